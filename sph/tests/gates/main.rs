//! Smoothed particles against closed-form solutions: shocks, plastic waves, bouncing rings.
//!
//! Measurements on several grids, with other methods or in several forms are in `tests/verification` of the workspace: breathing bodies,
//! tubes under pressure, beams, gates A, C, D and G.
#![allow(missing_docs)]

mod impacts;

use impactite_geometry::{Filling, Lattice, Shape, fill};
use sph::Layout;

/// Return particles of a shape at spacing `h`.
pub fn particles<const D: usize>(shape: &impl Shape<D>, h: f64) -> Layout<D> {
    Layout::of_seeds(&fill(shape, &Lattice::new([0.0; D], h).unwrap(), 1, &Filling::new()).unwrap())
}
