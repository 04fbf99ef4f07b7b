//! Penetration of at most 0.05 of the spacing, for any ratio of sizes, over many steps of random motion.

use mpm_contact::mesh::MeshContact;
use mpm_contact::{Coulomb, Frictionless};

use crate::scene::{Body, Random, advance, brick, outline, sheet};

/// Rolling and heaving sheet of facets of `ratio` spacings, below particles that hit it again and again.
fn over_waves(ratio: f64, triangles: bool, free: bool) {
    let spacing = 0.1;
    let counts = ((6.0 * 8.0_f64.max(ratio) * spacing / (ratio * spacing)).min(48.0)) as usize;
    let half = 0.5 * counts as f64 * ratio * spacing;
    let mut random = Random(ratio.to_bits());
    let mut mesh = sheet(half, counts, triangles);
    // A facet is about as heavy as the particles above it, and at least as one of them: it must keep its shape.
    mesh.m.fill(if free { (ratio * ratio).max(1.0) } else { f64::INFINITY });
    let within = 0.7 * half.min(8.0 * spacing);
    let x: Vec<[f64; 3]> = (0..60)
        .map(|_| [within * random.next(), within * random.next(), 1.5 * spacing + spacing * random.next()])
        .collect();
    let mut bodies = [Body::points(x, 1.0, 0.5 * spacing), mesh];
    let mut contact = MeshContact::new(Coulomb::new(0.2).unwrap()).between(0, 1);
    let (dt, length, mut deepest, mut met) = (1e-3, half.min(1.0), 0.0_f64, 0);
    let still = bodies[1].x.clone();
    for step in 0..400 {
        let time = dt * f64::from(step);
        // Particles fall at 1000 spacings per s^2 and are shaken; the sheet rolls and waves, at slopes up to 1/3.
        for (x, v) in bodies[0].x.iter().zip(&mut bodies[0].v) {
            v[2] -= 100.0 * spacing * dt * 10.0;
            for d in 0..3 {
                v[d] += 0.3 * random.next();
            }
            for d in (0..2).filter(|&d| x[d].abs() > within) {
                v[d] = -v[d].abs() * x[d].signum();
            }
        }
        let wave = |x: &[f64; 3], t: f64| {
            let roll = 0.15 * (7.0 * t).sin() * x[0] + 0.1 * (11.0 * t).cos() * x[1];
            roll + 0.05 * length * (2.5 * x[0] / length + 30.0 * t).sin()
        };
        let mesh = &mut bodies[1];
        for n in 0..mesh.x.len() {
            let to = wave(&still[n], time + dt);
            // Free nodes are driven towards the wave.
            mesh.v[n] = [0.0, 0.0, (to - mesh.x[n][2]) / dt].map(|v: f64| v.clamp(-20.0, 20.0));
        }
        let made = advance(&mut contact, &mut bodies, dt);
        deepest = deepest.max(made.depth);
        met += contact.impulses(0).len();
        assert!(made.depth <= 0.05, "ratio {ratio} step {step}: {made:?}");
        // Independent check that no particle passed through: centres are above the level of the sheet, to first order.
        for x in &bodies[0].x {
            let near = bodies[1].x.iter().map(|y| {
                let across = (x[0] - y[0]).hypot(x[1] - y[1]);
                (across, x[2] - y[2])
            });
            let (across, height) = near.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            assert!(
                height > -0.9 * across - 0.05 * length,
                "ratio {ratio} step {step}: {x:?} {across} {height}"
            );
        }
    }
    assert!(met > 2000, "ratio {ratio}: {met} contacts");
    println!(
        "ratio {ratio}, free {free}: deepest {deepest:.4} of the spacing, {met} contacts, {} searches",
        contact.searches()
    );
}

#[test]
fn ratios_of_facets_to_spacing_from_an_eighth_to_sixteen() {
    for (n, ratio) in [0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0].into_iter().enumerate() {
        over_waves(ratio, n % 2 == 0, false);
        over_waves(ratio, n % 2 == 1, true);
    }
}

/// Rotation of two rigid boxes of very different meshes beside each other: nodes and facets rotate by 0.02 a step.
#[test]
fn turning_boxes() {
    for counts in [[1, 40], [40, 1], [7, 9]] {
        let rotor = outline([-0.5, -0.5], [0.5, 0.5], [counts[0]; 2]);
        let mut free = outline([-0.4, 0.75], [0.4, 1.55], [counts[1]; 2]);
        free.m.fill(1.0 / free.x.len() as f64);
        let mut bodies = [rotor, free];
        bodies[0].m.fill(f64::INFINITY);
        let mut contact = MeshContact::new(Frictionless).between(0, 1);
        let dt = 1e-3;
        let mut pushed = 0;
        for step in 0..600 {
            let turn: f64 = 20.0 * dt;
            let rotor = &mut bodies[0];
            for (x, v) in rotor.x.iter().zip(&mut rotor.v) {
                let to = [x[0] * turn.cos() - x[1] * turn.sin(), x[0] * turn.sin() + x[1] * turn.cos()];
                *v = [(to[0] - x[0]) / dt, (to[1] - x[1]) / dt];
            }
            rigid(&mut bodies[1], dt, [0.0, -10.0 * dt]);
            let made = advance(&mut contact, &mut bodies, dt);
            pushed += usize::from(made.contacts > 0);
            assert!(made.depth <= 0.05, "{counts:?} step {step}: {made:?}");
        }
        assert!(pushed > 5, "{counts:?}: {pushed}");
    }
}

/// Set the velocities of a rigid body with the present momentum and angular momentum, over a step, and add this change of velocity.
fn rigid(body: &mut Body<2>, dt: f64, change: [f64; 2]) {
    let mass: f64 = body.m.iter().sum();
    let mean = |of: &[[f64; 2]]| {
        let each = of.iter().zip(&body.m);
        each.fold([0.0; 2], |s, (x, m)| [s[0] + m * x[0] / mass, s[1] + m * x[1] / mass])
    };
    let (centre, v) = (mean(&body.x), mean(&body.v));
    let (mut spin, mut inertia) = (0.0, 0.0);
    for ((x, w), m) in body.x.iter().zip(&body.v).zip(&body.m) {
        let r = [x[0] - centre[0], x[1] - centre[1]];
        spin += m * (r[0] * w[1] - r[1] * w[0]);
        inertia += m * (r[0] * r[0] + r[1] * r[1]);
    }
    let turn = spin / inertia * dt;
    for (x, w) in body.x.iter().zip(&mut body.v) {
        let r = [x[0] - centre[0], x[1] - centre[1]];
        let to = [r[0] * turn.cos() - r[1] * turn.sin(), r[0] * turn.sin() + r[1] * turn.cos()];
        for d in 0..2 {
            w[d] = v[d] + change[d] + (to[d] - r[d]) / dt;
        }
    }
}

#[test]
fn a_cube_of_quadrilaterals_among_small_balls() {
    let mut random = Random(4);
    let mut cube = brick([-0.5; 3], [0.5; 3], [2, 3, 4]);
    cube.m.fill(f64::INFINITY);
    let mut x = Vec::new();
    while x.len() < 300 {
        let at: [f64; 3] = random.vector().map(|c: f64| 0.9 * c);
        if at.iter().any(|c| c.abs() > 0.53) {
            x.push(at);
        }
    }
    let mut bodies = [Body::points(x, 1.0, 0.02), cube];
    let mut contact = MeshContact::new(Coulomb::new(0.4).unwrap()).between(0, 1);
    let dt = 1e-3;
    for step in 0..300 {
        for (x, v) in bodies[0].x.iter().zip(&mut bodies[0].v) {
            for d in 0..3 {
                v[d] = 0.95 * v[d] - 30.0 * x[d] * dt + 0.5 * random.next();
            }
        }
        // The cube rotates about two axes.
        let (a, b): (f64, f64) = (6.0 * dt, 4.0 * dt);
        for (x, v) in bodies[1].x.iter().zip(&mut bodies[1].v) {
            let y = [x[0] * a.cos() - x[1] * a.sin(), x[0] * a.sin() + x[1] * a.cos(), x[2]];
            let z = [y[0], y[1] * b.cos() - y[2] * b.sin(), y[1] * b.sin() + y[2] * b.cos()];
            *v = [0, 1, 2].map(|d| (z[d] - x[d]) / dt);
        }
        let made = advance(&mut contact, &mut bodies, dt);
        assert!(made.depth <= 0.05, "step {step}: {made:?}");
    }
}
