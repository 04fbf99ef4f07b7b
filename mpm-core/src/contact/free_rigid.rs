//! Impulses on free rigid bodies, whose nodes all move together.
//!
//! Pairs are relaxed as at a node with three bodies and more ([`relax`]). A rigid body's mass is shared among all nodes that touch it,
//! by the mass they hold; at each it shows the least mass that its share, which may turn, can show. What the
//! iteration converges to does not depend on the shares: velocities after contact that obey every pair's law.

use std::collections::BTreeMap;

use mpm_contact::vector::{sum, times};
use mpm_contact::{Contact, relax};

use super::node_impulses::LawCall;
use super::{SharedNodes, Touch};
use crate::parallel::Float;

/// Change of the impulses, over the largest, at which they count as found.
const FOUND: f64 = 1e-10;

/// A pair that touches at a node where a free rigid body is.
pub(super) struct Coupling<'a, T> {
    block: usize,
    touch: Touch<T>,
    fields: [usize; 2],
    call: LawCall<'a, T>,
    /// Who moves: a rigid body by its number, or the node.
    movers: [usize; 2],
    /// Masses that the pair sees.
    seen: [T; 2],
}

impl<'a, T: Float> Coupling<'a, T> {
    /// A touch in a block.
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

/// Movers from this number are nodes.
const NODES: usize = 1 << 40;

/// Who moves a field at a node. Bodies come before nodes; a node is one with its field.
fn mover<T: Float, const D: usize>(
    block: usize,
    at: &SharedNodes<'_, T, D>,
    node: usize,
    field: usize,
) -> usize {
    let free = at.rigid(field).is_some_and(|r| !r.is_prescribed());
    if free { at.body(field) } else { NODES + (block * at.fields() + field) * at.nodes() + node }
}

/// The pairs with their impulses.
pub(super) struct Coupled<'a, T> {
    pairs: Vec<Coupling<'a, T>>,
    sums: Sums<T>,
}

/// Impulse on a mover, and its moment, by the mover's number.
type Sums<T> = BTreeMap<usize, ([T; 3], [f64; 3])>;

impl<'a, T: Float> Coupled<'a, T> {
    /// Find the impulses.
    pub fn solve<const D: usize>(at: &[SharedNodes<'_, T, D>], mut pairs: Vec<Coupling<'a, T>>) -> Self {
        share(at, &mut pairs);
        let mut impulses = vec![[[T::of(0.0); 3]; 3]; pairs.len()];
        relax(&mut impulses, FOUND, |all| {
            let given = gather(at, &pairs, all.iter().map(|[_, ahead, _]| *ahead));
            for (pair, [_, ahead, next]) in pairs.iter().zip(all) {
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
        let sums = gather(at, &pairs, impulses.iter().map(|[impulse, ..]| *impulse));
        Coupled { pairs, sums }
    }

    /// The nodes, with the impulses of the pairs at each.
    pub fn nodes(&self) -> impl Iterator<Item = (usize, u8, Vec<[T; 3]>)> + '_ {
        let same =
            |a: &Coupling<'_, T>, b: &Coupling<'_, T>| (a.block, a.touch.node) == (b.block, b.touch.node);
        self.pairs.chunk_by(same).map(|chunk| {
            (chunk[0].block, chunk[0].touch.node, chunk.iter().map(|c| c.touch.impulse).collect())
        })
    }

    /// Velocity of a field at any node of a block once its mover has its impulses: of a rigid body wherever they act.
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

    /// Velocity of a field at a node of a pair once its mover has this part of its impulses.
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

/// Share masses among the pairs that they are in.
fn share<T: Float, const D: usize>(at: &[SharedNodes<'_, T, D>], pairs: &mut [Coupling<'_, T>]) {
    let held = |p: &Coupling<'_, T>, side: usize| p.call.contact.masses[side];
    let mut sums: BTreeMap<usize, T> = BTreeMap::new();
    for pair in pairs.iter() {
        for side in 0..2 {
            *sums.entry(pair.movers[side]).or_default() += held(pair, side);
        }
    }
    for pair in pairs.iter_mut() {
        for side in 0..2 {
            let (mass, all) = (held(pair, side), sums[&pair.movers[side]]);
            if !mass.to_double().is_finite() {
                continue;
            }
            let at = &at[pair.block];
            let whole = match at.rigid(pair.fields[side]) {
                Some(rigid) => T::of(rigid.least_mass(&at.position(pair.touch.node as usize))),
                None => mass,
            };
            pair.seen[side] = whole * (mass / all);
        }
    }
}

/// Sum of the impulses of the pairs on every mover, and of their moments about its centre if it is a rigid body.
fn gather<T: Float, const D: usize>(
    at: &[SharedNodes<'_, T, D>],
    pairs: &[Coupling<'_, T>],
    impulses: impl Iterator<Item = [T; 3]>,
) -> Sums<T> {
    let mut sums = Sums::new();
    for (pair, impulse) in pairs.iter().zip(impulses) {
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
    sums
}

/// What all impulses change of the velocity of one side of a pair.
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
