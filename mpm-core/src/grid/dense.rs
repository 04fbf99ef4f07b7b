//! Dense grid: all blocks of a box.

use super::{GridStorage, Node, OutsideGrid};
use crate::dim::{BLOCK, block_nodes};
use impactite_geometry::Lattice;
use impactite_simd::Float;
use impactite_simd::memory::{Budget, MOST_BYTES, MemoryError};

/// Grid with all nodes of a box, found by index arithmetic. For scenes that fill their box; others run faster and use less
/// memory on a [`super::BlockGrid`].
#[derive(Clone, Debug)]
pub struct DenseGrid<T, const D: usize> {
    lattice: Lattice<D>,
    low: [i32; D],
    size: [usize; D],
    blocks: Vec<[i32; D]>,
    nodes: Vec<Node<T>>,
}

/// Invalid dense grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DenseGridError {
    /// Box without extent.
    #[error(
        "the box of a dense grid needs `low` < `high` along axis {axis}; got {low} and {high} (node indices)"
    )]
    Empty {
        /// The axis.
        axis: usize,
        /// Lowest index.
        low: i32,
        /// Highest index.
        high: i32,
    },
    /// Box with more nodes than memory allows.
    #[error(transparent)]
    Memory(#[from] MemoryError),
}

impl<T: Float, const D: usize> DenseGrid<T, D> {
    /// Create a grid of the nodes of a lattice with indices `low..=high`, rounded outwards to whole blocks, in at most
    /// [`MOST_BYTES`].
    ///
    /// # Errors
    /// A box without extent; a box that needs more memory than that.
    pub fn new(lattice: Lattice<D>, low: [i32; D], high: [i32; D]) -> Result<Self, DenseGridError> {
        Self::within(lattice, low, high, MOST_BYTES)
    }

    /// Create a grid as [`DenseGrid::new`] does, in at most `bytes` of memory.
    ///
    /// # Errors
    /// A box without extent; a box that needs more memory than that.
    pub fn within(
        lattice: Lattice<D>,
        low: [i32; D],
        high: [i32; D],
        bytes: u64,
    ) -> Result<Self, DenseGridError> {
        let block = BLOCK as i32;
        let mut first = [0; D];
        let mut size = [0; D];
        for d in 0..D {
            if low[d] >= high[d] {
                return Err(DenseGridError::Empty { axis: d, low: low[d], high: high[d] });
            }
            first[d] = low[d].div_euclid(block);
            size[d] = (high[d].div_euclid(block) - first[d]) as usize + 1;
        }
        let budget = Budget {
            what: "a dense grid of this box",
            allowed: bytes,
            remedy: "use a smaller box or larger cells, a block grid, which holds only nodes that matter reaches, or allow more by `DenseGrid::within`",
        };
        // In floating point, in which the product does not overflow.
        let each = size_of::<[i32; D]>() + block_nodes(D) * size_of::<Node<T>>();
        budget.holds(size.iter().map(|n| *n as f64).product::<f64>() * each as f64)?;
        let count = size.iter().product();
        let mut blocks = budget.room(count)?;
        for mut rest in 0..count {
            let mut c = first;
            for d in 0..D {
                c[d] += (rest % size[d]) as i32;
                rest /= size[d];
            }
            blocks.push(c);
        }
        let mut nodes = budget.room(count * block_nodes(D))?;
        nodes.resize(count * block_nodes(D), Node::default());
        Ok(DenseGrid { lattice, low: first, size, blocks, nodes })
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
            // Two coordinates differ by less than 2^32.
            let at = i64::from(coordinates[d]) - i64::from(self.low[d]);
            let at = usize::try_from(at).ok().filter(|&at| at < self.size[d])?;
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
