//! D: impact of copper plates without strength, one half: a bar between symmetry planes on a rigid wall.
//!
//! A shock runs into material of velocity u and stops it: U = c0 + s u, p = rho0 U u, rho = rho0 U / (U - u), and the specific energy u^2
//! / 2. Means exclude wall heating of the first particles and the front.

use mpm_materials::{Fluid, MieGruneisen};

use super::Passage;
use super::matter::{Matter, Setup};
use crate::case::Outcome;

const LENGTH: f64 = 0.1;
/// Number of cells across.
const ACROSS: usize = 2;
const DENSITY: f64 = 8930.0;
const SOUND: f64 = 3940.0;
const SLOPE: f64 = 1.49;
const GRUNEISEN: f64 = 2.0;
/// Half of the closing speed, m/s.
const SPEED: f64 = 250.0;
/// Bulk viscosity coefficients, linear and quadratic.
const VISCOSITY: [f64; 2] = [0.3, 1.5];
/// Fraction of the plate that the shock has passed at the two samples.
const PASSED: [f64; 2] = [0.4, 0.7];
/// Averaging range behind the shock at the last sample, as fractions of the shocked length.
const BEHIND: [f64; 2] = [0.2, 0.7];

/// Shock speed in the material, m/s.
const SHOCK: f64 = SOUND + SLOPE * SPEED;
const PRESSURE: f64 = DENSITY * SHOCK * SPEED;
/// Density behind the shock, kg/m^3.
const DENSE: f64 = DENSITY * SHOCK / (SHOCK - SPEED);
/// Specific internal energy behind the shock, J/kg.
const ENERGY: f64 = 0.5 * SPEED * SPEED;

/// Sampled state of a point.
struct Seen {
    x: f64,
    volume: f64,
    pressure: f64,
    density: f64,
    /// Specific internal energy, J/kg.
    energy: f64,
}

fn look(plate: &mut Matter) -> Result<Vec<Seen>, String> {
    let energy = plate.place_of("energy").ok_or("the law keeps no energy")?;
    let mut seen = Vec::new();
    plate.visit(&mut |p| {
        seen.push(Seen {
            x: p.position[0],
            volume: p.volume,
            pressure: p.pressure(),
            density: p.mass / p.volume,
            energy: p.state[energy] / DENSITY,
        });
    });
    Ok(seen)
}

/// Points in the averaging range behind a front at `front` m.
fn behind(seen: &[Seen], front: f64) -> impl Iterator<Item = &Seen> + Clone {
    seen.iter().filter(move |s| (BEHIND[0] * front..BEHIND[1] * front).contains(&s.x))
}

fn mean<'a>(points: impl Iterator<Item = &'a Seen> + Clone, of: fn(&Seen) -> f64) -> f64 {
    points.clone().map(|s| s.volume * of(s)).sum::<f64>() / points.map(|s| s.volume).sum::<f64>()
}

pub fn run(passage: Passage) -> Result<Outcome, String> {
    let eos = MieGruneisen::new(DENSITY, SOUND, SLOPE, GRUNEISEN).map_err(|e| e.to_string())?;
    let [linear, quadratic] = VISCOSITY;
    let law = Fluid::new(eos).with_bulk_viscosity(linear, quadratic).map_err(|e| e.to_string())?;
    let setup = Setup::on_a_wall(LENGTH, [passage.cells, ACROSS], SPEED);
    let across = setup.size[1];
    let mut plate = Matter::in_plane_strain(passage.way, setup, law)?;
    let times = PASSED.map(|part| part * LENGTH / SHOCK);
    let mut fronts = [0.0; 2];
    let mut seen = Vec::new();
    for (front, time) in fronts.iter_mut().zip(times) {
        if let Err(failure) = plate.run_until(time) {
            return Ok(Outcome { work: plate.work, failure: Some(failure), ..Outcome::default() });
        }
        seen = look(&mut plate)?;
        // Front position: length at which the mean pressure behind the front gives the pressure integral.
        let pressure = mean(behind(&seen, (SHOCK - SPEED) * time), |s| s.pressure);
        *front = seen.iter().map(|s| s.volume * s.pressure).sum::<f64>() / across / pressure;
    }
    // Shock speed relative to the material, which moves at the impact speed.
    let shock = (fronts[1] - fronts[0]) / (times[1] - times[0]) + SPEED;
    let exact = (SHOCK - SPEED) * times[1];
    let behind = || behind(&seen, exact);
    let off = |s: &Seen| s.volume * (s.pressure - if s.x < exact { PRESSURE } else { 0.0 }).abs();
    let profile = seen.iter().map(off).sum::<f64>() / across / LENGTH / PRESSURE;
    let outcome = Outcome { work: plate.work, ..Outcome::default() };
    Ok(outcome
        .with("profile", profile)
        .with("pressure", mean(behind(), |s| s.pressure) / PRESSURE - 1.0)
        .with("density", mean(behind(), |s| s.density) / DENSE - 1.0)
        .with("specific energy", mean(behind(), |s| s.energy) / ENERGY - 1.0)
        .with("shock", shock / SHOCK - 1.0)
        .with("energy", plate.energy_error()))
}
