//! Solver: data and set-up.

use std::sync::{Arc, Mutex, OnceLock};

use impactite_scene::boundaries::check_at;
use impactite_scene::boundary::BodyForce;
use impactite_scene::constants::over;
use impactite_scene::control::ControlError;
use impactite_scene::embedding::described;
use impactite_scene::watch::{Look, Loss, Watcher, gain_at_the_fastest, not_finite};
use impactite_scene::{
    Account, Archive, Body, Boundaries, BoundaryEntry, CentreLead, CheckpointError, Clock, Embedding,
    Exchange, SceneError, Solver, StepError, StepLimit, Stopped, TimeControl, Totals, Warning, Watch,
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

/// Source of the particle masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masses {
    /// Masses of elements, original formulation: each element distributes its mass to its particles, a third to each particle of a triangle
    /// (around an axis by the radius: the integral of the shape function). Exact for single coverage. Under double coverage the mass is
    /// twice too large, and so are stiffness and forces.
    FromElements,
    /// Density times the volumes of the packing. The mass of an element follows from its particles: its reference volume is its own times
    /// the mean, over its particles, of given volume over covered volume. Under double coverage elements have half their mass.
    FromVolumes,
}

/// Particle-contact meshfree method in `D` dimensions, with the ingredients of `M`.
///
/// A body has one law; particles of it in contact form elements, whatever piece they came from: pieces in contact are welded.
#[derive(Clone)]
pub struct Pcmm<const D: usize, M> {
    pub(crate) method: M,
    pub(crate) material: Arc<dyn Material<f64>>,
    pub(crate) particles: Vec<Particle<D>>,
    /// Distance from the outermost centres to the surface, in radii.
    pub(crate) surface: f64,
    pub(crate) elements: Elements,
    /// Forces of the elements on their corners, N.
    pub(crate) forces: Vec<[f64; D]>,
    /// One number per element, if volumes are averaged.
    pub(crate) scalars: Vec<f64>,
    /// One number per particle, if volumes are averaged.
    pub(crate) averages: Vec<f64>,
    /// Reference volume of the elements at each particle, if volumes are averaged.
    pub(crate) weights: Vec<f64>,
    /// Last state of each particle, for new elements.
    pub(crate) memory: Vec<f64>,
    pub(crate) virgin: Vec<f64>,
    /// Reference volume and internal energy of material outside elements, by particle; empty before the first deletion.
    pub(crate) stores: Vec<[f64; 2]>,
    pub(crate) neighbours: Neighbours<D>,
    pub(crate) boundaries: Boundaries<D>,
    pub(crate) body_force: Option<BodyForce<D>>,
    pub(crate) team: Team,
    pub(crate) control: TimeControl,
    pub(crate) every: u64,
    pub(crate) clock: Clock,
    pub(crate) name: String,
    /// Courant rate: largest wave speed over altitude, or speed over diameter, 1/s.
    pub(crate) rate: f64,
    /// Exchange of the particles with boundaries and body force.
    pub(crate) exchange: Exchange,
    watcher: Watcher,
    pub(crate) audit: Audit,
    /// Lead of particles over the path of the centre of mass.
    pub(crate) lead: CentreLead,
    /// Scratch memory of each thread for the constitutive update.
    pub(crate) waiting: Arc<Vec<Mutex<Waiting>>>,
}

/// Advice in messages on energy loss and gain.
pub(crate) const ADVICE: Advice = Advice {
    loss: Loss {
        by: "contacts that closed, the printed volumes of elements, or elements that were made anew",
        remedy: "take `Method::consistent`, or smaller particles",
    },
    gain: "the particles there are the fastest; take `Method::consistent`, a smaller Courant factor, or revise more often",
};
/// Default safety factor of the time step.
const COURANT: f64 = 0.5;
/// Smallest number of particles of a body for more than one thread.
pub const SMALL: usize = 2000;
/// Skin of the neighbour lists over the smallest radius.
const SKIN: f64 = 0.6;

/// Marker of the implementation of [`PackingFor`] with satisfied bounds.
#[derive(Clone, Copy, Debug)]
pub struct Holding;
/// Marker of the implementation with unsatisfied bounds.
#[derive(Clone, Copy, Debug)]
pub struct Failing;
/// No type implements this.
pub trait Never {}

/// Packing for the method `M`: `R` is a body of both.
///
/// The packing is resolved first, so that the body has its dimensions: the compiler then reports a method of other dimensions, and not that
/// the packing should have those of the method. Of two implementations the compiler selects the one whose bounds hold; if neither does,
/// there is no `R`, and no further error about its uses.
#[diagnostic::on_unimplemented(
    message = "the method `{M}` has other dimensions than `{Self}`",
    label = "of other dimensions",
    note = "the embedding must have the dimensions of the packing: in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`",
    note = "the tessellation `AzimuthFan` is one of two dimensions: in three take `LocalDelaunay`"
)]
pub trait PackingFor<M, const D: usize, W, R> {
    /// Create the body of [`Pcmm::new`].
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
    /// Create particles of a law in a [`Packing`], with their velocity (m/s) at a position (m), and their elements. The body tessellates
    /// again after every step, has a time step of half of altitude over wave speed, and runs on the caller's thread. `R` is `Pcmm<D, M>`,
    /// of a method that is a [`Composition`] of `D` dimensions.
    ///
    /// # Errors
    /// No particle; an invalid position, radius, volume or velocity; a particle without mass.
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
            boundaries: Boundaries::default(),
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

    /// Create virgin elements, at reference density.
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

    /// Set the masses of particles, and the corresponding reference volumes of elements.
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

    /// Resize the lists to the number of elements.
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

    /// Set the name of the body in messages and files.
    #[must_use]
    pub fn named(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Set the run checks: [`Watch`]. A run that a check stopped may be continued after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Set the thread pool. Results are bitwise identical for any number of threads. Below [`SMALL`] particles one thread is used: it is
    /// faster than waking more.
    pub fn set_team(&mut self, team: Team) {
        self.team = if self.particles.len() < SMALL { Team::one() } else { team };
        self.waiting = Arc::new((0..self.team.threads()).map(|_| Mutex::default()).collect());
    }

    /// Set the time step control. The Courant rate is c over the smallest altitude of an element, or speed over diameter of a particle if
    /// that is larger.
    ///
    /// # Errors
    /// An invalid time step control.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Set the number of steps between revisions of the elements.
    ///
    /// # Errors
    /// An interval of zero.
    pub fn set_revision_interval(&mut self, steps: u64) -> Result<(), SceneError> {
        parameter(steps > 0, "revision", "interval in steps", steps as f64, "at least 1")?;
        self.every = steps;
        Ok(())
    }

    /// Add a boundary condition. A wall keeps the centres of particles in front of it, in compression only; a plane of symmetry removes the
    /// normal velocity of particles on it; fixed and prescribed velocities apply to particles behind the plane, or in the region, at that
    /// time; a rough wall applies friction to particles in contact; an absorbing plane or a user-defined condition acts on particles whose
    /// surface is within half a radius, with their `depth` as the thickness. Their order is that of [`Boundaries::add`].
    ///
    /// # Errors
    /// An invalid axis, a position or velocity that is not finite, invalid numbers of a condition; periodic planes, which particles do not
    /// support.
    pub fn bound(&mut self, boundary: impl Into<BoundaryEntry<D>>) -> Result<(), SceneError> {
        let entry = boundary.into();
        entry.boundary().check_moving(
            "in the particle-contact method; take planes of symmetry, or the material point method",
        )?;
        self.boundaries.add(entry);
        Ok(())
    }

    /// Set the acceleration of all particles over time, m/s^2.
    pub fn set_body_force(&mut self, acceleration: BodyForce<D>) {
        self.body_force = Some(acceleration);
    }

    /// Set the state of every element by `change`, from its centre (m) and its state of the law `C`, which must be the body's; for initial
    /// stresses.
    ///
    /// # Errors
    /// Another law; a non-finite number.
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

    /// Particles of the body.
    pub fn particles(&self) -> &[Particle<D>] {
        &self.particles
    }
    /// Elements: `D + 1` particles each, positively oriented.
    pub fn element_nodes(&self) -> &[u32] {
        &self.elements.nodes
    }
    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.elements.len()
    }
    /// Constitutive law.
    pub fn material(&self) -> &dyn Material<f64> {
        &*self.material
    }
    /// Return the names of the ingredients of the method in one line.
    pub fn describe(&self) -> String {
        self.method.describe()
    }
    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }
    /// Number of steps.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }
    /// Audit of revisions since the start.
    pub fn audit(&self) -> &Audit {
        &self.audit
    }
    /// Number of neighbour searches.
    pub fn searches(&self) -> u64 {
        self.neighbours.searches()
    }

    /// Store the body in a checkpoint, or load it: method, law, conditions and state; as [`Solver::archive`], but without the watch.
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
        self.boundaries.archive(file, times, &of)?;
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

    /// Return the speed that crosses half a particle in a Courant step, m/s.
    pub(crate) fn speed(&self) -> f64 {
        let smallest = self.particles.iter().fold(f64::INFINITY, |m, p| m.min(p.radius));
        self.rate * 2.0 * smallest
    }

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), Solver::exchange(self), self.clock);
        let at = Look::new(&clock, &exchange, self.speed(), ADVICE.loss);
        let mut watcher = std::mem::take(&mut self.watcher);
        let bodies: [&dyn Body; 1] = [self];
        let gain = gain_at_the_fastest(&bodies, |_| ADVICE.gain);
        let looked = watcher.look(&totals, M::Embedding::HOOP, &at, || not_finite(&bodies), gain);
        watcher.look_at_fields(&clock, &bodies, (D, M::Embedding::HOOP), None);
        self.watcher = watcher;
        looked
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        let (time, force) = (self.clock.time, self.body_force.as_ref());
        let checked = check_at(force, &self.boundaries, time, &[time, time + dt]);
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

/// Single body as a scene.
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
    // Never inlined, so that profilers (callgrind) separate steps from observers.
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
    /// Exchange with boundaries and body force since the start, and energy that revisions added without a source.
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
    fn account_of(&self, totals: &Totals) -> Account {
        self.watcher.account(totals, &Solver::exchange(self), M::Embedding::HOOP)
    }
}
