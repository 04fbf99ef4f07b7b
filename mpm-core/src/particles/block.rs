//! A block of bins with their particles.

use std::sync::Arc;

use super::{Columns, Masses};
use crate::dim::{BLOCK, block_nodes, node_of};
use crate::step::RowsMut;
use crate::step::between_steps::rest::TakenMotion;
use impactite_scene::{Archive, CheckpointError};
use impactite_simd::{Float, Pack, Whereabouts, prefetch_fours_from, prefetch_from};

/// Marker for no group.
const NONE: u32 = u32::MAX;

/// Groups of one bin: a linked list from the last group, the only one that may have free lanes, to the first.
#[derive(Clone, Copy, Debug)]
struct Run {
    last: u32,
    particles: u32,
}

impl Run {
    /// Return the last group and the number of its particles.
    #[inline(always)]
    fn last_group<T: Float>(self) -> Option<(u32, usize)> {
        (self.particles > 0).then(|| (self.last, (self.particles as usize - 1) % T::GROUP + 1))
    }
}

/// Return the preceding group, which is full, and the number of its particles.
#[inline(always)]
fn full_before<T: Float>(before: &[u32], group: u32) -> Option<(u32, usize)> {
    let before = before[group as usize];
    (before != NONE).then_some((before, T::GROUP))
}

/// Position of a particle in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Index of the group.
    pub group: u32,
    /// Lane of the group.
    pub lane: u32,
}

/// Particles of 4^D bins.
///
/// All groups are stored in one array, in any order. A bin that grows takes a group from the free list, one that
/// shrinks returns it: nothing else moves, and memory is that of the largest number of groups ever in use.
#[derive(Clone, Debug)]
pub struct Block<T: Float, const D: usize> {
    /// Block coordinates: the block contains the bins `BLOCK * coordinates[d] .. BLOCK * (coordinates[d] + 1)`.
    pub coordinates: [i32; D],
    /// Rows per group.
    columns: usize,
    runs: Vec<Run>,
    rows: Vec<T::Row>,
    /// Number of the particle in each lane, unless the last row of its group contains it.
    numbers: Vec<u32>,
    /// Preceding group of each group in its list.
    before: Vec<u32>,
    /// First group of the list of free groups.
    free: u32,
    /// Number of groups that are not free.
    in_use: usize,
    particles: usize,
    /// Bit mask of the bins with particles.
    occupied: u64,
    /// Values in a lane without a particle, one per column.
    dummy: Arc<[T]>,
}

/// Groups of a bin that go through a pass together, or one particle of a group.
#[derive(Clone, Copy, Debug, Default)]
pub struct Members {
    /// Groups in the order of their lanes; a single group appears twice.
    pub groups: [u32; 2],
    /// First lane: that of the particle, or 0 for groups.
    pub lane: u32,
}

impl Members {
    /// Return group and lane of the particle in lane `lane` of all members.
    #[inline(always)]
    pub fn place<T: Float>(self, lane: usize) -> (u32, usize) {
        let at = self.lane as usize + lane;
        (self.groups[at / T::GROUP % 2], at % T::GROUP)
    }
}

/// Storage of the groups of a block, for a pass that visits all of them.
pub struct Groups<'a, T: Float> {
    rows: &'a mut [T::Row],
    numbers: &'a [u32],
    before: &'a [u32],
    runs: &'a [Run],
    columns: usize,
}

impl<T: Float> Groups<'_, T> {
    /// Return the last group of a bin; see [`Block::last_group`].
    #[inline(always)]
    pub fn last(&self, bin: usize) -> Option<(u32, usize)> {
        self.runs[bin].last_group::<T>()
    }
    /// Return the preceding group; see [`Block::group_before`].
    #[inline(always)]
    pub fn before(&self, group: u32) -> Option<(u32, usize)> {
        full_before::<T>(self.before, group)
    }
    /// Number of groups of a bin.
    #[inline(always)]
    pub fn of_bin(&self, bin: usize) -> usize {
        (self.runs[bin].particles as usize).div_ceil(T::GROUP)
    }
    /// Return the rows of groups that go through a pass together. A single group is completed by `idle`.
    #[inline(always)]
    pub(crate) fn rows_of<'s, P: Pack<T>>(
        &'s mut self,
        members: Members,
        idle: &'s mut [T::Row],
    ) -> RowsMut<'s, T> {
        let (columns, [one, two]) = (self.columns, members.groups);
        let lane = members.lane as usize;
        if P::GROUPS == 1 {
            return RowsMut::<T>::of([&mut self.rows[one as usize * columns..][..columns], idle], lane);
        }
        let (first, second) = (one as usize * columns, two as usize * columns);
        if one == two {
            return RowsMut::<T>::of([&mut self.rows[first..][..columns], &mut idle[..columns]], lane);
        }
        let pair = if first < second {
            let (before, behind) = self.rows.split_at_mut(second);
            [&mut before[first..][..columns], &mut behind[..columns]]
        } else {
            let (before, behind) = self.rows.split_at_mut(first);
            [&mut behind[..columns], &mut before[second..][..columns]]
        };
        RowsMut::<T>::of(pair, lane)
    }
    /// Return all rows, and the number of rows per group.
    #[inline(always)]
    pub fn all_rows(&mut self) -> (&mut [T::Row], usize) {
        (self.rows, self.columns)
    }
    /// Return a row of a group.
    #[inline(always)]
    pub fn row(&self, group: u32, row: usize) -> &T::Row {
        &self.rows[group as usize * self.columns + row]
    }
    /// Return the particle number in a lane of groups that go through a pass together; see [`Block::number`].
    #[inline(always)]
    pub fn number(&self, members: Members, lane: usize) -> usize {
        let (group, lane) = members.place::<T>(lane);
        number_of::<T>(self.rows, self.numbers, self.columns, Place { group, lane: lane as u32 })
    }
    /// Prefetch groups of a bin; see [`Block::prefetch`].
    #[inline(always)]
    pub fn prefetch(&self, bin: usize, rows: usize, mass: Option<usize>) {
        ask_for_groups(self.rows, self.before, self.columns, self.runs[bin], rows, mass);
    }
}

/// Return the number that identifies the particle at a place: from `numbers`, or from the last row of its group. It
/// is not inlined, so that passes keep their values in registers.
#[inline(never)]
fn number_of<T: Float>(rows: &[T::Row], numbers: &[u32], columns: usize, at: Place) -> usize {
    let (group, lane) = (at.group as usize, at.lane as usize);
    match numbers.get(group * T::GROUP + lane) {
        Some(number) => *number as usize,
        None => rows[(group + 1) * columns - 1].as_ref()[lane].to_double() as usize,
    }
}

#[inline(always)]
fn ask_for_groups<R>(all: &[R], before: &[u32], columns: usize, run: Run, rows: usize, mass: Option<usize>) {
    let mut group = run.last;
    if group == NONE {
        return;
    }
    // Always the last three: the end of a loop over the actual number would be mispredicted as often as not.
    for _ in 0..3 {
        prefetch_fours_from(all, group as usize * columns, rows);
        if let Some(row) = mass {
            prefetch_from(all, group as usize * columns + row, 1);
        }
        let before = before.get(group as usize).copied().unwrap_or(NONE);
        group = if before == NONE { group } else { before };
    }
}

impl<T: Float, const D: usize> Block<T, D> {
    /// Create an empty block for particles with these columns. `dummy` contains the values of a lane without a particle.
    pub fn new(coordinates: [i32; D], columns: &Columns, dummy: Arc<[T]>) -> Self {
        debug_assert_eq!(columns.count(), dummy.len());
        Block {
            coordinates,
            columns: columns.rows(),
            runs: vec![Run { last: NONE, particles: 0 }; block_nodes(D)],
            rows: Vec::new(),
            numbers: Vec::new(),
            before: Vec::new(),
            free: NONE,
            in_use: 0,
            particles: 0,
            occupied: 0,
            dummy,
        }
    }

    /// Move an empty block to other coordinates.
    pub fn place_at(&mut self, coordinates: [i32; D]) {
        debug_assert!(self.is_empty(), "only an empty block can move");
        self.coordinates = coordinates;
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.particles
    }
    /// True if the block has no particle.
    pub fn is_empty(&self) -> bool {
        self.particles == 0
    }
    /// Memory of the block, bytes.
    pub fn bytes(&self) -> usize {
        self.rows.capacity() * size_of::<T::Row>()
            + (self.before.capacity() + self.numbers.capacity()) * size_of::<u32>()
            + self.runs.capacity() * size_of::<Run>()
    }
    /// Memory ranges of the two tables of its groups, and of the groups.
    pub fn outline(&self) -> [Whereabouts; 3] {
        [Whereabouts::of(&self.runs), Whereabouts::of(&self.before), Whereabouts::of(&self.rows)]
    }
    /// Bit mask of the bins with particles.
    pub fn occupied(&self) -> u64 {
        self.occupied
    }
    /// Number of particles in a bin.
    #[inline(always)]
    pub fn bin_len(&self, bin: usize) -> usize {
        self.runs[bin].particles as usize
    }
    /// Return the last group of a bin and the number of its particles.
    #[inline(always)]
    pub fn last_group(&self, bin: usize) -> Option<(u32, usize)> {
        self.runs[bin].last_group::<T>()
    }
    /// Return the preceding group of a bin, which is full, and the number of its particles.
    #[inline(always)]
    pub fn group_before(&self, group: u32) -> Option<(u32, usize)> {
        full_before::<T>(&self.before, group)
    }
    /// Return the rows of a group.
    #[inline(always)]
    pub fn group(&self, group: u32) -> &[T::Row] {
        &self.rows[group as usize * self.columns..][..self.columns]
    }
    /// Return all rows, and the number of rows per group.
    #[inline(always)]
    pub fn all_rows(&self) -> (&[T::Row], usize) {
        (&self.rows, self.columns)
    }
    /// Return the rows of a group.
    #[inline(always)]
    pub fn group_mut(&mut self, group: u32) -> &mut [T::Row] {
        &mut self.rows[group as usize * self.columns..][..self.columns]
    }
    /// Prefetch the first `rows` rows and the row of masses of the last groups, at most three, of a bin that comes soon.
    #[inline(always)]
    pub fn prefetch(&self, bin: usize, rows: usize, mass: Option<usize>) {
        ask_for_groups(&self.rows, &self.before, self.columns, self.runs[bin], rows, mass);
    }

    /// Return the groups for a pass, of `least` rows or more.
    #[inline(always)]
    pub fn groups(&mut self, least: usize) -> Groups<'_, T> {
        Groups {
            rows: &mut self.rows,
            numbers: &self.numbers,
            before: &self.before,
            runs: &self.runs[..block_nodes(D)],
            // The number of rows is not smaller; the bound is for the compiler.
            columns: self.columns.max(least),
        }
    }

    /// Number of values of a particle.
    #[inline(always)]
    pub fn particle_numbers(&self) -> usize {
        self.dummy.len()
    }

    /// True if particle numbers are stored apart from the rows.
    #[inline(always)]
    fn apart(&self) -> bool {
        self.columns < self.dummy.len()
    }

    /// Return the number that identifies a particle.
    #[inline(always)]
    pub fn number(&self, at: Place) -> usize {
        number_of::<T>(&self.rows, &self.numbers, self.columns, at)
    }

    /// Return the value of column `column` of a particle.
    #[inline(always)]
    pub fn get(&self, at: Place, column: usize) -> T {
        self.group(at.group)[column].as_ref()[at.lane as usize]
    }

    /// Set the value of column `column` of a particle.
    #[inline(always)]
    pub fn set(&mut self, at: Place, column: usize, number: T) {
        self.group_mut(at.group)[column].as_mut()[at.lane as usize] = number;
    }

    /// Append all values of a particle to `numbers`.
    #[inline(always)]
    pub fn read(&self, at: Place, numbers: &mut Vec<T>) {
        numbers.extend(self.group(at.group).iter().map(|row| row.as_ref()[at.lane as usize]));
        if self.apart() {
            numbers.push(T::of(self.number(at) as f64));
        }
    }

    /// Sum momentum, kg m/s, and kinetic energy, J, of the particles, in the order of the groups.
    pub fn motion(&self, masses: Masses<T>) -> TakenMotion {
        let mut sum = TakenMotion::default();
        for bin in 0..self.runs.len() {
            let mut next = self.last_group(bin);
            while let Some((group, here)) = next {
                next = self.group_before(group);
                let rows = self.group(group);
                let velocity = |d: usize| rows[Columns::velocity(D) + d].as_ref();
                for lane in 0..here {
                    let mass = masses.read(|row| rows[row].as_ref()[lane]).to_double();
                    for d in 0..D {
                        let v = velocity(d)[lane].to_double();
                        sum.momentum[d] += mass * v;
                        sum.kinetic += 0.5 * mass * v * v;
                    }
                }
            }
        }
        sum
    }

    /// Set all velocities to zero.
    pub fn stop(&mut self) {
        for bin in 0..self.runs.len() {
            let mut next = self.last_group(bin);
            while let Some((group, _)) = next {
                next = self.group_before(group);
                let rows = self.group_mut(group);
                rows[Columns::velocity(D)..][..D].fill(T::Row::default());
            }
        }
    }

    /// Append a particle to a bin.
    #[inline(always)]
    pub fn push(&mut self, bin: usize, numbers: &[T]) {
        let Run { last, particles } = self.runs[bin];
        let lane = particles as usize % T::GROUP;
        let group = if lane == 0 { self.take_group(last) } else { last };
        for (row, &x) in self.group_mut(group).iter_mut().zip(numbers) {
            row.as_mut()[lane] = x;
        }
        if self.apart() {
            self.numbers[group as usize * T::GROUP + lane] = numbers[self.columns].to_double() as u32;
        }
        self.runs[bin] = Run { last: group, particles: particles + 1 };
        self.particles += 1;
        self.occupied |= 1 << bin;
    }

    /// Remove a particle from a bin and store its values in `numbers`; the last particle of the bin takes its place.
    #[inline(always)]
    pub fn take(&mut self, bin: usize, at: Place, numbers: &mut [T]) {
        let Run { last, particles } = self.runs[bin];
        let (lane, to) = ((particles as usize - 1) % T::GROUP, at.lane as usize % T::GROUP);
        let group = |group: u32| {
            let first = group as usize * self.columns;
            first..first + self.columns
        };
        if self.apart() {
            let taken = at.group as usize * T::GROUP + to;
            numbers[self.columns] = T::of(f64::from(self.numbers[taken]));
            self.numbers[taken] = self.numbers[last as usize * T::GROUP + lane];
        }
        let numbers = numbers.iter_mut().zip(&*self.dummy);
        if at.group == last {
            for (row, (number, dummy)) in self.rows[group(last)].iter_mut().zip(numbers) {
                let row = row.as_mut();
                *number = row[to];
                row[to] = row[lane];
                row[lane] = *dummy;
            }
        // Two groups never overlap.
        } else if let Ok([here, end]) = self.rows.get_disjoint_mut([group(at.group), group(last)]) {
            for ((row, from), (number, dummy)) in here.iter_mut().zip(end).zip(numbers) {
                *number = std::mem::replace(&mut row.as_mut()[to], from.as_mut()[lane]);
                from.as_mut()[lane] = *dummy;
            }
        }
        self.runs[bin].particles -= 1;
        self.particles -= 1;
        self.occupied &= !(u64::from(particles == 1) << bin);
        if lane == 0 {
            self.runs[bin].last = std::mem::replace(&mut self.before[last as usize], self.free);
            self.free = last;
            self.in_use -= 1;
        }
    }

    /// Return a group without particles, linked to the group `before`.
    fn take_group(&mut self, before: u32) -> u32 {
        self.in_use += 1;
        if self.free != NONE {
            let group = self.free;
            self.free = std::mem::replace(&mut self.before[group as usize], before);
            return group;
        }
        let group = self.before.len();
        if self.rows.len() == self.rows.capacity() {
            // Reserve a little ahead: most blocks never grow again.
            let ahead = group / 32 + 1;
            self.before.reserve_exact(ahead);
            self.rows.reserve_exact(ahead * self.columns);
            self.numbers.reserve_exact(if self.apart() { ahead * T::GROUP } else { 0 });
        }
        self.before.push(before);
        if self.apart() {
            self.numbers.resize(self.before.len() * T::GROUP, 0);
        }
        for &x in &self.dummy[..self.columns] {
            let mut row = T::Row::default();
            row.as_mut().fill(x);
            self.rows.push(row);
        }
        group as u32
    }

    /// Sort the groups into bin order and drop free ones, if these are more than a twelfth.
    pub fn tidy(&mut self) {
        if 12 * self.in_use < 11 * self.before.len() {
            self.pack();
        }
    }

    /// Sort the groups into bin order and drop free ones.
    pub fn pack(&mut self) {
        let mut rows = Vec::with_capacity(self.in_use * self.columns);
        let mut before = Vec::with_capacity(self.in_use);
        let lanes = if self.apart() { T::GROUP } else { 0 };
        let mut numbers = Vec::with_capacity(self.in_use * lanes);
        for bin in 0..self.runs.len() {
            let first = before.len();
            let mut group = self.runs[bin].last;
            while group != NONE {
                rows.extend_from_slice(self.group(group));
                numbers.extend_from_slice(&self.numbers[group as usize * lanes..][..lanes]);
                before.push(before.len() as u32 + 1);
                group = self.before[group as usize];
            }
            if before.len() > first {
                self.runs[bin].last = first as u32;
                let end = before.len() - 1;
                before[end] = NONE;
            }
        }
        (self.rows, self.numbers, self.before, self.free) = (rows, numbers, before, NONE);
    }

    /// Coordinates of a bin.
    pub fn bin_coordinates(&self, bin: usize) -> [i32; D] {
        node_of(&self.coordinates, bin)
    }

    /// Iterate over all particles in order: bin and place.
    pub fn places(&self) -> impl Iterator<Item = (usize, Place)> + '_ {
        (0..self.runs.len()).flat_map(|bin| self.bin_places(bin).map(move |place| (bin, place)))
    }

    /// Iterate over the places of the particles of a bin, in order.
    pub fn bin_places(&self, bin: usize) -> impl Iterator<Item = Place> + '_ {
        std::iter::successors(self.last_group(bin), |&(group, _)| self.group_before(group))
            .flat_map(|(group, lanes)| (0..lanes as u32).map(move |lane| Place { group, lane }))
    }

    /// Write the particles of all bins to a file, in the order in which they were pushed; or read the particles of a
    /// file into this block, which is empty.
    pub(crate) fn exchange(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let mut numbers = Vec::with_capacity(self.particle_numbers());
        for bin in 0..self.runs.len() {
            let groups = std::iter::successors(self.last_group(bin), |&(group, _)| self.group_before(group));
            let mut groups: Vec<(u32, usize)> = groups.collect();
            groups.reverse();
            let mut count = self.bin_len(bin);
            file.count(&mut count)?;
            for n in 0..count {
                numbers.clear();
                match groups.get(n / T::GROUP) {
                    Some(&(group, _)) => {
                        self.read(Place { group, lane: (n % T::GROUP) as u32 }, &mut numbers)
                    }
                    None => numbers.resize(self.particle_numbers(), T::default()),
                }
                file.numbers(&mut numbers)?;
                if file.reads() {
                    self.push(bin, &numbers);
                }
            }
        }
        Ok(())
    }
}

/// Split a coordinate into block and position within the block.
#[inline]
pub fn split(coordinate: i32) -> (i32, usize) {
    let b = BLOCK as i32;
    (coordinate.div_euclid(b), coordinate.rem_euclid(b) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Particle numbers of 32 bits, stored apart, move with their particles like those in rows.
    #[test]
    fn numbers_go_with_their_particles() {
        let long = Columns::new(2, vec!["stress".into()], 0, 0, 0);
        let short = long.clone().with_short_number();
        assert_eq!((long.count(), long.rows()), (short.count(), short.rows() + 1));
        assert_eq!(long.bytes::<f64>(), short.bytes::<f64>() + 4);
        let dummy: Arc<[f64]> = vec![0.0; long.count()].into();
        let mut blocks = [long, short].map(|columns| Block::<f64, 2>::new([0; 2], &columns, dummy.clone()));
        let mut random = 1_u64;
        let mut draw = |below: usize| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) as usize % below
        };
        let mut taken = vec![0.0; dummy.len()];
        for n in 0..2000 {
            let (bin, which) = (draw(16), draw(40));
            // Three particles are pushed for each one removed; each has its number a second time, in the row of its stress.
            let here = blocks[0].bin_len(bin);
            for block in &mut blocks {
                let leaves =
                    if n % 4 < 3 || here == 0 { None } else { block.bin_places(bin).nth(which % here) };
                if let Some(at) = leaves {
                    let number = block.number(at);
                    block.take(bin, at, &mut taken);
                    assert_eq!((taken[4], taken[6]), (number as f64, number as f64));
                } else {
                    block.push(bin, &[0.1, 0.2, 0.3, 0.4, n as f64, 1.0, n as f64]);
                }
                if n % 500 == 499 {
                    block.pack();
                }
            }
        }
        for block in &blocks {
            let mut numbers = Vec::new();
            for (_, at) in block.places() {
                numbers.clear();
                block.read(at, &mut numbers);
                assert_eq!((numbers[4], numbers[6]), (block.number(at) as f64, block.number(at) as f64));
            }
        }
        let all =
            |n: usize| blocks[n].places().map(|(bin, at)| (bin, blocks[n].number(at))).collect::<Vec<_>>();
        assert!(all(0).len() > 900, "{}", all(0).len());
        assert_eq!(all(0), all(1));
    }
}
