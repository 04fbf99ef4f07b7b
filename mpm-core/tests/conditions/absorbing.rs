//! Plane waves at the ends of a bar of unit length: absorbed, or reflected by fixed and free ends.

use super::*;
use mpm_core::{Flip, Linear, Method, Musl, PlaneStrain, QuadraticBSpline};

/// Condition at the ends of the bar.
#[derive(Clone, Copy, Debug)]
enum End {
    Absorbing,
    Fixed,
    Free,
}

#[derive(Clone, Copy, Debug)]
enum Way {
    LinearFlip,
    QuadraticFlip,
    Apic,
}

/// Largest speed in the bar after both halves of a pulse reached an end, over that of the pulse before.
fn reflected(way: Way, end: End, axis: usize, h: f64, courant: f64) -> f64 {
    let period = 4.0 * h;
    let (lattice, seeds) = block([0.0, 0.0], [1.0, period], h);
    let grid = BlockGrid::new(lattice);
    let mut mpm = match way {
        Way::LinearFlip => Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), grid),
        Way::QuadraticFlip => Mpm::new(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), grid),
        Way::Apic => Mpm::new(Method::contact_at_rest(PlaneStrain), grid),
    };
    mpm.bound(Boundary::Periodic { axis: 1, low: 0.0, high: period }).expect("periodic");
    for (at, side) in [(0.0, Side::Above), (1.0, Side::Below)] {
        match end {
            End::Absorbing => {
                let plane =
                    Boundary::Absorbing { axis: 0, at, side, longitudinal: longitudinal(), shear: shear() };
                mpm.bound(plane).expect("plane");
            }
            End::Fixed => mpm.bound(Boundary::Fixed { axis: 0, at, side }).expect("end"),
            End::Free => {}
        }
    }
    // So weak that nothing moves far, and so long that the cells resolve it.
    let pulse = |x: [f64; 2]| 1e-4 * (-((x[0] - 0.5) / 0.1).powi(2)).exp();
    mpm.add("bar", law(), &seeds, |x| if axis == 0 { [pulse(x), 0.0] } else { [0.0, pulse(x)] })
        .expect("bar");
    mpm.set_time_control(TimeControl::Fixed(courant * h / longitudinal())).expect("step");
    let speed = if axis == 0 { longitudinal() } else { shear() };
    mpm.run_until(1.0 / speed).expect("a run");
    let fastest = mpm.bodies()[0].points().iter().map(|p| p.velocity[axis].abs()).fold(0.0, f64::max);
    // Each half of the pulse ran one way; reflections are superposed in the middle again.
    fastest / 1e-4
}

#[test]
fn waves_are_absorbed() {
    let mut worst: f64 = 0.0;
    for way in [Way::LinearFlip, Way::QuadraticFlip, Way::Apic] {
        for axis in 0..2 {
            for (h, courant) in [(0.0125, 0.2), (0.0125, 0.5), (0.0125, 0.8), (0.01, 0.5), (0.00625, 0.5)] {
                let r = reflected(way, End::Absorbing, axis, h, courant);
                println!("{way:?} axis {axis} h {h} courant {courant}: {r:.4}");
                worst = worst.max(r);
            }
        }
    }
    assert!(worst < 0.03, "{worst} comes back");
}

#[test]
fn other_ends_throw_them_back() {
    for end in [End::Fixed, End::Free] {
        for axis in 0..2 {
            let r = reflected(Way::LinearFlip, end, axis, 0.01, 0.5);
            println!("{end:?} axis {axis}: {r:.4}");
            assert!((r - 1.0).abs() < 0.05, "{end:?} along {axis}: {r}");
        }
    }
}

#[test]
fn what_dashpots_take_is_booked_as_work() {
    let (h, period) = (0.02, 0.08);
    let (lattice, seeds) = block([0.0, 0.0], [1.0, period], h);
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    mpm.bound(Boundary::Periodic { axis: 1, low: 0.0, high: period }).expect("periodic");
    for (at, side) in [(0.0, Side::Above), (1.0, Side::Below)] {
        let plane = Boundary::Absorbing { axis: 0, at, side, longitudinal: longitudinal(), shear: shear() };
        mpm.bound(plane).expect("plane");
    }
    let pulse = |x: [f64; 2]| 1e-4 * (-((x[0] - 0.5) / 0.1).powi(2)).exp();
    mpm.add("bar", law(), &seeds, |x| [pulse(x), 0.0]).expect("bar");
    let energy = mpm.totals().kinetic;
    mpm.run_until(1.0 / longitudinal()).expect("a run");
    let account = mpm.account();
    println!("work {} of {energy} J, unexplained {}", account.work, account.unexplained);
    assert!((account.work / energy + 1.0).abs() < 0.01, "{} of {energy} J", account.work);
    assert!(account.energy_error().abs() < 0.01);
    assert!(account.missing() < 1e-12 * account.momentum_scale);
}

#[test]
fn it_must_lie_on_nodes() {
    let (lattice, _) = block([0.0, 0.0], [1.0, 1.0], 0.1);
    let mut mpm: Mpm<2> = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    let plane = Boundary::Absorbing { axis: 0, at: 0.52, side: Side::Above, longitudinal: 1.0, shear: 0.0 };
    let error = mpm.bound(plane).expect_err("between nodes").to_string();
    assert_eq!(
        error,
        "absorbing plane at = 0.52 m is not allowed; it must lie on a plane of nodes (the nearest is 0.5 m)"
    );
}
