//! Completeness of the neighbour search, for any sizes and skins.

use impactite_simd::Team;
use mpm_contact::Frictionless;
use mpm_contact::mesh::MeshContact;

use crate::scene::{Body, Random, collide, sheet};

/// Comparison of points with lists kept over steps, points with a fresh search, and each point alone.
#[test]
fn lists_give_what_every_pair_gives() {
    let mut random = Random(11);
    let mut wavy = sheet(2.0, 24, true);
    for x in &mut wavy.x {
        x[2] = 0.1 * (3.0 * x[0]).sin() * (2.0 * x[1]).cos();
    }
    wavy.m.fill(f64::INFINITY);
    // Radii over two decades.
    let x: Vec<[f64; 3]> = (0..150).map(|_| [1.8 * random.next(), 1.8 * random.next(), 0.3]).collect();
    let mut points = Body::points(x, 1.0, 0.1);
    for half in &mut points.half {
        *half = 0.1 * 10f64.powf(random.next() - 1.0);
    }
    let mut kept = MeshContact::new(Frictionless).between(0, 1);
    let (mut met, steps) = (0, 60);
    for _ in 0..steps {
        for v in &mut points.v {
            *v = [30.0 * random.next(), 30.0 * random.next(), 30.0 * random.next() - 8.0];
        }
        // No point leaves over the rim.
        for (v, x) in points.v.iter_mut().zip(&points.x) {
            for d in (0..2).filter(|&d| x[d].abs() > 1.8) {
                v[d] = -v[d].abs() * x[d].signum();
            }
        }
        let mut bodies = [points.clone(), wavy.clone()];
        collide(&mut kept, &mut bodies, 1e-3, &Team::one());
        met += kept.impulses(0).len();
        let mut fresh = MeshContact::new(Frictionless).between(0, 1);
        let mut anew = [points.clone(), wavy.clone()];
        collide(&mut fresh, &mut anew, 1e-3, &Team::one());
        assert!(bodies[0].v == anew[0].v);
        // One by one: the facets are fixed, so that points are independent.
        for i in 0..points.x.len() {
            let half = points.half[i];
            let mut alone = [Body::points(vec![points.x[i]], 1.0, half).moving(points.v[i]), wavy.clone()];
            collide(&mut MeshContact::new(Frictionless).between(0, 1), &mut alone, 1e-3, &Team::one());
            let off = (0..3).map(|d| (alone[0].v[0][d] - bodies[0].v[i][d]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "point {i}: {:?} {:?}", alone[0].v[0], bodies[0].v[i]);
        }
        points.v = bodies[0].v.clone();
        for (x, v) in points.x.iter_mut().zip(&points.v) {
            for d in 0..3 {
                x[d] += 1e-3 * v[d];
            }
        }
    }
    assert!(met > 500, "{met} contacts");
    assert!(kept.searches() < steps / 2, "{} searches", kept.searches());
}

/// Comparison with the exact velocities above flat sheets, for points and facets of many sizes.
#[test]
fn every_facet_is_asked() {
    let mut random = Random(5);
    for case in 0..40 {
        let counts = 1 + case % 9;
        let mut flat = sheet(1.0, counts, case % 2 == 0);
        flat.m.fill(f64::INFINITY);
        let half = 0.5 * 4f64.powi(-((case % 5) as i32));
        let x =
            (0..50).map(|_| [0.9 * random.next(), 0.9 * random.next(), half + 0.3 * (1.0 + random.next())]);
        let mut bodies = [Body::points(x.collect(), 1.0, half), flat];
        for v in &mut bodies[0].v {
            *v = [0.0, 0.0, 400.0 * random.next()];
        }
        let expected: Vec<_> = (0..50)
            .map(|i| {
                let (gap, v) = (bodies[0].x[i][2] - half, bodies[0].v[i][2]);
                v.max(-gap / 1e-3)
            })
            .collect();
        collide(&mut MeshContact::new(Frictionless).between(0, 1), &mut bodies, 1e-3, &Team::one());
        for (v, expected) in bodies[0].v.iter().zip(&expected) {
            assert!((v[2] - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{v:?} {expected}");
        }
    }
}
