//! Contact laws: impulses between two bodies in contact.

use std::sync::Arc;

use mpm_materials::Real;

use crate::vector::{difference, dot, length, sum, times};

/// Contact of two bodies, at a node of a grid or as a pair of particles, as the input of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<'a, T> {
    /// Numbers of the bodies in the order of addition to the scene, from 0; the smaller first.
    pub bodies: [usize; 2],
    /// Contact position, m: the node, or half way between the particles.
    pub position: [f64; 3],
    /// Time at the start of the step, s.
    pub time: f64,
    /// Time step, s.
    pub dt: T,
    /// Unit normal, from the first body to the second.
    pub normal: [T; 3],
    /// Gap: distance of the surfaces along the normal, m, where measured; negative for overlap.
    pub gap: Option<T>,
    /// Contact area, m^2; zero if the law does not need it ([`ContactLaw::needs_area`]).
    pub area: T,
    /// Masses in contact, kg: of the nodes or particles; infinite for a body of prescribed motion. Where several pairs share a mass, the
    /// part of this pair.
    pub masses: [T; 2],
    /// Trial velocities, m/s: those at the end of the step without this contact.
    pub velocities: [[T; 3]; 2],
    /// Slip path between the bodies before this step, m, since contact began; zero if the law does not remember it
    /// ([`ContactLaw::remembers`]).
    pub slip: T,
    /// State variables of the law at the start of the step; empty if it has none.
    pub memory: &'a [f64],
}

impl<T: Real> Contact<'_, T> {
    /// Create a contact of bodies 0 and 1, at the origin, without gap, area or memory.
    pub fn new(normal: [T; 3], masses: [T; 2], velocities: [[T; 3]; 2], dt: T) -> Self {
        let (bodies, position, time) = ([0, 1], [0.0; 3], 0.0);
        let (gap, area, slip, memory) = (None, T::of(0.0), T::of(0.0), &[][..]);
        Contact { bodies, position, time, dt, normal, gap, area, masses, velocities, slip, memory }
    }
    /// Trial velocity of the first body relative to the second, m/s.
    pub fn relative_velocity(&self) -> [T; 3] {
        difference(self.velocities[0], self.velocities[1])
    }
    /// Approach velocity along the normal, m/s; negative at separation.
    pub fn approach(&self) -> T {
        dot(self.relative_velocity(), self.normal)
    }
    /// Reduced mass m_r m_s / (m_r + m_s), kg, also for an infinite mass.
    pub fn reduced_mass(&self) -> T {
        let (one, [r, s]): (T, _) = (T::of(1.0), self.masses);
        one / (one / r + one / s)
    }
    /// Impulse that reduces the approach velocity by `approach` along the normal, and the slip velocity by at most `limit`, both in m/s:
    /// for friction mu, `limit` is mu times `approach`.
    pub fn braking(&self, approach: T, limit: T) -> [T; 3] {
        let (normal, relative) = (self.normal, self.relative_velocity());
        let slip = difference(relative, times(normal, dot(relative, normal)));
        let speed = length(slip);
        let share = if speed > limit { limit / speed } else { T::of(1.0) };
        times(sum(times(normal, approach), times(slip, share)), self.reduced_mass())
    }
}

/// Result of a step for a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome<T> {
    /// Impulse on the second body, N s; zero for contact without pressure.
    pub impulse: [T; 3],
    /// Slip increment of the first body along the second, m: its tangential relative velocity at the end of the step, times the step.
    pub slid: [T; 3],
}

/// Memory of a law for a contact from step to step: numbers that are zero when contact begins, last as long as contact, and are lost at
/// separation. They are part of checkpoints, and bitwise equal for any number of threads.
///
/// *On a grid contacts are at nodes, and bodies move through them.* The memory of a node for a pair of bodies lasts while the detector
/// finds contact there, with or without pressure (a detector of gaps: to within the thousandth of a cell by which it looks ahead, so that
/// rattling does not clear it). It is advected with the mean of both velocities, from node to nearest node. A node with new contact takes
/// the mean of the nearest nodes, among its 3^D - 1 neighbours, that were in contact one step before; if there are none, it begins with
/// zeros. Memory therefore follows a patch through the grid, whichever body moves: exactly if it is uniform over the patch, like the slip
/// of a block; a pattern along it to within half a cell, if it is wider than some cells and the bodies do not rotate. The memory is that of
/// the contact, not of a surface: if bodies slide by much more than a cell, a pattern belongs to neither of them. A growing patch passes
/// the memory of its rim on to new nodes, since growth cannot be distinguished from motion. Vector components are not rotated with the
/// bodies. Deactivated bodies lose their memory.
///
/// The crate `pcmm` keeps no memory, and refuses laws with memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Remembers {
    /// No memory, at no cost.
    #[default]
    Nothing,
    /// Slip: [`Contact::slip`].
    Slip,
    /// Slip, [`Contact::slip`], and this number of state variables, [`Contact::memory`].
    SlipAnd(usize),
}

impl Remembers {
    /// Number of remembered values, slip included.
    #[must_use]
    pub fn numbers(self) -> usize {
        match self {
            Remembers::Nothing => 0,
            Remembers::Slip => 1,
            Remembers::SlipAnd(own) => 1 + own,
        }
    }
}

/// Contact law: the impulse between two bodies in contact, from their present state and, for laws with memory, from their history.
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
/// Custom law: friction that decreases with the work it does.
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
    /// True if the law resists separation.
    fn pulls(&self) -> bool {
        false
    }
    /// True if the law stores energy, and returns it at separation. All other laws at best conserve energy.
    fn springs(&self) -> bool {
        false
    }
    /// True if the law needs [`Contact::area`].
    fn needs_area(&self) -> bool {
        false
    }
    /// Memory of the law for a contact.
    fn remembers(&self) -> Remembers {
        Remembers::Nothing
    }
    /// Compute the impulse on the second body, N s; the first receives its opposite. For coupled pairs it is called many times a step, with
    /// the same memory. Exchange of the bodies with a reversed normal must reverse the impulse.
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3];
    /// Compute the impulse of a bond that holds at its strength instead of breaking, N s; `None` for a law without a strength. Contacts
    /// that share a load are solved with it first: those beyond their strength pass the rest on, and break where none is left to take it.
    fn at_strength(&self, _contact: &Contact<'_, T>) -> Option<[T; 3]> {
        None
    }
    /// Update the state variables to the end of the step, once a step while the bodies are in contact, with or without pressure: `memory`
    /// is [`Contact::memory`] at first. The slip is updated without this.
    fn advance(&self, _contact: &Contact<'_, T>, _outcome: &Outcome<T>, _memory: &mut [f64]) {}
}

/// Contact laws of all pairs of bodies: a default, and exceptions.
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
    /// Create with one law for all pairs.
    pub fn new(law: impl ContactLaw<T>) -> Self {
        Pairs { default: Arc::new(law), table: Vec::new() }
    }
    /// Set another law between two bodies, by number in the order of addition to the scene, from 0.
    #[must_use]
    pub fn with(mut self, one: usize, other: usize, law: impl ContactLaw<T>) -> Self {
        let bodies = [one.min(other), one.max(other)];
        self.table.retain(|entry| entry.0 != bodies);
        self.table.push((bodies, Arc::new(law)));
        self
    }
    /// Contact law between two bodies.
    pub fn law(&self, one: usize, other: usize) -> &dyn ContactLaw<T> {
        let bodies = [one.min(other), one.max(other)];
        let found = self.table.iter().find(|entry| entry.0 == bodies);
        found.map_or(self.default.as_ref(), |entry| entry.1.as_ref())
    }
    /// Number of values that a contact keeps from step to step, for the law with most of them: [`Remembers::numbers`].
    pub fn remembered_numbers(&self) -> usize {
        let all = self.table.iter().map(|entry| &entry.1).chain([&self.default]);
        all.map(|law| law.remembers().numbers()).max().unwrap_or(0)
    }
}
