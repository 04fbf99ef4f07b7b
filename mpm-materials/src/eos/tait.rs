//! Tait equation of state for liquids.

use crate::eos::{Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Nothing;

/// Tait pressure p = (rho0 c0^2 / 7) \[(rho/rho0)^7 - 1\] (book, "Other equations of state"), with c^2 = c0^2
/// (rho/rho0)^6. The exponent is fixed at 7, so that no transcendental function is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tait<T> {
    density: T,
    sound_speed: T,
}

impl<T: Real> Tait<T> {
    /// Name of the law.
    pub(crate) const NAME: &'static str = "Tait";
    /// Create from reference density, kg/m^3, and sound speed at rest c0, m/s; for weakly compressible flow choose c0
    /// at least ten times the largest speed.
    ///
    /// # Errors
    /// A value that is not positive.
    pub fn new(density: T, sound_speed: T) -> Result<Self, ParameterError> {
        let check = Check("Tait");
        Ok(Tait {
            density: check.positive("density rho0", density)?,
            sound_speed: check.positive("sound speed c0", sound_speed)?,
        })
    }
    /// Create from checked constants.
    pub(crate) fn known(density: f64, sound_speed: f64) -> Self {
        Tait { density: T::of(density), sound_speed: T::of(sound_speed) }
    }
    fn stiffness(&self) -> T {
        self.density * self.sound_speed * self.sound_speed / T::of(7.0)
    }
}

/// Compute (1/J)^6.
#[inline(always)]
fn sixth_power_of_density<L: Lane>(volume_ratio: L) -> L {
    let x = volume_ratio.recip();
    let cube = x * x * x;
    cube * cube
}

impl<T: Real> Eos<T> for Tait<T> {
    type Energy<L: Lane<Real = T>> = Nothing;

    fn name(&self) -> &'static str {
        Self::NAME
    }
    fn density(&self) -> T {
        self.density
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let seventh = sixth_power_of_density(volume_ratio) * volume_ratio.recip();
        Terms { cold: L::splat(self.stiffness()) * (seventh - L::one()), thermal: L::zero() }
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, _: L) -> L {
        L::splat(self.sound_speed * self.sound_speed) * sixth_power_of_density(volume_ratio)
    }
    /// Stored energy (rho0 c0^2 / 7) \[J^-6 / 6 + J - 7/6\].
    #[inline(always)]
    fn stored_energy<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        let sixth = sixth_power_of_density(volume_ratio) * L::of(1.0 / 6.0);
        L::splat(self.stiffness()) * (sixth + volume_ratio - L::of(7.0 / 6.0))
    }
}
