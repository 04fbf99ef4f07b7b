//! Unilateral walls in contact with particle surfaces: half a domain from their positions. Surfaces in contact move with the wall,
//! and the wall force balances the acceleration of their nodes.

use std::collections::{BTreeMap, BTreeSet};

use mpm_core::{Boundary, ShapeFunction, Side};

use super::boundaries::{constrain, held};
use super::weights::side;
use super::{Index, Node, Order, Point, Reference, Rule};

/// Wall at the start of a step.
struct Wall<const D: usize> {
    /// Index among the walls.
    number: usize,
    axis: usize,
    /// Sign of the wall normal along the axis: +1 or -1.
    sign: f64,
    at: f64,
    /// Velocity of the wall; a smooth wall has no tangential component.
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

/// Maximum number of sweeps, and convergence tolerance: change of the impulses over the largest impulse.
const SWEEPS: usize = 20;
const FOUND: f64 = 1e-6;

/// Nodes of a surface: weight, weight including images per direction, mass, and inverse of the effective mass normal to the wall.
type Row<const D: usize> = BTreeMap<Index<D>, (f64, [f64; D], f64, f64)>;

/// Particle surface at a wall.
pub(super) struct Touch<const D: usize> {
    point: usize,
    gap: f64,
    pressed: bool,
    presses: bool,
    row: Row<D>,
    /// Impulses of the wall force and of the velocity constraint, N s.
    force: f64,
    stop: f64,
}

impl<const D: usize> Touch<D> {
    /// Inverse effective mass of the surface along an axis, from the nodal masses.
    fn give(&self, axis: usize) -> f64 {
        self.row.values().map(|(own, all, mass, _)| own * all[axis] / mass).sum()
    }
    /// Inverse effective mass of the surface normal to the wall, from the effective nodal masses.
    fn shown(&self, axis: usize) -> f64 {
        self.row.values().map(|(own, all, _, shown)| own * all[axis] * shown).sum()
    }
    /// Impulse on moving nodes, N s; the part of the velocity constraint counts with the PIC fraction `takes`.
    fn given(&self, takes: f64) -> f64 {
        let of = |(own, _, mass, shown): &(f64, [f64; D], f64, f64)| {
            let passes = if *shown > 0.0 { self.force } else { 0.0 };
            own * (passes + takes * self.stop * mass * shown)
        };
        self.row.values().map(of).sum()
    }
    /// Interpolate nodal values at the surface.
    fn of(&self, value: impl Fn(&Index<D>) -> f64) -> f64 {
        self.row.iter().map(|(index, (own, ..))| own * value(index)).sum()
    }
}

/// Particle surfaces at a wall, nodes of negligible mass there, and pairs of a node behind the wall and the node in
/// front that it moves with.
pub(super) type AtWall<const D: usize> = (Vec<Touch<D>>, BTreeSet<Index<D>>, Vec<[Index<D>; 2]>);

/// Accessor of a nodal velocity.
pub(super) type Record<const D: usize> = fn(&mut Node<D>) -> &mut [f64; D];

impl<const D: usize, S: ShapeFunction<f64, D>> Reference<D, S> {
    fn planes(&self) -> Vec<Wall<D>> {
        let walls = self.boundaries.iter().filter(|b| b.is_wall()).enumerate();
        walls.filter_map(|(number, b)| wall(b, number, self.time)).collect()
    }

    /// Apply wall contact at the end of the momentum update.
    pub(super) fn meet_walls(&mut self, dt: f64) {
        let knows_force = self.knows_force();
        let takes = self.takes(dt);
        self.touches.clear();
        for plane in self.planes() {
            let (mut touches, light, ties) = self.touching(&plane, dt, knows_force);
            let starts = self.tie(&ties, dt);
            if knows_force {
                self.bear(&plane, &mut touches, dt);
            }
            self.hold(&plane, &mut touches, &light, |node| &mut node.velocity, dt);
            let least = FOUND * touches.iter().fold(0.0f64, |most, touch| most.max(touch.stop));
            for touch in &mut touches {
                let impulse = plane.sign * touch.given(takes);
                self.wall_impulse[plane.axis] += impulse;
                touch.pressed = knows_force && touch.presses || touch.stop > least;
                touch.presses = if knows_force { touch.presses } else { touch.pressed };
            }
            if plane.friction > 0.0 {
                self.rub(&plane, &touches, takes, dt);
            }
            self.pressed.retain(|(wall, _)| *wall != plane.number);
            self.pressed.extend(touches.iter().filter(|t| t.pressed).map(|t| (plane.number, t.point)));
            self.part(&ties, &starts, dt);
            self.touches.push((touches, light, ties));
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

    /// Apply wall contact to mapped velocities at surfaces in contact in the step before (USF).
    pub(super) fn hold_mapped(&mut self, dt: f64) {
        let takes = self.takes(dt);
        for plane in self.planes() {
            let (mut touches, light, _) = self.touching(&plane, dt, false);
            for touch in &mut touches {
                touch.presses = touch.pressed;
            }
            self.hold(&plane, &mut touches, &light, |node| &mut node.velocity, dt);
            self.wall_impulse[plane.axis] += touches.iter().map(|t| plane.sign * t.given(takes)).sum::<f64>();
        }
    }

    /// Apply wall contact again to a nodal velocity at the surfaces found by [`Self::meet_walls`]; `given` if
    /// particles use this velocity.
    pub(super) fn hold_again(&mut self, record: Record<D>, given: bool, dt: f64) {
        let mut all = std::mem::take(&mut self.touches);
        for (plane, (touches, light, ties)) in self.planes().into_iter().zip(&mut all) {
            let mut masses: BTreeMap<Index<D>, f64> = BTreeMap::new();
            for tie in ties.iter().filter(|_| !touches.is_empty()) {
                let (thin, mut front) = (self.nodes[&tie[0]].clone(), self.nodes[&tie[1]].clone());
                let held = masses.entry(tie[1]).or_insert(front.mass);
                let (a, b) = (record(&mut front)[plane.axis], record(&mut thin.clone())[plane.axis]);
                let mean = (*held * a + thin.mass * b) / (*held + thin.mass);
                *held += thin.mass;
                if let Some(front) = self.nodes.get_mut(&tie[1]) {
                    record(front)[plane.axis] = mean;
                }
            }
            self.hold(&plane, touches, light, record, dt);
            for tie in ties.iter().filter(|_| !touches.is_empty()) {
                let velocity = record(&mut self.nodes[&tie[1]].clone())[plane.axis];
                if let Some(thin) = self.nodes.get_mut(&tie[0]) {
                    record(thin)[plane.axis] = velocity;
                }
            }
            if given {
                touches.iter_mut().for_each(|touch| touch.force = 0.0);
                self.wall_impulse[plane.axis] +=
                    touches.iter().map(|t| plane.sign * t.given(1.0)).sum::<f64>();
            }
        }
        self.touches = all;
    }

    /// Return true if forces are known separately from momentum.
    fn knows_force(&self) -> bool {
        self.order != Order::Usl || matches!(self.rule, Rule::Flip | Rule::Aflip(_) | Rule::Blend(_))
    }

    /// PIC fraction of the transfer in a step of size `dt`.
    fn takes(&self, dt: f64) -> f64 {
        match self.rule {
            Rule::Flip => 0.0,
            Rule::Aflip(share) => share,
            Rule::Blend(tau) => (dt / tau).min(1.0),
            Rule::Pic | Rule::Apic | Rule::Mls | Rule::Fmpm(_) => 1.0,
        }
    }

    /// Return the particle surfaces that may touch a wall in a step, and nearby nodes of negligible mass.
    fn touching(&self, wall: &Wall<D>, dt: f64, ties: bool) -> AtWall<D> {
        // Nodes of negligible mass have velocities of rounding error only.
        let light = 1e-12 * self.points.iter().map(|p| p.mass).fold(f64::INFINITY, f64::min);
        let (mut list, mut lights) = (Vec::new(), BTreeSet::new());
        for (n, point) in self.points.iter().enumerate() {
            let radius = self.reach(point, wall.axis);
            let (gap, h) = (wall.sign * (point.x[wall.axis] - wall.at) - radius, self.lattice.spacing());
            // Surfaces that may touch the wall in this step, within rounding.
            let pressed = self.has_pressed(wall, n, gap, radius);
            if gap >= 0.1 * h + dt * (-wall.sign * point.v[wall.axis]).max(0.0) && !pressed {
                continue;
            }
            let gap = if gap <= 1e-6 * h { gap.min(0.0) } else { gap };
            let mut row = Row::new();
            for image in &self.images[n] {
                for w in &image.weights {
                    let Some(node) = self.nodes.get(&w.node) else { continue };
                    if node.mass <= light {
                        lights.insert(w.node);
                        continue;
                    }
                    let lever = -wall.sign * radius * image.sign[wall.axis];
                    let value = w.value + lever * w.gradient[wall.axis];
                    let sum = row.entry(w.node).or_insert((0.0, [0.0; D], node.mass, 0.0));
                    sum.0 += if image.sign == [1.0; D] { value } else { 0.0 };
                    (0..D).for_each(|d| sum.1[d] += image.sign[d] * value);
                }
            }
            list.push(Touch { point: n, gap, pressed, presses: false, row, force: 0.0, stop: 0.0 });
        }
        let ties = if ties { self.ties(wall, &mut list) } else { Vec::new() };
        // Nodes with a prescribed velocity do not move. The effective mass has a lower limit only if forces are known separately from
        // momentum.
        let least = if self.knows_force() { 0.1 } else { 0.0 };
        // Mass of a cell full of the densest material.
        let full = |touch: &Touch<D>| {
            let point = &self.points[touch.point];
            point.mass
                * self
                    .half_edges(point)
                    .map(|edge| 0.5 * self.lattice.spacing() / edge)
                    .iter()
                    .product::<f64>()
        };
        let full = list.iter().fold(0.0f64, |most, touch| most.max(full(touch)));
        for touch in &mut list {
            for (index, at) in &mut touch.row {
                let x = self.lattice.node(*index);
                let free = !held(&self.boundaries, &self.lattice, &x, wall.axis, self.time + dt);
                // On a symmetry plane, the node includes the mass of images.
                let on = |b: &&Boundary<D>| {
                    let h = self.lattice.spacing();
                    matches!(**b, Boundary::Symmetry { axis, at, .. } if (x[axis] - at).abs() <= 1e-6 * h)
                };
                let images = 2f64.powi(self.boundaries.iter().filter(on).count() as i32);
                at.3 = if free { 1.0 / at.2.max(least * full * images) } else { 0.0 };
            }
        }
        list.retain(|touch| touch.shown(wall.axis) > 0.0);
        let ties = if list.is_empty() { Vec::new() } else { ties };
        (list, lights, ties)
    }

    /// Pair nodes behind a wall, on which surfaces of more than ten times their mass act, with the nodes in front, if all surfaces agree on
    /// the same front node. The rows of front nodes then include weights and masses of both.
    fn ties(&self, wall: &Wall<D>, list: &mut [Touch<D>]) -> Vec<[Index<D>; 2]> {
        let (axis, h) = (wall.axis, self.lattice.spacing());
        let mut acting: BTreeMap<Index<D>, f64> = BTreeMap::new();
        for touch in &*list {
            let mass = self.points[touch.point].mass;
            for (index, (_, all, ..)) in &touch.row {
                *acting.entry(*index).or_insert(0.0) += all[axis].abs() * mass;
            }
        }
        acting.retain(|index, acting| {
            let behind = wall.sign * (self.lattice.node(*index)[axis] - wall.at) < -1e-6 * h;
            behind && *acting > 10.0 * self.nodes[index].mass
        });
        let mut fronts: BTreeMap<Index<D>, Option<Index<D>>> = BTreeMap::new();
        for touch in &*list {
            let there = || touch.row.iter().filter(|(_, (own, all, ..))| *own != 0.0 || *all != [0.0; D]);
            for (index, _) in there().filter(|(index, _)| acting.contains_key(*index)) {
                let cells = |other: &Index<D>| {
                    let beside = (0..D).all(|d| d == axis || other[d] == index[d]);
                    let cells = wall.sign * (other[axis] - index[axis]) as f64;
                    (beside && cells > 0.0 && !acting.contains_key(other)).then_some((cells, *other))
                };
                let front = there()
                    .filter_map(|(other, _)| cells(other))
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .map(|(_, other)| other);
                let known = fronts.entry(*index).or_insert(front);
                *known = if *known == front { front } else { None };
            }
        }
        let ties: Vec<[Index<D>; 2]> =
            fronts.into_iter().filter_map(|(thin, front)| Some([thin, front?])).collect();
        for [thin, front] in &ties {
            for touch in &mut *list {
                let given = touch.row.remove(thin).unwrap_or((0.0, [0.0; D], 0.0, 0.0));
                if let Some(at) = touch.row.get_mut(front) {
                    at.0 += given.0;
                    (0..D).for_each(|d| at.1[d] += given.1[d]);
                    at.2 += self.nodes[thin].mass;
                }
            }
        }
        ties
    }

    /// Set front nodes to the mass-weighted mean velocities and accelerations of both nodes. Returns the velocities of both nodes of each
    /// tie at the start of the step, and their mean.
    fn tie(&mut self, ties: &[[Index<D>; 2]], dt: f64) -> BTreeMap<Index<D>, [[f64; D]; 2]> {
        let mut starts: BTreeMap<Index<D>, [[f64; D]; 2]> = BTreeMap::new();
        let mut masses: BTreeMap<Index<D>, f64> = BTreeMap::new();
        for [thin, front] in ties {
            let of = |node: &Node<D>| std::array::from_fn(|d| node.velocity[d] - dt * node.acceleration[d]);
            for index in [thin, front] {
                let start = of(&self.nodes[index]);
                starts.entry(*index).or_insert([start, start]);
            }
            let other = self.nodes[thin].clone();
            let Some(node) = self.nodes.get_mut(front) else { continue };
            let mass = masses.entry(*front).or_insert(node.mass);
            let share = other.mass / (*mass + other.mass);
            *mass += other.mass;
            for d in 0..D {
                node.velocity[d] += share * (other.velocity[d] - node.velocity[d]);
                node.acceleration[d] += share * (other.acceleration[d] - node.acceleration[d]);
            }
            let mean = of(node);
            if let Some(known) = starts.get_mut(front) {
                known[1] = mean;
            }
        }
        starts
    }

    /// Set the velocity of the node behind the wall to that of the front node, with accelerations from the start
    /// velocity of each.
    fn part(&mut self, ties: &[[Index<D>; 2]], starts: &BTreeMap<Index<D>, [[f64; D]; 2]>, dt: f64) {
        let fronts: BTreeSet<Index<D>> = ties.iter().map(|tie| tie[1]).collect();
        for front in &fronts {
            let [own, mean] = starts[front];
            if let Some(node) = self.nodes.get_mut(front) {
                (0..D).for_each(|d| node.acceleration[d] += (mean[d] - own[d]) / dt);
            }
        }
        for [thin, front] in ties {
            let ahead = self.nodes[front].clone();
            let (own, of_front) = (starts[thin][0], starts[front][0]);
            if let Some(node) = self.nodes.get_mut(thin) {
                node.velocity = ahead.velocity;
                for d in 0..D {
                    let moved = of_front[d] + dt * ahead.acceleration[d];
                    node.acceleration[d] = (moved - own[d]) / dt;
                }
            }
        }
    }

    /// Return true if the particle surface was in contact in the step before and is still near.
    fn has_pressed(&self, wall: &Wall<D>, point: usize, gap: f64, radius: f64) -> bool {
        gap <= 0.25 * radius && self.pressed.contains(&(wall.number, point))
    }

    /// Half edge vectors of a particle's domain, in cells.
    fn edges(&self, point: &Point<D>) -> [[f64; D]; D] {
        std::array::from_fn(|d| {
            std::array::from_fn(|axis| {
                if !S::DOMAIN.convects() {
                    return if d == axis { point.half[axis] } else { 0.0 };
                }
                let of = |(c, corner): (usize, &[f64; D])| side(c, d) * corner[axis] / f64::from(1 << D);
                point.corners.iter().enumerate().map(of).sum()
            })
        })
    }

    /// Half edge lengths of a particle's domain, m.
    fn half_edges(&self, point: &Point<D>) -> [f64; D] {
        self.edges(point).map(|edge| self.lattice.spacing() * edge.iter().map(|x| x * x).sum::<f64>().sqrt())
    }

    /// Half extent of a particle's domain along an axis, m.
    fn reach(&self, point: &Point<D>, axis: usize) -> f64 {
        self.lattice.spacing() * self.edges(point).iter().map(|edge| edge[axis].abs()).sum::<f64>()
    }

    /// Balance nodal accelerations at surfaces in contact: those in contact in the step before, and those that
    /// penetrate.
    fn bear(&mut self, wall: &Wall<D>, touches: &mut [Touch<D>], dt: f64) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        let before: BTreeMap<Index<D>, f64> =
            self.nodes.iter().map(|(index, node)| (*index, node.acceleration[axis])).collect();
        for touch in &mut *touches {
            let speed = touch.of(|index| self.nodes[index].velocity[axis]);
            let closes = wall.sign * (speed - drag) < 0.0;
            touch.presses = touch.gap <= 0.0 && closes || touch.pressed;
        }
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for touch in touches.iter_mut().filter(|touch| touch.presses) {
                let mut excess = 0.0;
                for (index, (own, _, mass, shown)) in &touch.row {
                    excess += wall.sign * dt * own * self.nodes[index].acceleration[axis] * mass * shown;
                }
                let more = (touch.force - excess / touch.shown(axis)).max(0.0) - touch.force;
                touch.force += more;
                for (index, (_, all, mass, shown)) in &touch.row {
                    if let Some(node) = self.nodes.get_mut(index).filter(|_| *shown > 0.0) {
                        node.acceleration[axis] += wall.sign * all[axis] * more / (dt * mass);
                    }
                }
                (changed, largest) = (changed.max(more.abs()), largest.max(touch.force.abs()));
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        let least = FOUND * touches.iter().fold(0.0f64, |most, touch| most.max(touch.force));
        for touch in touches {
            touch.presses &= touch.force > least;
        }
        for (index, node) in &mut self.nodes {
            node.velocity[axis] += dt * (node.acceleration[axis] - before[index]);
        }
    }

    /// Correct nodal velocities until surfaces in contact move with the wall and the others do not penetrate within the step.
    /// Nodes of negligible mass there move with the wall, too.
    fn hold(
        &mut self,
        wall: &Wall<D>,
        touches: &mut [Touch<D>],
        light: &BTreeSet<Index<D>>,
        record: Record<D>,
        dt: f64,
    ) {
        let (axis, drag) = (wall.axis, wall.velocity[wall.axis]);
        touches.iter_mut().for_each(|touch| touch.stop = 0.0);
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for touch in &mut *touches {
                let mut speed = 0.0;
                for (index, (own, ..)) in &touch.row {
                    speed += self.nodes.get_mut(index).map_or(0.0, |node| own * record(node)[axis]);
                }
                let gap = if touch.presses { 0.0 } else { touch.gap.max(0.0) };
                let excess = wall.sign * (speed - drag) + gap / dt;
                let wanted = touch.stop - excess / touch.shown(axis);
                let more = if touch.presses { wanted } else { wanted.max(0.0) } - touch.stop;
                touch.stop += more;
                for (index, (_, all, _, shown)) in &touch.row {
                    if let Some(node) = self.nodes.get_mut(index) {
                        record(node)[axis] += wall.sign * all[axis] * more * shown;
                    }
                }
                (changed, largest) = (changed.max(more.abs()), largest.max(touch.stop.abs()));
            }
            if changed <= FOUND * largest {
                break;
            }
        }
        for index in light.iter().filter(|_| !touches.is_empty()) {
            if let Some(node) = self.nodes.get_mut(index) {
                record(node)[axis] = drag;
            }
        }
    }

    /// Apply Coulomb friction to the surfaces in particle order, with as many sweeps as the fast step.
    fn rub(&mut self, wall: &Wall<D>, touches: &[Touch<D>], takes: f64, dt: f64) {
        let slip_of = |this: &Self, touch: &Touch<D>, d: usize| {
            touch.of(|index| this.nodes[index].velocity[d]) - wall.velocity[d]
        };
        let along: Vec<usize> = (0..D).filter(|d| *d != wall.axis).collect();
        let mut impulses = vec![[0.0; D]; touches.len()];
        for _ in 0..SWEEPS {
            let (mut changed, mut largest) = (0.0f64, 0.0f64);
            for (touch, impulse) in touches.iter().zip(&mut impulses) {
                let limit = wall.friction * touch.given(takes).max(0.0);
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
                    for (index, (_, all, mass, _)) in &touch.row {
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
