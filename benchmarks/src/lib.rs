//! Neighbour searches of the literature, written to be compared with that of `pcmm`: each returns, for every particle,
//! those whose circles of contact reach its own, in ascending order.
//!
//! | search | |
//! |---|---|
//! | [`pcmm::Neighbours`] | cells of the largest range, counting sort |
//! | [`tree`] | a balanced tree of boxes, cut at medians |
//! | [`pib`] | points in a box by two sorted coordinates \[Attaway1993\] |
//! | [`strip_pib`] | the same in strips \[Xiao2015\] |

mod pib;
// Here and not in a program of its own: those are tested beside all programs of the package, which take long to compile.
#[cfg(test)]
mod searches;
mod tree;

pub use pib::{pib, strip_pib};
pub use tree::tree;

use pcmm::Particle;

/// Lists one after the other, and where each begins.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lists {
    /// One more than there are particles.
    pub starts: Vec<u32>,
    /// Numbers of particles.
    pub list: Vec<u32>,
}

impl Lists {
    fn new(particles: usize) -> Self {
        let mut starts = Vec::with_capacity(particles + 1);
        starts.push(0);
        Lists { starts, list: Vec::new() }
    }
    /// End the list that is being filled.
    fn close(&mut self) {
        let start = self.starts[self.starts.len() - 1] as usize;
        self.list[start..].sort_unstable();
        self.starts.push(self.list.len() as u32);
    }
    /// The list of particle `i`.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.list[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

/// Are two particles in range?
fn touch(a: &Particle<2>, b: &Particle<2>, reach: f64) -> bool {
    let range = a.radius + b.radius + reach;
    let (x, y) = (a.position[0] - b.position[0], a.position[1] - b.position[1]);
    x * x + y * y <= range * range
}

/// Half the edge of the box around a particle that holds all it may touch.
fn half_box(p: &Particle<2>, largest: f64, reach: f64) -> f64 {
    p.radius + largest + reach
}

fn largest_radius(particles: &[Particle<2>]) -> f64 {
    particles.iter().fold(0.0, |m, p| m.max(p.radius))
}

/// A number in [0, 1) from a seed and a place.
pub fn random(seed: u64, place: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
    for _ in 0..3 {
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z ^= z >> 27;
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}

/// About `count` particles in a body `aspect` times as long as it is wide: a lattice, every particle moved by up to a
/// quarter of a spacing, radii from 0.4 to 0.6 of it, in random order (bodies that have flowed are not in order).
pub fn packing(count: usize, aspect: f64, seed: u64) -> Vec<Particle<2>> {
    let columns = ((count as f64 / aspect).sqrt().round() as usize).max(1);
    let mut particles: Vec<Particle<2>> = (0..count)
        .map(|n| {
            let at = |k: u64| random(seed, 3 * n as u64 + k);
            let position =
                [(n % columns) as f64 + 0.5 * (at(0) - 0.5), (n / columns) as f64 + 0.5 * (at(1) - 0.5)];
            Particle { position, velocity: [0.0; 2], mass: 1.0, radius: 0.4 + 0.2 * at(2) }
        })
        .collect();
    for n in (1..count).rev() {
        particles.swap(n, (random(seed + 1, n as u64) * (n + 1) as f64) as usize);
    }
    particles
}

/// Processor seconds of this process so far, by the system's count (hundredths); by the clock where there is none.
pub fn core_seconds(clock: &std::time::Instant) -> f64 {
    let used = || {
        let text = std::fs::read_to_string("/proc/self/stat").ok()?;
        // Behind the name, which may hold anything: state is field 3, user and system time are 14 and 15.
        let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
        let ticks = |n: usize| fields.get(n - 3)?.parse::<f64>().ok();
        Some((ticks(14)? + ticks(15)?) / 100.0)
    };
    used().unwrap_or_else(|| clock.elapsed().as_secs_f64())
}
