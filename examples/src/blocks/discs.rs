//! Two elastic discs (Sulsky, Chen, Schreyer 1994), V10.

use std::path::Path;

use mpm_core::geometry::Lattice;
use mpm_core::output::Snapshot;
use mpm_core::{Archive, BlockGrid, CheckpointError, IntoKernels, Mpm, Solver};

use crate::blocks::circles::{Part, disc};
use crate::blocks::scene::{Seen, Task, Watch, rubber, run, velocity, wave};
use crate::{CaseError, Detection, Law, Totals};

/// Radius, m.
const RADIUS: f64 = 0.2;
/// Speed along each axis, m/s.
pub const SPEED: f64 = 0.1;
/// When a run ends, s.
const END: f64 = 3.0;
/// A collision.
pub struct Collision {
    /// Time, s, kinetic and internal energy, J, velocity of the first disc along x, m/s.
    pub rows: Vec<[f64; 4]>,
    /// The discs at the end.
    pub end: Snapshot,
    /// When the first step with contact began, s; not a number if none did.
    pub onset: f64,
    /// Work, and errors of the ledger.
    pub totals: Totals,
}

/// Speed at which the discs close, m/s.
pub fn closing() -> f64 {
    2.0 * 2.0f64.sqrt() * SPEED
}

/// When the discs touch, s: exact.
pub fn touch() -> f64 {
    (0.4 * 2.0f64.sqrt() - 2.0 * RADIUS) / closing()
}

/// A collision in cells of `h` metres; frames for ParaView into a folder, under a name, if they are given.
///
/// # Errors
/// What a scene refuses, and a step that breaks.
pub fn collide<M: IntoKernels<f64, 2>>(
    method: M,
    h: f64,
    task: impl Into<Task>,
    frames: Option<(&Path, &str)>,
) -> Result<Collision, CaseError> {
    let Task { asked, simulation } = task.into();
    let lattice = Lattice::new([0.0; 2], h)?;
    let best = (Detection::Plane, Law::Penalty);
    let contact = asked.touch(0.0, best, [wave(1000.0, 1000.0, 0.3), h])?;
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    for (name, at, v) in [("low", 0.3, SPEED), ("high", 0.7, -SPEED)] {
        let seeds = disc([at; 2], RADIUS, 0.5 * h, Part::Whole);
        mpm.add(name, rubber(1000.0, 1000.0, 0.3, 0.0)?, &seeds, |_| [v; 2])?;
    }
    let mut history = History { onset: f64::NAN, before: 0.0, rows: Vec::new() };
    let watch = Watch { series: frames, ..Watch::STEPS };
    let totals = run(&mut mpm, END, watch, simulation, &mut history, |seen, now| {
        if seen.onset.is_nan() && now.contacts().iter().any(|p| p.places > 0) {
            seen.onset = seen.before;
        }
        seen.before = now.time();
        let t = now.totals();
        seen.rows.push([now.time(), t.kinetic, t.internal, velocity(now, 0)[0]]);
    })?;
    let History { rows, onset, .. } = history;
    Ok(Collision { rows, end: mpm.snapshot()?, onset, totals })
}

/// As in [`Collision`], and the time of the step before, s.
struct History {
    onset: f64,
    before: f64,
    rows: Vec<[f64; 4]>,
}

impl Seen for History {
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals([&mut self.onset, &mut self.before])?;
        file.list(&mut self.rows, &[0.0; 4], |file, row| file.reals(row))
    }
}
