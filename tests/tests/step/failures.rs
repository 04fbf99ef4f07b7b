//! Error handling: a breakdown stops the run in the same step and names its location, invalid input is refused, and
//! every state variable is transferred.

use std::sync::Arc;

use impactite_tests::compare::{particles, plain};
use impactite_tests::laws::Watched;
use impactite_tests::reference::{Order, Rule};
use impactite_tests::scene::{self, block, lattice, metal, seeds};
use mpm_core::Cause;
use mpm_core::SceneError;
use mpm_core::geometry::Lattice;
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, CpGimp, Deformable, DenseGrid, FieldForce, Flip, Gimp, Linear,
    Method, Mpm, Musl, PlaneStrain, QuadraticBSpline, Side, Stopped, TimeControl, Usl,
};
use mpm_materials::{Breakdown, Constitutive};

/// State variables of a particle stay together when it changes its bin and its block.
#[test]
fn every_column_is_carried() {
    let scene = scene::flow::<2>();
    let (seeds, velocity) = &scene.bodies[0];
    let mut mpm = Mpm::new(Method::new(CpGimp, Flip, Usl, PlaneStrain), BlockGrid::new(scene.lattice));
    mpm.add("block", Watched::new(1e9).compiled(), seeds, velocity).expect("body");
    mpm.set_time_control(TimeControl::Fixed(scene.dt)).expect("time control");
    let start = particles(&mpm);
    let bin = |x: [f64; 3]| [0, 1].map(|d| ((x[d] - scene.lattice.origin()[d]) / 0.1).round() as i64);
    let (mut crossed_bins, mut crossed_blocks) = (0, 0);
    let names = mpm.bodies()[0].state_names();
    let column = |name: &str| names.iter().position(|n| n == name).expect(name);
    for step in 1..=60 {
        let before = particles(&mpm);
        mpm.step().expect("step");
        for (p, q) in particles(&mpm)[0].iter().zip(&before[0]) {
            let (new, old) = (bin(p.position), bin(q.position));
            crossed_bins += usize::from(new != old);
            crossed_blocks += usize::from(new.map(|i| i.div_euclid(4)) != old.map(|i| i.div_euclid(4)));
            assert_eq!(p.mass, start[0][p.number].mass, "mass of particle {}", p.number);
            let one = p.state[column("one")];
            assert_eq!(p.state[column("age")], f64::from(step), "age of particle {}", p.number);
            assert_eq!(p.state[column("two")], 2.0 * one, "particle {}", p.number);
            assert_eq!(p.state[column("four")], 4.0 * one, "particle {}", p.number);
            assert_eq!(p.state[column("minus_eight")], -8.0 * one, "particle {}", p.number);
        }
    }
    assert!(crossed_bins > 200 && crossed_blocks > 20, "{crossed_bins} and {crossed_blocks}: no test");
}

/// The error names the first failing particle, also while others leave its bin.
#[test]
fn the_broken_particle_is_named() {
    let scene = scene::flow::<2>();
    let (seeds, velocity) = &scene.bodies[0];
    let mut tested = 0;
    for wanted in 3..25 {
        // The reference determines the particle of largest stretch.
        let mut reference = plain(QuadraticBSpline, Rule::Apic, Order::Usl, &scene);
        reference.add(Watched::new(1e9), seeds, velocity);
        let stretch = |r: &impactite_tests::reference::Reference<2, QuadraticBSpline>| {
            r.points.iter().map(|p| p.state[7]).collect::<Vec<f64>>()
        };
        let mut largest_before = 0.0;
        for _ in 0..wanted - 1 {
            reference.step(scene.dt);
            largest_before = stretch(&reference).into_iter().fold(largest_before, f64::max);
        }
        reference.step(scene.dt);
        let mut ranked: Vec<(usize, f64)> = stretch(&reference).into_iter().enumerate().collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        let (culprit, most) = ranked[0];
        let limit = 0.5 * (most + ranked[1].1);
        if limit <= largest_before {
            continue;
        }
        tested += 1;
        let mut mpm =
            Mpm::new(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), BlockGrid::new(scene.lattice));
        mpm.add("first", metal(), &block(&scene.lattice, [40, 40], [1, 1], 2, 0.0), |_| [0.0; 2])
            .expect("body");
        mpm.add("second", Watched::new(limit).compiled(), seeds, velocity).expect("body");
        mpm.set_time_control(TimeControl::Fixed(scene.dt)).expect("time control");
        let stopped = (0..30).find_map(|_| mpm.step().err()).expect("it must break");
        assert_eq!(stopped.step, wanted, "{stopped}");
        let Stopped::Point { body, number: particle, position, law, cause, .. } = &stopped.what else {
            panic!("{stopped}")
        };
        assert_eq!((body.as_str(), *law, *cause), ("second", "watched", Cause::Law(Breakdown::Law)));
        assert_eq!(*particle, culprit, "step {wanted}: {stopped}");
        for d in 0..2 {
            let error = (position[d] - reference.points[culprit].x[d]).abs();
            assert!(error <= 0.1, "within a cell: {stopped}");
        }
        let text = stopped.to_string();
        for part in ["second", "watched", &culprit.to_string(), &format!("step {wanted}")] {
            assert!(text.contains(part), "`{part}` is missing in: {text}");
        }
    }
    assert!(tested >= 8, "{tested} limits tested");
}

/// The error names the particle that would cross more than a cell, not one that regularly leaves its bin beside it.
#[test]
fn the_runaway_is_named() {
    let lattice = Lattice::new([0.0; 2], 1.0).expect("lattice");
    for runaway in 0..2 {
        let place = seeds(vec![[0.5, 0.5], [3.5, 3.5]], 0.25, 0.25);
        let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
        mpm.add("pair", metal(), &place, |x| {
            let first = x[0] < 1.0;
            [if first == (runaway == 0) { 2.6 } else { 0.9 }, 0.0]
        })
        .expect("body");
        mpm.set_time_control(TimeControl::Fixed(1.0)).expect("time control");
        let stopped = mpm.step().expect_err("too fast");
        let Stopped::Point { number: particle, position, cause, .. } = &stopped.what else {
            panic!("{stopped}")
        };
        assert_eq!((*particle, *cause, stopped.step), (runaway, Cause::TooFast, 1), "{stopped}");
        let near = if runaway == 0 { 0.5 } else { 3.5 };
        assert!((position[1] - near).abs() <= 1.0, "{stopped}");
    }
}

/// A time step above the stability limit ends in a named breakdown, not in invalid results.
#[test]
fn too_large_a_time_step_is_found_out() {
    let scene = scene::bar::<2>();
    let (seeds, velocity) = &scene.bodies[0];
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(scene.lattice));
    mpm.add("bar", metal(), seeds, velocity).expect("body");
    impactite_tests::compare::surround(&mut mpm, &scene);
    mpm.set_time_control(TimeControl::Fixed(20.0 * scene.dt)).expect("time control");
    let stopped = (0..50).find_map(|_| mpm.step().err()).expect("it must break");
    assert!(matches!(stopped.what, Stopped::Point { .. }), "{stopped}");
    for body in particles(&mpm) {
        for p in body {
            let all = p.stress.iter().chain(&p.position).chain(&p.velocity);
            assert!(all.into_iter().all(|x| !x.is_nan()) || p.number == named(&stopped), "{p:?}");
        }
    }
}

fn named(e: &mpm_core::StepError) -> usize {
    match e.what {
        Stopped::Point { number: particle, .. } => particle,
        _ => usize::MAX,
    }
}

/// A load that becomes NaN or infinite stops the step in which it acts.
#[test]
fn not_a_number_stops_in_the_same_step() {
    let lattice = lattice::<2>();
    let dt = 0.02;
    for bad in [f64::NAN, f64::INFINITY] {
        let mut mpm =
            Mpm::new(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), BlockGrid::new(lattice));
        mpm.add("block", metal(), &block(&lattice, [0, 0], [2, 2], 2, 0.0), |_| [0.0; 2]).expect("body");
        mpm.set_time_control(TimeControl::Fixed(dt)).expect("time control");
        mpm.set_body_force(move |t| [if t > 3.5 * dt { bad } else { 0.0 }, 0.0]);
        for _ in 0..4 {
            mpm.step().expect("a good step");
        }
        let stopped = mpm.step().expect_err("not a number");
        assert_eq!(stopped.step, 5);
        let text = stopped.to_string();
        for part in ["body force", "must be finite", "step 5"] {
            assert!(text.contains(part), "`{part}` is missing in: {text}");
        }
        // Force field on particles, checked where it acts.
        let mut mpm =
            Mpm::new(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), BlockGrid::new(lattice));
        let force =
            FieldForce { acceleration: Arc::new(move |_, t| [if t > 3.5 * dt { bad } else { 0.0 }, 0.0]) };
        let seeds = block(&lattice, [0, 0], [2, 2], 2, 0.0);
        mpm.add_body(Deformable::new("block", metal(), &seeds).with_field_force(force)).expect("body");
        mpm.set_time_control(TimeControl::Fixed(dt)).expect("time control");
        let stopped = (0..8).find_map(|_| mpm.step().err()).expect("not a number");
        let text = stopped.to_string();
        for part in ["block", "linear elastic"] {
            assert!(text.contains(part), "`{part}` is missing in: {text}");
        }
        assert!((5..=6).contains(&stopped.step), "{text}");
        // The reported position is the last finite one; a volume of NaN is not reported as inverted.
        let Stopped::Point { position, cause, .. } = stopped.what else { panic!("{text}") };
        assert!(position.iter().all(|x| x.is_finite()), "{text}");
        assert_ne!(cause, Cause::Law(Breakdown::InvertedVolume), "{text}");
    }
}

fn mpm2() -> Mpm<2> {
    Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice()))
}

#[track_caller]
fn refused(result: Result<(), SceneError>, parts: &[&str]) {
    let text = result.expect_err("must be refused").to_string();
    for part in parts {
        assert!(text.contains(part), "`{part}` is missing in: {text}");
    }
}

#[test]
fn bad_bodies_are_refused() {
    let good = || block(&lattice(), [0, 0], [1, 1], 2, 0.0);
    let still = |_| [0.0; 2];
    refused(
        mpm2().add("empty one", metal(), &seeds(vec![], 1.0, 0.01), still),
        &["empty one", "no particles"],
    );
    let mut large = good();
    large.half_size = [0.025, 0.125];
    refused(mpm2().add("large", metal(), &large, still), &["large", "axis 1", "1.25", "(0, 0.5]"]);
    for (value, text) in [(f64::NAN, "NaN"), (0.0, "0"), (-1.5, "-1.5"), (f64::INFINITY, "inf")] {
        let mut bad = good();
        bad.volumes[2] = value;
        refused(mpm2().add("b", metal(), &bad, still), &["`b`", "volume", "particle 2", text]);
    }
    for (value, text) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf"), (1e12, "1000000000000")] {
        let mut bad = good();
        bad.positions[1][1] = value;
        refused(mpm2().add("b", metal(), &bad, still), &["`b`", "position", "particle 1", text]);
    }
    let mut short = good();
    short.volumes.pop();
    refused(mpm2().add("b", metal(), &short, still), &["`b`", "3 volumes", "4 positions"]);
    let fast = |x: [f64; 2]| if x[0] < good().positions[1][0] { [0.0; 2] } else { [f64::NAN, 0.0] };
    refused(mpm2().add("b", metal(), &good(), fast), &["`b`", "velocity", "particle 1", "NaN"]);

    let at_zero = Lattice::new([0.0; 2], 0.1).expect("lattice");
    let mut mpm = Mpm::new(Method::new(Gimp, Flip, Usl, Axisymmetric).compiled(), BlockGrid::new(at_zero));
    let behind = seeds(vec![[-0.02, 0.1]], 1.0, 0.01);
    refused(mpm.add("ring", metal(), &behind, still), &["ring", "r = -0.02", "positive"]);

    let grid = DenseGrid::new(at_zero, [0, 0], [7, 7]).expect("box");
    let mut mpm = Mpm::new(Method::new(Gimp, Flip, Usl, PlaneStrain).compiled(), grid);
    let outside = seeds(vec![[3.0, 0.35]], 1.0, 0.01);
    refused(mpm.add("far", metal(), &outside, still), &["far", "dense grid"]);
    assert_eq!(mpm.particles(), 0, "a refused body is not there");
}

#[test]
fn bad_surroundings_are_refused() {
    let plane = |axis, at| Boundary::Symmetry { axis, at, side: Side::Above };
    refused(mpm2().bound(plane(2, 0.0)), &["axis = 2", "dimension 2"]);
    refused(mpm2().bound(plane(0, 0.05)), &["0.05", "plane of nodes"]);
    refused(
        mpm2().bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Below, velocity: f64::NAN }),
        &["velocity = NaN"],
    );
    refused(mpm2().bound(Boundary::Fixed { axis: 0, at: f64::INFINITY, side: Side::Below }), &["at = inf"]);
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused(mpm2().set_time_control(TimeControl::Fixed(dt)), &["dt", &dt.to_string()]);
    }
    refused(
        mpm2().set_time_control(TimeControl::Courant { factor: -0.5, growth: 1.1 }),
        &["factor = -0.5", "positive"],
    );
    refused(
        mpm2().set_time_control(TimeControl::Courant { factor: 0.5, growth: 1.0 }),
        &["growth = 1", "above 1"],
    );
}

/// The error names the particle that leaves a dense grid, with body, position and law.
#[test]
fn leaving_the_grid_is_reported() {
    let at_zero = Lattice::new([0.0; 2], 0.1).expect("lattice");
    let grid = DenseGrid::new(at_zero, [0, 0], [15, 15]).expect("box");
    let mut mpm = Mpm::new(Method::new(Gimp, Flip, Usl, PlaneStrain).compiled(), grid);
    mpm.add("rock", metal(), &block(&at_zero, [4, 4], [2, 2], 2, 0.0), |_| [0.0; 2]).expect("body");
    mpm.add("stone", metal(), &block(&at_zero, [8, 8], [2, 2], 2, 0.0), |_| [1.0, 0.0]).expect("body");
    mpm.set_time_control(TimeControl::Fixed(0.02)).expect("time control");
    let stopped = (0..60).find_map(|_| mpm.step().err()).expect("it must leave");
    let Stopped::Outside { body, particle, position, law, .. } = &stopped.what else { panic!("{stopped}") };
    assert_eq!((body.as_str(), *law), ("stone", "linear elastic"));
    let (mut front, mut there) = (f64::MIN, [0.0; 3]);
    mpm.bodies()[1].for_each(&mut |p| {
        front = front.max(p.position[0]);
        if p.number == *particle {
            there = p.position;
        }
    });
    // One of the foremost particles requests the next nodes; they move together.
    assert_eq!(*position, there, "{stopped}");
    assert!(there[0] > front - 1e-9, "{stopped}");
    let text = stopped.to_string();
    for part in ["stone", "linear elastic", &particle.to_string()] {
        assert!(text.contains(part), "`{part}` is missing in: {text}");
    }
    assert!(!text.contains("rock"), "{text}");
}
