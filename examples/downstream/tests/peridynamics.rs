//! Conformance and accuracy of a user-defined method.

use downstream::peridynamics::{Brittle, Plate};
use impactite::geometry::Seeds;
use impactite::prelude::*;
use impactite::scene::solver_conforms;

/// Seed a plate of `width` x `height`, m, with points `h` apart, its lower left corner at the origin.
fn seeds(width: f64, height: f64, h: f64) -> Seeds<2> {
    let plate = Cuboid::new([0.0; 2], [width, height]).expect("shape");
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    fill(&plate, &lattice, 1, &Filling::new()).expect("seeds")
}

fn glass(critical: f64) -> Brittle {
    Brittle { density: 2450.0, young: 72.0e9, critical }
}

const H: f64 = 1.0e-3;
const HORIZON: f64 = 3.015 * H;

/// Build a notched plate that is pulled until it breaks.
fn pulled() -> Plate {
    let velocity = |x: [f64; 2]| [0.0, if x[1] > 10.0 * H { 10.0 } else { -10.0 }];
    let mut plate =
        Plate::new(glass(1.0e-3), &seeds(30.0 * H, 20.0 * H, H), HORIZON, velocity).expect("plate");
    let line = 10.0 * H;
    plate.cut(|x, y| (x[1] < line) != (y[1] < line) && 0.5 * (x[0] + y[0]) < 12.0 * H);
    plate
}

/// Build a plate whose numbers overflow.
fn overflowing() -> Plate {
    let velocity = |x: [f64; 2]| [1.0e300 * x[0], 0.0];
    Plate::new(glass(f64::MAX), &seeds(6.0 * H, 6.0 * H, H), HORIZON, velocity).expect("plate")
}

solver_conforms! {
    plate: super::pulled, SolverTests::until(8.0e-6).energy_within(0.02).breaking(1.0e-3, super::overflowing);
}

/// Speed of a plane wave: c = sqrt((lambda + 2 mu) / rho) with lambda = mu = 0.4 E.
#[test]
fn waves_have_their_speed() {
    let (length, wide) = (0.16, 0.24);
    let pulse = |x: [f64; 2]| [(-((x[0] - 0.03) / 0.01).powi(2)).exp(), 0.0];
    let mut plate = Plate::new(glass(1.0), &seeds(length, wide, H), HORIZON, pulse).expect("plate");
    let speed = (1.2 * 72.0e9_f64 / 2450.0).sqrt();
    let end = 0.1 / speed;
    plate.run_until(end).expect("run");
    // Half of the pulse travels each way. Waves from the sides have not reached the middle line.
    let (mut moment, mut sum) = (0.0, 0.0);
    plate.for_each(&mut |p| {
        if (p.position[1] - 0.5 * wide).abs() < H && p.position[0] > 0.1 {
            sum += p.velocity[0];
            moment += p.velocity[0] * p.position[0];
        }
    });
    let way = moment / sum - 0.03;
    assert!((way / 0.1 - 1.0).abs() < 0.02, "{way} m in the time of 0.1 m");
}

/// The crack propagates from the notch only.
#[test]
fn the_crack_runs_from_the_notch() {
    let mut plate = pulled();
    plate.run_until(2.0e-5).expect("run");
    let (mut on, mut off) = (0, 0);
    plate.for_each(&mut |p| {
        let ahead = p.position[0] > 14.0 * H && p.state[0] > 0.3;
        let line = (p.position[1] - 10.0 * H).abs() < 2.0 * H;
        on += usize::from(ahead && line);
        off += usize::from(ahead && !line);
    });
    assert!(on >= 20 && off == 0, "{on} broken points ahead of the notch, {off} elsewhere");
}
