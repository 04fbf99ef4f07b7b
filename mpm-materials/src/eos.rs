//! Equations of state: pressure from volume and internal energy.
//!
//! Every law here is linear in the internal energy, p = a(J) + b(J) e, with J the volume ratio and e the
//! internal energy per unit **reference** volume. That is what makes the energy half step of a solid or a
//! fluid implicit without iteration (docs/notes.md 3.7).

pub mod bulk;
pub mod chapman_jouguet;
pub mod crush;
pub mod expanding;
pub mod gruneisen;
pub mod ideal_gas;
pub mod jwl;
pub mod linear;
pub mod mie_gruneisen;
pub mod polynomial;
pub mod tait;

pub use bulk::LogarithmicBulk;
pub use chapman_jouguet::{ChapmanJouguet, chapman_jouguet};
pub use crush::{CrushConstants, CrushCurve};
pub use expanding::Expanding;
pub use gruneisen::{CubicShock, Gruneisen, Hugoniot, PolynomialHugoniot};
pub use ideal_gas::IdealGas;
pub use jwl::{Jwl, JwlConstants};
pub use linear::LinearDensity;
pub use mie_gruneisen::MieGruneisen;
pub use polynomial::Polynomial;
pub use tait::Tait;

use crate::lane::{Lane, Real};
use crate::point::{Breakdown, Fault, Nothing, State};

/// The two terms of a pressure that is linear in the internal energy: p = cold + thermal e.
#[derive(Clone, Copy, Debug)]
pub struct Terms<L> {
    /// a(J), the pressure at zero internal energy, Pa.
    pub cold: L,
    /// b(J) = dp/de, dimensionless; zero for a barotropic law.
    pub thermal: L,
}

/// An equation of state p = a(J) + b(J) e, compression positive.
pub trait Eos<T: Real>: Clone + Send + Sync + 'static {
    /// The internal energy a fluid of this law must remember: the number itself, or [`Nothing`] when the pressure
    /// depends on the volume alone.
    type Energy<L: Lane<Real = T>>: EnergyColumn<L>;

    /// The law's name, for messages.
    fn name(&self) -> &'static str;

    /// Reference density rho0, kg/m^3.
    fn density(&self) -> T;

    /// Internal energy of the virgin state, e0, J per m^3 of reference volume. Zero unless the law says so.
    fn initial_energy(&self) -> T {
        T::default()
    }

    /// The terms a and b at volume ratio J = rho0 / rho.
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L>;

    /// Squared bulk sound speed at constant entropy, m^2/s^2:
    /// c^2 = (1/rho0) \[(dp/dmu)_e + p J^2 b\] with mu = 1/J - 1 (docs/notes.md 3.7).
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L;

    /// Energy stored by volume change alone, W(J) = -int_1^J p dJ at e = 0, J per m^3 of reference volume.
    /// Only asked of laws with `Energy = Nothing`; the others have no such potential and keep the default, zero.
    #[inline(always)]
    fn stored_energy<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        let _ = volume_ratio;
        L::zero()
    }

    /// The law holds for volume ratios above this: zero, or more where it is singular.
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        T::default()
    }

    /// Reports the lanes whose volume ratio lies outside the range of the law:
    /// [`Breakdown::InvertedVolume`] for J <= 0, else [`Breakdown::OverCompressed`].
    #[inline(always)]
    fn range<L: Lane<Real = T>>(&self, volume_ratio: L) -> Fault<L> {
        Fault::none()
            .require(volume_ratio.gt(L::zero()), Breakdown::InvertedVolume)
            .require(volume_ratio.gt(L::splat(self.smallest_volume_ratio())), Breakdown::OverCompressed)
    }

    /// Pressure p, Pa.
    #[inline(always)]
    fn pressure<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let Terms { cold, thermal } = self.terms(volume_ratio);
        thermal.mul_add(energy, cold)
    }

    /// Bulk sound speed of the virgin state, m/s.
    fn rest_speed(&self) -> T {
        let squared = self.speed_squared(T::Single::one(), T::Single::splat(self.initial_energy()));
        squared.max(T::Single::zero()).sqrt().into()
    }
}

/// Pressure and energy at the end of a step.
#[derive(Clone, Copy, Debug)]
pub struct Balance<L: Lane> {
    /// p, Pa, without viscous pressure.
    pub pressure: L,
    /// e, J per m^3 of reference volume.
    pub energy: L,
    /// False in the lanes where the step compresses so much that the implicit equation has no solution.
    pub solvable: L::Mask,
}

/// The implicit energy half step: solves p = a + b e with e = `energy` - dJ/2 p, where `energy` already holds
/// all other work of the step (docs/notes.md 3.7).
#[inline(always)]
pub fn balance<L: Lane>(terms: Terms<L>, energy: L, volume_change: L) -> Balance<L> {
    let half = volume_change * L::of(0.5);
    let implicit = terms.thermal.mul_add(half, L::one());
    // The inverse does not wait for the energy.
    let pressure = terms.thermal.mul_add(energy, terms.cold) * implicit.recip();
    Balance { pressure, energy: (-half).mul_add(pressure, energy), solvable: implicit.gt(L::zero()) }
}

/// A column for the internal energy, or none.
pub trait EnergyColumn<L: Lane>: State<L> {
    /// Is there a column?
    const KEPT: bool;
    /// Remember the energy e, J/m^3.
    fn keep(energy: L) -> Self;
    /// What is remembered, or zero.
    fn recall(&self) -> L;
}

impl<L: Lane> EnergyColumn<L> for L {
    const KEPT: bool = true;
    #[inline(always)]
    fn keep(energy: L) -> Self {
        energy
    }
    #[inline(always)]
    fn recall(&self) -> L {
        *self
    }
}

impl<L: Lane> EnergyColumn<L> for Nothing {
    const KEPT: bool = false;
    #[inline(always)]
    fn keep(_: L) -> Self {
        Nothing
    }
    #[inline(always)]
    fn recall(&self) -> L {
        L::zero()
    }
}

/// The same law with an energy column, for a barotropic fluid whose viscous heat shall stay in the ledger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeepEnergy<E>(
    /// The law.
    pub E,
);

impl<T: Real, E: Eos<T>> Eos<T> for KeepEnergy<E> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn density(&self) -> T {
        self.0.density()
    }
    fn initial_energy(&self) -> T {
        self.0.initial_energy()
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        self.0.terms(volume_ratio)
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        self.0.speed_squared(volume_ratio, energy)
    }
    #[inline(always)]
    fn stored_energy<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        self.0.stored_energy(volume_ratio)
    }
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        self.0.smallest_volume_ratio()
    }
}
