//! Bodies and laws of the tests.

use impactite_geometry::{Cuboid, Filling, Lattice, fill};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli};
use sph::Layout;

pub fn moduli(poisson: f64) -> Moduli<f64> {
    Moduli::young_poisson(200e9, poisson).unwrap()
}

pub fn linear(poisson: f64) -> impl IntoMaterial<f64> + Copy {
    LinearElastic::new(7850.0, moduli(poisson)).unwrap()
}

/// Return a box of particles at spacing `h`.
pub fn block<const D: usize>(low: [f64; D], high: [f64; D], h: f64, axisymmetric: bool) -> Layout<D> {
    let filling = if axisymmetric { Filling::new().axisymmetric() } else { Filling::new() };
    let shape = Cuboid::new(low, high).unwrap();
    Layout::of_seeds(&fill(&shape, &Lattice::new(low, h).unwrap(), 1, &filling).unwrap())
}

/// Return numbers in -1..1 from a position.
pub fn noise<const D: usize>(x: [f64; D], seed: f64) -> [f64; D] {
    std::array::from_fn(|d| {
        let sum: f64 = x.iter().enumerate().map(|(k, c)| c * (12.9898 + 65.3 * k as f64)).sum();
        2.0 * ((sum * 1e3 + seed + 7.1 * d as f64).sin() * 43758.5453).rem_euclid(1.0) - 1.0
    })
}
