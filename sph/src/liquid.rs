//! Walls of liquids: mirror images that follow conditions, with the weight of the liquid between a particle and its image.
//!
//! An image has the pressure of its particle and, for a distance d between both, what the weight of the liquid adds: rho b . d. Without
//! it the pressure would have a cusp at the floor, and those of the first rows would be wrong by up to half of the weight of a row.

use impactite_scene::{Boundary, BoundaryEntry, SceneError};

use crate::images::{Image, Images, Mirror, MirrorKind};
use crate::layout::number;
use crate::matrix::Matrix;
use crate::method::Composition;
use crate::records::Records;
use crate::solver::Sph;
use crate::stabilisation::Stabilisation;
use crate::sums::{BATCH, Batch, Near, Viscous};

impl<const D: usize> Image<D> {
    /// Return the vector from a particle at `x` to the image, m, across mirrors alone.
    fn away(&self, x: &[f64; 4]) -> [f64; D] {
        let own: [f64; D] = std::array::from_fn(|d| x[d]);
        let there = self.place(&own);
        std::array::from_fn(|d| if self.flips[d] < 0.0 { there[d] - own[d] } else { 0.0 })
    }
    /// Return the number of the mirror to which a force along an axis belongs: that across the axis, or another one.
    fn bearer(&self, axis: usize) -> Option<usize> {
        let mirror = |d: usize| (self.flips[d] < 0.0).then_some(usize::from(self.mirrors[d]));
        mirror(axis).or_else(|| (0..D).find_map(mirror))?.checked_sub(1)
    }
}

/// c h over the kinematic viscosity of a linear pair viscosity of one, which acts on approaching pairs alone.
const PER_KINEMATIC: f64 = 16.0;

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    (0..D).map(|d| a[d] * b[d]).sum()
}

impl<const D: usize, M: Composition<D>> Sph<D, M> {
    /// Reduce the linear pair viscosity, which is like a kinematic viscosity of at most alpha c h / [`PER_KINEMATIC`], by that of the law.
    pub(crate) fn reduce_pair_viscosity(&mut self) {
        let sound = self.speed_at_rest;
        let h = self.records.smoothing.iter().fold(0.0f64, |most, h| most.max(*h));
        // The time step speed of a law of kinematic viscosity nu over a length l is c + 8/3 nu / l.
        let step = self.material.step_speed(&self.virgin, h).unwrap_or(sound);
        let kinematic = 0.375 * (step - sound).max(0.0) * h;
        if sound > 0.0 {
            self.viscosity[0] = (self.viscosity[0] - PER_KINEMATIC * kinematic / (sound * h)).max(0.0);
        }
    }

    /// Add a condition of a liquid: walls, fixed planes and planes of symmetry are mirrors.
    pub(crate) fn bound_liquid(&mut self, entry: BoundaryEntry<D>) -> Result<bool, SceneError> {
        let (axis, at, side) = match *entry.boundary() {
            Boundary::Symmetry { axis, at, side }
            | Boundary::Fixed { axis, at, side }
            | Boundary::Wall { axis, at, side, .. }
            | Boundary::FrictionWall { axis, at, side, .. } => (axis, at, side),
            Boundary::Periodic { axis, low, high } => return self.bound_period(entry, axis, low, high),
            _ => return Ok(false),
        };
        for (i, x) in self.positions.iter().enumerate() {
            let allowed = "in front of the walls";
            let open = (x[axis] - at) * side.sign() > 0.0;
            number(open, "position", self.numbers[i] as usize, x[axis], allowed)?;
        }
        self.bound_by_mirrors(entry)?;
        self.check_gaps()?;
        Ok(true)
    }

    /// Refuse walls so near to each other that particles are within reach of the images of images.
    pub(crate) fn check_gaps(&self) -> Result<(), SceneError> {
        let reach = 2.0 * self.records.smoothing.iter().fold(0.0f64, |most, h| most.max(*h));
        let walls = || self.mirrors.iter().filter(|m| m.kind.bounds_liquid());
        let gaps = walls().filter(|m| m.sign > 0.0).flat_map(|low| {
            walls().filter(move |m| m.sign < 0.0 && m.axis == low.axis).map(move |high| high.at - low.at)
        });
        let narrowest = gaps.fold(f64::INFINITY, f64::min);
        if narrowest >= reach {
            return Ok(());
        }
        Err(SceneError::NotWith {
            what: format!("a gap of {narrowest:e} m between two walls of a liquid"),
            method: self.name.clone(),
            why: "smoothed particles reach across it: take a spacing of at most a quarter of it",
        })
    }

    /// True if a wall of the liquid moves.
    pub(crate) fn has_moving_walls(&self) -> bool {
        self.mirrors.iter().any(|mirror| mirror.speed != 0.0)
    }

    /// Add periodic planes: particles beyond one of them enter at the other, and have images beyond both.
    fn bound_period(
        &mut self,
        entry: BoundaryEntry<D>,
        axis: usize,
        low: f64,
        high: f64,
    ) -> Result<bool, SceneError> {
        let largest = self.records.smoothing.iter().fold(0.0f64, |most, h| most.max(*h));
        if high - low < 5.0 * largest {
            return Err(SceneError::NotWith {
                what: format!("a period of {:e} m of a liquid", high - low),
                method: self.name.clone(),
                why: "particles would meet themselves: it needs at least five smoothing lengths, eight spacings",
            });
        }
        for (i, x) in self.positions.iter().enumerate() {
            let within = (low..=high).contains(&x[axis]);
            number(within, "position", self.numbers[i] as usize, x[axis], "between the periodic planes")?;
        }
        self.bound_by_mirrors(entry)?;
        Ok(true)
    }

    /// Add a condition, and find the mirrors of all conditions anew.
    fn bound_by_mirrors(&mut self, entry: BoundaryEntry<D>) -> Result<(), SceneError> {
        self.boundaries.add(entry);
        self.lists.forget();
        self.begin_anew_with(|sph| {
            sph.mirrors.retain(|mirror| mirror.condition.is_none());
            for (n, boundary) in sph.boundaries.iter().enumerate() {
                let (axis, at, side, kind) = match *boundary {
                    Boundary::Symmetry { axis, at, side }
                    | Boundary::Wall { axis, at, side, .. }
                    | Boundary::FrictionWall { axis, at, side, .. } => (axis, at, side, MirrorKind::Slip),
                    Boundary::Fixed { axis, at, side } => (axis, at, side, MirrorKind::Stick),
                    Boundary::Periodic { axis, low, high } => {
                        for (at, sign, by) in [(low, 1.0, high - low), (high, -1.0, low - high)] {
                            let kind = MirrorKind::Period(by);
                            sph.mirrors
                                .push(Mirror { condition: Some(n), ..Mirror::new(axis, at, sign, kind) });
                        }
                        continue;
                    }
                    _ => continue,
                };
                sph.mirrors.push(Mirror { condition: Some(n), ..Mirror::new(axis, at, side.sign(), kind) });
            }
            let time = sph.clock.time;
            sph.set_mirror_speeds();
            sph.move_mirrors(time);
        })
    }

    /// Let particles beyond a periodic plane enter at the other one.
    pub(crate) fn wrap(&mut self) {
        for mirror in &self.mirrors {
            let MirrorKind::Period(by) = mirror.kind else { continue };
            let mut wrapped = false;
            for x in &mut self.positions {
                if (x[mirror.axis] - mirror.at) * mirror.sign < 0.0 {
                    x[mirror.axis] += by;
                    wrapped = true;
                }
            }
            if wrapped {
                self.lists.forget();
            }
        }
    }

    /// Set the velocities of mirrors to those of their walls in the present step.
    pub(crate) fn set_mirror_speeds(&mut self) {
        for mirror in &mut self.mirrors {
            let wall = mirror.condition.and_then(|n| self.boundaries.get(n));
            mirror.speed = match wall {
                Some(Boundary::Wall { velocity, .. }) => *velocity,
                Some(Boundary::FrictionWall { velocity, .. }) => velocity[mirror.axis],
                _ => 0.0,
            };
        }
    }

    /// Move mirrors to the places of their walls at a time, s, the end of the present step.
    pub(crate) fn move_mirrors(&mut self, time: f64) {
        let mut moved = false;
        for mirror in &mut self.mirrors {
            let Some(at) = mirror.condition.and_then(|n| self.boundaries.wall_at(n, time)) else { continue };
            // Images are of particles within reach at the last search, plus the skin.
            moved |= (at - mirror.searched).abs() > 0.25 * self.lists.skin();
            mirror.at = at;
        }
        if moved {
            self.lists.forget();
        }
        self.images.follow(&self.mirrors);
    }

    /// Add the weight of the liquid between particles and their images to the densities of images.
    pub(crate) fn weigh_images(&mut self) {
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        let Records { particles, place, density, fluid, .. } = &mut self.records;
        for (n, image) in self.images.all.iter().enumerate() {
            let source = image.source as usize;
            let rho = density[source][3];
            let slope = rho / (fluid[source][1] * fluid[source][1]).max(f64::MIN_POSITIVE);
            let to = &mut density[*particles + n];
            to[3] += slope * dot(&force, &image.away(&place[source]));
            for d in 0..D {
                to[d] += slope * force[d] * (1.0 - image.flips[d]);
            }
        }
    }

    /// Turn the velocities of images along walls to which the liquid sticks, in the shear rates across these walls alone: the divergence of
    /// a flow along a wall stays zero, and the work of pressures and shear stresses is that of their forces.
    pub(crate) fn stick(
        images: &Images<D>,
        records: &Records<D>,
        near: &Near,
        first: usize,
        moments: &mut [Matrix],
    ) {
        let Records { particles, place, velocity, .. } = records;
        for (n, moments) in moments.iter_mut().enumerate() {
            let (index, slope) = near.of(n);
            for (&j, &s) in index.iter().zip(slope) {
                let j = j as usize;
                let image = j.checked_sub(*particles).and_then(|n| images.all.get(n));
                let Some(image) = image.filter(|image| image.sticks.contains(&true)) else { continue };
                for across in (0..D).filter(|d| image.sticks[*d]) {
                    let weight = s * place[j][3] * (place[j][across] - place[first + n][across]);
                    for along in (0..D).filter(|d| *d != across) {
                        moments[along][across] -= 2.0 * weight * velocity[j][along];
                    }
                }
            }
        }
    }

    /// Add the pressure of images by weight to the accelerations, and find the forces of mirrors on the liquid, N.
    pub(crate) fn press_on_mirrors(&mut self) {
        let force = self.body_force.as_ref().map_or([0.0; D], |f| f(self.clock.time));
        let viscous = M::Stabilisation::VISCOSITY.then_some(self.viscosity);
        let count = self.mirrors.len();
        let Sph { records, batches, team, acceleration, images, scale, .. } = self;
        let Records { particles, place, velocity, tensor, .. } = &*records;
        team.each_piece(acceleration, BATCH, batches, |b, acceleration, batch| {
            let first = b * BATCH;
            let Batch { near, stabilising, by_mirror, .. } = batch;
            by_mirror.clear();
            by_mirror.resize(count, [0.0; 4]);
            for (n, acceleration) in acceleration.iter_mut().enumerate() {
                let i = first + n;
                let (index, slope) = near.of(n);
                let per = place[i][3] / velocity[i][3];
                let mut extra = [0.0; D];
                for (&j, &s) in index.iter().zip(slope) {
                    let j = j as usize;
                    let Some(image) = j.checked_sub(*particles).and_then(|n| images.all.get(n)) else {
                        continue;
                    };
                    let weight = s * place[j][3] * per;
                    let along: [f64; D] = std::array::from_fn(|d| place[j][d] - place[i][d]);
                    let source = image.source as usize;
                    // Density times radius, as stresses of sums have it.
                    let rho = velocity[source][3] / place[source][3];
                    let more = rho * dot(&force, &image.away(&place[source])) * *scale;
                    let pushed: [f64; D] = std::array::from_fn(|a| -more * along[a] * weight);
                    let mut pair: [f64; D] = std::array::from_fn(|a| {
                        let sum: f64 = (0..D).map(|c| (tensor[j][c][a] + tensor[i][c][a]) * along[c]).sum();
                        sum * weight + pushed[a]
                    });
                    if let Some(viscosity) = viscous {
                        let push = Viscous { records, viscosity }.between(i, j) * weight;
                        (0..D).for_each(|a| pair[a] += push * along[a]);
                    }
                    for a in 0..D {
                        extra[a] += pushed[a];
                        if let Some(force) = image.bearer(a).and_then(|m| by_mirror.get_mut(m)) {
                            force[a] += velocity[i][3] * pair[a];
                            if image.flips[a] < 0.0 {
                                force[3] += velocity[i][3] * pushed[a];
                            }
                        }
                    }
                }
                for a in 0..D {
                    acceleration[a] += extra[a];
                    if let Some(stabilising) = stabilising.get_mut(n) {
                        stabilising[a] += extra[a];
                    }
                }
            }
        });
    }

    /// Set the velocities of mirrors to those of the step that begins, and book their impulses and work over `lag` s of the last step and
    /// `half` s of this one.
    pub(crate) fn kick_mirrors(&mut self, lag: f64, half: f64) {
        let before: Vec<f64> = self.mirrors.iter().map(|mirror| mirror.speed).collect();
        self.set_mirror_speeds();
        for (m, (mirror, before)) in self.mirrors.iter().zip(before).enumerate() {
            let Some(condition) = mirror.condition.filter(|_| mirror.kind.bounds_liquid()) else { continue };
            let mut force = [0.0; 4];
            let forces = self.batches.iter().filter_map(|batch| batch.by_mirror.get(m));
            forces.for_each(|of| (0..4).for_each(|d| force[d] += of[d]));
            let impulse: [f64; 3] = std::array::from_fn(|d| (lag + half) * force[d]);
            let moved = lag * before + half * mirror.speed;
            let work = force[mirror.axis] * moved;
            (0..D).for_each(|d| self.exchange.impulse[d] += impulse[d]);
            self.exchange.work += work;
            // The force by weight is booked by its work on the particles, of which this is that of the wall.
            self.exchange.viscosity += force[3] * moved;
            if let Some(account) = self.boundaries.account(condition) {
                let booking = &mut self.exchange.accounts[account];
                (0..D).for_each(|d| booking.impulse[d] += impulse[d]);
                booking.work += work;
            }
        }
    }
}
