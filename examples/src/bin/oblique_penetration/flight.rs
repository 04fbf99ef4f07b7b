//! Free flight before impact: cost of the rod's motion through the grid, and state of the resting plate.

use std::hash::{DefaultHasher, Hasher};

use examples::{CaseError, Check, Simulation};
use mpm_core::Mpm;
use mpm_core::observe::{Ledger, Observer, Progress};
use serde::Serialize;

use crate::setup::Setup;

/// Number of samples of the grid during the flight; the first quarter is the reference for the others.
const LOOKS: u32 = 200;
/// Limit of the grid size over its maximum in the first quarter of the flight. The position of an oblique rod relative to blocks of four
/// cells changes continually.
const GROWTH: f64 = 1.1;

/// Result of a free flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flight {
    /// Number of steps.
    pub steps: u64,
    /// Wall-clock time in steps, s.
    pub wall_seconds: f64,
    /// Particle updates, summed over steps.
    pub updates: f64,
    /// Number of particles of the rod, and of both bodies.
    pub particles: [usize; 2],
    /// Largest number of grid nodes in the first quarter of the flight, and later.
    pub nodes: [usize; 2],
    /// Peak memory in the first quarter of the flight, and later, bytes.
    pub bytes: [usize; 2],
    /// Hash of positions, velocities and stresses of all particles at the end of the run: equal for equal bits.
    pub fingerprint: String,
}

/// Fly the rod until it is a quarter of a cell before the plate.
pub fn fly(
    setup: &Setup,
    mpm: &mut Mpm<3>,
    ledger: &mut Ledger,
    bar: &mut Progress,
    simulation: &mut Simulation,
) -> Result<Flight, CaseError> {
    let (mut nodes, mut bytes) = ([0; 2], [0; 2]);
    for look in 1..=LOOKS {
        let end = setup.flight() / setup.speed * f64::from(look) / f64::from(LOOKS);
        let part = if 4 * look <= LOOKS { 0 } else { 1 };
        // Within the last two thicknesses of flight the bodies share blocks, and a deactivated plate is reactivated.
        if f64::from(LOOKS - look) * setup.stand_off > 2.0 * f64::from(LOOKS) {
            let [now, held] =
                simulation.note(|| Ok([mpm.grid().nodes().len() as f64, mpm.bytes() as f64]))?;
            nodes[part] = nodes[part].max(now as usize);
            bytes[part] = bytes[part].max(held as usize);
        }
        let observers: [&mut dyn Observer; 2] = [&mut *ledger, &mut *bar];
        simulation.until(mpm, observers, end)?;
    }
    let summary = simulation.summary();
    Ok(Flight {
        steps: summary.steps,
        wall_seconds: summary.wall_seconds,
        updates: summary.updates,
        particles: [mpm.bodies()[0].len(), mpm.particles()],
        nodes,
        bytes,
        fingerprint: String::new(),
    })
}

/// Hash the state of all particles.
pub fn fingerprint(mpm: &Mpm<3>) -> String {
    let mut hash = DefaultHasher::new();
    for body in mpm.bodies() {
        for p in body.points() {
            for x in p.position.iter().chain(&p.velocity).chain(&p.stress) {
                // Positive and negative zero are equal.
                hash.write_u64((x + 0.0).to_bits());
            }
        }
    }
    format!("{:016x}", hash.finish())
}

impl Flight {
    /// Return the checks of the flight.
    pub fn checks(&self) -> Vec<Check> {
        let [rod, all] = self.particles;
        let made = self.updates / (self.steps as f64 * all as f64);
        let over = |most: [usize; 2]| most[1] as f64 / most[0] as f64;
        let core = format!("the rod has {:.3} of the particles", rod as f64 / all as f64);
        vec![
            Check::unreferenced("flight: particle updates, of those of all particles", made, "-", &core),
            Check::unreferenced("flight: nodes of the grid", self.nodes[1] as f64, "-", "over the whole way"),
            Check::at_most(
                "flight: nodes, over its first quarter",
                over(self.nodes),
                "-",
                GROWTH,
                "no growth",
            ),
            Check::at_most(
                "flight: memory, over its first quarter",
                over(self.bytes),
                "-",
                GROWTH,
                "no growth",
            ),
        ]
    }
}
