//! Levels of cells: blocks of the background grid whose cells are halved, once or several times.
//!
//! The bins of a **refined** block belong to the next level, whose cells are half as wide. The particles of a level map to
//! the nodes of its lattice alone. A node whose support is not within the refined blocks is **dependent**: its value follows
//! from the nodes of the coarser level by the refinement relation of the shape function,
//!
//! u_j = sum_i C_ji u_i,   N_i(x) = sum_j C_ji n_j(x)
//!
//! so that the basis is the truncated hierarchical one (Giannelli, Juettler, Speleers 2012): a partition of unity that
//! reproduces linear fields. Mass, momentum and force of a dependent node belong to its parents, C^T.
//!
//! The blocks of all levels are stored in one grid. The level is part of the block's last coordinate ([`pack`]), so that
//! nothing that identifies a block by its coordinates knows of levels.

use std::collections::HashMap;
use std::sync::Arc;

use impactite_geometry::{Lattice, Seeds};

use crate::dim::{BLOCK, block_nodes, block_of, first_node, neighbours, node_of, offset, shifted};

/// Distance of the levels along the last axis, blocks and cells.
const APART: i32 = 1 << 26;
const CELLS_APART: i32 = APART * BLOCK as i32;
/// Largest number of refinements.
pub(crate) const MOST_LEVELS: usize = 7;
/// Largest distance of a block from the origin in a grid of several levels, blocks.
pub(crate) const FURTHEST_BLOCK: i32 = APART / 2 - 8;

/// Return the level of a block or cell, and its coordinates in the lattice of that level.
#[inline]
fn unpack<const D: usize>(mut at: [i32; D], apart: i32) -> (usize, [i32; D]) {
    let level = (at[D - 1] + apart / 2).div_euclid(apart);
    at[D - 1] -= level * apart;
    (level as usize, at)
}

/// Return the stored coordinates of a block of a level.
#[inline]
pub(crate) fn pack<const D: usize>(level: usize, mut block: [i32; D]) -> [i32; D] {
    block[D - 1] += level as i32 * APART;
    block
}

/// Return the level of a stored block, and its coordinates in the lattice of that level.
#[inline]
pub(crate) fn unpack_block<const D: usize>(block: &[i32; D]) -> (usize, [i32; D]) {
    unpack(*block, APART)
}

/// Return the stored index of a node of a level.
#[inline]
pub(crate) fn pack_node<const D: usize>(level: usize, mut node: [i32; D]) -> [i32; D] {
    node[D - 1] += level as i32 * CELLS_APART;
    node
}

/// Return the level of a stored node or bin, and its index in the lattice of that level.
#[inline]
pub(crate) fn unpack_node<const D: usize>(node: &[i32; D]) -> (usize, [i32; D]) {
    unpack(*node, CELLS_APART)
}

/// Lattices of the levels of a grid: that of a level has half the spacing of the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattices<const D: usize> {
    base: Lattice<D>,
    /// Offset of the origin of a level from that of the coarser one, in cells of the coarser one; none for one level.
    offset: Option<f64>,
}

impl<const D: usize> Lattices<D> {
    /// One level.
    pub(crate) fn one(base: Lattice<D>) -> Self {
        Lattices { base, offset: None }
    }
    /// Several levels, whose origins are this far from that of the coarser one, in its cells.
    pub(crate) fn several(base: Lattice<D>, offset: f64) -> Self {
        Lattices { base, offset: Some(offset) }
    }
    /// Lattice of the coarsest level.
    pub fn base(&self) -> &Lattice<D> {
        &self.base
    }
    /// Return the lattice of a level.
    pub fn of(&self, level: usize) -> Lattice<D> {
        let (mut origin, mut spacing) = (self.base.origin(), self.base.spacing());
        for _ in 0..level {
            let offset = spacing * self.offset.unwrap_or(0.0);
            origin = origin.map(|x| x + offset);
            spacing *= 0.5;
        }
        // The spacing of a valid lattice, halved a few times, is positive.
        Lattice::new(origin, spacing).unwrap_or(self.base)
    }
    /// Return the lattice of a stored node or bin, and its index there.
    #[inline]
    pub(crate) fn of_node(&self, node: &[i32; D]) -> (Lattice<D>, [i32; D]) {
        if self.offset.is_none() {
            return (self.base, *node);
        }
        let (level, node) = unpack_node(node);
        (if level == 0 { self.base } else { self.of(level) }, node)
    }
    /// Return the lattice of a stored block, and its coordinates there.
    #[inline]
    pub(crate) fn of_block(&self, block: &[i32; D]) -> (Lattice<D>, [i32; D]) {
        if self.offset.is_none() {
            return (self.base, *block);
        }
        let (level, block) = unpack_block(block);
        (if level == 0 { self.base } else { self.of(level) }, block)
    }
    /// Return the level of a stored block, and its coordinates there.
    #[inline]
    pub(crate) fn leveled(&self, block: &[i32; D]) -> (usize, [i32; D]) {
        if self.offset.is_none() { (0, *block) } else { unpack_block(block) }
    }
    /// Return the level of a stored block.
    #[inline]
    pub(crate) fn level(&self, block: &[i32; D]) -> usize {
        if self.offset.is_none() { 0 } else { unpack_block(block).0 }
    }
    /// Position of a stored node, m.
    pub(crate) fn position(&self, node: &[i32; D]) -> [f64; D] {
        let (lattice, node) = self.of_node(node);
        lattice.node(node.map(i64::from))
    }
    /// Return the node in front of a plane of base nodes in the lattice of a level, and true if the plane is between two
    /// nodes there.
    #[inline]
    pub(crate) fn node_at_plane(&self, level: usize, node: i32, sign: i32) -> (i32, bool) {
        if level == 0 {
            return (node, false);
        }
        if self.offset == Some(0.0) {
            return (node << level, false);
        }
        let behind = (node << level) + (1 << (level - 1)) - 1;
        (if sign > 0 { behind + 1 } else { behind }, true)
    }
}

/// Refinement relation of a shape function along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halving {
    /// Quadratic B-spline: 1/4, 3/4, 3/4, 1/4. Nodes are centres of knot spans, and those of the finer level are a quarter of a
    /// cell beside those of the coarser one.
    Quadratic,
    /// Cubic B-spline: 1/8, 4/8, 6/8, 4/8, 1/8. Every second node of the finer level is one of the coarser level.
    Cubic,
}

/// Offset of the origin of a level from that of the coarser one, in cells of the coarser one.
pub(crate) fn offset_of_levels(halving: Halving) -> f64 {
    match halving {
        Halving::Quadratic => -0.25,
        Halving::Cubic => 0.0,
    }
}

/// Parent of a dependent node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parent<const D: usize> {
    /// Index in the lattice of the coarser level.
    pub(crate) node: [i32; D],
    /// Coefficient C_ji.
    pub(crate) weight: f64,
    /// Position relative to the dependent node, in its cells.
    pub(crate) offset: [f64; D],
}

/// Refined blocks of a grid, and the levels of its particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Levels<const D: usize> {
    lattices: Lattices<D>,
    halving: Halving,
    /// Stencil nodes along an axis.
    nodes: i32,
    /// Refined blocks of each level but the finest, in its lattice, sorted.
    refined: Vec<Vec<[i32; D]>>,
    /// Dependent nodes of each level that its particles can reach, by block.
    borders: Vec<HashMap<[i32; D], Arc<Border<D>>>>,
}

/// Dependent nodes of a block and their parents.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Border<const D: usize> {
    /// Dependent nodes, one bit each.
    pub(crate) nodes: u64,
    /// Stored coordinates of the blocks of the parents, and the parents among their nodes, one bit each.
    pub(crate) blocks: Vec<([i32; D], u64)>,
    /// End of the parents of each dependent node, in order.
    pub(crate) ends: Vec<u32>,
    pub(crate) parents: Vec<ParentAt<D>>,
}

/// Parent of a dependent node, by its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParentAt<const D: usize> {
    /// Index of the block among those of the border.
    pub(crate) block: u8,
    /// Number of the node in the block.
    pub(crate) within: u8,
    /// Coefficient C_ji.
    pub(crate) weight: f64,
    /// Position relative to the dependent node, in its cells.
    pub(crate) offset: [f64; D],
}

/// Particle in a block whose level differs from its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Crossing {
    /// The block is refined.
    Finer,
    /// The block is not within the refined blocks of the coarser level.
    Coarser,
}

impl<const D: usize> Levels<D> {
    /// Create levels with these refined blocks, and extend them so that the blocks around a refined block are of its level.
    pub(crate) fn new(
        base: Lattice<D>,
        (halving, nodes): (Halving, usize),
        refined: Vec<Vec<[i32; D]>>,
    ) -> Self {
        let lattices = Lattices::several(base, offset_of_levels(halving));
        let nodes = nodes as i32;
        let one = Levels { lattices, halving, nodes, refined: Vec::new(), borders: vec![HashMap::new()] };
        one.grown(refined)
    }

    /// Return the levels with these refined blocks, the present ones among them, extended as in [`Levels::new`].
    fn grown(&self, mut refined: Vec<Vec<[i32; D]>>) -> Self {
        for level in (0..refined.len()).rev() {
            refined[level].sort_unstable();
            refined[level].dedup();
            if level > 0 {
                // A block of the level around every refined one: the stencils of two borders do not meet.
                let around: Vec<[i32; D]> = refined[level]
                    .iter()
                    .flat_map(|block| (0..neighbours(D)).map(move |n| shifted(block, &offset(n))))
                    .map(|block| block.map(|b| b.div_euclid(2)))
                    .collect();
                refined[level - 1].extend(around);
            }
        }
        while refined.last().is_some_and(Vec::is_empty) {
            refined.pop();
        }
        let mut levels = Levels { refined, borders: self.borders.clone(), ..*self };
        levels.borders.resize_with(levels.count(), HashMap::new);
        for level in 1..levels.count() {
            let known = self.refined.get(level - 1).map_or(&[][..], Vec::as_slice);
            levels.update_borders(level, known);
        }
        levels
    }

    /// Find the dependent nodes of a level in and around those refined blocks that are not `known`.
    fn update_borders(&mut self, level: usize, known: &[[i32; D]]) {
        let added = self.refined[level - 1].iter().filter(|block| known.binary_search(block).is_err());
        // Blocks from whose bins particles reach the nodes of others.
        let around = added.flat_map(|refined| {
            (0..4usize.pow(D as u32)).map(move |n| {
                let mut rest = n;
                std::array::from_fn(|d| {
                    let at = 2 * refined[d] - 1 + (rest % 4) as i32;
                    rest /= 4;
                    at
                })
            })
        });
        let mut around: Vec<[i32; D]> = around.collect();
        around.sort_unstable();
        around.dedup();
        for block in around {
            let border = self.border(level, &block);
            if border.nodes == 0 {
                self.borders[level].remove(&block);
            } else {
                self.borders[level].insert(block, Arc::new(border));
            }
        }
    }

    /// Return the dependent nodes of a block of a level, and their parents.
    fn border(&self, level: usize, block: &[i32; D]) -> Border<D> {
        let mut border = Border { nodes: 0, blocks: Vec::new(), ends: Vec::new(), parents: Vec::new() };
        border.nodes = self.nodes_beyond(level, block);
        for n in (0..block_nodes(D)).filter(|n| border.nodes >> n & 1 != 0) {
            let node = node_of(block, n);
            self.parents(&node, &mut |parent| {
                let (at, within) = block_of(&parent.node);
                let at = pack(level - 1, at);
                let known = border.blocks.iter().position(|known| known.0 == at);
                let number = known.unwrap_or_else(|| {
                    border.blocks.push((at, 0));
                    border.blocks.len() - 1
                });
                border.blocks[number].1 |= 1 << within;
                let Parent { weight, offset, .. } = parent;
                border.parents.push(ParentAt { block: number as u8, within: within as u8, weight, offset });
            });
            border.ends.push(border.parents.len() as u32);
        }
        border
    }

    /// Return the levels of other refined blocks.
    pub(crate) fn with_refined(&self, refined: Vec<Vec<[i32; D]>>) -> Self {
        Levels::new(self.lattices.base, (self.halving, self.nodes as usize), refined)
    }
    /// Return the levels in which these blocks, each with its level, are refined, too; none if all of them are.
    pub(crate) fn refined_also(&self, blocks: impl Iterator<Item = (usize, [i32; D])>) -> Option<Self> {
        let mut refined = self.refined.clone();
        let mut any = false;
        for (level, block) in blocks.filter(|(level, block)| !self.is_refined(*level, block)) {
            refined.resize_with(refined.len().max(level + 1), Vec::new);
            refined[level].push(block);
            any = true;
        }
        any.then(|| self.grown(refined))
    }

    /// Lattices of the levels.
    pub fn lattices(&self) -> Lattices<D> {
        self.lattices
    }
    /// Number of levels.
    pub fn count(&self) -> usize {
        self.refined.len() + 1
    }
    /// Refined blocks of each level but the finest.
    pub fn refined(&self) -> &[Vec<[i32; D]>] {
        &self.refined
    }
    /// True if a block of a level is refined.
    pub(crate) fn is_refined(&self, level: usize, block: &[i32; D]) -> bool {
        self.refined.get(level).is_some_and(|blocks| blocks.binary_search(block).is_ok())
    }
    /// Return the change of level of a particle that enters a block of a level, if any.
    pub(crate) fn crossing(&self, level: usize, block: &[i32; D]) -> Option<Crossing> {
        if self.is_refined(level, block) {
            return Some(Crossing::Finer);
        }
        let coarser = block.map(|b| b.div_euclid(2));
        (level > 0 && !self.is_refined(level - 1, &coarser)).then_some(Crossing::Coarser)
    }
    /// Return the level of a position (m), which is in the bin centred `centre` cells from a node.
    pub(crate) fn level_at(&self, x: &[f64; D], centre: f64) -> usize {
        let mut level = 0;
        while level < self.refined.len() {
            let lattice = self.lattices.of(level);
            let block = std::array::from_fn(|d| {
                let u = (x[d] - lattice.origin()[d]) / lattice.spacing() - centre;
                ((u + 0.5).floor() as i32).div_euclid(BLOCK as i32)
            });
            if !self.is_refined(level, &block) {
                break;
            }
            level += 1;
        }
        level
    }
    /// Return the dependent nodes of a block of a level with their parents, if there are any.
    pub(crate) fn border_at(&self, level: usize, block: &[i32; D]) -> Option<&Border<D>> {
        self.borders.get(level)?.get(block).map(|border| &**border)
    }
    /// Return the dependent nodes of a block of a level, one bit each.
    pub(crate) fn dependent(&self, level: usize, block: &[i32; D]) -> u64 {
        self.border_at(level, block).map_or(0, |border| border.nodes)
    }
    /// Return true if a node of a level is dependent.
    pub(crate) fn is_dependent(&self, level: usize, node: &[i32; D]) -> bool {
        let (block, within) = block_of(node);
        self.dependent(level, &block) >> within & 1 != 0
    }
    /// Return the nodes of a block of a level whose support is not within the refined blocks of the coarser level, one bit each.
    fn nodes_beyond(&self, level: usize, block: &[i32; D]) -> u64 {
        // Refined blocks around that of this block, which contain the supports of its nodes.
        let middle = block.map(|b| b.div_euclid(2));
        let refined = (0..neighbours(D))
            .filter(|&n| self.is_refined(level - 1, &shifted(&middle, &offset(n))))
            .fold(0u32, |refined, n| refined | 1 << n);
        if refined.count_ones() as usize == neighbours(D) {
            return 0;
        }
        // The two ends of the support of a node along an axis, by its place in the block: 0, 1, 2 for the blocks around.
        let ends = |d: usize, within: usize| {
            let node = BLOCK as i32 * block[d] + within as i32;
            let last = node - first_node(self.nodes as usize);
            [last - self.nodes + 1, last].map(|bin| bin.div_euclid(2 * BLOCK as i32) - middle[d] + 1)
        };
        let ends: [[[i32; 2]; BLOCK]; D] =
            std::array::from_fn(|d| std::array::from_fn(|within| ends(d, within)));
        let leaves = |n: &usize| {
            (0..1 << D).any(|corner: usize| {
                let (mut at, mut stride, mut rest) = (0, 1, *n);
                for (d, ends) in ends.iter().enumerate() {
                    at += ends[rest % BLOCK][corner >> d & 1] * stride;
                    (stride, rest) = (3 * stride, rest / BLOCK);
                }
                refined >> at & 1 == 0
            })
        };
        (0..block_nodes(D)).filter(leaves).fold(0, |nodes, n| nodes | 1 << n)
    }
    /// Return the bins of a block of a level from which particles reach a dependent node, one bit each.
    pub(crate) fn bins_at_border(&self, level: usize, block: &[i32; D]) -> u64 {
        let none = |n: usize| self.dependent(level, &shifted(block, &offset(n))) == 0;
        if level == 0 || (0..neighbours(D)).all(none) {
            return 0;
        }
        let reaches = |bin: &usize| {
            let first = node_of(block, *bin).map(|b| b + first_node(self.nodes as usize));
            (0..self.nodes.pow(D as u32)).any(|n| {
                let mut rest = n;
                let node = std::array::from_fn(|d| {
                    let at = first[d] + rest % self.nodes;
                    rest /= self.nodes;
                    at
                });
                self.is_dependent(level, &node)
            })
        };
        (0..block_nodes(D)).filter(reaches).fold(0, |bins, bin| bins | 1 << bin)
    }
    /// Call `visit` for every parent of a node of a level.
    pub(crate) fn parents(&self, node: &[i32; D], visit: &mut dyn FnMut(Parent<D>)) {
        // Node, coefficient and position relative to the dependent node in its cells, along an axis.
        let along = |j: i32| -> ([(i32, f64, f64); 3], usize) {
            let (k, odd, none) = (j.div_euclid(2), j.rem_euclid(2) == 1, (0, 0.0, 0.0));
            match (self.halving, odd) {
                (Halving::Quadratic, false) => ([(k, 0.75, 0.5), (k - 1, 0.25, -1.5), none], 2),
                (Halving::Quadratic, true) => ([(k, 0.75, -0.5), (k + 1, 0.25, 1.5), none], 2),
                (Halving::Cubic, false) => ([(k, 0.75, 0.0), (k - 1, 0.125, -2.0), (k + 1, 0.125, 2.0)], 3),
                (Halving::Cubic, true) => ([(k, 0.5, -1.0), (k + 1, 0.5, 1.0), none], 2),
            }
        };
        let axes = node.map(along);
        let count: usize = axes.iter().map(|axis| axis.1).product();
        for n in 0..count {
            let mut parent = Parent { node: [0; D], weight: 1.0, offset: [0.0; D] };
            let mut rest = n;
            for d in 0..D {
                let (list, several) = &axes[d];
                let (node, weight, offset) = list[rest % several];
                rest /= several;
                parent.node[d] = node;
                parent.weight *= weight;
                parent.offset[d] = offset;
            }
            visit(parent);
        }
    }

    /// Select the particles of a shape from those of the lattice of each level. The volumes add up to that of the particles on
    /// the coarsest level.
    pub(crate) fn select(&self, all: &[Seeds<D>]) -> Seeds<D> {
        let centre = crate::dim::centre(self.nodes as usize);
        let (mut positions, mut volumes) = (Vec::new(), Vec::new());
        for (level, seeds) in all.iter().enumerate() {
            let coarser = level.checked_sub(1).map(|coarser| Near::of(&all[coarser]));
            for (x, volume) in seeds.positions.iter().zip(&seeds.volumes) {
                // The parts of a particle of larger cells are of one level: no gap opens at a border.
                let whole = coarser.as_ref().map(|near| near.nearest(x).unwrap_or(*x));
                let due = whole.map_or(0, |x| self.level_at(&x, centre));
                if due >= level && self.level_at(x, centre) <= level {
                    positions.push(*x);
                    volumes.push(*volume);
                }
            }
        }
        let (measure, half_size) =
            all.first().map_or((0.0, [0.0; D]), |seeds| (seeds.volumes.iter().sum::<f64>(), seeds.half_size));
        let sum: f64 = volumes.iter().sum();
        if sum > 0.0 && sum != measure {
            volumes.iter_mut().for_each(|volume| *volume *= measure / sum);
        }
        Seeds::placed(positions, volumes, half_size)
    }
}

/// Search for the particle nearest to a position.
struct Near<'a, const D: usize> {
    seeds: &'a Seeds<D>,
    spacing: f64,
    cells: HashMap<[i64; D], Vec<u32>>,
}

impl<'a, const D: usize> Near<'a, D> {
    fn of(seeds: &'a Seeds<D>) -> Self {
        let spacing = seeds.half_size.iter().fold(0.0, |a: f64, b| a.max(2.0 * b));
        let mut near = Near { seeds, spacing, cells: HashMap::new() };
        for (n, x) in seeds.positions.iter().enumerate() {
            near.cells.entry(near.cell(x)).or_default().push(n as u32);
        }
        near
    }
    fn cell(&self, x: &[f64; D]) -> [i64; D] {
        x.map(|x| (x / self.spacing).floor() as i64)
    }
    /// Return the position of the nearest particle in the cells around, m; the first of several.
    fn nearest(&self, x: &[f64; D]) -> Option<[f64; D]> {
        let middle = self.cell(x);
        let mut best: Option<(f64, u32)> = None;
        for n in 0..neighbours(D) {
            let o = offset::<D>(n);
            let cell = std::array::from_fn(|d| middle[d] + i64::from(o[d]));
            for &n in self.cells.get(&cell).into_iter().flatten() {
                let y = &self.seeds.positions[n as usize];
                let square: f64 = (0..D).map(|d| (x[d] - y[d]).powi(2)).sum();
                if best.is_none_or(|best| (square, n) < best) {
                    best = Some((square, n));
                }
            }
        }
        best.map(|(_, n)| self.seeds.positions[n as usize])
    }
}
