//! Polynomial equation of state.

use crate::eos::{Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Polynomial pressure p = C0 + C1 mu + C2 mu^2 + C3 mu^3 + (C4 + C5 mu + C6 mu^2) e with mu = 1/J - 1; in expansion,
/// mu < 0, the terms of C2 and C6 are left out (the linear polynomial of the LS-DYNA manual \[M\], book, "Detonation
/// and JWL").
///
/// Ideal gas: C4 = C5 = gamma - 1; liquid: C1 = rho0 c0^2. Limits: defined for every J > 0, but with a negative
/// coefficient among C1 to C6 the pressure may decrease with the density far from the fit; this is not checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial<T> {
    density: T,
    cold: [T; 4],
    thermal: [T; 3],
    initial_energy: T,
}

impl<T: Real> Polynomial<T> {
    /// Create from reference density, kg/m^3, C0 to C3, Pa, C4 to C6, dimensionless, and the energy e0 of the virgin
    /// state, J/m^3.
    ///
    /// # Errors
    /// Density not positive, a coefficient not finite, e0 negative, or a virgin state without sound speed.
    pub fn new(density: T, cold: [T; 4], thermal: [T; 3], initial_energy: T) -> Result<Self, ParameterError> {
        let check = Check("polynomial equation of state");
        check.positive("density rho0", density)?;
        for (name, value) in ["C0", "C1", "C2", "C3"].into_iter().zip(cold) {
            check.that(true, name, value, "finite")?;
        }
        for (name, value) in ["C4", "C5", "C6"].into_iter().zip(thermal) {
            check.that(true, name, value, "finite")?;
        }
        check.not_negative("initial energy e0", initial_energy)?;
        let law = Polynomial { density, cold, thermal, initial_energy };
        let squared: T = law.speed_squared(T::Single::one(), T::Single::splat(initial_energy)).into();
        check.positive("squared sound speed of the virgin state", squared)?;
        Ok(law)
    }
}

impl<T: Real> Eos<T> for Polynomial<T> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        "polynomial equation of state"
    }
    fn density(&self) -> T {
        self.density
    }
    fn initial_energy(&self) -> T {
        self.initial_energy
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let mu = volume_ratio.recip() - L::one();
        let closed = mu.max(L::zero());
        let [c0, c1, c2, c3] = self.cold;
        let [c4, c5, c6] = self.thermal;
        let cubic = mu.mul_add(mu * mu * L::splat(c3), closed * closed * L::splat(c2));
        let cold = mu.mul_add(L::splat(c1), L::splat(c0)) + cubic;
        let thermal = mu.mul_add(L::splat(c5), L::splat(c4)) + closed * closed * L::splat(c6);
        Terms { cold, thermal }
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let mu = volume_ratio.recip() - L::one();
        let twice = mu.max(L::zero()) * L::of(2.0);
        let [_, c1, c2, c3] = self.cold;
        let [_, c5, c6] = self.thermal;
        let cold_slope = L::splat(c1) + twice * L::splat(c2) + mu * mu * L::splat(c3 * T::of(3.0));
        let thermal_slope = L::splat(c5) + twice * L::splat(c6);
        let Terms { cold, thermal } = self.terms(volume_ratio);
        let pressure = thermal.mul_add(energy, cold);
        let slope = cold_slope + thermal_slope * energy + pressure * volume_ratio * volume_ratio * thermal;
        slope * L::splat(T::of(1.0) / self.density)
    }
}
