//! Impulses of all pairs that touch at a node.
//!
//! One pair is one call of its law; with more they are relaxed (see `relax.rs`). What that converges to obeys every pair's law
//! with the whole impulse of the step: no pull, the friction cone.

use mpm_core::parallel::Float;
use mpm_core::step::contact::Touch;

use crate::law::{Contact, ContactLaw};
use crate::relax::{Iterate, relax};
use crate::vector::{sum, times};

/// What the law of two fields that touch at a node needs.
pub struct Meets<'a, T> {
    pub law: &'a dyn ContactLaw<T>,
    pub masses: [T; 2],
    pub velocities: [[T; 3]; 2],
    pub area: T,
}

/// Find the impulses of those of `touches`, all of one node, that act. `fields` and `meets` tell about one of them; `vectors` is memory.
pub fn solve<'a, T: Float>(
    touches: &mut [Touch<T>],
    fields: impl Fn(&Touch<T>) -> [usize; 2] + Copy,
    meets: impl Fn(&Touch<T>) -> Meets<'a, T>,
    dt: T,
    vectors: &mut Vec<Iterate<T>>,
) {
    let acting = touches.iter().filter(|t| t.acts).count();
    if acting == 0 {
        return;
    }
    if let (1, Some(touch)) = (acting, touches.iter_mut().find(|t| t.acts)) {
        let Meets { law, masses, velocities, area } = meets(touch);
        let contact = Contact { normal: touch.normal, gap: touch.gap, area };
        touch.impulse = law.impulse(&contact, masses, velocities, dt);
        return;
    }
    vectors.clear();
    vectors.resize(touches.len(), [[T::of(0.0); 3]; 3]);
    relax(vectors, 0.0, |all| {
        for t in (0..touches.len()).filter(|&t| touches[t].acts) {
            all[t][2] = alone(touches, all, t, fields, meets(&touches[t]), dt);
        }
    });
    touches.iter_mut().zip(vectors).for_each(|(touch, [impulse, ..])| touch.impulse = *impulse);
}

/// What the law of one pair says, with the others as they are.
fn alone<T: Float>(
    touches: &[Touch<T>],
    vectors: &[Iterate<T>],
    t: usize,
    fields: impl Fn(&Touch<T>) -> [usize; 2],
    meets: Meets<'_, T>,
    dt: T,
) -> [T; 3] {
    let touch = &touches[t];
    let Meets { law, masses, velocities, area } = meets;
    let contact = Contact { normal: touch.normal, gap: touch.gap, area };
    let (mut split, mut free) = (masses, velocities);
    let own = fields(touch);
    for side in 0..2 {
        let field = own[side];
        let share = touches.iter().filter(|o| o.acts && fields(o).contains(&field)).count();
        let share = T::of(share as f64);
        split[side] = masses[side] / share;
        let sign = if side == 0 { share } else { -share };
        // With the impulses of all pairs, less that of this one on its share of the mass.
        let all = on(touches.iter().zip(vectors).map(|(t, v)| (fields(t), v[1])), field);
        let given = sum(all, times(vectors[t][1], sign));
        free[side] = sum(velocities[side], times(given, T::of(1.0) / masses[side]));
    }
    law.impulse(&contact, split, free, dt)
}

/// The sum of the impulses on a field.
pub fn total<T: Float>(
    touches: &[Touch<T>],
    fields: impl Fn(&Touch<T>) -> [usize; 2],
    field: usize,
) -> [T; 3] {
    on(touches.iter().map(|t| (fields(t), t.impulse)), field)
}

/// The sum of impulses between pairs on one of them.
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
