//! Mie-Grueneisen equation of state for strong expansion.

use crate::eos::{Eos, MieGruneisen, Terms};
use crate::lane::{Lane, Real};

/// Mie-Grueneisen law with constant gamma, instead of constant rho gamma, in expansion: for J > 1
///
/// p = K mu + gamma0 (1 + mu) e, mu = 1/J - 1,
///
/// and the law itself for J <= 1; p is continuous. [`MieGruneisen::constant_gamma`] has the same expansion, but its
/// formula ends at (gamma0 + 2)/gamma0 times the density, which strong shocks exceed.
///
/// With constant rho gamma the thermal pressure gamma0 e of a hot cloud does not decrease in a hundredfold expansion;
/// in such a state a step that compresses it by a hundredth (dJ < -1) has no solution either. The tension K mu tends to
/// -K: a failure criterion must act before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expanding<T> {
    law: MieGruneisen<T>,
}

impl<T: Real> Expanding<T> {
    /// Create from the law in compression.
    pub fn new(law: MieGruneisen<T>) -> Self {
        Expanding { law }
    }
    /// Law in compression.
    pub fn law(&self) -> &MieGruneisen<T> {
        &self.law
    }
}

impl<T: Real> Eos<T> for Expanding<T> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        "Mie-Grueneisen, expanding"
    }
    fn density(&self) -> T {
        Eos::<T>::density(&self.law)
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let Terms { cold, thermal } = self.law.terms(volume_ratio);
        let thin = L::splat(self.law.gruneisen()) * volume_ratio.recip();
        // In tension the cold pressure of the law is K mu for any correction.
        Terms { cold, thermal: L::select(volume_ratio.gt(L::one()), thin, thermal) }
    }
    /// Squared sound speed for J > 1: \[K + gamma0 e + p J gamma0\]/rho0.
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let gamma = L::splat(self.law.gruneisen());
        let pressure = self.pressure(volume_ratio, energy);
        let modulus = L::splat(self.law.bulk_modulus()) + gamma * (energy + pressure * volume_ratio);
        let thin = modulus * L::splat(T::of(1.0) / Eos::<T>::density(&self.law));
        L::select(volume_ratio.gt(L::one()), thin, self.law.speed_squared(volume_ratio, energy))
    }
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        self.law.smallest_volume_ratio()
    }
}
