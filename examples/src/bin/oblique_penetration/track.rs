//! Position, speed and orientation of the rod over time.

use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::{Archive, CheckpointError, PointView};

use crate::setup::{ROD, Setup, THICKNESS};

/// Number of slices of the rod whose centres define its centre line.
const SLICES: usize = 20;

/// State of the rod at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Velocity of the centre of mass along x and z, m/s.
    pub velocity: [f64; 2],
    /// Angle between axis and plate normal, rad.
    pub pitch: f64,
    /// Heights of tip and tail above the front of the plate, m.
    pub tip: f64,
    pub tail: f64,
    /// Mean displacement of the plate along z, m, and its mean velocity, m/s: the edges are free.
    pub carried: [f64; 2],
    /// Mean force of the plate on the whole rod since the previous row, N.
    pub force: [f64; 2],
    /// Largest penetration of a plate particle into the bent, otherwise rigid, rod, m.
    pub overlap: f64,
    /// Number of plate particles deeper than half a cell inside the rod.
    pub inside: usize,
    /// Number of plate particles with Johnson-Cook damage one.
    pub failed: usize,
}

impl Row {
    /// Return the speed of the centre of mass, m/s.
    pub fn speed(&self) -> f64 {
        self.velocity[0].hypot(self.velocity[1])
    }
}

/// Observer of the rod.
pub struct Track {
    pace: Pace,
    /// Distance of each particle of the rod from its tail, m.
    from_tail: Vec<f64>,
    setup: Setup,
    pub rows: Vec<Row>,
}

impl Track {
    /// Create the observer of a rod whose particles have these distances from its tail, m.
    pub fn new(pace: Pace, from_tail: Vec<f64>, setup: &Setup) -> Self {
        Track { pace, from_tail, setup: *setup, rows: Vec::new() }
    }

    /// True if the rod has perforated the plate or stuck in it.
    pub fn over(&self) -> bool {
        let Some(row) = self.rows.last() else { return false };
        row.tail - row.carried[0] < -THICKNESS - self.setup.spacing() || row.velocity[1] > row.carried[1]
    }
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let bodies = now.bodies();
        // A plate of elements consists of two bodies: elements, and converted particles.
        let Some((rod, plates)) = bodies.split_first() else { return Ok(()) };
        let (mut mass, mut x, mut v, mut s) = (0.0, [0.0; 2], [0.0; 2], 0.0);
        rod.for_each(&mut |p| {
            mass += p.mass;
            for (d, axis) in [0, 2].into_iter().enumerate() {
                x[d] += p.mass * p.position[axis];
                v[d] += p.mass * p.velocity[axis];
            }
            s += p.mass * self.from_tail[p.number];
        });
        let (x, v, s) = (x.map(|x| x / mass), v.map(|v| v / mass), s / mass);
        // Axis by regression of position over distance from the tail.
        let mut axis = [0.0; 2];
        rod.for_each(&mut |p| {
            let arm = p.mass * (self.from_tail[p.number] - s);
            axis[0] += arm * (p.position[0] - x[0]);
            axis[1] += arm * (p.position[2] - x[1]);
        });
        let norm = axis[0].hypot(axis[1]);
        let axis = axis.map(|a| a / norm);
        // Deflection of the centre line from the axis, in slices.
        let mut slices = [[0.0; 2]; SLICES];
        let slice = |s: f64| ((s / ROD.length * SLICES as f64) as usize).min(SLICES - 1);
        rod.for_each(&mut |p| {
            let off = (p.position[0] - x[0]) * axis[1] - (p.position[2] - x[1]) * axis[0];
            let [sum, weight] = &mut slices[slice(self.from_tail[p.number])];
            *sum += p.mass * off;
            *weight += p.mass;
        });
        let (mut failed, mut inside, mut overlap) = (0, 0, f64::NEG_INFINITY);
        let half = 0.5 * self.setup.spacing();
        let (mut all, mut height, mut sink) = (0.0, 0.0, 0.0);
        let names = plates.first().map_or(Vec::new(), |plate| plate.state_names());
        let damage = names.iter().position(|n| n == "failure_damage");
        let mut look = |p: &PointView| {
            all += p.mass;
            height += p.mass * p.position[2];
            sink += p.mass * p.velocity[2];
            let [a, b] = [p.position[0] - x[0], p.position[2] - x[1]];
            let along = a * axis[0] + b * axis[1];
            let [sum, weight] = slices[slice(s + along)];
            let across = (a * axis[1] - b * axis[0] - sum / weight).hypot(p.position[1]);
            let depth = ROD.radius_at(s + along) - across;
            overlap = overlap.max(depth);
            inside += usize::from(depth > half);
            failed += usize::from(damage.is_some_and(|d| p.state[d] >= 1.0));
        };
        plates.iter().for_each(|plate| plate.for_each(&mut look));
        let force = self.rows.last().map_or([0.0; 2], |last| {
            let dt = now.time() - last.time;
            [0, 1].map(|d| if dt > 0.0 { 2.0 * mass * (v[d] - last.velocity[d]) / dt } else { 0.0 })
        });
        self.rows.push(Row {
            time: now.time(),
            velocity: v,
            pitch: axis[0].atan2(-axis[1]),
            tip: x[1] + (ROD.length - s) * axis[1],
            tail: x[1] - s * axis[1],
            carried: [height / all + 0.5 * THICKNESS, sink / all],
            force,
            overlap,
            inside,
            failed,
        });
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, velocity, pitch, tip, tail, carried, force, overlap, inside, failed } = row;
            let pairs = velocity.iter_mut().chain(carried).chain(force);
            file.reals(pairs.chain([time, pitch, tip, tail, overlap]))?;
            file.count(inside)?;
            file.count(failed)
        })
    }
}
