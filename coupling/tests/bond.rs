//! Bond with slip of bars within a body of particles.

#![allow(missing_docs)]

mod common;

use std::f64::consts::PI;

use common::{boxed, elastic, half_period, seeds};
use coupling::{BondLaw, BondState, Elements, LinearBond, ModelCodeBond};
use fem::{Fem, MeshBody};
use impactite_geometry::{ElementBlock, ElementKind, ElementMesh, Lattice, structured::box_mesh};
use impactite_simd::Team;
use mpm_core::{
    Aflip, BlockGrid, Boundary, Flip, Linear, Method, Mpm, Musl, PlaneStrain, QuadraticBSpline, SceneError,
    Side, Usl,
};

/// Bar along a polyline, with `parts` elements per segment.
fn bar(mesh: &mut ElementMesh<2>, points: &[[f64; 2]], parts: usize) {
    let mut links = Vec::new();
    for (k, ends) in points.windows(2).enumerate() {
        for n in usize::from(k > 0)..=parts {
            let part = n as f64 / parts as f64;
            if k > 0 || n > 0 {
                let last = mesh.nodes.len() as u32;
                links.extend([last - 1, last]);
            }
            mesh.nodes.push(std::array::from_fn(|d| ends[0][d] + part * (ends[1][d] - ends[0][d])));
        }
    }
    mesh.blocks.push(ElementBlock { name: "bars".into(), kind: ElementKind::Bar2, nodes: links });
}

fn empty() -> ElementMesh<2> {
    ElementMesh { nodes: Vec::new(), blocks: Vec::new(), ..ElementMesh::default() }
}

/// Shear lag of a bar in evenly strained matter [Cox1952]: E A s'' = k p s, with no force at its ends, so that its stress is E eps (1 -
/// cosh(kappa x) / cosh(kappa L)), kappa = sqrt(k p / E A).
#[test]
fn a_bar_in_strained_matter_takes_the_stress_of_shear_lag() {
    const HALF: f64 = 0.25;
    const YOUNG: f64 = 200e9;
    const SECTION: f64 = 1e-4;
    let (rate, end) = (0.2, 5e-3);
    for (kappa, elements) in [(8.0, 40), (8.0, 20), (20.0, 40)] {
        let lattice = Lattice::new([0.0; 2], 0.025).expect("lattice");
        // Heavy matter, which the bar hardly decelerates: it takes 3e-3 of its velocity.
        let pulled = move |x: [f64; 2]| [rate * (x[0] - 0.5), 0.0];
        let method = Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        let block = seeds(&boxed([0.2, 0.2], [0.8, 0.3]), &lattice);
        mpm.add("matter", elastic(1e7, 1e6, 0.0), &block, pulled).expect("matter");
        let mut mesh = empty();
        bar(&mut mesh, &[[0.5 - HALF, 0.25], [0.5 + HALF, 0.25]], elements);
        let mut fem = Fem::new(PlaneStrain);
        fem.add(MeshBody::new("bar", mesh, elastic(7850.0, YOUNG, 0.0)).section(SECTION).moving(pulled))
            .expect("bar");
        let bond = LinearBond::new(kappa * kappa * YOUNG * SECTION).expect("bond");
        let within = Elements::within(fem, "matter").expect("within").with_bond(bond, 1.0).expect("bond");
        mpm.add_client(within).expect("client");
        mpm.run_until(end).expect("run");
        let full = YOUNG * rate * mpm.time();
        let (mut worst, mut largest) = (0.0f64, 0.0f64);
        mpm.bodies()[1].for_each(&mut |p| {
            let x = p.position[0] - 0.5;
            let wanted = 1.0 - (kappa * x).cosh() / (kappa * HALF).cosh();
            worst = worst.max((p.stress[0] / full - wanted).abs());
            largest = largest.max(p.stress[0] / full);
        });
        println!("kappa {kappa}, {elements} elements: off by {worst:.4} of E eps, largest {largest:.4}");
        // Oscillation about the solution: 1 / omega t = 5e-3; error of elements of 0.25 / kappa: kappa^2 h^2 / 12 = 5e-3.
        assert!(worst < 0.02, "kappa {kappa}, {elements} elements: {worst}");
    }
}

/// Concrete with a fiftieth of steel that oscillates in its first mode.
fn swaying(bond: LinearBond) -> Mpm<2> {
    const HEIGHT: f64 = 0.1;
    let lattice = Lattice::new([0.0; 2], 0.025).expect("lattice");
    let mode = |x: [f64; 2]| [1e-2 * (PI * x[0]).cos(), 0.0];
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    mpm.add(
        "concrete",
        elastic(2440.0, 34e9, 0.0),
        &seeds(&boxed([0.0, 0.0], [1.0, HEIGHT]), &lattice),
        mode,
    )
    .expect("concrete");
    let mut mesh = empty();
    for n in 0..4 {
        let y = HEIGHT * (f64::from(n) + 0.5) / 4.0;
        bar(&mut mesh, &[[0.0, y], [1.0, y]], 40);
    }
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("bars", mesh, elastic(7850.0, 200e9, 0.0)).section(0.005 * HEIGHT).moving(mode))
        .expect("bars");
    mpm.add_client(Elements::within(fem, "concrete").expect("bars").with_bond(bond, 1.0).expect("bond"))
        .expect("client");
    mpm
}

/// Speed of long waves with stiff bond, over that of both materials together (`long_waves.rs`).
#[test]
fn stiff_bond_is_perfect_bond() {
    let mut mpm = swaying(LinearBond::new(1e13).expect("bond"));
    let start = mpm.totals();
    let expected = ((34e9 + 0.02 * 200e9) / (2440.0 + 0.02 * 7850.0_f64)).sqrt();
    let speed = 1.0 / half_period(&mut mpm, 1.0, 16.0 / expected) / expected;
    println!("{speed:.5} of the speed, energy error {:+.1e}", mpm.account().energy_error());
    assert!((speed - 1.0).abs() < 5e-3, "{speed}");
    assert!((mpm.totals().momentum[0] - start.momentum[0]).abs() < 1e-12 * start.momentum_scale);
}

/// Block with bars that flies at a wall, and rises.
fn flying(bond: Option<LinearBond>, mesh: ElementMesh<2>) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], 0.025).expect("lattice");
    let motion = |_: [f64; 2]| [-2.0, 0.5];
    let method = Method::new(QuadraticBSpline, Aflip::default(), Usl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 }).expect("wall");
    mpm.add("block", elastic(1000.0, 1e8, 0.0), &seeds(&boxed([0.0, 0.3], [0.5, 0.5]), &lattice), motion)
        .expect("block");
    let mut fem = Fem::new(PlaneStrain);
    fem.add(MeshBody::new("bar", mesh, elastic(7850.0, 2e9, 0.0)).section(1e-3).moving(motion)).expect("bar");
    let mut within = Elements::within(fem, "block").expect("within");
    if let Some(bond) = bond {
        within = within.with_bond(bond, 1.0).expect("bond");
    }
    mpm.add_client(within).expect("client");
    mpm
}

fn straight() -> ElementMesh<2> {
    let mut mesh = empty();
    bar(&mut mesh, &[[0.15, 0.4], [0.4, 0.4]], 20);
    mesh
}

/// Mean velocity of a body.
fn mean(mpm: &Mpm<2>, body: usize) -> [f64; 2] {
    let totals = mpm.bodies()[body].totals();
    [totals.momentum[0] / totals.mass, totals.momentum[1] / totals.mass]
}

/// Without bond a bar slides on along its axis, and moves with the matter across it.
#[test]
fn without_bond_a_bar_slides_and_is_carried_across() {
    let none = LinearBond::new(1.0).expect("bond");
    let (mut free, mut tied) = (flying(Some(none), straight()), flying(None, straight()));
    for mpm in [&mut free, &mut tied] {
        mpm.run_until(5e-3).expect("run");
    }
    println!("free {:?} in {:?}, tied {:?}", mean(&free, 1), mean(&free, 0), mean(&tied, 1));
    // The matter has rebounded; the remaining error is that of its acceleration in the last step: dt a.
    assert!(mean(&free, 0)[0] > 0.0 && mean(&tied, 1)[0] > 0.0);
    assert!((mean(&free, 1)[0] + 2.0).abs() < 0.02, "{:?}", mean(&free, 1));
    assert!((mean(&free, 1)[1] - 0.5).abs() < 0.02, "{:?}", mean(&free, 1));
}

/// Relative oscillation of steel and concrete with weak bond: a bar needs rho a dv/dt = 470 Pa to move with the concrete, without its own
/// stiffness.
#[test]
fn momentum_and_energy_are_kept_where_bars_slide_with_friction() {
    let bond = LinearBond::new(1e11).and_then(|bond| bond.with_strength(100.0, 100.0)).expect("bond");
    let mut mpm = swaying(bond);
    let start = mpm.totals();
    mpm.run_until(2e-4).expect("run");
    let first = mpm.account().energy_error();
    mpm.run_until(1e-3).expect("run");
    let account = mpm.account();
    let (part, error) = (account.friction / start.kinetic, account.energy_error());
    println!(
        "friction {part:.4} of the energy, error {error:+.2e}, momentum missing {:.1e}",
        account.missing() / account.momentum_scale
    );
    assert!(part > 0.01, "friction {part}");
    assert!(account.missing() < 1e-12 * account.momentum_scale, "momentum {}", account.missing());
    // Bars lose 1.2e-2 of the energy when they break loose, within 2e-4 s, for a reason not known; the fifth of the energy that friction
    // dissipates afterwards is booked to a fortieth of it.
    assert!((error - first).abs() < 5e-3, "energy {first:+e}, {error:+e}");
    assert!(first.abs() < 1.5e-2 && error.abs() < 1.5e-2, "energy {first:+e}, {error:+e}");
}

#[test]
fn bits_are_the_same_for_threads_and_after_a_checkpoint() {
    let path = std::env::temp_dir().join(format!("impactite-bond-{}", std::process::id()));
    let make = || {
        let bond = LinearBond::new(1e11).and_then(|bond| bond.with_strength(5e4, 2e4)).expect("bond");
        flying(Some(bond), straight())
    };
    let totals = |threads: usize, broken: bool| {
        let mut mpm = make();
        mpm.set_team(Team::new(threads).expect("team"));
        mpm.run_until(1.5e-3).expect("run");
        if broken {
            impactite_scene::Solver::save(&mut mpm, &path).expect("saved");
            mpm = make();
            impactite_scene::Solver::resume(&mut mpm, &path).expect("resumed");
        }
        mpm.run_until(3e-3).expect("run");
        let (now, account) = (mpm.totals(), mpm.account());
        assert!(account.friction > 0.0);
        [now.kinetic, now.internal, now.momentum[0], account.friction].map(f64::to_bits)
    };
    let alone = totals(1, false);
    assert_eq!(totals(2, false), alone);
    assert_eq!(totals(1, true), alone);
    let _ = std::fs::remove_file(&path);
}

/// Bar of the same length along the block with a hook: it moves with the matter, while a straight bar slides on.
#[test]
fn a_hook_holds() {
    let weak = LinearBond::new(1e11).and_then(|bond| bond.with_strength(1e3, 1e3)).expect("bond");
    let mut hooked = empty();
    bar(&mut hooked, &[[0.4, 0.4], [0.15, 0.4], [0.15, 0.45]], 10);
    let velocity = |mesh| {
        let mut mpm = flying(Some(weak), mesh);
        mpm.run_until(4e-3).expect("run");
        mean(&mpm, 1)[0]
    };
    let (straight, hooked) = (velocity(straight()), velocity(hooked));
    println!("straight {straight:.3} m/s, hooked {hooked:.3} m/s");
    assert!(straight < -1.5, "straight {straight}");
    assert!(hooked > 0.0, "hooked {hooked}");
}

/// Values of the curve by its formula, and a load cycle by hand.
#[test]
fn the_curve_of_the_model_code() {
    let law = ModelCodeBond::new(12e6, 4.8e6, [1e-3, 2e-3, 5e-3], 0.4, 2e11).expect("law");
    let mut state = BondState::default();
    let mut at = |slip: f64| law.stress(slip, &mut state);
    let is = |stress: f64, wanted: f64| assert!((stress - wanted).abs() < 1e-9 * 12e6, "{stress} {wanted}");
    is(at(1e-6), 2e5);
    // (1/32)^0.4 = 1/4.
    is(at(1e-3 / 32.0), 3e6);
    is(at(1.5e-3), 12e6);
    // Unloading by 12 MPa / 2e11 Pa/m, then friction backwards, and friction forwards until 1.5 mm are reached again.
    is(at(1.5e-3 - 3e-5), 6e6);
    is(at(1e-3), -4.8e6);
    is(at(1.4e-3), 4.8e6);
    is(at(1.6e-3), 12e6);
    is(at(3.5e-3), 8.4e6);
    is(at(8e-3), 4.8e6);
    is(at(-9e-3), -4.8e6);
}

#[test]
fn what_cannot_be_says_so() {
    let parameter = |result: Result<(), SceneError>| {
        assert!(matches!(result, Err(SceneError::Parameter { .. })), "{result:?}");
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        parameter(LinearBond::new(bad).map(|_| ()));
    }
    let linear = || LinearBond::new(1e10).expect("bond");
    parameter(linear().with_strength(0.0, 0.0).map(|_| ()));
    parameter(linear().with_strength(1e6, 2e6).map(|_| ()));
    let code =
        |tau, rest, slips, alpha, k| parameter(ModelCodeBond::new(tau, rest, slips, alpha, k).map(|_| ()));
    let slips = [1e-3, 2e-3, 5e-3];
    code(0.0, 0.0, slips, 0.4, 2e11);
    code(12e6, 13e6, slips, 0.4, 2e11);
    code(12e6, 5e6, [0.0, 2e-3, 5e-3], 0.4, 2e11);
    code(12e6, 5e6, [3e-3, 2e-3, 5e-3], 0.4, 2e11);
    code(12e6, 5e6, [1e-3, 2e-3, 2e-3], 0.4, 2e11);
    code(12e6, 5e6, slips, 1.1, 2e11);
    code(12e6, 5e6, slips, 0.4, 1e10);
    let fem = |mesh| {
        let mut fem = Fem::new(PlaneStrain);
        fem.add(MeshBody::new("part", mesh, elastic(7850.0, 2e9, 0.0))).expect("part");
        fem
    };
    for perimeter in [0.0, -1.0, f64::NAN] {
        let within = Elements::within(fem(straight()), "block").expect("within");
        parameter(within.with_bond(linear(), perimeter).map(|_| ()));
    }
    let core = box_mesh(&boxed([0.0; 2], [1.0; 2]), [2; 2]).expect("mesh");
    let solid = Elements::within(fem(core), "block").expect("within").with_bond(linear(), 1.0);
    assert!(matches!(solid, Err(SceneError::NotWith { .. })));
    let grid = Elements::on_the_grid(fem(straight())).expect("grid").with_bond(linear(), 1.0);
    assert!(matches!(grid, Err(SceneError::NotWith { .. })));
}
