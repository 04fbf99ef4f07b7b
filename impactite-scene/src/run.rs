//! The run loop: steps, observers, checkpoints and restart, for a solver of any method.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::archive::{Archive, CheckpointError};
use crate::error::StepError;
use crate::finding::Warning;
use crate::observe::{ObserveError, Observer, Pace, RunView};
use crate::solver::{PREFACED, Solver, TITLE, archive_body, not_stopped};
use crate::summary::RunSummary;

/// Error that stopped a run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// Failed step.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Failed observation.
    #[error("observer at t = {time:.6e} s: {source}")]
    Observe {
        /// Simulated time, s.
        time: f64,
        /// Error of the observer.
        source: ObserveError,
    },
    /// Failed write or read of a checkpoint.
    #[error("checkpoint at t = {time:.6e} s: {source}")]
    Checkpoint {
        /// Simulated time, s.
        time: f64,
        /// Error of the checkpoint.
        source: CheckpointError,
    },
    /// Run that was [asked to stop](Run::stop_when).
    #[error("the run was asked to stop at t = {time:.6e} s, after {steps} steps{}", saved.as_ref().map_or(String::new(), |p| format!("; it goes on from `{}`", p.display())))]
    Interrupted {
        /// Simulated time, s.
        time: f64,
        /// Number of steps since the scene was set up.
        steps: u64,
        /// Path of the checkpoint that was written, if any.
        saved: Option<PathBuf>,
    },
    /// Invalid end time.
    #[error("end = {end} s is not allowed; it must be finite and not before the time reached, {time} s")]
    End {
        /// End time given, s.
        end: f64,
        /// Simulated time, s.
        time: f64,
    },
}

/// Schedule of checkpoints.
#[derive(Clone, Copy, Debug)]
enum Every {
    Pace(Pace),
    WallClock(Duration),
}

#[derive(Debug)]
struct Checkpoints {
    path: PathBuf,
    every: Every,
    last: Instant,
    written: usize,
}

/// Function that writes or reads program data before solver and observers in a checkpoint.
type Preface<'a> = dyn FnMut(&mut Archive) -> Result<(), CheckpointError> + 'a;

/// A run of a solver with observers and checkpoints.
///
/// ```
/// # use impactite_scene::{Run, RunError, RunSummary, Solver};
/// use impactite_scene::observe::{Ledger, Pace};
///
/// fn run(scene: &mut dyn Solver) -> Result<RunSummary, Box<dyn std::error::Error>> {
///     let mut ledger = Ledger::new(Pace::interval(1.0e-6)?);
///     let summary = Run::new(scene)
///         .observe(&mut ledger)
///         .checkpoint("run.checkpoint", Pace::interval(10.0e-6)?)
///         .until(80.0e-6)?;
///     println!("energy within {:.1e}, {:.2e} updates a second", ledger.worst_energy_error(), summary.rate());
///     Ok(summary)
/// }
/// ```
pub struct Run<'a> {
    solver: &'a mut (dyn Solver + 'static),
    observers: Vec<&'a mut dyn Observer>,
    checkpoints: Option<Checkpoints>,
    preface: Option<&'a mut Preface<'a>>,
    stop: Option<&'a AtomicBool>,
    summary: RunSummary,
    /// True after a resume: observers are not called for the first moment again.
    resumed: bool,
}

impl<'a> Run<'a> {
    /// Create a run of this solver, without observers and checkpoints.
    pub fn new(solver: &'a mut (dyn Solver + 'static)) -> Self {
        let summary = RunSummary::default();
        Run {
            solver,
            observers: Vec::new(),
            checkpoints: None,
            preface: None,
            stop: None,
            summary,
            resumed: false,
        }
    }

    /// Add an observer.
    #[must_use]
    pub fn observe(mut self, observer: &'a mut dyn Observer) -> Self {
        self.observers.push(observer);
        self
    }

    /// Add observers.
    #[must_use]
    pub fn observe_all(mut self, observers: impl IntoIterator<Item = &'a mut dyn Observer>) -> Self {
        self.observers.extend(observers);
        self
    }

    /// Write a checkpoint of the scene and the observers to the file `path` at this pace. The file is replaced atomically.
    #[must_use]
    pub fn checkpoint(self, path: impl Into<PathBuf>, mut pace: Pace) -> Self {
        pace.looked(self.solver.steps(), self.solver.time());
        self.with_checkpoints(path.into(), Every::Pace(pace))
    }

    /// Write a checkpoint after the first step that ends at least `interval` of wall-clock time after the last checkpoint. `last` is the
    /// time of the last one: now, or in an earlier part of the run.
    #[must_use]
    pub fn checkpoint_by_clock(self, path: impl Into<PathBuf>, interval: Duration, last: Instant) -> Self {
        let run = self.with_checkpoints(path.into(), Every::WallClock(interval));
        Run { checkpoints: run.checkpoints.map(|c| Checkpoints { last, ..c }), ..run }
    }

    fn with_checkpoints(self, path: PathBuf, every: Every) -> Self {
        let checkpoints = Some(Checkpoints { path, every, last: Instant::now(), written: 0 });
        Run { checkpoints, ..self }
    }

    /// Add program data to the checkpoints, before solver and observers. `preface` is called whenever a checkpoint is written or read. A
    /// run without a preface rejects a file with one, and the other way round.
    #[must_use]
    pub fn preface(
        self,
        preface: &'a mut (dyn FnMut(&mut Archive) -> Result<(), CheckpointError> + 'a),
    ) -> Self {
        Run { preface: Some(preface), ..self }
    }

    /// Stop after the step in which `stop` becomes true, for signals: write a checkpoint, if the run has any, and return
    /// [`RunError::Interrupted`].
    #[must_use]
    pub fn stop_when(self, stop: &'a AtomicBool) -> Self {
        Run { stop: Some(stop), ..self }
    }

    /// Open the checkpoint `path` of a run with a [preface](Run::preface), to be read from the preface on.
    ///
    /// # Errors
    /// A file that cannot be read, is damaged, or has no preface.
    pub fn preface_of(path: impl AsRef<Path>) -> Result<Archive, CheckpointError> {
        let mut file = Archive::open(path.as_ref())?;
        file.same("kind of file", PREFACED)?;
        Ok(file)
    }

    /// Restore the scene, set up as at its start, and new observers from the checkpoint `path`. The continued run is the same as the saved
    /// one, bit for bit, files of the observers included.
    ///
    /// # Errors
    /// A file that cannot be read or is damaged; another scene; other observers. The scene is then unusable.
    pub fn resume(mut self, path: impl AsRef<Path>) -> Result<Self, RunError> {
        let time = self.solver.time();
        let read = Archive::open(path.as_ref()).and_then(|mut file| {
            self.archive(&mut file)?;
            file.close()
        });
        read.map_err(|source| RunError::Checkpoint { time, source })?;
        self.resumed = true;
        Ok(self)
    }

    /// Write or read the preface, the solver, the summary and the observers.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        match &mut self.preface {
            Some(preface) => {
                file.same("kind of file", PREFACED)?;
                preface(file)?;
            }
            None => file.same("kind of file", TITLE)?,
        }
        archive_body(self.solver, file)?;
        self.summary.archive(file)?;
        let mut count = self.observers.len();
        file.count(&mut count)?;
        // A checkpoint of a scene without a run has no observers: they keep their initial state.
        if file.reads() && count == 0 {
            return Ok(());
        }
        if count != self.observers.len() {
            let (saved, here) = (count.to_string(), self.observers.len().to_string());
            return Err(CheckpointError::OtherScene { what: "number of observers".into(), saved, here });
        }
        for observer in &mut self.observers {
            observer.pace().archive(file)?;
            observer.archive(file)?;
        }
        Ok(())
    }

    /// Return the cost of the run, whether it reached its end or stopped.
    #[must_use]
    pub fn summary(&self) -> RunSummary {
        self.summary
    }

    /// Return the time of the last checkpoint; before the first one, the time given or that of the creation of the run.
    #[must_use]
    pub fn last_checkpoint(&self) -> Option<Instant> {
        self.checkpoints.as_ref().map(|c| c.last)
    }

    /// Number of checkpoints written.
    #[must_use]
    pub fn checkpoints(&self) -> usize {
        self.checkpoints.as_ref().map_or(0, |c| c.written)
    }

    /// Step until exactly `end` (s), or until an observer [ends the run](Observer::ends_run), and call the observers when they are due.
    ///
    /// No step is shortened for an observer, which is called after the first step that ends at or after its due time. All observers are
    /// called at the start and at the end of the run, but none twice at one step, so that a run may be continued with the same observers.
    ///
    /// # Errors
    /// A step, observation or checkpoint that failed, or an end before the current time. [`Observer::finish`] is called in any case.
    pub fn until(&mut self, end: f64) -> Result<RunSummary, RunError> {
        let mut result = self.steps(end);
        let time = self.solver.time();
        for observer in &mut self.observers {
            if let Err(source) = observer.finish() {
                result = result.and(Err(RunError::Observe { time, source }));
            }
        }
        result
    }

    fn steps(&mut self, end: f64) -> Result<RunSummary, RunError> {
        let time = self.solver.time();
        if !end.is_finite() || self.solver.clock().is_past(end) {
            return Err(RunError::End { end, time });
        }
        let begins = !std::mem::take(&mut self.resumed);
        if begins {
            self.summary = RunSummary::default();
        }
        self.show(end, begins)?;
        while !self.solver.reached(end) && !self.ended_by_observers() {
            let (points, known) = (self.solver.moving_points() as f64, self.solver.warnings().len());
            let start = Instant::now();
            self.solver.step_towards(end)?;
            self.summary.wall_seconds += start.elapsed().as_secs_f64();
            self.summary.updates += points;
            self.summary.steps += 1;
            let mut reached = self.solver.reached(end);
            // The check precedes the last observation, which needs the energy of rest.
            let mut looked = if reached { self.solver.look_at_the_end() } else { Ok(()) };
            self.tell(known);
            self.show(end, reached)?;
            if !reached && self.ended_by_observers() {
                let known = self.solver.warnings().len();
                reached = true;
                looked = self.solver.look_at_the_end();
                self.tell(known);
                self.show(end, reached)?;
            }
            looked?;
            self.save_if_due()?;
            if self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) && !reached {
                self.save()?;
                let saved = self.checkpoints.as_ref().map(|c| c.path.clone());
                let (time, steps) = (self.solver.time(), self.solver.steps());
                return Err(RunError::Interrupted { time, steps, saved });
            }
        }
        // A run without steps.
        let known = self.solver.warnings().len();
        let looked = self.solver.look_at_the_end();
        self.tell(known);
        looked?;
        Ok(self.summary)
    }

    fn ended_by_observers(&self) -> bool {
        self.observers.iter().any(|observer| observer.ends_run())
    }

    fn tell(&mut self, known: usize) {
        let warnings: &[Warning] = &self.solver.warnings()[known..];
        for warning in warnings {
            self.observers.iter_mut().for_each(|o| o.warned(warning));
        }
    }

    /// Call the observers that are due, or at an `edge` of the run all that have not observed this step.
    fn show(&mut self, end: f64, edge: bool) -> Result<(), RunError> {
        let (step, time) = (self.solver.steps(), self.solver.time());
        let now = RunView::new(self.solver, end, self.summary);
        for observer in &mut self.observers {
            let pace = observer.pace();
            if pace.due(step, time) || (edge && !pace.has_seen(step)) {
                observer.observe(&now).map_err(|source| RunError::Observe { time, source })?;
                observer.pace().looked(step, time);
            }
        }
        Ok(())
    }

    fn save_if_due(&mut self) -> Result<(), RunError> {
        let Some(checkpoints) = &mut self.checkpoints else { return Ok(()) };
        let (step, time) = (self.solver.steps(), self.solver.time());
        let due = match &mut checkpoints.every {
            Every::Pace(pace) => {
                let due = pace.due(step, time);
                if due {
                    pace.looked(step, time);
                }
                due
            }
            Every::WallClock(interval) => checkpoints.last.elapsed() >= *interval,
        };
        if due { self.save() } else { Ok(()) }
    }

    /// Write a checkpoint, if the run has any.
    ///
    /// # Errors
    /// A file that cannot be written; a stopped run.
    pub fn save(&mut self) -> Result<(), RunError> {
        let Some(checkpoints) = &self.checkpoints else { return Ok(()) };
        let (path, time) = (checkpoints.path.clone(), self.solver.time());
        let written = not_stopped(self.solver).and_then(|()| {
            let mut file = Archive::create(&path)?;
            self.archive(&mut file)?;
            file.close()
        });
        written.map_err(|source| RunError::Checkpoint { time, source })?;
        if let Some(checkpoints) = &mut self.checkpoints {
            (checkpoints.last, checkpoints.written) = (Instant::now(), checkpoints.written + 1);
        }
        Ok(())
    }
}
