//! Grid stages: sums of the tiles, momentum update, boundary conditions, re-mapped velocities.

use crate::dim::block_nodes;
use crate::grid::{GridStorage, Node};
use impactite_geometry::Lattice;
use impactite_scene::Exchange;
use impactite_simd::{Float, Team};

use super::constraints::{BlockBooks, Conditions, Constraints, carry, free_directions};
use super::fields::Fields;
use super::layout::NodeSums;
use super::node_update::{Damp, Integrate, Leave, MeanVelocities, NodeUpdate, Remap, Velocities};
use super::planes::Planes;
use crate::step::bodies::body::GridBody;
use crate::step::rigid::nodes::rigid_of;

/// Return the mass cutoff of nodes, over the smallest particle mass: the square of some rounding units. The slope of a
/// spline is the root of its weight there, so that an excluded node adds no more than rounding to a velocity gradient.
/// (With 1e-14, rigid flight produced stresses of 1e-9 of Young's modulus.) Below it, slopes of deforming domains are
/// differences of rounding, which over a mass of rounding yield arbitrary velocities.
pub fn mass_cutoff<T: Float>() -> T {
    let rounding = T::of(64.0) * T::default_epsilon();
    rounding * rounding
}

/// Parameters of a stage, other than bodies and grid.
#[derive(Clone, Copy)]
pub(in crate::step) struct StageOf<T> {
    /// Time at the start of the step, s.
    pub(in crate::step) time: f64,
    /// True if stencils extend beyond a plane that particles touch.
    pub(in crate::step) wide: bool,
    /// PIC fraction of the transfer: 0 for FLIP, 1 for PIC and APIC.
    pub(in crate::step) takes: T,
    /// True if nodal forces are known separately from momentum.
    pub(in crate::step) forces: bool,
    /// Time step, s.
    pub(in crate::step) dt: T,
}

/// Grid of a step, for its stages.
pub struct GridStages<'a, T: Float, const D: usize> {
    /// The grid.
    pub grid: &'a mut dyn GridStorage<T, D>,
    /// Bodies of the scene.
    pub bodies: &'a [Box<dyn GridBody<T, D>>],
    /// Node blocks, by body if bodies are separated.
    pub fields: &'a Fields<D>,
    /// Thread pool.
    pub team: &'a Team,
    /// Conditions.
    pub conditions: &'a Conditions<D>,
    /// Records of node blocks, one per block.
    pub books: &'a mut Vec<BlockBooks>,
    /// Exchange that belongs to no single block, so that sums do not depend on the order of blocks.
    pub scene_wide: &'a mut Exchange,
    /// Mass below which a node carries no momentum, kg.
    pub cutoff: T,
    /// Mass of the lightest particle, kg.
    pub lightest: T,
    /// Parameters of the stage.
    pub(in crate::step) of: StageOf<T>,
    /// Nodes at symmetry planes, walls and fixed planes.
    pub planes: &'a mut Planes<T>,
    /// True if a body is rigid.
    pub rigid: bool,
}

impl<T: Float, const D: usize> GridStages<'_, T, D> {
    /// Return the boundary conditions of node blocks; nodes and records remain writable.
    fn constraints<'a>(
        (conditions, planes): (&'a Conditions<D>, &'a Planes<T>),
        (bodies, fields): (&'a [Box<dyn GridBody<T, D>>], &'a Fields<D>),
        lattice: Lattice<D>,
        of: StageOf<T>,
    ) -> Constraints<'a, T, D> {
        Constraints {
            boundaries: &conditions.boundaries,
            planes,
            layout: fields.layout(),
            bodies,
            fields,
            lattice,
            time: of.time,
            copies: if of.wide { 1.5 * lattice.spacing() } else { 0.0 },
        }
    }

    /// Sum the bodies' tiles (eqs. 2, 3, 9 of \[Ma2010\]): for each node block, bodies in order, neighbouring blocks in
    /// order, so that the sums are the same for any number of threads and any grid. Then apply `update` to every node: in
    /// the same loop, if no plane folds nodes in between.
    pub(in crate::step) fn collect_and(&mut self, sums: NodeSums, update: &impl NodeUpdate<T>) {
        let (bodies, fields) = (self.bodies, self.fields);
        if sums == NodeSums::All {
            self.books.resize(fields.len(), BlockBooks::default());
            self.books.iter_mut().for_each(|books| books.ledger = Exchange::default());
            *self.scene_wide = Exchange::default();
        }
        let constraints = Self::constraints(
            (self.conditions, self.planes),
            (self.bodies, self.fields),
            *self.grid.lattice(),
            self.of,
        );
        let at_once = self.planes.is_empty();
        let rigid = self.rigid;
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            if nodes.is_whole() {
                sum_up(bodies, fields, block, sums, nodes.items);
            } else {
                let mut all = [Node::default(); block_nodes(3)];
                nodes.numbered().for_each(|(n, node)| all[n] = *node);
                sum_up(bodies, fields, block, sums, &mut all[..block_nodes(D)]);
                nodes.numbered().for_each(|(n, node)| *node = std::mem::take(&mut all[n]));
                debug_assert!(
                    all.iter().all(|n| n.first[0] == T::default()),
                    "mass where the body has no node"
                );
            }
            if at_once && !(rigid && carry(bodies, fields, &constraints, block, sums, &mut nodes)) {
                constraints.apply(update, block, &mut nodes, books);
            }
        });
        if at_once {
            return;
        }
        self.planes.ties.fold(self.grid.nodes_mut(), sums, bodies, fields, self.team);
        let all = self.moves(sums);
        // Particles of other scenes receive no part of their nodes' velocity.
        let elsewhere = |node: u32| {
            let owner = fields.owner(layout.block_of(node as usize)) as usize;
            match bodies.get(owner) {
                Some(body) if body.client().is_some() => [T::default(), all[1]],
                _ => all,
            }
        };
        let ordinary = bodies.iter().all(|body| body.client().is_none());
        let moves = |node: u32| if ordinary { all } else { elsewhere(node) };
        let weight = update.weight();
        let [impulse, of_first] = {
            let spacing = self.grid.lattice().spacing();
            self.planes.fold(self.grid.nodes_mut(), sums, &moves, (self.cutoff, spacing), weight)
        };
        self.conditions.boundaries.book_symmetry(&impulse, self.scene_wide);
        for d in 0..3 {
            self.scene_wide.impulse[d] += impulse[d];
            // Work of the weight on the mapped momentum, if nodes store only the sum of momentum and impulse (see
            // `Integrate`).
            if let Some(weight) = weight.filter(|_| !self.of.forces) {
                self.scene_wide.work -= 0.5 * self.of.dt.to_double() * weight[d] * of_first[d];
            }
        }
        self.each_node(sums, update);
    }

    /// Return the factors of nodal records in the particles' momentum, for first[i] and second[i]. A velocity smoothed by
    /// FMPM is subtracted.
    fn moves(&self, sums: NodeSums) -> [T; 2] {
        let none = T::default();
        match sums {
            NodeSums::All => [self.of.takes, self.of.dt],
            NodeSums::Force => [none, self.of.dt],
            NodeSums::Smoothed => [none, T::of(-1.0)],
            NodeSums::Pushes => [none, T::of(1.0)],
            NodeSums::Again => [none, none],
        }
    }

    /// Sum momentum, and store the velocity, with boundary conditions, in the first record (USF).
    pub fn velocities(&mut self) {
        let (cutoff, time, takes, dt) = (self.cutoff, self.of.time, self.of.takes, self.of.dt);
        self.collect_and(NodeSums::All, &Velocities::<T, D> { cutoff, time, takes, dt });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum momentum, and store the velocity, without boundary conditions, in the first record.
    pub fn mean_velocities(&mut self) {
        self.collect_and(NodeSums::All, &MeanVelocities::<T, D> { cutoff: self.cutoff });
        self.planes.extrapolate(self.grid.nodes_mut());
        // Reset the ledgers: no exchange has taken place yet.
        self.books.iter_mut().for_each(|books| books.ledger = Exchange::default());
        *self.scene_wide = Exchange::default();
    }

    /// Sum momentum and force, or force alone if velocities are known, and update the momentum (eq. 8 of \[Ma2010\]): v =
    /// p/m + dt f/m with loads and boundary conditions. Stores the new velocity in the first record, the acceleration in
    /// the second.
    pub fn integrate_momentum(&mut self, dt: T, from_velocity: bool) {
        let (cutoff, end) = (self.cutoff, self.of.time + dt.to_double());
        let gravity = self.conditions.gravity.as_ref().map(|g| g(self.of.time));
        let sums = if from_velocity { NodeSums::Force } else { NodeSums::All };
        let forces = self.of.forces;
        let update = Integrate::<T, D> { cutoff, dt, end, gravity, from_velocity, forces };
        self.collect_and(sums, &update);
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Apply local damping to the velocity changes of nodes in the step, contact and boundary conditions included
    /// ([`LocalDamping`]). Nodes of rigid bodies and of bodies of other solvers are excluded: their forces are not those at
    /// their nodes.
    pub fn damp(&mut self, dt: T) {
        let (cutoff, end) = (self.cutoff, self.of.time + dt.to_double());
        let gravity = self.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.of.time));
        let update = Damp::<T, D> { cutoff, dt, end, gravity, damping: self.conditions.damping };
        self.each_node_of(&update, &|body| body.rigid().is_none() && body.client().is_none());
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum the momentum mapped a second time, and store the velocity, with boundary conditions, in the second record
    /// (MUSL).
    pub fn remap_velocities(&mut self, dt: T) {
        let (cutoff, end) = (self.cutoff, self.of.time + dt.to_double());
        self.collect_and(NodeSums::Again, &Remap::<T, D> { cutoff, end });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum the smoothed velocity, and add the next term of the FMPM series, d <- d - S~ d, to the velocity, except in
    /// constrained directions. `terms` stores d, one per node.
    pub fn refine_velocities(&mut self, terms: &mut [[T; 3]]) {
        self.collect_and(NodeSums::Smoothed, &Leave);
        let cutoff = self.cutoff;
        let conditions = self.conditions;
        // Constraints at the end of the step, as in the momentum update.
        let time = self.of.time + self.of.dt.to_double();
        let lattice = *self.grid.lattice();
        let copies = if self.of.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let accounts_of =
            |x: &[f64; D]| conditions.boundaries.constraining(x, (time, 1e-6 * lattice.spacing(), copies));
        let (bodies, fields, rigid) = (self.bodies, self.fields, self.rigid);
        let planes = &*self.planes;
        let mirrors = planes.copied();
        let nodes = self.grid.nodes();
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, terms, self.books, |block, mut terms, books| {
            if rigid && rigid_of(bodies, fields, block).is_some() {
                return;
            }
            let place = fields.place(block);
            let nodes = layout.of(nodes, block);
            let own = planes.own_masses(layout.start(block), nodes.len());
            for (i, ((n, term), node)) in terms.numbered().zip(nodes).enumerate() {
                let mass = node.first[0];
                if mass <= cutoff {
                    continue;
                }
                let x = place.node(n);
                let free = free_directions(conditions, &x, time, lattice.spacing(), copies);
                let whole = if place.is_copy(n, mirrors) { 0.0 } else { 1.0 };
                let share = own.share(i, node).unwrap_or(whole);
                let accounts = accounts_of(&x);
                for d in 0..D {
                    let next = term[d] - node.second[d + 1] / mass;
                    let free = free[d] && !books.held.has(d, n);
                    term[d] = if free { next } else { T::default() };
                    if !free {
                        let impulse = -share * (mass * next).to_double();
                        books.ledger.impulse[d] += impulse;
                        if let Some(account) = accounts[d] {
                            books.ledger.accounts[account].impulse[d] += impulse;
                        }
                    }
                }
            }
        });
        let terms = &*terms;
        layout.each(team, self.grid.nodes_mut(), self.books, |block, nodes, _| {
            if rigid && rigid_of(bodies, fields, block).is_some() {
                return;
            }
            for (node, term) in nodes.items.iter_mut().zip(layout.of(terms, block)) {
                if node.first[0] <= cutoff {
                    continue;
                }
                node.second[1..=D].copy_from_slice(&term[..D]);
                for d in 0..D {
                    node.first[d + 1] += term[d];
                }
            }
        });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Store the velocities next to symmetry planes, before others change them.
    pub fn note_velocities(&mut self) {
        self.planes.note_velocities(self.grid.nodes());
    }

    /// Extrapolate nodal vectors behind planes from the changed ones in front.
    pub fn extrapolate(&mut self) {
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Start the FMPM series: d = v.
    pub fn first_terms(&mut self, terms: &mut Vec<[T; 3]>) {
        terms.clear();
        for node in self.grid.nodes_mut() {
            let v = [node.first[1], node.first[2], node.first[3]];
            node.second[1..].copy_from_slice(&v);
            terms.push(v);
        }
    }

    /// Set the nodes of rigid bodies to the rigid velocity, which no plane folds, and apply `update` to all nodes that are
    /// not final.
    fn each_node(&mut self, sums: NodeSums, update: &impl NodeUpdate<T>) {
        let constraints = Self::constraints(
            (self.conditions, self.planes),
            (self.bodies, self.fields),
            *self.grid.lattice(),
            self.of,
        );
        let (bodies, fields, rigid) = (self.bodies, self.fields, self.rigid);
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            if !(rigid && carry(bodies, fields, &constraints, block, sums, &mut nodes)) {
                constraints.apply(update, block, &mut nodes, books);
            }
        });
    }

    /// Apply `update` to nodes of bodies for which `counts` is true, and to those of the common field.
    pub(in crate::step) fn each_node_of(
        &mut self,
        update: &impl NodeUpdate<T>,
        counts: &(dyn Fn(&dyn GridBody<T, D>) -> bool + Sync),
    ) {
        let constraints = Self::constraints(
            (self.conditions, self.planes),
            (self.bodies, self.fields),
            *self.grid.lattice(),
            self.of,
        );
        let (bodies, fields) = (self.bodies, self.fields);
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            if bodies.get(fields.owner(block) as usize).is_none_or(|body| counts(&**body)) {
                constraints.apply(update, block, &mut nodes, books);
            }
        });
    }
}

/// Sum the contributions of bodies to a block.
fn sum_up<T: Float, const D: usize>(
    bodies: &[Box<dyn GridBody<T, D>>],
    fields: &Fields<D>,
    block: usize,
    sums: NodeSums,
    nodes: &mut [Node<T>],
) {
    match sums {
        NodeSums::All => nodes.fill(Node::default()),
        NodeSums::Force | NodeSums::Again | NodeSums::Smoothed | NodeSums::Pushes => {
            nodes.iter_mut().for_each(|n| n.second = [T::default(); 4]);
        }
    }
    for giver in fields.givers(block) {
        bodies[giver.body as usize].presence().add_tiles(giver.local as usize, sums, nodes);
    }
}
