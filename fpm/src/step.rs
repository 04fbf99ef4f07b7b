//! Time step: velocity update, boundary conditions, displacements; gradients and law; tractions, cracks, forces.

use std::marker::PhantomData;

use impactite_scene::{ACCOUNTS, Boundary, Cause, Exchange, MovingPoint, PointKind, StepError, Stopped};
use impactite_simd::Float;
use mpm_contact::particles::press_on_walls;
use mpm_materials::Breakdown;
use mpm_materials::material::{Deformation, Length, Motion, Response, States, StatesMut};

use crate::crack::Criterion;
use crate::flux::Flux;
use crate::method::Composition;
use crate::rest::PLACES;
use crate::solver::{Fpm, HELD, PRESCRIBED, Scratch, TOUCHED};
use crate::sums::{BATCH, Batch, Deform, Force, GROUP, Lift, Load, Row, Trace, Traction};
use crate::vector::{
    Tensor, add_dyad, along, contract, identity, inverse, largest_row, product, subtract, with_identity, zero,
};

/// Indices of the groups of a batch, which are contiguous.
const GROUPS: [u32; BATCH / GROUP] = {
    let mut groups = [0; BATCH / GROUP];
    let mut n = 0;
    while n < groups.len() {
        groups[n] = n as u32;
        n += 1;
    }
    groups
};

impl<const D: usize, M: Composition<D>> Fpm<D, M> {
    /// Make one step of size `dt`, s.
    pub(crate) fn step(&mut self, dt: f64) -> Result<(), StepError> {
        self.accelerate(dt);
        self.advance(dt)?;
        self.finish(dt)
    }

    /// Update velocities by leapfrog, from the middle of the last step to that of this one.
    pub(crate) fn accelerate(&mut self, dt: f64) {
        let kick = self.lag + 0.5 * dt;
        self.boundaries.advance(self.clock.time, dt);
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        let Fpm { velocity, acceleration, mass, batches, acting, team, .. } = self;
        team.each_piece(velocity, BATCH, batches, |b, velocities, batch| {
            let mut given = Exchange::default();
            batch.start.copy_from_slice(velocities);
            for (n, v) in velocities.iter_mut().enumerate() {
                let i = b * BATCH + n;
                batch.held[n] &= !(7 * TOUCHED);
                for d in 0..D {
                    given.load[d] += kick * mass[i] * force[d];
                    v[d] += kick * (acceleration[i][d] + force[d]);
                }
            }
            for outer in &batch.outer {
                let load = &acting[outer.load as usize];
                let to = if load.holds() { &mut given.impulse } else { &mut given.load };
                (0..D).for_each(|d| to[d] += kick * outer.force[d]);
                if let Some(account) = load.account {
                    (0..D).for_each(|d| given.accounts[account].impulse[d] += kick * outer.force[d]);
                }
            }
            batch.report.given = given;
        });
    }

    /// Apply conditions and update displacements.
    pub(crate) fn advance(&mut self, dt: f64) -> Result<(), StepError> {
        self.obey(dt);
        self.press_on_walls(dt);
        self.damp();
        let kick = self.lag + 0.5 * dt;
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        // A change of the step size changes the force-dependent part of the staggered kinetic energy.
        let shorter = self.lag - 0.5 * dt;
        let Fpm { displacement, velocity, acceleration, mass, batches, team, .. } = self;
        team.each_piece(displacement, BATCH, batches, |b, displacements, batch| {
            batch.report.lost = None;
            let (mut given, mut resized) = (0.0, 0.0);
            for (n, u) in displacements.iter_mut().enumerate() {
                let i = b * BATCH + n;
                let (v, start, a) = (&velocity[i], &batch.start[n], &acceleration[i]);
                for d in 0..D {
                    given += mass[i] * force[d] * (start[d] + v[d]);
                    if batch.held[n] & HELD << d == 0 {
                        resized += mass[i] * a[d] * (v[d] - start[d]);
                    }
                    u[d] += dt * v[d];
                }
                if batch.report.lost.is_none() && !u.iter().all(|x| x.is_finite()) {
                    batch.report.lost = Some(n);
                }
            }
            batch.report.given.work += 0.5 * kick * given;
            batch.report.given.conversion += 0.5 * shorter * resized;
        });
        for batch in &self.batches {
            self.exchange.add(&batch.report.given);
        }
        self.lag = 0.5 * dt;
        let lost =
            self.batches.iter().enumerate().find_map(|(b, batch)| Some(b * BATCH + batch.report.lost?));
        lost.map_or(Ok(()), |i| Err(self.broken(i, Cause::Velocity)))
    }

    /// Apply local damping, if set, in directions without conditions.
    fn damp(&mut self) {
        if !self.damping.acts() {
            return;
        }
        let Fpm { velocity, mass, team, batches, damping, .. } = self;
        team.each_piece(velocity, BATCH, batches, |b, velocities, batch| {
            for (n, v) in velocities.iter_mut().enumerate() {
                let mass = mass[b * BATCH + n];
                for d in (0..D).filter(|d| batch.held[n] & HELD << d == 0) {
                    let slowed = damping.slowed(batch.start[n][d], v[d]);
                    let impulse = mass * (slowed - v[d]);
                    batch.report.given.load[d] += impulse;
                    batch.report.given.damping -= 0.5 * impulse * (batch.start[n][d] + slowed);
                    v[d] = slowed;
                }
            }
        });
    }

    /// Enforce boundary conditions on velocities.
    fn obey(&mut self, dt: f64) {
        if self.boundaries.is_empty() {
            return;
        }
        let Fpm { velocity, boundaries, reference, displacement, mass, sizes, clock, team, batches, .. } =
            self;
        let time = clock.time;
        team.each_piece(velocity, BATCH, batches, |b, velocities, batch| {
            for (n, v) in velocities.iter_mut().enumerate() {
                let i = b * BATCH + n;
                let mut point = MovingPoint {
                    position: along(&reference[i], 1.0, &displacement[i]),
                    mass: mass[i],
                    start: batch.start[n],
                    velocity: *v,
                    size: sizes[i],
                    depth: sizes[i],
                    tolerance: 0.75 * sizes[i],
                };
                let mut prescribed = 0;
                // `press_on_walls` keeps the surface in front of walls; here only points are stopped.
                for (number, boundary) in boundaries.iter().enumerate() {
                    let before = point.velocity;
                    boundaries.hold(number, &mut point, (time, dt), &mut batch.report.given);
                    for d in (0..D).filter(|d| !boundary.is_wall() && point.velocity[*d] != before[*d]) {
                        prescribed |= PRESCRIBED << d;
                    }
                }
                batch.held[n] = batch.held[n] & (7 * TOUCHED) | prescribed;
                for d in 0..D {
                    if point.velocity[d] != v[d] {
                        batch.held[n] |= HELD << d;
                        v[d] = point.velocity[d];
                    }
                }
            }
        });
    }

    /// Enforce walls on the surface of the body.
    fn press_on_walls(&mut self, dt: f64) {
        if !self.boundaries.iter().any(Boundary::is_wall) {
            return;
        }
        let boundaries = std::mem::take(&mut self.boundaries);
        let start = |fpm: &Self, n: usize| -> [f64; D] {
            let i = fpm.places[n] as usize;
            fpm.batches[i / BATCH].start[i % BATCH]
        };
        let (given, moved) = press_on_walls(self, &boundaries, &start, (self.clock.time, dt));
        self.boundaries = boundaries;
        self.exchange.add(&given);
        for (n, bits) in moved {
            let i = self.places[n] as usize;
            self.batches[i / BATCH].held[i % BATCH] |= u16::from(bits);
        }
    }

    /// Update gradients, law, tractions, cracks and forces at the new displacements.
    pub(crate) fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        let time = self.clock.time + dt;
        self.acting.iter_mut().for_each(|load| load.update(time, dt));
        self.deform();
        self.soften();
        self.strain(dt)?;
        self.bear(time);
        self.tractions(true);
        self.enter_books();
        self.enter_openings(time);
        self.forces();
        if M::Criterion::OPENS {
            self.open_faces(time);
        }
        self.clock.advance(dt);
        Ok(())
    }

    /// Begin or continue with the present displacements and states: update all data that follow from them.
    pub(crate) fn begin(&mut self) {
        let time = self.clock.time;
        self.acting.iter_mut().for_each(|load| load.update(time, 0.0));
        self.deform();
        self.look_up_stresses();
        self.begin_cracks();
        self.tractions(false);
        self.forces();
    }

    /// Update the trial functions.
    pub(crate) fn deform(&mut self) {
        let Fpm { traces, sides, displacement, cracks, batches, team, .. } = self;
        team.each_piece(traces, BATCH, batches, |b, traces, batch| {
            f64::dispatch(Deform { sides, displacement, first: b * BATCH, out: traces });
            for (n, h) in &batch.rigid {
                traces[*n as usize].h = *h;
            }
            for &(n, crack, end) in &batch.cracks {
                let crack = &cracks[crack as usize];
                if crack.softens {
                    crack.take_from_gradient(sides, end, &mut traces[n as usize].h);
                }
            }
        });
    }

    /// Update increments of gradients, and integrate the law.
    fn strain(&mut self, dt: f64) -> Result<(), StepError> {
        let numbers = self.virgin.len();
        let Fpm {
            stress,
            traces,
            sides,
            cracks,
            acting,
            volume,
            sizes,
            material,
            memory,
            team,
            batches,
            rest,
            ..
        } = self;
        team.each_piece(stress, BATCH, batches, |b, stress, batch| {
            let first = b * BATCH;
            let Scratch { seen, deformations, lengths, response } = &mut *team.own(memory);
            look::<D, M>((sides, cracks), traces, first, volume, batch, acting, seen);
            let count = stress.len();
            let groups = count.div_ceil(GROUP);
            deformations.clear();
            deformations.resize(groups.div_ceil(2), Deformation::default());
            lengths.resize(groups, Row::default());
            for n in 0..count {
                let old = with_identity(&batch.gradient[n]);
                let new = seen[n];
                let mut change = new;
                for a in 0..D {
                    for c in 0..D {
                        change[a][c] -= batch.gradient[n][a][c];
                    }
                }
                let increment = product(&change, &inverse(&old));
                let (to, half, lane) = (&mut deformations[n / GROUP / 2], n / GROUP % 2, n % GROUP);
                // The gradient is the increment itself, with a step of one.
                to.step.0[half].as_mut()[lane] = 1.0;
                for a in 0..D {
                    for c in 0..D {
                        to.gradient[3 * a + c].0[half].as_mut()[lane] = increment[a][c];
                    }
                }
                lengths[n / GROUP].as_mut()[lane] = sizes[first + n];
                batch.gradient[n] = new;
            }
            let groups = &GROUPS[..groups];
            let motion = Motion { deformation: deformations, dt, length: Length::Each(lengths) };
            let states = StatesMut { all: &mut batch.rows, stride: numbers, first: 0, groups };
            material.advance(&motion, states, true, response);
            let broken = response.faults().iter().map(|f| (f.group * GROUP + f.lane, f.cause));
            batch.report.trouble = broken.filter(|(n, _)| *n < count).min_by_key(|(n, _)| *n);
            let jumps = std::mem::take(&mut batch.jumps);
            let half_work = |stress: &[Tensor<D>]| -> f64 {
                let one = |(n, change): &(u32, Tensor<D>)| {
                    0.5 * volume[first + *n as usize] * contract(&stress[*n as usize], change)
                };
                jumps.iter().map(one).sum()
            };
            batch.report.jumped = half_work(stress);
            take(batch, response, rest.speed, stress);
            batch.report.jumped += half_work(stress);
        });
        self.find_rate();
        let trouble = self.batches.iter().enumerate().find_map(|(b, batch)| {
            batch.report.trouble.map(|(n, cause)| (b * BATCH + n, told::<M::Flux>(cause)))
        });
        trouble.map_or(Ok(()), |(i, cause)| Err(self.broken(i, cause)))
    }

    /// Return the error that stops the body at a cell.
    fn broken(&self, i: usize, cause: Cause) -> StepError {
        let (body, law, position) = (self.name.clone(), self.material.name(), wide(&self.position(i)));
        let (kind, number) = (PointKind::Cell, self.numbers[i] as usize);
        self.clock.stopped(Stopped::Point { kind, body, number, position, law, cause })
    }

    /// Update the stresses from the present states.
    fn look_up_stresses(&mut self) {
        let numbers = self.virgin.len();
        let Fpm { stress, material, memory, team, batches, rest, .. } = self;
        team.each_piece(stress, BATCH, batches, |_, stress, batch| {
            let Scratch { response, .. } = &mut *team.own(memory);
            let groups = &GROUPS[..stress.len().div_ceil(GROUP)];
            let states = States { all: &batch.rows, stride: numbers, first: 0, groups };
            // Viscous stresses, which limit the time step by the size of cells, come with the first strain.
            material.describe(states, f64::INFINITY, response);
            take(batch, response, rest.speed, stress);
        });
        self.find_rate();
    }

    /// Continue after loading a checkpoint.
    pub(crate) fn go_on(&mut self) {
        self.fit_all();
        self.find_softening();
        self.deform();
        for (i, p) in self.stress.iter_mut().enumerate() {
            let batch = &self.batches[i / BATCH];
            *p = nominal(&batch.said[i % BATCH], &inverse(&with_identity(&batch.gradient[i % BATCH])));
        }
        self.tractions(false);
        self.forces();
        self.find_rows();
    }

    /// Update the forces of open faces, and book their dissipation.
    fn bear(&mut self, time: f64) {
        let Fpm { cracks, traces, friction, team, .. } = self;
        let (traces, friction) = (&traces[..], *friction);
        let mut taken = vec![Default::default(); cracks.len()];
        let starts: Vec<u32> = (0..=cracks.len() as u32).collect();
        team.each_part(cracks, &starts, &mut taken, |_, crack, taken| {
            let [a, b] = crack[0].cells.map(|c| &traces[c as usize]);
            if !crack[0].softens {
                *taken = crack[0].step(time, [a, b], friction);
            }
        });
        for taken in taken {
            self.exchange.friction += taken.rubbed;
            self.exchange.conversion -= taken.dissipated;
            self.dissipated += taken.dissipated;
        }
    }

    /// Update the tractions on faces; with `books` also their work in a step.
    pub(crate) fn tractions(&mut self, books: bool) {
        let Fpm { loads, traces, stress, sides, cracks, acting, volume, method, team, batches, .. } = self;
        let around = Around { traces, stress, sides, cracks, acting, volume, method: *method };
        team.each_piece(loads, BATCH, batches, |b, loads, batch| {
            around.tractions(b * BATCH, loads, batch, books);
        });
    }

    /// Update the tractions of one batch again.
    pub(crate) fn tractions_of(&mut self, b: usize) {
        let Fpm { loads, traces, stress, sides, cracks, acting, volume, method, batches, .. } = self;
        let around = Around { traces, stress, sides, cracks, acting, volume, method: *method };
        let end = loads.len().min((b + 1) * BATCH);
        around.tractions(b * BATCH, &mut loads[b * BATCH..end], &mut batches[b], false);
    }

    fn enter_books(&mut self) {
        for batch in &self.batches {
            self.exchange.work += batch.report.work;
            for (booking, work) in self.exchange.accounts.iter_mut().zip(batch.report.work_of) {
                booking.work += work;
            }
            self.exchange.impacts -= batch.report.flux;
            self.exchange.conversion += batch.report.jumped;
            self.dissipated -= batch.report.jumped;
        }
    }

    /// Update the forces of one batch again.
    pub(crate) fn forces_of(&mut self, b: usize) {
        let Fpm { acceleration, sides, loads, mass, .. } = self;
        let end = mass.len().min((b + 1) * BATCH);
        f64::dispatch(Force { sides, loads, mass, first: b * BATCH, out: &mut acceleration[b * BATCH..end] });
    }

    /// Assemble the forces on points.
    pub(crate) fn forces(&mut self) {
        let Fpm { acceleration, sides, loads, mass, batches, team, .. } = self;
        team.each_piece(acceleration, BATCH, batches, |b, out, _| {
            f64::dispatch(Force { sides, loads, mass, first: b * BATCH, out });
        });
    }
}

/// Input of the traction update.
struct Around<'a, const D: usize, M> {
    traces: &'a [Trace<D>],
    stress: &'a [Tensor<D>],
    sides: &'a crate::sides::Sides<D>,
    cracks: &'a [crate::open::OpenFace<D>],
    acting: &'a [crate::loads::FaceLoad<D>],
    volume: &'a [f64],
    method: M,
}

impl<const D: usize, M: Composition<D>> Around<'_, D, M> {
    /// Assemble the loads of the cells of a batch.
    fn tractions(&self, first: usize, loads: &mut [Load<D>], batch: &mut Batch<D>, books: bool) {
        let Around { traces, stress, sides, volume, .. } = *self;
        let Batch { lifting, outer, cracks, report, before, .. } = batch;
        report.candidates.clear();
        let least = self.method.criterion().least();
        let candidates = &mut report.candidates;
        let method = PhantomData::<M>;
        let out = &mut *loads;
        report.penalty = f64::dispatch(Traction {
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
        (report.work, report.work_of) = (0.0, [0.0; ACCOUNTS]);
        for outer in outer {
            let n = outer.cell as usize;
            let (load, p) = (&mut loads[n], &stress[first + n]);
            let given = self.acting[outer.load as usize].act(outer, &traces[first + n], p, load, books);
            report.work += given.work;
            if let Some(account) = self.acting[outer.load as usize].account {
                report.work_of[account] += given.work;
            }
            report.penalty += given.penalty;
        }
        for &(n, crack, end) in cracks.iter() {
            let crack = &self.cracks[crack as usize];
            crack.load(end, &mut loads[n as usize]);
            if crack.softens {
                report.penalty += crack.off_the_penalty(crack.cells.map(|c| &traces[c as usize]));
            }
        }
        if !M::Flux::LIFTED {
            lift_openings(cracks, self.cracks, lifting);
        }
        report.flux = 0.0;
        for (n, before) in before.iter_mut().enumerate() {
            let (now, p) = (&lifting[n], &stress[first + n]);
            if books {
                let (mut change, mut mean) = (*now, *p);
                for a in 0..D {
                    for c in 0..D {
                        change[a][c] -= before[0][a][c];
                        mean[a][c] += before[1][a][c];
                    }
                }
                report.flux += 0.5 * contract(&mean, &change);
            }
            *before = [*now, *p];
        }
    }
}

/// Compute the displacement gradients for the laws of a batch: those of cells, with the symmetric flux minus the part of jumps, and with
/// both fluxes minus the part of jumps on prescribed faces.
#[inline(always)]
fn look<const D: usize, M: Composition<D>>(
    (sides, cracks): (&crate::sides::Sides<D>, &[crate::open::OpenFace<D>]),
    traces: &[Trace<D>],
    first: usize,
    volume: &[f64],
    batch: &mut Batch<D>,
    acting: &[crate::loads::FaceLoad<D>],
    seen: &mut Vec<Tensor<D>>,
) {
    let count = batch.gradient.len();
    seen.clear();
    seen.extend(traces[first..first + count].iter().map(|t| t.h));
    if M::Flux::LIFTED {
        let out = &mut batch.lifting;
        f64::dispatch(Lift { sides, traces, first, out });
        lift_openings(&batch.cracks, cracks, out);
        for (n, (h, lifting)) in seen.iter_mut().zip(out.iter()).enumerate() {
            subtract(h, 1.0 / volume[first + n], lifting);
        }
    }
    for outer in &batch.outer {
        let (n, load) = (outer.cell as usize, &acting[outer.load as usize]);
        if load.holds() {
            let jump = load.jump(&traces[first + n].at(&outer.arm));
            add_dyad(&mut seen[n], -1.0 / volume[first + n], &jump, &outer.area);
        }
    }
}

/// Add the openings of softening faces to sums of A/2 [u] (x) N.
fn lift_openings<const D: usize>(
    sides: &[(u32, u32, u8)],
    cracks: &[crate::open::OpenFace<D>],
    out: &mut [Tensor<D>],
) {
    for &(n, crack, _) in sides {
        let crack = &cracks[crack as usize];
        if crack.softens {
            add_dyad(&mut out[n as usize], 0.5, &crack.apart, &crack.surface.area);
        }
    }
}

/// Store stresses and Courant rates of a batch from the response of its law.
fn take<const D: usize>(
    batch: &mut Batch<D>,
    response: &Response<f64>,
    speed: f64,
    stress: &mut [Tensor<D>],
) {
    batch.report.rate = 0.0;
    for (n, p) in stress.iter_mut().enumerate() {
        let said = &mut batch.said[n];
        let (from, half, lane) = (&response.outputs()[n / GROUP / 2], n / GROUP % 2, n % GROUP);
        for k in 0..6 {
            said[k] = from.stress[k].0[half].as_ref()[lane];
        }
        said[6] = from.volume_ratio.0[half].as_ref()[lane];
        said[7] = from.step_speed.0[half].as_ref()[lane];
        let back = inverse(&with_identity(&batch.gradient[n]));
        *p = nominal(said, &back);
        batch.report.rate = batch.report.rate.max(square_of(&batch.rates[n], said[7] / speed, &back));
    }
}

/// Return P = J sigma F^-T.
#[inline(always)]
fn nominal<const D: usize>(said: &[f64; 8], back: &Tensor<D>) -> Tensor<D> {
    let mut p = zero();
    for a in 0..D {
        for c in 0..D {
            for b in 0..D {
                p[a][c] += said[6] * said[PLACES[a][b]] * back[c][b];
            }
        }
    }
    p
}

/// Return the squared frequency of a cell, with `faster` the wave speed over that at rest and `back` the inverse of F.
#[inline(always)]
pub(crate) fn square_of<const D: usize>([bulk, penalty]: &[f64; 2], faster: f64, back: &Tensor<D>) -> f64 {
    let shorter = faster * largest_row(back);
    bulk * shorter * shorter + penalty
}

/// Return a vector of `D` components as one of three.
pub(crate) fn wide<const D: usize>(a: &[f64; D]) -> [f64; 3] {
    let mut wide = [0.0; 3];
    wide[..D].copy_from_slice(a);
    wide
}

/// Return the displacement gradient of the rotation of a cell.
pub(crate) fn turned<const D: usize>(h: &Tensor<D>) -> Tensor<D> {
    let mut turn = crate::vector::rotation(&with_identity(h));
    let one = identity::<D>();
    (0..D).for_each(|a| (0..D).for_each(|c| turn[a][c] -= one[a][c]));
    turn
}

/// Return the cause of a breakdown of a cell, with a remedy.
fn told<X: Flux>(cause: Breakdown) -> Cause {
    match cause {
        Breakdown::InvertedVolume if X::LIFTED => Cause::Other(FOLDED),
        Breakdown::InvertedVolume => Cause::Other(FLUTTERED),
        other => Cause::Law(other),
    }
}

const FOLDED: &str = "its volume became zero or negative: it was pressed flat, neighbours went through each other, or faces opened in matter that flowed; take smaller \
                      cells, a larger penalty, or elements";
const FLUTTERED: &str = "its volume became zero or negative: it was pressed flat, or motion from cell to cell grew, which the incomplete flux does not hold back in long or nearly \
                         incompressible motion; take `Method::symmetric`, a larger penalty, or smaller cells";
