//! Plate pulled at its end: one-dimensional waves (case 2.1 of \[Shen2022\]) against the exact solution.

use std::f64::consts::PI;
use std::sync::Arc;

use mpm_core::{Boundary, Side};
use mpm_materials::{LinearElastic, Moduli};

use super::Passage;
use super::matter::{Matter, Setup};
use crate::case::Outcome;
use crate::work::Work;

const LENGTH: f64 = 4.0;
/// Number of cells across.
const ACROSS: usize = 3;
const YOUNG: f64 = 8e4;
const DENSITY: f64 = 1.0;
/// Traction amplitude, Pa, for small strains.
const PULL: f64 = 1e-3;
/// Duration of the pull, s: three quarters of the return travel time of a wave.
const DURATION: f64 = 0.0212;
/// End time of the run, s: eight and a half wave transits of the plate.
const END: f64 = 0.12;
const LOOKS: usize = 40;

/// Traction history.
#[derive(Clone, Copy)]
enum Pull {
    /// Half a sine: its rate jumps at start and end, and errors converge with the power 5/3 of the spacing at best.
    HalfSine,
    /// Sine squared: smooth.
    Squared,
}

impl Pull {
    /// Traction, Pa.
    fn at(self, t: f64) -> f64 {
        let sine = if (0.0..DURATION).contains(&t) { (PI * t / DURATION).sin() } else { 0.0 };
        PULL * match self {
            Pull::HalfSine => sine,
            Pull::Squared => sine * sine,
        }
    }

    /// Time integral of the traction, Pa s.
    fn sum(self, t: f64) -> f64 {
        let t = t.clamp(0.0, DURATION);
        PULL * match self {
            Pull::HalfSine => DURATION / PI * (1.0 - (PI * t / DURATION).cos()),
            Pull::Squared => 0.5 * t - 0.25 * DURATION / PI * (2.0 * PI * t / DURATION).sin(),
        }
    }
}

/// Exact displacement, m: images of the pull beyond both ends, of alternating sign.
fn exact(pull: Pull, x: f64, t: f64) -> f64 {
    let c = (YOUNG / DENSITY).sqrt();
    let ends = (0..).map(|n| (n, (2.0 * f64::from(n) + 1.0) * LENGTH));
    let there = ends.take_while(|(_, far)| far - LENGTH <= c * t);
    let waves = there.map(|(n, far)| {
        let both = pull.sum(t - (far - x) / c) - pull.sum(t - (far + x) / c);
        if n % 2 == 0 { both } else { -both }
    });
    waves.sum::<f64>() / (DENSITY * c)
}

/// Relative root mean square error of the displacement.
fn one(passage: Passage, pull: Pull) -> Result<(f64, f64, Work), String> {
    let moduli = Moduli::young_poisson(YOUNG, 0.0).map_err(|e| e.to_string())?;
    let law = LinearElastic::new(DENSITY, moduli).map_err(|e| e.to_string())?;
    let setup = Setup {
        size: [LENGTH, ACROSS as f64 * LENGTH / passage.cells as f64],
        cells: [passage.cells, ACROSS],
        velocity: Arc::new(|_| [0.0; 2]),
        boundaries: vec![Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }],
        load: Some(Arc::new(move |t| [pull.at(t), 0.0])),
    };
    let mut plate = Matter::in_plane_strain(passage.way, setup, law)?;
    let (mut wrong, mut all) = (0.0, 0.0);
    for look in 1..=LOOKS {
        let time = END * look as f64 / LOOKS as f64;
        plate.run_until(time)?;
        for point in plate.points() {
            let u = exact(pull, point.rest[0], time);
            wrong += point.mass * (point.position[0] - point.rest[0] - u).powi(2);
            all += point.mass * u * u;
        }
    }
    Ok(((wrong / all).sqrt(), plate.energy_error(), plate.work))
}

/// Run both tractions.
pub fn run(passage: Passage) -> Result<Outcome, String> {
    let (smooth, energy, work) = one(passage, Pull::Squared)?;
    let (half, _, more) = one(passage, Pull::HalfSine)?;
    let outcome = Outcome { work: work.and(&more), ..Outcome::default() };
    Ok(outcome.with("smooth", smooth).with("half sine", half).with("energy", energy))
}
