//! Sparse grid: blocks near the particles.

use super::{GridStorage, Node, OutsideGrid};
use crate::dim::block_nodes;
use impactite_geometry::Lattice;
use impactite_simd::Float;

/// Unbounded grid that stores only the requested blocks: the dynamic and the moving grid of \[Ma2010\] 1.5 combined, with
/// constant cell size.
#[derive(Clone, Debug)]
pub struct BlockGrid<T, const D: usize> {
    lattice: Lattice<D>,
    blocks: Vec<[i32; D]>,
    nodes: Vec<Node<T>>,
}

impl<T: Float, const D: usize> BlockGrid<T, D> {
    /// Create an empty grid on a lattice.
    pub fn new(lattice: Lattice<D>) -> Self {
        BlockGrid { lattice, blocks: Vec::new(), nodes: Vec::new() }
    }
}

impl<T: Float, const D: usize> GridStorage<T, D> for BlockGrid<T, D> {
    fn lattice(&self) -> &Lattice<D> {
        &self.lattice
    }
    fn is_unbounded(&self) -> bool {
        true
    }
    fn arrange(&mut self, wanted: &[[i32; D]]) -> Result<(), OutsideGrid> {
        if wanted != self.blocks {
            self.blocks.clear();
            self.blocks.extend_from_slice(wanted);
            self.nodes.clear();
            self.arrange_nodes(self.blocks.len() * block_nodes(D));
        }
        Ok(())
    }
    fn arrange_nodes(&mut self, count: usize) {
        self.nodes.reserve_exact(count.saturating_sub(self.nodes.len()));
        self.nodes.resize(count, Node::default());
    }
    fn give_back(&mut self) {
        self.blocks.shrink_to_fit();
        self.nodes.shrink_to_fit();
    }
    fn blocks(&self) -> &[[i32; D]] {
        &self.blocks
    }
    fn find(&self, coordinates: &[i32; D]) -> Option<usize> {
        self.blocks.binary_search(coordinates).ok()
    }
    fn nodes(&self) -> &[Node<T>] {
        &self.nodes
    }
    fn nodes_mut(&mut self) -> &mut [Node<T>] {
        &mut self.nodes
    }
}
