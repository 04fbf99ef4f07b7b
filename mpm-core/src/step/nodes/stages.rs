//! The grid stages: sums of the tiles, momentum update, boundaries, re-mapped velocities.

use crate::dim::block_nodes;
use crate::grid::{GridStorage, Node};
use impactite_geometry::Lattice;
use impactite_scene::boundary::{BodyForce, Boundary};
use impactite_scene::{Condition, Exchange, LocalDamping, Place};
use impactite_simd::{Float, Team};

use super::block_place::BlockPlace;
use super::fields::Fields;
use super::layout::{Layout, NodeSums, Piece};
use super::node_update::{
    Around, Damp, Integrate, Leave, MeanVelocities, NodeUpdate, Remap, Trial, Velocities,
};
use super::planes::Planes;
use crate::step::bodies::body::GridBody;
use crate::step::rigid::nodes::{self, rigid_of};

use super::node_sets::NodeSets;

/// Add a part of what became of a node.
fn add_share(sum: &mut Exchange, share: f64, o: &Exchange) {
    for d in 0..3 {
        sum.impulse[d] += share * o.impulse[d];
        sum.load[d] += share * o.load[d];
        sum.dropped[d] += share * o.dropped[d];
    }
    sum.work += share * o.work;
    sum.friction += share * o.friction;
    sum.damping += share * o.damping;
}

/// What is kept of a block of nodes beside the nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlockBooks {
    /// What its stages took or gave in a step.
    pub ledger: Exchange,
    /// Those that conditions hold in this step that react, by direction.
    pub held: NodeSets,
}

/// The conditions that act on the nodes of a scene.
#[derive(Clone, Default)]
pub struct Conditions<const D: usize> {
    /// Boundaries, applied in this order.
    pub boundaries: Vec<Boundary<D>>,
    /// Acceleration of all material.
    pub gravity: Option<BodyForce<D>>,
    /// Local damping.
    pub damping: LocalDamping,
}

/// A node counts as massless below this part of the smallest particle mass: the square of some rounding units.
/// A spline's slope is the root of its weight there, so that a node left out adds no more than rounding to a
/// velocity gradient. (With 1e-14, rigid flight made stresses of 1e-9 of Young's modulus.) Below, slopes of domains that
/// deform are differences of rounding, which over a mass of rounding make any velocity.
pub fn mass_cutoff<T: Float>() -> T {
    let rounding = T::of(64.0) * T::default_epsilon();
    rounding * rounding
}

/// What a stage is of, beside bodies and grid.
#[derive(Clone, Copy)]
pub(in crate::step) struct StageOf<T> {
    /// Time at the start of the step, s.
    pub(in crate::step) time: f64,
    /// Do stencils reach behind a plane that particles touch?
    pub(in crate::step) wide: bool,
    /// How much of the nodes' velocity particles take for their own: none with FLIP, all with PIC and its kin.
    pub(in crate::step) takes: T,
    /// Are forces at the nodes known, beside their momentum?
    pub(in crate::step) forces: bool,
    /// Time step, s.
    pub(in crate::step) dt: T,
}

/// One step's view of the grid for its stages.
pub struct GridStages<'a, T: Float, const D: usize> {
    /// The grid.
    pub grid: &'a mut dyn GridStorage<T, D>,
    /// Its bodies.
    pub bodies: &'a [Box<dyn GridBody<T, D>>],
    /// Its node blocks, by body where they are kept apart.
    pub fields: &'a Fields<D>,
    /// Threads.
    pub team: &'a Team,
    /// Conditions.
    pub conditions: &'a Conditions<D>,
    /// Books, one a block.
    pub books: &'a mut Vec<BlockBooks>,
    /// What is of no block alone: so that sums do not depend on which block is the first.
    pub scene_wide: &'a mut Exchange,
    /// Mass below which a node carries no momentum, kg.
    pub cutoff: T,
    /// Mass of the lightest particle, kg.
    pub lightest: T,
    /// What it is of.
    pub(in crate::step) of: StageOf<T>,
    /// The nodes at planes of symmetry, walls and fixed planes.
    pub planes: &'a mut Planes<T>,
    /// Is a body rigid?
    pub rigid: bool,
}

impl<T: Float, const D: usize> GridStages<'_, T, D> {
    /// The boundaries as seen from node blocks, beside which nodes and books can be written.
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
            blocks: fields.coordinates(),
            time: of.time,
            copies: if of.wide { 1.5 * lattice.spacing() } else { 0.0 },
        }
    }

    /// Sum the bodies' tiles (eqs. 2, 3, 9 of \[Ma2010\]): for each node block, bodies in order, the blocks
    /// around in order, so that the sums are the same for any number of threads and any grid. Then change every
    /// node as `update` says: at once, where no plane folds nodes in between.
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
        let all = self.moves(sums);
        // Of their nodes' velocity, particles of other scenes take nothing.
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
        for d in 0..3 {
            self.scene_wide.impulse[d] += impulse[d];
            // Where nodes know the sum of momentum and impulse alone, the weight works on what the particles mapped (see `Integrate`).
            if let Some(weight) = weight.filter(|_| !self.of.forces) {
                self.scene_wide.work -= 0.5 * self.of.dt.to_double() * weight[d] * of_first[d];
            }
        }
        self.each_node(sums, update);
    }

    /// What the records of the nodes give to the particles' momentum: first[i] and second[i] times this. A
    /// velocity smoothed by FMPM is taken off.
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

    /// Sum momentum; velocity, with boundaries, into the first record (USF).
    pub fn velocities(&mut self) {
        let (cutoff, time, takes, dt) = (self.cutoff, self.of.time, self.of.takes, self.of.dt);
        self.collect_and(NodeSums::All, &Velocities::<T, D> { cutoff, time, takes, dt });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum momentum; velocity, free of boundaries, into the first record.
    pub fn mean_velocities(&mut self) {
        self.collect_and(NodeSums::All, &MeanVelocities::<T, D> { cutoff: self.cutoff });
        self.planes.extrapolate(self.grid.nodes_mut());
        // Nothing has happened yet.
        self.books.iter_mut().for_each(|books| books.ledger = Exchange::default());
        *self.scene_wide = Exchange::default();
    }

    /// Sum momentum and force, or force alone beside the velocities there are; momentum update (eq. 8 of
    /// \[Ma2010\]): v = p/m + dt f/m with loads and boundaries. Leaves the new velocity in the first record, the
    /// acceleration in the second.
    pub fn integrate_momentum(&mut self, dt: T, from_velocity: bool) {
        let (cutoff, end) = (self.cutoff, self.of.time + dt.to_double());
        let gravity = self.conditions.gravity.as_ref().map(|g| g(self.of.time));
        let sums = if from_velocity { NodeSums::Force } else { NodeSums::All };
        let forces = self.of.forces;
        let update = Integrate::<T, D> { cutoff, dt, end, gravity, from_velocity, forces };
        self.collect_and(sums, &update);
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Local damping of what the velocities of nodes changed by in the step, contact and boundaries included ([`LocalDamping`]). Nodes of rigid
    /// bodies and of bodies of other solvers are left alone: their forces are not those at their nodes.
    pub fn damp(&mut self, dt: T) {
        let (cutoff, end) = (self.cutoff, self.of.time + dt.to_double());
        let gravity = self.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.of.time));
        let update = Damp::<T, D> { cutoff, dt, end, gravity, damping: self.conditions.damping };
        self.each_node_of(&update, &|body| body.rigid().is_none() && body.client().is_none());
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum the momentum mapped a second time; velocity, with boundaries, into the second record (MUSL).
    pub fn remap_velocities(&mut self, dt: T) {
        let (cutoff, end) = (self.cutoff, self.of.time + dt.to_double());
        self.collect_and(NodeSums::Again, &Remap::<T, D> { cutoff, end });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum the smoothed velocity; the next term of the FMPM series, d <- d - S~ d, added to the velocity, except
    /// where a boundary holds it. `terms` holds d, one a node.
    pub fn refine_velocities(&mut self, terms: &mut [[T; 3]]) {
        self.collect_and(NodeSums::Smoothed, &Leave);
        let cutoff = self.cutoff;
        let conditions = self.conditions;
        // As the momentum update constrained them: at the end of the step.
        let time = self.of.time + self.of.dt.to_double();
        let lattice = *self.grid.lattice();
        let copies = if self.of.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let blocks = self.fields.coordinates();
        let (bodies, fields, rigid) = (self.bodies, self.fields, self.rigid);
        let planes = &*self.planes;
        let mirrors = planes.copied();
        let nodes = self.grid.nodes();
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, terms, self.books, |block, mut terms, books| {
            if rigid && rigid_of(bodies, fields, block).is_some() {
                return;
            }
            let place = BlockPlace::new(&lattice, &blocks[block]);
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
                for d in 0..D {
                    let next = term[d] - node.second[d + 1] / mass;
                    let free = free[d] && !books.held.has(d, n);
                    term[d] = if free { next } else { T::default() };
                    if !free {
                        books.ledger.impulse[d] -= share * (mass * next).to_double();
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

    /// Note the velocities beside planes of symmetry, before others change them.
    pub fn note_velocities(&mut self) {
        self.planes.note_velocities(self.grid.nodes());
    }

    /// Have what nodes behind planes hold follow from those in front, which were changed.
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

    /// Give the nodes of rigid bodies the bodies' velocities, which no plane folds, and change every node as `update` says.
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

    /// Change nodes of bodies for which `counts` holds, and of those that bodies share.
    fn each_node_of(
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

/// The sums of what bodies map to a block.
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

/// Where the block is a rigid body's: give its nodes the body's velocities. Are they complete then?
fn carry<T: Float, const D: usize>(
    bodies: &[Box<dyn GridBody<T, D>>],
    fields: &Fields<D>,
    constraints: &Constraints<'_, T, D>,
    block: usize,
    sums: NodeSums,
    nodes: &mut Piece<'_, Node<T>>,
) -> bool {
    let Some(body) = rigid_of(bodies, fields, block) else { return false };
    let place = BlockPlace::new(&constraints.lattice, &constraints.blocks[block]);
    nodes::carry(body, sums, &place, nodes)
}

/// The boundaries as seen from node blocks.
struct Constraints<'a, T: Float, const D: usize> {
    boundaries: &'a [Boundary<D>],
    /// Beside these, nodes stand for their images, too: what happens to them is booked by their own mass.
    planes: &'a Planes<T>,
    layout: &'a Layout,
    bodies: &'a [Box<dyn GridBody<T, D>>],
    fields: &'a Fields<D>,
    lattice: Lattice<D>,
    blocks: &'a [[i32; D]],
    /// At the start of the step, s.
    time: f64,
    /// How far behind a mirror copies lie, m.
    copies: f64,
}

impl<T: Float, const D: usize> Constraints<'_, T, D> {
    /// Change the nodes of a block as `update` says.
    fn apply<U: NodeUpdate<T>>(
        &self,
        update: &U,
        block: usize,
        nodes: &mut Piece<'_, Node<T>>,
        books: &mut BlockBooks,
    ) {
        let BlockBooks { ledger, held } = books;
        let spacing = self.lattice.spacing();
        let reach = 2.0 * spacing;
        let place = BlockPlace::new(&self.lattice, &self.blocks[block]);
        let reaches = |b: &&Boundary<D>| b.reaches(&place.low, &place.high, self.time, reach);
        if !self.boundaries.iter().any(|b| reaches(&b)) {
            if U::HOLDS {
                *held = NodeSets::default();
            }
            update.update_free(nodes.items, ledger);
            return;
        }
        let body = self.bodies.get(self.fields.owner(block) as usize);
        let rigid = body.is_some_and(|b| b.rigid().is_some());
        // Particles meet walls one by one; matter whose stress is not on these nodes is stopped by the wall's impulse on them.
        let apart = body.is_none_or(|b| b.meets_surfaces().is_some());
        let reacts = |b: &&Boundary<D>| b.reacts() && !(apart && b.is_wall()) && !(rigid && stops_rigid(b));
        let reacting = self.boundaries.iter().filter(reaches).any(|b| reacts(&b));
        let held_before = *held;
        if U::HOLDS {
            *held = NodeSets::default();
        }
        let mirrors = self.planes.copied();
        let own = self.planes.own_masses(self.layout.start(block), nodes.items.len());
        let across = if rigid { [false; 3] } else { self.planes.mirrored_axes() };
        for (i, (n, node)) in nodes.numbered().enumerate() {
            let x = place.node(n);
            let share = own.share(i, node);
            let copy = share.is_none() && place.is_copy(n, mirrors);
            let held_now = std::array::from_fn(|d| held_before.has(d, n));
            let mut around = AtNode {
                of: self,
                place: &place,
                x,
                at: self.layout.start(block) + i,
                apart,
                rigid,
                reacting,
                weighed: if share.is_some() { across } else { [false; 3] },
                image: if reacting { place.image(n, mirrors) } else { [false; 3] },
                held: if U::HOLDS { [false; 3] } else { held_now },
            };
            if let Some(share) = share {
                let mut all = Exchange::default();
                update.update(node, &mut around, &mut all);
                add_share(ledger, share, &all);
            } else if copy {
                update.update(node, &mut around, &mut Exchange::default());
            } else {
                update.update(node, &mut around, ledger);
            }
            if U::HOLDS {
                (0..D).filter(|d| around.held[*d]).for_each(|d| held.set(d, n, true));
            }
        }
    }
}

/// The boundaries as seen from a node.
struct AtNode<'a, T: Float, const D: usize> {
    of: &'a Constraints<'a, T, D>,
    place: &'a BlockPlace<D>,
    /// Where the node is, m.
    x: [f64; D],
    /// Its place among all.
    at: usize,
    /// Do particles meet walls, and not these nodes?
    apart: bool,
    /// Is it a rigid body's, which planes stop as a whole?
    rigid: bool,
    /// The directions in which its weight is among its forces.
    weighed: [bool; 3],
    /// Does any condition react in this block?
    reacting: bool,
    /// The axes along which the node is the mirror image of one in front of a plane of symmetry.
    image: [bool; 3],
    /// The directions in which conditions that react hold the node.
    held: [bool; 3],
}

impl<T: Float, const D: usize> AtNode<'_, T, D> {
    /// The boundaries that reach the block, by their places.
    fn near(&self) -> impl Iterator<Item = (usize, &Boundary<D>)> {
        let (low, high) = (&self.place.low, &self.place.high);
        let (time, reach) = (self.of.time, 2.0 * self.of.lattice.spacing());
        let all = self.of.boundaries.iter().enumerate();
        let elsewhere = |b: &Boundary<D>| (self.apart && b.is_wall()) || (self.rigid && stops_rigid(b));
        all.filter(move |(_, b)| b.reaches(low, high, time, reach) && !elsewhere(b))
    }
    /// The place of the node, or of the one that it is the image of, and the signs of its vectors there.
    fn place(&self) -> ([f64; D], [f64; D]) {
        let (mut x, mut sign) = (self.x, [1.0; D]);
        for m in self.of.planes.copied().iter().filter(|m| self.image[m.axis]) {
            let (origin, h) = (self.of.lattice.origin()[m.axis], self.of.lattice.spacing());
            let plane = origin + f64::from(m.node) * h;
            if (x[m.axis] - plane) * f64::from(m.sign) < 0.0 {
                x[m.axis] = 2.0 * plane - x[m.axis];
                sign[m.axis] = -1.0;
            }
        }
        (x, sign)
    }
}

impl<T: Float, const D: usize> Around for AtNode<'_, T, D> {
    #[inline]
    fn constrain(&self, v: &mut [f64; 3], time: f64) -> bool {
        let before = *v;
        let tolerance = 1e-6 * self.of.lattice.spacing();
        for (_, b) in self.near() {
            b.constrain(&self.x, v, time, tolerance, self.of.copies);
        }
        *v != before
    }

    fn react(&mut self, trial: &Trial, v: &mut [f64; 3], takes: f64, ledger: &mut Exchange) -> bool {
        if !self.reacting {
            return false;
        }
        let (position, sign) = self.place();
        let spacing = self.of.lattice.spacing();
        let (mut any, mut held) = (false, self.held);
        for (n, b) in self.near().filter(|(_, b)| b.reacts()) {
            let (mut depth, mut tolerance) = (0.5 * spacing, 1e-6 * spacing);
            if b.surface().is_some() {
                let Some(share) = self.of.planes.depth(self.at, n) else { continue };
                (depth, tolerance) = (share, 1.5 * spacing);
            }
            let reaction = b.react(&Place {
                position,
                mass: trial.mass,
                depth,
                tolerance,
                start: trial.start.map(|start| std::array::from_fn(|d| sign[d] * start[d])),
                trial: std::array::from_fn(|d| sign[d] * v[d]),
                time: self.of.time,
                dt: trial.dt,
            });
            if reaction.is_none() {
                continue;
            }
            any = true;
            ledger.friction += if trial.only_held { 0.0 } else { reaction.heat };
            for d in (0..D).filter(|d| !trial.only_held || reaction.held[*d]) {
                let impulse = sign[d] * reaction.impulse[d];
                ledger.impulse[d] += takes * impulse;
                ledger.work += takes * reaction.impulse[d] * reaction.velocity[d];
                held[d] |= reaction.held[d];
                // To the bit, so that a place that is held stays.
                v[d] = if reaction.held[d] {
                    sign[d] * reaction.velocity[d]
                } else {
                    v[d] + impulse / trial.mass
                };
            }
        }
        self.held = held;
        any
    }

    fn held(&self) -> [bool; 3] {
        self.held
    }

    fn weighed(&self) -> [bool; 3] {
        self.weighed
    }
}

/// Does it stop free rigid bodies as a whole, where their surfaces reach it ([`crate::step::rigid::planes`]), and not their nodes?
pub(in crate::step) fn stops_rigid<const D: usize>(boundary: &Boundary<D>) -> bool {
    boundary.is_wall() || matches!(boundary, Boundary::Symmetry { .. } | Boundary::Fixed { .. })
}

/// Directions in which no boundary holds the node, walls that only push and conditions that react aside.
pub(in crate::step) fn free_directions<const D: usize>(
    conditions: &Conditions<D>,
    x: &[f64; D],
    time: f64,
    spacing: f64,
    copies: f64,
) -> [bool; 3] {
    let mut free = [true; 3];
    // A boundary that changes neither of two opposite probes in a direction leaves it free.
    for probe in [1e30, -1e30] {
        let before = [probe; 3];
        let mut v = before;
        for b in conditions.boundaries.iter().filter(|b| !b.is_wall()) {
            b.constrain(x, &mut v, time, 1e-6 * spacing, copies);
        }
        for d in 0..3 {
            free[d] &= v[d] == before[d];
        }
    }
    free
}
