//! Elastic bars of known frequency: the period error is of second order in the cell size, and the energy loss
//! agrees with theory.

use impactite_tests::compare::particles;
use impactite_tests::scene::block;
use mpm_core::geometry::Lattice;
use mpm_core::{
    BlockGrid, Boundary, Composition, Flip, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain,
    QuadraticBSpline, Side, TimeControl, Usl,
};
use mpm_materials::{LinearElastic, Moduli};

/// Build a bar of `cells` cells along x, one cell high, between symmetry planes: one-dimensional, since Poisson's
/// ratio is zero. Length 1, density 1, Young's modulus 1: c = 1.
fn bar<M: IntoKernels<f64, 2>>(method: M, cells: usize, held: bool, velocity: impl Fn(f64) -> f64) -> Mpm<2> {
    let h = 1.0 / cells as f64;
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.0).expect("moduli")).expect("law");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("bar", law, &block(&lattice, [0, 0], [cells, 1], 2, 0.0), |x| [velocity(x[0]), 0.0])
        .expect("body");
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).expect("boundary");
    mpm.bound(Boundary::Symmetry { axis: 1, at: h, side: Side::Below }).expect("boundary");
    if held {
        mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("boundary");
    }
    mpm.set_time_control(TimeControl::Fixed(0.3 * h)).expect("time control");
    mpm
}

/// Measure the period of the momentum of a bar held at one end, from the first and the last sign change.
fn period<M: IntoKernels<f64, 2>>(method: M, cells: usize) -> f64 {
    let mut mpm = bar(method, cells, true, |x| 1e-5 * (std::f64::consts::FRAC_PI_2 * x).sin());
    let mut last = mpm.totals().momentum[0];
    let mut crossings = vec![];
    while mpm.time() < 5.2 * 4.0 {
        let before = mpm.time();
        mpm.step().expect("step");
        let now = mpm.totals().momentum[0];
        if last * now < 0.0 {
            crossings.push(before + (mpm.time() - before) * last / (last - now));
        }
        last = now;
    }
    let halves = crossings.len() as f64 - 1.0;
    2.0 * (crossings[crossings.len() - 1] - crossings[0]) / halves
}

/// V1: fixed-free bar, period 4 L / c.
fn period_error_falls_as_the_square<M: Composition<f64, 2> + IntoKernels<f64, 2>>(method: M, predicted: f64) {
    let errors = [10, 20, 40].map(|cells| period(method, cells) / 4.0 - 1.0);
    let name = method.describe();
    println!("{name}: {errors:?}");
    // 10 cells per quarter wave are 20 per half wave; finding 9 of the accuracy notes.
    assert!((errors[0].abs() / predicted - 1.0).abs() < 0.25, "{name}: {} not {predicted}", errors[0]);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.15, "{name}: order {order}");
    }
}

#[test]
fn period_of_the_hat() {
    period_error_falls_as_the_square(Method::new(Linear, Flip, Musl, PlaneStrain), 3.3e-3);
}

#[test]
fn period_of_the_quadratic_spline() {
    period_error_falls_as_the_square(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), 6.4e-3);
}

/// Relative energy loss of a free bar of 20 cells in 10 periods of its first mode at a Courant number of 0.3.
/// Energies are period means, since kinetic and stored energy are half a step apart in time.
fn lost<M: IntoKernels<f64, 2>>(method: M) -> f64 {
    let cells = 20;
    let mut mpm = bar(method, cells, false, |x| 1e-5 * (std::f64::consts::PI * x).cos());
    let steps = (2.0 * cells as f64 / 0.3).round() as usize;
    let mut mean = || {
        let mut sum = 0.0;
        for _ in 0..steps {
            mpm.step().expect("step");
            let t = mpm.totals();
            sum += t.kinetic + t.internal;
        }
        sum / steps as f64
    };
    let first = mean();
    for _ in 0..9 {
        mean();
    }
    1.0 - mean() / first
}

/// Finding 3: USL loses (omega dt)^2 (p + 1) theta^2 / 12 of the energy per step, MUSL none.
#[test]
fn energy_of_a_free_bar() {
    let theta = std::f64::consts::PI / 20.0;
    let omega_dt = theta * 0.3;
    let steps = 10.0 * 2.0 * 20.0 / 0.3;
    let predicted =
        |degree: f64| 1.0 - (-omega_dt * omega_dt * (degree + 1.0) * theta * theta / 12.0 * steps).exp();
    for (name, degree, found) in [
        ("linear", 1.0, lost(Method::new(Linear, Flip, Usl, PlaneStrain).compiled())),
        ("quadratic", 2.0, lost(Method::new(QuadraticBSpline, Flip, Usl, PlaneStrain).compiled())),
    ] {
        let wanted = predicted(degree);
        println!("USL {name}: lost {found}, predicted {wanted}");
        assert!((found / wanted - 1.0).abs() < 0.3, "USL {name}: lost {found}, predicted {wanted}");
    }
    for (name, found) in [
        ("linear", lost(Method::new(Linear, Flip, Musl, PlaneStrain))),
        ("quadratic", lost(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain))),
    ] {
        println!("MUSL {name}: lost {found}");
        assert!(found.abs() < 1e-3, "MUSL {name}: lost {found}");
    }
}

/// A bar held by a symmetry plane moves like half of a free bar.
#[test]
fn the_bar_is_one_dimensional() {
    let mut mpm = bar(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), 10, true, |x| 1e-3 * x);
    for _ in 0..50 {
        mpm.step().expect("step");
    }
    for p in &particles(&mpm)[0] {
        assert!(p.velocity[1].abs() < 1e-16, "{p:?}");
        assert!(p.stress[1].abs() < 1e-15 && p.stress[5].abs() < 1e-15, "{p:?}");
    }
}
