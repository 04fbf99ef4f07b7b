//! Smoothed particles against closed solutions and independent computations: vibrations, shocks, plastic waves, a beam, a ball on a wall.
#![allow(missing_docs)]

mod beams;
mod impacts;
mod vibrations;

use impactite_geometry::{Filling, Lattice, Shape, fill};
use mpm_materials::Moduli;
use sph::Layout;

pub const STEEL: f64 = 7850.0;

pub fn steel() -> Moduli<f64> {
    Moduli::young_poisson(200e9, 0.3).unwrap()
}

/// Particles of a shape, `h` apart, around an axis or not.
pub fn particles<const D: usize>(shape: &impl Shape<D>, h: f64, axisymmetric: bool) -> Layout<D> {
    let filling = if axisymmetric { Filling::new().axisymmetric() } else { Filling::new() };
    Layout::of_seeds(&fill(shape, &Lattice::new([0.0; D], h).unwrap(), 1, &filling).unwrap())
}
