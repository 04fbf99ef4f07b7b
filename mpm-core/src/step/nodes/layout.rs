//! Where the nodes of a block are kept.
//!
//! A block has room for all its 4^D nodes, x fastest. Where several bodies share it, many of a body's nodes there are out
//! of its particles' reach: such a field keeps only those within, in the same order.

use crate::dim::block_nodes;
use crate::grid::Node;
use impactite_simd::Team;

/// Places of the nodes of all blocks.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Nodes of a whole block.
    whole: usize,
    /// Number of blocks.
    blocks: usize,
    /// First node of each block, and behind the last one; empty if all are whole.
    starts: Vec<u32>,
    /// Which nodes each block keeps, a bit each; likewise.
    kept: Vec<u64>,
}

/// The bits of all nodes of a block.
pub(in crate::step) const fn whole_block(d: usize) -> u64 {
    u64::MAX >> (64 - block_nodes(d))
}

/// Place of a node among those of a set.
#[inline(always)]
pub(in crate::step) fn rank(set: u64, node: usize) -> usize {
    (set & !(u64::MAX << node)).count_ones() as usize
}

impl Layout {
    /// Blocks in `d` dimensions that keep these nodes.
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

    /// Are all blocks whole?
    #[inline(always)]
    pub(in crate::step) fn is_whole(&self) -> bool {
        self.starts.is_empty()
    }
    /// Nodes of all blocks.
    pub(in crate::step) fn len(&self) -> usize {
        self.start(self.blocks)
    }
    /// First node of a block.
    #[inline(always)]
    pub(in crate::step) fn start(&self, block: usize) -> usize {
        if self.is_whole() { block * self.whole } else { self.starts[block] as usize }
    }
    /// The nodes that a block keeps, a bit each.
    #[inline(always)]
    pub(in crate::step) fn kept(&self, block: usize) -> u64 {
        if self.is_whole() { u64::MAX >> (64 - self.whole) } else { self.kept[block] }
    }
    /// Place of a node, if it is kept.
    pub(in crate::step) fn place(&self, block: usize, node: usize) -> Option<usize> {
        let kept = self.kept(block);
        (kept >> node & 1 != 0).then(|| self.start(block) + rank(kept, node))
    }
    /// The block of the node at a place.
    pub(in crate::step) fn block_of(&self, place: usize) -> usize {
        if self.is_whole() {
            return place / self.whole;
        }
        self.starts.partition_point(|&start| start as usize <= place) - 1
    }
    /// The nodes of a block.
    pub(in crate::step) fn of<'a, X>(&self, items: &'a [X], block: usize) -> &'a [X] {
        &items[self.start(block)..self.start(block + 1)]
    }

    /// `task` on the nodes of every block, with the matching element of `with`.
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

    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.starts.capacity() * size_of::<u32>() + self.kept.capacity() * size_of::<u64>()
    }
}

/// The nodes that a block keeps.
pub(in crate::step) struct Piece<'a, X> {
    /// In order of place.
    pub(in crate::step) items: &'a mut [X],
    kept: u64,
    whole: bool,
}

impl<X> Piece<'_, X> {
    /// Are they all of the block's?
    pub(in crate::step) fn is_whole(&self) -> bool {
        self.whole
    }
    /// Each with its number in the block.
    pub(in crate::step) fn numbered(&mut self) -> impl Iterator<Item = (usize, &mut X)> {
        self.items.iter_mut().zip(numbers(self.kept)).map(|(item, n)| (n, item))
    }
    /// One by its number in the block.
    pub(in crate::step) fn get(&mut self, node: usize) -> Option<&mut X> {
        let place = rank(self.kept, node);
        if self.kept >> node & 1 != 0 { self.items.get_mut(place) } else { None }
    }
}

/// The numbers in a set, in order.
pub(in crate::step) fn numbers(mut set: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let next = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (next < 64).then_some(next)
    })
}

/// All nodes as particles read them.
#[derive(Clone, Copy)]
pub struct Nodes<'a, T> {
    /// Their records.
    pub(in crate::step) all: &'a [Node<T>],
    /// Where those of a block are.
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

/// A body's claim to a node block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claim<const D: usize> {
    /// Coordinates of the block.
    pub coordinates: [i32; D],
    /// Number of the body.
    pub body: u32,
    /// The nodes that its particles reach, a bit each; none if they may come there, but are not there yet.
    pub reached: u64,
}

/// Which records of the bodies' tiles to sum, and where to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeSums {
    /// Both records: mass, momentum and force.
    All,
    /// The second into the second: force (USF).
    Force,
    /// The first into the second: momentum mapped again (MUSL).
    Again,
    /// The same, of a velocity that is smoothed (FMPM).
    Smoothed,
    /// The same, of what particles are pushed by.
    Pushes,
}
