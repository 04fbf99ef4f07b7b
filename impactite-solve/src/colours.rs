//! Blocks split by colour, and the Gauss-Seidel sweep on one colour.
//!
//! Cells with an even sum of coordinates are **red**, the others **black**: the 2D neighbours of a cell have the other colour. A vector of a
//! level is two arrays, one per colour, with 4^D / 2 entries per block. The entry of the cell x of row y (y + 4 z in three dimensions) is
//! 2 row + x / 2, so that neighbours along y and z have the same place in their rows, and a sweep over a block is one loop over short arrays.

use impactite_simd::{Arch, Kernel};

use crate::cells::{CellBlocks, slots};

/// Number of colours.
pub(crate) const RED: usize = 0;
pub(crate) const BLACK: usize = 1;

/// Largest number of cells of one colour in a block.
pub(crate) const MOST_HALF: usize = 32;

/// Cells of one colour in a block.
#[inline(always)]
pub(crate) const fn half<const D: usize>() -> usize {
    slots::<D>() / 2
}

/// Numbers per cell: 2D weights and the diagonal.
#[inline(always)]
pub(crate) const fn numbers<const D: usize>() -> usize {
    2 * D + 1
}

/// First x of the cells of a colour in a row: 0 or 1.
#[inline(always)]
pub(crate) const fn offset(colour: usize, row: usize) -> usize {
    (colour ^ row ^ (row >> 2)) & 1
}

/// Entry of a slot in the array of its colour: colour and place in the block.
#[inline(always)]
pub(crate) const fn split(slot: usize) -> (usize, usize) {
    let (x, row) = (slot % 4, slot / 4);
    ((x ^ row ^ (row >> 2)) & 1, 2 * row + x / 2)
}

static ZERO: [f32; MOST_HALF] = [0.0; MOST_HALF];

/// Values of the neighbours of the cells of one colour, in the order of the weights: along x in the same place of the row, along x in another
/// place of the row, lower y, upper y, lower z, upper z.
pub(crate) type Near = [[f32; MOST_HALF]; 6];

/// Gather the neighbours of the cells of colour C in a block from the array of the other colour.
#[inline(always)]
pub(crate) fn gather<const D: usize, const C: usize>(
    cells: &CellBlocks<D>,
    other: &[f32],
    block: usize,
    near: &mut Near,
) {
    let h = half::<D>();
    let part = |b: usize| &other[b * h..][..h];
    let side = |axis, up| cells.block_neighbour(block, axis, up).map_or(&ZERO[..h], part);
    let own = part(block);
    near[0][..h].copy_from_slice(own);
    let (lower, upper) = (side(0, false), side(0, true));
    for row in 0..h / 2 {
        if offset(C, row) == 0 {
            near[1][2 * row] = lower[2 * row + 1];
            near[1][2 * row + 1] = own[2 * row];
        } else {
            near[1][2 * row] = own[2 * row + 1];
            near[1][2 * row + 1] = upper[2 * row];
        }
    }
    let (lower, upper) = (side(1, false), side(1, true));
    near[2][2..h].copy_from_slice(&own[..h - 2]);
    near[3][..h - 2].copy_from_slice(&own[2..]);
    for plane in (0..h).step_by(8) {
        for k in 0..2 {
            near[2][plane + k] = lower[plane + 6 + k];
            near[3][plane + 6 + k] = upper[plane + k];
        }
    }
    if D == 3 {
        let (lower, upper) = (side(2, false), side(2, true));
        near[4][8..h].copy_from_slice(&own[..h - 8]);
        near[4][..8].copy_from_slice(&lower[h - 8..]);
        near[5][..h - 8].copy_from_slice(&own[8..]);
        near[5][h - 8..h].copy_from_slice(&upper[..8]);
    }
}

/// Cells of one loop over vectors.
const LANES: usize = 8;

/// Sums b + sum_f w_f x_n over the neighbours n of the cells of one colour.
#[inline(always)]
pub(crate) fn gauss_seidel_sums<const D: usize>(
    coefficients: &[f32],
    b: &[f32],
    near: &Near,
    sums: &mut [f32; MOST_HALF],
) {
    let h = half::<D>();
    for first in (0..h).step_by(LANES) {
        let mut sum = lanes(b, first);
        for side in 0..2 * D {
            let (weights, values) = (lanes(coefficients, side * h + first), lanes(&near[side], first));
            for i in 0..LANES {
                sum[i] += weights[i] * values[i];
            }
        }
        sums[first..first + LANES].copy_from_slice(&sum);
    }
}

/// Load consecutive numbers.
#[inline(always)]
fn lanes(x: &[f32], first: usize) -> [f32; LANES] {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(&x[first..][..LANES]);
    lanes
}

/// Kernel: Gauss-Seidel update of the cells of colour C in consecutive blocks, x = (b + sum_f w_f x_n) / d.
pub(crate) struct Relax<'a, const D: usize, const C: usize> {
    pub cells: &'a CellBlocks<D>,
    pub first: usize,
    pub coefficients: &'a [f32],
    pub b: &'a [f32],
    /// Values of the other colour.
    pub other: &'a [f32],
    /// Values of these blocks.
    pub x: &'a mut [f32],
}

impl<const D: usize, const C: usize> Kernel<f32> for Relax<'_, D, C> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f32>>(self) {
        let (h, length) = (half::<D>(), numbers::<D>() * half::<D>());
        let (mut near, mut sums) = ([[0.0; MOST_HALF]; 6], [0.0; MOST_HALF]);
        for (k, x) in self.x.chunks_exact_mut(h).enumerate() {
            let block = self.first + k;
            let coefficients = &self.coefficients[block * length..][..length];
            gather::<D, C>(self.cells, self.other, block, &mut near);
            gauss_seidel_sums::<D>(coefficients, &self.b[block * h..][..h], &near, &mut sums);
            let diagonal = &coefficients[2 * D * h..][..h];
            for i in 0..h {
                x[i] = sums[i] / diagonal[i];
            }
        }
    }
}
