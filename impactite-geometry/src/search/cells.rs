//! Cells on several levels, filled by a counting sort.

use std::ops::Range;

use impactite_simd::Team;

use super::error::{SearchError, check_length, check_place};
use super::lists::{CHUNK, Limit, NeighbourLists, Rows, assemble};
use super::points::{Pair, Points, Reach, bounds_of, distance_squared, distance_to_box, for_pair, half_box};
use super::{Nearest, NeighbourSearch};

/// Most cells a point: memory stays proportional to the number of points however far they fly apart.
const CELLS_PER_POINT: usize = 4;
/// Cells that even few points may have.
const FEWEST_CELLS: usize = 64;
/// Most levels. Points whose range is smaller than that of the largest by 2^32 share the cells of the last.
const LEVELS: usize = 32;
/// The extent of all points in cells, at most: differences of coordinates tell such cells apart.
const MOST_ALONG: f64 = (1u64 << 40) as f64;
/// No edge is smaller (m), so that its inverse is finite.
const SHORTEST_EDGE: f64 = 1e-150;
/// Cells that hold fewer points each on average, empty ones not counted, are made larger where there are too many of them. Points
/// thrown at four times as many cells give 1.13.
const FULL_ENOUGH: f64 = 1.25;

/// Cell lists for points of any dimension and of very different radii.
///
/// Points are put on levels, one for each power of two of the range of a pair of their kind, R(r, r), those of alike
/// radii on one. A level has cells of the largest range of its points, and is filled by a counting sort, so that the
/// points of a cell, and of cells side by side, are neighbours in memory (cell lists \[Feng2014\]; a grid for each
/// size \[OgarkoLuding2012\]). A point looks for its neighbours on its own level and on those of larger points, in 3^D
/// cells of each at most; what it finds there is handed back to the larger one. The cost is O(N) a level, however small the
/// smallest points are.
///
/// Cells of a level that are more than four times as many as its points are folded onto each other, as on a torus: memory
/// stays proportional to the number of points however far they fly apart, and a crowd keeps its small cells whatever flies off
/// elsewhere (as hashing does \[Teschner2003\], but in the order of cells). Cells that share a place cost candidates that are too far away, and
/// change no list.
///
/// [`nearest`](NeighbourSearch::nearest) looks into boxes that double until one holds a point.
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
    /// Those of the largest points first.
    levels: Vec<Level<D>>,
    /// Level by level, cell by cell.
    sorted: Vec<Entry<D>>,
}

#[derive(Clone, Copy, Debug)]
struct Entry<const D: usize> {
    position: [f64; D],
    radius: f64,
    number: u32,
}

/// The cells of points of about one size.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    /// Largest radius.
    largest: f64,
    /// Of a pair of the largest.
    range: f64,
    low: [f64; D],
    high: [f64; D],
    /// One over the edge of a cell.
    inverse: f64,
    /// Cells along each axis,
    natural: [u64; D],
    /// and how many are kept: the rest is folded onto them.
    counts: [usize; D],
    /// Where each cell begins in the list of all points.
    starts: Vec<u32>,
    /// Its points in that list.
    places: Range<usize>,
}

impl<const D: usize> Level<D> {
    /// Sort the points `numbers` by cell, to the end of `sorted`.
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

    /// Cells along the axes for the present edge, `most` altogether. Are some folded?
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
        // Numbers below zero become zero.
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

    /// `act` on the ranges of places that hold all points in the box around `x`, and others.
    #[inline(always)]
    fn rows(&self, x: &[f64; D], half: f64, mut act: impl FnMut(usize, usize)) {
        let (mut first, mut span) = ([0; D], [1; D]);
        for d in 0..D {
            let (from, to) = (x[d] - half, x[d] + half);
            if to < self.low[d] || from > self.high[d] {
                return;
            }
            let (a, b) = (self.cell(d, from), self.cell(d, to));
            // No folded cell is visited twice.
            span[d] = (b - a + 1).min(self.counts[d] as u64) as usize;
            first[d] = self.fold(d, a);
        }
        // Cells along the first axis are one after the other; beyond the last one of a folded axis comes the first.
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

/// The largest prime that is not above `most`, which is 2 or more: points at regular distances then fold onto all cells
/// and not on a few.
fn prime_below(most: usize) -> usize {
    let is_prime = |n: usize| (2..).take_while(|k| k * k <= n).all(|k| !n.is_multiple_of(k));
    (2..=most.max(2)).rev().find(|&n| is_prime(n)).unwrap_or(2)
}

impl<const D: usize> SortedCells<D> {
    /// Points on so many levels at most, 1 to 32: on the last one are all that are smaller. [`NeighbourSearch::new`] takes
    /// as many as there are powers of two.
    ///
    /// # Errors
    /// As [`NeighbourSearch::new`], and another number of levels.
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
                // The exponent of how many times smaller its range is; a range of zero is infinitely smaller.
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

    /// How many levels there are: one where radii are alike, none without points.
    pub fn levels(&self) -> usize {
        self.levels.len()
    }
    /// How many cells there are on all levels.
    pub fn cells(&self) -> usize {
        self.levels.iter().map(|level| level.starts.len() - 1).sum()
    }

    /// `visit` on every pair within reach, once, in any order: for callers that keep few of many, or need no lists.
    pub fn each_pair(&self, mut visit: impl FnMut(u32, u32)) {
        for_pair!(self.reach, pair => {
            let mut found = Vec::new();
            for (own, level) in self.levels.iter().enumerate() {
                for entry in &self.sorted[level.places.clone()] {
                    for (n, among) in self.levels[..=own].iter().enumerate() {
                        let count = self.search(pair, entry, among, entry.number, &mut found, 0);
                        // Two on one level find each other.
                        let once = |j: &&u32| n < own || **j > entry.number;
                        found[..count].iter().filter(once).for_each(|&j| visit(entry.number, j));
                    }
                }
            }
        });
    }

    /// Write the points of a level within reach of `of`, but for number `but`, into `found` from place `count` on. Returns the place
    /// behind them.
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
            // Always written and sometimes kept: whether a pair is in range is a toss that branches lose.
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

    /// `task` on every chunk of places: on each point of it, with the number of its level.
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

    /// What points find on their own level and on those of larger points, to which they are handed back.
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

    /// What the points of `self` find on those levels of `others` that are not finer than their own.
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

    /// What the points of `self` find on those levels of `others` that are coarser than their own, all handed back.
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

/// The nearest point so far; of those equally near, the one with the lowest number.
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
    /// Look, by `offer_box`, at all points in boxes around `x` that double, beginning a `step` beyond the bounds of the
    /// points, until none can be nearer.
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

    /// Points of the cell that a point shares, itself among them, on average over all.
    fn crowding<const D: usize>(positions: &[[f64; D]], radii: &[f64]) -> f64 {
        let points = Points::new(positions, radii).expect("points");
        let cells = SortedCells::new(&points, Reach::sum(0.0)).expect("cells");
        assert!(cells.cells() <= CELLS_PER_POINT * points.len() + FEWEST_CELLS * cells.levels());
        let ends = |level: &Level<D>| -> f64 {
            level.starts.windows(2).map(|s| f64::from(s[1] - s[0]).powi(2)).sum()
        };
        cells.levels.iter().map(ends).sum::<f64>() / points.len() as f64
    }

    /// What a crowd costs must not depend on points that flew off, on gaps, nor on a few small ones: it would all share a cell.
    #[test]
    fn few_points_share_a_cell_however_they_lie() {
        fn check<const D: usize>() {
            let side = (20_000f64).powf(1.0 / D as f64).round() as usize;
            let count = side.pow(D as u32);
            // A lattice with some disorder, radii 0.4 to 0.6 of the spacing: one to two a cell.
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
            // With cells at random, one more on average.
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
            // Far smaller than their spacing: cells grow until they hold a few.
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
