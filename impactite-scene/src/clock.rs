//! Simulated time.

use crate::archive::{Archive, CheckpointError};
use crate::error::{StepError, Stopped};

/// Relative tolerance of equal times.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Simulated time, step count and last step of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Simulated time, s.
    pub time: f64,
    /// Number of steps.
    pub steps: u64,
    /// Size of the last step, s, for the growth limit of the next one; none before the first.
    pub last: Option<f64>,
}

impl Clock {
    /// Advance the clock by a step of `dt` seconds.
    pub fn advance(&mut self, dt: f64) {
        self.time += dt;
        self.steps += 1;
        self.last = Some(dt);
    }

    /// True if the time has reached `end`, s, up to the rounding of either. False if `end` is NaN.
    #[must_use]
    pub fn reached(&self, end: f64) -> bool {
        end - self.time <= ROUNDING * end.abs().max(self.time.abs())
    }

    /// True if `end`, s, is before the current time by more than rounding.
    #[must_use]
    pub fn is_past(&self, end: f64) -> bool {
        self.time - end > ROUNDING * end.abs().max(self.time.abs())
    }

    /// Set the time to exactly `end`, s, if the last step reached it or at most `rounding`, s, remains. `before` is [`Clock::last`] before
    /// that step; it is restored, since a shortened step does not limit the next one.
    pub fn arrive(&mut self, end: f64, rounding: f64, before: Option<f64>) {
        if self.reached(end) || end - self.time <= rounding {
            self.time = end;
            self.last = before.or(self.last);
        }
    }

    /// Return an error of the step that begins now.
    #[must_use]
    pub fn stopped(&self, what: Stopped) -> StepError {
        StepError { step: self.steps + 1, time: self.time, what }
    }

    /// Return the error of an invalid time or step. The run can continue.
    #[must_use]
    pub fn refused(&self, field: &'static str, value: f64, allowed: &'static str) -> StepError {
        self.stopped(Stopped::Clock { field, value, allowed, now: self.time })
    }

    /// Return the size of the next step: `dt` seconds, or less if at most `left` (infinite for no limit) remain. The last two steps share
    /// the remaining time.
    ///
    /// # Errors
    /// A `left` that is not positive; a step that is not positive and finite, or too short to advance the clock.
    pub fn step_within(&self, dt: f64, left: f64) -> Result<f64, StepError> {
        if left.is_nan() || left <= 0.0 {
            return Err(self.refused("step_at_most: left", left, "positive; infinite for no limit"));
        }
        // Avoid a last step of the size of rounding. Without a step limit, one step covers all remaining time.
        let dt = if dt >= left * (1.0 - 1e-9) { left } else { dt.min(0.5 * left) };
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(self.stopped(Stopped::NoTimeStep(dt)));
        }
        if self.time + dt == self.time {
            return Err(self.refused(
                "time step",
                dt,
                "long enough to move the clock: let it start at an earlier time",
            ));
        }
        Ok(dt)
    }

    /// Check that `end` is finite and later than the current time.
    ///
    /// # Errors
    /// An end that is not finite, or that is [reached](Clock::reached).
    pub fn check_end(&self, end: f64) -> Result<(), StepError> {
        if !end.is_finite() || self.reached(end) {
            return Err(self.refused("end", end, "finite and later than the time reached"));
        }
        Ok(())
    }

    /// Write or read the clock.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.real(&mut self.time)?;
        file.word(&mut self.steps)?;
        file.option(&mut self.last, Archive::real)
    }
}
