//! Force on the wedge, and penetration of particles, over time.

use examples::{Inside, Outline};
use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::scene::Body;
use mpm_core::{Archive, CheckpointError};

use crate::setup::{HALF, Method, Setup};

/// State of the wedge at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Impulse of the water on the half wedge so far, upwards, N s/m.
    pub impulse: f64,
    /// Number of water particles with their centre in the wedge, and largest penetration of a centre, m.
    pub inside: usize,
    pub depth: f64,
    /// Height of the keel above its position in a rigid wedge, m.
    pub bend: f64,
}

/// Observer of the wedge.
pub struct Track {
    pace: Pace,
    setup: Setup,
    pub rows: Vec<Row>,
    /// Mass-weighted pressure sums, and masses, by position along the wedge over V t, the similarity variable.
    pressures: Vec<[f64; 2]>,
}

/// Number of bins along the wedge.
const BINS: usize = 60;

impl Track {
    pub fn new(pace: Pace, setup: &Setup) -> Self {
        Track { pace, setup: *setup, rows: Vec::new(), pressures: vec![[0.0; 2]; BINS] }
    }

    /// Add the pressures of particles half a cell to one and a half cells from the wedge to the means; those of the outermost particles are
    /// too low.
    fn add_pressures(&mut self, water: &dyn Body, outline: &Outline, time: f64) {
        let (cell, way) = (self.setup.spacing(), self.setup.speed * time);
        let bins = self.pressures.len() as f64;
        water.for_each(&mut |p| {
            let x = [p.position[0], p.position[1]];
            let bin = x[0].abs() / way / self.setup.reach() * bins;
            if bin < bins && x[0].abs() < HALF && (0.5..1.5).contains(&(-outline.depth(x, 2.0 * cell) / cell))
            {
                let [sum, mass] = &mut self.pressures[bin as usize];
                *sum += p.mass * p.pressure();
                *mass += p.mass;
            }
        });
    }

    /// Return positions along the wedge over V t, and mean pressures over the stagnation pressure, in the last half of the run.
    pub fn pressures(&self) -> Vec<[f64; 2]> {
        let bin = self.setup.reach() / self.pressures.len() as f64;
        let means = self.pressures.iter().enumerate().filter(|(_, [_, mass])| *mass > 0.0);
        means.map(|(n, [sum, mass])| [(n as f64 + 0.5) * bin, sum / mass / self.setup.stagnation()]).collect()
    }
}

/// Return the height of the keel, m.
fn keel(wedge: &dyn Body) -> f64 {
    let mut low = f64::INFINITY;
    wedge.for_each(&mut |element| low = element.corners.iter().map(|x| x[1]).fold(low, f64::min));
    low
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let [water, wedge] = now.bodies()[..] else { return Ok(()) };
        let whole = self.setup.method == Method::Flow;
        let outline = if whole {
            Outline::polygon(&self.setup.corners(self.setup.speed * now.time()))
        } else {
            Outline::of(wedge, true)
        };
        let impulse = wedge.given_by_others().unwrap_or_default().impulse[1];
        if now.time() > 0.5 * self.setup.end() {
            self.add_pressures(water, &outline, now.time());
        }
        let inside = Inside::of(water, &outline, self.setup.spacing());
        self.rows.push(Row {
            time: now.time(),
            impulse: if whole { 0.5 * impulse } else { impulse },
            inside: inside.count,
            depth: inside.deepest,
            bend: if whole { 0.0 } else { keel(wedge) + self.setup.speed * now.time() },
        });
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.reals(self.pressures.iter_mut().flatten())?;
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, impulse, inside, depth, bend } = row;
            file.reals([time, impulse, depth, bend])?;
            file.count(inside)
        })
    }
}
