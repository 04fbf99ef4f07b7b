//! Contact between bodies, and self-contact.

use std::sync::Arc;

use fem::{Erosion, Fem, MeshBody};
use impactite_geometry::ElementKind::{self, Bar2, Hexa8, Quad4, Tetra4, Triangle3};
use impactite_geometry::ElementMesh;
use impactite_scene::{
    Axisymmetric, Body, Boundary, Embedding, FullSpace, Line, PlaneStrain, SceneError, Side, Solver,
    TimeControl, solver_conforms,
};
use mpm_contact::{Coulomb, Frictionless, Pairs, SlipWeakening, Stick};
use mpm_materials::{Moduli, NeoHookean};

use crate::common::{ball, elastic, flowing, mesh, off};

const H: f64 = 1.0e-3;

fn coulomb(mu: f64) -> Coulomb<f64> {
    Coulomb::new(mu).unwrap()
}

/// Rubber, whose energy is exact at any strain.
fn rubber(young: f64) -> NeoHookean<f64> {
    NeoHookean::new(1000.0, Moduli::young_poisson(young, 0.3).unwrap()).unwrap()
}

fn along<const D: usize>(speed: f64) -> impl Fn([f64; D]) -> [f64; D] + Send + Sync + 'static {
    move |_| std::array::from_fn(|d| if d == 0 { speed } else { 0.0 })
}

/// Mean velocity of a body along x, m/s.
fn speed<const D: usize>(fem: &Fem<D>, body: usize) -> f64 {
    let totals = fem.body(body).totals();
    totals.momentum[0] / totals.mass
}

/// Impact of two bars of 0.2 m and nu = 0, one at 10 m/s, the other at rest; `across` elements over the height, subcycling up to
/// `subcycles`.
fn bars<const D: usize, E: Embedding<D>>(space: E, kind: ElementKind, across: [usize; 2], subcycles: u32) {
    let (length, elements, velocity) = (0.2, 100, 10.0);
    let height = length / elements as f64;
    let bar = |left: f64, across: usize| {
        let (mut low, mut high, mut counts) = ([0.0; D], [height; D], [across; D]);
        (low[0], high[0], counts[0]) = (left, left + length, elements * across);
        mesh(kind, low, high, counts)
    };
    let law = || elastic(7850.0, 200e9, 0.0);
    let mut fem = Fem::new(space);
    fem.add(MeshBody::new("one", bar(0.0, across[0]), law()).moving(along(velocity))).unwrap();
    fem.add(MeshBody::new("other", bar(length, across[1]), law())).unwrap();
    fem.touch(Frictionless).unwrap();
    fem.set_subcycling(subcycles).unwrap();
    let start = fem.totals();
    let wave = (200e9f64 / 7850.0).sqrt();
    // The wave fronts are beyond three quarters of the bars.
    fem.run_until(0.8 * length / wave).unwrap();
    let stress = |body: usize, near: &dyn Fn(f64) -> bool| {
        let points = fem.body(body).points();
        let behind: Vec<_> = points.iter().filter(|p| near(p.position[0])).collect();
        -behind.iter().map(|p| p.mass * p.stress[0]).sum::<f64>() / behind.iter().map(|p| p.mass).sum::<f64>()
    };
    let stresses = [stress(0, &|x| x > 0.5 * length), stress(1, &|x| x < 1.5 * length)];
    let mut contact = 0.0;
    while fem.time() < 100e-6 {
        fem.step_towards(100e-6).unwrap();
        if fem.contacts()[0].force[0] > 1e-3 * stresses[0] * height.powi(D as i32 - 1) {
            contact = fem.time();
        }
    }
    let end = fem.totals();
    println!(
        "bars {kind:?} {across:?} {subcycles}: {:.2} and {:.2} MPa, {:.3} us, {:.4} and {:.4} m/s, books {:.2e}, {:?}",
        stresses[0] / 1e6,
        stresses[1] / 1e6,
        contact * 1e6,
        speed(&fem, 0),
        speed(&fem, 1),
        fem.account().energy_error(),
        fem.exchange().impacts / start.kinetic
    );
    let wanted = 7850.0 * wave * 0.5 * velocity;
    // Simplices retain more energy in transverse waves.
    let [within, wide] = match kind {
        Tetra4 => [0.02, 2.0],
        Triangle3 => [0.005, 2.0],
        _ => [0.005, 1.0],
    };
    for stress in stresses {
        assert!(off(stress, wanted) < within, "{stress} {wanted}");
    }
    assert!(off(contact, 2.0 * length / wave) < 0.015 * wide, "{contact}");
    assert!(speed(&fem, 0).abs() < 0.015 * wide * velocity, "{}", speed(&fem, 0));
    assert!(off(speed(&fem, 1), velocity) < 0.015 * wide, "{}", speed(&fem, 1));
    for d in 0..3 {
        assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-12 * start.momentum_scale);
    }
    assert!(fem.account().energy_error().abs() < 2e-3, "{:?}", fem.account());
    assert!(fem.exchange().impacts < 0.01 * start.kinetic, "{:?}", fem.exchange());
    assert!(fem.exchange().friction.abs() < 1e-12 * start.kinetic);
}

#[test]
fn bars_exchange_their_velocities() {
    bars(PlaneStrain, Quad4, [1, 1], 1);
    bars(PlaneStrain, Quad4, [1, 2], 1);
    bars(PlaneStrain, Quad4, [1, 3], 4);
    bars(PlaneStrain, Triangle3, [2, 1], 1);
    bars(FullSpace, Hexa8, [1, 1], 1);
    bars(FullSpace, Tetra4, [1, 1], 1);
}

/// In the centre-of-mass frame, two equal balls are one ball on a rigid wall: R 5 mm, 1 m/s, problem I.
#[test]
fn balls_meet_as_hertz_says() {
    let r = 5e-3;
    let mut fem = Fem::new(Axisymmetric);
    let law = || elastic(7850.0, 200e9, 0.3);
    let mut upper = ball(r, 0.03e-3, 1.15);
    // The lower ball has its fine pole at the top.
    let mut lower = ball(r, 0.04e-3, 1.15);
    for x in &mut lower.nodes {
        x[1] = -x[1];
    }
    for quad in lower.blocks[0].nodes.chunks_exact_mut(4) {
        quad.reverse();
    }
    for x in &mut upper.nodes {
        x[1] += 1e-9;
    }
    fem.add(MeshBody::new("lower", lower, law())).unwrap();
    fem.add(MeshBody::new("upper", upper, law()).moving(|_| [0.0, -2.0])).unwrap();
    fem.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    fem.touch(Frictionless).unwrap();
    let middle = |fem: &Fem<2>, body: usize| {
        let nodes = fem.body(body).nodes();
        nodes.iter().map(|n| n.mass * n.position[1]).sum::<f64>() / nodes.iter().map(|n| n.mass).sum::<f64>()
    };
    let apart = |fem: &Fem<2>| middle(fem, 1) - middle(fem, 0);
    let start = (apart(&fem), fem.totals());
    let (mut force, mut depth, mut contact) = (0.0f64, 0.0f64, 0.0);
    let mut last = fem.body(0).totals().momentum[1];
    let window = 0.4e-6;
    for k in 1..=80 {
        fem.run_until(f64::from(k) * window).unwrap();
        let now = fem.body(0).totals().momentum[1];
        // Momenta are per radian.
        let mean = 2.0 * std::f64::consts::PI * (last - now) / window;
        force = force.max(mean);
        depth = depth.max(start.0 - apart(&fem));
        if mean > 1.0 {
            contact = fem.time() - 0.5 * window;
        }
        last = now;
    }
    let kept = 1.0 - fem.exchange().impacts / start.1.kinetic;
    println!(
        "balls: {force:.1} N, {:.3} um, {:.2} us, {kept:.4} of the energy; {:.2e}",
        depth * 1e6,
        contact * 1e6,
        fem.account().energy_error()
    );
    assert!(off(force, 566.3) < 0.03, "{force}");
    assert!(off(depth, 2.0 * 9.073e-6) < 0.03, "{depth}");
    assert!(off(contact, 26.70e-6) < 0.04, "{contact}");
    assert!(kept > 0.99, "{kept}");
    let end = fem.totals();
    assert!((end.momentum[1] - start.1.momentum[1]).abs() < 1e-12 * start.1.momentum_scale);
    assert!(fem.account().energy_error().abs() < 5e-3, "{:?}", fem.account());
}

/// Block on a slab with fixed bottom, under gravity inclined by 30 degrees.
fn incline(mu: f64, kinds: [ElementKind; 2]) -> Fem<2> {
    let mut fem = Fem::new(PlaneStrain);
    let soft = || elastic(2000.0, 2e7, 0.2);
    fem.add(MeshBody::new("slab", mesh(kinds[0], [0.0; 2], [1.2, 0.1], [24, 2]), soft())).unwrap();
    fem.add(MeshBody::new("block", mesh(kinds[1], [0.1, 0.1], [0.33, 0.2], [7, 3]), soft())).unwrap();
    fem.prescribe(0, "low y", Arc::new(|_| [Some(0.0); 3])).unwrap();
    let (sin, cos) = (0.5, 0.75f64.sqrt());
    // Gravity grows gradually, to avoid oscillations.
    fem.set_body_force(Arc::new(move |t| {
        let part = 9.81 * (t / 0.04).min(1.0);
        [sin * part, -cos * part]
    }));
    fem.touch(coulomb(mu)).unwrap();
    fem
}

#[test]
fn a_block_slides_down_another_one() {
    let (sin, cos) = (0.5, 0.75f64.sqrt());
    for kinds in [[Quad4, Quad4], [Quad4, Triangle3]] {
        let mut fem = incline(0.3, kinds);
        fem.run_until(0.1).unwrap();
        let (time, before) = (fem.time(), speed(&fem, 1));
        fem.run_until(0.4).unwrap();
        let found = (speed(&fem, 1) - before) / (fem.time() - time);
        let account = fem.account();
        println!("slides with {found:.4} m/s^2; {:.2e}", account.energy_error());
        assert!(off(found, 9.81 * (sin - 0.3 * cos)) < 0.01, "{found}");
        assert!(account.friction > 0.0);
        // Friction dissipates the part mu N / (m g sin) of the work of gravity along the plane.
        assert!(off(account.friction / (account.work), 0.3 * cos / sin) < 0.02, "{account:?}");
        assert!(account.energy_error().abs() < 1e-3, "{account:?}");
        // The block sticks if friction suffices: sin 30 < 0.7 cos 30.
        let mut fem = incline(0.7, kinds);
        fem.run_until(0.4).unwrap();
        assert!(speed(&fem, 1).abs() < 1e-3, "{}", speed(&fem, 1));
        assert!(fem.account().energy_error().abs() < 1e-3, "{:?}", fem.account());
    }
}

/// Oblique contact of blocks with friction.
fn aslant<const D: usize>(space: impl Embedding<D>, kinds: [ElementKind; 2]) -> Fem<D> {
    let mut fem = Fem::new(space);
    let (mut low, mut high) = ([0.0; D], [4.0 * H; D]);
    fem.add(MeshBody::new("one", mesh(kinds[0], low, high, [4; D]), rubber(1e7))).unwrap();
    (low, high) = ([1.3 * H; D], [4.6 * H; D]);
    (low[0], high[0]) = (4.05 * H, 7.0 * H);
    let velocity = |x: [f64; D]| {
        let mut v = [0.0; D];
        (v[0], v[1]) = (-8.0 - 900.0 * x[1], 5.0 + 900.0 * x[0]);
        v
    };
    fem.add(MeshBody::new("other", mesh(kinds[1], low, high, [3; D]), rubber(1e7)).moving(velocity)).unwrap();
    fem.touch(coulomb(0.3)).unwrap();
    fem
}

fn keeps<const D: usize>(mut fem: Fem<D>) {
    let start = fem.totals();
    let (mut couple, mut touched) = ([0.0; 3], 0);
    for _ in 0..400 {
        fem.step_at_most(f64::INFINITY).unwrap();
        let step = fem.last_contact().unwrap();
        touched += usize::from(step.exchange.friction > 0.0);
        (0..3).for_each(|d| couple[d] += step.couple[d]);
        assert!(step.depth < 0.051, "{step:?}");
    }
    let end = fem.totals();
    let lever = 10.0 * H * start.momentum_scale;
    println!(
        "couple {:.2e}, {touched} steps of contact, {:?}",
        couple[2] / lever,
        fem.account().energy_error()
    );
    assert!(touched > 10, "they touch");
    for d in 0..3 {
        assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-13 * start.momentum_scale);
        let turned = end.angular_momentum[d] - start.angular_momentum[d] - couple[d];
        assert!(turned.abs() < 1e-12 * lever, "{d}: {turned:e} of {lever:e}");
        // Couple of friction while a gap closes.
        assert!(couple[d].abs() < 1e-3 * lever, "{couple:?} of {lever}");
    }
    assert!(fem.account().energy_error().abs() < 5e-3, "{:?}", fem.account());
    let (exchange, force) = (fem.exchange(), fem.contacts()[0]);
    assert!(exchange.friction > 0.0 && exchange.impacts > -1e-3 * start.kinetic, "{exchange:?} {force:?}");
    assert_eq!(exchange.impulse, [0.0; 3]);
}

#[test]
fn momentum_and_angular_momentum_are_kept() {
    keeps(aslant(PlaneStrain, [Quad4, Quad4]));
    keeps(aslant(PlaneStrain, [Triangle3, Quad4]));
    keeps(aslant(FullSpace, [Hexa8, Hexa8]));
    keeps(aslant(FullSpace, [Tetra4, Hexa8]));
}

/// Mesh of a clamp, without the elements between its arms.
fn clamp<const D: usize>(kind: ElementKind) -> ElementMesh<D> {
    let (mut counts, mut high) = ([1; D], [H; D]);
    (counts[0], counts[1]) = (10, 5);
    (high[0], high[1]) = (10.0 * H, 5.0 * H);
    let mut mesh = mesh(kind, [0.0; D], high, counts);
    let nodes = std::mem::take(&mut mesh.blocks[0].nodes);
    for element in nodes.chunks_exact(kind.nodes()) {
        let middle = |d: usize| {
            element.iter().map(|&n| mesh.nodes[n as usize][d]).sum::<f64>() / kind.nodes() as f64 / H
        };
        if middle(0) < 2.0 || !(2.0..3.0).contains(&middle(1)) {
            mesh.blocks[0].nodes.extend_from_slice(element);
        }
    }
    mesh
}

/// Clamp whose arms move towards each other.
fn closing<const D: usize>(space: impl Embedding<D>, kind: ElementKind, itself: bool) -> Fem<D> {
    let mut fem = Fem::new(space);
    let speed = |x: [f64; D]| {
        let mut v = [0.0; D];
        v[1] = 20.0 * (x[0] / (10.0 * H)).powi(2) * if x[1] > 2.5 * H { -1.0 } else { 1.0 };
        v
    };
    fem.add(MeshBody::new("clamp", clamp(kind), rubber(1e7)).moving(speed)).unwrap();
    fem.touch(coulomb(0.2)).unwrap();
    if itself {
        fem.touch_itself(0).unwrap();
    }
    fem
}

/// Least distance of opposite nodes across the slot, H.
fn slot<const D: usize>(fem: &Fem<D>) -> f64 {
    let (rest, nodes) = (&fem.body(0).mesh().nodes, fem.body(0).nodes());
    let mut least = f64::INFINITY;
    for (a, x) in rest.iter().enumerate().filter(|(_, x)| x[0] > 2.5 * H && (x[1] - 2.0 * H).abs() < 1e-9) {
        let above = rest.iter().position(|y| {
            (y[1] - x[1] - H).abs() < 1e-9 && (0..D).filter(|d| *d != 1).all(|d| (x[d] - y[d]).abs() < 1e-9)
        });
        least = least.min((nodes[above.unwrap()].position[1] - nodes[a].position[1]) / H);
    }
    least
}

fn closes<const D: usize>(space: impl Embedding<D>, kind: ElementKind) {
    let mut least = [f64::INFINITY; 2];
    for itself in [false, true] {
        let mut fem = closing(space, kind, itself);
        let start = fem.totals();
        while fem.time() < 3e-4 {
            fem.step_towards(3e-4).unwrap();
            let gap = slot(&fem);
            least[usize::from(itself)] = least[usize::from(itself)].min(gap);
        }
        let end = fem.totals();
        for d in 0..3 {
            assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-13 * start.momentum_scale);
        }
        assert!(fem.account().energy_error().abs() < 5e-3, "{:?}", fem.account());
        assert_eq!(fem.contacts().len(), usize::from(itself));
    }
    println!("{kind:?}: the slot closes to {least:?} of an element");
    assert!(least[0] < -0.2, "without contact the arms pass through each other: {least:?}");
    assert!(least[1] > -0.06, "{least:?}");
}

#[test]
fn a_clamp_closes_on_itself() {
    closes(PlaneStrain, Quad4);
    closes(PlaneStrain, Triangle3);
    closes(FullSpace, Hexa8);
}

/// Stack of three blocks on a fixed slab.
fn stack(subcycles: u32) -> Fem<2> {
    let mut fem = Fem::new(PlaneStrain);
    for (n, (low, high, counts)) in [
        ([0.0, 0.0], [8.0, 1.0], [8, 1]),
        ([1.0, 1.0], [6.0, 3.0], [6, 3]),
        ([2.0, 3.0], [7.0, 5.0], [5, 2]),
        ([2.5, 5.0], [4.5, 6.0], [5, 3]),
    ]
    .into_iter()
    .enumerate()
    {
        let mesh = mesh(Quad4, low.map(|x| x * H), high.map(|x| x * H), counts);
        fem.add(MeshBody::new(format!("block {n}"), mesh, elastic(1000.0, 1e6, 0.3))).unwrap();
    }
    fem.prescribe(0, "low y", Arc::new(|_| [Some(0.0); 3])).unwrap();
    fem.set_body_force(Arc::new(|_| [0.0, -500.0]));
    fem.touch(coulomb(0.3)).unwrap();
    fem.set_subcycling(subcycles).unwrap();
    fem
}

/// The stack oscillates in suddenly applied gravity, without a gain of energy.
#[test]
fn a_stack_gains_no_energy() {
    for subcycles in [1, 4] {
        let mut fem = stack(subcycles);
        let mut most = [0.0f64; 2];
        for step in 0..20_000 {
            fem.step_at_most(f64::INFINITY).unwrap();
            if step % 100 == 0 {
                let half = usize::from(step >= 10_000);
                most[half] = most[half].max(fem.totals().kinetic);
            }
        }
        let (account, exchange) = (fem.account(), fem.exchange());
        println!("stack {subcycles}: kinetic {most:?} J, {:.2e}, {exchange:?}", account.energy_error());
        assert!(most[1] < most[0], "{most:?}");
        assert!(account.energy_error() < 1e-3 && account.energy_error() > -0.02, "{account:?}");
        assert!(exchange.impacts > 0.0 && exchange.friction >= 0.0);
        // No block fell off.
        for (body, height) in [(1, 2.0), (2, 4.0), (3, 5.5)] {
            let nodes = fem.body(body).nodes();
            let middle = nodes.iter().map(|n| n.position[1]).sum::<f64>() / nodes.len() as f64;
            assert!((middle / H - height).abs() < 0.2, "{body}: {middle}");
        }
    }
}

/// Fully prescribed tool that presses a block: prescribed nodes do not yield to contact.
#[test]
fn what_is_prescribed_does_not_yield() {
    let mut fem = Fem::new(PlaneStrain);
    let law = || rubber(1e7);
    fem.add(MeshBody::new("block", mesh(Quad4, [0.0; 2], [4.0 * H; 2], [4; 2]), law())).unwrap();
    let mut tool = mesh(Quad4, [-H, 4.0 * H], [5.0 * H, 5.0 * H], [2, 1]);
    tool.node_sets.insert("all".into(), (0..6).collect());
    fem.add(MeshBody::new("tool", tool, law())).unwrap();
    fem.prescribe(1, "all", Arc::new(|_| [Some(0.0), Some(-1.0), None])).unwrap();
    fem.prescribe(0, "low y", Arc::new(|_| [None, Some(0.0), None])).unwrap();
    fem.touch(Frictionless).unwrap();
    let end = 0.05 * 4.0 * H;
    fem.run_until(end).unwrap();
    let tops = fem.body(0).nodes().iter().map(|n| n.position[1]).fold(0.0, f64::max);
    let account = fem.account();
    println!("pressed to {:.5} H, work {:.4e}, {:.2e}", tops / H, account.work, account.energy_error());
    assert!((tops - (4.0 * H - end)).abs() < 1e-3 * H, "{tops}");
    assert!(account.work > 0.0 && account.energy_error().abs() < 2e-3, "{account:?}");
    // The nodes of the tool follow their prescribed motion.
    for (node, rest) in fem.body(1).nodes().iter().zip(&fem.body(1).mesh().nodes) {
        assert!((node.position[1] - rest[1] + end).abs() < 1e-12);
    }
}

/// Row of bars that falls on a block: contact of bars with facets.
#[test]
fn bars_meet_facets_half_their_thickness_away() {
    let mut fem = Fem::new(PlaneStrain);
    let law = || elastic(1000.0, 1e7, 0.0);
    let nodes: Vec<[f64; 2]> = (0..=8).map(|n| [0.5 * H * f64::from(n), 1.3 * H]).collect();
    let links = (0..8u32).flat_map(|n| [n, n + 1]).collect();
    let block = impactite_geometry::ElementBlock { name: "bars".into(), kind: Bar2, nodes: links };
    let string = ElementMesh { nodes, blocks: vec![block], ..ElementMesh::default() };
    fem.add(MeshBody::new("string", string, law()).section(0.2 * H).moving(|_| [0.0, -10.0])).unwrap();
    fem.add(MeshBody::new("block", mesh(Quad4, [0.0; 2], [4.0 * H, H], [5, 2]), law())).unwrap();
    fem.touch(Frictionless).unwrap();
    let start = fem.totals();
    let mut least = f64::INFINITY;
    while fem.time() < 1e-4 {
        fem.step_towards(1e-4).unwrap();
        let top = fem.body(1).nodes().iter().map(|n| n.position[1]).fold(0.0, f64::max);
        least = least.min(fem.body(0).nodes()[4].position[1] - top);
    }
    let end = fem.totals();
    assert!((least - 0.1 * H).abs() < 0.01 * H, "{}", least / H);
    assert!((end.momentum[1] - start.momentum[1]).abs() < 1e-13 * start.momentum_scale);
}

#[test]
fn what_cannot_touch_is_refused() {
    let refused = |result: Result<(), SceneError>| assert!(matches!(result, Err(SceneError::NotWith { .. })));
    refused(Fem::new(Line).touch(Frictionless));
    refused(Fem::<2>::new(PlaneStrain).touch(SlipWeakening::new(0.5, 0.2, 1e-3).unwrap()));
    let mut fem = stack(1);
    refused(fem.touch(Frictionless));
    assert!(matches!(fem.touch_itself(9), Err(SceneError::Parameter { .. })));
    let mut alone = Fem::new(PlaneStrain);
    alone.add(MeshBody::new("one", mesh(Quad4, [0.0; 2], [1.0; 2], [1; 2]), elastic(1.0, 1.0, 0.0))).unwrap();
    refused(alone.touch_itself(0));
}

/// Contact laws of pairs: the lower two blocks stick, the upper one slides.
#[test]
fn pairs_have_laws_of_their_own() {
    let mut fem = Fem::new(PlaneStrain);
    for n in 0..3 {
        let (low, high) = ([0.0, f64::from(n) * H], [4.0 * H, f64::from(n + 1) * H]);
        let body = MeshBody::new(format!("{n}"), mesh(Quad4, low, high, [4, 1]), rubber(1e6));
        fem.add(body.moving(along(f64::from(n)))).unwrap();
    }
    fem.touch(Pairs::new(Frictionless).with(0, 1, Stick)).unwrap();
    fem.run_until(5e-4).unwrap();
    let speeds = [0, 1, 2].map(|n| speed(&fem, n));
    println!("{speeds:?}");
    assert!((speeds[0] - speeds[1]).abs() < 0.2 && (speeds[2] - 2.0).abs() < 0.05, "{speeds:?}");
}

/// Projectile of bricks through a plate, both with erosion: surfaces change, and contact continues.
fn shot() -> Fem<3> {
    let mut fem = Fem::new(FullSpace);
    let erosion = || Erosion::plastic_strain(0.5).or(fem::Criterion::Volume(0.2));
    let metal = || flowing(7850.0, 206e9, 0.3, 400e6);
    let plate = mesh(Hexa8, [0.0; 3], [8.0 * H, 8.0 * H, 2.0 * H], [8, 8, 2]);
    fem.add(MeshBody::new("plate", plate, metal()).eroding(erosion())).unwrap();
    let shot = mesh(Hexa8, [3.1 * H, 2.9 * H, 2.05 * H], [5.1 * H, 4.9 * H, 5.05 * H], [2, 2, 3]);
    fem.add(MeshBody::new("shot", shot, metal()).eroding(erosion()).moving(|_| [0.0, 0.0, -800.0])).unwrap();
    fem.touch(coulomb(0.1)).unwrap();
    fem.touch_itself(0).unwrap();
    fem
}

#[test]
fn surfaces_go_on_where_elements_leave() {
    let mut fem = shot();
    let start = fem.totals();
    fem.run_until(8e-6).unwrap();
    let gone: Vec<_> = (0..2).map(|n| fem.body(n).eroded().elements).collect();
    let account = fem.account();
    println!(
        "{gone:?} elements left, shot at {:?}, {:.2e}",
        fem.body(1).totals().momentum,
        account.energy_error()
    );
    assert!(gone[0] > 1 && gone[1] > 1, "{gone:?}");
    let end = fem.totals();
    for d in 0..3 {
        assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-12 * start.momentum_scale);
    }
    assert!((end.mass / start.mass - 1.0).abs() < 1e-12);
    assert!(account.energy_error().abs() < 0.02, "{account:?}");
}

/// Axisymmetric ball on a plate.
fn round() -> Fem<2> {
    let mut fem = Fem::new(Axisymmetric);
    let law = || flowing(7850.0, 200e9, 0.3, 300e6);
    let mut upper = ball(H, 0.1 * H, 1.2);
    upper.nodes.iter_mut().for_each(|x| x[1] += 0.01 * H);
    fem.add(MeshBody::new("plate", mesh(Quad4, [0.0, -H], [2.0 * H, 0.0], [10, 5]), law())).unwrap();
    fem.add(MeshBody::new("ball", upper, law()).moving(|_| [0.0, -60.0])).unwrap();
    fem.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    fem.touch(coulomb(0.2)).unwrap();
    fem
}

/// Oblique contact with a time step at which the run breaks.
fn torn() -> Fem<2> {
    let mut fem = aslant(PlaneStrain, [Quad4, Quad4]);
    fem.set_time_control(TimeControl::Fixed(5e-4)).unwrap();
    fem
}

/// Scene with all that may depend on threads or be lost in a checkpoint: friction, subcycling, self-contact.
fn heap() -> Fem<2> {
    let mut fem = stack(2);
    fem.add(MeshBody::new("clamp", falling_clamp(), rubber(4e6)).moving(|x| [2e3 * x[1], -3.0])).unwrap();
    fem.touch_itself(4).unwrap();
    fem
}

fn falling_clamp() -> ElementMesh<2> {
    let mut mesh = clamp(Quad4);
    mesh.nodes.iter_mut().for_each(|x| *x = [0.3 * x[0] + 2.2 * H, 0.3 * x[1] + 6.02 * H]);
    mesh
}

solver_conforms! {
    contact_with_friction: || super::aslant(PlaneStrain, [Quad4, Triangle3]), SolverTests::until(3.0e-4).energy_within(0.01).breaking(1.0e-2, super::torn);
    contact_in_space: || super::aslant(FullSpace, [Tetra4, Hexa8]), SolverTests::until(3.0e-4).energy_within(0.01);
    contact_within: || super::closing(FullSpace, Hexa8, true), SolverTests::until(1.5e-4).energy_within(0.01);
    contact_in_several_steps: super::heap, SolverTests::until(1.0e-3).energy_within(0.01);
    contact_of_what_erodes: super::shot, SolverTests::until(4.0e-6).energy_within(0.03);
    contact_around_an_axis: super::round, SolverTests::until(4.0e-6).energy_within(0.02);
}
