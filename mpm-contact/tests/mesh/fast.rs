//! Points that pass many facets in a step.

use impactite_simd::Team;
use mpm_contact::mesh::MeshContact;
use mpm_contact::{Coulomb, Frictionless};

use crate::scene::{Body, Random, advance, brick, collide, outline, sheet};

#[test]
fn twenty_facets_a_step_and_no_way_through() {
    let mut random = Random(3);
    // Plate as thick as one facet, 0.1, and as a tenth of it.
    for thickness in [0.1, 0.01] {
        let mut plate = brick([-3.0, -3.0, -thickness], [3.0, 3.0, 0.0], [60, 60, 1]);
        plate.m.fill(f64::INFINITY);
        let start = |random: &mut Random| [random.next(), random.next(), 0.02 + 0.7 * (1.0 + random.next())];
        let x: Vec<_> = (0..300).map(|_| start(&mut random)).collect();
        let mut points = Body::points(x, 1.0, 0.01);
        for v in &mut points.v {
            // Path of 2 m in a step of 1 ms.
            *v = [1000.0 * random.next(), 1000.0 * random.next(), -2000.0];
        }
        let mut bodies = [points, plate];
        let mut contact = MeshContact::new(Frictionless).between(0, 1);
        for _ in 0..3 {
            let step = advance(&mut contact, &mut bodies, 1e-3);
            assert!(step.depth <= 0.05, "{step:?}");
            let low = bodies[0].x.iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
            assert!(low >= 0.01 - 0.05 * 0.02, "{low}");
        }
        assert!(bodies[0].v.iter().all(|v| v[2].abs() < 1e-6));
    }
}

#[test]
fn flying_past_an_edge_is_no_contact() {
    // Path to below the level of the top, beside the box, in one step: an unbounded plane of the top would stop it.
    let mut square = outline([0.0; 2], [1.0; 2], [10, 10]);
    square.m.fill(f64::INFINITY);
    let mut bodies = [Body::points(vec![[0.5, 1.3]], 1.0, 0.01).moving([2000.0, -1000.0]), square];
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    collide(&mut contact, &mut bodies, 1e-3, &Team::one());
    assert_eq!(bodies[0].v[0], [2000.0, -1000.0]);
    // A slightly steeper path hits the top.
    bodies[0].v[0] = [1000.0, -1000.0];
    advance(&mut contact, &mut bodies, 1e-3);
    assert!(bodies[0].v[0][1] > -300.1 && (bodies[0].x[0][1] - 1.01).abs() < 1e-3, "{bodies:?}");
}

#[test]
fn light_facets_that_fly_at_points_are_caught_too() {
    let mut random = Random(8);
    let net = sheet(1.0, 10, true).moving([0.0, 0.0, 1500.0]);
    let x = (0..40).map(|_| [0.7 * random.next(), 0.7 * random.next(), 0.8 + 0.5 * random.next()]);
    let points = Body::points(x.collect(), 5.0, 0.02);
    let mut bodies = [points, net];
    let mut contact = MeshContact::new(Coulomb::new(0.2).unwrap()).between(0, 1);
    let before = bodies[0].kinetic() + bodies[1].kinetic();
    let step = advance(&mut contact, &mut bodies, 1e-3);
    assert!(step.depth <= 0.05, "{step:?}");
    // Every point is on its own side of the net.
    let net = &bodies[1];
    let mut above = 0;
    for x in &bodies[0].x {
        for facet in &net.facets {
            let [a, b, c] = [0, 1, 2].map(|k| net.x[facet.nodes[k] as usize]);
            let area = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| {
                (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
            };
            let w = [area(*x, b, c), area(a, *x, c), area(a, b, *x)].map(|part| part / area(a, b, c));
            if w.iter().all(|w| *w >= 0.0) {
                let level = w[0] * a[2] + w[1] * b[2] + w[2] * c[2];
                assert!(x[2] > level + 0.01, "{x:?} {level}");
                above += 1;
            }
        }
    }
    assert!(above >= 30, "{above}");
    assert!(bodies[0].v.iter().filter(|v| v[2] > 0.0).count() > 20);
    assert!(bodies[0].kinetic() + bodies[1].kinetic() <= before);
}
