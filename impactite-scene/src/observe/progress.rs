//! A bar on the terminal.

use super::{ObserveError, Observer, Pace, RunView};
use crate::archive::{Archive, CheckpointError};
use crate::finding::Warning;
use impactite_output as output;

/// Shows on the terminal how far the run has come, silent where there is none; and writes what the run warns of, terminal or not.
pub struct Progress {
    pace: Pace,
    bar: output::Progress,
}

impl Progress {
    /// A bar titled `name`.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Progress { pace: Pace::every_step(), bar: output::Progress::new(name) }
    }
}

impl Observer for Progress {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        self.bar.update(now.time(), now.end(), now.step(), now.rate());
        Ok(())
    }
    fn archive(&mut self, _: &mut Archive) -> Result<(), CheckpointError> {
        Ok(())
    }
    fn warned(&mut self, warning: &Warning) {
        self.bar.line(&format!("warning: {warning}"));
    }
    fn finish(&mut self) {
        self.bar.finish();
    }
}
