//! Solution for the impulses of coupled pairs.
//!
//! Every pair is solved as if it were alone, with each body's mass split among its pairs and the impulse of the pair itself removed from
//! the velocities; all pairs at once, until convergence (Jacobi iteration with mass splitting, accelerated by Nesterov's momentum). Every
//! impulse acts on two bodies with opposite signs and is the result of a law, so that momentum is exact and every law is obeyed at any
//! stage of the iteration. All pairs see the same velocities, so that numbering matters only to rounding.

use impactite_simd::Float;

use crate::vector::{difference, dot, length, sum, times};

/// Maximum number of iterations.
const ITERATIONS: usize = 400;

/// Iterate of a pair, N s: its impulse, the extrapolated one for the other pairs, and the next one.
pub type Iterate<T> = [[T; 3]; 3];

/// Solve for the impulses of all pairs. `next` computes the next one of each from the extrapolated ones; convergence means that none
/// changes by more than `found` of the largest, or by rounding.
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
        // Restart the acceleration after an overshoot.
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
