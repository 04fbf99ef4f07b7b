//! Surfaces of particles at a wall, and what holds them there ([`super::meet_walls`]).

use super::near_particles::{FOUND, NearParticles, SWEEPS};
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::boundary::{Boundary, Side};

/// A wall at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane<const D: usize> {
    pub(super) axis: usize,
    /// +1 if it pushes up the axis, else -1.
    pub(super) sign: f64,
    /// Place, m.
    pub(super) at: f64,
    /// Velocity, m/s; of a smooth wall across it alone.
    pub(super) velocity: [f64; D],
    pub(super) friction: f64,
}

impl<const D: usize> Plane<D> {
    pub(super) fn of(boundary: &Boundary<D>, time: f64) -> Option<Self> {
        let (axis, at, side, velocity, friction) = match *boundary {
            Boundary::Wall { axis, at, side, velocity } => {
                let mut drag = [0.0; D];
                drag[axis] = velocity;
                (axis, at, side, drag, 0.0)
            }
            Boundary::FrictionWall { axis, at, side, velocity, friction } => {
                (axis, at, side, velocity, friction)
            }
            _ => return None,
        };
        let sign = if side == Side::Above { 1.0 } else { -1.0 };
        Some(Plane { axis, sign, at: at + velocity[axis] * time, velocity, friction })
    }
    /// Distance of a place in front of it, m.
    pub(super) fn distance(&self, x: &[f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.sign
    }
}

/// What is known of a wall from step to step, and the particles at it in this one.
#[derive(Clone, Debug, Default)]
pub(super) struct AtWall<const D: usize> {
    /// Body and number of the particles whose surfaces press on it, in order.
    pub(super) pressing: Vec<(u32, usize)>,
    /// Particles whose surfaces may reach it, with weights at their surfaces.
    pub(super) near: NearParticles<D>,
    pub(super) surfaces: Vec<Surface>,
    /// Inverse masses that nodes show to surfaces, 1/kg; zero for those that a condition holds along the axis of the wall.
    pub(super) shown: Vec<f64>,
    /// The particles by their numbers, so that what is found does not depend on where they are kept.
    pub(super) order: Vec<usize>,
    /// Places of nodes of next to no mass among all of the grid, which move as the wall does.
    pub(super) light: Vec<u32>,
}

/// The surface of a particle at a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Distance in front of the wall at the start of the step, m.
    pub(super) gap: f64,
    /// Did it press in the step before?
    pub(super) pressed: bool,
    /// Does it press in this one?
    pub(super) presses: bool,
    /// Inverse of the mass that its nodes show there, 1/kg.
    pub(super) give: f64,
    /// Impulses of the wall's force over the step and of the constraint on velocities, N s, by the masses that nodes show.
    pub(super) force: f64,
    pub(super) stop: f64,
    /// How much of these get nodes that move.
    pub(super) passes: [f64; 2],
}

impl Surface {
    /// The impulse that nodes get that move, N s, of which particles take the second part so much.
    pub(super) fn given(&self, takes: f64) -> f64 {
        self.passes[0] * self.force + takes * self.passes[1] * self.stop
    }
}

/// Components along an axis of what is said of nodes.
fn along<const D: usize>(weights: &[(u32, [f64; D])], axis: usize, of: &[f64]) -> f64 {
    weights.iter().map(|(node, weight)| weight[axis] * of[*node as usize]).sum()
}

impl<const D: usize> AtWall<D> {
    /// Change velocities of nodes across a wall until surfaces that press move as it does, and others do not go into it within the step.
    pub(super) fn hold(&mut self, wall: &Plane<D>, velocities: &mut [f64], step: f64) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        self.surfaces.iter_mut().for_each(|surface| surface.stop = 0.0);
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for &p in &self.order {
                let (surface, weights) = (&mut self.surfaces[p], self.near.weights(p));
                let gap = if surface.presses { 0.0 } else { surface.gap.max(0.0) };
                let excess = wall.sign * (along(weights, axis, velocities) - drag) + gap / step;
                let wanted = surface.stop - excess / surface.give;
                let wanted = if surface.presses { wanted } else { wanted.max(0.0) };
                let more = wanted - surface.stop;
                surface.stop = wanted;
                (changed, largest) = (changed.max(more.abs()), largest.max(wanted.abs()));
                for (node, weight) in weights.iter().filter(|_| more != 0.0) {
                    let node = *node as usize;
                    velocities[node] += wall.sign * weight[axis] * more * self.shown[node];
                }
            }
            if changed <= FOUND * largest {
                break;
            }
        }
    }

    /// Balance accelerations of nodes (forces over the masses that they show) at surfaces that press, and find which do.
    pub(super) fn bear(&mut self, wall: &Plane<D>, velocities: &[f64], accelerations: &mut [f64], step: f64) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        for (p, surface) in self.surfaces.iter_mut().enumerate() {
            let closing = wall.sign * (along(self.near.weights(p), axis, velocities) - drag) < 0.0;
            surface.presses = surface.pressed || surface.gap <= 0.0 && closing;
        }
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for &p in &self.order {
                let (surface, weights) = (&mut self.surfaces[p], self.near.weights(p));
                if !surface.presses {
                    continue;
                }
                let excess = wall.sign * along(weights, axis, accelerations) * step;
                let wanted = (surface.force - excess / surface.give).max(0.0);
                let more = wanted - surface.force;
                surface.force = wanted;
                (changed, largest) = (changed.max(more.abs()), largest.max(wanted.abs()));
                for (node, weight) in weights.iter().filter(|_| more != 0.0) {
                    let node = *node as usize;
                    accelerations[node] += wall.sign * weight[axis] * more * self.shown[node] / step;
                }
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        // Smaller ones are not found.
        let least = FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.force));
        self.surfaces.iter_mut().for_each(|surface| surface.presses &= surface.force > least);
    }

    /// Smaller impulses of the constraint on velocities are not found, N s.
    pub(super) fn least_stop(&self) -> f64 {
        FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.stop))
    }

    /// Note which surfaces press, and which came to the wall in this step: they press from the next one on.
    pub(super) fn note(&mut self) {
        self.pressing.clear();
        let (bodies, numbers) = (self.near.bodies(), self.near.numbers());
        let least = self.least_stop();
        let presses = |surface: &Surface| surface.presses || surface.stop > least;
        let pressing = self.order.iter().filter(|p| presses(&self.surfaces[**p]));
        self.pressing.extend(pressing.map(|&p| (bodies[p], numbers[p])));
    }

    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.near.bytes()
            + self.pressing.capacity() * size_of::<(u32, usize)>()
            + self.surfaces.capacity() * size_of::<Surface>()
            + self.shown.capacity() * size_of::<f64>()
            + self.order.capacity() * size_of::<usize>()
            + self.light.capacity() * size_of::<u32>()
    }

    /// What is known from step to step, to a file or from one.
    pub(super) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.pressing, &(0, 0), |file, (body, number)| {
            let mut word = u64::from(*body);
            file.word(&mut word)?;
            *body = u32::try_from(word).map_err(|_| file.damaged(format!("{word:#x} is no body")))?;
            file.count(number)
        })
    }
}
