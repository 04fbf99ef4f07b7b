//! A run with observers.

use std::time::Instant;

use super::{Moment, ObserveError, Observer};
use crate::parallel::Float;
use crate::step::{Mpm, StepError};
use crate::watch::Warning;

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
    /// An end that cannot be reached.
    #[error("end = {end} s is not allowed; it must be finite and not before the time reached, {time} s")]
    End {
        /// The end given, s.
        end: f64,
        /// Simulated time, s.
        time: f64,
    },
}

/// What a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunSummary {
    /// Steps made.
    pub steps: u64,
    /// Seconds of wall-clock time spent in steps; observers are left out.
    pub wall_seconds: f64,
    /// Particle updates: the number of particles that do not rest ([`Mpm::let_rest`]), summed over steps.
    pub updates: f64,
}

impl RunSummary {
    /// Particle updates a second; 0 if no step was made.
    #[must_use]
    pub fn rate(&self) -> f64 {
        if self.wall_seconds > 0.0 { self.updates / self.wall_seconds } else { 0.0 }
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

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Step until `end` (s), which is met exactly, and show the scene to the observers when they are due.
    ///
    /// The steps are those of [`Mpm::run_until`], bit for bit: no step is shortened for an observer, which sees
    /// the first step that ends at or after its due time. All observers see the first and the last moment of
    /// the run, but none sees one step twice, so that a run may be continued with the same observers.
    ///
    /// # Errors
    /// A step that cannot be made, an observer that cannot look, an end before the time reached. Observers are
    /// told that the run is over in any case.
    pub fn run_observed(
        &mut self,
        end: f64,
        observers: &mut [&mut dyn Observer<T, D>],
    ) -> Result<RunSummary, RunError> {
        self.work().run_observed(self, end, observers)
    }

    pub(crate) fn run_observed_here(
        &mut self,
        end: f64,
        observers: &mut [&mut dyn Observer<T, D>],
    ) -> Result<RunSummary, RunError> {
        let result = self.steps_observed(end, observers);
        for observer in observers.iter_mut() {
            observer.finish();
        }
        result
    }

    fn steps_observed(
        &mut self,
        end: f64,
        observers: &mut [&mut dyn Observer<T, D>],
    ) -> Result<RunSummary, RunError> {
        let time = self.time();
        if !end.is_finite() || self.is_past(end) {
            return Err(RunError::End { end, time });
        }
        let mut run = RunSummary::default();
        show(&self.moment_of(end, &run), observers, true)?;
        while !self.reached(end) {
            run.updates += self.moving_particles() as f64;
            let start = Instant::now();
            let known = self.warnings().len();
            self.step_towards(end)?;
            run.wall_seconds += start.elapsed().as_secs_f64();
            run.steps += 1;
            tell(&self.warnings()[known..], observers);
            show(&self.moment_of(end, &run), observers, self.reached(end))?;
        }
        let known = self.warnings().len();
        self.look_at_the_end_here()?;
        tell(&self.warnings()[known..], observers);
        Ok(run)
    }

    fn moment_of(&self, end: f64, run: &RunSummary) -> Moment<'_, T, D> {
        Moment { end, updates: run.updates, wall_seconds: run.wall_seconds, ..self.moment() }
    }
}

fn tell<T: Float, const D: usize>(warnings: &[Warning], observers: &mut [&mut dyn Observer<T, D>]) {
    for warning in warnings {
        observers.iter_mut().for_each(|o| o.warned(warning));
    }
}

/// Let look who is due, or at an `edge` of the run everyone who has not seen this step.
fn show<T: Float, const D: usize>(
    now: &Moment<'_, T, D>,
    observers: &mut [&mut dyn Observer<T, D>],
    edge: bool,
) -> Result<(), RunError> {
    let (step, time) = (now.step(), now.time());
    for observer in observers {
        let pace = observer.pace();
        if pace.due(step, time) || (edge && !pace.has_seen(step)) {
            observer.observe(now).map_err(|source| RunError::Observe { time, source })?;
            observer.pace().looked(step, time);
        }
    }
    Ok(())
}
