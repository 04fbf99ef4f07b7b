//! What a run took.

use crate::archive::{Archive, CheckpointError};

/// What a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunSummary {
    /// Steps made.
    pub steps: u64,
    /// Seconds of wall-clock time spent in steps; observers are left out.
    pub wall_seconds: f64,
    /// Point updates: [`Solver::moving_points`](crate::Solver::moving_points), summed over steps.
    pub updates: f64,
}

impl RunSummary {
    /// Point updates a second; 0 if no step was made.
    #[must_use]
    pub fn rate(&self) -> f64 {
        if self.wall_seconds > 0.0 { self.updates / self.wall_seconds } else { 0.0 }
    }

    /// To a file, or from one.
    ///
    /// # Errors
    /// The file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.steps)?;
        file.reals([&mut self.wall_seconds, &mut self.updates])
    }
}

/// A run in pieces.
impl std::ops::AddAssign for RunSummary {
    fn add_assign(&mut self, o: RunSummary) {
        self.steps += o.steps;
        self.wall_seconds += o.wall_seconds;
        self.updates += o.updates;
    }
}
