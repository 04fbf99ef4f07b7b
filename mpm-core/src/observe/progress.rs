//! A bar on the terminal.

use super::{Moment, ObserveError, Observer, Pace};
use crate::output;
use crate::parallel::Float;
use crate::watch::Warning;

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

impl<T: Float, const D: usize> Observer<T, D> for Progress {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &Moment<'_, T, D>) -> Result<(), ObserveError> {
        self.bar.update(now.time(), now.end(), now.step(), now.rate());
        Ok(())
    }
    fn warned(&mut self, warning: &Warning) {
        self.bar.line(&format!("warning: {warning}"));
    }
    fn finish(&mut self) {
        self.bar.finish();
    }
}
