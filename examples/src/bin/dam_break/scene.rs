//! Scene and run.

use examples::{CaseError, FlowRun, FlowRuns, Heap};
use flow::{Flow, Fluid, Wall};
use mpm_core::Solver;
use mpm_core::geometry::{Cuboid, Lattice};

use crate::setup::{DENSITY, GAUGE, GRAVITY, Setup, Study};

/// Measures of a run, in this order.
pub const COLUMNS: [(&str, &str); 6] = [
    ("front", "m"),
    ("volume beyond the dam", "m^2"),
    ("pressure at the gauge", "Pa"),
    ("volume", "m^2"),
    ("centre of mass", "m"),
    ("kinetic energy", "J/m"),
];
pub const FRONT: usize = 0;
pub const BEYOND: usize = 1;
pub const GAUGED: usize = 2;
pub const VOLUME: usize = 3;
pub const CENTRE: usize = 4;
pub const KINETIC: usize = 5;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub run: FlowRun<6>,
}

impl Outcome {
    /// Times over sqrt(H / g) and values of a measure.
    pub fn over_time(&self, measure: usize) -> Vec<[f64; 2]> {
        let second = self.setup.second();
        self.run.series(measure).into_iter().map(|[t, value]| [t / second, value]).collect()
    }
    /// Depths at the end.
    pub fn heap(&self) -> Heap {
        let end = self.run.snapshots.len() - 1;
        Heap::new(&self.run.snapshots[end], self.setup.tank(), self.setup.column())
    }
}

fn scene(setup: &Setup) -> Result<Flow<2>, CaseError> {
    let mut flow = Flow::new(setup.scheme.options(Lattice::new([0.0; 2], setup.spacing())?));
    let [left, right] = setup.tank();
    flow.add_wall(Wall::container(Cuboid::new([left, 0.0], [right, setup.ceiling()])?))?;
    let water = Fluid::new(DENSITY)?.with_viscosity(setup.viscosity)?;
    let column = Cuboid::new([0.0; 2], [setup.width(), setup.height])?;
    flow.add_shape("water", water, &column, 2, |_| [0.0; 2])?;
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    Ok(flow)
}

fn measure(setup: &Setup, flow: &Flow<2>) -> [f64; 6] {
    let (points, cell, column) = (flow.points(), setup.spacing(), setup.column());
    let [left, right] = setup.tank();
    let mut heights = vec![0.0; ((right - left) / column).ceil() as usize + 1];
    let (mut beyond, mut volume, mut moment) = (0.0, 0.0, 0.0);
    let (mut pressure, mut area) = (0.0, 0.0);
    for p in &points {
        let [x, y, _] = p.position;
        heights[((x - left) / column).max(0.0) as usize] += p.volume / column;
        (volume, moment) = (volume + p.volume, moment + p.volume * y);
        if x > setup.width() {
            beyond += p.volume;
        }
        let [middle, diameter] = GAUGE.map(|part| part * setup.height);
        if x > right - cell && (y - middle).abs() < 0.5 * diameter.max(cell) {
            (pressure, area) = (pressure + p.volume * p.pressure(), area + p.volume);
        }
    }
    let heap = Heap { left, width: column, heights, area: volume };
    [
        heap.front(0.5 * setup.width(), setup.front_depth()),
        beyond,
        if area > 0.0 { pressure / area } else { 0.0 },
        flow.liquid_volume(),
        moment / volume,
        flow.totals().kinetic,
    ]
}

/// Run a dam break, with snapshots at these shares of the end.
pub fn run(setup: &Setup, shares: &[f64], runs: &FlowRuns) -> Result<Outcome, CaseError> {
    let end = setup.end * setup.second();
    let times: Vec<f64> = shares.iter().map(|share| share * end).collect();
    // Pressures need every step.
    let every_step = matches!(setup.study, Study::Release | Study::Tank);
    let interval = if every_step { 0.0 } else { end / ROWS };
    let measured = |flow: &Flow<2>| measure(setup, flow);
    let run = runs.run(&setup.name(), scene(setup)?, &times, interval, COLUMNS, measured)?;
    Ok(Outcome { setup: *setup, run })
}

/// Number of history rows of a run.
const ROWS: f64 = 300.0;
