//! What two bodies do to each other where they touch.

use std::sync::Arc;

use mpm_materials::{Check, ParameterError, Real};

use crate::vector::{difference, dot, length, sum, times};

/// Two bodies that touch: at a node of the grid, or as a pair of particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T> {
    /// Unit normal, from the first body to the second.
    pub normal: [T; 3],
    /// Distance of the surfaces along it, m, where it is measured; negative if they overlap.
    pub gap: Option<T>,
    /// Area that the contact stands for, m^2; zero if the law does not ask ([`ContactLaw::needs_area`]).
    pub area: T,
}

/// A law of contact, without memory.
///
/// ```
/// use mpm_contact::{Contact, ContactLaw, Coulomb};
/// let law = Coulomb::new(0.5)?;
/// let contact = Contact { normal: [1.0, 0.0, 0.0], gap: None, area: 0.0 };
/// // The first body, 1 kg, runs into the second, 3 kg, at 2 m/s, and slides along it at 9 m/s.
/// let impulse = law.impulse(&contact, [1.0, 3.0], [[2.0, 9.0, 0.0], [0.0; 3]], 1.0e-3);
/// assert_eq!(impulse, [1.5, 0.75, 0.0]);
/// # Ok::<(), mpm_materials::ParameterError>(())
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
    /// Impulse on the second body, N s; the first gets its opposite. From the masses, kg (infinite for a body
    /// of prescribed motion), and the trial velocities, m/s, of two bodies that touch: those they would have
    /// after `dt` seconds without contact. Exchanging the bodies and turning the normal must turn the impulse.
    fn impulse(&self, contact: &Contact<T>, masses: [T; 2], velocities: [[T; 3]; 2], dt: T) -> [T; 3];
}

/// m_r m_s / (m_r + m_s), which also holds for an infinite mass.
fn reduced<T: Real>([r, s]: [T; 2]) -> T {
    let one: T = T::of(1.0);
    one / (one / r + one / s)
}

/// Bodies that push along the normal and slide freely:
/// J = \[(m_s p_r - m_r p_s) . n / (m_r + m_s)\] n if positive (eq. 11 of \[Zhang2017\]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frictionless;
impl<T: Real> ContactLaw<T> for Frictionless {
    fn impulse(&self, contact: &Contact<T>, masses: [T; 2], [r, s]: [[T; 3]; 2], _dt: T) -> [T; 3] {
        let approach = dot(difference(r, s), contact.normal);
        times(contact.normal, reduced(masses) * approach.max(T::of(0.0)))
    }
}

/// Coulomb friction: the tangential impulse stops the slip unless that takes more than mu times the normal one.
/// Both are those of the whole step, the impulsive part of closing included; printed (13) - (15) of \[Ma2010\]
/// leave that out of the limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<T> {
    friction: T,
}
impl<T: Real> Coulomb<T> {
    /// Friction coefficient mu.
    ///
    /// # Errors
    /// A coefficient that is negative or not finite.
    pub fn new(friction: T) -> Result<Self, ParameterError> {
        let friction = Check("Coulomb friction").that(
            friction >= T::of(0.0),
            "coefficient mu",
            friction,
            "not negative",
        )?;
        Ok(Coulomb { friction })
    }
}
impl<T: Real> ContactLaw<T> for Coulomb<T> {
    fn impulse(&self, contact: &Contact<T>, masses: [T; 2], [r, s]: [[T; 3]; 2], _dt: T) -> [T; 3] {
        let relative = difference(r, s);
        let approach = dot(relative, contact.normal);
        if approach > T::of(0.0) {
            slide(contact.normal, relative, approach, self.friction * approach, reduced(masses))
        } else {
            [T::of(0.0); 3]
        }
    }
}

/// `mass` times `approach` along the normal and at most `limit` against the slip.
fn slide<T: Real>(normal: [T; 3], relative: [T; 3], approach: T, limit: T, mass: T) -> [T; 3] {
    let slip = difference(relative, times(normal, dot(relative, normal)));
    let speed = length(slip);
    let share = if speed > limit { limit / speed } else { T::of(1.0) };
    times(sum(times(normal, approach), times(slip, share)), mass)
}

/// Penalty: surfaces that overlap by delta push each other apart as a spring on the masses m of the contact would,
/// J_n = m omega^2 \[delta + (1/e^2 - 1) min(delta, v_n / omega)\] dt, v_n the closing velocity where they close: a spring that
/// is stiffer while it is pressed, so that a part 1 - e^2 of the energy is lost. With Coulomb friction.
///
/// A node that only stops what closes loses what its mass brings along, once for every node that comes into contact: discs
/// of 8 cells lose a tenth of their energy in an impact. A spring gives it back. In return surfaces overlap by
/// about v_n / omega, and a joint passes a wave on later, by 2 / omega. What omega should be is a number of c / h, c the wave speed, m/s,
/// and h the cell, m ([`Penalty::of_cells`]): 0.9 with e = 0.8 is a fair choice, and e = 0.9 may gain a per cent
/// (book, "Contact laws against the cases"). For bodies that collide; for bodies that roll, and joints under load,
/// [`Coulomb`] is better.
///
/// What the spring holds is in no body's energy: a sixth of that of discs of 8 cells while they are pressed together.
///
/// Needs a detector that measures gaps, best along normals of the [`crate::SeparatingPlane`]: along gradients of mass overlaps may be
/// cells off at the rim of a contact. Where none is measured it acts as [`Coulomb`]. In steps longer than e / omega the
/// spring is one of e / dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty<T> {
    frequency: T,
    restitution: T,
    friction: Coulomb<T>,
}
impl<T: Real> Penalty<T> {
    /// `number` times c / h as the frequency, for the wave speed c of the bodies, m/s, and cells of h, m; else as of [`Penalty::new`].
    ///
    /// # Errors
    /// A number outside 0.1 to 2: softer springs let bodies through each other; a wave speed or cell that is not positive; else as of
    /// [`Penalty::new`].
    pub fn of_cells(
        number: T,
        [wave_speed, spacing]: [T; 2],
        restitution: T,
        friction: T,
    ) -> Result<Self, ParameterError> {
        let check = Check("penalty contact");
        let allowed = (T::of(0.1)..=T::of(2.0)).contains(&number);
        let number = check.that(allowed, "frequency over c / h", number, "0.1 to 2")?;
        let wave_speed = check.positive("wave speed", wave_speed)?;
        let frequency = number * wave_speed / check.positive("spacing", spacing)?;
        Self::new(frequency, restitution, friction)
    }
    /// Angular frequency omega, rad/s (not a number of c / h: [`Penalty::of_cells`]), restitution e of two masses that meet, and coefficient of friction.
    ///
    /// # Errors
    /// A frequency that is not positive, a restitution not in 0.1 to 1, a coefficient that is negative.
    pub fn new(frequency: T, restitution: T, friction: T) -> Result<Self, ParameterError> {
        let check = Check("penalty contact");
        let allowed = (T::of(0.1)..=T::of(1.0)).contains(&restitution);
        Ok(Penalty {
            frequency: check.positive("frequency omega", frequency)?,
            restitution: check.that(allowed, "restitution e", restitution, "0.1 to 1")?,
            friction: Coulomb::new(friction)?,
        })
    }
}
impl<T: Real> ContactLaw<T> for Penalty<T> {
    fn springs(&self) -> bool {
        true
    }
    fn impulse(&self, contact: &Contact<T>, masses: [T; 2], [r, s]: [[T; 3]; 2], dt: T) -> [T; 3] {
        let Some(gap) = contact.gap else {
            return self.friction.impulse(contact, masses, [r, s], dt);
        };
        let (zero, one) = (T::of(0.0), T::of(1.0));
        if gap >= zero {
            return [zero; 3];
        }
        let relative = difference(r, s);
        let closing = dot(relative, contact.normal).max(zero);
        let frequency = self.frequency.min(self.restitution / dt);
        let stiffer = one / (self.restitution * self.restitution) - one;
        let pressed = -gap + stiffer * (closing / frequency).min(-gap);
        let push = frequency * frequency * pressed * dt;
        slide(contact.normal, relative, push, self.friction.friction * push, reduced(masses))
    }
}

/// Bodies that are glued: one velocity where they meet, pulled or pushed, at every node where the detector says they
/// touch: with [`crate::Approach`] that is what one velocity field does. A distance test with the threshold zero
/// lets go as soon as a gap opens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stick;
impl<T: Real> ContactLaw<T> for Stick {
    fn pulls(&self) -> bool {
        true
    }
    fn impulse(&self, _contact: &Contact<T>, masses: [T; 2], [r, s]: [[T; 3]; 2], _dt: T) -> [T; 3] {
        times(difference(r, s), reduced(masses))
    }
}

/// Bodies that stick up to a strength: glued while the traction stays below, (t_n / strength)^2 +
/// (t_t / shear strength)^2 <= 1 (only t_t counts in compression); beyond it, Coulomb friction. Without memory:
/// surfaces that touch again stick again. As with [`Stick`], the detector must see a touch where a small
/// gap opens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adhesion<T> {
    strength: T,
    shear: T,
    beyond: Coulomb<T>,
}
impl<T: Real> Adhesion<T> {
    /// Tensile and shear strength, Pa, and the friction coefficient once they are passed.
    ///
    /// # Errors
    /// A strength that is not positive, a coefficient that is negative.
    pub fn new(strength: T, shear: T, friction: T) -> Result<Self, ParameterError> {
        let check = Check("adhesion");
        Ok(Adhesion {
            strength: check.positive("tensile strength", strength)?,
            shear: check.positive("shear strength", shear)?,
            beyond: Coulomb::new(friction)?,
        })
    }
}
impl<T: Real> ContactLaw<T> for Adhesion<T> {
    fn pulls(&self) -> bool {
        true
    }
    fn needs_area(&self) -> bool {
        true
    }
    fn impulse(&self, contact: &Contact<T>, masses: [T; 2], velocities: [[T; 3]; 2], dt: T) -> [T; 3] {
        let glued = Stick.impulse(contact, masses, velocities, dt);
        let along = dot(glued, contact.normal);
        let across = length(difference(glued, times(contact.normal, along)));
        let pull = (-along).max(T::of(0.0));
        // t / strength <= 1 times area and step, so that an area of zero holds nothing.
        let (a, b) = (pull * self.shear, across * self.strength);
        let capacity = self.strength * self.shear * contact.area * dt;
        if a * a + b * b <= capacity * capacity {
            glued
        } else {
            self.beyond.impulse(contact, masses, velocities, dt)
        }
    }
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
}
