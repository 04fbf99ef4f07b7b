//! What the run loop, observers, checkpoints and restart need of a method, and nothing else.

use std::any::Any;
use std::path::Path;

use impactite_output::{OutputError, Snapshot};
use impactite_simd::Team;

use crate::archive::{Archive, CheckpointError};
use crate::balance::Account;
use crate::body::{Body, Totals};
use crate::clock::Clock;
use crate::contact::{ContactPoint, PairContact};
use crate::control::StepLimit;
use crate::error::StepError;
use crate::exchange::Exchange;
use crate::finding::Warning;
use crate::snapshot::gather;
use crate::summary::RunSummary;

/// A scene of a method that goes on by steps.
///
/// A method of one's own is about a dozen short methods beside its physics: see the book, and `solver_conforms!`
/// (feature `conformance`), which tests it.
pub trait Solver: Any + Send {
    /// The method, in a line of words; the same in a scene that is resumed.
    fn method(&self) -> String;
    /// Dimensions of the scene, 1 to 3.
    fn dimensions(&self) -> usize;
    /// Are the coordinates (r, z) of a body of revolution? Then extensive quantities are per radian.
    fn axisymmetric(&self) -> bool {
        false
    }
    /// Time and steps.
    fn clock(&self) -> &Clock;
    /// The same, to be set.
    fn clock_mut(&mut self) -> &mut Clock;
    /// The largest stable step from now, s, by the scene's time control.
    ///
    /// # Errors
    /// Wave speeds that give none.
    fn stable_step(&mut self) -> Result<f64, StepError>;
    /// Make one step, of at most `left` seconds (infinite for no limit), and advance the clock by it. Returns its size, s.
    ///
    /// # Errors
    /// Names body, point, place and cause of what stopped it. A run that was stopped stays so.
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError>;
    /// Run on these threads. Results are the same bits for any number.
    fn set_team(&mut self, team: Team);
    /// The bodies; their numbers are places in this list.
    fn bodies(&self) -> Vec<&dyn Body>;
    /// What the scene exchanged with its surroundings since its start.
    fn exchange(&self) -> Exchange;
    /// Everything that changes in a run, to a file or from one; and what the scene is made of, to be compared
    /// ([`Archive::same`]). Reading leaves the scene as it stood when the file was written.
    ///
    /// # Errors
    /// The file; another scene.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// What stopped the run, after which it makes no step.
    fn stopped_by(&self) -> Option<&StepError> {
        None
    }
    /// Look at the run at its end, where that is not done with every step.
    ///
    /// # Errors
    /// A run that is not to be trusted ([`crate::watch`]).
    fn look_at_the_end(&mut self) -> Result<(), StepError> {
        Ok(())
    }
    /// What the run warned of so far.
    fn warnings(&self) -> &[Warning] {
        &[]
    }
    /// Balances of energy and momentum since the first step; empty where none are kept.
    fn account(&self) -> Account {
        Account::default()
    }
    /// The pairs of bodies that were ever in contact: force, places and gap in the last step, energy since the start.
    fn contacts(&self) -> Vec<PairContact> {
        Vec::new()
    }
    /// The places of contact in the last step.
    fn contact_points(&self) -> Vec<ContactPoint> {
        Vec::new()
    }
    /// What limits the next step, where the method knows.
    fn limited_by(&self) -> Option<StepLimit> {
        None
    }
    /// Points that a step moves: all but those of deactivated bodies.
    fn moving_points(&self) -> usize {
        self.bodies().iter().map(|b| b.len()).sum()
    }
    /// Bytes of memory of bodies and scratch.
    fn bytes(&self) -> usize {
        self.bodies().iter().map(|b| b.bytes()).sum()
    }
    /// What of a step of `dt` seconds may be rounding where the clock meets an end, s.
    fn clock_rounding(&self, dt: f64) -> f64 {
        4.0 * f64::EPSILON * dt
    }

    /// Simulated time, s.
    #[must_use]
    fn time(&self) -> f64 {
        self.clock().time
    }
    /// Steps made.
    #[must_use]
    fn steps(&self) -> u64 {
        self.clock().steps
    }
    /// Has the time come to `end`, s?
    #[must_use]
    fn reached(&self, end: f64) -> bool {
        self.clock().reached(end)
    }
    /// Sums over all bodies.
    #[must_use]
    fn totals(&self) -> Totals {
        self.bodies().iter().fold(Totals::default(), |sum, b| sum.plus(&b.totals()))
    }
    /// Make one step, shortened if it would go beyond `end`, s, which is then met exactly.
    ///
    /// # Errors
    /// As [`Solver::step_at_most`]; an end that is not finite, or that is reached.
    fn step_towards(&mut self, end: f64) -> Result<f64, StepError> {
        self.clock().check_end(end)?;
        let (time, before) = (self.clock().time, self.clock().last);
        let dt = self.step_at_most(end - time)?;
        let rounding = self.clock_rounding(dt);
        self.clock_mut().arrive(end, rounding, before);
        Ok(dt)
    }

    /// Step until `end`, s, which is met exactly.
    ///
    /// # Errors
    /// As [`Solver::step_at_most`]; an end that is not finite, or before the time reached.
    fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        if !end.is_finite() || self.clock().is_past(end) {
            return Err(self.clock().refused("end", end, "finite and not before the time reached"));
        }
        while !self.reached(end) {
            self.step_towards(end)?;
        }
        self.look_at_the_end()
    }

    /// All points of all bodies as pictures and files want them.
    ///
    /// Fields: `velocity` (m/s), `stress` (Cauchy, Pa), `pressure` (compression positive, Pa), `von_mises` (Pa), `particle` (its
    /// number in its body), then every number the laws keep, by [`Body::state_names`]; NaN for bodies whose law keeps no such
    /// number. `stress_xx` and its five companions are left out, being in `stress`; a name already taken gets `state_` before it.
    ///
    /// Bodies are numbered in their order, from 0.
    ///
    /// # Errors
    /// A scene without points, or law state names that cannot be field names.
    fn snapshot(&self) -> Result<Snapshot, OutputError> {
        gather(self.dimensions(), self.axisymmetric(), self.clock(), &self.bodies())
    }

    /// Write a checkpoint to the file `path`, which is the old one or the new one at any time, never half
    /// ([`WholeFile`](impactite_output::WholeFile)).
    ///
    /// # Errors
    /// A path that is no regular file; a file that cannot be written; a run that was stopped. Then the old one stays.
    fn save(&mut self, path: &Path) -> Result<(), CheckpointError> {
        not_stopped(self)?;
        let mut file = Archive::create(path)?;
        file.same("kind of file", TITLE)?;
        archive_body(self, &mut file)?;
        // No run, and no observers.
        RunSummary::default().archive(&mut file)?;
        file.count(&mut 0)?;
        file.close()
    }

    /// Bring this scene, set up as the one that was saved to `path` was at its start, to where that stood when it was saved. What
    /// it is made of is compared with what the checkpoint says. What observers kept, if the checkpoint is that of a
    /// [`Run`](crate::Run), is left out.
    ///
    /// # Errors
    /// A file that cannot be read or is damaged; another scene. The scene is then not to be used.
    fn resume(&mut self, path: &Path) -> Result<(), CheckpointError> {
        let mut file = Archive::open(path)?;
        file.same("kind of file", TITLE)?;
        archive_body(self, &mut file)?;
        file.skip_rest()?;
        file.close()
    }
}

impl dyn Solver {
    /// This solver as what it is, if it is an `S`.
    #[must_use]
    pub fn downcast_ref<S: Solver>(&self) -> Option<&S> {
        (self as &dyn Any).downcast_ref()
    }
}

/// A run that was stopped is not saved.
pub(crate) fn not_stopped<S: Solver + ?Sized>(solver: &S) -> Result<(), CheckpointError> {
    match solver.stopped_by() {
        Some(error) => Err(CheckpointError::Stopped(Box::new(error.clone()))),
        None => Ok(()),
    }
}

/// The solver, and what it is.
pub(crate) fn archive_body<S: Solver + ?Sized>(
    solver: &mut S,
    file: &mut Archive,
) -> Result<(), CheckpointError> {
    file.same("method", &solver.method())?;
    file.same("dimension", &solver.dimensions().to_string())?;
    solver.archive(file)
}

/// How checkpoints begin.
pub(crate) const TITLE: &str = "impactite checkpoint 10";
/// How those of runs with a preface do.
pub(crate) const PREFACED: &str = "impactite checkpoint 10 with a preface";
