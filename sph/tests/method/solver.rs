//! Conformance of smoothed particles as solvers and as contact bodies.

use impactite_scene::{Axisymmetric, Boundary, FullSpace, PlaneStrain, Side, TimeControl, solver_conforms};
use mpm_contact::conformance::particle_body;
use mpm_contact::particles::Bodies;
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_materials::library;
use sph::{
    ArtificialStress, GradientCorrection, Method, PairViscosity, Sph, TotalLagrangian, Updated, WendlandC2,
    ZeroEnergyPenalty,
};

use crate::common::{block, linear, noise};

const H: f64 = 1.0e-3;

/// Copper bar on a wall, axisymmetric, with updates of the reference during plastic flow.
fn bar() -> impl impactite_scene::Solver {
    let form = TotalLagrangian::renewed(1.2).unwrap();
    let method = Method::new(
        Axisymmetric,
        WendlandC2::default(),
        form,
        GradientCorrection,
        ZeroEnergyPenalty::default(),
    );
    let layout = block([0.0; 2], [4.0 * H, 16.0 * H], H, true);
    let mut bar = Sph::new(method, library::copper_taylor(), &layout, |_| [0.0, -150.0]).unwrap();
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    bar
}

/// Steel in the original formulation, on a wall of mirror images, half of it behind a plane of symmetry.
fn printed() -> impl impactite_scene::Solver {
    let layout = block([0.0; 2], [5.0 * H, 8.0 * H], H, false);
    let law = library::steel_4340().with_bulk_viscosity(0.5, 4.0).unwrap();
    let velocity = |x: [f64; 2]| [0.0, -30.0 + 2.0 * noise(x, 1.0)[1]];
    let mut body = Sph::new(Method::printed(PlaneStrain), law, &layout, velocity).unwrap();
    body.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    body.mirror_wall(1, 0.0, Side::Above).unwrap();
    body.set_body_force(std::sync::Arc::new(|t| [0.0, -1.0e4 * t.cos()]));
    body
}

/// Impact of a cube on another one of another form.
fn cubes() -> impl impactite_scene::Solver {
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).unwrap()));
    let cube = |z: f64| block([0.0, 0.0, z], [4.0 * H, 4.0 * H, z + 4.0 * H], H, false);
    let lower = Method::total_lagrangian(FullSpace);
    scene.add("lower", Sph::new(lower, linear(0.3), &cube(0.0), |_| [0.0; 3]).unwrap());
    let stabilisation = (ArtificialStress::default(), PairViscosity::default());
    let upper = Method::new(FullSpace, WendlandC2::default(), Updated, GradientCorrection, stabilisation);
    scene.add("upper", Sph::new(upper, linear(0.3), &cube(4.2 * H), |_| [0.0, 3.0, -80.0]).unwrap());
    scene
}

/// Two halves that penetrate each other in one step.
fn torn() -> impl impactite_scene::Solver {
    let speed = |[x, _]: [f64; 2]| [if x < 2.5 * H { 4.0e3 } else { -4.0e3 }, 0.0];
    let layout = block([0.0; 2], [5.0 * H, 5.0 * H], H, false);
    let law = library::copper_taylor();
    let mut bar = Sph::new(Method::total_lagrangian(PlaneStrain), law, &layout, speed).unwrap();
    bar.set_time_control(TimeControl::Fixed(0.4e-6)).unwrap();
    bar
}

solver_conforms! {
    // In contact with the wall, particles that it moves have the kinetic energy of half a step before.
    total_lagrangian: super::bar, SolverTests::until(6.0e-6).energy_within(1.5e-2).breaking(1.0e-5, super::torn);
    as_printed: super::printed, SolverTests::until(4.0e-6).energy_within(0.05);
    bodies: super::cubes, SolverTests::until(6.0e-6).energy_within(0.02);
}

#[test]
fn bodies_are_such_that_others_meet() {
    let layout = block([0.0; 2], [6.0 * H, 6.0 * H], H, false);
    let of = |method| Sph::new(method, linear(0.3), &layout, |x| noise(x, 0.0)).unwrap();
    particle_body(|| of(Method::total_lagrangian(PlaneStrain))).unwrap();
    let layout = block([0.0; 2], [6.0 * H, 6.0 * H], H, true);
    particle_body(|| {
        Sph::new(Method::updated(Axisymmetric), linear(0.3), &layout, |x| noise(x, 0.0)).unwrap()
    })
    .unwrap();
}
