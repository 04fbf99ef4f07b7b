//! Conformance of a scene as a solver.

use flow::{Flow, FlowOptions, Fluid, RigidBody, SemiStaggered, Wall};
use impactite_geometry::{Ball, Compose, Cuboid, HalfSpace, Lattice};
use impactite_scene::{Solver, solver_conforms};

use crate::common::GRAVITY;

fn dam() -> impl Solver {
    dam_of(FlowOptions::new(Lattice::new([0.0; 2], 0.05).unwrap()))
}

fn dam_at_nodes() -> impl Solver {
    let lattice = Lattice::new([0.0; 2], 0.05).unwrap();
    dam_of(FlowOptions::new(lattice).semi_staggered(SemiStaggered::default()))
}

fn dam_of(options: FlowOptions<2>) -> impl Solver {
    let mut flow = Flow::new(options);
    flow.add_wall(Wall::container(Cuboid::new([0.0; 2], [1.0, 0.8]).unwrap())).unwrap();
    let column = Cuboid::new([0.0; 2], [0.4, 0.4]).unwrap();
    flow.add_shape("water", Fluid::new(1000.0).unwrap(), &column, 2, |_| [0.0; 2]).unwrap();
    flow.set_body_force(|_| [0.0, -GRAVITY]);
    flow
}

/// Viscous drop with surface tension on a moving floor, in space.
fn drop() -> impl Solver {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 3], 1e-3).unwrap()));
    let floor = HalfSpace::new([0.0; 3], [0.0, 0.0, 1.0]).unwrap();
    flow.add_wall(Wall::solid(floor).no_slip().moving(|t| [0.0, 0.0, 0.02 * t])).unwrap();
    let fluid = Fluid::new(1000.0).unwrap().with_viscosity(0.01).unwrap().with_surface_tension(0.07).unwrap();
    let ball = Ball::new([0.0, 0.0, 5e-3], 4e-3).unwrap();
    flow.add_shape("drop", fluid, &ball, 2, |_| [0.0, 0.0, -0.2]).unwrap();
    flow.set_body_force(|_| [0.0, 0.0, -GRAVITY]);
    flow
}

/// Rigid box that drops and turns in a pool, and a ball that falls on its floor, in space.
fn raft() -> impl Solver {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 3], 0.1).unwrap()));
    flow.add_wall(Wall::container(Cuboid::new([0.0; 3], [1.0, 1.0, 2.0]).unwrap())).unwrap();
    let ball = Ball::new([0.3, 0.4, 0.2], 0.18).unwrap();
    let raft = Cuboid::new([0.35, 0.3, 0.55], [0.75, 0.7, 0.75]).unwrap();
    let pool = Cuboid::new([0.0; 3], [1.0, 1.0, 0.6]).unwrap().minus(ball).minus(raft);
    flow.add_shape("water", Fluid::new(1000.0).unwrap(), &pool, 2, |_| [0.0; 3]).unwrap();
    flow.add_rigid("raft", RigidBody::new(raft, 400.0).unwrap().with_spin([0.3, 0.0, 0.5])).unwrap();
    flow.add_rigid("ball", RigidBody::new(ball, 3000.0).unwrap()).unwrap();
    flow.set_body_force(|_| [0.0, 0.0, -GRAVITY]);
    flow
}

solver_conforms! {
    // Eight cells high, with an impact on the wall in front.
    plane: dam, SolverTests::until(0.6).energy_within(0.12);
    // The surface of balls is too high by up to half a cell of eight, and gravity works on it: half of the energy is lost.
    nodes: dam_at_nodes, SolverTests::until(0.6).energy_within(0.6);
    // Ten cells high; an impact of a flat box on liquid loses energy.
    bodies: raft, SolverTests::until(0.3).energy_within(0.35);
    // The energy of the surface is in no balance.
    space: drop, SolverTests::until(4e-3).energy_within(1.0);
}
