//! Explicit finite element solver: bodies of elements in a scene, and their time steps.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use impactite_geometry::Facet;
use impactite_scene::boundaries::check_at;
use impactite_scene::boundary::{BodyForce, VelocityHistory};
use impactite_scene::constants::over;
use impactite_scene::control::{ControlError, largest};
use impactite_scene::embedding::described;
use impactite_scene::error::parameter;
use impactite_scene::watch::{Look, Loss, Watcher};
use impactite_scene::{
    Account, Archive, Body, Boundaries, BoundaryEntry, CheckpointError, Clock, ContactPoint, Embedding,
    Exchange, Finding, GainCause, LocalDamping, PairContact, SceneError, Solver, StepError, StepLimit,
    Stopped, TimeControl, Totals, Warning, Watch,
};
use impactite_simd::Team;
use mpm_contact::Pairs;
use mpm_contact::mesh::MeshStep;

use crate::body::{ElementBody, MeshBody, Prescribed};
use crate::contact::{ContactSurface, Contacts, look};
use crate::load::{Loading, PressureHistory, SurfaceFacet, SurfaceLoad, TractionHistory, view};
use crate::motion::Part;
use crate::surface::surface_of;
use crate::sweep::Scratch;

/// Default Courant factor: time step over two divided by the bound of the highest frequency.
const COURANT: f64 = 0.9;
/// Number of elements below which a body runs on one thread, because waking more would take longer.
const SMALL: usize = 500;
/// Hourglass energy, over the largest energy of the body, at which a run warns.
const HOURGLASS: f64 = 0.05;
/// Largest energy of a body, over the energy scale of the scene, below which its hourglass energy is not checked.
const HARDLY: f64 = 1e-6;

/// Explicit finite elements in `D` dimensions.
///
/// Bodies pass through each other unless contact is defined ([`Fem::touch`]). Couplings with other methods add impulses in a [`Trial`].
pub struct Fem<const D: usize> {
    hoop: bool,
    space: &'static str,
    pub(crate) bodies: Vec<ElementBody<D>>,
    boundaries: Boundaries<D>,
    body_force: Option<BodyForce<D>>,
    damping: LocalDamping,
    pub(crate) team: Team,
    /// Contact of bodies; boxed, because most scenes have none.
    contact: Option<Box<Contacts<D>>>,
    control: TimeControl,
    /// Maximum number of steps of the scene in one step of a body.
    subcycles: u32,
    clock: Clock,
    /// Size of the open step, s.
    open: Option<f64>,
    watcher: Watcher,
    /// Scratch memory of each thread.
    pub(crate) memory: Arc<Vec<Mutex<Scratch>>>,
}

impl<const D: usize> Fem<D> {
    /// Create a scene without bodies, in `FullSpace`, `PlaneStrain`, `Axisymmetric` or, for bars alone, `Line`. It runs on the caller's
    /// thread with a Courant factor of 0.9.
    pub fn new<E: Embedding<D>>(_: E) -> Self {
        Fem {
            hoop: E::HOOP,
            space: E::NAME,
            bodies: Vec::new(),
            boundaries: Boundaries::default(),
            body_force: None,
            damping: LocalDamping::default(),
            team: Team::one(),
            contact: None,
            control: TimeControl::Courant { factor: COURANT, growth: 1.1 },
            subcycles: 1,
            clock: Clock::default(),
            open: None,
            watcher: Watcher::default(),
            memory: Arc::new(vec![Mutex::default()]),
        }
    }

    /// Add a body. Returns its number.
    ///
    /// # Errors
    /// Invalid mesh, law or technology; empty name, or that of another body.
    pub fn add(&mut self, body: MeshBody<D>) -> Result<usize, SceneError> {
        let mut body = body.build(self.hoop)?;
        let taken = self.bodies.iter().any(|b| b.name == body.name);
        if taken || body.name.is_empty() {
            return Err(SceneError::Name {
                name: body.name,
                allowed: "not empty, and that of no other body",
            });
        }
        body.forces_of_states(&self.team, &self.memory);
        self.bodies.push(body);
        self.contact = self.contact.take().map(|contact| Box::new(contact.with(&self.bodies)));
        self.watcher.reopen();
        Ok(self.bodies.len() - 1)
    }

    /// Add a boundary condition on all nodes ([`Boundary::hold`](impactite_scene::Boundary::hold)). Their order is that of
    /// [`Boundaries::add`].
    ///
    /// # Errors
    /// Invalid parameters of the condition; periodic planes.
    pub fn bound(&mut self, boundary: impl Into<BoundaryEntry<D>>) -> Result<(), SceneError> {
        let entry = boundary.into();
        entry
            .boundary()
            .check_moving("with finite elements; take planes of symmetry, or the material point method")?;
        self.boundaries.add(entry);
        if let Some(contact) = &mut self.contact {
            contact.forget();
        }
        Ok(())
    }

    /// Define contact between all bodies, including bodies added later, by one law or the laws of [`Pairs`]: nodes against the facets of
    /// other bodies ([`mpm_contact::mesh`]; details: [crate](crate#contact)). Self-contact needs [`Fem::touch_itself`]. Nodes of bars are
    /// in contact with facets at half the bar thickness, and never with other bars. Facets on planes of symmetry have no contact.
    ///
    /// # Errors
    /// Laws with memory; a scene on a line; contact that is already defined.
    pub fn touch(&mut self, laws: impl Into<Pairs<f64>>) -> Result<(), SceneError> {
        let laws = laws.into();
        let refuse = |what: &str, method: &str, why| {
            Err(SceneError::NotWith { what: what.into(), method: method.into(), why })
        };
        if D == 1 {
            return refuse(
                "contact of bodies",
                "elements on a line",
                "bars have no facets: take two dimensions",
            );
        }
        if laws.remembered_numbers() > 0 {
            let why = "a node that slides changes its facet, and no memory follows it: take a law without (`Coulomb`)";
            return refuse("a contact law that remembers", "contact of elements", why);
        }
        if self.contact.is_some() {
            return refuse(
                "contact of bodies",
                "a scene that has it",
                "give all laws at once (`Pairs::with`)",
            );
        }
        self.contact = Some(Box::new(Contacts::new(laws, self.hoop).with(&self.bodies)));
        Ok(())
    }

    /// Enable self-contact of a body, by the law of its pair with itself ([`Pairs::with`]).
    ///
    /// # Errors
    /// No contact defined ([`Fem::touch`]); a body that does not exist, or without facets.
    pub fn touch_itself(&mut self, body: usize) -> Result<(), SceneError> {
        let Some(this) = self.bodies.get(body) else {
            let allowed = "the number of a body of the scene";
            return parameter(false, "contact with itself", "body", body as f64, allowed).map(|_| ());
        };
        let refuse = |why| {
            let what = format!("contact of the body `{}` with itself", this.name);
            Err(SceneError::NotWith { what, method: "contact of elements".into(), why })
        };
        if this.surface.is_empty() {
            return refuse("bars have no facets");
        }
        match self.contact.take() {
            None => refuse("there are no laws: ask for contact (`Fem::touch`) before"),
            Some(contact) => {
                self.contact = Some(Box::new(contact.within(body)));
                Ok(())
            }
        }
    }

    /// Contact results of the last step: positions are those at its start. None without contact.
    pub fn last_contact(&self) -> Option<&MeshStep> {
        self.contact.as_ref().map(|contact| contact.last())
    }

    /// Prescribe the velocity of a named node set of a body, m/s over time, evaluated at the middle of each step; it acts after the
    /// boundary conditions.
    ///
    /// # Errors
    /// A body or node set that does not exist.
    pub fn prescribe(&mut self, body: usize, set: &str, velocity: VelocityHistory) -> Result<(), SceneError> {
        let count = self.bodies.len();
        let number = body as f64;
        let Some(body) = self.bodies.get_mut(body) else {
            parameter(false, "prescribed velocity", "body", number, "the number of a body of the scene")?;
            unreachable!("body {number} of {count} was refused")
        };
        let sets = &body.mesh.node_sets;
        let Some(nodes) = sets.get(set) else {
            let names = sets.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
            return Err(SceneError::NotWith {
                what: format!("a velocity of the node set `{set}`"),
                method: format!("the mesh of body `{}` (sets: {names})", body.name),
                why: "it has no such set",
            });
        };
        let mut nodes = nodes.clone();
        nodes.sort_unstable();
        body.prescribed.push(Prescribed { set: set.into(), nodes, velocity });
        Ok(())
    }

    /// Apply a traction over time to facets of the initial surface of a body; several loads add up. Returns the number of loaded facets.
    /// `facets` is their description, which checkpoints compare.
    ///
    /// # Errors
    /// No facet satisfies `picked`.
    ///
    /// # Panics
    /// There is no such body.
    pub fn load(
        &mut self,
        body: usize,
        facets: &str,
        picked: impl Fn(&SurfaceFacet<D>) -> bool,
        history: TractionHistory<D>,
    ) -> Result<usize, SceneError> {
        let chosen = self.chosen(body, ("traction", facets), picked)?;
        let (mut shares, hoop) = (BTreeMap::new(), self.hoop);
        let body = &mut self.bodies[body];
        for facet in &chosen {
            let (_, areas) = view(&body.mesh.nodes, facet, hoop);
            let shared = facet.nodes().iter().zip(areas);
            shared.for_each(|(node, area)| *shares.entry(*node).or_insert(0.0) += area);
        }
        let area = shares.values().sum();
        let loading = Loading::Traction { areas: shares.into_iter().collect(), history };
        body.loads.push(SurfaceLoad { facets: facets.into(), area, loading, acting: Vec::new() });
        Ok(chosen.len())
    }

    /// Apply a pressure over time, Pa, compression positive, to facets of the initial surface of a body: it acts along the present normals
    /// on the present areas. Facets of eroded elements are no longer loaded. Otherwise as [`Fem::load`].
    ///
    /// # Errors
    /// No facet satisfies `picked`.
    ///
    /// # Panics
    /// There is no such body.
    pub fn press(
        &mut self,
        body: usize,
        facets: &str,
        picked: impl Fn(&SurfaceFacet<D>) -> bool,
        history: PressureHistory,
    ) -> Result<usize, SceneError> {
        let chosen = self.chosen(body, ("pressure", facets), picked)?;
        let hoop = self.hoop;
        let body = &mut self.bodies[body];
        let (count, area) =
            (chosen.len(), chosen.iter().map(|f| view(&body.mesh.nodes, f, hoop).0.area).sum());
        let loading = Loading::Pressure { facets: chosen, history };
        body.loads.push(SurfaceLoad { facets: facets.into(), area, loading, acting: Vec::new() });
        Ok(count)
    }

    /// Return the facets of the initial surface of a body that satisfy `picked`; `what` is the load, and the description of the facets.
    fn chosen(
        &self,
        body: usize,
        what: (&str, &str),
        picked: impl Fn(&SurfaceFacet<D>) -> bool,
    ) -> Result<Vec<Facet>, SceneError> {
        let body = &self.bodies[body];
        let mut all = surface_of(&body.mesh, &|_| true);
        all.retain(|facet| {
            let (view, _) = view(&body.mesh.nodes, facet, self.hoop);
            let nodes = facet.nodes();
            picked(&SurfaceFacet { nodes: [0, 1, 2, 3].map(|n| nodes.get(n).copied()), ..view })
        });
        if all.is_empty() {
            return Err(SceneError::NotWith {
                what: format!("a {} on {}", what.0, what.1),
                method: format!("the mesh of body `{}`", body.name),
                why: "no facet of its surface is there",
            });
        }
        Ok(all)
    }

    /// Set the body force: acceleration of all nodes, m/s^2, over time.
    pub fn set_body_force(&mut self, acceleration: BodyForce<D>) {
        self.body_force = Some(acceleration);
    }

    /// Set local damping ([`LocalDamping`]): a part of the unbalanced force of every node, contact and loads included, is removed while it
    /// accelerates the node, and added while it decelerates it; directions held by conditions are not damped. Equilibrium states are
    /// unchanged. The removed energy is booked as damping.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1).
    pub fn set_local_damping(&mut self, coefficient: f64) -> Result<(), SceneError> {
        self.damping = LocalDamping::new(coefficient)?;
        Ok(())
    }

    /// Set the time step control. The Courant rate is half the bound of the highest frequency of any element, bulk viscosity and hourglass
    /// stiffness included: a factor of 1 is the stability limit.
    ///
    /// # Errors
    /// Invalid time step control.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Set subcycling: a body with a longer stable step makes one step for 2, 4 .. at most `most` steps of the scene, and strains its
    /// elements once in these. Mass and momentum are conserved to rounding. 1, the default, disables subcycling. Contact is enforced in
    /// every step of the scene: nodes of a subcycled body receive contact impulses within its step.
    ///
    /// # Errors
    /// `most` is zero.
    pub fn set_subcycling(&mut self, most: u32) -> Result<(), SceneError> {
        parameter(most > 0, "subcycling", "most steps", f64::from(most), "at least 1")?;
        self.subcycles = most;
        Ok(())
    }

    /// Set the run monitoring ([`Watch`]). A run that it stopped may continue after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Set the thread pool. Results are bitwise equal for any number of threads. Bodies of a few hundred elements run on one thread.
    pub fn set_team(&mut self, team: Team) {
        self.memory = Arc::new((0..team.threads()).map(|_| Mutex::default()).collect());
        self.team = team;
    }

    /// Bodies of the scene.
    pub fn element_bodies(&self) -> &[ElementBody<D>] {
        &self.bodies
    }
    /// Body by number.
    ///
    /// # Panics
    /// There is no such body.
    pub fn body(&self, number: usize) -> &ElementBody<D> {
        &self.bodies[number]
    }
    /// Size of the next time step by the time step control, s.
    pub fn next_time_step(&self) -> f64 {
        let rate = self.bodies.iter().map(|b| b.rate).fold(0.0, f64::max);
        self.control.next(rate, self.clock.last)
    }

    /// Begin a step of `dt` seconds: compute trial velocities without contact. A coupling adds impulses to the nodes and then ends the step
    /// ([`Trial::finish`]).
    ///
    /// # Errors
    /// No bodies; a step that is not positive; loads and velocities that are not finite; a stopped run.
    pub fn trial(&mut self, dt: f64) -> Result<Trial<'_, D>, StepError> {
        self.begin(dt)?;
        Ok(Trial { fem: self })
    }

    /// Begin a step like [`Fem::trial`], for a coupling that ends the step with [`Fem::finish`] in another call.
    ///
    /// # Errors
    /// Errors of [`Fem::trial`]; a step that is already open.
    pub fn begin(&mut self, dt: f64) -> Result<(), StepError> {
        self.watcher.may_go_on()?;
        if let Some(open) = self.open {
            return Err(self.clock.refused(
                "step begun",
                open,
                "ended (`Fem::finish`) before another one begins",
            ));
        }
        let begun = self.begin_step(dt);
        self.watcher.note(begun)?;
        let ratios = self.ratios();
        for (body, &ratio) in self.bodies.iter_mut().zip(&ratios) {
            let team = if body.elements < SMALL { &Team::one() } else { &self.team };
            let (clock, force, boundaries) = (&self.clock, self.body_force.as_ref(), &self.boundaries);
            let damping = self.damping;
            body.accelerate(&Part { clock, dt, ratio, force, damping, boundaries }, team);
        }
        self.open = Some(dt);
        Ok(())
    }

    /// End the open step: contact on the velocities left by couplings, boundary conditions, positions, stresses, internal forces and energy
    /// balance.
    ///
    /// # Errors
    /// Failure, with body, element or node, position and cause; no open step.
    pub fn finish(&mut self) -> Result<(), StepError> {
        let Some(dt) = self.open.take() else {
            return Err(self.clock.refused("step begun", 0.0, "there (`Fem::begin`)"));
        };
        let ended = self.end_step(dt);
        self.watcher.note(ended)
    }
    /// Body by number, to add impulses in an open step ([`ElementBody::add_impulse`]).
    ///
    /// # Panics
    /// There is no such body.
    pub fn body_mut(&mut self, number: usize) -> &mut ElementBody<D> {
        &mut self.bodies[number]
    }
    /// Update the contact surfaces of all bodies in an open step, for a coupling: positions, and velocities without contact. The list keeps
    /// data from step to step: use it for this scene only.
    ///
    /// # Errors
    /// A node whose velocity is not finite; no open step.
    pub fn surfaces(&self, list: &mut Vec<ContactSurface<D>>) -> Result<(), StepError> {
        let Some(dt) = self.open else {
            return Err(self.clock.refused("step begun", 0.0, "there (`Fem::begin`)"));
        };
        list.resize_with(self.bodies.len(), ContactSurface::default);
        look(list, &self.bodies, &self.boundaries, (&self.clock, dt), &self.team)
    }
    /// True if a body force is set.
    pub fn has_body_force(&self) -> bool {
        self.body_force.is_some()
    }
    /// True if any body has nodes with prescribed velocities.
    pub fn prescribes(&self) -> bool {
        self.bodies.iter().any(|body| !body.prescribed.is_empty())
    }
    /// Boundary conditions on all nodes.
    pub fn boundaries(&self) -> &Boundaries<D> {
        &self.boundaries
    }
    /// Name of the embedding of the coordinates in space.
    pub fn embedding(&self) -> &'static str {
        self.space
    }

    /// Subcycling ratio of each body: steps of the scene in one step of the body.
    fn ratios(&self) -> Vec<u32> {
        let fastest = self.bodies.iter().map(|b| b.rate).fold(0.0, f64::max);
        let ratio = |body: &ElementBody<D>| {
            let ratio = (fastest / body.rate).min(f64::from(self.subcycles)).max(1.0);
            if ratio.is_finite() { 1 << ratio.log2() as u32 } else { 1 }
        };
        self.bodies.iter().map(ratio).collect()
    }

    /// Check that a step may begin, and open the energy balance if due.
    fn begin_step(&mut self, dt: f64) -> Result<(), StepError> {
        if self.bodies.is_empty() {
            return Err(self.clock.stopped(Stopped::Scene(SceneError::NoBodies)));
        }
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(self.clock.refused("step", dt, "positive and finite"));
        }
        self.check_loads(dt).map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        self.boundaries.advance(self.clock.time, dt);
        if self.watcher.opens() {
            self.bodies.iter_mut().for_each(|body| body.note_energy());
            let (totals, exchange) = (self.totals(), Solver::exchange(self));
            self.watcher.open(self.clock.steps, &totals, &exchange, self.hoop);
        }
        Ok(())
    }

    fn check_loads(&self, dt: f64) -> Result<(), SceneError> {
        let time = self.clock.time;
        check_at(self.body_force.as_ref(), &self.boundaries, time, &[time, time + dt])?;
        for prescribed in self.bodies.iter().flat_map(|b| &b.prescribed) {
            let time = time + 0.5 * dt;
            let wanted = (prescribed.velocity)(time);
            if let Some(&value) = wanted.iter().flatten().find(|v| !v.is_finite()) {
                let what = format!("velocity prescribed for the node set `{}`", prescribed.set);
                return Err(SceneError::NotFinite { what, value, time });
            }
        }
        Ok(())
    }

    /// Enforce contact, update positions, strains and internal forces, and check the energy balance if due.
    fn end_step(&mut self, dt: f64) -> Result<(), StepError> {
        if let Some(contact) = &mut self.contact {
            contact.meet(&mut self.bodies, &self.boundaries, (&self.clock, dt), &self.team)?;
        }
        let ratios = self.ratios();
        for (body, &ratio) in self.bodies.iter_mut().zip(&ratios) {
            let team = if body.elements < SMALL { &Team::one() } else { &self.team };
            let (clock, force, boundaries) = (&self.clock, self.body_force.as_ref(), &self.boundaries);
            let damping = self.damping;
            body.advance(&Part { clock, dt, ratio, force, damping, boundaries }, team)?;
            if let Some(step) = body.pace.moved(dt) {
                body.strain(step, clock, team, &self.memory)?;
            }
        }
        self.clock.advance(dt);
        if self.watcher.due(self.clock.steps).is_some() {
            self.look()?;
        }
        Ok(())
    }

    /// Make a step without impulses of couplings.
    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        self.trial(dt)?.finish()?;
        Ok(dt)
    }

    fn look(&mut self) -> Result<(), StepError> {
        self.bodies.iter_mut().for_each(|body| body.note_energy());
        let (totals, exchange, clock) = (self.totals(), Solver::exchange(self), self.clock);
        let speed = self.bodies.iter().map(|b| b.probe.speed).fold(0.0, f64::max);
        let loss = Loss {
            by: "plastic impacts of nodes, or a step too long for what changes in it",
            remedy: "take a smaller Courant factor, or a finer mesh",
        };
        let at = Look::new(&clock, &exchange, speed, loss);
        let broken = self.bodies.iter().find(|b| !b.totals().is_finite()).map(|b| b.name.clone());
        let mut watcher = std::mem::take(&mut self.watcher);
        let gain = self.gain();
        let looked = watcher.look(&totals, self.hoop, &at, || broken.unwrap_or_default(), gain);
        watcher.look_at_fields(&clock, &Solver::bodies(self), (D, self.hoop), None);
        let scale = watcher.account(&totals, &exchange, self.hoop).energy_scale;
        for body in &self.bodies {
            let (largest, joules) = (body.largest_energy, body.hourglass_energy());
            if joules > HOURGLASS * largest && largest > HARDLY * scale {
                let (name, position) = (body.name.clone(), body.worst_hourglass().1);
                let share = joules / largest;
                let finding = Finding::Hourglass { body: name.clone(), share, joules, position };
                watcher.warn_once(
                    &clock,
                    finding,
                    |f| matches!(f, Finding::Hourglass { body, .. } if *body == name),
                );
            }
        }
        self.watcher = watcher;
        looked
    }

    /// Finding for an energy gain, at the fastest node, where it is most likely.
    fn gain(&self) -> impl FnOnce(f64, f64) -> Finding + use<D> {
        let (mut fastest, mut position, mut body) = (-1.0, [0.0; 3], String::new());
        for one in &self.bodies {
            for node in &one.nodes {
                let square: f64 = node.velocity.iter().map(|v| v * v).sum();
                if square > fastest {
                    (fastest, position) = (square, crate::set::wide(&node.position));
                    body.clone_from(&one.name);
                }
            }
        }
        let cause = GainCause::Other(
            "the nodes there are the fastest; take a smaller Courant factor, or a finer mesh",
        );
        move |share, joules| Finding::EnergyGain { share, joules, body, position, cause }
    }
}

/// Open step with trial velocities by internal forces and body forces alone. Couplings add impulses here. Without [`Trial::finish`] the
/// step is lost, and with it the scene.
#[must_use = "a step that is begun must be finished"]
pub struct Trial<'a, const D: usize> {
    fem: &'a mut Fem<D>,
}

impl<const D: usize> Trial<'_, D> {
    /// Size of the step, s.
    pub fn dt(&self) -> f64 {
        self.fem.open.unwrap_or_default()
    }
    /// Bodies of the scene: nodes with trial velocities, surface facets.
    pub fn bodies(&self) -> &[ElementBody<D>] {
        &self.fem.bodies
    }
    /// Body by number, to add impulses ([`ElementBody::add_impulse`]).
    ///
    /// # Panics
    /// There is no such body.
    pub fn body_mut(&mut self, number: usize) -> &mut ElementBody<D> {
        &mut self.fem.bodies[number]
    }
    /// End the step: contact, boundary conditions, positions, stresses, internal forces and energy balance.
    ///
    /// # Errors
    /// Failure, with body, element or node, position and cause.
    pub fn finish(self) -> Result<(), StepError> {
        self.fem.finish()
    }
}

impl<const D: usize> Solver for Fem<D> {
    fn method(&self) -> String {
        described(&format!("explicit finite elements: {}", self.space), &Solver::bodies(self))
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn axisymmetric(&self) -> bool {
        self.hoop
    }
    fn clock(&self) -> &Clock {
        &self.clock
    }
    fn clock_mut(&mut self) -> &mut Clock {
        &mut self.clock
    }
    fn stable_step(&mut self) -> Result<f64, StepError> {
        Ok(self.next_time_step())
    }
    fn limited_by(&self) -> Option<StepLimit> {
        let (body, rate) = largest(self.bodies.iter().map(|b| b.rate));
        Some(self.control.limit(rate, self.clock.last, body))
    }
    // Never inlined, so that profilers (callgrind) separate the cost of steps from that of observers.
    #[inline(never)]
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        self.watcher.may_go_on()?;
        let made = self.make_step(left);
        self.watcher.note(made)
    }
    fn set_team(&mut self, team: Team) {
        Fem::set_team(self, team);
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        self.bodies.iter().map(|b| b as &dyn Body).collect()
    }
    fn exchange(&self) -> Exchange {
        let contact = self.contact.as_ref().map(|contact| contact.exchange(&self.bodies));
        self.bodies.iter().fold(contact.unwrap_or_default(), |sum, body| sum.plus(&body.given()))
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("number of bodies", &self.bodies.len().to_string())?;
        file.same("most steps of the scene in one of a body", &self.subcycles.to_string())?;
        self.clock.archive(file)?;
        let times = [0.0, self.clock.time];
        let force = self.body_force.as_ref().map(|force| over(times, |t| force(t)));
        file.same("body force", &force.unwrap_or_default())?;
        file.same("local damping", &format!("{:?}", self.damping.coefficient()))?;
        self.boundaries.archive(file, times, &str::to_string)?;
        for body in &mut self.bodies {
            body.archive(file)?;
        }
        file.same("contact of bodies", if self.contact.is_some() { "some" } else { "none" })?;
        if let Some(contact) = &mut self.contact {
            contact.archive(file)?;
        }
        self.watcher.archive(file)
    }
    fn stopped_by(&self) -> Option<&StepError> {
        self.watcher.stopped_by()
    }
    fn look_at_the_end(&mut self) -> Result<(), StepError> {
        if !self.watcher.due_at_the_end(self.clock.steps) {
            return Ok(());
        }
        let looked = self.look();
        self.watcher.note(looked)
    }
    fn warnings(&self) -> &[Warning] {
        self.watcher.warnings()
    }
    fn account_of(&self, totals: &Totals) -> Account {
        self.watcher.account(totals, &Solver::exchange(self), self.hoop)
    }
    fn contacts(&self) -> Vec<PairContact> {
        self.contact.as_ref().map_or(Vec::new(), |contact| contact.pairs())
    }
    fn contact_points(&self) -> Vec<ContactPoint> {
        self.contact.as_ref().map_or(Vec::new(), |contact| contact.places().to_vec())
    }
    fn moving_points(&self) -> usize {
        self.bodies.iter().map(|b| b.elements - b.eroded.elements as usize).sum()
    }
    fn bytes(&self) -> usize {
        self.bodies.iter().map(Body::bytes).sum::<usize>() + self.contact.as_ref().map_or(0, |c| c.bytes())
    }
}
