//! Adhesive contact laws.

use mpm_materials::{Check, ParameterError, Real};

use crate::friction::Coulomb;
use crate::law::{Contact, ContactLaw};
use crate::vector::{difference, dot, length, sum, times};

/// Perfect adhesion: one velocity at the contact, in tension and compression, at every node where the detector finds contact; with
/// [`crate::Approach`] this is a single velocity field. On a grid a distance test finds contact up to a quarter of a cell beyond its
/// threshold for laws that pull: bodies whose faces coincide at the start stick, and a strained joint does not separate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stick;
impl<T: Real> ContactLaw<T> for Stick {
    fn pulls(&self) -> bool {
        true
    }
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3] {
        times(contact.relative_velocity(), contact.reduced_mass())
    }
}

/// Adhesion up to a strength: perfect while the traction satisfies (t_n / strength)^2 + (t_t / shear strength)^2 <= 1 (only t_t counts in
/// compression); beyond it, Coulomb friction. Without memory: surfaces that touch again stick again. As with [`Stick`], bodies stick from
/// the start where their faces coincide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adhesion<T> {
    strength: T,
    shear: T,
    beyond: Coulomb<T>,
}
impl<T: Real> Adhesion<T> {
    /// Create from tensile and shear strength, Pa, and the friction coefficient after failure.
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
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3] {
        let (glued, load) = self.load(contact);
        if load <= T::of(1.0) { glued } else { self.beyond.impulse(contact) }
    }
    fn at_strength(&self, contact: &Contact<'_, T>) -> Option<[T; 3]> {
        let (glued, load) = self.load(contact);
        if load <= T::of(1.0) {
            return Some(glued);
        }
        let along = dot(glued, contact.normal);
        // Compression has no limit.
        let pressed = times(contact.normal, along.max(T::of(0.0)));
        Some(sum(pressed, times(difference(glued, pressed), T::of(1.0) / load)))
    }
}
impl<T: Real> Adhesion<T> {
    /// Impulse of perfect adhesion, N s, and its traction over the strength, 0 where that is at most 1.
    fn load(&self, contact: &Contact<'_, T>) -> ([T; 3], T) {
        let glued = Stick.impulse(contact);
        let along = dot(glued, contact.normal);
        let across = length(difference(glued, times(contact.normal, along)));
        let pull = (-along).max(T::of(0.0));
        let (a, b) = (pull * self.shear, across * self.strength);
        let capacity = self.strength * self.shear * contact.area * contact.dt;
        let square = a * a + b * b;
        // Without area there is no strength.
        let load = if square <= capacity * capacity { T::of(0.0) } else { square.sqrt() / capacity };
        (glued, load)
    }
}
