//! Elements within a body of particles: bars in concrete, with perfect bond.

#![allow(missing_docs)]

mod common;

use std::f64::consts::PI;

use common::{bars, boxed, elastic, seeds};
use coupling::Elements;
use fem::{Erosion, Fem, MeshBody};
use impactite_geometry::Lattice;
use impactite_geometry::structured::box_mesh;
use impactite_simd::Team;
use mpm_contact::{Coulomb, Pairs, SeparatingPlane, SurfaceDistance};
use mpm_core::{
    Aflip, BlockGrid, Boundary, FullSpace, GridContact, Method, Mpm, PlaneStrain, QuadraticBSpline,
    SceneError, Side, Usl,
};
use mpm_materials::{J2, LogarithmicBulk, Moduli, NeoHookean, Solid};

/// Spinning and flying block with a cross of bars, `parts` elements each.
fn spinning(separate: bool, parts: usize) -> Mpm<2> {
    const H: f64 = 0.05;
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let motion = |x: [f64; 2]| [1.0 - 20.0 * (x[1] - 1.0), 20.0 * (x[0] - 1.0)];
    let method = || Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain);
    let grid = BlockGrid::new(lattice);
    let mut mpm = match separate {
        true => {
            let surfaces = SurfaceDistance::new(SeparatingPlane, 0.0).expect("detector").locally();
            let laws = Pairs::new(Coulomb::new(0.3).expect("law"));
            Mpm::with_contact(method(), grid, GridContact::new(surfaces, laws))
        }
        false => Mpm::new(method(), grid),
    };
    let rubber = NeoHookean::new(1100.0, Moduli::young_poisson(1e7, 0.3).expect("moduli")).expect("rubber");
    let block = seeds(&boxed([0.7; 2], [1.3; 2]), &lattice);
    mpm.add("block", rubber, &block, motion).expect("block");
    let mut fem = Fem::new(PlaneStrain);
    let mesh = bars(&[[[0.75, 1.0], [1.25, 1.0]], [[1.0, 0.75], [1.0, 1.25]]], parts);
    let steel = MeshBody::new("bars", mesh, elastic(7850.0, 2e9, 0.0)).section(2e-3);
    fem.add(steel.moving(motion)).expect("bars");
    mpm.add_client(Elements::within(fem, "block").expect("bars")).expect("client");
    mpm
}

#[test]
fn a_block_with_bars_flies_and_spins_as_one() {
    for (separate, parts) in [(false, 5), (false, 10), (true, 10), (false, 20)] {
        let mut mpm = spinning(separate, parts);
        let start = mpm.totals();
        mpm.run_until(PI / 10.0).expect("a turn");
        let now = mpm.totals();
        for d in 0..2 {
            assert!((now.momentum[d] - start.momentum[d]).abs() < 1e-11 * start.momentum_scale, "momentum");
        }
        // Angular momentum about the centre, which moves along the x axis.
        let spin = |t: &mpm_core::Totals| t.angular_momentum[2] + t.momentum[0];
        let error = spin(&now) / spin(&start) - 1.0;
        let energy = (now.kinetic + now.internal) / (start.kinetic + start.internal) - 1.0;
        println!(
            "kept apart from others: {separate}, {parts} parts: angular momentum {error:+.2e}, energy {energy:+.2e}"
        );
        // Errors without bars: -6e-4 and -1.6e-3.
        assert!(error.abs() < 2e-3, "angular momentum {error:+e}");
        assert!(energy.abs() < 4e-3, "energy {energy:+e}");
        // Bars move with the matter: the first bar keeps its length.
        let mut ends = [[0.0; 2]; 2];
        mpm.bodies()[1].for_each(&mut |p| {
            for (n, end) in [(0, 0), (parts - 1, 1)] {
                if p.number == n {
                    ends[end] = [p.position[0], p.position[1]];
                }
            }
        });
        let length = (ends[0][0] - ends[1][0]).hypot(ends[0][1] - ends[1][1]);
        let wanted = 0.5 * (1.0 - 1.0 / parts as f64);
        assert!(
            (length / wanted - 1.0).abs() < 0.03,
            "the middles of its outer elements are {length} m apart"
        );
    }
}

/// Bitwise equality for several threads, and after a checkpoint.
#[test]
fn bits_are_the_same_for_threads_and_after_a_checkpoint() {
    let path = std::env::temp_dir().join(format!("impactite-within-{}", std::process::id()));
    let totals = |threads: usize, broken: bool| {
        let mut mpm = spinning(true, 10);
        mpm.set_team(Team::new(threads).expect("team"));
        mpm.run_until(0.05).expect("run");
        if broken {
            impactite_scene::Solver::save(&mut mpm, &path).expect("saved");
            mpm = spinning(true, 10);
            impactite_scene::Solver::resume(&mut mpm, &path).expect("resumed");
        }
        mpm.run_until(0.1).expect("run");
        let now = mpm.totals();
        [now.kinetic, now.internal, now.momentum[0], now.angular_momentum[2]].map(f64::to_bits)
    };
    let alone = totals(1, false);
    assert_eq!(totals(2, false), alone);
    assert_eq!(totals(1, true), alone);
    let _ = std::fs::remove_file(&path);
}

/// Contact of a body acts on its embedded elements: impact of a block with half its mass in elements on a target.
#[test]
fn what_meets_the_body_meets_its_elements() {
    const H: f64 = 0.05;
    let lattice = Lattice::new([0.0; 3], H).expect("lattice");
    let method = Method::new(QuadraticBSpline, Aflip::default(), Usl, FullSpace);
    let surfaces = SurfaceDistance::new(SeparatingPlane, 0.0).expect("detector").locally();
    let laws = Pairs::new(Coulomb::new(0.0).expect("law"));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), GridContact::new(surfaces, laws));
    let (low, high) = ([0.5, 0.5, 0.5], [0.8, 0.8, 0.8]);
    let law = || elastic(1000.0, 1e7, 0.2);
    mpm.add("matrix", law(), &seeds(&boxed(low, high), &lattice), |_| [2.0, 0.0, 0.0]).expect("matrix");
    mpm.add("target", law(), &seeds(&boxed([0.8, 0.5, 0.5], [1.1, 0.8, 0.8]), &lattice), |_| [0.0; 3])
        .expect("target");
    // Mesh of the same block, as heavy as the matrix.
    let mut fem = Fem::new(FullSpace);
    let mesh = box_mesh(&boxed(low, high), [6; 3]).expect("mesh");
    fem.add(MeshBody::new("core", mesh, law()).moving(|_| [2.0, 0.0, 0.0])).expect("core");
    mpm.add_client(Elements::within(fem, "matrix").expect("core")).expect("client");
    let start = mpm.totals();
    mpm.run_until(0.03).expect("run");
    let now = mpm.totals();
    assert!((now.momentum[0] - start.momentum[0]).abs() < 1e-11 * start.momentum_scale);
    // Elastic impact of mass two on mass one: the target leaves with at most 4/3 of the speed, and at least with the common speed.
    let body = |n: usize| mpm.bodies()[n].totals();
    let speed = |n: usize| body(n).momentum[0] / body(n).mass;
    println!("matrix {:.3}, target {:.3}, core {:.3} m/s", speed(0), speed(1), speed(2));
    assert!(speed(1) > 4.0 / 3.0 && speed(1) < 8.0 / 3.0, "the target leaves with {} m/s", speed(1));
    assert!((speed(0) - speed(2)).abs() < 0.1, "matrix {} and core {} m/s", speed(0), speed(2));
}

/// Bar that is stretched with the rubber around it, yields and fails.
#[test]
fn bars_fail_and_their_mass_stays() {
    const H: f64 = 0.05;
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let pulled = |x: [f64; 2]| [10.0 * (x[0] - 1.0), 0.0];
    let draw = |at_most: Option<f64>| {
        let method = Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        let rubber =
            NeoHookean::new(1100.0, Moduli::young_poisson(1e7, 0.3).expect("moduli")).expect("rubber");
        let block = seeds(&boxed([0.5, 0.9], [1.5, 1.1]), &lattice);
        mpm.add("block", rubber, &block, pulled).expect("block");
        let strength = J2::linear(77e9, 100e6, 1e8).expect("strength");
        let law = Solid::new(strength, LogarithmicBulk::new(7850.0, 167e9).expect("bulk"));
        let mut bar =
            MeshBody::new("bar", bars(&[[[0.6, 1.0], [1.4, 1.0]]], 16), law).section(1e-4).moving(pulled);
        if let Some(strain) = at_most {
            bar = bar.eroding(Erosion::plastic_strain(strain));
        }
        let mut fem = Fem::new(PlaneStrain);
        fem.add(bar).expect("bar");
        mpm.add_client(Elements::within(fem, "block").expect("bar")).expect("client");
        let start = mpm.totals();
        mpm.run_until(8e-3).expect("run");
        let now = mpm.totals();
        assert!((now.momentum[0] - start.momentum[0]).abs() < 1e-11 * start.momentum_scale, "momentum");
        assert!((now.mass / start.mass - 1.0).abs() < 1e-12, "mass");
        (mpm.bodies()[1].len(), now.kinetic, mpm.account().energy_error())
    };
    let (whole, slower, kept) = draw(None);
    let (left, faster, lost) = draw(Some(0.03));
    println!(
        "{whole} elements and {left} points; kinetic energy {slower:.3} and {faster:.3} J; errors {kept:+.1e}, {lost:+.1e}"
    );
    // The strain is uniform, and the whole bar fails: its nodes remain, with its mass.
    assert_eq!((whole, left), (16, 17));
    // The failed bar no longer decelerates the block.
    assert!(faster > slower, "kinetic energy {slower} with, {faster} without the bar");
    assert!(kept.abs() < 0.02 && lost.abs() < 0.02, "energy errors {kept}, {lost}");
}

/// Body force on elements and particles.
#[test]
fn a_block_with_bars_falls_as_one() {
    let mut mpm = spinning(false, 10);
    mpm.set_body_force(|_| [0.0, -10.0]);
    let (start, end) = (mpm.totals(), 0.1);
    mpm.run_until(end).expect("run");
    let now = mpm.totals();
    let gained = (now.momentum[1] - start.momentum[1]) / start.mass;
    assert!((gained / (-10.0 * end) - 1.0).abs() < 1e-9, "{gained} m/s");
    for body in [0, 1] {
        let totals = mpm.bodies()[body].totals();
        // The block spins about the common centre, and starts with 1 m/s along x.
        assert!((totals.momentum[1] / totals.mass + 10.0 * end).abs() < 0.05, "body {body}: {totals:?}");
    }
    assert!(mpm.account().energy_error().abs() < 5e-3, "{:?}", mpm.account());
}

#[test]
fn what_cannot_be_within_says_so() {
    let lattice = Lattice::new([0.0; 2], 0.1).expect("lattice");
    let fem = || {
        let mut fem = Fem::new(PlaneStrain);
        let mesh = bars(&[[[0.2, 0.2], [0.4, 0.2]]], 2);
        fem.add(MeshBody::new("bars", mesh, elastic(7850.0, 2e9, 0.0))).expect("bars");
        fem
    };
    let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
    let nowhere = mpm.add_client(Elements::within(fem(), "block").expect("bars"));
    assert!(matches!(nowhere, Err(SceneError::NotWith { .. })), "{nowhere:?}");
    let mut held = fem();
    held.bound(Boundary::Fixed { axis: 0, at: 0.0, side: Side::Above }).expect("condition");
    assert!(matches!(Elements::within(held, "block"), Err(SceneError::NotWith { .. })));
    let mut heavy = fem();
    heavy.set_body_force(std::sync::Arc::new(|_| [0.0, -10.0]));
    assert!(matches!(Elements::within(heavy, "block"), Err(SceneError::NotWith { .. })));
    assert!(matches!(Elements::within(Fem::<2>::new(PlaneStrain), "block"), Err(SceneError::NoBodies)));
}
