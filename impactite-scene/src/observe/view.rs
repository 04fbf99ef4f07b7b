//! What observers see.

use std::cell::OnceCell;

use impactite_output::{OutputError, Snapshot};

use crate::body::{Body, Totals};
use crate::contact::{ContactPoint, PairContact};
use crate::exchange::Exchange;
use crate::observe::ObserveError;
use crate::solver::Solver;
use crate::summary::RunSummary;

/// A run between two steps.
pub struct RunView<'a> {
    solver: &'a (dyn Solver + 'static),
    end: f64,
    run: RunSummary,
    totals: OnceCell<Totals>,
}

impl<'a> RunView<'a> {
    /// Of a run to `end` (s) that has taken so much.
    #[must_use]
    pub fn new(solver: &'a (dyn Solver + 'static), end: f64, run: RunSummary) -> Self {
        RunView { solver, end, run, totals: OnceCell::new() }
    }

    /// Of a scene as it stands, without a run.
    #[must_use]
    pub fn of(solver: &'a (dyn Solver + 'static)) -> Self {
        RunView::new(solver, solver.time(), RunSummary::default())
    }

    /// The solver, for what only its method has: `downcast_ref`, or [`RunView::solver_as`].
    #[must_use]
    pub fn solver(&self) -> &'a (dyn Solver + 'static) {
        self.solver
    }
    /// The solver as the type that it is.
    ///
    /// # Errors
    /// It is of another type.
    pub fn solver_as<S: Solver>(&self) -> Result<&'a S, ObserveError> {
        let wanted = || ObserveError::OtherSolver { wanted: std::any::type_name::<S>() };
        self.solver.downcast_ref().ok_or_else(wanted)
    }
    /// Simulated time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.solver.time()
    }
    /// When the run ends, s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }
    /// Steps made since the scene was set up.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.solver.steps()
    }
    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> Vec<&'a dyn Body> {
        self.solver.bodies()
    }
    /// The pairs of bodies that were ever in contact: force, places and gap in the last step, energy since the start.
    #[must_use]
    pub fn contacts(&self) -> Vec<PairContact> {
        self.solver.contacts()
    }
    /// The places of contact in the last step, with gap, normal and impulse.
    #[must_use]
    pub fn contact_points(&self) -> Vec<ContactPoint> {
        self.solver.contact_points()
    }
    /// What boundaries and loads gave to the material since the start, and what contact took.
    #[must_use]
    pub fn exchange(&self) -> Exchange {
        self.solver.exchange()
    }
    /// Are the coordinates (r, z) of a body of revolution? Then extensive quantities are per radian.
    #[must_use]
    pub fn axisymmetric(&self) -> bool {
        self.solver.axisymmetric()
    }
    /// Seconds of wall-clock time spent in the steps of this run so far, observers left out.
    #[must_use]
    pub fn wall_seconds(&self) -> f64 {
        self.run.wall_seconds
    }
    /// Point updates a second in this run so far; 0 before its first step.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.run.rate()
    }
    /// Totals over all bodies, added up once however many observers ask.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        self.totals.get_or_init(|| self.solver.totals())
    }
    /// All points of all bodies as pictures and files want them: [`Solver::snapshot`].
    ///
    /// # Errors
    /// A scene without points, or law state names that cannot be field names.
    pub fn snapshot(&self) -> Result<Snapshot, OutputError> {
        self.solver.snapshot()
    }
}
