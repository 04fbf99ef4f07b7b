//! Mie-Grueneisen equation of state on a linear shock Hugoniot.

use crate::eos::{Continuation, Eos, REACH, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Mie-Grueneisen law on the Hugoniot U_s = c0 + s u_p. With eta = 1 - J and mu = 1/J - 1 = eta/J:
///
/// - compression, J < 1: p = p_H \[1 - (gamma0 + a mu) eta/2\] + (gamma0 + a mu) e,
///   p_H = rho0 c0^2 eta/(1 - s eta)^2, which equals rho0 c0^2 mu (1 + mu)/\[1 - (s - 1) mu\]^2;
/// - tension, J >= 1: p = rho0 c0^2 mu + (gamma0 + a mu) e.
///
/// This is the LS-DYNA form (book, "Mie-Grueneisen") with S2 = S3 = 0. The constant `a` sets the density dependence of
/// the Grueneisen gamma, gamma = (gamma0 + a mu)/(1 + mu):
///
/// - a = 0 ([`MieGruneisen::new`]): constant rho gamma. The factor of p_H is 1 - gamma0 rho0 mu/(2 rho), as in MPM3D,
///   and b = gamma0.
/// - a = gamma0 ([`MieGruneisen::constant_gamma`]): constant gamma. The factor is 1 - gamma0 mu/2 and
///   b = gamma0 (1 + mu).
///
/// The mixture of the two, factor 1 - gamma0 mu/2 with b = gamma0, which some programs use, does not reproduce its own
/// Hugoniot and is not provided. On the Hugoniot itself the choice cancels. MPM3D drops the energy term in tension, so
/// that the pressure of a hot point jumps at J = 1; here the term is kept.
///
/// The Hugoniot is singular at eta = 1/s. Beyond four fifths of that compression, or from where the slope of the
/// pressure at e = 0 is below rho0 c0^2/2 per eta (constant gamma: near 2/gamma0 of mu, where the factor of p_H
/// vanishes), a(J) is extrapolated linearly in mu, with b(J) unchanged: for e >= 0 the pressure grows with the density
/// for every J > 0, and c stays about constant. [`Eos::smallest_volume_ratio`] is that J; states beyond are no
/// breakdown, but outside any measurement ([`Eos::in_range`]).
///
/// Limits: the squared sound speed is negative in strong tension (for gamma0 = 2 beyond J = 1.37), where wave speeds
/// are floored and a failure criterion must act. For J > 1 the pressure rises with the density, but tends to
/// gamma0 e - rho0 c0^2 as J grows: use [`Expanding`](crate::Expanding) for strong expansion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MieGruneisen<T> {
    density: T,
    sound_speed: T,
    slope: T,
    gruneisen: T,
    correction: T,
    beyond: Continuation<T>,
}

impl<T: Real> MieGruneisen<T> {
    /// Create from reference density rho0, kg/m^3, bulk sound speed c0, m/s, Hugoniot slope s and Grueneisen gamma0,
    /// with constant rho gamma.
    ///
    /// # Errors
    /// rho0 or c0 not positive, s or gamma0 negative.
    pub fn new(density: T, sound_speed: T, slope: T, gruneisen: T) -> Result<Self, ParameterError> {
        let check = Check("Mie-Grueneisen");
        check.positive("density rho0", density)?;
        check.positive("sound speed c0", sound_speed)?;
        check.not_negative("Hugoniot slope s", slope)?;
        check.not_negative("Grueneisen gamma0", gruneisen)?;
        Ok(Self::of([density, sound_speed, slope, gruneisen], T::default()))
    }

    /// Set constant gamma, a = gamma0.
    pub fn constant_gamma(self) -> Self {
        Self::of([self.density, self.sound_speed, self.slope, self.gruneisen], self.gruneisen)
    }

    /// Set the first-order volume correction `a` of the Grueneisen gamma (about 0.47 for copper; not to be confused
    /// with the melting constant 1.5 of Steinberg's tables).
    ///
    /// # Errors
    /// A correction outside \[0, gamma0\].
    pub fn with_correction(self, a: T) -> Result<Self, ParameterError> {
        let inside = a >= T::of(0.0) && a <= self.gruneisen;
        let a = Check("Mie-Grueneisen").that(inside, "volume correction a", a, "between 0 and gamma0")?;
        Ok(Self::of([self.density, self.sound_speed, self.slope, self.gruneisen], a))
    }

    /// Copper: rho0 8930 kg/m^3, c0 3940 m/s, s 1.49, gamma0 1.96 (MPM3D-F90 `Taylor.mpm`; book, "Material constants").
    pub fn copper() -> Self {
        Self::known([8930.0, 3940.0, 1.49, 1.96])
    }

    /// Aluminium 6061-T6: rho0 2700 kg/m^3, c0 5386 m/s, s 1.339, gamma0 1.99 (Uintah; book, "Material constants").
    pub fn aluminium_6061() -> Self {
        Self::known([2700.0, 5386.0, 1.339, 1.99])
    }

    /// Aluminium 2024: rho0 2785 kg/m^3, c0 5328 m/s, s 1.338, gamma0 2.00 (Steinberg, in Uintah; book, "Material constants").
    pub fn aluminium_2024() -> Self {
        Self::known([2785.0, 5328.0, 1.338, 2.00])
    }

    /// Steel 4340: rho0 7830 kg/m^3, c0 3574 m/s, s 1.92, gamma0 1.69 (Uintah; book, "Material constants").
    pub fn steel_4340() -> Self {
        Self::known([7830.0, 3574.0, 1.92, 1.69])
    }

    /// Lead: rho0 11350 kg/m^3, c0 2092 m/s, s 1.45, gamma0 2.0 (MPM3D-F90 `LeadHypervelocityImpact.mpm`;
    /// book, "Material constants").
    pub fn lead() -> Self {
        Self::known([11350.0, 2092.0, 1.45, 2.0])
    }

    /// Tungsten alloy W-Ni-Fe: rho0 18167 kg/m^3, c0 4030 m/s, s 1.237, gamma0 1.67 (Steinberg, in Uintah;
    /// book, "Material constants").
    pub fn tungsten_alloy() -> Self {
        Self::known([18167.0, 4030.0, 1.237, 1.67])
    }

    pub(crate) fn known(constants: [f64; 4]) -> Self {
        Self::of(constants.map(T::of), T::default())
    }

    fn of([density, sound_speed, slope, gruneisen]: [T; 4], correction: T) -> Self {
        let (s, gamma0, a) = (slope.to_double(), gruneisen.to_double(), correction.to_double());
        let bulk = (density * sound_speed * sound_speed).to_double();
        // Slope da/dmu as in `speed_squared`.
        let cold = |j: f64| {
            let eta = 1.0 - j;
            let (thermal, open) = (gamma0 + a * eta / j, 1.0 - s * eta);
            let (hugoniot, steep) = (eta / (open * open), j * j * (1.0 + s * eta) / open.powi(3));
            bulk * (steep * (1.0 - 0.5 * thermal * eta) - 0.5 * hugoniot * (a * eta + thermal * j * j))
        };
        let beyond = Continuation::of(REACH / s, cold, |j, slope| slope >= 0.5 * bulk * j * j);
        MieGruneisen { density, sound_speed, slope, gruneisen, correction, beyond }
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
        let Continuation { smallest, inverse: densest, slope } = self.beyond;
        let eta = L::one() - volume_ratio.max(L::splat(smallest));
        let density = volume_ratio.recip();
        let inverse = density.min(L::splat(densest));
        let further = (density - L::splat(densest)).max(L::zero());
        let inside = (L::splat(self.correction) * eta).mul_add(inverse, L::splat(self.gruneisen));
        let to_singular = (-L::splat(self.slope)).mul_add(eta, L::one()).recip();
        let compressed = to_singular * to_singular * (-(inside * L::of(0.5))).mul_add(eta, L::one());
        let shape = L::select(eta.gt(L::zero()), compressed, inverse);
        Terms {
            cold: further.mul_add(L::splat(slope), L::splat(self.bulk_modulus()) * eta * shape),
            thermal: further.mul_add(L::splat(self.correction), inside),
        }
    }
    /// Squared sound speed. In compression, with h = 1 - s eta and g = gamma0 + a mu:
    /// J^2 (dp_H/deta) = rho0 c0^2 (1 + s eta)/h^3, multiplied out with the factor 1 - g eta/2.
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let (one, half) = (L::one(), L::of(0.5));
        let Continuation { smallest, inverse: densest, slope: straight } = self.beyond;
        let (j, slope) = (volume_ratio.max(L::splat(smallest)), L::splat(self.slope));
        let (gamma0, a) = (L::splat(self.gruneisen), L::splat(self.correction));
        let (per_density, bulk) = (L::splat(T::of(1.0) / self.density), L::splat(self.bulk_modulus()));
        let eta = one - j;
        let density = volume_ratio.recip();
        let inverse = density.min(L::splat(densest));
        let further = (density - L::splat(densest)).max(L::zero());
        let square = j * j;
        let thermal = (a * eta).mul_add(inverse, gamma0);
        let to_singular = (-slope).mul_add(eta, one).recip();
        let factor = (-(thermal * half)).mul_add(eta, one);
        // Derivatives J^2 d/deta = d/dmu of the Hugoniot, and of the factor (dg/dmu = a).
        let hugoniot = eta * to_singular * to_singular;
        let hugoniot_slope = square * (one + slope * eta) * to_singular * to_singular * to_singular;
        let compressed = hugoniot_slope * factor - hugoniot * half * (a * eta + thermal * square);
        let compression = eta.gt(L::zero());
        let beyond = further.gt(L::zero());
        let inside_slope = bulk * L::select(compression, compressed, one);
        let cold_slope = L::select(beyond, L::splat(straight), inside_slope);
        let inside = bulk * L::select(compression, hugoniot * factor, eta * inverse);
        let cold = further.mul_add(L::splat(straight), inside);
        let thermal = further.mul_add(a, thermal);
        let pressure = thermal.mul_add(energy, cold);
        let square = volume_ratio * volume_ratio;
        (cold_slope + a * energy + pressure * square * thermal) * per_density
    }
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        self.beyond.smallest
    }
}
