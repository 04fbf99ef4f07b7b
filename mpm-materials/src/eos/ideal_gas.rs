//! Ideal gas.

use crate::eos::{Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Ideal gas with constant heat capacities: p = (gamma - 1) rho e_m = (gamma - 1) e / J, with e_m the internal
/// energy per mass and e per reference volume; c^2 = gamma p / rho (book, "Other equations of state").
///
/// The virgin state is not free of stress: it carries the initial pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealGas<T> {
    density: T,
    gamma: T,
    initial_pressure: T,
}

impl<T: Real> IdealGas<T> {
    /// Create from reference density, kg/m^3, ratio of heat capacities gamma and pressure at reference density, Pa.
    ///
    /// # Errors
    /// Density not positive, gamma not above 1, pressure negative.
    pub fn new(density: T, gamma: T, initial_pressure: T) -> Result<Self, ParameterError> {
        let check = Check("ideal gas");
        Ok(IdealGas {
            density: check.positive("density rho0", density)?,
            gamma: check.that(gamma > T::of(1.0), "gamma", gamma, "above 1")?,
            initial_pressure: check.not_negative("initial pressure", initial_pressure)?,
        })
    }

    /// Air at 15 degrees Celsius: 1.225 kg/m^3, gamma 1.4, 101325 Pa (standard atmosphere).
    pub fn air() -> Self {
        IdealGas { density: T::of(1.225), gamma: T::of(1.4), initial_pressure: T::of(101_325.0) }
    }
}

impl<T: Real> Eos<T> for IdealGas<T> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        "ideal gas"
    }
    fn density(&self) -> T {
        self.density
    }
    /// Initial energy e0 = p0 / (gamma - 1).
    fn initial_energy(&self) -> T {
        self.initial_pressure / (self.gamma - T::of(1.0))
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        Terms { cold: L::zero(), thermal: L::splat(self.gamma - T::of(1.0)) / volume_ratio }
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, _: L, energy: L) -> L {
        // gamma p J / rho0 with p J = (gamma - 1) e
        L::splat(self.gamma * (self.gamma - T::of(1.0)) / self.density) * energy
    }
}
