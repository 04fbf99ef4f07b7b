//! Operations on meshes: mapping, joining, welding, selecting elements and extrusion.

use std::collections::BTreeMap;

use nalgebra::Rotation;

use super::check::repeated;
use super::{ElementBlock, ElementKind, ElementMesh, Facet, MeshError};
use crate::error::{Check, GeometryError};
use crate::search::{NeighbourSearch, Points, Reach, SortedCells};
use crate::transform::Rotated;
use crate::vector::{add, along, sub};

/// New number of a node that is removed.
const GONE: u32 = u32::MAX;

impl<const D: usize> ElementMesh<D> {
    /// Map the position of every node (m) by `place`.
    ///
    /// # Errors
    /// Errors of [`check`](Self::check): the map is not finite, or it folds, flattens or mirrors elements.
    pub fn mapped(mut self, place: impl Fn([f64; D]) -> [f64; D]) -> Result<Self, GeometryError> {
        for x in &mut self.nodes {
            *x = place(*x);
        }
        self.check()?;
        Ok(self)
    }

    /// Translate the mesh by `offset` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the offset is finite; errors of [`check`](Self::check).
    pub fn translated(self, offset: [f64; D]) -> Result<Self, GeometryError> {
        Check("translated").point("offset", offset)?;
        self.mapped(|x| add(x, offset))
    }

    /// Rotate the mesh about the point `pivot` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the rotation is orthogonal and finite and the pivot finite; errors of [`check`](Self::check).
    pub fn rotated(self, rotation: Rotation<f64, D>, pivot: [f64; D]) -> Result<Self, GeometryError> {
        let turn = Rotated::new((), rotation, pivot)?;
        self.mapped(|x| turn.to_world(x))
    }

    /// Scale the mesh by `factor` about the fixed point `pivot` (m).
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the factor is positive and both are finite; errors of [`check`](Self::check).
    pub fn scaled(self, factor: f64, pivot: [f64; D]) -> Result<Self, GeometryError> {
        let check = Check("scaled");
        check.positive("factor", factor)?;
        check.point("pivot", pivot)?;
        self.mapped(|x| along(pivot, factor, sub(x, pivot)))
    }

    /// Mirror the mesh in the plane where coordinate `axis` is `at` (m). Node orders are reversed to keep Jacobians positive.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless there is such an axis and `at` is finite; errors of [`check`](Self::check).
    pub fn mirrored(mut self, axis: usize, at: f64) -> Result<Self, GeometryError> {
        let check = Check("mirrored");
        check.that(axis < D, "axis", axis as f64, "less than the number of dimensions")?;
        check.that(true, "at", at, "finite")?;
        self.check_numbers()?;
        for block in &mut self.blocks {
            let kind = block.kind;
            block.nodes.chunks_exact_mut(kind.nodes()).for_each(|nodes| reverse(kind, nodes));
        }
        self.mapped(|mut x| {
            x[axis] = at - (x[axis] - at);
            x
        })
    }

    /// Join this mesh and another one: append the nodes and blocks of `other`, and merge sets of equal name. Coincident nodes
    /// stay separate: see [`welded`](Self::welded).
    ///
    /// # Errors
    /// [`MeshError`] if there are too many nodes or elements, or an index of a node that does not exist.
    pub fn joined(mut self, other: &Self) -> Result<Self, GeometryError> {
        self.check_numbers()?;
        other.check_numbers()?;
        let first = self.nodes.len();
        let allowed = u32::MAX - 1;
        let count = first + other.nodes.len();
        if count > allowed as usize {
            return Err(MeshError::Count { what: "nodes", count, allowed }.into());
        }
        let moved = |nodes: &[u32]| -> Vec<u32> { nodes.iter().map(|n| n + first as u32).collect() };
        let elements = self.elements();
        self.nodes.extend_from_slice(&other.nodes);
        self.blocks.extend(other.blocks.iter().map(|block| ElementBlock {
            name: block.name.clone(),
            kind: block.kind,
            nodes: moved(&block.nodes),
        }));
        for (name, nodes) in &other.node_sets {
            self.node_sets.entry(name.clone()).or_default().extend(moved(nodes));
        }
        if !(self.element_sets.is_empty() && other.element_sets.is_empty()) {
            let (what, count) = ("elements", elements + other.elements());
            if count > Facet::NONE as usize {
                return Err(MeshError::Count { what, count, allowed: Facet::NONE }.into());
            }
        }
        for (name, set) in &other.element_sets {
            let moved = set.iter().map(|e| e + elements as u32);
            self.element_sets.entry(name.clone()).or_default().extend(moved);
        }
        Ok(self)
    }

    /// Merge nodes within `tolerance` (m) of each other: each node is merged into the first kept node within the tolerance, so that
    /// no node moves farther than the tolerance.
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless the tolerance is finite and not negative, [`GeometryError::Search`] for positions that are not
    /// finite or too many neighbours within the tolerance, [`MeshError::RepeatedNode`] where the tolerance is so large that an element
    /// would collapse.
    pub fn welded(mut self, tolerance: f64) -> Result<Self, GeometryError> {
        Check("welded").that(tolerance >= 0.0, "tolerance", tolerance, "zero or positive, and finite")?;
        self.check_numbers()?;
        let points = Points::of_positions(&self.nodes)?;
        let team = impactite_simd::Team::one();
        let near = SortedCells::new(&points, Reach::uniform(tolerance))?.neighbours(&team)?;
        let mut goes: Vec<u32> = (0..self.nodes.len() as u32).collect();
        for node in 0..goes.len() {
            let stays = |other: &&u32| (**other as usize) < node && goes[**other as usize] == **other;
            if let Some(&other) = near.of(node).iter().find(stays) {
                goes[node] = other;
            }
        }
        let mut number = vec![GONE; goes.len()];
        for (new, node) in (0u32..).zip((0..goes.len()).filter(|&n| goes[n] as usize == n)) {
            number[node] = new;
        }
        let renumbered: Vec<u32> = goes.iter().map(|&n| number[n as usize]).collect();
        let mut node = 0;
        self.nodes.retain(|_| {
            node += 1;
            number[node - 1] != GONE
        });
        self.renumber(&renumbered);
        for (b, block) in self.blocks.iter().enumerate() {
            for (element, nodes) in block.elements().enumerate() {
                if let Some(&node) = repeated(nodes) {
                    let name = block.name.clone();
                    return Err(MeshError::RepeatedNode { block: b, name, element, node }.into());
                }
            }
        }
        Ok(self)
    }

    /// Renumber nodes; removed nodes are dropped from the sets.
    fn renumber(&mut self, number: &[u32]) {
        for node in self.blocks.iter_mut().flat_map(|b| &mut b.nodes) {
            *node = number[*node as usize];
        }
        for nodes in self.node_sets.values_mut() {
            *nodes = nodes.iter().map(|&n| number[n as usize]).filter(|&n| n != GONE).collect();
            nodes.sort_unstable();
            nodes.dedup();
        }
    }

    /// Extract the elements for which `keep(block, element)` is true, with their nodes. Blocks keep their indices, even if empty.
    ///
    /// # Errors
    /// [`MeshError`] if an element refers to a node that does not exist.
    pub fn part(&self, keep: &dyn Fn(usize, usize) -> bool) -> Result<Self, GeometryError> {
        self.check_numbers()?;
        let blocks = self.blocks.iter().enumerate().map(|(b, block)| ElementBlock {
            name: block.name.clone(),
            kind: block.kind,
            nodes: {
                let kept = block.elements().enumerate().filter(|(e, _)| keep(b, *e));
                kept.flat_map(|(_, nodes)| nodes.iter().copied()).collect()
            },
        });
        let blocks = blocks.collect();
        let kept = |(b, block): (usize, &ElementBlock)| (0..block.len()).map(move |e| u32::from(keep(b, e)));
        let element_sets = match self.element_sets.is_empty() {
            true => BTreeMap::new(),
            false => {
                self.element_sets_after(&self.blocks.iter().enumerate().flat_map(kept).collect::<Vec<_>>())
            }
        };
        let part =
            Self { nodes: self.nodes.clone(), blocks, node_sets: self.node_sets.clone(), element_sets };
        Ok(part.without_unused_nodes())
    }

    /// Element sets after every element is replaced by `counts` elements at its position: none, itself, or its subdivision.
    pub(super) fn element_sets_after(&self, counts: &[u32]) -> BTreeMap<String, Vec<u32>> {
        let mut first = 0;
        let new: Vec<std::ops::Range<u32>> = counts
            .iter()
            .map(|count| {
                first += count;
                first - count..first
            })
            .collect();
        let renumbered = |set: &Vec<u32>| set.iter().flat_map(|&e| new[e as usize].clone()).collect();
        self.element_sets.iter().map(|(name, set)| (name.clone(), renumbered(set))).collect()
    }

    /// Remove nodes that belong to no element: they would have no mass. Node indices must be in range.
    pub(super) fn without_unused_nodes(mut self) -> Self {
        let mut number = vec![GONE; self.nodes.len()];
        for &node in self.blocks.iter().flat_map(|b| &b.nodes) {
            number[node as usize] = 0;
        }
        let mut kept = Vec::with_capacity(self.nodes.len());
        for (number, x) in number.iter_mut().zip(&self.nodes).filter(|(number, _)| **number != GONE) {
            *number = kept.len() as u32;
            kept.push(*x);
        }
        self.nodes = kept;
        self.renumber(&number);
        self
    }
}

impl ElementMesh<2> {
    /// Extrude the mesh along the third axis to bricks, with nodes at ascending `heights` (m). Sets extend through
    /// all heights; node sets `start` and `end` are added at the first and the last height.
    ///
    /// ```
    /// use impactite_geometry::{Metric, Ring, structured};
    /// let section = structured::ring_mesh(&Ring::new([0.0; 2], 0.01, 0.012)?, [2, 48])?;
    /// let tube = section.extruded(&[0.0, 0.002, 0.005, 0.01])?;
    /// assert_eq!(tube.elements(), 3 * 96);
    /// # Ok::<(), impactite_geometry::GeometryError>(())
    /// ```
    ///
    /// # Errors
    /// [`GeometryError::Parameter`] unless there are at least two heights, finite and ascending, [`MeshError`] for elements other than
    /// quadrilaterals or too many nodes, and errors of [`check`](Self::check).
    pub fn extruded(&self, heights: &[f64]) -> Result<ElementMesh<3>, GeometryError> {
        self.check_numbers()?;
        let check = Check("extruded");
        check.that(heights.len() > 1, "number of heights", heights.len() as f64, "at least 2")?;
        for pair in heights.windows(2) {
            check.that(true, "heights", pair[0], "finite")?;
            check.that(pair[1] > pair[0], "heights", pair[1], "larger than the one before, and finite")?;
        }
        let (flat, levels) = (self.nodes.len(), heights.len());
        crate::structured::room(flat as f64 * levels as f64, (self.elements() * levels) as f64, 8)?;
        let mut solid = ElementMesh::<3> {
            nodes: heights.iter().flat_map(|&z| self.nodes.iter().map(move |&[x, y]| [x, y, z])).collect(),
            ..Default::default()
        };
        let at = |level: usize, node: u32| (level * flat) as u32 + node;
        for (block, quads) in self.blocks.iter().enumerate() {
            if quads.kind != ElementKind::Quad4 {
                let (name, kind) = (quads.name.clone(), quads.kind);
                let (what, allowed) = ("to extrude a mesh", "quadrilaterals");
                return Err(MeshError::Kind { what, block, name, kind, allowed }.into());
            }
            let layer = |l: usize| quads.elements().flat_map(move |q| brick(q, |n| [at(l, n), at(l + 1, n)]));
            let nodes = (0..levels - 1).flat_map(layer).collect();
            solid.blocks.push(ElementBlock { name: quads.name.clone(), kind: ElementKind::Hexa8, nodes });
        }
        for (name, nodes) in &self.node_sets {
            let through = (0..levels).flat_map(|l| nodes.iter().map(move |&n| at(l, n))).collect();
            solid.node_sets.insert(name.clone(), through);
        }
        // Bricks of a block are numbered layer by layer; each layer keeps the order of the quadrilaterals.
        let layers = levels - 1;
        let mut numbers: Vec<[usize; 2]> = Vec::new();
        if !self.element_sets.is_empty() {
            let mut first = 0;
            for block in &self.blocks {
                numbers.extend((0..block.len()).map(|e| [first + e, block.len()]));
                first += layers * block.len();
            }
        }
        for (name, set) in &self.element_sets {
            let copies = |[first, stride]: [usize; 2]| (0..layers).map(move |l| (first + l * stride) as u32);
            let mut through: Vec<u32> = set.iter().flat_map(|&e| copies(numbers[e as usize])).collect();
            through.sort_unstable();
            solid.element_sets.insert(name.clone(), through);
        }
        for (name, level) in [("start", 0), ("end", levels - 1)] {
            solid.node_sets.insert(name.into(), (0..flat as u32).map(|n| at(level, n)).collect());
        }
        solid.check()?;
        Ok(solid)
    }
}

/// Return the brick between two copies of a quadrilateral.
fn brick(quad: &[u32], copies: impl Fn(u32) -> [u32; 2]) -> [u32; 8] {
    std::array::from_fn(|i| copies(quad[i % 4])[i / 4])
}

/// Reverse the node order of an element.
pub(super) fn reverse(kind: ElementKind, nodes: &mut [u32]) {
    let mut old = [0; super::reference::MOST_NODES];
    old[..nodes.len()].copy_from_slice(nodes);
    for (node, &place) in nodes.iter_mut().zip(kind.reversed()) {
        *node = old[place];
    }
}
