//! Stages of a step for bodies of another discretisation.

use super::client::{GridClient, Taken};
use super::client_body::ClientBody;
use super::near_particles::NearParticles;
use super::new_particles::Matter;
use crate::step::bodies::body::Which;
use crate::step::bodies::capability::ClientSteps;
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::contact::ContactPhase;
use crate::step::mpm::Mpm;
use crate::step::nodes::footprint::Folds;
use crate::step::nodes::layout::Nodes;
use crate::step::nodes::stages::mass_cutoff;
use impactite_scene::control::TimeControl;
use impactite_scene::error::{SceneError, StepError, Stopped};
use impactite_scene::{Boundary, Finding, Parts};
use impactite_simd::Float;

/// Ratio of the spacing of points to that of nodes beyond which particles may slip through.
const WIDEST: f64 = 1.05;

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Move the clients by their own forces, and map their velocities.
    pub(in crate::step) fn open_clients(&mut self, dt: T) -> Result<(), StepError> {
        if self.scene.conditions.gravity.is_some() {
            self.check_weight().map_err(|e| self.stopped(Stopped::Scene(e)))?;
        }
        for n in 0..self.scene.clients.len() {
            let nodes = Nodes { all: self.grid.nodes(), layout: self.grid.fields.layout() };
            let body = self.scene.bodies[self.scene.clients[n]].client_mut();
            let opened = body.map_or(Ok(()), |body| body.open(nodes, dt, &self.team));
            opened.map_err(|what| self.stopped(what))?;
        }
        Ok(())
    }

    /// Apply the velocity changes of their nodes to the clients, deform and move them.
    pub(in crate::step) fn advance_clients(&mut self, dt: T) -> Result<(), StepError> {
        for n in 0..self.scene.clients.len() {
            let nodes = Nodes { all: self.grid.nodes(), layout: self.grid.fields.layout() };
            let body = self.scene.bodies[self.scene.clients[n]].client_mut();
            let advanced = body.map_or(Ok(T::default()), |body| body.advance(nodes, dt, &self.team));
            let rate = advanced.map_err(|what| self.stopped(what))?;
            self.stepper.rate = self.stepper.rate.max(rate);
        }
        Ok(())
    }

    /// Refuse a feature that needs all forces at the nodes of the scene, if bodies of another discretisation have proxies there.
    pub(in crate::step) fn check_clients(&self, what: &'static str) -> Result<(), SceneError> {
        self.refuse_beside(what, |client| client.on_grid())
    }

    /// Refuse a body force if there are clients whose own forces are not nodal forces.
    fn check_weight(&self) -> Result<(), SceneError> {
        self.refuse_beside("a body force of the scene", |client| client.on_grid() && !client.is_within())?;
        match self.scene.growing.first() {
            None => Ok(()),
            Some(&(n, _)) => Err(SceneError::BesideClient {
                body: self.scene.bodies[n].name().into(),
                what: "a body force of the scene",
            }),
        }
    }

    fn refuse_beside(
        &self,
        what: &'static str,
        stands_against: impl Fn(&dyn ClientSteps<T, D>) -> bool,
    ) -> Result<(), SceneError> {
        let against = |n: &&usize| self.scene.bodies[**n].client().is_some_and(&stands_against);
        match self.scene.clients.iter().find(against) {
            None => Ok(()),
            Some(&n) => Err(SceneError::BesideClient { body: self.scene.bodies[n].name().into(), what }),
        }
    }

    /// Apply contact between particles and the surfaces of clients.
    pub(in crate::step) fn meet_surfaces(&mut self, dt: T) -> Result<(), StepError> {
        for n in 0..self.scene.clients.len() {
            let number = self.scene.clients[n];
            let apart = self.check_apart(number);
            let met = apart.and_then(|()| self.meet_surface(number, dt));
            met.map_err(|what| self.stopped(what))?;
        }
        Ok(())
    }

    /// Stop where the surface of a client meets a body that is not of particles: no contact acts between them.
    fn check_apart(&mut self, number: usize) -> Result<(), Stopped> {
        let (before, rest) = self.scene.bodies.split_at_mut(number);
        let Some((client, after)) = rest.split_first_mut() else { return Ok(()) };
        let name = client.name().to_string();
        let Some(surface) = client.client_mut().and_then(ClientSteps::surface) else { return Ok(()) };
        for other in before.iter().chain(after.iter()) {
            let mut meet = false;
            if let Some(elements) = other.client().filter(|c| !c.is_within()) {
                elements.each_box(&mut |low, high| meet |= surface.reaches(low, high));
            } else if other.rigid().is_some() {
                other.for_each_with(Parts::SIZE, &mut |p| {
                    let side = |d: usize, sign: f64| {
                        p.position[d] + sign * (0..3).map(|e| p.half_edges[e][d].abs()).sum::<f64>()
                    };
                    let (low, high) =
                        (std::array::from_fn(|d| side(d, -1.0)), std::array::from_fn(|d| side(d, 1.0)));
                    meet |= surface.reaches(&low, &high);
                });
            }
            if meet {
                let other = other.name().into();
                return Err(Stopped::Scene(SceneError::NoContactOf { elements: name, other }));
            }
        }
        Ok(())
    }

    fn meet_surface(&mut self, number: usize, dt: T) -> Result<(), Stopped> {
        let cutoff = self.scene.lightest() * mass_cutoff::<T>();
        let modified = self.kernels.facts().boundary_modified;
        let folds = Folds::of(&self.scene.conditions.boundaries, &self.grid.fields, modified);
        let known = !self.kernels.facts().maps_together;
        let mut near = std::mem::take(&mut self.grid.near);
        near.clear();
        let (before, rest) = self.scene.bodies.split_at_mut(number);
        let Some((client, after)) = rest.split_first_mut() else { return Ok(()) };
        let Some(surface) = client.client_mut().and_then(ClientSteps::surface) else { return Ok(()) };
        let reaches = |low: &[f64; D], high: &[f64; D]| surface.reaches(low, high);
        let numbered = (number + 1..).zip(after.iter());
        for (body, particles) in before.iter().enumerate().chain(numbered) {
            if let Some(particles) = particles.meets_surfaces() {
                self.grid.gather_near(
                    &mut near,
                    (body as u32, particles),
                    (&folds, cutoff, known, dt),
                    &reaches,
                );
            }
        }
        let met =
            if near.is_empty() { Ok(Taken::default()) } else { surface.meet(&mut near, dt, &self.team) };
        if let Ok(taken) = met {
            self.ledger.friction += taken.friction;
            self.ledger.impacts += taken.impacts;
            self.push_nodes(&near, dt);
        }
        self.grid.near = near;
        met.map(|_| ())
    }

    /// Add the impulses of a surface on particles to the nodes, and apply boundary conditions again if there were any.
    pub(in crate::step) fn push_nodes(&mut self, near: &NearParticles<D>, dt: T) {
        let end = self.clock.time + dt.to_double();
        let tolerance = 1e-6 * self.grid.lattice().spacing();
        let copies = if self.facts().wide() { 1.5 * self.grid.lattice().spacing() } else { 0.0 };
        let per_dt = T::of(1.0) / dt;
        let pushed = || near.nodes.iter().filter(|node| node.change != [0.0; D]);
        if pushed().next().is_none() {
            return;
        }
        let mut of_planes = [0.0; 3];
        of_planes[..D].copy_from_slice(&near.planes);
        (0..D).for_each(|d| self.ledger.impulse[d] += of_planes[d]);
        self.scene.conditions.boundaries.book_symmetry(&of_planes, &mut self.ledger);
        self.stage(dt).note_velocities();
        for near in pushed() {
            let node = &mut self.grid.nodes_mut()[near.place as usize];
            let mut v = [0.0; 3];
            v[..D].copy_from_slice(&near.velocity);
            let free = v;
            let (x, at) = (&near.position, (end, tolerance, copies));
            let not_wall = |_, b: &Boundary<D>| !b.is_wall();
            self.scene.conditions.boundaries.constrain(not_wall, x, &mut v, at, near.mass, &mut self.ledger);
            for d in 0..D {
                let change = T::of(near.change[d] + v[d] - free[d]);
                node.first[d + 1] += change;
                node.second[d + 1] += change * per_dt;
                let held = near.mass * (v[d] - free[d]);
                self.ledger.impulse[d] += held;
                self.ledger.work += held * v[d];
            }
        }
        let mut stage = self.stage(dt);
        stage.copy_velocities(ContactPhase::Trial, 1.0);
        stage.extrapolate();
    }

    /// Add a body of another discretisation. Its own forces act on its own nodes; contact with the bodies and walls
    /// of this scene is computed on the grid of the scene. The body makes the steps of this scene, of the length that
    /// the scene finds. Loads and body forces of the body are its own; of the conditions of this scene, walls and
    /// fixed planes act on it.
    ///
    /// # Errors
    /// A scene without contact, in the reference configuration, or whose nodes have no accelerations (PIC, APIC,
    /// FMPM); other coordinates; points larger than a cell of this grid or outside of it; a body force, kinetic
    /// damping, a null-space filter, periodic planes, a body whose particles merge or [`TimeControl::Gershgorin`] in
    /// this scene.
    pub fn add_client(&mut self, body: impl GridClient<T, D> + 'static) -> Result<(), SceneError> {
        self.work.add_client(self, Box::new(body))
    }

    pub(in crate::step) fn add_any_client(
        &mut self,
        body: Box<dyn GridClient<T, D>>,
    ) -> Result<(), SceneError> {
        self.add_client_here("a body of another discretisation", body)
    }

    pub(in crate::step) fn add_client_here(
        &mut self,
        what: &'static str,
        body: Box<dyn GridClient<T, D>>,
    ) -> Result<(), SceneError> {
        self.check_levels(what)?;
        let mut body = body;
        let on_grid = !body.mass_points().is_empty();
        let matter = body.matter();
        let within = match (body.within(), &matter) {
            (None, _) => None,
            (Some(name), None) => Some(self.place_of_host(body.name(), name)?),
            // Index of the body that is added next.
            (Some(name), Some(_)) => {
                self.check_name(name)?;
                Some(self.scene.bodies.len())
            }
        };
        if on_grid && within.is_none() && !self.scene.contact.separates() {
            return Err(SceneError::NoContact(what));
        }
        if !on_grid && matter.is_none() && body.surface().is_none() {
            return Err(SceneError::Empty(body.name().into()));
        }
        self.check_frame(what, "the scene that bodies meet in is one of the current configuration")?;
        let here = self.facts();
        let proxies =
            self.kernels.for_place(within.is_some()).or_else(|| (!on_grid).then(|| self.kernels.clone()));
        let Some(kernels) = proxies else {
            let why = "such bodies meet others where nodes know accelerations: take FLIP or a blend";
            return Err(SceneError::NotWith { what: what.into(), method: here.description.clone(), why });
        };
        let (returns, here) = (if here.before_forces { Which::Second } else { Which::First }, here.embedding);
        let name = body.name().to_string();
        if body.embedding() != here {
            return Err(SceneError::OtherSpace { body: name, there: body.embedding(), here });
        }
        let refuse = |what| Err(SceneError::BesideClient { body: name.clone(), what });
        if on_grid || matter.is_some() {
            self.check_beside(&refuse)?;
            if (within.is_none() || matter.is_some()) && self.scene.conditions.gravity.is_some() {
                return refuse("a body force of the scene");
            }
        }
        self.check_half_sizes(&name, &body.half_size())?;
        let ratio = body.spacing() / self.grid.lattice().spacing();
        if let Some(matter) = &matter {
            self.check_matter(&mut *body, matter)?;
        }
        let body = ClientBody::new(body, [self.kernels.clone(), kernels], *self.grid.lattice(), returns);
        let number = self.scene.bodies.len() as u32;
        if let Some(host) = within {
            self.grid.fields.join(number, host as u32);
        }
        let entered = self.enter(&name, Box::new(body)).inspect_err(|_| self.grid.fields.part(number));
        if entered.is_err() && matter.is_some() {
            self.scene.bodies.pop();
        }
        entered?;
        self.scene.clients.push(self.scene.bodies.len() - 1);
        if let Some(host) = within.filter(|_| matter.is_some()) {
            self.scene.growing.push((self.scene.bodies.len() - 1, host));
        }
        if on_grid && within.is_none() && ratio > WIDEST {
            let finding = Finding::WidePoints { body: name.clone(), ratio };
            let same = |f: &Finding| matches!(f, Finding::WidePoints { body, .. } if *body == name);
            self.looks.watcher.warn_once(&self.clock, finding, same);
        }
        Ok(())
    }

    /// Add an empty body for particles from the matter of a client, and pass the boundary conditions to the client.
    fn check_matter(
        &mut self,
        client: &mut dyn GridClient<T, D>,
        matter: &Matter<T, D>,
    ) -> Result<(), SceneError> {
        let name = client.within().unwrap_or_default().to_string();
        self.check_half_sizes(&name, &matter.half_size)?;
        self.scene.conditions.boundaries.entries().iter().try_for_each(|boundary| client.bound(boundary))?;
        let body = ParticleBody::to_come(&name, matter, self)?;
        self.enter(&name, Box::new(body))
    }

    /// Index of the body of particles in which another body is embedded.
    fn place_of_host(&self, body: &str, host: &str) -> Result<usize, SceneError> {
        let at = self.scene.bodies.iter().position(|b| b.name() == host);
        let particles = |&n: &usize| {
            let there = &self.scene.bodies[n];
            there.rigid().is_none() && there.client().is_none()
        };
        at.filter(particles).ok_or_else(|| SceneError::NotWith {
            what: format!("the body `{body}` within `{host}`"),
            method: "the grid of this scene".into(),
            why: "a body is within one of particles that was added before it",
        })
    }

    /// Check that nothing in the scene needs all forces at the nodes.
    fn check_beside(
        &self,
        refuse: &dyn Fn(&'static str) -> Result<(), SceneError>,
    ) -> Result<(), SceneError> {
        if self.between_steps.kinetic_damping.is_some() {
            return refuse("kinetic damping");
        }
        if self.between_steps.filter.is_some() {
            return refuse("a null-space filter");
        }
        if self.scene.bodies.iter().any(|b| b.division().is_some_and(|b| b.merges().is_some())) {
            return refuse("merging");
        }
        if !self.wrap()?.is_none() {
            return refuse("periodic planes");
        }
        if matches!(self.stepper.control, TimeControl::Gershgorin { .. }) {
            return refuse("`TimeControl::Gershgorin`");
        }
        Ok(())
    }
}
