//! Impulses of all pairs that touch at a node.
//!
//! One pair is one call of its law. With more, every pair is solved as if it were alone, with each body's mass
//! shared among the pairs it is in and the impulse of the pair itself taken out of the velocities; all at once,
//! until nothing changes (Jacobi iteration with mass splitting, accelerated). Every impulse acts on two bodies with opposite
//! signs, so that momentum is exact however far the iteration came; and since all pairs use the same velocities,
//! numbering matters only to rounding. What it converges to obeys every pair's law with the whole impulse of the
//! step: no pull, the friction cone.

use mpm_core::parallel::Float;
use mpm_core::step::contact::Touch;

use crate::law::{Contact, ContactLaw};
use crate::vector::{difference, dot, length, sum, times};

/// Most iterations at a node with three bodies or more.
const ITERATIONS: usize = 400;

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
    vectors: &mut Vec<[[T; 3]; 2]>,
) {
    let zero = T::of(0.0);
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
    // Of every touch: its next impulse, and where the iteration looks from.
    vectors.clear();
    vectors.resize(touches.len(), [[zero; 3]; 2]);
    let mut steps = 0.0;
    for _ in 0..ITERATIONS {
        for t in (0..touches.len()).filter(|&t| touches[t].acts) {
            vectors[t][0] = alone(touches, vectors, t, fields, meets(&touches[t]), dt);
        }
        let (mut change, mut size, mut back) = (zero, zero, zero);
        for (touch, [next, ahead]) in touches.iter().zip(&*vectors) {
            let step = difference(*next, touch.impulse);
            change = change.max(length(step));
            size = size.max(length(*next));
            back += dot(difference(*ahead, *next), step);
        }
        // Nesterov's momentum, which starts anew where it overshoots.
        steps = if back > zero { 0.0 } else { steps + 1.0 };
        let momentum = T::of(steps / (steps + 3.0));
        for (touch, [next, ahead]) in touches.iter_mut().zip(&mut *vectors) {
            let step = difference(*next, touch.impulse);
            *ahead = sum(*next, times(step, momentum));
            touch.impulse = *next;
        }
        if change <= size * T::default_epsilon() * T::of(4.0) {
            break;
        }
    }
}

/// What the law of one pair says, with the others as they are.
fn alone<T: Float>(
    touches: &[Touch<T>],
    vectors: &[[[T; 3]; 2]],
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
