//! Surface extraction.

use super::{ElementMesh, Facet, MeshError};
use crate::error::GeometryError;

/// Facets sorted by their smallest node.
struct ByNode {
    facets: Vec<Facet>,
    /// Offsets of the facets of each node in `order`, and the total number.
    starts: Vec<u32>,
    /// Indices of facets.
    order: Vec<u32>,
}

impl ByNode {
    /// Sort by counting: linear in the number of facets, and stable, so that facets of a node stay in the order of elements.
    fn new(facets: Vec<Facet>, nodes: usize) -> Self {
        let mut starts = vec![0u32; nodes + 1];
        for facet in &facets {
            starts[smallest(facet) + 1] += 1;
        }
        for n in 0..nodes {
            starts[n + 1] += starts[n];
        }
        let mut next = starts.clone();
        let mut order = vec![0; facets.len()];
        for (number, facet) in (0u32..).zip(&facets) {
            let place = &mut next[smallest(facet)];
            order[*place as usize] = number;
            *place += 1;
        }
        Self { facets, starts, order }
    }

    /// Mark the facets that belong to one element only.
    fn single(&self) -> Result<Vec<bool>, MeshError> {
        let mut single = vec![true; self.facets.len()];
        for range in self.starts.windows(2) {
            let bucket = &self.order[range[0] as usize..range[1] as usize];
            for (i, &a) in bucket.iter().enumerate() {
                let mine = &self.facets[a as usize];
                for &b in &bucket[..i] {
                    let other = &self.facets[b as usize];
                    if !same_nodes(mine, other) {
                        continue;
                    }
                    if !single[b as usize] || !single[a as usize] || !opposite(mine.nodes(), other.nodes()) {
                        return Err(self.refuse(bucket, other, mine));
                    }
                    (single[a as usize], single[b as usize]) = (false, false);
                }
            }
        }
        Ok(single)
    }

    fn refuse(&self, bucket: &[u32], first: &Facet, second: &Facet) -> MeshError {
        MeshError::Facet {
            nodes: first.nodes().to_vec(),
            count: bucket.iter().filter(|&&f| same_nodes(first, &self.facets[f as usize])).count(),
            first: (first.block, first.element),
            second: (second.block, second.element),
        }
    }
}

fn smallest(facet: &Facet) -> usize {
    facet.nodes().iter().fold(u32::MAX, |m, &n| m.min(n)) as usize
}

fn same_nodes(a: &Facet, b: &Facet) -> bool {
    let sorted = |f: &Facet| {
        let mut nodes = f.nodes;
        nodes.sort_unstable();
        nodes
    };
    sorted(a) == sorted(b)
}

/// True if two facets of the same nodes run through them in opposite directions.
fn opposite(a: &[u32], b: &[u32]) -> bool {
    let count = a.len();
    if count < 3 {
        return a.first() == b.last();
    }
    let Some(shift) = b.iter().position(|&n| n == a[0]) else { return false };
    (0..count).all(|i| a[i] == b[(shift + count - i) % count])
}

impl<const D: usize> ElementMesh<D> {
    /// Return the facets that belong to one element only, in the order of their elements: edges in the plane, triangles and quadrilaterals
    /// in space. Elements of fewer dimensions than space (bars, shells) have no facets.
    ///
    /// Two elements share a facet only if it has the same nodes in both: weld meshes that merely touch. Non-conforming neighbours (a brick
    /// beside two tetrahedra, a hanging node) leave both facets in the surface.
    ///
    /// # Errors
    /// [`MeshError`] if a facet belongs to three elements or to two on the same side of it, or an element refers to a missing node.
    pub fn surface(&self) -> Result<Vec<Facet>, GeometryError> {
        self.surface_of(&|_, _| true)
    }

    /// Return the surface of the elements for which `alive(block, element)` is true, as if the others did not exist.
    ///
    /// # Errors
    /// Errors of [`surface`](Self::surface).
    pub fn surface_of(&self, alive: &dyn Fn(usize, usize) -> bool) -> Result<Vec<Facet>, GeometryError> {
        self.check_numbers()?;
        let sorted = ByNode::new(self.facets(alive)?, self.nodes.len());
        let single = sorted.single()?;
        Ok(sorted.facets.into_iter().zip(single).filter_map(|(f, single)| single.then_some(f)).collect())
    }

    /// Facets of all elements that are alive.
    fn facets(&self, alive: &dyn Fn(usize, usize) -> bool) -> Result<Vec<Facet>, MeshError> {
        let solid = || self.blocks.iter().enumerate().filter(|(_, block)| block.kind.dimensions() == D);
        let count = solid().map(|(_, block)| block.len() * block.kind.facets().len()).sum();
        if count > u32::MAX as usize {
            return Err(MeshError::Count { what: "facets", count, allowed: u32::MAX });
        }
        let mut facets = Vec::with_capacity(count);
        for (b, block) in solid() {
            for (e, element) in block.elements().enumerate().filter(|(e, _)| alive(b, *e)) {
                for places in block.kind.facets() {
                    let mut nodes = [Facet::NONE; 4];
                    for (node, &place) in nodes.iter_mut().zip(*places) {
                        *node = element[place];
                    }
                    facets.push(Facet { nodes, block: b as u32, element: e as u32 });
                }
            }
        }
        Ok(facets)
    }
}
