//! Several bodies, each with its law and method, and contact between them.

pub(crate) mod body;
pub(crate) mod candidates;
mod meet;
mod places;
mod solve;
mod wall;

use mpm_contact::{ContactDetector, Pairs};
use mpm_core::output::{FieldValues, OutputError, ParticleSize, Snapshot};
use mpm_core::step::control::ControlError;
use mpm_core::{Team, TimeControl};

use crate::boundary::Given;
use crate::ledger::{Audit, Totals};
use crate::method::Composition;
use crate::particles::Particle;
use crate::solver::{COURANT, Pcmm};
use crate::step::StepError;
use body::Part;
use candidates::{Candidates, Member};
use meet::meet;

pub use meet::PairContact;
pub use wall::RigidWall;

/// A step of several bodies that could not be made. The scene must not be stepped on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("body `{body}`: {cause}")]
pub struct BodyError {
    /// The body's name; of the whole scene, `scene`.
    pub body: String,
    /// What broke in it.
    pub cause: StepError,
}

/// What a pair of bodies did to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encounter {
    /// The bodies, by number; the smaller first.
    pub bodies: [usize; 2],
    /// Force on the second body, N, mean of the last step; the first feels its opposite.
    pub force: [f64; 3],
    /// Pairs of particles in contact in the last step.
    pub pairs: usize,
    /// Energy dissipated by friction since the start, J.
    pub friction: f64,
    /// Kinetic energy of colliding particles taken beside that since the start, J.
    pub taken: f64,
}

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
/// use mpm_core::geometry::{Cuboid, Lattice};
/// use mpm_core::PlaneStrain;
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
    time: f64,
    steps: u64,
    last: Option<f64>,
    contacts: Vec<PairContact>,
    encounters: Vec<Encounter>,
    walls: Given,
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
            time: 0.0,
            steps: 0,
            last: None,
            contacts: Vec::new(),
            encounters: Vec::new(),
            walls: Given::default(),
        }
    }

    /// Add a body, with the boundaries, body force and interval of revision that it has. Its threads and time control are
    /// those of the scene from now on. Returns its number.
    pub fn add<M: Composition<D>>(&mut self, name: impl Into<String>, body: Pcmm<D, M>) -> usize {
        let mut part: Box<dyn Part<D>> = Box::new(body);
        part.set_team(self.team.clone());
        self.join(Member::Body { name: name.into(), part, start: Vec::new() })
    }

    /// Add a rigid wall. Returns its number, which is one among those of the bodies.
    pub fn add_wall(&mut self, wall: RigidWall<D>) -> usize {
        self.join(Member::Wall { wall })
    }

    fn join(&mut self, member: Member<D>) -> usize {
        self.members.push(member);
        self.candidates.forget();
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
        let rate = self.parts().map(|(_, part)| part.rate()).fold(0.0, f64::max);
        self.control.next(rate, self.last)
    }

    /// One step, not beyond `end` (s). The last two steps before it share what is left.
    ///
    /// # Errors
    /// An end before the time reached, an element whose law breaks down, a velocity that is not finite.
    pub fn step_towards(&mut self, end: f64) -> Result<(), BodyError> {
        let whole = |cause| BodyError { body: "scene".into(), cause };
        let left = end - self.time;
        if !(left >= 0.0 && end.is_finite()) {
            return Err(whole(StepError::End { end, time: self.time }));
        }
        let dt = self.next_time_step();
        let dt = if dt >= left * (1.0 - 1e-9) { left } else { dt.min(0.5 * left) };
        if !(dt >= 0.0 && dt.is_finite()) {
            return Err(whole(StepError::TimeStep { step: self.steps, time: self.time, dt }));
        }
        if dt > 0.0 {
            self.step(dt)?;
        }
        if dt == left {
            self.time = end;
        }
        Ok(())
    }

    /// Step until `end` (s), which is met exactly.
    ///
    /// # Errors
    /// As [`Bodies::step_towards`].
    pub fn run_until(&mut self, end: f64) -> Result<(), BodyError> {
        if !(end.is_finite() && end >= self.time) {
            let cause = StepError::End { end, time: self.time };
            return Err(BodyError { body: "scene".into(), cause });
        }
        while self.time < end {
            let before = self.time;
            self.step_towards(end)?;
            // Such a step would be made for ever.
            if self.time == before {
                return Err(BodyError {
                    body: "scene".into(),
                    cause: StepError::TimeStep {
                        step: self.steps,
                        time: self.time,
                        dt: self.next_time_step(),
                    },
                });
            }
        }
        Ok(())
    }

    /// Forces and trial velocities; impulses between bodies; boundaries and positions; elements.
    fn step(&mut self, dt: f64) -> Result<(), BodyError> {
        for member in &mut self.members {
            if let Member::Body { part, start, .. } = member {
                part.accelerate(dt, start);
            }
        }
        self.exchange(dt);
        let mut fastest = 0.0f64;
        for member in &mut self.members {
            match member {
                Member::Wall { wall } => {
                    wall.advance(dt);
                    fastest = fastest.max(wall.speed());
                }
                Member::Body { name, part, start } => {
                    let named = |cause| BodyError { body: name.clone(), cause };
                    part.advance(dt, start).map_err(named)?;
                    let square = |p: &Particle<D>| p.velocity.iter().map(|v| v * v).sum::<f64>();
                    fastest = part.particles().iter().map(square).fold(fastest * fastest, f64::max).sqrt();
                    part.finish(dt).map_err(named)?;
                }
            }
        }
        self.candidates.moved(fastest * dt);
        self.time += dt;
        self.steps += 1;
        self.last = Some(dt);
        Ok(())
    }

    fn exchange(&mut self, dt: f64) {
        let candidates = self.candidates.update(&self.members);
        let met = meet(&mut self.members, &self.detector, &self.laws, self.spacing, candidates, dt);
        for d in 0..3 {
            self.walls.impulse[d] += met.impulse[d];
        }
        self.walls.work += met.work;
        for pair in &mut self.encounters {
            (pair.force, pair.pairs) = ([0.0; 3], 0);
        }
        for contact in &met.contacts {
            let bodies = contact.bodies;
            let place = self.encounters.binary_search_by_key(&bodies, |p| p.bodies).unwrap_or_else(|place| {
                let new = Encounter { bodies, force: [0.0; 3], pairs: 0, friction: 0.0, taken: 0.0 };
                self.encounters.insert(place, new);
                place
            });
            let pair = &mut self.encounters[place];
            for d in 0..3 {
                pair.force[d] += contact.impulse[d] / dt;
            }
            pair.pairs += 1;
            pair.friction += contact.friction;
            pair.taken += contact.taken;
        }
        self.contacts = met.contacts;
    }

    fn parts(&self) -> impl Iterator<Item = (&str, &dyn Part<D>)> {
        self.members.iter().filter_map(|m| match m {
            Member::Body { name, part, .. } => Some((name.as_str(), part.as_ref())),
            Member::Wall { .. } => None,
        })
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.time
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.steps
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
        self.members.get(body)?.part().map(Part::totals)
    }
    /// Sums over all bodies.
    pub fn totals(&self) -> Totals {
        self.parts().fold(Totals::default(), |sum, (_, part)| sum.plus(&part.totals()))
    }
    /// What revisions did to all bodies.
    pub fn audit(&self) -> Audit {
        self.parts().fold(Audit::default(), |sum, (_, part)| sum.plus(&part.audit()))
    }
    /// What boundaries and walls gave to the bodies since the start. Of walls, `work` is that of their motion; what
    /// particles lose on them is in [`Bodies::encounters`].
    pub fn given(&self) -> Given {
        self.parts().fold(self.walls, |sum, (_, part)| sum.plus(&part.given()))
    }
    /// The pairs of bodies that were ever in contact, by number.
    pub fn encounters(&self) -> &[Encounter] {
        &self.encounters
    }
    /// The pairs of particles in contact in the last step.
    pub fn contacts(&self) -> &[PairContact] {
        &self.contacts
    }
    /// Energy that contact took since the start, J: friction, and what colliding particles lose.
    pub fn taken(&self) -> f64 {
        self.encounters.iter().map(|e| e.friction + e.taken).sum()
    }
    /// Elements of all bodies.
    pub fn elements(&self) -> usize {
        self.parts().map(|(_, part)| part.elements()).sum()
    }
    /// Searches for pairs of particles of different bodies.
    pub fn searches(&self) -> u64 {
        self.candidates.searches
    }
    /// Bytes of memory of the bodies, by their own count.
    pub fn bytes(&self) -> usize {
        self.parts().map(|(_, part)| part.bytes()).sum()
    }
    /// A line a body that names its method.
    pub fn describe(&self) -> String {
        self.parts().map(|(name, part)| format!("{name}: {}\n", part.describe())).collect()
    }

    /// This instant for pictures and files: the particles of all bodies, body by body, with every field that all bodies
    /// have.
    ///
    /// # Errors
    /// A law with names that cannot be written.
    pub fn snapshot(&mut self) -> Result<Snapshot, OutputError> {
        let mut parts = Vec::new();
        for (number, member) in self.members.iter_mut().enumerate() {
            if let Member::Body { part, .. } = member {
                parts.push((number as u32, part.snapshot()?));
            }
        }
        let (mut positions, mut sizes, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in &parts {
            positions.extend_from_slice(part.positions());
            sizes.extend((0..part.len()).map(|i| part.size_of(i)));
            bodies.extend(std::iter::repeat_n(*number, part.len()));
        }
        let mut all = Snapshot::new(D, self.time, self.steps, positions, ParticleSize::Each(sizes))?
            .with_bodies(bodies)?;
        let Some((_, first)) = parts.first() else { return Ok(all) };
        for (name, values) in first.fields() {
            let same: Vec<&FieldValues> = parts
                .iter()
                .filter_map(|(_, p)| p.fields().find(|(other, _)| *other == name).map(|(_, v)| v))
                .collect();
            if same.len() == parts.len()
                && let Some(joined) = join(values, &same)
            {
                all = all.with_field(name, joined)?;
            }
        }
        Ok(all)
    }
}

/// One field of several bodies, if they are of one kind.
fn join(kind: &FieldValues, parts: &[&FieldValues]) -> Option<FieldValues> {
    macro_rules! all {
        ($variant:ident) => {{
            let mut list = Vec::new();
            for part in parts {
                let FieldValues::$variant(values) = part else { return None };
                list.extend_from_slice(values);
            }
            Some(FieldValues::$variant(list))
        }};
    }
    match kind {
        FieldValues::Scalar(_) => all!(Scalar),
        FieldValues::Vector(_) => all!(Vector),
        FieldValues::Tensor(_) => all!(Tensor),
    }
}
