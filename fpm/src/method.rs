//! Method: the ingredients of a solver, chosen at compile time.

use std::fmt::Debug;
use std::marker::PhantomData;

use impactite_scene::{Embedding, FullSpace, PlaneStrain};

use crate::crack::{Criterion, NoCracks};
use crate::flux::{Flux, Incomplete, Penalty, Symmetric};

/// Embedding whose cells do not depend on their position.
#[diagnostic::on_unimplemented(
    message = "cells of the fragile points method do not lie in `{Self}` in {D} dimensions",
    note = "in two dimensions take `PlaneStrain` (for plane stress with a law in `PlaneStress`), in three `FullSpace`"
)]
pub trait Space<const D: usize>: Embedding<D> {}
impl Space<2> for PlaneStrain {}
impl Space<3> for FullSpace {}

/// Ingredients of a fragile points method.
///
/// Invalid combinations do not compile; the error names the reason:
/// ```compile_fail
/// use fpm::Method;
/// use impactite_scene::Axisymmetric;
/// fn check<M: fpm::Composition<2>>(_: M) {}
/// // Hoop stresses act on no face.
/// check(Method::symmetric(Axisymmetric));
/// ```
/// ```
/// use fpm::{MaximumTension, Method};
/// use impactite_scene::PlaneStrain;
/// fn check<M: fpm::Composition<2>>(_: M) {}
/// check(Method::printed(PlaneStrain).with_cracks(MaximumTension::new(1773e6)?));
/// # Ok::<(), impactite_scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Method<E, X, C> {
    penalty: Penalty,
    criterion: C,
    ingredients: PhantomData<(E, X)>,
}

impl<E, X, C> Method<E, X, C> {
    /// Create a method from its ingredients.
    pub fn new(_embedding: E, _flux: X, penalty: Penalty, criterion: C) -> Self {
        Method { penalty, criterion, ingredients: PhantomData }
    }
    /// Replace the penalty.
    #[must_use]
    pub fn with_penalty(self, penalty: Penalty) -> Self {
        Method { penalty, ..self }
    }
    /// Set the opening criterion of faces.
    #[must_use]
    pub fn with_cracks<K>(self, criterion: K) -> Method<E, X, K> {
        Method { penalty: self.penalty, criterion, ingredients: PhantomData }
    }
}

impl<E> Method<E, Incomplete, NoCracks> {
    /// Original formulation \[Shen2022\]: the incomplete flux, with the default penalty.
    pub fn printed(embedding: E) -> Self {
        Method::new(embedding, Incomplete, Penalty::default(), NoCracks)
    }
}

impl<E> Method<E, Symmetric, NoCracks> {
    /// Symmetric flux, with forces that are the derivative of an energy, and the default penalty.
    pub fn symmetric(embedding: E) -> Self {
        Method::new(embedding, Symmetric, Penalty::default(), NoCracks)
    }
}

/// Requirements of a solver on a method; implemented by every valid [`Method`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no fragile points method in {D} dimensions",
    note = "in two dimensions take `PlaneStrain` (for plane stress with a law in `PlaneStress`), in three `FullSpace`"
)]
pub trait Composition<const D: usize>: Copy + Debug + Send + Sync + 'static {
    /// Embedding: plane strain or full space.
    type Embedding: Space<D>;
    /// Numerical flux between cells.
    type Flux: Flux;
    /// Opening criterion of faces.
    type Criterion: Criterion;
    /// Penalty on jumps between cells.
    fn penalty(&self) -> Penalty;
    /// Opening criterion of faces.
    fn criterion(&self) -> &Self::Criterion;
    /// Return the names of the ingredients in one line.
    fn describe(&self) -> String {
        format!(
            "{}, {}, penalty {}, {}",
            Self::Embedding::NAME,
            Self::Flux::NAME,
            self.penalty().eta(),
            self.criterion().name()
        )
    }
}

impl<const D: usize, E, X, C> Composition<D> for Method<E, X, C>
where
    E: Space<D> + Debug,
    X: Flux,
    C: Criterion,
{
    type Embedding = E;
    type Flux = X;
    type Criterion = C;
    fn penalty(&self) -> Penalty {
        self.penalty
    }
    fn criterion(&self) -> &C {
        &self.criterion
    }
}
