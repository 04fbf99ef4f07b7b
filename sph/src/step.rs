//! Time step: velocity update, boundary conditions, positions; strain and law; neighbours, kernels, accelerations.

use std::marker::PhantomData;
use std::time::Instant;

use impactite_geometry::search::{Points, SearchError};
use impactite_scene::{Boundary, Cause, MovingPoint, PointKind, SceneError, StepError, Stopped};
use impactite_simd::Float;
use mpm_contact::particles::press_on_walls;
use mpm_contact::vector::wide;
use mpm_materials::material::{Deformation, Length, Motion, States, StatesMut};

use crate::form::{Correction, Form};
use crate::images::{Images, Mirror, MirrorKind};
use crate::load::Outer;
use crate::matrix::{identity, inverse, inverse_of_moments, largest_row, mean_size, times};
use crate::method::Composition;
use crate::records::Records;
use crate::solver::{HELD, PRESCRIBED, Scratch, Sph, StepTimes, TOUCHED};
use crate::stabilisation::Stabilisation;
use crate::sums::{
    BATCH, Balance, Batch, DensityGradient, Diffuse, GROUP, Push, Pushed, Report, Row, Strain, Weigh,
};
use crate::tensors;

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

/// Largest row sum of a correction of density gradients, for gradients that are not corrected: 1 in a liquid, 2 at a surface, more for
/// drops and films, whose gradients are those of a few neighbours and do not tell one side from the other.
const SURROUNDED: f64 = 3.0;

/// Error text for a particle that reaches the axis: cause and remedy.
const AT_AXIS: &str =
    "it came to the axis: take a smaller Courant factor, or a law that stiffens under compression";

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    /// Run a part of a step, and measure its wall time if requested.
    fn part<R>(&mut self, of: impl Fn(&mut StepTimes) -> &mut f64, work: impl FnOnce(&mut Self) -> R) -> R {
        if self.times.is_none() {
            return work(self);
        }
        let begun = Instant::now();
        let made = work(self);
        if let Some(times) = &mut self.times {
            *of(times) += begun.elapsed().as_secs_f64();
        }
        made
    }

    /// Make one step of size `dt`, s.
    pub(crate) fn step(&mut self, dt: f64) -> Result<(), StepError> {
        self.accelerate(dt);
        self.advance(dt)?;
        self.finish(dt)
    }

    /// Update velocities by leapfrog, from the middle of the last step to that of this one.
    pub(crate) fn accelerate(&mut self, dt: f64) {
        self.part(|t| &mut t.motion, |sph| sph.new_velocities(dt));
    }

    fn new_velocities(&mut self, dt: f64) {
        let kick = self.lag + 0.5 * dt;
        self.boundaries.advance(self.clock.time, dt);
        self.kick_mirrors(self.lag, 0.5 * dt);
        self.held.iter_mut().for_each(|held| *held &= !(7 * TOUCHED));
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        let outer = Outer::new(force, &self.loads, &self.numbers, self.clock.time);
        let particles = self.positions.len();
        let acceleration = &self.acceleration;
        let mut mirrored = [false; 3];
        for mirror in self.mirrors.iter().filter(|m| m.kind != MirrorKind::Axis && m.condition.is_none()) {
            mirrored[mirror.axis] = true;
        }
        let symmetries: [_; D] = std::array::from_fn(|d| self.boundaries.symmetry_account(d));
        let velocities = &mut self.records.velocity[..particles];
        self.team.each_piece(velocities, BATCH, &mut self.batches, |b, velocities, batch| {
            batch.report.given = Default::default();
            batch.start.copy_from_slice(velocities);
            for (n, v) in velocities.iter_mut().enumerate() {
                let a = &acceleration[b * BATCH + n];
                let mass = v[3];
                let force = outer.at(b * BATCH + n, mass);
                for d in 0..D {
                    if mirrored[d] {
                        let impulse = kick * mass * a[d];
                        batch.report.given.impulse[d] += impulse;
                        if let Some(account) = symmetries[d] {
                            batch.report.given.accounts[account].impulse[d] += impulse;
                        }
                    }
                    batch.report.given.load[d] += kick * mass * force[d];
                    v[d] += kick * (a[d] + force[d]);
                }
            }
        });
    }

    /// Apply conditions and update positions.
    pub(crate) fn advance(&mut self, dt: f64) -> Result<(), StepError> {
        self.part(|t| &mut t.motion, |sph| sph.new_positions(dt))
    }

    fn new_positions(&mut self, dt: f64) -> Result<(), StepError> {
        self.obey(dt);
        self.press_on_walls(dt);
        self.damp();
        let kick = self.lag + 0.5 * dt;
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        let outer = Outer::new(force, &self.loads, &self.numbers, self.clock.time);
        let velocities = &self.records.velocity;
        self.team.each_piece(&mut self.positions, BATCH, &mut self.batches, |b, positions, batch| {
            batch.report.lost = None;
            for (n, x) in positions.iter_mut().enumerate() {
                let (v, start) = (&velocities[b * BATCH + n], &batch.start[n]);
                let (mut work, mut taken) = (0.0, 0.0);
                let force = outer.at(b * BATCH + n, v[3]);
                for d in 0..D {
                    let mean = 0.5 * (start[d] + v[d]);
                    work += force[d] * mean;
                    if let Some(a) = batch.stabilising.get(n) {
                        taken -= a[d] * mean;
                    }
                    x[d] += dt * v[d];
                }
                batch.report.given.work += kick * v[3] * work;
                batch.report.given.viscosity += kick * v[3] * taken;
                let found = x.iter().all(|x| x.is_finite()) && (!Self::HOOP || x[0] > 0.0);
                if !found && batch.report.lost.is_none() {
                    batch.report.lost = Some(n);
                }
            }
        });
        for batch in &self.batches {
            self.exchange.add(&batch.report.given);
        }
        self.lag = 0.5 * dt;
        self.wrap();
        let lost =
            self.batches.iter().enumerate().find_map(|(b, batch)| Some(b * BATCH + batch.report.lost?));
        match lost {
            Some(i) if Self::HOOP && self.positions[i][0] <= 0.0 => {
                Err(self.broken(i, Cause::Other(AT_AXIS)))
            }
            Some(i) => Err(self.broken(i, Cause::Velocity)),
            None => Ok(()),
        }
    }

    /// Apply local damping, if set, in directions without conditions.
    fn damp(&mut self) {
        if !self.damping.acts() {
            return;
        }
        let particles = self.positions.len();
        let Sph { records, team, batches, held, damping, .. } = self;
        team.each_piece(&mut records.velocity[..particles], BATCH, batches, |b, velocities, batch| {
            for (n, v) in velocities.iter_mut().enumerate() {
                for d in (0..D).filter(|d| held[b * BATCH + n] & HELD << d == 0) {
                    let slowed = damping.slowed(batch.start[n][d], v[d]);
                    let impulse = v[3] * (slowed - v[d]);
                    batch.report.given.load[d] += impulse;
                    batch.report.given.damping -= 0.5 * impulse * (batch.start[n][d] + slowed);
                    v[d] = slowed;
                }
            }
        });
    }

    /// Enforce boundary conditions on velocities.
    fn obey(&mut self, dt: f64) {
        let walls = self.mirrors.iter().filter(|m| matches!(m.kind, MirrorKind::Wall | MirrorKind::Stick));
        let walls: Vec<Boundary<D>> = walls.map(Mirror::wall).collect();
        if self.boundaries.is_empty() && walls.is_empty() {
            return;
        }
        let particles = self.positions.len();
        let Sph { records, boundaries, positions, spacing, clock, team, batches, held, .. } = self;
        let time = clock.time;
        // With corrected gradients `press_on_walls` keeps the surface in front of walls; here only particles are stopped.
        let surface = if M::Correction::CORRECTED || M::Correction::SCALED { 0.0 } else { self.surface };
        team.each_piece(&mut records.velocity[..particles], BATCH, batches, |b, velocities, batch| {
            for (n, v) in velocities.iter_mut().enumerate() {
                let i = b * BATCH + n;
                let mut point = MovingPoint {
                    position: positions[i],
                    mass: v[3],
                    start: std::array::from_fn(|d| batch.start[n][d]),
                    velocity: std::array::from_fn(|d| v[d]),
                    size: spacing[i],
                    depth: 0.5 * (1.0 + surface) * spacing[i],
                    tolerance: 0.5 * (0.5 + surface) * spacing[i],
                };
                let mut prescribed = 0;
                for (number, boundary) in boundaries.iter().enumerate() {
                    let before = point.velocity;
                    // Walls are in contact with the surface.
                    let behind = match *boundary {
                        Boundary::Wall { axis, side, .. } | Boundary::FrictionWall { axis, side, .. } => {
                            Some((axis, 0.5 * surface * spacing[i] * side.sign()))
                        }
                        _ => None,
                    };
                    if let Some((axis, half)) = behind {
                        point.position[axis] -= half;
                    }
                    // A dashpot acts on the particles whose surface is at the plane.
                    let whole = point;
                    if let Boundary::Absorbing { axis, side, .. } = *boundary {
                        point.position[axis] -= 0.5 * spacing[i] * side.sign();
                        (point.depth, point.tolerance) = (spacing[i], 0.25 * spacing[i]);
                    }
                    boundaries.hold(number, &mut point, (time, dt), &mut batch.report.given);
                    point = MovingPoint { velocity: point.velocity, ..whole };
                    if let Some((axis, half)) = behind {
                        point.position[axis] += half;
                    } else {
                        for d in (0..D).filter(|d| point.velocity[*d] != before[*d]) {
                            prescribed |= PRESCRIBED << d;
                        }
                    }
                }
                // Stop particles that penetrate a wall of mirror images.
                for wall in &walls {
                    wall.hold(&mut point, (time, dt), &mut batch.report.given);
                }
                let mut moved: u16 = prescribed;
                for d in 0..D {
                    if point.velocity[d] != v[d] {
                        moved |= HELD << d;
                        v[d] = point.velocity[d];
                    }
                }
                batch.start[n][3] = f64::from(moved);
            }
        });
        for (b, batch) in batches.iter().enumerate() {
            for (held, start) in held[b * BATCH..].iter_mut().zip(&batch.start) {
                *held = *held & (7 * TOUCHED) | start[3] as u16;
            }
        }
    }

    /// Enforce walls on the surface of the body.
    fn press_on_walls(&mut self, dt: f64) {
        if !M::Correction::CORRECTED || !self.boundaries.iter().any(Boundary::is_wall) {
            return;
        }
        let boundaries = std::mem::take(&mut self.boundaries);
        let start = |sph: &Self, n: usize| -> [f64; D] {
            let i = sph.places[n] as usize;
            let start = &sph.batches[i / BATCH].start[i % BATCH];
            std::array::from_fn(|d| start[d])
        };
        let (given, moved) = press_on_walls(self, &boundaries, &start, (self.clock.time, dt));
        self.boundaries = boundaries;
        self.exchange.add(&given);
        for (n, bits) in moved {
            self.held[self.places[n] as usize] |= u16::from(bits);
        }
    }

    /// Update strain, law, neighbours and accelerations at the new positions.
    pub(crate) fn finish(&mut self, dt: f64) -> Result<(), StepError> {
        self.part(|t| &mut t.law, |sph| sph.strain(dt))?;
        self.refresh(dt)?;
        self.part(|t| &mut t.sums, Self::push);
        self.clock.advance(dt);
        Ok(())
    }

    /// Update velocity gradients and integrate the law.
    fn strain(&mut self, dt: f64) -> Result<(), StepError> {
        self.images.fill_velocities(&mut self.records);
        let numbers = self.virgin.len();
        let sticks = self.mirrors.iter().any(|mirror| mirror.kind == MirrorKind::Stick);
        let Sph { records, material, memory, team, positions, spacing, batches, reference, images, .. } =
            self;
        team.each(batches, |b, batch| {
            let Batch { near, moments, .. } = batch;
            f64::dispatch(Strain { records, near, first: b * BATCH, places: false, out: moments });
            if sticks {
                Self::stick(images, records, near, b * BATCH, moments);
            }
            let Scratch { deformations, lengths, response } = &mut *team.own(memory);
            let count = batch.moments.len();
            let groups = count.div_ceil(GROUP);
            deformations.clear();
            deformations.resize(groups.div_ceil(2), Deformation::default());
            lengths.resize(groups, Row::default());
            for n in 0..count {
                let i = b * BATCH + n;
                let increment = times(&batch.moments[n], &batch.correction[n], D);
                let (to, half, lane) = (&mut deformations[n / GROUP / 2], n / GROUP % 2, n % GROUP);
                // The gradient is the increment itself, with a step of one.
                to.step.0[half].as_mut()[lane] = 1.0;
                for a in 0..D {
                    for c in 0..D {
                        to.gradient[3 * a + c].0[half].as_mut()[lane] = dt * increment[a][c];
                    }
                }
                if Self::HOOP {
                    let v = records.velocity[i][0];
                    to.gradient[8].0[half].as_mut()[lane] = dt * v / (positions[i][0] - dt * v);
                }
                if let Some(rate) = batch.diffusing.get(n) {
                    for d in [0, 4, 8] {
                        to.gradient[d].0[half].as_mut()[lane] -= dt * rate / 3.0;
                    }
                }
                if let Some(spin) = batch.spin.get_mut(n) {
                    let half = |a: usize, b: usize| 0.5 * dt * (increment[a][b] - increment[b][a]);
                    *spin = [half(1, 0), half(2, 0), half(2, 1)];
                }
                lengths[n / GROUP].as_mut()[lane] = spacing[i];
                // F' = K C0 is exact; C = C0 F^-1.
                if let (Some(first), Some(f)) = (batch.first.get(n), batch.deformation.get_mut(n)) {
                    let rate = times(&batch.moments[n], first, D);
                    (0..D).for_each(|a| (0..D).for_each(|c| f[a][c] += dt * rate[a][c]));
                    batch.correction[n] = times(first, &inverse(f, D), D);
                }
            }
            let groups = &GROUPS[..groups];
            let motion = Motion { deformation: deformations, dt, length: Length::Each(lengths) };
            let states = StatesMut { all: &mut batch.rows, stride: numbers, first: 0, groups };
            material.advance(&motion, states, true, response);
            let broken = response.faults().iter().map(|f| (f.group * GROUP + f.lane, f.cause));
            batch.report.trouble = broken.filter(|(n, _)| *n < count).min_by_key(|(n, _)| *n);
            let before = work_of_diffusion(batch, &reference[b * BATCH..]);
            take(batch, response);
            // Work of density diffusion on the law, without that of motion, by the mean of the stresses before and after.
            batch.report.diffused = 0.5 * dt * (before + work_of_diffusion(batch, &reference[b * BATCH..]));
        });
        if Self::HAS.diffusion {
            self.exchange.viscosity -= self.batches.iter().map(|batch| batch.report.diffused).sum::<f64>();
        }
        let trouble =
            self.batches.iter().enumerate().find_map(|(b, batch)| {
                batch.report.trouble.map(|(n, cause)| (b * BATCH + n, Cause::Law(cause)))
            });
        trouble.map_or(Ok(()), |(i, cause)| Err(self.broken(i, cause)))
    }

    /// Return the error that stops the body at a particle.
    fn broken(&self, i: usize, cause: Cause) -> StepError {
        let (body, law, position) = (self.name.clone(), self.material.name(), wide(&self.positions[i]));
        let (kind, number) = (PointKind::Particle, self.numbers[i] as usize);
        self.clock.stopped(Stopped::Point { kind, body, number, position, law, cause })
    }

    /// Update neighbours, kernels and stresses at the new positions.
    fn refresh(&mut self, dt: f64) -> Result<(), StepError> {
        if M::Form::TOTAL {
            self.part(|t| &mut t.sums, |sph| sph.tensors(dt));
            let most = self.batches.iter().map(|b| b.report.stretch).fold(0.0, f64::max);
            if self.method.form().renewed_at().is_some_and(|limit| most > limit) {
                self.renewals += 1;
                return self.renew(dt).map_err(|error| self.searched(error));
            }
            return Ok(());
        }
        self.move_mirrors(self.clock.time + dt);
        if self.has_moving_walls() {
            self.check_gaps().map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        }
        self.place();
        self.neighbours().map_err(|error| self.searched(error))?;
        self.part(
            |t| &mut t.sums,
            |sph| {
                sph.correct();
                sph.tensors(dt);
            },
        );
        Ok(())
    }

    fn searched(&self, error: SearchError) -> StepError {
        self.clock.stopped(Stopped::Scene(SceneError::Search(error)))
    }

    /// Advance velocities to the time of the positions by the present forces: later forces had no part in the last step.
    fn synchronise(&mut self) {
        let lag = std::mem::take(&mut self.lag);
        self.kick_mirrors(lag, 0.0);
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        let outer = Outer::new(force, &self.loads, &self.numbers, self.clock.time);
        for (i, v) in self.records.velocity.iter_mut().take(self.positions.len()).enumerate() {
            let force = outer.at(i, v[3]);
            let stabilising = self.batches[i / BATCH].stabilising.get(i % BATCH);
            for d in (0..D).filter(|d| self.held[i] & HELD << d == 0) {
                let (a, mass, before) = (self.acceleration[i][d], v[3], v[d]);
                v[d] += lag * (a + force[d]);
                let mean = 0.5 * (before + v[d]);
                self.exchange.load[d] += lag * mass * force[d];
                self.exchange.work += lag * mass * force[d] * mean;
                self.exchange.viscosity -= stabilising.map_or(0.0, |a| lag * mass * a[d] * mean);
                if self
                    .mirrors
                    .iter()
                    .any(|m| m.kind != MirrorKind::Axis && m.axis == d && m.condition.is_none())
                {
                    self.exchange.impulse[d] += lag * mass * a;
                    if let Some(account) = self.boundaries.symmetry_account(d) {
                        self.exchange.accounts[account].impulse[d] += lag * mass * a;
                    }
                }
            }
        }
    }

    /// Apply a change, and restart with the present positions and states as the reference.
    pub(crate) fn begin_anew_with(&mut self, change: impl FnOnce(&mut Self)) -> Result<(), SceneError> {
        if self.lag > 0.0 {
            self.synchronise();
        }
        change(self);
        let numbers = self.virgin.len();
        // The viscosity of a liquid limits its first step, too; that of other laws comes with the first strain.
        let smallest = self.spacing.iter().fold(f64::INFINITY, |least, x| x.min(least));
        let length = if M::Correction::SCALED { smallest } else { f64::INFINITY };
        let Sph { material, memory, team, batches, .. } = self;
        team.each(batches, |_, batch| {
            let Scratch { response, .. } = &mut *team.own(memory);
            let groups = &GROUPS[..batch.stress.len().div_ceil(GROUP)];
            let states = States { all: &batch.rows, stride: numbers, first: 0, groups };
            material.describe(states, length, response);
            take(batch, response);
        });
        self.renew(f64::INFINITY).map_err(SceneError::Search)?;
        self.push();
        Ok(())
    }

    /// Make the present configuration the reference.
    fn renew(&mut self, dt: f64) -> Result<(), SearchError> {
        let rest = identity(D);
        if self.batches.iter().flat_map(|batch| &batch.deformation).any(|f| *f != rest) {
            // Springs are unloaded by the update.
            self.exchange.conversion -= self.penalty_energy();
            for batch in &mut self.batches {
                batch.before = (0..batch.stress.len()).filter_map(|n| batch.whole(n, D)).collect();
                batch.deformation.fill(rest);
            }
        }
        self.place();
        self.neighbours()?;
        self.skin.forget();
        self.correct();
        self.tensors(dt);
        Ok(())
    }

    /// Rebuild neighbours, kernels and accelerations from positions, states and stresses.
    pub(crate) fn go_on(&mut self) -> Result<(), SearchError> {
        self.skin.forget();
        self.neighbours()?;
        self.correct();
        self.tensors(0.0);
        self.push();
        Ok(())
    }

    /// Move kernels to the present positions of the particles.
    fn place(&mut self) {
        let particles = self.positions.len();
        let Sph { records, positions, reference, batches, team, .. } = self;
        team.each_piece(&mut records.place[..particles], BATCH, batches, |b, places, batch| {
            for (n, place) in places.iter_mut().enumerate() {
                let i = b * BATCH + n;
                place[..D].copy_from_slice(&positions[i]);
                let volume = reference[i] * batch.stress[n][6];
                place[3] = if Self::HOOP { volume / positions[i][0] } else { volume };
            }
        });
    }

    /// Update the neighbours within reach; search if the lists are outdated.
    fn neighbours(&mut self) -> Result<(), SearchError> {
        self.part(|t| &mut t.search, Self::search)?;
        self.part(|t| &mut t.kernels, Self::weigh);
        Ok(())
    }

    fn search(&mut self) -> Result<(), SearchError> {
        let particles = self.positions.len();
        self.images.fill_places(&mut self.records);
        let Records { place, smoothing, .. } = &self.records;
        let point = |i: usize| -> [f64; D] { std::array::from_fn(|d| place[i][d]) };
        if !M::Form::TOTAL && self.lists.hold((0..place.len()).map(|i| (point(i), smoothing[i]))) {
            return Ok(());
        }
        self.points.clear();
        self.points.extend((0..particles).map(point));
        let skin = self.lists.skin();
        self.mirrors.iter_mut().for_each(|mirror| mirror.searched = mirror.at);
        self.images = Images::find(&self.mirrors, &self.points, &smoothing[..particles], skin);
        self.records.resize(self.images.all.len(), Self::HAS);
        self.images.fill_places(&mut self.records);
        let Records { place, smoothing, .. } = &self.records;
        self.points.extend(place[particles..].iter().map(|p| -> [f64; D] { std::array::from_fn(|d| p[d]) }));
        self.lists.forget();
        self.lists.update_with(self.search, &Points::new(&self.points, smoothing)?, &self.team)?;
        Ok(())
    }

    fn weigh(&mut self) {
        let walls = self.mirrors.iter().any(|m| m.kind == MirrorKind::Wall);
        let power = Self::HAS.stress.then(|| self.method.stabilisation().artificial().1);
        let Sph { method, records, lists, images, batches, team, .. } = self;
        let (kernel, lists) = (method.kernel(), lists.lists());
        team.each(batches, |b, batch| {
            let (first, count) = (b * BATCH, batch.stress.len());
            let Batch { near, stress, .. } = batch;
            f64::dispatch(Weigh { kernel, records, lists, first, count, power, images, walls, stress, near });
        });
    }

    /// Update the gradient correction from the moments.
    fn correct(&mut self) {
        let Sph { records, batches, team, scale, .. } = self;
        let mut scaled = identity(D);
        (0..D).for_each(|d| scaled[d][d] = *scale);
        team.each(batches, |b, batch| {
            if !M::Correction::CORRECTED {
                batch.correction.fill(scaled);
                if !Self::HAS.diffusion {
                    return;
                }
            }
            let Batch { near, moments, .. } = batch;
            f64::dispatch(Strain { records, near, first: b * BATCH, places: true, out: moments });
            if !M::Correction::CORRECTED {
                let Batch { moments, of_density, surrounded, .. } = batch;
                for ((moments, out), surrounded) in moments.iter().zip(of_density).zip(surrounded) {
                    *out = inverse_of_moments(moments, D);
                    *surrounded = largest_row(out, D) <= SURROUNDED;
                }
                return;
            }
            for n in 0..batch.moments.len() {
                let first = inverse_of_moments(&batch.moments[n], D);
                batch.correction[n] = if M::Form::TOTAL {
                    batch.first[n] = first;
                    times(&first, &inverse(&batch.deformation[n], D), D)
                } else {
                    first
                };
            }
        });
    }

    /// Update pair stresses and Courant rates, `dt` seconds after the last update.
    fn tensors(&mut self, dt: f64) {
        let particles = self.positions.len();
        let scale = tensors::Scale {
            penalty: self.method.stabilisation().penalty() * self.modulus,
            stiffer: self.method.stabilisation().penalty(),
            space: if D == 3 { 2 } else { usize::from(Self::HOOP) },
            corrected: M::Correction::CORRECTED,
        };
        let renews = self.method.form().renewed_at().is_some();
        let Sph { records, batches, team, reference, positions, .. } = self;
        let Records { place, smoothing, tensor, .. } = records;
        team.each_piece(&mut tensor[..particles], BATCH, batches, |b, tensors, batch| {
            let mut report = Report { rate: 0.0, stretch: 0.0, ..batch.report };
            for (n, out) in tensors.iter_mut().enumerate() {
                let i = b * BATCH + n;
                let said = &batch.stress[n];
                let area = place[i][3];
                let volume = reference[i] * said[6];
                let factor = volume / area;
                let correction = &batch.correction[n];
                *out = tensors::columns(said, factor, correction);
                if Self::HAS.penalty {
                    let radius = if Self::HOOP { place[i][0] } else { 1.0 };
                    tensors::less_penalty(out, scale.penalty * radius, &batch.deformation[n]);
                }
                if renews {
                    let f = &batch.deformation[n];
                    let stretch = mean_size(f, D).max(mean_size(&inverse(f, D), D));
                    report.stretch = report.stretch.max(stretch);
                }
                let rate = scale.rate(said[7], largest_row(correction, D), smoothing[i]);
                report.rate = report.rate.max(rate);
            }
            batch.report = report;
        });
        if Self::HAS.penalty {
            for (i, x) in positions.iter().enumerate() {
                let first = if D == 2 { 2 } else { 0 };
                records.now[i][first..first + D].copy_from_slice(x);
                let radius = if Self::HOOP { records.place[i][0] } else { 1.0 };
                records.bias[i] = scale.penalty * radius;
            }
        }
        if Self::HAS.stress {
            let eps = self.method.stabilisation().artificial().0;
            let Sph { records, batches, team, reference, .. } = self;
            let Records { place, artificial, smoothing, .. } = records;
            team.each_piece(&mut artificial[..particles], BATCH, batches, |b, tensors, batch| {
                for (n, out) in tensors.iter_mut().enumerate() {
                    let i = b * BATCH + n;
                    let said = &batch.stress[n];
                    let volume = reference[i] * said[6];
                    let now: [[f64; 4]; D] = tensors::artificial(said, eps * volume / place[i][3]);
                    let part = tensors::followed(dt * said[7] / smoothing[i]);
                    if part > 0.0 {
                        *out = tensors::turned(out, &batch.spin[n]);
                    }
                    for (out, now) in out.iter_mut().flatten().zip(now.iter().flatten()) {
                        *out += part * (now - *out);
                    }
                }
            });
            if Self::HAS.balance {
                self.balance();
            }
        }
        if Self::HAS.viscosity || Self::HAS.diffusion {
            let Sph { records, batches, reference, .. } = self;
            for (i, fluid) in records.fluid[..particles].iter_mut().enumerate() {
                let said = &batches[i / BATCH].stress[i % BATCH];
                let radius = if Self::HOOP { records.place[i][0] } else { 1.0 };
                *fluid = [records.velocity[i][3] / (reference[i] * said[6]) * radius, said[7]];
            }
        }
        if Self::HAS.diffusion {
            let Records { velocity, density, .. } = &mut self.records;
            for (i, density) in density[..particles].iter_mut().enumerate() {
                let said = &self.batches[i / BATCH].stress[i % BATCH];
                density[3] = velocity[i][3] / (self.reference[i] * said[6]);
            }
        }
        self.images.fill_tensors(&mut self.records);
        if Self::HAS.diffusion {
            self.diffuse();
        }
        self.rate = self.batches.iter().map(|b| b.report.rate).fold(0.0, f64::max);
    }

    /// Update the balance of the artificial stress of each particle.
    fn balance(&mut self) {
        let particles = self.positions.len();
        let mut balance = std::mem::take(&mut self.records.balance);
        let Sph { records, batches, team, .. } = self;
        team.each_piece(&mut balance[..particles], BATCH, batches, |b, tensors, batch| {
            let Batch { near, .. } = batch;
            let sums = Balance { records, near, first: b * BATCH };
            tensors.iter_mut().enumerate().for_each(|(n, out)| *out = sums.of(n));
        });
        self.records.balance = balance;
    }

    /// Update the rates of density diffusion.
    fn diffuse(&mut self) {
        self.images.fill_densities(&mut self.records);
        if M::Correction::SCALED {
            self.weigh_images();
        }
        let Sph { records, batches, team, .. } = self;
        team.each(batches, |b, batch| {
            let Batch { near, correction, of_density, moments, .. } = batch;
            let correction = if M::Correction::CORRECTED { correction } else { of_density };
            let sums = DensityGradient { records, near, first: b * BATCH, correction };
            moments.iter_mut().enumerate().for_each(|(n, out)| out[0] = sums.of(n));
        });
        for (i, density) in records.density[..records.particles].iter_mut().enumerate() {
            density[..3].copy_from_slice(&batches[i / BATCH].moments[i % BATCH][0]);
        }
        for (i, diffuses) in records.diffuses[..records.particles].iter_mut().enumerate() {
            *diffuses = batches[i / BATCH].surrounded.get(i % BATCH).copied().unwrap_or(true);
        }
        self.images.fill_densities(&mut self.records);
        if M::Correction::SCALED {
            self.weigh_images();
        }
        let delta = self.method.stabilisation().diffusion();
        let Sph { records, batches, team, .. } = self;
        team.each(batches, |b, batch| {
            let Batch { near, diffusing, .. } = batch;
            let sums = Diffuse { records, near, first: b * BATCH, delta };
            diffusing.iter_mut().enumerate().for_each(|(n, out)| *out = sums.of(n));
        });
    }

    /// Assemble accelerations by neighbours and by hoop stress.
    pub(crate) fn push(&mut self) {
        if Self::HAS.viscosity {
            self.images.fill_velocities(&mut self.records);
        }
        let viscosity = self.viscosity;
        let Sph { records, batches, team, acceleration, reference, positions, .. } = self;
        team.each_piece(acceleration, BATCH, batches, |b, acceleration, batch| {
            let first = b * BATCH;
            let Batch { near, stabilising, .. } = batch;
            let out = Pushed { acceleration, stabilising };
            let method = PhantomData::<M>;
            f64::dispatch(Push { records, near, first, viscosity, out, method });
            if Self::HOOP {
                for (n, a) in acceleration.iter_mut().enumerate() {
                    let (i, said) = (first + n, &batch.stress[n]);
                    let volume = reference[i] * said[6];
                    a[0] -= volume * said[2] / (records.velocity[i][3] * positions[i][0]);
                }
            }
        });
        if M::Correction::SCALED {
            self.press_on_mirrors();
        }
    }
}

/// Return the power of density diffusion on the laws of a batch at its stresses, W.
fn work_of_diffusion(batch: &Batch, reference: &[f64]) -> f64 {
    let of = |((said, rate), volume): ((&[f64; 8], &f64), &f64)| {
        -(said[0] + said[1] + said[2]) / 3.0 * rate * volume * said[6]
    };
    batch.stress.iter().zip(&batch.diffusing).zip(reference).map(of).sum()
}

/// Store stress, volume ratio and wave speed of the particles of a batch.
fn take(batch: &mut Batch, response: &mpm_materials::material::Response<f64>) {
    for (n, said) in batch.stress.iter_mut().enumerate() {
        let (from, half, lane) = (&response.outputs()[n / GROUP / 2], n / GROUP % 2, n % GROUP);
        for k in 0..6 {
            said[k] = from.stress[k].0[half].as_ref()[lane];
        }
        said[6] = from.volume_ratio.0[half].as_ref()[lane];
        said[7] = from.step_speed.0[half].as_ref()[lane];
    }
}
