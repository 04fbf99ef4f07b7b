//! Multigrid preconditioner.

use std::sync::Arc;

use impactite_simd::Team;

use crate::cells::{CellBlocks, slots};
use crate::coarsen::coarsen;
use crate::coarsest::{Coarsest, MOST_UNKNOWNS};
use crate::colours::{BLACK, RED};
use crate::level::{Level, each_block};
use crate::operator::Preconditioner;
use crate::stencil::Stencil;
use crate::transfer::Transfer;
use crate::vectors::largest;

/// Sweeps before and after the coarse correction.
const SWEEPS: usize = 2;

/// Symmetric multigrid V-cycle as a preconditioner of a [`Stencil`], z = M^-1 r in the unit of x.
///
/// The crate documentation has the algorithm, its sources and costs. Memory: 67 bytes per slot of a block in space, 65 in the plane.
#[derive(Clone, Debug)]
pub struct Multigrid<const D: usize> {
    levels: Vec<Level<D>>,
    transfers: Vec<Transfer<D>>,
    coarsest: Coarsest,
    /// Largest diagonal of the operator, by which it is divided.
    scale: f64,
}

impl<const D: usize> Multigrid<D> {
    /// Create the levels of an operator: coarse operators, interpolation, and the factorisation of the coarsest level.
    #[must_use]
    pub fn new(team: &Team, stencil: &Stencil<D>) -> Self {
        let mut multigrid = Multigrid {
            levels: Vec::new(),
            transfers: Vec::new(),
            coarsest: Coarsest::default(),
            scale: 1.0,
        };
        multigrid.renew(team, stencil);
        multigrid
    }

    /// Allocated memory, bytes, without that of the cells.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let levels = self.levels.iter().map(Level::bytes).sum::<usize>();
        levels + self.transfers.iter().map(Transfer::bytes).sum::<usize>() + self.coarsest.bytes()
    }

    /// Create the levels of another operator, of any cells, in the memory of this one. Results do not depend on the previous operator.
    pub fn renew(&mut self, team: &Team, stencil: &Stencil<D>) {
        self.scale = largest(team, stencil.diagonal());
        if self.scale == 0.0 {
            self.scale = 1.0;
        }
        self.adapt(0, stencil.cells().clone());
        self.read(team, stencil);
        let mut depth = 0;
        loop {
            self.levels[depth].split_coefficients(team);
            if self.levels[depth].unknowns() <= MOST_UNKNOWNS {
                break;
            }
            let coarse = self.coarse_cells(depth);
            self.adapt(depth + 1, coarse);
            if self.transfers.len() == depth {
                self.transfers.push(Transfer::default());
            }
            let (fine, coarse) = self.levels.split_at_mut(depth + 1);
            let (fine, coarse, transfer) = (&fine[depth], &mut coarse[0], &mut self.transfers[depth]);
            transfer.resize(&fine.cells, &coarse.cells);
            coarsen(team, fine, coarse, transfer);
            depth += 1;
        }
        self.levels.truncate(depth + 1);
        self.transfers.truncate(depth);
        let coarsest = &mut self.levels[depth];
        // The direct solve writes unknowns only.
        coarsest.x.iter_mut().for_each(|x| x.fill(0.0));
        self.coarsest.renew(coarsest);
    }

    /// Cells of the next coarser level.
    fn coarse_cells(&self, depth: usize) -> Arc<CellBlocks<D>> {
        let fine = &self.levels[depth].cells;
        let keys = (0..fine.blocks()).map(|b| fine.key(b).map(|x| x.div_euclid(2)));
        Arc::new(CellBlocks::of_blocks(keys))
    }

    fn adapt(&mut self, depth: usize, cells: Arc<CellBlocks<D>>) {
        match self.levels.get_mut(depth) {
            Some(level) => level.resize(cells),
            None => self.levels.push(Level::new(cells)),
        }
    }

    /// Read the coefficients of the finest level, divided by the largest diagonal.
    fn read(&mut self, team: &Team, stencil: &Stencil<D>) {
        let (n, scale) = (slots::<D>(), 1.0 / self.scale);
        let natural = &mut self.levels[0].natural;
        each_block::<D, _>(team, &mut natural.weights, D * n, |block, weights| {
            for axis in 0..D {
                let from = &stencil.weights(axis)[block * n..][..n];
                for i in 0..n {
                    weights[axis * n + i] = (scale * from[i]) as f32;
                }
            }
        });
        each_block::<D, _>(team, &mut natural.excess, n, |block, excess| {
            for (e, from) in excess.iter_mut().zip(stencil.excess(block)) {
                *e = (scale * from) as f32;
            }
        });
        each_block::<D, _>(team, &mut natural.unknown, 1, |block, unknown| {
            let from = &stencil.diagonal()[block * n..][..n];
            unknown[0] = from.iter().enumerate().fold(0, |m, (i, d)| m | u64::from(*d > 0.0) << i);
        });
    }

    /// Apply a cycle to the level `depth`, from zero.
    fn cycle(&mut self, team: &Team, depth: usize) {
        if depth == self.transfers.len() {
            self.coarsest.solve(&mut self.levels[depth]);
            return;
        }
        let level = &mut self.levels[depth];
        level.relax_red_from_zero(team);
        level.relax::<BLACK>(team);
        for _ in 1..SWEEPS {
            level.relax::<RED>(team);
            level.relax::<BLACK>(team);
        }
        let (fine, coarse) = self.levels.split_at_mut(depth + 1);
        self.transfers[depth].restrict(team, &fine[depth], &mut coarse[0]);
        self.cycle(team, depth + 1);
        let (fine, coarse) = self.levels.split_at_mut(depth + 1);
        self.transfers[depth].prolong(team, &coarse[0], &mut fine[depth]);
        for _ in 0..SWEEPS {
            fine[depth].relax::<BLACK>(team);
            fine[depth].relax::<RED>(team);
        }
    }
}

impl<const D: usize> Preconditioner for Multigrid<D> {
    fn apply(&mut self, team: &Team, r: &[f64], z: &mut [f64]) {
        let size = largest(team, r);
        if size == 0.0 {
            z.fill(0.0);
            return;
        }
        self.levels[0].load(team, 1.0 / size, r);
        self.cycle(team, 0);
        self.levels[0].store(team, size / self.scale, z);
    }
}
