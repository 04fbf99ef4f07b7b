//! Bounding box, node selection by position, and edge lengths.

use super::{ElementMesh, MeshError};
use crate::bounds::Bounds;
use crate::error::{Check, GeometryError};
use crate::shape::Shape;
use crate::vector::{norm, sub, sum};

/// Lengths of the edges of elements (m), each edge once: the mesh size for a time step limit, a contact search or a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLengths {
    /// Shortest edge length, m.
    pub min: f64,
    /// Mean edge length, m.
    pub mean: f64,
    /// Longest edge length, m.
    pub max: f64,
}

impl<const D: usize> ElementMesh<D> {
    /// Bounding box of all nodes.
    #[must_use]
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.nodes.iter().copied())
    }

    /// Number of elements in all blocks.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.blocks.iter().map(super::ElementBlock::len).sum()
    }

    /// Select the nodes for whose position (m) `holds` is true, ascending.
    #[must_use]
    pub fn nodes_where(&self, holds: impl Fn([f64; D]) -> bool) -> Vec<u32> {
        (0u32..).zip(&self.nodes).filter(|(_, x)| holds(**x)).map(|(node, _)| node).collect()
    }

    /// Select the nodes within a shape or at a distance of at most `margin` (m) from it. With a margin of zero, nodes on the surface are
    /// selected to within rounding.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the margin is finite and not negative.
    pub fn nodes_in(&self, shape: &(impl Shape<D> + ?Sized), margin: f64) -> Result<Vec<u32>, GeometryError> {
        Check("nodes in a shape").that(margin >= 0.0, "margin", margin, "zero or positive, and finite")?;
        Ok(self.nodes_where(|x| shape.signed_distance(x) <= margin))
    }

    /// Add a node set, or replace the one of this name.
    ///
    /// # Errors
    /// [`MeshError`] unless the nodes exist and ascend.
    pub fn with_node_set(mut self, name: &str, nodes: Vec<u32>) -> Result<Self, GeometryError> {
        self.node_sets.insert(name.into(), nodes);
        self.check_numbers()?;
        Ok(self)
    }

    /// Centroid of the nodes of an element (m).
    ///
    /// # Panics
    /// Panics if there is no such element, or it refers to a node that does not exist.
    pub(crate) fn centre(&self, block: usize, element: usize) -> [f64; D] {
        let block = &self.blocks[block];
        let count = block.kind.nodes();
        let nodes = &block.nodes[count * element..count * (element + 1)];
        let sum = |d: usize| nodes.iter().map(|&n| self.nodes[n as usize][d]).sum::<f64>();
        std::array::from_fn(|d| sum(d) / count as f64)
    }

    /// Minimum, mean and maximum edge length.
    ///
    /// # Errors
    /// [`MeshError`] if there is no element, or one refers to a node that does not exist.
    pub fn edge_lengths(&self) -> Result<EdgeLengths, GeometryError> {
        self.check_numbers()?;
        let mut edges: Vec<[u32; 2]> = Vec::new();
        for block in &self.blocks {
            for nodes in block.elements() {
                edges.extend(block.kind.edges().iter().map(|e| {
                    let [a, b] = e.map(|place| nodes[place]);
                    [a.min(b), a.max(b)]
                }));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let length = |e: &[u32; 2]| norm(sub(self.nodes[e[0] as usize], self.nodes[e[1] as usize]));
        let range = edges.iter().map(length).map(|l| [l, l]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let [min, max] = range.ok_or(MeshError::Empty { what: "the length of its edges" })?;
        Ok(EdgeLengths { min, mean: sum(edges.iter().map(length)) / edges.len() as f64, max })
    }
}
