//! Levels of the multigrid hierarchy.

use std::sync::Arc;

use impactite_simd::{Float, Team};

use crate::cells::{CellBlocks, MOST, SIDE, slots, stride};
use crate::colours::{BLACK, RED, Relax, half, numbers, offset};

/// Cells per task.
const TASK: usize = 2048;

/// Blocks per task.
pub(crate) const fn group<const D: usize>() -> usize {
    TASK / slots::<D>()
}

/// Coefficients of a level in the order of slots, scaled.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coefficients<const D: usize> {
    /// Weights of the upper faces along each axis, `[axis][slot]` per block.
    pub weights: Vec<f32>,
    /// Dirichlet excess per slot.
    pub excess: Vec<f32>,
    /// Unknowns of each block as bits.
    pub unknown: Vec<u64>,
}

/// Level of the hierarchy: operator, right-hand side and solution, split by colour.
#[derive(Clone, Debug)]
pub(crate) struct Level<const D: usize> {
    pub cells: Arc<CellBlocks<D>>,
    pub natural: Coefficients<D>,
    /// Weights and diagonal of the cells of each colour, `[number][cell]` per block.
    pub coefficients: [Vec<f32>; 2],
    pub b: [Vec<f32>; 2],
    pub x: [Vec<f32>; 2],
}

impl<const D: usize> Level<D> {
    pub fn new(cells: Arc<CellBlocks<D>>) -> Self {
        let mut level = Level {
            cells: CellBlocks::default().into(),
            natural: Coefficients::default(),
            coefficients: Default::default(),
            b: Default::default(),
            x: Default::default(),
        };
        level.resize(cells);
        level
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        let natural = &self.natural;
        let colours = [&self.coefficients, &self.b, &self.x].into_iter().flatten();
        let reals = natural.weights.capacity()
            + natural.excess.capacity()
            + colours.map(Vec::capacity).sum::<usize>();
        4 * reals + 8 * natural.unknown.capacity()
    }

    /// Adapt the arrays to a set of cells.
    pub fn resize(&mut self, cells: Arc<CellBlocks<D>>) {
        let (blocks, h) = (cells.blocks(), half::<D>());
        self.natural.weights.resize(blocks * D * slots::<D>(), 0.0);
        self.natural.excess.resize(blocks * slots::<D>(), 0.0);
        self.natural.unknown.resize(blocks, 0);
        for colour in [RED, BLACK] {
            self.coefficients[colour].resize(blocks * numbers::<D>() * h, 0.0);
            self.b[colour].resize(blocks * h, 0.0);
            self.x[colour].resize(blocks * h, 0.0);
        }
        self.cells = cells;
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.natural.unknown.iter().map(|m| m.count_ones() as usize).sum()
    }

    /// Split the coefficients by colour.
    pub fn split_coefficients(&mut self, team: &Team) {
        let (cells, natural) = (&self.cells, &self.natural);
        let length = numbers::<D>() * half::<D>();
        for (colour, coefficients) in self.coefficients.iter_mut().enumerate() {
            each_block::<D, _>(team, coefficients, length, |block, part| {
                natural.split_block(cells, block, colour, part);
            });
        }
    }

    /// Gauss-Seidel sweep on the red cells, from zero: x = b / d.
    pub fn relax_red_from_zero(&mut self, team: &Team) {
        let h = half::<D>();
        let (b, coefficients) = (&self.b[RED], &self.coefficients[RED]);
        each_block::<D, _>(team, &mut self.x[RED], h, |block, x| {
            let diagonal = &coefficients[(block * numbers::<D>() + 2 * D) * h..][..h];
            let b = &b[block * h..][..h];
            for i in 0..h {
                x[i] = b[i] / diagonal[i];
            }
        });
    }

    /// Gauss-Seidel sweep on the cells of one colour.
    pub fn relax<const C: usize>(&mut self, team: &Team) {
        let (cells, b, coefficients) = (&*self.cells, &self.b[C][..], &self.coefficients[C][..]);
        let [red, black] = &mut self.x;
        let (own, other) = if C == RED { (red, &*black) } else { (black, &*red) };
        each_group::<D, _>(team, own, half::<D>(), |first, x| {
            f32::dispatch(Relax::<D, C> { cells, first, coefficients, b, other, x });
        });
    }

    /// Set b to `scale` r for a vector r in the order of slots.
    pub fn load(&mut self, team: &Team, scale: f64, r: &[f64]) {
        let (n, h) = (slots::<D>(), half::<D>());
        each_pair::<D>(team, &mut self.b, |block, red, black| {
            let r = &r[block * n..][..n];
            for row in 0..h / 2 {
                let first = offset(RED, row);
                for k in 0..2 {
                    red[2 * row + k] = (scale * r[4 * row + 2 * k + first]) as f32;
                    black[2 * row + k] = (scale * r[4 * row + 2 * k + 1 - first]) as f32;
                }
            }
        });
    }

    /// Return `scale` x in the order of slots.
    pub fn store(&self, team: &Team, scale: f64, z: &mut [f64]) {
        let (n, h) = (slots::<D>(), half::<D>());
        let [red, black] = &self.x;
        each_block::<D, _>(team, z, n, |block, z| {
            let (red, black) = (&red[block * h..][..h], &black[block * h..][..h]);
            for row in 0..n / 4 {
                let first = offset(RED, row);
                for k in 0..2 {
                    z[4 * row + 2 * k + first] = scale * f64::from(red[2 * row + k]);
                    z[4 * row + 2 * k + 1 - first] = scale * f64::from(black[2 * row + k]);
                }
            }
        });
    }
}

impl<const D: usize> Coefficients<D> {
    /// Weights of the upper faces of a block along an axis.
    #[inline(always)]
    pub fn upper(&self, block: usize, axis: usize) -> &[f32] {
        let n = slots::<D>();
        &self.weights[(block * D + axis) * n..][..n]
    }

    /// Weights of the lower faces of a block along an axis.
    #[inline(always)]
    pub fn lower(&self, cells: &CellBlocks<D>, block: usize, axis: usize, out: &mut [f32; MOST]) {
        let (n, s) = (slots::<D>(), stride(axis));
        out[s..n].copy_from_slice(&self.upper(block, axis)[..n - s]);
        let beside = cells.block_neighbour(block, axis, false).map(|b| self.upper(b, axis));
        for i in (0..n).step_by(SIDE as usize * s) {
            for k in 0..s {
                out[i + k] = beside.map_or(0.0, |w| w[i + 3 * s + k]);
            }
        }
    }

    /// Coefficients of the cells of one colour in a block.
    fn split_block(&self, cells: &CellBlocks<D>, block: usize, colour: usize, out: &mut [f32]) {
        let (n, h) = (slots::<D>(), half::<D>());
        let (mut lower, mut sums) = ([[0.0; MOST]; 3], [0.0; MOST]);
        for axis in 0..D {
            self.lower(cells, block, axis, &mut lower[axis]);
            let upper = self.upper(block, axis);
            for i in 0..n {
                sums[i] += lower[axis][i] + upper[i];
            }
        }
        let (excess, unknown) = (&self.excess[block * n..(block + 1) * n], self.unknown[block]);
        for row in 0..n / 4 {
            let first = offset(colour, row);
            for k in 0..2 {
                let (slot, i) = (4 * row + 2 * k + first, 2 * row + k);
                for axis in 0..D {
                    let pair = [lower[axis][slot], self.upper(block, axis)[slot]];
                    // Along x, the neighbour in the same place of the row comes first: the upper one for x even.
                    let swap = axis == 0 && first == 0;
                    out[2 * axis * h + i] = pair[usize::from(swap)];
                    out[(2 * axis + 1) * h + i] = pair[usize::from(!swap)];
                }
                // A coarse cell around a whole singular region has no diagonal, and a right-hand side of round-off.
                let diagonal = sums[slot] + excess[slot];
                let active = unknown >> slot & 1 == 1 && diagonal > 0.0;
                out[2 * D * h + i] = if active { diagonal } else { 1.0 };
            }
        }
    }
}

/// Run `task(first block, part)` on the parts of a vector of groups of blocks, `length` entries per block.
pub(crate) fn each_group<const D: usize, X: Send>(
    team: &Team,
    items: &mut [X],
    length: usize,
    task: impl Fn(usize, &mut [X]) + Send + Sync,
) {
    let mut units = vec![(); items.len().div_ceil(group::<D>() * length)];
    team.each_piece(items, group::<D>() * length, &mut units, |i, piece, ()| task(i * group::<D>(), piece));
}

/// Run `task(block, part)` on the parts of a vector, `length` entries per block.
pub(crate) fn each_block<const D: usize, X: Send>(
    team: &Team,
    items: &mut [X],
    length: usize,
    task: impl Fn(usize, &mut [X]) + Send + Sync,
) {
    each_group::<D, X>(team, items, length, |first, piece| {
        for (k, part) in piece.chunks_exact_mut(length).enumerate() {
            task(first + k, part);
        }
    });
}

/// Run `task(block, red, black)` on the parts of a vector that is split by colour.
pub(crate) fn each_pair<const D: usize>(
    team: &Team,
    x: &mut [Vec<f32>; 2],
    task: impl Fn(usize, &mut [f32], &mut [f32]) + Send + Sync,
) {
    let h = half::<D>();
    let [red, black] = x;
    let mut blacks: Vec<&mut [f32]> = black.chunks_mut(group::<D>() * h).collect();
    team.each_piece(red, group::<D>() * h, &mut blacks, |i, red, black| {
        for (k, (red, black)) in red.chunks_exact_mut(h).zip(black.chunks_exact_mut(h)).enumerate() {
            task(i * group::<D>() + k, red, black);
        }
    });
}
