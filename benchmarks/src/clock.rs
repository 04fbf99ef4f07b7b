//! Timing of work.

use std::time::Instant;

use examples::CaseError;
use examples::machine::Stopwatch;
use mpm_core::{Solver, Team};

/// Run work and return its time, s: processor time on one thread, independent of other load; wall-clock time on several threads.
pub fn timed<R>(threads: usize, work: impl FnOnce() -> R) -> (R, f64) {
    let (thread, clock) = (Stopwatch::start(), Instant::now());
    let made = work();
    (made, if threads == 1 { thread.seconds() } else { clock.elapsed().as_secs_f64() })
}

/// Timed run of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    /// Number of particles or elements.
    pub points: usize,
    /// Number of timed steps.
    pub steps: u64,
    /// Time of the steps, s: [`timed`].
    pub seconds: f64,
    /// Memory of the solver after the steps, bytes.
    pub bytes: usize,
}

impl Stepped {
    /// Point updates per second.
    pub fn updates_per_second(&self) -> f64 {
        self.points as f64 * self.steps as f64 / self.seconds
    }
    /// Bytes per point.
    pub fn bytes_per_point(&self) -> f64 {
        self.bytes as f64 / self.points as f64
    }
}

/// Time this number of steps on a number of threads, after a first step that is not timed and completes the
/// initialisation.
///
/// # Errors
/// The threads cannot be started, or a step fails.
pub fn stepped(solver: &mut dyn Solver, threads: usize, steps: u64) -> Result<Stepped, CaseError> {
    solver.set_team(Team::new(threads)?);
    solver.step_at_most(f64::INFINITY)?;
    let (made, seconds) =
        timed(threads, || (0..steps).try_for_each(|_| solver.step_at_most(f64::INFINITY).map(|_| ())));
    made?;
    Ok(Stepped { points: solver.moving_points(), steps, seconds, bytes: solver.bytes() })
}
