//! Footprints of particles: contributions to their nodes between two steps, for diagnostics, independent of the kernels of
//! the step.

mod folds;
mod of_particles;

pub(in crate::step) use folds::Folds;

/// Weight of a particle on a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeWeight<const D: usize> {
    /// Lattice index of the node.
    pub node: [i32; D],
    /// Weight N.
    pub value: f64,
    /// Gradient grad N, 1/m; in the reference configuration if the method is total Lagrangian.
    pub gradient: [f64; D],
    /// Factors of vector components: -1 if the node represents its mirror image.
    pub sign: [f64; 3],
}

impl<const D: usize> NodeWeight<D> {
    /// Norm of the gradient, |grad N|, 1/m.
    pub fn steepness(&self) -> f64 {
        self.gradient.iter().map(|g| g * g).sum::<f64>().sqrt()
    }
}

/// Contributions of a particle to its nodes.
#[derive(Clone, Copy, Debug)]
pub struct Footprint<'a, const D: usize> {
    /// Index of the body.
    pub body: usize,
    /// Number of the particle in its body.
    pub number: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Volume, m^3 (per metre of depth or radian), of the configuration of the gradients.
    pub volume: f64,
    /// Position in the configuration of the gradients, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Largest wave speed over the cells, m/s: c, or c |F^-1| in the reference configuration.
    pub wave_speed: f64,
    /// Volume times stress, J: v sigma, or v sigma F^-T in the reference configuration. Its product with the gradient of a
    /// node is the force on the particle.
    pub stress: [[f64; 3]; 3],
    /// Additional force of hoop stress about an axis on the nodes, distributed by weights, N.
    pub hoop: [f64; 3],
    /// Force of tractions and force fields on the particle, distributed by weights, N.
    pub load: [f64; 3],
    /// True for a particle of a rigid body.
    pub rigid: bool,
    /// Nodes of the particle. A node may occur twice, as itself and as the mirror image of one behind a symmetry plane.
    pub nodes: &'a [NodeWeight<D>],
}
