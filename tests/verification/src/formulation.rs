//! Formulations that run case scenes: material point schemes here, smoothed particles in [`crate::smoothed`].

use std::fmt::Debug;

use mpm_core::{
    CpGimp, Deformable, Flip, Fmpm, FullSpace, Linear, Method, PlaneStrain, QuadraticBSpline, Usl,
};
use mpm_materials::IntoMaterial;

use crate::case::{Case, Outcome};
use crate::empty::{Gas, GasState, empty_gas_scene};
use crate::scene::{Moment, Run, Scene};
use crate::scheme::{Kernel, Scheme, Velocity, kernels};

/// Formulation that runs the scene of a case; errors are measured alike for all.
pub trait Formulation: Copy + Debug + PartialEq {
    /// Name in files.
    fn name(self) -> String;

    /// Run a case, compiled in this crate once for each formulation: crates that run cases would compile all schemes again.
    fn run(case: &Case<Self>) -> Outcome;

    /// Number of cells across a bar between symmetry planes that provides all neighbours.
    fn across(self) -> usize;

    /// Run a plane strain scene; `look` records the errors of the outcome.
    fn plane<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 2>,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome;

    /// Run a three-dimensional scene by one of the few compiled schemes.
    fn solid<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 3>,
        look: &mut dyn FnMut(&Moment<'_, 3>),
    ) -> Outcome;

    /// Run gas in plane strain from an initial state field; seed volumes are those in that state.
    fn gas(
        self,
        scene: &Scene<Gas, 2>,
        state: fn([f64; 2]) -> GasState,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome;
}

impl Formulation for Scheme {
    fn name(self) -> String {
        Scheme::name(self)
    }

    fn run(case: &Case<Self>) -> Outcome {
        case.by_problem()
    }

    fn across(self) -> usize {
        1
    }

    fn plane<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 2>,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome {
        let ended = kernels::<PlaneStrain, 2>(self).map(|method| Run { scene, look }.with(method));
        Outcome::of(self.kernel.nodes(2), ended)
    }

    /// Runs the schemes of [`solid_schemes`].
    fn solid<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 3>,
        look: &mut dyn FnMut(&Moment<'_, 3>),
    ) -> Outcome {
        let run = Run { scene, look };
        let ended = match (self.kernel, self.velocity, self.total) {
            (Kernel::CpGimp, Velocity::FlipUsl, false) => {
                Some(run.with(Method::new(CpGimp, Flip, Usl, FullSpace)))
            }
            (Kernel::Linear, Velocity::FlipUsl, true) => {
                Some(run.with(Method::new(Linear, Flip, Usl, FullSpace).total_lagrangian().compiled()))
            }
            (Kernel::Quadratic, Velocity::Fmpm4Usl, true) => Some(run.with(
                Method::new(QuadraticBSpline, Fmpm::<4>, Usl, FullSpace).total_lagrangian().compiled(),
            )),
            _ => None,
        };
        Outcome::of(self.kernel.nodes(3), ended)
    }

    /// Runs the schemes of [`gas_schemes`](crate::empty::gas_schemes).
    fn gas(
        self,
        scene: &Scene<Gas, 2>,
        state: fn([f64; 2]) -> GasState,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome {
        let ended = empty_gas_scene(self, scene.lattice).map(|mpm| {
            let body = Deformable::new("gas", scene.law, &scene.seeds).moving(&scene.velocity);
            Run { scene, look }.on(mpm, body.in_state(state))
        });
        Outcome::of(self.kernel.nodes(2), ended)
    }
}

/// List the schemes compiled for three-dimensional problems.
pub fn solid_schemes() -> Vec<Scheme> {
    vec![
        Scheme::moving(Kernel::CpGimp, Velocity::FlipUsl),
        Scheme::total(Kernel::Linear, Velocity::FlipUsl),
        Scheme::total(Kernel::Quadratic, Velocity::Fmpm4Usl),
    ]
}
