//! Interface of a method for the run loop, observers, checkpoints and restart.

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

/// Scene of a method with time steps.
///
/// A custom method has about a dozen short methods beside its physics: see the book, and `solver_conforms!` (feature `conformance`), which
/// tests it.
pub trait Solver: Any + Send {
    /// Description of the method in one line; unchanged in a resumed scene.
    fn method(&self) -> String;
    /// Dimensions of the scene, 1 to 3.
    fn dimensions(&self) -> usize;
    /// True if the coordinates are (r, z) of a body of revolution. Then extensive quantities are per radian.
    fn axisymmetric(&self) -> bool {
        false
    }
    /// Simulated time and step count.
    fn clock(&self) -> &Clock;
    /// Mutable access to the clock.
    fn clock_mut(&mut self) -> &mut Clock;
    /// Return the largest stable step from now, s, by the scene's time control.
    ///
    /// # Errors
    /// Wave speeds that do not define a step.
    fn stable_step(&mut self) -> Result<f64, StepError>;
    /// Make one step of at most `left` seconds (infinite for no limit), advance the clock by it, and return its size, s.
    ///
    /// # Errors
    /// Body, point, position and cause of a failure. A stopped run stays stopped.
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError>;
    /// Set the thread pool. Results are the same bits for any number of threads.
    fn set_team(&mut self, team: Team);
    /// Bodies of the scene; a body number is an index into this list.
    fn bodies(&self) -> Vec<&dyn Body>;
    /// Exchange of the scene with its surroundings since its start.
    fn exchange(&self) -> Exchange;
    /// Write or read everything that changes in a run, and store or compare the constants of the scene ([`Archive::same`]). Reading
    /// restores the scene as it was when the file was written.
    ///
    /// # Errors
    /// I/O error; damaged file; another scene.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// Error that stopped the run. A stopped run makes no step.
    fn stopped_by(&self) -> Option<&StepError> {
        None
    }
    /// Check the run at its end, unless every step does so.
    ///
    /// # Errors
    /// A finding that stops the run ([`crate::watch`]).
    fn look_at_the_end(&mut self) -> Result<(), StepError> {
        Ok(())
    }
    /// Warnings so far.
    fn warnings(&self) -> &[Warning] {
        &[]
    }
    /// Balances of energy and momentum since the first step, from the present [`Solver::totals`]; zero if the method has none.
    fn account_of(&self, totals: &Totals) -> Account {
        let _ = totals;
        Account::default()
    }
    /// Balances of energy and momentum since the first step; zero if the method has none.
    fn account(&self) -> Account {
        self.account_of(&self.totals())
    }
    /// Pairs of bodies that were ever in contact: force, contact points and gap in the last step, energy since the start.
    fn contacts(&self) -> Vec<PairContact> {
        Vec::new()
    }
    /// Contact points of the last step.
    fn contact_points(&self) -> Vec<ContactPoint> {
        Vec::new()
    }
    /// Wall-clock times, s, of stages of the steps so far; the time of the remaining stages, nodes and conditions in the material point
    /// method, is that of the steps without these. Empty if the method does not measure them.
    fn stage_seconds(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
    /// Sizes of the cells, m, from the largest to the smallest that the scene may have, each with the number of points there. Empty for
    /// methods without cells.
    fn points_by_cell(&self) -> Vec<(f64, usize)> {
        Vec::new()
    }
    /// Limit of the next time step, if the method knows it.
    fn limited_by(&self) -> Option<StepLimit> {
        None
    }
    /// Number of points that a step moves: all but those of deactivated bodies.
    fn moving_points(&self) -> usize {
        self.bodies().iter().map(|b| b.len()).sum()
    }
    /// Memory of bodies and scratch, bytes.
    fn bytes(&self) -> usize {
        self.bodies().iter().map(|b| b.bytes()).sum()
    }
    /// Tolerance of the clock at an end time, s: the rounding error of a step of `dt` seconds.
    fn clock_rounding(&self, dt: f64) -> f64 {
        4.0 * f64::EPSILON * dt
    }

    /// Simulated time, s.
    #[must_use]
    fn time(&self) -> f64 {
        self.clock().time
    }
    /// Number of steps.
    #[must_use]
    fn steps(&self) -> u64 {
        self.clock().steps
    }
    /// True if the time has reached `end`, s.
    #[must_use]
    fn reached(&self, end: f64) -> bool {
        self.clock().reached(end)
    }
    /// Sums over all bodies.
    #[must_use]
    fn totals(&self) -> Totals {
        self.bodies().iter().fold(Totals::default(), |sum, b| sum.plus(&b.totals()))
    }
    /// Make one step, shortened to end at exactly `end`, s, if it would go beyond.
    ///
    /// # Errors
    /// Those of [`Solver::step_at_most`]; an end that is not finite, or that is reached.
    fn step_towards(&mut self, end: f64) -> Result<f64, StepError> {
        self.clock().check_end(end)?;
        let (time, before) = (self.clock().time, self.clock().last);
        let dt = self.step_at_most(end - time)?;
        let rounding = self.clock_rounding(dt);
        self.clock_mut().arrive(end, rounding, before);
        Ok(dt)
    }

    /// Step until exactly `end`, s.
    ///
    /// # Errors
    /// Those of [`Solver::step_at_most`]; an end that is not finite, or before the current time.
    fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        if !end.is_finite() || self.clock().is_past(end) {
            return Err(self.clock().refused("end", end, "finite and not before the time reached"));
        }
        while !self.reached(end) {
            self.step_towards(end)?;
        }
        self.look_at_the_end()
    }

    /// Return all points of all bodies for pictures and files.
    ///
    /// Fields: `velocity` (m/s), `stress` (Cauchy, Pa), `pressure` (compression positive, Pa), `von_mises` (Pa), `particle` (number in its
    /// body), then every state variable of the laws, by [`Body::state_names`]; NaN for bodies whose law does not have it. `stress_xx` and
    /// its five companions are omitted, being in `stress`; a name already in use gets the prefix `state_`.
    ///
    /// Bodies are numbered in their order, from 0.
    ///
    /// # Errors
    /// A scene without points, or law state names that cannot be field names.
    fn snapshot(&self) -> Result<Snapshot, OutputError> {
        gather(self.dimensions(), self.axisymmetric(), self.clock(), &self.bodies())
    }

    /// Write a checkpoint to the file `path`, which is replaced atomically ([`WholeFile`](impactite_output::WholeFile)).
    ///
    /// # Errors
    /// A path that is no regular file; a file that cannot be written; a stopped run. Then the old file stays.
    fn save(&mut self, path: &Path) -> Result<(), CheckpointError> {
        not_stopped(self)?;
        let mut file = Archive::create(path)?;
        file.same("kind of file", TITLE)?;
        archive_body(self, &mut file)?;
        // Empty summary of a run, and no observers.
        RunSummary::default().archive(&mut file)?;
        file.count(&mut 0)?;
        file.close()
    }

    /// Restore this scene from the checkpoint `path`. The scene must be set up as the saved one was at its start; its constants are
    /// compared with the checkpoint. Data of observers, in a checkpoint of a [`Run`](crate::Run), are skipped.
    ///
    /// # Errors
    /// A file that cannot be read or is damaged; another scene. The scene is then unusable.
    fn resume(&mut self, path: &Path) -> Result<(), CheckpointError> {
        let mut file = Archive::open(path)?;
        file.same("kind of file", TITLE)?;
        archive_body(self, &mut file)?;
        file.skip_rest()?;
        file.close()
    }
}

impl dyn Solver {
    /// Return the solver as an `S`, if it is one.
    #[must_use]
    pub fn downcast_ref<S: Solver>(&self) -> Option<&S> {
        (self as &dyn Any).downcast_ref()
    }
}

/// Check that the run was not stopped, since a stopped run is not saved.
pub(crate) fn not_stopped<S: Solver + ?Sized>(solver: &S) -> Result<(), CheckpointError> {
    match solver.stopped_by() {
        Some(error) => Err(CheckpointError::Stopped(Box::new(error.clone()))),
        None => Ok(()),
    }
}

/// Write or read the solver, after a comparison of method and dimension.
pub(crate) fn archive_body<S: Solver + ?Sized>(
    solver: &mut S,
    file: &mut Archive,
) -> Result<(), CheckpointError> {
    file.same("method", &solver.method())?;
    file.same("dimension", &solver.dimensions().to_string())?;
    solver.archive(file)
}

/// Header of checkpoints.
pub(crate) const TITLE: &str = "impactite checkpoint 14";
/// Header of checkpoints of runs with a preface.
pub(crate) const PREFACED: &str = "impactite checkpoint 14 with a preface";
