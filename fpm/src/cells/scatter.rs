//! Random points, from a seed.

use super::domain::Domain;
use super::error::{CellsError, parameter};
use super::voronoi::tessellate;
use crate::vector::difference;

/// Smallest distance of two points over the local spacing.
const NEAREST: f64 = 0.75;
/// Trials per point, of those accepted by the spacing, before the set counts as saturated.
const THROWS: usize = 200;

/// Return random points in a domain at distances of about `spacing` (m, at a place), at least three quarters of it. There are as many as on
/// a lattice. They are identical for the same seed, on any machine. The spacing may vary in space.
///
/// # Errors
/// A spacing that is not positive and finite, or so small that there would be more than 2^31 points.
pub fn scattered<const D: usize>(
    domain: &Domain<D>,
    seed: u64,
    spacing: impl Fn([f64; D]) -> f64,
) -> Result<Vec<[f64; D]>, CellsError> {
    let mut random = Random(seed);
    let (low, high) = (domain.bounds().min, domain.bounds().max);
    let place = |random: &mut Random| -> [f64; D] {
        std::array::from_fn(|d| low[d] + random.next() * (high[d] - low[d]))
    };
    // Estimate their number and the range of spacings from random places.
    const TRIALS: usize = 4096;
    let (mut density, mut within, mut least, mut most) = (0.0, 0, f64::INFINITY, 0.0f64);
    for _ in 0..TRIALS {
        let x = place(&mut random);
        if domain.contains(x) {
            let s = checked(&spacing, x)?;
            (least, most, within) = (least.min(s), most.max(s), within + 1);
            density += s.powi(-(D as i32));
        }
    }
    parameter(
        within > 0,
        "scattered points",
        "share of the domain in its box",
        0.0,
        "a thousandth at least",
    )?;
    let wanted = (domain.volume() * density / f64::from(within)).round().max(1.0);
    parameter(wanted < f64::from(i32::MAX), "scattered points", "number of points", wanted, "below 2^31")?;
    let mut buckets = Buckets::new(low, high, most);
    let mut points: Vec<[f64; D]> = Vec::with_capacity(wanted as usize);
    let taken = least.powi(D as i32) * density / f64::from(within);
    for _ in 0..(THROWS as f64 * wanted / taken) as usize {
        if points.len() == wanted as usize {
            break;
        }
        let (x, chance) = (place(&mut random), random.next());
        if !domain.contains(x) {
            continue;
        }
        let s = checked(&spacing, x)?;
        // Accept with a probability proportional to the number density.
        if chance < (least / s).powi(D as i32) && buckets.free(&x, NEAREST * s, &points) {
            buckets.add(&x, points.len() as u32);
            points.push(x);
        }
    }
    Ok(points)
}

fn checked<const D: usize>(spacing: impl Fn([f64; D]) -> f64, x: [f64; D]) -> Result<f64, CellsError> {
    let s = spacing(x);
    parameter(s > 0.0, "scattered points", "spacing", s, "positive and finite")
}

/// Move points to the centroids of their Voronoi cells, `steps` times (Lloyd's algorithm): cells become rounder and more uniform.
///
/// # Errors
/// Errors of [`Cells::voronoi`](super::Cells::voronoi).
pub fn relaxed<const D: usize>(
    mut points: Vec<[f64; D]>,
    domain: &Domain<D>,
    steps: usize,
) -> Result<Vec<[f64; D]>, CellsError> {
    for _ in 0..steps {
        let cells = tessellate(&points, domain)?;
        for (x, cell) in points.iter_mut().zip(&cells) {
            *x = cell.volume_and_centroid(x).1;
        }
    }
    Ok(points)
}

/// Portable random numbers: SplitMix64 \[Steele2014\].
struct Random(u64);

impl Random {
    /// Return the next number, from 0 (included) to 1 (excluded).
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Points in boxes of the largest spacing, for the neighbour search.
struct Buckets<const D: usize> {
    low: [f64; D],
    edge: f64,
    counts: [usize; D],
    numbers: Vec<Vec<u32>>,
}

impl<const D: usize> Buckets<D> {
    fn new(low: [f64; D], high: [f64; D], edge: f64) -> Self {
        let counts: [usize; D] =
            std::array::from_fn(|d| (((high[d] - low[d]) / edge) as usize).clamp(1, 1 << 10));
        // A bound of their number makes boxes larger.
        let longest = (0..D).map(|d| (high[d] - low[d]) / counts[d] as f64).fold(edge, f64::max);
        let counts = std::array::from_fn(|d| ((high[d] - low[d]) / longest) as usize + 1);
        Buckets { low, edge: longest, counts, numbers: vec![Vec::new(); counts.iter().product()] }
    }

    fn along(&self, x: &[f64; D]) -> [usize; D] {
        std::array::from_fn(|d| (((x[d] - self.low[d]) / self.edge) as usize).min(self.counts[d] - 1))
    }

    fn add(&mut self, x: &[f64; D], number: u32) {
        let at = self.along(x);
        let place = (0..D).rev().fold(0, |place, d| place * self.counts[d] + at[d]);
        self.numbers[place].push(number);
    }

    /// True if no point is within `radius`, at most the edge of a box.
    fn free(&self, x: &[f64; D], radius: f64, points: &[[f64; D]]) -> bool {
        let at = self.along(x);
        let sides = 3usize.pow(D as u32);
        for side in 0..sides {
            let (mut rest, mut place, mut scale, mut inside) = (side, 0, 1, true);
            for d in 0..D {
                let there = (at[d] + rest % 3).wrapping_sub(1);
                inside &= there < self.counts[d];
                place += scale * there.min(self.counts[d] - 1);
                (rest, scale) = (rest / 3, scale * self.counts[d]);
            }
            let near = |&n: &u32| {
                let from = difference(&points[n as usize], x);
                crate::vector::dot(&from, &from) < radius * radius
            };
            if inside && self.numbers[place].iter().any(near) {
                return false;
            }
        }
        true
    }
}
