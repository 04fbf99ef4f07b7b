//! V14: confined column under its own weight, with nominal stress -rho0 g (L - X) for any law.
//!
//! Without lateral strain the Cauchy stress along the column equals the nominal stress. E 1e4 Pa, nu 0, rho0 80
//! kg/m^3, L 50 m as in AMPLE, but g = 2.5 m/s^2: at g = 10 m/s^2 the neo-Hookean law would be compressed to 0.12
//! at the foot, with 2.5 m/s^2 to 0.41. The weight is ramped up smoothly over ten periods 4 L / c. The stress is
//! averaged over the last of two more periods, so that oscillations cancel. Error: sum |s - s_a| V0 / (rho0 g L sum
//! V0).

use std::f64::consts::PI;
use std::sync::Arc;

use mpm_core::{Boundary, Side};

use crate::case::{Case, Outcome};
use crate::formulation::Formulation;
use crate::problems::{box_of_planes, lattice, rubber};
use crate::scene::{Scene, block};

const LENGTH: f64 = 50.0;
const DENSITY: f64 = 80.0;
const WEIGHT: f64 = 2.5;
const YOUNG: f64 = 1e4;

/// Run V14; `cells` is the number of cells of the column.
pub(crate) fn run<S: Formulation>(case: &Case<S>) -> Result<Outcome, String> {
    let h = LENGTH / case.cells as f64;
    let lattice = lattice([0.0; 2], h)?;
    let c = (YOUNG / DENSITY).sqrt();
    let dt = case.courant * h / c;
    let period = 4.0 * LENGTH / c;
    let steps = (12.0 * period / dt).round() as u64;
    let ramp = 10.0 * period;
    let across = case.scheme.across();
    let mut boundaries = box_of_planes(0..1, 0.0, across as f64 * h);
    boundaries.push(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above });
    let every = (period / dt / 40.0).ceil() as u64;
    let scene = Scene {
        lattice,
        seeds: block(&lattice, [0; 2], [across, case.cells], case.per_axis),
        law: rubber(DENSITY, YOUNG, 0.0)?,
        velocity: Box::new(|_| [0.0; 2]),
        field: Some(Arc::new(move |_: &[f64; 2], t: f64| {
            let part = (t / ramp).min(1.0);
            [0.0, -WEIGHT * (part - (2.0 * PI * part).sin() / (2.0 * PI))]
        })),
        boundaries,
        dt,
        steps,
        every,
    };
    let mut sums = vec![0.0; scene.seeds.positions.len()];
    let mut looks = 0.0;
    let outcome = case.scheme.plane(&scene, &mut |moment| {
        if moment.time > 11.0 * period {
            looks += 1.0;
            moment.for_each(&mut |p| sums[p.number] += p.stress[1]);
        }
    });
    let full = DENSITY * WEIGHT * LENGTH;
    let error: f64 = sums
        .iter()
        .zip(&scene.seeds.positions)
        .map(|(sum, x)| (sum / looks + DENSITY * WEIGHT * (LENGTH - x[1])).abs() / full)
        .sum();
    Ok(outcome.with("stress", error / sums.len() as f64))
}
