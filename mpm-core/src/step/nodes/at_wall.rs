//! Particle surfaces at a wall, and their contact constraints ([`super::meet_walls`]).

use crate::step::clients::near_particles::{FOUND, NearParticles, SWEEPS};

/// Ratio of surface mass acting on a node behind a wall to nodal mass, above which the node is tied to the one in front.
const THIN: f64 = 10.0;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::boundary::{Boundary, Side};

/// Wall at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Plane<const D: usize> {
    pub(in crate::step) axis: usize,
    /// Direction of the wall force: +1 along the axis, else -1.
    pub(in crate::step) sign: f64,
    /// Position, m.
    pub(in crate::step) at: f64,
    /// Velocity, m/s; only its normal component for a frictionless wall.
    pub(in crate::step) velocity: [f64; D],
    pub(in crate::step) friction: f64,
    /// Account of the wall ([`impactite_scene::BoundaryEntry::with_account`]).
    pub(in crate::step) account: Option<usize>,
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
        Some(Plane { axis, sign, at: at + velocity[axis] * time, velocity, friction, account: None })
    }
    /// Return the distance of a point in front of the wall, m.
    pub(in crate::step) fn distance(&self, x: &[f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.sign
    }
}

/// State of a wall, kept from step to step, and the particles near it in the current step.
#[derive(Clone, Debug, Default)]
pub(in crate::step) struct AtWall<const D: usize> {
    /// Body and number of the particles in active contact, sorted.
    pub(in crate::step) pressing: Vec<(u32, usize)>,
    /// Particles whose surfaces may reach the wall, with weights at their surfaces.
    pub(in crate::step) near: NearParticles<D>,
    pub(in crate::step) surfaces: Vec<Surface>,
    /// Inverse effective masses of the nodes, 1/kg; zero for nodes that a condition constrains along the axis of the wall.
    pub(in crate::step) shown: Vec<f64>,
    /// Particles sorted by number, so that results do not depend on their storage.
    pub(in crate::step) order: Vec<usize>,
    /// Indices of nodes of almost no mass in the grid, which move with the wall.
    pub(in crate::step) light: Vec<u32>,
    /// Light nodes behind the wall, each with the node in front to which it is tied, by index in `near`.
    pub(in crate::step) tied: Vec<(u32, u32)>,
}

/// Surface of a particle at a wall.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Surface {
    /// Gap to the wall at the start of the step, m.
    pub(in crate::step) gap: f64,
    /// True if the contact was active in the previous step.
    pub(in crate::step) pressed: bool,
    /// True if the contact is active in this step.
    pub(in crate::step) presses: bool,
    /// Inverse of the effective mass of its nodes, 1/kg.
    pub(in crate::step) give: f64,
    /// Impulses of the wall force over the step (`force`) and of the velocity constraint (`stop`), N s, with effective
    /// masses.
    pub(in crate::step) force: f64,
    pub(in crate::step) stop: f64,
    /// Fractions of these impulses on unconstrained nodes.
    pub(in crate::step) passes: [f64; 2],
}

impl Surface {
    /// Return the impulse on unconstrained nodes, N s; particles receive the fraction `takes` of that of the velocity
    /// constraint.
    pub(in crate::step) fn given(&self, takes: f64) -> f64 {
        self.passes[0] * self.force + takes * self.passes[1] * self.stop
    }
}

/// Interpolate nodal values `of`, with the components of `weights` along an axis.
fn along<const D: usize>(weights: &[(u32, [f64; D])], axis: usize, of: &[f64]) -> f64 {
    weights.iter().map(|(node, weight)| weight[axis] * of[*node as usize]).sum()
}

impl<const D: usize> AtWall<D> {
    /// Correct normal nodal velocities until active surfaces move with the wall, and others do not penetrate it within the
    /// step.
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

    /// Balance nodal accelerations (forces over effective masses) at active surfaces, and find the active ones.
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
        // Smaller forces are below the solver tolerance.
        let least = FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.force));
        self.surfaces.iter_mut().for_each(|surface| surface.presses &= surface.force > least);
    }

    /// Return the tolerance of the impulses of the velocity constraint, N s.
    pub(in crate::step) fn least_stop(&self) -> f64 {
        FOUND * self.surfaces.iter().fold(0.0, |most: f64, surface| most.max(surface.stop))
    }

    /// Store the active surfaces, and those that reached the wall in this step: they are active from the next step on.
    pub(in crate::step) fn note(&mut self) {
        self.pressing.clear();
        let (bodies, numbers) = (self.near.bodies(), self.near.numbers());
        let least = self.least_stop();
        let presses = |surface: &Surface| surface.presses || surface.stop > least;
        let pressing = self.order.iter().filter(|p| presses(&self.surfaces[**p]));
        self.pressing.extend(pressing.map(|&p| (bodies[p], numbers[p])));
    }

    /// Tie nodes behind a wall to those in front, one cell of `spacing`, m, away, if their mass is small relative to that
    /// of the surfaces acting on them; `masses` are those of the particles. The wall force acts at surfaces, half a
    /// particle in front of the nodal mass, and would strongly accelerate a node that particles have just reached. Both
    /// nodes then act as one, with the sums of masses and momenta, until [`AtWall::part`].
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

    /// Set tied nodes to the velocities of those in front, whose own masses are restored.
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

    /// Set tied nodes and those in front to their mass-weighted mean normal velocity.
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

    /// Copy the normal velocities of the nodes in front to tied nodes.
    pub(in crate::step) fn follow(&self, velocities: &mut [f64]) {
        self.tied.iter().for_each(|(node, front)| velocities[*node as usize] = velocities[*front as usize]);
    }

    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.near.bytes()
            + self.pressing.capacity() * size_of::<(u32, usize)>()
            + self.surfaces.capacity() * size_of::<Surface>()
            + self.shown.capacity() * size_of::<f64>()
            + self.order.capacity() * size_of::<usize>()
            + self.light.capacity() * size_of::<u32>()
            + self.tied.capacity() * size_of::<(u32, u32)>()
    }

    /// Save or restore the state that is kept from step to step.
    pub(in crate::step) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.list(&mut self.pressing, &(0, 0), |file, (body, number)| {
            let mut word = u64::from(*body);
            file.word(&mut word)?;
            *body = u32::try_from(word).map_err(|_| file.damaged(format!("{word:#x} is no body")))?;
            file.count(number)
        })
    }
}
