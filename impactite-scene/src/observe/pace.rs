//! Schedule of observations.

use super::ObserveError;
use crate::archive::{Archive, CheckpointError};

/// Interval of observations, and the time of the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    every: Every,
    seen: Option<Seen>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Every {
    Steps(u64),
    Interval(f64),
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Seen {
    step: u64,
    time: f64,
}

/// Tolerance of equal times, as a share of the interval.
const ROUNDING: f64 = 1e-9;

impl Pace {
    /// Observe after every step.
    #[must_use]
    pub fn every_step() -> Self {
        Pace { every: Every::Steps(1), seen: None }
    }

    /// Observe after every `steps` steps.
    ///
    /// # Errors
    /// Zero steps.
    pub fn steps(steps: u64) -> Result<Self, ObserveError> {
        if steps == 0 {
            return Err(ObserveError::Pace { field: "steps", value: 0.0, allowed: "at least 1" });
        }
        Ok(Pace { every: Every::Steps(steps), seen: None })
    }

    /// Observe after the first step that ends at or after each multiple of `seconds`.
    ///
    /// # Errors
    /// An interval that is not positive and finite.
    pub fn interval(seconds: f64) -> Result<Self, ObserveError> {
        if !(seconds > 0.0 && seconds.is_finite()) {
            let allowed = "positive and finite";
            return Err(ObserveError::Pace { field: "interval", value: seconds, allowed });
        }
        Ok(Pace { every: Every::Interval(seconds), seen: None })
    }

    /// True if an observation is due after step number `step` that ended at `time` (s). Never twice at one step.
    #[must_use]
    pub fn due(&self, step: u64, time: f64) -> bool {
        let Some(seen) = self.seen else { return true };
        match self.every {
            Every::Steps(n) => step >= seen.step.saturating_add(n),
            Every::Interval(dt) => {
                let periods = |t: f64| (t / dt + ROUNDING).floor();
                step > seen.step && periods(time) > periods(seen.time)
            }
        }
    }

    /// True if the last observation was after this step.
    #[must_use]
    pub fn has_seen(&self, step: u64) -> bool {
        self.seen.is_some_and(|seen| seen.step == step)
    }

    /// Write or read the time of the last observation.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.seen, |file, Seen { step, time }| {
            file.word(step)?;
            file.real(time)
        })
    }

    /// Record an observation after step number `step` that ended at `time` (s).
    pub fn looked(&mut self, step: u64, time: f64) {
        self.seen = Some(Seen { step, time });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps with an observation in a run with steps of 0.4 s.
    fn looks(mut pace: Pace) -> Vec<u64> {
        let mut steps = Vec::new();
        for step in 0..=12 {
            let time = 0.4 * step as f64;
            if pace.due(step, time) {
                pace.looked(step, time);
                steps.push(step);
            }
        }
        steps
    }

    #[test]
    fn by_steps_and_by_time() {
        assert_eq!(looks(Pace::every_step()), (0..=12).collect::<Vec<_>>());
        assert_eq!(looks(Pace::steps(5).unwrap()), [0, 5, 10]);
        // Due at 0, 1, 2, 3, 4 s: observed after the first step that ends then or later; steps end at exactly 2 s and 4 s.
        assert_eq!(looks(Pace::interval(1.0).unwrap()), [0, 3, 5, 8, 10]);
        // With an interval shorter than a step every step is observed.
        assert_eq!(looks(Pace::interval(0.1).unwrap()), (0..=12).collect::<Vec<_>>());
    }

    #[test]
    fn a_pace_that_cannot_be_is_refused() {
        let said = Pace::interval(-1.0).unwrap_err().to_string();
        assert_eq!(said, "pace: interval = -1 is not allowed; it must be positive and finite");
        assert!(Pace::interval(f64::NAN).is_err());
        assert!(Pace::steps(0).is_err());
    }
}
