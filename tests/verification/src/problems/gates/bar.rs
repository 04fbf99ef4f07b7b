//! A: bar on a rigid wall, between symmetry planes.

use mpm_materials::{LinearElastic, Moduli};

use super::Passage;
use super::matter::{Matter, Point, Setup};
use crate::case::Outcome;

const LENGTH: f64 = 0.2;
const SPEED: f64 = 10.0;
const YOUNG: f64 = 200e9;
const DENSITY: f64 = 7850.0;
/// Number of cells across.
const ACROSS: usize = 2;
/// Sample times of the velocity, in wave transit times: the third front, that of release, is present from 2 on.
const LOOKS: [f64; 7] = [0.25, 0.5, 0.75, 1.25, 1.5, 1.75, 2.5];

/// Exact velocity at the position `x`, m, along the bar after `time` transits, m/s (d'Alembert).
fn exact(x: f64, time: f64) -> f64 {
    let from_wall = time * LENGTH;
    match time {
        t if t <= 1.0 => -if x < from_wall { 0.0 } else { SPEED },
        t if t <= 2.0 => {
            if x < 2.0 * LENGTH - from_wall {
                0.0
            } else {
                SPEED
            }
        }
        _ => SPEED,
    }
}

pub fn run(passage: Passage) -> Result<Outcome, String> {
    let law = LinearElastic::new(DENSITY, Moduli::young_poisson(YOUNG, 0.0).map_err(|e| e.to_string())?);
    let setup = Setup::on_a_wall(LENGTH, [passage.cells, ACROSS], SPEED);
    let mut bar = Matter::in_plane_strain(passage.way, setup, law.map_err(|e| e.to_string())?)?;
    let transit = LENGTH * (DENSITY / YOUNG).sqrt();
    let mut worst = 0.0;
    for time in LOOKS {
        if let Err(failure) = bar.run_until(time * transit) {
            return Ok(Outcome { work: bar.work, failure: Some(failure), ..Outcome::default() });
        }
        let points = bar.points();
        let mass: f64 = points.iter().map(|p| p.mass).sum();
        let off = |p: &Point| p.mass * (p.velocity[0] - exact(p.rest[0], time)).abs();
        worst += points.iter().map(off).sum::<f64>() / mass / SPEED / LOOKS.len() as f64;
    }
    let points = bar.points();
    let sum = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>();
    let mass = sum(&|p| p.mass);
    let rebound = sum(&|p| p.mass * p.velocity[0]) / mass / SPEED;
    let outcome = Outcome { work: bar.work, ..Outcome::default() };
    Ok(outcome
        .with("velocity", worst)
        .with("rebound", rebound - 1.0)
        .with("residual energy", 1.0 - rebound * rebound)
        .with("energy", bar.energy_error()))
}
