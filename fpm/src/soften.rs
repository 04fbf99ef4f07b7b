//! Softening of faces between joined cells: update of their openings in a step.
//!
//! A softening face remains a side of its cells. Its opening delta, the displacement of the second side minus that of the first that
//! belongs to the crack and not to the material, is an internal variable like plastic strain: it is subtracted wherever displacements of
//! both cells are compared, in gradients, u_m - u - delta, and in jumps, \[u\] + delta. It begins at zero, so that nothing jumps. The
//! energy of material and penalty is then a function of displacements and openings; conjugate to the openings are the forces between pairs
//! of cells,
//!
//! T = t A + Q b_m - Q_m b.
//!
//! A step finds openings at which T is the cohesive traction. The material is too stiff against openings for an explicit update: stresses
//! are predicted from those of the last step by the moduli at rest, the openings of all softening faces follow by block Gauss-Seidel
//! sweeps, each face with its own K = -dT/d delta, and the law receives the result once. The error of the prediction (a nonlinear law, the
//! last sweep) is a difference of T and the cohesive law, which the next step corrects. The energy balance does not depend on it: the work
//! of cracks is that of the acting T on openings.
//!
//! Openings and T are rotated back by the mean rotation of both cells.

use std::marker::PhantomData;

use impactite_simd::Float;

use crate::flux::Flux;
use crate::method::Composition;
use crate::softening::Softening;
use crate::solver::Fpm;
use crate::sums::{BATCH, Load, Trace, Traction, jump, lifting, trace};
use crate::vector::{
    Tensor, add_dyad, along, apply, difference, largest_row, norm, product, rotation, scaled, subtract,
    with_identity, zero,
};

/// Largest number of sweeps in a step, and tolerance of the change of a traction over the strength.
const SWEEPS: usize = 100;
const CLOSE: f64 = 1e-4;
impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Return the open faces of a cell, each with the index of the cell in the face.
    pub(crate) fn cracks_of(&self, cell: usize) -> impl Iterator<Item = (u32, u8)> {
        let (n, cracks) = ((cell % BATCH) as u32, &self.batches[cell / BATCH].cracks);
        let first = cracks.partition_point(|c| c.0 < n);
        cracks[first..].iter().take_while(move |c| c.0 == n).map(|&(_, crack, end)| (crack, end))
    }

    /// True if a face softens between joined cells.
    pub(crate) fn softens(&self, face: u32) -> bool {
        let cell = self.faces[face as usize].cells[0] as usize;
        let of = |(crack, _): (u32, u8)| &self.cracks[crack as usize];
        self.cracks_of(cell).map(of).any(|crack| crack.face == face && crack.softens)
    }

    /// True if a side joins a cell to its neighbour: not if it is open or carries nothing any more.
    pub(crate) fn joins(&self, cell: usize, side: usize) -> bool {
        let face = self.sides.face[side];
        let of = |(crack, _): (u32, u8)| &self.cracks[crack as usize];
        side < self.sides.intact[cell] as usize
            && !self.cracks_of(cell).map(of).any(|crack| crack.face == face && crack.broken())
    }

    /// Return the trial function of a cell.
    pub(crate) fn trace_of(&self, cell: usize) -> Trace<D> {
        let mut trace = trace(&self.sides, &self.displacement, cell);
        if let Some(h) = self.batches[cell / BATCH].rigid(cell % BATCH) {
            trace.h = *h;
        }
        for (crack, end) in self.cracks_of(cell) {
            let crack = &self.cracks[crack as usize];
            if crack.softens {
                crack.take_from_gradient(&self.sides, end, &mut trace.h);
            }
        }
        trace
    }

    /// Return the sum over the intact sides of a cell of A/2 times the dyad of jump and normal.
    pub(crate) fn lifting_of(&self, cell: usize) -> Tensor<D> {
        let mut sum = lifting(&self.sides, &self.traces, cell);
        for (crack, _) in self.cracks_of(cell) {
            let crack = &self.cracks[crack as usize];
            if crack.softens {
                add_dyad(&mut sum, 0.5, &crack.apart, &crack.surface.area);
            }
        }
        sum
    }

    /// Return the gradient for the law of a cell.
    pub(crate) fn seen_of(&self, cell: usize) -> Tensor<D> {
        let (trace, per) = (&self.traces[cell], 1.0 / self.volume[cell]);
        let mut seen: Tensor<D> = trace.h;
        if M::Flux::LIFTED {
            subtract(&mut seen, per, &self.lifting_of(cell));
        }
        let n = cell % BATCH;
        for outer in self.batches[cell / BATCH].outer.iter().filter(|o| o.cell as usize == n) {
            let load = &self.acting[outer.load as usize];
            if load.holds() {
                add_dyad(&mut seen, -per, &load.jump(&trace.at(&outer.arm)), &outer.area);
            }
        }
        seen
    }

    /// Return the force T on the first cell of a softening face, N, by the present loads of its cells.
    fn force_across(&self, crack: u32) -> [f64; D] {
        let crack = &self.cracks[crack as usize];
        let [a, b] = crack.cells.map(|c| c as usize);
        let mut p = self.stress[a];
        subtract(&mut p, -1.0, &self.stress[b]);
        let apart = along(&jump(&self.traces[a], &self.traces[b], &crack.surface), 1.0, &crack.apart);
        let t = along(&scaled(&apply(&p, &crack.surface.area), 0.5), -crack.surface.stiffness, &apart);
        self.force_between(crack.face, &t)
    }

    /// Return T for the traction on a face as a force on its first cell, N, by the present loads of its cells.
    pub(crate) fn force_between(&self, face: u32, traction: &[f64; D]) -> [f64; D] {
        let cells = self.faces[face as usize].cells.map(|c| c as usize);
        self.between(face, cells, traction, cells.map(|c| &self.loads[c].q))
    }

    /// Return T for the traction on the first cell of a face, N, and Q of both cells, J.
    fn between(&self, face: u32, cells: [usize; 2], t: &[f64; D], q: [&Tensor<D>; 2]) -> [f64; D] {
        let [here, there] = cells.map(|c| self.sides.gradient[self.side_of(face, c as u32)]);
        difference(&along(t, 1.0, &apply(q[0], &here)), &apply(q[1], &there))
    }

    /// Register a face that begins to soften.
    pub(crate) fn begin_softening(&mut self, crack: u32) {
        self.softening.cracks.push(crack);
        self.softening.columns.push(Vec::new());
    }

    /// Rebuild the list of softening faces after a checkpoint.
    pub(crate) fn find_softening(&mut self) {
        self.softening = Softening::default();
        for crack in 0..self.cracks.len() as u32 {
            if self.cracks[crack as usize].softens {
                self.begin_softening(crack);
            }
        }
        self.renew_softening(&[]);
    }

    /// Update K of new faces and near cells in `changed`, whose neighbours changed; update the lists of cells.
    pub(crate) fn renew_softening(&mut self, changed: &[u32]) {
        let cracks = std::mem::take(&mut self.softening.cracks);
        let columns = std::mem::take(&mut self.softening.columns);
        let kept = cracks.into_iter().zip(columns).filter(|(c, _)| self.cracks[*c as usize].softens);
        let (cracks, mut columns): (Vec<u32>, Vec<_>) = kept.unzip();
        self.softening.cracks = cracks;
        let mut cells: Vec<u32> =
            self.softening.cracks.iter().flat_map(|&c| self.cracks[c as usize].cells).collect();
        cells.sort_unstable();
        cells.dedup();
        self.softening.around = self.ring(&cells);
        self.softening.cells = cells;
        // T depends on openings two neighbours away, and these on cells one neighbour farther.
        let mut near = changed.to_vec();
        if !near.is_empty() {
            (0..6).for_each(|_| near = self.ring(&near));
        }
        for (n, column) in columns.iter_mut().enumerate() {
            let crack = self.softening.cracks[n];
            let touched = self.cracks[crack as usize].cells.iter().any(|c| near.binary_search(c).is_ok());
            if column.is_empty() || touched {
                *column = self.column_of(crack);
            }
        }
        self.softening.columns = columns;
        self.softening.link(self.cracks.len());
    }

    /// Return the column of K of a face at rest: the decrease of T by its opening, on itself and on faces that softened before it.
    fn column_of(&self, crack: u32) -> Vec<(u32, Tensor<D>)> {
        let opened = &self.cracks[crack as usize];
        let near = self.ring(&opened.cells);
        let far = self.ring(&near);
        let held = |c: usize| {
            let own = self.batches[c / BATCH].outer.iter().filter(move |o| o.cell as usize == c % BATCH);
            own.filter(|o| self.acting[o.load as usize].holds())
        };
        let mut reached: Vec<u32> =
            far.iter().flat_map(|&c| self.cracks_of(c as usize)).map(|(n, _)| n).collect();
        reached.sort_unstable();
        reached.dedup();
        reached.retain(|&n| n <= crack && self.cracks[n as usize].softens);
        reached.reverse();
        let mut column: Vec<(u32, Tensor<D>)> = reached.iter().map(|&n| (n, zero())).collect();
        for d in 0..D {
            let mut unit = [0.0; D];
            unit[d] = 1.0;
            let mut own = [Trace::<D>::default(); 2];
            for (end, trace) in own.iter_mut().enumerate() {
                let side = self.side_of(opened.face, opened.cells[end]);
                let sign = if end == 0 { -1.0 } else { 1.0 };
                add_dyad(&mut trace.h, sign, &unit, &self.sides.gradient[side]);
            }
            let still = Trace::default();
            let of = |c: u32| match opened.cells.iter().position(|&o| o == c) {
                Some(end) => &own[end],
                None => &still,
            };
            // Jump on a side.
            let jumps = |c: u32, s: usize| {
                let there = jump(of(c), of(self.sides.neighbour[s]), &self.sides.surface[s]);
                if self.sides.face[s] != opened.face {
                    return there;
                }
                along(&there, if c == opened.cells[0] { 1.0 } else { -1.0 }, &unit)
            };
            let stress_of = |&c: &u32| {
                let (cell, per) = (c as usize, 1.0 / self.volume[c as usize]);
                let mut seen = of(c).h;
                if M::Flux::LIFTED {
                    for s in self.sides.intact_of(cell) {
                        add_dyad(&mut seen, -0.5 * per, &jumps(c, s), &self.sides.surface[s].area);
                    }
                }
                for outer in held(cell) {
                    let jump = self.acting[outer.load as usize].part(&of(c).at(&outer.arm));
                    add_dyad(&mut seen, -per, &jump, &outer.area);
                }
                self.rest.stress(&seen)
            };
            let stresses: Vec<Tensor<D>> = near.iter().map(stress_of).collect();
            let stress = |c: u32| near.binary_search(&c).map_or(zero(), |n| stresses[n]);
            let traction = |c: u32, s: usize| {
                let (mut p, surface) = (stress(c), &self.sides.surface[s]);
                subtract(&mut p, -1.0, &stress(self.sides.neighbour[s]));
                along(&scaled(&apply(&p, &surface.area), 0.5), -surface.stiffness, &jumps(c, s))
            };
            let moment = |c: u32| {
                let (cell, mut q) = (c as usize, stress(c));
                q.iter_mut().flatten().for_each(|q| *q *= self.volume[cell]);
                for s in self.sides.intact_of(cell) {
                    add_dyad(&mut q, -1.0, &traction(c, s), &self.sides.surface[s].own);
                }
                for outer in held(cell) {
                    let flux = apply(&stress(c), &outer.area);
                    let force = along(&flux, -outer.stiffness, &of(c).at(&outer.arm));
                    add_dyad(&mut q, -1.0, &self.acting[outer.load as usize].part(&force), &outer.arm);
                }
                q
            };
            for (n, block) in &mut column {
                let face = &self.cracks[*n as usize];
                let [a, b] = face.cells;
                let t = traction(a, self.side_of(face.face, a));
                let q = [moment(a), moment(b)];
                let force = self.between(face.face, [a as usize, b as usize], &t, [&q[0], &q[1]]);
                (0..D).for_each(|i| block[i][d] = -force[i]);
            }
        }
        column
    }

    /// Update the openings of softening faces at the end of a step with known displacements.
    pub(crate) fn soften(&mut self) {
        if self.softening.cracks.is_empty() {
            return;
        }
        let near = std::mem::take(&mut self.softening);
        near.cracks.iter().for_each(|&n| self.cracks[n as usize].go_on());
        self.settle(&near.cells);
        for &n in &near.cracks {
            let turn = self.turn_of(n);
            self.cracks[n as usize].turn(turn);
        }
        self.settle(&near.cells);
        let forces = self.foretold(&near);
        self.sweep(&near, forces);
        self.settle(&near.cells);
        self.softening = near;
    }

    /// Return the mean rotation of both cells of an open face.
    fn turn_of(&self, crack: u32) -> Tensor<D> {
        let [a, b] = self.cracks[crack as usize].cells.map(|c| &self.traces[c as usize].h);
        let mut mean = zero();
        subtract(&mut mean, -0.5, a);
        subtract(&mut mean, -0.5, b);
        rotation(&with_identity(&mean))
    }

    /// Update the trial functions of cells after a change of openings.
    fn settle(&mut self, cells: &[u32]) {
        for &c in cells {
            self.traces[c as usize] = self.trace_of(c as usize);
        }
    }

    /// Predict T of softening faces at new displacements and old openings, N, rotated back.
    fn foretold(&mut self, near: &Softening<D>) -> Vec<[f64; D]> {
        let mut kept = Vec::with_capacity(near.around.len());
        for &c in &near.around {
            let cell = c as usize;
            let old = with_identity(&self.batches[cell / BATCH].gradient[cell % BATCH]);
            let new = with_identity(&self.seen_of(cell));
            let (from, to) = (rotation(&old), rotation(&new));
            // Stress rotates with the cell, and stretch changes it by the moduli.
            let mut change = back(&to, &new);
            subtract(&mut change, 1.0, &back(&from, &old));
            let mut stress = back(&from, &self.stress[cell]);
            subtract(&mut stress, -1.0, &self.rest.stress(&change));
            kept.push(std::mem::replace(&mut self.stress[cell], product(&to, &stress)));
        }
        for &c in &near.cells {
            self.load(c as usize);
        }
        let of = |&n: &u32| self.cracks[n as usize].turned_back(&self.force_across(n));
        let forces = near.cracks.iter().map(of).collect();
        for (&c, stress) in near.around.iter().zip(kept) {
            self.stress[c as usize] = stress;
        }
        forces
    }

    /// Assemble the load of a cell.
    fn load(&mut self, cell: usize) {
        let Fpm { sides, traces, stress, volume, acting, .. } = &*self;
        let (first, least, method) = (cell, f64::INFINITY, PhantomData::<M>);
        let (mut loads, mut lifted, mut found) = ([Load::default()], [zero()], Vec::new());
        let (out, lifting, candidates) = (&mut loads[..], &mut lifted[..], &mut found);
        f64::dispatch(Traction {
            sides,
            traces,
            stress,
            volume,
            first,
            least,
            out,
            lifting,
            candidates,
            method,
        });
        let batch = &self.batches[cell / BATCH];
        for outer in batch.outer.iter().filter(|o| o.cell as usize == cell % BATCH) {
            let mut outer = *outer;
            let (trace, p) = (&traces[cell], &stress[cell]);
            acting[outer.load as usize].act(&mut outer, trace, p, &mut loads[0], false);
        }
        for (crack, end) in self.cracks_of(cell) {
            self.cracks[crack as usize].load(end, &mut loads[0]);
        }
        self.loads[cell] = loads[0];
    }

    /// Solve for the openings at which T is the cohesive traction.
    fn sweep(&mut self, near: &Softening<D>, mut forces: Vec<[f64; D]>) {
        let friction = self.friction;
        let starts: Vec<[f64; D]> = near.cracks.iter().map(|&n| self.cracks[n as usize].start()).collect();
        for _ in 0..SWEEPS {
            let mut moved = false;
            for (n, &crack) in near.cracks.iter().enumerate() {
                let face = &mut self.cracks[crack as usize];
                let column = &near.columns[n];
                let own = &column[0].1;
                let stiff = largest_row(own);
                let opening = face.balanced(&starts[n], &forces[n], stiff, friction);
                let change = difference(&opening, &face.opening);
                if norm(&change) * stiff <= face.little(CLOSE) {
                    continue;
                }
                moved = true;
                face.opening = opening;
                forces[n] = difference(&forces[n], &apply(own, &change));
                for (other, block) in &column[1..] {
                    let m = near.places[*other as usize] as usize;
                    forces[m] = difference(&forces[m], &apply(block, &change));
                }
                for &[m, at] in &near.later[n] {
                    let (m, block) = (m as usize, &near.columns[m as usize][at as usize].1);
                    for i in 0..D {
                        for j in 0..D {
                            // K is symmetric.
                            forces[m][i] -= block[j][i] * change[j];
                        }
                    }
                }
            }
            if !moved {
                break;
            }
        }
        for &n in &near.cracks {
            self.cracks[n as usize].opened_further();
        }
    }

    /// Book the dissipation of softening faces in a step.
    pub(crate) fn enter_openings(&mut self, time: f64) {
        let friction = self.friction;
        for n in 0..self.softening.cracks.len() {
            let crack = self.softening.cracks[n];
            let force = self.force_across(crack);
            let taken = self.cracks[crack as usize].takes(time, &force, friction);
            self.exchange.friction += taken.rubbed;
            self.exchange.conversion -= taken.dissipated;
            self.dissipated += taken.dissipated;
        }
    }
}

/// Return R^T m for a rotation R.
fn back<const D: usize>(turn: &Tensor<D>, m: &Tensor<D>) -> Tensor<D> {
    let mut to = zero();
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                to[i][j] += turn[k][i] * m[k][j];
            }
        }
    }
    to
}
