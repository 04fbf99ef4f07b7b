//! Impulses of all contact pairs at a node.
//!
//! One pair is one call of its law; several pairs are relaxed ([`relax`]). The converged impulses obey every pair's law
//! with the whole impulse of the step: no tension, friction cone.

use mpm_contact::vector::{sum, times};
use mpm_contact::{Contact, ContactLaw, Iterate, relax};

use super::Touch;
use impactite_simd::Float;

/// Law of two fields in contact at a node, with its arguments.
pub(super) struct LawCall<'a, T> {
    pub law: &'a dyn ContactLaw<T>,
    pub contact: Contact<'a, T>,
}

/// Compute the impulses of the active `touches`, all at one node. `fields` returns the fields of a touch, `calls` its law
/// call, given its index, too; `vectors` is scratch memory.
pub(super) fn find_impulses<'a, T: Float>(
    touches: &mut [Touch<T>],
    fields: impl Fn(&Touch<T>) -> [usize; 2] + Copy,
    calls: impl Fn(usize, &Touch<T>) -> LawCall<'a, T>,
    vectors: &mut Vec<Iterate<T>>,
) {
    let acting = touches.iter().filter(|t| t.acts).count();
    if acting == 0 {
        return;
    }
    if let (1, Some((t, touch))) = (acting, touches.iter_mut().enumerate().find(|(_, t)| t.acts)) {
        let LawCall { law, contact } = calls(t, touch);
        touch.impulse = law.impulse(&contact);
        return;
    }
    vectors.clear();
    vectors.resize(touches.len(), [[T::of(0.0); 3]; 3]);
    relax(vectors, 0.0, |all| {
        for t in (0..touches.len()).filter(|&t| touches[t].acts) {
            all[t][2] = alone(touches, all, t, fields, calls(t, &touches[t]));
        }
    });
    touches.iter_mut().zip(vectors).for_each(|(touch, [impulse, ..])| touch.impulse = *impulse);
}

/// Return the impulse of one pair from its law, with the others fixed.
fn alone<T: Float>(
    touches: &[Touch<T>],
    vectors: &[Iterate<T>],
    t: usize,
    fields: impl Fn(&Touch<T>) -> [usize; 2],
    call: LawCall<'_, T>,
) -> [T; 3] {
    let touch = &touches[t];
    let LawCall { law, contact: Contact { masses, velocities, .. } } = call;
    let (mut split, mut free) = (masses, velocities);
    let own = fields(touch);
    for side in 0..2 {
        let field = own[side];
        let share = touches.iter().filter(|o| o.acts && fields(o).contains(&field)).count();
        let share = T::of(share as f64);
        split[side] = masses[side] / share;
        let sign = if side == 0 { share } else { -share };
        // Add the impulses of all pairs, less that of this one on its share of the mass.
        let all = on(touches.iter().zip(vectors).map(|(t, v)| (fields(t), v[1])), field);
        let given = sum(all, times(vectors[t][1], sign));
        free[side] = sum(velocities[side], times(given, T::of(1.0) / masses[side]));
    }
    law.impulse(&Contact { masses: split, velocities: free, ..call.contact })
}

/// Sum the impulses on a field.
pub(super) fn total<T: Float>(
    touches: &[Touch<T>],
    fields: impl Fn(&Touch<T>) -> [usize; 2],
    field: usize,
) -> [T; 3] {
    on(touches.iter().map(|t| (fields(t), t.impulse)), field)
}

/// Sum the impulses between pairs of fields on one of them.
fn on<T: Float>(impulses: impl Iterator<Item = ([usize; 2], [T; 3])>, field: usize) -> [T; 3] {
    let mut sum = [T::of(0.0); 3];
    for (fields, impulse) in impulses {
        let sign = match fields.iter().position(|&f| f == field) {
            Some(0) => T::of(-1.0),
            Some(_) => T::of(1.0),
            None => continue,
        };
        for d in 0..3 {
            sum[d] += sign * impulse[d];
        }
    }
    sum
}
