//! Particles as their nodes see them between two steps: what diagnostics sum up, apart from the kernels of the step.

mod folds;
mod of_particles;

pub(in crate::step) use folds::Folds;

/// Weight of a particle on a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeWeight<const D: usize> {
    /// Index of the node on the lattice.
    pub node: [i32; D],
    /// N.
    pub value: f64,
    /// grad N, 1/m; in the reference configuration if the method is total Lagrangian.
    pub gradient: [f64; D],
    /// What components of vectors are multiplied with: -1 where the node stands for its mirror image.
    pub sign: [f64; 3],
}

impl<const D: usize> NodeWeight<D> {
    /// |grad N|, 1/m.
    pub fn steepness(&self) -> f64 {
        self.gradient.iter().map(|g| g * g).sum::<f64>().sqrt()
    }
}

/// A particle as its nodes see it.
#[derive(Clone, Copy, Debug)]
pub struct Footprint<'a, const D: usize> {
    /// Its number in its body.
    pub number: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Velocity, m/s.
    pub velocity: [f64; 3],
    /// Speed of the fastest wave over the cells, m/s: c, or c |F^-1| in the reference configuration.
    pub wave_speed: f64,
    /// Volume times stress, J, whose product with the gradient of a node is the force on the particle: v sigma, or
    /// v sigma F^-T in the reference configuration.
    pub stress: [[f64; 3]; 3],
    /// Force of its stress on its nodes beside that, spread by their weights, N: of hoop stress about an axis.
    pub hoop: [f64; 3],
    /// Force of tractions and force fields on it, spread likewise, N.
    pub load: [f64; 3],
    /// Is it of a rigid body?
    pub rigid: bool,
    /// Its nodes. One may come twice, as itself and as the mirror image of one behind a plane of symmetry.
    pub nodes: &'a [NodeWeight<D>],
}
