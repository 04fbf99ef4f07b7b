//! Coarse operator.

use impactite_simd::Team;

use crate::cells::{CellBlocks, NONE, slots, stride};
use crate::level::{Coefficients, Level, group};
use crate::transfer::Transfer;

/// Largest sum of factors of the interpolation of a cell.
pub const MOST_FACTORS: f32 = 0.9;

/// Arrays of a group of coarse blocks.
struct Part<'a> {
    weights: &'a mut [f32],
    excess: &'a mut [f32],
    unknown: &'a mut [u64],
    factors: &'a mut [f32],
}

/// Compute the operator of the coarse level and the factors of the interpolation from it.
pub(crate) fn coarsen<const D: usize>(
    team: &Team,
    fine: &Level<D>,
    coarse: &mut Level<D>,
    transfer: &mut Transfer<D>,
) {
    let (n, group) = (slots::<D>(), group::<D>());
    let source = Source { cells: &coarse.cells, children: &transfer.children, fine: &fine.natural };
    let natural = &mut coarse.natural;
    let mut parts: Vec<Part> = natural
        .weights
        .chunks_mut(group * D * n)
        .zip(natural.excess.chunks_mut(group * n))
        .zip(natural.unknown.chunks_mut(group))
        .zip(transfer.factors.chunks_mut(group * 2 * D * n))
        .map(|(((weights, excess), unknown), factors)| Part { weights, excess, unknown, factors })
        .collect();
    team.each(&mut parts, |i, part| {
        for (k, unknown) in part.unknown.iter_mut().enumerate() {
            *unknown = source.coarsen_block(
                i * group + k,
                &mut part.weights[k * D * n..][..D * n],
                &mut part.excess[k * n..][..n],
                &mut part.factors[k * 2 * D * n..][..2 * D * n],
            );
        }
    });
}

struct Source<'a, const D: usize> {
    cells: &'a CellBlocks<D>,
    children: &'a [[u32; 8]],
    fine: &'a Coefficients<D>,
}

/// Largest number of fine faces of a coarse face.
const COLUMNS: usize = 4;

impl<const D: usize> Source<'_, D> {
    /// Fine block and slot of the child `corner` of a coarse cell.
    #[inline(always)]
    fn child(&self, block: usize, slot: usize, corner: usize) -> Option<(usize, usize)> {
        let (mut octant, mut inside) = (0, 0);
        for axis in 0..D {
            let x = slot / stride(axis) % 4;
            octant |= (x / 2) << axis;
            inside += (2 * (x % 2) + (corner >> axis & 1)) * stride(axis);
        }
        let child = self.children[block][octant];
        (child != NONE).then_some((child as usize, inside))
    }

    /// Weights of the upper faces along `axis` of the children of a coarse cell that are at side `up` of it.
    #[inline(always)]
    fn columns(&self, cell: Option<(usize, usize)>, axis: usize, up: usize) -> [f32; COLUMNS] {
        let mut weights = [0.0; COLUMNS];
        let Some((block, slot)) = cell else { return weights };
        for (j, weight) in weights[..1 << (D - 1)].iter_mut().enumerate() {
            let low = j & ((1 << axis) - 1);
            let corner = low | (up << axis) | ((j >> axis) << (axis + 1));
            *weight = self.child(block, slot, corner).map_or(0.0, |(b, i)| self.fine.upper(b, axis)[i]);
        }
        weights
    }

    fn neighbour(&self, block: usize, slot: usize, axis: usize, up: bool) -> Option<(usize, usize)> {
        let n = slots::<D>();
        self.cells.neighbour(block * n + slot, axis, up).map(|s| (s / n, s % n))
    }

    /// Compute the coefficients of a coarse block; return its unknowns.
    fn coarsen_block(
        &self,
        block: usize,
        weights: &mut [f32],
        excess: &mut [f32],
        factors: &mut [f32],
    ) -> u64 {
        let n = slots::<D>();
        let mut unknown = 0;
        for slot in 0..n {
            let mut active = false;
            for corner in 0..1 << D {
                active |=
                    self.child(block, slot, corner).is_some_and(|(b, i)| self.fine.unknown[b] >> i & 1 == 1);
            }
            unknown |= u64::from(active) << slot;
            excess[slot] = 0.0;
            for k in 0..2 * D {
                factors[k * n + slot] = 0.0;
            }
            if !active {
                (0..D).for_each(|axis| weights[axis * n + slot] = 0.0);
                continue;
            }
            let mut conductance = [[0.0; 2]; D];
            let mut within = [0.0; D];
            for axis in 0..D {
                let inner = self.columns(Some((block, slot)), axis, 0);
                let cross = [
                    self.columns(self.neighbour(block, slot, axis, false), axis, 1),
                    self.columns(Some((block, slot)), axis, 1),
                ];
                let beyond =
                    [false, true].map(|up| self.columns(self.neighbour(block, slot, axis, up), axis, 0));
                let mut weight = 0.0;
                for j in 0..1 << (D - 1) {
                    within[axis] += inner[j];
                    for up in 0..2 {
                        conductance[axis][up] += series(cross[up][j], beyond[up][j], 0.0);
                    }
                    weight += series(cross[1][j], beyond[1][j], inner[j]);
                }
                weights[axis * n + slot] = weight;
            }
            for corner in 0..1 << D {
                excess[slot] += self.excess_of_child(block, slot, corner, &mut conductance);
            }
            let mut sum = 0.0;
            for axis in 0..D {
                let pair = conductance[axis].map(|g| factor(g, within[axis]));
                for up in 0..2 {
                    factors[(2 * axis + up) * n + slot] = pair[up];
                }
                sum += pair[0].max(pair[1]);
            }
            if sum > MOST_FACTORS {
                for side in 0..2 * D {
                    factors[side * n + slot] *= MOST_FACTORS / sum;
                }
            }
        }
        unknown
    }

    /// Excess that a child adds to its coarse cell, and conductances to the Dirichlet boundary.
    #[inline(always)]
    fn excess_of_child(
        &self,
        block: usize,
        slot: usize,
        corner: usize,
        conductance: &mut [[f32; 2]; D],
    ) -> f32 {
        let Some((b, i)) = self.child(block, slot, corner) else { return 0.0 };
        let e = self.fine.excess[b * slots::<D>() + i];
        if e == 0.0 {
            return 0.0;
        }
        // Weights of the faces of the child, those inside of the coarse cell and those on its boundary.
        let mut faces = [[0.0; 2]; D];
        for axis in 0..D {
            let up = corner >> axis & 1;
            let of = |corner: usize, cell: Option<(usize, usize)>| {
                cell.and_then(|(b, s)| self.child(b, s, corner))
                    .map_or(0.0, |(b, i)| self.fine.upper(b, axis)[i])
            };
            let (low, high) = (corner & !(1 << axis), corner | (1 << axis));
            let inner = of(low, Some((block, slot)));
            let outer = if up == 1 {
                of(high, Some((block, slot)))
            } else {
                of(high, self.neighbour(block, slot, axis, false))
            };
            faces[axis] = [inner, outer];
        }
        let open = faces.iter().flatten().filter(|w| **w == 0.0).count();
        if open == 0 {
            return e;
        }
        let share = e / open as f32;
        let mut sum = 0.0;
        for axis in 0..D {
            let [inner, outer] = faces[axis];
            if inner == 0.0 {
                sum += share;
            }
            if outer == 0.0 {
                sum += series(share, 0.0, inner);
                conductance[axis][corner >> axis & 1] += share;
            }
        }
        sum
    }
}

/// Conductance of a face with weight w between half cells with inner weights a and b, 1 / (1/w + 1/(2 a) + 1/(2 b)), where the half cell of
/// a zero weight is left out.
#[inline(always)]
fn series(w: f32, a: f32, b: f32) -> f32 {
    if w == 0.0 {
        return 0.0;
    }
    let half = |a: f32| if a == 0.0 { 0.0 } else { 0.5 / a };
    1.0 / (1.0 / w + half(a) + half(b))
}

/// Factor of the interpolation, G / (G + 2 W), for the conductance G to the neighbour and W within the cell.
#[inline(always)]
fn factor(conductance: f32, within: f32) -> f32 {
    if within == 0.0 { 0.0 } else { conductance / (conductance + 2.0 * within) }
}
