//! A method: the shape function, transfer, stress update and embedding that make a solver together.

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

/// The ingredients of a material point method, chosen at compile time.
///
/// Combinations that would break are refused by the compiler, with the reason:
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
/// Two ingredients are there without being asked for, and the charts of docs/report/index.html say what they cost. Weights are
/// those of the current configuration: those of the reference one ([`Method::total_lagrangian`]) are the cheapest for any error
/// below half a per cent in chart C1 and below a tenth in C2, but only what neither tears nor flows without end has one. Laws see every particle's own
/// dilatation: in chart C6 the mean of a cell ([`Method::mean_dilatation`]) takes the error of a limit load from 16 to below 5 %, and
/// brings nothing where material is compressible, so that it is for metal that flows, undrained soil and rubber.
#[derive(Clone, Copy, Debug, Default)]
pub struct Method<S, X, U, E, F = UpdatedLagrangian, V = OwnDilatation> {
    shape: S,
    transfer: X,
    ingredients: PhantomData<(U, E, F, V)>,
}

impl<S, X, U, E> Method<S, X, U, E> {
    /// A method from its ingredients, which must go together (book, "Choosing the parts"): `R` is `Method<S, X, U, E>`, of any shape
    /// function `S` that [`Suits`] the transfer `X`, and any stress update `U` that [`Allows`] it.
    // `R` is `Self`, by way of the bounds.
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
    /// For impact, penetration and fragments that fly and tumble: quadratic B-splines, AFLIP, stress last.
    ///
    /// It keeps a disc whole that spins without load, where FLIP without an affine field tears one apart within a few turns, whatever the shape
    /// function; it gained energy in none of the scenes there, and loses a quarter to a third of what APIC does in an impact (book, "Methods compared").
    pub fn impact(embedding: E) -> Self {
        Method::new(QuadraticBSpline, Aflip::default(), Usl, embedding)
    }
}

impl<E> Method<QuadraticBSpline, Apic, Usl, E> {
    /// For bodies that rest on each other: quadratic B-splines, APIC, stress last. FLIP without an affine field never forgets what the
    /// nodes do not see, and contacts that open and close feed it until the bodies jump; with APIC a stack comes to rest to
    /// rounding (book, "Methods compared").
    pub fn contact_at_rest(embedding: E) -> Self {
        Method::new(QuadraticBSpline, Apic, Usl, embedding)
    }
}

impl<E> Method<CpGimp, Flip, Musl, E> {
    /// For elastic bodies that bounce and roll on others: cpGIMP, FLIP, velocities mapped twice. What contact of bodies loses on nodes a cell away
    /// is least with it (book, "Walls and floors"), and particles that cross cells make less noise than with linear shape functions. Nothing damps
    /// what vibrates: soft bodies that rest on few cells in space feed noise, and bodies that spin freely for many turns lose angular momentum.
    pub fn machine_parts(embedding: E) -> Self {
        Method::new(CpGimp, Flip, Musl, embedding)
    }
}

impl<E> Method<Linear, Flip, Musl, E, TotalLagrangian> {
    /// For large elastic deformation of bodies that neither break nor flow: linear shape functions in the reference configuration, FLIP.
    /// No particle crosses a cell, the energy is kept, and it is the cheapest for a given error in charts C1 and C2 of docs/report/index.html.
    /// Bodies that meet are added by `Mpm::add_total_lagrangian`.
    pub fn large_elastic(embedding: E) -> Self {
        Method::new(Linear, Flip, Musl, embedding).total_lagrangian()
    }
}

impl<S, X, U, E, F, V> Method<S, X, U, E, F, V> {
    /// The method with kernels that are compiled where this is written, for some seconds: what a scene takes of ingredients of one's
    /// own, and of those of this crate that it has no kernels of together ([`IntoKernels`](crate::IntoKernels)).
    pub fn compiled(self) -> CompiledHere<Self> {
        CompiledHere(self)
    }
    /// The same, mapped in the reference configuration ([`TotalLagrangian`]): `R` is `Method<S, X, U, E, TotalLagrangian, V>`, of a shape
    /// function that has a [`FixedDomain`](crate::FixedDomain).
    pub fn total_lagrangian<R, W>(self) -> R
    where
        S: InReference<W, Method<S, X, U, E, TotalLagrangian, V>, R>,
    {
        S::made(Method { shape: self.shape, transfer: self.transfer, ingredients: PhantomData })
    }
    /// The same, with the dilatation of a cell for that of its particles: [`MeanDilatation`].
    pub fn mean_dilatation(self) -> Method<S, X, U, E, F, MeanDilatation> {
        Method { shape: self.shape, transfer: self.transfer, ingredients: PhantomData }
    }
}

/// What a solver asks of a method; implemented by every legal [`Method`].
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
    /// Whose change of volume laws see.
    type Dilatation: Dilatation;
    /// Does a step need only the sum of momentum and impulse at the nodes? So it is with USL and a transfer
    /// that does not read the acceleration: then force goes to the nodes as the impulse of the step to come,
    /// whose size is planned one step ahead.
    const MAPS_TOGETHER: bool =
        !Self::Update::REMAP && !Self::Update::BEFORE_FORCES && !Self::Transfer::READS_INCREMENT;
    /// The shape function.
    fn shape(&self) -> &Self::Shape;
    /// The transfer.
    fn transfer(&self) -> &Self::Transfer;
    /// A line that names the ingredients.
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

/// A method whose kernels are compiled where it is used: [`Method::compiled`].
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
