//! Static equilibrium, and no gain of energy.

use mpm_contact::mesh::MeshContact;
use mpm_contact::{Coulomb, Frictionless};

use crate::scene::{Body, Random, advance, brick, outline};

const G: f64 = 9.81;

/// Apply damped springs between all nodes of a box of four. Returns the stored energy.
fn springs(body: &mut Body<2>, rest: &[[f64; 2]], dt: f64) -> f64 {
    let (stiffness, damping, mut stored) = (2e4, 200.0, 0.0);
    for i in 0..4 {
        for j in i + 1..4 {
            let d = [0, 1].map(|k| body.x[j][k] - body.x[i][k]);
            let w = [0, 1].map(|k| body.v[j][k] - body.v[i][k]);
            let (long, still) = (d[0].hypot(d[1]), (rest[j][0] - rest[i][0]).hypot(rest[j][1] - rest[i][1]));
            let rate = (d[0] * w[0] + d[1] * w[1]) / long;
            let force = stiffness * (long - still) + damping * rate;
            stored += 0.5 * stiffness * (long - still).powi(2);
            for k in 0..2 {
                let push = force * d[k] / long * dt;
                body.v[i][k] += push / body.m[i];
                body.v[j][k] -= push / body.m[j];
            }
        }
    }
    stored
}

/// Stack of five boxes of four nodes, each on two or one facets of the one below, which it overhangs.
#[test]
fn a_resting_stack_neither_drifts_nor_gains() {
    let mut floor = outline([-1.0, -1.0], [1.0, 0.0], [3, 1]);
    floor.m.fill(f64::INFINITY);
    let mut bodies = vec![floor];
    for level in 0..5 {
        let (low, half) = (0.2 * f64::from(level), 0.3 + 0.05 * f64::from((level * 2) % 5));
        bodies.push(outline([-half, low], [half, low + 0.2], [1, 1]));
    }
    let mut contact = MeshContact::new(Coulomb::new(0.5).unwrap());
    for n in 0..bodies.len() - 1 {
        contact = contact.between(n, n + 1);
    }
    let (start, dt, steps) = (bodies.clone(), 2e-4, 40_000);
    let energy = |bodies: &[Body<2>], stored: f64| {
        let height = bodies[1..].iter().flat_map(|b| b.x.iter().zip(&b.m)).map(|(x, m)| m * G * x[1]);
        bodies[1..].iter().map(Body::kinetic).sum::<f64>() + height.sum::<f64>() + stored
    };
    let (first, mut settled, mut most, mut weight) = (energy(&bodies, 0.0), Vec::new(), 0.0_f64, 0.0);
    for step in 0..steps {
        let mut stored = 0.0;
        for (body, start) in bodies.iter_mut().zip(&start).skip(1) {
            stored += springs(body, &start.x, dt);
            body.v.iter_mut().for_each(|v| v[1] -= G * dt);
        }
        let made = advance(&mut contact, &mut bodies, dt);
        assert!(made.depth <= 0.05, "{made:?}");
        assert!(energy(&bodies, stored) <= first + 1e-3, "step {step}");
        if step == 3 * steps / 4 {
            settled.clone_from(&bodies);
        }
        if step > 3 * steps / 4 {
            most = most.max(bodies[1..].iter().map(Body::kinetic).sum());
            weight += contact.pairs()[0].force[1] / f64::from(steps / 4 - 1);
        }
    }
    let mass: f64 = bodies[1..].iter().flat_map(|body| &body.m).sum();
    let drift = bodies.iter().zip(&settled).flat_map(|(a, b)| a.x.iter().zip(&b.x));
    let drift = drift.map(|(x, y)| (x[0] - y[0]).hypot(x[1] - y[1])).fold(0.0, f64::max);
    println!(
        "drift {drift:.2e} m in 2 s, kinetic energy {most:.2e} J, weight {weight:.6} N of {:.6}",
        mass * G
    );
    assert!(drift < 1e-6 && most < 1e-10, "{drift} {most}");
    // The floor supports the whole weight.
    assert!((weight - mass * G).abs() < 1e-6 * mass * G, "{weight} {}", mass * G);
}

#[test]
fn energies_add_up_over_a_long_shake() {
    let mut random = Random(6);
    let mut bucket = brick([-1.0, -1.0, -0.2], [1.0, 1.0, 0.0], [3, 2, 1]);
    bucket.m.fill(1000.0);
    let x = (0..200).map(|_| [0.8 * random.next(), 0.8 * random.next(), 0.3 + 0.2 * random.next()]);
    let mut bodies = [Body::points(x.collect(), 0.3, 0.05), bucket];
    for v in &mut bodies[0].v {
        *v = random.vector().map(|c: f64| 5.0 * c);
        v[2] -= 10.0;
    }
    let mut contact = MeshContact::new(Coulomb::new(0.3).unwrap()).between(0, 1);
    let kinetic = |bodies: &[Body<3>; 2]| bodies[0].kinetic() + bodies[1].kinetic();
    let (start, mut last) = (kinetic(&bodies), kinetic(&bodies));
    let mut taken = 0.0;
    for _ in 0..500 {
        let step = advance(&mut contact, &mut bodies, 1e-3);
        taken += step.exchange.friction + step.exchange.impacts;
        let now = kinetic(&bodies);
        assert!(now <= last * (1.0 + 1e-13), "{now} {last}");
        last = now;
    }
    assert!((start - taken - last).abs() < 1e-11 * start);
    assert!(taken > 0.1 * start);
    let pair = contact.pairs()[0];
    assert!((pair.friction + pair.taken - taken).abs() < 1e-11 * start && pair.friction > 0.0);
}

#[test]
fn what_touches_without_closing_is_left_alone() {
    let square = outline([0.0; 2], [1.0; 2], [4, 4]).moving([3.0, 2.0]);
    let row = (0..9).map(|i| [0.1 + 0.1 * f64::from(i), 1.05]).collect();
    let mut bodies = [Body::points(row, 1.0, 0.05).moving([3.0, 2.0]), square];
    let mut contact = MeshContact::new(Frictionless).between(0, 1);
    for _ in 0..200 {
        advance(&mut contact, &mut bodies, 1e-2);
    }
    let off = bodies.iter().flat_map(|body| &body.v).map(|v| (v[0] - 3.0).hypot(v[1] - 2.0));
    assert!(off.fold(0.0, f64::max) < 1e-9);
}
