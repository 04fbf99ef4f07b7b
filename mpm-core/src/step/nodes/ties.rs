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
    weight: T,
    /// Position relative to the dependent node, in its cells.
    offset: [T; 3],
}

/// Master node: others depend on it.
#[derive(Clone, Debug)]
struct Master<T> {
    node: u32,
    /// Its index among the dependent nodes, or [`FREE`].
    tie: u32,
    /// Start and end of its children.
    children: [u32; 2],
    /// Records of the node, and the affine part of its momentum, with those of its children.
    records: [[T; 4]; 2],
    affine: [[T; 4]; 3],
}

/// Child of a node: dependent node by its index, and its index among the parents of that.
#[derive(Clone, Copy, Debug)]
struct Child {
    tie: u32,
    parent: u32,
}

/// Dependent nodes of a level, and the nodes on which they depend.
#[derive(Clone, Copy, Debug)]
struct LevelEnds {
    ties: usize,
    masters: usize,
}

/// Dependent nodes of a grid, those of the finest level first.
#[derive(Clone, Debug)]
pub struct Ties<T> {
    ties: Vec<Tie<T>>,
    parents: Vec<Parent<T>>,
    /// Parents of each level, once each, with their children in order.
    masters: Vec<Master<T>>,
    children: Vec<Child>,
    ends: Vec<LevelEnds>,
    /// Index of each node among the parents of a level, in an arrangement.
    master_at: Vec<u32>,
}

impl<T> Default for Ties<T> {
    fn default() -> Self {
        let (ties, parents, masters) = (Vec::new(), Vec::new(), Vec::new());
        Ties { ties, parents, masters, children: Vec::new(), ends: Vec::new(), master_at: Vec::new() }
    }
}

impl<T: Float> Master<T> {
    /// Sum the records of the node and of its children, and the affine part of the momentum if it is mapped.
    fn gather<const D: usize>(
        &mut self,
        (ties, parents, children): (&[Tie<T>], &[Parent<T>], &[Child]),
        nodes: &[Node<T>],
        (sums, affine): (NodeSums, bool),
    ) {
        let node = &nodes[self.node as usize];
        let (mut one, mut two) = (node.first, node.second);
        let mut own = ties.get(self.tie as usize).map_or([[T::default(); 4]; 3], |tie| tie.affine);
        for child in &children[self.children[0] as usize..self.children[1] as usize] {
            let (tie, parent) = (&ties[child.tie as usize], &parents[child.parent as usize]);
            let from = &nodes[tie.node as usize];
            for c in 0..4 {
                if sums == NodeSums::All {
                    one[c] += parent.weight * from.first[c];
                }
                two[c] += parent.weight * from.second[c];
            }
            if !affine {
                continue;
            }
            let momentum = if sums == NodeSums::All { &mut one } else { &mut two };
            for d in 0..D {
                for c in 1..4 {
                    momentum[c] += parent.weight * tie.affine[d][c] * parent.offset[d];
                }
            }
            if self.tie != FREE {
                // Cells of the parent are twice as wide.
                for d in 0..D {
                    (1..4).for_each(|c| own[d][c] += T::of(2.0) * parent.weight * tie.affine[d][c]);
                }
            }
        }
        (self.records, self.affine) = ([one, two], own);
    }
}

impl<T: Float> Ties<T> {
    /// Find the dependent nodes and their parents, of which every body has its own.
    pub(super) fn arrange<const D: usize>(&mut self, grid: &dyn GridStorage<T, D>, fields: &Fields<D>) {
        self.ties.clear();
        self.parents.clear();
        self.ends.clear();
        self.masters.clear();
        self.children.clear();
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
                        self.parents.push(Parent { node: place as u32, weight, offset });
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
            let first = self.ends.last().map_or(0, |ends| ends.ties);
            self.arrange_masters(first);
            self.ends.push(LevelEnds { ties: self.ties.len(), masters: self.masters.len() });
        }
        // Parents on the coarsest level depend on no others.
        if levels.count() < 3 {
            return;
        }
        let places = self.ties.iter().enumerate().map(|(k, tie)| (tie.node, k as u32));
        let mut places: Vec<(u32, u32)> = places.collect();
        places.sort_unstable();
        for master in &mut self.masters {
            if let Ok(at) = places.binary_search_by_key(&master.node, |entry| entry.0) {
                master.tie = places[at].1;
            }
        }
    }

    /// List the parents of the dependent nodes of a level, which begin at `first`, with their children in the order of these.
    fn arrange_masters(&mut self, first: usize) {
        let Ties { ties, parents, masters, children, master_at, .. } = self;
        let (first_master, first_child) = (masters.len(), children.len());
        let of_ties = || {
            ties[first..].iter().enumerate().flat_map(|(k, tie)| {
                (tie.parents[0]..tie.parents[1]).map(move |parent| Child { tie: (first + k) as u32, parent })
            })
        };
        for child in of_ties() {
            let node = parents[child.parent as usize].node;
            if master_at.len() <= node as usize {
                master_at.resize(node as usize + 1, FREE);
            }
            let at = &mut master_at[node as usize];
            if *at == FREE {
                *at = masters.len() as u32;
                let (records, affine) = ([[T::default(); 4]; 2], [[T::default(); 4]; 3]);
                masters.push(Master { node, tie: FREE, children: [0; 2], records, affine });
            }
            masters[*at as usize].children[1] += 1;
        }
        let mut end = first_child as u32;
        for master in &mut masters[first_master..] {
            let count = master.children[1];
            master.children = [end; 2];
            end += count;
        }
        children.resize(end as usize, Child { tie: FREE, parent: FREE });
        for child in of_ties() {
            let node = parents[child.parent as usize].node;
            let [_, next] = &mut masters[master_at[node as usize] as usize].children;
            children[*next as usize] = child;
            *next += 1;
        }
        masters[first_master..].iter().for_each(|master| master_at[master.node as usize] = FREE);
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
        let (mut first, mut first_master) = (0, 0);
        for level in 0..self.ends.len() {
            let LevelEnds { ties: end, masters } = self.ends[level];
            let (ties, parents, children, known) = (&self.ties, &self.parents, &self.children, &*nodes);
            team.each(&mut self.masters[first_master..masters], |_, master| {
                master.gather::<D>((ties, parents, children), known, (sums, affine));
            });
            for tie in &self.ties[first..end] {
                let node = &mut nodes[tie.node as usize];
                if sums == NodeSums::All {
                    node.first = [T::default(); 4];
                }
                node.second = [T::default(); 4];
            }
            for master in &self.masters[first_master..masters] {
                let node = &mut nodes[master.node as usize];
                [node.first, node.second] = master.records;
                if let Some(tie) = self.ties.get_mut(master.tie as usize).filter(|_| affine) {
                    tie.affine = master.affine;
                }
            }
            (first, first_master) = (end, masters);
        }
    }

    /// Set the vectors of dependent nodes from those of their parents, those of coarser levels first.
    pub(in crate::step) fn extend(&mut self, nodes: &mut [Node<T>], team: &Team) {
        let Ties { ties, parents, ends, .. } = self;
        for level in (0..ends.len()).rev() {
            let start = level.checked_sub(1).map_or(0, |finer| ends[finer].ties);
            let ties = &mut ties[start..ends[level].ties];
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
        self.ties.capacity() * size_of::<Tie<T>>()
            + self.parents.capacity() * size_of::<Parent<T>>()
            + self.masters.capacity() * size_of::<Master<T>>()
            + self.children.capacity() * size_of::<Child>()
            + self.master_at.capacity() * size_of::<u32>()
    }
}
