//! Custom conditions on the grid.

use super::*;
use impactite_scene::{Condition, Place, Reaction};
use mpm_core::{Aflip, Flip, Linear, Method, Musl, PlaneStrain, QuadraticBSpline, Usf, Usl};

/// Clamp of everything below a line: [`Boundary::Fixed`] written by a user.
#[derive(Debug)]
struct Clamp(f64);

impl Condition<2> for Clamp {
    fn reaches(&self, low: &[f64; 2], _: &[f64; 2], _: f64) -> bool {
        low[1] <= self.0
    }
    fn react(&self, place: &Place<2>) -> Reaction<2> {
        let below = place.position[1] <= self.0 + place.tolerance;
        if below { Reaction::hold(place, [0.0; 2], [true; 2]) } else { Reaction::none() }
    }
}

/// Condition with a reaction that is not a number at some time.
#[derive(Debug)]
struct Faulty;

impl Condition<2> for Faulty {
    fn react(&self, place: &Place<2>) -> Reaction<2> {
        Reaction { impulse: [if place.time > 0.0 { f64::NAN } else { 0.0 }, 0.0], ..Reaction::none() }
    }
}

fn scene(mut mpm: Mpm<2>, seeds: &Seeds<2>, boundary: Boundary<2>) -> Mpm<2> {
    mpm.add("block", law(), seeds, |x| [0.1 * x[1], -0.2 * x[0]]).expect("block");
    mpm.bound(boundary).expect("boundary");
    mpm.set_body_force(|_| [1.0, -10.0]);
    mpm.set_time_control(TimeControl::Fixed(5e-4)).expect("step");
    mpm
}

#[test]
fn a_clamp_of_ones_own_is_a_fixed_plane() {
    let (lattice, seeds) = block([0.0, 0.0], [0.5, 0.5], 0.1);
    let grid = || BlockGrid::new(lattice);
    let makes: [(&str, &dyn Fn() -> Mpm<2>); 4] = [
        ("stress last, mapped again", &|| Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), grid())),
        ("affine", &|| Mpm::new(Method::contact_at_rest(PlaneStrain), grid())),
        ("affine FLIP", &|| {
            Mpm::new(Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain), grid())
        }),
        ("stress first", &|| Mpm::new(Method::new(Linear, Flip, Usf, PlaneStrain).compiled(), grid())),
    ];
    for (name, make) in makes {
        let run = |boundary| {
            let mut mpm = scene(make(), &seeds, boundary);
            mpm.run_until(0.1).expect("a run");
            (bits(&mpm), mpm.exchange())
        };
        let (fixed, given) = run(Boundary::Fixed { axis: 1, at: 0.0, side: Side::Above });
        let (own, gave) = run(Boundary::own(Clamp(0.0)));
        for (a, b) in fixed.iter().zip(&own) {
            for (x, y) in a.iter().zip(b) {
                assert!((x - y).abs() <= 1e-12 * (1.0 + x.abs()), "{name}: {a:?} and {b:?}");
            }
        }
        let (a, b) = (given.impulse[1], gave.impulse[1]);
        assert!((a - b).abs() <= 1e-10 * a.abs(), "{name}: {a} and {b} N s");
        assert!((given.work - gave.work).abs() <= 1e-10 * given.work.abs() && gave.friction == 0.0, "{name}");
    }
}

#[test]
fn what_is_no_number_stops_the_step_it_arises_in() {
    let (lattice, seeds) = block([0.0, 0.0], [0.5, 0.5], 0.1);
    let mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    let mut mpm = scene(mpm, &seeds, Boundary::own(Faulty));
    mpm.step().expect("a sound step");
    let error = mpm.step().expect_err("not a number").to_string();
    assert!(error.starts_with("step 2 ") && error.contains("block"), "{error}");
}
