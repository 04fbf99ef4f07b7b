//! The solver: what it holds, and how it is set up.

use std::sync::{Arc, Mutex, OnceLock};

use impactite_scene::boundary::BodyForce;
use impactite_scene::boundary::check_at;
use impactite_scene::constants::over;
use impactite_scene::control::ControlError;
use impactite_scene::embedding::described;
use impactite_scene::watch::{Look, Loss, Watcher, gain_at_the_fastest, not_finite};
use impactite_scene::{
    Account, Archive, Body, Boundary, CentreLead, CheckpointError, Clock, Condition, Embedding, Exchange,
    SceneError, Solver, StepError, StepLimit, Stopped, TimeControl, Warning, Watch,
};
use impactite_simd::Team;
use mpm_contact::particles::Advice;
use mpm_materials::point::{flatten, unflatten};
use mpm_materials::{Constitutive, IntoMaterial, Material, State};

use crate::audit::Audit;
use crate::elements::{Elements, Incidence};
use crate::kinematics::Dilatation;
use crate::method::Composition;
use crate::particles::{BODY, Packing, Particle, number};
use crate::search::Neighbours;
use crate::simplex::{mean_radius, volume};
use crate::sweep::Waiting;
use crate::tessellation::{Tessellation, View, corners};
use impactite_scene::error::parameter;

/// Where the masses of particles come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masses {
    /// Each element gives its mass to its particles, as printed: a third to each of a triangle's (around an axis by the
    /// radius: the integral of the shape function). Exact if the elements cover the body once. Where they cover it
    /// twice its mass is twice too large, and so are stiffness and forces.
    FromElements,
    /// Density times the volumes of the packing. Elements then weigh what their particles weigh: an element's reference
    /// volume is its own times the mean, over its particles, of given volume over volume covered. A body that is
    /// covered twice has elements of half weight.
    FromVolumes,
}

/// Particle-contact meshfree method in `D` dimensions, with the parts of `M`.
///
/// A scene has one law; particles of it that touch make elements, whatever body they came from: what meets is welded.
#[derive(Clone)]
pub struct Pcmm<const D: usize, M> {
    pub(crate) method: M,
    pub(crate) material: Arc<dyn Material<f64>>,
    pub(crate) particles: Vec<Particle<D>>,
    /// How far the surface lies beyond centres, in radii.
    pub(crate) surface: f64,
    pub(crate) elements: Elements,
    /// Forces of the elements on their corners, N.
    pub(crate) forces: Vec<[f64; D]>,
    /// A number an element, if volumes are averaged.
    pub(crate) scalars: Vec<f64>,
    /// A number a particle, if volumes are averaged.
    pub(crate) averages: Vec<f64>,
    /// Reference volume of the elements at each particle, if volumes are averaged.
    pub(crate) weights: Vec<f64>,
    /// The state each particle had last, for newborn elements.
    pub(crate) memory: Vec<f64>,
    pub(crate) virgin: Vec<f64>,
    /// Reference volume and internal energy of matter that is in no element, by particle; empty before the first
    /// element dies.
    pub(crate) stores: Vec<[f64; 2]>,
    pub(crate) neighbours: Neighbours<D>,
    pub(crate) boundaries: Vec<Boundary<D>>,
    pub(crate) body_force: Option<BodyForce<D>>,
    pub(crate) team: Team,
    pub(crate) control: TimeControl,
    pub(crate) every: u64,
    pub(crate) clock: Clock,
    pub(crate) name: String,
    /// Largest wave speed over altitude, or speed over diameter, 1/s.
    pub(crate) rate: f64,
    /// What boundaries and the body force gave to the particles.
    pub(crate) exchange: Exchange,
    watcher: Watcher,
    pub(crate) audit: Audit,
    /// Lead of particles over the path of the centre of mass.
    pub(crate) lead: CentreLead,
    /// Memory of each thread for elements on their way through their law.
    pub(crate) waiting: Arc<Vec<Mutex<Waiting>>>,
}

/// What is said where energy is lost or gained.
pub(crate) const ADVICE: Advice = Advice {
    loss: Loss {
        by: "contacts that closed, the printed volumes of elements, or elements that were made anew",
        remedy: "take `Method::consistent`, or smaller particles",
    },
    gain: "the particles there are the fastest; take `Method::consistent`, a smaller Courant factor, or revise more often",
};
/// The default safety factor of the time step.
const COURANT: f64 = 0.5;
/// Particles of a scene for which more than one thread is used.
pub const SMALL: usize = 2000;
/// The skin of the neighbour lists over the smallest radius.
const SKIN: f64 = 0.6;

/// The implementation of [`PackingFor`] that counts.
#[derive(Clone, Copy, Debug)]
pub struct Holding;
/// The one that never holds.
#[derive(Clone, Copy, Debug)]
pub struct Failing;
/// What no type is.
pub trait Never {}

/// A packing for the method `M`: `R` is a body of both.
///
/// It is asked first, so that a body has the dimensions of its packing: where the method has others, that is what the compiler says, and
/// not that the packing should have those of the method. Of two implementations the compiler takes the one whose bounds hold; where
/// neither does, there is no `R`, and nothing is said of what is done with it.
#[diagnostic::on_unimplemented(
    message = "the method `{M}` has other dimensions than `{Self}`",
    label = "of other dimensions",
    note = "the embedding must have the dimensions of the packing: in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`",
    note = "the tessellation `AzimuthFan` is one of two dimensions: in three take `LocalDelaunay`"
)]
pub trait PackingFor<M, const D: usize, W, R> {
    /// What [`Pcmm::new`] makes.
    #[doc(hidden)]
    fn body(&self, method: M, law: Law, velocity: Velocity<'_, D>, masses: Masses) -> Result<R, SceneError>;
}
type Law = Arc<dyn Material<f64>>;
type Velocity<'a, const D: usize> = &'a dyn Fn([f64; D]) -> [f64; D];

impl<M: Composition<D>, const D: usize> PackingFor<M, D, Holding, Pcmm<D, M>> for Packing<D> {
    fn body(
        &self,
        method: M,
        law: Law,
        velocity: Velocity<'_, D>,
        masses: Masses,
    ) -> Result<Pcmm<D, M>, SceneError> {
        Pcmm::of(method, law, self, velocity, masses)
    }
}
impl<M: Composition<D> + Never, const D: usize> PackingFor<M, D, Failing, Pcmm<D, M>> for Packing<D> {
    fn body(
        &self,
        method: M,
        law: Law,
        velocity: Velocity<'_, D>,
        masses: Masses,
    ) -> Result<Pcmm<D, M>, SceneError> {
        Pcmm::of(method, law, self, velocity, masses)
    }
}

impl<const D: usize, M> Pcmm<D, M> {
    /// Particles of a law in a [`Packing`], with their velocity (m/s) at a position (m); elements are made at once. Tessellates anew
    /// after every step, takes half of altitude over wave speed for a step, on the caller's thread. `R` is `Pcmm<D, M>`, of a method that
    /// is a [`Composition`] of `D` dimensions.
    ///
    /// # Errors
    /// No particle; a position, radius, volume or velocity that no particle can have; a particle without mass.
    // `R` is `Self`, by way of the bound.
    #[allow(clippy::new_ret_no_self)]
    pub fn new<R, W>(
        method: M,
        law: impl IntoMaterial<f64>,
        packing: &impl PackingFor<M, D, W, R>,
        velocity: impl Fn([f64; D]) -> [f64; D],
        masses: Masses,
    ) -> Result<R, SceneError> {
        packing.body(method, law.into_material(), &velocity, masses)
    }
}

impl<const D: usize, M: Composition<D>> Pcmm<D, M> {
    fn of(
        method: M,
        law: Law,
        packing: &Packing<D>,
        velocity: Velocity<'_, D>,
        masses: Masses,
    ) -> Result<Self, SceneError> {
        packing.check()?;
        let density = law.density();
        if !(density > 0.0 && density.is_finite()) {
            return Err(SceneError::Density { law: law.name(), density });
        }
        let mut particles = Vec::with_capacity(packing.positions.len());
        for (n, (&position, &radius)) in packing.positions.iter().zip(&packing.radii).enumerate() {
            let velocity = velocity(position);
            for v in velocity {
                number(v.is_finite(), "velocity", n, v, "finite")?;
            }
            if M::Embedding::HOOP {
                number(position[0] >= 0.0, "distance from the axis", n, position[0], "zero or positive")?;
            }
            particles.push(Particle { position, velocity, mass: 0.0, radius });
        }
        let smallest = particles.iter().fold(f64::INFINITY, |m, p| m.min(p.radius));
        let virgin = law.virgin();
        let mut solver = Pcmm {
            neighbours: Neighbours::new(method.tessellation().reach(), SKIN * smallest),
            memory: virgin.repeat(particles.len()),
            method,
            material: law,
            particles,
            surface: packing.surface,
            elements: Elements::default(),
            forces: Vec::new(),
            scalars: Vec::new(),
            averages: Vec::new(),
            weights: Vec::new(),
            virgin,
            stores: Vec::new(),
            boundaries: Vec::new(),
            body_force: None,
            team: Team::one(),
            control: TimeControl::Courant { factor: COURANT, growth: 1.1 },
            every: 1,
            clock: Clock::default(),
            name: BODY.into(),
            rate: 0.0,
            exchange: Exchange::default(),
            watcher: Watcher::default(),
            audit: Audit::default(),
            lead: CentreLead::default(),
            waiting: Arc::new(vec![Mutex::default()]),
        };
        solver.first_elements()?;
        solver.weigh(masses, &packing.volumes)?;
        for p in &solver.particles {
            let square: f64 = p.velocity.iter().map(|v| v * v).sum();
            solver.rate = solver.rate.max(square.sqrt() / (2.0 * p.radius));
        }
        solver.forces_of_states();
        Ok(solver)
    }

    /// Virgin elements, at reference density.
    fn first_elements(&mut self) -> Result<(), SceneError> {
        let none = Incidence::of_elements(&[], self.particles.len());
        self.neighbours.update(&self.particles, &self.team);
        if let Some(refused) = self.neighbours.refused() {
            return Err(SceneError::Search(refused.clone()));
        }
        let view = View {
            particles: &self.particles,
            neighbours: &self.neighbours,
            nodes: &[],
            incidence: &none,
            team: &self.team,
            open: &OnceLock::new(),
        };
        let nodes = self.method.tessellation().revise(&view).born;
        let hoop = M::Embedding::HOOP;
        let reference: Vec<f64> =
            nodes.chunks_exact(D + 1).map(|n| volume(&corners(&self.particles, n), hoop)).collect();
        let states = self.virgin.repeat(reference.len());
        self.elements = Elements::assemble(nodes, reference, &states, &self.virgin, self.particles.len());
        self.make_room();
        Ok(())
    }

    /// Masses of particles, and reference volumes of elements that go with them.
    fn weigh(&mut self, masses: Masses, volumes: &[f64]) -> Result<(), SceneError> {
        let density = self.material.density();
        let mut covered = vec![0.0; self.particles.len()];
        for (e, nodes) in self.elements.nodes.chunks_exact(D + 1).enumerate() {
            let x = corners(&self.particles, nodes);
            let mean = mean_radius(&x);
            for (a, &n) in nodes.iter().enumerate() {
                let part = if M::Embedding::HOOP {
                    // The integral of N_a r over a triangle is (r_a + 3 r_mean) / 12 times its area.
                    (x[a][0] + 3.0 * mean) / (12.0 * mean)
                } else {
                    1.0 / (D + 1) as f64
                };
                covered[n as usize] += part * self.elements.reference[e];
            }
        }
        if masses == Masses::FromVolumes {
            parameter(
                volumes.len() == self.particles.len(),
                "masses from volumes",
                "number of volumes",
                volumes.len() as f64,
                "one a particle",
            )?;
            for (e, nodes) in self.elements.nodes.chunks_exact(D + 1).enumerate() {
                let mean = |n: &u32| volumes[*n as usize] / covered[*n as usize];
                self.elements.reference[e] *= nodes.iter().map(mean).sum::<f64>() / (D + 1) as f64;
            }
            covered.copy_from_slice(volumes);
            self.make_room();
        }
        for (n, p) in self.particles.iter_mut().enumerate() {
            p.mass = density * covered[n];
            if !(p.mass > 0.0 && p.mass.is_finite()) {
                let why = "it belongs to no element; widen the tolerance of contact or give volumes";
                let (body, position) = (BODY.into(), p.position.to_vec());
                return Err(SceneError::NoMass { body, particle: n, position, why });
            }
        }
        Ok(())
    }

    /// Lists that are as long as there are elements.
    pub(crate) fn make_room(&mut self) {
        self.forces.resize(self.elements.len() * (D + 1), [0.0; D]);
        if M::Dilatation::AVERAGED {
            self.scalars.resize(self.elements.len(), 0.0);
            self.averages.resize(self.particles.len(), 0.0);
            let Elements { incidence, reference, .. } = &self.elements;
            let weight = |n| incidence.of(n).iter().map(|&at| reference[at as usize / (D + 1)]).sum::<f64>();
            self.weights = (0..self.particles.len()).map(weight).collect();
        }
    }

    /// Call the body so, in messages and files.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Choose what the run watches over: [`Watch`]. A run that the watch stopped may go on after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Run on these threads. Results are the same bits for any number. Below [`SMALL`] particles one thread is faster
    /// than waking more, and is used.
    pub fn set_team(&mut self, team: Team) {
        self.team = if self.particles.len() < SMALL { Team::one() } else { team };
        self.waiting = Arc::new((0..self.team.threads()).map(|_| Mutex::default()).collect());
    }

    /// Choose the time step otherwise. The Courant rate is c over the smallest altitude of an element, or speed over
    /// diameter of a particle if that is larger.
    ///
    /// # Errors
    /// A control that no run can use.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Tessellate anew every so many steps.
    ///
    /// # Errors
    /// Zero.
    pub fn set_revision_interval(&mut self, steps: u64) -> Result<(), SceneError> {
        parameter(steps > 0, "revision", "interval in steps", steps as f64, "at least 1")?;
        self.every = steps;
        Ok(())
    }

    /// Add a condition: a wall keeps the centres of particles in front of it and only pushes; a plane of symmetry takes
    /// the velocity across it from particles on it; fixed and prescribed velocities hold for the particles that are
    /// then behind the plane, or in the region; a rough wall rubs on what it pushes; an absorbing plane or a condition of one's own acts
    /// on the particles whose surface is there up to half a radius, of which it takes `depth` for the thickness. Conditions act in the order they were added.
    ///
    /// # Errors
    /// An axis that is not there, a position or velocity that is not finite, numbers that a condition refuses; periodic planes, which
    /// particles do not know.
    pub fn bound(&mut self, boundary: Boundary<D>) -> Result<(), SceneError> {
        boundary.check_moving(
            "in the particle-contact method; take planes of symmetry, or the material point method",
        )?;
        self.boundaries.push(boundary);
        Ok(())
    }

    /// An acceleration of all particles, m/s^2, over time.
    pub fn set_body_force(&mut self, acceleration: BodyForce<D>) {
        self.body_force = Some(acceleration);
    }

    /// Give every element's state, with its centre (m), to `change`, for initial stresses: that of the law `C`, which must be the
    /// body's.
    ///
    /// # Errors
    /// Another law; a number that is not finite.
    pub fn set_states<C: Constitutive<f64>>(
        &mut self,
        mut change: impl FnMut([f64; D], C::State<f64>) -> C::State<f64>,
    ) -> Result<(), SceneError> {
        let mut names = Vec::new();
        C::State::<f64>::names("state", &mut names);
        if names != self.material.state_names() {
            return Err(SceneError::OtherState { law: self.material.name(), there: names.join(", ") });
        }
        let mut states = vec![0.0; self.elements.len() * self.virgin.len()];
        for e in 0..self.elements.len() {
            let out = &mut states[e * self.virgin.len()..(e + 1) * self.virgin.len()];
            self.elements.read(e, out);
            let x = corners(&self.particles, &self.elements.nodes[e * (D + 1)..(e + 1) * (D + 1)]);
            let mut centre = [0.0; D];
            for d in 0..D {
                centre[d] = x[..=D].iter().map(|c| c[d]).sum::<f64>() / (D + 1) as f64;
            }
            if let Ok(state) = unflatten::<f64, C::State<f64>>(out) {
                out.copy_from_slice(&flatten(&change(centre, state)));
            }
            number(out.iter().all(|x| x.is_finite()), "state of element", e, f64::NAN, "finite")?;
        }
        let elements = std::mem::take(&mut self.elements);
        self.elements = Elements::assemble(
            elements.nodes,
            elements.reference,
            &states,
            &self.virgin,
            self.particles.len(),
        );
        self.forces_of_states();
        Ok(())
    }

    /// The particles.
    pub fn particles(&self) -> &[Particle<D>] {
        &self.particles
    }
    /// The elements: `D + 1` particles each, positively oriented.
    pub fn element_nodes(&self) -> &[u32] {
        &self.elements.nodes
    }
    /// How many elements there are.
    pub fn elements(&self) -> usize {
        self.elements.len()
    }
    /// The law.
    pub fn material(&self) -> &dyn Material<f64> {
        &*self.material
    }
    /// A line that names the method.
    pub fn describe(&self) -> String {
        self.method.describe()
    }
    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }
    /// What revisions did since the start.
    pub fn audit(&self) -> &Audit {
        &self.audit
    }
    /// Searches for neighbours made.
    pub fn searches(&self) -> u64 {
        self.neighbours.searches()
    }

    /// What the body is made of and what changes in a run, to a file or from one: as [`Solver::archive`], but for the watch.
    pub(crate) fn archive_body(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let name = self.name.clone();
        let of = |what: &str| format!("{what} of body `{name}`");
        file.same(&of("method"), &self.method.describe())?;
        file.same(&of("tessellation"), &format!("{:?}", self.method.tessellation()))?;
        file.same(&of("law"), self.material.name())?;
        file.same(&of("constants of the law"), &self.material.constants())?;
        file.same(&of("number of particles"), &self.particles.len().to_string())?;
        file.same(&of("steps between revisions"), &self.every.to_string())?;
        self.clock.archive(file)?;
        let times = [0.0, self.clock.time];
        let force = self.body_force.as_ref().map(|force| over(times, |t| force(t)));
        file.same(&of("body force"), &force.unwrap_or_default())?;
        file.same(&of("number of boundaries"), &self.boundaries.len().to_string())?;
        for (n, boundary) in self.boundaries.iter().enumerate() {
            file.same(&format!("boundary {n} of body `{name}`"), &boundary.constants(times))?;
        }
        for Particle { position, velocity, mass, radius } in &mut self.particles {
            file.reals(position.iter_mut().chain(velocity).chain([mass, radius]))?;
        }
        self.archive_elements(file)?;
        file.reals(&mut self.memory)?;
        file.list(&mut self.stores, &[0.0; 2], |file, store| file.reals(store))?;
        file.reals([&mut self.rate, &mut self.surface])?;
        self.exchange.archive(file)?;
        self.lead.archive(file)?;
        self.audit.archive(file)
    }

    fn archive_elements(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let particles = self.particles.len();
        let mut nodes = self.elements.nodes.clone();
        let mut reference = self.elements.reference.clone();
        file.list(&mut nodes, &0, |file, n| file.index(n, particles))?;
        file.list(&mut reference, &0.0, Archive::real)?;
        if nodes.len() != reference.len() * (D + 1) {
            return Err(file.damaged("elements without corners"));
        }
        let numbers = self.virgin.len();
        let mut states = vec![0.0; reference.len() * numbers];
        if file.reads() {
            file.reals(&mut states)?;
            self.elements = Elements::assemble(nodes, reference, &states, &self.virgin, particles);
            self.make_room();
            self.neighbours.forget();
        } else {
            for (e, state) in states.chunks_exact_mut(numbers).enumerate() {
                self.elements.read(e, state);
            }
            file.reals(&mut states)?;
        }
        file.reals(self.forces.iter_mut().flatten())
    }

    /// The speed that a particle or a wave crosses half a particle with in a Courant step, m/s.
    pub(crate) fn speed(&self) -> f64 {
        let smallest = self.particles.iter().fold(f64::INFINITY, |m, p| m.min(p.radius));
        self.rate * 2.0 * smallest
    }

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), Solver::exchange(self), self.clock);
        let (speed, loss, rounding) = (self.speed(), ADVICE.loss, f64::EPSILON);
        let at = Look { clock: &clock, exchange: &exchange, rounding, speed, energy: true, loss };
        let mut watcher = std::mem::take(&mut self.watcher);
        let bodies: [&dyn Body; 1] = [self];
        let gain = gain_at_the_fastest(&bodies, |_| ADVICE.gain);
        let looked = watcher.look(&totals, M::Embedding::HOOP, &at, || not_finite(&bodies), gain);
        self.watcher = watcher;
        looked
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        let (time, force) = (self.clock.time, self.body_force.as_ref());
        let checked = check_at(force, &self.boundaries, time, &[time + dt]);
        checked.map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
        if self.watcher.opens() {
            let (totals, exchange) = (self.totals(), Solver::exchange(self));
            self.watcher.open(self.clock.steps, &totals, &exchange, M::Embedding::HOOP);
        }
        self.step(dt)?;
        if self.watcher.due(self.clock.steps).is_some() {
            self.look()?;
        }
        Ok(dt)
    }
}

/// A body alone.
impl<const D: usize, M: Composition<D>> Solver for Pcmm<D, M> {
    fn method(&self) -> String {
        described(&format!("particle-contact method: {}", self.method.describe()), &[self])
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn axisymmetric(&self) -> bool {
        M::Embedding::HOOP
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
        Some(self.control.limit(self.rate, self.clock.last, 0))
    }
    // Never inlined, so that the work of steps can be told from that of what looks at them (callgrind, profilers).
    #[inline(never)]
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        self.watcher.may_go_on()?;
        let made = self.make_step(left);
        self.watcher.note(made)
    }
    fn set_team(&mut self, team: Team) {
        Pcmm::set_team(self, team);
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        vec![self]
    }
    /// What boundaries and the body force gave to the particles since the start, and what revisions made of nothing.
    fn exchange(&self) -> Exchange {
        Exchange { conversion: self.audit.energy_added(), ..self.exchange }
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.archive_body(file)?;
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
        self.watcher.account(&self.totals(), &Solver::exchange(self), M::Embedding::HOOP)
    }
}
