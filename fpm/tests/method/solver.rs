//! Conformance of the fragile points method as a solver.

use std::sync::Arc;

use fpm::{Cohesive, Fpm, MaximumTension, Method, Notch};
use impactite_scene::{Boundary, FullSpace, PlaneStrain, Side, Solver, TimeControl, solver_conforms};
use mpm_materials::library;

use crate::common::{lattice, linear, noise, random};

const H: f64 = 1e-3;

/// Copper bar on a wall.
fn bar() -> impl Solver {
    let cells = random([0.0, 0.0], [6.0 * H, 30.0 * H], H, 3);
    let mut bar =
        Fpm::new(Method::symmetric(PlaneStrain), library::copper_taylor(), &cells, |_| [0.0, -100.0])
            .unwrap();
    bar.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    bar.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    bar
}

/// Notched plate under tension and its weight, in the original formulation.
fn torn() -> impl Solver {
    let notch = Notch::segment([0.0, 8.0 * H], [10.0 * H, 8.0 * H]).unwrap();
    let cells = random([0.0, 0.0], [32.0 * H, 40.0 * H], H, 5).with_notch(&notch).unwrap();
    let method = Method::printed(PlaneStrain).with_cracks(MaximumTension::new(100e6).unwrap());
    let mut plate = Fpm::new(method, linear(0.3), &cells, |x| noise(x, 1.0).map(|v| 0.1 * v)).unwrap();
    for side in [-1.0, 1.0] {
        let pull = move |t: f64| [None, Some(side * 5.0 * (t / 1e-6).min(1.0))];
        plate.drive_faces(|f| f.normal[1] * side > 0.5, Arc::new(pull)).unwrap();
    }
    plate.set_body_force(Arc::new(|t| [10.0 * t.cos(), -9.81]));
    plate
}

fn cohesive(work: f64) -> Cohesive {
    Cohesive::new(300e6, work).unwrap()
}

/// Block of cubes with one corner pulled off, with cohesive faces and friction.
fn corner(cracks: Cohesive) -> impl Solver {
    let cells = lattice([0.0; 3], [5, 5, 6], H);
    let method = Method::symmetric(FullSpace).with_cracks(cracks);
    let mut block = Fpm::new(method, linear(0.25), &cells, |[x, _, z]| {
        [0.0, 0.0, if z > 3.0 * H && x > 2.0 * H { 25.0 } else { -5.0 }]
    })
    .unwrap();
    block.set_friction(0.4).unwrap();
    block.load_faces(|f| f.normal[0] > 0.5, Arc::new(|t| [-1e6 * t / 1e-6, 0.0, 0.0])).unwrap();
    block
}

/// Bar in uniform extension, in which all faces across it soften, with enough cells for threads.
fn softening() -> impl Solver {
    let cells = random([0.0; 2], [52.0 * H, 20.0 * H], H, 6);
    let method = Method::symmetric(PlaneStrain).with_cracks(cohesive(3e3));
    let away = |[x, _]: [f64; 2]| [1500.0 * (x - 26.0 * H), 0.0];
    let mut bar = Fpm::new(method, linear(0.3), &cells, away).unwrap();
    bar.set_friction(0.2).unwrap();
    bar
}

/// Two halves that penetrate each other in one step.
fn broken() -> impl Solver {
    let speed = |[x, _]: [f64; 2]| [if x < 2.5 * H { 4.0e3 } else { -4.0e3 }, 0.0];
    let cells = lattice([0.0; 2], [5, 5], H);
    let mut bar = Fpm::new(Method::printed(PlaneStrain), library::copper_taylor(), &cells, speed).unwrap();
    bar.set_time_control(TimeControl::Fixed(0.4e-6)).unwrap();
    bar
}

solver_conforms! {
    impact: super::bar, SolverTests::until(8.0e-6).energy_within(2e-3).breaking(1.0e-5, super::broken);
    tearing: super::torn, SolverTests::until(16.0e-6).energy_within(2e-3);
    softening: super::softening, SolverTests::until(4.0e-6).energy_within(2e-3);
    cohesive: || super::corner(super::cohesive(100.0)), SolverTests::until(2.0e-6).energy_within(2e-3);
    parted: || super::corner(super::cohesive(100.0).parted()), SolverTests::until(2.0e-6).energy_within(2e-3);
}

/// The scenes crack as intended.
#[test]
fn the_scenes_tear() {
    fn open<const D: usize, M: fpm::Composition<D>>(mut solver: impl Solver, end: f64) -> usize {
        solver.run_until(end).unwrap();
        let solver: &dyn Solver = &solver;
        solver.downcast_ref::<Fpm<D, M>>().map_or(0, |s| s.cracks().len())
    }
    type Torn = Method<PlaneStrain, fpm::Incomplete, MaximumTension>;
    let [before, after] = [1e-9, 16e-6].map(|end| open::<2, Torn>(torn(), end));
    assert!(after > before + 3 && before > 5, "{before} {after}");
    for cracks in [cohesive(100.0), cohesive(100.0).parted()] {
        let after = open::<3, Method<FullSpace, fpm::Symmetric, Cohesive>>(corner(cracks), 2e-6);
        assert!(after > 5, "{after}");
    }
    type Softens = Method<PlaneStrain, fpm::Symmetric, Cohesive>;
    let [halfway, after] = [2e-6, 4e-6].map(|end| open::<2, Softens>(softening(), end));
    assert!(halfway > 100 && after > 100, "{halfway} {after}");
}

#[test]
fn bodies_are_such_that_others_meet() {
    let cells = random([0.0; 2], [6.0 * H, 6.0 * H], H, 2);
    let of = || Fpm::new(Method::symmetric(PlaneStrain), linear(0.3), &cells, |x| noise(x, 0.0)).unwrap();
    mpm_contact::conformance::particle_body(of).unwrap();
    let cells = random([0.0; 3], [4.0 * H; 3], H, 2);
    let of = || Fpm::new(Method::printed(FullSpace), linear(0.3), &cells, |x| noise(x, 0.0)).unwrap();
    mpm_contact::conformance::particle_body(of).unwrap();
}
