//! Volumes of particles by the cells of their Voronoi diagram in a shape.

use std::collections::HashMap;

use super::seed::{Seeds, part_below};
use super::shape::{Metric, Shape};
use super::vector::sum;
use impactite_simd::Team;

/// Depth of a site, in edges of a particle, from which its particle has the whole site.
const DEEP: f64 = 1.7;
/// Largest correction of a volume that puts the centroid in its place.
const LARGEST: f64 = 0.02;
/// Relative difference of squared distances that are equal.
const EQUAL: f64 = 1e-9;
/// Number of sites along an axis in which the particle nearest to a sample is sought, to each side.
const REACH: usize = 2;
/// Number of sites whose samples are in memory at once.
const SITES_AT_ONCE: usize = 4096;

impl<const D: usize> Seeds<D> {
    /// Replace the volumes by those of the cells of the Voronoi diagram in the shape, up to their sampling, scaled to the same sum. The
    /// particles of a [filling](super::fill) that were moved to half a particle below the surface, and those behind them, have more or
    /// less than a whole site around them, by up to a quarter; with their own cells the centroid is that of the shape.
    ///
    /// Particles should be of one edge, on sites of a lattice but for the outermost layer. Around an axis volumes are per radian.
    #[must_use]
    pub fn with_cell_volumes(mut self, shape: &(impl Shape<D> + ?Sized), metric: Metric) -> Self {
        let edge = 2.0 * self.half_size.iter().fold(f64::INFINITY, |least, half| least.min(*half));
        if self.is_empty() || edge <= 0.0 {
            return self;
        }
        let total = self.measure();
        let sites = Sites::of(&self.positions, edge);
        let whole = edge.powi(D as i32);
        let weight = |x: &[f64; D]| if metric == Metric::Axisymmetric { x[0].max(0.0) } else { 1.0 };
        let team = Team::ambient();
        // Particles far below the surface, which have their whole sites.
        let mut deep = vec![false; self.len()];
        team.each(&mut deep, |n, deep| {
            *deep = shape.signed_distance_within(self.positions[n], 2.0 * DEEP * edge) <= -DEEP * edge;
        });
        let mut volumes = vec![0.0; self.len()];
        let mut around: Vec<[i64; D]> = Vec::new();
        for (n, x) in self.positions.iter().enumerate() {
            if deep[n] {
                volumes[n] += whole * weight(x);
            } else {
                sites.around(&sites.site(x), 1, &mut around);
            }
        }
        around.sort_unstable();
        around.dedup();
        let parts = if D <= 2 { 6 } else { 4 };
        let samples = Samples { parts, edge: edge / parts as f64 };
        let mut shares: Vec<Vec<(u32, f64)>> = vec![Vec::new(); SITES_AT_ONCE.min(around.len())];
        for around in around.chunks(SITES_AT_ONCE) {
            let shares = &mut shares[..around.len()];
            team.each(shares, |at, shares| {
                shares.clear();
                let site = &around[at];
                if sites.at.get(site).is_some_and(|list| list.iter().any(|n| deep[*n as usize])) {
                    return;
                }
                let mut near = SiteParticles::new(&sites, &self.positions, site);
                samples.each(&sites.corner(site), |x| {
                    let distance = shape.signed_distance_within(x, edge);
                    let part = part_below(shape, x, [samples.edge; D], distance);
                    if part > 0.0 {
                        let nearest = near.nearest(&x);
                        let share = part * samples.edge.powi(D as i32) * weight(&x) / nearest.len() as f64;
                        shares.extend(nearest.iter().map(|n| (*n, share)));
                    }
                });
            });
            // In the order of sites, so that the sums do not depend on the number of threads.
            shares.iter().flatten().for_each(|(n, share)| volumes[*n as usize] += share);
        }
        let found = sum(volumes.iter().copied());
        if volumes.iter().all(|v| *v > 0.0) && found.is_finite() {
            self.volumes = volumes.iter().map(|v| v * total / found).collect();
            if let (Metric::Cartesian, Some(centroid)) = (metric, shape.centroid()) {
                self.move_centroid(&centroid);
            }
        }
        self
    }

    /// Correct the volumes by factors that are linear in place, so that their centroid is exactly this one, m; their sum stays.
    fn move_centroid(&mut self, to: &[f64; D]) {
        let (from, total) = (self.centroid(), self.measure());
        let arm = |x: &[f64; D]| nalgebra::SVector::<f64, D>::from_fn(|d, _| x[d] - from[d]);
        let mut moments = nalgebra::SMatrix::<f64, D, D>::zeros();
        for (x, v) in self.positions.iter().zip(&self.volumes) {
            moments += arm(x) * arm(x).transpose() * *v;
        }
        let Some(inverse) = moments.try_inverse() else { return };
        let slope = inverse * nalgebra::SVector::<f64, D>::from_fn(|d, _| (to[d] - from[d]) * total);
        let factors: Vec<f64> = self.positions.iter().map(|x| 1.0 + slope.dot(&arm(x))).collect();
        // A correction of more than sampling would be one of something else.
        if factors.iter().all(|f| (f - 1.0).abs() < LARGEST) {
            self.volumes.iter_mut().zip(factors).for_each(|(v, f)| *v *= f);
        }
    }
}

/// Samples of a site: the centres of equal parts of it.
struct Samples {
    parts: usize,
    edge: f64,
}

impl Samples {
    fn each<const D: usize>(&self, corner: &[f64; D], mut visit: impl FnMut([f64; D])) {
        for n in 0..self.parts.pow(D as u32) {
            let mut rest = n;
            visit(std::array::from_fn(|d| {
                let k = rest % self.parts;
                rest /= self.parts;
                corner[d] + (k as f64 + 0.5) * self.edge
            }));
        }
    }
}

/// Particles by sites of a lattice of which the first particle has a site of its own.
struct Sites<const D: usize> {
    origin: [f64; D],
    edge: f64,
    at: HashMap<[i64; D], Vec<u32>>,
}

impl<const D: usize> Sites<D> {
    /// Create for particles of this edge; the lattice is that of the sites with the most particles at their centres.
    fn of(positions: &[[f64; D]], edge: f64) -> Self {
        let mut sites = Sites { origin: lattice_of(positions, edge), edge, at: HashMap::new() };
        for (n, x) in positions.iter().enumerate() {
            let site = sites.site(x);
            sites.at.entry(site).or_default().push(n as u32);
        }
        sites
    }
    fn site(&self, x: &[f64; D]) -> [i64; D] {
        std::array::from_fn(|d| ((x[d] - self.origin[d]) / self.edge).floor() as i64)
    }
    fn corner(&self, site: &[i64; D]) -> [f64; D] {
        std::array::from_fn(|d| self.origin[d] + site[d] as f64 * self.edge)
    }
    /// Append the sites up to `reach` from this one.
    fn around(&self, site: &[i64; D], reach: i64, out: &mut Vec<[i64; D]>) {
        let side = (2 * reach + 1) as usize;
        for n in 0..side.pow(D as u32) {
            out.push(std::array::from_fn(|d| site[d] + (n / side.pow(d as u32) % side) as i64 - reach));
        }
    }
}

/// Particles around a site, for the nearest ones to places in it.
struct SiteParticles<'a, const D: usize> {
    sites: &'a Sites<D>,
    positions: &'a [[f64; D]],
    site: &'a [i64; D],
    /// Particles of the sites up to 1, 2, ... [`REACH`] away, each found on first use.
    around: [Option<Vec<u32>>; REACH],
    squares: Vec<f64>,
    nearest: Vec<u32>,
}

impl<'a, const D: usize> SiteParticles<'a, D> {
    fn new(sites: &'a Sites<D>, positions: &'a [[f64; D]], site: &'a [i64; D]) -> Self {
        let (squares, nearest) = (Vec::new(), Vec::new());
        SiteParticles { sites, positions, site, around: std::array::from_fn(|_| None), squares, nearest }
    }
    /// Find the particles nearest to a place in the site: all that are equally near, so that symmetric shapes stay so.
    fn nearest(&mut self, x: &[f64; D]) -> &[u32] {
        let SiteParticles { sites, positions, site, around, squares, nearest } = self;
        for (n, around) in around.iter_mut().enumerate() {
            let reach = n as i64 + 1;
            let near = around.get_or_insert_with(|| {
                let mut list = Vec::new();
                sites.around(site, reach, &mut list);
                list.iter().filter_map(|site| sites.at.get(site)).flatten().copied().collect()
            });
            let square =
                |n: &u32| -> f64 { (0..D).map(|d| (x[d] - positions[*n as usize][d]).powi(2)).sum() };
            squares.clear();
            squares.extend(near.iter().map(square));
            let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
            let equal = |square: f64| square <= least * (1.0 + EQUAL);
            nearest.clear();
            nearest.extend(near.iter().zip(&*squares).filter(|(_, s)| equal(**s)).map(|(n, _)| *n));
            // A particle of a site farther off is at least `reach` edges away.
            if least <= (reach as f64 * sites.edge).powi(2) {
                break;
            }
        }
        nearest
    }
}

/// Origin of the sites, modulo their edge: the most frequent remainder of the positions along each axis, less half an edge.
fn lattice_of<const D: usize>(positions: &[[f64; D]], edge: f64) -> [f64; D] {
    const BINS: f64 = 1024.0;
    std::array::from_fn(|d| {
        let mut counts: HashMap<i64, (u32, f64)> = HashMap::new();
        for x in positions {
            let rest = (x[d] / edge).rem_euclid(1.0);
            let bin = counts.entry((rest * BINS).round() as i64 % BINS as i64).or_insert((0, rest));
            bin.0 += 1;
        }
        let most = counts.iter().max_by_key(|(bin, (count, _))| (*count, std::cmp::Reverse(**bin)));
        (most.map_or(0.5, |(_, (_, rest))| *rest) - 0.5) * edge
    })
}

#[cfg(test)]
mod tests {
    use crate::{Ball, Filling, Lattice, Metric, Polygon, Shape, fill};

    fn offset<const D: usize>(shape: &dyn Shape<D>, centre: [f64; D], edge: f64) -> [f64; 2] {
        let lattice = Lattice::new([0.0; D], 2.0 * edge).unwrap();
        let seeds = fill(shape, &lattice, 2, &Filling::new()).unwrap();
        let far = |c: [f64; D]| (0..D).map(|d| (c[d] - centre[d]).abs()).fold(0.0f64, f64::max) / edge;
        let before = far(seeds.centroid());
        let total = seeds.measure();
        let after = seeds.with_cell_volumes(shape, Metric::Cartesian);
        assert!((after.measure() / total - 1.0).abs() < 1e-12);
        [before, far(after.centroid())]
    }

    #[test]
    fn the_centroid_of_cells_is_that_of_the_shape() {
        // A hexagon and a triangle off the lattice, and a ball.
        let hexagon: Vec<[f64; 2]> = (0..6)
            .map(|n| {
                let a = f64::from(n) * std::f64::consts::FRAC_PI_3 + 0.49;
                [0.0396 + 0.03 * a.cos(), 0.0473 + 0.03 * a.sin()]
            })
            .collect();
        let [before, after] = offset(&Polygon::new(hexagon).unwrap(), [0.0396, 0.0473], 0.004);
        assert!(before > 0.1 && after < 0.03, "{before} {after}");
        let triangle = vec![[0.01, 0.013], [0.071, 0.027], [0.02, 0.07]];
        let [_, after] = offset(&Polygon::new(triangle).unwrap(), [0.101 / 3.0, 0.11 / 3.0], 0.004);
        assert!(after < 0.06, "{after}");
        let [_, after] =
            offset(&Ball::<3>::new([0.01, 0.02, 0.03], 0.021).unwrap(), [0.01, 0.02, 0.03], 0.004);
        assert!(after < 0.02, "{after}");
    }

    #[test]
    fn a_ball_on_the_axis_keeps_the_points_beside_it() {
        let (shape, edge) = (Ball::new([0.0, 0.2], 0.5).unwrap(), 0.03);
        let lattice = Lattice::new([0.0; 2], 2.0 * edge).unwrap();
        let seeds = fill(&shape, &lattice, 2, &Filling::new().axisymmetric()).unwrap();
        let seeds = seeds.with_cell_volumes(&shape, Metric::Axisymmetric);
        let whole = edge * edge;
        let least = seeds.positions.iter().zip(&seeds.volumes).map(|(x, v)| v / (whole * x[0]));
        assert!(least.fold(f64::INFINITY, f64::min) > 0.3);
        assert!((seeds.measure() / (2.0 / 3.0 * 0.5f64.powi(3)) - 1.0).abs() < 1e-9);
        let height = seeds.positions.iter().zip(&seeds.volumes).map(|(x, v)| x[1] * v).sum::<f64>();
        assert!((height / seeds.measure() - 0.2).abs() < 0.05 * edge);
    }
}
