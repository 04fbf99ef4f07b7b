//! Contact with faces, edges and corners, one by one.

use impactite_simd::Team;
use mpm_contact::Frictionless;
use mpm_contact::mesh::MeshContact;

use crate::scene::{Body, advance, brick, collide, outline, sheet};

const DT: f64 = 1e-3;

/// Velocity of a point after a step beside a fixed body, and number of contacts.
fn meet<const D: usize>(body: &Body<D>, x: [f64; D], v: [f64; D], half: f64) -> ([f64; D], usize) {
    let mut fixed = body.clone();
    fixed.m.fill(f64::INFINITY);
    let point = Body::points(vec![x], 1.0, half).moving(v);
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    let mut bodies = [point, fixed];
    collide(&mut contact, &mut bodies, DT, &Team::one());
    (bodies[0].v[0], contact.places().iter().filter(|p| p.impulse != [0.0; 3]).count())
}

fn near<const D: usize>(a: [f64; D], b: [f64; D]) {
    for d in 0..D {
        assert!((a[d] - b[d]).abs() < 1e-9, "{a:?} is not {b:?}");
    }
}

#[test]
fn a_face_stops_what_closes_once_the_gap_is_closed() {
    let square = outline([0.0; 2], [1.0; 2], [4, 4]);
    near(meet(&square, [0.3, 1.1], [7.0, -5.0], 0.1).0, [7.0, 0.0]);
    // Gap of 2 mm: closed by 2 m/s in a step of 1 ms.
    near(meet(&square, [0.3, 1.102], [7.0, -5.0], 0.1).0, [7.0, -2.0]);
    near(meet(&square, [0.3, 1.102], [7.0, 5.0], 0.1).0, [7.0, 5.0]);
    near(meet(&square, [0.3, 1.106], [7.0, -5.0], 0.1).0, [7.0, -5.0]);
    // Above a node of a flat side there is one normal, and one facet pushes.
    let (v, places) = meet(&square, [0.5, 1.1], [7.0, -5.0], 0.1);
    near(v, [7.0, 0.0]);
    assert_eq!(places, 1);
}

#[test]
fn beyond_a_convex_edge_the_direction_is_to_the_edge() {
    let square = outline([0.0; 2], [1.0; 2], [4, 4]);
    let s = 0.1 / 2f64.sqrt();
    near(meet(&square, [1.0 + s, 1.0 + s], [-3.0, -1.0], 0.1).0, [-1.0, 1.0]);
    // A point that moves past the corner has no contact.
    near(meet(&square, [1.0 + s, 1.0 + s], [3.0, -3.0], 0.1).0, [3.0, -3.0]);
    let cube = brick([0.0; 3], [1.0; 3], [2; 3]);
    // Edge and corner of a cube.
    near(meet(&cube, [1.0 + s, 0.7, 1.0 + s], [-3.0, 2.0, -1.0], 0.1).0, [-1.0, 2.0, 1.0]);
    let c = 0.1 / 3f64.sqrt();
    near(meet(&cube, [1.0 + c; 3], [-3.0; 3], 0.1).0, [0.0; 3]);
    near(meet(&cube, [1.0 + c; 3], [-3.0, 0.0, 0.0], 0.1).0, [-2.0, 1.0, 1.0]);
}

#[test]
fn a_concave_corner_touches_on_both_sides() {
    // L-shaped body, with its concave corner at the origin.
    let x = vec![[0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 0.0]];
    let n = x.len() as u32;
    let facets = (0..n).map(|i| crate::scene::facet(&[i, (i + 1) % n])).collect();
    let corner = Body::mesh(x, 1.0, facets);
    let (v, places) = meet(&corner, [0.1, 0.1], [-2.0, -3.0], 0.1);
    near(v, [0.0, 0.0]);
    assert_eq!(places, 2);
    near(meet(&corner, [0.1, 0.1], [-2.0, 3.0], 0.1).0, [0.0, 3.0]);
    // Node exactly in the corner.
    let square = outline([0.0; 2], [0.5; 2], [1, 1]).moving([-2.0, -3.0]);
    let mut fixed = corner.clone();
    fixed.m.fill(f64::INFINITY);
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    let mut bodies = [square, fixed];
    collide(&mut contact, &mut bodies, DT, &Team::one());
    near(bodies[0].v[0], [0.0, 0.0]);
    near(bodies[0].v[1], [-2.0, 0.0]);
    near(bodies[0].v[3], [0.0, -3.0]);
}

#[test]
fn a_point_above_the_middle_of_warped_quadrilaterals_has_no_diagonal() {
    let mut warped = sheet(1.0, 1, false);
    for (n, x) in warped.x.iter_mut().enumerate() {
        x[2] = if n == 0 || n == 3 { 0.2 } else { -0.2 };
    }
    // The middle of the bilinear surface is at the mean of its corners, and horizontal.
    near(meet(&warped, [0.0, 0.0, 0.1], [1.0, 2.0, -3.0], 0.1).0, [1.0, 2.0, 0.0]);
}

#[test]
fn nobody_is_dragged_through_a_thin_plate() {
    // Plate of 2 mm thickness under points of 20 mm, on both sides.
    let mut plate = outline([-1.0, -0.001], [1.0, 0.001], [20, 1]);
    plate.m.fill(f64::INFINITY);
    let points = Body::points(vec![[0.33, 0.011], [0.37, -0.011], [0.0, 0.011]], 1.0, 0.01);
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    let mut bodies = [points, plate];
    bodies[0].v = vec![[0.0, -30.0], [0.0, 30.0], [3.0, -1.0]];
    for _ in 0..50 {
        let step = advance(&mut contact, &mut bodies, DT);
        assert!(step.depth < 0.01);
    }
    assert!((bodies[0].x[0][1] - 0.011).abs() < 1e-3 && (bodies[0].x[1][1] + 0.011).abs() < 1e-3);
    // A sheet pushes in front, and has no effect behind.
    let plate = sheet(1.0, 4, true);
    near(meet(&plate, [0.1, 0.1, -0.05], [0.0, 0.0, 3.0], 0.01).0, [0.0, 0.0, 3.0]);
    near(meet(&plate, [0.1, 0.1, 0.01], [0.0, 0.0, -3.0], 0.01).0, [0.0, 0.0, 0.0]);
}

#[test]
fn what_begins_inside_is_let_out_the_nearest_way_and_slowly() {
    let mut square = outline([0.0; 2], [1.0; 2], [4, 4]);
    square.m.fill(f64::INFINITY);
    // The centre of a point of 0.1 is 0.06 under the upper side: its surface is 0.11 deep.
    let mut bodies = [Body::points(vec![[0.3, 0.94]], 1.0, 0.05), square];
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    let mut given = 0.0;
    for _ in 0..400 {
        given -= advance(&mut contact, &mut bodies, DT).exchange.impacts;
        // Each step corrects at most 0.01 of its size.
        assert!(bodies[0].v[0][1] <= 0.01 * 0.1 / DT * (1.0 + 1e-9));
    }
    assert!(bodies[0].x[0][1] > 1.0 + 0.05 - 0.0021, "{:?}", bodies[0].x);
    // The added kinetic energy is booked.
    assert!((given - bodies[0].kinetic()).abs() < 1e-12);
}

#[test]
fn a_mesh_touches_itself_and_not_its_neighbours() {
    // C-shaped body of unit thickness whose arms close; flat parts must not touch themselves.
    let x = [
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [3.0, 0.0],
        [3.0, 1.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 1.5],
        [1.0, 2.0],
        [2.0, 2.0],
        [3.0, 2.0],
        [3.0, 3.0],
        [2.0, 3.0],
        [1.0, 3.0],
        [0.0, 3.0],
        [0.0, 1.5],
    ];
    let n = x.len() as u32;
    let facets = (0..n).map(|i| crate::scene::facet(&[i, (i + 1) % n])).collect();
    let mut body = [Body::mesh(x.to_vec(), 1.0, facets)];
    let mut contact = MeshContact::new(Frictionless).within(0);
    let step = collide(&mut contact, &mut body, DT, &Team::one());
    assert!(contact.impulses(0).is_empty() && step.depth == 0.0, "{step:?}");
    // The upper arm hits the lower one, at 30 m/s over a gap of 1.
    let close = |body: &mut Body<2>| {
        for i in 9..13 {
            body.v[i] = [0.0, -30.0];
        }
    };
    let (mut p, mut touched) = ([0.0; 2], false);
    for _ in 0..60 {
        close(&mut body[0]);
        for i in 3..6 {
            body[0].v[i] = [0.0; 2];
        }
        p[1] = body[0].momentum()[1];
        let step = advance(&mut contact, &mut body, DT);
        touched |= !contact.impulses(0).is_empty();
        assert!(step.depth < 0.05 && (body[0].momentum()[1] - p[1]).abs() < 1e-12);
        for (up, down) in [(10, 4), (9, 5)] {
            assert!(body[0].x[up][1] > body[0].x[down][1] - 0.05);
        }
    }
    assert!(touched);
}
