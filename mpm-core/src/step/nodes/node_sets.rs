//! Sets of nodes of a block.

/// Constrained nodes of a block, one bit each, by axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSets(pub(in crate::step) [u64; 3]);

impl NodeSets {
    pub(in crate::step) fn has(&self, axis: usize, node: usize) -> bool {
        self.0[axis] >> node & 1 != 0
    }
    pub(in crate::step) fn set(&mut self, axis: usize, node: usize, is: bool) {
        self.0[axis] = self.0[axis] & !(1 << node) | u64::from(is) << node;
    }
}
