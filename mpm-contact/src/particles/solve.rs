//! Solution for the impulses of all pairs of particles in contact, relaxed as at a grid node with three bodies.

use crate::law::{Contact, ContactLaw};
use crate::relax::relax;

/// Convergence tolerance: change of the impulses, over the largest.
const FOUND: f64 = 1e-9;

/// Two particles in contact.
pub(super) struct Touch<'a> {
    pub law: &'a dyn ContactLaw<f64>,
    /// Contact data, with masses and trial velocities without any of these impulses.
    pub contact: Contact<'a, f64>,
    /// Movers: numbers from 0 without gaps.
    pub movers: [usize; 2],
    /// Impulse on the second.
    pub impulse: [f64; 3],
}

/// Solve for the impulses of pairs among `movers` movers.
pub(super) fn solve(touches: &mut [Touch<'_>], movers: usize) {
    let mut shares = vec![0.0; movers];
    for touch in touches.iter() {
        for m in touch.movers {
            shares[m] += 1.0;
        }
    }
    let mut impulses = vec![[[0.0; 3]; 3]; touches.len()];
    relax(&mut impulses, FOUND, |all| {
        let sums = gather(touches, movers, all.iter().map(|[_, ahead, _]| *ahead));
        for (touch, [_, ahead, next]) in touches.iter().zip(all) {
            let Contact { masses, velocities, .. } = touch.contact;
            let (mut split, mut free) = (masses, velocities);
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                let (m, mass) = (touch.movers[side], masses[side]);
                split[side] = mass / shares[m];
                for d in 0..3 {
                    free[side][d] += (sums[m][d] + sign * shares[m] * ahead[d]) / mass;
                }
            }
            *next = touch.law.impulse(&Contact { masses: split, velocities: free, ..touch.contact });
        }
    });
    touches.iter_mut().zip(&impulses).for_each(|(touch, [impulse, ..])| touch.impulse = *impulse);
}

/// Sum the impulses on every mover.
pub(super) fn gather(
    touches: &[Touch<'_>],
    movers: usize,
    impulses: impl Iterator<Item = [f64; 3]>,
) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; movers];
    for (touch, impulse) in touches.iter().zip(impulses) {
        for (m, sign) in touch.movers.into_iter().zip([-1.0, 1.0]) {
            for d in 0..3 {
                sums[m][d] += sign * impulse[d];
            }
        }
    }
    sums
}
