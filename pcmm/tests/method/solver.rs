//! Conformance of the particle-contact solvers.

use impactite_scene::{Axisymmetric, Boundary, FullSpace, PlaneStrain, Side, TimeControl, solver_conforms};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_materials::Constitutive as _;
use pcmm::{AzimuthFan, Bodies, LocalDelaunay, Masses, Method, Packing, Pcmm, RigidWall};

use crate::common::{block, copper, steel};

const H: f64 = 1.0e-3;

fn delaunay() -> LocalDelaunay {
    LocalDelaunay::new(0.45 * H, 2.0).unwrap()
}

/// Copper bar on a wall, axisymmetric, with revisions during plastic flow.
fn bar() -> impl impactite_scene::Solver {
    let method = Method::consistent(Axisymmetric, delaunay());
    let packing = block([0.0; 2], 4, 16, H);
    let mut bar = Pcmm::new(method, copper(), &packing, |_| [0.0, -150.0], Masses::FromElements).unwrap();
    bar.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    bar
}

/// Steel in the original formulation, sheared in free fall.
fn printed() -> impl impactite_scene::Solver {
    let method = Method::printed(PlaneStrain, AzimuthFan::new(0.45 * H).unwrap());
    let packing = block([0.0; 2], 6, 6, H);
    let velocity = |x: [f64; 2]| [2.0e3 * x[1], 0.0];
    let mut body = Pcmm::new(method, steel().compiled(), &packing, velocity, Masses::FromElements).unwrap();
    body.set_body_force(std::sync::Arc::new(|t| [0.0, -1.0e4 * t.cos()]));
    body
}

fn cube(packing: &Packing<3>, speed: f64) -> Pcmm<3, impl pcmm::Composition<3> + use<>> {
    // Diagonals of cubes are edges.
    let method = Method::consistent(FullSpace, LocalDelaunay::new(0.8 * H, 2.0).unwrap());
    Pcmm::new(method, steel().compiled(), packing, |_| [0.0, 0.0, -speed], Masses::FromElements).unwrap()
}

/// Impact of a cube on another one on a wall.
fn cubes() -> impl impactite_scene::Solver {
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).unwrap()));
    for (name, z, speed) in [("lower", 0.0, 0.0), ("upper", 4.2 * H, 80.0)] {
        let shape = impactite_geometry::Cuboid::new([0.0, 0.0, z], [3.0 * H, 3.0 * H, z + 3.0 * H]).unwrap();
        let lattice = impactite_geometry::Lattice::new([0.0, 0.0, z], H).unwrap();
        scene.add(name, cube(&Packing::on_nodes(&shape, &lattice).unwrap(), speed));
    }
    scene.add_wall(RigidWall::new([0.0; 3], [0.0, 0.0, 1.0]).unwrap());
    scene
}

/// Two halves that penetrate each other in one step.
fn torn() -> impl impactite_scene::Solver {
    let speed = |[x, _]: [f64; 2]| [if x < 2.5 * H { 4.0e3 } else { -4.0e3 }, 0.0];
    let method = Method::consistent(PlaneStrain, delaunay());
    let mut bar =
        Pcmm::new(method, copper(), &block([0.0; 2], 5, 5, H), speed, Masses::FromElements).unwrap();
    bar.set_time_control(TimeControl::Fixed(0.4e-6)).unwrap();
    bar
}

solver_conforms! {
    copper_bar: super::bar, SolverTests::until(6.0e-6).energy_within(0.05).breaking(1.0e-5, super::torn);
    as_printed: super::printed, SolverTests::until(2.0e-5).energy_within(0.3);
    bodies: super::cubes, SolverTests::until(2.5e-5).energy_within(0.1);
}
