//! Sliding of blocks on inclines: comparison with g (sin - mu cos).

use mpm_contact::Coulomb;
use mpm_contact::mesh::MeshContact;

use crate::scene::{Body, advance, outline, sheet};

const G: f64 = 9.81;
const DT: f64 = 1e-3;

/// Acceleration along the x axis, under gravity at `slope` to the plane z = 0 (y = 0 in the plane), from rest over 0.4 s.
fn slide<const D: usize>(block: Body<D>, floor: Body<D>, slope: f64, friction: f64) -> f64 {
    let mut floor = floor;
    floor.m.fill(f64::INFINITY);
    let mut bodies = [block, floor];
    let mut contact = MeshContact::new(Coulomb::new(friction).unwrap()).between(0, 1);
    let steps = 400;
    let (mut work, before) = (0.0, bodies[0].clone());
    for _ in 0..steps {
        for v in &mut bodies[0].v {
            v[0] += G * slope.sin() * DT;
            v[D - 1] -= G * slope.cos() * DT;
        }
        let step = advance(&mut contact, &mut bodies, DT);
        assert!(step.depth <= 0.05);
        work += step.exchange.friction;
    }
    // m a = m g sin - mu m g cos; the work of friction is the difference of energies, up to a step.
    let mass: f64 = bodies[0].m.iter().sum();
    let speed = bodies[0].momentum()[0] / mass;
    let mean =
        |body: &Body<D>, d: usize| body.x.iter().zip(&body.m).map(|(x, m)| m * x[d]).sum::<f64>() / mass;
    let [down, out] = [0, D - 1].map(|d| mean(&bodies[0], d) - mean(&before, d));
    let given = mass * G * (slope.sin() * down - slope.cos() * out);
    assert!((given - work - bodies[0].kinetic()).abs() < 0.01 * given.abs().max(1e-6), "{given} {work}");
    speed / (DT * f64::from(steps))
}

fn expect(found: f64, slope: f64, friction: f64) {
    let expected = G * (slope.sin() - friction * slope.cos());
    assert!((found - expected).abs() < 0.01 * expected, "{found} for {expected}");
    println!("slope {slope}, mu {friction}: {found:.5} m/s^2 for {expected:.5}");
}

#[test]
fn blocks_of_points_slide_as_coulomb_says() {
    for (slope, friction) in [(0.5_f64, 0.3), (0.3, 0.1), (0.7, 0.0)] {
        let row = (0..12).map(|i| [0.1 * f64::from(i), 0.05]).collect();
        // The floor's element is below.
        let mut floor = outline([-1.0, -1.0], [5.0, 0.0], [17, 1]);
        floor.v.fill([0.0; 2]);
        expect(slide(Body::points(row, 0.7, 0.05), floor, slope, friction), slope, friction);
        let grid = (0..25).map(|i| [0.1 * f64::from(i % 5), 0.1 * f64::from(i / 5) - 0.2, 0.05]).collect();
        expect(slide(Body::points(grid, 0.7, 0.05), sheet(3.0, 13, true), slope, friction), slope, friction);
        // Lower side of a block, in contact by its own nodes, on facets of other sizes.
        let mut block = sheet(0.25, 5, false);
        block.facets.iter_mut().for_each(|facet| facet.nodes.reverse());
        expect(slide(block, sheet(3.0, 4, false), slope, friction), slope, friction);
    }
}

#[test]
fn below_the_angle_of_friction_nothing_moves() {
    let row = (0..5).map(|i| [0.1 * f64::from(i), 0.05]).collect();
    let floor = outline([-1.0, -1.0], [5.0, 0.0], [17, 1]);
    let found = slide(Body::points(row, 0.7, 0.05), floor, 0.28, 0.3);
    assert!(found.abs() < 1e-9, "{found}");
}
