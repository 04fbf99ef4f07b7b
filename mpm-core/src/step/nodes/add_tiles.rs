//! Sums over the tiles of the particle blocks around a node block.

use std::marker::PhantomData;
use std::ops::Range;

use super::layout::NodeSums;
use crate::dim::{BLOCK, Stencil, block_nodes};
use crate::grid::Node;
use crate::step::passes::slot::Slot;
use crate::step::passes::tile::{place, thirds, tile_nodes};
use impactite_simd::{Arch, Float, Kernel, Quad, Vectors, prefetch_from};

/// Kernel that adds the tiles of the particle blocks around a node block to its nodes, in the order of the blocks.
pub(in crate::step) struct AddTiles<'a, T: Float, const D: usize, E> {
    /// Nodes of the block.
    pub(in crate::step) nodes: &'a mut [Node<T>],
    /// Particle blocks.
    pub(in crate::step) slots: &'a [Slot<T, D>],
    /// Slots around the node block, and around the next one.
    pub(in crate::step) around: [&'a [u32]; 2],
    /// Records to sum, and their destination.
    pub(in crate::step) sums: NodeSums,
    /// True if the method maps two records.
    pub(in crate::step) two: bool,
    pub(in crate::step) extent: PhantomData<E>,
}

impl<T: Float, const D: usize, E: Stencil> Kernel<T> for AddTiles<'_, T, D, E> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(mut self) {
        let what = match self.sums {
            NodeSums::All => Adds { first: true, again: false, second: self.two },
            NodeSums::Force => Adds { first: false, again: false, second: true },
            NodeSums::Again | NodeSums::Smoothed | NodeSums::Pushes => {
                Adds { first: false, again: true, second: false }
            }
        };
        self.add_all::<A>(what);
    }
}

/// Destination of the records of a tile.
#[derive(Clone, Copy)]
struct Adds {
    /// Add first records to first ones.
    first: bool,
    /// Add first records to second ones.
    again: bool,
    /// Add second records to second ones.
    second: bool,
}

impl<T: Float, const D: usize, E: Stencil> AddTiles<'_, T, D, E> {
    /// Return the tile of the n-th neighbour, if any, of this (0) or the next node block (1), and its rows that contain
    /// sums.
    #[inline(always)]
    fn tile(&self, n: usize, block: usize) -> Option<(&[[T; 4]], u64)> {
        let slot = *self.around[block].get(n)?;
        self.slots.get(slot as usize).map(|slot| (slot.tile.all(), slot.rows))
    }

    /// Add the tiles of all neighbouring particle blocks; the nodes are one third of each tile along an axis.
    #[inline(always)]
    fn add_all<A: Arch<T>>(&mut self, what: Adds) {
        for z in 0..if D == 3 { 3 } else { 1 } {
            let layers = if D == 3 { thirds::<E>(2 - z) } else { 0..1 };
            for y in 0..3 {
                let lines = thirds::<E>(2 - y);
                if layers.is_empty() || lines.is_empty() {
                    continue;
                }
                let first = (z * 3 + y) * 3;
                self.add::<A, 2>(what, first, &layers, &lines);
                self.add::<A, 1>(what, first + 1, &layers, &lines);
                self.add::<A, 0>(what, first + 2, &layers, &lines);
            }
        }
    }

    /// Add these rows of the tile of neighbour `n`, in which the nodes are the third `X` along x, and prefetch those of the
    /// next node block.
    #[inline(always)]
    fn add<A: Arch<T>, const X: usize>(
        &mut self,
        what: Adds,
        n: usize,
        layers: &Range<usize>,
        lines: &Range<usize>,
    ) {
        let x = thirds::<E>(X);
        if x.is_empty() {
            return;
        }
        let nodes = std::mem::take(&mut self.nodes);
        self.add_to::<A, X>(what, nodes, n, layers, lines);
        self.nodes = nodes;
    }

    #[inline(always)]
    fn add_to<A: Arch<T>, const X: usize>(
        &self,
        what: Adds,
        nodes: &mut [Node<T>],
        n: usize,
        layers: &Range<usize>,
        lines: &Range<usize>,
    ) {
        let x = thirds::<E>(X);
        let (own, next) = (self.tile(n, 0), self.tile(n, 1));
        let Some((soon, _)) = next.or(own) else { return };
        let (tile, rows) = own.unwrap_or((soon, 0));
        let nodes = nodes[..block_nodes(D)].as_chunks_mut::<BLOCK>().0;
        let (first, second) = tile.split_at(tile_nodes::<E>(D));
        let at = place::<E>(x.start).1;
        for k in layers.clone() {
            let nz = if D == 3 { place::<E>(k).1 } else { 0 };
            for j in lines.clone() {
                let row = k * E::TILE + j;
                let from = row * E::TILE + x.start;
                if what.first || what.again {
                    prefetch_from(soon, from, x.len());
                }
                if what.second {
                    prefetch_from(soon, tile_nodes::<E>(D) + from, x.len());
                }
                if rows >> row & 1 == 0 {
                    continue;
                }
                let to = &mut nodes[nz * BLOCK + place::<E>(j).1][at..at + x.len()];
                if what.first {
                    add_row::<T, A, 0>(to, &first[from..][..x.len()]);
                }
                if what.again {
                    add_row::<T, A, 1>(to, &first[from..][..x.len()]);
                }
                if what.second {
                    add_row::<T, A, 1>(to, &second[from..][..x.len()]);
                }
            }
        }
    }
}

/// Add a row of records to the first (0) or second (1) records of nodes.
#[inline(always)]
fn add_row<T: Float, A: Arch<T>, const RECORD: usize>(to: &mut [Node<T>], from: &[[T; 4]]) {
    for (node, add) in to.iter_mut().zip(from) {
        let sum = if RECORD == 0 { &mut node.first } else { &mut node.second };
        (A::Quad::load(sum) + A::Quad::load(add)).store(sum);
    }
}
