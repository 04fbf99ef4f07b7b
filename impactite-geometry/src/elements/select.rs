//! Bounds, nodes by place, and lengths of edges.

use super::{ElementMesh, MeshError};
use crate::bounds::Bounds;
use crate::error::{Check, GeometryError};
use crate::shape::Shape;
use crate::vector::{norm, sub, sum};

/// Lengths of the edges of elements (m), each edge once: what a time step, a contact or a grid compares with its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLengths {
    /// The shortest.
    pub min: f64,
    /// The mean.
    pub mean: f64,
    /// The longest.
    pub max: f64,
}

impl<const D: usize> ElementMesh<D> {
    /// The smallest box around all nodes.
    #[must_use]
    pub fn bounds(&self) -> Bounds<D> {
        Bounds::around(self.nodes.iter().copied())
    }

    /// How many elements there are in all blocks.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.blocks.iter().map(super::ElementBlock::len).sum()
    }

    /// The nodes at whose position (m) `holds`, ascending.
    #[must_use]
    pub fn nodes_where(&self, holds: impl Fn([f64; D]) -> bool) -> Vec<u32> {
        (0u32..).zip(&self.nodes).filter(|(_, x)| holds(**x)).map(|(node, _)| node).collect()
    }

    /// The nodes within a shape or nearer to it than `margin` (m), which may be zero: then nodes on the surface are among them as far as
    /// rounding allows.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the margin is finite and not negative.
    pub fn nodes_in(&self, shape: &(impl Shape<D> + ?Sized), margin: f64) -> Result<Vec<u32>, GeometryError> {
        Check("nodes in a shape").that(margin >= 0.0, "margin", margin, "zero or positive, and finite")?;
        Ok(self.nodes_where(|x| shape.signed_distance(x) <= margin))
    }

    /// The mesh with one node set more, or another one of this name.
    ///
    /// # Errors
    /// [`MeshError`] unless the nodes exist and ascend.
    pub fn with_node_set(mut self, name: &str, nodes: Vec<u32>) -> Result<Self, GeometryError> {
        self.node_sets.insert(name.into(), nodes);
        self.check_numbers()?;
        Ok(self)
    }

    /// Mean of the nodes of an element (m).
    ///
    /// # Panics
    /// If there is no such element, or it names a node that does not exist.
    pub(crate) fn centre(&self, block: usize, element: usize) -> [f64; D] {
        let block = &self.blocks[block];
        let count = block.kind.nodes();
        let nodes = &block.nodes[count * element..count * (element + 1)];
        let sum = |d: usize| nodes.iter().map(|&n| self.nodes[n as usize][d]).sum::<f64>();
        std::array::from_fn(|d| sum(d) / count as f64)
    }

    /// Lengths of edges.
    ///
    /// # Errors
    /// [`MeshError`] if there is no element, or one names a node that does not exist.
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
