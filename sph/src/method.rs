//! Method: the ingredients of a solver, chosen at compile time.

use std::fmt::Debug;
use std::marker::PhantomData;

use impactite_scene::Embedding;

use crate::form::{
    Correction, Form, GradientCorrection, NoCorrection, ScaledGradients, TotalLagrangian, Updated,
};
use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::stabilisation::{
    ArtificialStress, DensityDiffusion, PairViscosity, PrintedArtificialStress, Stabilisation,
    ZeroEnergyPenalty,
};

/// Ingredients of a method of smoothed particles.
///
/// Invalid combinations do not compile; the error names the reason:
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
    /// Create a method from its ingredients.
    pub fn new(_embedding: E, kernel: K, form: F, _correction: C, stabilisation: S) -> Self {
        Method { kernel, form, stabilisation, ingredients: PhantomData }
    }
}

impl<E> Method<E, CubicSpline, Updated, NoCorrection, PrintedArtificialStress> {
    /// Original formulation \[Xiao2015\]: direct discretisation, cubic spline, artificial stress. The artificial viscosity is that of the
    /// law.
    pub fn printed(embedding: E) -> Self {
        let stress = PrintedArtificialStress::default();
        Method::new(embedding, CubicSpline::default(), Updated, NoCorrection, stress)
    }
}

impl<E> Method<E, WendlandC2, TotalLagrangian, GradientCorrection, ZeroEnergyPenalty> {
    /// Method for bodies without fracture: total Lagrangian, corrected gradients, zero-energy penalty. Smoothing lengths are 1.1 spacings:
    /// gradients that are exact for linear fields need no more than 12 neighbours in the plane and 32 in space.
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
    /// Method for flow and fracture: updated Lagrangian, corrected gradients, balanced artificial stress.
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

impl<E> Method<E, WendlandC2, Updated, ScaledGradients, (PairViscosity, DensityDiffusion)> {
    /// Method for liquids, the delta-SPH of \[Antuono2010\]: updated Lagrangian, gradients that are scaled and not corrected, pair viscosity of
    /// 0.05, diffusion of density. Walls, fixed planes and planes of symmetry are mirrors ([`Sph::bound`](crate::Sph::bound)).
    pub fn liquid(embedding: E) -> Self {
        let stabilisation = (PairViscosity::LIQUID, DensityDiffusion::default());
        Method::new(embedding, WendlandC2::WIDE, Updated, ScaledGradients, stabilisation)
    }
}

/// Requirements of a solver on a method; implemented by every valid [`Method`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no method of smoothed particles in {D} dimensions",
    note = "in two dimensions take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`",
    note = "the total Lagrangian form needs `GradientCorrection` and takes `ZeroEnergyPenalty`; artificial stress is for the updated ones"
)]
pub trait Composition<const D: usize>: Copy + Debug + Send + Sync + 'static {
    /// Embedding: plane strain, axisymmetric or full space.
    type Embedding: Embedding<D>;
    /// The kernel.
    type Kernel: Kernel;
    /// Configuration of the kernels.
    type Form: Form;
    /// Correction of gradients.
    type Correction: Correction<Self::Form>;
    /// Stabilisation of zero-energy modes and of the tensile instability.
    type Stabilisation: Stabilisation<Self::Form>;
    /// The kernel.
    fn kernel(&self) -> &Self::Kernel;
    /// The form.
    fn form(&self) -> &Self::Form;
    /// The stabilisation.
    fn stabilisation(&self) -> &Self::Stabilisation;
    /// Return the names of the ingredients in one line.
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
