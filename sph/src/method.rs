//! A method: the parts of a solver, chosen at compile time.

use std::fmt::Debug;
use std::marker::PhantomData;

use impactite_scene::Embedding;

use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::stabilisation::{ArtificialStress, Stabilisation, ZeroEnergyPenalty};

/// The configuration that kernels are taken in.
pub trait Form: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Is it that of the reference, with the neighbours that particles have there?
    const TOTAL: bool;
    /// The stretch beyond which the present configuration becomes the reference, if any.
    fn renewed_at(&self) -> Option<f64> {
        None
    }
}

/// Kernels and neighbours of the reference configuration: no tensile instability, no search, and no separation. Nothing tears, so that it
/// is for bodies that stay whole.
///
/// With [`TotalLagrangian::renewed`] the present configuration becomes the reference, neighbours and all, as soon as a particle is stretched
/// by more than a factor since: the switch to an updated form for what flows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TotalLagrangian(Option<f64>);

impl TotalLagrangian {
    /// Renew the reference where the root mean square of the principal stretches of a particle, or that of their inverses, exceeds this.
    ///
    /// # Errors
    /// Not above 1, or not finite.
    pub fn renewed(stretch: f64) -> Result<Self, StretchError> {
        if stretch > 1.0 && stretch.is_finite() {
            Ok(TotalLagrangian(Some(stretch)))
        } else {
            Err(StretchError(stretch))
        }
    }
}

/// A stretch that renews nothing, or everything always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StretchError(f64);

impl std::fmt::Display for StretchError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let StretchError(stretch) = self;
        write!(
            f,
            "renewal of the reference: stretch = {stretch} is not allowed; it must be above 1 and finite"
        )
    }
}
impl std::error::Error for StretchError {}

impl Form for TotalLagrangian {
    const NAME: &'static str = "total Lagrangian";
    const TOTAL: bool = true;
    fn renewed_at(&self) -> Option<f64> {
        self.0
    }
}

/// Kernels and neighbours of the present configuration. The force of a pair is -V_i V_j (sigma_i B_i + sigma_j B_j) grad W, the one that
/// does the work that the velocity gradients of laws see: energy is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Updated;
impl Form for Updated {
    const NAME: &'static str = "updated Lagrangian";
    const TOTAL: bool = false;
}

/// What is done about kernels that are cut off by surfaces, and about disorder.
pub trait Correction<F>: Copy + Debug + Send + Sync + 'static {
    /// The name in tables and messages.
    const NAME: &'static str;
    /// Are gradients multiplied by B = (sum V grad W (x) (x_j - x_i))^-1?
    const CORRECTED: bool;
}

/// Gradients that are exact of linear fields \[Randles1996, BonetLok1999\]: what turns as a rigid body is not strained.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GradientCorrection;
impl<F: Form> Correction<F> for GradientCorrection {
    const NAME: &'static str = "corrected gradients";
    const CORRECTED: bool = true;
}

/// Gradients as they are, as printed: near surfaces about half of what they should be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoCorrection;
impl Correction<Updated> for NoCorrection {
    const NAME: &'static str = "gradients as they are";
    const CORRECTED: bool = false;
}

/// The ingredients of a method of smoothed particles.
///
/// Those that do not go together are refused by the compiler, with the reason:
/// ```compile_fail
/// use impactite_scene::PlaneStrain;
/// use sph::{GradientCorrection, Method, TotalLagrangian, WendlandC2, ArtificialStress};
/// fn check<M: sph::Composition<2>>(_: M) {}
/// // Under kernels of the reference configuration there is no tensile instability.
/// check(Method::new(PlaneStrain, WendlandC2::default(), TotalLagrangian::default(), GradientCorrection, ArtificialStress::default()));
/// ```
/// ```compile_fail
/// use impactite_scene::PlaneStrain;
/// use sph::{GradientCorrection, Method, Updated, WendlandC2, ZeroEnergyPenalty};
/// fn check<M: sph::Composition<2>>(_: M) {}
/// // The penalty is by the deformation gradient of the reference configuration.
/// check(Method::new(PlaneStrain, WendlandC2::default(), Updated, GradientCorrection, ZeroEnergyPenalty::default()));
/// ```
/// ```
/// use impactite_scene::PlaneStrain;
/// use sph::{GradientCorrection, Method, TotalLagrangian, WendlandC2, ZeroEnergyPenalty};
/// fn check<M: sph::Composition<2>>(_: M) {}
/// check(Method::new(PlaneStrain, WendlandC2::NARROW, TotalLagrangian::default(), GradientCorrection, ZeroEnergyPenalty::default()));
/// check(Method::total_lagrangian(PlaneStrain)); // the same
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Method<E, K, F, C, S> {
    kernel: K,
    form: F,
    stabilisation: S,
    ingredients: PhantomData<(E, C)>,
}

impl<E, K, F, C, S> Method<E, K, F, C, S> {
    /// A method from its ingredients.
    pub fn new(_embedding: E, kernel: K, form: F, _correction: C, stabilisation: S) -> Self {
        Method { kernel, form, stabilisation, ingredients: PhantomData }
    }
}

impl<E> Method<E, CubicSpline, Updated, NoCorrection, ArtificialStress> {
    /// As printed \[Xiao2015\]: direct discretisation, cubic spline, artificial stress. The artificial viscosity is that of the law.
    pub fn printed(embedding: E) -> Self {
        Method::new(embedding, CubicSpline::default(), Updated, NoCorrection, ArtificialStress::default())
    }
}

impl<E> Method<E, WendlandC2, TotalLagrangian, GradientCorrection, ZeroEnergyPenalty> {
    /// For bodies that stay whole: total Lagrangian, corrected gradients, a penalty on what these do not see. Smoothing lengths are 1.1
    /// spacings: what is exact of linear fields needs no more neighbours, 12 in the plane and 32 in space.
    pub fn total_lagrangian(embedding: E) -> Self {
        Method::new(
            embedding,
            WendlandC2::NARROW,
            TotalLagrangian::default(),
            GradientCorrection,
            ZeroEnergyPenalty::default(),
        )
    }
}

impl<E> Method<E, WendlandC2, Updated, GradientCorrection, ArtificialStress> {
    /// For what flows and tears: updated Lagrangian, corrected gradients, artificial stress.
    pub fn updated(embedding: E) -> Self {
        Method::new(
            embedding,
            WendlandC2::default(),
            Updated,
            GradientCorrection,
            ArtificialStress::default(),
        )
    }
}

/// What a solver asks of a method; implemented by every legal [`Method`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no method of smoothed particles in {D} dimensions",
    note = "in two dimensions take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`",
    note = "the total Lagrangian form needs `GradientCorrection` and takes `ZeroEnergyPenalty`; artificial stress is for the updated ones"
)]
pub trait Composition<const D: usize>: Copy + Debug + Send + Sync + 'static {
    /// How the problem lies in space.
    type Embedding: Embedding<D>;
    /// The kernel.
    type Kernel: Kernel;
    /// The configuration of kernels.
    type Form: Form;
    /// Correction of gradients.
    type Correction: Correction<Self::Form>;
    /// What is done against modes that the sums do not see.
    type Stabilisation: Stabilisation<Self::Form>;
    /// The kernel.
    fn kernel(&self) -> &Self::Kernel;
    /// The form.
    fn form(&self) -> &Self::Form;
    /// The stabilisation.
    fn stabilisation(&self) -> &Self::Stabilisation;
    /// A line that names the ingredients.
    fn describe(&self) -> String {
        format!(
            "{}, {}, {}, {}, {}",
            Self::Embedding::NAME,
            Self::Form::NAME,
            Self::Kernel::NAME,
            Self::Correction::NAME,
            Self::Stabilisation::NAME
        )
    }
}

impl<const D: usize, E, K, F, C, S> Composition<D> for Method<E, K, F, C, S>
where
    E: Embedding<D> + Debug,
    K: Kernel,
    F: Form,
    C: Correction<F>,
    S: Stabilisation<F>,
{
    type Embedding = E;
    type Kernel = K;
    type Form = F;
    type Correction = C;
    type Stabilisation = S;
    fn kernel(&self) -> &K {
        &self.kernel
    }
    fn form(&self) -> &F {
        &self.form
    }
    fn stabilisation(&self) -> &S {
        &self.stabilisation
    }
}
