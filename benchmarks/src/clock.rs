//! How long work takes.

use std::time::Instant;

use examples::CaseError;
use examples::machine::Stopwatch;
use mpm_core::{Solver, Team};

/// Do work, and the seconds it took: on one thread those of the processor, whatever else the machine does; on several, those of the clock.
pub fn timed<R>(threads: usize, work: impl FnOnce() -> R) -> (R, f64) {
    let (thread, clock) = (Stopwatch::start(), Instant::now());
    let made = work();
    (made, if threads == 1 { thread.seconds() } else { clock.elapsed().as_secs_f64() })
}

/// A scene that was stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    /// Particles, or elements.
    pub points: usize,
    /// Steps timed.
    pub steps: u64,
    /// What they took, s: [`timed`].
    pub seconds: f64,
    /// All memory of the solver after them, bytes.
    pub bytes: usize,
}

impl Stepped {
    /// Updates of points in a second.
    pub fn updates_per_second(&self) -> f64 {
        self.points as f64 * self.steps as f64 / self.seconds
    }
    /// Bytes a point.
    pub fn bytes_per_point(&self) -> f64 {
        self.bytes as f64 / self.points as f64
    }
}

/// Make so many steps on so many threads, after a first one that makes what later ones find made.
///
/// # Errors
/// Threads that cannot be started; a step that breaks.
pub fn stepped(solver: &mut dyn Solver, threads: usize, steps: u64) -> Result<Stepped, CaseError> {
    solver.set_team(Team::new(threads)?);
    solver.step_at_most(f64::INFINITY)?;
    let (made, seconds) =
        timed(threads, || (0..steps).try_for_each(|_| solver.step_at_most(f64::INFINITY).map(|_| ())));
    made?;
    Ok(Stepped { points: solver.moving_points(), steps, seconds, bytes: solver.bytes() })
}
