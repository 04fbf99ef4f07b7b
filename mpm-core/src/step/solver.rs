//! The solver: bodies on a grid, and the step.

use std::sync::Arc;
use std::time::{Duration, Instant};

use impactite_scene::boundary::check_at;
use impactite_scene::error::{SceneError, StepError, Stopped};
use impactite_scene::{
    Account, Archive, Body, CheckpointError, Clock, ContactPoint, Exchange, PairContact, PointKind, Solver,
    TimeControl, Totals, Warning,
};

use super::body::{BodyTrouble, GridBody, Steps, Which};
use super::contact::{Contact, ContactPhase, ContactState, OneField};
use super::fields::Fields;
use super::kernels::{Facts, MethodKernels};
use super::layout::Nodes;
use super::load::Loading;
use super::looks::Looks;
use super::nodes::{BlockBooks, Conditions, Stage, mass_cutoff};
use super::planes::Planes;
use super::rest::KineticDamping;
use super::rigid::Wrong;
use super::work::Work;
use super::wrap::Wrap;

use crate::combine::GridFor;
use crate::dim::BLOCK;
use crate::grid::{GridStorage, OutsideGrid};
#[cfg(doc)]
use crate::method::IntoKernels;
use crate::method::Kernels;
use crate::parallel::{Float, Team};
use impactite_scene::boundary::{Boundary, BoundaryError, Side};

/// Material point method: bodies of particles on a background grid.
///
/// A scene is of one type, whatever method ([`crate::Method`]), grid, contact and laws it is made of. Bodies may have different
/// laws; with [`OneField`] they move in one velocity field, that is, they stick where they touch.
pub struct Mpm<const D: usize, T: Float = f64> {
    pub(super) work: &'static dyn Work<T, D>,
    pub(super) kernels: Arc<dyn MethodKernels<T, D>>,
    pub(super) grid: Box<dyn GridStorage<T, D>>,
    pub(super) contact: Arc<dyn Contact<T, D>>,
    /// Where on the grid each body's nodes are.
    pub(super) fields: Fields<D>,
    pub(super) contact_state: ContactState<T>,
    pub(super) bodies: Vec<Box<dyn GridBody<T, D>>>,
    pub(super) conditions: Conditions<D>,
    pub(super) control: TimeControl,
    /// The last Gershgorin rate, 1/s, and the step it was found at.
    pub(super) gershgorin: Option<(u64, f64)>,
    /// Kinetic damping, if asked for.
    pub(super) kinetic_damping: Option<KineticDamping>,
    /// Steps between null-space filters, if asked for.
    pub(super) filter: Option<u64>,
    pub(super) team: Team,
    pub(super) clock: Clock,
    /// What the bodies' last pass came to, and whether their blocks changed after it.
    passed: Vec<Result<T, BodyTrouble>>,
    /// Time spent at particles so far.
    at_particles: Duration,
    changed: Vec<bool>,
    /// The step after which blocks were arranged last, and whether with a look ahead.
    pub(super) arranged: u64,
    pub(super) ahead: bool,
    /// The step that impulses on the grid are for, s.
    pub(super) planned: T,
    /// Largest (c + |v|) / h of the particles, 1/s.
    pub(super) rate: T,
    /// What stopped the run, after which it makes no step.
    pub(super) stopped_by: Option<StepError>,
    /// Do the tiles hold the map of the particles as they stand?
    pub(super) mapped: bool,
    /// Of each block of nodes.
    pub(super) books: Vec<BlockBooks>,
    /// What no block of nodes gave or took alone, in a step.
    together: Exchange,
    pub(super) ledger: Exchange,
    /// The surface loads on the grid.
    pub(super) acting: Loading,
    /// Terms of the FMPM series, one a node; empty for other transfers.
    terms: Vec<[T; 3]>,
    /// The nodes at planes of symmetry, walls and fixed planes.
    planes: Planes<T>,
    /// Which bodies are rigid.
    pub(super) rigid: Vec<usize>,
    /// Which bodies are mapped in their reference configuration.
    pub(super) references: Vec<usize>,
    /// Books, and what they and the bodies were found to be like.
    pub(super) looks: Looks<D>,
}

/// A view of the grid for its stages, which leaves the other parts of the solver free.
macro_rules! stage {
    ($mpm:expr, $dt:expr) => {{
        let lightest = $mpm.bodies.iter().map(|b| b.lightest()).fold(T::of(f64::MAX), |a, b| a.min(b));
        Stage {
            grid: &mut *$mpm.grid,
            bodies: &$mpm.bodies,
            fields: &$mpm.fields,
            team: &$mpm.team,
            conditions: &$mpm.conditions,
            books: &mut $mpm.books,
            together: &mut $mpm.together,
            time: $mpm.clock.time,
            cutoff: lightest * mass_cutoff::<T>(),
            lightest,
            wide: $mpm.kernels.facts().wide(),
            takes: $mpm.kernels.taken($dt),
            forces: !$mpm.kernels.facts().maps_together,
            dt: $dt,
            planes: &mut $mpm.planes,
            rigid: !$mpm.rigid.is_empty(),
        }
    }};
}

/// Steps between two removals of empty blocks (the default of \[Ma2010\] 1.4, step ii), and where blocks were arranged with
/// a look ahead.
/// How often the affine velocity field of particles is taken from the nodes at the start of a run: what is left of its error falls by
/// more than half each time.
const REFITS: usize = 8;
const PRUNE_EVERY: u64 = 10;
const PRUNE_AHEAD: u64 = 128;
/// Blocks that are arranged anew after fewer steps than this, and hold fewer particles each on average, are arranged with a
/// look ahead: that takes memory, and about as long as a step.
const OFTEN: u64 = 16;
const FEW: usize = 32;

impl<const D: usize> Mpm<D> {
    /// An empty scene in double precision, of any method ([`IntoKernels`]) and grid ([`GridStorage`]) of the same dimensions, whose bodies
    /// will share one velocity field.
    ///
    /// ```
    /// use mpm_core::geometry::Lattice;
    /// use mpm_core::{BlockGrid, Flip, FullSpace, Linear, Method, Mpm, Musl};
    ///
    /// // One type, whatever the scene is made of: it can be a field of a struct, and be chosen at run time.
    /// fn scene(spacing: f64) -> Result<Mpm<3>, Box<dyn std::error::Error>> {
    ///     let grid = BlockGrid::new(Lattice::new([0.0; 3], spacing)?);
    ///     Ok(Mpm::new(Method::new(Linear, Flip, Musl, FullSpace), grid))
    /// }
    /// # assert_eq!(scene(0.1).unwrap().particles(), 0);
    /// ```
    pub fn new<M>(method: M, grid: impl GridFor<M, f64, D> + 'static) -> Self {
        Mpm::with_contact(method, grid, OneField)
    }

    /// An empty scene in double precision whose bodies act on each other by this contact algorithm.
    pub fn with_contact<M>(
        method: M,
        grid: impl GridFor<M, f64, D> + 'static,
        contact: impl Contact<f64, D>,
    ) -> Self {
        Mpm::of(method, grid, contact)
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// An empty scene in any precision: `Mpm::<3, f32>::of(method, grid, OneField)`. All three may be objects, chosen at run time:
    /// [`Kernels`], `Box<dyn GridStorage<T, D>>`, `Arc<dyn Contact<T, D>>`.
    pub fn of<M, G>(method: M, grid: G, contact: impl Contact<T, D>) -> Self
    where
        G: GridFor<M, T, D> + 'static,
    {
        Self::of_parts(G::kernels(method), Box::new(grid), Arc::new(contact))
    }

    fn of_parts(
        method: Kernels<T, D>,
        grid: Box<dyn GridStorage<T, D>>,
        contact: Arc<dyn Contact<T, D>>,
    ) -> Self {
        let Kernels { kernels, work } = method;
        let control = kernels.facts().time_control();
        Mpm {
            work,
            kernels,
            grid,
            contact,
            fields: Fields::default(),
            contact_state: ContactState::default(),
            bodies: Vec::new(),
            conditions: Conditions { boundaries: Vec::new(), gravity: None, damping: 0.0 },
            control,
            gershgorin: None,
            kinetic_damping: None,
            filter: None,
            team: Team::one(),
            clock: Clock::default(),
            passed: Vec::new(),
            at_particles: Duration::ZERO,
            changed: Vec::new(),
            arranged: 0,
            ahead: false,
            planned: T::default(),
            rate: T::default(),
            stopped_by: None,
            mapped: false,
            books: Vec::new(),
            together: Exchange::default(),
            ledger: Exchange::default(),
            acting: Loading::default(),
            terms: Vec::new(),
            planes: Planes::default(),
            rigid: Vec::new(),
            references: Vec::new(),
            looks: Looks::default(),
        }
    }

    /// Refuse a method that no body can have here.
    pub(super) fn check_method(&self) -> Result<(), SceneError> {
        if self.contact.separates() {
            self.check_frame(
                "contact",
                "bodies mapped in the reference configuration never meet: leave it out",
            )?;
        }
        if self.facts().domain.carried() {
            let why =
                "domains tile for ever in the reference configuration: take `Gimp`, `Linear` or a B-spline";
            self.check_frame("a shape function whose domains follow the strain", why)?;
        }
        Ok(())
    }

    /// Add a boundary condition; conditions act in the order they were added.
    ///
    /// # Errors
    /// An axis that does not exist, a symmetry or absorbing plane between nodes, a symmetry plane with particles behind it, numbers that are
    /// not finite or that a condition refuses; walls in the reference configuration; periodic planes whose distance is no whole number of
    /// blocks of four cells, beside another plane across their axis, with bodies there already or kept apart, or along a radius.
    pub fn bound(&mut self, boundary: Boundary<D>) -> Result<(), SceneError> {
        self.work.bound(self, boundary)
    }

    pub(super) fn bound_here(&mut self, boundary: Boundary<D>) -> Result<(), SceneError> {
        boundary.check(self.grid.lattice())?;
        self.check_periodic(&boundary)?;
        if self.facts().total && boundary.is_wall() {
            return Err(BoundaryError::WallInReference.into());
        }
        for body in &self.bodies {
            let mut behind = None;
            body.for_each(&mut |p| {
                let x = std::array::from_fn(|d| p.position[d]);
                behind = behind.take().or_else(|| self.behind_symmetry(&boundary, body.name(), p.number, &x));
            });
            behind.map_or(Ok(()), Err)?;
        }
        self.conditions.boundaries.push(boundary);
        self.arrange_planes();
        Ok(())
    }

    /// Where blocks are found beyond periodic planes.
    pub(super) fn wrap(&self) -> Result<Wrap<D>, SceneError> {
        Ok(Wrap::of(&self.conditions.boundaries, self.grid.lattice())?)
    }

    /// Refuse periodic planes that cannot be with the scene, and planes that cannot be with them.
    fn check_periodic(&self, boundary: &Boundary<D>) -> Result<(), SceneError> {
        let mut all = self.conditions.boundaries.clone();
        all.push(boundary.clone());
        Wrap::of(&all, self.grid.lattice())?;
        let Boundary::Periodic { axis, .. } = *boundary else { return Ok(()) };
        let refuse = |why| Err(BoundaryError::Periodic { axis, why }.into());
        if !self.bodies.is_empty() {
            return refuse("once there are bodies; they must be given before");
        }
        if self.contact.separates() {
            return refuse("where bodies are kept apart; the scene must be of one field");
        }
        if self.facts().hoop && axis == 0 {
            return refuse("along the radius; they must lie across the axis of revolution");
        }
        Ok(())
    }

    /// What a particle is refused for that is behind a plane of symmetry, where its image is.
    pub(super) fn behind_symmetry(
        &self,
        boundary: &Boundary<D>,
        body: &str,
        particle: usize,
        x: &[f64; D],
    ) -> Option<SceneError> {
        let Boundary::Symmetry { axis, at, side } = *boundary else { return None };
        let distance = if side == Side::Above { at - x[axis] } else { x[axis] - at };
        let behind = distance > 1e-6 * self.grid.lattice().spacing();
        let body = || body.to_string();
        behind.then(|| SceneError::BehindSymmetry { body: body(), particle, axis, at, distance })
    }

    /// Accelerate all material, m/s^2 over time.
    pub fn set_body_force(&mut self, acceleration: impl Fn(f64) -> [f64; D] + Send + Sync + 'static) {
        self.conditions.gravity = Some(std::sync::Arc::new(acceleration));
    }

    /// Damp towards rest: every node's unbalanced force, weight included, is lowered by its part `coefficient` along each
    /// axis while it speeds the node up, and raised by as much while it slows it down, f <- f - alpha |f| sign(v)
    /// (Cundall 1987). It leaves balanced forces alone, so that a state at rest is the true one; what it takes is booked as a
    /// load. 0.05 for slow processes, 0.7 to come to rest soonest. What particles keep of velocity that nodes do not see is
    /// not damped, and FLIP with wide stencils gathers it: take a [`Blend`](crate::Blend) there.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1), or a method that maps momentum and impulse together
    /// ([`Composition::MAPS_TOGETHER`](crate::Composition::MAPS_TOGETHER)), where nodes know no forces.
    pub fn set_local_damping(&mut self, coefficient: f64) -> Result<(), SceneError> {
        if !(0.0..1.0).contains(&coefficient) {
            return Err(SceneError::Damping(coefficient));
        }
        if self.facts().maps_together && coefficient > 0.0 {
            return Err(SceneError::NoForces(self.facts().description.clone()));
        }
        self.conditions.damping = coefficient;
        Ok(())
    }

    /// Choose how the time step is found.
    ///
    /// # Errors
    /// Numbers out of range.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), SceneError> {
        control.check()?;
        if matches!(control, TimeControl::Gershgorin { .. }) {
            self.check_references("`TimeControl::Gershgorin`")?;
        }
        self.control = control;
        self.gershgorin = None;
        self.clock.last = None;
        self.mapped = false;
        Ok(())
    }

    /// Run the stages on these threads. Results do not depend on their number.
    pub fn set_team(&mut self, team: Team) {
        self.team = team;
    }

    /// Make one step, and return its size in seconds.
    ///
    /// # Errors
    /// Names body, particle, place and cause of what stopped it. A run that was stopped stays so.
    pub fn step(&mut self) -> Result<T, StepError> {
        self.step_at_most(f64::INFINITY)
    }

    /// Make one step, of at most `left` seconds if it can still be shortened.
    ///
    /// A step that maps momentum and impulse together ([`Composition::MAPS_TOGETHER`](crate::Composition::MAPS_TOGETHER)) was planned by the step
    /// before it, whose `left` it respects; only its successor follows the `left` given here.
    ///
    /// The stages are those of \[Ma2010\] 1.4 (i - xii). The map of mass, momentum and force that opens a
    /// step (iii, vi) was made by the last pass of the step before, while the particles were at hand.
    ///
    /// # Errors
    /// As [`Mpm::step`]; a `left` that is not positive.
    pub fn step_at_most(&mut self, left: f64) -> Result<T, StepError> {
        self.work.step_at_most(self, left)
    }

    // Never inlined, so that the work of steps can be told from that of what looks at them (callgrind, profilers).
    #[inline(never)]
    pub(super) fn step_at_most_here(&mut self, left: f64) -> Result<T, StepError> {
        if let Some(error) = &self.stopped_by {
            return Err(error.clone());
        }
        if left.is_nan() || left <= 0.0 {
            return Err(self.clock.refused("step_at_most: left", left, "positive; infinite for no limit"));
        }
        if self.bodies.is_empty() {
            return Err(self.stopped(Stopped::Scene(SceneError::NoBodies)));
        }
        let made = self.team.clone().run(|| self.stages(left));
        self.stopped_by = made.as_ref().err().cloned();
        made
    }

    fn stages(&mut self, left: f64) -> Result<T, StepError> {
        self.open_books();
        self.reactivate_disturbed().map_err(|outside| self.stopped(self.who_left(outside)))?;
        self.map_particles(left)?; // iii, vi (only where nothing was mapped before)
        let dt = self.time_step(left)?;
        if self.clock.time + dt.to_double() == self.clock.time {
            let allowed = "long enough to move the clock: let it start at an earlier time (`Mpm::set_time`)";
            return Err(self.clock.refused("time step", dt.to_double(), allowed));
        }
        self.check_conditions(dt.to_double()).map_err(|error| self.stopped(Stopped::Scene(error)))?;
        self.plan_rigid(dt)?;
        self.open_references(dt)?;
        let (before_forces, remap) = (self.facts().before_forces, self.facts().remap);
        if before_forces {
            self.stage(dt).velocities(); // iii: eqs. 2, 3; boundaries
            self.apply_contact(ContactPhase::Momentum, dt); // iv: eqs. 6, 7, if the contact algorithm wants it
            self.particle_pass(Which::First, dt)?; // v (USF), vi: eqs. 18, 19, 9
            self.undo_contact_correction(dt);
            self.stage(dt).integrate_momentum(dt, true); // vi: eq. 9 summed; viii: eq. 8
            self.apply_contact(ContactPhase::Trial, dt); // vii: eqs. 11 - 15
            self.move_rigid(dt)?;
            self.watch_motion();
            self.invert_full_mass(dt)?; // FMPM
            self.particle_pass(Which::Second, dt)?; // ix: eqs. 16, 17; next iii
        } else {
            self.stage(dt).integrate_momentum(dt, false); // iii, vi: eqs. 2, 3, 9 summed; viii: eq. 8
            self.apply_contact(ContactPhase::Trial, dt); // iv, vii: eqs. 6, 7, 11 - 15
            self.move_rigid(dt)?;
            self.watch_motion();
            self.invert_full_mass(dt)?; // FMPM
            self.particle_pass(Which::First, dt)?; // ix; USL: xi and the next iii, vi
            if remap {
                self.stage(dt).remap_velocities(dt); // x: eq. 3 again
                self.apply_contact(ContactPhase::Remapped, dt); // x, if the contact algorithm wants it
                self.particle_pass(Which::Second, dt)?; // xi: eqs. 18, 19; next iii, vi
            }
        }

        self.advance_references(dt)?;
        self.close_step(dt)?;
        self.apply_between_step_operations();
        self.look_if_due()?;
        Ok(dt)
    }

    /// Refuse loads and prescribed velocities that are no numbers in this step.
    fn check_conditions(&self, dt: f64) -> Result<(), SceneError> {
        let (time, conditions) = (self.clock.time, &self.conditions);
        check_at(conditions.gravity.as_ref(), &conditions.boundaries, time, &[time, time + dt])
    }

    /// Book the step, bring particles to their new bins, define the new grid (xii, ii).
    pub(super) fn close_step(&mut self, dt: T) -> Result<(), StepError> {
        for part in self.books.iter().map(|books| &books.ledger).chain([&self.together]) {
            self.ledger.add(part);
        }
        if self.facts().before_forces {
            self.acting = self.loading();
        }
        for d in 0..3 {
            self.ledger.load[d] += self.acting.force[d] * dt.to_double();
        }
        self.acting = self.loading();
        self.ledger.work += self.acting.power * dt.to_double();
        self.ledger.conversion =
            self.bodies.iter().filter_map(|b| Some(b.division()?.splits().kinetic)).sum();
        let last = self.facts().last_pass();
        let age = self.clock.steps - self.arranged;
        let prune =
            if self.ahead { age >= PRUNE_AHEAD } else { self.clock.steps % PRUNE_EVERY == PRUNE_EVERY - 1 };
        let team = &self.team;
        self.changed.resize(self.bodies.len(), false);
        let clock = Instant::now();
        team.each_piece(&mut self.bodies, 1, &mut self.changed, |_, body, changed| {
            *changed = body[0].locate(last, prune, team);
        });
        self.at_particles += clock.elapsed();
        let changed = self.changed.contains(&true);
        if changed || self.fields_changed(prune) {
            self.ahead = self.contact.separates() && age < OFTEN && self.particles() < FEW * self.blocks();
            self.arrange().map_err(|outside| self.stopped(self.who_left(outside)))?;
        }
        self.clock.advance(dt.to_double());
        Ok(())
    }

    /// Let the bodies act on each other at the nodes they share.
    fn apply_contact(&mut self, phase: ContactPhase, dt: T) {
        if !self.contact.separates() || (phase != ContactPhase::Trial && !self.contact.corrects_strain()) {
            return;
        }
        let mut contact_state = std::mem::take(&mut self.contact_state);
        let contact = &*self.contact;
        stage!(self, dt).apply_contact(contact, phase, &mut contact_state);
        self.contact_state = contact_state;
    }

    /// Plan how bodies of prescribed motion move.
    fn plan_rigid(&mut self, dt: T) -> Result<(), StepError> {
        for n in 0..self.rigid.len() {
            let (body, hoop) = (self.rigid[n], self.facts().hoop);
            let name = self.bodies[body].name().to_string();
            let planned = self.bodies[body]
                .rigid_mut()
                .map_or(Ok(()), |state| state.plan(&name, self.clock.time, dt.to_double(), hoop));
            planned.map_err(|error| self.stopped(Stopped::Scene(error)))?;
        }
        Ok(())
    }

    /// Move rigid bodies: free ones as what their nodes got in this step pushes them, and their nodes with them.
    fn move_rigid(&mut self, dt: T) -> Result<(), StepError> {
        if self.rigid.is_empty() {
            return Ok(());
        }
        for n in 0..self.rigid.len() {
            let number = self.rigid[n];
            let Some(state) = self.bodies[number].rigid().filter(|s| !s.is_prescribed()).cloned() else {
                continue;
            };
            let (impulse, moment) = self.stage(dt).push_on(number, &state);
            let Some(state) = self.bodies[number].rigid_mut() else { continue };
            let held = state.push(impulse, moment, dt.to_double());
            let held = held.map_err(|wrong| {
                let body = self.bodies[number].name().into();
                let Wrong { field, value, allowed } = wrong;
                self.stopped(Stopped::Scene(SceneError::Rigid { body, field, value, allowed }))
            })?;
            let Some(state) = self.bodies[number].rigid() else { continue };
            let velocity = state.velocity();
            for d in 0..3 {
                self.together.impulse[d] += held[d];
                self.together.work += held[d] * velocity[d];
            }
        }
        self.stage(dt).move_rigid();
        for n in 0..self.rigid.len() {
            if let Some(state) = self.bodies[self.rigid[n]].rigid_mut() {
                state.advance();
            }
        }
        self.check_rigid_places().map_err(|error| self.stopped(Stopped::Scene(error)))
    }

    /// Refuse rigid bodies that went behind planes of symmetry, which do not stop them.
    fn check_rigid_places(&self) -> Result<(), SceneError> {
        let planes = self.conditions.boundaries.iter().filter(|b| matches!(b, Boundary::Symmetry { .. }));
        for boundary in planes {
            for &number in &self.rigid {
                let (body, mut behind) = (&self.bodies[number], None);
                body.for_each(&mut |p| {
                    if behind.is_none() {
                        let x = std::array::from_fn(|d| p.position[d]);
                        behind = self.behind_symmetry(boundary, body.name(), p.number, &x);
                    }
                });
                behind.map_or(Ok(()), Err)?;
            }
        }
        Ok(())
    }

    /// Take contact back from the momentum that the stress update of USF saw.
    fn undo_contact_correction(&mut self, dt: T) {
        if !self.contact.separates() || !self.contact.corrects_strain() {
            return;
        }
        let contact_state = &self.contact_state;
        stage!(self, dt).undo_contact_correction(contact_state);
    }

    /// Do particles reach node blocks where their body has no field, or (asked with `prune`) none any more where
    /// it has one?
    fn fields_changed(&mut self, prune: bool) -> bool {
        let layout = self.fields.layout();
        self.contact.separates()
            && (prune && self.ahead
                || self.bodies.iter_mut().any(|b| b.presence_mut().reaches_further(layout))
                || prune && self.fields.outdated(&self.bodies))
    }

    /// Surface loads of all bodies, as the last pass mapped them.
    fn loading(&self) -> Loading {
        let mut sum = Loading::default();
        for body in &self.bodies {
            let one = body.loading();
            for d in 0..3 {
                sum.force[d] += one.force[d];
            }
            sum.power += one.power;
        }
        sum
    }

    /// Map the particles as they stand, where no pass did so.
    pub(super) fn map_particles(&mut self, left: f64) -> Result<(), StepError> {
        if !self.mapped {
            let spacing = self.grid.lattice().spacing();
            let rates = self.bodies.iter().map(|b| b.rate(spacing));
            self.rate = rates.fold(T::default(), |a, b| if b > a { b } else { a });
            let planned = self.plan(left)?;
            let refits = if self.facts().affine { REFITS } else { 0 };
            // Particles bring no affine field to a run. Without one a body that turns would lose the angular momentum that its
            // particles have about their own centres, 1 % at ten cells a radius. The impulse of the step to come, which
            // may be mapped with the momentum, is no part of it.
            self.planned = if refits == 0 { planned } else { T::default() };
            self.particle_pass(Which::Map, T::default())?;
            for fit in 1..=refits {
                self.stage(T::default()).mean_velocities();
                self.planned = if fit == refits { planned } else { T::default() };
                self.particle_pass(Which::Refit, T::default())?;
            }
            self.acting = self.loading();
            self.mapped = true;
        }
        Ok(())
    }

    /// FMPM: add the terms of the series for the inverse of the full mass matrix to the velocity.
    fn invert_full_mass(&mut self, dt: T) -> Result<(), StepError> {
        let order = self.facts().order;
        if order < 2 {
            return Ok(());
        }
        let mut terms = std::mem::take(&mut self.terms);
        self.stage(dt).first_terms(&mut terms);
        for _ in 1..order {
            self.particle_pass(Which::Smooth, dt)?;
            self.stage(dt).refine_velocities(&mut terms);
        }
        self.terms = terms;
        Ok(())
    }

    pub(super) fn particle_pass(&mut self, which: Which, dt: T) -> Result<(), StepError> {
        let adapt = matches!(self.control, TimeControl::Courant { .. });
        // Forces act in the step that follows the map; those of USF in this one.
        let usf = self.facts().before_forces && which == Which::First;
        let force_time = self.clock.time + if usf { 0.0 } else { dt.to_double() };
        let dt = Steps { this: dt, next: self.planned, adapt, force_time };
        let nodes = Nodes { all: self.grid.nodes(), layout: self.fields.layout() };
        let team = &self.team;
        self.passed.resize_with(self.bodies.len(), || Ok(T::default()));
        let clock = Instant::now();
        team.each_piece(&mut self.bodies, 1, &mut self.passed, |_, body, passed| {
            *passed = body[0].pass(which, nodes, dt, team);
        });
        self.at_particles += clock.elapsed();
        let mut rate = T::default();
        for (b, passed) in self.passed.iter_mut().enumerate() {
            match std::mem::replace(passed, Ok(T::default())) {
                Ok(r) => rate = if r > rate { r } else { rate },
                Err(BodyTrouble { particle, position, cause }) => {
                    // The run ends here, with all particles where they went.
                    for body in &mut self.bodies {
                        body.locate(which, false, &self.team);
                    }
                    let (body, law) = (self.bodies[b].name().to_string(), self.bodies[b].law());
                    return Err(self.stopped(Stopped::Point {
                        kind: PointKind::Particle,
                        body,
                        number: particle,
                        position,
                        law,
                        cause,
                    }));
                }
            }
        }
        if rate > T::default() {
            self.rate = rate;
        }
        Ok(())
    }

    /// The step to make now; where momentum and impulse are mapped together, plan the next one, too.
    fn time_step(&mut self, left: f64) -> Result<T, StepError> {
        if !self.facts().maps_together {
            return self.plan(left);
        }
        let dt = self.planned;
        self.clock.last = Some(dt.to_double());
        let then = left - dt.to_double();
        self.planned = self.plan(if then > 1e-9 * left.abs() { then } else { f64::INFINITY })?;
        Ok(dt)
    }

    fn plan(&mut self, left: f64) -> Result<T, StepError> {
        let mut rate = self.rate.to_double();
        if let TimeControl::Gershgorin { every, .. } = self.control {
            let known = self.gershgorin.filter(|(step, _)| self.clock.steps < step + every);
            let (step, sharp) = known.unwrap_or_else(|| (self.clock.steps, self.gershgorin_rate()));
            (self.gershgorin, rate) = (Some((step, sharp)), sharp);
        }
        let dt = self.control.next(rate, self.clock.last);
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(self.stopped(Stopped::NoTimeStep(dt)));
        }
        Ok(T::of(dt.min(left)))
    }

    /// The size of the next step, s.
    pub(super) fn stable_step_here(&mut self) -> Result<f64, StepError> {
        self.map_particles(f64::INFINITY)?;
        if self.facts().maps_together {
            Ok(self.planned.to_double())
        } else {
            Ok(self.plan(f64::INFINITY)?.to_double())
        }
    }

    pub(super) fn stage(&mut self, dt: T) -> Stage<'_, T, D> {
        stage!(self, dt)
    }

    /// Have the node blocks that the particles reach, and tell the bodies where they are.
    pub(super) fn arrange(&mut self) -> Result<(), OutsideGrid> {
        let separate = self.contact.separates();
        let pressed = self.pressed();
        self.fields.arrange(&mut *self.grid, &mut self.bodies, separate, self.ahead, &self.team)?;
        self.contact_state.arrange(&self.fields, self.bodies.len());
        self.press(&pressed);
        self.arranged = self.clock.steps;
        self.arrange_planes();
        Ok(())
    }

    pub(super) fn arrange_planes(&mut self) {
        let reach = [self.facts().wide(), self.facts().boundary_modified];
        let shares = self.surface_shares();
        self.planes.arrange(&*self.grid, &self.fields, &self.conditions.boundaries, reach, shares);
    }

    /// What a traction on a plane of nodes gives to the nodes in front of, on and behind it: the weights of a point there.
    fn surface_shares(&self) -> [f64; 3] {
        let facts = self.facts();
        if !facts.wide() || facts.domain.convects() {
            return [0.0, 1.0, 0.0];
        }
        // The domain of a particle is no part of the surface: of weights with one the limit without it, hats.
        let (point, none) = (T::of(1e-3), 1e-2);
        let xi = T::of(if facts.nodes.is_multiple_of(2) { -0.5 } else { 0.0 });
        let [weights, _] = self.kernels.shape().weights(xi, point);
        let shares: [f64; 3] = std::array::from_fn(|n| weights[n].to_double());
        let shares = shares.map(|share| if share > none { share } else { 0.0 });
        let sum: f64 = shares.iter().sum();
        shares.map(|share| share / sum)
    }

    /// The particle nearest to a block of nodes that the grid has not: the one that asks for it.
    fn who_left(&self, outside: OutsideGrid) -> Stopped {
        let lattice = self.grid.lattice();
        let (origin, width) = (lattice.origin(), BLOCK as f64 * lattice.spacing());
        let mut nearest = f64::INFINITY;
        let (mut who, mut number, mut place) = (0, 0, [0.0; 3]);
        for (k, body) in self.bodies.iter().enumerate() {
            body.for_each(&mut |p| {
                let mut square = 0.0;
                for d in 0..D {
                    let low = origin[d] + width * f64::from(outside.coordinates[d]);
                    square += (low - p.position[d]).max(p.position[d] - low - width).max(0.0).powi(2);
                }
                if square < nearest {
                    (nearest, who, number, place) = (square, k, p.number, p.position);
                }
            });
        }
        let body = &self.bodies[who];
        let (law, body) = (body.law(), body.name().to_string());
        Stopped::Outside { body, particle: number, position: place, law, outside: Box::new(outside) }
    }

    pub(super) fn stopped(&self, what: Stopped) -> StepError {
        self.clock.stopped(what)
    }

    /// Step until `end`, s; the last step is shortened to arrive there.
    ///
    /// # Errors
    /// As [`Mpm::step`]; an end that is not finite, or before the time reached.
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    /// Make one step, shortened if it would go beyond `end`, s, which is then met exactly.
    ///
    /// # Errors
    /// As [`Mpm::step`]; an end that is not finite, or that is [reached](Mpm::reached).
    pub fn step_towards(&mut self, end: f64) -> Result<T, StepError> {
        Solver::step_towards(self, end).map(T::of)
    }

    /// Has the time come to `end`, s, or is what is left less than the rounding of either? Never for an end that is not a number.
    pub fn reached(&self, end: f64) -> bool {
        self.clock.reached(end)
    }

    /// Wall-clock time, s, that steps spent at particles so far: in passes over them and bringing them to their bins. What is
    /// left of a step's is the grid's and contact's.
    pub fn particle_seconds(&self) -> f64 {
        self.at_particles.as_secs_f64()
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }
    /// The bodies.
    pub fn bodies(&self) -> &[Box<dyn GridBody<T, D>>] {
        &self.bodies
    }
    /// The grid.
    pub fn grid(&self) -> &dyn GridStorage<T, D> {
        &*self.grid
    }
    /// What its method is.
    pub fn facts(&self) -> &Facts {
        self.kernels.facts()
    }
    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.bodies.iter().map(|b| b.len()).sum()
    }
    /// Totals over all particles.
    pub fn totals(&self) -> Totals {
        self.bodies.iter().map(|b| b.totals()).fold(Totals::default(), |a, b| a.plus(&b))
    }
    /// What boundaries and loads gave to the material since the start.
    pub fn exchange(&self) -> Exchange {
        let mut sum = self.ledger;
        let own = self.bodies.iter().filter_map(|b| b.in_reference());
        own.for_each(|body| sum.add(&body.given()));
        sum
    }
    /// The contact algorithm.
    pub fn contact(&self) -> &dyn Contact<T, D> {
        &*self.contact
    }
    /// The pairs of bodies that were ever in contact: force, nodes and gap in the last step, energy since the
    /// start.
    pub fn contacts(&self) -> &[PairContact] {
        self.contact_state.pairs()
    }
    /// The nodes in contact in the last step, with gap, normal and impulse.
    pub fn contact_points(&self) -> Vec<ContactPoint> {
        self.contact_state.nodes(self.grid.lattice())
    }
    /// Bytes of particles, grid and all scratch.
    pub fn bytes(&self) -> usize {
        self.bodies.iter().map(|b| b.bytes()).sum::<usize>()
            + self.grid.bytes()
            + self.books.capacity() * size_of::<BlockBooks>()
            + self.terms.capacity() * size_of::<[T; 3]>()
            + self.planes.bytes()
            + self.fields.bytes()
            + self.contact_state.bytes()
            + self.looks.bytes()
    }
}

/// What the run loop, observers and checkpoints need of it.
impl<const D: usize, T: Float> Solver for Mpm<D, T> {
    fn method(&self) -> String {
        self.facts().description.clone()
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
        self.bodies.iter().map(|body| &**body as &dyn Body).collect()
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
    fn account(&self) -> Account {
        Mpm::account(self)
    }
    fn contacts(&self) -> Vec<PairContact> {
        self.contact_state.pairs().to_vec()
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
