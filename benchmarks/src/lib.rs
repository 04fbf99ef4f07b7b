//! Common parts of benchmark programs and the results page: scenes of smoothed particles, neighbour searches and their point sets, and
//! timing.

pub mod bar;
mod clock;
pub mod search;

pub use clock::{Stepped, stepped, timed};

/// Smoothing length of smoothed particles over their spacing: pairs within twice the smoothing length are
/// neighbours.
const SMOOTHING: f64 = 1.3;

/// Point set: positions and radii.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud<const D: usize> {
    /// Positions, in spacings or in edges of the body.
    pub positions: Vec<[f64; D]>,
    /// Radius of each point.
    pub radii: Vec<f64>,
}

impl<const D: usize> Cloud<D> {
    /// Create smoothed particles at these positions, each displaced along every axis by up to a tenth of its spacing, with the smoothing
    /// length of 1.3 spacings as the radius.
    pub fn smoothed(positions: &[[f64; D]], spacings: &[f64], seed: u64) -> Self {
        let moved = |(n, (x, spacing)): (usize, (&[f64; D], &f64))| {
            std::array::from_fn(|d| x[d] + 0.2 * spacing * (random(seed, (D * n + d) as u64) - 0.5))
        };
        Cloud {
            positions: positions.iter().zip(spacings).enumerate().map(moved).collect(),
            radii: spacings.iter().map(|spacing| SMOOTHING * spacing).collect(),
        }
    }

    /// Shuffle the points, as in bodies after large flow.
    #[must_use]
    pub fn shuffled(mut self, seed: u64) -> Self {
        for n in (1..self.radii.len()).rev() {
            let other = (random(seed, n as u64) * (n + 1) as f64) as usize;
            self.positions.swap(n, other);
            self.radii.swap(n, other);
        }
        self
    }
}

/// Return a pseudo-random number in [0, 1) by seed and index.
pub fn random(seed: u64, place: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ place.wrapping_mul(0xD1B5_4A32_D192_ED03);
    for _ in 0..3 {
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z ^= z >> 27;
    }
    (z >> 11) as f64 / (1u64 << 53) as f64
}

/// Create smoothed particles ([`Cloud::smoothed`]) on a lattice of unit spacing with `counts` points along the axes, in lattice order: 20
/// neighbours per particle in two and 76 to 80 in three dimensions, except at the surface.
pub fn lattice<const D: usize>(counts: [usize; D], seed: u64) -> Cloud<D> {
    let total: usize = counts.iter().product();
    let place = |n: usize| {
        let mut rest = n;
        std::array::from_fn(|d| {
            let at = (rest % counts[d]) as f64;
            rest /= counts[d];
            at
        })
    };
    let positions: Vec<[f64; D]> = (0..total).map(place).collect();
    Cloud::smoothed(&positions, &vec![1.0; total], seed)
}

/// Create about `count` particles in a body with length to width ratio `aspect`: a lattice with displacements of up
/// to a quarter of a spacing, radii from 0.4 to 0.6 of it, in random order.
pub fn packing<const D: usize>(count: usize, aspect: f64, seed: u64) -> Cloud<D> {
    let columns = ((count as f64 / aspect).powf(1.0 / D as f64).round() as usize).max(1);
    let mut cloud = Cloud::default();
    for n in 0..count {
        let at = |k: usize| random(seed, ((D + 1) * n + k) as u64);
        let mut rest = n;
        cloud.positions.push(std::array::from_fn(|d| {
            let column = if d + 1 < D { rest % columns } else { rest };
            rest /= columns;
            column as f64 + 0.5 * (at(d) - 0.5)
        }));
        cloud.radii.push(0.4 + 0.2 * at(D));
    }
    cloud.shuffled(seed + 1)
}

/// Create random points in a unit cube, refined along the first axis: radii decrease by `ratio` from one side to the other, and are
/// everywhere 0.7 of the spacing.
pub fn graded<const D: usize>(count: usize, ratio: f64, seed: u64) -> Cloud<D> {
    // Density over that at the coarse side: ratio^(D x); its integral is inverted.
    let rate = D as f64 * ratio.ln();
    let mut cloud = Cloud::default();
    for n in 0..count {
        let at = |k: usize| random(seed, (D * n + k) as u64);
        let x = if rate > 0.0 { (at(0) * rate.exp_m1()).ln_1p() / rate } else { at(0) };
        cloud.positions.push(std::array::from_fn(|d| if d == 0 { x } else { at(d) }));
        let density = count as f64 * if rate > 0.0 { rate / rate.exp_m1() * (rate * x).exp() } else { 1.0 };
        cloud.radii.push(0.7 * density.powf(-1.0 / D as f64));
    }
    cloud.shuffled(seed + 1)
}

/// Create random points in a unit cube with local radius ratios of up to `ratio`: every range of sizes has the same volume, and all of them
/// fill a half.
pub fn mixed<const D: usize>(count: usize, ratio: f64, seed: u64) -> Cloud<D> {
    let power = -(D as f64);
    let mut cloud = Cloud::default();
    for n in 0..count {
        let at = |k: usize| random(seed, ((D + 1) * n + k) as u64);
        cloud.positions.push(std::array::from_fn(at));
        // Size distribution: numbers decrease with size to the power -D for each factor of size.
        cloud.radii.push((1.0 - at(D) * (1.0 - ratio.powf(power))).powf(1.0 / power));
    }
    let ball = [2.0, std::f64::consts::PI, 4.0 / 3.0 * std::f64::consts::PI][D - 1];
    let matter: f64 = cloud.radii.iter().map(|r| ball * r.powi(D as i32)).sum();
    let scale = (0.5 / matter).powf(1.0 / D as f64);
    cloud.radii.iter_mut().for_each(|r| *r *= scale);
    cloud
}
