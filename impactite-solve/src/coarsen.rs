//! Coarse operator.

use impactite_simd::Team;

use crate::cells::{CellBlocks, NONE, slots, stride};
use crate::level::{Coefficients, Level, group};
use crate::transfer::Transfer;

/// Largest sum of factors of the interpolation of a cell.
const MOST_FACTORS: f32 = 0.9;

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

/// Slot of a cell in a block, if it has a block.
type Cell = Option<(usize, usize)>;

impl<const D: usize> Source<'_, D> {
    /// Fine block and slot of the child `corner` of a coarse cell: bit a of the corner is the side along axis a.
    #[inline(always)]
    fn child(&self, block: usize, slot: usize, corner: usize) -> Cell {
        let (mut octant, mut inside) = (0, 0);
        for axis in 0..D {
            let x = slot / stride(axis) % 4;
            octant |= (x / 2) << axis;
            inside += (2 * (x % 2) + (corner >> axis & 1)) * stride(axis);
        }
        let child = self.children[block][octant];
        (child != NONE).then_some((child as usize, inside))
    }

    /// Weight of the upper face along `axis` of the child `corner` of a coarse cell.
    #[inline(always)]
    fn weight(&self, cell: Cell, axis: usize, corner: usize) -> f32 {
        let child = cell.and_then(|(block, slot)| self.child(block, slot, corner));
        child.map_or(0.0, |(block, i)| self.fine.upper(block, axis)[i])
    }

    /// Sum of the weights of the upper faces along `axis` of the children at side `up` of a coarse cell.
    #[inline(always)]
    fn sum(&self, cell: Cell, axis: usize, up: usize) -> f32 {
        let corners = (0..1 << D).filter(|corner| corner >> axis & 1 == up);
        corners.map(|corner| self.weight(cell, axis, corner)).sum()
    }

    fn neighbour(&self, block: usize, slot: usize, axis: usize, up: bool) -> Cell {
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
        let (n, mut unknown) = (slots::<D>(), 0);
        excess.fill(0.0);
        weights.fill(0.0);
        factors.fill(0.0);
        for slot in 0..n {
            let child = |corner| self.child(block, slot, corner);
            if !(0..1 << D).filter_map(child).any(|(b, i)| self.fine.unknown[b] >> i & 1 == 1) {
                continue;
            }
            unknown |= 1 << slot;
            let (mut conductances, mut within) = ([[0.0; 2]; D], [0.0; D]);
            for axis in 0..D {
                let cell = Some((block, slot));
                let [below, above] = [false, true].map(|up| self.neighbour(block, slot, axis, up));
                let (lower, upper) = (self.sum(below, axis, 1), self.sum(cell, axis, 1));
                let beyond = [below, above].map(|beside| self.sum(beside, axis, 0));
                within[axis] = self.sum(cell, axis, 0);
                conductances[axis] = [series(lower, beyond[0], 0.0), series(upper, beyond[1], 0.0)];
                weights[axis * n + slot] = series(upper, beyond[1], within[axis]);
            }
            for corner in 0..1 << D {
                excess[slot] += self.excess_of_child(block, slot, corner, &mut conductances);
            }
            let mut sum = 0.0;
            for axis in 0..D {
                let pair = conductances[axis].map(|g| factor(g, within[axis]));
                factors[2 * axis * n + slot] = pair[0];
                factors[(2 * axis + 1) * n + slot] = pair[1];
                sum += pair[0].max(pair[1]);
            }
            if sum > MOST_FACTORS {
                (0..2 * D).for_each(|side| factors[side * n + slot] *= MOST_FACTORS / sum);
            }
        }
        unknown
    }

    /// Excess that a child adds to its coarse cell; its conductances to a Dirichlet boundary are added to those of the cell.
    ///
    /// The excess is shared among the faces of the child that have no weight. A share at a face of the coarse cell is in series with half of
    /// the coarse cell.
    #[inline(always)]
    fn excess_of_child(
        &self,
        block: usize,
        slot: usize,
        corner: usize,
        conductances: &mut [[f32; 2]; D],
    ) -> f32 {
        let Some((b, i)) = self.child(block, slot, corner) else { return 0.0 };
        let excess = self.fine.excess[b * slots::<D>() + i];
        if excess == 0.0 {
            return 0.0;
        }
        // Weights of the faces of the child, inside of the coarse cell and on its boundary.
        let mut faces = [[0.0; 2]; D];
        for axis in 0..D {
            let (lower, upper) = (corner & !(1 << axis), corner | (1 << axis));
            let at_upper = corner >> axis & 1 == 1;
            let beside =
                if at_upper { Some((block, slot)) } else { self.neighbour(block, slot, axis, false) };
            faces[axis] = [self.weight(Some((block, slot)), axis, lower), self.weight(beside, axis, upper)];
        }
        let open = faces.iter().flatten().filter(|w| **w == 0.0).count();
        if open == 0 {
            return excess;
        }
        let (share, mut sum) = (excess / open as f32, 0.0);
        for axis in 0..D {
            let [inner, outer] = faces[axis];
            if inner == 0.0 {
                sum += share;
            }
            if outer == 0.0 {
                sum += series(share, 0.0, inner);
                conductances[axis][corner >> axis & 1] += share;
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

/// Factor of the interpolation, G / (2 G + 4 W), for the conductance G to the neighbour and W within the cell: half of that of linear
/// interpolation.
#[inline(always)]
fn factor(conductance: f32, within: f32) -> f32 {
    if within == 0.0 { 0.0 } else { 0.5 * conductance / (conductance + 2.0 * within) }
}
