//! Viscous stress on the staggered grid: tau = mu (grad v + grad v^T), in full, so that solid rotation has no stress.
//!
//! Normal stresses are at liquid cells, shear stresses at the edges between four cells that are liquid or wall. At a surface the shear stress
//! is zero, and the pressure is that of the normal stress, n . tau . n, in explicit steps; in implicit ones the stress beyond the faces beside
//! air is zero, and these faces have the mass of their liquid share. At a wall without slip, velocity gradients are those to the wall, half a cell from the face beside it; at a slip wall the shear
//! stress is zero. Steps are explicit, by the second-order Runge-Kutta method, up to [`EXPLICIT`] of mu dt / (rho h^2), and implicit beyond
//! by conjugate gradients: the trapezoidal rule while the fastest mode decays by a rate times dt below 6, and towards Euler's method,
//! of first order, for larger ones.

use impactite_simd::Team;
use impactite_solve::{Identity, Operator, SolveError, Stop, conjugate_gradients};

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::extrapolate::SOLVED;
use crate::pressure::theta;
use crate::surface::{AIR, LIQUID, SOLID};

/// Largest mu dt / (rho h^2) of explicit steps: the limit of stability is 1 / (2 (1 + D)), 1/8 in space.
pub(crate) const EXPLICIT: f64 = 0.1;
/// Largest rate of decay times dt of the explicit share of an implicit step, which is half a step up to twice this rate: the fastest mode then
/// keeps at most half of its amplitude.
const DAMPED: f64 = 3.0;
/// Relative tolerance of implicit steps.
const TOLERANCE: f64 = 1e-10;
/// Largest number of iterations of implicit steps.
const ITERATIONS: usize = 2000;

/// Liquid and walls of a step, for stresses.
pub(crate) struct Stress<'a, const D: usize> {
    pub blocks: &'a Blocks<D>,
    pub kind: &'a [u8],
    /// Level set of the surface, in cells.
    pub level: &'a [f64],
    pub marks: &'a [Vec<u8>; D],
    pub open: &'a [Vec<f64>; D],
    /// 1 at closed faces of walls without slip, else 0; empty without such walls.
    pub stick: &'a [Vec<f64>; D],
    /// Velocity of walls at faces; empty if they rest.
    pub wall: &'a [Vec<f64>; D],
    /// mu dt / (rho h^2).
    pub number: f64,
}

/// Liquid share of the control volume of the lower face of a cell, as in the pressure equation: below one beside air.
#[inline]
fn liquid_share(kind: &[u8; TILE_CELLS], level: &[f64; TILE_CELLS], d: usize, at: usize) -> f64 {
    let low = at - stride(d);
    match (kind[low], kind[at]) {
        (LIQUID, AIR) => theta(level[low], level[at]).min(1.0),
        (AIR, LIQUID) => theta(level[at], level[low]).min(1.0),
        _ => 1.0,
    }
}

/// Copies of the fields around a block.
struct Tiles {
    kind: [u8; TILE_CELLS],
    level: [f64; TILE_CELLS],
    open: [[f64; TILE_CELLS]; 3],
    stick: [[f64; TILE_CELLS]; 3],
    wall: [[f64; TILE_CELLS]; 3],
    u: [[f64; TILE_CELLS]; 3],
}

impl Tiles {
    /// Difference of component `d` over a cell along `e`, up to the face at `at`; none where a slip wall or a surface makes it useless.
    /// `moves` is 1 if walls have their velocity, 0 if they rest.
    #[inline]
    fn difference(&self, d: usize, e: usize, at: usize, moves: f64) -> Option<f64> {
        let low = at - stride(e);
        let closed = [low, at].map(|f| self.open[d][f] <= 0.0);
        match closed {
            [false, false] => Some(self.u[d][at] - self.u[d][low]),
            [true, true] => Some(0.0),
            [true, false] if self.stick[d][low] > 0.0 => {
                Some(2.0 * (self.u[d][at] - moves * self.wall[d][low]))
            }
            [false, true] if self.stick[d][at] > 0.0 => {
                Some(2.0 * (moves * self.wall[d][at] - self.u[d][low]))
            }
            _ => None,
        }
    }

    /// Shear stress of components `d` and `e` over mu / h, at the edge at the lower end of cell `at` along both.
    #[inline]
    fn shear(&self, d: usize, e: usize, at: usize, moves: f64) -> f64 {
        let cells = [at, at - stride(d), at - stride(e), at - stride(d) - stride(e)];
        if cells.iter().any(|c| self.kind[*c] == AIR) || !cells.iter().any(|c| self.kind[*c] == LIQUID) {
            return 0.0;
        }
        match (self.difference(d, e, at, moves), self.difference(e, d, at, moves)) {
            (Some(a), Some(b)) => a + b,
            _ => 0.0,
        }
    }

    /// Normal stress at a cell over mu / h.
    #[inline]
    fn normal(&self, d: usize, at: usize) -> f64 {
        if self.kind[at] == LIQUID { 2.0 * (self.u[d][at + stride(d)] - self.u[d][at]) } else { 0.0 }
    }

    /// Difference of the normal stresses at both sides of the lower face of a cell over mu / h. Towards air it is zero if the surface has
    /// a pressure by viscosity (`bears`), and else that to a stress of zero.
    #[inline]
    fn across(&self, d: usize, at: usize, bears: bool) -> f64 {
        let low = at - stride(d);
        if bears && (self.kind[at] == AIR || self.kind[low] == AIR) {
            return 0.0;
        }
        self.normal(d, at) - self.normal(d, low)
    }

    /// Stress along the normal of the surface over mu / h, at a liquid cell. Shear stresses are the mean of those at the edges without air.
    fn along_normal<const D: usize>(&self, at: usize) -> f64 {
        let slope: [f64; D] = std::array::from_fn(|d| {
            let to = |other: usize| {
                if self.kind[other] == SOLID { self.level[at] } else { self.level[other] }
            };
            to(at + stride(d)) - to(at - stride(d))
        });
        let square: f64 = slope.iter().map(|s| s * s).sum();
        if square < 1e-6 {
            return 0.0;
        }
        let mut sum = 0.0;
        for d in 0..D {
            sum += slope[d] * slope[d] * self.normal(d, at);
            for e in 0..d {
                let (a, b) = (stride(d), stride(e));
                let (mut shear, mut count) = (0.0, 0.0f64);
                for edge in [at, at + a, at + b, at + a + b] {
                    if [edge, edge - a, edge - b, edge - a - b].iter().all(|c| self.kind[*c] != AIR) {
                        (shear, count) = (shear + self.shear(d, e, edge, 1.0), count + 1.0);
                    }
                }
                sum += 2.0 * slope[d] * slope[e] * shear / count.max(1.0);
            }
        }
        sum / square
    }
}

impl<const D: usize> Stress<'_, D> {
    fn load(&self, b: usize, u: &[f64]) -> Tiles {
        let zero = [[0.0; TILE_CELLS]; 3];
        let mut tiles = Tiles {
            kind: [0; TILE_CELLS],
            level: [0.0; TILE_CELLS],
            open: zero,
            stick: zero,
            wall: zero,
            u: zero,
        };
        let count = self.blocks.cells();
        self.blocks.load(b, self.kind, 0, &mut tiles.kind);
        self.blocks.load(b, self.level, 1.0, &mut tiles.level);
        for d in 0..D {
            self.blocks.load(b, &self.open[d], 1.0, &mut tiles.open[d]);
            self.blocks.load(b, &u[d * count..(d + 1) * count], 0.0, &mut tiles.u[d]);
            if !self.stick[d].is_empty() {
                self.blocks.load(b, &self.stick[d], 0.0, &mut tiles.stick[d]);
            }
            if !self.wall[d].is_empty() {
                self.blocks.load(b, &self.wall[d], 0.0, &mut tiles.wall[d]);
            }
        }
        tiles
    }

    /// Change of velocity in the step by the stresses of the velocity `u`, at the faces of one axis after another, times the liquid shares of
    /// faces beside air in implicit steps. Walls have their velocity if `moves` is 1, and rest if it is 0.
    fn change(&self, team: &Team, u: &[f64], moves: f64, out: &mut [f64]) {
        let (cells, blocks) = (Blocks::<D>::CELLS, self.blocks.len());
        team.each_piece(out, cells, &mut vec![(); D * blocks], |n, out, ()| {
            let (d, b) = (n / blocks, n % blocks);
            out.fill(0.0);
            if !self.marks[d][b * cells..(b + 1) * cells].contains(&SOLVED) {
                return;
            }
            let tiles = self.load(b, u);
            for (i, out) in out.iter_mut().enumerate() {
                if self.marks[d][b * cells + i] != SOLVED {
                    continue;
                }
                let at = in_tile(&local::<D>(i));
                let mut sum = tiles.across(d, at, self.bears());
                for e in (0..D).filter(|e| *e != d) {
                    sum += tiles.shear(d, e, at + stride(e), moves) - tiles.shear(d, e, at, moves);
                }
                *out = self.number * sum;
            }
        });
    }

    /// Add the velocities times the liquid shares of their faces.
    fn add_weighed(&self, team: &Team, u: &[f64], out: &mut [f64]) {
        let (cells, blocks) = (Blocks::<D>::CELLS, self.blocks.len());
        team.each_piece(out, cells, &mut vec![(); D * blocks], |n, out, ()| {
            let (d, b) = (n / blocks, n % blocks);
            let u = &u[n * cells..(n + 1) * cells];
            if !self.marks[d][b * cells..(b + 1) * cells].contains(&SOLVED) {
                out.iter_mut().zip(u).for_each(|(out, u)| *out += u);
                return;
            }
            let (mut kind, mut level) = ([0; TILE_CELLS], [0.0; TILE_CELLS]);
            self.blocks.load(b, self.kind, 0, &mut kind);
            self.blocks.load(b, self.level, 1.0, &mut level);
            for (i, (out, u)) in out.iter_mut().zip(u).enumerate() {
                let at = in_tile(&local::<D>(i));
                *out += liquid_share(&kind, &level, d, at) * u;
            }
        });
    }

    /// True if the surface has a pressure by viscosity: in explicit steps.
    pub fn bears(&self) -> bool {
        self.number <= EXPLICIT
    }

    /// Add the pressure at the surface by viscosity, n . tau . n, to `out`, in the unit of q: at liquid cells beside air, and at cells of air
    /// the mean of those beside them.
    pub fn add_surface_pressure(&self, team: &Team, u: &[f64], out: &mut [f64]) {
        let cells = Blocks::<D>::CELLS;
        team.each_piece(out, cells, &mut vec![(); self.blocks.len()], |b, out, ()| {
            let kinds = &self.kind[b * cells..(b + 1) * cells];
            if kinds.iter().all(|k| *k == SOLID) {
                return;
            }
            let tiles = self.load(b, u);
            if !tiles.kind.contains(&AIR) || !tiles.kind.contains(&LIQUID) {
                return;
            }
            for (i, out) in out.iter_mut().enumerate() {
                let at = in_tile(&local::<D>(i));
                let around = || (0..D).flat_map(|d| [at - stride(d), at + stride(d)]);
                if tiles.kind[at] == LIQUID && around().any(|c| tiles.kind[c] == AIR) {
                    *out += self.number * tiles.along_normal::<D>(at);
                } else if tiles.kind[at] == AIR {
                    let (mut sum, mut count) = (0.0, 0.0f64);
                    for liquid in around().filter(|c| tiles.kind[*c] == LIQUID) {
                        (sum, count) = (sum + tiles.along_normal::<D>(liquid), count + 1.0);
                    }
                    *out += self.number * sum / count.max(1.0);
                }
            }
        });
    }

    /// Visit the faces between liquid and air whose velocity is solved: axis, index of the face, that of the cell below it, and true if the
    /// liquid is below.
    fn each_surface_face(&self, mut visit: impl FnMut(usize, usize, usize, bool)) {
        let cells = Blocks::<D>::CELLS;
        for (b, d) in (0..self.blocks.len()).flat_map(|b| (0..D).map(move |d| (b, d))) {
            for i in (0..cells).filter(|i| self.marks[d][b * cells + i] == SOLVED) {
                let up = b * cells + i;
                let Some(low) = self.blocks.beside(b, i, d, false) else { continue };
                match (self.kind[low], self.kind[up]) {
                    (LIQUID, AIR) => visit(d, up, low, true),
                    (AIR, LIQUID) => visit(d, up, low, false),
                    _ => {}
                }
            }
        }
    }

    /// Return the work of the surface pressure `q` on the faces of velocity `u` between liquid and air, over rho h^D: what the liquid loses.
    pub fn work_at_surface(&self, u: &[f64], q: &[f64]) -> f64 {
        let (count, mut sum) = (self.blocks.cells(), 0.0);
        self.each_surface_face(|d, up, low, below| {
            let out = if below { 1.0 } else { -1.0 };
            sum += out * 0.5 * (q[low] + q[up]) * u[d * count + up];
        });
        sum
    }

    /// Return the sum of the changes of velocity by the normal stress at faces beside air, which explicit steps leave to the pressure there.
    fn left_to_surface(&self, u: &[f64]) -> [f64; D] {
        let (cells, count) = (Blocks::<D>::CELLS, self.blocks.cells());
        let mut sum = [0.0; D];
        self.each_surface_face(|d, up, low, below| {
            let u = &u[d * count..(d + 1) * count];
            if below {
                sum[d] -= 2.0 * self.number * (u[up] - u[low]);
            } else if let Some(next) = self.blocks.beside(up / cells, up % cells, d, true) {
                sum[d] += 2.0 * self.number * (u[next] - u[up]);
            }
        });
        sum
    }

    /// Update the velocity `u`, at the faces of one axis after another, by the viscous stress. Return the impulse of walls and the kinetic
    /// energy that the liquid loses, both over rho h^D, but for the work of [`Stress::work_at_surface`].
    ///
    /// # Errors
    /// An implicit step that does not reach its tolerance.
    pub fn step(&self, team: &Team, u: &mut [f64]) -> Result<([f64; D], f64), SolveError> {
        let (count, before) = (self.blocks.cells(), u.to_vec());
        let mut first = vec![0.0; u.len()];
        let mut impulse = [0.0; D];
        if self.bears() {
            let (mut middle, mut second) = (u.to_vec(), vec![0.0; u.len()]);
            self.change(team, u, 1.0, &mut first);
            middle.iter_mut().zip(&first).for_each(|(m, f)| *m += f);
            self.change(team, &middle, 1.0, &mut second);
            for (u, (a, b)) in u.iter_mut().zip(first.iter().zip(&second)) {
                *u += 0.5 * (a + b);
            }
            // The change is that of the velocity in the middle, by the linear stress.
            middle.iter_mut().zip(&before).for_each(|(m, u)| *m = 0.5 * (*m + u));
            impulse = self.left_to_surface(&middle);
        } else {
            // (m - s L) u = m u* + (1 - s) L u* + c, where the change of m u is L u + c with c from the walls and the liquid shares m of faces.
            let largest = 4.0 * (1 + D) as f64 * self.number;
            let share = (1.0 - DAMPED / largest).max(0.5);
            let mut walls = vec![0.0; u.len()];
            self.change(team, &walls.clone(), 1.0, &mut walls);
            self.change(team, u, 0.0, &mut first);
            for (right, c) in first.iter_mut().zip(&walls) {
                *right = (1.0 - share) * *right + c;
            }
            self.add_weighed(team, u, &mut first);
            let stop = Stop { relative: TOLERANCE, iterations: ITERATIONS, ..Stop::default() };
            conjugate_gradients(team, &Implicit(self, share), &mut Identity, &first, u, &stop)?;
        }
        let mut lost = 0.0;
        for (n, (new, old)) in u.iter().zip(&before).enumerate() {
            impulse[n / count] += new - old;
            lost += 0.5 * (old * old - new * new);
        }
        if !self.bears() {
            // Faces beside air have the mass of their liquid share.
            self.each_surface_face(|d, up, low, below| {
                let (liquid, air) = if below { (low, up) } else { (up, low) };
                let empty = 1.0 - theta(self.level[liquid], self.level[air]).min(1.0);
                let (new, old) = (u[d * count + up], before[d * count + up]);
                impulse[d] -= empty * (new - old);
                lost -= 0.5 * empty * (old * old - new * new);
            });
        }
        Ok((impulse, lost))
    }
}

/// Operator of an implicit step, m - s L, with the liquid shares m of faces and the share s.
struct Implicit<'a, 'b, const D: usize>(&'a Stress<'b, D>, f64);

impl<const D: usize> Operator for Implicit<'_, '_, D> {
    fn len(&self) -> usize {
        D * self.0.blocks.cells()
    }
    fn apply(&self, team: &Team, x: &[f64], y: &mut [f64]) {
        // Faces that are not solved are no unknowns: what they have does not reach the others.
        self.0.change(team, x, 0.0, y);
        y.iter_mut().for_each(|y| *y *= -self.1);
        self.0.add_weighed(team, x, y);
    }
}
