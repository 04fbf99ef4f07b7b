//! Solver: time step of bodies on a grid.

use std::time::Instant;

use impactite_scene::boundaries::check_at;
use impactite_scene::error::{SceneError, StepError, Stopped};
use impactite_scene::{CentreLead, PointKind, StepLimit, TimeControl};

use super::bodies::body::{BodyTrouble, Steps, Which};
use super::bodies::load::Loading;
use super::contact::ContactPhase;
use super::mpm::Mpm;
use super::nodes::background::AtPlanes;
use super::nodes::constraints::Conditions;
use super::nodes::layout::Nodes;
use super::nodes::stages::{GridStages, StageOf};
use super::rigid;
use super::rigid::motion::{RigidState, Wrong};
use super::stepper::each_body;

use crate::dim::BLOCK;
use crate::grid::OutsideGrid;
use impactite_scene::boundary::Boundary;
use impactite_simd::Float;

/// Steps between two removals of empty blocks (the default of \[Ma2010\] 1.4, step ii), and the same for blocks
/// arranged with a look-ahead.
const PRUNE_EVERY: u64 = 10;
const PRUNE_AHEAD: u64 = 128;
/// Blocks are arranged with a look-ahead if the last arrangement is fewer steps than this ago, and they contain fewer
/// particles each on average. A look-ahead costs memory, and about the time of a step.
const OFTEN: u64 = 16;
const FEW: usize = 32;

/// Steps in which rigid bodies cross a cell, in scenes of rigid bodies only.
const STEPS_A_CELL: f64 = 20.0;
/// Ratio of the step to the remaining time, for rigid bodies at rest without an acceleration.
const LEAST_PART: f64 = 1e-3;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Make one step, and return its size, s.
    ///
    /// # Errors
    /// The error names body, particle, position and cause. A stopped run returns its error again.
    pub fn step(&mut self) -> Result<T, StepError> {
        self.step_at_most(f64::INFINITY)
    }

    /// Make one step, of at most `left` seconds if it can still be shortened.
    ///
    /// A step that maps momentum and impulse together
    /// ([`Composition::MAPS_TOGETHER`](crate::Composition::MAPS_TOGETHER)) was planned in the preceding step, for the
    /// `left` of that step; only the next step respects the present `left`.
    ///
    /// The stages are those of \[Ma2010\] 1.4 (i - xii). The map of mass, momentum and force at the start of a step
    /// (iii, vi) is part of the last pass of the preceding step, which visits the particles anyway.
    ///
    /// # Errors
    /// Errors of [`Mpm::step`]; a `left` that is not positive.
    pub fn step_at_most(&mut self, left: f64) -> Result<T, StepError> {
        self.work.step_at_most(self, left)
    }

    // Never inlined, so that profilers (callgrind) separate the work of steps from that of observers.
    #[inline(never)]
    pub(super) fn step_at_most_here(&mut self, left: f64) -> Result<T, StepError> {
        if let Some(error) = &self.stopped_by {
            return Err(error.clone());
        }
        if left.is_nan() || left <= 0.0 {
            return Err(self.clock.refused("step_at_most: left", left, "positive; infinite for no limit"));
        }
        if self.scene.bodies.is_empty() {
            return Err(self.stopped(Stopped::Scene(SceneError::NoBodies)));
        }
        let made = self.team.clone().run(|| self.stages(left));
        self.stopped_by = made.as_ref().err().cloned();
        made
    }

    fn stages(&mut self, left: f64) -> Result<T, StepError> {
        self.open_books();
        self.hooks_before_step()?;
        if !self.stepper.mapped {
            self.convert_clients()?;
        }
        self.reactivate_disturbed().map_err(|outside| self.stopped(self.who_left(outside)))?;
        self.map_particles(left)?; // iii, vi (only if nothing is mapped yet)
        self.plan_regrid()?;
        let dt = self.time_step(left)?;
        if self.clock.time + dt.to_double() == self.clock.time {
            let allowed = "long enough to move the clock: let it start at an earlier time (`Mpm::set_time`)";
            return Err(self.clock.refused("time step", dt.to_double(), allowed));
        }
        self.check_conditions(dt.to_double()).map_err(|error| self.stopped(Stopped::Scene(error)))?;
        self.scene.conditions.boundaries.advance(self.clock.time, dt.to_double());
        self.plan_rigid(dt)?;
        self.open_clients(dt)?;
        let (before_forces, remap) = (self.facts().before_forces, self.facts().remap);
        if before_forces {
            self.stage(dt).velocities(); // iii: eqs. 2, 3; boundaries
            self.hold_at_walls(dt, true);
            self.apply_contact(ContactPhase::Momentum, dt); // iv: eqs. 6, 7, if the contact algorithm corrects the strain
            self.particle_pass(Which::First, dt)?; // v (USF), vi: eqs. 18, 19, 9
            self.undo_contact_correction(dt);
            self.stage(dt).integrate_momentum(dt, true); // vi: eq. 9 summed; viii: eq. 8
            self.apply_contact(ContactPhase::Trial, dt); // vii: eqs. 11 - 15
            self.complete_trial(dt)?;
            self.particle_pass(Which::Second, dt)?; // ix: eqs. 16, 17; next iii
        } else {
            self.stage(dt).integrate_momentum(dt, false); // iii, vi: eqs. 2, 3, 9 summed; viii: eq. 8
            self.apply_contact(ContactPhase::Trial, dt); // iv, vii: eqs. 6, 7, 11 - 15
            self.complete_trial(dt)?;
            self.begin_regrid();
            if !remap {
                self.hooks_at_strain(dt)?;
            }
            self.particle_pass(Which::First, dt)?; // ix; USL: xi and the next iii, vi
            if remap {
                self.stage(dt).remap_velocities(dt); // x: eq. 3 again
                self.hold_remapped_at_walls(dt);
                self.apply_contact(ContactPhase::Remapped, dt); // x, if the contact algorithm corrects the strain
                self.hooks_at_strain(dt)?;
                self.particle_pass(Which::Second, dt)?; // xi: eqs. 18, 19; next iii, vi
            }
        }

        self.advance_clients(dt)?;
        self.close_step(dt)?;
        self.renew_densities(dt);
        self.apply_between_steps();
        self.convert_clients()?;
        self.hooks_after_step()?;
        self.look_if_due()?;
        Ok(dt)
    }

    /// Complete the trial velocities: rigid bodies, walls, surfaces of other discretisations, damping, the full mass matrix.
    fn complete_trial(&mut self, dt: T) -> Result<(), StepError> {
        self.move_rigid(dt)?;
        self.hooks_at_trial(dt)?;
        self.meet_walls(dt);
        self.meet_surfaces(dt)?;
        self.damp(dt);
        self.watch_motion();
        self.invert_full_mass(dt) // FMPM
    }

    /// Check that loads and prescribed velocities are finite in this step.
    fn check_conditions(&self, dt: f64) -> Result<(), SceneError> {
        let (time, conditions) = (self.clock.time, &self.scene.conditions);
        check_at(conditions.gravity.as_ref(), &conditions.boundaries, time, &[time, time + dt])
    }

    /// Book the step, sort particles into their new bins and arrange the new grid (xii, ii).
    pub(super) fn close_step(&mut self, dt: T) -> Result<(), StepError> {
        for part in self.grid.books.iter().map(|books| &books.ledger).chain([&self.grid.scene_wide]) {
            self.ledger.add(part);
        }
        if self.facts().before_forces {
            self.stepper.acting = self.loading();
        }
        for d in 0..3 {
            self.ledger.load[d] += self.stepper.acting.force[d] * dt.to_double();
        }
        self.stepper.acting = self.loading();
        self.ledger.work += self.stepper.acting.power * dt.to_double();
        self.ledger.conversion =
            self.scene.bodies.iter().filter_map(|b| Some(b.division()?.splits().kinetic)).sum();
        let last = self.facts().last_pass();
        let age = self.clock.steps - self.grid.arranged;
        let prune = self.regrids()
            || if self.grid.ahead {
                age >= PRUNE_AHEAD
            } else {
                self.clock.steps % PRUNE_EVERY == PRUNE_EVERY - 1
            };
        let team = &self.team;
        self.stepper.changed.resize(self.scene.bodies.len(), false);
        let clock = Instant::now();
        let changes = &mut self.stepper.changed;
        each_body(team, &mut self.scene.bodies, changes, |body, changed| {
            *changed = body.locate(last, prune, team);
        });
        self.stepper.spent.particles += clock.elapsed();
        let changed = self.end_regrid() || self.stepper.changed.contains(&true);
        if changed || self.grid.fields_changed(&mut self.scene, prune) {
            self.grid.ahead =
                self.scene.contact.separates() && age < OFTEN && self.particles() < FEW * self.blocks();
            self.arrange().map_err(|outside| self.stopped(self.who_left(outside)))?;
        }
        self.clock.advance(dt.to_double());
        Ok(())
    }

    /// Apply contact between bodies at shared nodes.
    fn apply_contact(&mut self, phase: ContactPhase, dt: T) {
        let contact = &*self.scene.contact;
        if contact.separates() && (phase == ContactPhase::Trial || contact.corrects_strain()) {
            let (clock, of) = (Instant::now(), self.stage_of(dt));
            let (mut stage, state) = self.grid.stage(&self.scene, &self.team, of);
            let acts = phase == ContactPhase::Trial;
            let mut planes = if acts { stage.plane_touches(&self.scene.rigid) } else { Vec::new() };
            stage.apply_contact(contact, phase, state, &mut planes);
            if acts {
                self.stepper.plane_pushes = rigid::planes::pushes(&planes);
            }
            self.stepper.spent.contact += clock.elapsed();
        }
    }

    /// Plan the step of rigid bodies with prescribed motion.
    fn plan_rigid(&mut self, dt: T) -> Result<(), StepError> {
        for n in 0..self.scene.rigid.len() {
            let (body, hoop) = (self.scene.rigid[n], self.facts().hoop);
            let name = self.scene.bodies[body].name().to_string();
            let planned = self.scene.bodies[body]
                .rigid_mut()
                .map_or(Ok(()), |state| state.plan(&name, self.clock.time, dt.to_double(), hoop));
            planned.map_err(|error| self.stopped(Stopped::Scene(error)))?;
        }
        Ok(())
    }

    /// Move rigid bodies and their nodes; free bodies move by the impulses on their nodes in this step.
    fn move_rigid(&mut self, dt: T) -> Result<(), StepError> {
        if self.scene.rigid.is_empty() {
            return Ok(());
        }
        let pushes = std::mem::take(&mut self.stepper.plane_pushes);
        let (time, step) = (self.clock.time, dt.to_double());
        let gravity = self.scene.conditions.gravity.as_ref().map_or([0.0; D], |g| g(time));
        for n in 0..self.scene.rigid.len() {
            let number = self.scene.rigid[n];
            let Some(state) = self.scene.bodies[number].rigid().filter(|s| !s.is_prescribed()).cloned()
            else {
                continue;
            };
            let (impulse, moment) = self.stage(dt).push_on(number, &state);
            let of_planes = || pushes.iter().filter(|p| p.body == number);
            let [impulse, moment] = state.pushed_by([impulse, moment], of_planes());
            let (impulse, moment) = self.damped(&state, (impulse, moment), dt.to_double());
            let Some(state) = self.scene.bodies[number].rigid_mut() else { continue };
            let held = state.push(impulse, moment, step);
            let held = held.map_err(|wrong| {
                let body = self.scene.bodies[number].name().into();
                let Wrong { field, value, allowed } = wrong;
                self.stopped(Stopped::Scene(SceneError::Rigid { body, field, value, allowed }))
            })?;
            let Some(state) = self.scene.bodies[number].rigid_mut() else { continue };
            state.keep_out_of(&self.scene.conditions.boundaries, time, step);
            of_planes().for_each(|p| p.book(state, &gravity, step, &mut self.grid.scene_wide));
            let velocity = state.velocity();
            for d in 0..3 {
                self.grid.scene_wide.impulse[d] += held[d];
                self.grid.scene_wide.work += held[d] * velocity[d];
            }
            // The work of a body force was booked with the velocities of an unconstrained body.
            for d in 0..D {
                self.grid.scene_wide.work += 0.5 * step * gravity[d] * held[d];
            }
        }
        self.stage(dt).move_rigid();
        for n in 0..self.scene.rigid.len() {
            if let Some(state) = self.scene.bodies[self.scene.rigid[n]].rigid_mut() {
                state.advance();
            }
        }
        self.check_rigid_places().map_err(|error| self.stopped(Stopped::Scene(error)))
    }

    /// Apply local damping to the nodes, if enabled.
    fn damp(&mut self, dt: T) {
        if self.scene.conditions.damping.acts() {
            self.stage(dt).damp(dt);
        }
    }

    /// Apply local damping to a free rigid body: return the remaining impulse, N s, and moment about its centre, N m
    /// s, of the step, and book the removed part.
    fn damped(
        &mut self,
        state: &RigidState<D>,
        (mut impulse, mut moment): ([f64; 3], [f64; 3]),
        dt: f64,
    ) -> ([f64; 3], [f64; 3]) {
        let damping = self.scene.conditions.damping;
        if !damping.acts() {
            return (impulse, moment);
        }
        let (mass, velocity, spin) = (state.mass(), state.velocity(), state.spin());
        let gravity = self.scene.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.clock.time));
        for d in 0..3 {
            let left = mass * (damping.slowed(velocity[d], velocity[d] + impulse[d] / mass) - velocity[d]);
            let more = left - impulse[d];
            self.grid.scene_wide.load[d] += more;
            self.grid.scene_wide.damping -= more * (velocity[d] + 0.5 * left / mass);
            // The work of a body force was booked with the undamped velocities.
            self.grid.scene_wide.work += 0.5 * dt * gravity.get(d).map_or(0.0, |g| g * more);
            impulse[d] = left;
            if spin[d] != 0.0 {
                let turning = -damping.coefficient() * moment[d].abs() * spin[d].signum();
                self.grid.scene_wide.damping -= turning * spin[d];
                moment[d] += turning;
            }
        }
        (impulse, moment)
    }

    /// Check that no rigid body is behind a plane of symmetry, which does not stop bodies of prescribed motion.
    fn check_rigid_places(&self) -> Result<(), SceneError> {
        let planes =
            self.scene.conditions.boundaries.iter().filter(|b| matches!(b, Boundary::Symmetry { .. }));
        for boundary in planes {
            for &number in &self.scene.rigid {
                let (body, mut behind) = (&self.scene.bodies[number], None);
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

    /// Remove contact from the momentum that the stress update of USF used.
    fn undo_contact_correction(&mut self, dt: T) {
        if self.scene.contact.separates() && self.scene.contact.corrects_strain() {
            let (mut stage, state) = self.grid.stage(&self.scene, &self.team, self.stage_of(dt));
            stage.undo_contact_correction(state);
        }
    }

    /// Sum the surface loads of all bodies that the last pass mapped.
    fn loading(&self) -> Loading {
        let mut sum = Loading::default();
        for body in &self.scene.bodies {
            let one = body.loading();
            for d in 0..3 {
                sum.force[d] += one.force[d];
            }
            sum.power += one.power;
        }
        sum
    }

    /// Map the particles in their present state, unless a pass did.
    pub(super) fn map_particles(&mut self, left: f64) -> Result<(), StepError> {
        if !self.stepper.mapped {
            let spacing = self.grid.lattice().spacing();
            let rates = self.scene.bodies.iter().map(|b| b.rate(spacing));
            self.stepper.rate = rates.fold(T::default(), |a, b| if b > a { b } else { a });
            let planned = self.plan(left)?;
            let refits = if self.facts().affine { self.stepper.refits } else { 0 };
            // Particles have no affine field at the start of a run. Without it a rotating body would lose the angular
            // momentum of its particles about their own centres, 1 % at a radius of ten cells. The impulse of the
            // next step, which may be mapped with the momentum, is not part of the field.
            self.stepper.planned = if refits == 0 { planned } else { T::default() };
            self.particle_pass(Which::Map, T::default())?;
            for fit in 1..=refits {
                self.stage(T::default()).mean_velocities();
                self.stepper.planned = if fit == refits { planned } else { T::default() };
                self.particle_pass(Which::Refit, T::default())?;
            }
            self.stepper.acting = self.loading();
            self.stepper.mapped = true;
        }
        Ok(())
    }

    /// Add the terms of the series for the inverse of the full mass matrix to the velocity (FMPM).
    fn invert_full_mass(&mut self, dt: T) -> Result<(), StepError> {
        let order = self.facts().order;
        if order < 2 {
            return Ok(());
        }
        let mut terms = std::mem::take(&mut self.grid.terms);
        self.stage(dt).first_terms(&mut terms);
        for _ in 1..order {
            self.particle_pass(Which::Smooth, dt)?;
            self.stage(dt).refine_velocities(&mut terms);
        }
        self.grid.terms = terms;
        self.hold_at_walls(dt, false);
        Ok(())
    }

    pub(super) fn particle_pass(&mut self, which: Which, dt: T) -> Result<(), StepError> {
        let adapt = matches!(self.stepper.control, TimeControl::Courant { .. });
        // Forces act in the step after the map; those of USF in the present one.
        let usf = self.facts().before_forces && which == Which::First;
        let force_time = self.clock.time + if usf { 0.0 } else { dt.to_double() };
        let Conditions { gravity, boundaries, .. } = &self.scene.conditions;
        let force = gravity.as_ref().map_or([0.0; D], |force| force(0.0));
        let force = CentreLead::along(&force, boundaries, self.facts().hoop);
        let dt = Steps { this: dt, next: self.stepper.planned, adapt, force_time, force };
        // Only particles read the nodes that depend on others.
        self.grid.planes.ties.extend(self.grid.storage.nodes_mut(), &self.team);
        let nodes = Nodes { all: self.grid.nodes(), layout: self.grid.fields.layout() };
        let team = &self.team;
        self.stepper.passed.resize_with(self.scene.bodies.len(), || Ok(T::default()));
        let clock = Instant::now();
        each_body(team, &mut self.scene.bodies, &mut self.stepper.passed, |body, passed| {
            *passed = body.pass(which, nodes, dt, team);
        });
        self.stepper.spent.particles += clock.elapsed();
        let (mut rate, mut fastest) = (T::default(), 0);
        for (b, passed) in self.stepper.passed.iter_mut().enumerate() {
            match std::mem::replace(passed, Ok(T::default())) {
                Ok(r) if r > rate => (rate, fastest) = (r, b),
                Ok(_) => {}
                Err(BodyTrouble { particle, position, cause }) => {
                    // End the run with all particles at their last positions.
                    for body in &mut self.scene.bodies {
                        body.locate(which, false, &self.team);
                    }
                    let (body, law) = (self.scene.bodies[b].name().to_string(), self.scene.bodies[b].law());
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
            (self.stepper.rate, self.stepper.fastest) = (rate, fastest);
        }
        Ok(())
    }

    /// Return the present step; where momentum and impulse are mapped together, also plan the next one.
    fn time_step(&mut self, left: f64) -> Result<T, StepError> {
        if !self.facts().maps_together {
            return self.plan(left);
        }
        let dt = self.stepper.planned;
        self.clock.last = Some(dt.to_double());
        let then = left - dt.to_double();
        self.stepper.planned = self.plan(if then > 1e-9 * left.abs() { then } else { f64::INFINITY })?;
        Ok(dt)
    }

    fn plan(&mut self, left: f64) -> Result<T, StepError> {
        let mut rate = self.stepper.rate.to_double();
        if let TimeControl::Gershgorin { every, .. } = self.stepper.control {
            let known = self.stepper.gershgorin.filter(|(step, _)| self.clock.steps < step + every);
            let (step, sharp) = known.unwrap_or_else(|| (self.clock.steps, self.gershgorin_rate()));
            (self.stepper.gershgorin, rate) = (Some((step, sharp)), sharp);
        }
        let mut longest = self.steps_of_clients().map(|(_, step)| step).fold(f64::INFINITY, f64::min);
        if self.scene.rigid.len() == self.scene.bodies.len() {
            rate = self.rigid_rate(rate);
            // The future speed of bodies at rest is unknown.
            longest = longest.min(if rate > 0.0 { longest } else { LEAST_PART * left });
        }
        let dt = self.stepper.control.next(rate, self.clock.last).min(longest);
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(self.stopped(Stopped::NoTimeStep(dt)));
        }
        if self.scene.clients.is_empty() {
            return Ok(T::of(dt.min(left)));
        }
        // Avoid, like `Clock::step_within`, a last step near zero, in which clients with surfaces would correct penetrations.
        Ok(T::of(if dt >= left * (1.0 - 1e-9) { left } else { dt.min(0.5 * left) }))
    }

    /// Substitute for the rate of waves in scenes without any, 1/s, from the rate at which bodies cross cells: a body
    /// that moves or starts to fall crosses a cell in some tens of steps.
    fn rigid_rate(&self, crossing: f64) -> f64 {
        let gravity = self.scene.conditions.gravity.as_ref().map_or([0.0; D], |g| g(self.clock.time));
        let weight = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        STEPS_A_CELL * (crossing + (weight / self.grid.lattice().spacing()).sqrt())
    }

    /// Iterate over the bodies with steps of their own: index, and longest step in one of the scene, s.
    fn steps_of_clients(&self) -> impl Iterator<Item = (usize, f64)> {
        let clients = self.scene.clients.iter();
        clients.filter_map(|&n| Some((n, self.scene.bodies[n].client()?.stable_step())))
    }

    /// Cause that limits the next step.
    pub(super) fn step_limit(&self) -> StepLimit {
        let control = &self.stepper.control;
        let rate = match (control, self.stepper.gershgorin) {
            (TimeControl::Gershgorin { .. }, Some((_, sharp))) => sharp,
            _ => self.stepper.rate.to_double(),
        };
        let own = control.next(rate, self.clock.last);
        let shorter = self.steps_of_clients().filter(|(_, step)| *step < own);
        match shorter.min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((client, _)) => StepLimit::Body(client),
            None => control.limit(rate, self.clock.last, self.stepper.fastest),
        }
    }

    /// Size of the next step, s.
    pub(super) fn stable_step_here(&mut self) -> Result<f64, StepError> {
        self.map_particles(f64::INFINITY)?;
        if self.facts().maps_together {
            Ok(self.stepper.planned.to_double())
        } else {
            Ok(self.plan(f64::INFINITY)?.to_double())
        }
    }

    /// Parameters of a stage in a step of `dt`, s.
    fn stage_of(&self, dt: T) -> StageOf<T> {
        let facts = self.facts();
        let (wide, takes, forces) = (facts.wide(), self.kernels.taken(dt), !facts.maps_together);
        StageOf { time: self.clock.time, wide, takes, forces, dt }
    }

    pub(super) fn stage(&mut self, dt: T) -> GridStages<'_, T, D> {
        let of = self.stage_of(dt);
        self.grid.stage(&self.scene, &self.team, of).0
    }

    /// Arrange the node blocks that the particles reach, and link the bodies to them.
    pub(super) fn arrange(&mut self) -> Result<(), OutsideGrid> {
        let (clock, planes) = (Instant::now(), self.at_planes());
        let arranged = self.grid.arrange(&mut self.scene, &self.team, self.clock.steps, planes);
        self.stepper.spent.arrangement += clock.elapsed();
        arranged
    }

    pub(super) fn arrange_planes(&mut self) {
        let planes = self.at_planes();
        self.grid.arrange_planes(&self.scene.conditions.boundaries, &self.scene.rigid, planes);
    }

    /// Stencil reach and nodal shares of surface loads at planes.
    fn at_planes(&self) -> AtPlanes {
        let reach = [self.facts().wide(), self.facts().boundary_modified];
        AtPlanes { reach, shares: self.surface_shares() }
    }

    /// Shares of a traction on a plane of nodes for the nodes in front of, on and behind it: the weights of a point there.
    fn surface_shares(&self) -> [f64; 3] {
        let facts = self.facts();
        if !facts.wide() || facts.domain.convects() {
            return [0.0, 1.0, 0.0];
        }
        // The domain of a particle is not part of the surface: the limit of weights without a domain are linear shape functions.
        let (point, none) = (T::of(1e-3), 1e-2);
        let xi = T::of(if facts.nodes.is_multiple_of(2) { -0.5 } else { 0.0 });
        let [weights, _] = self.kernels.shape().weights(xi, point);
        let shares: [f64; 3] = std::array::from_fn(|n| weights[n].to_double());
        let shares = shares.map(|share| if share > none { share } else { 0.0 });
        let sum: f64 = shares.iter().sum();
        shares.map(|share| share / sum)
    }

    /// Return the error for a block of nodes outside the grid. It names the nearest particle: the one that needs the block.
    pub(super) fn who_left(&self, outside: OutsideGrid) -> Stopped {
        let lattice = self.grid.lattice();
        let (origin, width) = (lattice.origin(), BLOCK as f64 * lattice.spacing());
        let mut nearest = f64::INFINITY;
        let (mut who, mut number, mut place) = (0, 0, [0.0; 3]);
        for (k, body) in self.scene.bodies.iter().enumerate() {
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
        let body = &self.scene.bodies[who];
        let (law, body) = (body.law(), body.name().to_string());
        Stopped::Outside { body, particle: number, position: place, law, outside: Box::new(outside) }
    }

    pub(super) fn stopped(&self, what: Stopped) -> StepError {
        self.clock.stopped(what)
    }
}
