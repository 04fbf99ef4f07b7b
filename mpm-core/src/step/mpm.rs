//! Scene of the material point method. Its larger methods are compiled in this crate, once for a precision and a
//! dimension, and not in every program.
//!
//! [`Mpm`] is generic: a program that calls `mpm.step()` would compile the step, the grid stages, checkpoints and all
//! that they call. Its larger methods therefore delegate to a [`Work`] object, which each scene receives from its
//! method ([`Kernels`]); there are four, those of [`Scalar`].

use std::collections::HashSet;
use std::sync::Arc;

use mpm_materials::material::Material;

use super::between_steps::looks::Looks;
use super::between_steps::operations::BetweenSteps;
use super::between_steps::rest::{Balance, Frequency, Rest, Rested};
use super::bodies::body::GridBody;
use super::bodies::deformable::Prepared;
use super::clients::client::GridClient;
use super::contact::ContactAlgorithm;
use super::criteria::Adaptive;
use super::hooks::Hooks;
use super::nodes::background::Background;
use super::nodes::footprint::Footprint;
use super::passes::kernels::{Facts, MethodKernels};
use super::rigid::motion::Rigid;
use super::scene::Scene;
use super::stepper::Stepper;
use crate::grid::GridStorage;
use impactite_geometry::Seeds;
use impactite_scene::error::SceneError;
use impactite_scene::{Archive, BoundaryEntry, CheckpointError, Clock, Exchange, StepError};
use impactite_simd::{Float, Team};

/// Material point method: bodies of particles on a background grid.
///
/// A scene has one type for all methods ([`crate::Method`]), grids, contact algorithms and laws. Bodies may have
/// different laws; with [`OneField`](crate::OneField) they move in one velocity field: they stick where they touch.
pub struct Mpm<const D: usize, T: Float = f64> {
    pub(super) work: &'static dyn Work<T, D>,
    /// Kernels of the method.
    pub(super) kernels: Arc<dyn MethodKernels<T, D>>,
    pub(super) scene: Scene<T, D>,
    pub(super) grid: Background<T, D>,
    pub(super) stepper: Stepper<T, D>,
    pub(super) between_steps: BetweenSteps,
    pub(super) hooks: Hooks<T, D>,
    /// Criteria of smaller cells, if the scene has any.
    pub(super) adaptive: Option<Adaptive<T, D>>,
    /// Names of all bodies so far, while several are added with a single arrangement of node blocks.
    pub(super) together: Option<HashSet<String>>,
    pub(super) team: Team,
    pub(super) clock: Clock,
    /// Exchange with boundaries and loads since the start.
    pub(super) ledger: Exchange,
    /// State of the balance checks.
    pub(super) looks: Looks<D>,
    /// Error that stopped the run, which then makes no further step.
    pub(super) stopped_by: Option<StepError>,
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Create an empty scene.
    pub(crate) fn of_parts(
        method: Kernels<T, D>,
        grid: Box<dyn GridStorage<T, D>>,
        contact: Arc<dyn ContactAlgorithm<T, D>>,
    ) -> Self {
        let Kernels { kernels, work } = method;
        let stepper = Stepper::new(kernels.facts().time_control());
        Mpm {
            work,
            kernels,
            scene: Scene::new(contact),
            grid: Background::new(grid),
            stepper,
            between_steps: BetweenSteps::default(),
            hooks: Hooks::default(),
            adaptive: None,
            together: None,
            team: Team::one(),
            clock: Clock::default(),
            ledger: Exchange::default(),
            looks: Looks::default(),
            stopped_by: None,
        }
    }
}

/// Kernels of a method as an object: one type for all methods, so that a method can be chosen at run time.
///
/// ```
/// use mpm_core::geometry::Lattice;
/// use mpm_core::{Apic, BlockGrid, Flip, IntoKernels, Kernels, Linear, Method, Mpm, Musl, PlaneStrain, QuadraticBSpline, Usl};
///
/// fn named(name: &str) -> Option<Kernels<f64, 2>> {
///     match name {
///         "flip" => Some(Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()),
///         "apic" => Some(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).into_kernels()),
///         _ => None,
///     }
/// }
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let method = named("apic").ok_or("no such method")?;
/// let scene = Mpm::new(method, BlockGrid::new(Lattice::new([0.0; 2], 0.1)?));
/// # assert!(scene.facts().affine);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Kernels<T: Float, const D: usize> {
    pub(crate) kernels: Arc<dyn MethodKernels<T, D>>,
    pub(crate) work: &'static dyn Work<T, D>,
}

impl<T: Float, const D: usize> Kernels<T, D> {
    pub(crate) fn new(kernels: Arc<dyn MethodKernels<T, D>>, work: &'static dyn Work<T, D>) -> Self {
        Kernels { kernels, work }
    }
    /// Properties of the method besides its kernels.
    pub fn facts(&self) -> &Facts {
        self.kernels.facts()
    }
}

/// Scalar type for which solvers in `D` dimensions are compiled: `f64` and, with the feature `single`, `f32`; in two
/// and three dimensions.
#[diagnostic::on_unimplemented(
    message = "solvers of numbers `{Self}` in {D} dimensions are not compiled",
    note = "`f32` asks for the feature `single` of `mpm-core`"
)]
pub trait Scalar<const D: usize>: Float {
    /// Compiled methods of a scene.
    #[doc(hidden)]
    const WORK: &'static dyn Work<Self, D>;
}

macro_rules! works {
    ($($(#[$doc:meta])* $name:ident(&$($self:ident)+, $($arg:ident: $type:ty),*) -> $out:ty = $here:ident;)*) => {
        /// Implementation of the methods of [`Mpm`] of the same names.
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
    add_client(&mut mpm, body: Box<dyn GridClient<T, D>>) -> Result<(), SceneError> = add_any_client;
    deactivate(&mut mpm, bodies: &[&str]) -> Result<(), SceneError> = deactivate_here;
    bound(&mut mpm, boundary: BoundaryEntry<D>) -> Result<(), SceneError> = bound_here;
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
