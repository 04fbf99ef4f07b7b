//! Positions of the nodes of a block.

use super::layout::{LAYERS, whole_block};
use crate::dim::BLOCK;
use impactite_geometry::Lattice;
use impactite_scene::boundary::{Boundary, Plane};

/// Positions of the nodes of a block.
pub(in crate::step) struct BlockPlace<const D: usize> {
    pub(in crate::step) low: [f64; D],
    pub(in crate::step) high: [f64; D],
    first: [i32; D],
    origin: [f64; D],
    spacing: f64,
}

impl<const D: usize> BlockPlace<D> {
    pub(in crate::step) fn new(lattice: &Lattice<D>, block: &[i32; D]) -> Self {
        let (origin, spacing) = (lattice.origin(), lattice.spacing());
        let first = block.map(|b| b * BLOCK as i32);
        let mut low = origin;
        let mut high = origin;
        for d in 0..D {
            low[d] += f64::from(first[d]) * spacing;
            high[d] += f64::from(first[d] + BLOCK as i32 - 1) * spacing;
        }
        BlockPlace { low, high, first, origin, spacing }
    }
    /// Return the nodes of the layers across an axis for which `holds` is true of the layer's index, one bit each.
    fn layers(&self, axis: usize, holds: impl Fn(i32) -> bool) -> u64 {
        let at = |k: &usize| holds(self.first[axis] + *k as i32);
        let layer = |k: usize| LAYERS[axis] << (k * BLOCK.pow(axis as u32));
        whole_block(D) & (0..BLOCK).filter(at).fold(0, |nodes, k| nodes | layer(k))
    }
    /// Return the nodes on which a boundary may act in the step from `time`, s, one bit each: those within `reach`, m, of a
    /// boundary that moves or has no plane.
    pub(in crate::step) fn within_reach(&self, boundary: &Boundary<D>, time: f64, reach: f64) -> u64 {
        let Some(axis) = boundary.across() else { return whole_block(D) };
        let margin = if boundary.rests() { 2e-6 * self.spacing } else { reach };
        self.layers(axis, |index| {
            let mut x = self.low;
            x[axis] = self.origin[axis] + f64::from(index) * self.spacing;
            boundary.reaches(&x, &x, time, margin)
        })
    }
    /// Return the nodes behind planes, one bit each.
    pub(in crate::step) fn copies(&self, mirrors: &[Plane]) -> u64 {
        let behind = |m: &Plane| self.layers(m.axis, |index| (index - m.node) * m.sign < 0);
        mirrors.iter().fold(0, |nodes, m| nodes | behind(m))
    }
    pub(in crate::step) fn is_copy(&self, n: usize, mirrors: &[Plane]) -> bool {
        mirrors.iter().any(|m| {
            let index = self.first[m.axis] + (n / BLOCK.pow(m.axis as u32) % BLOCK) as i32;
            (index - m.node) * m.sign < 0
        })
    }
    /// Return the axes along which a node is behind a plane.
    pub(in crate::step) fn image(&self, n: usize, mirrors: &[Plane]) -> [bool; 3] {
        let mut image = [false; 3];
        for m in mirrors {
            image[m.axis] |= self.is_copy(n, std::slice::from_ref(m));
        }
        image
    }
    pub(in crate::step) fn node(&self, n: usize) -> [f64; D] {
        let mut x = self.origin;
        let mut rest = n;
        for d in 0..D {
            x[d] += f64::from(self.first[d] + (rest % BLOCK) as i32) * self.spacing;
            rest /= BLOCK;
        }
        x
    }
}
