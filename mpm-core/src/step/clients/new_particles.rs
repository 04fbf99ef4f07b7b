//! Particles added to a body between steps, and space occupied by others.

use std::sync::Arc;

use mpm_materials::Material;

use crate::dim::BLOCK;
use crate::particles::split;
use impactite_geometry::Lattice;
use impactite_simd::Float;

/// Matter of a [`GridClient`](crate::step::GridClient) that may convert to particles.
#[derive(Clone)]
pub struct Matter<T: Float, const D: usize> {
    /// Law of the matter.
    pub law: Arc<dyn Material<T>>,
    /// Half sizes of the particles, m, for shape functions whose domains do not follow the strain; at most half a cell.
    pub half_size: [f64; D],
    /// Least mass of a particle, kg.
    pub lightest: f64,
}

/// Particle added to a body between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewParticle<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// Velocity gradient dv_c/dx_d around it, 1/s: affine transfers map it once, like the gradient gathered from nodes.
    pub gradient: [[f64; D]; D],
    /// Mass, kg.
    pub mass: f64,
    /// Half edges of its domain, m.
    pub half_edges: [[f64; 3]; 3],
}

/// Particles added to a body between steps, with their state variables.
#[derive(Clone, Debug, Default)]
pub struct NewParticles<T, const D: usize> {
    pub(in crate::step) particles: Vec<NewParticle<D>>,
    pub(in crate::step) states: Vec<T>,
}

impl<T: Copy, const D: usize> NewParticles<T, D> {
    /// Add a particle with its state variables.
    pub fn push(&mut self, particle: NewParticle<D>, state: &[T]) {
        self.particles.push(particle);
        self.states.extend_from_slice(state);
    }
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.particles.len()
    }
    /// True if there are no particles.
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }
}

/// Surroundings of a body whose matter may convert to particles.
#[derive(Clone, Debug)]
pub struct Surroundings<const D: usize> {
    /// Matter of other bodies.
    pub others: Occupied<D>,
    /// Points of other elements within the same body: bars.
    pub within: Occupied<D>,
}

/// Space occupied by matter: bins of the size of a cell, in blocks of 4^D.
#[derive(Clone, Debug)]
pub struct Occupied<const D: usize> {
    lattice: Lattice<D>,
    /// Offset of the bin centres from the nodes, in cells.
    centre: f64,
    /// Blocks with the bit mask of their occupied bins, sorted.
    pub(in crate::step) blocks: Vec<([i32; D], u64)>,
    /// Bounding box of all blocks, in bins; none if there are none.
    bounds: Option<[[i32; D]; 2]>,
}

impl<const D: usize> Surroundings<D> {
    /// Edge of a cell of the grid, m.
    pub fn spacing(&self) -> f64 {
        self.others.lattice.spacing()
    }
}

impl<const D: usize> Occupied<D> {
    pub(in crate::step) fn new(lattice: Lattice<D>, centre: f64) -> Self {
        Occupied { lattice, centre, blocks: Vec::new(), bounds: None }
    }

    fn bin(&self, x: f64, d: usize) -> i32 {
        let cells = (x - self.lattice.origin()[d]) / self.lattice.spacing() - self.centre + 0.5;
        cells.floor().clamp(-1e9, 1e9) as i32
    }

    pub(in crate::step) fn add_box(&mut self, low: &[f64; D], high: &[f64; D]) {
        let first: [i32; D] = std::array::from_fn(|d| self.bin(low[d], d));
        let last: [i32; D] = std::array::from_fn(|d| self.bin(high[d], d));
        let mut at = first;
        loop {
            let (mut block, mut bin, mut stride) = ([0; D], 0, 1);
            for d in 0..D {
                let (b, place) = split(at[d]);
                block[d] = b;
                bin += place * stride;
                stride *= BLOCK;
            }
            self.blocks.push((block, 1 << bin));
            let Some(d) = (0..D).find(|&d| at[d] < last[d]) else { break };
            at[d] += 1;
            at[..d].copy_from_slice(&first[..d]);
        }
    }

    /// Sort the blocks and compute their bounding box, once all are added.
    pub(in crate::step) fn settle(&mut self) {
        self.blocks.sort_unstable();
        self.blocks.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            kept.1 |= if same { next.1 } else { 0 };
            same
        });
        self.bounds = None;
        for (block, _) in &self.blocks {
            let low: [i32; D] = block.map(|b| b * BLOCK as i32);
            let high: [i32; D] = low.map(|b| b + BLOCK as i32 - 1);
            let [below, above] = self.bounds.get_or_insert([low, high]);
            for d in 0..D {
                (below[d], above[d]) = (below[d].min(low[d]), above[d].max(high[d]));
            }
        }
    }

    /// True if nothing is occupied.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// True if an occupied bin touches the box (lower and upper corner, m).
    pub fn touches(&self, low: &[f64; D], high: &[f64; D]) -> bool {
        let Some([below, above]) = self.bounds else { return false };
        let first: [i32; D] = std::array::from_fn(|d| self.bin(low[d], d).max(below[d]));
        let last: [i32; D] = std::array::from_fn(|d| self.bin(high[d], d).min(above[d]));
        if (0..D).any(|d| first[d] > last[d]) {
            return false;
        }
        let blocks: [[i32; D]; 2] = [first, last].map(|at| at.map(|x| split(x).0));
        let mut at = blocks[0];
        loop {
            let found = self.blocks.binary_search_by_key(&at, |b| b.0);
            if found.is_ok_and(|found| self.blocks[found].1 & within(&at, &first, &last) != 0) {
                return true;
            }
            let Some(d) = (0..D).find(|&d| at[d] < blocks[1][d]) else { return false };
            at[d] += 1;
            at[..d].copy_from_slice(&blocks[0][..d]);
        }
    }
}

/// Bit mask of the bins of a block between two other bins.
fn within<const D: usize>(block: &[i32; D], first: &[i32; D], last: &[i32; D]) -> u64 {
    let side = BLOCK as i32;
    let mut range = [[0, 1]; 3];
    for d in 0..D {
        range[d] = [(first[d] - block[d] * side).max(0), (last[d] + 1 - block[d] * side).min(side)];
    }
    let row = (1u64 << range[0][1]) - (1 << range[0][0]);
    let mut bins = 0;
    for z in range[2][0]..range[2][1] {
        for y in range[1][0]..range[1][1] {
            bins |= row << ((z * side + y) * side);
        }
    }
    bins
}
