//! Closed-form solutions: problems `A` to `I`, common to all methods.

use fem::{Fem, Hourglass, MeshBody, Technology};
use impactite_geometry::ElementKind::{self, Bar2, Hexa8, Quad4, Tetra4, Triangle3};
use impactite_scene::{Axisymmetric, Body, Boundary, Embedding, FullSpace, Line, PlaneStrain, Side, Solver};

use crate::common::{ball, copper_fluid, elastic, flowing, mesh, off};

const SPRINGS: Technology = Technology::OnePoint(Hourglass::Stiffness(0.05));

/// Problem A: impact of a bar on a rigid wall. Returns mean stress behind the front, contact time, rebound speed and the remaining part of
/// the energy.
fn bar_on_wall<const D: usize, E: Embedding<D>>(space: E, kind: ElementKind, elements: usize) -> [f64; 4] {
    let (length, speed) = (0.2, 10.0);
    let mut high = [length / elements as f64; D];
    let mut counts = [1; D];
    (high[0], counts[0]) = (length, elements);
    let mut fem = Fem::new(space);
    let body = MeshBody::new("bar", mesh(kind, [0.0; D], high, counts), elastic(7850.0, 200e9, 0.0));
    fem.add(body.moving(move |_| std::array::from_fn(|d| if d == 0 { -speed } else { 0.0 }))).unwrap();
    fem.bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    let start = fem.totals();
    // The wave front is beyond three quarters of the bar.
    fem.run_until(32e-6).unwrap();
    let points = fem.body(0).points();
    let behind: Vec<_> = points.iter().filter(|p| p.position[0] < 0.5 * length).collect();
    let stress = -behind.iter().map(|p| p.mass * p.stress[0]).sum::<f64>()
        / behind.iter().map(|p| p.mass).sum::<f64>();
    let (mut last, mut contact) = (0.0, 0.0);
    while fem.time() < 100e-6 {
        fem.step_towards(100e-6).unwrap();
        let impulse = fem.exchange().impulse[0];
        if impulse > last * (1.0 + 1e-9) {
            contact = fem.time();
        }
        last = impulse;
    }
    let end = fem.totals();
    // The law is in rate form: its energy has an error of the order of its strain, 0.2 %.
    assert!(fem.account().energy_error().abs() < 2e-3, "{:?}", fem.account());
    assert!(fem.account().missing() < 1e-12 * start.momentum_scale);
    [
        stress,
        contact,
        end.momentum[0] / end.mass,
        1.0 - end.momentum[0].powi(2) / (2.0 * end.mass) / start.kinetic,
    ]
}

#[test]
fn a_bar_rebounds_from_a_wall() {
    // Simplices retain more energy in transverse waves.
    let cases = [
        (bar_on_wall(Line, Bar2, 100), 0.01, 0.02),
        (bar_on_wall(PlaneStrain, Quad4, 100), 0.01, 0.02),
        (bar_on_wall(FullSpace, Hexa8, 100), 0.01, 0.02),
        (bar_on_wall(PlaneStrain, Triangle3, 100), 0.02, 0.04),
        (bar_on_wall(FullSpace, Tetra4, 100), 0.02, 0.04),
    ];
    for ([stress, contact, rebound, kept], within, most) in cases {
        println!(
            "A: {:.2} MPa, {:.3} us, {rebound:.4} m/s, {kept:.5} of the energy stays",
            stress / 1e6,
            contact * 1e6
        );
        assert!(off(stress, 396.23e6) < 0.005, "{stress}");
        assert!(off(contact, 79.246e-6) < within, "{contact}");
        assert!(off(rebound, 10.0) < within, "{rebound}");
        assert!(kept < most, "{kept}");
    }
}

/// Problem C: lowest frequency of a cantilever, from half a period of its first mode.
pub fn beam_frequency(
    kind: ElementKind,
    technology: Technology,
    counts: [usize; 2],
    poisson: f64,
    guess: f64,
) -> f64 {
    let (length, height) = (0.2, 0.02);
    // First Euler-Bernoulli mode, with the rotation of sections.
    let mode = move |x: [f64; 2]| {
        let (k, s) = (1.875_104_068_7 / length, 0.734_095_514_0);
        let (a, y) = (k * x[0], x[1] - 0.5 * height);
        let bend = a.cosh() - a.cos() - s * (a.sinh() - a.sin());
        let slope = k * (a.sinh() + a.sin() - s * (a.cosh() - a.cos()));
        [-y * slope, bend].map(|c| 1e-4 * c)
    };
    let mut fem = Fem::new(PlaneStrain);
    let beam = mesh(kind, [0.0; 2], [length, height], counts);
    let rest = beam.nodes.clone();
    let body = MeshBody::new("beam", beam, elastic(1000.0, 2e6, poisson)).with(kind, technology);
    fem.add(body.moving(mode)).unwrap();
    fem.prescribe(0, "low x", std::sync::Arc::new(|_| [Some(0.0); 3])).unwrap();
    // Modal amplitude of the displacement.
    let part = |fem: &Fem<2>| -> f64 {
        let one = |(n, x): (&fem::Node<2>, &[f64; 2])| {
            let shape = mode(*x);
            (0..2).map(|d| n.mass * shape[d] * (n.position[d] - x[d])).sum::<f64>()
        };
        fem.body(0).nodes().iter().zip(&rest).map(one).sum()
    };
    fem.run_until(0.4 / guess).unwrap();
    let mut before = (fem.time(), part(&fem));
    loop {
        fem.step_at_most(f64::INFINITY).unwrap();
        let now = (fem.time(), part(&fem));
        if now.1 <= 0.0 {
            let crossing = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
            assert!(fem.account().energy_error().abs() < 1e-4, "{:?}", fem.account());
            return 0.5 / crossing;
        }
        assert!(now.0 < 0.6 / guess, "it does not come back");
        before = now;
    }
}

#[test]
fn c_beam_swings_as_it_should() {
    let f = 3.9210;
    for (technology, counts, within) in [
        (Technology::MeanDilatation, [40, 4], 0.035),
        (Technology::MeanDilatation, [80, 8], 0.01),
        (SPRINGS, [40, 4], 0.035),
        (SPRINGS, [80, 8], 0.01),
        // Spring coefficient that gives squares their exact bending stiffness.
        (Technology::OnePoint(Hourglass::Stiffness(0.45)), [40, 4], 0.01),
    ] {
        let found = beam_frequency(Quad4, technology, counts, 0.3975, f);
        println!("C: {counts:?} {technology:?}: {found:.4} Hz, {:+.2} %", 100.0 * (found / f - 1.0));
        assert!(off(found, f) < within, "{technology:?} {counts:?}: {found}");
    }
}

/// Impact of a strip or rod of elements along x on a plane of symmetry: half of a symmetric impact.
fn plate<L: mpm_materials::IntoMaterial<f64>>(law: L, speed: f64, elements: usize, length: f64) -> Fem<2> {
    let h = length / elements as f64;
    let mut fem = Fem::new(PlaneStrain);
    let body = MeshBody::new("plate", mesh(Quad4, [0.0; 2], [length, h], [elements, 1]), law);
    fem.add(body.moving(move |_| [-speed, 0.0])).unwrap();
    fem.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    fem.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
    fem.bound(Boundary::Symmetry { axis: 1, at: h, side: Side::Below }).unwrap();
    fem
}

/// Position along x at which a quantity of the points falls through `level`, m.
fn front(
    points: &[impactite_scene::PointView],
    of: impl Fn(&impactite_scene::PointView) -> f64,
    level: f64,
) -> f64 {
    let place = points.iter().rposition(|p| of(p) >= level).unwrap();
    let (a, b) = (&points[place], &points[place + 1]);
    let part = (of(a) - level) / (of(a) - of(b));
    a.position[0] + part * (b.position[0] - a.position[0])
}

#[test]
fn d_shock_of_a_symmetric_impact() {
    let mut fem = plate(copper_fluid(), 250.0, 200, 10e-3);
    let (early, late) = (0.8e-6, 1.8e-6);
    let pressure = |p: &impactite_scene::PointView| p.pressure();
    fem.run_until(early).unwrap();
    let first = front(&fem.body(0).points(), pressure, 4.8e9);
    fem.run_until(late).unwrap();
    let points = fem.body(0).points();
    // The shock moves away from the plane at U - u.
    let shock = (front(&points, pressure, 4.8e9) - first) / (late - early) + 250.0;
    let behind = &points[50..90];
    let mean = |of: &dyn Fn(&impactite_scene::PointView) -> f64| {
        behind.iter().map(of).sum::<f64>() / behind.len() as f64
    };
    let density = mean(&|p| p.mass / p.volume);
    let level = mean(&pressure);
    let energy = {
        let names = fem.body(0).state_names();
        let place = names.iter().position(|n| n == "energy").unwrap();
        mean(&|p| p.state[place]) / 8930.0
    };
    println!("D: U {shock:.1} m/s, p {:.4} GPa, rho {density:.2}, e {energy:.0} J/kg", level / 1e9);
    println!("D: books {:?}", fem.account().energy_error());
    assert!(off(shock, 4312.5) < 0.005, "{shock}");
    assert!(off(level, 9.6277e9) < 0.005, "{level}");
    assert!(off(density, 9479.54) < 0.002, "{density}");
    assert!(off(energy, 31250.0) < 0.02, "{energy}");
    assert!(fem.account().energy_error().abs() < 5e-3);
}

#[test]
fn e_elastic_and_plastic_wave() {
    let mut fem = plate(flowing(8930.0, 117e9, 0.35, 0.4e9), 50.0, 400, 20e-3);
    let stress = |p: &impactite_scene::PointView| -p.stress[0];
    let (early, late) = (2.0e-6, 3.6e-6);
    let (hel, plateau) = (0.86667e9, 1.8492e9);
    fem.run_until(early).unwrap();
    let at = |fem: &Fem<2>| {
        let points = fem.body(0).points();
        [front(&points, stress, 0.5 * hel), front(&points, stress, 0.5 * (hel + plateau))]
    };
    let first = at(&fem);
    fem.run_until(late).unwrap();
    let second = at(&fem);
    let points = fem.body(0).points();
    // Fronts move in moving matter: the elastic one in matter at 50 m/s, the plastic one in matter at 50 - 21.16.
    let elastic = (second[0] - first[0]) / (late - early) + 50.0;
    let plastic = (second[1] - first[1]) / (late - early) + 50.0 - 21.16;
    let between: Vec<f64> = points
        .iter()
        .filter(|p| p.position[0] > second[1] + 0.8e-3 && p.position[0] < second[0] - 0.8e-3)
        .map(stress)
        .collect();
    let foot = between.iter().sum::<f64>() / between.len() as f64;
    let high = points[60..140].iter().map(stress).sum::<f64>() / 80.0;
    println!(
        "E: c_l {elastic:.1}, plastic {plastic:.1} m/s, HEL {:.4}, plateau {:.4} GPa",
        foot / 1e9,
        high / 1e9
    );
    assert!(off(elastic, 4585.6) < 0.01, "{elastic}");
    assert!(off(plastic, 3815.5) < 0.01, "{plastic}");
    assert!(off(foot, hel) < 0.02, "{foot}");
    assert!(off(high, plateau) < 0.01, "{high}");
    assert!(fem.account().energy_error().abs() < 1e-3, "{:?}", fem.account());
}

#[test]
fn f_ring_stops_where_its_work_is_done() {
    for (density, strength, speed, wanted, when) in
        [(8930.0, 400e6, 100.0, 22.362e-3, 48.13e-6), (2700.0, 300e6, 200.0, 23.944e-3, 40.65e-6)]
    {
        // Nearly rigid before yield, and thin.
        let (edge, r0) = (0.2e-3, 20e-3);
        let ring = mesh(Quad4, [r0 - 0.5 * edge, 0.0], [r0 + 0.5 * edge, edge], [2, 2]);
        let mut fem = Fem::new(Axisymmetric);
        let law = flowing(density, 20e12, 0.3, strength);
        fem.add(MeshBody::new("ring", ring, law).moving(move |x| [speed * r0 / x[0], 0.0])).unwrap();
        let radius = |fem: &Fem<2>| {
            let nodes = fem.body(0).nodes();
            nodes.iter().map(|n| n.mass * n.position[0]).sum::<f64>()
                / nodes.iter().map(|n| n.mass).sum::<f64>()
        };
        let (mut largest, mut time, start) = (0.0, 0.0, radius(&fem));
        while fem.time() < 1.05 * when {
            fem.step_at_most(f64::INFINITY).unwrap();
            let r = radius(&fem) - start + r0;
            if r > largest {
                (largest, time) = (r, fem.time());
            }
        }
        println!("F: {:.3} mm at {:.2} us", largest * 1e3, time * 1e6);
        assert!(off(largest - r0, wanted - r0) < 0.01, "{largest}");
        assert!(off(time, when) < 0.01, "{time}");
        assert!(fem.account().energy_error().abs() < 1e-3, "{:?}", fem.account());
    }
}

#[test]
fn i_ball_on_a_wall_against_hertz() {
    let r = 5e-3;
    let mut fem = Fem::new(Axisymmetric);
    fem.add(
        MeshBody::new("ball", ball(r, 0.03e-3, 1.15), elastic(7850.0, 200e9, 0.3)).moving(|_| [0.0, -1.0]),
    )
    .unwrap();
    fem.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).unwrap();
    fem.bound(Boundary::Wall { axis: 1, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    let mass: f64 = fem.totals().mass;
    let middle =
        |fem: &Fem<2>| fem.body(0).nodes().iter().map(|n| n.mass * n.position[1]).sum::<f64>() / mass;
    let start = middle(&fem);
    let (mut force, mut depth, mut last, mut contact) = (0.0f64, 0.0f64, 0.0, 0.0);
    let window = 0.4e-6;
    for k in 1..=80 {
        fem.run_until(f64::from(k) * window).unwrap();
        let impulse = fem.exchange().impulse[1];
        // Impulses are per radian.
        let mean = 2.0 * std::f64::consts::PI * (impulse - last) / window;
        force = force.max(mean);
        depth = depth.max(start - middle(&fem));
        if mean > 1.0 {
            contact = fem.time() - 0.5 * window;
        }
        last = impulse;
    }
    println!("I: {force:.1} N, {:.3} um, {:.2} us", depth * 1e6, contact * 1e6);
    assert!(off(force, 566.3) < 0.03, "{force}");
    assert!(off(depth, 9.073e-6) < 0.03, "{depth}");
    assert!(off(contact, 26.70e-6) < 0.04, "{contact}");
    assert!(fem.account().energy_error().abs() < 5e-3, "{:?}", fem.account());
}
