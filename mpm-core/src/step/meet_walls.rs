//! Walls that only push, as particles meet them.
//!
//! A particle is a ball whose radius r is half its edge: so far below the surface of a body its outermost particles lie. A wall pushes
//! it off by what the layer of matter between its centre and the surface bears that is compressed from r to r - s, s being how deep
//! the surface would be in the wall: rho c^2 A s / r, with the section A = V / 2r. So contact begins when surfaces meet, wherever the nodes of the grid
//! are, a body is as stiff as its matter up to the wall, and what the layer stores it gives back.
//!
//! Friction acts on the surface, at x - r n, which turns as the particle's velocity gradient says: the impulse along the wall is what the
//! surface takes the velocity of the wall from, at most the coefficient of friction times the impulse across.

use super::footprint::{Folds, NodeWeight};
use super::mpm::Mpm;
use super::near_particles::NearParticles;
use super::nodes::mass_cutoff;
use crate::parallel::Float;
use impactite_scene::boundary::{Boundary, Side};

/// Stiffness of the layer between a particle and a wall over that of matter strained in one direction: what bounces of a square and
/// its compression between walls agree best with (book, "Walls").
const LAYER: f64 = 1.3;
/// The largest stiffness times step squared over mass: half of what central differences bear.
const STIFFEST: f64 = 2.0;

/// A wall at the start of a step.
struct Plane<const D: usize> {
    axis: usize,
    /// +1 if it pushes up the axis, else -1.
    sign: f64,
    /// Place, m.
    at: f64,
    /// Velocity, m/s; of a smooth wall across it alone.
    velocity: [f64; D],
    friction: f64,
}

impl<const D: usize> Plane<D> {
    fn of(boundary: &Boundary<D>, time: f64) -> Option<Self> {
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
    fn distance(&self, x: &[f64; D]) -> f64 {
        (x[self.axis] - self.at) * self.sign
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Have walls push particles off.
    pub(super) fn meet_walls(&mut self, dt: T) {
        for n in 0..self.scene.conditions.boundaries.len() {
            if let Some(wall) = Plane::of(&self.scene.conditions.boundaries[n], self.clock.time) {
                self.meet_wall(&wall, dt);
            }
        }
    }

    fn meet_wall(&mut self, wall: &Plane<D>, dt: T) {
        let cutoff = self.scene.lightest() * mass_cutoff::<T>();
        let modified = self.kernels.facts().boundary_modified;
        let folds = Folds::of(&self.scene.conditions.boundaries, self.grid.lattice(), modified);
        let known = !self.kernels.facts().maps_together;
        let step = dt.to_double();
        let mut near = std::mem::take(&mut self.grid.near);
        near.clear();
        let mut layers = Vec::new();
        let margin = 0.1 * self.grid.lattice().spacing();
        let reaches =
            |low: &[f64; D], high: &[f64; D]| wall.distance(if wall.sign > 0.0 { low } else { high }) < 0.0;
        for (body, particles) in self.scene.bodies.iter().enumerate() {
            let Some(particles) = particles.meets_surfaces() else { continue };
            let node_at = self.grid.near_node(body as u32, (cutoff, known, dt));
            particles.visit_near(step, &reaches, &mut |particle, weights| {
                let radius = particle.half_size;
                let depth = radius - wall.distance(&particle.position);
                // Those that come to touch it in this step begin to store energy.
                if depth + margin + step * particle.velocity[wall.axis].abs() <= 0.0 {
                    return;
                }
                let speed = particle.wave_speed / radius;
                layers.push(Layer {
                    depth,
                    thickness: radius,
                    stiffness: 0.5 * LAYER * particle.mass * speed * speed,
                    stiffest: STIFFEST * particle.mass / (step * step),
                });
                near.add(body as u32, particle, &mut |list| folds.fold(weights, list), &node_at);
                if wall.friction > 0.0 {
                    let lever = -wall.sign * radius;
                    near.add(
                        body as u32,
                        particle,
                        &mut |list| {
                            let moved = |w: &NodeWeight<D>| NodeWeight {
                                value: w.value + lever * w.gradient[wall.axis],
                                ..*w
                            };
                            let moved: Vec<_> = weights.iter().map(moved).collect();
                            folds.fold(&moved, list);
                        },
                        &node_at,
                    );
                }
            });
        }
        if layers.iter().any(|layer| layer.depth > 0.0) {
            self.push_off(wall, &mut near, &layers, step);
            self.push_nodes(&near, dt);
        }
        self.grid.near = near;
    }

    /// Give particles the impulses of their layers, and those of friction.
    fn push_off(&mut self, wall: &Plane<D>, near: &mut NearParticles<D>, layers: &[Layer], step: f64) {
        let each = if wall.friction > 0.0 { 2 } else { 1 };
        let gravity = self.scene.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.clock.time));
        let across: Vec<f64> = layers.iter().map(|layer| step * layer.force(layer.depth)).collect();
        let mut impulses = vec![[0.0; D]; each * layers.len()];
        for (n, impulse) in across.iter().enumerate() {
            impulses[each * n][wall.axis] = wall.sign * impulse;
        }
        near.push(&impulses);
        if each == 2 {
            let rubbed =
                near.rub(|p| p % 2 == 1, |p| wall.friction * across[p / 2], wall.axis, &wall.velocity);
            self.ledger.friction += rubbed.1;
            impulses
                .iter_mut()
                .zip(rubbed.0)
                .filter(|(_, along)| *along != [0.0; D])
                .for_each(|(j, along)| *j = along);
        }
        for impulse in &impulses {
            for d in 0..D {
                self.ledger.impulse[d] += impulse[d];
                // The work of a body force was booked with the velocities before.
                self.ledger.work += impulse[d] * (wall.velocity[d] + 0.5 * step * gravity[d]);
            }
        }
        let mut velocities = Vec::new();
        near.velocities(&mut velocities);
        for (n, layer) in layers.iter().enumerate() {
            // What the layer stores is the wall's, until it gives it back.
            let closes = (wall.velocity[wall.axis] - velocities[each * n][wall.axis]) * wall.sign;
            self.ledger.work += layer.energy(layer.depth) - layer.energy(layer.depth + step * closes);
        }
    }
}

/// The matter between a particle and the surface, as a spring.
struct Layer {
    /// How much of it the wall takes at the start of the step, m; negative in front of it.
    depth: f64,
    /// m.
    thickness: f64,
    /// Stiffness at first, N/m, and the largest force over depth, N/m.
    stiffness: f64,
    stiffest: f64,
}

impl Layer {
    /// Depth from which the force is that of the largest stiffness, m.
    fn stiffens(&self) -> f64 {
        (self.thickness * (1.0 - self.stiffness / self.stiffest)).max(0.0)
    }
    /// Force at this depth, N: k s / (1 - s / r), at most the largest stiffness times s.
    fn force(&self, depth: f64) -> f64 {
        let depth = depth.max(0.0);
        if depth < self.stiffens() {
            self.stiffness * depth / (1.0 - depth / self.thickness)
        } else {
            self.stiffest * depth
        }
    }
    /// Energy at this depth, J, the integral of the force.
    fn energy(&self, depth: f64) -> f64 {
        let (depth, bend) = (depth.max(0.0), self.stiffens());
        let part = depth.min(bend) / self.thickness;
        let below = self.stiffness * self.thickness * self.thickness * (-(-part).ln_1p() - part);
        below + 0.5 * self.stiffest * (depth * depth - bend * bend).max(0.0)
    }
}
