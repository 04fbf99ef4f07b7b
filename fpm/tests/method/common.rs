//! Cells and laws of the tests.

use fpm::{Cells, Domain, relaxed, scattered};
use mpm_materials::{IntoMaterial, LinearElastic, Moduli, NeoHookean};

pub const STEEL: f64 = 7850.0;

pub fn moduli(poisson: f64) -> Moduli<f64> {
    Moduli::young_poisson(200e9, poisson).unwrap()
}

pub fn linear(poisson: f64) -> impl IntoMaterial<f64> + Copy {
    LinearElastic::new(STEEL, moduli(poisson)).unwrap()
}

pub fn rubber() -> impl IntoMaterial<f64> + Copy {
    NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap()
}

/// Return Voronoi cells of points on a lattice: squares or cubes.
pub fn lattice<const D: usize>(low: [f64; D], counts: [usize; D], h: f64) -> Cells<D> {
    let high: [f64; D] = std::array::from_fn(|d| low[d] + counts[d] as f64 * h);
    let total = counts.iter().product();
    let point = |mut n: usize| -> [f64; D] {
        std::array::from_fn(|d| {
            let at = n % counts[d];
            n /= counts[d];
            low[d] + (at as f64 + 0.5) * h
        })
    };
    let points: Vec<[f64; D]> = (0..total).map(point).collect();
    Cells::voronoi(&points, &Domain::cuboid(low, high).unwrap()).unwrap()
}

/// Return Voronoi cells of random points at spacing `h`.
pub fn random<const D: usize>(low: [f64; D], high: [f64; D], h: f64, seed: u64) -> Cells<D> {
    let domain = Domain::cuboid(low, high).unwrap();
    let points = relaxed(scattered(&domain, seed, |_| h).unwrap(), &domain, 2).unwrap();
    Cells::voronoi(&points, &domain).unwrap()
}

/// Return numbers in -1..1 from a position.
pub fn noise<const D: usize>(x: [f64; D], seed: f64) -> [f64; D] {
    std::array::from_fn(|d| {
        let sum: f64 = x.iter().enumerate().map(|(k, c)| c * (12.9898 + 65.3 * k as f64)).sum();
        2.0 * ((sum * 1e3 + seed + 7.1 * d as f64).sin() * 43758.5453).rem_euclid(1.0) - 1.0
    })
}
