//! Cost of a run.

use crate::archive::{Archive, CheckpointError};

/// Cost of a run: steps, wall-clock time and point updates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunSummary {
    /// Number of steps.
    pub steps: u64,
    /// Wall-clock time of the steps, s, without observers.
    pub wall_seconds: f64,
    /// Point updates: [`Solver::moving_points`](crate::Solver::moving_points), summed over steps.
    pub updates: f64,
}

impl RunSummary {
    /// Point updates per second; 0 without steps.
    #[must_use]
    pub fn rate(&self) -> f64 {
        if self.wall_seconds > 0.0 { self.updates / self.wall_seconds } else { 0.0 }
    }

    /// Write or read the summary.
    ///
    /// # Errors
    /// I/O error; damaged file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.steps)?;
        file.reals([&mut self.wall_seconds, &mut self.updates])
    }
}

/// Sum over the parts of a run.
impl std::ops::AddAssign for RunSummary {
    fn add_assign(&mut self, o: RunSummary) {
        self.steps += o.steps;
        self.wall_seconds += o.wall_seconds;
        self.updates += o.updates;
    }
}
