//! Poisson equation of the pressure: ghost-fluid surface, open fractions of faces.
//!
//! With the unknown q = p dt / (rho h), in m/s, a face velocity after the projection is u - (q_up - q_low) / theta, with theta = 1 between
//! liquid cells. At a surface theta is the share of the distance between cell centres that is liquid, at least 0.01, and the value in the air
//! is that of the surface (\[Gibou2002\]). A row of the system is
//!
//! ```text
//! sum_f alpha_f (q_c - q_f) / theta_f = -sum_f +-(alpha_f u_f + (1 - alpha_f) w_f)
//! ```
//!
//! with the open fraction alpha (\[Batty2007\], \[Ng2009\]) and the wall velocity w.

use std::sync::Arc;

use impactite_simd::Team;
use impactite_solve::{
    CellBlocks, Jacobi, Multigrid, Operator, SolveError, Stencil, StencilError, Stop, conjugate_gradients,
};

use crate::blocks::{Blocks, NONE, TILE_CELLS, in_tile, local, stride};
use crate::coupled::{Column, Coupled};
use crate::surface::{AIR, LIQUID, SOLID};

/// Smallest theta of a surface.
pub(crate) const SMALLEST: f64 = 0.01;
/// Largest number of iterations.
const ITERATIONS: usize = 400;
/// Largest number of iterations in periodic scenes, which have the Jacobi preconditioner.
const PERIODIC_ITERATIONS: usize = 20_000;

/// Liquid share of the distance from a liquid cell to another one, by their level sets.
#[inline(always)]
pub(crate) fn theta(liquid: f64, air: f64) -> f64 {
    (liquid / (liquid - air.max(0.0))).max(SMALLEST)
}

/// Failed solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum PressureError {
    #[error(transparent)]
    Solve(#[from] SolveError),
    #[error(transparent)]
    Stencil(#[from] StencilError),
}

/// Geometry of the system: kinds of cells, level set, open fractions of the lower faces.
#[derive(Clone, Copy)]
pub(crate) struct Cells<'a, const D: usize> {
    pub blocks: &'a Blocks<D>,
    pub kind: &'a [u8],
    pub level: &'a [f64],
    pub open: &'a [Vec<f64>; D],
    /// Value of q at the surface, near each cell; none for zero.
    pub surface: Option<&'a [f64]>,
}

/// Place of a cell in the system; none if it is not in it.
pub(crate) type Place<'a> = dyn Fn(u32) -> Option<u32> + 'a;
/// Columns of free rigid bodies, by the places of cells.
pub(crate) type Columns<'a> = dyn Fn(&Place<'_>, &mut Vec<Column>) + 'a;

/// Operator of a periodic scene, on all cells of the grid.
struct Periodic<'a, const D: usize> {
    blocks: &'a Blocks<D>,
    weights: [Vec<f64>; D],
    diagonal: Vec<f64>,
    /// True without a surface: constants are the null space.
    singular: bool,
}

impl<const D: usize> Operator for Periodic<'_, D> {
    fn nullity(&self) -> usize {
        usize::from(self.singular)
    }
    fn project(&self, _: &Team, x: &mut [f64]) {
        if !self.singular {
            return;
        }
        let unknown = |n: &usize| self.diagonal[*n] > 0.0;
        let count = (0..x.len()).filter(unknown).count().max(1) as f64;
        let mean = (0..x.len()).filter(unknown).map(|n| x[n]).sum::<f64>() / count;
        (0..x.len()).filter(unknown).for_each(|n| x[n] -= mean);
    }
    fn len(&self) -> usize {
        self.diagonal.len()
    }
    fn apply(&self, team: &Team, x: &[f64], y: &mut [f64]) {
        let cells = Blocks::<D>::CELLS;
        team.each_piece(y, cells, &mut vec![(); self.blocks.len()], |b, y, ()| {
            for (i, y) in y.iter_mut().enumerate() {
                let slot = b * cells + i;
                let mut sum = self.diagonal[slot] * x[slot];
                for d in 0..D {
                    if let Some(up) = self.blocks.beside(b, i, d, true) {
                        sum -= self.weights[d][slot] * x[up];
                    }
                    if let Some(low) = self.blocks.beside(b, i, d, false) {
                        sum -= self.weights[d][low] * x[low];
                    }
                }
                *y = sum;
            }
        });
    }
}

/// System of a step, with its memory.
#[derive(Debug)]
pub(crate) struct System<const D: usize> {
    /// Index among all blocks of each block of the system.
    mine: Vec<u32>,
    cells: Arc<CellBlocks<D>>,
    stencil: Option<Stencil<D>>,
    multigrid: Option<Multigrid<D>>,
    parts: ([Vec<f64>; D], Vec<f64>),
    right: Vec<f64>,
    unknown: Vec<f64>,
    /// True if a periodic scene has no surface.
    closed: bool,
    /// Number of liquid cells.
    pub unknowns: usize,
    /// Iterations of the last solves: pressure, density.
    pub iterations: [usize; 2],
}

impl<const D: usize> Default for System<D> {
    fn default() -> Self {
        System {
            mine: Vec::new(),
            cells: Arc::new(CellBlocks::of_blocks([])),
            stencil: None,
            multigrid: None,
            parts: (std::array::from_fn(|_| Vec::new()), Vec::new()),
            right: Vec::new(),
            unknown: Vec::new(),
            closed: false,
            unknowns: 0,
            iterations: [0; 2],
        }
    }
}

impl<const D: usize> Clone for System<D> {
    /// An empty system: it is assembled anew in every step.
    fn clone(&self) -> Self {
        System::default()
    }
}

impl<const D: usize> System<D> {
    /// Assemble the matrix.
    ///
    /// # Errors
    /// Entries that are not finite.
    pub fn assemble(&mut self, team: &Team, at: &Cells<'_, D>, periodic: bool) -> Result<(), PressureError> {
        let (blocks, cells) = (at.blocks, Blocks::<D>::CELLS);
        self.unknowns = at.kind.iter().filter(|k| **k == LIQUID).count();
        self.mine.clear();
        if periodic {
            self.mine.extend(0..blocks.len() as u32);
            self.cells = Arc::new(CellBlocks::of_blocks([]));
        } else {
            let wet: Vec<u32> = (0..blocks.len() as u32)
                .filter(|b| at.kind[*b as usize * cells..(*b as usize + 1) * cells].contains(&LIQUID))
                .collect();
            let keys = wet.iter().map(|b| blocks.keys[*b as usize]);
            self.cells = Arc::new(CellBlocks::of_blocks(keys));
            self.mine.resize(wet.len(), NONE);
            for b in wet {
                if let Some(n) = self.cells.find_block(blocks.keys[b as usize]) {
                    self.mine[n] = b;
                }
            }
        }
        if let Some(stencil) = self.stencil.take() {
            self.parts = stencil.into_parts();
        }
        let (mut weights, mut diagonal) =
            std::mem::replace(&mut self.parts, (crate::blocks::faces(), Vec::new()));
        let slots = self.mine.len() * cells;
        for list in weights.iter_mut().chain([&mut diagonal]) {
            list.clear();
            list.resize(slots, 0.0);
        }
        self.fill(team, at, &mut weights, &mut diagonal);
        self.right.resize(slots, 0.0);
        self.unknown.resize(slots, 0.0);
        if periodic {
            self.closed = closed(&self.mine, at);
            self.parts = (weights, diagonal);
            return Ok(());
        }
        let stencil = Stencil::new(team, self.cells.clone(), weights, diagonal)?;
        match &mut self.multigrid {
            Some(multigrid) => multigrid.renew(team, &stencil),
            none => *none = Some(Multigrid::new(team, &stencil)),
        }
        self.stencil = Some(stencil);
        Ok(())
    }

    fn fill(&self, team: &Team, at: &Cells<'_, D>, weights: &mut [Vec<f64>; D], diagonal: &mut [f64]) {
        let cells = Blocks::<D>::CELLS;
        for (d, weights) in weights.iter_mut().enumerate() {
            let mut pieces: Vec<&mut [f64]> = diagonal.chunks_mut(cells).collect();
            team.each_piece(weights, cells, &mut pieces, |n, weights, diagonal| {
                let b = self.mine[n] as usize;
                let (mut kind, mut level, mut open) = ([0; TILE_CELLS], [0.0; TILE_CELLS], [0.0; TILE_CELLS]);
                at.blocks.load(b, at.kind, 0, &mut kind);
                at.blocks.load(b, at.level, 1.0, &mut level);
                at.blocks.load(b, &at.open[d], 1.0, &mut open);
                for i in 0..cells {
                    let c = in_tile(&local::<D>(i));
                    if kind[c] != LIQUID {
                        continue;
                    }
                    let (low, up) = (c - stride(d), c + stride(d));
                    for (other, alpha) in [(low, open[c]), (up, open[up])] {
                        diagonal[i] +=
                            if kind[other] == LIQUID { alpha } else { alpha / theta(level[c], level[other]) };
                    }
                    if kind[up] == LIQUID {
                        weights[i] = open[up];
                    }
                }
            });
        }
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        let parts = self.parts.0.iter().map(Vec::capacity).sum::<usize>() + self.parts.1.capacity();
        let own = 8 * (parts + self.right.capacity() + self.unknown.capacity()) + 4 * self.mine.capacity();
        own + self.stencil.as_ref().map_or(0, Stencil::bytes)
            + self.multigrid.as_ref().map_or(0, Multigrid::bytes)
    }

    /// True if liquid fills a closed region, whose pressure is known but for a constant.
    pub fn is_singular(&self) -> bool {
        self.stencil.as_ref().map_or(self.closed, |stencil| stencil.singular_regions() > 0)
    }

    /// Solve for q with the right-hand side `right` at the cells, to which the values at the surface are added. `q` is the start and the
    /// result; it is zero but in liquid cells. `columns` finds the columns of free rigid bodies by the place of a cell in the system.
    ///
    /// # Errors
    /// A solve that does not reach the tolerance, or a closed region of liquid that gains or loses volume.
    pub fn solve(
        &mut self,
        team: &Team,
        at: &Cells<'_, D>,
        right: &[f64],
        q: &mut [f64],
        stop: &Stop,
        columns: &Columns<'_>,
    ) -> Result<usize, PressureError> {
        let cells = Blocks::<D>::CELLS;
        if self.unknowns == 0 {
            q.fill(0.0);
            return Ok(0);
        }
        let periodic = self.stencil.is_none();
        for (n, &b) in self.mine.iter().enumerate() {
            let (there, here) = (b as usize * cells, n * cells);
            for i in 0..cells {
                let liquid = at.kind[there + i] == LIQUID;
                self.right[here + i] = if liquid { right[there + i] } else { 0.0 };
                self.unknown[here + i] = if liquid { q[there + i] } else { 0.0 };
            }
        }
        if at.surface.is_some() {
            self.add_surface(team, at);
        }
        // A row without an open face has no unknown.
        let iterations = if periodic {
            let (weights, diagonal) =
                std::mem::replace(&mut self.parts, (crate::blocks::faces(), Vec::new()));
            let mut jacobi = Jacobi::new(&diagonal);
            let singular = self.closed;
            let system = Periodic { blocks: at.blocks, weights, diagonal, singular };
            let stop = Stop { iterations: PERIODIC_ITERATIONS, ..*stop };
            let solved =
                conjugate_gradients(team, &system, &mut jacobi, &self.right, &mut self.unknown, &stop);
            self.parts = (system.weights, system.diagonal);
            solved?.iterations
        } else {
            let (Some(stencil), Some(multigrid)) = (&self.stencil, &mut self.multigrid) else { return Ok(0) };
            let stop = Stop { iterations: ITERATIONS, ..*stop };
            let mut list = Vec::new();
            let place = |slot: u32| {
                let (b, i) = (slot as usize / cells, slot as usize % cells);
                self.cells.find_block(at.blocks.keys[b]).map(|n| (n * cells + i) as u32)
            };
            columns(&place, &mut list);
            if list.is_empty() {
                conjugate_gradients(team, stencil, multigrid, &self.right, &mut self.unknown, &stop)?
            } else {
                let coupled = Coupled { alone: stencil, columns: &list };
                conjugate_gradients(team, &coupled, multigrid, &self.right, &mut self.unknown, &stop)?
            }
            .iterations
        };
        q.fill(0.0);
        for (n, &b) in self.mine.iter().enumerate() {
            q[b as usize * cells..(b as usize + 1) * cells]
                .copy_from_slice(&self.unknown[n * cells..(n + 1) * cells]);
        }
        Ok(iterations)
    }

    /// Add the values at the surface to the right-hand side.
    fn add_surface(&mut self, team: &Team, at: &Cells<'_, D>) {
        let cells = Blocks::<D>::CELLS;
        let Some(surface) = at.surface else { return };
        let mine = &self.mine;
        team.each_piece(&mut self.right, cells, &mut vec![(); mine.len()], |n, right, ()| {
            let b = mine[n] as usize;
            let (mut kind, mut level, mut value) = ([0; TILE_CELLS], [0.0; TILE_CELLS], [0.0; TILE_CELLS]);
            at.blocks.load(b, at.kind, 0, &mut kind);
            at.blocks.load(b, at.level, 1.0, &mut level);
            at.blocks.load(b, surface, 0.0, &mut value);
            for d in 0..D {
                let mut open = [0.0; TILE_CELLS];
                at.blocks.load(b, &at.open[d], 1.0, &mut open);
                for (i, right) in right.iter_mut().enumerate() {
                    let c = in_tile(&local::<D>(i));
                    if kind[c] != LIQUID {
                        continue;
                    }
                    for (other, alpha) in [(c - stride(d), open[c]), (c + stride(d), open[c + stride(d)])] {
                        if kind[other] != LIQUID {
                            let part = theta(level[c], level[other]);
                            *right += alpha / part * between(value[c], value[other], part);
                        }
                    }
                }
            }
        });
    }
}

/// True if no open face is between liquid and air.
fn closed<const D: usize>(blocks: &[u32], at: &Cells<'_, D>) -> bool {
    let cells = Blocks::<D>::CELLS;
    blocks.iter().all(|&b| {
        (0..cells).flat_map(|i| (0..D).map(move |d| (i, d))).all(|(i, d)| {
            let slot = b as usize * cells + i;
            let below = at.blocks.beside(b as usize, i, d, false).map_or(0, |s| at.kind[s]);
            at.open[d][slot] <= 0.0 || (at.kind[slot] == LIQUID) == (below == LIQUID)
        })
    })
}

/// Value at the surface from those near the liquid cell and near the other one.
#[inline(always)]
fn between(liquid: f64, air: f64, theta: f64) -> f64 {
    liquid + theta.min(1.0) * (air - liquid)
}

/// Net outflow of each liquid cell, times -1: the right-hand side of the projection. `wall` is the velocity of walls at faces.
pub(crate) fn outflow<const D: usize>(
    team: &Team,
    at: &Cells<'_, D>,
    velocity: &[Vec<f64>; D],
    wall: Option<&[Vec<f64>; D]>,
    right: &mut Vec<f64>,
) {
    let cells = Blocks::<D>::CELLS;
    right.resize(at.blocks.cells(), 0.0);
    team.each_piece(right, cells, &mut vec![(); at.blocks.len()], |b, right, ()| {
        right.fill(0.0);
        if !at.kind[b * cells..(b + 1) * cells].contains(&LIQUID) {
            return;
        }
        let (mut u, mut open, mut w) = ([0.0; TILE_CELLS], [0.0; TILE_CELLS], [0.0; TILE_CELLS]);
        for d in 0..D {
            at.blocks.load(b, &velocity[d], 0.0, &mut u);
            at.blocks.load(b, &at.open[d], 1.0, &mut open);
            if let Some(wall) = wall {
                at.blocks.load(b, &wall[d], 0.0, &mut w);
            }
            for (i, right) in right.iter_mut().enumerate() {
                let low = in_tile(&local::<D>(i));
                let up = low + stride(d);
                let flux = |f: usize| open[f] * u[f] + (1.0 - open[f]) * w[f];
                *right -= flux(up) - flux(low);
            }
        }
        for (i, right) in right.iter_mut().enumerate() {
            if at.kind[b * cells + i] != LIQUID {
                *right = 0.0;
            }
        }
    });
}

/// Subtract the gradient of q from the velocity at the open faces of liquid cells.
pub(crate) fn subtract_gradient<const D: usize>(
    team: &Team,
    at: &Cells<'_, D>,
    q: &[f64],
    velocity: &mut [Vec<f64>; D],
) {
    let cells = Blocks::<D>::CELLS;
    for d in 0..D {
        team.each_piece(&mut velocity[d], cells, &mut vec![(); at.blocks.len()], |b, velocity, ()| {
            let tile = Tile::load(at, b, q);
            for (i, u) in velocity.iter_mut().enumerate() {
                if at.open[d][b * cells + i] <= 0.0 {
                    continue;
                }
                let up = in_tile(&local::<D>(i));
                let low = up - stride(d);
                *u -= tile.gradient(low, up);
            }
        });
    }
}

/// Cells around a block: kinds, level set, q, and its value at the surface.
pub(crate) struct Tile {
    pub kind: [u8; TILE_CELLS],
    level: [f64; TILE_CELLS],
    value: [f64; TILE_CELLS],
    surface: [f64; TILE_CELLS],
}

impl Tile {
    /// Copy the cells around block `b`.
    #[inline(always)]
    pub fn load<const D: usize>(at: &Cells<'_, D>, b: usize, q: &[f64]) -> Self {
        let mut tile = Tile {
            kind: [0; TILE_CELLS],
            level: [0.0; TILE_CELLS],
            value: [0.0; TILE_CELLS],
            surface: [0.0; TILE_CELLS],
        };
        at.blocks.load(b, at.kind, 0, &mut tile.kind);
        at.blocks.load(b, at.level, 1.0, &mut tile.level);
        at.blocks.load(b, q, 0.0, &mut tile.value);
        if let Some(field) = at.surface {
            at.blocks.load(b, field, 0.0, &mut tile.surface);
        }
        tile
    }

    /// Gradient of q across the face between two cells, times the width of a cell; 0 between cells without liquid.
    #[inline(always)]
    pub fn gradient(&self, low: usize, up: usize) -> f64 {
        let Tile { kind, level, value, surface } = self;
        match (kind[low] == LIQUID, kind[up] == LIQUID) {
            (true, true) => value[up] - value[low],
            (true, false) => {
                let part = theta(level[low], level[up]);
                (between(surface[low], surface[up], part) - value[low]) / part
            }
            (false, true) => {
                let part = theta(level[up], level[low]);
                (value[up] - between(surface[up], surface[low], part)) / part
            }
            (false, false) => 0.0,
        }
    }
}

/// Continue the pressure linearly into cells within walls beside the liquid, by the mean over the axes; into the cells of edges and corners, which
/// touch no liquid, from those. Particles beside a wall then have the pressure of their place.
pub(crate) fn continue_into_walls<const D: usize>(blocks: &Blocks<D>, kind: &[u8], pressure: &mut [f64]) {
    let mut known: Vec<bool> = kind.iter().map(|kind| *kind != SOLID).collect();
    for _ in 0..D {
        let mut found = Vec::new();
        for slot in (0..blocks.cells()).filter(|slot| !known[*slot]) {
            let (mut sum, mut count) = (0.0, 0u32);
            for (axis, up) in (0..D).flat_map(|axis| [(axis, false), (axis, true)]) {
                let next = |slot: usize| {
                    let (b, i) = (slot / Blocks::<D>::CELLS, slot % Blocks::<D>::CELLS);
                    blocks.beside(b, i, axis, up).filter(|s| known[*s])
                };
                let Some(near) = next(slot).filter(|s| kind[*s] != AIR) else { continue };
                let slope = next(near).map_or(0.0, |far| pressure[near] - pressure[far]);
                sum += pressure[near] + slope;
                count += 1;
            }
            if count > 0 {
                found.push((slot, sum / f64::from(count)));
            }
        }
        for (slot, value) in found {
            pressure[slot] = value;
            known[slot] = true;
        }
    }
}
