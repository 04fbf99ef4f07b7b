//! Symmetric (2D+1)-point operator.

use std::sync::Arc;

use impactite_simd::{Arch, Float, Kernel, Team};

use crate::cells::{CellBlocks, MOST, SIDE, slots, stride};
use crate::error::StencilError;
use crate::operator::Operator;
use crate::regions::{BlockMasks, Regions};
use crate::vectors::{sum_pieces, update};

/// Symmetric (2D+1)-point operator of a finite-volume Poisson equation on the unknown cells of a [`CellBlocks`]:
///
/// ```text
/// (A x)_c = d_c x_c - sum_f w_f x_n,    d_c = sum_f w_f + e_c
/// ```
///
/// with the diagonal d, the weight w_f >= 0 of the face f between the cell c and its neighbour n, and the Dirichlet excess e_c >= 0: w / theta
/// for each face whose boundary value is prescribed at the distance theta h (ghost fluid). Units are those of the caller; A x has the unit of
/// d times that of x. A face weight is stored once, at the cell below its face. A diagonal of zero marks a slot that is no unknown; x and b
/// are zero there.
///
/// A connected region of unknowns without excess is **singular**: constants are its null space. [`Operator::project`] subtracts the mean of
/// every singular region.
#[derive(Clone, Debug)]
pub struct Stencil<const D: usize> {
    cells: Arc<CellBlocks<D>>,
    weights: [Vec<f64>; D],
    diagonal: Vec<f64>,
    regions: Regions,
}

/// An excess below this part of the diagonal is round-off of the sum of 2D weights: (2D + 1) eps, with a factor of ten for sums of the
/// caller.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;

impl<const D: usize> Stencil<D> {
    /// Create the operator: `weights[axis][slot]` is the weight of the face between the cell of the slot and its upper neighbour along
    /// the axis, `diagonal[slot]` the diagonal.
    ///
    /// # Errors
    /// Arrays that do not have one entry per slot; entries that are negative or not finite; weights of faces that lack an unknown on a side;
    /// diagonals below the sum of the weights of the cell.
    pub fn new(
        team: &Team,
        cells: Arc<CellBlocks<D>>,
        weights: [Vec<f64>; D],
        diagonal: Vec<f64>,
    ) -> Result<Self, StencilError> {
        let length = |field, array: &[f64]| match array.len() {
            value if value == cells.cells() => Ok(()),
            value => Err(StencilError::Length { field, value, cells: cells.cells() }),
        };
        weights.iter().try_for_each(|w| length("weights", w))?;
        length("diagonal", &diagonal)?;
        let mut stencil = Stencil { cells, weights, diagonal, regions: Regions::default() };
        let mut masks = vec![BlockMasks::default(); stencil.cells.blocks()];
        team.each(&mut masks, |block, masks| *masks = stencil.inspect(block));
        if let Some(block) = masks.iter().position(|m| m.invalid) {
            return Err(stencil.refuse(block));
        }
        stencil.regions = Regions::find(&stencil.cells, &masks);
        Ok(stencil)
    }

    /// Allocated memory of the coefficients, bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        8 * (self.diagonal.capacity() + self.weights.iter().map(Vec::capacity).sum::<usize>())
    }

    /// Return the arrays of weights and of the diagonal, to be used again.
    #[must_use]
    pub fn into_parts(self) -> ([Vec<f64>; D], Vec<f64>) {
        (self.weights, self.diagonal)
    }

    /// Cells of the operator.
    #[must_use]
    pub fn cells(&self) -> &Arc<CellBlocks<D>> {
        &self.cells
    }

    /// Weights of the upper faces along an axis, one per slot.
    #[must_use]
    pub fn weights(&self, axis: usize) -> &[f64] {
        &self.weights[axis]
    }

    /// Diagonal, one entry per slot.
    #[must_use]
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Number of unknowns: slots with a positive diagonal.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.regions.unknowns()
    }

    /// Number of singular regions: connected regions of unknowns without a Dirichlet boundary.
    #[must_use]
    pub fn singular_regions(&self) -> usize {
        self.regions.len()
    }

    /// Dirichlet excess of the slots of a block, d_c - sum_f w_f, with round-off set to zero.
    pub(crate) fn excess(&self, block: usize) -> [f64; MOST] {
        let n = slots::<D>();
        let (mut lower, mut excess) = ([0.0; MOST], [0.0; MOST]);
        let diagonal = &self.diagonal[block * n..][..n];
        for axis in 0..D {
            self.lower(block, axis, &self.weights[axis], &mut lower);
            let upper = &self.weights[axis][block * n..][..n];
            for i in 0..n {
                excess[i] += lower[i] + upper[i];
            }
        }
        for i in 0..n {
            let e = diagonal[i] - excess[i];
            excess[i] = if e > ROUND_OFF * diagonal[i] { e } else { 0.0 };
        }
        excess
    }

    /// Weights of the lower and upper faces of a slot along each axis.
    pub(crate) fn face_weights(&self, slot: usize) -> [[f64; 2]; D] {
        std::array::from_fn(|axis| {
            let lower = self.cells.neighbour(slot, axis, false).map_or(0.0, |n| self.weights[axis][n]);
            [lower, self.weights[axis][slot]]
        })
    }

    /// Unknowns, couplings and excess of a block as bits, one per slot.
    fn inspect(&self, block: usize) -> BlockMasks {
        let (mut masks, n) = (BlockMasks::default(), slots::<D>());
        let first = block * n;
        let mut sums = [0.0; MOST];
        for axis in 0..D {
            let (mut lower, mut beside) = ([0.0; MOST], [0.0; MOST]);
            self.lower(block, axis, &self.weights[axis], &mut lower);
            self.upper(block, axis, &self.diagonal, &mut beside);
            for i in 0..n {
                let weight = self.weights[axis][first + i];
                let linked = weight > 0.0;
                let both = self.diagonal[first + i] > 0.0 && beside[i] > 0.0;
                masks.invalid |= !(weight >= 0.0 && weight.is_finite()) || (linked && !both);
                masks.coupled[axis] |= u64::from(linked) << i;
                sums[i] += lower[i] + weight;
            }
        }
        for i in 0..n {
            let d = self.diagonal[first + i];
            let excess = d - sums[i];
            masks.invalid |= !(d >= 0.0 && d.is_finite()) || excess < -ROUND_OFF * d;
            masks.unknown |= u64::from(d > 0.0) << i;
            masks.held |= u64::from(excess > ROUND_OFF * d) << i;
        }
        masks
    }

    /// Error of the first invalid entry of a block.
    fn refuse(&self, block: usize) -> StencilError {
        let n = slots::<D>();
        let entry = |field, value, slot: usize, allowed| StencilError::Entry {
            field,
            value,
            cell: self.cells.place(slot).to_vec(),
            allowed,
        };
        let unknown = |slot: usize| self.diagonal[slot] > 0.0;
        for slot in block * n..(block + 1) * n {
            let d = self.diagonal[slot];
            if !(d >= 0.0 && d.is_finite()) {
                return entry("diagonal", d, slot, "finite and not negative");
            }
            for axis in 0..D {
                let w = self.weights[axis][slot];
                if !(w >= 0.0 && w.is_finite()) {
                    return entry("weight", w, slot, "finite and not negative");
                }
                let both = unknown(slot) && self.cells.neighbour(slot, axis, true).is_some_and(unknown);
                if w > 0.0 && !both {
                    return entry("weight", w, slot, "zero on a face without an unknown on each side");
                }
            }
        }
        let short = |slot: &usize| {
            let excess = self.diagonal[*slot] - self.face_weights(*slot).iter().flatten().sum::<f64>();
            excess < -ROUND_OFF * self.diagonal[*slot]
        };
        let slot = (block * n..(block + 1) * n).find(short).unwrap_or(block * n);
        entry(
            "diagonal",
            self.diagonal[slot],
            slot,
            "at least the sum of the weights of the faces of the cell",
        )
    }

    /// Entries of the upper neighbours of the slots of a block along an axis, zero where there is no block.
    #[inline(always)]
    fn upper(&self, block: usize, axis: usize, x: &[f64], out: &mut [f64; MOST]) {
        let (n, s) = (slots::<D>(), stride(axis));
        out[..n - s].copy_from_slice(&x[block * n + s..][..n - s]);
        let beside = self.cells.block_neighbour(block, axis, true).map_or(&ZERO[..n], |b| &x[b * n..][..n]);
        for i in ends::<D>(axis) {
            for k in 0..s {
                out[i + 3 * s + k] = beside[i + k];
            }
        }
    }

    /// Entries of the lower neighbours of the slots of a block along an axis, zero where there is no block.
    #[inline(always)]
    fn lower(&self, block: usize, axis: usize, x: &[f64], out: &mut [f64; MOST]) {
        let (n, s) = (slots::<D>(), stride(axis));
        out[s..n].copy_from_slice(&x[block * n..][..n - s]);
        let beside = self.cells.block_neighbour(block, axis, false).map_or(&ZERO[..n], |b| &x[b * n..][..n]);
        for i in ends::<D>(axis) {
            for k in 0..s {
                out[i + k] = beside[i + 3 * s + k];
            }
        }
    }

    /// Compute A x on a block and return x . A x of it.
    #[inline(always)]
    fn apply_block(&self, block: usize, x: &[f64], y: &mut [f64]) -> f64 {
        let n = slots::<D>();
        let (mut flux, mut near, mut weight) = ([0.0; MOST], [0.0; MOST], [0.0; MOST]);
        for axis in 0..D {
            self.upper(block, axis, x, &mut near);
            let w = &self.weights[axis][block * n..][..n];
            for i in 0..n {
                flux[i] += w[i] * near[i];
            }
            self.lower(block, axis, x, &mut near);
            self.lower(block, axis, &self.weights[axis], &mut weight);
            for i in 0..n {
                flux[i] += weight[i] * near[i];
            }
        }
        let (d, x) = (&self.diagonal[block * n..][..n], &x[block * n..][..n]);
        let y = &mut y[..n];
        let mut sums = [0.0; 4];
        for i in 0..n {
            y[i] = d[i] * x[i] - flux[i];
            sums[i % 4] += x[i] * y[i];
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }
}

static ZERO: [f64; MOST] = [0.0; MOST];

/// First slots of the groups of rows that end at a side of a block: for each of them, the rows 0..s are at the lower and 3 s..4 s at the
/// upper side of the axis with stride s.
#[inline(always)]
fn ends<const D: usize>(axis: usize) -> impl Iterator<Item = usize> {
    (0..slots::<D>()).step_by(SIDE as usize * stride(axis))
}

/// Kernel: A x on consecutive blocks, and x . A x of them.
struct Apply<'a, const D: usize> {
    stencil: &'a Stencil<D>,
    first: usize,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl<const D: usize> Kernel<f64> for Apply<'_, D> {
    type Output = f64;

    #[inline(always)]
    fn run<A: Arch<f64>>(self) -> f64 {
        let mut sum = 0.0;
        for (k, y) in self.y.chunks_exact_mut(slots::<D>()).enumerate() {
            sum += self.stencil.apply_block(self.first + k, self.x, y);
        }
        sum
    }
}

impl<const D: usize> Operator for Stencil<D> {
    fn len(&self) -> usize {
        self.cells.cells()
    }

    fn apply(&self, team: &Team, x: &[f64], y: &mut [f64]) {
        self.apply_dot(team, x, y);
    }

    fn apply_dot(&self, team: &Team, x: &[f64], y: &mut [f64]) -> f64 {
        let n = slots::<D>();
        update(team, y, |start, y| [f64::dispatch(Apply { stencil: self, first: start / n, x, y })])[0]
    }

    fn nullity(&self) -> usize {
        self.regions.len()
    }

    fn unreachable(&self, team: &Team, b: &[f64]) -> Option<usize> {
        let outside = |(b, d): (&f64, &f64)| *b != 0.0 && *d == 0.0;
        let [count] = sum_pieces(team, b.len(), |start, end| {
            let pairs = b[start..end].iter().zip(&self.diagonal[start..end]);
            [pairs.map(|pair| f64::from(u8::from(outside(pair)))).sum()]
        });
        if count == 0.0 { None } else { b.iter().zip(&self.diagonal).position(outside) }
    }

    fn project(&self, team: &Team, x: &mut [f64]) {
        self.regions.subtract_means(team, slots::<D>(), x);
    }
}
