//! Validation of element meshes.

use super::reference::{Element, Reference};
use super::{ElementMesh, Facet, MeshError};
use crate::error::GeometryError;

/// Lower limit of the scaled Jacobian: corners below some 1e-7 degrees are flat to within rounding.
const FLAT: f64 = 1e-9;

impl<const D: usize> ElementMesh<D> {
    /// Check the mesh. Rejected are positions that are not finite; elements of more dimensions than space, with nodes that do not exist,
    /// with a repeated node, flat, inverted or with reversed node order; and sets that are not ascending or refer to
    /// nodes or elements that do not exist.
    ///
    /// An element of as many dimensions as space must have positive Jacobians at its corners, and a brick also at its eight Gauss points.
    /// An element of fewer dimensions (a bar in space) must not be flat.
    ///
    /// # Errors
    /// [`MeshError`] with block, element and the allowed values.
    pub fn check(&self) -> Result<(), GeometryError> {
        self.check_numbers()?;
        self.check_positions()?;
        for (b, block) in self.blocks.iter().enumerate() {
            let reference = Reference::new(block.kind);
            for (element, nodes) in block.elements().enumerate() {
                if let Some(&node) = repeated(nodes) {
                    let name = block.name.clone();
                    return Err(MeshError::RepeatedNode { block: b, name, element, node }.into());
                }
                let shape = reference.element(self, nodes);
                check_shape(&shape, nodes, |place, value| MeshError::Shape {
                    block: b,
                    name: block.name.clone(),
                    element,
                    kind: block.kind,
                    place,
                    value,
                    allowed: FLAT,
                })?;
            }
        }
        Ok(())
    }

    /// Check all counts and indices, a precondition of every method that uses indices.
    pub(super) fn check_numbers(&self) -> Result<(), MeshError> {
        let most = Facet::NONE - 1;
        let count = |what, count| {
            if count <= most as usize { Ok(()) } else { Err(MeshError::Count { what, count, allowed: most }) }
        };
        count("nodes", self.nodes.len())?;
        count("blocks", self.blocks.len())?;
        for (b, block) in self.blocks.iter().enumerate() {
            let (kind, name) = (block.kind, &block.name);
            if kind.dimensions() > D {
                return Err(MeshError::Dimensions { block: b, name: name.clone(), kind, space: D });
            }
            let numbers = block.nodes.len();
            if !numbers.is_multiple_of(kind.nodes()) {
                return Err(MeshError::BlockLength { block: b, name: name.clone(), kind, numbers });
            }
            count("elements of a block", block.len())?;
            if let Some(place) = block.nodes.iter().position(|&n| n as usize >= self.nodes.len()) {
                return Err(MeshError::NodeOutOfRange {
                    block: b,
                    name: name.clone(),
                    element: place / kind.nodes(),
                    node: block.nodes[place],
                    nodes: self.nodes.len(),
                });
            }
        }
        self.check_sets()
    }

    fn check_sets(&self) -> Result<(), MeshError> {
        for (set, numbers) in &self.node_sets {
            if let Some(&node) = numbers.iter().find(|&&n| n as usize >= self.nodes.len()) {
                return Err(MeshError::SetNode { set: set.clone(), node, nodes: self.nodes.len() });
            }
            if let Some(pair) = numbers.windows(2).find(|pair| pair[0] >= pair[1]) {
                return Err(MeshError::SetOrder { set: set.clone(), node: pair[1], before: pair[0] });
            }
        }
        let elements = self.elements();
        if !self.element_sets.is_empty() && elements > Facet::NONE as usize {
            return Err(MeshError::Count { what: "elements", count: elements, allowed: Facet::NONE });
        }
        for (set, numbers) in &self.element_sets {
            if let Some(&element) = numbers.iter().find(|&&n| n as usize >= elements) {
                return Err(MeshError::SetElement { set: set.clone(), element, elements });
            }
            if let Some(pair) = numbers.windows(2).find(|pair| pair[0] >= pair[1]) {
                let (element, before) = (pair[1], pair[0]);
                return Err(MeshError::ElementSetOrder { set: set.clone(), element, before });
            }
        }
        Ok(())
    }

    fn check_positions(&self) -> Result<(), MeshError> {
        for (node, x) in self.nodes.iter().enumerate() {
            if let Some(axis) = x.iter().position(|c| !c.is_finite()) {
                return Err(MeshError::Position { node, axis, value: x[axis] });
            }
        }
        Ok(())
    }
}

fn check_shape<const D: usize>(
    shape: &Element<D>,
    nodes: &[u32],
    refuse: impl Fn(String, f64) -> MeshError,
) -> Result<(), MeshError> {
    let flat = |value: f64| value.is_nan() || value <= FLAT;
    let mut corners = shape.corners().enumerate();
    if let Some((corner, j)) = corners.find(|(_, j)| flat(j.scaled)) {
        return Err(refuse(format!("at its node {} (corner {corner})", nodes[corner]), j.scaled));
    }
    match shape.within().find(|j| flat(j.scaled)) {
        Some(j) => Err(refuse("at a point of integration".into(), j.scaled)),
        None => Ok(()),
    }
}

/// Return a node that occurs twice in an element.
pub(super) fn repeated(nodes: &[u32]) -> Option<&u32> {
    nodes.iter().enumerate().find(|(i, n)| nodes[..*i].contains(n)).map(|(_, n)| n)
}
