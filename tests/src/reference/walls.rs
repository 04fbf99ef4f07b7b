//! Walls that only push, as particles meet them: each is a ball, with a layer of its matter between its centre and the wall.

use std::collections::BTreeMap;

use mpm_core::{Boundary, ShapeFunction, Side};

use super::boundaries::constrain;
use super::weights::side;
use super::{Index, Point, Reference, Weight};

/// A wall at the start of a step.
struct Wall<const D: usize> {
    axis: usize,
    /// +1 if it pushes up the axis, else -1.
    sign: f64,
    at: f64,
    /// Of which a smooth one has no part along itself.
    velocity: [f64; D],
    friction: f64,
}

fn wall<const D: usize>(boundary: &Boundary<D>, time: f64) -> Option<Wall<D>> {
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
    Some(Wall { axis, sign, at: at + velocity[axis] * time, velocity, friction })
}

/// The force, N, of a layer of this thickness r, m, as deep as s, m, in a wall: k s / (1 - s / r), up to 2 m / dt^2 times s.
fn force(stiffness: f64, stiffest: f64, depth: f64, thickness: f64) -> f64 {
    let tangent = stiffness / (1.0 - depth / thickness);
    if depth >= thickness || tangent > stiffest { stiffest * depth } else { tangent * depth }
}

/// Sweeps of friction at most, and the change of the impulses, over the largest, at which they count as found.
const SWEEPS: usize = 20;
const FOUND: f64 = 1e-6;

impl<const D: usize, S: ShapeFunction<f64, D>> Reference<D, S> {
    /// Push the nodes of particles that are in walls, and rub on rough ones.
    pub(super) fn meet_walls(&mut self, dt: f64) {
        let planes: Vec<_> = self.boundaries.iter().filter_map(|b| wall(b, self.time)).collect();
        let end = self.time + dt;
        for plane in planes {
            self.meet_wall(&plane, dt);
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

    fn meet_wall(&mut self, wall: &Wall<D>, dt: f64) {
        let (axis, mut rubbed) = (wall.axis, Vec::new());
        for n in 0..self.points.len() {
            let point = &self.points[n];
            let radius = self.half_size(point);
            let depth = radius - wall.sign * (point.x[axis] - wall.at);
            if depth <= 0.0 {
                continue;
            }
            let speed = self.laws[point.body].wave_speed(&point.state);
            let stiffness = 0.5 * 1.3 * point.mass * speed * speed / (radius * radius);
            let impulse = dt * force(stiffness, 2.0 * point.mass / (dt * dt), depth, radius);
            let mut across = [0.0; D];
            across[axis] = wall.sign * impulse;
            self.push(n, 0.0, axis, &across, dt);
            rubbed.push((n, -wall.sign * radius, wall.friction * impulse));
        }
        if wall.friction > 0.0 && !rubbed.is_empty() {
            self.rub(wall, &rubbed, dt);
        }
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

    /// The weights of a particle, those of its images mirrored, at a place `lever` from it along an axis: their slope there is that at the particle.
    fn at(&self, n: usize, lever: f64, axis: usize) -> Vec<(Weight<D>, [f64; D])> {
        let mut list = Vec::new();
        for image in &self.images[n] {
            for w in &image.weights {
                let value = w.value + lever * image.sign[axis] * w.gradient[axis];
                list.push((Weight { value, ..*w }, image.sign));
            }
        }
        list
    }

    /// Give a particle an impulse, N s, at a place `lever` from it along an axis.
    fn push(&mut self, n: usize, lever: f64, axis: usize, impulse: &[f64; D], dt: f64) {
        let light = self.lightest();
        for (w, sign) in self.at(n, lever, axis) {
            let Some(node) = self.nodes.get_mut(&w.node).filter(|node| node.mass > light) else { continue };
            for d in 0..D {
                let change = w.value * sign[d] * impulse[d] / node.mass;
                node.velocity[d] += change;
                node.acceleration[d] += change / dt;
            }
        }
        (0..D).for_each(|d| self.wall_impulse[d] += impulse[d]);
    }

    /// Coulomb friction of particles (each with the lever of its surface, m, and the largest impulse, N s), one after the other by
    /// their numbers, as often as the fast step.
    fn rub(&mut self, wall: &Wall<D>, rubbed: &[(usize, f64, f64)], dt: f64) {
        let light = self.lightest();
        // By node of a surface: its weight, that with those of images, its mass.
        type Row<const D: usize> = BTreeMap<Index<D>, ([f64; D], [f64; D], f64)>;
        let mut rows: Vec<Row<D>> = Vec::new();
        for &(n, lever, _) in rubbed {
            let mut row = Row::new();
            for (w, sign) in self.at(n, lever, wall.axis) {
                let Some(node) = self.nodes.get(&w.node).filter(|node| node.mass > light) else { continue };
                let sum = row.entry(w.node).or_insert(([0.0; D], [0.0; D], node.mass));
                let own = if sign == [1.0; D] { w.value } else { 0.0 };
                for d in 0..D {
                    sum.0[d] += own;
                    sum.1[d] += sign[d] * w.value;
                }
            }
            rows.push(row);
        }
        let slip_of = |this: &Self, row: &Row<D>| {
            let mut slip = wall.velocity.map(|v| -v);
            for (index, (own, _, _)) in row {
                (0..D).for_each(|d| slip[d] += own[d] * this.nodes[index].velocity[d]);
            }
            slip
        };
        let mut impulses = vec![[0.0; D]; rubbed.len()];
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for ((&(n, lever, limit), row), impulse) in rubbed.iter().zip(&rows).zip(&mut impulses) {
                let slip = slip_of(self, row);
                let mut wanted = *impulse;
                for d in (0..D).filter(|d| *d != wall.axis) {
                    let per_mass: f64 = row.values().map(|(own, all, mass)| own[d] * all[d] / mass).sum();
                    wanted[d] -= if per_mass > 0.0 { slip[d] / per_mass } else { 0.0 };
                }
                let size = wanted.iter().map(|j| j * j).sum::<f64>().sqrt();
                let scale = if size > limit { limit / size } else { 1.0 };
                let more: [f64; D] = std::array::from_fn(|d| scale * wanted[d] - impulse[d]);
                self.push(n, lever, wall.axis, &more, dt);
                for d in 0..D {
                    impulse[d] += more[d];
                    changed = changed.max(more[d].abs());
                    largest = largest.max(impulse[d].abs());
                }
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        for (row, impulse) in rows.iter().zip(&impulses) {
            let slip = slip_of(self, row);
            self.heat -= (0..D).map(|d| impulse[d] * slip[d]).sum::<f64>();
        }
    }
}
