//! Progress of a run, for programs that display it themselves.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use impactite::observe::{ObserveError, Observer, Pace, Progress, RunView};
use impactite::scene::{Archive, CheckpointError, Warning};
use impactite_input::shown;

/// Wall-clock time between updates of a [`ProgressState`].
const EVERY: Duration = Duration::from_millis(50);

/// Progress of a run, shared between its thread and others. It replaces the bar on the terminal for a [`Job`](crate::Job).
#[derive(Debug, Default)]
pub struct SharedProgress {
    begun: AtomicBool,
    now: Mutex<(ProgressState, Vec<String>)>,
}

/// Time and number of steps reached by a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProgressState {
    /// Simulated time, s.
    pub time: f64,
    /// Simulated time at the end of the run, s; 0 before the first step.
    pub end: f64,
    /// Number of steps since set-up.
    pub steps: u64,
    /// Point updates per second of wall-clock time in steps.
    pub rate: f64,
    /// Energy error: unexplained change of the total energy over the largest energy so far.
    pub energy_error: f64,
}

impl SharedProgress {
    /// True if set-up is complete. A stop request before that ends the run before it writes a file.
    pub fn begun(&self) -> bool {
        self.begun.load(Ordering::SeqCst)
    }

    /// Return the time and the number of steps reached.
    pub fn stand(&self) -> ProgressState {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).0
    }

    /// Return the warnings of the run so far.
    pub fn warnings(&self) -> Vec<String> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner).1.clone()
    }

    /// Mark the scene as set up; return false if a stop was requested before.
    pub(crate) fn begin(&self, stop: &AtomicBool) -> bool {
        // A thread that stops the run first stores `stop` and then loads `begun`: at least one of the two threads sees the store of the
        // other.
        self.begun.store(true, Ordering::SeqCst);
        !stop.load(Ordering::SeqCst)
    }

    fn update<R>(&self, update: impl FnOnce(&mut ProgressState, &mut Vec<String>) -> R) -> R {
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        let (stand, warnings) = &mut *now;
        update(stand, warnings)
    }
}

/// Observer of progress: the terminal bar, or a [`SharedProgress`] in its place. One observer serves both cases, so that checkpoints fit
/// both.
pub(crate) struct Shown {
    pub bar: Progress,
    pub advance: Option<Arc<SharedProgress>>,
    pub last: Option<Instant>,
}

impl Observer for Shown {
    fn pace(&mut self) -> &mut Pace {
        self.bar.pace()
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let Some(advance) = &self.advance else { return self.bar.observe(now) };
        let ends = now.time() >= now.end();
        if ends || self.last.is_none_or(|last| last.elapsed() >= EVERY) {
            self.last = Some(Instant::now());
            let stand = ProgressState {
                time: now.time(),
                end: now.end(),
                steps: now.step(),
                rate: now.rate(),
                energy_error: now.account().energy_error(),
            };
            advance.update(|seen, _| *seen = stand);
        }
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.bar.archive(file)
    }
    fn warned(&mut self, warning: &Warning) {
        match &self.advance {
            Some(advance) => advance.update(|_, warnings| warnings.push(shown(&warning.to_string()))),
            None => self.bar.warned(warning),
        }
    }
    fn finish(&mut self) -> Result<(), ObserveError> {
        if self.advance.is_none() { self.bar.finish() } else { Ok(()) }
    }
}
