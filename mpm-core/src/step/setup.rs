//! Conditions, loads, damping and time control of a scene.

use super::mpm::Mpm;
use super::nodes::wrap::Wrap;
use impactite_scene::boundary::{Boundary, BoundaryError, Side};
use impactite_scene::error::SceneError;
use impactite_scene::{BoundaryEntry, LocalDamping, TimeControl};
use impactite_simd::{Float, Team};

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Check that bodies can use the method in this scene.
    pub(super) fn check_method(&self) -> Result<(), SceneError> {
        if self.scene.contact.separates() {
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

    /// Add a boundary condition; conditions are applied in the order in which they were added.
    ///
    /// # Errors
    /// An axis that does not exist; a symmetry or absorbing plane between nodes; a symmetry plane with particles
    /// behind it; values that are not finite or that a condition refuses; walls in the reference configuration;
    /// periodic planes whose distance is not a multiple of blocks of four cells, beside another plane across their
    /// axis, with existing bodies or contact between bodies, or along a radius.
    pub fn bound(&mut self, boundary: impl Into<BoundaryEntry<D>>) -> Result<(), SceneError> {
        self.work.bound(self, boundary.into())
    }

    pub(super) fn bound_here(&mut self, entry: BoundaryEntry<D>) -> Result<(), SceneError> {
        // Nodes in the reference configuration keep their matter.
        let entry = if self.facts().total { entry.in_reference() } else { entry };
        let boundary = entry.boundary();
        boundary.check(self.grid.lattice())?;
        self.check_periodic(boundary)?;
        if self.grid.fields.levels().is_some() {
            self.check_boundaries_of_levels([boundary])?;
        }
        if self.facts().total && boundary.is_wall() {
            return Err(BoundaryError::WallInReference.into());
        }
        for body in &self.scene.bodies {
            let mut behind = None;
            body.for_each(&mut |p| {
                let x = std::array::from_fn(|d| p.position[d]);
                behind = behind.take().or_else(|| self.behind_symmetry(boundary, body.name(), p.number, &x));
            });
            behind.map_or(Ok(()), Err)?;
        }
        for &(client, _) in &self.scene.growing {
            self.scene.bodies[client].client_mut().map_or(Ok(()), |client| client.bound(&entry))?;
        }
        self.scene.conditions.boundaries.add(entry);
        self.halve_rigid();
        self.arrange_planes();
        Ok(())
    }

    /// Constrain free rigid bodies that planes of symmetry cut to motions that preserve the symmetry.
    pub(super) fn halve_rigid(&mut self) {
        for boundary in &self.scene.conditions.boundaries {
            let Boundary::Symmetry { axis, at, side } = *boundary else { continue };
            for &number in &self.scene.rigid {
                if let Some(state) = self.scene.bodies[number].rigid_mut() {
                    state.halve(axis, at, side.sign());
                }
            }
        }
    }

    /// Return the map of blocks beyond periodic planes.
    pub(super) fn wrap(&self) -> Result<Wrap<D>, SceneError> {
        Ok(Wrap::of(&self.scene.conditions.boundaries, self.grid.lattice())?)
    }

    /// Check that periodic planes are compatible with the scene and with other planes.
    fn check_periodic(&self, boundary: &Boundary<D>) -> Result<(), SceneError> {
        let mut all = self.scene.conditions.boundaries.to_vec();
        all.push(boundary.clone());
        Wrap::of(&all, self.grid.lattice())?;
        let Boundary::Periodic { axis, .. } = *boundary else { return Ok(()) };
        let refuse = |why| Err(BoundaryError::Periodic { axis, why }.into());
        if !self.scene.bodies.is_empty() {
            return refuse("once there are bodies; they must be given before");
        }
        if self.scene.contact.separates() {
            return refuse("where bodies are kept apart; the scene must be of one field");
        }
        if self.facts().hoop && axis == 0 {
            return refuse("along the radius; they must lie across the axis of revolution");
        }
        Ok(())
    }

    /// Return the error for a particle behind a plane of symmetry, where its image is.
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

    /// Set the acceleration of all material, m/s^2, as a function of time, s.
    pub fn set_body_force(&mut self, acceleration: impl Fn(f64) -> [f64; D] + Send + Sync + 'static) {
        self.scene.conditions.gravity = Some(std::sync::Arc::new(acceleration));
    }

    /// Set local damping towards rest: the unbalanced force of every node, including weight, contact and boundary
    /// reactions, is reduced along each axis by its fraction `coefficient` while it accelerates the node, and
    /// increased by as much while it decelerates it, f <- f - alpha |f| sign(v) (Cundall 1987; [`LocalDamping`]).
    /// Balanced forces are unchanged, so that the state at rest is exact. The momentum removed is booked as a load,
    /// the energy as damping. Free rigid bodies are damped by their total force and moment. Use 0.05 for slow
    /// processes, 0.7 to come to rest soonest. Particle velocities that nodes do not resolve are not damped, and FLIP
    /// with wide stencils accumulates them: use a [`Blend`](crate::Blend) there.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1), or a method that maps momentum and impulse together
    /// ([`Composition::MAPS_TOGETHER`](crate::Composition::MAPS_TOGETHER)), where nodes have no separate forces.
    pub fn set_local_damping(&mut self, coefficient: f64) -> Result<(), SceneError> {
        let damping = LocalDamping::new(coefficient)?;
        if self.facts().maps_together && damping.acts() {
            return Err(SceneError::NoForces(self.facts().description.clone()));
        }
        self.scene.conditions.damping = damping;
        Ok(())
    }

    /// Set the time step control.
    ///
    /// # Errors
    /// Values out of range.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), SceneError> {
        control.check()?;
        if matches!(control, TimeControl::Gershgorin { .. }) {
            self.check_clients("`TimeControl::Gershgorin`")?;
        }
        self.stepper.control = control;
        self.stepper.gershgorin = None;
        self.clock.last = None;
        self.stepper.mapped = false;
        Ok(())
    }

    /// Set the thread pool. Results do not depend on the number of threads.
    pub fn set_team(&mut self, team: Team) {
        self.team = team;
    }
}
