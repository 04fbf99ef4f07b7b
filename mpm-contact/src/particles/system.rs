//! Impulses of surface points that move with several particles each.

use std::ops::Range;

use crate::law::{Contact, ContactLaw};
use crate::vector::{difference, dot, length, sum, times};

/// Largest change of an impulse in a sweep, over the largest impulse, at which impulses count as found.
const FOUND: f64 = 1e-4;
/// Most sweeps.
const SWEEPS: usize = 30;

/// What an impulse moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mover {
    /// Trial velocity, m/s; where it is held the prescribed one.
    pub velocity: [f64; 3],
    /// Inverse mass by axis, 1/kg: zero where it is held.
    pub inverse: [f64; 3],
}

/// Entries of the pool of a [`System`].
pub(super) type Row = Range<usize>;

/// Two surfaces that touch at a point.
pub(super) struct SurfaceTouch<'a> {
    pub law: &'a dyn ContactLaw<f64>,
    /// Masses and velocities are filled in by the solver.
    pub contact: Contact<'a, f64>,
    /// What each side moves with; empty if it is rigid.
    pub rows: [Row; 2],
    /// Velocity of a rigid side, m/s.
    pub rigid: [[f64; 3]; 2],
    /// Approach along the normal that is allowed at the end of the step, m/s.
    pub allowed: f64,
    /// Do only normal impulses act? Those of two balls act at two points, where friction would turn them both.
    pub central: bool,
    /// On the second side, N s; the first gets its opposite.
    pub impulse: [f64; 3],
}

/// Movers, and the weights of rows.
#[derive(Default)]
pub(super) struct System {
    pub movers: Vec<Mover>,
    /// Mover and its weight by axis (an image in a plane of symmetry has another sign across it).
    pub pool: Vec<(u32, [f64; 3])>,
}

impl System {
    fn velocity(&self, row: &Row) -> [f64; 3] {
        let mut u = [0.0; 3];
        for (number, share) in &self.pool[row.clone()] {
            let v = &self.movers[*number as usize].velocity;
            (0..3).for_each(|d| u[d] += share[d] * v[d]);
        }
        u
    }

    /// The inverse mass of a row, 1/kg: sum_k W_k^2 / m_k.
    fn inverse(&self, row: &Row) -> f64 {
        let mut inverse = [0.0f64; 3];
        for (number, share) in &self.pool[row.clone()] {
            let of = &self.movers[*number as usize].inverse;
            (0..3).for_each(|d| inverse[d] += share[d] * share[d] * of[d]);
        }
        inverse.iter().fold(0.0, |most, x| x.max(most))
    }

    fn push(&mut self, row: &Row, impulse: [f64; 3]) {
        for (number, share) in &self.pool[row.clone()] {
            let mover = &mut self.movers[*number as usize];
            (0..3).for_each(|d| mover.velocity[d] += share[d] * mover.inverse[d] * impulse[d]);
        }
    }

    /// Find the impulses of all touches: each in turn as its law demands, the others as they stand, forwards and backwards, until none
    /// changes (projected Gauss-Seidel). Momentum is exact however far this came.
    pub fn solve(&mut self, touches: &mut [SurfaceTouch<'_>]) {
        let inverses: Vec<[f64; 2]> =
            touches.iter().map(|touch| [0, 1].map(|side| self.inverse(&touch.rows[side]))).collect();
        let count = touches.len();
        for sweep in 0..SWEEPS {
            let (mut change, mut size) = (0.0f64, 0.0f64);
            for k in 0..count {
                let n = if sweep % 2 == 0 { k } else { count - 1 - k };
                let (touch, inverse) = (&mut touches[n], inverses[n]);
                // Nothing moves what is held on both sides.
                if inverse[0] + inverse[1] <= 0.0 {
                    continue;
                }
                let mut free: [[f64; 3]; 2] = std::array::from_fn(|side| {
                    if touch.rows[side].is_empty() {
                        touch.rigid[side]
                    } else {
                        self.velocity(&touch.rows[side])
                    }
                });
                free[0] = sum(free[0], times(touch.impulse, inverse[0]));
                free[1] = difference(free[1], times(touch.impulse, inverse[1]));
                free[0] = difference(free[0], times(touch.contact.normal, touch.allowed));
                let masses = inverse.map(|i| 1.0 / i);
                let mut next = touch.law.impulse(&Contact { masses, velocities: free, ..touch.contact });
                if touch.central {
                    next = times(touch.contact.normal, dot(next, touch.contact.normal));
                }
                let step = difference(next, touch.impulse);
                change = change.max(length(step));
                size = size.max(length(next));
                touch.impulse = next;
                let [a, b] = [touch.rows[0].clone(), touch.rows[1].clone()];
                self.push(&a, times(step, -1.0));
                self.push(&b, step);
            }
            if change <= FOUND * size {
                break;
            }
        }
    }
}
