//! Conformance of a scene as a solver.

use flow::{Flow, FlowOptions, Fluid, Wall};
use impactite_geometry::{Cuboid, Lattice};
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

solver_conforms! {
    plane: dam, SolverTests::until(0.6).energy_within(0.12);
}
