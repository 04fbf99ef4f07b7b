//! Penalty contact.

use mpm_materials::{Check, ParameterError, Real};

use crate::friction::Coulomb;
use crate::law::{Contact, ContactLaw};

/// Penalty law: surfaces that overlap by delta repel each other like a spring on the masses m of the contact, J_n = m omega^2 \[delta +
/// (1/e^2 - 1) min(delta, v_n / omega)\] dt, with the approach velocity v_n: the spring is stiffer in compression, so that a part 1 - e^2
/// of the energy is lost. With Coulomb friction.
///
/// Inelastic contact dissipates the kinetic energy of every node that comes into contact: discs of 8 cells lose a tenth of their energy in
/// an impact. A spring returns it. In exchange surfaces overlap by about v_n / omega, and a joint delays waves by 2 / omega. omega should
/// be a number times c / h, c the wave speed, m/s, and h the cell, m ([`Penalty::of_cells`]): 0.9 with e = 0.8 is a fair choice, and e =
/// 0.9 may gain a per cent (book, "Contact laws against the cases"). The law suits bodies that collide; for bodies that roll, and joints
/// under load, [`Coulomb`] is better.
///
/// Spring energy is not part of any body's energy: a sixth of that of discs of 8 cells while they are pressed together.
///
/// The law needs a detector that measures gaps, best along normals of the [`crate::SeparatingPlane`]: along gradients of mass, overlaps may
/// be cells off at the rim of a contact. Without a gap it acts as [`Coulomb`]. In steps longer than e / omega the spring has the frequency
/// e / dt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penalty<T> {
    frequency: T,
    restitution: T,
    friction: T,
    /// Law for contacts without a measured gap.
    ungauged: Coulomb<T>,
}
impl<T: Real> Penalty<T> {
    /// Create with `number` times c / h as the frequency, for the wave speed c of the bodies, m/s, and cells of h, m; the rest as for
    /// [`Penalty::new`].
    ///
    /// # Errors
    /// A number outside 0.1 to 2, because softer springs let bodies pass through each other; a wave speed or cell that is not positive;
    /// errors of [`Penalty::new`].
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
    /// Create from the angular frequency omega, rad/s (not a number of c / h: [`Penalty::of_cells`]), the restitution e of two colliding
    /// masses, and the friction coefficient.
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
