//! The grid stages: sums of the tiles, momentum update, boundaries, re-mapped velocities.

use crate::boundary::{BodyForce, Boundary, Plane};
use crate::dim::{BLOCK, block_nodes};
use crate::geometry::Lattice;
use crate::grid::{GridStorage, Node};
use crate::parallel::{Float, Team};

use super::body::Body;
use super::fields::Fields;
use super::layout::{Layout, Piece};
use super::node_update::{Integrate, Leave, MeanVelocities, NodeUpdate, Remap, Velocities};
use super::planes::Planes;
use super::rigid::RigidState;
use super::rigid_body::{self, rigid_of};
use super::tile::Sums;
use super::walls::{Pressed, Walls};

/// What the grid stages of a step took from or gave to the momentum, a block of nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeLedger {
    /// Impulse of the boundaries on the material, N s.
    pub impulse: [f64; 3],
    /// Impulse of body forces, N s.
    pub load: [f64; 3],
    /// Work of boundaries (impulse times the boundary's velocity: none where it rests) and of body forces on
    /// the material, J.
    pub work: f64,
    /// Momentum at nodes too light to carry it, dropped, kg m/s.
    pub dropped: [f64; 3],
    /// Work of friction between bodies that slide, J: heat that no particle gets.
    pub friction: f64,
    /// Kinetic energy of the nodes that contact took beside that, J: where bodies meet, a node's velocities
    /// become one at once. Light nodes, whose velocities forces tear apart in every step, are counted in every
    /// step, so that this is more than what the particles lose.
    pub contact: f64,
    /// Kinetic energy of the motion within particles that came to light when they were split
    /// ([`Splitting`](super::Splitting)), J.
    pub split: f64,
}

impl NodeLedger {
    /// Add another one.
    pub fn add(&mut self, o: &NodeLedger) {
        for d in 0..3 {
            self.impulse[d] += o.impulse[d];
            self.load[d] += o.load[d];
            self.dropped[d] += o.dropped[d];
        }
        self.work += o.work;
        self.friction += o.friction;
        self.contact += o.contact;
        self.split += o.split;
    }

    /// Add a part of what became of a node.
    fn add_share(&mut self, share: f64, o: &NodeLedger) {
        for d in 0..3 {
            self.impulse[d] += share * o.impulse[d];
            self.load[d] += share * o.load[d];
            self.dropped[d] += share * o.dropped[d];
        }
        self.work += share * o.work;
    }
}

/// What is kept of a block of nodes beside the nodes.
#[derive(Clone, Copy, Debug, Default)]
pub struct BlockBooks {
    /// What its stages took or gave in a step.
    pub ledger: NodeLedger,
    /// Those that press on walls, from step to step.
    pub pressed: Pressed,
}

/// The conditions that act on the nodes of a scene.
#[derive(Clone, Default)]
pub struct Conditions<const D: usize> {
    /// Boundaries, applied in this order.
    pub boundaries: Vec<Boundary<D>>,
    /// Acceleration of all material.
    pub gravity: Option<BodyForce<D>>,
    /// Local damping coefficient; zero for none.
    pub damping: f64,
}

/// A node counts as massless below this part of the smallest particle mass: the square of the rounding unit.
/// A spline's slope is the root of its weight there, so that a node left out adds no more than rounding to a
/// velocity gradient. (With 1e-14, rigid flight made stresses of 1e-9 of Young's modulus.)
pub fn mass_cutoff<T: Float>() -> T {
    T::default_epsilon() * T::default_epsilon()
}

/// One step's view of the grid for its stages.
pub struct Stage<'a, T: Float, const D: usize> {
    /// The grid.
    pub grid: &'a mut dyn GridStorage<T, D>,
    /// Its bodies.
    pub bodies: &'a [Box<dyn Body<T, D>>],
    /// Its node blocks, by body where they are kept apart.
    pub fields: &'a Fields<D>,
    /// Threads.
    pub team: &'a Team,
    /// Conditions.
    pub conditions: &'a Conditions<D>,
    /// Books, one a block.
    pub books: &'a mut Vec<BlockBooks>,
    /// What is of no block alone: so that sums do not depend on which block is the first.
    pub together: &'a mut NodeLedger,
    /// Time at the start of the step, s.
    pub time: f64,
    /// Mass below which a node carries no momentum, kg.
    pub cutoff: T,
    /// Mass of the lightest particle, kg.
    pub lightest: T,
    /// Do stencils reach behind a plane that particles touch?
    pub wide: bool,
    /// How much of the nodes' velocity particles take for their own: none with FLIP, all with PIC and its kin.
    pub takes: T,
    /// Are forces at the nodes known, beside their momentum?
    pub forces: bool,
    /// Time step, s.
    pub dt: T,
    /// The nodes at planes of symmetry, walls and fixed planes.
    pub planes: &'a mut Planes<T>,
    /// Is a body rigid?
    pub rigid: bool,
}

/// The constraints of a stage, beside its grid and ledgers.
macro_rules! constraints {
    ($stage:expr) => {
        Constraints {
            boundaries: &$stage.conditions.boundaries,
            planes: &*$stage.planes,
            layout: $stage.fields.layout(),
            bodies: $stage.bodies,
            fields: $stage.fields,
            lattice: *$stage.grid.lattice(),
            blocks: $stage.fields.coordinates(),
            time: $stage.time,
            copies: if $stage.wide { 1.5 * $stage.grid.lattice().spacing() } else { 0.0 },
        }
    };
}

impl<T: Float, const D: usize> Stage<'_, T, D> {
    /// Sum the bodies' tiles (eqs. 2, 3, 9 of \[Ma2010\]): for each node block, bodies in order, the blocks
    /// around in order, so that the sums are the same for any number of threads and any grid. Then change every
    /// node as `update` says: at once, where no plane folds nodes in between.
    pub(super) fn collect_and(&mut self, sums: Sums, update: &impl NodeUpdate<T>) {
        let (bodies, fields) = (self.bodies, self.fields);
        if sums == Sums::All {
            self.books.resize(fields.len(), BlockBooks::default());
            self.books.iter_mut().for_each(|books| books.ledger = NodeLedger::default());
            *self.together = NodeLedger::default();
        }
        let constraints = constraints!(self);
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
            let complete = rigid && carry(bodies, fields, &constraints, block, sums, &mut nodes);
            if at_once && !complete {
                constraints.apply(update, block, &mut nodes, books);
            }
        });
        if at_once {
            return;
        }
        let all = self.moves(sums);
        // Of their nodes' velocity, particles of other scenes take nothing; bodies of prescribed motion take nothing at all.
        let elsewhere = |node: u32| {
            let owner = fields.owner(layout.block_of(node as usize)) as usize;
            match bodies.get(owner) {
                Some(body) if body.in_reference().is_some() => [T::default(), all[1]],
                Some(body) if body.rigid().is_some_and(RigidState::is_prescribed) => [T::default(); 2],
                _ => all,
            }
        };
        let ordinary = bodies.iter().all(|body| body.in_reference().is_none() && body.rigid().is_none());
        let moves = |node: u32| if ordinary { all } else { elsewhere(node) };
        let impulse = self.planes.fold(self.grid.nodes_mut(), sums, &moves, self.cutoff);
        for d in 0..3 {
            self.together.impulse[d] += impulse[d];
        }
        self.each_node(update);
    }

    /// What the records of the nodes give to the particles' momentum: first[i] and second[i] times this. A
    /// velocity smoothed by FMPM is taken off.
    fn moves(&self, sums: Sums) -> [T; 2] {
        let none = T::default();
        match sums {
            Sums::All => [self.takes, self.dt],
            Sums::Force => [none, self.dt],
            Sums::Smoothed => [none, T::of(-1.0)],
            Sums::Pushes => [none, T::of(1.0)],
            Sums::Again => [none, none],
        }
    }

    /// Sum momentum; velocity, with boundaries, into the first record (USF).
    pub fn velocities(&mut self) {
        let (cutoff, time, takes) = (self.cutoff, self.time, self.takes);
        self.collect_and(Sums::All, &Velocities::<T, D> { cutoff, time, takes });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum momentum; velocity, free of boundaries, into the first record.
    pub fn mean_velocities(&mut self) {
        self.collect_and(Sums::All, &MeanVelocities::<T, D> { cutoff: self.cutoff });
        self.planes.extrapolate(self.grid.nodes_mut());
        // Nothing has happened yet.
        self.books.iter_mut().for_each(|books| books.ledger = NodeLedger::default());
        *self.together = NodeLedger::default();
    }

    /// Sum momentum and force, or force alone beside the velocities there are; momentum update (eq. 8 of
    /// \[Ma2010\]): v = p/m + dt f/m with loads and boundaries. Leaves the new velocity in the first record, the
    /// acceleration in the second.
    pub fn integrate_momentum(&mut self, dt: T, from_velocity: bool) {
        let (cutoff, end) = (self.cutoff, self.time + dt.to_double());
        let gravity = self.conditions.gravity.as_ref().map(|g| g(self.time));
        let damping = self.conditions.damping;
        let sums = if from_velocity { Sums::Force } else { Sums::All };
        let (takes, forces) = (self.takes, self.forces);
        let update = Integrate::<T, D> { cutoff, dt, end, gravity, damping, from_velocity, takes, forces };
        self.collect_and(sums, &update);
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum the momentum mapped a second time; velocity, with boundaries, into the second record (MUSL).
    pub fn remap_velocities(&mut self, dt: T) {
        let (cutoff, end) = (self.cutoff, self.time + dt.to_double());
        self.collect_and(Sums::Again, &Remap::<T, D> { cutoff, end });
        self.planes.extrapolate(self.grid.nodes_mut());
    }

    /// Sum the smoothed velocity; the next term of the FMPM series, d <- d - S~ d, added to the velocity, except
    /// where a boundary holds it. `terms` holds d, one a node.
    pub fn refine_velocities(&mut self, terms: &mut [[T; 3]]) {
        self.collect_and(Sums::Smoothed, &Leave);
        let cutoff = self.cutoff;
        let conditions = self.conditions;
        // As the momentum update constrained them: at the end of the step.
        let time = self.time + self.dt.to_double();
        let lattice = *self.grid.lattice();
        let copies = if self.wide { 1.5 * lattice.spacing() } else { 0.0 };
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
                    let free = free[d] && !books.pressed.has(d, n);
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

    /// Start the FMPM series: d = v.
    pub fn first_terms(&mut self, terms: &mut Vec<[T; 3]>) {
        terms.clear();
        for node in self.grid.nodes_mut() {
            let v = [node.first[1], node.first[2], node.first[3]];
            node.second[1..].copy_from_slice(&v);
            terms.push(v);
        }
    }

    /// Change every node as `update` says.
    fn each_node(&mut self, update: &impl NodeUpdate<T>) {
        let constraints = constraints!(self);
        let (bodies, fields, rigid) = (self.bodies, self.fields, self.rigid);
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            if !(rigid && rigid_of(bodies, fields, block).is_some_and(RigidState::is_prescribed)) {
                constraints.apply(update, block, &mut nodes, books);
            }
        });
    }
}

/// The sums of what bodies map to a block.
fn sum_up<T: Float, const D: usize>(
    bodies: &[Box<dyn Body<T, D>>],
    fields: &Fields<D>,
    block: usize,
    sums: Sums,
    nodes: &mut [Node<T>],
) {
    match sums {
        Sums::All => nodes.fill(Node::default()),
        Sums::Force | Sums::Again | Sums::Smoothed | Sums::Pushes => {
            nodes.iter_mut().for_each(|n| n.second = [T::default(); 4]);
        }
    }
    for giver in fields.givers(block) {
        bodies[giver.body as usize].presence().add_tiles(giver.local as usize, sums, nodes);
    }
}

/// Where the block is a rigid body's: give its nodes the body's velocities. Are they complete then?
fn carry<T: Float, const D: usize>(
    bodies: &[Box<dyn Body<T, D>>],
    fields: &Fields<D>,
    constraints: &Constraints<'_, T, D>,
    block: usize,
    sums: Sums,
    nodes: &mut Piece<'_, Node<T>>,
) -> bool {
    let Some(body) = rigid_of(bodies, fields, block) else { return false };
    let place = BlockPlace::new(&constraints.lattice, &constraints.blocks[block]);
    rigid_body::carry(body, sums, &place, nodes)
}

/// The boundaries as seen from node blocks.
struct Constraints<'a, T: Float, const D: usize> {
    boundaries: &'a [Boundary<D>],
    /// Beside these, nodes stand for their images, too: what happens to them is booked by their own mass.
    planes: &'a Planes<T>,
    layout: &'a Layout,
    bodies: &'a [Box<dyn Body<T, D>>],
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
        let BlockBooks { ledger, pressed } = books;
        let spacing = self.lattice.spacing();
        let (reach, tolerance) = (2.0 * spacing, 1e-6 * spacing);
        let place = BlockPlace::new(&self.lattice, &self.blocks[block]);
        let reaches = |b: &&Boundary<D>| b.reaches(&place.low, &place.high, self.time, reach);
        if !self.boundaries.iter().any(|b| reaches(&b)) {
            if U::PRESSES {
                *pressed = Pressed::default();
            }
            update.update_free(nodes.items, ledger);
            return;
        }
        // Matter whose stress is not on these nodes is stopped by the wall's impulse alone.
        let body = self.bodies.get(self.fields.owner(block) as usize);
        let unstressed = body.is_some_and(|b| b.rigid().is_some() || b.in_reference().is_some());
        let near = || self.boundaries.iter().filter(reaches);
        let mut walls = if unstressed { Walls::default() } else { Walls::of(near(), self.time) };
        let apart = !walls.is_empty();
        let others = |b: &&Boundary<D>| !(apart && matches!(b, Boundary::Wall { .. }));
        let before = *pressed;
        if U::PRESSES {
            *pressed = Pressed::default();
        }
        let mirrors = self.planes.copied();
        let own = self.planes.own_masses(self.layout.start(block), nodes.items.len());
        for (i, (n, node)) in nodes.numbered().enumerate() {
            let x = place.node(n);
            walls.look_at(n, &x, &before, tolerance);
            let constrain = |v: &mut [f64; 3], time: f64| {
                let before = *v;
                for b in self.boundaries.iter().filter(reaches).filter(others) {
                    b.constrain(&x, v, time, tolerance, self.copies);
                }
                *v != before
            };
            if let Some(share) = own.share(i, node) {
                let mut all = NodeLedger::default();
                update.update(node, &mut walls, &constrain, &mut all);
                ledger.add_share(share, &all);
            } else if place.is_copy(n, mirrors) {
                update.update(node, &mut walls, &constrain, &mut NodeLedger::default());
            } else {
                update.update(node, &mut walls, &constrain, ledger);
            }
            if U::PRESSES {
                walls.iter().filter(|wall| wall.pressed).for_each(|wall| pressed.set(wall.axis, n, true));
            }
        }
    }
}

/// Directions in which no boundary holds the node, walls that only push aside.
pub(super) fn free_directions<const D: usize>(
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
        for b in conditions.boundaries.iter().filter(|b| !matches!(b, Boundary::Wall { .. })) {
            b.constrain(x, &mut v, time, 1e-6 * spacing, copies);
        }
        for d in 0..3 {
            free[d] &= v[d] == before[d];
        }
    }
    free
}

/// Positions of the nodes of a block.
pub(super) struct BlockPlace<const D: usize> {
    pub(super) low: [f64; D],
    pub(super) high: [f64; D],
    first: [i32; D],
    origin: [f64; D],
    spacing: f64,
}

impl<const D: usize> BlockPlace<D> {
    pub(super) fn new(lattice: &Lattice<D>, block: &[i32; D]) -> Self {
        let (origin, spacing) = (lattice.origin(), lattice.spacing());
        let first = block.map(|b| b * BLOCK as i32);
        let mut low = origin;
        let mut high = origin;
        for d in 0..D {
            low[d] += f64::from(first[d]) * spacing;
            high[d] += f64::from(first[d] + BLOCK as i32 - 1) * spacing;
        }
        BlockPlace { low, high, first, origin, spacing }
    }
    pub(super) fn is_copy(&self, n: usize, mirrors: &[Plane]) -> bool {
        mirrors.iter().any(|m| {
            let index = self.first[m.axis] + (n / BLOCK.pow(m.axis as u32) % BLOCK) as i32;
            (index - m.node) * m.sign < 0
        })
    }
    pub(super) fn node(&self, n: usize) -> [f64; D] {
        let mut x = self.origin;
        let mut rest = n;
        for d in 0..D {
            x[d] += f64::from(self.first[d] + (rest % BLOCK) as i32) * self.spacing;
            rest /= BLOCK;
        }
        x
    }
}
