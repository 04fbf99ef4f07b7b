//! Body force by place and time.

use std::sync::Arc;

use impactite_scene::SceneError;

use crate::blocks::Blocks;
use crate::options::ForceField;
use crate::solver::{Flow, add_to};
use crate::transfer::face_centre;

impl<const D: usize> Flow<D> {
    /// Set a body force of the liquid by place, m, and time, s, m/s^2, in addition to that over time: a central force, the centrifugal force
    /// of a frame that turns. It acts on liquid alone: scenes with bodies that the liquid moves, and the semi-staggered scheme, are refused.
    pub fn set_force_field(&mut self, field: impl Fn([f64; D], f64) -> [f64; D] + Send + Sync + 'static) {
        self.field = Some(ForceField { of: Arc::new(field), strongest: 0.0, load: [0.0; D] });
    }

    /// Check that the field acts on liquid alone, and that it is finite at the particles.
    pub(crate) fn check_field(&self) -> Result<(), SceneError> {
        let Some(field) = &self.field else { return Ok(()) };
        let beside = if self.moves_bodies() {
            "a body force by place beside a body that the liquid moves"
        } else if self.options.semi_staggered.is_some() {
            "a body force by place in the semi-staggered scheme"
        } else {
            let time = self.clock.time;
            let values = self.liquids.iter().flat_map(|l| &l.particles).flat_map(|p| (field.of)(p.x, time));
            return match { values }.find(|f| !f.is_finite()) {
                Some(value) => Err(SceneError::NotFinite { what: "body force".into(), value, time }),
                None => Ok(()),
            };
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
        if self.clock.steps > 0 {
            return field.strongest;
        }
        let particles = self.liquids.iter().flat_map(|l| &l.particles);
        // What is not finite is refused by `check_field`.
        let forces = particles.map(|p| norm(&(field.of)(p.x, self.clock.time))).filter(|f| f.is_finite());
        forces.fold(0.0, f64::max)
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
                    *u += kick * force[d];
                    let share = volume[b * cells + i];
                    if share > 0.0 {
                        found[0] += share * force[d];
                        found[1] = found[1].max(norm(&force));
                    }
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
    pub(crate) fn before_motion(&self) -> Vec<Vec<([f64; D], [f64; D])>> {
        let Some(field) = &self.field else { return Vec::new() };
        let time = self.clock.time;
        let of = |l: &crate::particles::Liquid<D>| {
            l.particles.iter().map(|p| (p.x, (field.of)(p.x, time))).collect()
        };
        self.liquids.iter().map(of).collect()
    }

    /// Book the work of the field over the motion of a step of `dt` seconds, and find its power at the end.
    pub(crate) fn book_field(&mut self, before: &[Vec<([f64; D], [f64; D])>], dt: f64) {
        let Some(field) = &self.field else { return };
        let time = self.clock.time + dt;
        for (liquid, before) in self.liquids.iter_mut().zip(before) {
            let (mut work, mut power) = (0.0, 0.0);
            for (p, (x, start)) in liquid.particles.iter().zip(before) {
                let end = (field.of)(p.x, time);
                for d in 0..D {
                    work += p.volume * 0.5 * (start[d] + end[d]) * self.frame.way(d, x[d], p.x[d]);
                    power += p.volume * end[d] * p.v[d];
                }
            }
            self.exchange.work += liquid.density * work;
            liquid.power = liquid.density * power;
        }
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
