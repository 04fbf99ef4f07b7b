//! Merging of particles, the counterpart of splitting: where a cell holds too many, two take the place of some.
//!
//! Two particles have just the freedom that it takes to keep everything. A cluster of mass M, centre x_c, velocity v_c,
//! angular momentum L about its centre and kinetic energy K of the motion in it becomes two of mass M/2 at x_c +- d with
//! v_c +- w, with d normal to L and
//!
//! w = L x d / (M d^2) + alpha d / |d|,   alpha^2 = 2 K / M - L^2 / (M d)^2.
//!
//! Then M d x w = L and M w^2 / 2 = K. The second moment of the cluster along d is d^2, or L^2 / (2 K M) if that is more:
//! less has no alpha.

mod merge;

use mpm_materials::{Check, ParameterError};

/// When particles of a body that splits are merged: [`Splitting::with_merging`](crate::step::Splitting::with_merging).
///
/// Every so many steps the particles of a cell that holds more than `above` of its body are taken together, four or three
/// at a time, and two take their place, until no more than `above` are left or none are like enough. To rounding
///
/// - mass, centre of mass, momentum, angular momentum and kinetic energy stay what they were. Motion that particles of a
///   cluster have against each other becomes that of the two, towards each other or apart as the cluster was;
/// - volume and internal energy stay, too: what state the two have is the law's to say
///   ([`Constitutive::merged`](mpm_materials::Constitutive::merged)), which refuses points that are too unlike;
/// - the remembered stretch and a carried box (cpGIMP) grow by what the cluster extends across the line that joins the two,
///   and along that line until the volume is half of the sum.
///
/// A cluster is left alone if the new particles would be longer than four fifths of what is cut, lie outside the box around
/// the old ones, or be lighter than the heaviest of them. All that is left of one ancestor, or of two, goes first, since merging
/// that undoes cuts: numbers and generations come back. Of others two numbers are kept, of those that were cut least, and the
/// rest is never used again. That uses numbers up: a particle that was cut 40 times without taking it back, or as often as single
/// precision counts, is not cut any more.
///
/// A cell is the set of points with one stencil: around a node where that has three nodes an axis.
///
/// The map at the start of the next step is made anew after a merge, so that a step in which something merges takes about
/// half as long again, and the particles' numbers are read one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Merging {
    above: usize,
    every: u64,
}

impl Merging {
    /// Merge in cells that hold more particles than this, every 10 steps unless told.
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

/// What merging did to a body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MergeBook {
    /// Clusters that became two particles.
    pub merges: u64,
    /// Particles fewer than before, in all of them.
    pub removed: u64,
}
