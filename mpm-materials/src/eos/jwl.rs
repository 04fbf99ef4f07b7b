//! Jones-Wilkins-Lee equation of state of detonation products.

use crate::eos::{Continuation, Eos, Terms};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Constants of a [`Jwl`] law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JwlConstants<T> {
    /// Reference density rho0, that of the unreacted explosive, kg/m^3.
    pub density: T,
    /// Coefficient A, Pa.
    pub a: T,
    /// Coefficient B, Pa.
    pub b: T,
    /// Exponent R1, dimensionless.
    pub r1: T,
    /// Exponent R2, dimensionless.
    pub r2: T,
    /// Grueneisen gamma of the products at large volume, omega, dimensionless.
    pub omega: T,
    /// Chemical energy E0 per volume of unreacted explosive, J/m^3.
    pub energy: T,
}

/// JWL pressure p = A (1 - omega/(R1 V)) exp(-R1 V) + B (1 - omega/(R2 V)) exp(-R2 V) + omega e/V (book, "Detonation
/// and JWL"), with V = J the volume over that of the unreacted explosive and e the energy per volume of it; e is E0 in
/// the virgin state. A [`Fluid`](crate::Fluid) of it is products burnt at constant volume; for the burning charge use
/// [`Explosive`](crate::Explosive).
///
/// Along an isentrope p = A exp(-R1 V) + B exp(-R2 V) + C V^-(1 + omega). Limits: fitted to expansion from the
/// Chapman-Jouguet state, V of about 0.7 to 10; stronger compression is an extrapolation. The sum of the terms of A and
/// B has a maximum in strong compression and tends to minus infinity; it is extrapolated linearly in 1/V from where its
/// slope falls to half of that at V = 1 (TNT: V = 0.24): for e >= 0 the pressure grows with the density for every
/// V > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jwl<T> {
    constants: JwlConstants<T>,
    beyond: Continuation<T>,
}

impl<T: Real> Jwl<T> {
    /// Create from constants.
    ///
    /// # Errors
    /// Density, A, R1, R2, omega or E0 not positive, B negative.
    pub fn new(constants: JwlConstants<T>) -> Result<Self, ParameterError> {
        let check = Check("JWL");
        check.positive("density rho0", constants.density)?;
        check.positive("A", constants.a)?;
        check.not_negative("B", constants.b)?;
        check.positive("R1", constants.r1)?;
        check.positive("R2", constants.r2)?;
        check.positive("omega", constants.omega)?;
        check.positive("energy E0", constants.energy)?;
        Ok(Self::known(constants))
    }

    fn known(constants: JwlConstants<T>) -> Self {
        let JwlConstants { a, b, r1, r2, omega, .. } = constants;
        let (a, b, r1, r2, omega) =
            (a.to_double(), b.to_double(), r1.to_double(), r2.to_double(), omega.to_double());
        let term = |a: f64, r: f64, v: f64| a * (v * v * r - omega * v - omega / r) * (-r * v).exp();
        // d/dmu = -V^2 d/dV.
        let slope = |v: f64| term(a, r1, v) + term(b, r2, v);
        let least = 0.5 * slope(1.0);
        Jwl { constants, beyond: Continuation::of(f64::INFINITY, slope, |_, slope| slope >= least) }
    }

    /// TNT: 1630 kg/m^3, A 371.2 GPa, B 3.21 GPa, R1 4.15, R2 0.95, omega 0.30, E0 6.993e9 J/m^3 (MPM3D-F90
    /// `Deto1k.mpm`; book, "Material constants"). Its Chapman-Jouguet state is D 6928 m/s, p 21.0 GPa, V 0.732.
    ///
    /// The deck `TNT3D.mpm` of the same program has omega 0.35 and E0 6.0e9 with this A and B: a mixture of two sets,
    /// with D 6890 m/s, and not provided.
    pub fn tnt() -> Self {
        Self::known(JwlConstants {
            density: T::of(1630.0),
            a: T::of(371.2e9),
            b: T::of(3.21e9),
            r1: T::of(4.15),
            r2: T::of(0.95),
            omega: T::of(0.30),
            energy: T::of(6.993e9),
        })
    }

    /// The constants.
    pub fn constants(&self) -> &JwlConstants<T> {
        &self.constants
    }
}

impl<T: Real> Eos<T> for Jwl<T> {
    type Energy<L: Lane<Real = T>> = L;

    fn name(&self) -> &'static str {
        "JWL"
    }
    fn density(&self) -> T {
        self.constants.density
    }
    /// Initial energy E0, J/m^3.
    fn initial_energy(&self) -> T {
        self.constants.energy
    }
    #[inline(always)]
    fn terms<L: Lane<Real = T>>(&self, volume_ratio: L) -> Terms<L> {
        let k = &self.constants;
        let Continuation { smallest, inverse: densest, slope } = self.beyond;
        let inside = volume_ratio.max(L::splat(smallest));
        let further = (volume_ratio.recip() - L::splat(densest)).max(L::zero());
        let thermal = L::splat(k.omega) / inside;
        let first = L::splat(k.a) * (L::splat(-k.r1) * inside).exp();
        let second = L::splat(k.b) * (L::splat(-k.r2) * inside).exp();
        let per_r1 = L::splat(T::of(1.0) / k.r1);
        let per_r2 = L::splat(T::of(1.0) / k.r2);
        let cold = first * (L::one() - thermal * per_r1) + second * (L::one() - thermal * per_r2);
        Terms {
            cold: further.mul_add(L::splat(slope), cold),
            thermal: further.mul_add(L::splat(k.omega), thermal),
        }
    }
    /// Squared sound speed c^2 = (V^2/rho0) \[p omega/V - (dp/dV)_e\].
    #[inline(always)]
    fn speed_squared<L: Lane<Real = T>>(&self, volume_ratio: L, energy: L) -> L {
        let k = &self.constants;
        let Continuation { smallest, inverse: densest, slope } = self.beyond;
        let (v, one) = (volume_ratio.max(L::splat(smallest)), L::one());
        let inverse = v.recip();
        let thermal = L::splat(k.omega) * inverse;
        let first = L::splat(k.a) * (L::splat(-k.r1) * v).exp();
        let second = L::splat(k.b) * (L::splat(-k.r2) * v).exp();
        let (r1, r2) = (L::splat(k.r1), L::splat(k.r2));
        let pressure = first * (one - thermal / r1) + second * (one - thermal / r2) + thermal * energy;
        // (dp/dV)_e = -sum A (R - omega/V - omega/(R V^2)) exp(-R V) - omega e/V^2
        let steep = first * (r1 - thermal - thermal * inverse / r1)
            + second * (r2 - thermal - thermal * inverse / r2)
            + thermal * inverse * energy;
        let inside = v * v * (pressure * thermal + steep);
        // Extrapolated range, with da/dmu constant: da/dmu + omega e + p V^2 b.
        let further = volume_ratio.recip() - L::splat(densest);
        let omega = L::splat(k.omega);
        let beyond =
            L::splat(slope) + omega * energy + self.pressure(volume_ratio, energy) * volume_ratio * omega;
        L::select(further.gt(L::zero()), beyond, inside) * L::splat(T::of(1.0) / k.density)
    }
    #[inline(always)]
    fn smallest_volume_ratio(&self) -> T {
        self.beyond.smallest
    }
}
