//! Viscous time step limit: fluids whose viscosity, not sound speed, limits the step.

use std::f64::consts::PI;

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{BlockGrid, Flip, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain};
use mpm_materials::fluid::ShearViscosity;
use mpm_materials::{Bingham, Constitutive, Fluid, Newtonian, Tait};

/// Run a wide fluid layer of so many cells between free surfaces with velocity cos(pi y / H), which decays as exp(-nu (pi / H)^2 t).
/// Returns the relative kinetic energy after the time of decay to 1/e, and the number of steps.
fn decay(
    method: impl IntoKernels<f64, 2>,
    shear: impl ShearViscosity<f64> + 'static,
    viscosity: f64,
    cells: f64,
) -> (f64, u64) {
    let (h, high) = (0.8 / cells, 0.8);
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let layer = Cuboid::new([0.0; 2], [12.0, high]).expect("layer");
    let seeds = fill(&layer, &lattice, 2, &Filling::new()).expect("seeds");
    let fluid = Fluid::new(Tait::new(1000.0, 50.0).expect("fluid")).with_shear_viscosity(shear);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("layer", fluid.compiled(), &seeds, |x| [1e-3 * (PI * x[1] / high).cos(), 0.0]).expect("layer");
    let start = mpm.totals().kinetic;
    let rate = viscosity / 1000.0 * (PI / high).powi(2);
    mpm.run_until(0.5 / rate).expect("run");
    (mpm.totals().kinetic / start, mpm.steps())
}

/// The remaining energy is too large by 12 % with 8 cells and by 6 % with 16, for both methods and viscosities: a first-order error of
/// unknown cause. The test checks the time step, above which the solution would diverge.
#[test]
fn viscosity_bounds_the_step() {
    let due = (-1.0f64).exp();
    let hats = || Method::new(Linear, Flip, Musl, PlaneStrain);
    let errors = |run: &dyn Fn(f64) -> (f64, u64)| {
        let [(coarse, few), (fine, many)] = [8.0, 16.0].map(run);
        assert!(few < 40 && many < 150, "{few} and {many} steps");
        let [coarse, fine] = [coarse, fine].map(|kinetic| (kinetic / due - 1.0).abs());
        assert!(coarse < 0.15 && fine < 0.6 * coarse, "errors {coarse} and {fine}");
    };
    for eta in [5e4, 5e5] {
        let newtonian = || Newtonian::new(eta).expect("fluid");
        errors(&|cells| decay(hats(), newtonian(), eta, cells));
        errors(&|cells| decay(Method::impact(PlaneStrain), newtonian(), eta, cells));
    }
    // A Bingham fluid far below its creep rate equals a Newtonian fluid of its creep viscosity.
    let creeping = || Bingham::new(5e4, 1.0, 1.0).expect("fluid");
    errors(&|cells| decay(hats(), creeping(), 5e4 + 1.0, cells));
}
