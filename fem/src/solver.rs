//! The solver: bodies of elements in a scene, and their steps.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use impactite_scene::boundary::{BodyForce, VelocityHistory, check_at};
use impactite_scene::constants::over;
use impactite_scene::control::{ControlError, largest};
use impactite_scene::embedding::described;
use impactite_scene::error::parameter;
use impactite_scene::watch::{Look, Loss, Watcher};
use impactite_scene::{
    Account, Archive, Body, Boundary, CheckpointError, Clock, ContactPoint, Embedding, Exchange, Finding,
    GainCause, LocalDamping, PairContact, SceneError, Solver, StepError, StepLimit, Stopped, TimeControl,
    Warning, Watch,
};
use impactite_simd::Team;
use mpm_contact::Pairs;
use mpm_contact::mesh::MeshStep;

use crate::body::{ElementBody, MeshBody, Prescribed};
use crate::contact::{ContactSurface, Contacts, look};
use crate::load::{SurfaceFacet, SurfaceLoad, TractionHistory, view};
use crate::motion::Part;
use crate::surface::surface_of;
use crate::sweep::Scratch;

/// The default safety factor of the time step: of two over the bound of the highest frequency.
const COURANT: f64 = 0.9;
/// Elements of a body below which one thread is faster than waking more, and is used.
const SMALL: usize = 500;
/// Hourglass energy over the largest energy of the body that is warned of.
const HOURGLASS: f64 = 0.05;
/// Internal energy over all energy below which that is not looked at.
const HARDLY: f64 = 1e-6;

/// Explicit finite elements in `D` dimensions.
///
/// Bodies pass through each other unless told to touch ([`Fem::touch`]). What is no body of elements meets them by impulses that a
/// coupling gives in a [`Trial`].
pub struct Fem<const D: usize> {
    hoop: bool,
    space: &'static str,
    pub(crate) bodies: Vec<ElementBody<D>>,
    boundaries: Vec<Boundary<D>>,
    body_force: Option<BodyForce<D>>,
    damping: LocalDamping,
    pub(crate) team: Team,
    /// Boxed, for most scenes have none.
    contact: Option<Box<Contacts<D>>>,
    control: TimeControl,
    /// Most steps of the scene in one of a body.
    subcycles: u32,
    clock: Clock,
    /// The step that was begun, s.
    open: Option<f64>,
    watcher: Watcher,
    /// Memory of each thread.
    pub(crate) memory: Arc<Vec<Mutex<Scratch>>>,
}

impl<const D: usize> Fem<D> {
    /// A scene without bodies: `FullSpace`, `PlaneStrain`, `Axisymmetric` or, of bars alone, `Line`. On the caller's thread, with 0.9 of
    /// the stable step.
    pub fn new<E: Embedding<D>>(_: E) -> Self {
        Fem {
            hoop: E::HOOP,
            space: E::NAME,
            bodies: Vec::new(),
            boundaries: Vec::new(),
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
    /// A mesh, law or technology that cannot be; a name that another body has.
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

    /// Add a condition on all nodes: [`Boundary::hold`] says what it does to them. Conditions act in the order they were added.
    ///
    /// # Errors
    /// Numbers that a condition refuses; periodic planes.
    pub fn bound(&mut self, boundary: Boundary<D>) -> Result<(), SceneError> {
        boundary
            .check_moving("with finite elements; take planes of symmetry, or the material point method")?;
        self.boundaries.push(boundary);
        if let Some(contact) = &mut self.contact {
            contact.forget();
        }
        Ok(())
    }

    /// Let all bodies touch each other, those that are added later too, by a law or the laws of [`Pairs`]: nodes of each meet facets of the
    /// others ([`mpm_contact::mesh`]; the [crate](crate#contact) says how). Bodies touch themselves only where asked
    /// ([`Fem::touch_itself`]). Bars meet facets with their nodes, half their thickness away, and no other bars. Facets on planes of symmetry
    /// meet nobody.
    ///
    /// # Errors
    /// Laws that remember; a scene on a line; contact that there is.
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

    /// Let a body touch itself too, by the law of its pair with itself ([`Pairs::with`]).
    ///
    /// # Errors
    /// No contact ([`Fem::touch`]); a body that is not there, or without facets.
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

    /// What contact did in the last step, as it was found: positions are those at its start. None without contact.
    pub fn last_contact(&self) -> Option<&MeshStep> {
        self.contact.as_ref().map(|contact| contact.last())
    }

    /// Prescribe the velocity of a named set of nodes of a body, m/s over time, taken at the middle of each step; it acts after the
    /// boundaries.
    ///
    /// # Errors
    /// A body or set that is not there.
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

    /// Load facets of the surface of a body, as it is at the start, by a traction over time; several loads add up. Returns how many facets
    /// it is on. `facets` says which they are, for checkpoints to compare.
    ///
    /// # Errors
    /// No facet is picked.
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
        let hoop = self.hoop;
        let body = &mut self.bodies[body];
        let (mut shares, mut count) = (BTreeMap::new(), 0);
        for facet in surface_of(&body.mesh, &|_| true) {
            let (view, areas) = view(&body.mesh.nodes, &facet, hoop);
            if picked(&view) {
                count += 1;
                facet
                    .nodes()
                    .iter()
                    .zip(areas)
                    .for_each(|(node, area)| *shares.entry(*node).or_insert(0.0) += area);
            }
        }
        if count == 0 {
            return Err(SceneError::NotWith {
                what: format!("a traction on {facets}"),
                method: format!("the mesh of body `{}`", body.name),
                why: "no facet of its surface is there",
            });
        }
        body.loads.push(SurfaceLoad {
            facets: facets.into(),
            areas: shares.into_iter().collect(),
            history,
            acting: [0.0; D],
        });
        Ok(count)
    }

    /// An acceleration of all nodes, m/s^2, over time.
    pub fn set_body_force(&mut self, acceleration: BodyForce<D>) {
        self.body_force = Some(acceleration);
    }

    /// Damp towards rest ([`LocalDamping`]): part of the unbalanced force of every node, contact and conditions included, is taken away while it
    /// speeds the node up, and added while it slows it down. States at rest stay as they are. What it takes is booked as damping.
    ///
    /// # Errors
    /// A coefficient outside \[0, 1).
    pub fn set_local_damping(&mut self, coefficient: f64) -> Result<(), SceneError> {
        self.damping = LocalDamping::new(coefficient)?;
        Ok(())
    }

    /// Choose the time step otherwise. The Courant rate is half the bound of the highest frequency of any element, bulk viscosity
    /// and hourglass springs included: a factor of 1 is the limit of stability.
    ///
    /// # Errors
    /// A control that no run can use.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Let bodies whose stable step is longer make one step for 2, 4 .. at most `most` steps of the scene: their elements are strained
    /// once in those. Mass and momentum are kept to rounding. 1, the default, switches that off. Bodies meet in every step of the scene:
    /// where one that makes a longer step is touched, its nodes get impulses within that.
    ///
    /// # Errors
    /// Zero.
    pub fn set_subcycling(&mut self, most: u32) -> Result<(), SceneError> {
        parameter(most > 0, "subcycling", "most steps", f64::from(most), "at least 1")?;
        self.subcycles = most;
        Ok(())
    }

    /// Choose what the run watches over: [`Watch`]. A run that the watch stopped may go on after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Run on these threads. Results are the same bits for any number. Bodies of a few hundred elements run on one.
    pub fn set_team(&mut self, team: Team) {
        self.memory = Arc::new((0..team.threads()).map(|_| Mutex::default()).collect());
        self.team = team;
    }

    /// The bodies.
    pub fn element_bodies(&self) -> &[ElementBody<D>] {
        &self.bodies
    }
    /// A body.
    ///
    /// # Panics
    /// There is no such body.
    pub fn body(&self, number: usize) -> &ElementBody<D> {
        &self.bodies[number]
    }
    /// The size of the next step by the time control, s.
    pub fn next_time_step(&self) -> f64 {
        let rate = self.bodies.iter().map(|b| b.rate).fold(0.0, f64::max);
        self.control.next(rate, self.clock.last)
    }

    /// Begin a step of `dt` seconds: velocities as if bodies met nothing. A coupling gives impulses to the nodes and then ends the step
    /// ([`Trial::finish`]).
    ///
    /// # Errors
    /// No bodies; a step that is not positive; loads and velocities that are no numbers; a run that was stopped.
    pub fn trial(&mut self, dt: f64) -> Result<Trial<'_, D>, StepError> {
        self.begin(dt)?;
        Ok(Trial { fem: self })
    }

    /// As [`Fem::trial`], for a coupling that ends the step with [`Fem::finish`] in another call.
    ///
    /// # Errors
    /// As [`Fem::trial`]; a step that was begun and not ended.
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

    /// End the step that was begun: contact of the bodies with the velocities that others left, conditions, positions, stresses, forces and books.
    ///
    /// # Errors
    /// Names body, element or node, position and cause of what stopped it; no step that was begun.
    pub fn finish(&mut self) -> Result<(), StepError> {
        let Some(dt) = self.open.take() else {
            return Err(self.clock.refused("step begun", 0.0, "there (`Fem::begin`)"));
        };
        let ended = self.end_step(dt);
        self.watcher.note(ended)
    }
    /// A body, to be given impulses in a step that was begun ([`ElementBody::add_impulse`]).
    ///
    /// # Panics
    /// There is no such body.
    pub fn body_mut(&mut self, number: usize) -> &mut ElementBody<D> {
        &mut self.bodies[number]
    }
    /// The surfaces of all bodies in a step that was begun, for a coupling that has others meet them: where they are, and how they will move
    /// if nobody does. The list is filled anew but for what stays from step to step: keep it for this scene alone.
    ///
    /// # Errors
    /// A node whose velocity is no number; no step that was begun.
    pub fn surfaces(&self, list: &mut Vec<ContactSurface<D>>) -> Result<(), StepError> {
        let Some(dt) = self.open else {
            return Err(self.clock.refused("step begun", 0.0, "there (`Fem::begin`)"));
        };
        list.resize_with(self.bodies.len(), ContactSurface::default);
        look(list, &self.bodies, &self.boundaries, (&self.clock, dt), &self.team)
    }
    /// Is there a body force?
    pub fn has_body_force(&self) -> bool {
        self.body_force.is_some()
    }
    /// Has a body nodes with prescribed velocities?
    pub fn prescribes(&self) -> bool {
        self.bodies.iter().any(|body| !body.prescribed.is_empty())
    }
    /// The conditions on all nodes.
    pub fn boundaries(&self) -> &[Boundary<D>] {
        &self.boundaries
    }
    /// How the coordinates lie in space: the name of the embedding.
    pub fn embedding(&self) -> &'static str {
        self.space
    }

    /// Steps of the scene in one of each body.
    fn ratios(&self) -> Vec<u32> {
        let fastest = self.bodies.iter().map(|b| b.rate).fold(0.0, f64::max);
        let ratio = |body: &ElementBody<D>| {
            let ratio = (fastest / body.rate).min(f64::from(self.subcycles)).max(1.0);
            if ratio.is_finite() { 1 << ratio.log2() as u32 } else { 1 }
        };
        self.bodies.iter().map(ratio).collect()
    }

    /// Before a step: may it be made? The balance is opened.
    fn begin_step(&mut self, dt: f64) -> Result<(), StepError> {
        if self.bodies.is_empty() {
            return Err(self.clock.stopped(Stopped::Scene(SceneError::NoBodies)));
        }
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(self.clock.refused("step", dt, "positive and finite"));
        }
        self.check_loads(dt).map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        if self.watcher.opens() {
            self.bodies.iter_mut().for_each(|body| body.note_energy());
            let (totals, exchange) = (self.totals(), Solver::exchange(self));
            self.watcher.open(self.clock.steps, &totals, &exchange, self.hoop);
        }
        Ok(())
    }

    fn check_loads(&self, dt: f64) -> Result<(), SceneError> {
        let time = self.clock.time;
        check_at(self.body_force.as_ref(), &self.boundaries, time, &[time + dt])?;
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

    /// Contact, positions, strains, forces and books.
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

    /// A step without others that would give impulses in the [`Trial`].
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
        let at =
            Look { clock: &clock, exchange: &exchange, rounding: f64::EPSILON, speed, energy: true, loss };
        let broken = self.bodies.iter().find(|b| !b.totals().is_finite()).map(|b| b.name.clone());
        let mut watcher = std::mem::take(&mut self.watcher);
        let gain = self.gain();
        let looked = watcher.look(&totals, self.hoop, &at, || broken.unwrap_or_default(), gain);
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

    /// What is said of an energy gain: it is most likely where the fastest node is.
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

/// A step that was begun: velocities are those that elements and body forces alone would give. Impulses of others enter here. Without
/// [`Trial::finish`] the step is lost, and with it the scene.
#[must_use = "a step that is begun must be finished"]
pub struct Trial<'a, const D: usize> {
    fem: &'a mut Fem<D>,
}

impl<const D: usize> Trial<'_, D> {
    /// Size of the step, s.
    pub fn dt(&self) -> f64 {
        self.fem.open.unwrap_or_default()
    }
    /// The bodies: nodes with the velocities tried, surface facets.
    pub fn bodies(&self) -> &[ElementBody<D>] {
        &self.fem.bodies
    }
    /// A body, to be given impulses ([`ElementBody::add_impulse`]).
    ///
    /// # Panics
    /// There is no such body.
    pub fn body_mut(&mut self, number: usize) -> &mut ElementBody<D> {
        &mut self.fem.bodies[number]
    }
    /// Contact of the bodies, conditions, positions, stresses, forces and books of the end of the step.
    ///
    /// # Errors
    /// Names body, element or node, position and cause of what stopped it.
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
    // Never inlined, so that the work of steps can be told from that of what looks at them (callgrind, profilers).
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
        file.same("number of boundaries", &self.boundaries.len().to_string())?;
        for (n, boundary) in self.boundaries.iter().enumerate() {
            file.same(&format!("boundary {n}"), &impactite_scene::Condition::constants(boundary, times))?;
        }
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
    fn account(&self) -> Account {
        self.watcher.account(&self.totals(), &Solver::exchange(self), self.hoop)
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
