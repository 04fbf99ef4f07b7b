//! Particles of a liquid, sorted by block.

use impactite_geometry::Lattice;

use crate::blocks::{Blocks, NONE, SIDE};

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
    /// Heat of viscosity since the start, J.
    pub heat: f64,
    pub particles: Vec<Particle<D>>,
    /// First particle of each block, and the count of all.
    pub starts: Vec<u32>,
    sorted: Vec<Particle<D>>,
    block_of: Vec<u32>,
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
            heat: 0.0,
            particles,
            starts: Vec::new(),
            sorted: Vec::new(),
            block_of: Vec::new(),
        }
    }

    /// Blocks that contain particles, in any order, with repetitions.
    ///
    /// # Errors
    /// Index of a particle whose position is no cell.
    pub fn occupied(&self, frame: &Frame<D>, out: &mut Vec<[i32; D]>) -> Result<(), usize> {
        let mut last = None;
        for (n, p) in self.particles.iter().enumerate() {
            let key = frame.block(&p.x).ok_or(n)?;
            if last != Some(key) {
                out.push(key);
                last = Some(key);
            }
        }
        Ok(())
    }

    /// Sort the particles by block, keeping their order within a block.
    pub fn sort(&mut self, blocks: &Blocks<D>, frame: &Frame<D>) {
        let count = self.particles.len();
        self.starts.clear();
        self.starts.resize(blocks.len() + 1, 0);
        self.block_of.clear();
        let (mut key, mut block, mut sorted, mut before) = ([i32::MAX; D], NONE, true, 0);
        for p in &self.particles {
            let here = frame.block(&p.x).unwrap_or(key);
            if here != key {
                (key, block) = (here, blocks.find(&here));
            }
            sorted &= block >= before;
            before = block;
            self.block_of.push(block);
            self.starts[block as usize + 1] += 1;
        }
        for b in 0..blocks.len() {
            self.starts[b + 1] += self.starts[b];
        }
        if sorted || count == 0 {
            return;
        }
        let mut next = self.starts.clone();
        self.sorted.clear();
        self.sorted.resize(count, self.particles[0]);
        for (p, &b) in self.particles.iter().zip(&self.block_of) {
            let place = &mut next[b as usize];
            self.sorted[*place as usize] = *p;
            *place += 1;
        }
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
            + 4 * (self.starts.capacity() + self.block_of.capacity())
    }
}
