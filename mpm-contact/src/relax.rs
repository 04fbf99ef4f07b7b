//! Impulses of pairs that depend on each other.
//!
//! Every pair is solved as if it were alone, with each body's mass shared among the pairs it is in and the impulse of the pair
//! itself taken out of the velocities; all at once, until nothing changes (Jacobi iteration with mass splitting, accelerated
//! by Nesterov's momentum). Every impulse acts on two bodies with opposite signs and is one that a law gave, so that momentum
//! is exact and no law is broken however far the iteration came; and since all pairs see the same velocities, numbering matters
//! only to rounding.

use impactite_simd::Float;

use crate::vector::{difference, dot, length, sum, times};

/// Most iterations.
const ITERATIONS: usize = 400;

/// A pair's impulse, N s, the one that other pairs look at, and the next one.
pub type Iterate<T> = [[T; 3]; 3];

/// Find the impulses of all pairs. `next` finds the next one of each from those that the others look at; impulses count as found
/// where none changes by more than `found` of the largest, or by rounding.
pub fn relax<T: Float>(pairs: &mut [Iterate<T>], found: f64, mut next: impl FnMut(&mut [Iterate<T>])) {
    let (zero, rounding) = (T::of(0.0), T::default_epsilon() * T::of(4.0));
    let mut steps = 0.0;
    for _ in 0..ITERATIONS {
        next(pairs);
        let (mut change, mut size, mut back) = (zero, zero, zero);
        for [impulse, ahead, next] in &*pairs {
            let step = difference(*next, *impulse);
            change = change.max(length(step));
            size = size.max(length(*next));
            back += dot(difference(*ahead, *next), step);
        }
        // It starts anew where it overshoots.
        steps = if back > zero { 0.0 } else { steps + 1.0 };
        let momentum = T::of(steps / (steps + 3.0));
        for [impulse, ahead, next] in &mut *pairs {
            *ahead = sum(*next, times(difference(*next, *impulse), momentum));
            *impulse = *next;
        }
        if change <= size * T::of(found).max(rounding) {
            break;
        }
    }
}
