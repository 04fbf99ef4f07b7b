//! All searches find the same: what looking at every pair finds.

use crate::{packing, pib, random, strip_pib, tree};
use mpm_core::Team;
use pcmm::{Neighbours, Particle};

fn every_pair(particles: &[Particle<2>], reach: f64) -> Vec<Vec<u32>> {
    let touch = |a: &Particle<2>, b: &Particle<2>| {
        let [x, y] = [0, 1].map(|d| a.position[d] - b.position[d]);
        x * x + y * y <= (a.radius + b.radius + reach).powi(2)
    };
    let partners = |i: usize| {
        (0..particles.len())
            .filter(|&j| j != i && touch(&particles[i], &particles[j]))
            .map(|j| j as u32)
            .collect()
    };
    (0..particles.len()).map(partners).collect()
}

#[test]
fn all_searches_find_every_pair() {
    for (count, aspect) in [(1, 1.0), (7, 1.0), (400, 1.0), (400, 30.0), (333, 0.05)] {
        let mut particles = packing(count, aspect, 5);
        // A few that flew far, and two at one place.
        for n in 0..count / 50 {
            particles[n].position = [300.0 * random(9, n as u64), -200.0];
        }
        if count > 3 {
            particles[2].position = particles[3].position;
        }
        for reach in [0.0, 0.3, 2.0] {
            let all = every_pair(&particles, reach);
            let mut cells = Neighbours::new(reach, 0.0);
            cells.update(&particles, &Team::one());
            let lists = [
                tree(&particles, reach),
                pib(&particles, reach),
                strip_pib(&particles, reach, 2.0),
                strip_pib(&particles, reach, 0.4),
            ];
            for (i, wanted) in all.iter().enumerate() {
                assert_eq!(cells.of(i), &wanted[..]);
                for list in &lists {
                    assert_eq!(list.of(i), &wanted[..]);
                }
            }
        }
    }
}
