//! Mie-Grueneisen equation of state on a linear shock Hugoniot.

use crate::eos::{Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Smallest value of 1 - s (1 - J) that still counts as inside the range of the Hugoniot.
const MARGIN: f64 = 0.02;

/// Mie-Grueneisen law on the Hugoniot U_s = c0 + s u_p. With eta = 1 - J and mu = 1/J - 1 = eta/J:
///
/// - compression, J < 1: p = p_H \[1 - (gamma0 + a mu) eta/2\] + (gamma0 + a mu) e,
///   p_H = rho0 c0^2 eta/(1 - s eta)^2, which equals rho0 c0^2 mu (1 + mu)/\[1 - (s - 1) mu\]^2;
/// - tension, J >= 1: p = rho0 c0^2 mu + (gamma0 + a mu) e.
///
/// This is the LS-DYNA form (docs/notes.md 3.7) with S2 = S3 = 0. The constant `a` chooses how the Grueneisen
/// gamma follows the density, gamma = (gamma0 + a mu)/(1 + mu):
///
/// - a = 0 ([`MieGruneisen::new`]): rho gamma constant. The factor of p_H is 1 - gamma0 rho0 mu/(2 rho), as in
///   MPM3D, and b = gamma0.
/// - a = gamma0 ([`MieGruneisen::constant_gamma`]): gamma constant. The factor is 1 - gamma0 mu/2 and
///   b = gamma0 (1 + mu).
///
/// The mixture of the two, factor 1 - gamma0 mu/2 with b = gamma0, which some programs use, leaves its own
/// Hugoniot and is not offered. On the Hugoniot itself the choice cancels. MPM3D drops the energy term in
/// tension, which makes the pressure of a hot point jump at J = 1; here it stays.
///
/// Limits: the Hugoniot is singular at eta = 1/s; within 2 % of it the state is refused as
/// [`Breakdown::OverCompressed`](crate::Breakdown). The squared sound speed falls below zero in strong tension (for gamma0 = 2
/// beyond J = 1.37): a failure law must act before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MieGruneisen<T> {
    density: T,
    sound_speed: T,
    slope: T,
    gruneisen: T,
    correction: T,
}

impl<T: Real> MieGruneisen<T> {
    /// From reference density rho0, kg/m^3, bulk sound speed c0, m/s, Hugoniot slope s and Grueneisen
    /// gamma0, with rho gamma constant.
    ///
    /// # Errors
    /// rho0 or c0 not positive, s or gamma0 negative.
    pub fn new(density: T, sound_speed: T, slope: T, gruneisen: T) -> Result<Self, ParameterError> {
        let check = Check("Mie-Grueneisen");
        Ok(MieGruneisen {
            density: check.positive("density rho0", density)?,
            sound_speed: check.positive("sound speed c0", sound_speed)?,
            slope: check.not_negative("Hugoniot slope s", slope)?,
            gruneisen: check.not_negative("Grueneisen gamma0", gruneisen)?,
            correction: T::of(0.0),
        })
    }

    /// The same law with gamma constant, a = gamma0.
    pub fn constant_gamma(self) -> Self {
        MieGruneisen { correction: self.gruneisen, ..self }
    }

    /// The same law with the first-order volume correction `a` of the Grueneisen gamma (about 0.47 for copper;
    /// not to be mistaken for the melting constant 1.5 of Steinberg's tables).
    ///
    /// # Errors
    /// A correction outside \[0, gamma0\].
    pub fn with_correction(self, a: T) -> Result<Self, ParameterError> {
        let inside = a >= T::of(0.0) && a <= self.gruneisen;
        let a = Check("Mie-Grueneisen").that(inside, "volume correction a", a, "between 0 and gamma0")?;
        Ok(MieGruneisen { correction: a, ..self })
    }

    /// Copper: rho0 8930 kg/m^3, c0 3940 m/s, s 1.49, gamma0 1.96 (MPM3D-F90 `Taylor.mpm`; docs/notes.md 5).
    pub fn copper() -> Self {
        Self::known([8930.0, 3940.0, 1.49, 1.96])
    }

    /// Aluminium 6061-T6: rho0 2700 kg/m^3, c0 5386 m/s, s 1.339, gamma0 1.99 (Uintah; docs/notes.md 5).
    pub fn aluminium_6061() -> Self {
        Self::known([2700.0, 5386.0, 1.339, 1.99])
    }

    /// Steel 4340: rho0 7830 kg/m^3, c0 3574 m/s, s 1.92, gamma0 1.69 (Uintah; docs/notes.md 5).
    pub fn steel_4340() -> Self {
        Self::known([7830.0, 3574.0, 1.92, 1.69])
    }

    /// Lead: rho0 11350 kg/m^3, c0 2092 m/s, s 1.45, gamma0 2.0 (MPM3D-F90 `LeadHypervelocityImpact.mpm`;
    /// docs/notes.md 5).
    pub fn lead() -> Self {
        Self::known([11350.0, 2092.0, 1.45, 2.0])
    }

    /// Tungsten alloy W-Ni-Fe: rho0 18167 kg/m^3, c0 4030 m/s, s 1.237, gamma0 1.67 (Steinberg, in Uintah;
    /// docs/notes.md 5).
    pub fn tungsten_alloy() -> Self {
        Self::known([18167.0, 4030.0, 1.237, 1.67])
    }

    pub(crate) fn known([density, sound_speed, slope, gruneisen]: [f64; 4]) -> Self {
        MieGruneisen {
            density: T::of(density),
            sound_speed: T::of(sound_speed),
            slope: T::of(slope),
            gruneisen: T::of(gruneisen),
            correction: T::of(0.0),
        }
    }

    /// Grueneisen gamma0 at rest.
    pub fn gruneisen(&self) -> T {
        self.gruneisen
    }

    /// Bulk modulus at rest, K = rho0 c0^2, Pa.
    pub fn bulk_modulus(&self) -> T {
        self.density * self.sound_speed * self.sound_speed
    }
}

impl<T: Real> Eos<T> for MieGruneisen<T> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        "Mie-Grueneisen"
    }
    fn density(&self) -> T {
        self.density
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let eta = L::one() - volume_ratio;
        let inverse = volume_ratio.recip();
        let thermal = (L::splat(self.correction) * eta).mul_add(inverse, L::splat(self.gruneisen));
        let to_singular = (-L::splat(self.slope)).mul_add(eta, L::one()).recip();
        let compressed = to_singular * to_singular * (-(thermal * L::of(0.5))).mul_add(eta, L::one());
        let shape = L::select(eta.gt(L::zero()), compressed, inverse);
        Terms { cold: L::splat(self.bulk_modulus()) * eta * shape, thermal }
    }
    /// In compression with h = 1 - s eta and g = gamma0 + a mu:
    /// J^2 (dp_H/deta) = rho0 c0^2 (1 + s eta)/h^3, multiplied out with the factor 1 - g eta/2.
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let (one, half) = (L::one(), L::of(0.5));
        let (j, slope) = (volume_ratio, L::splat(self.slope));
        let (gamma0, a) = (L::splat(self.gruneisen), L::splat(self.correction));
        let (per_density, bulk) = (L::splat(T::of(1.0) / self.density), L::splat(self.bulk_modulus()));
        let eta = one - j;
        let inverse = j.recip();
        let square = j * j;
        let thermal = (a * eta).mul_add(inverse, gamma0);
        let to_singular = (-slope).mul_add(eta, one).recip();
        let factor = (-(thermal * half)).mul_add(eta, one);
        // J^2 d/deta = d/dmu: of the Hugoniot, and of the factor (dg/dmu = a).
        let hugoniot = eta * to_singular * to_singular;
        let hugoniot_slope = square * (one + slope * eta) * to_singular * to_singular * to_singular;
        let compressed = hugoniot_slope * factor - hugoniot * half * (a * eta + thermal * square);
        let compression = eta.gt(L::zero());
        let cold_slope = bulk * L::select(compression, compressed, one);
        let cold = bulk * L::select(compression, hugoniot * factor, eta * inverse);
        let pressure = thermal.mul_add(energy, cold);
        (cold_slope + a * energy + pressure * square * thermal) * per_density
    }
    /// 1 - 0.98/s, or zero where the Hugoniot is nowhere singular.
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        let reach = T::of(1.0 - MARGIN);
        if self.slope > reach { T::of(1.0) - reach / self.slope } else { T::of(0.0) }
    }
}
