//! View of a run for observers.

use std::cell::OnceCell;

use impactite_output::{OutputError, Snapshot};

use crate::balance::Account;
use crate::body::{Body, Totals};
use crate::contact::{ContactPoint, PairContact};
use crate::exchange::Exchange;
use crate::observe::ObserveError;
use crate::solver::Solver;
use crate::summary::RunSummary;

/// View of a run between two steps.
pub struct RunView<'a> {
    solver: &'a (dyn Solver + 'static),
    end: f64,
    run: RunSummary,
    totals: OnceCell<Totals>,
}

impl<'a> RunView<'a> {
    /// Create the view of a run to `end` (s) with the summary so far.
    #[must_use]
    pub fn new(solver: &'a (dyn Solver + 'static), end: f64, run: RunSummary) -> Self {
        RunView { solver, end, run, totals: OnceCell::new() }
    }

    /// Create the view of a scene without a run.
    #[must_use]
    pub fn of(solver: &'a (dyn Solver + 'static)) -> Self {
        RunView::new(solver, solver.time(), RunSummary::default())
    }

    /// Solver, for data of its method: `downcast_ref`, or [`RunView::solver_as`].
    #[must_use]
    pub fn solver(&self) -> &'a (dyn Solver + 'static) {
        self.solver
    }
    /// Return the solver as its concrete type.
    ///
    /// # Errors
    /// A solver of another type.
    pub fn solver_as<S: Solver>(&self) -> Result<&'a S, ObserveError> {
        let wanted = || ObserveError::OtherSolver { wanted: std::any::type_name::<S>() };
        self.solver.downcast_ref().ok_or_else(wanted)
    }
    /// Simulated time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.solver.time()
    }
    /// End time of the run, s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }
    /// Number of steps since the scene was set up.
    #[must_use]
    pub fn step(&self) -> u64 {
        self.solver.steps()
    }
    /// Bodies of the scene.
    #[must_use]
    pub fn bodies(&self) -> Vec<&'a dyn Body> {
        self.solver.bodies()
    }
    /// Pairs of bodies that were ever in contact: force, contact points and gap in the last step, energy since the start.
    #[must_use]
    pub fn contacts(&self) -> Vec<PairContact> {
        self.solver.contacts()
    }
    /// Contact points of the last step, with gap, normal and impulse.
    #[must_use]
    pub fn contact_points(&self) -> Vec<ContactPoint> {
        self.solver.contact_points()
    }
    /// Exchange since the start: impulses and work of boundaries and loads, dissipation.
    #[must_use]
    pub fn exchange(&self) -> Exchange {
        self.solver.exchange()
    }
    /// True if the coordinates are (r, z) of a body of revolution. Then extensive quantities are per radian.
    #[must_use]
    pub fn axisymmetric(&self) -> bool {
        self.solver.axisymmetric()
    }
    /// Wall-clock time of the steps of this run so far, s, without observers.
    #[must_use]
    pub fn wall_seconds(&self) -> f64 {
        self.run.wall_seconds
    }
    /// Point updates per second in this run so far; 0 before its first step.
    #[must_use]
    pub fn rate(&self) -> f64 {
        self.run.rate()
    }
    /// Totals over all bodies, computed once for all observers.
    #[must_use]
    pub fn totals(&self) -> &Totals {
        self.totals.get_or_init(|| self.solver.totals())
    }
    /// Balances of energy and momentum since the first step, from the same totals.
    #[must_use]
    pub fn account(&self) -> Account {
        self.solver.account_of(self.totals())
    }
    /// Return all points of all bodies for pictures and files: [`Solver::snapshot`].
    ///
    /// # Errors
    /// A scene without points, or law state names that cannot be field names.
    pub fn snapshot(&self) -> Result<Snapshot, OutputError> {
        self.solver.snapshot()
    }
}
