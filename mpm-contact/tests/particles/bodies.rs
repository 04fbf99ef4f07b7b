//! Solver conformance of scenes of bodies, and conformance of bodies.

use impactite_scene::{Body as _, Finding, Solver, TimeControl, Watch, solver_conforms};
use mpm_contact::conformance::{Balls, Broken, particle_body};
use mpm_contact::particles::RigidWall;
use mpm_contact::{Coulomb, Frictionless};

use crate::{R, block, scene};

/// Block that falls on another one on a wall, and a free ball that hits both.
fn pile() -> impl Solver {
    let mut scene = scene(Coulomb::new(0.3).unwrap());
    let down = [0.0, -1.0e3];
    scene.add("lower", block([0.0, R], [8, 4]).under(down));
    scene.add("upper", block([3.0 * R, 9.4 * R], [8, 4]).under(down).moving([0.0, -4.0]));
    scene.add("ball", Balls::new(vec![[-3.0 * R, 3.0 * R]], R, 5.0e-3).moving([10.0, 0.0]));
    scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap().moving([1.0, 0.0]).unwrap());
    // Velocities are half a step from spring forces, and contact acts on them: 2.1 % of energy are missing with a factor of 0.5.
    scene.set_time_control(TimeControl::Courant { factor: 0.1, growth: 1.1 }).unwrap();
    scene
}

/// Body with a velocity that is not a number.
fn lost() -> impl Solver {
    let mut scene = scene(Frictionless);
    scene.add("balls", Balls::new(vec![[0.0; 3]], R, 1.0).moving([f64::NAN; 3]));
    scene.set_time_control(TimeControl::Fixed(1.0e-5)).unwrap();
    scene
}

solver_conforms! {
    balls: super::pile, SolverTests::until(1.0e-3).energy_within(0.006).breaking(1.0e-3, super::lost);
}

#[test]
fn balls_are_bodies_of_particles() -> Result<(), Broken> {
    particle_body(|| block([0.0, 0.0], [6, 4]).moving([1.0, 2.0]).under([0.0, -10.0]))?;
    particle_body(|| Balls::new(vec![[0.0; 3], [1.0; 3]], 0.1, 1.0).moving([1.0, 2.0, 3.0]))?;
    Ok(())
}

#[test]
fn broken_bodies_are_found_out() {
    let ball = |radius: f64, mass: f64| Balls::new(vec![[0.0, 0.0]], radius, mass).moving([1.0, 0.0]);
    let property = |balls: Balls<2>| particle_body(|| balls.clone()).unwrap_err().property;
    assert_eq!(property(Balls::new(vec![[0.0, 0.0]], 1.0, 1.0)), "a positive Courant rate");
    assert_eq!(property(ball(1.0, f64::INFINITY)), "a positive mass");
    assert_eq!(property(ball(-1.0, 1.0)), "a positive Courant rate");
}

#[test]
fn bodies_come_back_as_what_they_are() {
    let mut scene = scene::<2>(Frictionless);
    let balls = scene.add("block", block([0.0, R], [3, 3]));
    let wall = scene.add_wall(RigidWall::new([0.0, 0.0], [0.0, 1.0]).unwrap());
    assert!(scene.part::<Balls<2>>(balls).is_some_and(|balls| balls.name() == "block" && balls.len() == 9));
    assert_eq!(scene.body(balls).map(|body| body.describe()).as_deref(), Some("balls on 20 springs"));
    assert_eq!(scene.particles(balls).count(), 9);
    for none in [wall, 2] {
        assert!(scene.part::<Balls<2>>(none).is_none() && scene.body(none).is_none());
        assert!(scene.particles(none).count() == 0 && scene.totals_of(none).is_none());
    }
    assert_eq!(scene.method(), "bodies of particles; block: balls on 20 springs");
    assert_eq!(scene.bodies().iter().map(|b| b.name()).collect::<Vec<_>>(), ["block", "wall 1"]);
}

/// Message on an energy gain: body and place of the fastest particle, and the remedy of its method.
#[test]
fn a_step_too_long_is_a_gain_of_the_fastest() {
    let mut scene = scene(Frictionless);
    scene.add("stiff", block([0.0, 0.0], [4, 4]));
    scene.add("shaken", block([40.0 * R, 0.0], [4, 4]));
    scene.add("ball", Balls::new(vec![[40.0 * R, -2.5 * R]], R, 1.0e-3).moving([0.0, 1.0]));
    scene.set_watch(Watch::default());
    // Three times the stability limit.
    scene.set_time_control(TimeControl::Fixed(1.0e-4)).unwrap();
    let stopped = scene.run_until(1.0).unwrap_err().to_string();
    assert!(stopped.contains("shaken") && stopped.contains("take a smaller Courant factor"), "{stopped}");
    let none = |f: &Finding| matches!(f, Finding::EnergyLoss { .. });
    assert!(!scene.warnings().iter().any(|w| none(&w.finding)));
}
