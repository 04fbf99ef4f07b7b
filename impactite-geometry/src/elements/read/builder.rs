//! Mesh of a file while it is read: nodes by tag, elements in blocks and sets.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::super::split::tetrahedra;
use super::super::{ElementBlock, ElementKind, ElementMesh};
use crate::cursor::ReadError;
use crate::vector::{cross, dot, sub};

/// Nodes, blocks and sets. Positions are in space, whatever the dimensions of the mesh.
#[derive(Default)]
pub(super) struct Builder {
    positions: Vec<[f64; 3]>,
    tags: Vec<u64>,
    number: HashMap<u64, u32>,
    blocks: Vec<ElementBlock>,
    place: HashMap<(String, ElementKind), usize>,
    /// Block of the last element.
    last: usize,
    node_sets: BTreeMap<String, Vec<u32>>,
    element_sets: BTreeMap<String, Vec<Elements>>,
    /// Quadrilaterals of wedges and pyramids, nodes ascending.
    split_faces: HashSet<[u32; 4]>,
}

/// Form of an element of a file, by its corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Form {
    /// Element of the mesh.
    Whole(ElementKind),
    /// Triangle and the triangle opposite, on the side of the right-handed normal: read as three tetrahedra.
    Wedge,
    /// Quadrilateral and a tip on the side of the right-handed normal: read as two tetrahedra.
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

    /// Dimensions of the element itself.
    pub fn dimensions(self) -> usize {
        match self {
            Form::Whole(kind) => kind.dimensions(),
            Form::Wedge | Form::Pyramid => 3,
        }
    }

    /// Facets of a form that is split to tetrahedra, seen from outside counter-clockwise.
    fn facets(self) -> &'static [&'static [usize]] {
        match self {
            Form::Whole(_) => &[],
            Form::Wedge => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
            Form::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        }
    }
}

/// Elements of a block that represent one element of the file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Elements {
    block: u32,
    first: u32,
    count: u32,
}

/// Coordinates of a flat mesh that are rounding, over the largest.
const FLAT: f64 = 1e-9;
/// Most nodes of a file.
pub(super) const MOST: usize = u32::MAX as usize - 1;

impl Builder {
    /// Adds a node that elements name by its tag; `false` if there is one of this tag already, or no number left.
    pub fn add_node(&mut self, tag: u64, x: [f64; 3]) -> bool {
        let number = self.positions.len();
        if number >= MOST || self.number.insert(tag, number as u32).is_some() {
            return false;
        }
        self.push_node(tag, x);
        true
    }

    /// Adds a node whose tag may be that of another one, too.
    pub fn push_node(&mut self, tag: u64, x: [f64; 3]) {
        self.positions.push(x);
        self.tags.push(tag);
    }

    /// The number of the node with this tag.
    pub fn node(&self, tag: u64) -> Option<u32> {
        self.number.get(&tag).copied()
    }

    pub fn node_count(&self) -> usize {
        self.positions.len()
    }

    /// Adds an element to a block, named by block.
    ///
    /// # Errors
    /// A wedge or pyramid of which a tetrahedron is flat, or inverted against the others.
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

    /// Index of a block, which is added if there is none of this name and kind.
    fn block(&mut self, name: &str, kind: ElementKind) -> usize {
        let is = |block: &ElementBlock| block.name == name && block.kind == kind;
        // Most elements are of the block of the element before.
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

    /// Six times the volume of a tetrahedron.
    fn volume(&self, nodes: &[u32; 4]) -> f64 {
        let [a, b, c, d] = nodes.map(|n| self.positions[n as usize]);
        dot(cross(sub(b, a), sub(c, a)), sub(d, a))
    }

    /// Tags of nodes, for a message.
    fn named(&self, nodes: &[u32]) -> String {
        let tags: Vec<String> = nodes.iter().map(|&n| self.tags[n as usize].to_string()).collect();
        tags.join(", ")
    }

    /// Adds nodes to a set.
    pub fn add_to_node_set(&mut self, set: &str, nodes: impl IntoIterator<Item = u32>) {
        match self.node_sets.get_mut(set) {
            Some(set) => set.extend(nodes),
            None => {
                self.node_sets.insert(set.into(), nodes.into_iter().collect());
            }
        }
    }

    /// Adds elements to a set.
    pub fn add_to_element_set(&mut self, set: &str, elements: Elements) {
        match self.element_sets.get_mut(set) {
            Some(set) => set.push(elements),
            None => {
                self.element_sets.insert(set.into(), vec![elements]);
            }
        }
    }

    /// Refuses bricks at the quadrilaterals of wedges and pyramids, which are split.
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

    /// The mesh, coordinates multiplied by `unit`.
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
