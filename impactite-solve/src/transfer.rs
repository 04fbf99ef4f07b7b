//! Transfer between a level and the next coarser one.

use impactite_simd::{Arch, Float, Kernel, Team};

use crate::cells::{CellBlocks, MOST, NONE, SIDE, slots, stride};
use crate::colours::{BLACK, MOST_HALF, RED, gather, gauss_seidel_sums, half, numbers, offset};
use crate::level::{Level, each_group, each_pair, group};

/// Values of the cells of a block in the order of slots, one array per side: lower x, upper x, lower y, ...
type Sides = [[f32; MOST]; 6];

/// Prolongation P from a coarse level and restriction P^T to it.
///
/// A fine cell on the sides s_1 .. s_D of its coarse cell C takes the value
///
/// ```text
/// x = (1 - sum_a t_a) x_C + sum_a t_a x_N(a),
/// ```
///
/// with the neighbours N(a) of C on these sides. On a uniform grid t = 1/8, half of what interpolates linear functions exactly. Factors follow
/// from conductances (`coarsen`). Where there is no neighbour, x_N = 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Transfer<const D: usize> {
    /// Fine blocks of each coarse block, by octant.
    pub children: Vec<[u32; 8]>,
    /// First entries of the fine arrays of one colour for each group of coarse blocks.
    starts: Vec<u32>,
    /// Factors t, `[side][slot]` per coarse block.
    pub factors: Vec<f32>,
    /// Sums of residuals: those that go to each neighbour, and the sum of all, `[side][slot]` per coarse block.
    flux: Vec<f32>,
}

impl<const D: usize> Transfer<D> {
    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        let words = self.starts.capacity() + self.factors.capacity() + self.flux.capacity();
        4 * words + 32 * self.children.capacity()
    }

    /// Adapt the arrays to sets of cells.
    pub fn resize(&mut self, fine: &CellBlocks<D>, coarse: &CellBlocks<D>) {
        let (n, h) = (slots::<D>(), half::<D>());
        self.factors.resize(coarse.blocks() * 2 * D * n, 0.0);
        self.flux.resize(coarse.blocks() * (2 * D + 1) * n, 0.0);
        self.children.clear();
        self.children.resize(coarse.blocks(), [NONE; 8]);
        self.starts.clear();
        let mut parent = 0;
        for block in 0..fine.blocks() {
            let key = fine.key(block);
            // Blocks of a parent are consecutive, in the order of the parents.
            while coarse.key(parent) != key.map(|x| x.div_euclid(2)) {
                parent += 1;
            }
            let octant: usize = (0..D).map(|axis| (key[axis].rem_euclid(2) as usize) << axis).sum();
            self.children[parent][octant] = block as u32;
            while self.starts.len() * group::<D>() <= parent {
                self.starts.push((block * h) as u32);
            }
        }
        self.starts.push((fine.blocks() * h) as u32);
    }

    /// Restrict the residual of the fine level to the right-hand side of the coarse one. The residual of black cells is zero, that is after
    /// a sweep on them.
    pub fn restrict(&mut self, team: &Team, fine: &Level<D>, coarse: &mut Level<D>) {
        let (children, factors) = (&self.children[..], &self.factors[..]);
        each_group::<D, _>(team, &mut self.flux, (2 * D + 1) * slots::<D>(), |first, flux| {
            f32::dispatch(Restrict { fine, children, factors, first, flux });
        });
        self.assemble(team, coarse);
    }

    /// Right-hand side of the coarse level from the sums of residuals.
    fn assemble(&self, team: &Team, coarse: &mut Level<D>) {
        let (cells, unknown) = (&coarse.cells, &coarse.natural.unknown);
        each_pair::<D>(team, &mut coarse.b, |block, red, black| {
            let b = self.assemble_block(cells, block);
            let value = |slot: usize| if unknown[block] >> slot & 1 == 1 { b[slot] } else { 0.0 };
            for row in 0..half::<D>() / 2 {
                let first = offset(RED, row);
                for k in 0..2 {
                    red[2 * row + k] = value(4 * row + 2 * k + first);
                    black[2 * row + k] = value(4 * row + 2 * k + 1 - first);
                }
            }
        });
    }

    #[inline(always)]
    fn assemble_block(&self, cells: &CellBlocks<D>, block: usize) -> [f32; MOST] {
        let n = slots::<D>();
        let part = |b: usize, side: usize| &self.flux[(b * (2 * D + 1) + side) * n..][..n];
        let mut b = [0.0; MOST];
        b[..n].copy_from_slice(part(block, 2 * D));
        for side in 0..2 * D {
            let (axis, s) = (side / 2, stride(side / 2));
            let own = part(block, side);
            for i in 0..n {
                b[i] -= own[i];
            }
            // Contributions of neighbours to this block: those above their lower, those below their upper side.
            let beside = cells.block_neighbour(block, axis, side % 2 == 0);
            if side % 2 == 0 {
                for i in 0..n - s {
                    b[i] += if i / s % 4 == 3 { 0.0 } else { own[i + s] };
                }
            } else {
                for i in s..n {
                    b[i] += if i / s % 4 == 0 { 0.0 } else { own[i - s] };
                }
            }
            if let Some(beside) = beside {
                let beside = part(beside, side);
                for i in (0..n).step_by(SIDE as usize * s) {
                    for k in 0..s {
                        if side % 2 == 0 {
                            b[i + 3 * s + k] += beside[i + k];
                        } else {
                            b[i + k] += beside[i + 3 * s + k];
                        }
                    }
                }
            }
        }
        b
    }

    /// Add the interpolated coarse solution to the red cells of the fine level. The black ones follow from a sweep on them.
    pub fn prolong(&self, team: &Team, coarse: &Level<D>, fine: &mut Level<D>) {
        let (count, group) = (coarse.cells.blocks(), group::<D>());
        let mut units = vec![(); self.starts.len() - 1];
        team.each_part(&mut fine.x[RED], &self.starts, &mut units, |i, x, ()| {
            let blocks = [i * group, count.min((i + 1) * group)];
            f32::dispatch(Prolong { transfer: self, coarse, blocks, base: self.starts[i] as usize, x });
        });
    }
}

/// Kernel: sums of residuals of consecutive coarse blocks.
struct Restrict<'a, const D: usize> {
    fine: &'a Level<D>,
    children: &'a [[u32; 8]],
    factors: &'a [f32],
    first: usize,
    flux: &'a mut [f32],
}

impl<const D: usize> Kernel<f32> for Restrict<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f32>>(self) {
        let n = slots::<D>();
        for (k, flux) in self.flux.chunks_exact_mut((2 * D + 1) * n).enumerate() {
            let (block, mut sides) = (self.first + k, [[0.0; MOST]; 6]);
            for octant in 0..1 << D {
                let child = self.children[block][octant];
                if child != NONE {
                    add_residual::<D>(self.fine, child as usize, octant, &mut sides);
                }
            }
            let factors = &self.factors[block * 2 * D * n..][..2 * D * n];
            for side in 0..2 * D {
                for i in 0..n {
                    flux[side * n + i] = factors[side * n + i] * sides[side][i];
                }
            }
            for i in 0..n {
                flux[2 * D * n + i] = sides[0][i] + sides[1][i];
            }
        }
    }
}

/// Kernel: interpolation from consecutive coarse blocks to the red cells of their children.
struct Prolong<'a, const D: usize> {
    transfer: &'a Transfer<D>,
    coarse: &'a Level<D>,
    /// First coarse block, and the one after the last.
    blocks: [usize; 2],
    /// First entry of `x` in the fine array.
    base: usize,
    x: &'a mut [f32],
}

impl<const D: usize> Kernel<f32> for Prolong<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f32>>(self) {
        let (n, h) = (slots::<D>(), half::<D>());
        let (mut own, mut sides) = ([0.0; MOST], [[0.0; MOST]; 6]);
        for block in self.blocks[0]..self.blocks[1] {
            let factors = &self.transfer.factors[block * 2 * D * n..][..2 * D * n];
            differences::<D, RED>(self.coarse, block, factors, &mut own, &mut sides);
            differences::<D, BLACK>(self.coarse, block, factors, &mut own, &mut sides);
            for octant in 0..1 << D {
                let child = self.transfer.children[block][octant];
                if child != NONE {
                    let x = &mut self.x[child as usize * h - self.base..][..h];
                    add_interpolated::<D>(octant, &own, &sides, x);
                }
            }
        }
    }
}

/// Coarse slot of the first cell of a fine row in an octant, and the sides of the red cells of this row along each axis.
#[inline(always)]
fn parent<const D: usize>(octant: usize, row: usize) -> (usize, [usize; 3]) {
    let (y, z) = (row % 4, row / 4);
    let origin = |axis: usize| 2 * (octant >> axis & 1);
    let mut slot = origin(0) + 4 * (origin(1) + y / 2);
    if D == 3 {
        slot += 16 * (origin(2) + z / 2);
    }
    (slot, [offset(RED, row), 2 + y % 2, 4 + z % 2])
}

/// Add the residual of the red cells of a fine block to the sums of its parent.
#[inline(always)]
fn add_residual<const D: usize>(fine: &Level<D>, block: usize, octant: usize, sides: &mut Sides) {
    let h = half::<D>();
    let (mut near, mut r) = ([[0.0; MOST_HALF]; 6], [0.0; MOST_HALF]);
    let coefficients = &fine.coefficients[RED][block * numbers::<D>() * h..][..numbers::<D>() * h];
    gather::<D, RED>(&fine.cells, &fine.x[BLACK], block, &mut near);
    gauss_seidel_sums::<D>(coefficients, &fine.b[RED][block * h..][..h], &near, &mut r);
    let x = &fine.x[RED][block * h..][..h];
    for i in 0..h {
        r[i] -= coefficients[2 * D * h + i] * x[i];
    }
    for row in 0..h / 2 {
        let (slot, at) = parent::<D>(octant, row);
        for side in &at[..D] {
            for k in 0..2 {
                sides[*side][slot + k] += r[2 * row + k];
            }
        }
    }
}

/// Add interpolated values to the red cells of a fine block.
#[inline(always)]
fn add_interpolated<const D: usize>(octant: usize, own: &[f32; MOST], sides: &Sides, x: &mut [f32]) {
    for row in 0..half::<D>() / 2 {
        let (slot, at) = parent::<D>(octant, row);
        for k in 0..2 {
            let mut value = own[slot + k];
            for side in &at[..D] {
                value += sides[*side][slot + k];
            }
            x[2 * row + k] += value;
        }
    }
}

/// Values x_C of the coarse cells of colour C and differences t (x_N - x_C) to their neighbours on each side.
#[inline(always)]
fn differences<const D: usize, const C: usize>(
    coarse: &Level<D>,
    block: usize,
    factors: &[f32],
    own: &mut [f32; MOST],
    sides: &mut Sides,
) {
    let (n, h) = (slots::<D>(), half::<D>());
    let mut near = [[0.0; MOST_HALF]; 6];
    gather::<D, C>(&coarse.cells, &coarse.x[1 - C], block, &mut near);
    let x = &coarse.x[C][block * h..][..h];
    for row in 0..h / 2 {
        let first = offset(C, row);
        for k in 0..2 {
            let (slot, i) = (4 * row + 2 * k + first, 2 * row + k);
            own[slot] = x[i];
            for side in 0..2 * D {
                // Along x, the neighbour in the same place of the row is the upper one for x even.
                let from = if side < 2 && first == 0 { 1 - side } else { side };
                sides[side][slot] = factors[side * n + slot] * (near[from][i] - x[i]);
            }
        }
    }
}
