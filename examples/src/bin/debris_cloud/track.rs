//! History of the cloud.

use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::{Archive, CheckpointError};

use crate::setup::{RADIUS, Setup, THICKNESS};

/// Number of rings for the radius of the hole, each as wide as the edge of a seed.
const RINGS: usize = 80;

/// State of the cloud at one time. Lengths are from the front face of the plate; masses and momenta are of a quarter.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Largest x of a particle, m.
    pub front: f64,
    /// Largest distance from the axis of a particle more than a thickness behind the plate, m.
    pub radius: f64,
    /// Smallest x of a particle, m.
    pub back: f64,
    /// Mass more than a cell behind the plate, kg, and its momentum along x, kg m/s.
    pub mass: f64,
    pub momentum: f64,
    /// Radius within which less than half of the plate's mass remains in place, m.
    pub hole: f64,
    /// Mean pressure of the seeds near the axis in the middle of the plate, Pa.
    pub pressure: f64,
    /// Number of particles.
    pub particles: usize,
}

/// Observer of the cloud.
pub struct Track {
    pub pace: Pace,
    edge: f64,
    /// Marks of the seeds of the plate whose pressure is recorded.
    gauge: Vec<bool>,
    pub rows: Vec<Row>,
}

impl Track {
    pub fn new(pace: Pace, setup: &Setup, plate: &[[f64; 3]]) -> Self {
        let edge = setup.edge();
        let followed =
            |[x, y, z]: &[f64; 3]| (x - 0.5 * THICKNESS).abs() < edge && y.hypot(*z) < 0.2 * RADIUS;
        Track { pace, edge, gauge: plate.iter().map(followed).collect(), rows: Vec::new() }
    }
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let mut row = Row { time: now.time(), ..Row::default() };
        let mut at_gauge = 0.0;
        let mut rings = [0.0; RINGS];
        for (index, body) in now.bodies().iter().enumerate() {
            row.particles += body.len();
            body.for_each(&mut |p| {
                let [x, y, z] = p.position;
                let r = y.hypot(z);
                row.front = row.front.max(x);
                row.back = row.back.min(x);
                if x > 2.0 * THICKNESS {
                    row.radius = row.radius.max(r);
                }
                if x > THICKNESS + 2.0 * self.edge {
                    row.mass += p.mass;
                    row.momentum += p.mass * p.velocity[0];
                }
                if (0.0..THICKNESS).contains(&x)
                    && let Some(ring) = rings.get_mut((r / self.edge) as usize)
                {
                    *ring += p.mass;
                }
                if index == 1 && !self.gauge.is_empty() && self.gauge[p.number % self.gauge.len()] {
                    row.pressure += p.mass * p.pressure();
                    at_gauge += p.mass;
                }
            });
        }
        let full = |n: usize| {
            let area = std::f64::consts::FRAC_PI_4 * (2 * n + 1) as f64 * self.edge * self.edge;
            crate::setup::SHOCK[0] * area * THICKNESS
        };
        let inner = (0..RINGS).take_while(|&n| rings[n] < 0.5 * full(n)).count();
        row.pressure = if at_gauge > 0.0 { row.pressure / at_gauge } else { 0.0 };
        row.hole = inner as f64 * self.edge;
        self.rows.push(row);
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, front, radius, back, mass, momentum, hole, pressure, particles } = row;
            file.reals([time, front, radius, back, mass, momentum, hole, pressure])?;
            file.count(particles)
        })
    }
}
