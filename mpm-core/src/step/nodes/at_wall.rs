//! Surfaces of particles at a wall, and what holds them there ([`super::meet_walls`]).

use crate::step::clients::near_particles::{FOUND, NearParticles, SWEEPS};

/// Mass of a body's surface that acts on a node behind a wall, over its own mass, from which the node moves with the one in front of it.
const THIN: f64 = 10.0;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::boundary::{Boundary, Side};

/// A wall at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Plane<const D: usize> {
    pub(in crate::step) axis: usize,
    /// +1 if it pushes up the axis, else -1.
    pub(in crate::step) sign: f64,
    /// Place, m.
    pub(in crate::step) at: f64,
    /// Velocity, m/s; of a smooth wall across it alone.
    pub(in crate::step) velocity: [f64; D],
    pub(in crate::step) friction: f64,
}

impl<const D: usize> Plane<D> {
    pub(in crate::step) fn of(boundary: &Boundary<D>, time: f64) -> Option<Self> {
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
    pub(in crate::step) fn distance(&self, x: &[f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.sign
    }
}

/// What is known of a wall from step to step, and the particles at it in this one.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct AtWall<const D: usize> {
    /// Body and number of the particles whose surfaces press on it, in order.
    pub(in crate::step) pressing: Vec<(u32, usize)>,
    /// Particles whose surfaces may reach it, with weights at their surfaces.
    pub(in crate::step) near: NearParticles<D>,
    pub(in crate::step) surfaces: Vec<Surface>,
    /// Inverse masses that nodes show to surfaces, 1/kg; zero for those that a condition holds along the axis of the wall.
    pub(in crate::step) shown: Vec<f64>,
    /// The particles by their numbers, so that what is found does not depend on where they are kept.
    pub(in crate::step) order: Vec<usize>,
    /// Places of nodes of next to no mass among all of the grid, which move as the wall does.
    pub(in crate::step) light: Vec<u32>,
    /// Nodes behind the wall of so little mass that they move with the one in front, and that one, by place among those of `near`.
    pub(in crate::step) tied: Vec<(u32, u32)>,
}

/// The surface of a particle at a wall.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Surface {
    /// Distance in front of the wall at the start of the step, m.
    pub(in crate::step) gap: f64,
    /// Did it press in the step before?
    pub(in crate::step) pressed: bool,
    /// Does it press in this one?
    pub(in crate::step) presses: bool,
    /// Inverse of the mass that its nodes show there, 1/kg.
    pub(in crate::step) give: f64,
    /// Impulses of the wall's force over the step and of the constraint on velocities, N s, by the masses that nodes show.
    pub(in crate::step) force: f64,
    pub(in crate::step) stop: f64,
    /// How much of these get nodes that move.
    pub(in crate::step) passes: [f64; 2],
}

impl Surface {
    /// The impulse that nodes get that move, N s, of which particles take the second part so much.
    pub(in crate::step) fn given(&self, takes: f64) -> f64 {
        self.passes[0] * self.force + takes * self.passes[1] * self.stop
    }
}

/// Components along an axis of what is said of nodes.
fn along<const D: usize>(weights: &[(u32, [f64; D])], axis: usize, of: &[f64]) -> f64 {
    weights.iter().map(|(node, weight)| weight[axis] * of[*node as usize]).sum()
}

impl<const D: usize> AtWall<D> {
    /// Change velocities of nodes across a wall until surfaces that press move as it does, and others do not go into it within the step.
    pub(in crate::step) fn hold(&mut self, wall: &Plane<D>, velocities: &mut [f64], step: f64) {
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
    pub(in crate::step) fn bear(
        &mut self,
        wall: &Plane<D>,
        velocities: &[f64],
        accelerations: &mut [f64],
        step: f64,
    ) {
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
    pub(in crate::step) fn least_stop(&self) -> f64 {
        FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.stop))
    }

    /// Note which surfaces press, and which came to the wall in this step: they press from the next one on.
    pub(in crate::step) fn note(&mut self) {
        self.pressing.clear();
        let (bodies, numbers) = (self.near.bodies(), self.near.numbers());
        let least = self.least_stop();
        let presses = |surface: &Surface| surface.presses || surface.stop > least;
        let pressing = self.order.iter().filter(|p| presses(&self.surfaces[**p]));
        self.pressing.extend(pressing.map(|&p| (bodies[p], numbers[p])));
    }

    /// Tie nodes behind a wall to those in front of them, one cell of `spacing` on, where the mass that they have is small beside that of the
    /// surfaces which act on them: `masses` are those of the particles. The force of the wall acts at surfaces, half a particle in front of the mass
    /// that a node gets, and would throw a node that particles have just reached. Both are one node from here on, of both masses and momenta,
    /// until [`AtWall::part`].
    pub(in crate::step) fn tie(&mut self, wall: &Plane<D>, masses: &[f64], spacing: f64) {
        self.tied.clear();
        let (axis, near) = (wall.axis, &mut self.near);
        let behind = |x: &[f64; D]| wall.distance(x) < -1e-6 * spacing;
        if !near.nodes.iter().any(|node| behind(&node.position)) {
            return;
        }
        let mut acting = vec![0.0; near.nodes.len()];
        for (p, mass) in masses.iter().enumerate() {
            near.weights(p).iter().for_each(|(node, w)| acting[*node as usize] += w[axis].abs() * mass);
        }
        let thin: Vec<bool> = near
            .nodes
            .iter()
            .zip(&acting)
            .map(|(node, acting)| behind(&node.position) && *acting > THIN * node.mass)
            .collect();
        let fronts = near.fronts(&thin, (axis, wall.sign * spacing));
        near.fold_to(&fronts);
        let tied = fronts.iter().enumerate().filter_map(|(node, front)| Some((node as u32, (*front)?)));
        self.tied.extend(tied);
        for &(node, front) in &self.tied {
            let (thin, front) = (near.nodes[node as usize], &mut near.nodes[front as usize]);
            let mass = front.mass + thin.mass;
            let mean = |a: f64, b: f64| (front.mass * a + thin.mass * b) / mass;
            let velocity: [f64; D] = std::array::from_fn(|d| mean(front.velocity[d], thin.velocity[d]));
            let start = front.start.zip(thin.start).map(|(a, b)| std::array::from_fn(|d| mean(a[d], b[d])));
            (0..D).for_each(|d| front.change[d] += velocity[d] - front.velocity[d]);
            (front.velocity, front.start, front.mass) = (velocity, start.or(front.start), mass);
        }
    }

    /// Have tied nodes move as those in front of them do, which get back their own masses.
    pub(in crate::step) fn part(&mut self) {
        let nodes = &mut self.near.nodes;
        for &(node, front) in &self.tied {
            let velocity = nodes[front as usize].velocity;
            nodes[front as usize].mass -= nodes[node as usize].mass;
            let thin = &mut nodes[node as usize];
            (0..D).for_each(|d| thin.change[d] += velocity[d] - thin.velocity[d]);
            thin.velocity = velocity;
        }
    }

    /// Give tied nodes and those in front of them the mean of their velocities across the wall, by their masses.
    pub(in crate::step) fn join(&self, velocities: &mut [f64]) {
        if self.tied.is_empty() {
            return;
        }
        let nodes = &self.near.nodes;
        let mut masses: Vec<f64> = nodes.iter().map(|node| node.mass).collect();
        for &(node, front) in &self.tied {
            let (node, front) = (node as usize, front as usize);
            let mass = masses[front] + masses[node];
            velocities[front] = (masses[front] * velocities[front] + masses[node] * velocities[node]) / mass;
            masses[front] = mass;
        }
        self.follow(velocities);
    }

    /// Have tied nodes take velocities across the wall of those in front of them.
    pub(in crate::step) fn follow(&self, velocities: &mut [f64]) {
        self.tied.iter().for_each(|(node, front)| velocities[*node as usize] = velocities[*front as usize]);
    }

    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.near.bytes()
            + self.pressing.capacity() * size_of::<(u32, usize)>()
            + self.surfaces.capacity() * size_of::<Surface>()
            + self.shown.capacity() * size_of::<f64>()
            + self.order.capacity() * size_of::<usize>()
            + self.light.capacity() * size_of::<u32>()
            + self.tied.capacity() * size_of::<(u32, u32)>()
    }

    /// What is known from step to step, to a file or from one.
    pub(in crate::step) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.pressing, &(0, 0), |file, (body, number)| {
            let mut word = u64::from(*body);
            file.word(&mut word)?;
            *body = u32::try_from(word).map_err(|_| file.damaged(format!("{word:#x} is no body")))?;
            file.count(number)
        })
    }
}
