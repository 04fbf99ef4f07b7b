//! Lead of the positions of falling bodies, in methods that move points with the velocity at the end of a step.
//!
//! A step moves particles with the velocity at its end (symplectic Euler): leap-frog integration of second order, whose velocities belong
//! to the middle of steps. But its first step applies a body force a, which acts from the start, for a whole step instead of half a step.
//! So a falling body is ahead of x0 + v0 t + a t^2 / 2 by the sum of a dt^2 / 2, which is a t dt / 2 with constant steps. Views of points
//! are moved back by this lead, limited to the change of the centre's velocity due to the body force: a body that was stopped has no lead.
//! The points themselves are not moved, so that the run does not change.

use crate::archive::{Archive, CheckpointError};
use crate::boundary::Boundary;

/// Relative tolerance of equal masses of one body.
const SAME_MASS: f64 = 1e-9;

/// Lead of the points of a falling body, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CentreLead {
    /// Mass, kg, and momentum, kg m/s, of the points at the end of the last step; none before the first.
    last: Option<[f64; 4]>,
    /// Sum of dt (v' - v) / 2 with the velocities v at the start and v' at the end of steps, m.
    way: [f64; 3],
    /// Sum of a dt^2 / 2, m.
    fall: [f64; 3],
}

impl CentreLead {
    /// Set mass, kg, and momentum, kg m/s, before the first step.
    pub fn open(&mut self, mass: f64, momentum: [f64; 3]) {
        let [x, y, z] = momentum;
        self.last = Some([mass, x, y, z]);
    }

    /// True if [`CentreLead::open`] is due.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.last.is_none()
    }

    /// Update the lead by mass, kg, and momentum, kg m/s, at the end of a step of `dt` seconds, and the body force at the start of the run,
    /// m/s^2, along the axes of [`CentreLead::along`]. A step that changes the mass is ignored.
    pub fn step(&mut self, now: [f64; 4], dt: f64, force: [f64; 3]) {
        if let Some(last) = self.last.replace(now)
            && now[0] > 0.0
            && (now[0] - last[0]).abs() <= SAME_MASS * now[0]
        {
            for d in (0..3).filter(|&d| force[d] != 0.0) {
                self.fall[d] += 0.5 * dt * dt * force[d];
                self.way[d] += 0.5 * dt * (now[d + 1] - last[d + 1]) / now[0];
            }
        }
    }

    /// Return the components of a body force, m/s^2, along axes in which the scene contains the centres of its bodies: not across planes of
    /// symmetry, nor along the radius of axisymmetric scenes, since the modelled part of a body has no centre of its own there.
    #[must_use]
    pub fn along<const D: usize>(
        force: &[f64; D],
        boundaries: &[Boundary<D>],
        axisymmetric: bool,
    ) -> [f64; 3] {
        let mut along = [0.0; 3];
        along[..D].copy_from_slice(force);
        if axisymmetric {
            along[0] = 0.0;
        }
        for boundary in boundaries {
            if let Boundary::Symmetry { axis, .. } = *boundary {
                along[axis] = 0.0;
            }
        }
        along
    }

    /// Return the lead, m, to subtract from positions.
    #[must_use]
    pub fn way(&self) -> [f64; 3] {
        std::array::from_fn(|d| self.way[d].clamp(self.fall[d].min(0.0), self.fall[d].max(0.0)))
    }

    /// Write or read the lead.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.last, |file, last| file.reals(last))?;
        file.reals(&mut self.way)?;
        file.reals(&mut self.fall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of variable size, and a body with an initial velocity of 3 m/s and an acceleration of -9.81 m/s^2.
    #[test]
    fn constant_acceleration_is_exact_with_steps_of_any_size() {
        let (mass, start, a) = (2.0, 3.0, -9.81);
        let (mut lead, mut x, mut v, mut t) = (CentreLead::default(), 0.0, start, 0.0);
        assert!(lead.is_closed());
        lead.open(mass, [0.0, mass * v, mass * v]);
        for n in 0..50 {
            let dt = 1e-2 * (1.0 + 0.9 * f64::sin(f64::from(n)));
            v += dt * a;
            x += dt * v;
            t += dt;
            lead.step([mass, 0.0, mass * v, mass * v], dt, [0.0, a, 0.0]);
        }
        let exact = start * t + 0.5 * a * t * t;
        assert!((x - exact).abs() > 1e-2 && (x - lead.way()[1] - exact).abs() < 1e-13);
        assert_eq!((lead.way()[0], lead.way()[2]), (0.0, 0.0));
        // A body that another force stopped has no lead.
        let mut stopped = lead;
        stopped.step([mass, 0.0, mass * start, 0.0], 0.5, [0.0, a, 0.0]);
        assert_eq!(stopped.way()[1], 0.0);
        // Added mass has a velocity of its own.
        let before = lead;
        lead.step([2.0 * mass, 0.0, 0.0, 0.0], 1.0, [a; 3]);
        assert_eq!(lead.way(), before.way());
    }
}
