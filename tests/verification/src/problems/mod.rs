//! The problems. Numbers as V3 are those of the list of verification problems of the book, "Verification".

pub mod axis_aligned;
pub mod bar;
pub mod column;
pub mod elements;
pub mod footing;
pub mod gas;
pub mod gates;
pub mod rigid;
pub mod ring;
pub mod statics;
pub mod vortex;

use mpm_core::geometry::Lattice;
use mpm_core::{Boundary, FullSpace, PlaneStrain, Side};
use mpm_materials::{IntoMaterial, Moduli, NeoHookean};

use crate::case::Outcome;
use crate::scene::{Moment, Run, Scene};
use crate::scheme::{Scheme, kernels};

/// A neo-Hookean law of Young's modulus (Pa) and Poisson's ratio.
///
/// # Errors
/// Constants that no material has.
pub fn rubber(density: f64, young: f64, poisson: f64) -> Result<NeoHookean<f64>, String> {
    let moduli = Moduli::young_poisson(young, poisson).map_err(|e| e.to_string())?;
    NeoHookean::new(density, moduli).map_err(|e| e.to_string())
}

/// A lattice from an origin.
///
/// # Errors
/// An origin or a spacing that cannot be.
pub fn lattice<const D: usize>(origin: [f64; D], spacing: f64) -> Result<Lattice<D>, String> {
    Lattice::new(origin, spacing).map_err(|e| e.to_string())
}

/// Planes of symmetry at `low` and `high` of the axes.
pub fn box_of_planes<const D: usize>(axes: std::ops::Range<usize>, low: f64, high: f64) -> Vec<Boundary<D>> {
    axes.flat_map(|axis| {
        [
            Boundary::Symmetry { axis, at: low, side: Side::Above },
            Boundary::Symmetry { axis, at: high, side: Side::Below },
        ]
    })
    .collect()
}

/// Run a plane scene; `look` fills in the outcome's errors.
pub(crate) fn run_plane<C: IntoMaterial<f64> + Clone>(
    scheme: Scheme,
    scene: &Scene<C, 2>,
    look: &mut dyn FnMut(&Moment<'_, 2>),
) -> Outcome {
    let ended = kernels::<PlaneStrain, 2>(scheme).map(|method| Run { scene, look }.with(method));
    Outcome::of(scheme, 2, ended)
}

/// Run a scene in space. Compiled for the schemes of [`solid_schemes`] alone.
pub(crate) fn run_solid<C: IntoMaterial<f64> + Clone>(
    scheme: Scheme,
    scene: &Scene<C, 3>,
    look: &mut dyn FnMut(&Moment<'_, 3>),
) -> Outcome {
    use mpm_core::{CpGimp, Flip, Fmpm, Linear, Method, QuadraticBSpline, Usl};

    use crate::scheme::{Kernel, Velocity};
    let run = Run { scene, look };
    let ended = match (scheme.kernel, scheme.velocity, scheme.total) {
        (Kernel::CpGimp, Velocity::FlipUsl, false) => {
            Some(run.with(Method::new(CpGimp, Flip, Usl, FullSpace)))
        }
        (Kernel::Linear, Velocity::FlipUsl, true) => {
            Some(run.with(Method::new(Linear, Flip, Usl, FullSpace).total_lagrangian().compiled()))
        }
        (Kernel::Quadratic, Velocity::Fmpm4Usl, true) => Some(
            run.with(Method::new(QuadraticBSpline, Fmpm::<4>, Usl, FullSpace).total_lagrangian().compiled()),
        ),
        _ => None,
    };
    Outcome::of(scheme, 3, ended)
}

/// The schemes that problems in space are compiled for.
pub fn solid_schemes() -> Vec<Scheme> {
    use crate::scheme::{Kernel, Velocity};
    vec![
        Scheme::moving(Kernel::CpGimp, Velocity::FlipUsl),
        Scheme::total(Kernel::Linear, Velocity::FlipUsl),
        Scheme::total(Kernel::Quadratic, Velocity::Fmpm4Usl),
    ]
}
