//! Storage layout of the nodes of blocks.
//!
//! A block can store all its 4^D nodes, x fastest. If several bodies share it, many nodes of a body are out of its
//! particles' reach: such a field stores only those within, in the same order.

use crate::dim::block_nodes;
use crate::grid::Node;
use impactite_simd::Team;

/// Storage indices of the nodes of all blocks.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Number of nodes of a whole block.
    whole: usize,
    /// Number of blocks.
    blocks: usize,
    /// First node of each block, and one past the last node; empty if all blocks are whole.
    starts: Vec<u32>,
    /// Nodes that each block stores, one bit each; empty if all blocks are whole.
    kept: Vec<u64>,
}

/// First of the four layers of a block normal to each axis, one bit per node.
pub(in crate::step) const LAYERS: [u64; 3] =
    [0x1111_1111_1111_1111, 0x000F_000F_000F_000F, 0x0000_0000_0000_FFFF];

/// Return the bits of all nodes of a block.
pub(in crate::step) const fn whole_block(d: usize) -> u64 {
    u64::MAX >> (64 - block_nodes(d))
}

/// Return the rank of a node in a set.
#[inline(always)]
pub(in crate::step) fn rank(set: u64, node: usize) -> usize {
    (set & !(u64::MAX << node)).count_ones() as usize
}

impl Layout {
    /// Arrange blocks in `d` dimensions that store these nodes.
    pub(in crate::step) fn arrange(&mut self, d: usize, kept: impl ExactSizeIterator<Item = u64> + Clone) {
        (self.whole, self.blocks) = (block_nodes(d), kept.len());
        self.starts.clear();
        self.kept.clear();
        if kept.clone().all(|k| k == whole_block(d)) {
            return;
        }
        let mut start = 0;
        for nodes in kept {
            self.starts.push(start);
            self.kept.push(nodes);
            start += nodes.count_ones();
        }
        self.starts.push(start);
    }

    /// Return true if all blocks are whole.
    #[inline(always)]
    pub(in crate::step) fn is_whole(&self) -> bool {
        self.starts.is_empty()
    }
    /// Number of nodes of all blocks.
    pub(in crate::step) fn len(&self) -> usize {
        self.start(self.blocks)
    }
    /// Index of the first node of a block.
    #[inline(always)]
    pub(in crate::step) fn start(&self, block: usize) -> usize {
        if self.is_whole() { block * self.whole } else { self.starts[block] as usize }
    }
    /// Nodes that a block stores, one bit each.
    #[inline(always)]
    pub(in crate::step) fn kept(&self, block: usize) -> u64 {
        if self.is_whole() { u64::MAX >> (64 - self.whole) } else { self.kept[block] }
    }
    /// Index of a node, if stored.
    pub(in crate::step) fn place(&self, block: usize, node: usize) -> Option<usize> {
        let kept = self.kept(block);
        (kept >> node & 1 != 0).then(|| self.start(block) + rank(kept, node))
    }
    /// Block of the node at an index.
    pub(in crate::step) fn block_of(&self, place: usize) -> usize {
        if self.is_whole() {
            return place / self.whole;
        }
        self.starts.partition_point(|&start| start as usize <= place) - 1
    }
    /// Items at the nodes of a block.
    pub(in crate::step) fn of<'a, X>(&self, items: &'a [X], block: usize) -> &'a [X] {
        &items[self.start(block)..self.start(block + 1)]
    }

    /// Run `task` on the nodes of every block, with the matching element of `with`.
    pub(in crate::step) fn each<X: Send, Y: Send>(
        &self,
        team: &Team,
        items: &mut [X],
        with: &mut [Y],
        task: impl Fn(usize, Piece<'_, X>, &mut Y) + Send + Sync,
    ) {
        if self.is_whole() {
            let kept = self.kept(0);
            team.each_piece(items, self.whole, with, |block, items, with| {
                task(block, Piece { items, kept, whole: true }, with);
            });
            return;
        }
        let whole = u64::MAX >> (64 - self.whole);
        team.each_part(items, &self.starts, with, |block, items, with| {
            let kept = self.kept[block];
            task(block, Piece { items, kept, whole: kept == whole }, with);
        });
    }

    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.starts.capacity() * size_of::<u32>() + self.kept.capacity() * size_of::<u64>()
    }
}

/// Items at the nodes that a block stores.
pub(in crate::step) struct Piece<'a, X> {
    /// Items in storage order.
    pub(in crate::step) items: &'a mut [X],
    kept: u64,
    whole: bool,
}

impl<X> Piece<'_, X> {
    /// Node numbers of the block that are stored, one bit each.
    pub(in crate::step) fn kept(&self) -> u64 {
        self.kept
    }
    /// Return true if all nodes of the block are stored.
    pub(in crate::step) fn is_whole(&self) -> bool {
        self.whole
    }
    /// Iterate over the items, with their node number in the block.
    pub(in crate::step) fn numbered(&mut self) -> impl Iterator<Item = (usize, &mut X)> {
        self.items.iter_mut().zip(numbers(self.kept)).map(|(item, n)| (n, item))
    }
    /// Return the item of a node number in the block, if stored.
    pub(in crate::step) fn get(&mut self, node: usize) -> Option<&mut X> {
        let place = rank(self.kept, node);
        if self.kept >> node & 1 != 0 { self.items.get_mut(place) } else { None }
    }
}

/// Iterate over the numbers in a set, in order.
pub(in crate::step) fn numbers(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let next = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (next < 64).then_some(next)
    })
}

/// All nodes, for reading by particles.
#[derive(Clone, Copy)]
pub struct Nodes<'a, T> {
    /// Records of the nodes.
    pub(in crate::step) all: &'a [Node<T>],
    /// Storage layout of the blocks.
    pub(in crate::step) layout: &'a Layout,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_found_where_they_are_kept() {
        let kept = [whole_block(2), 0b1010_0000_0001, 0, 0b1000_0000_0000_0000];
        let mut layout = Layout::default();
        layout.arrange(2, kept.into_iter());
        assert_eq!((layout.len(), layout.is_whole()), (16 + 3 + 1, false));
        for (block, kept) in kept.into_iter().enumerate() {
            let places: Vec<usize> = (0..16).filter_map(|n| layout.place(block, n)).collect();
            let expected: Vec<usize> = (layout.start(block)..layout.start(block + 1)).collect();
            assert_eq!(places, expected);
            assert_eq!(numbers(kept).count(), places.len());
        }
        for threads in [1, 3] {
            let mut items = vec![0; layout.len()];
            let mut seen = vec![0; kept.len()];
            let team = Team::new(threads).expect("threads");
            layout.each(&team, &mut items, &mut seen, |block, mut piece, seen| {
                *seen = piece.items.len();
                for (n, item) in piece.numbered() {
                    *item = 100 * block + n;
                }
                assert!((0..16).all(|n| piece.get(n).is_none_or(|item| *item == 100 * block + n)));
            });
            assert_eq!(seen, [16, 3, 0, 1]);
            assert_eq!(items[16..], [100, 109, 111, 315]);
        }
        layout.arrange(3, [whole_block(3); 2].into_iter());
        assert!(layout.is_whole() && layout.len() == 128 && layout.place(1, 63) == Some(127));
    }
}

/// Request of a body for a node block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claim<const D: usize> {
    /// Coordinates of the block.
    pub coordinates: [i32; D],
    /// Index of the body.
    pub body: u32,
    /// Nodes that its particles reach, one bit each; none if they may come there later.
    pub reached: u64,
}

/// Tile records to sum, and their destination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeSums {
    /// Both records: mass, momentum and force.
    All,
    /// Second into second records: force (USF).
    Force,
    /// First into second records: momentum mapped again (MUSL).
    Again,
    /// First into second records: smoothed velocity (FMPM).
    Smoothed,
    /// First into second records: impulses on particles.
    Pushes,
}
