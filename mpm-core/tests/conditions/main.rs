//! Boundary conditions against exact solutions: friction on an incline, waves at absorbing planes, waves and bodies
//! across periodic ones, custom conditions.

mod absorbing;
mod hooks;
mod incline;
mod levels;
mod operator;
mod own;
mod periodic;
mod same_bits;
mod weight;

use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{BlockGrid, Boundary, Mpm, Side, TimeControl};
use mpm_materials::{LinearElastic, Moduli};

/// Name of a method, and constructor of an empty scene with it.
type Made = (&'static str, Box<dyn Fn(Lattice<2>) -> Mpm<2>>);

/// Density, kg/m^3.
const DENSITY: f64 = 1000.0;
/// Young's modulus, Pa.
const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;

fn law() -> LinearElastic<f64> {
    LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, POISSON).expect("moduli")).expect("law")
}
/// Speed of longitudinal waves, m/s.
fn longitudinal() -> f64 {
    (YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)) / DENSITY).sqrt()
}
/// Speed of shear waves, m/s.
fn shear() -> f64 {
    (YOUNG / (2.0 * (1.0 + POISSON)) / DENSITY).sqrt()
}

/// Box with two particles an axis and cell.
fn block<const D: usize>(low: [f64; D], high: [f64; D], h: f64) -> (Lattice<D>, Seeds<D>) {
    let lattice = Lattice::new([0.0; D], h).expect("lattice");
    let seeds = fill(&Cuboid::new(low, high).expect("box"), &lattice, 2, &Filling::new()).expect("seeds");
    (lattice, seeds)
}

/// Return the values of every particle that must be bitwise identical, by number.
fn bits<const D: usize>(mpm: &Mpm<D>) -> Vec<[f64; 9]> {
    let mut points = mpm.bodies()[0].points();
    points.sort_by_key(|p| p.number);
    points
        .iter()
        .map(|p| {
            let mut all = [0.0; 9];
            all[..3].copy_from_slice(&p.velocity);
            all[3..].copy_from_slice(&p.stress);
            all
        })
        .collect()
}
