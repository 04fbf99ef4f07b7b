//! A method: the parts of a solver, chosen at compile time.

use std::marker::PhantomData;

use impactite_scene::Embedding;

use crate::inheritance::{Inheritance, OverlapWeighted, ParticleMean};
use crate::kinematics::{Configuration, Dilatation, EndOfStep, OfElement, OfParticles, StartOfStep};
use crate::tessellation::{AzimuthFan, LocalDelaunay, Tessellation};

/// The ingredients of a particle-contact method.
///
/// [`Method::printed`] is \[Feng2014\] as it stands, [`Method::consistent`] ours.
#[derive(Clone, Copy, Debug)]
pub struct Method<E, S, I, G, V> {
    tessellation: S,
    ingredients: PhantomData<(E, I, G, V)>,
}

impl<E, S, I, G, V> Method<E, S, I, G, V> {
    /// A method from its ingredients.
    pub fn new(_embedding: E, tessellation: S, _inheritance: I, _configuration: G, _dilatation: V) -> Self {
        Method { tessellation, ingredients: PhantomData }
    }
}

/// The method of [`Method::printed`].
pub type Printed<E> = Method<E, AzimuthFan, ParticleMean, EndOfStep, OfElement>;
/// The method of [`Method::consistent`].
pub type Consistent<E> = Method<E, LocalDelaunay, OverlapWeighted, StartOfStep, OfParticles>;

impl<E> Printed<E> {
    /// As printed.
    pub fn printed(embedding: E, fan: AzimuthFan) -> Self {
        Method::new(embedding, fan, ParticleMean, EndOfStep, OfElement)
    }
}

impl<E> Consistent<E> {
    /// Nothing covered twice, states handed on by overlap, no strain in rotation, no locking.
    pub fn consistent(embedding: E, delaunay: LocalDelaunay) -> Self {
        Method::new(embedding, delaunay, OverlapWeighted, StartOfStep, OfParticles)
    }
}

/// What a solver asks of a method.
pub trait Composition<const D: usize>: Clone + Send + Sync + 'static {
    /// How the problem lies in space.
    type Embedding: Embedding<D>;
    /// How elements are made.
    type Tessellation: Tessellation<D>;
    /// What new elements inherit.
    type Inheritance: Inheritance;
    /// Where the velocity gradient is taken.
    type Configuration: Configuration;
    /// Where the change of volume comes from.
    type Dilatation: Dilatation;
    /// The tessellation.
    fn tessellation(&self) -> &Self::Tessellation;
    /// A line that names the ingredients.
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
