//! Simulated time.

use crate::archive::{Archive, CheckpointError};
use crate::error::{StepError, Stopped};

/// Times are the same that differ by less than this part of them.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Time, steps, and the last step of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Simulated time, s.
    pub time: f64,
    /// Steps made.
    pub steps: u64,
    /// Size of the last step, s, which limits how far the next one grows; none before the first.
    pub last: Option<f64>,
}

impl Clock {
    /// A step of `dt` seconds was made.
    pub fn advance(&mut self, dt: f64) {
        self.time += dt;
        self.steps += 1;
        self.last = Some(dt);
    }

    /// Has the time come to `end`, s, or is what is left less than the rounding of either? Never for an end that is not a number.
    #[must_use]
    pub fn reached(&self, end: f64) -> bool {
        end - self.time <= ROUNDING * end.abs().max(self.time.abs())
    }

    /// Is `end`, s, before the time reached, by more than rounding?
    #[must_use]
    pub fn is_past(&self, end: f64) -> bool {
        self.time - end > ROUNDING * end.abs().max(self.time.abs())
    }

    /// A step was made that may have come to `end`, s: stand there exactly if nothing but `rounding`, s, is left. `before` is
    /// [`Clock::last`] as it was before that step, which, cut short to arrive, says nothing about the next one.
    pub fn arrive(&mut self, end: f64, rounding: f64, before: Option<f64>) {
        if self.reached(end) || end - self.time <= rounding {
            self.time = end;
            self.last = before.or(self.last);
        }
    }

    /// An error of the step that begins now.
    #[must_use]
    pub fn stopped(&self, what: Stopped) -> StepError {
        StepError { step: self.steps + 1, time: self.time, what }
    }

    /// A time that it cannot follow: the run may go on.
    #[must_use]
    pub fn refused(&self, field: &'static str, value: f64, allowed: &'static str) -> StepError {
        self.stopped(Stopped::Clock { field, value, allowed, now: self.time })
    }

    /// The size of the next step, of `dt` seconds or less if no more than `left` (infinite for no limit) is: the last two steps share
    /// that.
    ///
    /// # Errors
    /// A `left` that is not positive; a step that is no positive number, or too short to move the clock.
    pub fn step_within(&self, dt: f64, left: f64) -> Result<f64, StepError> {
        if left.is_nan() || left <= 0.0 {
            return Err(self.refused("step_at_most: left", left, "positive; infinite for no limit"));
        }
        // Rounding must not leave a last step of nothing. Where nothing limits the step, all is made at once.
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

    /// Refuse an end that no step leads to.
    ///
    /// # Errors
    /// One that is not finite, or that is [reached](Clock::reached).
    pub fn check_end(&self, end: f64) -> Result<(), StepError> {
        if !end.is_finite() || self.reached(end) {
            return Err(self.refused("end", end, "finite and later than the time reached"));
        }
        Ok(())
    }

    /// To a file, or from one.
    ///
    /// # Errors
    /// The file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.real(&mut self.time)?;
        file.word(&mut self.steps)?;
        file.option(&mut self.last, Archive::real)
    }
}
