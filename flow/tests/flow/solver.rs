//! Conformance of a scene as a solver.

use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Ball, Cuboid, HalfSpace, Lattice};
use impactite_scene::{Solver, solver_conforms};

use crate::common::GRAVITY;

fn dam() -> impl Solver {
    let mut flow = Flow::new(FlowOptions::new(Lattice::new([0.0; 2], 0.05).unwrap()));
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

solver_conforms! {
    // Eight cells high, with an impact on the wall in front.
    plane: dam, SolverTests::until(0.6).energy_within(0.12);
    // The energy of the surface is in no balance.
    space: drop, SolverTests::until(4e-3).energy_within(1.0);
}
