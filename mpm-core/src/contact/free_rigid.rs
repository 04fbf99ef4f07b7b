//! Contact impulses on free rigid bodies, whose nodes all move together.
//!
//! Pairs are relaxed as at a node with three or more bodies ([`relax`]). The mass of a rigid body is distributed over all
//! nodes in contact with it, weighted by the opposing mass; its effective mass at a node is the least that the share, which
//! may rotate, can have. The converged solution does not depend on the shares: velocities after contact obey every pair's
//! law. Planes in contact with a body are relaxed with the pairs, as bodies of infinite mass. Mirror image nodes are
//! excluded: the body receives the whole impulse of their originals.

use std::collections::BTreeMap;

use mpm_contact::vector::{difference, sum, times};
use mpm_contact::{Contact, relax};

use super::node_impulses::LawCall;
use super::{PlaneTouch, SharedNodes, Touch};
use impactite_simd::Float;

/// Convergence tolerance: change of the impulses, over the largest.
const FOUND: f64 = 1e-13;
/// Weight added to every pair of a rigid body, over the mean weight.
const LEAST_WEIGHT: f64 = 0.1;

/// Contact pair at a node of a free rigid body.
pub(super) struct Coupling<'a, T> {
    block: usize,
    touch: Touch<T>,
    fields: [usize; 2],
    call: LawCall<'a, T>,
    /// Movers of both sides: number of a rigid body, or of a node.
    movers: [usize; 2],
    /// Effective masses for the pair, kg.
    seen: [T; 2],
}

impl<'a, T: Float> Coupling<'a, T> {
    /// Create the coupling of a touch in a block.
    pub fn new<const D: usize>(
        block: usize,
        at: &SharedNodes<'_, T, D>,
        touch: Touch<T>,
        fields: [usize; 2],
        call: LawCall<'a, T>,
    ) -> Self {
        let movers = fields.map(|field| mover(block, at, touch.node as usize, field));
        let seen = call.contact.masses;
        Coupling { block, touch, fields, call, movers, seen }
    }
}

/// First mover number of nodes; smaller ones are rigid bodies.
const NODES: usize = 1 << 40;

/// Return the mover of a field at a node: the body if rigid and free, else a number per node and field.
fn mover<T: Float, const D: usize>(
    block: usize,
    at: &SharedNodes<'_, T, D>,
    node: usize,
    field: usize,
) -> usize {
    let free = at.rigid(field).is_some_and(|r| !r.is_prescribed());
    if free { at.body(field) } else { NODES + (block * at.fields() + field) * at.nodes() + node }
}

/// Pairs with their impulses.
pub(super) struct Coupled<'a, T> {
    pairs: Vec<Coupling<'a, T>>,
    sums: Sums<T>,
}

/// Impulse on a mover, N s, and its moment, N m s, by the mover's number.
type Sums<T> = BTreeMap<usize, ([T; 3], [f64; 3])>;

impl<'a, T: Float> Coupled<'a, T> {
    /// Solve for the impulses of pairs and planes.
    pub fn solve<const D: usize>(
        at: &[SharedNodes<'_, T, D>],
        mut pairs: Vec<Coupling<'a, T>>,
        planes: &mut [PlaneTouch<'_, D>],
    ) -> Self {
        let seen_by_planes = share(at, &mut pairs, planes);
        let mut impulses = vec![[[T::of(0.0); 3]; 3]; pairs.len() + planes.len()];
        let count = pairs.len();
        relax(&mut impulses, FOUND, |all| {
            let given = gather(at, (&pairs, planes), all.iter().map(|[_, ahead, _]| *ahead));
            let (of_pairs, of_planes) = all.split_at_mut(count);
            for ((plane, [_, ahead, next]), &seen) in planes.iter().zip(of_planes).zip(&seen_by_planes) {
                *next = of_plane(plane, seen, ahead, &given);
            }
            for (pair, [_, ahead, next]) in pairs.iter().zip(of_pairs) {
                let Coupling { call: LawCall { law, contact: Contact { velocities, .. } }, seen, .. } = pair;
                let mut free = *velocities;
                for side in 0..2 {
                    let change = response(at, pair, side, &given);
                    let own = times(*ahead, T::of(if side == 0 { 1.0 } else { -1.0 }) / seen[side]);
                    free[side] = sum(velocities[side], sum(change, own));
                }
                *next = law.impulse(&Contact { masses: *seen, velocities: free, ..pair.call.contact });
            }
        });
        pairs.iter_mut().zip(&impulses).for_each(|(pair, [impulse, ..])| pair.touch.impulse = *impulse);
        let of_planes = planes.iter_mut().zip(&impulses[count..]);
        of_planes.for_each(|(plane, [impulse, ..])| plane.impulse = impulse.map(T::to_double));
        let sums = gather(at, (&pairs, planes), impulses.iter().map(|[impulse, ..]| *impulse));
        Coupled { pairs, sums }
    }

    /// Iterate over the nodes, with the impulses of the pairs at each.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, u8, Vec<[T; 3]>)> + '_ {
        let same =
            |a: &Coupling<'_, T>, b: &Coupling<'_, T>| (a.block, a.touch.node) == (b.block, b.touch.node);
        self.pairs.chunk_by(same).map(|chunk| {
            (chunk[0].block, chunk[0].touch.node, chunk.iter().map(|c| c.touch.impulse).collect())
        })
    }

    /// Return the velocity of a field at any node of a block after the impulses on its mover; for a rigid body, those at
    /// all nodes.
    pub fn after<const D: usize>(
        &self,
        at: &[SharedNodes<'_, T, D>],
        block: usize,
        node: usize,
        field: usize,
    ) -> [T; 3] {
        let (here, start) = (&at[block], at[block].velocity(field, node));
        let Some((impulse, moment)) = self.sums.get(&mover(block, here, node, field)) else { return start };
        let change = match here.rigid(field).filter(|r| !r.is_prescribed()) {
            None => times(*impulse, T::of(1.0) / here.mass(field, node)),
            Some(rigid) => {
                rigid.response(&impulse.map(T::to_double), moment, &here.position(node)).map(T::of)
            }
        };
        sum(start, change)
    }

    /// Return the velocity of a field at a node of a pair after the fraction `part` of the impulses on its mover.
    pub fn moved<const D: usize>(
        &self,
        at: &[SharedNodes<'_, T, D>],
        block: usize,
        node: u8,
        field: usize,
        part: f64,
    ) -> [T; 3] {
        let start = at[block].velocity(field, node as usize);
        let here =
            |p: &&Coupling<'a, T>| p.block == block && p.touch.node == node && p.fields.contains(&field);
        let Some(pair) = self.pairs.iter().find(here) else { return start };
        let side = usize::from(pair.fields[1] == field);
        sum(start, times(response(at, pair, side, &self.sums), T::of(part)))
    }
}

/// Solve for the impulses of planes alone.
pub(crate) fn solve_planes<T: Float, const D: usize>(planes: &mut [PlaneTouch<'_, D>]) {
    Coupled::<T>::solve::<D>(&[], Vec::new(), planes);
}

/// Return the impulse of a plane on a body with the effective mass `seen`, after the impulses `given`: the normal velocity
/// is at least [`PlaneTouch::least_velocity`], with Coulomb friction.
fn of_plane<T: Float, const D: usize>(
    plane: &PlaneTouch<'_, D>,
    seen: T,
    ahead: &[T; 3],
    given: &Sums<T>,
) -> [T; 3] {
    let change = given.get(&plane.body).map_or([0.0; 3], |(impulse, moment)| {
        plane.rigid.response(&impulse.map(T::to_double), moment, &plane.point)
    });
    let trial = std::array::from_fn(|d| T::of(plane.trial[d] + change[d]));
    let free = difference(trial, times(*ahead, T::of(1.0) / seen));
    let velocities = [plane.least_velocity().map(T::of), free];
    let masses = [T::of(f64::INFINITY), seen];
    let contact = Contact::new(plane.normal.map(T::of), masses, velocities, T::of(0.0));
    let approach = contact.approach();
    if approach > T::of(0.0) {
        contact.braking(approach, T::of(plane.friction) * approach)
    } else {
        [T::of(0.0); 3]
    }
}

/// Return the weight of a pair, kg, for the distribution of a side's mass over its pairs. A rigid body uses the opposing
/// nodal mass, so that no share is small relative to the mass that it stops, and all pairs converge alike.
fn weight<T: Float>(pair: &Coupling<'_, T>, side: usize) -> T {
    let [own, other] = [pair.call.contact.masses[side], pair.call.contact.masses[1 - side]];
    let is_node = pair.movers.map(|mover| mover >= NODES);
    if is_node[side] || !other.to_double().is_finite() {
        own
    } else if is_node[1 - side] {
        other
    } else {
        own.min(other)
    }
}

/// Distribute masses over pairs and planes. Returns the effective masses for planes, kg.
fn share<T: Float, const D: usize>(
    at: &[SharedNodes<'_, T, D>],
    pairs: &mut [Coupling<'_, T>],
    planes: &[PlaneTouch<'_, D>],
) -> Vec<T> {
    let mut sums: BTreeMap<usize, (T, f64)> = BTreeMap::new();
    let of_pairs = pairs.iter().flat_map(|p| [0, 1].map(|side| (p.movers[side], weight(p, side))));
    for (mover, weight) in of_pairs.chain(planes.iter().map(|p| (p.body, T::of(p.mass)))) {
        let (all, count) = sums.entry(mover).or_default();
        (*all, *count) = (*all + weight, *count + 1.0);
    }
    // Share of a weight in the sum of a mover. A node of almost no mass is opposed by a much larger share of a rigid body:
    // its velocity is then as exact as the body's, and spline slopes of light nodes are not small.
    let part = |mover: usize, weight: T| {
        let (all, count) = sums[&mover];
        let least = if mover < NODES { T::of(LEAST_WEIGHT / count) * all } else { T::of(0.0) };
        (weight + least) / (all + least * T::of(count))
    };
    for pair in pairs.iter_mut() {
        for side in 0..2 {
            let mass = pair.call.contact.masses[side];
            if !mass.to_double().is_finite() {
                continue;
            }
            let at = &at[pair.block];
            let whole = match at.rigid(pair.fields[side]) {
                Some(rigid) => T::of(rigid.least_mass(&at.position(pair.touch.node as usize))),
                None => mass,
            };
            pair.seen[side] = whole * part(pair.movers[side], weight(pair, side));
        }
    }
    let seen = |p: &PlaneTouch<'_, D>| T::of(p.rigid.least_mass(&p.point)) * part(p.body, T::of(p.mass));
    planes.iter().map(seen).collect()
}

/// Sum the impulses of pairs and planes on every mover, and for rigid bodies their moments about the centre.
fn gather<T: Float, const D: usize>(
    at: &[SharedNodes<'_, T, D>],
    (pairs, planes): (&[Coupling<'_, T>], &[PlaneTouch<'_, D>]),
    mut impulses: impl Iterator<Item = [T; 3]>,
) -> Sums<T> {
    let mut sums = Sums::new();
    for (pair, impulse) in pairs.iter().zip(impulses.by_ref()) {
        let here = &at[pair.block];
        for (side, sign) in [(0, -1.0), (1, 1.0)] {
            let impulse = times(impulse, T::of(sign));
            let entry = sums.entry(pair.movers[side]).or_insert(([T::of(0.0); 3], [0.0; 3]));
            entry.0 = sum(entry.0, impulse);
            if let Some(rigid) = here.rigid(pair.fields[side]) {
                let moment =
                    rigid.moment(&here.position(pair.touch.node as usize), &impulse.map(T::to_double));
                (0..3).for_each(|d| entry.1[d] += moment[d]);
            }
        }
    }
    for (plane, impulse) in planes.iter().zip(impulses) {
        let entry = sums.entry(plane.body).or_insert(([T::of(0.0); 3], [0.0; 3]));
        entry.0 = sum(entry.0, impulse);
        let moment = plane.rigid.moment(&plane.point, &impulse.map(T::to_double));
        (0..3).for_each(|d| entry.1[d] += moment[d]);
    }
    sums
}

/// Return the velocity change of one side of a pair by all impulses.
fn response<T: Float, const D: usize>(
    at: &[SharedNodes<'_, T, D>],
    pair: &Coupling<'_, T>,
    side: usize,
    sums: &Sums<T>,
) -> [T; 3] {
    let Some((impulse, moment)) = sums.get(&pair.movers[side]) else { return [T::of(0.0); 3] };
    let here = &at[pair.block];
    match here.rigid(pair.fields[side]).filter(|r| !r.is_prescribed()) {
        None => times(*impulse, T::of(1.0) / pair.call.contact.masses[side]),
        Some(rigid) => {
            let seen = here.position(pair.touch.node as usize);
            rigid.response(&impulse.map(T::to_double), moment, &seen).map(T::of)
        }
    }
}
