//! Contact algorithm of the grid: normals, detection, contact laws.

use impactite_simd::Float;
use mpm_contact::vector::{difference, dot, length, sum, times};
use mpm_contact::{
    Contact, ContactDetector, ContactLaw, Criterion, FieldPoints, Memory, Nodal, NormalRule, Outcome, Pairs,
    Remembers, SurfaceQuantity, each_place,
};
use mpm_materials::{Check, ParameterError};

use super::free_rigid::{Coupled, Coupling};
use super::node_impulses::{LawCall, find_impulses, total};
use super::{BlockContacts, ContactPhase, Pair, PlaneTouch, Scratch, SharedNodes, Touch, TouchMemory};

/// Largest motion of bodies, in cells, before normals and gaps are updated: well below the errors of either (book,
/// "Detection and normals"; book, "A pack of balls under a plate"). The value avoids exact hits by sums of equal steps.
const KEEPS: f64 = 1.03e-3;

/// Largest gap, in cells, of contact laws with tension: half a particle of the default filling. Initial contacts are closed
/// to within rounding and half a strained particle.
const HOLDS: f64 = 0.25;

/// Contact of any number of bodies at shared nodes: a detector and the laws of the pairs, from `mpm-contact` or
/// user-defined ([`ContactLaw`], [`mpm_contact::PairDetector`]). State variables of laws move with the bodies
/// ([`Remembers`]); without any, nothing is stored.
///
/// ```
/// use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
/// use mpm_core::geometry::Lattice;
/// use mpm_core::{BlockGrid, Flip, GridContact, Linear, Method, Mpm, Musl, PlaneStrain};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let method = Method::new(Linear, Flip, Musl, PlaneStrain);
/// let grid = BlockGrid::new(Lattice::new([0.0; 2], 0.01)?);
/// let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3)?));
/// let mpm = Mpm::with_contact(method, grid, contact);
/// # assert!(mpm.contacts().is_empty());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct GridContact<S, T> {
    detector: S,
    laws: Pairs<T>,
    strain: bool,
    keeps: f64,
    /// Number of state variables of a contact.
    remembers: usize,
}

impl<S, T: Float> GridContact<S, T> {
    /// Create the algorithm from a detector and laws.
    pub fn new(detector: S, laws: Pairs<T>) -> Self {
        let remembers = laws.remembered_numbers();
        GridContact { detector, laws, strain: false, keeps: KEEPS, remembers }
    }
    /// Also correct the velocities of the strain increment (before the stress update of USF, after the second mapping of
    /// MUSL), as the flow chart of \[Ma2010\] does. Impacts then gain energy, since the strain includes a motion that the
    /// particles do not make (book, "Contact on the grid").
    #[must_use]
    pub fn with_strain_corrected(mut self) -> Self {
        self.strain = true;
        self
    }
    /// Update normals and gaps once bodies may have moved by this many cells (1e-3 by default); zero: in every step.
    /// Detectors that depend on more than particle positions ([`Criterion::State`]) update in every step.
    ///
    /// # Errors
    /// A negative number, or more than 0.1.
    pub fn keeping(mut self, cells: f64) -> Result<Self, ParameterError> {
        self.keeps =
            Check("grid contact").that((0.0..=0.1).contains(&cells), "keeping", cells, "0 to 0.1")?;
        Ok(self)
    }
    /// Contact laws of the pairs.
    pub fn laws(&self) -> &Pairs<T> {
        &self.laws
    }
}

impl<S, T, const D: usize> super::ContactAlgorithm<T, D> for GridContact<S, T>
where
    T: Float,
    S: ContactDetector<T, D>,
{
    fn corrects_strain(&self) -> bool {
        self.strain
    }
    fn keeps(&self, spacing: f64) -> f64 {
        if self.detector.criterion(spacing) == Criterion::State { 0.0 } else { self.keeps * spacing }
    }
    fn remembers(&self) -> usize {
        self.remembers
    }

    fn impulses(&self, at: &SharedNodes<'_, T, D>, found: &mut BlockContacts<T>, scratch: &mut Scratch<T>) {
        let Scratch { numbers, bits, vectors, points } = scratch;
        let crowded = share(at, bits);
        if bits.iter().all(|&nodes| nodes == 0) {
            found.pairs.clear();
            found.touches.clear();
            return;
        }
        self.look(at, found, bits, (numbers, points), crowded);
        let (zero, criterion) = ([T::of(0.0); 3], self.detector.criterion(at.spacing()));
        for touch in &mut found.touches {
            let Pair { fields, bodies, .. } = &found.pairs[touch.pair as usize];
            let law = self.laws.law(bodies[0] as usize, bodies[1] as usize);
            let (parting, limit) = (acts_on_parting(law), T::of(furthest(law, criterion, at.spacing())));
            let closes = || approach(at, fields, touch.node, touch.normal);
            touch.acts =
                touch.gap.is_none_or(|gap| gap <= limit) && (parting || has(crowded, touch.node) || closes());
            touch.impulse = zero;
        }
        found.pairs.iter_mut().for_each(|p| (p.friction, p.taken) = (0.0, 0.0));
        if self.remembers > 0 {
            for pair in &mut found.pairs {
                pair.remembers = remembers(self.laws.law(pair.bodies[0] as usize, pair.bodies[1] as usize));
            }
            at.recall(found, self.remembers);
        }
        let BlockContacts { pairs, touches, memory, .. } = found;
        let mut first = 0;
        for touches in touches.chunk_by_mut(|a, b| a.node == b.node) {
            if !couples(at, pairs, touches) {
                let call = |n: usize, t: &Touch<T>| self.law_call(at, pairs, t, memory.start(first + n));
                find_impulses(touches, |t| fields(pairs, t), call, vectors);
                self.book(at, touches, pairs, Some((memory, first)), |pairs, touches, f, part| {
                    moved(at, pairs, touches, f, part)
                });
            }
            first += touches.len();
        }
    }

    fn couple(
        &self,
        at: &[SharedNodes<'_, T, D>],
        found: &mut [BlockContacts<T>],
        planes: &mut [PlaneTouch<'_, D>],
    ) {
        // State variables for the laws, copied since the originals are written.
        let remembered: Vec<TouchMemory> =
            if self.remembers > 0 { found.iter().map(|f| f.memory.clone()).collect() } else { Vec::new() };
        let mut couplings = Vec::new();
        for (block, (at, found)) in at.iter().zip(found.iter()).enumerate() {
            let mut first = 0;
            for touches in found.touches.chunk_by(|a, b| a.node == b.node) {
                let coupled = couples(at, &found.pairs, touches);
                for (n, touch) in touches.iter().enumerate().filter(|(_, t)| coupled && t.acts && !t.image) {
                    let memory = remembered.get(block).map_or(&[][..], |m| m.start(first + n));
                    let call = self.law_call(at, &found.pairs, touch, memory);
                    couplings.push(Coupling::new(block, at, *touch, fields(&found.pairs, touch), call));
                }
                first += touches.len();
            }
        }
        let solved = Coupled::solve(at, couplings, planes);
        for (block, node, impulses) in solved.nodes() {
            let BlockContacts { pairs, touches, .. } = &mut found[block];
            let first = touches.partition_point(|t| t.node < node);
            let count = touches[first..].partition_point(|t| t.node == node);
            let touches = &mut touches[first..first + count];
            let acting = touches.iter_mut().filter(|t| t.acts);
            acting.zip(impulses).for_each(|(touch, impulse)| touch.impulse = impulse);
            self.book(&at[block], touches, pairs, None, |_, _, field, part| {
                solved.moved(at, block, node, field, part)
            });
        }
        if self.remembers == 0 {
            return;
        }
        // Update contacts without an impulse, too: a rigid body also moves there.
        for (block, found) in found.iter_mut().enumerate() {
            let BlockContacts { pairs, touches, memory, .. } = found;
            let mut first = 0;
            for touches in touches.chunk_by(|a, b| a.node == b.node) {
                let coupled = couples(&at[block], pairs, touches);
                for (n, touch) in touches.iter().enumerate().filter(|_| coupled) {
                    let node = touch.node as usize;
                    let after = fields(pairs, touch).map(|field| solved.after(at, block, node, field));
                    self.remember(&at[block], pairs, touch, (memory, first + n), after);
                }
                first += touches.len();
            }
        }
    }
}

/// Return true if the node is in the set.
fn has(nodes: u64, node: u8) -> bool {
    nodes >> node & 1 != 0
}

fn fields<T>(pairs: &[Pair], touch: &Touch<T>) -> [usize; 2] {
    pairs[touch.pair as usize].fields.map(|f| f as usize)
}

/// Return true if the law has state variables.
fn remembers<T: Float>(law: &dyn ContactLaw<T>) -> bool {
    law.remembers() != Remembers::Nothing
}

/// Return true if the law acts on separating bodies, too.
fn acts_on_parting<T: Float>(law: &dyn ContactLaw<T>) -> bool {
    law.pulls() || law.springs()
}

/// Return the largest gap, m, at which a law acts on bodies, for cells of `spacing`, m.
fn furthest<T: Float>(law: &dyn ContactLaw<T>, criterion: Criterion, spacing: f64) -> f64 {
    let Criterion::Gap(limit) = criterion else { return f64::INFINITY };
    if law.pulls() { limit + HOLDS * spacing } else { limit }
}

/// Return true if the two fields approach each other at a node: (v_r - v_s) . n > 0 (eq. 4 of \[Ma2010\]).
fn approach<T: Float, const D: usize>(
    at: &SharedNodes<'_, T, D>,
    fields: &[u32; 2],
    node: u8,
    normal: [T; 3],
) -> bool {
    let velocity = |side: usize| at.velocity(fields[side] as usize, node as usize);
    dot(difference(velocity(0), velocity(1)), normal) > T::of(0.0)
}

/// Return true if a free rigid body is in contact at the node; all its nodes are then solved together.
fn couples<T: Float, const D: usize>(
    at: &SharedNodes<'_, T, D>,
    pairs: &[Pair],
    touches: &[Touch<T>],
) -> bool {
    let free = |field: usize| !at.is_prescribed(field) && at.rigid(field).is_some();
    at.has_rigid() && touches.iter().any(|t| fields(pairs, t).into_iter().any(free))
}

/// Fill `bits` with the shared nodes of each field. Returns the nodes shared by three or more fields.
fn share<T: Float, const D: usize>(at: &SharedNodes<'_, T, D>, bits: &mut Vec<u64>) -> u64 {
    bits.clear();
    let (mut one, mut two, mut three) = (0, 0, 0);
    for field in 0..at.fields() {
        let nodes = at.occupied(field);
        bits.push(nodes);
        three |= two & nodes;
        two |= one & nodes;
        one |= nodes;
    }
    bits.iter_mut().for_each(|nodes| *nodes &= two);
    three
}

impl<S, T: Float> GridContact<S, T> {
    /// Detect contact at nodes without known contact status; `shared` are the nodes that each field shares with others.
    ///
    /// For bodies that move far in every step, only nodes with approaching velocities are checked. All nodes are checked
    /// for slow bodies, whose result is reused, and for laws that act on separating bodies or have state variables.
    fn look<const D: usize>(
        &self,
        at: &SharedNodes<'_, T, D>,
        found: &mut BlockContacts<T>,
        shared: &mut Vec<u64>,
        (numbers, points): (&mut Vec<[T; 4]>, &mut FieldPoints),
        crowded: u64,
    ) where
        S: ContactDetector<T, D>,
    {
        let fields = at.fields();
        let both = |shared: &[u64], r: usize, s: usize| {
            if at.is_prescribed(r) && at.is_prescribed(s) { 0 } else { shared[r] & shared[s] }
        };
        for pair in &mut found.pairs {
            pair.known &= both(shared, pair.fields[0] as usize, pair.fields[1] as usize);
        }
        found.touches.retain(|t| has(found.pairs[t.pair as usize].known, t.node));
        shared.resize(2 * fields, 0);
        for r in 0..fields {
            for s in r + 1..fields {
                let unknown = both(shared, r, s) & !known(&found.pairs, r, s);
                shared[fields + r] |= unknown;
                shared[fields + s] |= unknown;
            }
        }
        let (shared, unknown) = shared.split_at(fields);
        if unknown.iter().all(|&nodes| nodes == 0) {
            return;
        }
        numbers.clear();
        let mut memory = Memory { numbers, points, nodes: unknown };
        self.detector.normals().prepare(at, &mut memory);
        let before = found.touches.len();
        for r in 0..fields {
            for s in r + 1..fields {
                let nodes = both(shared, r, s) & !known(&found.pairs, r, s);
                if nodes != 0 {
                    self.look_at(at, [r, s], nodes, &memory, crowded, found);
                }
            }
        }
        if found.touches.len() > before {
            let BlockContacts { pairs, touches, .. } = found;
            touches.sort_unstable_by_key(|t| (t.node, pairs[t.pair as usize].fields));
        }
    }

    /// Detect the contact of a pair at `nodes`.
    fn look_at<const D: usize>(
        &self,
        at: &SharedNodes<'_, T, D>,
        pair: [usize; 2],
        nodes: u64,
        memory: &Memory<'_, T>,
        crowded: u64,
        found: &mut BlockContacts<T>,
    ) where
        S: ContactDetector<T, D>,
    {
        let zero = [T::of(0.0); 3];
        let mut normals: Nodal<[T; 3]> = [zero; 64];
        let mut gaps: Nodal<Option<T>> = [None; 64];
        let bodies = pair.map(|f| at.body(f));
        let fields = pair.map(|f| f as u32);
        let law = self.laws.law(bodies[0], bodies[1]);
        let criterion = self.detector.criterion(at.spacing());
        // Largest gap of nodes that are in contact or may come into contact before the next update.
        let gap = match criterion {
            Criterion::Gap(_) => furthest(law, criterion, at.spacing()) + self.keeps * at.spacing(),
            Criterion::State | Criterion::Always => f64::INFINITY,
        };
        let gap_of_surfaces = if self.detector.measures_surfaces() { gap } else { f64::INFINITY };
        let rule = self.detector.normals();
        let asked = rule.normals_within(at, pair, nodes, gap_of_surfaces, memory, &mut normals);
        let mut nodes = asked.found;
        let place = found.pairs.iter().position(|p| p.fields == fields).unwrap_or_else(|| {
            found.pairs.push(Pair::new(fields, bodies.map(|b| b as u32)));
            found.pairs.len() - 1
        });
        let all = found.pairs[place].lasts || acts_on_parting(law) || remembers(law);
        if all {
            // Bodies that are apart do not meet before the next update.
            found.pairs[place].known |= asked.apart;
        } else {
            let closes = |n: &usize| has(crowded, *n as u8) || approach(at, &fields, *n as u8, normals[*n]);
            nodes = each_place(nodes).filter(closes).fold(0, |bits, n| bits | 1 << n);
        }
        if nodes == 0 {
            return;
        }
        let mut touching = self.detector.touching(at, pair, nodes, &normals, &mut gaps);
        if let Criterion::Gap(_) = criterion {
            let limit = T::of(gap);
            let near = |n: &usize| gaps[*n].is_some_and(|gap| gap <= limit);
            touching |= each_place(nodes).filter(near).fold(0, |bits, n| bits | 1 << n);
        }
        found.pairs[place].known |= nodes;
        found.touches.extend(each_place(touching).map(|node| Touch {
            node: node as u8,
            acts: false,
            image: at.is_image(node),
            pair: place as u32,
            normal: normals[node],
            gap: gaps[node],
            impulse: zero,
        }));
    }

    /// Assemble the arguments of the law of a touch; `remembered` are its state variables.
    fn law_call<'a, const D: usize>(
        &'a self,
        at: &SharedNodes<'_, T, D>,
        pairs: &[Pair],
        touch: &Touch<T>,
        remembered: &'a [f64],
    ) -> LawCall<'a, T> {
        let Pair { fields, bodies, .. } = pairs[touch.pair as usize];
        let law = self.laws.law(bodies[0] as usize, bodies[1] as usize);
        let (fields, node) = (fields.map(|f| f as usize), touch.node as usize);
        let mut position = [0.0; 3];
        position[..D].copy_from_slice(&at.position(node));
        let (slip, memory) = match remembered.split_first() {
            Some((slip, own)) => (T::of(*slip), &own[..law.remembers().numbers().saturating_sub(1)]),
            None => (T::of(0.0), &[][..]),
        };
        let contact = Contact {
            bodies: bodies.map(|b| b as usize),
            position,
            time: at.time(),
            dt: at.dt(),
            normal: touch.normal,
            gap: touch.gap,
            area: if law.needs_area() { area(at, fields, node) } else { T::of(0.0) },
            masses: fields.map(|f| at.mass(f, node)),
            velocities: trial(at, fields, touch, acts_on_parting(law)),
            slip,
            memory,
        };
        LawCall { law, contact }
    }

    /// Record the energies of the impulses at one node by pair, update the gaps and, if given, advance the contact memory
    /// of the block, with the index of the node's first touch, to the end of the step. `moved` returns the velocity of a
    /// field after a fraction of its impulses.
    fn book<const D: usize>(
        &self,
        at: &SharedNodes<'_, T, D>,
        touches: &mut [Touch<T>],
        pairs: &mut [Pair],
        mut memory: Option<(&mut TouchMemory, usize)>,
        moved: impl Fn(&[Pair], &[Touch<T>], usize, f64) -> [T; 3],
    ) {
        if at.phase() != ContactPhase::Trial {
            return;
        }
        for t in 0..touches.len() {
            let touch = touches[t];
            let [r, s] = fields(pairs, &touch);
            let after = [moved(pairs, touches, r, 1.0), moved(pairs, touches, s, 1.0)];
            let slip = difference(after[0], after[1]);
            let closing = dot(slip, touch.normal);
            touches[t].gap = touch.gap.map(|gap| gap - closing * at.dt());
            if let Some((memory, first)) = &mut memory {
                self.remember(at, pairs, &touch, (memory, *first + t), after);
            }
            if touch.image || touch.impulse.iter().all(|&x| x == T::of(0.0)) {
                continue;
            }
            // Impulse times the mean of the velocities before and after is the change of kinetic energy.
            let mean = difference(moved(pairs, touches, r, 0.5), moved(pairs, touches, s, 0.5));
            // Friction uses the slip at the end of the step; stopping a slip dissipates energy as stopping an approach
            // does.
            let friction = dot(touch.impulse, slip) - dot(touch.impulse, touch.normal) * closing;
            let pair = &mut pairs[touch.pair as usize];
            pair.friction += friction.to_double();
            pair.taken += (dot(touch.impulse, mean) - friction).to_double();
        }
    }

    /// Advance the state variables of a touch to the end of the step, for the velocities `after` contact.
    fn remember<const D: usize>(
        &self,
        at: &SharedNodes<'_, T, D>,
        pairs: &[Pair],
        touch: &Touch<T>,
        (memory, n): (&mut TouchMemory, usize),
        after: [[T; 3]; 2],
    ) {
        if at.phase() != ContactPhase::Trial || !pairs[touch.pair as usize].remembers {
            return;
        }
        let way = times(sum(after[0], after[1]), T::of(0.5) * at.dt());
        memory.carry(n, way.map(T::to_double));
        let relative = difference(after[0], after[1]);
        let across = difference(relative, times(touch.normal, dot(relative, touch.normal)));
        let outcome = Outcome { impulse: touch.impulse, slid: times(across, at.dt()) };
        let (start, end) = memory.start_and_end(n);
        let LawCall { law, contact } = self.law_call(at, pairs, touch, start);
        if let Some((slip, own)) = end.split_first_mut() {
            *slip += length(outcome.slid).to_double();
            law.advance(&contact, &outcome, &mut own[..contact.memory.len()]);
        }
    }
}

/// Return the nodes at which the contact status of a pair is known.
fn known(pairs: &[Pair], r: usize, s: usize) -> u64 {
    pairs.iter().find(|p| p.fields == [r as u32, s as u32]).map_or(0, |p| p.known)
}

/// Return the velocities for the law: trial velocities, corrected so that contact does no work.
///
/// An impulse J does the work J . (w + w') / 2 on the nodes, with w and w' the velocities of the second body relative to
/// the first at the start and at the end of the step. If the bodies already separate (w . n > 0, as after the map of
/// particles that did not follow the nodes), J would accelerate the separation. Then w' . n is limited to -w . n, and J
/// does no work along the normal.
fn trial<T: Float, const D: usize>(
    at: &SharedNodes<'_, T, D>,
    [r, s]: [usize; 2],
    touch: &Touch<T>,
    parting: bool,
) -> [[T; 3]; 2] {
    let node = touch.node as usize;
    let mut velocities = [at.velocity(r, node), at.velocity(s, node)];
    if !parting && at.phase() == ContactPhase::Trial {
        let apart = dot(difference(at.old_velocity(s, node), at.old_velocity(r, node)), touch.normal);
        velocities[0] = difference(velocities[0], times(touch.normal, apart.max(T::of(0.0))));
    }
    velocities
}

/// Return the contact area of a node, m^2: the smaller of |sum_p V_p grad N_ip| of both fields.
fn area<T: Float, const D: usize>(at: &SharedNodes<'_, T, D>, fields: [usize; 2], node: usize) -> T {
    let of = |field: usize| {
        let mut out: Nodal<[T; 3]> = [[T::of(0.0); 3]; 64];
        at.surface_quantity(field, SurfaceQuantity::VolumeGradient, 1 << node, &[], &mut out);
        length(out[node])
    };
    of(fields[0]).min(of(fields[1]))
}

/// Return the velocity of a field at a node after the fraction `part` of its impulses.
fn moved<T: Float, const D: usize>(
    at: &SharedNodes<'_, T, D>,
    pairs: &[Pair],
    touches: &[Touch<T>],
    field: usize,
    part: f64,
) -> [T; 3] {
    let node = touches[0].node as usize;
    let share = T::of(part) / at.mass(field, node);
    let given = total(touches, |t| fields(pairs, t), field);
    sum(at.velocity(field, node), times(given, share))
}
