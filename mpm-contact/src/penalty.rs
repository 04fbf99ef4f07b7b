//! Bodies that push each other apart by springs.

use mpm_materials::{Check, ParameterError, Real};

use crate::friction::Coulomb;
use crate::law::{Contact, ContactLaw};

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
    friction: T,
    /// Where no gap is measured.
    ungauged: Coulomb<T>,
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
            friction,
            ungauged: Coulomb::new(friction)?,
        })
    }
}
impl<T: Real> ContactLaw<T> for Penalty<T> {
    fn springs(&self) -> bool {
        true
    }
    fn impulse(&self, contact: &Contact<'_, T>) -> [T; 3] {
        let Some(gap) = contact.gap else {
            return self.ungauged.impulse(contact);
        };
        let (zero, one) = (T::of(0.0), T::of(1.0));
        if gap >= zero {
            return [zero; 3];
        }
        let closing = contact.approach().max(zero);
        let frequency = self.frequency.min(self.restitution / contact.dt);
        let stiffer = one / (self.restitution * self.restitution) - one;
        let pressed = -gap + stiffer * (closing / frequency).min(-gap);
        let push = frequency * frequency * pressed * contact.dt;
        contact.braking(push, self.friction * push)
    }
}
