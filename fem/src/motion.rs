//! Nodal time integration: velocity update, boundary conditions, position update.

use impactite_scene::boundary::BodyForce;
use impactite_scene::{
    Boundaries, Boundary, Cause, Exchange, LocalDamping, MovingPoint, PointKind, StepError, Stopped,
};
use impactite_scene::{Clock, Condition};
use impactite_simd::Team;

use crate::body::{ElementBody, Node};
use crate::push::{Push, merge};
use crate::set::wide;

/// Number of nodes per task.
const CHUNK: usize = 1024;
/// Tolerance for nodes on a plane, over the spacing.
const ROUNDING: f64 = 1e-6;
/// Tolerance for nodes on the plane of a condition that reacts to velocities, over the extent of the node's elements.
const NEAR: f64 = 0.25;

/// Results of the update of a chunk of nodes.
#[derive(Clone, Copy, Debug, Default)]
struct Moved {
    given: Exchange,
    /// Part of `given` by impulses of couplings.
    pushed: Exchange,
    /// Exchange by contact in the scene, not included in `given`.
    touched: Exchange,
    trouble: Option<usize>,
}

/// Step of the scene, as a part of the step of a body.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a, const D: usize> {
    pub clock: &'a Clock,
    pub dt: f64,
    /// Subcycling ratio: steps of the scene in one step of the body.
    pub ratio: u32,
    pub force: Option<&'a BodyForce<D>>,
    pub damping: LocalDamping,
    pub boundaries: &'a Boundaries<D>,
}

impl<const D: usize> ElementBody<D> {
    /// Update velocities by internal forces, the body force and loads.
    pub(crate) fn accelerate(&mut self, part: &Part<'_, D>, team: &Team) {
        self.begin(part);
        if self.pace.kick == 0.0 {
            return;
        }
        let chunks = self.each_node(team, |body, n, node, found| body.kick(n, node, found));
        chunks.iter().for_each(|found| self.exchange.add(&found.given));
        if !self.loads.is_empty() {
            self.push_loads(part.clock.time);
        }
    }

    /// Apply boundary conditions and update positions.
    pub(crate) fn advance(&mut self, part: &Part<'_, D>, team: &Team) -> Result<(), StepError> {
        self.merge_pushes();
        let Part { clock, dt, boundaries, damping, .. } = *part;
        let chunks = self.each_node(team, |body, n, node, found| {
            Motion { body, boundaries, time: clock.time, dt, damping }.advance(n, node, found);
        });
        self.take(clock, &chunks)
    }

    /// Move a node in the open step with this velocity, m/s, instead of its own, which it keeps: the velocity, with boundary conditions
    /// applied, of the matter that carries the node.
    ///
    /// # Panics
    /// There is no such node.
    pub fn carry(&mut self, node: usize, velocity: [f64; D]) {
        self.carried.resize(self.nodes.len(), None);
        self.carried[node] = Some(velocity);
    }

    fn begin(&mut self, part: &Part<'_, D>) {
        self.pace.begin(part.dt, part.ratio);
        self.pushes.clear();
        self.carried.clear();
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

    /// Run a task on every node. Its view of the body has no nodes.
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

    /// Update the velocity of a node by its internal force and the body force.
    #[inline]
    fn kick(&self, n: usize, node: &mut Node<D>, found: &mut Moved) {
        if node.mass == 0.0 {
            return; // All its elements were converted.
        }
        let kick = self.pace.kick;
        let (start, pull, per) = (node.velocity, self.force(n), kick / node.mass);
        for d in 0..D {
            node.velocity[d] += per * pull[d] + kick * self.acceleration[d];
        }
        if self.acceleration != [0.0; D] {
            self.book_load(&start, node, found);
        }
    }

    /// Book impulse and work of the body force on a node whose velocity was `start`.
    #[inline(never)]
    fn book_load(&self, start: &[f64; D], node: &Node<D>, found: &mut Moved) {
        for d in 0..D {
            let impulse = self.pace.kick * node.mass * self.acceleration[d];
            found.given.load[d] += impulse;
            found.given.work += 0.5 * impulse * (start[d] + node.velocity[d]);
        }
    }

    /// Collect the results of the node updates.
    fn take(&mut self, clock: &Clock, chunks: &[Moved]) -> Result<(), StepError> {
        for found in chunks {
            self.exchange.add(&found.given);
            self.pushed.add(&found.pushed);
            self.touched.add(&found.touched);
            if let Some(number) = found.trouble {
                return Err(self.runs_away(clock, number));
            }
        }
        Ok(())
    }

    /// Error for a node whose velocity is not finite.
    pub(crate) fn runs_away(&self, clock: &Clock, number: usize) -> StepError {
        clock.stopped(Stopped::Point {
            kind: PointKind::Node,
            body: self.name.clone(),
            number,
            position: wide(&self.mesh.nodes[number]),
            law: self.material.name(),
            cause: Cause::Velocity,
        })
    }

    /// Add an impulse, N s, to a node in a trial: its velocity changes at once. Momentum, and work with the velocity at the end of the
    /// step, are booked as those of boundaries ([`ElementBody::exchange`]).
    ///
    /// # Panics
    /// There is no such node.
    pub fn add_impulse(&mut self, node: usize, impulse: [f64; D]) {
        self.push(Push { given: impulse, ..Push::of(node as u32) });
    }

    /// Add a contact impulse of the scene, N s, to a node; it is booked separately.
    pub(crate) fn touch(&mut self, node: u32, impulse: [f64; D]) {
        self.push(Push { touch: impulse, ..Push::of(node) });
    }

    /// Add the impulses of the surface loads at a time, s, to the nodes.
    pub(crate) fn push_loads(&mut self, time: f64) {
        let mut loads = std::mem::take(&mut self.loads);
        for load in &mut loads {
            load.act(time, &|node| self.nodes[node as usize].position, self.hoop);
            for (node, force) in &load.acting {
                // Nodes without mass belong to converted elements only.
                if self.nodes[*node as usize].mass > 0.0 {
                    let load = force.map(|f| self.pace.kick * f);
                    self.push(Push { load, ..Push::of(*node) });
                }
            }
        }
        self.loads = loads;
    }

    /// Force of the loads on a node in the last step, N.
    pub(crate) fn loaded_by(&self, node: usize) -> [f64; D] {
        let mut force = [0.0; D];
        for load in &self.loads {
            if let Some(own) = load.on(node as u32) {
                (0..D).for_each(|d| force[d] += own[d]);
            }
        }
        force
    }

    fn push(&mut self, push: Push<D>) {
        let (Node { velocity, mass, .. }, impulse) = (&mut self.nodes[push.node as usize], push.sum());
        for d in 0..D {
            velocity[d] += impulse[d] / *mass;
        }
        self.pushes.push(push);
    }

    /// Merge the impulses of each node.
    pub(crate) fn merge_pushes(&mut self) {
        merge(&mut self.pushes);
    }

    /// Measure the mean extent of the elements around each node along the axes.
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

/// Context of a node update.
pub(crate) struct Motion<'a, const D: usize> {
    pub body: &'a ElementBody<D>,
    pub boundaries: &'a Boundaries<D>,
    pub time: f64,
    pub dt: f64,
    pub damping: LocalDamping,
}

/// Velocities of a node in a step.
struct Moment<const D: usize> {
    /// Velocity before any force of the step acted, m/s.
    start: [f64; D],
    /// Trial velocity, after internal forces and the body force, m/s.
    tried: [f64; D],
    /// View of the node for boundary conditions.
    point: MovingPoint<D>,
}

impl<const D: usize> Motion<'_, D> {
    #[inline]
    fn advance(&self, n: usize, node: &mut Node<D>, found: &mut Moved) {
        node.held = 0;
        if node.mass == 0.0 {
            return;
        }
        let pushed = self.pushed(n);
        if pushed.is_some() || self.is_bound(n, node) {
            self.constrain(n, node, pushed, found);
        }
        if self.damping.acts() {
            self.damp(n, node, pushed, found);
        }
        let mut square = 0.0;
        let moves = self.carried(n).unwrap_or(&node.velocity);
        for d in 0..D {
            node.position[d] += self.dt * moves[d];
            square += node.velocity[d] * node.velocity[d];
        }
        if !square.is_finite() && found.trouble.is_none() {
            found.trouble = Some(n);
        }
    }

    /// Velocity of the matter that carries a node.
    #[inline]
    fn carried(&self, n: usize) -> Option<&[f64; D]> {
        self.body.carried.get(n).and_then(Option::as_ref)
    }

    /// Impulses on a node in the step.
    #[inline]
    fn pushed(&self, n: usize) -> Option<&Push<D>> {
        let pushes = &self.body.pushes;
        if pushes.is_empty() {
            return None;
        }
        pushes.binary_search_by_key(&(n as u32), |push| push.node).ok().map(|at| &pushes[at])
    }

    /// True if a condition may act on a node.
    #[inline]
    fn is_bound(&self, n: usize, node: &Node<D>) -> bool {
        if self.carried(n).is_some() {
            return false;
        }
        self.prescribed(n).next().is_some() || self.boundaries.iter().any(|b| self.reaches(b, n, node))
    }

    /// Prescribed velocities of a node.
    #[inline]
    fn prescribed(&self, n: usize) -> impl Iterator<Item = [Option<f64>; 3]> {
        let on = self.body.prescribed.iter().filter(move |p| p.nodes.binary_search(&(n as u32)).is_ok());
        on.map(|p| (p.velocity)(self.time + 0.5 * self.dt))
    }

    /// True if the path of a node in the step comes within reach of a boundary.
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

    /// State of a node with an added impulse, before conditions act.
    fn moment(&self, n: usize, node: &Node<D>, push: &[f64; D]) -> Moment<D> {
        let body = self.body;
        let (force, kick) = (body.force(n), body.pace.kick);
        let tried: [f64; D] = std::array::from_fn(|d| node.velocity[d] - push[d] / node.mass);
        let start = std::array::from_fn(|d| tried[d] - kick * (force[d] / node.mass + body.acceleration[d]));
        let point = MovingPoint {
            position: node.position,
            mass: node.mass,
            start,
            velocity: node.velocity,
            size: body.spacing,
            depth: 0.0,
            tolerance: ROUNDING * body.spacing,
        };
        Moment { start, tried, point }
    }

    /// Apply boundary conditions and prescribed velocities to a point.
    fn obey(&self, n: usize, point: &mut MovingPoint<D>, given: &mut Exchange) {
        if self.carried(n).is_some() {
            return;
        }
        for (number, boundary) in self.boundaries.iter().enumerate() {
            if let Some(extent) = self.body.extents.get(n).filter(|_| boundary.reacts()) {
                let size = match boundary.surface() {
                    Some((axis, ..)) => extent[axis],
                    None => extent.iter().sum::<f64>() / D as f64,
                };
                (point.depth, point.tolerance) = (0.5 * size, NEAR * size);
            }
            self.boundaries.hold(number, point, (self.time, self.dt), given);
        }
        for wanted in self.prescribed(n) {
            let before = point.velocity;
            point.follow(wanted);
            point.book(before, given);
        }
    }

    /// Velocity of a node after boundary conditions, and true if they prescribe it in all directions.
    pub fn answer(&self, n: usize, node: &Node<D>) -> ([f64; D], bool) {
        if !self.is_bound(n, node) {
            return (node.velocity, false);
        }
        let push = self.pushed(n).map_or([0.0; D], Push::sum);
        let mut point = self.moment(n, node, &push).point;
        let mut held = [false; D];
        for boundary in self.boundaries.iter().filter(|b| self.reaches(b, n, node)) {
            let holds = boundary.holds(&point, (self.time, self.dt));
            (0..D).for_each(|d| held[d] |= holds[d]);
        }
        for wanted in self.prescribed(n) {
            (0..D).for_each(|d| held[d] |= wanted[d].is_some());
        }
        self.obey(n, &mut point, &mut Exchange::default());
        (point.velocity, held == [true; D])
    }

    /// Apply local damping to the velocity change of a node in the step, in directions that no condition holds. A subcycled body is damped
    /// in the step in which its forces act.
    #[inline(never)]
    fn damp(&self, n: usize, node: &mut Node<D>, pushed: Option<&Push<D>>, found: &mut Moved) {
        let (body, kick) = (self.body, self.body.pace.kick);
        if kick == 0.0 || self.carried(n).is_some() {
            return;
        }
        let force = body.force(n);
        let Push { given, touch, load, .. } = *pushed.unwrap_or(&Push::of(0));
        for d in 0..D {
            if node.is_held(d) {
                continue;
            }
            let gained = kick * (force[d] / node.mass + body.acceleration[d])
                + (given[d] + touch[d] + load[d]) / node.mass;
            let start = node.velocity[d] - gained;
            let change = self.damping.slowed(start, node.velocity[d]) - node.velocity[d];
            if change == 0.0 {
                continue;
            }
            node.velocity[d] += change;
            let impulse = node.mass * change;
            found.given.load[d] += impulse;
            found.given.damping -= 0.5 * impulse * (start + node.velocity[d]);
            // Work was booked with the undamped velocities: add the difference.
            let per = 0.5 * change;
            found.given.work += per * (kick * node.mass * body.acceleration[d] + given[d] + load[d]);
            found.pushed.work += per * given[d];
            found.touched.work += per * touch[d];
        }
    }

    /// Apply conditions to a node, and book the impulses on it. Few nodes need it, so that it is kept out of the loop over all.
    #[inline(never)]
    fn constrain(&self, n: usize, node: &mut Node<D>, pushed: Option<&Push<D>>, found: &mut Moved) {
        let (body, kick) = (self.body, self.body.pace.kick);
        let pushes = *pushed.unwrap_or(&Push::of(0));
        let (Push { given, touch, load, .. }, push) = (pushes, pushes.sum());
        let Moment { start, tried, mut point } = self.moment(n, node, &push);
        self.obey(n, &mut point, &mut found.given);
        let (is_pushed, is_touched) = (given != [0.0; D], touch != [0.0; D]);
        for d in 0..D {
            let end = point.velocity[d];
            if end != node.velocity[d] || is_pushed {
                node.held |= Node::<D>::HELD << d;
            } else if is_touched {
                node.held |= Node::<D>::TOUCHED << d;
            }
            let mean = 0.5 * (start[d] + end);
            for (sum, impulse) in
                [(&mut found.given, given[d]), (&mut found.pushed, given[d]), (&mut found.touched, touch[d])]
            {
                sum.impulse[d] += impulse;
                sum.work += impulse * mean;
            }
            found.given.load[d] += load[d];
            found.given.work += load[d] * mean;
            // The body force was booked with the trial velocity: add the difference.
            found.given.work += 0.5 * kick * node.mass * body.acceleration[d] * (end - tried[d]);
        }
        node.velocity = point.velocity;
    }
}
