//! What runs scenes of cases: schemes of material points here, smoothed particles in [`crate::smoothed`].

use std::fmt::Debug;

use mpm_core::{
    CpGimp, Deformable, Flip, Fmpm, FullSpace, Linear, Method, PlaneStrain, QuadraticBSpline, Usl,
};
use mpm_materials::IntoMaterial;

use crate::case::Outcome;
use crate::empty::{Gas, GasState, empty_gas_scene};
use crate::scene::{Moment, Run, Scene};
use crate::scheme::{Kernel, Scheme, Velocity, kernels};

/// What runs the scene of a case, whatever it is: errors are measured alike.
pub trait Formulation: Copy + Debug + PartialEq {
    /// Its name in files.
    fn name(self) -> String;

    /// Cells across a bar between planes of symmetry: as many as it takes to have all neighbours.
    fn across(self) -> usize;

    /// Run a scene in plane strain; `look` fills in the outcome's errors.
    fn plane<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 2>,
        look: &mut dyn FnMut(&Moment<'_, 2>),
    ) -> Outcome;

    /// Run a scene in space, by the few that are compiled for that.
    fn solid<C: IntoMaterial<f64> + Clone>(
        self,
        scene: &Scene<C, 3>,
        look: &mut dyn FnMut(&Moment<'_, 3>),
    ) -> Outcome;

    /// Run gas in plane strain that starts in a state by place; volumes of the seeds are those in that state.
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

    /// By [`solid_schemes`].
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

    /// By [`gas_schemes`](crate::empty::gas_schemes).
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

/// The schemes that problems in space are compiled for.
pub fn solid_schemes() -> Vec<Scheme> {
    vec![
        Scheme::moving(Kernel::CpGimp, Velocity::FlipUsl),
        Scheme::total(Kernel::Linear, Velocity::FlipUsl),
        Scheme::total(Kernel::Quadratic, Velocity::Fmpm4Usl),
    ]
}
