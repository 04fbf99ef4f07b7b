//! Background grid: node records in blocks of 4^D.

mod dense;
pub(crate) mod levels;
mod sparse;

use mpm_materials::Real;

use impactite_geometry::Lattice;
use impactite_simd::Float;

pub use dense::{DenseGrid, DenseGridError};
pub use levels::{Halving, Lattices, Levels};
pub use sparse::BlockGrid;

/// Grid node: two records of four numbers, `[scalar, x, y, z]` (z unused in two dimensions).
///
/// During a step the first record is mass and momentum, then mass and velocity; the second is force, then acceleration,
/// then the vector that the stress update reads (see [`crate::scheme::Nodal`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct Node<T> {
    /// Mass (kg), then momentum (kg m/s) or velocity (m/s).
    pub first: [T; 4],
    /// Unused, then force (N), acceleration (m/s^2) or a second velocity (m/s).
    pub second: [T; 4],
}

impl<T: Real> Default for Node<T> {
    fn default() -> Self {
        Node { first: [T::default(); 4], second: [T::default(); 4] }
    }
}

/// Storage of the nodes. Blocks are identified by their coordinates and stored in any order; results do not depend on that
/// order, so any two grids yield bitwise equal results.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a grid of {D} dimensions for numbers `{T}`",
    note = "`BlockGrid` and `DenseGrid` have the dimensions of their lattice; in two take the embedding `PlaneStrain` or `Axisymmetric`, in \
            three `FullSpace`"
)]
pub trait GridStorage<T: Float, const D: usize>: Send + Sync {
    /// Lattice of the nodes.
    fn lattice(&self) -> &Lattice<D>;
    /// Allocate (at least) these blocks, sorted and without repetition, of 4^D nodes each. All nodes are zero afterwards if
    /// the set of blocks changed.
    ///
    /// # Errors
    /// The first block outside this grid.
    fn arrange(&mut self, wanted: &[[i32; D]]) -> Result<(), OutsideGrid>;
    /// Allocate `count` nodes, for bodies that share blocks ([`crate::ContactAlgorithm`]): each has its own nodes there,
    /// possibly a part of the block's.
    fn arrange_nodes(&mut self, count: usize);
    /// Coordinates of the blocks, in the order of storage.
    fn blocks(&self) -> &[[i32; D]];
    /// Index of a block in that order.
    fn find(&self, coordinates: &[i32; D]) -> Option<usize>;
    /// All nodes: 4^D per block, x fastest, after [`GridStorage::arrange`].
    fn nodes(&self) -> &[Node<T>];
    /// All nodes, mutable.
    fn nodes_mut(&mut self) -> &mut [Node<T>];
    /// True if blocks may have any coordinates, as cells of several sizes require.
    fn is_unbounded(&self) -> bool {
        false
    }
    /// Free memory beyond the needs of the current blocks; a grid may keep it.
    fn give_back(&mut self) {}
    /// Allocated memory, bytes.
    fn bytes(&self) -> usize {
        std::mem::size_of_val(self.nodes()) + std::mem::size_of_val(self.blocks())
    }
}

/// Grid selected at run time.
impl<T: Float, const D: usize> GridStorage<T, D> for Box<dyn GridStorage<T, D>> {
    fn lattice(&self) -> &Lattice<D> {
        (**self).lattice()
    }
    fn arrange(&mut self, wanted: &[[i32; D]]) -> Result<(), OutsideGrid> {
        (**self).arrange(wanted)
    }
    fn arrange_nodes(&mut self, count: usize) {
        (**self).arrange_nodes(count);
    }
    fn blocks(&self) -> &[[i32; D]] {
        (**self).blocks()
    }
    fn find(&self, coordinates: &[i32; D]) -> Option<usize> {
        (**self).find(coordinates)
    }
    fn nodes(&self) -> &[Node<T>] {
        (**self).nodes()
    }
    fn nodes_mut(&mut self) -> &mut [Node<T>] {
        (**self).nodes_mut()
    }
    fn is_unbounded(&self) -> bool {
        (**self).is_unbounded()
    }
    fn give_back(&mut self) {
        (**self).give_back();
    }
    fn bytes(&self) -> usize {
        (**self).bytes()
    }
}

pub use impactite_scene::error::OutsideGrid;
