//! Method: the shape function, transfer, stress update and embedding of a solver.

use std::marker::PhantomData;

use mpm_materials::Real;

use crate::combine::{InReference, OnShape, WithTransfer};
use crate::dilatation::{Dilatation, MeanDilatation, OwnDilatation};
use crate::frame::{Frame, Holds, TotalLagrangian, UpdatedLagrangian};
use crate::scheme::Allows;
use crate::scheme::{Musl, StressUpdate, Usl};
use crate::shape::{CpGimp, Linear, QuadraticBSpline, ShapeFunction};
use crate::transfer::{Aflip, Apic, Flip, Suits, Transfer};
use impactite_scene::embedding::Embedding;

/// Parts of a material point method, chosen at compile time.
///
/// Combinations that are unstable or undefined do not compile; the error names the reason:
/// ```compile_fail
/// use mpm_core::{Apic, FullSpace, Linear, Method, Usl};
/// fn check<M: mpm_core::Composition<f64, 3>>(_: M) {}
/// check(Method::new(Linear, Apic, Usl, FullSpace)); // the linear shape function's second moment vanishes at a node
/// ```
/// ```compile_fail
/// use mpm_core::{Apic, FullSpace, Method, Musl, QuadraticBSpline};
/// fn check<M: mpm_core::Composition<f64, 3>>(_: M) {}
/// check(Method::new(QuadraticBSpline, Apic, Musl, FullSpace)); // filters the velocity twice
/// ```
/// ```compile_fail
/// use mpm_core::{Axisymmetric, Flip, Linear, Method, Musl};
/// fn check<M: mpm_core::Composition<f64, 3>>(_: M) {}
/// check(Method::new(Linear, Flip, Musl, Axisymmetric)); // an embedding of two dimensions
/// ```
/// ```
/// use mpm_core::{Apic, FullSpace, Method, QuadraticBSpline, Usl};
/// fn check<M: mpm_core::Composition<f64, 3>>(_: M) {}
/// check(Method::new(QuadraticBSpline, Apic, Usl, FullSpace));
/// check(Method::impact(FullSpace)); // by what it is for
/// ```
///
/// Two further parts have defaults; the charts of docs/report/index.html show their costs. Weights refer to the
/// current configuration. Those of the reference configuration ([`Method::total_lagrangian`]) are the cheapest for
/// any error below half a per cent in chart C1 and below a tenth in C2, but require material that neither tears nor
/// flows without limit. Laws receive the dilatation of each particle. The mean over a cell
/// ([`Method::mean_dilatation`]) reduces the error of a limit load in chart C6 from 16 to below 5 %, without benefit
/// for compressible material: use it for plastic metal, undrained soil and rubber.
#[derive(Clone, Copy, Debug, Default)]
pub struct Method<S, X, U, E, F = UpdatedLagrangian, V = OwnDilatation> {
    shape: S,
    transfer: X,
    ingredients: PhantomData<(U, E, F, V)>,
}

impl<S, X, U, E> Method<S, X, U, E> {
    /// Create a method from compatible parts (book, "Choosing the parts"): `R` is `Method<S, X, U, E>`, for any shape
    /// function `S` that [`Suits`] the transfer `X`, and any stress update `U` that [`Allows`] it.
    // The bounds make `R` equal to `Self`.
    #[allow(clippy::new_ret_no_self)]
    pub fn new<R, Q, V, W>(shape: S, transfer: X, _stress_update: U, _embedding: E) -> R
    where
        X: OnShape<S, V, Q, R>,
        U: WithTransfer<X, W, Self, Q>,
    {
        X::made(U::made(Method { shape, transfer, ingredients: PhantomData }))
    }
}

impl<E> Method<QuadraticBSpline, Aflip<f64>, Usl, E> {
    /// Create a method for impact, penetration and tumbling fragments: quadratic B-splines, AFLIP, stress last.
    ///
    /// A disc that spins without load stays whole; FLIP without an affine field tears it apart within a few turns,
    /// whatever the shape function. AFLIP gained energy in none of the scenes of the book, and loses a quarter to a
    /// third of what APIC does in an impact (book, "Methods compared").
    pub fn impact(embedding: E) -> Self {
        Method::new(QuadraticBSpline, Aflip::default(), Usl, embedding)
    }
}

impl<E> Method<QuadraticBSpline, Apic, Usl, E> {
    /// Create a method for bodies at rest on each other: quadratic B-splines, APIC, stress last. FLIP without an
    /// affine field keeps velocity components that the nodes do not resolve, and contacts that open and close amplify
    /// them until the bodies jump; with APIC a stack comes to rest to rounding (book, "Methods compared").
    pub fn contact_at_rest(embedding: E) -> Self {
        Method::new(QuadraticBSpline, Apic, Usl, embedding)
    }
}

impl<E> Method<CpGimp, Flip, Musl, E> {
    /// Create a method for elastic bodies that bounce and roll on others: cpGIMP, FLIP, velocities mapped twice. It
    /// has the least loss in contact of bodies on nodes a cell away (book, "Walls and floors"), and less
    /// cell-crossing noise than linear shape functions. Vibrations are undamped: soft bodies that rest on few cells
    /// in space amplify noise, and bodies that spin freely for many turns lose angular momentum.
    pub fn machine_parts(embedding: E) -> Self {
        Method::new(CpGimp, Flip, Musl, embedding)
    }
}

impl<E> Method<Linear, Flip, Musl, E, TotalLagrangian> {
    /// Create a method for large elastic deformation without fracture or flow: linear shape functions in the
    /// reference configuration, FLIP. No particle crosses a cell, the energy is conserved, and it is the cheapest for
    /// a given error in charts C1 and C2 of docs/report/index.html. Add bodies that come into contact by
    /// `Mpm::add_total_lagrangian`.
    pub fn large_elastic(embedding: E) -> Self {
        Method::new(Linear, Flip, Musl, embedding).total_lagrangian()
    }
}

impl<S, X, U, E, F, V> Method<S, X, U, E, F, V> {
    /// Compile the kernels at the call, which takes some seconds: required for custom parts, and for combinations of
    /// parts of this crate without compiled kernels ([`IntoKernels`](crate::IntoKernels)).
    pub fn compiled(self) -> CompiledHere<Self> {
        CompiledHere(self)
    }
    /// Map in the reference configuration ([`TotalLagrangian`]): `R` is `Method<S, X, U, E, TotalLagrangian, V>`, for
    /// a shape function that has a [`FixedDomain`](crate::FixedDomain).
    pub fn total_lagrangian<R, W>(self) -> R
    where
        S: InReference<W, Method<S, X, U, E, TotalLagrangian, V>, R>,
    {
        S::made(Method { shape: self.shape, transfer: self.transfer, ingredients: PhantomData })
    }
    /// Replace the dilatation of particles by that of their cell: [`MeanDilatation`].
    pub fn mean_dilatation(self) -> Method<S, X, U, E, F, MeanDilatation> {
        Method { shape: self.shape, transfer: self.transfer, ingredients: PhantomData }
    }
}

/// Interface of a method to the solver; implemented by every legal [`Method`].
pub trait Composition<T: Real, const D: usize>: Copy + Send + Sync + 'static {
    /// Shape function.
    type Shape: ShapeFunction<T, D>;
    /// Transfer.
    type Transfer: Transfer<T>;
    /// Stress update.
    type Update: StressUpdate;
    /// Embedding.
    type Embedding: Embedding<D>;
    /// Frame of reference of weights and gradients.
    type Frame: Frame;
    /// Volume change passed to laws.
    type Dilatation: Dilatation;
    /// True if a step needs only the sum of momentum and impulse at the nodes: with USL and a transfer that does not
    /// read the acceleration. The force is then mapped as the impulse of the next step, whose size is planned one
    /// step ahead.
    const MAPS_TOGETHER: bool =
        !Self::Update::REMAP && !Self::Update::BEFORE_FORCES && !Self::Transfer::READS_INCREMENT;
    /// The shape function.
    fn shape(&self) -> &Self::Shape;
    /// The transfer.
    fn transfer(&self) -> &Self::Transfer;
    /// Describe the parts in one line.
    fn describe(&self) -> String {
        let frame = if Self::Frame::TOTAL { Self::Frame::NAME.to_string() + ", " } else { String::new() };
        let mean =
            if Self::Dilatation::MEAN { Self::Dilatation::NAME.to_string() + ", " } else { String::new() };
        format!(
            "{}, {frame}{mean}{}-{}, {}",
            Self::Embedding::NAME,
            Self::Update::NAME,
            Self::Transfer::NAME,
            Self::Shape::NAME
        )
    }
}

/// Method with kernels compiled where it is used: [`Method::compiled`].
#[derive(Clone, Copy, Debug, Default)]
pub struct CompiledHere<M>(pub(crate) M);

impl<T: Real, const D: usize, M: Composition<T, D>> Composition<T, D> for CompiledHere<M> {
    type Shape = M::Shape;
    type Transfer = M::Transfer;
    type Update = M::Update;
    type Embedding = M::Embedding;
    type Frame = M::Frame;
    type Dilatation = M::Dilatation;
    #[inline(always)]
    fn shape(&self) -> &M::Shape {
        self.0.shape()
    }
    #[inline(always)]
    fn transfer(&self) -> &M::Transfer {
        self.0.transfer()
    }
}

impl<T, const D: usize, S, X, U, E, F, V> Composition<T, D> for Method<S, X, U, E, F, V>
where
    T: Real,
    S: ShapeFunction<T, D> + Suits<X>,
    X: Transfer<T>,
    U: StressUpdate + Allows<X>,
    E: Embedding<D>,
    F: Holds<S>,
    V: Dilatation,
{
    type Shape = S;
    type Transfer = X;
    type Update = U;
    type Embedding = E;
    type Frame = F;
    type Dilatation = V;
    #[inline(always)]
    fn shape(&self) -> &S {
        &self.shape
    }
    #[inline(always)]
    fn transfer(&self) -> &X {
        &self.transfer
    }
}
