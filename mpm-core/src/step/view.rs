//! Queries of a scene.

use impactite_scene::embedding::described;
use impactite_scene::{
    Account, Archive, Body, CheckpointError, Clock, ContactPoint, Exchange, PairContact, Solver, StepError,
    StepLimit, Totals, Warning,
};

use super::bodies::body::GridBody;
use super::contact::ContactAlgorithm;
use super::mpm::Mpm;
use super::passes::kernels::Facts;
use super::stepper::Spent;
use crate::grid::GridStorage;
use impactite_simd::{Float, Team};

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Step until `end`, s; the last step is shortened to arrive there.
    ///
    /// # Errors
    /// Errors of [`Mpm::step`]; an end that is not finite, or before the current time.
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    /// Make one step, shortened if it would exceed `end`, s, to end exactly there.
    ///
    /// # Errors
    /// Errors of [`Mpm::step`]; an end that is not finite, or that is [reached](Mpm::reached).
    pub fn step_towards(&mut self, end: f64) -> Result<T, StepError> {
        Solver::step_towards(self, end).map(T::of)
    }

    /// True if the time has reached `end`, s, up to the rounding of either. False for an end that is not a number.
    pub fn reached(&self, end: f64) -> bool {
        self.clock.reached(end)
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }

    /// Number of steps made.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }

    /// Bodies of the scene.
    pub fn bodies(&self) -> &[Box<dyn GridBody<T, D>>] {
        &self.scene.bodies
    }

    /// Background grid.
    pub fn grid(&self) -> &dyn GridStorage<T, D> {
        &*self.grid.storage
    }

    /// Properties of the method.
    pub fn facts(&self) -> &Facts {
        self.kernels.facts()
    }

    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.scene.bodies.iter().map(|b| b.len()).sum()
    }

    /// Totals over all particles.
    pub fn totals(&self) -> Totals {
        let mut parts = Vec::new();
        let totals = self.scene.bodies.iter().map(|b| b.totals_on(&self.team, &mut parts));
        totals.fold(Totals::default(), |a, b| a.plus(&b))
    }

    /// Exchange of the material with boundaries and loads since the start.
    pub fn exchange(&self) -> Exchange {
        let mut sum = self.ledger;
        let own = self.scene.bodies.iter().filter_map(|b| b.client());
        own.for_each(|body| sum.add(&body.given()));
        sum
    }

    /// Contact algorithm of the scene.
    pub fn contact(&self) -> &dyn ContactAlgorithm<T, D> {
        &*self.scene.contact
    }

    /// Pairs of bodies that were ever in contact: force, nodes and gap in the last step, energy since the start.
    pub fn contacts(&self) -> &[PairContact] {
        self.grid.contact.pairs()
    }

    /// Nodes in contact in the last step, with gap, normal and impulse.
    pub fn contact_points(&self) -> Vec<ContactPoint> {
        self.grid.contact.nodes(&self.grid.fields.lattices())
    }

    /// Memory of particles, grid and scratch, bytes.
    pub fn bytes(&self) -> usize {
        self.scene.bodies.iter().map(|b| b.bytes()).sum::<usize>() + self.grid.bytes() + self.looks.bytes()
    }
}

/// Interface for the run loop, observers and checkpoints.
impl<const D: usize, T: Float> Solver for Mpm<D, T> {
    fn method(&self) -> String {
        let mut parts = self.facts().description.clone();
        if let [coarse, .., fine] = self.all_cell_sizes()[..] {
            parts += &format!(", cells of {coarse:.3e} to {fine:.3e} m");
        }
        described(&parts, &Solver::bodies(self))
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn axisymmetric(&self) -> bool {
        self.facts().hoop
    }
    fn clock(&self) -> &Clock {
        &self.clock
    }
    fn clock_mut(&mut self) -> &mut Clock {
        &mut self.clock
    }
    fn stage_seconds(&self) -> Vec<(&'static str, f64)> {
        let Spent { particles, contact, arrangement } = self.stepper.spent;
        let stages = [("particles", particles), ("contact", contact), ("arrangement", arrangement)];
        stages.map(|(name, spent)| (name, spent.as_secs_f64())).into()
    }
    fn points_by_cell(&self) -> Vec<(f64, usize)> {
        Mpm::points_by_cell(self)
    }
    fn limited_by(&self) -> Option<StepLimit> {
        Some(self.step_limit())
    }
    fn stable_step(&mut self) -> Result<f64, StepError> {
        self.work.stable_step(self)
    }
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        Mpm::step_at_most(self, left).map(|dt| dt.to_double())
    }
    fn set_team(&mut self, team: Team) {
        Mpm::set_team(self, team);
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        self.scene.bodies.iter().map(|body| &**body as &dyn Body).collect()
    }
    fn totals(&self) -> Totals {
        Mpm::totals(self)
    }
    fn exchange(&self) -> Exchange {
        Mpm::exchange(self)
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.work.archive(self, file)
    }
    fn stopped_by(&self) -> Option<&StepError> {
        self.stopped_by.as_ref()
    }
    fn look_at_the_end(&mut self) -> Result<(), StepError> {
        self.work.look_at_the_end(self)
    }
    fn warnings(&self) -> &[Warning] {
        Mpm::warnings(self)
    }
    fn account_of(&self, totals: &Totals) -> Account {
        self.looks.watcher.account(totals, &self.exchange(), self.facts().hoop)
    }
    fn contacts(&self) -> Vec<PairContact> {
        self.grid.contact.pairs().to_vec()
    }
    fn contact_points(&self) -> Vec<ContactPoint> {
        Mpm::contact_points(self)
    }
    fn moving_points(&self) -> usize {
        self.moving_particles()
    }
    fn bytes(&self) -> usize {
        Mpm::bytes(self)
    }
    fn clock_rounding(&self, dt: f64) -> f64 {
        4.0 * T::default_epsilon().to_double() * dt
    }
}
