//! Particles in transit between levels of cells.

use crate::dim::{offset, shifted};
use crate::grid::Levels;
use crate::grid::levels::{Crossing, unpack_block};

/// Particles that entered blocks of another level.
#[derive(Debug, Default)]
pub struct Crossers<T, const D: usize> {
    /// Block and bin of each particle, and its values and contributions, in the order of their source blocks.
    pub(super) list: Vec<([i32; D], usize, Vec<T>)>,
}

/// Return the change of level of particles that go from a block to neighbour `to`, if any.
pub(in crate::step) fn crosses<const D: usize>(
    levels: Option<&Levels<D>>,
    block: &[i32; D],
    to: usize,
) -> Option<Crossing> {
    let (level, block) = unpack_block(block);
    levels?.crossing(level, &shifted(&block, &offset(to)))
}
