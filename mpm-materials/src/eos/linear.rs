//! Pressure linear in the density.

use crate::eos::{Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Nothing;

/// Linear equation of state p = c0^2 (rho - rho0) = rho0 c0^2 (1/J - 1) with constant sound speed c0 (book, "Other
/// equations of state"). For weakly compressible flow use c0 of at least ten times the largest speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearDensity<T> {
    density: T,
    sound_speed: T,
}

impl<T: Real> LinearDensity<T> {
    /// Create from reference density, kg/m^3, and sound speed c0, m/s.
    ///
    /// # Errors
    /// A value that is not positive.
    pub fn new(density: T, sound_speed: T) -> Result<Self, ParameterError> {
        let check = Check("linear equation of state");
        Ok(LinearDensity {
            density: check.positive("density rho0", density)?,
            sound_speed: check.positive("sound speed c0", sound_speed)?,
        })
    }
    fn bulk_modulus(&self) -> T {
        self.density * self.sound_speed * self.sound_speed
    }
}

impl<T: Real> Eos<T> for LinearDensity<T> {
    type Energy<L: Lane<Real = T>> = Nothing;

    fn name(&self) -> &'static str {
        "linear equation of state"
    }
    fn density(&self) -> T {
        self.density
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let cold = L::splat(self.bulk_modulus()) * (volume_ratio.recip() - L::one());
        Terms { cold, thermal: L::zero() }
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, _: L, _: L) -> L {
        L::splat(self.sound_speed * self.sound_speed)
    }
    /// Stored energy rho0 c0^2 (J - 1 - ln J).
    #[inline(always)]
    fn stored_energy<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        L::splat(self.bulk_modulus()) * (volume_ratio - L::one() - volume_ratio.ln())
    }
}
