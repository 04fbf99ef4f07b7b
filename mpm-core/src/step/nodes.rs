//! The grid stages: sums of the tiles, momentum update, boundaries, re-mapped velocities.

use crate::boundary::{BodyForce, Boundary, Plane};
use crate::dim::{BLOCK, block_nodes};
use crate::grid::{GridStorage, Node};
use crate::parallel::{Float, Team};

use super::body::Body;
use super::fields::Fields;
use super::tile::Sums;

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
    }
}

/// The conditions that act on the nodes of a scene.
#[derive(Clone, Default)]
pub struct Conditions<const D: usize> {
    /// Boundaries, applied in this order.
    pub boundaries: Vec<Boundary<D>>,
    /// Acceleration of all material.
    pub gravity: Option<BodyForce<D>>,
}

/// A node counts as massless below this part of the smallest particle mass: the square of the rounding unit.
/// A spline's slope is the root of its weight there, so that a node left out adds no more than rounding to a
/// velocity gradient. (With 1e-14, rigid flight made stresses of 1e-9 of Young's modulus.)
pub fn mass_cutoff<T: Float>() -> T {
    T::default_epsilon() * T::default_epsilon()
}

/// One step's view of the grid for its stages.
pub struct Stage<'a, T: Float, const D: usize, G> {
    /// The grid.
    pub grid: &'a mut G,
    /// Its bodies.
    pub bodies: &'a [Box<dyn Body<T, D>>],
    /// Its node blocks, by body where they are kept apart.
    pub fields: &'a Fields<D>,
    /// Threads.
    pub team: &'a Team,
    /// Conditions.
    pub conditions: &'a Conditions<D>,
    /// Ledgers, one a block.
    pub ledgers: &'a mut Vec<NodeLedger>,
    /// Time at the start of the step, s.
    pub time: f64,
    /// Mass below which a node carries no momentum, kg.
    pub cutoff: T,
    /// Do stencils reach behind a plane that particles touch?
    pub wide: bool,
    /// Is what lies behind a wall or fixed plane extrapolated ([`crate::BoundaryModified`])?
    pub modified: bool,
    /// Share of the nodes' velocity that particles take for theirs: 1; 0 where they keep theirs and add its change
    /// (FLIP).
    pub takes: T,
    /// Time step, s.
    pub dt: T,
}

impl<T: Float, const D: usize, G: GridStorage<T, D>> Stage<'_, T, D, G> {
    /// Sum the bodies' tiles (eqs. 2, 3, 9 of \[Ma2010\]): for each node block, bodies in order, the blocks
    /// around in order. The sums are the same for any number of threads and any grid.
    pub fn collect(&mut self, sums: Sums) {
        let (bodies, fields) = (self.bodies, self.fields);
        if sums == Sums::All {
            self.ledgers.clear();
            self.ledgers.resize(fields.len(), NodeLedger::default());
        }
        self.team.each_piece(self.grid.nodes_mut(), block_nodes(D), self.ledgers, |block, nodes, _| {
            for node in nodes.iter_mut() {
                match sums {
                    Sums::All => *node = Node::default(),
                    Sums::Force | Sums::Again => node.second = [T::default(); 4],
                }
            }
            for giver in fields.givers(block) {
                bodies[giver.body as usize].add_tiles(giver.local as usize, sums, nodes);
            }
        });
        let lattice = *self.grid.lattice();
        let (cutoff, takes, dt) = (self.cutoff, self.takes, self.dt);
        for mirror in self.conditions.boundaries.iter().filter_map(|b| b.mirror(&lattice)) {
            let axis = mirror.axis;
            let mut impulse = 0.0;
            self.columns(mirror, |nodes, [_, on, _]| {
                let Some(on) = on else { return };
                impulse += still(&mut nodes[on], axis, sums, takes, dt);
            });
            if self.wide {
                self.columns(mirror, |nodes, [front, _, back]| {
                    let (Some(front), Some(back)) = (front, back) else { return };
                    let before = [nodes[front], nodes[back]];
                    fold_mirrored(nodes, front, back, axis, sums);
                    if sums == Sums::All && nodes[front].first[0] > cutoff {
                        impulse += mirrored_impulse(&before, &nodes[front], axis, takes, dt);
                    }
                });
            }
            if let Some(ledger) = self.ledgers.first_mut() {
                ledger.impulse[axis] += impulse;
            }
        }
        self.close_slices(sums);
        for edge in self.edges() {
            self.columns(edge, |nodes, column| fold_extrapolated(nodes, column, sums));
        }
    }

    /// Between two symmetry planes one cell apart, what was folded in front of one lies on the other, where
    /// nothing crosses.
    fn close_slices(&mut self, sums: Sums) {
        let mirrors = self.mirrors();
        for mirror in &mirrors {
            let other = |m: &&Plane| m.axis == mirror.axis && m.node == mirror.node + mirror.sign;
            if mirrors.iter().find(other).is_none() {
                continue;
            }
            let across = 1 + mirror.axis;
            self.columns(*mirror, |nodes, [front, _, back]| {
                for node in [front, back].into_iter().flatten() {
                    if sums == Sums::All {
                        nodes[node].first[across] = T::default();
                    }
                    nodes[node].second[across] = T::default();
                }
            });
        }
    }

    /// Symmetry planes that stencils reach behind.
    pub(super) fn mirrors(&self) -> Vec<Plane> {
        let lattice = self.grid.lattice();
        let boundaries = if self.wide { &self.conditions.boundaries[..] } else { &[] };
        boundaries.iter().filter_map(|b| b.mirror(lattice)).collect()
    }

    /// Walls and fixed planes behind which velocities are extrapolated.
    fn edges(&self) -> Vec<Plane> {
        let lattice = self.grid.lattice();
        let boundaries = if self.wide && self.modified { &self.conditions.boundaries[..] } else { &[] };
        boundaries.iter().filter_map(|b| b.edge(lattice)).collect()
    }

    /// Visit the columns of three nodes in front of, on and behind a plane (where they exist, by index).
    fn columns(&mut self, plane: Plane, mut visit: impl FnMut(&mut [Node<T>], [Option<usize>; 3])) {
        let Plane { axis, node, sign } = plane;
        let layers = [node + sign, node, node - sign];
        let block_of = |layer: i32| layer.div_euclid(BLOCK as i32);
        let stride = BLOCK.pow(axis as u32);
        // Each column of a body once: by the block on the plane, or in front where that one does not exist.
        let fields = self.fields;
        let mut places: Vec<([i32; D], u32)> = Vec::new();
        for (block, c) in fields.coordinates().iter().enumerate() {
            if layers.iter().any(|&l| block_of(l) == c[axis]) {
                let mut place = *c;
                place[axis] = 0;
                places.push((place, fields.owner(block)));
            }
        }
        places.sort_unstable();
        places.dedup();
        for (place, owner) in places {
            let blocks = layers.map(|layer| {
                let mut c = place;
                c[axis] = block_of(layer);
                fields.find(&*self.grid, &c, owner)
            });
            let nodes = self.grid.nodes_mut();
            for n in (0..block_nodes(D)).filter(|n| (n / stride).is_multiple_of(BLOCK)) {
                let mut column = [None; 3];
                for i in 0..3 {
                    let within = layers[i].rem_euclid(BLOCK as i32) as usize * stride;
                    column[i] = blocks[i].map(|b| b * block_nodes(D) + n + within);
                }
                visit(nodes, column);
            }
        }
    }

    /// Give the nodes behind walls and fixed planes what the others extrapolate to.
    pub(super) fn extrapolate(&mut self) {
        for edge in self.edges() {
            self.columns(edge, |nodes, column| {
                if let [Some(front), Some(on), Some(back)] = column {
                    let two = T::of(2.0);
                    for d in 1..4 {
                        nodes[back].first[d] = two * nodes[on].first[d] - nodes[front].first[d];
                        nodes[back].second[d] = two * nodes[on].second[d] - nodes[front].second[d];
                    }
                }
            });
        }
    }

    /// Velocity of the mapped momentum, with boundaries, into the first record (USF).
    pub fn velocities(&mut self) {
        let (cutoff, time) = (self.cutoff, self.time);
        self.each_node(move |node, constrain, ledger| {
            let mass = node.first[0];
            if mass > cutoff {
                let mut v = [0.0; 3];
                for d in 0..D {
                    v[d] = (node.first[d + 1] / mass).to_double();
                }
                constrain(&mut v, time);
                for d in 0..D {
                    node.first[d + 1] = T::of(v[d]);
                }
            } else {
                drop_momentum::<T, D>(node, ledger, T::default());
            }
        });
        self.extrapolate();
    }

    /// Momentum update (eq. 8 of \[Ma2010\]): v = p/m + dt f/m with loads and boundaries. Leaves the new
    /// velocity in the first record, the acceleration in the second.
    pub fn integrate_momentum(&mut self, dt: T, from_velocity: bool) {
        let (cutoff, time) = (self.cutoff, self.time);
        let end = time + dt.to_double();
        let gravity = self.conditions.gravity.as_ref().map(|g| g(time));
        let per_dt = T::of(1.0) / dt;
        self.each_node(move |node, constrain, ledger| {
            let mass = node.first[0];
            if mass <= cutoff {
                drop_momentum::<T, D>(node, ledger, dt);
                return;
            }
            let per_mass = T::of(1.0) / mass;
            let (mut old, mut new) = ([T::default(); 3], [T::default(); 3]);
            for d in 0..D {
                old[d] = if from_velocity { node.first[d + 1] } else { node.first[d + 1] * per_mass };
                let mut a = node.second[d + 1] * per_mass;
                if let Some(g) = gravity {
                    a += T::of(g[d]);
                    ledger.load[d] += (mass * dt).to_double() * g[d];
                    let middle = (old[d] + a * dt).to_double() - 0.5 * dt.to_double() * g[d];
                    ledger.work += (mass * dt).to_double() * g[d] * middle;
                }
                new[d] = old[d] + a * dt;
                node.second[d + 1] = a;
            }
            let mut v = new.map(T::to_double);
            if constrain(&mut v, end) {
                for d in 0..D {
                    let impulse = mass.to_double() * (v[d] - new[d].to_double());
                    ledger.impulse[d] += impulse;
                    ledger.work += impulse * v[d];
                    new[d] = T::of(v[d]);
                    node.second[d + 1] = (new[d] - old[d]) * per_dt;
                }
            }
            node.first[1..=D].copy_from_slice(&new[..D]);
        });
        self.extrapolate();
    }

    /// Velocity of the momentum mapped a second time, with boundaries, into the second record (MUSL).
    pub fn remap_velocities(&mut self, dt: T) {
        let (cutoff, end) = (self.cutoff, self.time + dt.to_double());
        self.each_node(move |node, constrain, _| {
            let mass = node.first[0];
            let mut v = [0.0; 3];
            if mass > cutoff {
                for d in 0..D {
                    v[d] = (node.second[d + 1] / mass).to_double();
                }
                constrain(&mut v, end);
            }
            for d in 0..D {
                node.second[d + 1] = T::of(v[d]);
            }
        });
        self.extrapolate();
    }

    /// The next term of the FMPM series, d <- d - S~ d, added to the velocity. `terms` holds d, one a node.
    pub fn refine_velocities(&mut self, terms: &mut [[T; 3]]) {
        let cutoff = self.cutoff;
        let conditions = self.conditions;
        // As the momentum update constrained them: at the end of the step.
        let time = self.time + self.dt.to_double();
        let lattice = *self.grid.lattice();
        let copies = if self.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let blocks = self.fields.coordinates();
        let mut pieces: Vec<&mut [[T; 3]]> = terms.chunks_mut(block_nodes(D)).collect();
        self.team.each_piece(self.grid.nodes_mut(), block_nodes(D), &mut pieces, |block, nodes, terms| {
            let place = BlockPlace::new(&lattice, &blocks[block]);
            for (n, (node, term)) in nodes.iter_mut().zip(terms.iter_mut()).enumerate() {
                let mass = node.first[0];
                if mass <= cutoff {
                    continue;
                }
                let x = place.node(n);
                let free = free_directions(conditions, &x, time, lattice.spacing(), copies);
                for d in 0..D {
                    let smoothed = node.second[d + 1] / mass;
                    term[d] = if free[d] { term[d] - smoothed } else { T::default() };
                    node.first[d + 1] += term[d];
                    node.second[d + 1] = term[d];
                }
            }
        });
        self.extrapolate();
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

    /// `update` every node; it gets a function that makes a velocity obey the boundaries at a time and says
    /// whether any applies there.
    fn each_node<F>(&mut self, update: F)
    where
        F: Fn(&mut Node<T>, &dyn Fn(&mut [f64; 3], f64) -> bool, &mut NodeLedger) + Send + Sync,
    {
        let lattice = *self.grid.lattice();
        let blocks = self.fields.coordinates();
        let (conditions, time) = (self.conditions, self.time);
        let tolerance = 1e-6 * lattice.spacing();
        let copies = if self.wide { 1.5 * lattice.spacing() } else { 0.0 };
        // Nodes behind a mirror are copies: what happens to them is booked at their originals.
        let mirrors = self.mirrors();
        self.team.each_piece(self.grid.nodes_mut(), block_nodes(D), self.ledgers, |block, nodes, ledger| {
            let place = BlockPlace::new(&lattice, &blocks[block]);
            let reach = 2.0 * lattice.spacing();
            let near: Vec<&Boundary<D>> = conditions
                .boundaries
                .iter()
                .filter(|b| b.reaches(&place.low, &place.high, time, reach))
                .collect();
            for (n, node) in nodes.iter_mut().enumerate() {
                if near.is_empty() {
                    update(node, &|_, _| false, ledger);
                } else {
                    let x = place.node(n);
                    let constrain = |v: &mut [f64; 3], time: f64| {
                        let before = *v;
                        for b in &near {
                            b.constrain(&x, v, time, tolerance, copies);
                        }
                        *v != before
                    };
                    if place.is_copy(n, &mirrors) {
                        update(node, &constrain, &mut NodeLedger::default());
                    } else {
                        update(node, &constrain, ledger);
                    }
                }
            }
        });
    }
}

/// On a symmetry plane the other half of the body cancels what lies across the plane: momentum and force
/// vanish there before anything is divided or differenced. Returns the plane's impulse, what it cancelled, N s.
fn still<T: Float>(node: &mut Node<T>, axis: usize, sums: Sums, takes: T, dt: T) -> f64 {
    let mut impulse = 0.0;
    if sums == Sums::All {
        impulse -= (takes * node.first[1 + axis]).to_double();
        node.first[1 + axis] = T::default();
    }
    if sums != Sums::Again {
        impulse -= (node.second[1 + axis] * dt).to_double();
    }
    node.second[1 + axis] = T::default();
    impulse
}

/// The impulse of a symmetry plane through the nodes beside it, N s: what both layers give to the particles
/// less what the particles gave to them.
fn mirrored_impulse<T: Float>(
    [front, back]: &[Node<T>; 2],
    folded: &Node<T>,
    axis: usize,
    takes: T,
    dt: T,
) -> f64 {
    let mut had = (front.second[1 + axis] + back.second[1 + axis]) * dt;
    let mut has = folded.second[1 + axis] * dt;
    had += takes * (front.first[1 + axis] + back.first[1 + axis]);
    has += takes * folded.first[1 + axis];
    let share = (front.first[0] - back.first[0]) / folded.first[0];
    (share * has - had).to_double()
}

/// Add the node behind a symmetry plane, mirrored, to the one in front, and the other way round: what the
/// other half of the body would have given.
fn fold_mirrored<T: Float>(nodes: &mut [Node<T>], front: usize, back: usize, axis: usize, sums: Sums) {
    let reflect = |mut record: [T; 4]| {
        record[1 + axis] = -record[1 + axis];
        record
    };
    let sum = |a: [T; 4], b: [T; 4]| [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]];
    if sums == Sums::All {
        nodes[front].first = sum(nodes[front].first, reflect(nodes[back].first));
        nodes[back].first = reflect(nodes[front].first);
    }
    nodes[front].second = sum(nodes[front].second, reflect(nodes[back].second));
    nodes[back].second = reflect(nodes[front].second);
}

/// Give what was mapped behind an edge to the nodes that its velocity is extrapolated from: the adjoint of
/// v_back = 2 v_on - v_front. The basis then ends at the edge: at the edge's nodes it interpolates
/// (Steffen, Kirby, Berzins 2008).
fn fold_extrapolated<T: Float>(nodes: &mut [Node<T>], column: [Option<usize>; 3], sums: Sums) {
    let [Some(front), Some(on), Some(back)] = column else { return };
    let two = T::of(2.0);
    for i in 0..4 {
        if sums == Sums::All {
            let behind = std::mem::take(&mut nodes[back].first[i]);
            nodes[on].first[i] += two * behind;
            nodes[front].first[i] -= behind;
        }
        let behind = std::mem::take(&mut nodes[back].second[i]);
        nodes[on].second[i] += two * behind;
        nodes[front].second[i] -= behind;
    }
}

/// A node too light to divide by: its momentum leaves with a note.
fn drop_momentum<T: Float, const D: usize>(node: &mut Node<T>, ledger: &mut NodeLedger, dt: T) {
    for d in 0..D {
        ledger.dropped[d] += (node.first[d + 1] + dt * node.second[d + 1]).to_double();
        node.first[d + 1] = T::default();
        node.second[d + 1] = T::default();
    }
}

/// Directions in which no boundary holds the node.
fn free_directions<const D: usize>(
    conditions: &Conditions<D>,
    x: &[f64; D],
    time: f64,
    spacing: f64,
    copies: f64,
) -> [bool; 3] {
    let mut free = [true; 3];
    // A boundary that changes neither of two opposite probes in a direction leaves it free. They are faster than
    // any wall.
    for probe in [1e30, -1e30] {
        let before = [probe; 3];
        let mut v = before;
        for b in &conditions.boundaries {
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
    low: [f64; D],
    high: [f64; D],
    first: [i32; D],
    origin: [f64; D],
    spacing: f64,
}

impl<const D: usize> BlockPlace<D> {
    pub(super) fn new(lattice: &crate::geometry::Lattice<D>, block: &[i32; D]) -> Self {
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
