//! Position and speed of the rod.

use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::{Archive, CheckpointError};

use crate::setup::{ROD, Setup, THICKNESS};

/// Criterion of perforation: part of the impact speed that the force on the rod could still take while the rod leaves the slab.
const DONE: f64 = 2.0e-3;

/// State of the rod at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Velocity of the centre of mass into the slab, m/s.
    pub speed: f64,
    /// Height of the tip above the front of the slab, m.
    pub tip: f64,
    /// Mean force of the slab on the whole rod since the previous row, N.
    pub force: f64,
    /// Fully damaged part of the slab.
    pub damaged: f64,
    /// Volume of slab more than half a cell inside the rod, m^3, scaled from the model to the whole.
    pub inside: f64,
}

/// Observer of the rod.
pub struct Track {
    pace: Pace,
    setup: Setup,
    /// Distance from the tip to the centre of mass, m.
    arm: Option<f64>,
    pub rows: Vec<Row>,
}

impl Track {
    /// Create the observer of a run.
    pub fn new(pace: Pace, setup: &Setup) -> Self {
        Track { pace, setup: *setup, arm: None, rows: Vec::new() }
    }

    /// True if the rod perforated the slab.
    pub fn through(&self) -> bool {
        let Some(row) = self.rows.last() else { return false };
        let left = (row.tip + ROD.length + THICKNESS).max(0.0);
        // The force falls as the slab opens: its recent mean bounds the remaining loss.
        let mass = crate::setup::MASS;
        let recent = self.rows.iter().rev().take(10);
        let force = recent.fold(0.0, |sum: f64, r| sum + r.force) / 10.0;
        let loss = force / mass * left / row.speed.max(1e-9);
        row.speed > 0.0 && row.tip < -THICKNESS - ROD.nose() && loss < DONE * self.setup.speed
    }
    /// True if the rod stopped or rebounded.
    pub fn stopped(&self) -> bool {
        self.rows.last().is_some_and(|row| row.speed <= 0.0)
    }
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let [rod, slab] = now.bodies()[..] else { return Ok(()) };
        // Axis of flight: the last one.
        let axis = now.solver().dimensions() - 1;
        let (mut mass, mut z, mut v) = (0.0, 0.0, 0.0);
        rod.for_each(&mut |p| {
            mass += p.mass;
            z += p.mass * p.position[axis];
            v -= p.mass * p.velocity[axis];
        });
        let (z, speed) = (z / mass, v / mass);
        let start = 0.25 * self.setup.spacing();
        let tip = z - *self.arm.get_or_insert(z - start);
        let half = 0.5 * self.setup.spacing();
        let (mut all, mut damaged, mut inside) = (0.0, 0.0, 0.0);
        let place = slab.state_names().iter().position(|n| n == "damage");
        slab.for_each(&mut |p| {
            all += p.mass;
            damaged += if place.is_some_and(|d| p.state[d] >= 1.0) { p.mass } else { 0.0 };
            let across = if axis == 2 { p.position[0].hypot(p.position[1]) } else { p.position[0] };
            let depth = ROD.radius_at(ROD.length - (p.position[axis] - tip)) - across;
            inside += if depth > half { p.volume } else { 0.0 };
        });
        let whole = crate::setup::MASS;
        let force = self.rows.last().map_or(0.0, |last| {
            let dt = now.time() - last.time;
            if dt > 0.0 { whole * (last.speed - speed) / dt } else { 0.0 }
        });
        let inside = inside * self.setup.copies();
        self.rows.push(Row { time: now.time(), speed, tip, force, damaged: damaged / all, inside });
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.arm, Archive::real)?;
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, speed, tip, force, damaged, inside } = row;
            file.reals([time, speed, tip, force, damaged, inside])
        })
    }
}
