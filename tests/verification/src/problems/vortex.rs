//! V4: the generalised vortex (Kamojjala, Brannon et al. 2015).
//!
//! In a square of 3 m, otherwise at rest, the annulus 0.75 < R < 1.25 m rotates by alpha = g(t) H(R), H = 1 - 32 (R -
//! 1)^2 + 256 (R - 1)^4, g = A sin(pi c t), at constant volume and with shears up to 7. In the co-rotating polar
//! frame, `b_r = -R (g' H)^2 + (G / rho) R (g H')^2` and `b_theta = R g'' H - (G / rho) g (R H'' + 3 H')`. E 1000 Pa,
//! nu 0.3, rho 1000 kg/m^3, A 1. The run ends at t = 1 s; measured is the largest error of 20 samples, over the
//! largest displacement 2 sin(1/2) m.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::case::{Case, Outcome};
use crate::formulation::Formulation;
use crate::problems::{lattice, rubber};
use crate::scene::{Norm, Scene, block, worse};

const SHEAR: f64 = 1000.0 / 2.6;
const DENSITY: f64 = 1000.0;

/// Radial profile and derivatives: H, R H', R H'' + 3 H'.
fn profile(r: f64) -> (f64, f64, f64) {
    if !(0.75..=1.25).contains(&r) {
        return (0.0, 0.0, 0.0);
    }
    let s = (r - 1.0) * (r - 1.0);
    let slope = 64.0 * (r - 1.0) * (4.0 * r - 5.0) * (4.0 * r - 3.0);
    let bend = 64.0 * (96.0 * r * r * r - 240.0 * r * r + 188.0 * r - 45.0);
    (1.0 - 32.0 * s + 256.0 * s * s, r * slope, bend)
}

/// Time history and derivatives: g, g', g''.
fn swing(t: f64) -> (f64, f64, f64) {
    let (sin, cos) = (PI * t).sin_cos();
    (sin, PI * cos, -PI * PI * sin)
}

/// Exact position and velocity of a particle with initial position `x`.
fn motion(x: &[f64; 2], t: f64) -> ([f64; 2], [f64; 2]) {
    let r = x[0].hypot(x[1]);
    let (h, ..) = profile(r);
    let (g, rate, _) = swing(t);
    let (sin, cos) = (x[1].atan2(x[0]) + g * h).sin_cos();
    let speed = r * rate * h;
    ([r * cos, r * sin], [-speed * sin, speed * cos])
}

fn force(x: &[f64; 2], t: f64) -> [f64; 2] {
    let r = x[0].hypot(x[1]);
    let (h, slope, bend) = profile(r);
    let (g, rate, second) = swing(t);
    let (sin, cos) = (x[1].atan2(x[0]) + g * h).sin_cos();
    // Identity: R (g H')^2 = (g R H')^2 / R.
    let outward = -r * (rate * h).powi(2) + SHEAR / DENSITY * (g * slope).powi(2) / r;
    let around = r * second * h - SHEAR / DENSITY * g * bend;
    [outward * cos - around * sin, outward * sin + around * cos]
}

/// Run V4; `cells` is the number of cells across the square.
pub(crate) fn run<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let h = 3.0 / case.cells as f64;
    let lattice = lattice([-1.5; 2], h)?;
    let steps = (1.0 / (case.courant * h)).ceil() as u64;
    let dt = 1.0 / steps as f64;
    let scene = Scene {
        lattice,
        seeds: block(&lattice, [0; 2], [case.cells; 2], case.per_axis),
        law: rubber(DENSITY, 1000.0, 0.3)?,
        velocity: Box::new(move |x| motion(&x, -0.5 * dt).1),
        field: Some(Arc::new(force)),
        boundaries: Vec::new(),
        dt,
        steps,
        every: (steps / 20).max(1),
    };
    let (mut mean, mut largest) = (0.0, 0.0);
    let full = 2.0 * 0.5f64.sin();
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        let mut of_u = Norm::default();
        moment.for_each(&mut |p| {
            let (x, _) = motion(&moment.starts[p.number], moment.time);
            of_u.add(p.mass, &[(p.position[0] - x[0]) / full, (p.position[1] - x[1]) / full]);
        });
        mean = worse(mean, of_u.l2());
        largest = worse(largest, of_u.largest());
    });
    Ok(outcome.with("u", mean).with("u largest", largest))
}
