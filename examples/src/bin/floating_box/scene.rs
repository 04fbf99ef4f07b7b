//! Scene and run.

use std::cell::Cell;
use std::f64::consts::PI;

use examples::{CaseError, FlowRun, FlowRuns};
use flow::{Flow, FlowOptions, Fluid, RigidBody, Wall};
use mpm_core::Solver;
use mpm_core::geometry::{Ball, Compose, Cuboid, Lattice};

use crate::setup::{CEILING, EDGE, GRAVITY, LEFT, PUSHED, Setup, Study, TANK, WATER};

/// Measures of a run, in this order.
pub const COLUMNS: [(&str, &str); 6] = [
    ("centre of the box x", "m"),
    ("centre of the box y", "m"),
    ("turn of the box", "rad"),
    ("kinetic and potential energy since the start", "J"),
    ("momentum lost", "-"),
    ("volume", "m^D"),
];
pub const ACROSS: usize = 0;
pub const HEIGHT: usize = 1;
pub const TURN: usize = 2;
pub const ENERGY: usize = 3;
pub const MOMENTUM: usize = 4;
pub const VOLUME: usize = 5;

/// Radius of the ball of water that falls, its horizontal velocity and the place of the box in it, m and m/s.
const DROP: f64 = 0.4;
const THROWN: f64 = 0.3;
const ASIDE: f64 = 0.03;

/// Results of a run.
pub struct Outcome {
    pub setup: Setup,
    pub run: FlowRun<6>,
}

fn scene<const D: usize>(setup: &Setup) -> Result<Flow<D>, CaseError> {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; D], setup.spacing())?));
    let mut gravity = [0.0; D];
    gravity[1] = -GRAVITY;
    flow.set_body_force(move |_| gravity);
    let water = Fluid::new(WATER)?;
    if setup.study == Study::Fall {
        let half = 0.5 * EDGE;
        let shape = Cuboid::new([ASIDE - half; D], [ASIDE + half; D])?;
        let mut thrown = [0.0; D];
        thrown[0] = THROWN;
        flow.add_shape("water", water, &Ball::new([0.0; D], DROP)?.minus(shape), 2, |_| thrown)?;
        flow.add_rigid("box", RigidBody::new(shape, setup.density)?.with_velocity(thrown))?;
        return Ok(flow);
    }
    let (mut tank, mut pool) = ([TANK[0]; D], [TANK[0]; D]);
    (tank[1], pool[1]) = (CEILING, TANK[1]);
    flow.add_wall(Wall::container(Cuboid::new([0.0; D], tank)?))?;
    let (mut low, mut high) = ([LEFT; D], [LEFT + EDGE; D]);
    (low[1], high[1]) = (setup.bottom(), setup.bottom() + EDGE);
    let shape = Cuboid::new(low, high)?;
    flow.add_shape("water", water, &Cuboid::new([0.0; D], pool)?.minus(shape), 2, |_| [0.0; D])?;
    let body = RigidBody::new(shape, setup.density)?;
    let mut held = [true; D];
    held[1] = false;
    let body = if setup.is_free() {
        body.with_spin([0.0, 0.0, PUSHED])
    } else {
        body.without_turning().holding(held)
    };
    flow.add_rigid("box", body)?;
    Ok(flow)
}

/// Turn of the box in the plane, rad: that of its first corner about its centre.
fn turn<const D: usize>(flow: &Flow<D>) -> f64 {
    let corner = Cell::new([0.0; 2]);
    if let Some(body) = flow.bodies().get(1) {
        body.for_each(&mut |p| {
            if p.number == 0 {
                corner.set([p.position[0], p.position[1]]);
            }
        });
    }
    let centre = flow.rigid_centre(0).unwrap_or([f64::NAN; D]);
    let arm = [corner.get()[0] - centre[0], corner.get()[1] - centre[1]];
    (arm[1].atan2(arm[0]) + 0.75 * PI + PI).rem_euclid(2.0 * PI) - PI
}

/// Kinetic and potential energy of water and box, J.
fn mechanical<const D: usize>(flow: &Flow<D>) -> f64 {
    let mut energy = 0.0;
    for body in flow.bodies() {
        energy += body.totals().kinetic;
        body.for_each(&mut |p| energy += GRAVITY * p.mass * p.position[1]);
    }
    energy
}

/// State at the start of a run.
struct Start {
    energy: f64,
    momentum: [f64; 3],
}

fn measure<const D: usize>(start: &Start, flow: &Flow<D>) -> [f64; 6] {
    let (totals, load) = (flow.totals(), flow.exchange().load);
    let lost = |d: usize| (totals.momentum[d] - start.momentum[d] - load[d]).abs() / totals.momentum_scale;
    let centre = flow.rigid_centre(0).unwrap_or([f64::NAN; D]);
    [
        centre[0],
        centre[1],
        turn(flow),
        mechanical(flow) - start.energy,
        (0..3).map(lost).fold(0.0, f64::max),
        flow.liquid_volume(),
    ]
}

fn run_in<const D: usize>(setup: &Setup, times: &[f64], runs: &FlowRuns) -> Result<FlowRun<6>, CaseError> {
    let flow = scene::<D>(setup)?;
    let start = Start { energy: mechanical(&flow), momentum: flow.totals().momentum };
    runs.run(&setup.name(), flow, times, 0.0, COLUMNS, |flow| measure(&start, flow))
}

/// Run a motion, with snapshots at these shares of its end.
pub fn run(setup: &Setup, shares: &[f64], runs: &FlowRuns) -> Result<Outcome, CaseError> {
    let times: Vec<f64> = shares.iter().map(|share| share * setup.end).collect();
    let run = if setup.dimensions() == 3 {
        run_in::<3>(setup, &times, runs)?
    } else {
        run_in::<2>(setup, &times, runs)?
    };
    Ok(Outcome { setup: *setup, run })
}
