//! Bodies that meet: impulses between velocity fields at the nodes that several bodies share.
//!
//! The step calls [`Stage::meet`] where \[Ma2010\] 1.4 adjusts momenta and forces (iv, vii, x). It works in two
//! phases. First every shared block, on its own, asks the scene's [`Contact`] for the impulses at its nodes and
//! keeps them; nodes are only read. Then every field block adds its own impulses to its nodes. No task writes
//! what another reads, and all sums have a fixed order, so that results do not depend on threads.

use super::body::Body;
use super::fields::{Fields, Member};
use super::nodes::{BlockPlace, Stage};
use super::rigid::RigidState;
use super::rigid_body;
use super::survey::{Near, Survey};
use crate::boundary::Plane;
use crate::dim::{BLOCK, block_nodes};
use crate::geometry::Lattice;
use crate::grid::{GridStorage, Node};
use crate::parallel::Float;

/// How bodies meet. The crate `mpm-contact` has contact algorithms; [`OneField`] is none.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a contact algorithm",
    note = "`Mpm::with_contact` takes `OneField` or one of the crate `mpm-contact`"
)]
pub trait Contact<T: Float, const D: usize>: Send + Sync + 'static {
    /// Does every body have velocities of its own where it meets others?
    const SEPARATES: bool = true;
    /// Is contact also made in the velocities that only the strain is taken from: those of the mapped momentum
    /// with USF, those mapped a second time with MUSL? (Costs energy its balance: docs/notes.md 7.)
    fn corrects_strain(&self) -> bool {
        false
    }
    /// Impulses at the nodes of a block that several bodies share. Must depend on what `at` shows alone.
    fn impulses(&self, at: &SharedNodes<'_, T, D>, found: &mut Found<T>);
    /// Further impulses, those on free rigid bodies, which couple all blocks; called where the scene has any, with
    /// every block and what [`Contact::impulses`] left of it.
    fn couple(&self, _at: &[SharedNodes<'_, T, D>], _found: &mut [Found<T>]) {}
}

/// One velocity field for all bodies: they stick where they meet. Costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OneField;

impl<T: Float, const D: usize> Contact<T, D> for OneField {
    const SEPARATES: bool = false;
    fn impulses(&self, _at: &SharedNodes<'_, T, D>, _found: &mut Found<T>) {}
}

/// Which velocities meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// Those of the mapped momentum, before the stress update of USF.
    Momentum,
    /// The trial velocities of the momentum update: every body moved by its own forces.
    Trial,
    /// Those mapped a second time (MUSL).
    Remapped,
}

/// An impulse on a node of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeImpulse<T> {
    /// Which field of the block.
    pub field: usize,
    /// Which node of the block.
    pub node: usize,
    /// The impulse, N s.
    pub impulse: [T; 3],
}

/// A pair of bodies in contact at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeContact {
    /// The bodies, by number; the smaller first.
    pub bodies: [usize; 2],
    /// The node in its block.
    pub node: usize,
    /// Unit normal, from the first body to the second.
    pub normal: [f64; 3],
    /// Distance of the surfaces along it, m, where the detector measures it; negative if they overlap.
    pub gap: Option<f64>,
    /// Impulse on the second body, N s; the first gets its opposite.
    pub impulse: [f64; 3],
    /// Work of friction on the slip that is left at the end of the step, J.
    pub friction: f64,
    /// Kinetic energy of the nodes that the impulse took beside that, J.
    pub taken: f64,
}

/// Two fields that may touch at a node, while a contact algorithm looks at them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<T> {
    /// The node in its block.
    pub node: usize,
    /// The fields, the smaller first.
    pub fields: [usize; 2],
    /// Unit normal, from the first field to the second.
    pub normal: [T; 3],
    /// Distance of the surfaces along it, m, where it is measured.
    pub gap: Option<T>,
    /// Impulse on the second field, N s.
    pub impulse: [T; 3],
    /// Its next value, while pairs are solved together.
    pub next: [T; 3],
    /// Where the iteration looks from, likewise.
    pub ahead: [T; 3],
}

/// What a [`Contact`] finds at a shared block.
#[derive(Clone, Debug)]
pub struct Found<T> {
    /// Impulses on the fields, any order.
    pub impulses: Vec<NodeImpulse<T>>,
    /// The pairs they act between.
    pub contacts: Vec<NodeContact>,
    /// Memory for the contact algorithm, kept from step to step: candidates.
    pub touches: Vec<Touch<T>>,
    /// Likewise: numbers of nodes.
    pub scratch: Vec<[T; 4]>,
    /// Likewise: sets of nodes, a bit each.
    pub bits: Vec<u64>,
}

impl<T> Default for Found<T> {
    fn default() -> Self {
        Found {
            impulses: Vec::new(),
            contacts: Vec::new(),
            touches: Vec::new(),
            scratch: Vec::new(),
            bits: Vec::new(),
        }
    }
}

impl<T> Found<T> {
    fn clear(&mut self) {
        self.impulses.clear();
        self.contacts.clear();
    }
    fn bytes(&self) -> usize {
        self.impulses.capacity() * size_of::<NodeImpulse<T>>()
            + self.contacts.capacity() * size_of::<NodeContact>()
            + self.touches.capacity() * size_of::<Touch<T>>()
            + self.scratch.capacity() * size_of::<[T; 4]>()
            + self.bits.capacity() * size_of::<u64>()
    }
}

/// A pair of bodies in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The bodies, by number; the smaller first.
    pub bodies: [usize; 2],
    /// Contact force on the second body, N, mean of the step; the first feels its opposite.
    pub force: [f64; 3],
    /// Nodes in contact.
    pub nodes: usize,
    /// Smallest distance of the surfaces at those nodes, m, where the detector measures it.
    pub gap: Option<f64>,
    /// Energy dissipated by friction since the start, J.
    pub friction: f64,
    /// Kinetic energy of the nodes taken beside that since the start, J.
    pub taken: f64,
}

/// A node in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactNode {
    /// Position, m.
    pub position: [f64; 3],
    /// What meets there.
    pub contact: NodeContact,
}

/// What contact keeps from step to step.
#[derive(Clone, Debug)]
pub struct Encounters<T> {
    /// One a shared block.
    found: Vec<Found<T>>,
    pairs: Vec<PairContact>,
    nodes: Vec<ContactNode>,
}

impl<T> Default for Encounters<T> {
    fn default() -> Self {
        Encounters { found: Vec::new(), pairs: Vec::new(), nodes: Vec::new() }
    }
}

impl<T: Float> Encounters<T> {
    /// The pairs that were ever in contact, by number.
    pub(super) fn pairs(&self) -> &[PairContact] {
        &self.pairs
    }

    /// The nodes in contact in the last step.
    pub(super) fn nodes(&self) -> &[ContactNode] {
        &self.nodes
    }

    /// One list a shared block; the memory of blocks that went is used for those that came.
    pub(super) fn arrange(&mut self, shared: usize) {
        self.found.iter_mut().for_each(Found::clear);
        self.found.resize_with(shared, Found::default);
    }

    /// Book what the trial velocities met with: friction and what else contact took, J.
    fn book<const D: usize>(&mut self, fields: &Fields<D>, lattice: &Lattice<D>, dt: f64) -> [f64; 2] {
        for pair in &mut self.pairs {
            (pair.force, pair.nodes, pair.gap) = ([0.0; 3], 0, None);
        }
        self.nodes.clear();
        for (shared, found) in fields.shared().iter().zip(&self.found) {
            let place = BlockPlace::new(lattice, &shared.coordinates);
            for contact in &found.contacts {
                let mut position = [0.0; 3];
                position[..D].copy_from_slice(&place.node(contact.node));
                self.nodes.push(ContactNode { position, contact: *contact });
            }
        }
        let mut sums = [0.0; 2];
        for ContactNode { contact, .. } in &self.nodes {
            let place = match self.pairs.binary_search_by_key(&contact.bodies, |p| p.bodies) {
                Ok(place) => place,
                Err(place) => {
                    let bodies = contact.bodies;
                    let new = PairContact {
                        bodies,
                        force: [0.0; 3],
                        nodes: 0,
                        gap: None,
                        friction: 0.0,
                        taken: 0.0,
                    };
                    self.pairs.insert(place, new);
                    place
                }
            };
            let pair = &mut self.pairs[place];
            for d in 0..3 {
                pair.force[d] += contact.impulse[d] / dt;
            }
            pair.nodes += 1;
            pair.gap = match (pair.gap, contact.gap) {
                (Some(a), Some(b)) => Some(a.min(b)),
                (a, b) => a.or(b),
            };
            pair.friction += contact.friction;
            pair.taken += contact.taken;
            sums[0] += contact.friction;
            sums[1] += contact.taken;
        }
        sums
    }

    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.found.iter().map(Found::bytes).sum::<usize>()
            + self.found.capacity() * size_of::<Found<T>>()
            + self.pairs.capacity() * size_of::<PairContact>()
            + self.nodes.capacity() * size_of::<ContactNode>()
    }
}

/// The nodes of a block that several bodies share, as a [`Contact`] sees them.
pub struct SharedNodes<'a, T: Float, const D: usize> {
    nodes: &'a [Node<T>],
    members: &'a [Member],
    bodies: &'a [Box<dyn Body<T, D>>],
    fields: &'a Fields<D>,
    mirrors: &'a [Plane],
    wide: bool,
    place: BlockPlace<D>,
    coordinates: [i32; D],
    meeting: Meeting,
    spacing: f64,
    rigid: bool,
    cutoff: T,
    dt: T,
}

impl<T: Float, const D: usize> SharedNodes<'_, T, D> {
    /// Number of fields.
    pub fn fields(&self) -> usize {
        self.members.len()
    }
    /// Number of a field's body; fields are in the order of bodies.
    pub fn body(&self, field: usize) -> usize {
        self.members[field].body as usize
    }
    /// Nodes in the block.
    pub fn nodes(&self) -> usize {
        block_nodes(D)
    }
    /// Nodes where the field has mass, a bit each.
    pub fn occupied(&self, field: usize) -> u64 {
        let mut bits = 0;
        for (n, node) in self.of(field).iter().enumerate() {
            bits |= u64::from(node.first[0] > self.cutoff) << n;
        }
        bits
    }
    /// Is any body of the scene rigid?
    pub fn has_rigid(&self) -> bool {
        self.rigid
    }
    /// Place and motion of the field's body, if it is rigid.
    pub fn rigid(&self, field: usize) -> Option<&RigidState<D>> {
        self.bodies[self.body(field)].rigid()
    }
    /// Does the field's body move as prescribed, whatever meets it? Two of them have nothing to give to each other.
    pub fn is_prescribed(&self, field: usize) -> bool {
        self.members[field].prescribed
    }
    /// Mass of a field at a node, kg: infinite if the body's motion is prescribed. Of a free rigid body, the share of its
    /// mass that the node holds.
    pub fn mass(&self, field: usize, node: usize) -> T {
        if self.is_prescribed(field) { T::of(f64::INFINITY) } else { self.of(field)[node].first[0] }
    }
    /// Its velocity there, m/s.
    pub fn velocity(&self, field: usize, node: usize) -> [T; 3] {
        let node = &self.of(field)[node];
        let [_, x, y, z] = if self.meeting == Meeting::Remapped { node.second } else { node.first };
        [x, y, z]
    }
    /// Its velocity at the start of the step, m/s, before forces and contact; where momentum and impulse are
    /// mapped together, that is not known, and this is the trial velocity.
    pub fn old_velocity(&self, field: usize, node: usize) -> [T; 3] {
        let mut v = self.velocity(field, node);
        if self.meeting == Meeting::Trial {
            let a = self.of(field)[node].second;
            for d in 0..D {
                v[d] -= a[d + 1] * self.dt;
            }
        }
        v
    }
    /// Position of a node, m.
    pub fn position(&self, node: usize) -> [f64; D] {
        self.place.node(node)
    }
    /// Node spacing, m.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
    /// Time step, s.
    pub fn dt(&self) -> T {
        self.dt
    }
    /// Which velocities meet.
    pub fn meeting(&self) -> Meeting {
        self.meeting
    }
    /// Is the node the image of another behind a plane of symmetry?
    pub fn is_image(&self, node: usize) -> bool {
        self.wide && self.place.is_copy(node, self.mirrors)
    }

    /// Ask a field's particles about some nodes, a bit each; see [`Body::survey`]. What lies beyond planes of
    /// symmetry counts.
    pub fn survey(&self, field: usize, what: Survey, nodes: u64, normals: &[[T; 3]], out: &mut [[T; 3]]) {
        let member = self.members[field];
        let body = &self.bodies[member.body as usize];
        body.survey(member.local as usize, what, nodes, normals, out);
        for mirror in self.mirrors {
            self.mirror(mirror, member, what, nodes, normals, out);
        }
    }

    /// Call `visit` for every particle of a field near some nodes, a bit each, with the node.
    pub fn near(&self, field: usize, nodes: u64, visit: &mut dyn FnMut(usize, &Near<T>)) {
        let member = self.members[field];
        self.bodies[member.body as usize].near(member.local as usize, nodes, visit);
    }

    fn of(&self, field: usize) -> &[Node<T>] {
        &self.nodes[self.members[field].block as usize * block_nodes(D)..][..block_nodes(D)]
    }

    /// Add what the mirror image of the body would say.
    fn mirror(
        &self,
        mirror: &Plane,
        member: Member,
        what: Survey,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    ) {
        let (axis, block) = (mirror.axis, BLOCK as i32);
        let stride = BLOCK.pow(axis as u32);
        let vector = matches!(what, Survey::MassGradient | Survey::VolumeGradient);
        let largest = matches!(what, Survey::Reach | Survey::LocalReach | Survey::CentreReach);
        for layer in -1..=1 {
            let index = mirror.node + layer;
            if index.div_euclid(block) != self.coordinates[axis] {
                continue;
            }
            let within = index.rem_euclid(block) as usize;
            let mine = (0..block_nodes(D)).filter(|n| n / stride % BLOCK == within && nodes & (1 << n) != 0);
            if layer == 0 {
                // Both halves of the body give the same along the plane and cancel across it.
                if vector {
                    mine.for_each(|n| out[n][axis] = T::default());
                }
                continue;
            }
            if !self.wide {
                continue;
            }
            let image = mirror.node - layer;
            let mut at = self.coordinates;
            at[axis] = image.div_euclid(block);
            let Some(local) = self.fields.local(&at, member.body) else { continue };
            let there = |n: usize| n - within * stride + image.rem_euclid(block) as usize * stride;
            let mut bits = 0;
            let mut turned = [[T::default(); 3]; 64];
            let mut found = [[T::default(); 3]; 64];
            for n in mine.clone() {
                bits |= 1 << there(n);
                if let Some(normal) = normals.get(n) {
                    turned[there(n)] = *normal;
                    turned[there(n)][axis] = -normal[axis];
                }
                found[there(n)][0] = if largest { out[n][0] } else { T::default() };
            }
            self.bodies[member.body as usize].survey(local, what, bits, &turned, &mut found);
            for n in mine {
                let mut image = found[there(n)];
                if largest {
                    out[n][0] = image[0];
                    continue;
                }
                if vector {
                    image[axis] = -image[axis];
                }
                for d in 0..3 {
                    out[n][d] += image[d];
                }
            }
        }
    }
}

impl<T: Float, const D: usize, G: GridStorage<T, D>> Stage<'_, T, D, G> {
    /// Let the bodies meet at the nodes they share: contact impulses on the velocities of `meeting`, then
    /// boundaries again where any acted.
    pub fn meet<K: Contact<T, D>>(&mut self, contact: &K, meeting: Meeting, encounters: &mut Encounters<T>) {
        if !K::SEPARATES {
            return;
        }
        let alone = self.fields.shared().is_empty();
        if !alone {
            self.planes.note_velocities(self.grid.nodes());
            self.find_impulses(contact, meeting, encounters);
            self.add_impulses(meeting, encounters);
            self.copy_velocities(meeting);
        }
        if meeting == Meeting::Trial {
            let [friction, taken] = encounters.book(self.fields, self.grid.lattice(), self.dt.to_double());
            if let Some(ledger) = self.ledgers.first_mut() {
                ledger.friction += friction;
                ledger.contact += taken;
            }
        }
        if !alone {
            self.planes.extrapolate(self.grid.nodes_mut());
        }
    }

    /// Bring the velocities behind planes of symmetry after those in front.
    fn copy_velocities(&mut self, meeting: Meeting) {
        let impulse = self.planes.copy_velocities(self.grid.nodes_mut(), self.cutoff);
        if meeting == Meeting::Trial
            && let Some(ledger) = self.ledgers.first_mut()
        {
            (0..3).for_each(|d| ledger.impulse[d] += impulse[d]);
        }
    }

    fn find_impulses<K: Contact<T, D>>(
        &mut self,
        contact: &K,
        meeting: Meeting,
        encounters: &mut Encounters<T>,
    ) {
        let lattice = *self.grid.lattice();
        let mirrors = self.planes.mirrors();
        let (fields, bodies, nodes) = (self.fields, self.bodies, self.grid.nodes());
        let (wide, cutoff, dt, rigid) = (self.wide, self.cutoff, self.dt, self.rigid);
        let view = |s: usize| {
            let coordinates = fields.shared()[s].coordinates;
            SharedNodes {
                nodes,
                members: fields.members(s),
                bodies,
                fields,
                mirrors,
                wide,
                place: BlockPlace::new(&lattice, &coordinates),
                coordinates,
                meeting,
                spacing: lattice.spacing(),
                rigid,
                cutoff,
                dt,
            }
        };
        self.team.each(&mut encounters.found, |s, found| {
            found.clear();
            contact.impulses(&view(s), found);
        });
        if self.rigid {
            let all: Vec<SharedNodes<'_, T, D>> = (0..fields.shared().len()).map(view).collect();
            contact.couple(&all, &mut encounters.found);
        }
    }

    fn add_impulses(&mut self, meeting: Meeting, encounters: &Encounters<T>) {
        let lattice = *self.grid.lattice();
        let (bodies, fields, dt) = (self.bodies, self.fields, self.dt);
        let (conditions, time) = (self.conditions, self.time);
        let end = if meeting == Meeting::Momentum { time } else { time + dt.to_double() };
        let tolerance = 1e-6 * lattice.spacing();
        let copies = if self.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let mirrors = self.planes.copied();
        let per_dt = T::of(1.0) / dt;
        self.team.each_piece(self.grid.nodes_mut(), block_nodes(D), self.ledgers, |block, nodes, ledger| {
            let Some((shared, field)) = fields.field_of(block) else { return };
            let found = &encounters.found[shared];
            if found.impulses.is_empty() {
                return;
            }
            let place = BlockPlace::new(&lattice, &fields.coordinates()[block]);
            if fields.members(shared)[field].prescribed {
                let body = bodies[fields.owner(block) as usize].rigid();
                let real = found.impulses.iter().filter(|i| i.field == field);
                let real = real.filter(|i| meeting == Meeting::Trial && !place.is_copy(i.node, mirrors));
                for (given, body) in real.zip(body.into_iter().cycle()) {
                    rigid_body::book(body, &place.node(given.node), &given.impulse.map(T::to_double), ledger);
                }
                return;
            }
            let front = |i: &&NodeImpulse<T>| i.field == field && !place.is_copy(i.node, mirrors);
            for given in found.impulses.iter().filter(front) {
                let node = &mut nodes[given.node];
                let mass = node.first[0];
                let mut change = [T::default(); 3];
                let mut v = [0.0; 3];
                for d in 0..D {
                    change[d] = given.impulse[d] / mass;
                    let now = if meeting == Meeting::Remapped { node.second } else { node.first };
                    v[d] = (now[d + 1] + change[d]).to_double();
                }
                let free = v;
                let x = place.node(given.node);
                for b in &conditions.boundaries {
                    b.constrain(&x, &mut v, end, tolerance, copies);
                }
                for d in 0..D {
                    change[d] += T::of(v[d] - free[d]);
                    if meeting == Meeting::Remapped {
                        node.second[d + 1] += change[d];
                        continue;
                    }
                    node.first[d + 1] += change[d];
                    if meeting == Meeting::Momentum {
                        continue;
                    }
                    node.second[d + 1] += change[d] * per_dt;
                    if v[d] != free[d] {
                        let impulse = mass.to_double() * (v[d] - free[d]);
                        ledger.impulse[d] += impulse;
                        ledger.work += impulse * v[d];
                    }
                }
            }
        });
    }

    /// Take back what contact gave to the mapped momentum for the stress update (USF): the trial velocities
    /// start from the uncorrected ones, so that the friction limit of the step holds the whole impulse.
    pub fn part<K: Contact<T, D>>(&mut self, encounters: &Encounters<T>) {
        let (fields, mirrors, lattice) = (self.fields, self.planes.copied(), *self.grid.lattice());
        if !K::SEPARATES || fields.shared().is_empty() {
            return;
        }
        self.team.each_piece(self.grid.nodes_mut(), block_nodes(D), self.ledgers, |block, nodes, _| {
            let Some((shared, field)) = fields.field_of(block) else { return };
            if fields.members(shared)[field].prescribed {
                return;
            }
            let place = BlockPlace::new(&lattice, &fields.coordinates()[block]);
            let front = |i: &&NodeImpulse<T>| i.field == field && !place.is_copy(i.node, mirrors);
            for given in encounters.found[shared].impulses.iter().filter(front) {
                let node = &mut nodes[given.node];
                for d in 0..D {
                    node.first[d + 1] -= given.impulse[d] / node.first[0];
                }
            }
        });
        self.planes.copy_velocities(self.grid.nodes_mut(), self.cutoff);
    }
}
