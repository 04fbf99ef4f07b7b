//! Multilevel cell lists, filled by a counting sort.

use std::ops::Range;

use impactite_simd::Team;

use super::error::{SearchError, check_length, check_place};
use super::lists::{CHUNK, Limit, NeighbourLists, Rows, assemble};
use super::points::{Pair, Points, Reach, bounds_of, distance_squared, distance_to_box, for_pair, half_box};
use super::{Nearest, NeighbourSearch};

/// Maximum number of cells per point: memory is proportional to the number of points, whatever their extent.
const CELLS_PER_POINT: usize = 4;
/// Number of cells that is always allowed.
const FEWEST_CELLS: usize = 64;
/// Maximum number of levels. Points whose range is smaller than the largest by 2^32 or more share the cells of the last level.
const LEVELS: usize = 32;
/// Maximum extent of all points in cells: such cells are resolved in double precision.
const MOST_ALONG: f64 = (1u64 << 40) as f64;
/// Minimum cell edge (m), so that its inverse is finite.
const SHORTEST_EDGE: f64 = 1e-150;
/// Minimum average number of points per occupied cell: below this, cells are enlarged if some are folded. Points
/// thrown at random at four times as many cells give 1.13.
const FULL_ENOUGH: f64 = 1.25;

/// Multilevel cell lists for points of any dimension and of very different radii.
///
/// Points are assigned to levels, one for each power of two of the range R(r, r) of a pair of equal radii; points of similar
/// radii share one level. The cells of a level are as large as the largest range of its points. A level is filled by a counting sort, so
/// that the points of a cell, and of adjacent cells, are contiguous in memory (cell lists \[Feng2014\]; a grid for each
/// size \[OgarkoLuding2012\]). A point searches its own level and those of larger points, at most 3^D
/// cells of each; a pair across levels is also added to the list of the larger point. The cost is O(N) a level, however small the
/// smallest points are.
///
/// If a level has more than four times as many cells as points, its cells are folded onto each other, as on a torus. Memory
/// then stays proportional to the number of points whatever their extent, and dense regions keep their small cells whatever flies off
/// elsewhere (similar to hashing \[Teschner2003\], but in the order of cells). Folded cells add distant candidates and
/// change no list.
///
/// [`nearest`](NeighbourSearch::nearest) searches boxes of doubling size until one contains a point.
///
/// ```
/// use impactite_geometry::search::{NeighbourSearch, Points, Reach, SearchError, SortedCells};
/// // A large disc that touches two small ones, which do not touch each other.
/// let positions = [[0.0, 0.0], [1.05, 0.0], [0.0, -1.1]];
/// let points = Points::new(&positions, &[1.0, 0.1, 0.1])?;
/// let cells = SortedCells::new(&points, Reach::sum(0.0))?;
/// assert_eq!(cells.levels(), 2);
/// let mut pairs = Vec::new();
/// cells.each_pair(|i, j| pairs.push([i.min(j), i.max(j)]));
/// pairs.sort_unstable();
/// assert_eq!(pairs, [[0, 1], [0, 2]]);
/// # Ok::<(), SearchError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SortedCells<const D: usize> {
    reach: Reach,
    /// Levels, largest points first.
    levels: Vec<Level<D>>,
    /// Points by level and cell.
    sorted: Vec<Entry<D>>,
}

#[derive(Clone, Copy, Debug)]
struct Entry<const D: usize> {
    position: [f64; D],
    radius: f64,
    number: u32,
}

/// Cells of the points of similar size.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    /// Largest radius of the level.
    largest: f64,
    /// Range of a pair of the largest radius.
    range: f64,
    low: [f64; D],
    high: [f64; D],
    /// Inverse of the cell edge.
    inverse: f64,
    /// Unfolded number of cells along each axis.
    natural: [u64; D],
    /// Number of cells along each axis after folding.
    counts: [usize; D],
    /// Offset of each cell in the sorted points of all levels.
    starts: Vec<u32>,
    /// Range of this level in the sorted points of all levels.
    places: Range<usize>,
}

impl<const D: usize> Level<D> {
    /// Sort the points `numbers` by cell and append them to `sorted`.
    fn sort(
        points: &Points<'_, D>,
        numbers: impl ExactSizeIterator<Item = u32> + Clone,
        largest: f64,
        range: f64,
        sorted: &mut Vec<Entry<D>>,
    ) -> Self {
        let positions = points.positions();
        let place = |i: u32| &positions[i as usize];
        let (low, high) = bounds_of(numbers.clone().map(place));
        let (first, count) = (sorted.len(), numbers.len());
        let mut level = Level {
            largest,
            range,
            low,
            high,
            inverse: 0.0,
            natural: [1; D],
            counts: [1; D],
            starts: Vec::new(),
            places: first..first + count,
        };
        let longest = (0..D).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        let mut edge = range.max(longest / MOST_ALONG).max(SHORTEST_EDGE);
        let mut cells: Vec<u32> = Vec::with_capacity(count);
        loop {
            level.inverse = 1.0 / edge;
            let folded = level.lay_out((CELLS_PER_POINT * count).max(FEWEST_CELLS));
            level.starts.clear();
            level.starts.resize(level.counts.iter().product::<usize>() + 1, 0);
            cells.clear();
            cells.extend(numbers.clone().map(|i| level.index(place(i)) as u32));
            for &c in &cells {
                level.starts[c as usize + 1] += 1;
            }
            let occupied = level.starts.iter().filter(|&&n| n > 0).count();
            if !folded || FULL_ENOUGH * occupied as f64 <= count as f64 {
                break;
            }
            edge *= 2.0;
        }
        level.starts[0] = first as u32;
        for c in 1..level.starts.len() {
            level.starts[c] += level.starts[c - 1];
        }
        let mut next = level.starts.clone();
        sorted.resize(first + count, Entry { position: [0.0; D], radius: 0.0, number: 0 });
        for (number, &c) in numbers.zip(&cells) {
            let at = &mut next[c as usize];
            sorted[*at as usize] =
                Entry { position: *place(number), radius: points.radius(number as usize), number };
            *at += 1;
        }
        level
    }

    /// Compute the number of cells along each axis for the current cell edge, at most `most` in total. True if cells are folded.
    fn lay_out(&mut self, most: usize) -> bool {
        for d in 0..D {
            self.natural[d] = ((self.high[d] - self.low[d]) * self.inverse) as u64 + 1;
        }
        let folded = self.natural.iter().map(|&n| n as f64).product::<f64>() > most as f64;
        let mut left = most as f64;
        let mut axes = [0; D];
        for d in 0..D {
            axes[d] = d;
        }
        axes.sort_by_key(|&d| self.natural[d]);
        for (n, &d) in axes.iter().enumerate() {
            let share = left.powf(1.0 / (D - n) as f64).max(2.0);
            self.counts[d] = if !folded || self.natural[d] as f64 <= share {
                self.natural[d] as usize
            } else {
                prime_below(share as usize)
            };
            left /= self.counts[d] as f64;
        }
        folded
    }

    #[inline(always)]
    fn cell(&self, d: usize, x: f64) -> u64 {
        // A saturating cast maps negative numbers to zero.
        (((x - self.low[d]) * self.inverse) as u64).min(self.natural[d] - 1)
    }
    #[inline(always)]
    fn fold(&self, d: usize, cell: u64) -> usize {
        let count = self.counts[d] as u64;
        (if cell < count { cell } else { cell % count }) as usize
    }
    fn index(&self, x: &[f64; D]) -> usize {
        (0..D).rev().fold(0, |n, d| n * self.counts[d] + self.fold(d, self.cell(d, x[d])))
    }

    /// Call `act` on ranges of the sorted points that contain all points in the box around `x`, and others.
    #[inline(always)]
    fn rows(&self, x: &[f64; D], half: f64, mut act: impl FnMut(usize, usize)) {
        let (mut first, mut span) = ([0; D], [1; D]);
        for d in 0..D {
            let (from, to) = (x[d] - half, x[d] + half);
            if to < self.low[d] || from > self.high[d] {
                return;
            }
            let (a, b) = (self.cell(d, from), self.cell(d, to));
            // Limit the span so that no folded cell is visited twice.
            span[d] = (b - a + 1).min(self.counts[d] as u64) as usize;
            first[d] = self.fold(d, a);
        }
        // Cells along the first axis are contiguous; on a folded axis, the first cell follows the last.
        let end = first[0] + span[0];
        let beyond = end.saturating_sub(self.counts[0]);
        let mut offset = [0; D];
        loop {
            let mut row = 0;
            for d in (1..D).rev() {
                let c = first[d] + offset[d];
                row = row * self.counts[d] + if c < self.counts[d] { c } else { c - self.counts[d] };
            }
            row *= self.counts[0];
            act(self.starts[row + first[0]] as usize, self.starts[row + end - beyond] as usize);
            if beyond > 0 {
                act(self.starts[row] as usize, self.starts[row + beyond] as usize);
            }
            let mut d = 1;
            loop {
                if d >= D {
                    return;
                }
                offset[d] += 1;
                if offset[d] < span[d] {
                    break;
                }
                offset[d] = 0;
                d += 1;
            }
        }
    }
}

/// Return the largest prime up to `most`, which is at least 2. With a prime number of cells, points at regular distances fold onto
/// all cells and not onto a few.
fn prime_below(most: usize) -> usize {
    let is_prime = |n: usize| (2..).take_while(|k| k * k <= n).all(|k| !n.is_multiple_of(k));
    (2..=most.max(2)).rev().find(|&n| is_prime(n)).unwrap_or(2)
}

impl<const D: usize> SortedCells<D> {
    /// Sort points into at most `most` levels, 1 to 32; the last level contains all smaller points. [`NeighbourSearch::new`] uses
    /// a level for each power of two.
    ///
    /// # Errors
    /// Errors of [`NeighbourSearch::new`], and another number of levels.
    pub fn with_levels(points: &Points<'_, D>, reach: Reach, most: usize) -> Result<Self, SearchError> {
        if !(1..=LEVELS).contains(&most) {
            let (field, allowed) = ("number of levels", "1 to 32");
            return Err(SearchError::Parameter { field, value: most as f64, allowed });
        }
        let [smallest, largest] = points.radii_range();
        reach.check(largest)?;
        let mut cells = SortedCells { reach, levels: Vec::new(), sorted: Vec::with_capacity(points.len()) };
        let range = |radius: f64| reach.of(radius, radius);
        let (count, top) = (points.len() as u32, range(largest));
        if count > 0 && (most == 1 || 2.0 * range(smallest) >= top) {
            cells.levels.push(Level::sort(points, 0..count, largest, top, &mut cells.sorted));
        } else if count > 0 {
            let mut members = vec![Vec::new(); most];
            for i in 0..count {
                // Binary exponent of the ratio of ranges; a range of zero has an infinite ratio.
                let times = top / range(points.radius(i as usize));
                let exponent = (times.to_bits() >> 52).saturating_sub(1023) as usize;
                members[exponent.min(most - 1)].push(i);
            }
            for numbers in members.iter().filter(|numbers| !numbers.is_empty()) {
                let largest = numbers.iter().fold(0.0, |m: f64, &i| m.max(points.radius(i as usize)));
                let numbers = numbers.iter().copied();
                let level = Level::sort(points, numbers, largest, range(largest), &mut cells.sorted);
                cells.levels.push(level);
            }
        }
        Ok(cells)
    }

    /// Number of levels: one for similar radii, zero without points.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }
    /// Number of cells on all levels.
    pub fn cells(&self) -> usize {
        self.levels.iter().map(|level| level.starts.len() - 1).sum()
    }

    /// Call `visit` once on every pair within reach, in any order: for callers that keep few of many pairs, or need no lists.
    pub fn each_pair(&self, mut visit: impl FnMut(u32, u32)) {
        for_pair!(self.reach, pair => {
            let mut found = Vec::new();
            for (own, level) in self.levels.iter().enumerate() {
                for entry in &self.sorted[level.places.clone()] {
                    for (n, among) in self.levels[..=own].iter().enumerate() {
                        let count = self.search(pair, entry, among, entry.number, &mut found, 0);
                        // Two points on one level find each other: keep one of the two pairs.
                        let once = |j: &&u32| n < own || **j > entry.number;
                        found[..count].iter().filter(once).for_each(|&j| visit(entry.number, j));
                    }
                }
            }
        });
    }

    /// Write the points of a level within reach of `of`, except for index `but`, into `found` from `count` on. Returns the end position.
    #[inline(always)]
    fn search<P: Pair>(
        &self,
        pair: P,
        of: &Entry<D>,
        level: &Level<D>,
        but: u32,
        found: &mut Vec<u32>,
        mut count: usize,
    ) -> usize {
        let half = half_box(pair.range(of.radius, level.largest));
        level.rows(&of.position, half, |from, to| {
            let row = &self.sorted[from..to];
            if found.len() < count + row.len() {
                found.resize((count + row.len()).next_power_of_two(), 0);
            }
            let out = &mut found[count..count + row.len()];
            let mut here = 0;
            // Branch-free: always written and kept if in range, since branch prediction fails for random pairs.
            for entry in row {
                let range = pair.range(of.radius, entry.radius);
                let near = distance_squared(&of.position, &entry.position) <= range * range;
                out[here] = entry.number;
                here += usize::from(near & (entry.number != but));
            }
            count += here;
        });
        count
    }

    /// Call `task` on every point of every chunk, with the index of its level.
    fn each_chunk(
        &self,
        limit: &Limit,
        team: &Team,
        task: impl Fn(&Entry<D>, usize, &mut Rows, usize) -> usize + Send + Sync,
    ) -> Vec<Rows> {
        let mut rows = vec![Rows::default(); self.sorted.len().div_ceil(CHUNK)];
        team.each(&mut rows, |chunk, row| {
            let places = chunk * CHUNK..((chunk + 1) * CHUNK).min(self.sorted.len());
            let (mut count, mut own) = (0, 0);
            for place in places {
                while place >= self.levels[own].places.end {
                    own += 1;
                }
                if limit.passed(count + row.returned.len()) {
                    break;
                }
                count = task(&self.sorted[place], own, row, count);
            }
            row.found.truncate(count);
            limit.add(count + row.returned.len());
        });
        rows
    }

    /// Find the neighbours of points on their own level and on the levels of larger points; return the latter pairs to the larger points.
    fn rows<P: Pair>(&self, pair: P, limit: &Limit, team: &Team) -> Vec<Rows> {
        self.each_chunk(limit, team, |entry, own, row, before| {
            let Rows { ends, found, returned } = row;
            let mut count = before;
            for (n, level) in self.levels[..=own].iter().enumerate() {
                let from = count;
                count = self.search(pair, entry, level, entry.number, found, count);
                if n < own {
                    returned.extend(found[from..count].iter().map(|&j| [j, entry.number]));
                }
            }
            found[before..count].sort_unstable();
            ends.push(count as u32);
            count
        })
    }

    /// Find the neighbours of the points of `self` on those levels of `others` that are not finer than their own.
    fn rows_of_larger<P: Pair>(&self, pair: P, others: &Self, limit: &Limit, team: &Team) -> Vec<Rows> {
        self.each_chunk(limit, team, |entry, own, row, before| {
            let Rows { ends, found, .. } = row;
            let mut count = before;
            for level in others.levels.iter().take_while(|l| l.range >= self.levels[own].range) {
                count = others.search(pair, entry, level, u32::MAX, found, count);
            }
            found[before..count].sort_unstable();
            ends.push(count as u32);
            count
        })
    }

    /// Find the neighbours of the points of `self` on those levels of `others` that are coarser than their own, all returned.
    fn rows_for_larger<P: Pair>(&self, pair: P, others: &Self, limit: &Limit, team: &Team) -> Vec<Rows> {
        self.each_chunk(limit, team, |entry, own, row, _| {
            let Rows { found, returned, .. } = row;
            for level in others.levels.iter().take_while(|l| l.range > self.levels[own].range) {
                let count = others.search(pair, entry, level, u32::MAX, found, 0);
                returned.extend(found[..count].iter().map(|&i| [i, entry.number]));
            }
            0
        })
    }
}

impl<const D: usize> NeighbourSearch<D> for SortedCells<D> {
    fn new(points: &Points<'_, D>, reach: Reach) -> Result<Self, SearchError> {
        SortedCells::with_levels(points, reach, LEVELS)
    }

    fn len(&self) -> usize {
        self.sorted.len()
    }

    fn neighbours_into(&self, team: &Team, lists: &mut NeighbourLists) -> Result<(), SearchError> {
        let limit = Limit::new(self.len());
        let rows = for_pair!(self.reach, pair => self.rows(pair, &limit, team));
        limit.check()?;
        assemble(self.len(), &rows, |place| self.sorted[place].number, team, lists);
        Ok(())
    }

    fn neighbours_of(&self, others: &Points<'_, D>, team: &Team) -> Result<NeighbourLists, SearchError> {
        let others = SortedCells::new(others, self.reach)?;
        let limit = Limit::new(self.len() + others.len());
        let rows = for_pair!(self.reach, pair => {
            let mut rows = others.rows_of_larger(pair, self, &limit, team);
            rows.extend(self.rows_for_larger(pair, &others, &limit, team));
            rows
        });
        limit.check()?;
        let mut lists = NeighbourLists::new();
        assemble(others.len(), &rows, |place| others.sorted[place].number, team, &mut lists);
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
        for level in &self.levels {
            level.rows(x, half_box(radius), |from, to| {
                for entry in &self.sorted[from..to] {
                    let square = distance_squared(x, &entry.position);
                    if square <= radius * radius {
                        visit(entry.number, square.sqrt());
                    }
                }
            });
        }
        Ok(())
    }

    fn nearest(&self, x: &[f64; D]) -> Result<Option<Nearest>, SearchError> {
        check_place(x)?;
        let mut best = Best::none();
        for level in &self.levels {
            best.among_boxes(x, &level.low, &level.high, 0.5 / level.inverse, |half, best| {
                level.rows(x, half, |from, to| {
                    for entry in &self.sorted[from..to] {
                        best.offer(entry.number, distance_squared(x, &entry.position));
                    }
                });
            });
        }
        Ok(best.point())
    }
}

/// Nearest point so far; at equal distances the one of lowest index.
pub(super) struct Best {
    pub square: f64,
    number: u32,
}

impl Best {
    pub(super) fn none() -> Self {
        Best { square: f64::INFINITY, number: u32::MAX }
    }
    #[inline(always)]
    pub(super) fn offer(&mut self, number: u32, square: f64) {
        if square < self.square || (square == self.square && number < self.number) {
            (self.square, self.number) = (square, number);
        }
    }
    pub(super) fn point(&self) -> Option<Nearest> {
        (self.number != u32::MAX).then(|| Nearest { point: self.number, distance: self.square.sqrt() })
    }
    /// Search boxes around `x` by `offer_box` until no point can be nearer. The first box extends a `step` beyond the bounds of the
    /// points; the size doubles.
    pub(super) fn among_boxes<const D: usize>(
        &mut self,
        x: &[f64; D],
        low: &[f64; D],
        high: &[f64; D],
        step: f64,
        mut offer_box: impl FnMut(f64, &mut Self),
    ) {
        let gap = distance_to_box(x, low, high);
        let farthest = (0..D).fold(0.0, |m: f64, d| m.max(x[d] - low[d]).max(high[d] - x[d]));
        let mut half = half_box(gap + step);
        while half_box(self.square.sqrt()) >= gap {
            let enough = half.min(half_box(self.square.sqrt()));
            offer_box(enough, self);
            if enough >= self.square.sqrt() || enough > farthest {
                return;
            }
            half = 2.0 * enough;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Average number of points per cell, as seen by a point, including the point itself.
    fn crowding<const D: usize>(positions: &[[f64; D]], radii: &[f64]) -> f64 {
        let points = Points::new(positions, radii).expect("points");
        let cells = SortedCells::new(&points, Reach::sum(0.0)).expect("cells");
        assert!(cells.cells() <= CELLS_PER_POINT * points.len() + FEWEST_CELLS * cells.levels());
        let ends = |level: &Level<D>| -> f64 {
            level.starts.windows(2).map(|s| f64::from(s[1] - s[0]).powi(2)).sum()
        };
        cells.levels.iter().map(ends).sum::<f64>() / points.len() as f64
    }

    /// The cost of a dense region must not depend on points that flew off, on gaps, or on a few small points that all share a cell.
    #[test]
    fn few_points_share_a_cell_however_they_lie() {
        fn check<const D: usize>() {
            let side = (20_000f64).powf(1.0 / D as f64).round() as usize;
            let count = side.pow(D as u32);
            // Disturbed lattice, radii 0.4 to 0.6 of the spacing: one to two points per cell.
            let mut positions: Vec<[f64; D]> = (0..count)
                .map(|n| {
                    std::array::from_fn(|d| {
                        let jitter = ((n * (7 * d + 3)) as f64 * 0.618_034).fract();
                        (n / side.pow(d as u32) % side) as f64 + 0.3 * jitter
                    })
                })
                .collect();
            let mut radii: Vec<f64> =
                (0..count).map(|n| 0.4 + 0.2 * (n as f64 * 0.618_034).fract()).collect();
            let plain = crowding(&positions, &radii);
            assert!(plain < 5.0, "{plain} points in {D} dimensions");
            // One more point on average for random cells.
            let limit = plain + 2.0;
            positions[7] = [-1e12; D];
            positions[9][0] = 1e9;
            let flown = crowding(&positions, &radii);
            for x in &mut positions[count / 2..] {
                x[0] += 1e7;
            }
            let parted = crowding(&positions, &radii);
            radii[..5].fill(1e-12);
            let small = crowding(&positions, &radii);
            // Radii far below the spacing: cells grow until they contain a few points.
            let sparse = crowding(&positions, &radii.iter().map(|r| 1e-5 * r).collect::<Vec<_>>());
            let none = crowding(&positions, &vec![0.0; count]);
            for (what, points) in [("flown", flown), ("parted", parted), ("small", small)] {
                assert!(points < limit, "{what}: {points} points share a cell in {D} dimensions");
            }
            for (what, points) in [("sparse", sparse), ("none", none)] {
                assert!(points < 3.0 * 2f64.powi(D as i32), "{what}: {points} points in {D} dimensions");
            }
        }
        check::<1>();
        check::<2>();
        check::<3>();
    }

    #[test]
    fn counts_of_folded_cells_are_prime() {
        assert_eq!([2, 3, 4, 10, 100, 317].map(prime_below), [2, 3, 3, 7, 97, 317]);
    }
}
