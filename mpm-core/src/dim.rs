//! Dimension as a const generic, and the array sizes that stable Rust cannot compute from it.

use std::ops::{Index, IndexMut};

/// Space of `D` dimensions, as a type: `Dim<2>` or `Dim<3>`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dim<const D: usize>;

/// Nodes of a grid block along an axis.
pub const BLOCK: usize = 4;

/// Nodes (and bins) in a block: 4^D.
#[inline(always)]
pub const fn block_nodes(d: usize) -> usize {
    if d == 3 { BLOCK * BLOCK * BLOCK } else { BLOCK * BLOCK }
}

/// Blocks around and including a block: 3^D.
#[inline(always)]
pub const fn neighbours(d: usize) -> usize {
    if d == 3 { 27 } else { 9 }
}

/// Index, relative to the bin, of the first node along an axis of a stencil of `nodes` nodes an axis.
#[inline(always)]
pub const fn first_node(nodes: usize) -> i32 {
    -((nodes as i32 - 1) / 2)
}

/// Offset of bin centres from the nodes in units of h for a stencil of `nodes` nodes an axis: 1/2 for even numbers, 0 for odd ones.
#[inline(always)]
pub const fn centre(nodes: usize) -> f64 {
    if nodes.is_multiple_of(2) { 0.5 } else { 0.0 }
}

/// Offset of node `a` of a stencil of `nodes` nodes an axis from the bin centre, in units of h.
#[inline(always)]
pub const fn offset_of(nodes: usize, a: usize) -> f64 {
    a as f64 - 0.5 * (nodes as f64 - 1.0)
}

/// Array whose length is an associated type of a trait.
pub trait Array<X>:
    Copy + Send + Index<usize, Output = X> + IndexMut<usize> + AsRef<[X]> + AsMut<[X]>
{
    /// Create an array with every element `x`.
    fn filled(x: X) -> Self;
}
impl<X: Copy + Send, const N: usize> Array<X> for [X; N] {
    #[inline(always)]
    fn filled(x: X) -> Self {
        [x; N]
    }
}

/// Sizes of a stencil of `N` nodes an axis in `D` dimensions; implemented by [`Extent`] for N = 2, 3, 4. A shape
/// function specifies its stencil by `type Extent = Extent<D, N>`.
pub trait Stencil: Copy + Send + Sync + 'static {
    /// Nodes along an axis.
    const NODES: usize;
    /// Layers of nodes along the third axis: `NODES` in three dimensions, 1 in two.
    const LAYERS: usize;
    /// Nodes along an axis in reach of the particles of one block of bins: `BLOCK + NODES - 1`.
    const TILE: usize = BLOCK + Self::NODES - 1;
    /// Number of nodes from the first of a stencil in a tile to one past its last, in tile order.
    const SPAN: usize = ((Self::LAYERS - 1) * Self::TILE + Self::NODES - 1) * Self::TILE + Self::NODES;
    /// Index, relative to the bin, of the first node of the stencil along an axis.
    const BASE: i32 = first_node(Self::NODES);
    /// One value per node of the stencil along one axis.
    type Axis<X: Copy + Send>: Array<X>;
    /// One value per node of the stencil.
    type Nodes<X: Copy + Send>: Array<X>;
}

/// The [`Stencil`] of `N` nodes an axis in `D` dimensions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extent<const D: usize, const N: usize>;

macro_rules! stencil {
    ($($d:literal $n:literal $layers:literal $all:literal),*) => {$(
        impl Stencil for Extent<$d, $n> {
            const NODES: usize = $n;
            const LAYERS: usize = $layers;
            type Axis<X: Copy + Send> = [X; $n];
            type Nodes<X: Copy + Send> = [X; $all];
        }
    )*};
}
stencil!(2 2 1 4, 2 3 1 9, 2 4 1 16, 3 2 2 8, 3 3 3 27, 3 4 4 64);

/// Return the offset -1, 0 or 1 along each axis of neighbour `index`.
pub(crate) fn offset<const D: usize>(index: usize) -> [i32; D] {
    let mut o = [0; D];
    let mut rest = index;
    for x in &mut o {
        *x = (rest % 3) as i32 - 1;
        rest /= 3;
    }
    o
}

pub(crate) fn shifted<const D: usize>(c: &[i32; D], by: &[i32; D]) -> [i32; D] {
    let mut r = *c;
    for d in 0..D {
        r[d] += by[d];
    }
    r
}

/// Return the index of node (or bin) `n` of a block in its lattice.
pub(crate) fn node_of<const D: usize>(block: &[i32; D], n: usize) -> [i32; D] {
    let mut rest = n;
    std::array::from_fn(|d| {
        let within = rest % BLOCK;
        rest /= BLOCK;
        block[d] * BLOCK as i32 + within as i32
    })
}

/// Return the block of a node (or bin) of a lattice, and its number there.
pub(crate) fn block_of<const D: usize>(node: &[i32; D]) -> ([i32; D], usize) {
    let within = (0..D).rev().fold(0, |n, d| n * BLOCK + node[d].rem_euclid(BLOCK as i32) as usize);
    (node.map(|x| x.div_euclid(BLOCK as i32)), within)
}
