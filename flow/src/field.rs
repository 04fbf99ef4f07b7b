//! Body force by place and time.

use std::sync::Arc;

use impactite_scene::{SceneError, StepError, Stopped};

use crate::blocks::Blocks;
use crate::options::ForceField;
use crate::particles::Particle;
use crate::solver::{Flow, add_to};
use crate::transfer::face_centre;

/// Number of particles at which a field is looked at ahead.
const SAMPLED: usize = 64;

/// Places and forces of the particles of a liquid.
pub(crate) type Moved<const D: usize> = Vec<([f64; D], [f64; D])>;

impl<const D: usize> ForceField<D> {
    /// Force at a place, m/s^2.
    fn finite_at(&self, x: [f64; D], time: f64) -> Result<[f64; D], SceneError> {
        let force = (self.of)(x, time);
        match force.iter().find(|f| !f.is_finite()) {
            Some(&value) => Err(SceneError::NotFinite {
                what: format!("body force of the liquid at {x:?} m"),
                value,
                time,
            }),
            None => Ok(force),
        }
    }
}

impl<const D: usize> Flow<D> {
    /// Set a body force of the liquid by place, m, and time, s, m/s^2, in addition to that over time: a central force, the centrifugal force
    /// of a frame that turns. It acts on liquid alone: scenes with bodies that the liquid moves, and the semi-staggered scheme, are refused.
    pub fn set_force_field(&mut self, field: impl Fn([f64; D], f64) -> [f64; D] + Send + Sync + 'static) {
        self.field = Some(ForceField { of: Arc::new(field), strongest: 0.0, load: [0.0; D] });
    }

    /// Check the force field: the first step does the same.
    ///
    /// # Errors
    /// A body that the liquid moves; the semi-staggered scheme; a force at a particle that is not finite.
    pub fn check_force_field(&self) -> Result<(), SceneError> {
        let Some(field) = &self.field else { return Ok(()) };
        let beside = if self.moves_bodies() {
            "a body force by place beside a body that the liquid moves"
        } else if self.options.semi_staggered.is_some() {
            "a body force by place in the semi-staggered scheme"
        } else {
            let values = self.liquids.iter().flat_map(|l| &l.particles);
            return { values }.try_for_each(|p| field.finite_at(p.x, self.clock.time).map(|_| ()));
        };
        Err(SceneError::NotWith {
            what: beside.into(),
            method: impactite_scene::Solver::method(self),
            why: "it acts on liquid alone; take a body force over time for all",
        })
    }

    /// Largest magnitude of the field on the liquid, m/s^2; 0 without one.
    pub(crate) fn strength_of_field(&self) -> f64 {
        let Some(field) = &self.field else { return 0.0 };
        if self.clock.steps > 0 { field.strongest } else { self.strength_at(self.clock.time, 1) }
    }

    /// Largest magnitude of the field at a later time on some of the liquid where it is now, m/s^2; 0 without one.
    pub(crate) fn strength_ahead(&self, time: f64) -> f64 {
        let count = self.liquids.iter().map(|l| l.particles.len()).sum::<usize>();
        self.strength_at(time, count.div_ceil(SAMPLED))
    }

    /// Largest magnitude at every n-th particle; forces that are not finite are refused elsewhere.
    fn strength_at(&self, time: f64, every: usize) -> f64 {
        let Some(field) = &self.field else { return 0.0 };
        let particles = self.liquids.iter().flat_map(|l| &l.particles).step_by(every.max(1));
        particles.map(|p| norm(&(field.of)(p.x, time))).filter(|f| f.is_finite()).fold(0.0, f64::max)
    }

    /// Add the impulse of the field to the velocities at faces, over `kick` seconds.
    pub(crate) fn apply_field(&mut self, kick: f64) {
        let Some(field) = &mut self.field else { return };
        let (grid, frame, time) = (&mut self.grid, &self.frame, self.clock.time);
        let (cells, density) = (Blocks::<D>::CELLS, self.fluid.map_or(0.0, |fluid| fluid.density));
        let mass = density * frame.h.powi(D as i32);
        let mut strongest = 0.0f64;
        let mut load = [0.0; D];
        for d in 0..D {
            let (keys, volume) = (&grid.blocks.keys, &grid.volume[d]);
            let mut found = vec![[0.0f64; 2]; grid.blocks.len()];
            self.team.each_piece(&mut grid.velocity[d], cells, &mut found, |b, velocity, found| {
                for (i, u) in velocity.iter_mut().enumerate() {
                    let at = frame.place(&keys[b], &face_centre::<D>(i, d));
                    let force = (field.of)(at, time);
                    let share = volume[b * cells + i];
                    if share > 0.0 {
                        found[0] += share * force[d];
                        found[1] = found[1].max(norm(&force));
                    }
                    // Faces without liquid have velocities that are extrapolated.
                    *u += if share > 0.0 || force[d].is_finite() { kick * force[d] } else { 0.0 };
                }
            });
            for [sum, most] in found {
                load[d] += mass * kick * sum;
                strongest = strongest.max(most);
            }
        }
        field.strongest = strongest;
        field.load.iter_mut().zip(load).for_each(|(sum, load)| *sum += load);
    }

    /// Places of the particles and forces of the field on them, before they move; empty without a field.
    ///
    /// # Errors
    /// A force that is not finite.
    pub(crate) fn before_motion(&self) -> Result<Vec<Moved<D>>, StepError> {
        let Some(field) = &self.field else { return Ok(Vec::new()) };
        let time = self.clock.time;
        let at = |p: &Particle<D>| field.finite_at(p.x, time).map(|force| (p.x, force));
        let forces = self.liquids.iter().map(|l| l.particles.iter().map(at).collect());
        forces.collect::<Result<_, _>>().map_err(|error| self.clock.stopped(Stopped::Scene(error)))
    }

    /// Book the work of the field over the motion of a step of `dt` seconds, and find its power at the end.
    ///
    /// # Errors
    /// A force that is not finite.
    pub(crate) fn book_field(&mut self, before: &[Moved<D>], dt: f64) -> Result<(), StepError> {
        let Some(field) = &self.field else { return Ok(()) };
        let time = self.clock.time + dt;
        for (liquid, before) in self.liquids.iter_mut().zip(before) {
            let (mut work, mut power) = (0.0, 0.0);
            for (p, (x, start)) in liquid.particles.iter().zip(before) {
                let end = field.finite_at(p.x, time);
                let end = end.map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
                for d in 0..D {
                    work += p.volume * 0.5 * (start[d] + end[d]) * self.frame.way(d, x[d], p.x[d]);
                    power += p.volume * end[d] * p.v[d];
                }
            }
            self.exchange.work += liquid.density * work;
            liquid.power = liquid.density * power;
        }
        Ok(())
    }

    /// Book the impulse of the field in the step, and return it, N s.
    pub(crate) fn book_load_of_field(&mut self) -> [f64; D] {
        let load = self.field.as_mut().map_or([0.0; D], |field| std::mem::replace(&mut field.load, [0.0; D]));
        add_to(&mut self.exchange.load, &load);
        load
    }

    /// Write or read what was found of the field.
    pub(crate) fn strongest_of_field(&mut self) -> Option<&mut f64> {
        self.field.as_mut().map(|field| &mut field.strongest)
    }
}

fn norm<const D: usize>(v: &[f64; D]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
