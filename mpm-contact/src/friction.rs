//! Friction laws.

use mpm_materials::{Check, ParameterError, Real};

use crate::law::{Contact, ContactLaw, Remembers};
use crate::vector::times;

/// Frictionless contact: J = \[(m_s p_r - m_r p_s) . n / (m_r + m_s)\] n if positive (eq. 11 of \[Zhang2017\]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frictionless;
impl<T: Real> ContactLaw<T> for Frictionless {
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3] {
        times(contact.normal, contact.reduced_mass() * contact.approach().max(T::of(0.0)))
    }
}

/// Coulomb friction: the tangential impulse stops the slip unless that takes more than mu times the normal impulse. Both are impulses of
/// the whole step, the impulsive part of closing included; the original (13) - (15) of \[Ma2010\] exclude it from the limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coulomb<T> {
    friction: T,
}
impl<T: Real> Coulomb<T> {
    /// Create from the friction coefficient mu.
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
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3] {
        rub(contact, self.friction)
    }
}

/// Coulomb impulse: stop the approach, and the slip as far as this friction coefficient permits.
fn rub<T: Real>(contact: &Contact<'_, T>, friction: T) -> [T; 3] {
    let approach = contact.approach();
    if approach > T::of(0.0) { contact.braking(approach, friction * approach) } else { [T::of(0.0); 3] }
}

/// Slip-weakening friction: the coefficient falls from static to kinetic over the critical slip distance d_c: mu(s) = mu_s - (mu_s - mu_k)
/// min(s / d_c, 1) \[Ida1972\], \[Andrews1976\].
///
/// A contact sticks until the tangential impulse exceeds mu_s times the normal one, then weakens; it heals only where the bodies separate.
/// Under a normal traction sigma_n the weakening dissipates (mu_s - mu_k) sigma_n d_c / 2 per area in addition to kinetic friction.
///
/// The law remembers the slip ([`Remembers::Slip`]) and uses its value at the start of the step: of second order in the step, which should
/// be short beside 1 / lambda, lambda^2 = (mu_s - mu_k) N / (m d_c), the growth rate of unstable slip of a mass m under the normal force N.
/// Where slip nucleates along a surface of soft bodies, the weakening zone is about G d_c / \[(mu_s - mu_k) sigma_n\] wide (G the shear
/// modulus); cells must be smaller. On a grid the slip follows a sliding patch, and a growing patch passes its slip on to new nodes
/// ([`Remembers`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipWeakening<T> {
    at_rest: T,
    sliding: T,
    distance: T,
}
impl<T: Real> SlipWeakening<T> {
    /// Create from the static coefficient mu_s, the kinetic coefficient mu_k and the critical slip distance d_c, m.
    ///
    /// # Errors
    /// A kinetic coefficient that is negative, a static one below it, a distance that is not positive; numbers that are not finite.
    pub fn new(at_rest: T, sliding: T, distance: T) -> Result<Self, ParameterError> {
        let check = Check("slip weakening");
        let sliding =
            check.that(sliding >= T::of(0.0), "kinetic coefficient mu_k", sliding, "not negative")?;
        let falls = at_rest >= sliding;
        let at_rest =
            check.that(falls, "static coefficient mu_s", at_rest, "no less than the kinetic one")?;
        let distance = check.positive("critical slip distance d_c", distance)?;
        Ok(SlipWeakening { at_rest, sliding, distance })
    }
    /// Friction coefficient after the slip s, m.
    pub fn coefficient(&self, slip: T) -> T {
        self.at_rest - (self.at_rest - self.sliding) * (slip / self.distance).min(T::of(1.0))
    }
}
impl<T: Real> ContactLaw<T> for SlipWeakening<T> {
    fn remembers(&self) -> Remembers {
        Remembers::Slip
    }
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3] {
        rub(contact, self.coefficient(contact.slip))
    }
}
