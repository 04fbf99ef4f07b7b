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

/// Why a run stopped early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A step could not be made.
    #[error(transparent)]
    Step(#[from] StepError),
    /// An observer could not look.
    #[error("observer at t = {time:.6e} s: {source}")]
    Observe {
        /// Simulated time, s.
        time: f64,
        /// What it said.
        source: ObserveError,
    },
    /// A checkpoint could not be written or read.
    #[error("checkpoint at t = {time:.6e} s: {source}")]
    Checkpoint {
        /// Simulated time, s.
        time: f64,
        /// What was wrong with it.
        source: CheckpointError,
    },
    /// It was [asked to stop](Run::stop_when).
    #[error("the run was asked to stop at t = {time:.6e} s, after {steps} steps{}", saved.as_ref().map_or(String::new(), |p| format!("; it goes on from `{}`", p.display())))]
    Interrupted {
        /// Simulated time, s.
        time: f64,
        /// Steps made since the scene was set up.
        steps: u64,
        /// The checkpoint that was written.
        saved: Option<PathBuf>,
    },
    /// An end that cannot be reached.
    #[error("end = {end} s is not allowed; it must be finite and not before the time reached, {time} s")]
    End {
        /// The end given, s.
        end: f64,
        /// Simulated time, s.
        time: f64,
    },
}

/// When checkpoints are written.
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

/// What a program has in its checkpoints before solver and observers, to a file or from one.
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
    /// Did it go on from a checkpoint, in whose run the observers looked when they were due?
    resumed: bool,
}

impl<'a> Run<'a> {
    /// Of this solver, without observers and checkpoints.
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

    /// Show the run to an observer, too.
    #[must_use]
    pub fn observe(mut self, observer: &'a mut dyn Observer) -> Self {
        self.observers.push(observer);
        self
    }

    /// Show the run to these observers, too.
    #[must_use]
    pub fn observe_all(mut self, observers: impl IntoIterator<Item = &'a mut dyn Observer>) -> Self {
        self.observers.extend(observers);
        self
    }

    /// Write a checkpoint, of the scene and of what the observers keep, to the file `path` at this pace. It is the old one or the
    /// new one at any time, never half.
    #[must_use]
    pub fn checkpoint(self, path: impl Into<PathBuf>, mut pace: Pace) -> Self {
        pace.looked(self.solver.steps(), self.solver.time());
        self.with_checkpoints(path.into(), Every::Pace(pace))
    }

    /// The same after the first step that ends so long after the last checkpoint, on the clock on the wall: that was at `last`,
    /// now or in an earlier piece of a run.
    #[must_use]
    pub fn checkpoint_by_clock(self, path: impl Into<PathBuf>, interval: Duration, last: Instant) -> Self {
        let run = self.with_checkpoints(path.into(), Every::WallClock(interval));
        Run { checkpoints: run.checkpoints.map(|c| Checkpoints { last, ..c }), ..run }
    }

    fn with_checkpoints(self, path: PathBuf, every: Every) -> Self {
        let checkpoints = Some(Checkpoints { path, every, last: Instant::now(), written: 0 });
        Run { checkpoints, ..self }
    }

    /// Have what `preface` says in the checkpoints, too, before solver and observers: what else a program must know to go on. It
    /// is called whenever a checkpoint is written or read. A file with a preface is for runs with one, and says so to others.
    #[must_use]
    pub fn preface(
        self,
        preface: &'a mut (dyn FnMut(&mut Archive) -> Result<(), CheckpointError> + 'a),
    ) -> Self {
        Run { preface: Some(preface), ..self }
    }

    /// Stop after the step in which `stop` becomes true, with a checkpoint if the run writes any, and [`RunError::Interrupted`]: for signals.
    #[must_use]
    pub fn stop_when(self, stop: &'a AtomicBool) -> Self {
        Run { stop: Some(stop), ..self }
    }

    /// The checkpoint `path` of a run with a [preface](Run::preface), to be read from the preface on.
    ///
    /// # Errors
    /// A file that cannot be read, is damaged, or has no preface.
    pub fn preface_of(path: impl AsRef<Path>) -> Result<Archive, CheckpointError> {
        let mut file = Archive::open(path.as_ref())?;
        file.same("kind of file", PREFACED)?;
        Ok(file)
    }

    /// Bring the scene, set up as at its start, and the observers, just made, to where those of the run stood that wrote the
    /// checkpoint `path`. What follows is what would have followed there, bit for bit, files of the observers included.
    ///
    /// # Errors
    /// A file that cannot be read or is damaged; another scene; other observers. The scene is then not to be used.
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

    /// The preface, the solver, what the run took so far, and the observers.
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
        // A scene that was saved without a run says nothing of observers: they begin anew.
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

    /// What the run took, whether it reached its end or stopped.
    #[must_use]
    pub fn summary(&self) -> RunSummary {
        self.summary
    }

    /// When the last checkpoint was written: as it was given, or when the run was made, if there was none yet.
    #[must_use]
    pub fn last_checkpoint(&self) -> Option<Instant> {
        self.checkpoints.as_ref().map(|c| c.last)
    }

    /// How many checkpoints were written.
    #[must_use]
    pub fn checkpoints(&self) -> usize {
        self.checkpoints.as_ref().map_or(0, |c| c.written)
    }

    /// Step until `end` (s), which is met exactly, or until an observer [ends the run](Observer::ends_run), and show the scene to the observers when they are due.
    ///
    /// No step is shortened for an observer, which sees the first step that ends at or after its due time. All observers see the
    /// first and the last moment of the run, but none sees one step twice, so that a run may be continued with the same observers.
    ///
    /// # Errors
    /// A step that cannot be made, an observer that cannot look, a checkpoint that cannot be written, an end before the time
    /// reached. Observers are told that the run is over in any case.
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
            // Before observers see the last moment, which knows then what is rest.
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
        // A run that had no step to make.
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

    /// Let look who is due, or at an `edge` of the run everyone who has not seen this step.
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

    /// Write a checkpoint, where the run writes any.
    ///
    /// # Errors
    /// A file that cannot be written; a run that was stopped.
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
