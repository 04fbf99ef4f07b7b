//! Impulses of all pairs of particles that touch.
//!
//! As at a node of the grid where three bodies meet (`mpm-contact`, `solve.rs`): every pair is solved as if it were alone,
//! with each particle's mass shared among the pairs it is in and the impulse of the pair itself taken out of the
//! velocities; all at once, until nothing changes (Jacobi iteration with mass splitting, accelerated). Every impulse acts
//! on two particles with opposite signs and is one the law gave, so that momentum is exact and no law is broken
//! however far the iteration came.

use mpm_contact::{Contact, ContactLaw};

/// Most iterations.
const ITERATIONS: usize = 400;
/// Change of the impulses, over the largest, at which they count as found.
const FOUND: f64 = 1e-9;

/// Two particles that touch.
pub(crate) struct Touch<'a> {
    pub law: &'a dyn ContactLaw<f64>,
    pub contact: Contact<f64>,
    /// Who moves: numbers from 0 without gaps.
    pub movers: [usize; 2],
    pub masses: [f64; 2],
    /// That the law sees, without any impulse.
    pub velocities: [[f64; 3]; 2],
    /// On the second.
    pub impulse: [f64; 3],
    /// Where the iteration looks from.
    pub ahead: [f64; 3],
}

fn length(a: &[f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Find the impulses of pairs among `movers` movers.
pub(crate) fn solve(touches: &mut [Touch<'_>], movers: usize, dt: f64) {
    let mut shares = vec![0.0; movers];
    for touch in touches.iter() {
        for m in touch.movers {
            shares[m] += 1.0;
        }
    }
    let mut next = vec![[0.0; 3]; touches.len()];
    let mut steps = 0.0;
    for _ in 0..ITERATIONS {
        let sums = gather(touches, movers, |t| t.ahead);
        for (touch, next) in touches.iter().zip(&mut next) {
            let (mut split, mut free) = (touch.masses, touch.velocities);
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                let (m, mass) = (touch.movers[side], touch.masses[side]);
                split[side] = mass / shares[m];
                for d in 0..3 {
                    free[side][d] += (sums[m][d] + sign * shares[m] * touch.ahead[d]) / mass;
                }
            }
            *next = touch.law.impulse(&touch.contact, split, free, dt);
        }
        let (mut change, mut size, mut back) = (0.0f64, 0.0f64, 0.0);
        for (touch, next) in touches.iter().zip(&next) {
            let step: [f64; 3] = std::array::from_fn(|d| next[d] - touch.impulse[d]);
            change = change.max(length(&step));
            size = size.max(length(next));
            back += (0..3).map(|d| (touch.ahead[d] - next[d]) * step[d]).sum::<f64>();
        }
        // Nesterov's momentum, which starts anew where it overshoots.
        steps = if back > 0.0 { 0.0 } else { steps + 1.0 };
        let momentum = steps / (steps + 3.0);
        for (touch, next) in touches.iter_mut().zip(&next) {
            for d in 0..3 {
                touch.ahead[d] = next[d] + momentum * (next[d] - touch.impulse[d]);
            }
            touch.impulse = *next;
        }
        if change <= size * FOUND {
            break;
        }
    }
}

/// The sum of the impulses on every mover.
pub(crate) fn gather(
    touches: &[Touch<'_>],
    movers: usize,
    impulse: impl Fn(&Touch<'_>) -> [f64; 3],
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; movers];
    for touch in touches {
        let impulse = impulse(touch);
        for (m, sign) in touch.movers.into_iter().zip([-1.0, 1.0]) {
            for d in 0..3 {
                sums[m][d] += sign * impulse[d];
            }
        }
    }
    sums
}
