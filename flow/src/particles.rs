//! Particles of a liquid, sorted by block.

use impactite_geometry::Lattice;
use impactite_simd::Team;

use crate::blocks::{Blocks, SIDE};

/// Number of particles whose blocks are found at once.
const PIECE: usize = 8192;

const _: () = assert!(SIDE == 4, "the block of a cell is a quarter of its coordinate");

/// Particle of a liquid: affine particle-in-cell (APIC), \[Jiang2017\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Particle<const D: usize> {
    /// Position, m.
    pub x: [f64; D],
    /// Velocity, m/s, in the middle of the last step.
    pub v: [f64; D],
    /// Affine matrix h dv_d/dx_e, m/s: the change of velocity over a cell.
    pub c: [[f64; D]; D],
    /// Volume, m^3 (m^2 in the plane).
    pub volume: f64,
    /// Pressure in the last step, Pa.
    pub pressure: f64,
    /// Number in its body.
    pub number: u32,
}

/// Map of positions to cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<const D: usize> {
    pub origin: [f64; D],
    pub h: f64,
    per_h: f64,
    /// Period along each axis, in blocks; 0 without.
    pub period: [i32; D],
}

impl<const D: usize> Frame<D> {
    pub fn new(lattice: &Lattice<D>, period: [i32; D]) -> Self {
        let h = lattice.spacing();
        Frame { origin: lattice.origin(), h, per_h: 1.0 / h, period }
    }
    /// Position in cells.
    #[inline(always)]
    pub fn cells(&self, x: &[f64; D]) -> [f64; D] {
        let mut at = [0.0; D];
        for d in 0..D {
            at[d] = (x[d] - self.origin[d]) * self.per_h;
        }
        at
    }
    /// Block of a position; none if it is not finite or beyond 2^28 cells.
    #[inline(always)]
    pub fn block(&self, x: &[f64; D]) -> Option<[i32; D]> {
        const FARTHEST: f64 = (1 << 28) as f64;
        let at = self.cells(x);
        let mut key = [0; D];
        for d in 0..D {
            let near = at[d].abs() < FARTHEST;
            if !near {
                return None;
            }
            // The floor, without a call of the library.
            let cell = at[d] as i32;
            key[d] = (cell - i32::from(f64::from(cell) > at[d])) >> 2;
        }
        Some(key)
    }
    /// Position in cells from the corner of a block, 0 to 4 in it.
    #[inline(always)]
    pub fn local(&self, x: &[f64; D], key: &[i32; D]) -> [f64; D] {
        let mut at = self.cells(x);
        for d in 0..D {
            at[d] -= f64::from(key[d] * SIDE as i32);
        }
        at
    }
    /// Position of a place in a block, given in cells from its corner.
    #[inline]
    pub fn place(&self, key: &[i32; D], at: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|d| self.origin[d] + (f64::from(key[d]) * SIDE as f64 + at[d]) * self.h)
    }
    /// Way from `from` to `to` along an axis, m, over the period if that is shorter.
    pub fn way(&self, axis: usize, from: f64, to: f64) -> f64 {
        let (way, period) = (to - from, f64::from(self.period[axis]) * SIDE as f64 * self.h);
        if period > 0.0 { way - period * (way / period).round() } else { way }
    }
    /// Image of a position in the period.
    #[inline(always)]
    pub fn wrap(&self, x: &mut [f64; D]) {
        for d in 0..D {
            if self.period[d] > 0 {
                let length = f64::from(self.period[d]) * SIDE as f64 * self.h;
                let from = x[d] - self.origin[d];
                if from < 0.0 {
                    x[d] += length;
                } else if from >= length {
                    x[d] -= length;
                }
                // A negative position of the size of rounding becomes the upper end.
                if x[d] - self.origin[d] >= length {
                    x[d] = self.origin[d];
                }
            }
        }
    }
}

/// Liquid body: particles sorted by block.
#[derive(Clone, Debug)]
pub(crate) struct Liquid<const D: usize> {
    pub name: String,
    /// Density, kg/m^3.
    pub density: f64,
    /// Time from the velocities to the positions, s.
    pub lag: f64,
    /// Body force at the present time, m/s^2.
    pub force: [f64; D],
    /// Change of the momentum over time in the last step, N.
    pub momentum_rate: [f64; D],
    /// Mass times square of the acceleration in the last step, N^2/kg.
    pub acceleration: f64,
    /// Power of the force by place at the present time, W.
    pub power: f64,
    /// Heat of viscosity since the start, J.
    pub heat: f64,
    pub particles: Vec<Particle<D>>,
    /// First particle of each block, and the count of all.
    pub starts: Vec<u32>,
    sorted: Vec<Particle<D>>,
    pieces: Vec<Piece<D>>,
    /// Block, first particle and number of particles of each run.
    order: Vec<(u32, u32, u32)>,
}

/// Successive particles in one block.
#[derive(Clone, Copy, Debug)]
struct Run<const D: usize> {
    key: [i32; D],
    /// First particle in its piece, and number.
    first: u32,
    count: u32,
}

/// Runs of some successive particles.
#[derive(Clone, Debug)]
struct Piece<const D: usize> {
    runs: Vec<Run<D>>,
    /// Index of a particle whose position is no cell.
    failed: Option<usize>,
}

impl<const D: usize> Default for Piece<D> {
    fn default() -> Self {
        Piece { runs: Vec::new(), failed: None }
    }
}

impl<const D: usize> Piece<D> {
    /// Find the runs of particles, of which the first has the index `start`.
    fn find(&mut self, frame: &Frame<D>, start: usize, particles: &[Particle<D>]) {
        self.runs.clear();
        self.failed = None;
        for (n, p) in particles.iter().enumerate() {
            let Some(key) = frame.block(&p.x) else {
                self.failed = Some(start + n);
                return;
            };
            match self.runs.last_mut() {
                Some(run) if run.key == key => run.count += 1,
                _ => self.runs.push(Run { key, first: n as u32, count: 1 }),
            }
        }
    }
}

impl<const D: usize> Liquid<D> {
    pub fn new(name: String, density: f64, particles: Vec<Particle<D>>) -> Self {
        Liquid {
            name,
            density,
            lag: 0.0,
            force: [0.0; D],
            momentum_rate: [0.0; D],
            acceleration: 0.0,
            power: 0.0,
            heat: 0.0,
            particles,
            starts: Vec::new(),
            sorted: Vec::new(),
            pieces: Vec::new(),
            order: Vec::new(),
        }
    }

    /// Blocks that contain particles, in any order, with repetitions; for the next [`Liquid::sort`], too.
    ///
    /// # Errors
    /// Index of a particle whose position is no cell.
    pub fn occupied(&mut self, team: &Team, frame: &Frame<D>, out: &mut Vec<[i32; D]>) -> Result<(), usize> {
        let particles = &self.particles;
        self.pieces.resize_with(particles.len().div_ceil(PIECE), Piece::default);
        team.each(&mut self.pieces, |n, piece| {
            let first = n * PIECE;
            piece.find(frame, first, &particles[first..particles.len().min(first + PIECE)]);
        });
        if let Some(failed) = self.pieces.iter().find_map(|piece| piece.failed) {
            return Err(failed);
        }
        out.extend(self.pieces.iter().flat_map(|piece| &piece.runs).map(|run| run.key));
        Ok(())
    }

    /// Sort the particles by the blocks that [`Liquid::occupied`] found, keeping their order within a block.
    pub fn sort(&mut self, team: &Team, blocks: &Blocks<D>) {
        let count = self.particles.len();
        self.starts.clear();
        self.starts.resize(blocks.len() + 1, 0);
        let (mut sorted, mut before) = (true, 0);
        self.order.clear();
        for (n, piece) in self.pieces.iter().enumerate() {
            for run in &piece.runs {
                let block = blocks.find(&run.key);
                sorted &= block >= before;
                before = block;
                self.starts[block as usize + 1] += run.count;
                self.order.push((block, (n * PIECE) as u32 + run.first, run.count));
            }
        }
        for b in 0..blocks.len() {
            self.starts[b + 1] += self.starts[b];
        }
        if sorted || count == 0 {
            return;
        }
        // By block and then by place, which are all different.
        self.order.sort_unstable();
        self.sorted.resize(count, self.particles[0]);
        let (order, particles) = (&self.order, &self.particles);
        let mut next = 0;
        let mut runs: Vec<&[(u32, u32, u32)]> = (0..blocks.len() as u32)
            .map(|b| {
                let first = next;
                next += order[first..].iter().take_while(|run| run.0 == b).count();
                &order[first..next]
            })
            .collect();
        team.each_part(&mut self.sorted, &self.starts, &mut runs, |_, to, runs| {
            let mut at = 0;
            for (_, first, count) in *runs {
                let (first, count) = (*first as usize, *count as usize);
                to[at..at + count].copy_from_slice(&particles[first..first + count]);
                at += count;
            }
        });
        std::mem::swap(&mut self.particles, &mut self.sorted);
    }

    /// Particles of a block.
    #[inline]
    pub fn of_block(&self, b: usize) -> &[Particle<D>] {
        &self.particles[self.starts[b] as usize..self.starts[b + 1] as usize]
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        (self.particles.capacity() + self.sorted.capacity()) * size_of::<Particle<D>>()
            + 4 * self.starts.capacity()
            + 12 * self.order.capacity()
            + self.pieces.iter().map(|p| p.runs.capacity() * size_of::<Run<D>>()).sum::<usize>()
    }
}
