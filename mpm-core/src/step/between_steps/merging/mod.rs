//! Merging of particles, the counterpart of splitting: where a cell contains too many, two replace several.
//!
//! Two particles have just enough freedom to conserve all quantities. A cluster of mass M, centre x_c, velocity v_c,
//! angular momentum L about its centre and kinetic energy K of the relative motion is replaced by two of mass M/2 at
//! x_c +- d with v_c +- w, with d normal to L and
//!
//! w = L x d / (M d^2) + alpha d / |d|,   alpha^2 = 2 K / M - L^2 / (M d)^2.
//!
//! Then M d x w = L and M w^2 / 2 = K. d^2 is the second moment of the cluster along d, or L^2 / (2 K M) if that is
//! larger: a smaller one has no real alpha.

mod merge;

use mpm_materials::{Check, ParameterError};

/// Criterion of particle merging in a body with splitting: [`Splitting::with_merging`](crate::step::Splitting::with_merging).
///
/// Every so many steps the particles of a cell that contains more than `above` of its body are merged, four or three
/// into two, until no more than `above` remain or none are similar enough. To rounding
///
/// - mass, centre of mass, momentum, angular momentum and kinetic energy are conserved. The relative motion within a
///   cluster becomes that of the two, towards each other or apart as in the cluster;
/// - volume and internal energy are conserved, too: the law determines the state of the two
///   ([`Constitutive::merged`](mpm_materials::Constitutive::merged)), and refuses points that differ too much;
/// - the stored stretch and a carried box (cpGIMP) grow by the extent of the cluster across the line that joins the
///   two, and along that line until the volume is half of the sum.
///
/// A cluster is not merged if the new particles would be longer than four fifths of the length at which particles are
/// cut, would be outside the bounding box of the old ones, or would be lighter than the heaviest of them. All
/// remaining descendants of one ancestor, or of two, are merged first, since that reverses cuts: numbers and
/// generations become available again. Other clusters keep two numbers, of the ancestors with the fewest cuts, and
/// the remaining numbers are never used again. Numbers can thus be exhausted: a particle with 40 cuts that were not
/// reversed, or as many as single precision can count, is not cut any more.
///
/// A cell is the set of points with one stencil: it is around a node for stencils of three nodes an axis.
///
/// After a merge the map at the start of the next step is repeated, so that a step with merging takes about half as
/// long again, and the values of particles are read one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Merging {
    above: usize,
    every: u64,
}

impl Merging {
    /// Merge in cells with more particles than this, by default every 10 steps.
    ///
    /// # Errors
    /// Less than 2.
    pub fn above(particles: usize) -> Result<Self, ParameterError> {
        Check("merging").that(particles >= 2, "particles a cell", particles as f64, "at least 2")?;
        Ok(Merging { above: particles, every: 10 })
    }

    /// Merge every so many steps.
    ///
    /// # Errors
    /// Zero.
    pub fn every(self, steps: u64) -> Result<Self, ParameterError> {
        Check("merging").that(steps > 0, "steps", steps as f64, "at least 1")?;
        Ok(Merging { every: steps, ..self })
    }
}

/// Book of the merging in a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MergeBook {
    /// Number of clusters that were replaced by two particles.
    pub merges: u64,
    /// Number of particles removed in all of them.
    pub removed: u64,
}
