//! What contact of bodies reports, whatever its method.

use crate::archive::{Archive, CheckpointError};

/// A place where two bodies act on each other: a node of a grid, a pair of particles, a particle at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Position, m.
    pub position: [f64; 3],
    /// The bodies, by number; the smaller first.
    pub bodies: [usize; 2],
    /// Unit normal, from the first body to the second.
    pub normal: [f64; 3],
    /// Distance of the surfaces along it, m, where the detector measures it; negative if they overlap.
    pub gap: Option<f64>,
    /// Impulse on the second body, N s; the first gets its opposite.
    pub impulse: [f64; 3],
}

/// A pair of bodies in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The bodies, by number; the smaller first.
    pub bodies: [usize; 2],
    /// Contact force on the second body, N, mean of the step; the first feels its opposite.
    pub force: [f64; 3],
    /// Places in contact: nodes, or pairs of particles.
    pub places: usize,
    /// Smallest distance of the surfaces there, m, where the detector measures it.
    pub gap: Option<f64>,
    /// Energy dissipated by friction since the start, J.
    pub friction: f64,
    /// Kinetic energy of what collides taken beside that since the start, J. Of nodes it holds what forces gave them in each step
    /// and contact took back, and is no measure of what an impact loses: that is in the totals of the bodies.
    pub taken: f64,
}

impl PairContact {
    /// A pair that did nothing yet.
    #[must_use]
    pub fn new(bodies: [usize; 2]) -> Self {
        PairContact { bodies, force: [0.0; 3], places: 0, gap: None, friction: 0.0, taken: 0.0 }
    }

    /// To a file, or from one.
    ///
    /// # Errors
    /// The file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let PairContact { bodies, force, places, gap, friction, taken } = self;
        bodies.iter_mut().try_for_each(|b| file.count(b))?;
        file.reals(force)?;
        file.count(places)?;
        file.option(gap, Archive::real)?;
        file.reals([friction, taken])
    }
}
