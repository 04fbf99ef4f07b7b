//! Bodies of another discretisation in the steps of a scene.

use super::body::Which;
use super::client::GridClient;
use super::client_body::ClientBody;
use super::layout::Nodes;
use super::mpm::Mpm;
use crate::parallel::Float;
use impactite_scene::control::TimeControl;
use impactite_scene::error::{SceneError, StepError, Stopped};

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Have them move by their own forces, and map their velocities.
    pub(super) fn open_clients(&mut self, dt: T) -> Result<(), StepError> {
        if self.scene.conditions.gravity.is_some() {
            self.check_clients("a body force of the scene").map_err(|e| self.stopped(Stopped::Scene(e)))?;
        }
        for n in 0..self.scene.clients.len() {
            let nodes = Nodes { all: self.grid.nodes(), layout: self.grid.fields.layout() };
            let body = self.scene.bodies[self.scene.clients[n]].client_mut();
            let opened = body.map_or(Ok(()), |body| body.open(nodes, dt, &self.team));
            opened.map_err(|what| self.stopped(what))?;
        }
        Ok(())
    }

    /// Have them take what their nodes got, deform and move.
    pub(super) fn advance_clients(&mut self, dt: T) -> Result<(), StepError> {
        for n in 0..self.scene.clients.len() {
            let nodes = Nodes { all: self.grid.nodes(), layout: self.grid.fields.layout() };
            let body = self.scene.bodies[self.scene.clients[n]].client_mut();
            let advanced = body.map_or(Ok(T::default()), |body| body.advance(nodes, dt, &self.team));
            let rate = advanced.map_err(|what| self.stopped(what))?;
            self.stepper.rate = self.stepper.rate.max(rate);
        }
        Ok(())
    }

    /// Refuse what asks the nodes of the scene for all forces, beside bodies of another discretisation.
    pub(super) fn check_clients(&self, what: &'static str) -> Result<(), SceneError> {
        match self.scene.clients.first() {
            None => Ok(()),
            Some(&n) => Err(SceneError::BesideClient { body: self.scene.bodies[n].name().into(), what }),
        }
    }

    /// Add a body of another discretisation: its own forces act on its own nodes, and it meets the bodies and walls of this scene on
    /// the grid of this one. A step of this scene is one of the body's, too, of the length that this one finds. Loads and body forces of
    /// its own are the body's affair; of the conditions of this scene walls and fixed planes hold it.
    ///
    /// # Errors
    /// A scene without contact, or in the reference configuration, or whose nodes know no accelerations (PIC, APIC, FMPM); other
    /// coordinates; points larger than a cell of this grid or outside of it; a body force, kinetic damping, a null-space filter,
    /// periodic planes, a body whose particles merge or [`TimeControl::Gershgorin`] in this scene.
    pub fn add_client(&mut self, body: impl GridClient<T, D> + 'static) -> Result<(), SceneError> {
        self.work.add_client(self, Box::new(body))
    }

    pub(super) fn add_any_client(&mut self, body: Box<dyn GridClient<T, D>>) -> Result<(), SceneError> {
        self.add_client_here("a body of another discretisation", body)
    }

    pub(super) fn add_client_here(
        &mut self,
        what: &'static str,
        body: Box<dyn GridClient<T, D>>,
    ) -> Result<(), SceneError> {
        if !self.scene.contact.separates() {
            return Err(SceneError::NoContact(what));
        }
        self.check_frame(what, "the scene that bodies meet in is one of the current configuration")?;
        let here = self.facts();
        let Some(kernels) = self.kernels.for_place() else {
            let why = "such bodies meet others where nodes know accelerations: take FLIP or a blend";
            return Err(SceneError::NotWith { what: what.into(), method: here.description.clone(), why });
        };
        let (returns, here) = (if here.before_forces { Which::Second } else { Which::First }, here.embedding);
        let name = body.name().to_string();
        if body.embedding() != here {
            return Err(SceneError::OtherSpace { body: name, there: body.embedding(), here });
        }
        if body.mass_points().is_empty() {
            return Err(SceneError::Empty(name));
        }
        let refuse = |what| Err(SceneError::BesideClient { body: name.clone(), what });
        if self.between_steps.kinetic_damping.is_some() {
            return refuse("kinetic damping");
        }
        if self.between_steps.filter.is_some() {
            return refuse("a null-space filter");
        }
        if self.scene.bodies.iter().any(|b| b.division().is_some_and(|b| b.merges().is_some())) {
            return refuse("merging");
        }
        if self.scene.conditions.gravity.is_some() {
            return refuse("a body force of the scene");
        }
        if !self.wrap()?.is_none() {
            return refuse("periodic planes");
        }
        if matches!(self.stepper.control, TimeControl::Gershgorin { .. }) {
            return refuse("`TimeControl::Gershgorin`");
        }
        self.check_half_sizes(&name, &body.half_size())?;
        let body = ClientBody::new(body, kernels, *self.grid.lattice(), returns);
        self.enter(&name, Box::new(body))?;
        self.scene.clients.push(self.scene.bodies.len() - 1);
        Ok(())
    }
}
