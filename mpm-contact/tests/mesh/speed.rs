//! Cost of contact: `cargo test --release -p mpm-contact --test mesh -- --ignored --nocapture speed`.

use std::time::Instant;

use impactite_simd::Team;
use mpm_contact::Coulomb;
use mpm_contact::mesh::MeshContact;

use crate::scene::{Body, Random, advance, sheet};

/// Benchmark of 100 000 points in ten layers over 10 000 facets, with the lowest layer on them; or 1 m above.
#[test]
#[ignore = "a measurement"]
fn speed_of_1e5_points_on_1e4_facets() {
    for (name, triangles, free) in [
        ("nothing near", false, false),
        ("quadrilaterals, fixed", false, false),
        ("triangles, fixed", true, false),
        ("quadrilaterals, free", false, true),
    ] {
        let counts = if triangles { 71 } else { 100 };
        let mut floor = sheet(5.0, counts, triangles);
        floor.m.fill(if free { 10.0 } else { f64::INFINITY });
        let mut random = Random(2);
        let x = (0..100_000).map(|i| {
            let (i, layer) = (i % 10_000, i / 10_000);
            let at = |k: i32| -4.9 + 0.098 * f64::from(k);
            let apart = if name == "nothing near" { 1.0 } else { 0.0 };
            [at(i % 100), at(i / 100), apart + 0.049 + 0.098 * f64::from(layer)]
        });
        let mut bodies = [Body::points(x.collect(), 1.0, 0.049), floor];
        let mut contact = MeshContact::new(Coulomb::new(0.3).unwrap()).between(0, 1);
        let team = Team::one();
        let dt = 1e-4;
        let (mut spent, mut contacts, mut sweeps, mut rounds, steps) = (0.0, 0, 0, 0, 50);
        for step in 0..steps {
            for v in &mut bodies[0].v {
                *v = [v[0] + 0.01 * random.next(), v[1], v[2] - 9.81 * dt];
            }
            let views = [bodies[0].view(), bodies[1].view()];
            let begun = Instant::now();
            let made = contact.step(&views, 0.0, dt, &team).unwrap();
            if step >= 5 {
                spent += begun.elapsed().as_secs_f64();
                contacts += made.contacts;
                sweeps = sweeps.max(made.sweeps);
                rounds = rounds.max(made.rounds);
            }
            advance(&mut contact, &mut bodies, dt);
        }
        let each = spent / f64::from(steps - 5);
        println!(
            "{name}: {:.1} ns a point and step, {:.0} ns a contact, {} contacts a step, at most {sweeps} sweeps and {rounds} rounds, {} searches",
            each * 1e9 / 1e5,
            each * 1e9 / (contacts / (steps - 5) as usize).max(1) as f64,
            contacts / (steps - 5) as usize,
            contact.searches()
        );
    }
}
