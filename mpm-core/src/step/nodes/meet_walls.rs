//! Contact of unilateral walls with the surfaces of bodies.
//!
//! The outermost particles of a body are half a particle size r below its surface, along the normal. The surface of a
//! particle, at x - r n, is in active contact with a wall of normal n from the step in which it would penetrate the wall to
//! that in which the nodal acceleration pulls it off. In active contact the surface moves with the wall:
//!
//! sum_i N_i(x - r n) v_i . n = v_wall . n,  sum_i N_i(x - r n) a_i . n = 0
//!
//! with the particle's weights N_i at its surface. The constraint on the accelerations a_i is the compressive force of the
//! wall, which balances the pressure of the material. The constraint on the velocities v_i determines the motion and
//! deformation of particles, but does not push them: the stress of the compressed material brings them to rest. So a wall
//! at rest does no work, and the transfer of impulses to particles is lossless. (A wall that stops trial velocities step by
//! step does work J . (v- + v+) / 2 on material that separates at the start of a step and closes at its end, and FLIP keeps
//! it: a bounce gained up to twice the energy. A wall that pushes particles with the stiffness of half of each is lossy in
//! the transfer: 16 % of the energy of a flat impact with eight cells.)
//!
//! Friction also acts at the surface: the tangential impulse brings the surface to rest on the wall, but is at most the
//! friction coefficient times the normal impulse.

use super::at_wall::{AtWall, Plane, Surface};
use super::footprint::{Folds, NodeWeight};
use super::stages::mass_cutoff;
use crate::step::clients::near_particles::NearNode;
use crate::step::contact::ContactPhase;
use crate::step::mpm::Mpm;
use impactite_simd::Float;
use std::cell::RefCell;

/// Least effective mass of a node for surfaces, over that of a cell full of the densest material there. Nodes of almost no
/// mass would yield to a surface alone, at velocities that strain the adjacent material.
const LIGHTEST: f64 = 0.1;
/// Mass of nodes that surfaces ignore, over that of the lightest particle: their velocities are rounding errors.
const NO_MASS: f64 = 1e-12;
/// Largest gap, over half the particle size, at which an active contact stays active: expanded material is larger than its
/// particle.
const PARTS: f64 = 0.25;
/// Contact tolerance of the gap, in cells: a gap that was closed within a step is closed to rounding.
const TOUCHES: f64 = 1e-6;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Apply wall contact at the end of the momentum update.
    pub(in crate::step) fn meet_walls(&mut self, dt: T) {
        self.at_walls(|this, at, wall| this.meet_wall(at, wall, dt));
    }

    /// Constrain nodal velocities at surfaces in active wall contact; `mapped` is true for mapped velocities before forces
    /// act (USF).
    pub(in crate::step) fn hold_at_walls(&mut self, dt: T, mapped: bool) {
        self.at_walls(|this, at, wall| {
            if mapped {
                this.gather_at(at, wall, dt, true);
                at.surfaces.iter_mut().for_each(|s| s.presses = s.pressed);
            }
            this.hold_at(at, wall, dt, false);
            // Particles receive the PIC fraction of the velocity constraint.
            at.surfaces.iter_mut().for_each(|surface| surface.force = 0.0);
            this.book_walls(at, wall, this.kernels.taken(dt).to_double());
        });
    }

    /// Constrain the re-mapped velocities at surfaces in active wall contact (MUSL).
    pub(in crate::step) fn hold_remapped_at_walls(&mut self, dt: T) {
        self.at_walls(|this, at, wall| this.hold_at(at, wall, dt, true));
    }

    fn at_walls(&mut self, mut meet: impl FnMut(&mut Self, &mut AtWall<D>, &Plane<D>)) {
        self.have_walls();
        let mut walls = std::mem::take(&mut self.grid.walls);
        let mut at = walls.iter_mut();
        for n in 0..self.scene.conditions.boundaries.len() {
            let account = self.scene.conditions.boundaries.account(n);
            let wall = Plane::of(&self.scene.conditions.boundaries[n], self.clock.time);
            let wall = wall.map(|wall| Plane { account, ..wall });
            if let Some((wall, at)) = wall.and_then(|wall| Some((wall, at.next()?))) {
                meet(self, at, &wall);
            }
        }
        self.grid.walls = walls;
    }

    /// Allocate the contact state of every wall.
    pub(in crate::step) fn have_walls(&mut self) {
        let count = self.scene.conditions.boundaries.iter().filter(|b| b.is_wall()).count();
        self.grid.walls.resize_with(count, AtWall::default);
    }

    /// Gather the particles whose surfaces may reach a wall in this step.
    fn gather_at(&self, at: &mut AtWall<D>, wall: &Plane<D>, dt: T, mapped: bool) {
        let (cutoff, no_mass) = (
            self.scene.lightest() * mass_cutoff::<T>(),
            (self.scene.lightest() * T::of(NO_MASS)).to_double(),
        );
        let modified = self.kernels.facts().boundary_modified;
        let folds = Folds::of(&self.scene.conditions.boundaries, &self.grid.fields, modified);
        let known = !mapped && !self.kernels.facts().maps_together;
        let step = dt.to_double();
        let AtWall { pressing, near, surfaces, light, .. } = at;
        near.clear();
        surfaces.clear();
        let rounding = RefCell::new(std::mem::take(light));
        rounding.borrow_mut().clear();
        let spacing = self.grid.lattice().spacing();
        let lattices = self.grid.fields.lattices();
        let (margin, touches) = (0.1 * spacing, TOUCHES * spacing);
        let reaches =
            |low: &[f64; D], high: &[f64; D]| wall.distance(if wall.sign > 0.0 { low } else { high }) < 0.0;
        let (mut shifted, mut full, mut masses) = (Vec::new(), 0.0f64, Vec::new());
        for (body, particles) in self.scene.bodies.iter().enumerate() {
            let Some(particles) = particles.meets_surfaces() else { continue };
            let with_mass = self.grid.near_node(body as u32, (cutoff, known, dt));
            let node_at = |at: &[i32; D]| {
                let node = with_mass(at)?;
                if node.mass > no_mass {
                    return Some(node);
                }
                rounding.borrow_mut().push(node.place);
                None
            };
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
                masses.push(particle.mass);
                let cell = weights.first().map_or(spacing, |w| lattices.of_node(&w.node).0.spacing());
                full = full.max(particle.mass * (0.5 * cell / particle.half_size).powi(D as i32));
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
        *light = rounding.into_inner();
        at.tied.clear();
        if known {
            at.tie(wall, &masses, spacing);
        }
        let AtWall { near, surfaces, shown, order, .. } = at;
        let end = self.clock.time + step;
        let tolerance = 1e-6 * spacing;
        let copies = if self.facts().wide() { 1.5 * spacing } else { 0.0 };
        let held = |x: &[f64; D]| {
            let mut v = [1.0; 3];
            let others = self.scene.conditions.boundaries.iter().filter(|b| !b.is_wall());
            others.for_each(|b| b.constrain(x, &mut v, end, tolerance, copies));
            v[wall.axis] != 1.0
        };
        shown.clear();
        // With forces mapped together with momentum, the wall force changes velocities, too; nodes then share it by weights
        // alone.
        let least = if self.kernels.facts().maps_together { 0.0 } else { LIGHTEST };
        shown.extend(
            near.nodes
                .iter()
                .map(|node| if held(&node.position) { 0.0 } else { 1.0 / node.mass.max(least * full) }),
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
                node.change[axis] += *v - node.velocity[axis];
                node.velocity[axis] = *v;
            }
        }
        at.hold(wall, &mut velocities, step);
        self.book_walls(at, wall, takes);
        // Body force work was recorded with the mean of the velocities at the start and at the end. If momentum and impulse
        // are mapped together, the start velocity is that of both, and stays.
        let held = if known { 1.0 } else { 0.5 };
        let gravity = self.scene.conditions.gravity.as_ref().map_or(0.0, |g| g(self.clock.time)[axis]);
        let moved = |s: &Surface| 0.5 * s.passes[0] * s.force + held * s.passes[1] * s.stop;
        let moved: f64 = at.surfaces.iter().map(moved).sum();
        self.ledger.work += step * gravity * wall.sign * moved;
        if !known {
            let least = at.least_stop();
            at.surfaces.iter_mut().for_each(|surface| surface.presses = surface.stop > least);
        }
        if wall.friction > 0.0 {
            let surfaces = &at.surfaces;
            let limit = |p: usize| wall.friction * surfaces[p].given(takes).max(0.0);
            let (impulses, heat) = at.near.rub(&at.order, limit, axis, &wall.velocity);
            self.ledger.friction += heat;
            for impulse in &impulses {
                for d in 0..D {
                    self.book_wall(wall, d, impulse[d]);
                }
            }
        }
        at.note();
        at.part();
        at.follow(&mut velocities);
        self.push_nodes(&at.near, dt);
        self.move_nodes(at, wall, &velocities, dt);
    }

    /// Record the impulse and work of a wall.
    fn book_walls(&mut self, at: &AtWall<D>, wall: &Plane<D>, takes: f64) {
        let axis = wall.axis;
        for surface in &at.surfaces {
            self.book_wall(wall, axis, wall.sign * surface.given(takes));
        }
    }

    /// Record an impulse, N s, of a wall along an axis.
    fn book_wall(&mut self, wall: &Plane<D>, axis: usize, impulse: f64) {
        let work = impulse * wall.velocity[axis];
        self.ledger.impulse[axis] += impulse;
        self.ledger.work += work;
        if let Some(account) = wall.account {
            self.ledger.accounts[account].impulse[axis] += impulse;
            self.ledger.accounts[account].work += work;
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
        at.join(&mut velocities);
        at.hold(wall, &mut velocities, dt.to_double());
        at.follow(&mut velocities);
        if !remapped {
            self.move_nodes(at, wall, &velocities, dt);
            return;
        }
        let nodes = self.grid.nodes_mut();
        for (near, v) in at.near.nodes.iter().zip(velocities) {
            nodes[near.place as usize].second[axis + 1] = T::of(v);
        }
        for &place in &at.light {
            nodes[place as usize].second[axis + 1] = T::of(wall.velocity[axis]);
        }
        let mut stage = self.stage(dt);
        stage.copy_velocities(ContactPhase::Remapped, 0.0);
        stage.extrapolate();
    }

    /// Set the normal velocities of nodes at a wall, m/s, subject to constraints, and not as an increment of particle
    /// velocities.
    fn move_nodes(&mut self, at: &AtWall<D>, wall: &Plane<D>, velocities: &[f64], dt: T) {
        let (axis, end) = (wall.axis, self.clock.time + dt.to_double());
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
        for &place in &at.light {
            self.grid.nodes_mut()[place as usize].first[axis + 1] = T::of(wall.velocity[axis]);
        }
        let mut stage = self.stage(dt);
        stage.copy_velocities(ContactPhase::Trial, takes);
        stage.extrapolate();
    }
}
