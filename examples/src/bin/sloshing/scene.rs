//! Scene and run.

use std::f64::consts::PI;

use examples::{CaseError, FlowRun, FlowRuns};
use flow::{Flow, Fluid, Wall};
use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::{Solver, Watch};

use crate::setup::{DENSITY, GRAVITY, STRONG, SWAY, Setup, Study};
use crate::theory::Mode;

/// Measures of a run, in this order.
pub const COLUMNS: [(&str, &str); 7] = [
    ("amplitude of the mode", "m"),
    ("elevation at the wall", "m"),
    ("centre of mass x", "m"),
    ("centre of mass y", "m"),
    ("volume", "m^2"),
    ("kinetic energy", "J/m"),
    ("unexplained energy", "J/m"),
];
pub const MODE: usize = 0;
pub const WALL: usize = 1;
pub const CENTRE: usize = 2;
pub const HEIGHT: usize = 3;
pub const VOLUME: usize = 4;
pub const KINETIC: usize = 5;
pub const UNEXPLAINED: usize = 6;
/// Modes of the elevation at the wall.
pub const WALL_MODES: [u32; 3] = [1, 3, 5];

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub run: FlowRun<7>,
}

fn scene(setup: &Setup) -> Result<Flow<2>, CaseError> {
    let Setup { length, depth, study, .. } = *setup;
    let lattice = Lattice::new([0.0; 2], setup.spacing())?;
    let mut flow = Flow::new(setup.scheme.options(lattice));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [length, 3.0 * depth])?))?;
    let mut seeds = fill(&Cuboid::new([0.0; 2], [length, depth])?, &lattice, 2, &Filling::new())?;
    let mode = Mode::new(setup.mode, setup);
    let waves = matches!(study, Study::Wave | Study::Decay);
    let amplitude = if waves { setup.amplitude } else { 0.0 };
    for (x, volume) in seeds.positions.iter_mut().zip(&mut seeds.volumes) {
        // Columns are stretched to the elevation of the mode.
        let stretch = 1.0 + amplitude / depth * (mode.wave_number * x[0]).cos();
        (x[1], *volume) = (x[1] * stretch, *volume * stretch);
    }
    let viscosity = if study == Study::Decay { DENSITY * setup.viscosity } else { 0.0 };
    flow.add_fluid("liquid", Fluid::new(DENSITY)?.with_viscosity(viscosity)?, &seeds, |_| [0.0; 2])?;
    if study == Study::Long {
        // The energy is a row of the table, also where it grows.
        flow.set_watch(Watch::default().only_warn());
    }
    let first = Mode::new(1, setup).frequency();
    // In the frame of the tank.
    flow.set_body_force(move |t| {
        let along = match study {
            Study::Sway => {
                let [shift, w] = [SWAY[0], SWAY[1] * first];
                -shift * w * w * (w * t).cos()
            }
            Study::Long if t < STRONG[2] => -STRONG[0] * (STRONG[1] * first * t).sin(),
            _ => 0.0,
        };
        [along, -GRAVITY]
    });
    Ok(flow)
}

/// Amplitudes of modes are projections: integrals of cos(k x) over the liquid, times 2 / L.
fn measure(setup: &Setup, flow: &Flow<2>) -> [f64; 7] {
    let points = flow.points();
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        points.iter().map(|p| p.volume * of(p.position[0], p.position[1])).sum::<f64>()
    };
    let amplitude = |n: u32| 2.0 / setup.length * sum(&|x, _| (f64::from(n) * PI / setup.length * x).cos());
    let volume = sum(&|_, _| 1.0);
    [
        amplitude(setup.mode),
        WALL_MODES.iter().map(|n| amplitude(*n)).sum(),
        sum(&|x, _| x) / volume,
        sum(&|_, y| y) / volume,
        flow.liquid_volume(),
        flow.totals().kinetic,
        flow.account().unexplained,
    ]
}

/// Run to these times, s.
pub fn run(setup: &Setup, times: &[f64], runs: &FlowRuns) -> Result<Outcome, CaseError> {
    let run = runs.run(&setup.name(), scene(setup)?, times, 0.0, COLUMNS, |flow| measure(setup, flow))?;
    Ok(Outcome { setup: *setup, run })
}
