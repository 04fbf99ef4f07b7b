//! Tiles: the nodes that the particles of one block of bins reach, `TILE` an axis, x fastest. A pass reads the
//! grid through one and adds to the grid through another.

use mpm_materials::Lane;

use super::gather::to_coefficients;
use super::scatter::Maps;
use crate::dim::{Array, BLOCK, Stencil, block_nodes};
use crate::grid::Node;
use crate::parallel::{Arch, Float, Quad};
use crate::shape::ShapeFunction;

/// Which records of the bodies' tiles to sum, and where to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sums {
    /// Both records: mass, momentum and force.
    All,
    /// The second into the second: force (USF).
    Force,
    /// The first into the second: momentum mapped again (MUSL, FMPM).
    Again,
}

/// Nodes that the particles of a block reach, along an axis and in all, for a method.
pub fn tile_nodes<E: Stencil>(d: usize) -> usize {
    E::TILE.pow(d as u32)
}

/// Index in the tile of the first node of a bin's stencil.
#[inline(always)]
pub(super) fn tile_corner<E: Stencil, const D: usize>(bin: usize) -> usize {
    let (x, y, z) = (bin % BLOCK, bin / BLOCK % BLOCK, bin / (BLOCK * BLOCK));
    if D == 3 { (z * E::TILE + y) * E::TILE + x } else { y * E::TILE + x }
}

/// Copy the nodes that a block's particles reach out of the blocks of the grid.
#[inline(always)]
pub(super) fn load_tile<T: Float, const D: usize, E: Stencil>(
    nodes: &[Node<T>],
    around: &[u32],
    tile: &mut E::Tile<Node<T>>,
) {
    let tile = tile.as_mut();
    let layers = if D == 3 { E::TILE } else { 1 };
    for z in 0..layers {
        let (bz, nz) = if D == 3 { place::<E>(z) } else { (0, 0) };
        for y in 0..E::TILE {
            let (by, ny) = place::<E>(y);
            let row = &mut tile[(z * E::TILE + y) * E::TILE..][..E::TILE];
            let mut x = 0;
            while x < E::TILE {
                // A piece of the row inside one block.
                let (bx, nx) = place::<E>(x);
                let length = (BLOCK - nx).min(E::TILE - x);
                let block = around[(bz * 3 + by) * 3 + bx] as usize;
                let first = block * block_nodes(D) + (nz * BLOCK + ny) * BLOCK + nx;
                if let Some(found) = nodes.get(first..first + length) {
                    row[x..x + length].copy_from_slice(found);
                }
                x += length;
            }
        }
    }
}

/// Which of the three blocks along an axis a tile coordinate lies in, and where.
#[inline(always)]
pub fn place<E: Stencil>(tile: usize) -> (usize, usize) {
    let node = tile + BLOCK - (-E::BASE) as usize;
    (node / BLOCK, node % BLOCK)
}

/// Which nodal vectors a pass reads.
#[derive(Clone, Copy)]
pub(super) struct Reads {
    pub(super) first: bool,
    pub(super) second: bool,
}

/// The nodal records of one bin's stencil.
pub(super) struct Stencilled<T: Float, E: Stencil> {
    pub(super) first: E::Nodes<[T; 4]>,
    pub(super) second: E::Nodes<[T; 4]>,
}

impl<T: Float, E: Stencil> Stencilled<T, E> {
    #[inline(always)]
    pub(super) fn zero() -> Self {
        Stencilled { first: Array::filled([T::default(); 4]), second: Array::filled([T::default(); 4]) }
    }
    #[inline(always)]
    pub(super) fn load<const D: usize, Q: Quad<T>, S: ShapeFunction<T, D, Extent = E>>(
        &mut self,
        tile: &E::Tile<Node<T>>,
        corner: usize,
        reads: Reads,
    ) {
        let tile = tile.as_ref();
        for k in 0..E::LAYERS {
            for j in 0..E::NODES {
                let row = &tile[corner + (k * E::TILE + j) * E::TILE..][..E::NODES];
                for i in 0..E::NODES {
                    let at = (k * E::NODES + j) * E::NODES + i;
                    if reads.first {
                        self.first[at] = row[i].first;
                    }
                    if reads.second {
                        self.second[at] = row[i].second;
                    }
                }
            }
        }
        if S::POLYNOMIAL && reads.first {
            to_coefficients::<T, D, Q, S>(&mut self.first);
        }
        if S::POLYNOMIAL && reads.second {
            to_coefficients::<T, D, Q, S>(&mut self.second);
        }
    }
}

/// Clear the records of a tile that a pass adds to.
#[inline(always)]
pub(super) fn clear_tile<T: Float, const D: usize, E: Stencil>(tile: &mut [[T; 4]], maps: Maps) {
    let (first, second) = tile.split_at_mut(tile_nodes::<E>(D));
    if maps.momentum {
        first.fill([T::default(); 4]);
    }
    if maps.second() {
        second.fill([T::default(); 4]);
    }
}

/// Add a bin's sums to its block's tile and clear them for the next bin.
#[inline(always)]
pub(super) fn add_to_tile<T: Float, const D: usize, A: Arch<T>, E: Stencil>(
    tile: &mut [[T; 4]],
    corner: usize,
    sums: &mut E::Nodes<[A::Quad; 2]>,
    maps: Maps,
) {
    let (first, second) = tile.split_at_mut(tile_nodes::<E>(D));
    if maps.momentum {
        add_records::<T, A, E>(first, corner, sums, 0);
    }
    if maps.second() {
        add_records::<T, A, E>(second, corner, sums, 1);
    }
}

#[inline(always)]
pub(super) fn add_records<T: Float, A: Arch<T>, E: Stencil>(
    tile: &mut [[T; 4]],
    corner: usize,
    sums: &mut E::Nodes<[A::Quad; 2]>,
    which: usize,
) {
    for k in 0..E::LAYERS {
        for j in 0..E::NODES {
            let row = &mut tile[corner + (k * E::TILE + j) * E::TILE..][..E::NODES];
            for i in 0..E::NODES {
                let sum = &mut sums[(k * E::NODES + j) * E::NODES + i][which];
                (A::Quad::load(&row[i]) + *sum).store(&mut row[i]);
                *sum = A::Quad::zero();
            }
        }
    }
}

/// The tile coordinates that lie in the left, same or right block (0, 1, 2) along an axis.
pub(super) fn thirds<E: Stencil>(which: usize) -> std::ops::Range<usize> {
    let before = (-E::BASE) as usize;
    match which {
        0 => 0..before,
        1 => before..before + BLOCK,
        _ => before + BLOCK..E::TILE,
    }
}

#[inline(always)]
pub(super) fn add_row<T: Float>(
    to: &mut [Node<T>],
    from: &[[T; 4]],
    record: impl Fn(&mut Node<T>) -> &mut [T; 4],
) {
    for (node, add) in to.iter_mut().zip(from) {
        let sum = record(node);
        for i in 0..4 {
            sum[i] += add[i];
        }
    }
}
