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

/// Two fields that touch at a node, with what their law needs.
pub struct Pair<'a, T> {
    pub law: &'a dyn ContactLaw<T>,
    pub masses: [T; 2],
    pub velocities: [[T; 3]; 2],
    pub area: T,
}

/// Find the impulses of the pairs in `touches`, all of one node. `pair` tells about one of them.
pub fn solve<'a, T: Float>(touches: &mut [Touch<T>], pair: impl Fn(&Touch<T>) -> Pair<'a, T>, dt: T) {
    let zero = T::of(0.0);
    if let [touch] = touches {
        let Pair { law, masses, velocities, area } = pair(touch);
        let contact = Contact { normal: touch.normal, gap: touch.gap, area };
        touch.impulse = law.impulse(&contact, masses, velocities, dt);
        return;
    }
    let mut steps = 0.0;
    for _ in 0..ITERATIONS {
        for t in 0..touches.len() {
            touches[t].next = alone(touches, t, pair(&touches[t]), dt);
        }
        let (mut change, mut size, mut back) = (zero, zero, zero);
        for touch in touches.iter() {
            let step = difference(touch.next, touch.impulse);
            change = change.max(length(step));
            size = size.max(length(touch.next));
            back += dot(difference(touch.ahead, touch.next), step);
        }
        // Nesterov's momentum, which starts anew where it overshoots.
        steps = if back > zero { 0.0 } else { steps + 1.0 };
        let momentum = T::of(steps / (steps + 3.0));
        for touch in touches.iter_mut() {
            let step = difference(touch.next, touch.impulse);
            touch.ahead = sum(touch.next, times(step, momentum));
            touch.impulse = touch.next;
        }
        if change <= size * T::default_epsilon() * T::of(4.0) {
            break;
        }
    }
}

/// What the law of one pair says, with the others as they are.
fn alone<T: Float>(touches: &[Touch<T>], t: usize, pair: Pair<'_, T>, dt: T) -> [T; 3] {
    let touch = &touches[t];
    let Pair { law, masses, velocities, area } = pair;
    let contact = Contact { normal: touch.normal, gap: touch.gap, area };
    let (mut split, mut free) = (masses, velocities);
    for side in 0..2 {
        let field = touch.fields[side];
        let share = T::of(touches.iter().filter(|o| o.fields.contains(&field)).count() as f64);
        split[side] = masses[side] / share;
        let sign = if side == 0 { share } else { -share };
        // With the impulses of all pairs, less that of this one on its share of the mass.
        let given = sum(on(touches, field, |t| t.ahead), times(touch.ahead, sign));
        free[side] = sum(velocities[side], times(given, T::of(1.0) / masses[side]));
    }
    law.impulse(&contact, split, free, dt)
}

/// The sum of the impulses on a field.
pub fn total<T: Float>(touches: &[Touch<T>], field: usize) -> [T; 3] {
    on(touches, field, |t| t.impulse)
}

fn on<T: Float>(touches: &[Touch<T>], field: usize, impulse: fn(&Touch<T>) -> [T; 3]) -> [T; 3] {
    let mut sum = [T::of(0.0); 3];
    for touch in touches {
        let sign = match touch.fields.iter().position(|&f| f == field) {
            Some(0) => T::of(-1.0),
            Some(_) => T::of(1.0),
            None => continue,
        };
        let impulse = impulse(touch);
        for d in 0..3 {
            sum[d] += sign * impulse[d];
        }
    }
    sum
}
