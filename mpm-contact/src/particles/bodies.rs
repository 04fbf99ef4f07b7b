//! Scene of several bodies of particles, each with its law and method, and contact between them.

use std::any::Any;

use impactite_scene::control::{ControlError, largest};
use impactite_scene::watch::{Look, Loss, Watcher, gain_at_the_fastest, not_finite};
use impactite_scene::{
    Account, Archive, Body, CheckpointError, Clock, ContactPoint, Exchange, PairContact, SceneError, Solver,
    StepError, StepLimit, Stopped, TimeControl, Totals, Warning, Watch,
};
use impactite_simd::Team;

use super::body::{Advice, ContactParticle, ParticleBody};
use super::candidates::Candidates;
use super::meet::meet;
use super::member::{Member, particles};
use super::met::PairOfParticles;
use super::wall::RigidWall;
use crate::detect::ContactDetector;
use crate::law::Pairs;

/// Default Courant factor of the time step.
const COURANT: f64 = 0.5;

/// Scene of bodies of particles in contact: any number of any laws and methods ([`ParticleBody`]), with common time steps, and rigid walls.
/// A scene of one body does not need this, and has no cost from it.
///
/// Contact and an example: see the [module](crate::particles).
pub struct Bodies<const D: usize, S> {
    detector: S,
    laws: Pairs<f64>,
    members: Vec<Member<D>>,
    candidates: Candidates,
    control: TimeControl,
    team: Team,
    spacing: f64,
    /// True if a body was added since the last check of particles.
    unchecked: bool,
    clock: Clock,
    contacts: Vec<PairOfParticles>,
    pairs: Vec<PairContact>,
    /// Exchange with moving walls.
    walls: Exchange,
    watcher: Watcher,
}

impl<const D: usize, S: ContactDetector<f64, D>> Bodies<D, S> {
    /// Create a scene without bodies. It makes steps of half of one over the largest Courant rate, on the caller's thread.
    pub fn new(detector: S, laws: Pairs<f64>) -> Self {
        Bodies {
            detector,
            laws,
            members: Vec::new(),
            candidates: Candidates::default(),
            control: TimeControl::Courant { factor: COURANT, growth: 1.1 },
            team: Team::one(),
            spacing: 0.0,
            unchecked: false,
            clock: Clock::default(),
            contacts: Vec::new(),
            pairs: Vec::new(),
            walls: Exchange::default(),
            watcher: Watcher::default(),
        }
    }

    /// Add a body, with its loads and conditions. The scene sets its threads and time step from now on. Returns its number.
    pub fn add(&mut self, name: impl Into<String>, body: impl ParticleBody<D>) -> usize {
        let mut part: Box<dyn ParticleBody<D>> = Box::new(body);
        part.set_team(self.team.clone());
        part.rename(name.into());
        self.join(Member::Body { part, start: Vec::new() })
    }

    /// Add a rigid wall. Returns its number, counted among those of the bodies.
    pub fn add_wall(&mut self, mut wall: RigidWall<D>) -> usize {
        wall.rename(format!("wall {}", self.members.len()));
        self.join(Member::Wall { wall })
    }

    fn join(&mut self, member: Member<D>) -> usize {
        self.members.push(member);
        self.candidates.forget();
        self.watcher.reopen();
        let (mut sum, mut count) = (0.0, 0usize);
        for part in self.members.iter().filter_map(Member::part) {
            sum += particles(part).map(|p| 2.0 * p.radius).sum::<f64>();
            count += part.len();
        }
        self.spacing = sum / count.max(1) as f64;
        self.unchecked = true;
        self.members.len() - 1
    }

    /// Set the thread pool. Results are bitwise equal for any number of threads.
    pub fn set_team(&mut self, team: Team) {
        for member in &mut self.members {
            if let Member::Body { part, .. } = member {
                part.set_team(team.clone());
            }
        }
        self.team = team;
    }

    /// Set the time step control, by the largest Courant rate of all bodies.
    ///
    /// # Errors
    /// Invalid time step control.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// Size of the next time step by the time step control, s.
    pub fn next_time_step(&self) -> f64 {
        let rate = self.parts().map(|part| part.rate()).fold(0.0, f64::max);
        self.control.next(rate, self.clock.last)
    }

    /// Set the run monitoring ([`Watch`]). A run that it stopped may continue after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Run until `end` (s), which is reached exactly.
    ///
    /// # Errors
    /// Errors of [`Solver::run_until`].
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        self.check_members().map_err(|error| self.refused(error))?;
        self.unchecked = false;
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        let checked = self.parts().try_for_each(|part| part.check(dt));
        checked.map_err(|error| self.refused(error))?;
        if self.watcher.opens() {
            let (totals, exchange) = (self.totals(), self.exchange());
            self.watcher.open(self.clock.steps, &totals, &exchange, self.axisymmetric());
        }
        self.step(dt)?;
        if self.watcher.due(self.clock.steps).is_some() {
            self.look()?;
        }
        Ok(dt)
    }

    fn refused(&self, error: SceneError) -> StepError {
        self.clock.stopped(Stopped::Scene(error))
    }

    /// Check that the members and laws are compatible with one scene.
    fn check_members(&self) -> Result<(), SceneError> {
        let refused = |what: String, why: &'static str| {
            Err(SceneError::NotWith { what, method: "contact of pairs of particles".into(), why })
        };
        if self.members.is_empty() {
            return Err(SceneError::NoBodies);
        }
        if self.laws.remembered_numbers() > 0 {
            let why = "they keep nothing from step to step: take a law without memory (`Coulomb`)";
            return refused("a contact law that remembers".into(), why);
        }
        let around = self.axisymmetric();
        if let Some(plane) = self.parts().find(|part| part.axisymmetric() != around) {
            let what = format!("a body around an axis beside `{}` in the plane", plane.name());
            return refused(what, "masses are per radian, or per metre of depth: take one for all bodies");
        }
        let positive = |x: f64| x > 0.0 && x.is_finite();
        for part in self.parts().filter(|_| self.unchecked) {
            let mut of_part = particles(part).enumerate();
            if let Some((n, p)) = of_part.find(|(_, p)| !positive(p.mass) || !positive(p.radius)) {
                let ContactParticle { position, mass, radius, .. } = p;
                let body = part.name();
                let what = format!(
                    "particle {n} of body `{body}` at {position:?} m with a mass of {mass} kg and a radius of {radius} m"
                );
                return refused(what, "both must be positive and finite");
            }
        }
        Ok(())
    }

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), self.exchange(), self.clock);
        let axisymmetric = self.axisymmetric();
        let speed = self.parts().map(ParticleBody::speed).fold(0.0, f64::max);
        let at = Look::new(&clock, &exchange, speed, self.loss());
        let mut watcher = std::mem::take(&mut self.watcher);
        let bodies = self.bodies();
        let gain = gain_at_the_fastest(&bodies, |body| self.advice(body).gain);
        let looked = watcher.look(&totals, axisymmetric, &at, || not_finite(&bodies), gain);
        watcher.look_at_fields(&clock, &bodies, (self.dimensions(), axisymmetric), None);
        self.watcher = watcher;
        looked
    }

    /// Advice on lost energy: that of the bodies, if it is the same for all.
    fn loss(&self) -> Loss {
        let mut said = self.parts().map(|part| part.advice().loss);
        let first = said.next().unwrap_or(Advice::default().loss);
        if said.all(|other| other == first) { first } else { Advice::default().loss }
    }

    fn advice(&self, body: usize) -> Advice {
        self.body(body).map_or(Advice::default(), ParticleBody::advice)
    }

    /// Make a step, by the list of [`ParticleBody`].
    fn step(&mut self, dt: f64) -> Result<(), StepError> {
        for member in &mut self.members {
            if let Member::Body { part, start, .. } = member {
                part.accelerate(dt, start)?;
            }
        }
        self.make_contact(dt);
        let mut fastest = 0.0f64;
        for member in &mut self.members {
            match member {
                Member::Wall { wall } => {
                    wall.advance(dt);
                    fastest = fastest.max(wall.speed());
                }
                Member::Body { part, start } => {
                    part.advance(dt, start)?;
                    fastest = fastest.max(part.fastest());
                    part.finish(dt)?;
                }
            }
        }
        self.candidates.moved(fastest * dt);
        self.clock.advance(dt);
        Ok(())
    }

    fn make_contact(&mut self, dt: f64) {
        self.candidates.update(&self.members);
        let (members, at) = (&mut self.members, (self.clock.time, dt));
        let met = meet(members, &self.detector, &self.laws, self.spacing, &self.candidates, at);
        for d in 0..3 {
            self.walls.impulse[d] += met.impulse[d];
        }
        self.walls.work += met.work;
        for pair in &mut self.pairs {
            (pair.force, pair.places, pair.gap) = ([0.0; 3], 0, None);
        }
        for contact in &met.contacts {
            let bodies = contact.bodies;
            let place = self.pairs.binary_search_by_key(&bodies, |p| p.bodies).unwrap_or_else(|place| {
                self.pairs.insert(place, PairContact::new(bodies));
                place
            });
            let pair = &mut self.pairs[place];
            for d in 0..3 {
                pair.force[d] += contact.impulse[d] / dt;
            }
            pair.places += 1;
            pair.gap = contact.gap.map(|gap| pair.gap.map_or(gap, |least| least.min(gap))).or(pair.gap);
            pair.friction += contact.friction;
            pair.taken += contact.taken;
        }
        self.contacts = met.contacts;
    }

    fn parts(&self) -> impl Iterator<Item = &dyn ParticleBody<D>> {
        self.members.iter().filter_map(Member::part)
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }
    /// Number of steps made.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }
    /// Body by number; `None` for a wall.
    pub fn body(&self, body: usize) -> Option<&dyn ParticleBody<D>> {
        self.members.get(body)?.part()
    }
    /// Body by number as its own type; `None` for another type, and for a wall.
    pub fn part<B: ParticleBody<D>>(&self, body: usize) -> Option<&B> {
        let part: &dyn Any = self.body(body)?;
        part.downcast_ref()
    }
    /// Particles of a body; none for a wall.
    pub fn particles(&self, body: usize) -> impl Iterator<Item = ContactParticle<D>> + '_ {
        self.body(body).into_iter().flat_map(particles)
    }
    /// Totals of a body; `None` for a wall.
    pub fn totals_of(&self, body: usize) -> Option<Totals> {
        self.body(body).map(|part| part.totals())
    }
    /// Pairs of particles in contact in the last step.
    pub fn particles_in_contact(&self) -> &[PairOfParticles] {
        &self.contacts
    }
    /// Number of searches for pairs of particles of different bodies.
    pub fn searches(&self) -> u64 {
        self.candidates.searches
    }
}

impl<const D: usize, S: ContactDetector<f64, D>> Solver for Bodies<D, S> {
    /// Description of the method of each body.
    fn method(&self) -> String {
        let of = |part: &dyn ParticleBody<D>| format!("; {}: {}", part.name(), part.describe());
        format!("bodies of particles{}", self.parts().map(of).collect::<String>())
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn axisymmetric(&self) -> bool {
        self.parts().any(ParticleBody::axisymmetric)
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
        let rates = self.members.iter().map(|member| member.part().map_or(0.0, ParticleBody::rate));
        let (body, rate) = largest(rates);
        Some(self.control.limit(rate, self.clock.last, body))
    }
    fn step_at_most(&mut self, left: f64) -> Result<f64, StepError> {
        self.watcher.may_go_on()?;
        let made = self.make_step(left);
        self.watcher.note(made)
    }
    fn set_team(&mut self, team: Team) {
        Bodies::set_team(self, team);
    }
    fn bodies(&self) -> Vec<&dyn Body> {
        self.members.iter().map(Member::body).collect()
    }
    /// Exchange with boundaries and walls since the start, and energy taken by contact.
    fn exchange(&self) -> Exchange {
        let mut sum = self.parts().fold(self.walls, |sum, part| sum.plus(&part.exchange()));
        for pair in &self.pairs {
            sum.friction += pair.friction;
            sum.impacts += pair.taken;
        }
        sum
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("number of bodies and walls", &self.members.len().to_string())?;
        file.same("contact", &format!("{:?}, {:?}", self.detector, self.laws))?;
        self.clock.archive(file)?;
        for member in &mut self.members {
            match member {
                Member::Body { part, .. } => {
                    file.same("name of a body", part.name())?;
                    part.archive(file)?;
                }
                Member::Wall { wall } => wall.archive(file)?,
            }
        }
        file.list(&mut self.pairs, &PairContact::new([0; 2]), |file, pair| pair.archive(file))?;
        if file.reads() {
            self.candidates.forget();
            self.contacts.clear();
        }
        self.walls.archive(file)?;
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
        self.watcher.account(totals, &self.exchange(), self.axisymmetric())
    }
    fn contacts(&self) -> Vec<PairContact> {
        self.pairs.clone()
    }
    fn contact_points(&self) -> Vec<ContactPoint> {
        let point = |pair: &PairOfParticles| {
            let PairOfParticles { position, bodies, normal, gap, impulse, .. } = *pair;
            ContactPoint { position, bodies, normal, gap, impulse }
        };
        self.contacts.iter().map(point).collect()
    }
}
