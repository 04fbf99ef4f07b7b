//! The way to a plate that is not there yet: what the rod takes on it, and what the plate does.

use std::hash::{DefaultHasher, Hasher};

use examples::{CaseError, Check, Simulation};
use mpm_core::Mpm;
use mpm_core::observe::{Ledger, Observer, Progress};
use serde::Serialize;

use crate::setup::Setup;

/// Looks at the grid on the way; the first quarter of them is what the others are held against.
const LOOKS: u32 = 200;
/// The most that the grid may have of what it had in the first quarter of the way. An oblique rod lies a little differently
/// in the blocks of four cells all the time.
const GROWTH: f64 = 1.1;

/// A flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flight {
    /// Steps made.
    pub steps: u64,
    /// Seconds of stepping.
    pub wall_seconds: f64,
    /// Particles computed, summed over steps.
    pub updates: f64,
    /// Particles of the rod, and of both bodies.
    pub particles: [usize; 2],
    /// Most nodes of the grid in the first quarter of the way, and later.
    pub nodes: [usize; 2],
    /// Most memory, bytes, likewise.
    pub bytes: [usize; 2],
    /// Of the positions, velocities and stresses of all particles at the end of the run: the same for the same bits.
    pub fingerprint: String,
}

/// Let the rod fly until it is a quarter of a cell before the plate.
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
        // In the last two thicknesses of the way the bodies come to share blocks, and a plate at rest wakes.
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

/// Of all particles.
pub fn fingerprint(mpm: &Mpm<3>) -> String {
    let mut hash = DefaultHasher::new();
    for body in mpm.bodies() {
        for p in body.points() {
            for x in p.position.iter().chain(&p.velocity).chain(&p.stress) {
                // Zeros of both signs are one.
                hash.write_u64((x + 0.0).to_bits());
            }
        }
    }
    format!("{:016x}", hash.finish())
}

impl Flight {
    /// What is shown of it, and asked.
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
