//! Two-dimensional scenes of schemes selected at run time.

use mpm_core::geometry::Lattice;
use mpm_core::{BlockGrid, Mpm, PlaneStrain, Watch};
use mpm_materials::fluid::FluidState;
use mpm_materials::{BulkViscosity, Fluid, IdealGas, Inviscid, Nothing};

use crate::scheme::{Kernel, Scheme, Velocity, kernels};

/// Ideal gas with bulk viscosity.
pub type Gas = Fluid<IdealGas<f64>, Inviscid, BulkViscosity<f64>>;

/// State variables of the gas: volume ratio, internal energy per reference volume (J/m^3).
pub type GasState = FluidState<f64, f64, Nothing, f64, Nothing>;

/// Create an empty plane strain scene of a scheme on an empty lattice; `None` if the scheme does not exist.
pub fn empty_scene(scheme: Scheme, lattice: Lattice<2>) -> Option<Mpm<2>> {
    let mut mpm = Mpm::new(kernels::<PlaneStrain, 2>(scheme)?, BlockGrid::new(lattice));
    // Watch off: such runs measure failures of schemes up to the end.
    mpm.set_watch(Watch::off());
    Some(mpm)
}

/// List the schemes for gas.
pub fn gas_schemes() -> Vec<Scheme> {
    vec![
        Scheme::moving(Kernel::Linear, Velocity::FlipMusl),
        Scheme::moving(Kernel::CpGimp, Velocity::FlipUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::FlipUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl),
        Scheme::moving(Kernel::Quadratic, Velocity::Fmpm4Usl),
        Scheme::moving(Kernel::Cubic, Velocity::ApicUsl),
    ]
}

/// Create an empty scene of a scheme for gas; `None` if it is not in [`gas_schemes`].
pub fn empty_gas_scene(scheme: Scheme, lattice: Lattice<2>) -> Option<Mpm<2>> {
    if gas_schemes().contains(&scheme) { empty_scene(scheme, lattice) } else { None }
}
