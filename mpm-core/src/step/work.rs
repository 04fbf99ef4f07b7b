//! The work of a solver behind one call: compiled in this crate, once for a precision and a dimension, and not in every program.
//!
//! A program that calls `mpm.step()` would compile the step, the grid's stages, checkpoints and all that they call, since
//! [`Mpm`] is generic. So its larger methods hand their work to a [`Work`], an object that each scene has from its method
//! ([`crate::Kernels`]); there are four, those of [`Scalar`].

use std::sync::Arc;

use mpm_materials::material::Material;

use super::body::GridBody;
use super::footprint::Footprint;
use super::frequency::Frequency;
use super::rest::{Balance, Rest, Rested};
use super::rigid::Rigid;
use super::seeding::Prepared;
use super::solver::Mpm;
use crate::geometry::Seeds;
use crate::parallel::Float;
use impactite_scene::boundary::Boundary;
use impactite_scene::error::SceneError;
use impactite_scene::{Archive, CheckpointError, StepError};

/// A number that solvers in `D` dimensions are compiled for: `f64` and, with the feature `single`, `f32`; in two and three dimensions.
#[diagnostic::on_unimplemented(
    message = "solvers of numbers `{Self}` in {D} dimensions are not compiled",
    note = "`f32` asks for the feature `single` of `mpm-core`"
)]
pub trait Scalar<const D: usize>: Float {
    /// Their work.
    #[doc(hidden)]
    const WORK: &'static dyn Work<Self, D>;
}

macro_rules! works {
    ($($(#[$doc:meta])* $name:ident(&$($self:ident)+, $($arg:ident: $type:ty),*) -> $out:ty = $here:ident;)*) => {
        /// What the methods of [`Mpm`] of the same names do.
        pub trait Work<T: Float, const D: usize>: Sync {
            $($(#[$doc])* fn $name(&self, mpm: works!(self T $($self)+), $($arg: $type),*) -> $out;)*
        }
        impl<T: Float, const D: usize> Work<T, D> for Once {
            $(fn $name(&self, mpm: works!(self T $($self)+), $($arg: $type),*) -> $out {
                mpm.$here($($arg),*)
            })*
        }
    };
    (self T mut mpm) => { &mut Mpm<D, T> };
    (self T mpm) => { &Mpm<D, T> };
}

struct Once;

works! {
    step_at_most(&mut mpm, left: f64) -> Result<T, StepError> = step_at_most_here;
    look_at_the_end(&mut mpm,) -> Result<(), StepError> = look_at_the_end_here;
    run_to_rest(&mut mpm, rest: &Rest, end: f64) -> Result<Rested, StepError> = run_to_rest_here;
    insert(&mut mpm, body: Prepared<'_, T, D>) -> Result<(), SceneError> = insert_here;
    add_rigid(&mut mpm, name: &str, rigid: &Rigid<D>, seeds: &Seeds<D>) -> Result<(), SceneError> = add_rigid_here;
    adopt(&mut mpm, law: Arc<dyn Material<T>>, body: &dyn GridBody<T, D>) -> Result<(), SceneError> = adopt_here;
    add_total_lagrangian(&mut mpm, scene: Mpm<D, T>) -> Result<(), SceneError> = add_total_lagrangian_here;
    deactivate(&mut mpm, bodies: &[&str]) -> Result<(), SceneError> = deactivate_here;
    bound(&mut mpm, boundary: Boundary<D>) -> Result<(), SceneError> = bound_here;
    archive(&mut mpm, file: &mut Archive) -> Result<(), CheckpointError> = archive_here;
    stable_step(&mut mpm,) -> Result<f64, StepError> = stable_step_here;
    balance(&mpm,) -> Balance = balance_here;
    frequency_bound(&mpm,) -> Frequency = frequency_bound_here;
    for_each_footprint(&mpm, visit: &mut dyn FnMut(&Footprint<'_, D>)) -> () = for_each_footprint_here;
}

macro_rules! scalars {
    ($($t:ty, $d:literal;)*) => {$(
        impl Scalar<$d> for $t {
            const WORK: &'static dyn Work<$t, $d> = &Once;
        }
    )*};
}
scalars! {
    f64, 2;
    f64, 3;
}
#[cfg(feature = "single")]
scalars! {
    f32, 2;
    f32, 3;
}
