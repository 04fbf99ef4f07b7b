//! What two bodies do to each other where they touch.

use std::sync::Arc;

use mpm_materials::Real;

use crate::vector::{difference, dot, length, sum, times};

/// Two bodies that touch, at a node of a grid or as a pair of particles, as their law sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<'a, T> {
    /// The bodies, by number in the order they are added to the scene, from 0; the smaller first.
    pub bodies: [usize; 2],
    /// Where they touch, m: the node, or half way between the particles.
    pub position: [f64; 3],
    /// Time at the start of the step, s.
    pub time: f64,
    /// Time step, s.
    pub dt: T,
    /// Unit normal, from the first body to the second.
    pub normal: [T; 3],
    /// Distance of the surfaces along it, m, where it is measured; negative if they overlap.
    pub gap: Option<T>,
    /// Area that the contact stands for, m^2; zero if the law does not ask ([`ContactLaw::needs_area`]).
    pub area: T,
    /// Masses that meet, kg: of the nodes or particles; infinite for a body of prescribed motion. Where several pairs share a mass, the
    /// part that this one has of it.
    pub masses: [T; 2],
    /// Trial velocities, m/s: those that the bodies would have at the end of the step without this contact.
    pub velocities: [[T; 3]; 2],
    /// How far the bodies slid along each other here before this step, m, since they touch; zero if the law does not remember it
    /// ([`ContactLaw::remembers`]).
    pub slip: T,
    /// The law's own numbers of this contact at the start of the step; empty if it remembers none.
    pub memory: &'a [f64],
}

impl<T: Real> Contact<'_, T> {
    /// The first contact of bodies 0 and 1, at the origin, without gap, area or memory.
    pub fn new(normal: [T; 3], masses: [T; 2], velocities: [[T; 3]; 2], dt: T) -> Self {
        let (bodies, position, time) = ([0, 1], [0.0; 3], 0.0);
        let (gap, area, slip, memory) = (None, T::of(0.0), T::of(0.0), &[][..]);
        Contact { bodies, position, time, dt, normal, gap, area, masses, velocities, slip, memory }
    }
    /// Trial velocity of the first body relative to the second, m/s.
    pub fn relative_velocity(&self) -> [T; 3] {
        difference(self.velocities[0], self.velocities[1])
    }
    /// How fast the bodies close, m/s; negative where they part.
    pub fn approach(&self) -> T {
        dot(self.relative_velocity(), self.normal)
    }
    /// m_r m_s / (m_r + m_s), kg, which also holds for an infinite mass.
    pub fn reduced_mass(&self) -> T {
        let (one, [r, s]): (T, _) = (T::of(1.0), self.masses);
        one / (one / r + one / s)
    }
    /// The impulse that slows the bodies down by `approach` along the normal, and their slip by at most `limit`, both in m/s: of friction
    /// mu, `limit` is mu times `approach`.
    pub fn braking(&self, approach: T, limit: T) -> [T; 3] {
        let (normal, relative) = (self.normal, self.relative_velocity());
        let slip = difference(relative, times(normal, dot(relative, normal)));
        let speed = length(slip);
        let share = if speed > limit { limit / speed } else { T::of(1.0) };
        times(sum(times(normal, approach), times(slip, share)), self.reduced_mass())
    }
}

/// What a step did to a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome<T> {
    /// Impulse on the second body, N s; zero where they touch and do not press.
    pub impulse: [T; 3],
    /// How far the first body slid along the second in the step, m: its relative velocity at the end of the step across the normal,
    /// times the step.
    pub slid: [T; 3],
}

/// What a law remembers of a contact from step to step: numbers that are zero when two bodies begin to touch, last while they do, and
/// are forgotten when they let go. They are part of checkpoints, and the same bits for any number of threads.
///
/// *On a grid contacts are at nodes, and bodies move through them.* What a node remembers of a pair of bodies lasts while the detector
/// finds that they touch there, whether they press or not (with a detector of gaps: to within the thousandth of a cell by which it
/// looks ahead, so that rattling does not clear it). It moves with the mean of both velocities, from node to nearest node. A
/// node where they begin to touch takes the mean of the nearest nodes, among its 3^D - 1 neighbours, where they touched a step ago, and
/// only where there is none does it begin with zeros. So memory follows a patch through the grid, whichever of the bodies moves:
/// exactly what is uniform over the patch, as the slip of a block; a pattern along it to within half a cell, if it is wider than some
/// cells and the bodies do not turn. It is the contact that remembers, and neither surface: with bodies that slide by much
/// more than a cell a pattern belongs to none of both. A patch that grows hands what its rim remembers to what is new in it,
/// since growth cannot be told from motion. Numbers that are parts of a vector are not turned with the bodies. Bodies that are
/// put to rest forget.
///
/// The crate `pcmm` keeps no memory, and refuses laws that ask for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Remembers {
    /// Nothing, at no cost.
    #[default]
    Nothing,
    /// [`Contact::slip`].
    Slip,
    /// [`Contact::slip`], and so many numbers of its own, [`Contact::memory`].
    SlipAnd(usize),
}

impl Remembers {
    /// How many numbers these are, with the slip.
    #[must_use]
    pub fn numbers(self) -> usize {
        match self {
            Remembers::Nothing => 0,
            Remembers::Slip => 1,
            Remembers::SlipAnd(own) => 1 + own,
        }
    }
}

/// A law of contact: the impulse between two bodies that touch, from what they are and, for laws with memory, from what they did.
///
/// ```
/// use mpm_contact::{Contact, ContactLaw, Coulomb};
/// let law = Coulomb::new(0.5)?;
/// // The first body, 1 kg, runs into the second, 3 kg, at 2 m/s, and slides along it at 9 m/s.
/// let contact = Contact::new([1.0, 0.0, 0.0], [1.0, 3.0], [[2.0, 9.0, 0.0], [0.0; 3]], 1.0e-3);
/// assert_eq!(law.impulse(&contact), [1.5, 0.75, 0.0]);
/// # Ok::<(), mpm_materials::ParameterError>(())
/// ```
///
/// A law of one's own: friction that wears off with the work it does.
///
/// ```
/// use mpm_contact::vector::dot;
/// use mpm_contact::{Contact, ContactLaw, Outcome, Remembers};
///
/// /// mu = mu_0 / (1 + work of friction on an area / scale).
/// #[derive(Clone, Debug)]
/// struct Polishing {
///     friction: f64,
///     /// J/m^2.
///     scale: f64,
/// }
/// impl ContactLaw<f64> for Polishing {
///     fn remembers(&self) -> Remembers {
///         Remembers::SlipAnd(1) // the work, J/m^2
///     }
///     fn needs_area(&self) -> bool {
///         true
///     }
///     fn impulse(&self, contact: &Contact<f64>) -> [f64; 3] {
///         let mu = self.friction / (1.0 + contact.memory[0] / self.scale);
///         let approach = contact.approach();
///         if approach > 0.0 { contact.braking(approach, mu * approach) } else { [0.0; 3] }
///     }
///     fn advance(&self, contact: &Contact<f64>, outcome: &Outcome<f64>, memory: &mut [f64]) {
///         if contact.area > 0.0 {
///             memory[0] += dot(outcome.impulse, outcome.slid) / (contact.dt * contact.area);
///         }
///     }
/// }
/// # #[cfg(feature = "conformance")]
/// mpm_contact::conformance::law(&Polishing { friction: 0.3, scale: 1.0 }).unwrap();
/// ```
pub trait ContactLaw<T: Real>: std::fmt::Debug + Send + Sync + 'static {
    /// Does it hold bodies that move apart back?
    fn pulls(&self) -> bool {
        false
    }
    /// Does it store energy, and give it back to bodies that move apart? All others at best take none.
    fn springs(&self) -> bool {
        false
    }
    /// Does it need [`Contact::area`]?
    fn needs_area(&self) -> bool {
        false
    }
    /// What of a contact it remembers.
    fn remembers(&self) -> Remembers {
        Remembers::Nothing
    }
    /// Impulse on the second body, N s; the first gets its opposite. Where pairs depend on each other it is asked many times a step, with
    /// the same memory. Exchanging the bodies and turning the normal must turn the impulse.
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3];
    /// Bring its own numbers to the end of the step, once a step while the bodies touch, whether they press or not: `memory` is
    /// [`Contact::memory`] at first. The slip is followed without this.
    fn advance(&self, _contact: &Contact<'_, T>, _outcome: &Outcome<T>, _memory: &mut [f64]) {}
}

/// The law of every pair of bodies: a default, and exceptions.
///
/// ```
/// use mpm_contact::{Coulomb, Pairs, Stick};
/// // Friction 0.3 between all bodies; the first two are glued.
/// let laws = Pairs::new(Coulomb::new(0.3)?).with(0, 1, Stick);
/// # Ok::<(), mpm_materials::ParameterError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Pairs<T> {
    default: Arc<dyn ContactLaw<T>>,
    table: Vec<([usize; 2], Arc<dyn ContactLaw<T>>)>,
}
impl<L: ContactLaw<f64>> From<L> for Pairs<f64> {
    fn from(law: L) -> Self {
        Pairs::new(law)
    }
}
impl<T: Real> Pairs<T> {
    /// The same law for all pairs.
    pub fn new(law: impl ContactLaw<T>) -> Self {
        Pairs { default: Arc::new(law), table: Vec::new() }
    }
    /// Another law between two bodies, by number in the order they are added to the scene, from 0.
    #[must_use]
    pub fn with(mut self, one: usize, other: usize, law: impl ContactLaw<T>) -> Self {
        let bodies = [one.min(other), one.max(other)];
        self.table.retain(|entry| entry.0 != bodies);
        self.table.push((bodies, Arc::new(law)));
        self
    }
    /// The law between two bodies.
    pub fn law(&self, one: usize, other: usize) -> &dyn ContactLaw<T> {
        let bodies = [one.min(other), one.max(other)];
        let found = self.table.iter().find(|entry| entry.0 == bodies);
        found.map_or(self.default.as_ref(), |entry| entry.1.as_ref())
    }
    /// How many numbers a contact keeps from step to step, of the law that keeps most: [`Remembers::numbers`].
    pub fn remembered_numbers(&self) -> usize {
        let all = self.table.iter().map(|entry| &entry.1).chain([&self.default]);
        all.map(|law| law.remembers().numbers()).max().unwrap_or(0)
    }
}
