//! Point-in-box search: coordinates sorted along every axis, and intersection of the ranges.

use std::ops::Range;

use impactite_simd::Team;

use super::cells::Best;
use super::error::{SearchError, check_length, check_place};
use super::lists::{NeighbourLists, collect};
use super::points::{Points, Reach, bounds_of, distance_squared, half_box};
use super::{Nearest, NeighbourSearch};

/// Width of a strip over the range of the largest pair. The value of the paper is not known; 2 was the fastest in two dimensions.
const WIDTH: f64 = 2.0;

/// Point-in-box search \[Attaway1993\]: points are sorted along every axis. Of the index ranges of a box along the axes, the shortest is
/// traversed; ranks test membership in the others. The box size follows from the largest radius. Fast for thin bodies; O(N^(2 - 1/D)) for
/// others, and more for unequal radii.
#[derive(Clone, Debug)]
pub struct PointInBox<const D: usize>(Strips<D>);

/// Point-in-box search in strips \[Xiao2015\]: the plane is divided into strips along its longer side (space into square columns along its
/// longest), two ranges of the largest pair wide, and every strip is sorted separately. Strips inside the box need no rank test.
#[derive(Clone, Debug)]
pub struct StripPointInBox<const D: usize>(Strips<D>);

/// Points of a strip, sorted along all axes.
#[derive(Clone, Debug)]
struct Sorted<const D: usize> {
    /// Point indices by rank, per axis.
    order: [Vec<u32>; D],
    /// Coordinates by rank, per axis.
    places: [Vec<f64>; D],
    /// Ranks along all axes of the point with a rank along one axis.
    ranks: [Vec<[u32; D]>; D],
}

impl<const D: usize> Sorted<D> {
    /// Sort the points `numbers`. `rank` is scratch memory with one entry per point of the set.
    fn new(positions: &[[f64; D]], numbers: &[u32], rank: &mut [[u32; D]]) -> Self {
        let mut sorted = Sorted {
            order: [const { Vec::new() }; D],
            places: [const { Vec::new() }; D],
            ranks: [const { Vec::new() }; D],
        };
        for d in 0..D {
            let along = |i: &u32| positions[*i as usize][d];
            let order = &mut sorted.order[d];
            order.extend_from_slice(numbers);
            order.sort_unstable_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            sorted.places[d] = order.iter().map(along).collect();
            for (r, &i) in order.iter().enumerate() {
                rank[i as usize][d] = r as u32;
            }
        }
        for d in 0..D {
            sorted.ranks[d] = sorted.order[d].iter().map(|&i| rank[i as usize]).collect();
        }
        sorted
    }

    /// Range of ranks with coordinates from `low` to `high` along an axis.
    fn range(&self, d: usize, low: f64, high: f64) -> Range<u32> {
        let places = &self.places[d];
        places.partition_point(|&x| x < low) as u32..places.partition_point(|&x| x <= high) as u32
    }

    /// Visit the points in the box around `x`.
    #[inline(always)]
    fn visit(&self, x: &[f64; D], half: f64, visit: &mut impl FnMut(u32)) {
        let mut ranges = [const { 0..0 }; D];
        for d in 0..D {
            ranges[d] = self.range(d, x[d] - half, x[d] + half);
        }
        let walk = (1..D).fold(0, |w, d| if ranges[d].len() < ranges[w].len() { d } else { w });
        for r in ranges[walk].clone() {
            let ranks = &self.ranks[walk][r as usize];
            if (0..D).all(|d| ranges[d].contains(&ranks[d])) {
                visit(self.order[walk][r as usize]);
            }
        }
    }

    /// Visit the points in a range along one axis.
    #[inline(always)]
    fn along(&self, d: usize, low: f64, high: f64, visit: &mut impl FnMut(u32)) {
        let Range { start, end } = self.range(d, low, high);
        self.order[d][start as usize..end as usize].iter().for_each(|&i| visit(i));
    }
}

/// Points in strips, or all in one strip.
#[derive(Clone, Debug)]
struct Strips<const D: usize> {
    reach: Reach,
    positions: Vec<[f64; D]>,
    radii: Vec<f64>,
    largest: f64,
    low: [f64; D],
    high: [f64; D],
    /// Axis of the strips, and number of strips along each axis; 1 along their own axis.
    axis: usize,
    counts: [usize; D],
    width: f64,
    strips: Vec<Sorted<D>>,
}

impl<const D: usize> Strips<D> {
    fn new(points: &Points<'_, D>, reach: Reach, cut: bool) -> Result<Self, SearchError> {
        let largest = points.radii_range()[1];
        reach.check(largest)?;
        let positions = points.positions().to_vec();
        let (low, high) = bounds_of(positions.iter());
        let extent = |d: usize| high[d] - low[d];
        let axis = (1..D).fold(0, |a, d| if extent(d) > extent(a) { d } else { a });
        let mut counts = [1; D];
        let mut width = f64::INFINITY;
        if cut && !points.is_empty() {
            // At most as many strips as points.
            let shortest = extent(axis) / points.len() as f64;
            width = (WIDTH * reach.of(largest, largest)).max(shortest).max(f64::MIN_POSITIVE);
            let along = |d: usize, width: f64| (extent(d) / width).floor() + 1.0;
            let all = |width: f64| (0..D).filter(|&d| d != axis).map(|d| along(d, width)).product::<f64>();
            while all(width) > points.len() as f64 {
                width *= 1.25;
            }
            for d in (0..D).filter(|&d| d != axis) {
                counts[d] = along(d, width) as usize;
            }
        }
        let radii = (0..points.len()).map(|i| points.radius(i)).collect();
        let mut strips =
            Strips { reach, positions, radii, largest, low, high, axis, counts, width, strips: Vec::new() };
        let mut members = vec![Vec::new(); counts.iter().product()];
        for (i, x) in strips.positions.iter().enumerate() {
            let n = (0..D).rev().fold(0, |n, d| n * counts[d] + strips.strip(d, x[d]));
            members[n].push(i as u32);
        }
        let mut rank = vec![[0; D]; points.len()];
        strips.strips = members.iter().map(|m| Sorted::new(&strips.positions, m, &mut rank)).collect();
        Ok(strips)
    }

    fn strip(&self, d: usize, x: f64) -> usize {
        // A saturating cast maps negative numbers to zero.
        (((x - self.low[d]) / self.width) as usize).min(self.counts[d] - 1)
    }

    /// Visit the points in the box around `x`; strips are a superset.
    #[inline(always)]
    fn visit(&self, x: &[f64; D], half: f64, mut visit: impl FnMut(u32)) {
        let (mut first, mut last) = ([0; D], [0; D]);
        for d in 0..D {
            first[d] = self.strip(d, x[d] - half);
            last[d] = self.strip(d, x[d] + half);
        }
        let mut at = first;
        loop {
            let strip = &self.strips[(0..D).rev().fold(0, |n, d| n * self.counts[d] + at[d])];
            let across = |d: &usize| *d != self.axis;
            if D > 1 && (0..D).filter(across).all(|d| first[d] < at[d] && at[d] < last[d]) {
                strip.along(self.axis, x[self.axis] - half, x[self.axis] + half, &mut visit);
            } else {
                strip.visit(x, half, &mut visit);
            }
            let Some(d) = (0..D).find(|&d| at[d] < last[d]) else { return };
            at[d] += 1;
            at[..d].copy_from_slice(&first[..d]);
        }
    }

    fn find(&self, x: &[f64; D], radius: f64, but: u32, found: &mut Vec<u32>) {
        if self.positions.is_empty() {
            return;
        }
        self.visit(x, half_box(self.reach.of(radius, self.largest)), |i| {
            let range = self.reach.of(radius, self.radii[i as usize]);
            if i != but && distance_squared(x, &self.positions[i as usize]) <= range * range {
                found.push(i);
            }
        });
    }

    fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError> {
        collect(self.positions.len(), team, lists, |i, found| {
            self.find(&self.positions[i], self.radii[i], i as u32, found);
        })
    }

    fn neighbours_of(&self, others: &Points<'_, D>, team: &Team) -> Result<NeighbourLists, SearchError> {
        self.reach.check(others.radii_range()[1])?;
        let mut lists = NeighbourLists::new();
        collect(others.len(), team, &mut lists, |i, found| {
            self.find(&others.positions()[i], others.radius(i), u32::MAX, found);
        })?;
        Ok(lists)
    }

    fn visit_within(
        &self,
        x: &[f64; D],
        radius: f64,
        visit: &mut dyn FnMut(u32, f64),
    ) -> Result<(), SearchError> {
        check_place(x)?;
        check_length("radius of the ball", radius)?;
        if !self.positions.is_empty() {
            self.visit(x, half_box(radius), |i| {
                let square = distance_squared(x, &self.positions[i as usize]);
                if square <= radius * radius {
                    visit(i, square.sqrt());
                }
            });
        }
        Ok(())
    }

    fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError> {
        check_place(x)?;
        let mut best = Best::none();
        if !self.positions.is_empty() {
            // Estimate of the mean spacing.
            let extent = (0..D).map(|d| self.high[d] - self.low[d]).fold(0.0, f64::max);
            let step = extent / (self.positions.len() as f64).powf(1.0 / D as f64);
            best.among_boxes(x, &self.low, &self.high, step, |half, best| {
                self.visit(x, half, |i| best.offer(i, distance_squared(x, &self.positions[i as usize])));
            });
        }
        Ok(best.point())
    }
}

macro_rules! search_of_strips {
    ($search:ident, $cut:literal) => {
        impl<const D: usize> NeighbourSearch<D> for $search<D> {
            fn new(points: &Points<'_, D>, reach: Reach) -> Result<Self, SearchError> {
                Strips::new(points, reach, $cut).map($search)
            }
            fn len(&self) -> usize {
                self.0.positions.len()
            }
            fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError> {
                self.0.neighbours_into(team, lists)
            }
            fn neighbours_of(
                &self,
                others: &Points<'_, D>,
                team: &Team,
            ) -> Result<NeighbourLists, SearchError> {
                self.0.neighbours_of(others, team)
            }
            fn visit_within(
                &self,
                x: &[f64; D],
                radius: f64,
                visit: &mut dyn FnMut(u32, f64),
            ) -> Result<(), SearchError> {
                self.0.visit_within(x, radius, visit)
            }
            fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError> {
                self.0.nearest(x)
            }
        }
    };
}

search_of_strips!(PointInBox, false);
search_of_strips!(StripPointInBox, true);
