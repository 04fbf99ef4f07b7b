//! A method: the shape function, transfer, stress update and embedding that make a solver together.

use std::marker::PhantomData;

use mpm_materials::Real;

use crate::dilatation::{Dilatation, MeanDilatation, OwnDilatation};
use crate::embedding::Embedding;
use crate::frame::{Frame, TotalLagrangian, UpdatedLagrangian};
use crate::scheme::StressUpdate;
use crate::shape::ShapeFunction;
use crate::transfer::{Allows, Suits, Transfer};

/// The ingredients of a material point method, chosen at compile time.
///
/// Combinations that would break are refused by the compiler, with the reason:
/// ```compile_fail
/// use mpm_core::{Apic, FullSpace, Linear, Method, Usl};
/// fn check<M: mpm_core::Composition<f64, 3>>(_: M) {}
/// check(Method::new(Linear, Apic, Usl, FullSpace)); // the hat's second moment vanishes at a node
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
    /// A method from its ingredients.
    pub fn new(shape: S, transfer: X, _stress_update: U, _embedding: E) -> Self {
        Method { shape, transfer, ingredients: PhantomData }
    }
}

impl<S, X, U, E, F, V> Method<S, X, U, E, F, V> {
    /// A method whose other ingredients its type names.
    pub(crate) fn of(shape: S, transfer: X) -> Self {
        Method { shape, transfer, ingredients: PhantomData }
    }
    /// The same, mapped in the reference configuration: [`TotalLagrangian`].
    pub fn total_lagrangian(self) -> Method<S, X, U, E, TotalLagrangian, V> {
        Method { shape: self.shape, transfer: self.transfer, ingredients: PhantomData }
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

impl<T, const D: usize, S, X, U, E, F, V> Composition<T, D> for Method<S, X, U, E, F, V>
where
    T: Real,
    S: ShapeFunction<T, D> + Suits<T, D, X>,
    X: Transfer<T>,
    U: StressUpdate + Allows<X>,
    E: Embedding<D>,
    F: Frame,
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
