//! Periodic planes: particle and node blocks are those of one period, and blocks beyond are mapped to it.
//!
//! A period is a whole number of blocks. A particle thus leaves its block into an adjacent one or one a period away, at the
//! same position within it, and the tile of a block is summed by the nodes of its periodic neighbours: nodes interact
//! across the planes, sums keep the order of directions, and no stage of a step needs a special case.

use crate::dim::BLOCK;
use impactite_geometry::Lattice;
use impactite_scene::boundary::{Boundary, BoundaryError};

/// Range of the blocks of a period along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wrap<const D: usize> {
    /// First block.
    first: [i32; D],
    /// Number of blocks; zero along an axis without periodic planes.
    count: [i32; D],
}

impl<const D: usize> Default for Wrap<D> {
    fn default() -> Self {
        Wrap { first: [0; D], count: [0; D] }
    }
}

impl<const D: usize> Wrap<D> {
    /// Create the wrap of these boundaries, which are on nodes.
    ///
    /// # Errors
    /// A period that is not a whole number of blocks; two periods along an axis; another plane across such an axis.
    pub(in crate::step) fn of(
        boundaries: &[Boundary<D>],
        lattice: &Lattice<D>,
    ) -> Result<Self, BoundaryError> {
        let mut wrap = Wrap::default();
        for boundary in boundaries {
            let Boundary::Periodic { axis, low, high } = *boundary else { continue };
            let cells = |x: f64| (x / lattice.spacing()).round() as i32;
            let (first, period) = (cells(low - lattice.origin()[axis]), cells(high - low));
            let refuse = |why| Err(BoundaryError::Periodic { axis, why });
            if period % BLOCK as i32 != 0 {
                return refuse("at this distance; it must be a whole number of blocks of four cells");
            }
            if boundaries.iter().filter(|b| b.across() == Some(axis)).count() > 1 {
                return refuse("beside another plane across it; there must be no other");
            }
            wrap.first[axis] = first.div_euclid(BLOCK as i32);
            wrap.count[axis] = period / BLOCK as i32;
        }
        Ok(wrap)
    }

    /// Return true if nothing is periodic.
    pub(in crate::step) fn is_none(&self) -> bool {
        self.count == [0; D]
    }

    /// Number of cells of a period along each axis, zero without one.
    pub(in crate::step) fn cells(&self) -> [i32; D] {
        self.count.map(|count| count * BLOCK as i32)
    }

    /// Return the periodic image of a block within the period.
    #[inline]
    pub(in crate::step) fn block(&self, mut at: [i32; D]) -> [i32; D] {
        for d in 0..D {
            if self.count[d] > 0 {
                at[d] = self.first[d] + (at[d] - self.first[d]).rem_euclid(self.count[d]);
            }
        }
        at
    }

    /// Return the periodic image of a node within the period.
    pub(in crate::step) fn node(&self, mut at: [i32; D]) -> [i32; D] {
        let size = BLOCK as i32;
        for d in 0..D {
            if self.count[d] > 0 {
                let first = self.first[d] * size;
                at[d] = first + (at[d] - first).rem_euclid(self.count[d] * size);
            }
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_and_nodes_are_those_of_one_period() {
        let lattice = Lattice::new([0.5, 0.0], 0.25).expect("lattice");
        // Nodes -6 .. 6: blocks -2, -1, 0.
        let planes = Boundary::Periodic { axis: 0, low: -1.0, high: 2.0 };
        let wrap = Wrap::of(&[planes], &lattice).expect("a period");
        assert_eq!((wrap.cells(), wrap.is_none()), ([12, 0], false));
        let blocks = [-3, -2, -1, 0, 1, 2].map(|x| wrap.block([x, x])[0]);
        assert_eq!(blocks, [0, -2, -1, 0, -2, -1]);
        assert_eq!(wrap.block([7, 7])[1], 7);
        for node in -40..40 {
            let inside = wrap.node([node, node]);
            assert!((-8..4).contains(&inside[0]) && (inside[0] - node) % 12 == 0 && inside[1] == node);
            let block = wrap.block([node.div_euclid(4); 2])[0];
            assert_eq!(inside[0].div_euclid(4), block);
        }
    }
}
