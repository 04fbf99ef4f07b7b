//! Position and velocity of the cylinder over time.

use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::{Archive, CheckpointError};

use crate::scene::START;

/// State of the cylinder at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time since the middle of the release, s.
    pub time: f64,
    /// Distance travelled by the centre of mass along the incline, m.
    pub way: f64,
    /// Height of the centre of mass above the undeformed plane, m.
    pub height: f64,
    /// Speed along the incline, m/s.
    pub speed: f64,
    /// Angular momentum over the moment of inertia, rad/s, positive downhill.
    pub spin: f64,
    /// Gap between the lowest surface of the cylinder and the surface of the plane, m.
    pub gap: f64,
    /// Tangential and normal force of the plane on the cylinder: N/m, in three dimensions N on half of it.
    pub force: [f64; 2],
    /// Number of nodes in contact.
    pub nodes: usize,
}

/// Observer of the cylinder.
pub struct Track {
    pace: Pace,
    /// Cell size and half size of a particle of the cylinder, m.
    spacing: f64,
    half: f64,
    /// Time of release, s.
    zero: f64,
    pub rows: Vec<Row>,
}

impl Track {
    /// Create the observer for cells of `spacing` (m), particles of half size `half` (m), and release at `zero` (s).
    pub fn new(pace: Pace, spacing: f64, half: f64, zero: f64) -> Self {
        Track { pace, spacing, half, zero, rows: Vec::new() }
    }
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let [plane, cylinder] = now.bodies()[..] else { return Ok(()) };
        // First and second moments about the start, from which those about the centre follow.
        let (mut mass, mut place, mut momentum) = (0.0, [0.0; 2], [0.0; 2]);
        let (mut turning, mut inertia, mut lowest) = (0.0, 0.0, f64::INFINITY);
        cylinder.for_each(&mut |p| {
            let [a, b] = [p.position[0] - START, p.position[1]];
            let [u, v] = [p.velocity[0], p.velocity[1]];
            mass += p.mass;
            place[0] += p.mass * a;
            place[1] += p.mass * b;
            momentum[0] += p.mass * u;
            momentum[1] += p.mass * v;
            turning += p.mass * (b * u - a * v);
            inertia += p.mass * (a * a + b * b);
            lowest = lowest.min(b - self.half);
        });
        let [x, y] = place.map(|c| c / mass);
        turning -= y * momentum[0] - x * momentum[1];
        inertia -= mass * (x * x + y * y);
        let mut top = f64::NEG_INFINITY;
        plane.for_each(&mut |p| {
            if (p.position[0] - START - x).abs() < self.spacing {
                top = top.max(p.position[1] + 0.25 * self.spacing);
            }
        });
        let met = now.contacts().first().copied();
        self.rows.push(Row {
            time: now.time() - self.zero,
            way: x,
            height: y,
            speed: momentum[0] / mass,
            spin: turning / inertia,
            gap: lowest - top,
            force: met.map_or([0.0; 2], |c| [c.force[0], c.force[1]]),
            nodes: met.map_or(0, |c| c.places),
        });
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, way, height, speed, spin, gap, force, nodes } = row;
            file.reals([time, way, height, speed, spin, gap].into_iter().chain(force))?;
            file.count(nodes)
        })
    }
}
