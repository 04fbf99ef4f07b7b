//! Equations of state: pressure from volume and internal energy.
//!
//! Every law here is linear in the internal energy, p = a(J) + b(J) e, with J the volume ratio and e the internal
//! energy per unit **reference** volume. The energy half step of a solid or a fluid is therefore implicit without
//! iteration (book, "Mie-Grueneisen").
//!
//! Every law is defined for every J > 0. Laws that end at a finite compression (Mie-Grueneisen) or have a pressure
//! maximum there (JWL) are extrapolated linearly in mu = 1/J - 1 beyond a compression of their own,
//! [`Eos::smallest_volume_ratio`]: a(J) grows with the density at constant slope, so that the sound speed stays about
//! constant and the time step does not vanish. [`Eos::in_range`] is false for extrapolated states.

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
use crate::point::{Nothing, State};

/// The two terms of a pressure that is linear in the internal energy: p = cold + thermal e.
#[derive(Clone, Copy, Debug)]
pub struct Terms<L> {
    /// Cold pressure a(J), at zero internal energy, Pa.
    pub cold: L,
    /// Thermal coefficient b(J) = dp/de, dimensionless; zero for a barotropic law.
    pub thermal: L,
}

/// An equation of state p = a(J) + b(J) e, compression positive.
pub trait Eos<T: Real>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// Internal energy in the state of a fluid: a number, or [`Nothing`] if the pressure depends on the volume alone.
    type Energy<L: Lane<Real = T>>: EnergyColumn<L>;

    /// The law's name, for messages.
    fn name(&self) -> &'static str;

    /// Reference density rho0, kg/m^3.
    fn density(&self) -> T;

    /// Internal energy of the virgin state, e0, J per m^3 of reference volume. Default: zero.
    fn initial_energy(&self) -> T {
        T::default()
    }

    /// The terms a and b at volume ratio J = rho0 / rho.
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L>;

    /// Squared bulk sound speed at constant entropy, m^2/s^2:
    /// c^2 = (1/rho0) \[(dp/dmu)_e + p J^2 b\] with mu = 1/J - 1 (book, "Mie-Grueneisen").
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L;

    /// Energy stored by volume change alone, W(J) = -int_1^J p dJ at e = 0, J per m^3 of reference volume.
    /// Used only for laws with `Energy = Nothing`; the others have no such potential and keep the default, zero.
    #[inline(always)]
    fn stored_energy<L: Lane<Real = T>>(&self, volume_ratio: L) -> L {
        let _ = volume_ratio;
        L::zero()
    }

    /// Smallest volume ratio of the formula, which is extrapolated below: zero unless the formula has no pressure at
    /// some J > 0, or none that grows with the density.
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        T::default()
    }

    /// True if the volume ratio is within the range of the formula, J > [`Eos::smallest_volume_ratio`].
    #[inline(always)]
    fn in_range<L: Lane<Real = T>>(&self, volume_ratio: L) -> L::Mask {
        volume_ratio.gt(L::splat(self.smallest_volume_ratio()))
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
    /// Pressure p, Pa, without viscous pressure.
    pub pressure: L,
    /// Internal energy e, J per m^3 of reference volume.
    pub energy: L,
}

/// Lower bound of 1 + b dJ/2 in an implicit step.
const MOST_IMPLICIT: f64 = 0.25;

/// Solve the implicit energy half step: p = a + b e with e = `energy` - dJ/2 p, where `energy` already includes all
/// other work of the step (book, "Mie-Grueneisen"): p = (a + b energy)/(1 + b dJ/2).
///
/// The denominator is at least 1/4, since a stronger compression, dJ < -3/(2 b), has no such solution or one far too
/// large: p is then below a + b e, by less than the work of this one step, and is that of the new energy in the next.
/// The energy always includes the work of the returned pressure, so that the energy balance closes.
#[inline(always)]
pub fn balance<L: Lane>(terms: Terms<L>, energy: L, volume_change: L) -> Balance<L> {
    let half = volume_change * L::of(0.5);
    let implicit = terms.thermal.mul_add(half, L::one()).max(L::of(MOST_IMPLICIT));
    // The reciprocal does not depend on the energy.
    let pressure = terms.thermal.mul_add(energy, terms.cold) * implicit.recip();
    Balance { pressure, energy: (-half).mul_add(pressure, energy) }
}

/// Fraction of the singular compression up to which a Hugoniot is used: beyond, u_p exceeds 4 c0/s on a straight one,
/// where the pressure is 20 rho0 c0^2/s and the wave speed six times that at rest.
pub(crate) const REACH: f64 = 0.8;

/// Linear extrapolation of a cold pressure a(J) in mu below a volume ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Continuation<T> {
    /// Volume ratio J at which it begins, or zero.
    pub smallest: T,
    /// Reciprocal of `smallest`, 1/J.
    pub inverse: T,
    /// Slope da/dmu at `smallest`, Pa.
    pub slope: T,
}

impl<T: Real> Continuation<T> {
    /// Begin at the largest eta = 1 - J below `reach` up to which `enough` is true of J and the slope da/dmu, Pa; do
    /// not extrapolate if that is any compression.
    pub fn of(reach: f64, slope: impl Fn(f64) -> f64, enough: impl Fn(f64, f64) -> bool) -> Self {
        const PARTS: usize = 1000;
        let holds = |eta: f64| enough(1.0 - eta, slope(1.0 - eta));
        let end = reach.min(1.0 - 1e-3);
        let at = |k: usize| end * k as f64 / PARTS as f64;
        let eta = match (1..=PARTS).find(|&k| !holds(at(k))) {
            Some(k) => {
                let (mut inside, mut outside) = (at(k - 1), at(k));
                for _ in 0..60 {
                    let middle = 0.5 * (inside + outside);
                    if holds(middle) { inside = middle } else { outside = middle }
                }
                inside
            }
            None if reach < 1.0 => end,
            None => {
                let (smallest, inverse) = (T::default(), T::of(f64::INFINITY));
                return Continuation { smallest, inverse, slope: T::default() };
            }
        };
        let smallest = 1.0 - eta;
        Continuation {
            smallest: T::of(smallest),
            inverse: T::of(1.0 / smallest),
            slope: T::of(slope(smallest)),
        }
    }
}

/// State column of the internal energy, or none.
pub trait EnergyColumn<L: Lane>: State<L> {
    /// True if there is a column.
    const KEPT: bool;
    /// Column of a heat `H` in addition to the energy: none if the energy, which includes that heat, is stored.
    type Beside<H: EnergyColumn<L>>: EnergyColumn<L>;
    /// Store the energy e, J/m^3.
    fn keep(energy: L) -> Self;
    /// Return the stored energy, or zero.
    fn recall(&self) -> L;
}

impl<L: Lane> EnergyColumn<L> for L {
    const KEPT: bool = true;
    type Beside<H: EnergyColumn<L>> = Nothing;
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
    type Beside<H: EnergyColumn<L>> = H;
    #[inline(always)]
    fn keep(_: L) -> Self {
        Nothing
    }
    #[inline(always)]
    fn recall(&self) -> L {
        L::zero()
    }
}

/// Barotropic law with an energy column, so that the states of its fluid merge without a loss of energy.
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
