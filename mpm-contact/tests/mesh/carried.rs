//! Points carried by nodes.

use impactite_simd::Team;
use mpm_contact::Coulomb;
use mpm_contact::mesh::{Carriers, ContactBody, MeshContact};

use crate::scene::{Body, Random, collide, outline, sheet};

const DT: f64 = 1e-3;

/// Particles above a moving floor, fast enough to hit it.
fn crowd(random: &mut Random) -> [Body<3>; 2] {
    let place = |i: i32, random: &mut Random| {
        let jitter: [f64; 3] = random.vector();
        [0.2 * f64::from(i % 5) - 0.4, 0.2 * f64::from(i / 5) - 0.4, 0.1 + 0.02 * jitter[2].abs()]
    };
    let mut points = Body::points((0..25).map(|i| place(i, random)).collect(), 0.7, 0.1);
    points.v = points.x.iter().map(|_| random.vector().map(|v| 20.0 * v)).collect();
    (points.v.iter_mut()).for_each(|v| v[2] = -30.0 - v[2].abs());
    [points, sheet(1.0, 6, false).moving([1.0, 2.0, 3.0])]
}

fn contact() -> MeshContact<3> {
    MeshContact::new(Coulomb::new(0.3).unwrap()).between(0, 1)
}

#[test]
fn a_node_for_each_point_is_as_points_with_masses() {
    let mut random = Random(3);
    for _ in 0..10 {
        let mut bodies = crowd(&mut random);
        let [points, floor] = bodies.clone();
        let starts: Vec<usize> = (0..=25).collect();
        // The nodes have another order than the points.
        let weights: Vec<(u32, [f64; 3])> = (0..25).map(|n| ((n * 7) % 25, [1.0; 3])).collect();
        let (mut velocities, masses) = (vec![[0.0; 3]; 25], vec![0.7; 25]);
        for (v, (node, _)) in points.v.iter().zip(&weights) {
            velocities[*node as usize] = *v;
        }
        let carriers =
            Carriers { starts: &starts, weights: &weights, velocities: &velocities, masses: &masses };
        let carried = ContactBody::of_carried_points("points", &points.x, &points.v, &points.half, carriers);
        let mut other = contact();
        let step = other.step(&[carried, floor.view()], 0.0, DT, &Team::one()).expect("step");
        let mut same = contact();
        let plain = collide(&mut same, &mut bodies, DT, &Team::one());
        assert!(step.contacts > 10 && step.depth <= 0.05, "{step:?}");
        for body in 0..2 {
            assert_eq!(other.impulses(body).len(), same.impulses(body).len());
            for (a, b) in other.impulses(body).iter().zip(same.impulses(body)) {
                let off = (0..3).map(|d| (a.impulse[d] - b.impulse[d]).abs()).fold(0.0, f64::max);
                assert!(a.point == b.point && off < 1e-3, "{a:?} {b:?}");
            }
        }
        let scale = plain.exchange.impacts;
        assert!((step.exchange.impacts - scale).abs() < 1e-4 * scale, "{step:?} {plain:?}");
    }
}

/// Particles of one cell against a dense solution by hand: they move together, and a rigid floor takes the momentum of their nodes once,
/// for any number of particles in contact.
#[test]
fn points_of_the_same_nodes_yield_to_each_others_impulses() {
    let mut floor = outline([-2.0, -1.0], [2.0, 0.0], [5, 1]);
    floor.m.fill(f64::INFINITY);
    for count in [1, 4, 30] {
        // Two nodes; all points are between them.
        let (masses, velocities) = ([2.0, 3.0], [[1.0, -4.0]; 2]);
        let x: Vec<[f64; 2]> =
            (0..count).map(|n| [0.1 + 0.8 * (f64::from(n) + 0.5) / f64::from(count), 0.02]).collect();
        let starts: Vec<usize> = (0..=count as usize).map(|n| 2 * n).collect();
        let weights: Vec<(u32, [f64; 2])> =
            x.iter().flat_map(|x| [(0, [1.0 - x[0]; 2]), (1, [x[0]; 2])]).collect();
        let (v, half) = (vec![[1.0, -4.0]; count as usize], vec![0.02; count as usize]);
        let carriers =
            Carriers { starts: &starts, weights: &weights, velocities: &velocities, masses: &masses };
        let points = ContactBody::of_carried_points("points", &x, &v, &half, carriers);
        let mut contact = MeshContact::new(Coulomb::new(0.0).unwrap()).between(0, 1);
        let step = contact.step(&[points, floor.view()], 0.0, DT, &Team::one()).expect("step");
        let mut after = velocities;
        for push in contact.impulses(0) {
            for (node, weight) in &weights[2 * push.point as usize..][..2] {
                (0..2).for_each(|d| {
                    after[*node as usize][d] += weight[d] * push.impulse[d] / masses[*node as usize]
                });
            }
        }
        // No point moves on into the floor, and the rebound is no larger than one point needs.
        for x in &x {
            let v = (1.0 - x[0]) * after[0][1] + x[0] * after[1][1];
            // Two of the thirty points would suffice: sweeps leave the others a small velocity.
            assert!(v > -0.01, "{count}: {after:?}");
        }
        let kinetic = |v: &[[f64; 2]; 2]| 0.5 * (0..2).map(|n| masses[n] * v[n][1] * v[n][1]).sum::<f64>();
        let taken = kinetic(&velocities) - kinetic(&after);
        assert!((taken - step.exchange.impacts).abs() < 1e-9 * taken, "{taken} {step:?}");
        if count > 1 {
            // Both ends stop: the floor supports all points.
            assert!(
                after.iter().all(|v| v[1].abs() < 0.05 && (v[0] - 1.0).abs() < 1e-9),
                "{count}: {after:?}"
            );
        }
    }
}

/// Weights on a plane of symmetry: a point moves along it with all of its node, across it with none.
#[test]
fn weights_differ_by_direction() {
    let mut floor = outline([-2.0, -1.0], [2.0, 0.0], [5, 1]);
    floor.m.fill(f64::INFINITY);
    let (masses, velocities, weights) = ([2.0], [[9.0, -4.0]], [(0, [0.0, 1.0])]);
    let carriers = Carriers { starts: &[0, 1], weights: &weights, velocities: &velocities, masses: &masses };
    let points = ContactBody::of_carried_points("points", &[[0.3, 0.1]], &[[0.0, -4.0]], &[0.1], carriers);
    let mut contact = MeshContact::new(Coulomb::new(0.5).unwrap()).between(0, 1);
    contact.step(&[points, floor.view()], 0.0, DT, &Team::one()).expect("step");
    let push = contact.impulses(0)[0].impulse;
    assert!(push[0].abs() < 1e-12 && (push[1] - 8.0).abs() < 1e-9, "{push:?}");
}

/// Labels of points: a point that passed through an open sheet is assigned to its front by its last contact, if it is identified again.
#[test]
fn labels_follow_points_whose_numbers_change() {
    let deep = |labels: [u64; 2], x: [[f64; 3]; 2], contact: &mut MeshContact<3>, floor: &Body<3>| {
        let points = Body::points(x.to_vec(), 1.0, 0.05).moving([0.0, 0.0, -1.0]);
        let view = points.view().with_labels(&labels);
        contact.step(&[view, floor.view()], 0.0, DT, &Team::one()).expect("step");
        contact.impulses(0).iter().map(|push| labels[push.point as usize]).collect::<Vec<_>>()
    };
    let mut floor = sheet(1.0, 4, false);
    floor.m.fill(f64::INFINITY);
    let (near, far) = ([0.1, 0.1, 0.05], [0.3, 0.3, 0.5]);
    // Behind the sheet by more than the depth from which points without contact are pulled through.
    let behind = [0.1, 0.1, -0.08];
    for again in [[7, 8], [8, 7]] {
        let mut contact = contact();
        assert_eq!(deep([7, 8], [near, far], &mut contact, &floor), [7]);
        let places = if again[0] == 7 { [behind, far] } else { [far, behind] };
        assert_eq!(deep(again, places, &mut contact, &floor), [7], "it touched before");
        let mut contact = MeshContact::new(Coulomb::new(0.3).unwrap()).between(0, 1);
        assert_eq!(deep([7, 8], [near, far], &mut contact, &floor), [7]);
        assert!(deep([8, 9], [behind, far], &mut contact, &floor).is_empty(), "others did not");
    }
}

#[test]
fn what_cannot_carry_is_refused() {
    let floor = sheet(1.0, 2, false);
    let (x, v, half) = ([[0.0, 0.0, 0.1]], [[0.0; 3]], [0.1]);
    let refused = |carriers: Carriers<'_, 3>| {
        let points = ContactBody::of_carried_points("points", &x, &v, &half, carriers);
        let step = contact().step(&[points, floor.view()], 0.0, DT, &Team::one());
        step.expect_err("refused").to_string()
    };
    let (weights, velocities, masses) = ([(0, [1.0; 3])], [[0.0; 3]], [1.0]);
    let sound = Carriers { starts: &[0, 1], weights: &weights, velocities: &velocities, masses: &masses };
    for (carriers, field) in [
        (Carriers { starts: &[0], ..sound }, "starts of the weights"),
        (Carriers { starts: &[0, 2], ..sound }, "starts of the weights"),
        (Carriers { weights: &[(1, [1.0; 3])], ..sound }, "node of a point"),
        (Carriers { weights: &[(0, [f64::NAN; 3])], ..sound }, "weight"),
        (Carriers { masses: &[f64::INFINITY], ..sound }, "mass of a node"),
        (Carriers { masses: &[], ..sound }, "velocities of nodes"),
        (Carriers { velocities: &[[f64::INFINITY; 3]], ..sound }, "velocity of a node"),
    ] {
        let message = refused(carriers);
        assert!(message.contains(field), "{field}: {message}");
    }
}
