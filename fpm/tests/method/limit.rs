//! The stable time step.

use fpm::{Composition, Fpm, Method, Penalty};
use impactite_scene::{PlaneStrain, Solver, TimeControl, Watch};

use crate::common::{STEEL, lattice, linear, noise, random};

/// Return the stable step, and the growth of the energy of noise in 800 steps of a part of it.
fn growth<M: Composition<2>>(method: M, cells: &fpm::Cells<2>, poisson: f64, part: f64) -> (f64, f64) {
    let mut body = Fpm::new(method, linear(poisson), cells, |x| noise(x, 2.0).map(|v| 1e-3 * v)).unwrap();
    body.set_watch(Watch::off());
    let limit = body.critical_time_step();
    body.set_time_control(TimeControl::Fixed(part * limit)).unwrap();
    let first = body.totals().kinetic;
    for _ in 0..800 {
        if body.step_at_most(f64::INFINITY).is_err() {
            return (limit, f64::INFINITY);
        }
    }
    (limit, body.totals().kinetic / first)
}

/// Noise does not grow 5 % below the stable step, and grows 5 % above it. Return the stable step.
fn brackets<M: Composition<2>>(method: M, cells: &fpm::Cells<2>, poisson: f64) -> f64 {
    let (limit, below) = growth(method, cells, poisson, 0.95);
    assert!(below < 20.0, "{method:?}: noise grows {below:e} times at 0.95 of the limit");
    let (_, above) = growth(method, cells, poisson, 1.05);
    assert!(above > 1e6 || above.is_nan(), "{method:?}: noise grows {above:e} times at 1.05 of the limit");
    limit
}

#[test]
fn the_limit_is_bracketed_for_all_penalties() {
    let cells = lattice([0.0; 2], [14, 14], 1.0);
    let speed = (200e9f64 / STEEL).sqrt();
    for eta in [0.25, 1.0, 2.0, 5.0, 25.0, 100.0] {
        let penalty = Penalty::new(eta).unwrap();
        let limit = brackets(Method::printed(PlaneStrain).with_penalty(penalty), &cells, 0.0);
        if eta >= 1.0 {
            // Closed form: h / (c sqrt(d eta)).
            let closed = 1.0 / (speed * (2.0 * eta).sqrt());
            assert!((limit / closed - 1.0).abs() < 0.05, "eta {eta}: {limit:e} and {closed:e}");
        }
        brackets(Method::symmetric(PlaneStrain).with_penalty(penalty), &cells, 0.3);
    }
}

#[test]
fn the_limit_is_bracketed_on_random_cells() {
    let cells = random([0.0; 2], [14.0; 2], 1.0, 3);
    for eta in [1.0, 5.0, 25.0] {
        let penalty = Penalty::new(eta).unwrap();
        // With a smaller penalty the incomplete flux produces noise by itself.
        if eta > 1.0 {
            brackets(Method::printed(PlaneStrain).with_penalty(penalty), &cells, 0.3);
        }
        brackets(Method::symmetric(PlaneStrain).with_penalty(penalty), &cells, 0.3);
    }
}
