//! Walls that only push, as the surfaces of bodies meet them.
//!
//! Half its size r along the normal: so far below the surface of a body its outermost particles lie. Where the surface of a
//! particle, at x - r n, reaches a wall of normal n, it presses on it from the step in which it would go into the wall to that in which the
//! nodes' acceleration draws it off. While it presses, the surface moves as the wall does:
//!
//! sum_i N_i(x - r n) v_i . n = v_wall . n,  sum_i N_i(x - r n) a_i . n = 0
//!
//! with the particle's weights N_i at its surface. The constraint on the accelerations a_i is the force of the wall, which only pushes: it
//! balances what matter presses with. That on the velocities v_i says how particles move and deform; particles are not pushed by it: they come to
//! rest by the stress of the matter that is compressed. So a wall at rest does no work, and nothing is lost in the transfer of impulses to
//! particles. (A wall that stops trial velocities step by step does work J . (v- + v+) / 2 on matter that parts at the start of a step and
//! closes at its end, and FLIP keeps it: a bounce gave up to twice the energy. One that pushes particles by the stiffness of half of each loses
//! in the transfer: 16 % of the energy of a flat impact with eight cells.)
//!
//! Friction acts at the surface, too: the impulse along the wall is what brings it to rest on the wall, at most the coefficient of friction times
//! the impulse across.

use super::contact::ContactPhase;
use super::footprint::{Folds, NodeWeight};
use super::mpm::Mpm;
use super::near_particles::{FOUND, NearNode, NearParticles, SWEEPS};
use super::nodes::mass_cutoff;
use crate::parallel::Float;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::boundary::{Boundary, Side};

/// A wall at the start of a step.
#[derive(Clone, Copy, Debug)]
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

/// What is known of a wall from step to step, and the particles at it in this one.
#[derive(Clone, Debug, Default)]
pub(super) struct AtWall<const D: usize> {
    /// Body and number of the particles whose surfaces press on it, in order.
    pressing: Vec<(u32, usize)>,
    /// Particles whose surfaces may reach it, with weights at their surfaces.
    near: NearParticles<D>,
    surfaces: Vec<Surface>,
    /// Inverse masses that nodes show to surfaces, 1/kg; none of those that a condition holds along the axis of the wall.
    shown: Vec<f64>,
    /// The particles by their numbers, so that what is found does not depend on where they are kept.
    order: Vec<usize>,
}

/// Least mass that a node shows to surfaces, over the largest there. Nodes of next to no mass would give way to a surface all alone, at
/// velocities that strain what is beside them.
const LIGHTEST: f64 = 0.1;
/// Gap, over half the size of a particle, up to which a surface that pressed still presses: matter that expands is larger than its particle.
const PARTS: f64 = 0.25;
/// A surface within this many cells of a wall touches it: a gap that was closed within a step is closed to rounding.
const TOUCHES: f64 = 1e-6;

/// The surface of a particle at a wall.
#[derive(Clone, Copy, Debug)]
struct Surface {
    /// Distance in front of the wall at the start of the step, m.
    gap: f64,
    /// Did it press in the step before?
    pressed: bool,
    /// Does it press in this one?
    presses: bool,
    /// Inverse of the mass that its nodes show there, 1/kg.
    give: f64,
    /// Impulses of the wall's force over the step and of the constraint on velocities, N s, by the masses that nodes show.
    force: f64,
    stop: f64,
    /// How much of these get nodes that move.
    passes: [f64; 2],
}

impl Surface {
    /// The impulse that nodes get that move, N s, of which particles take the second part so much.
    fn given(&self, takes: f64) -> f64 {
        self.passes[0] * self.force + takes * self.passes[1] * self.stop
    }
}

/// Components along an axis of what is said of nodes.
fn along<const D: usize>(weights: &[(u32, [f64; D])], axis: usize, of: &[f64]) -> f64 {
    weights.iter().map(|(node, weight)| weight[axis] * of[*node as usize]).sum()
}

impl<const D: usize> AtWall<D> {
    /// Change velocities of nodes across a wall until surfaces that press move as it does, and others do not go into it within the step.
    fn hold(&mut self, wall: &Plane<D>, velocities: &mut [f64], step: f64) {
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
    fn bear(&mut self, wall: &Plane<D>, velocities: &[f64], accelerations: &mut [f64], step: f64) {
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
        self.surfaces.iter_mut().for_each(|surface| surface.presses &= surface.force > 0.0);
    }

    fn note(&mut self) {
        self.pressing.clear();
        let (bodies, numbers) = (self.near.bodies(), self.near.numbers());
        let pressing = self.order.iter().filter(|p| self.surfaces[**p].presses);
        self.pressing.extend(pressing.map(|&p| (bodies[p], numbers[p])));
    }

    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.near.bytes()
            + self.pressing.capacity() * size_of::<(u32, usize)>()
            + self.surfaces.capacity() * size_of::<Surface>()
            + self.shown.capacity() * size_of::<f64>()
            + self.order.capacity() * size_of::<usize>()
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

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Have surfaces meet the walls at the end of the momentum update.
    pub(super) fn meet_walls(&mut self, dt: T) {
        self.at_walls(|this, at, wall| this.meet_wall(at, wall, dt));
    }

    /// Hold the velocities of nodes where surfaces press on walls: `mapped` before forces act (USF), else as they are.
    pub(super) fn hold_at_walls(&mut self, dt: T, mapped: bool) {
        self.at_walls(|this, at, wall| {
            if mapped {
                this.gather_at(at, wall, dt, true);
                at.surfaces.iter_mut().for_each(|s| s.presses = s.pressed);
            }
            this.hold_at(at, wall, dt, false);
            // Particles take this much of what nodes move with.
            at.surfaces.iter_mut().for_each(|surface| surface.force = 0.0);
            this.book_walls(at, wall, this.kernels.taken(dt).to_double());
        });
    }

    /// Hold the velocities that were mapped again where surfaces press on walls (MUSL).
    pub(super) fn hold_remapped_at_walls(&mut self, dt: T) {
        self.at_walls(|this, at, wall| this.hold_at(at, wall, dt, true));
    }

    fn at_walls(&mut self, mut meet: impl FnMut(&mut Self, &mut AtWall<D>, &Plane<D>)) {
        self.have_walls();
        let mut walls = std::mem::take(&mut self.grid.walls);
        let mut at = walls.iter_mut();
        for n in 0..self.scene.conditions.boundaries.len() {
            let wall = Plane::of(&self.scene.conditions.boundaries[n], self.clock.time);
            if let Some((wall, at)) = wall.and_then(|wall| Some((wall, at.next()?))) {
                meet(self, at, &wall);
            }
        }
        self.grid.walls = walls;
    }

    /// Know as many walls as there are.
    pub(super) fn have_walls(&mut self) {
        let count = self.scene.conditions.boundaries.iter().filter(|b| b.is_wall()).count();
        self.grid.walls.resize_with(count, AtWall::default);
    }

    /// Gather the particles whose surfaces may reach a wall in this step.
    fn gather_at(&self, at: &mut AtWall<D>, wall: &Plane<D>, dt: T, mapped: bool) {
        let cutoff = self.scene.lightest() * mass_cutoff::<T>();
        let modified = self.kernels.facts().boundary_modified;
        let folds = Folds::of(&self.scene.conditions.boundaries, self.grid.lattice(), modified);
        let known = !mapped && !self.kernels.facts().maps_together;
        let step = dt.to_double();
        let AtWall { pressing, near, surfaces, shown, order } = at;
        near.clear();
        surfaces.clear();
        let (margin, touches) =
            (0.1 * self.grid.lattice().spacing(), TOUCHES * self.grid.lattice().spacing());
        let reaches =
            |low: &[f64; D], high: &[f64; D]| wall.distance(if wall.sign > 0.0 { low } else { high }) < 0.0;
        let mut shifted = Vec::new();
        for (body, particles) in self.scene.bodies.iter().enumerate() {
            let Some(particles) = particles.meets_surfaces() else { continue };
            let node_at = self.grid.near_node(body as u32, (cutoff, known, dt));
            particles.visit_near(step, &reaches, &mut |particle, weights| {
                let radius = particle.reach[wall.axis];
                let gap = wall.distance(&particle.position) - radius;
                let gap = if gap <= touches { gap.min(0.0) } else { gap };
                let pressed =
                    gap <= PARTS * radius && pressing.binary_search(&(body as u32, particle.number)).is_ok();
                if gap >= margin + step * (-wall.sign * particle.velocity[wall.axis]).max(0.0) && !pressed {
                    return;
                }
                surfaces.push(Surface {
                    gap,
                    pressed,
                    presses: false,
                    give: 0.0,
                    force: 0.0,
                    stop: 0.0,
                    passes: [0.0; 2],
                });
                let lever = -wall.sign * radius;
                shifted.clear();
                shifted.extend(
                    weights
                        .iter()
                        .map(|w| NodeWeight { value: w.value + lever * w.gradient[wall.axis], ..*w }),
                );
                near.add(body as u32, particle, &mut |list| folds.fold(&shifted, list), &node_at);
            });
        }
        let least = LIGHTEST * near.nodes.iter().fold(0.0, |most: f64, node| most.max(node.mass));
        let end = self.clock.time + step;
        let tolerance = 1e-6 * self.grid.lattice().spacing();
        let copies = if self.facts().wide() { 1.5 * self.grid.lattice().spacing() } else { 0.0 };
        let held = |x: &[f64; D]| {
            let mut v = [1.0; 3];
            let others = self.scene.conditions.boundaries.iter().filter(|b| !b.is_wall());
            others.for_each(|b| b.constrain(x, &mut v, end, tolerance, copies));
            v[wall.axis] != 1.0
        };
        shown.clear();
        shown.extend(
            near.nodes.iter().map(|node| if held(&node.position) { 0.0 } else { 1.0 / node.mass.max(least) }),
        );
        for (p, surface) in surfaces.iter_mut().enumerate() {
            for (node, w) in near.weights(p) {
                let (shown, w) = (shown[*node as usize], w[wall.axis]);
                surface.give += w * w * shown;
                surface.passes[0] += if shown > 0.0 { w } else { 0.0 };
                surface.passes[1] += w * near.nodes[*node as usize].mass * shown;
            }
        }
        order.clear();
        order.extend((0..near.len()).filter(|p| surfaces[*p].give > 0.0));
        let (bodies, numbers) = (near.bodies(), near.numbers());
        order.sort_unstable_by_key(|&p| (bodies[p], numbers[p]));
    }

    fn meet_wall(&mut self, at: &mut AtWall<D>, wall: &Plane<D>, dt: T) {
        self.gather_at(at, wall, dt, false);
        if at.order.is_empty() {
            at.pressing.clear();
            return;
        }
        let (axis, step) = (wall.axis, dt.to_double());
        let known = !self.kernels.facts().maps_together;
        let takes = self.kernels.taken(dt).to_double();
        let mut velocities: Vec<f64> = at.near.nodes.iter().map(|node| node.velocity[axis]).collect();
        if known {
            let shows =
                |(node, shown): (&NearNode<D>, &f64)| node.acceleration(axis, step) * node.mass * shown;
            let before: Vec<f64> = at.near.nodes.iter().zip(&at.shown).map(shows).collect();
            let mut accelerations = before.clone();
            at.bear(wall, &velocities, &mut accelerations, step);
            let changes = accelerations.iter().zip(&before).map(|(now, before)| now - before);
            for (((v, node), change), shown) in
                velocities.iter_mut().zip(&mut at.near.nodes).zip(changes).zip(&at.shown)
            {
                *v += if change == 0.0 { 0.0 } else { change * step / (node.mass * shown) };
                node.change[axis] = *v - node.velocity[axis];
                node.velocity[axis] = *v;
            }
        }
        at.hold(wall, &mut velocities, step);
        self.book_walls(at, wall, takes);
        // The work of a body force was booked with the velocities before.
        let gravity = self.scene.conditions.gravity.as_ref().map_or(0.0, |g| g(self.clock.time)[axis]);
        let moved = |s: &Surface| 0.5 * s.passes[0] * s.force + s.passes[1] * s.stop;
        let moved: f64 = at.surfaces.iter().map(moved).sum();
        self.ledger.work += step * gravity * wall.sign * moved;
        if !known {
            at.surfaces.iter_mut().for_each(|surface| surface.presses = surface.stop > 0.0);
        }
        if wall.friction > 0.0 {
            let surfaces = &at.surfaces;
            let limit = |p: usize| wall.friction * surfaces[p].given(takes).max(0.0);
            let (impulses, heat) = at.near.rub(&at.order, limit, axis, &wall.velocity);
            self.ledger.friction += heat;
            for impulse in &impulses {
                for d in 0..D {
                    self.ledger.impulse[d] += impulse[d];
                    self.ledger.work += impulse[d] * wall.velocity[d];
                }
            }
        }
        at.note();
        self.push_nodes(&at.near, dt);
        self.move_nodes(at, axis, &velocities, dt);
    }

    /// Book what a wall gave.
    fn book_walls(&mut self, at: &AtWall<D>, wall: &Plane<D>, takes: f64) {
        let axis = wall.axis;
        for surface in &at.surfaces {
            let impulse = wall.sign * surface.given(takes);
            self.ledger.impulse[axis] += impulse;
            self.ledger.work += impulse * wall.velocity[axis];
        }
    }

    fn hold_at(&mut self, at: &mut AtWall<D>, wall: &Plane<D>, dt: T, remapped: bool) {
        if at.order.is_empty() {
            return;
        }
        let (axis, nodes) = (wall.axis, self.grid.nodes());
        let mut velocities: Vec<f64> = Vec::with_capacity(at.near.nodes.len());
        velocities.extend(at.near.nodes.iter().map(|near| {
            let node = &nodes[near.place as usize];
            if remapped { node.second[axis + 1].to_double() } else { node.first[axis + 1].to_double() }
        }));
        at.hold(wall, &mut velocities, dt.to_double());
        if !remapped {
            self.move_nodes(at, axis, &velocities, dt);
            return;
        }
        let nodes = self.grid.nodes_mut();
        for (near, v) in at.near.nodes.iter().zip(velocities) {
            nodes[near.place as usize].second[axis + 1] = T::of(v);
        }
        let mut stage = self.stage(dt);
        stage.copy_velocities(ContactPhase::Remapped, 0.0);
        stage.extrapolate();
    }

    /// Give nodes these velocities along an axis, m/s, as far as conditions allow that hold them, and not as an increment of what particles have.
    fn move_nodes(&mut self, at: &AtWall<D>, axis: usize, velocities: &[f64], dt: T) {
        let end = self.clock.time + dt.to_double();
        let tolerance = 1e-6 * self.grid.lattice().spacing();
        let copies = if self.facts().wide() { 1.5 * self.grid.lattice().spacing() } else { 0.0 };
        let takes = self.kernels.taken(dt).to_double();
        self.stage(dt).note_velocities();
        for (near, velocity) in at.near.nodes.iter().zip(velocities) {
            let node = &mut self.grid.nodes_mut()[near.place as usize];
            let mut v = [0.0; 3];
            (0..D).for_each(|d| v[d] = node.first[d + 1].to_double());
            v[axis] = *velocity;
            for b in self.scene.conditions.boundaries.iter().filter(|b| !b.is_wall()) {
                b.constrain(&near.position, &mut v, end, tolerance, copies);
            }
            node.first[axis + 1] = T::of(v[axis]);
        }
        let mut stage = self.stage(dt);
        stage.copy_velocities(ContactPhase::Trial, takes);
        stage.extrapolate();
    }
}
