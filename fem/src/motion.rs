//! Nodes through a step: velocities from forces, conditions, positions.

use impactite_scene::boundary::BodyForce;
use impactite_scene::{Boundary, Cause, Exchange, MovingPoint, PointKind, StepError, Stopped};
use impactite_scene::{Clock, Condition};
use impactite_simd::Team;

use crate::body::{ElementBody, Node};
use crate::set::wide;

/// Nodes a task moves.
const CHUNK: usize = 1024;
/// Within this part of the spacing a node lies on a plane.
const ROUNDING: f64 = 1e-6;
/// Within this part of its elements' extent a node is on the plane of a condition that answers to velocities.
const NEAR: f64 = 0.25;

/// What moving the nodes of a chunk found.
#[derive(Clone, Copy, Debug, Default)]
struct Moved {
    given: Exchange,
    /// What of it came by impulses of others.
    pushed: Exchange,
    trouble: Option<usize>,
}

/// A step of the scene that a body makes a part of.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a, const D: usize> {
    pub clock: &'a Clock,
    pub dt: f64,
    /// Steps of the scene in one of the body.
    pub ratio: u32,
    pub force: Option<&'a BodyForce<D>>,
    pub boundaries: &'a [Boundary<D>],
}

impl<const D: usize> ElementBody<D> {
    /// New velocities, as if nothing but elements and the body force acted.
    pub(crate) fn accelerate(&mut self, part: &Part<'_, D>, team: &Team) {
        self.begin(part);
        if self.pace.kick == 0.0 {
            return;
        }
        let chunks = self.each_node(team, |body, n, node, found| body.kick(n, node, found));
        chunks.iter().for_each(|found| self.exchange.add(&found.given));
    }

    /// Conditions and new positions.
    pub(crate) fn advance(&mut self, part: &Part<'_, D>, team: &Team) -> Result<(), StepError> {
        self.merge_pushes();
        let Part { clock, dt, boundaries, .. } = *part;
        let chunks = self.each_node(team, |body, n, node, found| {
            Motion { body, boundaries, time: clock.time, dt }.advance(n, node, found);
        });
        self.take(clock, &chunks)
    }

    fn begin(&mut self, part: &Part<'_, D>) {
        self.pace.begin(part.dt, part.ratio);
        self.pushes.clear();
        if self.extents.is_empty() && part.boundaries.iter().any(Boundary::reacts) {
            self.measure_extents();
        }
        if self.pace.kick == 0.0 {
            return;
        }
        self.acceleration = part.force.map_or([0.0; D], |f| f(part.clock.time));
        if part.ratio > 1 {
            self.from.clear();
            self.from.extend(self.nodes.iter().map(|n| n.position));
        }
    }

    /// A task on every node. It sees the body without nodes.
    fn each_node(
        &mut self,
        team: &Team,
        task: impl Fn(&Self, usize, &mut Node<D>, &mut Moved) + Send + Sync,
    ) -> Vec<Moved> {
        let mut nodes = std::mem::take(&mut self.nodes);
        let mut chunks = vec![Moved::default(); nodes.len().div_ceil(CHUNK)];
        let body = &*self;
        team.each_piece(&mut nodes, CHUNK, &mut chunks, |chunk, nodes, found| {
            for (k, node) in nodes.iter_mut().enumerate() {
                task(body, chunk * CHUNK + k, node, found);
            }
        });
        self.nodes = nodes;
        chunks
    }

    /// The new velocity of a node.
    #[inline]
    fn kick(&self, n: usize, node: &mut Node<D>, found: &mut Moved) {
        let kick = self.pace.kick;
        let (start, pull, per) = (node.velocity, self.force(n), kick / node.mass);
        for d in 0..D {
            node.velocity[d] += per * pull[d] + kick * self.acceleration[d];
        }
        if self.acceleration != [0.0; D] {
            self.book_load(&start, node, found);
        }
    }

    /// Book the body force on a node that had the velocity `start`.
    #[inline(never)]
    fn book_load(&self, start: &[f64; D], node: &Node<D>, found: &mut Moved) {
        for d in 0..D {
            let impulse = self.pace.kick * node.mass * self.acceleration[d];
            found.given.load[d] += impulse;
            found.given.work += 0.5 * impulse * (start[d] + node.velocity[d]);
        }
    }

    /// What moving the nodes found.
    fn take(&mut self, clock: &Clock, chunks: &[Moved]) -> Result<(), StepError> {
        for found in chunks {
            self.exchange.add(&found.given);
            self.pushed.add(&found.pushed);
            if let Some(number) = found.trouble {
                let (body, law) = (self.name.clone(), self.material.name());
                let position = wide(&self.mesh.nodes[number]);
                let cause = Cause::Velocity;
                return Err(clock.stopped(Stopped::Point {
                    kind: PointKind::Node,
                    body,
                    number,
                    position,
                    law,
                    cause,
                }));
            }
        }
        Ok(())
    }

    /// Give a node an impulse, N s, in a trial: its velocity changes at once; momentum and, with the velocity that the step ends with,
    /// work are booked as those of boundaries ([`ElementBody::exchange`]).
    ///
    /// # Panics
    /// There is no such node.
    pub fn add_impulse(&mut self, node: usize, impulse: [f64; D]) {
        let Node { velocity, mass, .. } = &mut self.nodes[node];
        for d in 0..D {
            velocity[d] += impulse[d] / *mass;
        }
        self.pushes.push((node as u32, impulse));
    }

    /// Pushes by node, each once.
    fn merge_pushes(&mut self) {
        self.pushes.sort_by_key(|(node, _)| *node);
        self.pushes.dedup_by(|next, sum| {
            let same = next.0 == sum.0;
            if same {
                (0..D).for_each(|d| sum.1[d] += next.1[d]);
            }
            same
        });
    }

    /// How far elements reach around each node: the mean of their extents along the axes.
    fn measure_extents(&mut self) {
        let mut sums = vec![([0.0; D], 0.0); self.nodes.len()];
        let rest = &self.mesh.nodes;
        for nodes in self.mesh.blocks.iter().flat_map(|b| b.elements()) {
            let at = |d: usize| nodes.iter().map(move |&n| rest[n as usize][d]);
            let extent: [f64; D] = std::array::from_fn(|d| {
                at(d).fold(f64::NEG_INFINITY, f64::max) - at(d).fold(f64::INFINITY, f64::min)
            });
            for &n in nodes {
                let (sum, count) = &mut sums[n as usize];
                (0..D).for_each(|d| sum[d] += extent[d]);
                *count += 1.0;
            }
        }
        self.extents = sums.into_iter().map(|(sum, count)| sum.map(|s| s / count)).collect();
    }
}

/// What moves a node.
struct Motion<'a, const D: usize> {
    body: &'a ElementBody<D>,
    boundaries: &'a [Boundary<D>],
    time: f64,
    dt: f64,
}

impl<const D: usize> Motion<'_, D> {
    #[inline]
    fn advance(&self, n: usize, node: &mut Node<D>, found: &mut Moved) {
        node.held = 0;
        let pushed = match self.body.pushes.is_empty() {
            true => None,
            false => self.body.pushes.binary_search_by_key(&(n as u32), |(node, _)| *node).ok(),
        };
        let marked = self.body.prescribed.iter().any(|p| p.nodes.binary_search(&(n as u32)).is_ok());
        if pushed.is_some() || marked || self.boundaries.iter().any(|b| self.reaches(b, n, node)) {
            self.constrain(n, node, pushed, found);
        }
        let mut square = 0.0;
        for d in 0..D {
            node.position[d] += self.dt * node.velocity[d];
            square += node.velocity[d] * node.velocity[d];
        }
        if !square.is_finite() && found.trouble.is_none() {
            found.trouble = Some(n);
        }
    }

    /// May a boundary act on a node?
    #[inline]
    fn reaches(&self, boundary: &Boundary<D>, n: usize, node: &Node<D>) -> bool {
        let (mut low, mut high) = (node.position, node.position);
        for d in 0..D {
            let end = node.position[d] + self.dt * node.velocity[d];
            (low[d], high[d]) = (low[d].min(end), high[d].max(end));
        }
        let near = match self.body.extents.get(n) {
            Some(extent) if boundary.reacts() => NEAR * extent.iter().fold(0.0, |m: f64, e| m.max(*e)),
            _ => ROUNDING * self.body.spacing,
        };
        let at = |time| boundary.reaches(&low, &high, time, near);
        at(self.time) || at(self.time + self.dt)
    }

    /// Conditions on a node, and the books of what pushed it: of few nodes, and so kept out of the loop over all.
    #[inline(never)]
    fn constrain(&self, n: usize, node: &mut Node<D>, pushed: Option<usize>, found: &mut Moved) {
        let body = self.body;
        let push = pushed.map_or([0.0; D], |at| body.pushes[at].1);
        let (force, kick) = (body.force(n), body.pace.kick);
        // Before any force of the step acted, and after elements and the body force did.
        let tried: [f64; D] = std::array::from_fn(|d| node.velocity[d] - push[d] / node.mass);
        let start = std::array::from_fn(|d| tried[d] - kick * (force[d] / node.mass + body.acceleration[d]));
        let mut point = MovingPoint {
            position: node.position,
            mass: node.mass,
            start,
            velocity: node.velocity,
            size: body.spacing,
            depth: 0.0,
            tolerance: ROUNDING * body.spacing,
        };
        for boundary in self.boundaries {
            if let Some(extent) = body.extents.get(n).filter(|_| boundary.reacts()) {
                let size = match boundary.surface() {
                    Some((axis, ..)) => extent[axis],
                    None => extent.iter().sum::<f64>() / D as f64,
                };
                (point.depth, point.tolerance) = (0.5 * size, NEAR * size);
            }
            boundary.hold(&mut point, (self.time, self.dt), &mut found.given);
        }
        for prescribed in body.prescribed.iter().filter(|p| p.nodes.binary_search(&(n as u32)).is_ok()) {
            let before = point.velocity;
            point.follow((prescribed.velocity)(self.time + 0.5 * self.dt));
            point.book(before, &mut found.given);
        }
        for d in 0..D {
            let end = point.velocity[d];
            if end != node.velocity[d] || pushed.is_some() {
                node.held |= 1 << d;
            }
            let work = 0.5 * push[d] * (start[d] + end);
            for sum in [&mut found.given, &mut found.pushed] {
                sum.impulse[d] += push[d];
                sum.work += work;
            }
            // The body force was booked with the velocity tried.
            found.given.work += 0.5 * kick * node.mass * body.acceleration[d] * (end - tried[d]);
        }
        node.velocity = point.velocity;
    }
}
