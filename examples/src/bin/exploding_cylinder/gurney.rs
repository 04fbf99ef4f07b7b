//! Gurney's estimate, with the energy released by the products at a given expansion.
//!
//! The products have a uniform density and a speed proportional to the radius; the case keeps its section and moves with
//! c / r. The available energy is E(V) less the plastic work in the case.

use mpm_materials::{Jwl, JwlConstants};

use crate::setup::{CHARGE, DENSITY, HARDENING, Setup};

/// Energy released by the products at the volume ratio V, J/kg of charge: the integral of p dV from V = 1 along the
/// isentrope p = A exp(-R1 V) + B exp(-R2 V) + C V^-(1 + omega) through e = E0 (burnt at constant volume), over rho0.
pub fn given_off(v: f64) -> f64 {
    let products = Jwl::<f64>::tnt();
    let &JwlConstants { density, a, b, r1, r2, omega, energy } = products.constants();
    let solid = |a: f64, r: f64, v: f64| a * (-r * v).exp();
    // At V = 1: p = A (1 - omega / R1) exp(-R1) + ... + omega E0.
    let c = omega * (energy - solid(a, r1, 1.0) / r1 - solid(b, r2, 1.0) / r2);
    let part = |a: f64, r: f64| (solid(a, r, 1.0) - solid(a, r, v)) / r;
    (part(a, r1) + part(b, r2) + c / omega * (1.0 - v.powf(-omega))) / density
}

/// Plastic work in the case, J/kg of charge, at the volume ratio V of the products: (A eps + B eps^(n + 1) / (n + 1)) over
/// the section, with eps = (2 / sqrt 3) ln(r / R) of material initially at R, r^2 = R^2 + (V - 1) a^2.
pub fn plastic(setup: &Setup, v: f64) -> f64 {
    const RINGS: usize = 200;
    let [a, b, n] = HARDENING;
    let width = setup.case / RINGS as f64;
    let work = |k: usize| {
        let before = CHARGE + (k as f64 + 0.5) * width;
        let now = (before * before + (v - 1.0) * CHARGE * CHARGE).sqrt();
        let strain = 2.0 / 3f64.sqrt() * (now / before).ln();
        (a * strain + b * strain.powf(n + 1.0) / (n + 1.0)) * 2.0 * before * width
    };
    (0..RINGS).map(work).sum::<f64>() / (DENSITY[0] * CHARGE * CHARGE)
}

/// Mean speed of the case by mass, m/s, at the volume ratio V of the products.
pub fn speed(setup: &Setup, v: f64) -> f64 {
    let inner = CHARGE * v.sqrt();
    let outer = (setup.outer().powi(2) + (v - 1.0) * CHARGE * CHARGE).sqrt();
    // With the mean speed u the inner face of the case has the speed u (a + b) / (2 a), and the mean square speed of the case
    // is u^2 (b^2 - a^2) ln(b / a) / (2 (b - a)^2).
    let face = 0.5 * (inner + outer) / inner;
    let square = 0.5 * (outer + inner) / (outer - inner) * (outer / inner).ln();
    let mass = setup.mass_ratio() * square + 0.5 * face * face;
    (2.0 * (given_off(v) - plastic(setup, v)).max(0.0) / mass).sqrt()
}

/// Gurney's formula for a thin case: sqrt(2 E) / sqrt(M/C + 1/2), m/s.
pub fn thin(constant: f64, mass_ratio: f64) -> f64 {
    constant / (mass_ratio + 0.5).sqrt()
}
