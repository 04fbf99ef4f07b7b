//! A block of bins with their particles.

use crate::dim::{BLOCK, block_nodes};
use crate::parallel::Float;

/// The groups of one bin.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    /// First row in the block's memory.
    start: u32,
    /// Particles.
    len: u32,
    /// Groups there is room for.
    room: u32,
}

/// The particles of 4^D bins.
#[derive(Clone, Debug)]
pub struct Block<T: Float, const D: usize> {
    /// Block coordinates: it holds the bins `BLOCK * coordinates[d] .. BLOCK * (coordinates[d] + 1)`.
    pub coordinates: [i32; D],
    /// Numbers of a particle: rows of a group.
    columns: usize,
    runs: Vec<Run>,
    rows: Vec<T::Row>,
    /// Rows where runs that moved to a larger place began, by the groups they had room for.
    holes: Vec<Vec<u32>>,
    particles: usize,
    /// What a lane without a particle holds.
    dummy: Vec<T>,
}

/// The particles that left the bins of a block in a pass, for the blocks around (and itself) to take in.
#[derive(Clone, Debug, Default)]
pub struct Outbox<T> {
    /// For each, the neighbour it goes to: 0 .. 3^D, x fastest, the block itself in the middle.
    pub to: Vec<u8>,
    /// For each, the bin in that neighbour.
    pub bin: Vec<u8>,
    /// For each, its numbers.
    pub numbers: Vec<T>,
    /// For each, the records it scatters to the nodes.
    pub records: Vec<[T; 4]>,
    /// Bit `to` is set if a particle goes there.
    pub directions: u32,
}

impl<T> Outbox<T> {
    /// Empty it, keeping its memory.
    pub fn clear(&mut self) {
        self.to.clear();
        self.bin.clear();
        self.numbers.clear();
        self.records.clear();
        self.directions = 0;
    }
}

impl<T: Float, const D: usize> Block<T, D> {
    /// An empty block. `dummy` is what a lane without a particle holds: one number a column.
    pub fn new(coordinates: [i32; D], dummy: Vec<T>) -> Self {
        Block {
            coordinates,
            columns: dummy.len(),
            runs: vec![Run::default(); block_nodes(D)],
            rows: Vec::new(),
            holes: Vec::new(),
            particles: 0,
            dummy,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.particles
    }
    /// Has it no particle?
    pub fn is_empty(&self) -> bool {
        self.particles == 0
    }
    /// Bytes of its memory.
    pub fn bytes(&self) -> usize {
        self.rows.capacity() * size_of::<T::Row>()
            + self.runs.capacity() * size_of::<Run>()
            + self.dummy.capacity() * size_of::<T>()
    }
    /// Number of particles in a bin.
    #[inline(always)]
    pub fn bin_len(&self, bin: usize) -> usize {
        self.runs[bin].len as usize
    }
    /// The rows of a bin's groups.
    #[inline(always)]
    pub fn bin_rows(&self, bin: usize) -> &[T::Row] {
        let run = self.runs[bin];
        let groups = (run.len as usize).div_ceil(T::GROUP);
        &self.rows[run.start as usize..][..groups * self.columns]
    }
    /// The rows of a bin's groups.
    #[inline(always)]
    pub fn bin_rows_mut(&mut self, bin: usize) -> &mut [T::Row] {
        let run = self.runs[bin];
        let groups = (run.len as usize).div_ceil(T::GROUP);
        &mut self.rows[run.start as usize..][..groups * self.columns]
    }
    /// The number of column `column` of particle `index` of a bin.
    #[inline]
    pub fn get(&self, bin: usize, index: usize, column: usize) -> T {
        self.rows[self.row(bin, index) + column].as_ref()[index % T::GROUP]
    }
    /// Set a number.
    #[inline]
    pub fn set(&mut self, bin: usize, index: usize, column: usize, value: T) {
        let row = self.row(bin, index) + column;
        self.rows[row].as_mut()[index % T::GROUP] = value;
    }
    #[inline(always)]
    fn row(&self, bin: usize, index: usize) -> usize {
        self.runs[bin].start as usize + index / T::GROUP * self.columns
    }

    /// All numbers of a particle.
    pub fn read(&self, bin: usize, index: usize, numbers: &mut Vec<T>) {
        let first = self.row(bin, index);
        let lane = index % T::GROUP;
        numbers.extend(self.rows[first..first + self.columns].iter().map(|row| row.as_ref()[lane]));
    }
    fn write(&mut self, bin: usize, index: usize, numbers: &[T]) {
        let first = self.row(bin, index);
        let lane = index % T::GROUP;
        for (row, &x) in self.rows[first..first + self.columns].iter_mut().zip(numbers) {
            row.as_mut()[lane] = x;
        }
    }

    /// Append a particle to a bin.
    pub fn push(&mut self, bin: usize, numbers: &[T]) {
        let run = self.runs[bin];
        let index = run.len as usize;
        if index == run.room as usize * T::GROUP {
            self.make_room(bin);
        }
        if index.is_multiple_of(T::GROUP) {
            let first = self.row(bin, index);
            for (row, &x) in self.rows[first..first + self.columns].iter_mut().zip(&self.dummy) {
                row.as_mut().fill(x);
            }
        }
        self.write(bin, index, numbers);
        self.runs[bin].len += 1;
        self.particles += 1;
    }

    /// Remove a particle; the bin's last one takes its place.
    pub fn remove(&mut self, bin: usize, index: usize) {
        let last = self.runs[bin].len as usize - 1;
        let (to, from) = (self.row(bin, index), self.row(bin, last));
        for c in 0..self.columns {
            let x = self.rows[from + c].as_ref()[last % T::GROUP];
            self.rows[to + c].as_mut()[index % T::GROUP] = x;
            self.rows[from + c].as_mut()[last % T::GROUP] = self.dummy[c];
        }
        self.runs[bin].len -= 1;
        self.particles -= 1;
    }

    /// One more group for a bin: in a hole that another run left, or at the end of the block's memory.
    fn make_room(&mut self, bin: usize) {
        let run = self.runs[bin];
        let (start, room) = (run.start as usize, run.room as usize);
        let used = room * self.columns;
        self.runs[bin].room += 1;
        if used > 0 && start + used == self.rows.len() {
            self.lengthen(self.columns);
            return;
        }
        let place = match self.holes.get_mut(room + 1).and_then(Vec::pop) {
            Some(hole) => hole as usize,
            None => {
                let end = self.rows.len();
                self.lengthen(used + self.columns);
                end
            }
        };
        self.rows.copy_within(start..start + used, place);
        self.runs[bin].start = place as u32;
        if room > 0 {
            if self.holes.len() <= room {
                self.holes.resize(room + 1, Vec::new());
            }
            self.holes[room].push(start as u32);
        }
    }

    /// Append rows; a little ahead where memory must grow, since most of it never grows again.
    fn lengthen(&mut self, rows: usize) {
        let length = self.rows.len() + rows;
        if length > self.rows.capacity() {
            self.rows.reserve_exact(rows + length / 4);
        }
        self.rows.resize(length, T::Row::default());
    }

    /// Lay the runs out again in bin order without gaps, if gaps take more than half of the memory.
    pub fn tidy(&mut self) {
        let needed: usize =
            self.runs.iter().map(|r| (r.len as usize).div_ceil(T::GROUP) * self.columns).sum();
        if self.rows.len() <= needed * 2 {
            return;
        }
        let mut rows = Vec::with_capacity(needed);
        for run in &mut self.runs {
            let groups = (run.len as usize).div_ceil(T::GROUP);
            let start = rows.len();
            rows.extend_from_slice(&self.rows[run.start as usize..][..groups * self.columns]);
            *run = Run { start: start as u32, len: run.len, room: groups as u32 };
        }
        self.rows = rows;
        self.holes.clear();
    }

    /// Coordinates of a bin.
    pub fn bin_coordinates(&self, bin: usize) -> [i32; D] {
        let mut c = self.coordinates;
        let mut rest = bin;
        for x in &mut c {
            *x = *x * BLOCK as i32 + (rest % BLOCK) as i32;
            rest /= BLOCK;
        }
        c
    }

    /// For every particle: its bin and its index there, in order.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.runs.iter().enumerate().flat_map(|(bin, run)| (0..run.len as usize).map(move |i| (bin, i)))
    }

    /// The dummy of this block.
    pub fn dummy(&self) -> &[T] {
        &self.dummy
    }
}

/// Split a coordinate into block and place within the block.
#[inline]
pub fn split(coordinate: i32) -> (i32, usize) {
    let b = BLOCK as i32;
    (coordinate.div_euclid(b), coordinate.rem_euclid(b) as usize)
}
