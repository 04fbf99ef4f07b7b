//! Every block of a box.

use super::{GridStorage, Node, OutsideGrid, zeroed};
use crate::dim::BLOCK;
use crate::geometry::Lattice;
use crate::parallel::Float;

/// A grid that holds all nodes of a box, found by index arithmetic. For scenes that fill their box; others
/// are faster and smaller on a [`super::BlockGrid`].
#[derive(Clone, Debug)]
pub struct DenseGrid<T, const D: usize> {
    lattice: Lattice<D>,
    low: [i32; D],
    size: [usize; D],
    blocks: Vec<[i32; D]>,
    nodes: Vec<Node<T>>,
}

/// A box that is no box.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the box of a dense grid needs `low` < `high` along axis {axis}; got {low} and {high} (node indices)"
)]
pub struct EmptyBox {
    axis: usize,
    low: i32,
    high: i32,
}

impl<T: Float, const D: usize> DenseGrid<T, D> {
    /// The nodes of a lattice with indices `low..=high`, rounded outwards to whole blocks.
    ///
    /// # Errors
    /// A box without extent.
    pub fn new(lattice: Lattice<D>, low: [i32; D], high: [i32; D]) -> Result<Self, EmptyBox> {
        let block = BLOCK as i32;
        let mut first = [0; D];
        let mut size = [0; D];
        for d in 0..D {
            if low[d] >= high[d] {
                return Err(EmptyBox { axis: d, low: low[d], high: high[d] });
            }
            first[d] = low[d].div_euclid(block);
            size[d] = (high[d].div_euclid(block) - first[d]) as usize + 1;
        }
        let count = size.iter().product();
        let mut blocks = Vec::with_capacity(count);
        for mut rest in 0..count {
            let mut c = first;
            for d in 0..D {
                c[d] += (rest % size[d]) as i32;
                rest /= size[d];
            }
            blocks.push(c);
        }
        Ok(DenseGrid { lattice, low: first, size, blocks, nodes: zeroed::<T, D>(count) })
    }
}

impl<T: Float, const D: usize> GridStorage<T, D> for DenseGrid<T, D> {
    fn lattice(&self) -> &Lattice<D> {
        &self.lattice
    }
    fn arrange(&mut self, wanted: &[[i32; D]]) -> Result<(), OutsideGrid> {
        match wanted.iter().find(|&c| self.find(c).is_none()) {
            None => Ok(()),
            Some(c) => Err(OutsideGrid {
                coordinates: c.to_vec(),
                hint: "enlarge the dense grid's box or use a block grid, which has no bounds",
            }),
        }
    }
    fn arrange_nodes(&mut self, count: usize) {
        self.nodes.reserve_exact(count.saturating_sub(self.nodes.len()));
        self.nodes.resize(count, Node::default());
    }
    fn blocks(&self) -> &[[i32; D]] {
        &self.blocks
    }
    fn find(&self, coordinates: &[i32; D]) -> Option<usize> {
        let mut index = 0;
        for d in (0..D).rev() {
            let at = usize::try_from(coordinates[d] - self.low[d]).ok().filter(|&at| at < self.size[d])?;
            index = index * self.size[d] + at;
        }
        Some(index)
    }
    fn nodes(&self) -> &[Node<T>] {
        &self.nodes
    }
    fn nodes_mut(&mut self) -> &mut [Node<T>] {
        &mut self.nodes
    }
}
