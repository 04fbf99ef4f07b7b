//! Method: the ingredients of a solver, chosen at compile time.

use std::marker::PhantomData;

use impactite_scene::Embedding;

use crate::inheritance::{Inheritance, OverlapWeighted, ParticleMean};
use crate::kinematics::{Configuration, Dilatation, EndOfStep, OfElement, OfParticles, StartOfStep};
use crate::tessellation::{AzimuthFan, LocalDelaunay, Tessellation};

/// Ingredients of a particle-contact method.
///
/// [`Method::printed`] is the original formulation \[Feng2014\], [`Method::consistent`] that of this crate.
#[derive(Clone, Copy, Debug)]
pub struct Method<E, S, I, G, V> {
    tessellation: S,
    ingredients: PhantomData<(E, I, G, V)>,
}

impl<E, S, I, G, V> Method<E, S, I, G, V> {
    /// Create a method from its ingredients.
    pub fn new(_embedding: E, tessellation: S, _inheritance: I, _configuration: G, _dilatation: V) -> Self {
        Method { tessellation, ingredients: PhantomData }
    }
}

/// The method of [`Method::printed`].
pub type Printed<E> = Method<E, AzimuthFan, ParticleMean, EndOfStep, OfElement>;
/// The method of [`Method::consistent`].
pub type Consistent<E> = Method<E, LocalDelaunay, OverlapWeighted, StartOfStep, OfParticles>;

impl<E> Printed<E> {
    /// Original formulation \[Feng2014\].
    pub fn printed(embedding: E, fan: AzimuthFan) -> Self {
        Method::new(embedding, fan, ParticleMean, EndOfStep, OfElement)
    }
}

impl<E> Consistent<E> {
    /// Consistent formulation: single coverage, inheritance by overlap, no strain in rotations, no volumetric locking.
    pub fn consistent(embedding: E, delaunay: LocalDelaunay) -> Self {
        Method::new(embedding, delaunay, OverlapWeighted, StartOfStep, OfParticles)
    }
}

/// Requirements of a solver on a method.
pub trait Composition<const D: usize>: Clone + Send + Sync + 'static {
    /// Embedding: plane strain, axisymmetric or full space.
    type Embedding: Embedding<D>;
    /// Tessellation: creation and deletion of elements.
    type Tessellation: Tessellation<D>;
    /// Inheritance of states by new elements.
    type Inheritance: Inheritance;
    /// Configuration of the velocity gradient.
    type Configuration: Configuration;
    /// Source of the volume change.
    type Dilatation: Dilatation;
    /// The tessellation.
    fn tessellation(&self) -> &Self::Tessellation;
    /// Return the names of the ingredients in one line.
    fn describe(&self) -> String {
        format!(
            "{}, {}, {}, {}, {}",
            Self::Embedding::NAME,
            Self::Tessellation::NAME,
            Self::Inheritance::NAME,
            Self::Configuration::NAME,
            Self::Dilatation::NAME
        )
    }
}

impl<const D: usize, E, S, I, G, V> Composition<D> for Method<E, S, I, G, V>
where
    E: Embedding<D>,
    S: Tessellation<D>,
    I: Inheritance,
    G: Configuration,
    V: Dilatation,
{
    type Embedding = E;
    type Tessellation = S;
    type Inheritance = I;
    type Configuration = G;
    type Dilatation = V;
    fn tessellation(&self) -> &S {
        &self.tessellation
    }
}
