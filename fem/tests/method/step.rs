//! Time step: order of convergence, parts, subcycling, conditions.

use std::sync::Arc;

use fem::{Erosion, Fem, MeshBody, Technology};
use impactite_geometry::ElementKind::{Hexa8, Quad4, Tetra4, Triangle3};
use impactite_scene::{Boundary, FullSpace, PlaneStrain, Side, Solver, TimeControl};
use impactite_simd::Team;
use mpm_materials::{Moduli, NeoHookean};

use crate::common::{elastic, flowing, mesh};

/// Largest relative energy error of an oscillating and spinning block of rubber.
fn energy_error(kind: impactite_geometry::ElementKind, technology: Technology, factor: f64) -> f64 {
    let law = NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
    let mut fem = Fem::new(PlaneStrain);
    let spin = |x: [f64; 2]| [-10.0 * x[1] + 3.0 * (x[0] * 3.0).sin(), 10.0 * x[0]];
    fem.add(
        MeshBody::new("block", mesh(kind, [-0.5; 2], [0.5; 2], [6; 2]), law)
            .with(kind, technology)
            .moving(spin),
    )
    .unwrap();
    // Constant step: a change of the step changes the conserved energy.
    let dt = factor * fem.next_time_step();
    fem.set_time_control(TimeControl::Fixed(dt)).unwrap();
    let mut worst = 0.0f64;
    for k in 1..=40 {
        fem.run_until(dt * (0.2 / dt).round() * f64::from(k) / 40.0).unwrap();
        worst = worst.max(fem.account().energy_error().abs());
    }
    assert!(fem.account().missing() < 1e-12 * fem.account().momentum_scale);
    worst
}

#[test]
fn books_of_elastic_bodies_close_with_the_square_of_the_step() {
    let springs = Technology::default_of(Quad4, false);
    for (kind, technology) in
        [(Quad4, springs), (Quad4, Technology::MeanDilatation), (Triangle3, Technology::AveragedVolumes)]
    {
        let errors = [0.4, 0.2, 0.1].map(|factor| energy_error(kind, technology, factor));
        println!("energy errors of {technology:?}: {errors:?}");
        assert!(errors[0] < 1e-3, "{errors:?}");
        assert!(errors[0] / errors[2] > 8.0, "{errors:?}");
    }
}

/// Two cubes, one with large elements: end state, and initial momentum.
fn two(most: u32) -> (Fem<3>, [f64; 3]) {
    let mut fem = Fem::new(FullSpace);
    let steel = || flowing(7850.0, 206e9, 0.3, 400e6);
    let swing = |x: [f64; 3]| [100.0 * (700.0 * x[1]).sin(), 50.0 * (900.0 * x[2]).cos(), 20.0];
    fem.add(MeshBody::new("fine", mesh(Hexa8, [0.0; 3], [1e-3; 3], [4; 3]), steel()).moving(swing)).unwrap();
    fem.add(
        MeshBody::new("coarse", mesh(Hexa8, [2e-3, 0.0, 0.0], [10e-3, 8e-3, 8e-3], [5; 3]), steel())
            .moving(swing),
    )
    .unwrap();
    fem.set_subcycling(most).unwrap();
    let start = fem.totals().momentum;
    fem.run_until(8e-6).unwrap();
    (fem, start)
}

#[test]
fn subcycling_keeps_momentum_and_hardly_changes_the_motion() {
    let ((one, start), (four, _)) = (two(1), two(4));
    let scale = four.totals().momentum_scale;
    for fem in [&one, &four] {
        let now = fem.totals();
        assert!((0..3).all(|d| (now.momentum[d] - start[d]).abs() < 1e-12 * scale));
        assert!(fem.account().energy_error().abs() < 2e-3, "{:?}", fem.account());
    }
    let (a, b) = (one.body(1).nodes(), four.body(1).nodes());
    let apart = |(a, b): (&fem::Node<3>, &fem::Node<3>)| {
        (0..3).map(|d| (a.position[d] - b.position[d]).abs()).fold(0.0, f64::max)
    };
    let most = a.iter().zip(b).map(apart).fold(0.0, f64::max);
    // The displacement is 0.2 mm or more.
    println!("subcycling: nodes are {most:e} m apart");
    assert!(most > 0.0 && most < 2e-5, "{most}");
}

#[test]
fn bits_are_the_same_for_any_number_of_threads() {
    // More elements than the limit for one thread, all passes, and erosion.
    let run = |threads: usize| {
        let steel = || flowing(7850.0, 206e9, 0.3, 200e6);
        let swing = |x: [f64; 3]| [200.0 * (700.0 * x[1]).sin(), 100.0 * (900.0 * x[2]).cos(), -100.0];
        let mut fem = Fem::new(FullSpace);
        let bricks = mesh(Hexa8, [0.0; 3], [9e-3; 3], [9; 3]);
        let body = MeshBody::new("bricks", bricks, steel()).moving(swing);
        fem.add(body.eroding(Erosion::plastic_strain(0.03))).unwrap();
        let simplices = mesh(Tetra4, [20e-3, 0.0, 0.0], [25e-3, 5e-3, 5e-3], [5; 3]);
        fem.add(MeshBody::new("simplices", simplices, steel()).moving(swing)).unwrap();
        fem.bound(Boundary::Wall { axis: 2, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
        fem.set_team(Team::new(threads).unwrap());
        fem.run_until(2e-6).unwrap();
        fem
    };
    let alone = run(1);
    assert!(alone.body(0).eroded().elements > 0);
    for threads in [2, 3] {
        let other = run(threads);
        assert_eq!(alone.exchange(), other.exchange());
        for body in 0..2 {
            assert_eq!(alone.body(body).nodes(), other.body(body).nodes());
            assert_eq!(alone.body(body).surface(), other.body(body).surface());
        }
    }
}

#[test]
fn impulses_of_others_are_booked_with_their_work() {
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("block", mesh(Quad4, [0.0; 2], [1.0; 2], [4; 2]), elastic(1.0, 1.0, 0.3))).unwrap();
    let dt = fem.next_time_step();
    for _ in 0..50 {
        let mut trial = fem.trial(dt).unwrap();
        assert_eq!(trial.dt(), dt);
        let before = trial.bodies()[0].nodes()[12];
        trial.body_mut(0).add_impulse(12, [1e-4, 2e-4]);
        trial.body_mut(0).add_impulse(12, [1e-4, 0.0]);
        let after = trial.bodies()[0].nodes()[12];
        assert!((after.mass * (after.velocity[0] - before.velocity[0]) - 2e-4).abs() < 1e-17);
        trial.finish().unwrap();
    }
    let (now, given) = (fem.totals(), fem.exchange());
    assert!((given.impulse[0] - 1e-2).abs() < 1e-15 && (given.impulse[1] - 1e-2).abs() < 1e-15);
    assert!((now.momentum[0] - 1e-2).abs() < 1e-14);
    assert!((now.kinetic + now.internal - given.work).abs() < 1e-4 * given.work, "{now:?} {given:?}");
    assert!(fem.trial(-1.0).is_err());
}

#[test]
fn absorbing_planes_let_waves_out() {
    let (young, density, n) = (1e9_f64, 1000.0, 100);
    let mut fem = Fem::new(PlaneStrain);
    let h = 1.0 / n as f64;
    // Pulse that travels to the right.
    let pulse = |x: [f64; 2]| {
        [
            if x[0] > 0.3 && x[0] < 0.5 {
                (1.0 - (20.0 * std::f64::consts::PI * (x[0] - 0.3)).cos()) * 1e-3
            } else {
                0.0
            },
            0.0,
        ]
    };
    fem.add(
        MeshBody::new("bar", mesh(Quad4, [0.0; 2], [1.0, h], [n, 1]), elastic(density, young, 0.0))
            .moving(pulse),
    )
    .unwrap();
    let c = (young / density).sqrt();
    for (at, side) in [(0.0, Side::Above), (1.0, Side::Below)] {
        fem.bound(Boundary::Absorbing { axis: 0, at, side, longitudinal: c, shear: c / 2f64.sqrt() })
            .unwrap();
    }
    let start = fem.totals().kinetic;
    fem.run_until(1.2 / c).unwrap();
    let left = fem.totals();
    println!("absorbing: {:.2e} of the energy is left", (left.kinetic + left.internal) / start);
    assert!(left.kinetic + left.internal < 1e-3 * start);
    assert!(fem.account().energy_error().abs() < 5e-3, "{:?}", fem.account());
}

#[test]
fn sets_move_as_they_are_told_and_errors_name_them() {
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("block", mesh(Quad4, [0.0; 2], [1.0; 2], [4; 2]), elastic(1.0, 1.0, 0.3))).unwrap();
    let said = fem.prescribe(0, "top", Arc::new(|_| [None; 3])).unwrap_err().to_string();
    assert!(said.contains("`top`") && said.contains("high y"), "{said}");
    assert!(
        fem.prescribe(3, "high y", Arc::new(|_| [None; 3])).unwrap_err().to_string().contains("body = 3")
    );
    fem.prescribe(0, "low y", Arc::new(|_| [Some(0.0); 3])).unwrap();
    fem.prescribe(0, "high y", Arc::new(|t| [None, Some(1e-4 * t), None])).unwrap();
    fem.set_time_control(TimeControl::Courant { factor: 0.2, growth: 1.1 }).unwrap();
    fem.run_until(2.0).unwrap();
    let top: Vec<_> = fem.body(0).nodes().iter().filter(|n| n.position[1] > 0.99).collect();
    assert!(top.iter().all(|n| (n.position[1] - 1.0 - 2e-4).abs() < 1e-9) && top.len() == 5);
    assert!(fem.account().energy_error().abs() < 5e-4, "{:?}", fem.account());
    let mut broken = Fem::new(PlaneStrain);
    broken
        .add(MeshBody::new("block", mesh(Quad4, [0.0; 2], [1.0; 2], [1; 2]), elastic(1.0, 1.0, 0.3)))
        .unwrap();
    broken
        .prescribe(0, "low y", Arc::new(|t| [Some(if t > 1.0 { f64::NAN } else { 0.0 }), None, None]))
        .unwrap();
    let said = broken.run_until(3.0).unwrap_err().to_string();
    assert!(said.contains("velocity prescribed for the node set `low y` = NaN"), "{said}");
    let periodic = Boundary::Periodic { axis: 0, low: 0.0, high: 1.0 };
    assert!(broken.bound(periodic).unwrap_err().to_string().contains("finite elements"));
}

#[test]
fn bodies_under_initial_stress_rest_where_it_is_in_equilibrium() {
    use impactite_scene::Body;
    use mpm_materials::{Constitutive, LinearElastic};
    for (kind, technology) in [
        (Quad4, Technology::default_of(Quad4, false)),
        (Quad4, Technology::MeanDilatation),
        (Triangle3, Technology::AveragedVolumes),
    ] {
        let mut fem = Fem::new(PlaneStrain);
        fem.add(
            MeshBody::new("block", mesh(kind, [0.0; 2], [1.0; 2], [4; 2]), elastic(1.0, 1.0, 0.3))
                .with(kind, technology),
        )
        .unwrap();
        // Column under its own weight, on rollers.
        let weight = 1e-3;
        fem.set_states::<LinearElastic<f64>>(0, |x, mut state| {
            let down = -weight * (1.0 - x[1]);
            state.stress.0 = [0.3 / 0.7 * down, down, 0.3 / 0.7 * down, 0.0, 0.0, 0.0];
            state
        })
        .unwrap();
        for (axis, at, side) in [(0, 0.0, Side::Above), (0, 1.0, Side::Below), (1, 0.0, Side::Above)] {
            fem.bound(Boundary::Symmetry { axis, at, side }).unwrap();
        }
        fem.set_body_force(Arc::new(move |_| [0.0, -weight]));
        fem.run_until(2.0).unwrap();
        let moved = fem
            .body(0)
            .nodes()
            .iter()
            .zip(&fem.body(0).mesh().nodes)
            .map(|(n, x)| (n.position[1] - x[1]).abs())
            .fold(0.0, f64::max);
        // Without initial stresses the top would move down by about weight/2 = 5e-4.
        assert!(moved < if kind == Quad4 { 1e-12 } else { 5e-5 }, "{technology:?}: {moved}");
        let nan = |_, mut state: <LinearElastic<f64> as Constitutive<f64>>::State<f64>| {
            state.volume_ratio = f64::NAN;
            state
        };
        assert!(
            fem.set_states::<LinearElastic<f64>>(0, nan)
                .unwrap_err()
                .to_string()
                .contains("number of the state = NaN")
        );
        assert!(fem.body(0).len() > 0 && fem.set_states::<crate::common::Flowing>(0, |_, s| s).is_err());
    }
}

#[test]
fn frames_for_paraview_hold_elements() {
    let mut fem = Fem::new(FullSpace);
    fem.add(MeshBody::new("block", mesh(Hexa8, [0.0; 3], [1.0; 3], [3, 2, 2]), elastic(1.0, 1.0, 0.3)))
        .unwrap();
    let snapshot = fem.snapshot().unwrap();
    let cells = snapshot.cells().unwrap();
    // Neighbours share their nodes.
    assert_eq!((snapshot.len(), cells.nodes.len(), cells.corners.len()), (12, 4 * 3 * 3, 12 * 8));
    let folder = std::env::temp_dir().join(format!("impactite-fem-{}", std::process::id()));
    let mut series = impactite_output::VtkSeries::create(&folder, "block").unwrap();
    let file = series.write(&snapshot).unwrap();
    let text = String::from_utf8_lossy(&std::fs::read(&file).unwrap()).into_owned();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(file.extension().unwrap(), "vtu");
    assert!(
        text.contains("<Piece NumberOfPoints=\"36\" NumberOfCells=\"12\">")
            && text.contains("Name=\"types\"")
    );
    assert!(text.contains("<CellData>") && text.contains("Name=\"von_mises\""));
    // Pictures draw points at their true width.
    assert!((snapshot.size_of(0) - (1.0f64 / 12.0).cbrt()).abs() < 1e-12);
}

#[test]
fn a_step_in_parts_is_the_step() {
    let made = || {
        let mut fem = Fem::new(PlaneStrain);
        let block = mesh(Quad4, [0.0; 2], [5e-3; 2], [5; 2]);
        let law = flowing(8930.0, 117e9, 0.35, 200e6);
        fem.add(MeshBody::new("block", block, law).moving(|x| [1e4 * x[1], -100.0])).unwrap();
        fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
        fem.set_body_force(Arc::new(|t| [1e6 * (1e6 * t).sin(), 0.0]));
        fem
    };
    let (mut whole, mut parts) = (made(), made());
    for _ in 0..40 {
        whole.step_at_most(f64::INFINITY).unwrap();
        let dt = parts.next_time_step();
        parts.trial(dt).unwrap().finish().unwrap();
    }
    assert_eq!(whole.body(0).nodes(), parts.body(0).nodes());
    // Sums of two loops and of one.
    let (a, b) = (whole.exchange(), parts.exchange());
    assert!(
        (a.work - b.work).abs() < 1e-12 * a.work.abs() && (a.impulse[1] / b.impulse[1] - 1.0).abs() < 1e-12
    );
}
