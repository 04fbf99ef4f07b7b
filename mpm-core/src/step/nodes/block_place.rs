//! Positions of the nodes of a block.

use crate::dim::BLOCK;
use impactite_geometry::Lattice;
use impactite_scene::boundary::Plane;

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
