//! A mesh as files have it: nodes by tag, elements in groups.

use std::collections::{BTreeMap, HashMap};

use super::super::{ElementBlock, ElementKind, ElementMesh};
use super::cursor::ReadError;

/// A mesh while its file is read. Positions in space, whatever the dimensions it is for.
#[derive(Default)]
pub(super) struct Builder {
    positions: Vec<[f64; 3]>,
    tags: Vec<u64>,
    number: HashMap<u64, u32>,
    blocks: Vec<ElementBlock>,
    place: HashMap<(String, ElementKind), usize>,
    sets: BTreeMap<String, Vec<u32>>,
}

/// Coordinates of a flat mesh that are rounding, over the largest.
const FLAT: f64 = 1e-9;
/// The most nodes of a file.
const MOST: usize = u32::MAX as usize - 1;

impl Builder {
    /// Takes a node; `false` if there is one of this tag already, or no number left.
    pub fn add_node(&mut self, tag: u64, x: [f64; 3]) -> bool {
        let number = self.positions.len();
        if number >= MOST || self.number.insert(tag, number as u32).is_some() {
            return false;
        }
        self.positions.push(x);
        self.tags.push(tag);
        true
    }

    /// The number of the node with this tag.
    pub fn node(&self, tag: u64) -> Option<u32> {
        self.number.get(&tag).copied()
    }

    /// Tags of the nodes in the order of the file.
    pub fn tags(&self) -> &[u64] {
        &self.tags
    }

    pub fn node_count(&self) -> usize {
        self.positions.len()
    }

    /// Takes an element of a block, named by block.
    pub fn add_element(&mut self, block: &str, kind: ElementKind, nodes: &[u32]) {
        let next = self.blocks.len();
        let place = *self.place.entry((block.into(), kind)).or_insert(next);
        if place == next {
            self.blocks.push(ElementBlock { name: block.into(), kind, nodes: Vec::new() });
        }
        self.blocks[place].nodes.extend_from_slice(nodes);
    }

    /// Takes nodes into a set.
    pub fn add_to_set(&mut self, set: &str, nodes: impl IntoIterator<Item = u32>) {
        match self.sets.get_mut(set) {
            Some(set) => set.extend(nodes),
            None => {
                self.sets.insert(set.into(), nodes.into_iter().collect());
            }
        }
    }

    /// The mesh, coordinates multiplied by `unit`.
    pub fn build<const D: usize>(self, unit: f64) -> Result<ElementMesh<D>, ReadError> {
        if self.blocks.is_empty() {
            let what = "the file has no element".into();
            return Err(ReadError::Whole { what, allowed: "one at least" });
        }
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
        let node_sets = self.sets.into_iter().map(|(name, mut nodes)| {
            nodes.sort_unstable();
            nodes.dedup();
            (name, nodes)
        });
        let node_sets = node_sets.collect();
        Ok(ElementMesh { nodes, blocks: self.blocks, node_sets })
    }
}
