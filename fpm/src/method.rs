//! A method: the parts of a solver, chosen at compile time.

use std::fmt::Debug;
use std::marker::PhantomData;

use impactite_scene::{Embedding, FullSpace, PlaneStrain};

use crate::crack::{Criterion, NoCracks};
use crate::flux::{Flux, Incomplete, Penalty, Symmetric};

/// An embedding whose cells are the same at any place.
#[diagnostic::on_unimplemented(
    message = "cells of the fragile points method do not lie in `{Self}` in {D} dimensions",
    note = "in two dimensions take `PlaneStrain` (for plane stress with a law in `PlaneStress`), in three `FullSpace`"
)]
pub trait Space<const D: usize>: Embedding<D> {}
impl Space<2> for PlaneStrain {}
impl Space<3> for FullSpace {}

/// The ingredients of a fragile points method.
///
/// Those that do not go together are refused by the compiler, with the reason:
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
    /// A method from its ingredients.
    pub fn new(_embedding: E, _flux: X, penalty: Penalty, criterion: C) -> Self {
        Method { penalty, criterion, ingredients: PhantomData }
    }
    /// The same with another penalty.
    #[must_use]
    pub fn with_penalty(self, penalty: Penalty) -> Self {
        Method { penalty, ..self }
    }
    /// The same with faces that open.
    #[must_use]
    pub fn with_cracks<K>(self, criterion: K) -> Method<E, X, K> {
        Method { penalty: self.penalty, criterion, ingredients: PhantomData }
    }
}

impl<E> Method<E, Incomplete, NoCracks> {
    /// As printed \[Shen2022\]: the incomplete flux, with the default penalty.
    pub fn printed(embedding: E) -> Self {
        Method::new(embedding, Incomplete, Penalty::default(), NoCracks)
    }
}

impl<E> Method<E, Symmetric, NoCracks> {
    /// With forces that are the derivative of an energy, and the default penalty.
    pub fn symmetric(embedding: E) -> Self {
        Method::new(embedding, Symmetric, Penalty::default(), NoCracks)
    }
}

/// What a solver asks of a method; implemented by every legal [`Method`].
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no fragile points method in {D} dimensions",
    note = "in two dimensions take `PlaneStrain` (for plane stress with a law in `PlaneStress`), in three `FullSpace`"
)]
pub trait Composition<const D: usize>: Copy + Debug + Send + Sync + 'static {
    /// How the problem lies in space.
    type Embedding: Space<D>;
    /// What joins the cells.
    type Flux: Flux;
    /// When faces open.
    type Criterion: Criterion;
    /// What else joins them.
    fn penalty(&self) -> Penalty;
    /// When faces open.
    fn criterion(&self) -> &Self::Criterion;
    /// A line that names the ingredients.
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
