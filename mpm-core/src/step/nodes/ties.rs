//! Dependent nodes at the borders of levels of cells: u_j = sum_i C_ji u_i.
//!
//! Sums of a dependent node j belong to its parents i, by the same coefficients: mass, momentum and force are conserved. Affine
//! transfers map the velocity field of each particle at the positions of the nodes, which are the Greville points of their
//! functions. The momentum of a dependent node is that of the field at x_j; its parents receive that at x_i,
//!
//! p_i += C_ji (p_j + sum_p n_j(x_p) m_p B_p (x_i - x_j))
//!
//! so that a linear velocity field is reproduced exactly. The correction has no sum: C reproduces linear functions.

use super::fields::Fields;
use super::layout::{NodeSums, numbers};
use crate::grid::levels::unpack_block;
use crate::grid::{GridStorage, Node};
use crate::step::bodies::body::GridBody;
use impactite_simd::{Float, Team};

/// Index of a node that depends on no other.
const FREE: u32 = u32::MAX;

/// Dependent node.
#[derive(Clone, Debug)]
struct Tie<T> {
    node: u32,
    /// Block of the node, and its number there.
    at: (u32, u8),
    /// Start and end of its parents.
    parents: [u32; 2],
    /// Vectors of the node.
    vectors: [[T; 4]; 2],
    /// Affine part of the momentum, by axis of the distance, kg m/s a cell.
    affine: [[T; 4]; 3],
}

/// Parent of a dependent node.
#[derive(Clone, Copy, Debug)]
struct Parent<T> {
    node: u32,
    /// Index of the parent among the dependent nodes, or [`FREE`].
    tie: u32,
    weight: T,
    /// Position relative to the dependent node, in its cells.
    offset: [T; 3],
}

/// Dependent nodes of a grid, those of the finest level first.
#[derive(Clone, Debug)]
pub struct Ties<T> {
    ties: Vec<Tie<T>>,
    parents: Vec<Parent<T>>,
    /// End of the dependent nodes of each level.
    ends: Vec<usize>,
}

impl<T> Default for Ties<T> {
    fn default() -> Self {
        Ties { ties: Vec::new(), parents: Vec::new(), ends: Vec::new() }
    }
}

impl<T: Float> Ties<T> {
    /// Find the dependent nodes and their parents, of which every body has its own.
    pub(super) fn arrange<const D: usize>(&mut self, grid: &dyn GridStorage<T, D>, fields: &Fields<D>) {
        self.ties.clear();
        self.parents.clear();
        self.ends.clear();
        let Some(levels) = fields.levels() else { return };
        let layout = fields.layout();
        for level in (1..levels.count()).rev() {
            for (block, coordinates) in fields.coordinates().iter().enumerate() {
                let (at, coordinates) = unpack_block(coordinates);
                if at != level {
                    continue;
                }
                let Some(border) = levels.border_at(level, &coordinates) else { continue };
                let owner = fields.owner(block);
                let blocks = border.blocks.iter().map(|(at, _)| fields.find(grid, at, owner));
                let blocks: Vec<Option<usize>> = blocks.collect();
                let kept = layout.kept(block);
                let mut from = 0;
                for (n, &end) in numbers(border.nodes).zip(&border.ends) {
                    let parents = &border.parents[from as usize..end as usize];
                    from = end;
                    let Some(place) = layout.place(block, n).filter(|_| kept >> n & 1 != 0) else { continue };
                    let start = self.parents.len() as u32;
                    for parent in parents {
                        let of = blocks[usize::from(parent.block)];
                        let found = of.and_then(|block| layout.place(block, usize::from(parent.within)));
                        let Some(place) = found else { continue };
                        let mut offset = [T::default(); 3];
                        (0..D).for_each(|d| offset[d] = T::of(parent.offset[d]));
                        let weight = T::of(parent.weight);
                        self.parents.push(Parent { node: place as u32, tie: FREE, weight, offset });
                    }
                    self.ties.push(Tie {
                        node: place as u32,
                        at: (block as u32, n as u8),
                        parents: [start, self.parents.len() as u32],
                        vectors: [[T::default(); 4]; 2],
                        affine: [[T::default(); 4]; 3],
                    });
                }
            }
            self.ends.push(self.ties.len());
        }
        // Parents on the coarsest level depend on no others.
        if levels.count() < 3 {
            return;
        }
        let mut places: Vec<(u32, u32)> =
            self.ties.iter().enumerate().map(|(k, t)| (t.node, k as u32)).collect();
        places.sort_unstable();
        for parent in &mut self.parents {
            if let Ok(at) = places.binary_search_by_key(&parent.node, |entry| entry.0) {
                parent.tie = places[at].1;
            }
        }
    }

    /// True if no node depends on others.
    pub(super) fn is_empty(&self) -> bool {
        self.ties.is_empty()
    }

    /// Move the sums of dependent nodes to their parents.
    pub(in crate::step) fn fold<const D: usize>(
        &mut self,
        nodes: &mut [Node<T>],
        sums: NodeSums,
        bodies: &[Box<dyn GridBody<T, D>>],
        fields: &Fields<D>,
        team: &Team,
    ) {
        let affine = matches!(sums, NodeSums::All | NodeSums::Again);
        if affine {
            team.each(&mut self.ties, |_, tie| {
                tie.affine = [[T::default(); 4]; 3];
                for giver in fields.givers(tie.at.0 as usize) {
                    let presence = bodies[giver.body as usize].presence();
                    presence.add_affine(giver.local as usize, usize::from(tie.at.1), &mut tie.affine);
                }
            });
        }
        for k in 0..self.ties.len() {
            let Tie { node, parents: [first, end], affine: own, .. } = self.ties[k];
            let from = &mut nodes[node as usize];
            let second = std::mem::take(&mut from.second);
            let record = match sums {
                NodeSums::All => std::mem::take(&mut from.first),
                _ => [T::default(); 4],
            };
            for parent in &self.parents[first as usize..end as usize] {
                let to = &mut nodes[parent.node as usize];
                for c in 0..4 {
                    to.first[c] += parent.weight * record[c];
                    to.second[c] += parent.weight * second[c];
                }
                if !affine {
                    continue;
                }
                let momentum = if sums == NodeSums::All { &mut to.first } else { &mut to.second };
                for d in 0..D {
                    for c in 1..4 {
                        momentum[c] += parent.weight * own[d][c] * parent.offset[d];
                    }
                }
                if let Some(tie) = self.ties.get_mut(parent.tie as usize) {
                    // Cells of the parent are twice as wide.
                    for d in 0..D {
                        (1..4).for_each(|c| tie.affine[d][c] += T::of(2.0) * parent.weight * own[d][c]);
                    }
                }
            }
        }
    }

    /// Set the vectors of dependent nodes from those of their parents, those of coarser levels first.
    pub(in crate::step) fn extend(&mut self, nodes: &mut [Node<T>], team: &Team) {
        let Ties { ties, parents, ends } = self;
        for level in (0..ends.len()).rev() {
            let start = level.checked_sub(1).map_or(0, |finer| ends[finer]);
            let ties = &mut ties[start..ends[level]];
            let known = &*nodes;
            team.each(ties, |_, tie| {
                let (mut one, mut two) = ([T::default(); 4], [T::default(); 4]);
                for parent in &parents[tie.parents[0] as usize..tie.parents[1] as usize] {
                    let from = &known[parent.node as usize];
                    for c in 1..4 {
                        one[c] += parent.weight * from.first[c];
                        two[c] += parent.weight * from.second[c];
                    }
                }
                tie.vectors = [one, two];
            });
            // The mass is that of the parents.
            for tie in ties {
                [nodes[tie.node as usize].first, nodes[tie.node as usize].second] = tie.vectors;
            }
        }
    }

    /// Allocated memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        self.ties.capacity() * size_of::<Tie<T>>() + self.parents.capacity() * size_of::<Parent<T>>()
    }
}
