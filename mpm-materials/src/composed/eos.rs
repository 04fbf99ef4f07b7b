//! Equation of state chosen at run time.

use crate::eos::{
    CubicShock, Eos, Expanding, Gruneisen, IdealGas, Jwl, LinearDensity, LogarithmicBulk, MieGruneisen,
    Polynomial, PolynomialHugoniot, Tait, Terms,
};
use crate::lane::{Lane, Real};

macro_rules! any_eos {
    ($($(#[$doc:meta])* $name:ident($law:ty),)+) => {
        /// Equation of state chosen at run time. Laws of the library convert into it by `into()`. The energy is a state
        /// variable with any of them ([`KeepEnergy`](crate::KeepEnergy)).
        #[derive(Clone, Copy, PartialEq)]
        pub enum AnyEos<T> { $($(#[$doc])* $name($law),)+ }

        $(impl<T> From<$law> for AnyEos<T> {
            fn from(law: $law) -> Self {
                AnyEos::$name(law)
            }
        })+

        impl<T: std::fmt::Debug> std::fmt::Debug for AnyEos<T> {
            /// Debug of the part.
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                match self { $(AnyEos::$name(law) => law.fmt(f),)+ }
            }
        }

        impl<T: Real> Eos<T> for AnyEos<T> {
            type Energy<L: Lane<Real = T>> = L;

            fn name(&self) -> &'static str {
                match self { $(AnyEos::$name(law) => Eos::<T>::name(law),)+ }
            }
            #[inline(always)]
            fn density(&self) -> T {
                match self { $(AnyEos::$name(law) => Eos::<T>::density(law),)+ }
            }
            #[inline(always)]
            fn initial_energy(&self) -> T {
                match self { $(AnyEos::$name(law) => Eos::<T>::initial_energy(law),)+ }
            }
            #[inline(always)]
            fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
                match self { $(AnyEos::$name(law) => law.terms(volume_ratio),)+ }
            }
            #[inline(always)]
            fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
                match self { $(AnyEos::$name(law) => law.speed_squared(volume_ratio, energy),)+ }
            }
            #[inline(always)]
            fn smallest_volume_ratio(&self) -> T {
                match self { $(AnyEos::$name(law) => Eos::<T>::smallest_volume_ratio(law),)+ }
            }
        }
    };
}

any_eos! {
    /// p = c0^2 (rho - rho0).
    LinearDensity(LinearDensity<T>),
    /// p = K ln(rho / rho0).
    LogarithmicBulk(LogarithmicBulk<T>),
    /// Mie-Grueneisen on a straight shock velocity.
    MieGruneisen(MieGruneisen<T>),
    /// Mie-Grueneisen for strong expansion.
    Expanding(Expanding<T>),
    /// Mie-Grueneisen on a cubic shock velocity.
    CubicShock(Gruneisen<T, CubicShock<T>>),
    /// Mie-Grueneisen on a polynomial Hugoniot.
    PolynomialHugoniot(Gruneisen<T, PolynomialHugoniot<T>>),
    /// Polynomial in the compression.
    Polynomial(Polynomial<T>),
    /// Tait with exponent 7.
    Tait(Tait<T>),
    /// Ideal gas.
    IdealGas(IdealGas<T>),
    /// Jones-Wilkins-Lee.
    Jwl(Jwl<T>),
}
