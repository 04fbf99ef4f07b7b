//! Calls of hooks in a step, and application of their nodal velocities.

use std::collections::HashMap;
use std::sync::Arc;

use impactite_scene::{Body, Exchange, StepError, Stopped};
use impactite_simd::Float;

use super::hooks::{Hook, HookError, StepView, StrainNodes, TrialNode, TrialNodes};
use super::mpm::Mpm;
use super::nodes::block_place::BlockPlace;
use super::nodes::constraints::free_directions;
use super::nodes::layout::numbers;
use super::nodes::node_update::{Around, NodeUpdate, Nothing};
use super::nodes::stages::GridStages;
use super::point_operator::{OperatorPoint, OperatorWeight, PointOperator};
use crate::grid::Node;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Add a hook, an operation of each step ([`Hook`]). A resumed scene needs the same hooks.
    pub fn add_hook(&mut self, hook: impl Hook<T, D> + 'static) {
        self.hooks.0.push(Box::new(hook));
    }

    /// Call `place` of all hooks.
    fn call_hooks(
        &mut self,
        mut place: impl FnMut(&mut Self, &mut dyn Hook<T, D>) -> Result<(), HookError>,
    ) -> Result<(), StepError> {
        if self.hooks.0.is_empty() {
            return Ok(());
        }
        let mut hooks = std::mem::take(&mut self.hooks.0);
        let failed = hooks.iter_mut().find_map(|hook| {
            let error = place(self, &mut **hook).err()?;
            Some(Stopped::Hook { hook: hook.name().into(), why: error.to_string() })
        });
        self.hooks.0 = hooks;
        failed.map_or(Ok(()), |stopped| Err(self.stopped(stopped)))
    }

    pub(in crate::step) fn hooks_before_step(&mut self) -> Result<(), StepError> {
        self.call_hooks(|mpm, hook| hook.before_step(&mpm.step_view()))
    }

    pub(in crate::step) fn hooks_after_step(&mut self) -> Result<(), StepError> {
        self.call_hooks(|mpm, hook| hook.after_step(&mpm.step_view()))
    }

    fn step_view(&self) -> StepView<'_, D> {
        let bodies = self.scene.bodies.iter().map(|body| &**body as &dyn Body).collect();
        StepView { time: self.clock.time, steps: self.clock.steps, bodies }
    }

    /// Call the hooks with the velocities that strain the matter.
    pub(in crate::step) fn hooks_at_strain(&mut self, dt: T) -> Result<(), StepError> {
        self.call_hooks(|mpm, hook| {
            if !hook.needs_strain() {
                return Ok(());
            }
            let remapped = mpm.facts().remap;
            let mut nodes = StrainNodes { nodes: mpm.stage(dt).trial_nodes(remapped).nodes, work: 0.0 };
            hook.strain(&mut nodes, dt.to_double())?;
            mpm.ledger.work += nodes.work;
            Ok(())
        })
    }

    /// Assemble the particles of deformable bodies with their weights on listed nodes.
    fn point_operator(&self, nodes: &TrialNodes<D>) -> PointOperator<D> {
        let list = nodes.nodes().iter().enumerate();
        let at: HashMap<_, usize> = list.map(|(n, node)| ((node.body, node.index), n)).collect();
        let hoop = self.facts().hoop;
        let mut operator = PointOperator::new(nodes.nodes().len());
        self.for_each_footprint_here(&mut |p| {
            let of = &self.scene.bodies[p.body];
            if of.rigid().is_some() || of.client().is_some() {
                return;
            }
            let own = Some(self.grid.fields.owner_of(p.body as u32) as usize);
            let find = |node| at.get(&(own, node)).or_else(|| at.get(&(None, node)));
            let per_radius = if hoop { 1.0 / p.position[0] } else { 0.0 };
            let (body, number, mass, volume, stress) = (p.body, p.number, p.mass, p.volume, p.stress);
            let point = OperatorPoint { body, number, mass, volume, stress, per_radius };
            let weights = p.nodes.iter().filter_map(|w| {
                let sign = std::array::from_fn(|d| w.sign[d]);
                let (value, gradient) = (w.value, w.gradient);
                find(w.node).map(|&node| OperatorWeight { node, value, gradient, sign })
            });
            operator.push(point, weights);
        });
        operator
    }

    /// Call the hooks with the trial velocities, and apply their changes.
    pub(in crate::step) fn hooks_at_trial(&mut self, dt: T) -> Result<(), StepError> {
        self.call_hooks(|mpm, hook| {
            if !hook.needs_nodes() {
                return Ok(());
            }
            if mpm.grid.fields.levels().is_some() {
                return Err(
                    "a hook of nodes is not available with cells of several sizes: return false from \
                            `Hook::needs_nodes`, or remove the refined regions"
                        .into(),
                );
            }
            let mut nodes = mpm.stage(dt).trial_nodes(false);
            if hook.needs_points() {
                nodes.points = Some(Arc::new(mpm.point_operator(&nodes)));
            }
            hook.trial(&mut nodes, dt.to_double())?;
            if !nodes.changed {
                return Ok(());
            }
            let broken = nodes.nodes.iter().find(|node| node.velocity.iter().any(|v| !v.is_finite()));
            if let Some(node) = broken {
                return Err(
                    format!("velocity {:?} m/s of the node at {:?} m", node.velocity, node.position).into()
                );
            }
            mpm.stage(dt).set_trial(&nodes, dt);
            Ok(())
        })
    }
}

impl<T: Float, const D: usize> GridStages<'_, T, D> {
    /// List the nodes of deformable bodies of particles with their velocities, or with those of the second map.
    fn trial_nodes(&self, remapped: bool) -> TrialNodes<D> {
        let (lattice, layout) = (*self.grid.lattice(), self.fields.layout());
        let (mirrors, all) = (self.planes.copied(), self.grid.nodes());
        let time = self.of.time + self.of.dt.to_double();
        let copies = if self.of.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let mut nodes = Vec::new();
        for (block, coordinates) in self.fields.coordinates().iter().enumerate() {
            let owner = self.bodies.get(self.fields.owner(block) as usize);
            if owner.is_some_and(|body| body.rigid().is_some() || body.client().is_some()) {
                continue;
            }
            let (place, start) = (BlockPlace::new(&self.fields.lattices(), coordinates), layout.start(block));
            for (i, n) in numbers(layout.kept(block)).enumerate() {
                let node = &all[start + i];
                if node.first[0] <= self.cutoff || place.is_copy(n, mirrors) {
                    continue;
                }
                let position = place.node(n);
                let vector = |of: [T; 4]| -> [T; D] { std::array::from_fn(|d| of[d + 1]) };
                let (end, rate) = (vector(node.first), vector(node.second));
                let change = |d: usize| end[d] - rate[d] * self.of.dt;
                let (velocity, before) =
                    if remapped { (rate, rate) } else { (end, std::array::from_fn(change)) };
                let free = free_directions(self.conditions, &position, time, lattice.spacing(), copies);
                nodes.push(TrialNode {
                    body: owner.map(|_| self.fields.owner(block) as usize),
                    index: std::array::from_fn(|d| {
                        ((position[d] - lattice.origin()[d]) / lattice.spacing()).round() as i32
                    }),
                    position,
                    mass: node.first[0].to_double(),
                    velocity: velocity.map(|v| v.to_double()),
                    start: before.map(|v| v.to_double()),
                    held: std::array::from_fn(|d| !free[d] || self.books[block].held.has(d, n)),
                    place: start + i,
                });
            }
        }
        TrialNodes { nodes, points: None, spacing: lattice.spacing(), changed: false }
    }

    /// Set the velocities of listed nodes, and book the changes as loads.
    fn set_trial(&mut self, nodes: &TrialNodes<D>, dt: T) {
        let mut wanted = vec![None; self.grid.nodes().len()];
        nodes.nodes.iter().for_each(|node| wanted[node.place] = Some(node.velocity));
        let gravity = self.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.of.time));
        let end = self.of.time + dt.to_double();
        self.each_node_of(&SetVelocity { wanted: &wanted, dt, end, gravity }, &|_| true);
        self.planes.extrapolate(self.grid.nodes_mut());
    }
}

/// Velocities of nodes at the end of the step.
struct SetVelocity<'a, T, const D: usize> {
    wanted: &'a [Option<[f64; D]>],
    dt: T,
    end: f64,
    gravity: [f64; D],
}

impl<T: Float, const D: usize> NodeUpdate<T> for SetVelocity<'_, T, D> {
    #[inline(always)]
    fn update(&self, node: &mut Node<T>, around: &mut impl Around, ledger: &mut Exchange) {
        self.set(around.place(), node, around, ledger);
    }
    fn update_free_from(&self, first: usize, nodes: &mut [Node<T>], ledger: &mut Exchange) {
        for (i, node) in nodes.iter_mut().enumerate() {
            self.set(first + i, node, &mut Nothing, ledger);
        }
    }
}

impl<T: Float, const D: usize> SetVelocity<'_, T, D> {
    #[inline(always)]
    fn set(&self, place: usize, node: &mut Node<T>, around: &mut impl Around, ledger: &mut Exchange) {
        let Some(wanted) = self.wanted[place] else { return };
        let (mass, dt, held) = (node.first[0].to_double(), self.dt.to_double(), around.held());
        let (mut start, mut end, mut new) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for d in 0..D {
            end[d] = node.first[d + 1].to_double();
            start[d] = (node.first[d + 1] - node.second[d + 1] * self.dt).to_double();
            // A node that is not changed keeps its bits.
            let same = T::of(wanted[d]) == node.first[d + 1];
            new[d] = if held[d] || same { end[d] } else { wanted[d] };
        }
        around.constrain(&mut new, self.end);
        for d in (0..D).filter(|&d| new[d] != end[d]) {
            node.first[d + 1] = T::of(new[d]);
            node.second[d + 1] += T::of((new[d] - end[d]) / dt);
            let impulse = mass * (new[d] - end[d]);
            ledger.load[d] += impulse;
            ledger.work += 0.5 * impulse * (start[d] + new[d]);
            // Work of the body force was booked with the velocities before: add the difference.
            ledger.work += 0.5 * mass * dt * self.gravity[d] * (new[d] - end[d]);
        }
    }
}
