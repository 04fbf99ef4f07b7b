//! Mesh under construction by a reader: nodes by tag, elements in blocks and sets.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::super::split::tetrahedra;
use super::super::{ElementBlock, ElementKind, ElementMesh};
use crate::cursor::ReadError;
use crate::vector::{cross, dot, sub};

/// Nodes, blocks and sets of a file. Positions have three coordinates, whatever the dimension of the mesh.
#[derive(Default)]
pub(super) struct Builder {
    positions: Vec<[f64; 3]>,
    tags: Vec<u64>,
    number: HashMap<u64, u32>,
    blocks: Vec<ElementBlock>,
    place: HashMap<(String, ElementKind), usize>,
    /// Block of the most recent element.
    last: usize,
    node_sets: BTreeMap<String, Vec<u32>>,
    element_sets: BTreeMap<String, Vec<Elements>>,
    /// Quadrilaterals of wedges and pyramids, nodes ascending. Such a face is split by a diagonal.
    split_faces: HashSet<[u32; 4]>,
}

/// Element shape in a file, by its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Form {
    /// Element type of the mesh, read unchanged.
    Whole(ElementKind),
    /// Triangle, and the opposite triangle on the side of the right-handed normal: read as three tetrahedra.
    Wedge,
    /// Quadrilateral, and a tip on the side of the right-handed normal: read as two tetrahedra.
    Pyramid,
}

impl Form {
    /// Number of corners.
    pub fn corners(self) -> usize {
        match self {
            Form::Whole(kind) => kind.nodes(),
            Form::Wedge => 6,
            Form::Pyramid => 5,
        }
    }

    /// Number of dimensions of the element itself.
    pub fn dimensions(self) -> usize {
        match self {
            Form::Whole(kind) => kind.dimensions(),
            Form::Wedge | Form::Pyramid => 3,
        }
    }

    /// Facets of a form that is split into tetrahedra, counter-clockwise from outside.
    fn facets(self) -> &'static [&'static [usize]] {
        match self {
            Form::Whole(_) => &[],
            Form::Wedge => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
            Form::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        }
    }
}

/// Range of elements of a block that represents one element of the file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Elements {
    block: u32,
    first: u32,
    count: u32,
}

/// Tolerance of the extra coordinates of a plane mesh, relative to the largest coordinate.
const FLAT: f64 = 1e-9;
/// Maximum number of nodes of a file.
pub(super) const MOST: usize = u32::MAX as usize - 1;

impl Builder {
    /// Add a node with a unique tag, by which elements refer to it; `false` if the tag exists already, or if there are too many nodes.
    pub fn add_node(&mut self, tag: u64, x: [f64; 3]) -> bool {
        let number = self.positions.len();
        if number >= MOST || self.number.insert(tag, number as u32).is_some() {
            return false;
        }
        self.push_node(tag, x);
        true
    }

    /// Add a node whose tag need not be unique.
    pub fn push_node(&mut self, tag: u64, x: [f64; 3]) {
        self.positions.push(x);
        self.tags.push(tag);
    }

    /// Return the index of the node with this tag.
    pub fn node(&self, tag: u64) -> Option<u32> {
        self.number.get(&tag).copied()
    }

    pub fn node_count(&self) -> usize {
        self.positions.len()
    }

    /// Add an element to the block of this name and kind.
    ///
    /// # Errors
    /// A wedge or pyramid with a flat tetrahedron, or with tetrahedra of opposite orientation.
    pub fn add_element(&mut self, block: &str, form: Form, nodes: &[u32]) -> Result<Elements, ReadError> {
        let kind = match form {
            Form::Whole(kind) => kind,
            Form::Wedge | Form::Pyramid => ElementKind::Tetra4,
        };
        let place = self.block(block, kind);
        let first = self.blocks[place].len() as u32;
        if let Form::Whole(_) = form {
            self.blocks[place].nodes.extend_from_slice(nodes);
        } else {
            let parts = tetrahedra(nodes, form.facets());
            let volumes: Vec<f64> = parts.iter().map(|part| self.volume(part)).collect();
            if !(volumes.iter().all(|v| *v > 0.0) || volumes.iter().all(|v| *v < 0.0)) {
                let what = format!("the wedge or pyramid of nodes {} is flat or folded", self.named(nodes));
                return Err(ReadError::Whole {
                    what,
                    allowed: "one whose tetrahedra have volumes of the same sign",
                });
            }
            self.blocks[place].nodes.extend(parts.as_flattened());
            for facet in form.facets() {
                if let [a, b, c, d] = facet[..] {
                    self.split_faces.insert(sorted([a, b, c, d].map(|place| nodes[place])));
                }
            }
        }
        let count = self.blocks[place].len() as u32 - first;
        Ok(Elements { block: place as u32, first, count })
    }

    /// Return the index of a block; add the block if there is none of this name and kind.
    fn block(&mut self, name: &str, kind: ElementKind) -> usize {
        let is = |block: &ElementBlock| block.name == name && block.kind == kind;
        // Consecutive elements mostly belong to the same block.
        if self.blocks.get(self.last).is_some_and(is) {
            return self.last;
        }
        let next = self.blocks.len();
        self.last = *self.place.entry((name.into(), kind)).or_insert(next);
        if self.last == next {
            self.blocks.push(ElementBlock { name: name.into(), kind, nodes: Vec::new() });
        }
        self.last
    }

    /// Return six times the volume of a tetrahedron.
    fn volume(&self, nodes: &[u32; 4]) -> f64 {
        let [a, b, c, d] = nodes.map(|n| self.positions[n as usize]);
        dot(cross(sub(b, a), sub(c, a)), sub(d, a))
    }

    /// List the tags of nodes for a message.
    fn named(&self, nodes: &[u32]) -> String {
        let tags: Vec<String> = nodes.iter().map(|&n| self.tags[n as usize].to_string()).collect();
        tags.join(", ")
    }

    /// Add nodes to a set.
    pub fn add_to_node_set(&mut self, set: &str, nodes: impl IntoIterator<Item = u32>) {
        match self.node_sets.get_mut(set) {
            Some(set) => set.extend(nodes),
            None => {
                self.node_sets.insert(set.into(), nodes.into_iter().collect());
            }
        }
    }

    /// Add elements to a set.
    pub fn add_to_element_set(&mut self, set: &str, elements: Elements) {
        match self.element_sets.get_mut(set) {
            Some(set) => set.push(elements),
            None => {
                self.element_sets.insert(set.into(), vec![elements]);
            }
        }
    }

    /// Check for bricks at the quadrilaterals of wedges and pyramids, which are split by a diagonal.
    fn check_split_faces(&self) -> Result<(), ReadError> {
        if self.split_faces.is_empty() {
            return Ok(());
        }
        for block in self.blocks.iter().filter(|b| b.kind == ElementKind::Hexa8) {
            for nodes in block.elements() {
                for facet in block.kind.facets() {
                    let face = [0, 1, 2, 3].map(|i| nodes[facet[i]]);
                    if self.split_faces.contains(&sorted(face)) {
                        let what = format!(
                            "a brick and a wedge or pyramid share the face of nodes {}; wedges and pyramids are split to tetrahedra, whose \
                             faces are triangles",
                            self.named(&face)
                        );
                        return Err(ReadError::Whole {
                            what,
                            allowed: "bricks alone, or wedges, pyramids and tetrahedra",
                        });
                    }
                }
            }
        }
        Ok(())
    }

    /// Build the mesh, with coordinates multiplied by `unit`.
    pub fn build<const D: usize>(self, unit: f64) -> Result<ElementMesh<D>, ReadError> {
        if self.blocks.is_empty() {
            let what = "the file has no element".into();
            return Err(ReadError::Whole { what, allowed: "one at least" });
        }
        self.check_split_faces()?;
        let mut nodes = Vec::with_capacity(self.positions.len());
        let within = self.positions.iter().flat_map(|x| &x[..D]);
        let size = within.fold(0.0, |size: f64, c| size.max(c.abs()));
        for (tag, x) in self.tags.iter().zip(&self.positions) {
            if let Some(extra) = x.iter().skip(D).find(|c| c.abs() > FLAT * size) {
                let what = format!("node {tag} at {x:?} has a coordinate {extra} beyond the {D} of the mesh");
                return Err(ReadError::Whole { what, allowed: "0, to rounding" });
            }
            nodes.push(std::array::from_fn(|d| x[d] * unit));
        }
        let ascending = |(name, mut numbers): (String, Vec<u32>)| {
            numbers.sort_unstable();
            numbers.dedup();
            (name, numbers)
        };
        let mut elements = 0;
        let first: Vec<u32> = self
            .blocks
            .iter()
            .map(|block| {
                elements += block.len() as u32;
                elements - block.len() as u32
            })
            .collect();
        let numbers = |set: Vec<Elements>| -> Vec<u32> {
            let range = |e: &Elements| (first[e.block as usize] + e.first, e.count);
            set.iter().map(range).flat_map(|(first, count)| first..first + count).collect()
        };
        let element_sets = self.element_sets.into_iter().map(|(name, set)| ascending((name, numbers(set))));
        Ok(ElementMesh {
            nodes,
            element_sets: element_sets.collect(),
            blocks: self.blocks,
            node_sets: self.node_sets.into_iter().map(ascending).collect(),
        })
    }
}

fn sorted(mut face: [u32; 4]) -> [u32; 4] {
    face.sort_unstable();
    face
}
