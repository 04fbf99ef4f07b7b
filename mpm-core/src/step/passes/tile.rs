//! Tiles: nodes that the particles of one block of bins reach, `TILE` per axis, x fastest. A pass reads the grid through
//! one tile and adds to the grid through another.

use std::ops::Range;

use mpm_materials::Lane;

use super::gather::to_coefficients;
use super::spread::Maps;
use crate::step::nodes::layout::{Nodes, numbers, rank};

use crate::dim::{Array, BLOCK, Stencil, block_nodes};
use crate::grid::Node;
use crate::shape::ShapeFunction;
use impactite_simd::{AlignedRecords, Arch, Float, Quad, apart, prefetch_early_from};

/// Number of nodes that the particles of a block reach, in `d` dimensions.
pub fn tile_nodes<E: Stencil>(d: usize) -> usize {
    E::TILE.pow(d as u32)
}

/// Index in the tile of the first node of a bin's stencil.
#[inline(always)]
pub(in crate::step) fn tile_corner<E: Stencil, const D: usize>(bin: usize) -> usize {
    let (x, y, z) = (bin % BLOCK, bin / BLOCK % BLOCK, bin / (BLOCK * BLOCK));
    if D == 3 { (z * E::TILE + y) * E::TILE + x } else { y * E::TILE + x }
}

/// Return the rows of tile nodes along x, `TILE` per axis, that are in the stencils of `bins`; one bit per row and per bin.
#[inline(always)]
pub(in crate::step) fn rows_of<E: Stencil, const D: usize>(bins: u64) -> u64 {
    let mut rows = 0;
    for z in 0..if D == 3 { BLOCK } else { 1 } {
        let mut line = 0;
        for y in 0..BLOCK {
            let bins = bins >> ((z * BLOCK + y) * BLOCK) & ((1 << BLOCK) - 1);
            line |= u64::from(bins != 0) << y;
        }
        let mut lines = line;
        for j in 1..E::NODES {
            lines |= line << j;
        }
        for k in 0..E::LAYERS {
            rows |= lines << ((z + k) * E::TILE);
        }
    }
    rows
}

/// Iterate over the records of a tile, in runs of rows.
#[inline(always)]
fn runs<E: Stencil>(mut rows: u64) -> impl Iterator<Item = Range<usize>> {
    std::iter::from_fn(move || {
        let from = rows.trailing_zeros();
        let to = from + rows.checked_shr(from)?.trailing_ones();
        rows &= u64::MAX.checked_shl(to).unwrap_or(0);
        Some(from as usize * E::TILE..to as usize * E::TILE)
    })
}

/// Nodal records that a block's particles read. Other records are left from other blocks.
#[derive(Debug, Default)]
pub(in crate::step) struct TileIn<T> {
    first: AlignedRecords<T>,
    second: AlignedRecords<T>,
}

impl<T: Float> TileIn<T> {
    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.first.bytes() + self.second.bytes()
    }

    /// Copy at least these rows of records from the node blocks of the grid.
    #[inline(always)]
    pub(in crate::step) fn load<E: Stencil, const D: usize>(
        &mut self,
        nodes: Nodes<'_, T>,
        around: &[u32],
        reads: Reads,
        rows: u64,
    ) {
        self.first.have(tile_nodes::<E>(D));
        self.second.have(tile_nodes::<E>(D));
        if nodes.layout.is_whole() {
            self.load_whole::<E, D>(nodes.all, around, reads, rows);
        } else {
            self.load_kept::<E, D>(nodes, around, reads);
        }
    }

    /// Copy records from node blocks that may lack nodes.
    #[inline(never)]
    fn load_kept<E: Stencil, const D: usize>(&mut self, nodes: Nodes<'_, T>, around: &[u32], reads: Reads) {
        let layers = if D == 3 { E::TILE } else { 1 };
        for (n, &block) in around.iter().enumerate().filter(|(_, b)| **b != u32::MAX) {
            let [x, y, z] = [n % 3, n / 3 % 3, if D == 3 { n / 9 } else { 0 }].map(thirds::<E>);
            let z = if D == 3 { z } else { 0..layers };
            if x.is_empty() || y.is_empty() || z.is_empty() {
                continue;
            }
            let (kept, start) = (nodes.layout.kept(block as usize), nodes.layout.start(block as usize));
            for k in z {
                let nz = if D == 3 { place::<E>(k).1 } else { 0 };
                for j in y.clone() {
                    let line = (nz * BLOCK + place::<E>(j).1) * BLOCK + place::<E>(x.start).1;
                    let to = (k * E::TILE + j) * E::TILE + x.start;
                    let row = kept >> line & !(u64::MAX << x.len());
                    let from = start + rank(kept, line);
                    if row.count_ones() as usize == x.len() {
                        self.piece(nodes.all, from, to, x.len(), reads);
                    } else {
                        for (found, n) in numbers(row).enumerate() {
                            self.piece(nodes.all, from + found, to + n, 1, reads);
                        }
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn load_whole<E: Stencil, const D: usize>(
        &mut self,
        nodes: &[Node<T>],
        around: &[u32],
        reads: Reads,
        rows: u64,
    ) {
        let (left, right) = (thirds::<E>(0).len(), thirds::<E>(2).len());
        let first = &mut self.first.all_mut()[..tile_nodes::<E>(D)];
        let second = &mut self.second.all_mut()[..tile_nodes::<E>(D)];
        for (bz, by) in (0..if D == 3 { 3 } else { 1 }).flat_map(|bz| (0..3).map(move |by| (bz, by))) {
            let layers = if D == 3 { thirds::<E>(bz) } else { 0..1 };
            let lines = thirds::<E>(by);
            if layers.is_empty() || lines.is_empty() {
                continue;
            }
            let blocks = &around[(bz * 3 + by) * 3..][..3];
            let before = lines_of::<T, D>(nodes, blocks[0]);
            let here = lines_of::<T, D>(nodes, blocks[1]);
            let behind = lines_of::<T, D>(nodes, blocks[2]);
            for k in layers {
                let nz = if D == 3 { place::<E>(k).1 } else { 0 };
                for j in lines.clone() {
                    let row = k * E::TILE + j;
                    if rows >> row & 1 == 0 {
                        continue;
                    }
                    let line = nz * BLOCK + place::<E>(j).1;
                    let to = row * E::TILE..(row + 1) * E::TILE;
                    for i in 0..2 {
                        if !(if i == 0 { reads.first } else { reads.second }) {
                            continue;
                        }
                        let to = if i == 0 { &mut first[to.clone()] } else { &mut second[to.clone()] };
                        if left > 0
                            && let Some(from) = before.get(line)
                        {
                            copy(&mut to[..left], &from[BLOCK - left..], i);
                        }
                        if let Some(from) = here.get(line) {
                            copy(&mut to[left..left + BLOCK], from, i);
                        }
                        if let Some(from) = behind.get(line) {
                            copy(&mut to[left + BLOCK..], &from[..right], i);
                        }
                    }
                }
            }
        }
    }

    /// First and second records.
    #[inline(always)]
    pub(in crate::step) fn records(&self) -> [&[[T; 4]]; 2] {
        [self.first.all(), self.second.all()]
    }

    /// Prefetch row `row` of the nodes that the next block of particles reads.
    #[inline(always)]
    pub(in crate::step) fn prefetch<E: Stencil, const D: usize>(
        nodes: Nodes<'_, T>,
        around: &[u32],
        row: usize,
    ) {
        if !nodes.layout.is_whole() {
            return;
        }
        let (y, z) = (row % E::TILE, row / E::TILE);
        let (bz, nz) = if D == 3 { place::<E>(z) } else { (0, 0) };
        let (by, ny) = place::<E>(y);
        let (blocks, line) = (&around[(bz * 3 + by) * 3..][..3], (nz * BLOCK + ny) * BLOCK);
        let (left, right) = (thirds::<E>(0).len(), thirds::<E>(2).len());
        // Prefetching the address of an absent block has no effect.
        if left > 0 {
            let from = block_nodes(D) * blocks[0] as usize + line + BLOCK - left;
            prefetch_early_from(nodes.all, from, left);
        }
        prefetch_early_from(nodes.all, block_nodes(D) * blocks[1] as usize + line, BLOCK);
        prefetch_early_from(nodes.all, block_nodes(D) * blocks[2] as usize + line, right);
    }

    /// Copy a piece of a row inside one block; nothing if the block does not exist.
    #[inline(always)]
    fn piece(&mut self, nodes: &[Node<T>], from: usize, to: usize, length: usize, reads: Reads) {
        let Some(found) = nodes.get(from..from + length) else { return };
        if reads.first {
            let to = &mut self.first.all_mut()[to..to + length];
            for (to, node) in to.iter_mut().zip(found) {
                *to = node.first;
            }
        }
        if reads.second {
            let to = &mut self.second.all_mut()[to..to + length];
            for (to, node) in to.iter_mut().zip(found) {
                *to = node.second;
            }
        }
    }
}

/// Return the nodes of a block by lines along x; empty if the block does not exist.
#[inline(always)]
fn lines_of<T, const D: usize>(nodes: &[Node<T>], block: u32) -> &[[Node<T>; BLOCK]] {
    let from = block_nodes(D) * block as usize;
    nodes.get(from..from + block_nodes(D)).unwrap_or_default().as_chunks().0
}

/// Copy the first (0) or second (1) records of nodes.
#[inline(always)]
fn copy<T: Float>(to: &mut [[T; 4]], from: &[Node<T>], record: usize) {
    for (to, node) in to.iter_mut().zip(from) {
        *to = if record == 0 { node.first } else { node.second };
    }
}

/// Return the block of a tile coordinate, of the three along an axis, and the coordinate within it.
#[inline(always)]
pub fn place<E: Stencil>(tile: usize) -> (usize, usize) {
    let node = tile + BLOCK - (-E::BASE) as usize;
    (node / BLOCK, node % BLOCK)
}

/// Nodal vectors that a pass reads.
#[derive(Clone, Copy)]
pub(in crate::step) struct Reads {
    pub(in crate::step) first: bool,
    pub(in crate::step) second: bool,
}

/// Nodal records of one bin's stencil, in the format of a gather.
#[repr(C, align(64))]
pub(in crate::step) struct Stencilled<T: Float, E: Stencil> {
    pub(in crate::step) first: E::Nodes<[T; 4]>,
    pub(in crate::step) second: E::Nodes<[T; 4]>,
}

impl<T: Float, E: Stencil> Stencilled<T, E> {
    #[inline(always)]
    pub(in crate::step) fn zero() -> Self {
        Stencilled { first: Array::filled([T::default(); 4]), second: Array::filled([T::default(); 4]) }
    }
    #[inline(always)]
    pub(in crate::step) fn load<const D: usize, A: Arch<T>, S: ShapeFunction<T, D, Extent = E>>(
        &mut self,
        [first, second]: [&[[T; 4]]; 2],
        corner: usize,
        reads: Reads,
    ) {
        if reads.first {
            load_stencil::<T, D, A, S>(&mut self.first, first, corner);
        }
        if reads.second {
            load_stencil::<T, D, A, S>(&mut self.second, second, corner);
        }
    }
}

/// Load the records of the stencil that begins at `corner`, as coefficients if the shape function has a polynomial form.
#[inline(always)]
fn load_stencil<T: Float, const D: usize, A: Arch<T>, S: ShapeFunction<T, D>>(
    to: &mut <S::Extent as Stencil>::Nodes<[T; 4]>,
    tile: &[[T; 4]],
    corner: usize,
) {
    if A::APART {
        return apart(|| load_stencil_here::<T, D, A, S>(to, tile, corner));
    }
    load_stencil_here::<T, D, A, S>(to, tile, corner);
}

#[inline(always)]
fn load_stencil_here<T: Float, const D: usize, A: Arch<T>, S: ShapeFunction<T, D>>(
    to: &mut <S::Extent as Stencil>::Nodes<[T; 4]>,
    tile: &[[T; 4]],
    corner: usize,
) {
    let (side, layers) = (<S::Extent as Stencil>::TILE, <S::Extent as Stencil>::LAYERS);
    let n = <S::Extent as Stencil>::NODES;
    let from = &tile[corner..][..<S::Extent as Stencil>::SPAN];
    let mut numbers = <S::Extent as Stencil>::Nodes::<A::Quad>::filled(A::Quad::zero());
    for k in 0..layers {
        for j in 0..n {
            for i in 0..n {
                numbers[(k * n + j) * n + i] = A::Quad::load(&from[(k * side + j) * side + i]);
            }
        }
    }
    if S::POLYNOMIAL {
        to_coefficients::<T, D, A::Quad, S>(&mut numbers);
    }
    for i in 0..layers * n * n {
        numbers[i].store(&mut to[i]);
    }
}

/// Clear rows of the records of a tile that a pass adds to.
#[inline(always)]
pub(in crate::step) fn clear_rows<T: Float, const D: usize, E: Stencil>(
    tile: &mut [[T; 4]],
    rows: u64,
    maps: Maps,
) {
    let (first, second) = tile.split_at_mut(tile_nodes::<E>(D));
    for run in runs::<E>(rows) {
        if maps.momentum {
            first[run.clone()].fill([T::default(); 4]);
        }
        if maps.second() {
            second[run].fill([T::default(); 4]);
        }
    }
}

/// Return the tile coordinates in the left, same or right block (0, 1, 2) along an axis.
#[inline(always)]
pub(in crate::step) fn thirds<E: Stencil>(which: usize) -> Range<usize> {
    let before = (-E::BASE) as usize;
    match which {
        0 => 0..before,
        1 => before..before + BLOCK,
        _ => before + BLOCK..E::TILE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dim::Extent;

    fn check<E: Stencil, const D: usize>() {
        let (bins, side, layers) = (block_nodes(D), E::TILE, if D == 3 { E::TILE } else { 1 });
        // Every single bin, then sets of bins.
        let sets =
            (0..bins).map(|bin| 1 << bin).chain((1..200u64).map(|n| n.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        for set in sets.map(|set: u64| if bins == 64 { set } else { set & ((1 << bins) - 1) }) {
            let mut reached = vec![false; tile_nodes::<E>(D)];
            for bin in numbers(set) {
                let corner = tile_corner::<E, D>(bin);
                for (k, j) in (0..E::LAYERS).flat_map(|k| (0..E::NODES).map(move |j| (k, j))) {
                    reached[corner + (k * side + j) * side] = true;
                }
            }
            let rows = rows_of::<E, D>(set);
            for row in 0..side * layers {
                let any = reached[row * side..][..side].contains(&true);
                assert_eq!(rows >> row & 1 == 1, any, "row {row} of the bins {set:#x}");
            }
            let listed: Vec<usize> = runs::<E>(rows).flatten().collect();
            let expected: Vec<usize> =
                (0..side * side * layers).filter(|n| rows >> (n / side) & 1 == 1).collect();
            assert_eq!(listed, expected, "the bins {set:#x}");
        }
    }

    #[test]
    fn rows_are_those_that_stencils_reach() {
        check::<Extent<2, 2>, 2>();
        check::<Extent<2, 3>, 2>();
        check::<Extent<2, 4>, 2>();
        check::<Extent<3, 2>, 3>();
        check::<Extent<3, 3>, 3>();
        check::<Extent<3, 4>, 3>();
    }
}
