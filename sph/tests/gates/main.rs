//! Smoothed particles against closed solutions: shocks, plastic waves, rings that bounce.
//!
//! What is measured on several grids, beside other methods or by several forms, is in `tests/verification` of the workspace: bodies that breathe,
//! tubes under pressure, beams, gates A, C, D and G.
#![allow(missing_docs)]

mod impacts;

use impactite_geometry::{Filling, Lattice, Shape, fill};
use sph::Layout;

/// Particles of a shape, `h` apart.
pub fn particles<const D: usize>(shape: &impl Shape<D>, h: f64) -> Layout<D> {
    Layout::of_seeds(&fill(shape, &Lattice::new([0.0; D], h).unwrap(), 1, &Filling::new()).unwrap())
}
