//! Observers of the gate (tip displacement, load, leakage) and of the front.

use examples::{Heap, Inside, Outline};
use mpm_core::observe::{ObserveError, Observer, Pace, RunView};
use mpm_core::scene::Body;
use mpm_core::{Archive, CheckpointError};

use crate::setup::{GATE, Gate, Setup, WATER};

/// State of the gate at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time, s.
    pub time: f64,
    /// Displacement of the middle of the free end, to the right and up, m.
    pub tip: [f64; 2],
    /// Impulse of the water on gate and wall since the start, N s/m.
    pub impulse: [f64; 2],
    /// Fraction of the water that is through.
    pub out: f64,
    /// Number of particles of water with their centre in the gate, and depth of the deepest centre, m.
    pub inside: usize,
    pub depth: f64,
    /// Root mean square of the pressure less that at rest, Pa, and of the relative change of density.
    pub pressure: f64,
    pub density: f64,
}

/// Observer of the gate.
pub struct Track {
    pace: Pace,
    setup: Setup,
    pub rows: Vec<Row>,
}

impl Track {
    pub fn new(pace: Pace, setup: &Setup) -> Self {
        Track { pace, setup: *setup, rows: Vec::new() }
    }

    /// Mean force of the water on gate and wall since the previous row, N/m.
    pub fn force(&self, n: usize) -> [f64; 2] {
        let (Some(before), row) = (n.checked_sub(1).map(|n| self.rows[n]), self.rows[n]) else {
            return [0.0; 2];
        };
        [0, 1].map(|d| (row.impulse[d] - before.impulse[d]) / (row.time - before.time))
    }

    /// Measure the water: fraction that is through, and deviations of pressure and density from those at rest.
    fn look_at(&self, water: &dyn Body, row: &mut Row) {
        let (mut mass, mut out, mut pressure, mut density) = (0.0, 0.0, 0.0, 0.0f64);
        water.for_each(&mut |p| {
            mass += p.mass;
            if p.position[0] > WATER[0] + GATE[1] {
                out += p.mass;
            }
            pressure += p.mass * (p.pressure() - self.setup.pressure(p.position[1])).powi(2);
            density += p.mass * (p.mass / p.volume / self.setup.water().density - 1.0).powi(2);
        });
        row.out = out / mass;
        (row.pressure, row.density) = ((pressure / mass).sqrt(), (density / mass).sqrt());
    }
}

/// Middle of the free end, m: mean of the lower corners of the first row of elements.
fn tip(gate: &dyn Body, layers: u32) -> [f64; 2] {
    let mut sum = [0.0; 2];
    gate.for_each(&mut |element| {
        if element.number < layers as usize {
            for corner in &element.corners[..2] {
                (0..2).for_each(|d| sum[d] += corner[d] / f64::from(2 * layers));
            }
        }
    });
    sum
}

impl Observer for Track {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let [water, gate] = now.bodies()[..] else { return Ok(()) };
        let start = [WATER[0] + 0.5 * GATE[1], 0.0];
        let (at, pushed) = (tip(gate, self.setup.layers), gate.given_by_others().unwrap_or_default());
        let inside = Inside::of(water, &Outline::of(gate, false), self.setup.spacing());
        let mut row = Row {
            time: now.time(),
            tip: [at[0] - start[0], at[1] - start[1]],
            impulse: [pushed.impulse[0], pushed.impulse[1]],
            inside: inside.count,
            depth: inside.deepest,
            ..Row::default()
        };
        self.look_at(water, &mut row);
        self.rows.push(row);
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &Row::default(), |file, row| {
            let Row { time, tip, impulse, out, inside, depth, pressure, density } = row;
            file.reals(tip.iter_mut().chain(impulse).chain([time, out, depth, pressure, density]))?;
            file.count(inside)
        })
    }
}

/// Observer of the front of water without a gate.
pub struct Fronts {
    pace: Pace,
    setup: Setup,
    /// Time, s, and position, m.
    pub rows: Vec<[f64; 2]>,
}

impl Fronts {
    pub fn new(pace: Pace, setup: &Setup) -> Self {
        Fronts { pace, setup: *setup, rows: Vec::new() }
    }
}

impl Observer for Fronts {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    /// Record the right end of the water: at least half a particle high.
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        if self.setup.gate == Gate::None {
            let ([width, _], cell) = (self.setup.size(), self.setup.spacing());
            let heap = Heap::new(&now.snapshot()?, [0.0, 8.0 * width], cell);
            self.rows.push([now.time(), heap.front(0.5 * width, 0.25 * cell)]);
        }
        Ok(())
    }

    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.rows, &[0.0; 2], |file, row| file.reals(row))
    }
}
