//! Sparse set of cells in blocks.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, DefaultHasher};

/// Cells along a side of a block.
pub const SIDE: i32 = 4;

/// Number of slots of a block, 4^D.
#[inline(always)]
pub(crate) const fn slots<const D: usize>() -> usize {
    (SIDE as usize).pow(D as u32)
}

/// Largest number of slots of a block.
pub(crate) const MOST: usize = 64;

/// Stride between slots of a block along an axis: 1, 4, 16.
#[inline(always)]
pub(crate) const fn stride(axis: usize) -> usize {
    (SIDE as usize).pow(axis as u32)
}

/// Index that stands for a missing neighbour block.
pub(crate) const NONE: u32 = u32::MAX;

/// Sorted set of blocks of 4^D cells on an unbounded Cartesian grid, D = 2 or 3.
///
/// A **cell** has D integer coordinates. A **slot** is its number: slots of a block are consecutive, x fastest, and blocks are sorted along
/// the Morton (Z-order) curve, so that the 2^D blocks of a block that is twice as wide are consecutive. A block holds slots for all its cells,
/// named by the caller or not. Memory: 28 bytes per block in two, 36 bytes in three dimensions, and the hash map.
#[derive(Clone, Debug, Default)]
pub struct CellBlocks<const D: usize> {
    /// Block coordinates: those of its cells divided by 4, rounded down.
    blocks: Vec<[i32; D]>,
    index: HashMap<[i32; D], u32, BuildHasherDefault<DefaultHasher>>,
    /// Lower and upper neighbour along each axis, or [`NONE`].
    neighbours: Vec<[[u32; 2]; D]>,
}

impl<const D: usize> PartialEq for CellBlocks<D> {
    fn eq(&self, other: &Self) -> bool {
        self.blocks == other.blocks
    }
}

impl<const D: usize> CellBlocks<D> {
    /// Slots of a block, 4^D.
    pub const BLOCK: usize = slots::<D>();

    /// Create the set of blocks that contain `cells`, in any order, repeated or not.
    pub fn of_cells(cells: impl IntoIterator<Item = [i32; D]>) -> Self {
        Self::of_blocks(cells.into_iter().map(|cell| cell.map(|x| x.div_euclid(SIDE))))
    }

    /// Create the set of blocks with the given block coordinates (cell coordinates divided by 4, rounded down), in any order, repeated or
    /// not.
    pub fn of_blocks(blocks: impl IntoIterator<Item = [i32; D]>) -> Self {
        const { assert!(D == 2 || D == 3, "blocks of cells have two or three dimensions") };
        let mut index: HashMap<_, _, _> = HashMap::default();
        let (mut list, mut last) = (Vec::new(), None);
        for block in blocks {
            if last != Some(block) && index.insert(block, 0).is_none() {
                list.push((morton(block), block));
            }
            last = Some(block);
        }
        list.sort_unstable();
        let blocks: Vec<[i32; D]> = list.into_iter().map(|(_, block)| block).collect();
        for (i, block) in blocks.iter().enumerate() {
            index.insert(*block, i as u32);
        }
        let beside = |block: &[i32; D], axis: usize, up: bool| {
            let mut key = *block;
            key[axis] += if up { 1 } else { -1 };
            index.get(&key).copied().unwrap_or(NONE)
        };
        let around = |block| std::array::from_fn(|axis| [false, true].map(|up| beside(block, axis, up)));
        let neighbours = blocks.iter().map(around).collect();
        CellBlocks { blocks, index, neighbours }
    }

    /// Number of blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Number of slots: blocks times 4^D.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.blocks.len() * Self::BLOCK
    }

    /// True if there are no blocks.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Block coordinates of block `block`: the coordinates of its cells divided by 4, rounded down.
    #[must_use]
    pub fn key(&self, block: usize) -> [i32; D] {
        self.blocks[block]
    }

    /// Index of the block with block coordinates `key`, or None.
    #[must_use]
    pub fn find_block(&self, key: [i32; D]) -> Option<usize> {
        self.index.get(&key).map(|&i| i as usize)
    }

    /// Slot of the cell, or None if its block is not in the set.
    #[must_use]
    pub fn find(&self, cell: [i32; D]) -> Option<usize> {
        let block = self.find_block(cell.map(|x| x.div_euclid(SIDE)))?;
        Some(block * Self::BLOCK + local(cell))
    }

    /// Coordinates of the cell of a slot.
    #[must_use]
    pub fn place(&self, slot: usize) -> [i32; D] {
        let (block, inside) = (self.blocks[slot / Self::BLOCK], slot % Self::BLOCK);
        std::array::from_fn(|axis| block[axis] * SIDE + (inside / stride(axis)) as i32 % SIDE)
    }

    /// Slot of the neighbour of a cell along `axis`, with the larger coordinate if `up`; None if its block is not in the set.
    #[inline]
    #[must_use]
    pub fn neighbour(&self, slot: usize, axis: usize, up: bool) -> Option<usize> {
        let (block, inside, stride) = (slot / Self::BLOCK, slot % Self::BLOCK, stride(axis));
        let x = inside / stride % SIDE as usize;
        match (up, x) {
            (true, 0..3) => Some(slot + stride),
            (false, 1..) => Some(slot - stride),
            (true, _) => self.block_neighbour(block, axis, up).map(|b| b * Self::BLOCK + inside - 3 * stride),
            (false, _) => {
                self.block_neighbour(block, axis, up).map(|b| b * Self::BLOCK + inside + 3 * stride)
            }
        }
    }

    /// Index of the neighbour block along `axis`, with the larger coordinate if `up`, or None.
    #[inline]
    #[must_use]
    pub fn block_neighbour(&self, block: usize, axis: usize, up: bool) -> Option<usize> {
        let neighbour = self.neighbours[block][axis][usize::from(up)];
        (neighbour != NONE).then_some(neighbour as usize)
    }
}

/// Slot of a cell in its block.
fn local<const D: usize>(cell: [i32; D]) -> usize {
    (0..D).map(|axis| cell[axis].rem_euclid(SIDE) as usize * stride(axis)).sum()
}

/// Position along the Morton curve: interleaved bits of the coordinates.
fn morton<const D: usize>(block: [i32; D]) -> u128 {
    let mut code = 0;
    for axis in 0..D {
        let mut x = u128::from((block[axis] as u32) ^ (1 << 31));
        let mut bit = axis;
        while x != 0 {
            code |= (x & 1) << bit;
            x >>= 1;
            bit += D;
        }
    }
    code
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_and_cells_correspond_and_neighbours_are_next_to_each_other() {
        let cells = CellBlocks::of_cells([[-1, 0, 5], [3, -9, 5], [-5, 0, 4], [4, 0, 4], [-1, 0, 5]]);
        assert_eq!((cells.blocks(), cells.cells()), (4, 256));
        let mut pairs = 0;
        for slot in 0..cells.cells() {
            let place = cells.place(slot);
            assert_eq!(cells.find(place), Some(slot));
            for axis in 0..3 {
                for (up, by) in [(false, -1), (true, 1)] {
                    let mut beside = place;
                    beside[axis] += by;
                    assert_eq!(cells.neighbour(slot, axis, up), cells.find(beside), "{place:?} {beside:?}");
                    pairs += usize::from(cells.find(beside).is_some());
                }
            }
        }
        // Each block has 2 * 3 * 48 inner pairs; blocks [-1, 0, 1] and [-2, 0, 1] share a side of 16 faces.
        assert_eq!(pairs, 4 * 288 + 2 * 16);
        assert_eq!(cells.find([100, 0, 0]), None);
    }

    #[test]
    fn children_of_a_block_are_consecutive() {
        let cells = CellBlocks::<2>::of_cells((0..40 * 40).map(|i| [i % 40 - 17, i / 40 - 9]));
        let parents: Vec<_> = (0..cells.blocks()).map(|b| cells.key(b).map(|x| x.div_euclid(2))).collect();
        let coarse = CellBlocks::of_blocks(parents.iter().copied());
        let order: Vec<_> = parents.iter().map(|p| coarse.find_block(*p).expect("parent")).collect();
        assert!(order.is_sorted());
    }
}
