//! Bodies of a scene, conditions and contact.

use std::sync::Arc;

use super::bodies::body::GridBody;
use super::contact::ContactAlgorithm;
use super::nodes::constraints::Conditions;
use impactite_simd::Float;

/// Bodies, conditions and the contact algorithm.
pub(super) struct Scene<T: Float, const D: usize> {
    pub(super) bodies: Vec<Box<dyn GridBody<T, D>>>,
    pub(super) conditions: Conditions<D>,
    pub(super) contact: Arc<dyn ContactAlgorithm<T, D>>,
    /// Indices of the rigid bodies.
    pub(super) rigid: Vec<usize>,
    /// Indices of the bodies of another discretisation.
    pub(super) clients: Vec<usize>,
    /// Bodies whose matter may convert to particles, each with the body that receives them.
    pub(super) growing: Vec<(usize, usize)>,
}

impl<T: Float, const D: usize> Scene<T, D> {
    /// Create an empty scene.
    pub(super) fn new(contact: Arc<dyn ContactAlgorithm<T, D>>) -> Self {
        let conditions = Conditions::default();
        let (bodies, rigid, clients, growing) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Scene { bodies, conditions, contact, rigid, clients, growing }
    }
    /// Mass of the lightest particle, kg.
    pub(super) fn lightest(&self) -> T {
        self.bodies.iter().map(|b| b.lightest()).fold(T::of(f64::MAX), |a, b| a.min(b))
    }
}
