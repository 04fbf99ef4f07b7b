//! Contact results of bodies, for any method.

use crate::archive::{Archive, CheckpointError};

/// Contact point of two bodies: a grid node, a pair of particles, a particle at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Position, m.
    pub position: [f64; 3],
    /// Numbers of the bodies; the smaller first.
    pub bodies: [usize; 2],
    /// Unit normal, from the first body to the second.
    pub normal: [f64; 3],
    /// Gap along the normal, m, if the detector measures it; negative for penetration.
    pub gap: Option<f64>,
    /// Impulse on the second body, N s; that on the first is opposite.
    pub impulse: [f64; 3],
}

/// Contact of a pair of bodies in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// Numbers of the bodies; the smaller first.
    pub bodies: [usize; 2],
    /// Contact force on the second body, N, mean of the step; that on the first is opposite.
    pub force: [f64; 3],
    /// Number of contact points: nodes, or pairs of particles.
    pub places: usize,
    /// Smallest gap at the contact points, m, if the detector measures it.
    pub gap: Option<f64>,
    /// Energy dissipated by friction since the start, J.
    pub friction: f64,
    /// Kinetic energy removed by contact beside friction since the start, J. At grid nodes it includes the energy that forces add in each
    /// step and contact removes, so it does not measure the loss of an impact: see the totals of the bodies.
    pub taken: f64,
}

impl PairContact {
    /// Create a pair without contact so far.
    #[must_use]
    pub fn new(bodies: [usize; 2]) -> Self {
        PairContact { bodies, force: [0.0; 3], places: 0, gap: None, friction: 0.0, taken: 0.0 }
    }

    /// Write or read the pair.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let PairContact { bodies, force, places, gap, friction, taken } = self;
        bodies.iter_mut().try_for_each(|b| file.count(b))?;
        file.reals(force)?;
        file.count(places)?;
        file.option(gap, Archive::real)?;
        file.reals([friction, taken])
    }
}
