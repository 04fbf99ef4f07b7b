//! Facets that are turned away from a node at them.

use mpm_contact::Frictionless;
use mpm_contact::mesh::MeshContact;

use crate::scene::{Body, Random, advance, brick, outline};

/// Boxes with corner nodes only, face to face, misaligned by the residual of sweeps: no corner moves sideways.
#[test]
fn corners_meet_the_face_before_them() {
    for noise in [0.0, 1e-15, 1e-12, 1e-9] {
        let mut random = Random(5);
        let one = brick([0.0; 3], [1.0; 3], [1, 1, 1]).moving([1.0, 0.0, 0.0]);
        let two = brick([1.0, 0.0, 0.0], [2.0, 1.0, 1.0], [1, 1, 1]);
        let mut bodies = [one, two];
        for x in bodies.iter_mut().flat_map(|body| &mut body.x) {
            let shift: [f64; 3] = random.vector();
            (0..3).for_each(|d| x[d] += noise * shift[d]);
        }
        let mut contact = MeshContact::new(Frictionless).between(0, 1);
        for _ in 0..20 {
            advance(&mut contact, &mut bodies, 1e-3);
            // Rigid motion along x: all nodes of a body take its mean velocity.
            for body in &mut bodies {
                let mean = body.momentum()[0] / body.m.iter().sum::<f64>();
                body.v.iter_mut().for_each(|v| v[0] = mean);
            }
        }
        for body in &bodies {
            for v in &body.v {
                assert!((v[0] - 0.5).abs() < 1e-6 && v[1].abs() + v[2].abs() < 1e-6, "{noise}: {v:?}");
            }
        }
    }
}

/// Box that slides over a floor of many nodes with a small penetration: neither of its sides catches a node.
#[test]
fn an_edge_slides_over_nodes_below_it() {
    for depth in [0.0, 1e-6, 1e-3] {
        let mut floor = outline([0.0, -1.0], [10.0, 0.0], [37, 2]);
        floor.m.fill(f64::INFINITY);
        let sliding = outline([0.53, -depth], [2.0, 1.0], [3, 2]).moving([1.0, 0.0]);
        let mut bodies = [floor, sliding];
        let mut contact = MeshContact::new(Frictionless).between(0, 1);
        for step in 0..700 {
            // The nodes of a body are not connected: only those below have weight, or the box would fold.
            let Body { x, v, .. } = &mut bodies[1];
            for (v, _) in v.iter_mut().zip(x).filter(|(_, x)| x[1] < 0.1) {
                v[1] -= 1e-2;
            }
            advance(&mut contact, &mut bodies, 1e-2);
            for v in &bodies[1].v {
                assert!((v[0] - 1.0).abs() < 1e-3, "{depth}, step {step}: {v:?}");
            }
        }
        let low = bodies[1].x.iter().map(|x| x[1]).fold(0.0, f64::min);
        assert!(low > -depth - 1e-3, "{low}");
    }
}
