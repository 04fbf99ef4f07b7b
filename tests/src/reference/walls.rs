//! Walls that only push, as the surfaces of particles meet them: each is a ball whose radius is half its edge. Surfaces that press move as the
//! wall does, and the force of the wall balances the acceleration of the nodes there.

use std::collections::BTreeMap;

use mpm_core::{Boundary, ShapeFunction, Side};

use super::boundaries::constrain;
use super::weights::side;
use super::{Index, Node, Order, Point, Reference, Rule};

/// A wall at the start of a step.
struct Wall<const D: usize> {
    /// Among the walls.
    number: usize,
    axis: usize,
    /// +1 if it pushes up the axis, else -1.
    sign: f64,
    at: f64,
    /// Of which a smooth one has no part along itself.
    velocity: [f64; D],
    friction: f64,
}

fn wall<const D: usize>(boundary: &Boundary<D>, number: usize, time: f64) -> Option<Wall<D>> {
    let (axis, at, side, velocity, friction) = match *boundary {
        Boundary::Wall { axis, at, side, velocity } => {
            let mut across = [0.0; D];
            across[axis] = velocity;
            (axis, at, side, across, 0.0)
        }
        Boundary::FrictionWall { axis, at, side, velocity, friction } => (axis, at, side, velocity, friction),
        _ => return None,
    };
    let sign = if side == Side::Above { 1.0 } else { -1.0 };
    Some(Wall { number, axis, sign, at: at + velocity[axis] * time, velocity, friction })
}

/// Sweeps at most, and the change of the impulses, over the largest, at which they count as found.
const SWEEPS: usize = 20;
const FOUND: f64 = 1e-6;

/// By node of a surface: its weight, that with those of images by direction, its mass.
type Row<const D: usize> = BTreeMap<Index<D>, (f64, [f64; D], f64)>;

/// The surface of a particle at a wall.
pub(super) struct Touch<const D: usize> {
    point: usize,
    gap: f64,
    presses: bool,
    row: Row<D>,
    /// Impulses of the force of the wall and of the constraint on velocities, N s.
    force: f64,
    stop: f64,
}

impl<const D: usize> Touch<D> {
    /// Inverse of the mass that the nodes show along an axis.
    fn give(&self, axis: usize) -> f64 {
        self.row.values().map(|(own, all, mass)| own * all[axis] / mass).sum()
    }
    /// At the surface, what is said of nodes.
    fn of(&self, value: impl Fn(&Index<D>) -> f64) -> f64 {
        self.row.iter().map(|(index, (own, _, _))| own * value(index)).sum()
    }
}

/// A record of the nodes.
pub(super) type Record<const D: usize> = fn(&mut Node<D>) -> &mut [f64; D];

impl<const D: usize, S: ShapeFunction<f64, D>> Reference<D, S> {
    fn planes(&self) -> Vec<Wall<D>> {
        let walls = self.boundaries.iter().filter(|b| b.is_wall()).enumerate();
        walls.filter_map(|(number, b)| wall(b, number, self.time)).collect()
    }

    /// Have surfaces meet walls at the end of the momentum update.
    pub(super) fn meet_walls(&mut self, dt: f64) {
        let knows_force =
            self.order != Order::Usl || matches!(self.rule, Rule::Flip | Rule::Aflip(_) | Rule::Blend(_));
        let takes = self.takes(dt);
        self.touches.clear();
        for plane in self.planes() {
            let mut touches = self.touching(&plane);
            if knows_force {
                self.bear(&plane, &mut touches, dt);
            }
            self.hold(&plane, &mut touches, |node| &mut node.velocity, dt);
            for touch in &mut touches {
                let impulse = plane.sign * (touch.force + takes * touch.stop);
                self.wall_impulse[plane.axis] += impulse;
                touch.presses = if knows_force { touch.force > 0.0 } else { touch.stop > 0.0 };
            }
            if plane.friction > 0.0 {
                self.rub(&plane, &touches, takes, dt);
            }
            self.pressed.retain(|(wall, _)| *wall != plane.number);
            self.pressed.extend(touches.iter().filter(|t| t.presses).map(|t| (plane.number, t.point)));
            self.touches.push(touches);
            let end = self.time + dt;
            for (index, node) in &mut self.nodes {
                let free = node.velocity;
                constrain(
                    &self.boundaries,
                    &self.lattice,
                    &self.lattice.node(*index),
                    &mut node.velocity,
                    end,
                );
                (0..D).for_each(|d| node.acceleration[d] += (node.velocity[d] - free[d]) / dt);
            }
        }
    }

    /// Hold mapped velocities at surfaces that pressed in the step before (USF).
    pub(super) fn hold_mapped(&mut self, dt: f64) {
        let takes = self.takes(dt);
        for plane in self.planes() {
            let mut touches = self.touching(&plane);
            for touch in &mut touches {
                touch.presses = touch.gap <= 0.0 && self.pressed.contains(&(plane.number, touch.point));
            }
            self.hold(&plane, &mut touches, |node| &mut node.velocity, dt);
            self.wall_impulse[plane.axis] += touches.iter().map(|t| plane.sign * takes * t.stop).sum::<f64>();
        }
    }

    /// Hold a record of velocities at surfaces as [`Self::meet_walls`] found them; are they the particles'?
    pub(super) fn hold_again(&mut self, record: Record<D>, given: bool, dt: f64) {
        let mut all = std::mem::take(&mut self.touches);
        for (plane, touches) in self.planes().into_iter().zip(&mut all) {
            self.hold(&plane, touches, record, dt);
            if given {
                self.wall_impulse[plane.axis] += touches.iter().map(|t| plane.sign * t.stop).sum::<f64>();
            }
        }
        self.touches = all;
    }

    /// How much of the nodes' velocity particles take.
    fn takes(&self, dt: f64) -> f64 {
        match self.rule {
            Rule::Flip => 0.0,
            Rule::Aflip(share) => share,
            Rule::Blend(tau) => (dt / tau).min(1.0),
            Rule::Pic | Rule::Apic | Rule::Mls | Rule::Fmpm(_) => 1.0,
        }
    }

    /// The surfaces within half a cell of a wall.
    fn touching(&self, wall: &Wall<D>) -> Vec<Touch<D>> {
        let (light, mut list) = (self.lightest(), Vec::new());
        for (n, point) in self.points.iter().enumerate() {
            let radius = self.half_size(point);
            let gap = wall.sign * (point.x[wall.axis] - wall.at) - radius;
            if gap > 0.5 * self.lattice.spacing() {
                continue;
            }
            let mut row = Row::new();
            for image in &self.images[n] {
                for w in &image.weights {
                    let Some(node) = self.nodes.get(&w.node).filter(|node| node.mass > light) else {
                        continue;
                    };
                    let lever = -wall.sign * radius * image.sign[wall.axis];
                    let value = w.value + lever * w.gradient[wall.axis];
                    let sum = row.entry(w.node).or_insert((0.0, [0.0; D], node.mass));
                    sum.0 += if image.sign == [1.0; D] { value } else { 0.0 };
                    (0..D).for_each(|d| sum.1[d] += image.sign[d] * value);
                }
            }
            list.push(Touch { point: n, gap, presses: false, row, force: 0.0, stop: 0.0 });
        }
        list.retain(|touch| touch.give(wall.axis) > 0.0);
        list
    }

    /// Half the edge of a cube as large as a particle's domain, m.
    fn half_size(&self, point: &Point<D>) -> f64 {
        let h = self.lattice.spacing();
        let half: [f64; D] = if !S::DOMAIN.convects() {
            point.half
        } else {
            // Half the mean edge along an axis.
            std::array::from_fn(|d| {
                let mut edge = [0.0; D];
                for (c, corner) in point.corners.iter().enumerate() {
                    (0..D).for_each(|e| edge[e] += side(c, d) * corner[e] / f64::from(1 << D));
                }
                edge.iter().map(|x| x * x).sum::<f64>().sqrt()
            })
        };
        h * half.iter().product::<f64>().powf(1.0 / D as f64)
    }

    /// Balance accelerations of nodes where surfaces press: those that did before, and those that go into the wall.
    fn bear(&mut self, wall: &Wall<D>, touches: &mut [Touch<D>], dt: f64) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        let before: BTreeMap<Index<D>, f64> =
            self.nodes.iter().map(|(index, node)| (*index, node.acceleration[axis])).collect();
        for touch in &mut *touches {
            let speed = touch.of(|index| self.nodes[index].velocity[axis]);
            let closes = wall.sign * (speed - drag) < 0.0;
            touch.presses =
                touch.gap <= 0.0 && (closes || self.pressed.contains(&(wall.number, touch.point)));
        }
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for touch in touches.iter_mut().filter(|touch| touch.presses) {
                let excess = wall.sign * dt * touch.of(|index| self.nodes[index].acceleration[axis]);
                let more = (touch.force - excess / touch.give(axis)).max(0.0) - touch.force;
                touch.force += more;
                for (index, (_, all, mass)) in &touch.row {
                    if let Some(node) = self.nodes.get_mut(index) {
                        node.acceleration[axis] += wall.sign * all[axis] * more / (dt * mass);
                    }
                }
                (changed, largest) = (changed.max(more.abs()), largest.max(touch.force.abs()));
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        for touch in touches {
            touch.presses &= touch.force > 0.0;
        }
        for (index, node) in &mut self.nodes {
            node.velocity[axis] += dt * (node.acceleration[axis] - before[index]);
        }
    }

    /// Change velocities of nodes until surfaces that press move as the wall does, and others do not go into it within the step.
    fn hold(&mut self, wall: &Wall<D>, touches: &mut [Touch<D>], record: Record<D>, dt: f64) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        touches.iter_mut().for_each(|touch| touch.stop = 0.0);
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for touch in &mut *touches {
                let mut speed = 0.0;
                for (index, (own, _, _)) in &touch.row {
                    speed += self.nodes.get_mut(index).map_or(0.0, |node| own * record(node)[axis]);
                }
                let excess = wall.sign * (speed - drag) + touch.gap.max(0.0) / dt;
                let wanted = touch.stop - excess / touch.give(axis);
                let more = if touch.presses { wanted } else { wanted.max(0.0) } - touch.stop;
                touch.stop += more;
                for (index, (_, all, mass)) in &touch.row {
                    if let Some(node) = self.nodes.get_mut(index) {
                        record(node)[axis] += wall.sign * all[axis] * more / mass;
                    }
                }
                (changed, largest) = (changed.max(more.abs()), largest.max(touch.stop.abs()));
            }
            if changed <= FOUND * largest {
                break;
            }
        }
    }

    /// Coulomb friction of surfaces, one after the other by the numbers of their particles, as often as the fast step.
    fn rub(&mut self, wall: &Wall<D>, touches: &[Touch<D>], takes: f64, dt: f64) {
        let slip_of = |this: &Self, touch: &Touch<D>, d: usize| {
            touch.of(|index| this.nodes[index].velocity[d]) - wall.velocity[d]
        };
        let along: Vec<usize> = (0..D).filter(|d| *d != wall.axis).collect();
        let mut impulses = vec![[0.0; D]; touches.len()];
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for (touch, impulse) in touches.iter().zip(&mut impulses) {
                let limit = wall.friction * (touch.force + takes * touch.stop).max(0.0);
                let mut wanted = *impulse;
                for &d in &along {
                    let give = touch.give(d);
                    wanted[d] -= if give > 0.0 { slip_of(self, touch, d) / give } else { 0.0 };
                }
                let size = wanted.iter().map(|j| j * j).sum::<f64>().sqrt();
                let scale = if size > limit { limit / size } else { 1.0 };
                for &d in &along {
                    let more = scale * wanted[d] - impulse[d];
                    impulse[d] += more;
                    for (index, (_, all, mass)) in &touch.row {
                        if let Some(node) = self.nodes.get_mut(index) {
                            node.velocity[d] += all[d] * more / mass;
                            node.acceleration[d] += all[d] * more / (mass * dt);
                        }
                    }
                    (changed, largest) = (changed.max(more.abs()), largest.max(impulse[d].abs()));
                }
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        for (touch, impulse) in touches.iter().zip(&impulses) {
            for &d in &along {
                self.wall_impulse[d] += impulse[d];
                self.heat -= impulse[d] * slip_of(self, touch, d);
            }
        }
    }
}
