//! Mie-Grueneisen equation of state on any Hugoniot, with a density-dependent Grueneisen gamma.

use crate::eos::{Continuation, Eos, REACH, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Hugoniot pressure and its slope.
#[derive(Clone, Copy, Debug)]
pub struct Curve<L> {
    /// Hugoniot pressure p_H, Pa.
    pub pressure: L,
    /// Slope dp_H/dmu, Pa.
    pub slope: L,
}

/// Hugoniot: pressure of shocked states, p_H(mu), mu = rho/rho0 - 1 > 0.
pub trait Hugoniot<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// The curve's name, for messages.
    fn name(&self) -> &'static str;
    /// Reference density rho0, kg/m^3.
    fn density(&self) -> T;
    /// Bulk modulus at rest, K = rho0 c0^2, Pa; tension is p = K mu.
    fn bulk_modulus(&self) -> T;
    /// Pressure and slope at mu >= 0.
    fn curve<L: Lane<Real = T>>(&self, mu: L) -> Curve<L>;
    /// Compression eta = 1 - J at which the curve becomes singular; more than one if it does not.
    fn singular(&self) -> T {
        T::of(f64::INFINITY)
    }
}

/// Mie-Grueneisen law on a Hugoniot `H`, with eta = 1 - J, mu = 1/J - 1 and rho gamma / rho0 = gamma0 + a mu:
///
/// - compression: p = p_H \[1 - (gamma0 + a mu) eta/2\] + (gamma0 + a mu) e;
/// - tension: p = K mu + (gamma0 + a mu) e.
///
/// With [`CubicShock`] this is the LS-DYNA form with S1, S2, S3 (book, "Mie-Grueneisen"), with [`PolynomialHugoniot`]
/// the MPM3D form. On a straight U_s(u_p) use [`MieGruneisen`](crate::MieGruneisen), which is faster.
///
/// The law is extrapolated beyond four fifths of the singular compression, or from where its slope at e = 0 falls to
/// half of K per eta (possible for a series in mu), and has the limits of [`MieGruneisen`](crate::MieGruneisen).
/// gamma0 + a mu must stay positive, so that a > gamma0 is an error (negative in tension below mu = -gamma0/a).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gruneisen<T, H> {
    hugoniot: H,
    gruneisen: T,
    correction: T,
    beyond: Continuation<T>,
}

impl<T: Real, H: Hugoniot<T>> Gruneisen<T, H> {
    /// Create from a Hugoniot, Grueneisen gamma0 at rest, and its volume correction a: 0 for constant rho gamma,
    /// a = gamma0 for constant gamma.
    ///
    /// # Errors
    /// gamma0 negative or a outside \[0, gamma0\].
    pub fn new(hugoniot: H, gruneisen: T, correction: T) -> Result<Self, ParameterError> {
        let check = Check("Mie-Grueneisen");
        check.not_negative("Grueneisen gamma0", gruneisen)?;
        let inside = correction >= T::of(0.0) && correction <= gruneisen;
        check.that(inside, "volume correction a", correction, "between 0 and gamma0")?;
        let (gamma0, a) = (gruneisen.to_double(), correction.to_double());
        let bulk = hugoniot.bulk_modulus().to_double();
        let cold = |j: f64| {
            let (eta, mu) = (1.0 - j, 1.0 / j - 1.0);
            let curve = hugoniot.curve::<T::Single>(T::of(mu).into());
            let (pressure, slope): (T, T) = (curve.pressure.into(), curve.slope.into());
            let thermal = gamma0 + a * mu;
            slope.to_double() * (1.0 - 0.5 * thermal * eta)
                - 0.5 * pressure.to_double() * (a * eta + thermal * j * j)
        };
        let reach = REACH * hugoniot.singular().to_double();
        let beyond = Continuation::of(reach, cold, |j, slope| slope >= 0.5 * bulk * j * j);
        Ok(Gruneisen { hugoniot, gruneisen, correction, beyond })
    }
    /// The Hugoniot.
    pub fn hugoniot(&self) -> &H {
        &self.hugoniot
    }
}

impl<T: Real, H: Hugoniot<T>> Eos<T> for Gruneisen<T, H> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        self.hugoniot.name()
    }
    fn density(&self) -> T {
        self.hugoniot.density()
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let Continuation { smallest, inverse: densest, slope } = self.beyond;
        let eta = L::one() - volume_ratio.max(L::splat(smallest));
        let density = volume_ratio.recip();
        let mu = eta * density.min(L::splat(densest));
        let further = (density - L::splat(densest)).max(L::zero());
        let inside = L::splat(self.correction).mul_add(mu, L::splat(self.gruneisen));
        let hugoniot = self.hugoniot.curve(mu.max(L::zero())).pressure;
        let compressed = hugoniot * (L::one() - inside * eta * L::of(0.5));
        let stretched = L::splat(self.hugoniot.bulk_modulus()) * mu;
        let cold = L::select(eta.gt(L::zero()), compressed, stretched);
        Terms {
            cold: further.mul_add(L::splat(slope), cold),
            thermal: further.mul_add(L::splat(self.correction), inside),
        }
    }
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let (one, half) = (L::one(), L::of(0.5));
        let Continuation { smallest, inverse: densest, slope: straight } = self.beyond;
        let inside = volume_ratio.max(L::splat(smallest));
        let eta = one - inside;
        let density = volume_ratio.recip();
        let mu = eta * density.min(L::splat(densest));
        let further = (density - L::splat(densest)).max(L::zero());
        let square = inside * inside;
        let (a, bulk) = (L::splat(self.correction), L::splat(self.hugoniot.bulk_modulus()));
        let thermal = a.mul_add(mu, L::splat(self.gruneisen));
        let Curve { pressure: hugoniot, slope } = self.hugoniot.curve(mu.max(L::zero()));
        let factor = one - thermal * eta * half;
        // deta/dmu = J^2.
        let compressed = slope * factor - hugoniot * half * (a * eta + thermal * square);
        let compression = eta.gt(L::zero());
        let inside_slope = L::select(compression, compressed, bulk);
        let cold_slope = L::select(further.gt(L::zero()), L::splat(straight), inside_slope);
        let cold = further.mul_add(L::splat(straight), L::select(compression, hugoniot * factor, bulk * mu));
        let thermal = further.mul_add(a, thermal);
        let pressure = thermal.mul_add(energy, cold);
        let per_density = L::splat(T::of(1.0) / self.hugoniot.density());
        (cold_slope + a * energy + pressure * volume_ratio * volume_ratio * thermal) * per_density
    }
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        self.beyond.smallest
    }
}

/// Cubic shock velocity U_s = c0 + S1 u_p + S2 u_p^2/U_s + S3 u_p^3/U_s^2, with
/// p_H = rho0 c0^2 eta/(1 - S1 eta - S2 eta^2 - S3 eta^3)^2 and eta = u_p/U_s = 1 - J (book, "Mie-Grueneisen"),
/// singular at the first zero of the denominator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicShock<T> {
    density: T,
    sound_speed: T,
    slopes: [T; 3],
    singular: T,
}

impl<T: Real> CubicShock<T> {
    /// Create from reference density rho0, kg/m^3, bulk sound speed c0, m/s, and S1, S2, S3.
    ///
    /// # Errors
    /// rho0 or c0 not positive, S1 negative, S2 or S3 not finite.
    pub fn new(density: T, sound_speed: T, slopes: [T; 3]) -> Result<Self, ParameterError> {
        let check = Check("cubic shock Hugoniot");
        check.positive("density rho0", density)?;
        check.positive("sound speed c0", sound_speed)?;
        check.not_negative("S1", slopes[0])?;
        check.that(true, "S2", slopes[1], "finite")?;
        check.that(true, "S3", slopes[2], "finite")?;
        let singular = T::of(singular(slopes.map(T::to_double)));
        Ok(CubicShock { density, sound_speed, slopes, singular })
    }
}

/// Smallest positive zero of the denominator in eta, up to two; infinite if there is none.
fn singular([s1, s2, s3]: [f64; 3]) -> f64 {
    let open = |eta: f64| 1.0 - eta * (s1 + eta * (s2 + eta * s3)) > 0.0;
    const PARTS: usize = 2000;
    let at = |k: usize| 2.0 * k as f64 / PARTS as f64;
    let Some(k) = (1..=PARTS).find(|&k| !open(at(k))) else { return f64::INFINITY };
    let (mut inside, mut outside) = (at(k - 1), at(k));
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        if open(middle) { inside = middle } else { outside = middle }
    }
    inside
}

impl<T: Real> Hugoniot<T> for CubicShock<T> {
    fn name(&self) -> &'static str {
        "Mie-Grueneisen, cubic shock velocity"
    }
    fn density(&self) -> T {
        self.density
    }
    fn bulk_modulus(&self) -> T {
        self.density * self.sound_speed * self.sound_speed
    }
    #[inline(always)]
    fn curve<L: Lane<Real = T>>(&self, mu: L) -> Curve<L> {
        let one = L::one();
        let j = (mu + one).recip();
        let eta = mu * j;
        let [s1, s2, s3] = self.slopes;
        let bend = L::splat(s3).mul_add(eta, L::splat(s2)).mul_add(eta, L::splat(s1));
        // S1 + 2 S2 eta + 3 S3 eta^2
        let rise =
            L::splat(s3 * T::of(3.0)).mul_add(eta, L::splat(s2 * T::of(2.0))).mul_add(eta, L::splat(s1));
        let inverse = (one - eta * bend).recip();
        let square = L::splat(self.bulk_modulus()) * inverse * inverse;
        let slope = j * j * square * (one + L::of(2.0) * eta * rise * inverse);
        Curve { pressure: square * eta, slope }
    }
    fn singular(&self) -> T {
        self.singular
    }
}

/// Polynomial Hugoniot p_H = K1 mu + K2 mu^2 + K3 mu^3. It has no singular compression, a defect: beyond mu of about
/// 0.5 it is below the shock line from which it was expanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolynomialHugoniot<T> {
    density: T,
    coefficients: [T; 3],
}

impl<T: Real> PolynomialHugoniot<T> {
    /// Create from reference density, kg/m^3, and K1, K2, K3, Pa.
    ///
    /// # Errors
    /// Density or K1 not positive, K2 or K3 not finite.
    pub fn new(density: T, coefficients: [T; 3]) -> Result<Self, ParameterError> {
        let check = Check("polynomial Hugoniot");
        check.positive("density rho0", density)?;
        check.positive("K1", coefficients[0])?;
        check.that(true, "K2", coefficients[1], "finite")?;
        check.that(true, "K3", coefficients[2], "finite")?;
        Ok(PolynomialHugoniot { density, coefficients })
    }

    /// Expand U_s = c0 + s u_p to third order: K1 = rho0 c0^2, K2 = K1 (2 s - 1), K3 = K1 (s - 1)(3 s - 1), as in MPM3D
    /// (book, "Mie-Grueneisen").
    ///
    /// # Errors
    /// See [`PolynomialHugoniot::new`].
    pub fn of_shock(density: T, sound_speed: T, slope: T) -> Result<Self, ParameterError> {
        let bulk = density * sound_speed * sound_speed;
        let one = T::of(1.0);
        let second = bulk * (T::of(2.0) * slope - one);
        let third = bulk * (slope - one) * (T::of(3.0) * slope - one);
        Self::new(density, [bulk, second, third])
    }
}

impl<T: Real> Hugoniot<T> for PolynomialHugoniot<T> {
    fn name(&self) -> &'static str {
        "Mie-Grueneisen, polynomial Hugoniot"
    }
    fn density(&self) -> T {
        self.density
    }
    fn bulk_modulus(&self) -> T {
        self.coefficients[0]
    }
    #[inline(always)]
    fn curve<L: Lane<Real = T>>(&self, mu: L) -> Curve<L> {
        let [k1, k2, k3] = self.coefficients;
        let pressure = L::splat(k3).mul_add(mu, L::splat(k2)).mul_add(mu, L::splat(k1)) * mu;
        let slope =
            L::splat(k3 * T::of(3.0)).mul_add(mu, L::splat(k2 * T::of(2.0))).mul_add(mu, L::splat(k1));
        Curve { pressure, slope }
    }
}
