//! C: half a period of a cantilever in its lowest mode.

use std::sync::Arc;

use mpm_core::{Boundary, Side};
use mpm_materials::{LinearElastic, Moduli};

use super::Passage;
use super::matter::{Matter, Setup};
use crate::case::Outcome;

const SIZE: [f64; 2] = [0.2, 0.02];
const FREQUENCY: f64 = 3.9210;
/// Velocity amplitude of the end, m/s.
const SMALL: f64 = 2e-4;
/// Search interval of half a period, in periods.
const BETWEEN: [f64; 2] = [0.35, 0.65];
const LOOKS: usize = 60;

/// Euler-Bernoulli first mode, with the rotation of sections.
fn mode([x, y]: [f64; 2]) -> [f64; 2] {
    let (k, s) = (1.875_104_068_7 / SIZE[0], 0.734_095_514_0);
    let (a, y) = (k * x, y - 0.5 * SIZE[1]);
    let bend = a.cosh() - a.cos() - s * (a.sinh() - a.sin());
    let slope = k * (a.sinh() + a.sin() - s * (a.cosh() - a.cos()));
    [-y * slope, bend].map(|c| 0.5 * SMALL * c)
}

pub fn run(passage: Passage) -> Result<Outcome, String> {
    let moduli = Moduli::young_poisson(2e6, 0.3975).map_err(|e| e.to_string())?;
    let law = LinearElastic::new(1000.0, moduli).map_err(|e| e.to_string())?;
    let setup = Setup {
        size: SIZE,
        cells: [(SIZE[0] / SIZE[1]).round() as usize * passage.cells, passage.cells],
        velocity: Arc::new(mode),
        boundaries: vec![Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }],
        load: None,
    };
    let mut beam = Matter::in_plane_strain(passage.way, setup, law)?;
    // Modal amplitude of the displacement.
    let part = |beam: &Matter| -> f64 {
        let one = |shape: [f64; 2], u: [f64; 2]| shape[0] * u[0] + shape[1] * u[1];
        let points = beam.points();
        points.iter().map(|p| p.mass * one(mode(p.rest), [0, 1].map(|d| p.position[d] - p.rest[d]))).sum()
    };
    let mut before: Option<(f64, f64)> = None;
    for look in 0..=LOOKS {
        let share = look as f64 / LOOKS as f64;
        let time = (BETWEEN[0] + share * (BETWEEN[1] - BETWEEN[0])) / FREQUENCY;
        if let Err(failure) = beam.run_until(time) {
            return Ok(Outcome { work: beam.work, failure: Some(failure), ..Outcome::default() });
        }
        let now = (time, part(&beam));
        if let Some((earlier, was)) = before.filter(|(_, was)| *was > 0.0 && now.1 <= 0.0) {
            let half = earlier + (time - earlier) * was / (was - now.1);
            let outcome = Outcome { work: beam.work, ..Outcome::default() };
            return Ok(outcome
                .with("frequency", 0.5 / half / FREQUENCY - 1.0)
                .with("energy", beam.energy_error()));
        }
        before = Some(now);
    }
    let failure = Some("it does not swing back in time".into());
    Ok(Outcome { work: beam.work, failure, ..Outcome::default() })
}
