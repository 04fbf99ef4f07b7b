//! Solution for the impulses of surface points that move with several particles each.

use std::ops::Range;

use crate::law::{Contact, ContactLaw};
use crate::vector::{difference, dot, length, sum, times};

/// Convergence tolerance: largest change of an impulse in a sweep, over the largest impulse.
const FOUND: f64 = 1e-4;
/// Area, over that of a bond, with which it still breaks: a bond at its strength, to within convergence, holds.
const STRONGER: f64 = 1.002;
/// Maximum number of sweeps.
const SWEEPS: usize = 30;

/// Particle that impulses move.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mover {
    /// Trial velocity, m/s; the prescribed one where it is held.
    pub velocity: [f64; 3],
    /// Inverse mass by axis, 1/kg: zero where it is held.
    pub inverse: [f64; 3],
}

/// Range of entries in the pool of a [`System`].
pub(super) type Row = Range<usize>;

/// Contact of two surfaces at a point.
pub(super) struct SurfaceTouch<'a> {
    pub law: &'a dyn ContactLaw<f64>,
    /// Contact data; masses and velocities are set by the solver.
    pub contact: Contact<'a, f64>,
    /// Movers of each side; empty if it is rigid.
    pub rows: [Row; 2],
    /// Velocity of a rigid side, m/s.
    pub rigid: [[f64; 3]; 2],
    /// Allowed approach velocity along the normal at the end of the step, m/s.
    pub allowed: f64,
    /// True if only normal impulses act. Those of two balls act at two points, where friction would turn both.
    pub central: bool,
    /// Impulse on the second side, N s; the first receives its opposite.
    pub impulse: [f64; 3],
}

/// Movers, and the weights of rows.
#[derive(Default)]
pub(super) struct System {
    pub movers: Vec<Mover>,
    /// Mover and its weight by axis (an image in a plane of symmetry has the opposite sign across it).
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

    /// Inverse mass of a row, 1/kg: sum_k W_k^2 / m_k.
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

    /// Solve for the impulses of all contacts: each in turn by its law, with the others fixed, forwards and backwards, until none changes
    /// (projected Gauss-Seidel). Bonds hold at their strength at first ([`ContactLaw::at_strength`]); then those beyond it break, and the
    /// others are solved for again, until no more break. Momentum is exact at any stage.
    pub fn solve(&mut self, touches: &mut [SurfaceTouch<'_>]) {
        let inverses: Vec<[f64; 2]> =
            touches.iter().map(|touch| [0, 1].map(|side| self.inverse(&touch.rows[side]))).collect();
        self.relax(touches, &inverses);
        while self.break_bonds(touches, &inverses) {
            self.relax(touches, &inverses);
        }
    }

    /// Contact as the law sees it: velocities without its own impulse.
    fn without_own<'a>(&self, touch: &SurfaceTouch<'a>, inverse: [f64; 2]) -> Contact<'a, f64> {
        let mut free: [[f64; 3]; 2] = std::array::from_fn(|side| {
            if touch.rows[side].is_empty() { touch.rigid[side] } else { self.velocity(&touch.rows[side]) }
        });
        free[0] = sum(free[0], times(touch.impulse, inverse[0]));
        free[1] = difference(free[1], times(touch.impulse, inverse[1]));
        free[0] = difference(free[0], times(touch.contact.normal, touch.allowed));
        Contact { masses: inverse.map(|i| 1.0 / i), velocities: free, ..touch.contact }
    }

    /// Break all bonds beyond their strength: they have no area from then on. Returns true if any broke.
    fn break_bonds(&self, touches: &mut [SurfaceTouch<'_>], inverses: &[[f64; 2]]) -> bool {
        let mut broke = false;
        for (touch, inverse) in touches.iter_mut().zip(inverses) {
            if inverse[0] + inverse[1] <= 0.0 || touch.contact.area <= 0.0 {
                continue;
            }
            let contact = self.without_own(touch, *inverse);
            let contact = Contact { area: contact.area * STRONGER, ..contact };
            if touch.law.at_strength(&contact).is_some_and(|held| held != touch.law.impulse(&contact)) {
                touch.contact.area = 0.0;
                broke = true;
            }
        }
        broke
    }

    fn relax(&mut self, touches: &mut [SurfaceTouch<'_>], inverses: &[[f64; 2]]) {
        let count = touches.len();
        for sweep in 0..SWEEPS {
            let (mut change, mut size) = (0.0f64, 0.0f64);
            for k in 0..count {
                let n = if sweep % 2 == 0 { k } else { count - 1 - k };
                let (touch, inverse) = (&mut touches[n], inverses[n]);
                // Contacts between two held sides have no effect.
                if inverse[0] + inverse[1] <= 0.0 {
                    continue;
                }
                let contact = self.without_own(touch, inverse);
                let held = if contact.area > 0.0 { touch.law.at_strength(&contact) } else { None };
                let mut next = held.unwrap_or_else(|| touch.law.impulse(&contact));
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
