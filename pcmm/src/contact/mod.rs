//! Several bodies, each with its law and method, and contact between them.

pub(crate) mod body;
pub(crate) mod candidates;
mod meet;
mod places;
mod solve;
mod wall;

use impactite_scene::control::ControlError;
use impactite_scene::watch::Watcher;
use impactite_scene::{
    Account, Archive, Body, CheckpointError, Clock, ContactPoint, Exchange, PairContact, SceneError, Solver,
    StepError, Stopped, TimeControl, Totals, Warning, Watch,
};
use impactite_simd::Team;
use mpm_contact::{ContactDetector, Pairs};

use crate::audit::{Audit, Coverage};
use crate::method::Composition;
use crate::particles::Particle;
use crate::solver::{COURANT, Pcmm, broken, gain, look_at};
use body::Part;
use candidates::{Candidates, Member};
use meet::meet;

pub use meet::PairOfParticles;
pub use wall::RigidWall;
pub(crate) use wall::wide;

/// Bodies that meet: any number of [`Pcmm`] solvers of any laws and methods, which take their steps together, and rigid
/// walls. A scene of one body needs none of this, and pays nothing for it.
///
/// Contact is between pairs of particles: every particle of a surface and the nearest of the other body that faces it.
/// Detectors, normals and laws are those of `mpm-contact` (with the material point method, places of contact are nodes):
/// normals of [`mpm_contact::Gradients`] are sums of V grad N over the elements at a particle, so that flat surfaces are
/// flat; surfaces lie [`crate::Packing::surface`] radii beyond the centres. Impulses of all pairs are found
/// together; every one acts on two bodies with opposite signs.
///
/// ```
/// use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
/// use impactite_geometry::{Cuboid, Lattice};
/// use impactite_scene::PlaneStrain;
/// use mpm_materials::{Elastic, LogarithmicBulk, Moduli, Solid};
/// use pcmm::{Bodies, LocalDelaunay, Masses, Method, Packing, Pcmm};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A block of aluminium flies into one of steel, friction 0.2.
/// let h = 1.0e-3;
/// let mut scene = Bodies::<2, _>::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.2)?));
/// for (name, left, density, young, speed) in
///     [("steel", 0.0, 7850.0, 206e9, 0.0), ("aluminium", 5.0 * h, 2700.0, 70e9, -100.0)]
/// {
///     let shape = Cuboid::new([left, 0.0], [left + 4.0 * h, 4.0 * h])?;
///     let packing = Packing::on_nodes(&shape, &Lattice::new([left, 0.0], h)?)?;
///     let moduli = Moduli::young_poisson(young, 0.3)?;
///     let law = Solid::new(Elastic::new(moduli.shear)?, LogarithmicBulk::new(density, moduli.bulk)?);
///     let method = Method::consistent(PlaneStrain, LocalDelaunay::new(0.45 * h, 2.0)?);
///     scene.add(name, Pcmm::new(method, law, &packing, |_| [speed, 0.0], Masses::FromElements)?);
/// }
/// scene.run_until(1.2e-5)?;
/// // The gap of 1 mm was closed after 10 microseconds, and the steel moves.
/// assert!(scene.totals_of(0).is_some_and(|steel| steel.momentum[0] < 0.0));
/// # Ok(())
/// # }
/// ```
pub struct Bodies<const D: usize, S> {
    detector: S,
    laws: Pairs<f64>,
    members: Vec<Member<D>>,
    candidates: Candidates,
    control: TimeControl,
    team: Team,
    spacing: f64,
    clock: Clock,
    contacts: Vec<PairOfParticles>,
    pairs: Vec<PairContact>,
    /// What moving walls gave.
    walls: Exchange,
    watcher: Watcher,
}

impl<const D: usize, S: ContactDetector<f64, D>> Bodies<D, S> {
    /// A scene without bodies. Takes half of altitude over wave speed for a step, on the caller's thread.
    pub fn new(detector: S, laws: Pairs<f64>) -> Self {
        Bodies {
            detector,
            laws,
            members: Vec::new(),
            candidates: Candidates::default(),
            control: TimeControl::Courant { factor: COURANT, growth: 1.1 },
            team: Team::one(),
            spacing: 0.0,
            clock: Clock::default(),
            contacts: Vec::new(),
            pairs: Vec::new(),
            walls: Exchange::default(),
            watcher: Watcher::default(),
        }
    }

    /// Add a body, with the boundaries, body force and interval of revision that it has. Its threads and time control are
    /// those of the scene from now on. Returns its number.
    pub fn add<M: Composition<D>>(&mut self, name: impl Into<String>, body: Pcmm<D, M>) -> usize {
        let mut part: Box<dyn Part<D>> = Box::new(body);
        part.set_team(self.team.clone());
        part.rename(name.into());
        self.join(Member::Body { part, start: Vec::new() })
    }

    /// Add a rigid wall. Returns its number, which is one among those of the bodies.
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
            sum += part.particles().iter().map(|p| 2.0 * p.radius).sum::<f64>();
            count += part.particles().len();
        }
        self.spacing = sum / count.max(1) as f64;
        self.members.len() - 1
    }

    /// Run on these threads. Results are the same bits for any number.
    pub fn set_team(&mut self, team: Team) {
        for member in &mut self.members {
            if let Member::Body { part, .. } = member {
                part.set_team(team.clone());
            }
        }
        self.team = team;
    }

    /// Choose the time step otherwise: as [`Pcmm::set_time_control`], over all bodies.
    ///
    /// # Errors
    /// A control that no run can use.
    pub fn set_time_control(&mut self, control: TimeControl) -> Result<(), ControlError> {
        control.check_without_grid()?;
        self.control = control;
        Ok(())
    }

    /// The size of the next step by the time control, s.
    pub fn next_time_step(&self) -> f64 {
        let rate = self.parts().map(|part| part.rate()).fold(0.0, f64::max);
        self.control.next(rate, self.clock.last)
    }

    /// Choose what the run watches over: [`Watch`]. A run that the watch stopped may go on after this.
    pub fn set_watch(&mut self, watch: Watch) {
        self.watcher.set(watch);
    }

    /// Step until `end` (s), which is met exactly.
    ///
    /// # Errors
    /// As [`Solver::run_until`].
    pub fn run_until(&mut self, end: f64) -> Result<(), StepError> {
        Solver::run_until(self, end)
    }

    fn make_step(&mut self, left: f64) -> Result<f64, StepError> {
        if self.members.is_empty() {
            return Err(self.clock.stopped(Stopped::Scene(SceneError::NoBodies)));
        }
        if self.laws.remembered_numbers() > 0 {
            let what = "a contact law that remembers".to_string();
            let why =
                "pairs of particles keep nothing from step to step: take a law without memory (`Coulomb`)";
            let refused = SceneError::NotWith { what, method: "the particle-contact method".into(), why };
            return Err(self.clock.stopped(Stopped::Scene(refused)));
        }
        let dt = self.clock.step_within(self.next_time_step(), left)?;
        let checked = self.parts().try_for_each(|part| part.check(dt));
        checked.map_err(|error| self.clock.stopped(Stopped::Scene(error)))?;
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

    fn look(&mut self) -> Result<(), StepError> {
        let (totals, exchange, clock) = (self.totals(), self.exchange(), self.clock);
        let speed = self.parts().map(Part::speed).fold(0.0, f64::max);
        let at = look_at(&clock, &exchange, speed);
        let bodies = self.bodies();
        let (broken, gain) = (broken(&bodies), gain(&bodies));
        let axisymmetric = self.axisymmetric();
        self.watcher.look(&totals, axisymmetric, &at, || broken, gain)
    }

    /// Forces and trial velocities; impulses between bodies; boundaries and positions; elements.
    fn step(&mut self, dt: f64) -> Result<(), StepError> {
        for member in &mut self.members {
            if let Member::Body { part, start, .. } = member {
                part.accelerate(dt, start);
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
                    let square = |p: &Particle<D>| p.velocity.iter().map(|v| v * v).sum::<f64>();
                    fastest = part.particles().iter().map(square).fold(fastest * fastest, f64::max).sqrt();
                    part.finish(dt)?;
                }
            }
        }
        self.candidates.moved(fastest * dt);
        self.clock.advance(dt);
        Ok(())
    }

    fn make_contact(&mut self, dt: f64) {
        let candidates = self.candidates.update(&self.members);
        let met = meet(
            &mut self.members,
            &self.detector,
            &self.laws,
            self.spacing,
            candidates,
            self.clock.time,
            dt,
        );
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

    fn parts(&self) -> impl Iterator<Item = &dyn Part<D>> {
        self.members.iter().filter_map(Member::part)
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.clock.time
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.clock.steps
    }
    /// The particles of a body; none of a wall.
    pub fn particles(&self, body: usize) -> &[Particle<D>] {
        self.members.get(body).and_then(Member::part).map_or(&[], Part::particles)
    }
    /// The elements of a body: `D + 1` particles each, positively oriented.
    pub fn element_nodes(&self, body: usize) -> &[u32] {
        self.members.get(body).and_then(Member::part).map_or(&[], Part::element_nodes)
    }
    /// Sums over a body; `None` of a wall.
    pub fn totals_of(&self, body: usize) -> Option<Totals> {
        self.members.get(body)?.part().map(|part| part.totals())
    }
    /// How the elements of all bodies cover their particles.
    pub fn coverage(&self) -> Coverage {
        self.parts().fold(Coverage::default(), |sum, part| sum.plus(&part.coverage()))
    }
    /// What revisions did to all bodies.
    pub fn audit(&self) -> Audit {
        self.parts().fold(Audit::default(), |sum, part| sum.plus(&part.audit()))
    }
    /// The pairs of particles in contact in the last step.
    pub fn particles_in_contact(&self) -> &[PairOfParticles] {
        &self.contacts
    }
    /// Elements of all bodies.
    pub fn elements(&self) -> usize {
        self.parts().map(|part| part.elements()).sum()
    }
    /// Searches for pairs of particles of different bodies.
    pub fn searches(&self) -> u64 {
        self.candidates.searches
    }
}

impl<const D: usize, S: ContactDetector<f64, D>> Solver for Bodies<D, S> {
    /// A line a body.
    fn method(&self) -> String {
        let of = |part: &dyn Part<D>| format!("; {}: {}", part.name(), part.describe());
        format!("particle-contact method{}", self.parts().map(of).collect::<String>())
    }
    fn dimensions(&self) -> usize {
        D
    }
    fn axisymmetric(&self) -> bool {
        self.parts().any(Part::axisymmetric)
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
    /// What boundaries and walls gave to the bodies since the start, and what contact took.
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
    fn account(&self) -> Account {
        self.watcher.account(&self.totals(), &self.exchange(), self.axisymmetric())
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
