//! Pressure linear in the logarithmic volume strain.

use crate::eos::{Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Nothing;

/// Logarithmic equation of state p = -K ln J with constant bulk modulus K: the volumetric part of Hooke's law in
/// logarithmic strain, as most finite-element programs integrate it. c^2 = K J / rho0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogarithmicBulk<T> {
    density: T,
    modulus: T,
}

impl<T: Real> LogarithmicBulk<T> {
    /// Create from reference density, kg/m^3, and bulk modulus K, Pa.
    ///
    /// # Errors
    /// A value that is not positive.
    pub fn new(density: T, modulus: T) -> Result<Self, ParameterError> {
        let check = Check("logarithmic bulk modulus");
        Ok(LogarithmicBulk {
            density: check.positive("density rho0", density)?,
            modulus: check.positive("bulk modulus K", modulus)?,
        })
    }
}

impl<T: Real> LogarithmicBulk<T> {
    /// Create from checked constants.
    pub(crate) fn known(density: f64, modulus: f64) -> Self {
        LogarithmicBulk { density: T::of(density), modulus: T::of(modulus) }
    }
}

impl<T: Real> Eos<T> for LogarithmicBulk<T> {
    type Energy<L: Lane<Real = T>> = Nothing;

    fn name(&self) -> &'static str {
        "logarithmic bulk modulus"
    }
    fn density(&self) -> T {
        self.density
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        Terms { cold: -(L::splat(self.modulus) * volume_ratio.ln()), thermal: L::zero() }
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, _: L) -> L {
        L::splat(self.modulus / self.density) * volume_ratio
    }
    /// Stored energy K (J ln J - J + 1).
    #[inline(always)]
    fn stored_energy<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        L::splat(self.modulus) * (volume_ratio * volume_ratio.ln() - volume_ratio + L::one())
    }
}
