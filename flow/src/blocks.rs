//! Blocks of cells near the liquid, their neighbours, and copies of a field around a block.

/// Cells along an edge of a block.
pub(crate) const SIDE: usize = 4;
/// Index of a block that does not exist.
pub(crate) const NONE: u32 = u32::MAX;
/// Edge of a tile: a block with two cells more at each side.
pub(crate) const TILE: usize = 8;
/// Layers of cells around the block in a tile.
pub(crate) const HALO: usize = 2;
/// Number of cells of the largest tile, in three dimensions.
pub(crate) const TILE_CELLS: usize = TILE * TILE * TILE;
/// Cells of the bounding box of all blocks, per block, up to which blocks are found in a table.
const SPARSE: usize = 64;

/// Number of cells of a block, 4^D.
#[inline(always)]
pub(crate) const fn volume(dimension: usize) -> usize {
    1 << (2 * dimension)
}

/// Sorted set of blocks of 4^D cells. The first axis varies fastest, in the order of blocks and of cells in a block.
#[derive(Clone, Debug)]
pub(crate) struct Blocks<const D: usize> {
    /// Coordinates in blocks.
    pub keys: Vec<[i32; D]>,
    /// The 3^D blocks around each block, itself in the middle; [`NONE`] where there is none.
    near: Vec<u32>,
    /// Period along each axis, in blocks; 0 without.
    period: [i32; D],
    low: [i32; D],
    size: [usize; D],
    /// Index of the block at each place of the bounding box; empty if the box is too large.
    table: Vec<u32>,
}

impl<const D: usize> Default for Blocks<D> {
    fn default() -> Self {
        Blocks {
            keys: Vec::new(),
            near: Vec::new(),
            period: [0; D],
            low: [0; D],
            size: [0; D],
            table: Vec::new(),
        }
    }
}

/// Compare keys, the last axis first.
fn order<const D: usize>(a: &[i32; D], b: &[i32; D]) -> std::cmp::Ordering {
    a.iter().rev().cmp(b.iter().rev())
}

/// Offset of neighbour `n` of 3^D along each axis, -1 to 1.
pub(crate) fn offset<const D: usize>(n: usize) -> [i32; D] {
    let mut rest = n;
    std::array::from_fn(|_| {
        let part = (rest % 3) as i32 - 1;
        rest /= 3;
        part
    })
}

/// Local coordinates of cell `i` of a block.
#[inline(always)]
pub(crate) fn local<const D: usize>(i: usize) -> [usize; D] {
    let mut at = [0; D];
    for d in 0..D {
        at[d] = (i >> (2 * d)) & 3;
    }
    at
}

/// Index in a tile of the cell at these local coordinates of its block.
#[inline(always)]
pub(crate) fn in_tile<const D: usize>(at: &[usize; D]) -> usize {
    let mut index = 0;
    for d in (0..D).rev() {
        index = index * TILE + at[d] + HALO;
    }
    index
}

/// Distance in a tile between neighbours along an axis.
#[inline(always)]
pub(crate) const fn stride(axis: usize) -> usize {
    1 << (3 * axis)
}

const _: () = assert!(SIDE == 1 << 2 && TILE == 1 << 3, "edges as powers of two");

impl<const D: usize> Blocks<D> {
    /// Number of cells of a block.
    pub const CELLS: usize = volume(D);
    /// Number of blocks around a block, itself included.
    pub const AROUND: usize = 3usize.pow(D as u32);

    /// Create the set of the blocks `occupied` and all blocks around them. `period` is in blocks; 0 without.
    pub fn around(mut occupied: Vec<[i32; D]>, period: [i32; D]) -> Self {
        occupied.sort_unstable_by(order);
        occupied.dedup();
        let mut keys = Vec::with_capacity(3 * occupied.len());
        for key in &occupied {
            for n in 0..Self::AROUND {
                keys.push(wrapped(shifted(key, &offset(n)), &period));
            }
        }
        keys.sort_unstable_by(order);
        keys.dedup();
        let mut blocks = Blocks { keys, period, ..Blocks::default() };
        blocks.fill_table();
        blocks.fill_near();
        blocks
    }

    fn fill_table(&mut self) {
        let (mut low, mut high) = ([i32::MAX; D], [i32::MIN; D]);
        for key in &self.keys {
            for d in 0..D {
                (low[d], high[d]) = (low[d].min(key[d]), high[d].max(key[d]));
            }
        }
        self.low = low;
        self.size = std::array::from_fn(|d| (i64::from(high[d]) - i64::from(low[d]) + 1).max(0) as usize);
        let room = self.size.iter().try_fold(1usize, |product, n| product.checked_mul(*n));
        if let Some(room) = room.filter(|&room| room <= SPARSE * self.keys.len() + 4096) {
            self.table = vec![NONE; room];
            for (b, key) in self.keys.iter().enumerate() {
                let place = self.place(key);
                if let Some(place) = place {
                    self.table[place] = b as u32;
                }
            }
        }
    }

    fn fill_near(&mut self) {
        let mut near = Vec::with_capacity(self.keys.len() * Self::AROUND);
        for key in &self.keys {
            near.extend((0..Self::AROUND).map(|n| self.find(&shifted(key, &offset(n)))));
        }
        self.near = near;
    }

    #[inline]
    fn place(&self, key: &[i32; D]) -> Option<usize> {
        let mut place = 0;
        for d in (0..D).rev() {
            let at = key[d].wrapping_sub(self.low[d]) as u32 as usize;
            if at >= self.size[d] {
                return None;
            }
            place = place * self.size[d] + at;
        }
        Some(place)
    }

    /// Return the index of the block with these coordinates or their periodic image; [`NONE`] if there is none.
    #[inline]
    pub fn find(&self, key: &[i32; D]) -> u32 {
        let key = wrapped(*key, &self.period);
        if self.table.is_empty() {
            return self.keys.binary_search_by(|k| order(k, &key)).map_or(NONE, |b| b as u32);
        }
        self.place(&key).map_or(NONE, |place| self.table[place])
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.keys.len()
    }
    /// Number of cells of all blocks.
    pub fn cells(&self) -> usize {
        self.keys.len() * Self::CELLS
    }
    /// The 3^D blocks around a block.
    pub fn near(&self, b: usize) -> &[u32] {
        &self.near[b * Self::AROUND..(b + 1) * Self::AROUND]
    }
    /// Index of the cell beside cell `i` of block `b`, along an axis.
    pub fn beside(&self, b: usize, i: usize, axis: usize, up: bool) -> Option<usize> {
        let mut at = local::<D>(i);
        let across = if up { at[axis] == SIDE - 1 } else { at[axis] == 0 };
        if !across {
            let step = volume(axis);
            return Some(b * Self::CELLS + if up { i + step } else { i - step });
        }
        at[axis] = if up { 0 } else { SIDE - 1 };
        let middle = Self::AROUND / 2;
        let step = 3usize.pow(axis as u32);
        let other = self.near(b)[if up { middle + step } else { middle - step }];
        let cell = at.iter().rev().fold(0, |sum, x| sum * SIDE + x);
        (other != NONE).then_some(other as usize * Self::CELLS + cell)
    }
    /// Index of the cell at this offset, -1 to 1 along each axis, from the cell at `at` in block `b`.
    pub fn around_cell(&self, b: usize, at: &[usize; D], by: &[i32; D]) -> Option<usize> {
        let (mut block, mut cell) = (0, 0);
        for d in (0..D).rev() {
            let place = at[d] as i32 + by[d];
            let part = place.div_euclid(SIDE as i32);
            block = block * 3 + (part + 1) as usize;
            cell = cell * SIDE + (place - part * SIDE as i32) as usize;
        }
        let other = self.near(b)[block];
        (other != NONE).then_some(other as usize * Self::CELLS + cell)
    }
    /// Coordinates of cell `i` of block `b`.
    #[cfg(test)]
    pub fn cell(&self, b: usize, i: usize) -> [i32; D] {
        let at = local::<D>(i);
        std::array::from_fn(|d| self.keys[b][d] * SIDE as i32 + at[d] as i32)
    }

    /// Copy a field of cells into the tile of block `b`, with two layers of cells around it. Cells that do not exist are `outside`.
    #[inline]
    pub fn load<X: Copy>(&self, b: usize, field: &[X], outside: X, tile: &mut [X; TILE_CELLS]) {
        let near = self.near(b);
        let of = |block: u32| {
            let first = block as usize * Self::CELLS;
            if block == NONE { None } else { field.get(first..first + Self::CELLS) }
        };
        let layers: &[Span] = if D == 3 { &SPANS } else { &SPANS[..1] };
        for (slab, layer) in layers.iter().enumerate() {
            for (line, rows) in SPANS.iter().enumerate() {
                let first = 9 * slab + 3 * line;
                let blocks = [of(near[first]), of(near[first + 1]), of(near[first + 2])];
                for k in 0..if D == 3 { layer.count } else { 1 } {
                    for j in 0..rows.count {
                        let high = if D == 3 { (layer.first + k) * SIDE * SIDE } else { 0 };
                        let start = high + (rows.first + j) * SIDE;
                        let place = if D == 3 { layer.place + k } else { 0 } * TILE + rows.place + j;
                        let row = &mut tile[place * TILE..][..TILE];
                        copy_row::<X, 2>(blocks[0], start + 2, outside, &mut row[..2]);
                        copy_row::<X, 4>(blocks[1], start, outside, &mut row[2..6]);
                        copy_row::<X, 2>(blocks[2], start, outside, &mut row[6..]);
                    }
                }
            }
        }
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        self.keys.capacity() * size_of::<[i32; D]>() + 4 * (self.near.capacity() + self.table.capacity())
    }
}

/// Part of a tile along an axis that is of one block.
struct Span {
    /// First layer in the tile.
    place: usize,
    count: usize,
    /// First layer in the block.
    first: usize,
}

/// Parts of the block below, of the block itself, and of the block above.
const SPANS: [Span; 3] = [
    Span { place: 0, count: HALO, first: SIDE - HALO },
    Span { place: HALO, count: SIDE, first: 0 },
    Span { place: HALO + SIDE, count: HALO, first: 0 },
];

/// Copy `N` cells of a block.
#[inline(always)]
fn copy_row<X: Copy, const N: usize>(cells: Option<&[X]>, start: usize, outside: X, out: &mut [X]) {
    match cells.and_then(|cells| cells.get(start..start + N)) {
        Some(row) => out.copy_from_slice(row),
        None => out.fill(outside),
    }
}

fn shifted<const D: usize>(key: &[i32; D], by: &[i32; D]) -> [i32; D] {
    std::array::from_fn(|d| key[d] + by[d])
}

#[inline]
fn wrapped<const D: usize>(mut key: [i32; D], period: &[i32; D]) -> [i32; D] {
    for d in 0..D {
        if period[d] > 0 {
            key[d] = key[d].rem_euclid(period[d]);
        }
    }
    key
}

/// Empty lists, one for each axis.
pub(crate) fn faces<const D: usize, X>() -> [Vec<X>; D] {
    std::array::from_fn(|_| Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_contain_the_cells_around_a_block() {
        for period in [[0, 0, 0], [3, 0, 4]] {
            let blocks = Blocks::around(vec![[0, 0, 0], [2, 1, 0], [2, 3, 3]], period);
            let field: Vec<[i32; 3]> = (0..blocks.cells()).map(|s| blocks.cell(s / 64, s % 64)).collect();
            let mut tile = [[i32::MAX; 3]; TILE_CELLS];
            for b in 0..blocks.len() {
                blocks.load(b, &field, [i32::MAX; 3], &mut tile);
                for (t, found) in tile.iter().enumerate() {
                    let at = [t % 8, t / 8 % 8, t / 64];
                    let mut cell: [i32; 3] =
                        std::array::from_fn(|d| blocks.keys[b][d] * 4 + at[d] as i32 - 2);
                    for d in (0..3).filter(|d| period[*d] > 0) {
                        cell[d] = cell[d].rem_euclid(4 * period[d]);
                    }
                    let there = blocks.find(&cell.map(|x| x.div_euclid(4))) != NONE;
                    assert_eq!(*found, if there { cell } else { [i32::MAX; 3] });
                }
            }
        }
    }
}
