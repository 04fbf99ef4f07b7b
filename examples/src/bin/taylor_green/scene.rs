//! Scenes and runs.

use clap::ValueEnum;
use examples::{CaseError, FlowRun, FlowRuns, FlowScheme};
use flow::{Flow, Fluid, Wall};
use mpm_core::geometry::{Cuboid, Filling, HalfSpace, Lattice, fill};
use mpm_core::{Solver, TimeControl};
use serde::Serialize;

use crate::theory::{amplitude, couette, poiseuille, vortices};

/// Flow to compute; lengths and speeds are of unit size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Study {
    /// Taylor-Green vortices in a periodic square, until L / U
    Vortices,
    /// Start of a channel flow by a pressure gradient
    Poiseuille,
    /// Start of a channel flow by a moving wall
    Couette,
}

impl Study {
    /// Name in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            Study::Vortices => "vortices",
            Study::Poiseuille => "Poiseuille",
            Study::Couette => "Couette",
        }
    }
    /// Exact velocity at a position, at nu t.
    fn velocity(self, x: [f64; 2], time: f64) -> [f64; 2] {
        match self {
            Study::Vortices => vortices(x).map(|v| v * amplitude(time)),
            Study::Poiseuille => [poiseuille(x[1], time), 0.0],
            Study::Couette => [couette(x[1], time), 0.0],
        }
    }
}

/// Parameters of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Setup {
    pub study: Study,
    /// Cells over the period, or over the height of the channel; two particles a cell along each axis.
    pub cells: u32,
    /// Reynolds number of vortices; channels have 10.
    pub reynolds: f64,
    pub scheme: FlowScheme,
}

impl Setup {
    /// Cell size.
    pub fn spacing(&self) -> f64 {
        1.0 / f64::from(self.cells)
    }
    /// Kinematic viscosity; that of a channel is a unit of time.
    pub fn viscosity(&self) -> f64 {
        if self.study == Study::Vortices { 1.0 / self.reynolds } else { 0.1 }
    }
    /// Times of comparison.
    pub fn times(&self) -> Vec<f64> {
        match self.study {
            Study::Vortices => vec![0.25, 0.5, 0.75, 1.0],
            _ => [0.05, 0.1, 0.2].map(|time| time / self.viscosity()).into(),
        }
    }
}

/// Measures of a run, in this order: the projection on the exact flow is 1 for the exact one.
pub const COLUMNS: [(&str, &str); 3] = [
    ("time of the velocity", "-"),
    ("velocity projected on the exact one", "-"),
    ("root-mean-square error", "-"),
];
pub const PROJECTED: usize = 1;
pub const ERROR: usize = 2;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub run: FlowRun<3>,
}

fn scene(setup: &Setup) -> Result<Flow<2>, CaseError> {
    let (h, cells, nu) = (setup.spacing(), setup.cells as usize, setup.viscosity());
    let lattice = Lattice::new([0.0; 2], h)?;
    let fluid = Fluid::new(1.0)?.with_viscosity(nu)?;
    let options = setup.scheme.options(lattice);
    if setup.study == Study::Vortices {
        let mut flow = Flow::new(options.periodic(0, cells)?.periodic(1, cells)?);
        flow.add_shape("vortices", fluid, &Cuboid::new([0.0; 2], [1.0; 2])?, 2, vortices)?;
        return Ok(flow);
    }
    // All of the flow is along the channel.
    let mut flow = Flow::new(options.periodic(0, CHANNEL)?);
    let moves = setup.study == Study::Couette;
    let floor = HalfSpace::new([0.0, 0.0], [0.0, 1.0])?;
    let ceiling = Wall::solid(HalfSpace::new([0.0, 1.0], [0.0, -1.0])?).no_slip();
    flow.add_wall(Wall::solid(floor).no_slip())?;
    flow.add_wall(if moves { ceiling.moving(|t| [t, 0.0]) } else { ceiling })?;
    let seeds = fill(&Cuboid::new([0.0; 2], [CHANNEL as f64 * h, 1.0])?, &lattice, 2, &Filling::new())?;
    flow.add_fluid("liquid", fluid, &seeds, |_| [0.0; 2])?;
    if !moves {
        // Final speed 1 in the middle.
        flow.set_body_force(move |_| [8.0 * nu, 0.0]);
    }
    // The stress of the semi-staggered scheme is explicit.
    let step = if setup.scheme == FlowScheme::SemiStaggered { STEP.min(EXPLICIT) } else { STEP };
    flow.set_time_control(TimeControl::Fixed(step * h * h / nu))?;
    Ok(flow)
}

/// Length of the channel, cells.
const CHANNEL: usize = 8;
/// Step of channel flow, nu dt / h^2: the speed of the liquid sets none at first. Errors of time are of fourth order in the cell.
const STEP: f64 = 0.4;
/// Largest step of an explicit stress, in this unit.
const EXPLICIT: f64 = 1.0 / 16.0;

/// Velocities are those in the middle of the last step.
fn measure(setup: &Setup, flow: &Flow<2>) -> [f64; 3] {
    let time = (flow.time() - flow.velocity_lag()).max(0.0);
    let (mut product, mut square, mut error, mut volume) = (0.0, 0.0, 0.0, 0.0);
    for p in flow.points() {
        let exact = setup.study.velocity([p.position[0], p.position[1]], setup.viscosity() * time);
        for (found, exact) in p.velocity.iter().zip(exact) {
            product += p.volume * found * exact;
            square += p.volume * exact * exact;
            error += p.volume * (found - exact).powi(2);
        }
        volume += p.volume;
    }
    // Errors over the speed of the vortices, or the final one of the channel.
    let scale = if setup.study == Study::Vortices { square } else { volume };
    [time, product / square, (error / scale).sqrt()]
}

/// Run to the times of comparison.
pub fn run(setup: &Setup, runs: &FlowRuns) -> Result<Outcome, CaseError> {
    let name = format!("{}_{}", setup.study.name().to_lowercase(), setup.cells);
    let run = runs.run(&name, scene(setup)?, &setup.times(), 0.0, COLUMNS, |flow| measure(setup, flow))?;
    Ok(Outcome { setup: *setup, run })
}
