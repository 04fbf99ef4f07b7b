//! Scene and run.

use examples::{CaseError, FlowRun, FlowRuns};
use flow::{Flow, Fluid};
use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, Shape, fill};
use mpm_core::{Solver, TimeControl, Watch};

use crate::setup::{DENSITY, Setup, Study};

/// Measures of a run, in this order. The pressure is that at the start of the last step.
pub const COLUMNS: [(&str, &str); 9] = [
    ("semi-axis x", "m"),
    ("semi-axis y", "m"),
    ("stretch less 1", "-"),
    ("kinetic energy", "J"),
    ("largest speed", "m/s"),
    ("mean pressure", "Pa"),
    ("root-mean-square deviation of the pressure", "Pa"),
    ("time of the pressure", "s"),
    ("x^4 / (3 x^2 y^2) less 1", "-"),
];
pub const AXIS_X: usize = 0;
pub const AXIS_Y: usize = 1;
pub const STRETCH: usize = 2;
pub const KINETIC: usize = 3;
pub const FASTEST: usize = 4;
pub const PRESSURE: usize = 5;
pub const DEVIATION: usize = 6;
pub const PRESSURE_TIME: usize = 7;
pub const FOURTH: usize = 8;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub run: FlowRun<9>,
}

/// Rate A0 of the elliptic drop, 1/s.
pub const RATE: f64 = 1.0;

fn scene<const D: usize>(setup: &Setup) -> Result<Flow<D>, CaseError> {
    let h = setup.spacing();
    // Not centred at a node, but for shapes with edges.
    let at = if setup.study.has_edges() { 0.0 } else { 0.37 * h };
    let lattice = Lattice::new([at; D], h)?;
    let mut flow = Flow::new(setup.scheme.options(lattice));
    let fluid = Fluid::new(DENSITY)?.with_surface_tension(setup.tension)?.with_viscosity(setup.viscosity)?;
    let shape: Box<dyn Shape<D>> = if setup.study.has_edges() {
        Box::new(Cuboid::new([-setup.size; D], [setup.size; D])?)
    } else {
        Box::new(Ball::new([0.0; D], setup.size)?)
    };
    let mut seeds = fill(&*shape, &lattice, 2, &Filling::new())?;
    let along = 1.0 + setup.stretch;
    let across = along.powf(-1.0 / (D as f64 - 1.0));
    for x in &mut seeds.positions {
        (0..D).for_each(|d| x[d] *= if d == 0 { along } else { across });
    }
    let elliptic = setup.study == Study::Elliptic;
    flow.add_fluid("drop", fluid, &seeds, |x| {
        std::array::from_fn(|d| if elliptic { [RATE, -RATE, 0.0][d] * x[d] } else { 0.0 })
    })?;
    if setup.study.has_edges() {
        // The viscous step is explicit.
        flow.set_time_control(TimeControl::Courant { factor: 0.34, growth: 1.1 })?;
    }
    if setup.tension > 0.0 {
        // The energy of the surface is in no balance.
        flow.set_watch(Watch::off());
    }
    Ok(flow)
}

/// Semi-axes are those of the ellipse, or ellipsoid, with the second moments of the liquid; the fourth moments are 0 for circle and sphere, -0.4 for
/// square and cube.
fn measure<const D: usize>(flow: &Flow<D>) -> [f64; 9] {
    let points = flow.points();
    let volume: f64 = points.iter().map(|p| p.volume).sum();
    let mean = |of: &dyn Fn(&mpm_core::PointView) -> f64| {
        points.iter().map(|p| p.volume * of(p)).sum::<f64>() / volume
    };
    let moments: [f64; D] = std::array::from_fn(|d| mean(&|p| p.position[d].powi(2)));
    let across = moments[1..].iter().sum::<f64>() / (D as f64 - 1.0);
    let stretch = (moments[0] / across).powf(if D == 2 { 0.25 } else { 1.0 / 3.0 }) - 1.0;
    let speed = |p: &mpm_core::PointView| p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
    let pressure = mean(&|p| p.pressure());
    [
        ((D as f64 + 2.0) * moments[0]).sqrt(),
        ((D as f64 + 2.0) * moments[1]).sqrt(),
        stretch,
        flow.totals().kinetic,
        points.iter().map(speed).fold(0.0, f64::max),
        pressure,
        mean(&|p| (p.pressure() - pressure).powi(2)).sqrt(),
        flow.time() - 2.0 * flow.velocity_lag(),
        mean(&|p| p.position[0].powi(4)) / (3.0 * mean(&|p| (p.position[0] * p.position[1]).powi(2))) - 1.0,
    ]
}

/// Run a drop, with snapshots at these shares of the end.
pub fn run(setup: &Setup, shares: &[f64], runs: &FlowRuns) -> Result<Outcome, CaseError> {
    fn of<const D: usize>(setup: &Setup, times: &[f64], runs: &FlowRuns) -> Result<FlowRun<9>, CaseError> {
        runs.run(&setup.name(), scene::<D>(setup)?, times, 0.0, COLUMNS, measure)
    }
    let times: Vec<f64> = shares.iter().map(|share| share * setup.end).collect();
    let run = if setup.study.dimensions() == 2 {
        of::<2>(setup, &times, runs)
    } else {
        of::<3>(setup, &times, runs)
    }?;
    Ok(Outcome { setup: *setup, run: if setup.tension > 0.0 { run.without_energy() } else { run } })
}
