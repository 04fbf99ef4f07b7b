//! Johnson-Cook strength.

use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Fault, Nothing, State};
use crate::strength::j2::radial_return;
use crate::strength::{FlowStress, Hardened, Hardening, Loading, PowerHardening, Return, Strength};
use crate::tensor::Sym3;

/// Johnson-Cook flow stress sigma_y = (A + B eps_p^n) R(rate) S(T) (book, "Johnson-Cook").
///
/// The rate factor R is a type: [`RateIndependent`] (C = 0, costs nothing), [`Logarithmic`] or [`SmoothLogarithmic`].
/// The thermal model is a type, too: [`Isothermal`] has no temperature and S = 1, [`Adiabatic`] heats.
///
/// The return is radial. Hardening is implicit: the yield condition holds at the new plastic strain to the
/// rounding of the hardening curve (1e-9 of the flow stress or better). The rate is the total deviatoric rate
/// of the step, the temperature that at its start, so both are explicit.
///
/// Limits: the rate factor is an extrapolation above 1e4 to 1e5 per second; at the melting temperature the
/// strength is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JohnsonCook<T, R = RateIndependent, H = Isothermal, K = PowerHardening<T>> {
    shear: T,
    hardening: K,
    rate: R,
    thermal: H,
}

/// Johnson-Cook with the standard rate factor and no temperature.
pub type SimplifiedJohnsonCook<T> = JohnsonCook<T, Logarithmic<T>>;

/// Johnson-Cook with the standard rate factor, heating and thermal softening.
pub type AdiabaticJohnsonCook<T> = JohnsonCook<T, Logarithmic<T>, Adiabatic<T>>;

impl<T: Real> JohnsonCook<T> {
    /// Create with sigma_y = A + B eps_p^n and shear modulus G; G, A, B in Pa. Add rate and temperature by
    /// [`JohnsonCook::with_rate`] and [`JohnsonCook::with_heat`].
    ///
    /// # Errors
    /// G, A or n not positive, B negative.
    pub fn new(shear: T, initial: T, coefficient: T, exponent: T) -> Result<Self, ParameterError> {
        let shear = Check("Johnson-Cook").positive("shear modulus G", shear)?;
        let hardening = PowerHardening::new(initial, coefficient, exponent)?;
        Ok(JohnsonCook { shear, hardening, rate: RateIndependent, thermal: Isothermal })
    }

    /// Create simplified Johnson-Cook, without temperature: sigma_y = (A + B eps_p^n)(1 + C ln max(rate*, 1)), with
    /// shear modulus G; G, A, B in Pa, the reference rate in 1/s.
    ///
    /// The routine of MPM3D-F90 of this name floors rate* at 0.001 instead, which lowers the rate factor at rest by
    /// 6.9 C (book, "Johnson-Cook").
    ///
    /// # Errors
    /// G, A, n or the reference rate not positive, B or C negative.
    pub fn simplified(
        shear: T,
        [initial, coefficient, exponent]: [T; 3],
        c: T,
        reference: T,
    ) -> Result<SimplifiedJohnsonCook<T>, ParameterError> {
        let plain = JohnsonCook::new(shear, initial, coefficient, exponent)?;
        Ok(plain.with_rate(Logarithmic::new(c, reference)?))
    }

    /// OFHC copper as fitted to the Taylor tests of Johnson and Holmquist 1988: A 157 MPa, B 425 MPa, n 1,
    /// C 0; G = E/2(1 + nu) from E 117 GPa, nu 0.35 (MPM3D-F90 `Taylor.mpm`; book, "Material constants").
    pub fn copper_taylor() -> Self {
        Self::known([117e9 / 2.7, 157e6, 425e6, 1.0])
    }

    /// Lead: A 12 MPa, B 125 MPa, n 1, C 0; G from E 22.4 GPa, nu 0.42 (MPM3D-F90
    /// `LeadHypervelocityImpact.mpm`; book, "Material constants").
    pub fn lead() -> Self {
        Self::known([22.4e9 / 2.84, 12e6, 125e6, 1.0])
    }

    /// OFHC copper, the standard set: A 90 MPa, B 292 MPa, n 0.31, C 0.025 at 1 /s, m 1.09, T_melt 1356 K,
    /// T_room 294 K, c_p 383 J/(kg K), Taylor-Quinney 0.9, G 47.7 GPa (Steinberg). Sources:
    /// book, "Material constants". Ambient 294 K is the lower of the range given there.
    pub fn copper() -> AdiabaticJohnsonCook<T> {
        Self::adiabatic([47.7e9, 90e6, 292e6, 0.31], 0.025, [294.0, 1356.0, 1.09, 383.0])
    }

    /// 6061-T6 aluminium: A 324 MPa, B 114 MPa, n 0.42, C 0.002 at 1 /s, m 1.34, T_melt 925 K, T_room 294 K,
    /// c 896 J/(kg K), G 26 GPa (Uintah; book, "Material constants"); Taylor-Quinney 0.9.
    pub fn aluminium_6061() -> AdiabaticJohnsonCook<T> {
        Self::adiabatic([26.0e9, 324e6, 114e6, 0.42], 0.002, [294.0, 925.0, 1.34, 896.0])
    }

    /// 2024-T3 aluminium: A 369 MPa, B 684 MPa, n 0.73, C 0.0083 at 1 /s, m 1.7, T_melt 775 K (\[Lesuer2000\] as in public decks);
    /// G 28.6 GPa and c 863 J/(kg K) of 2024-T4 (Steinberg, in Uintah; book, "Material constants"); T_room 294 K, Taylor-Quinney 0.9.
    pub fn aluminium_2024_t3() -> AdiabaticJohnsonCook<T> {
        Self::adiabatic([28.6e9, 369e6, 684e6, 0.73], 0.0083, [294.0, 775.0, 1.7, 863.0])
    }

    /// 4340 steel: A 792 MPa, B 510 MPa, n 0.26, C 0.014 at 1 /s, m 1.03, T_melt 1793 K, c 477 J/(kg K),
    /// G 80 GPa (Uintah; book, "Material constants"); T_room 294 K, Taylor-Quinney 0.9.
    pub fn steel_4340() -> AdiabaticJohnsonCook<T> {
        Self::adiabatic([80.0e9, 792e6, 510e6, 0.26], 0.014, [294.0, 1793.0, 1.03, 477.0])
    }

    /// Tungsten alloy: A 1507 MPa, B 177 MPa, n 0.12, C 0.016 at 1 /s, m 1.0 (Uintah; book, "Material constants"); G 145 GPa of
    /// W-Ni-Fe (Steinberg, same source). T_melt 1723 K and c 134 J/(kg K) are from memory of the literature; T_room 294 K,
    /// Taylor-Quinney 0.9.
    pub fn tungsten_alloy() -> AdiabaticJohnsonCook<T> {
        Self::adiabatic([145e9, 1507e6, 177e6, 0.12], 0.016, [294.0, 1723.0, 1.0, 134.0])
    }

    /// Weldox 460 E steel, the later set, not coupled to damage: A 499 MPa, B 382 MPa, n 0.458, G = E/2(1 + nu) from E 211 GPa, nu 0.33
    /// (karamelo; book, "Material constants"). C 0.0079 at 5e-4 /s, m 0.893, T_melt 1800 K, T_room 293 K and c_p 452 J/(kg K) are from
    /// memory of the literature; Taylor-Quinney 0.9.
    pub fn weldox_460_e() -> AdiabaticJohnsonCook<T> {
        let curve = [211e9 / 2.66, 499e6, 382e6, 0.458];
        let rate = Logarithmic { c: T::of(0.0079), reference: T::of(5e-4) };
        JohnsonCook { rate, ..Self::adiabatic(curve, 0.0079, [293.0, 1800.0, 0.893, 452.0]) }
    }

    pub(crate) fn adiabatic(
        curve: [f64; 4],
        c: f64,
        [room, melt, exponent, heat_capacity]: [f64; 4],
    ) -> AdiabaticJohnsonCook<T> {
        let JohnsonCook { shear, hardening, .. } = JohnsonCook::known(curve);
        let heat = Heat {
            room: T::of(room),
            melt: T::of(melt),
            exponent: T::of(exponent),
            heat_capacity: T::of(heat_capacity),
            taylor_quinney: T::of(0.9),
        };
        let rate = Logarithmic { c: T::of(c), reference: T::of(1.0) };
        JohnsonCook { shear, hardening, rate, thermal: Adiabatic { heat } }
    }

    pub(crate) fn known([shear, initial, coefficient, exponent]: [f64; 4]) -> Self {
        let hardening = PowerHardening::known(T::of(initial), T::of(coefficient), T::of(exponent));
        JohnsonCook { shear: T::of(shear), hardening, rate: RateIndependent, thermal: Isothermal }
    }
}

impl<T: Real, K: Hardening<T>> JohnsonCook<T, RateIndependent, Isothermal, K> {
    /// Create the rate-independent isothermal law of a shear modulus, Pa, and any hardening.
    ///
    /// # Errors
    /// A shear modulus that is not positive.
    pub fn from_hardening(shear: T, hardening: K) -> Result<Self, ParameterError> {
        let shear = Check("J2 plasticity").positive("shear modulus G", shear)?;
        Ok(JohnsonCook { shear, hardening, rate: RateIndependent, thermal: Isothermal })
    }
}

impl<T: Real, R, H, K> JohnsonCook<T, R, H, K> {
    /// Set the rate factor.
    pub fn with_rate<Q: RateFactor<T>>(self, rate: Q) -> JohnsonCook<T, Q, H, K> {
        JohnsonCook { shear: self.shear, hardening: self.hardening, rate, thermal: self.thermal }
    }
    /// Set the thermal model.
    pub fn with_heat<Q: Thermal<T>>(self, thermal: Q) -> JohnsonCook<T, R, Q, K> {
        JohnsonCook { shear: self.shear, hardening: self.hardening, rate: self.rate, thermal }
    }
    /// Set the shear modulus G, Pa.
    ///
    /// # Errors
    /// G not positive.
    pub fn with_shear_modulus(self, shear: T) -> Result<Self, ParameterError> {
        Ok(JohnsonCook { shear: Check("Johnson-Cook").positive("shear modulus G", shear)?, ..self })
    }
    pub(crate) fn of_parts(shear: T, hardening: K, rate: R, thermal: H) -> Self {
        JohnsonCook { shear, hardening, rate, thermal }
    }
    pub(crate) fn parts(self) -> (T, K, R, H) {
        (self.shear, self.hardening, self.rate, self.thermal)
    }
    pub(crate) fn thermal(&self) -> &H {
        &self.thermal
    }
}

impl<T: Real, R: RateFactor<T>, H: Thermal<T>, K: Hardening<T>> Strength<T> for JohnsonCook<T, R, H, K> {
    type History<L: Lane<Real = T>> = Hardened<L, H::Temperature<L>>;

    fn name(&self) -> &'static str {
        "Johnson-Cook"
    }
    fn shear_modulus(&self) -> T {
        self.shear
    }
    fn virgin(&self) -> Self::History<T::Single> {
        Hardened { plastic_strain: T::Single::zero(), temperature: self.thermal.virgin() }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        loading: &Loading<L>,
        old: &Self::History<L>,
    ) -> Return<L, Self::History<L>> {
        // Lower bound of the flow stress without ln or exp, since the rate factor is at least one.
        let cold = self.hardening.lower_bound(old.plastic_strain);
        let bound = cold * self.thermal.softening_bound(&old.temperature);
        let squared = trial.dot(trial) * L::of(1.5);
        if !(bound * bound).lt(squared).any() {
            return Return { deviator: *trial, history: *old, plastic_work: L::zero(), fault: Fault::none() };
        }
        let equivalent = squared.sqrt();
        let factor = self.rate.factor(loading) * self.thermal.softening(&old.temperature);
        let three_g = L::splat(self.shear * T::of(3.0));
        let increment = self.hardening.increment(equivalent, three_g, factor, old.plastic_strain);
        let (deviator, plastic_work) = radial_return(trial, equivalent, three_g, increment.value);
        let history = Hardened {
            plastic_strain: old.plastic_strain + increment.value,
            temperature: self.thermal.heated(&old.temperature, plastic_work * loading.specific_volume),
        };
        Return { deviator, history, plastic_work, fault: increment.fault }
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        history.plastic_strain
    }
    #[inline(always)]
    fn homologous_temperature<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        self.thermal.homologous(&history.temperature)
    }
}

impl<T: Real, R: RateFactor<T>, H: Thermal<T>, K: Hardening<T>> FlowStress<T> for JohnsonCook<T, R, H, K> {
    #[inline(always)]
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        loading: &Loading<L>,
        old: &Self::History<L>,
        new: &Self::History<L>,
    ) -> L {
        let factor = self.rate.factor(loading) * self.thermal.softening(&old.temperature);
        factor * self.hardening.stress(new.plastic_strain)
    }
}

/// Rate factor R of the flow stress.
pub trait RateFactor<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// Rate factor R >= 1, dimensionless.
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>) -> L;
}

/// Rate factor R = 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateIndependent;

impl<T: Real> RateFactor<T> for RateIndependent {
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, _: &Loading<L>) -> L {
        L::one()
    }
}

/// Standard rate factor R = 1 + C ln max(rate/rate0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Logarithmic<T> {
    c: T,
    reference: T,
}

impl<T: Real> Logarithmic<T> {
    /// Create from C and the reference rate rate0, 1/s.
    ///
    /// # Errors
    /// C negative or rate0 not positive.
    pub fn new(c: T, reference: T) -> Result<Self, ParameterError> {
        let (c, reference) = rate_constants(c, reference)?;
        Ok(Logarithmic { c, reference })
    }
}

impl<T: Real> RateFactor<T> for Logarithmic<T> {
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>) -> L {
        let relative = loading.equivalent_rate() * L::splat(T::of(1.0) / self.reference);
        L::splat(self.c).mul_add(relative.max(L::one()).ln(), L::one())
    }
}

/// Rate factor R = 1 + C ln(1 + rate/rate0), smooth at rest (Feng 2014); above the standard factor by at most C ln 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothLogarithmic<T> {
    c: T,
    reference: T,
}

impl<T: Real> SmoothLogarithmic<T> {
    /// Create from C and the reference rate rate0, 1/s.
    ///
    /// # Errors
    /// C negative or rate0 not positive.
    pub fn new(c: T, reference: T) -> Result<Self, ParameterError> {
        let (c, reference) = rate_constants(c, reference)?;
        Ok(SmoothLogarithmic { c, reference })
    }
}

impl<T: Real> RateFactor<T> for SmoothLogarithmic<T> {
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>) -> L {
        let relative = loading.equivalent_rate() * L::splat(T::of(1.0) / self.reference);
        L::splat(self.c).mul_add((relative + L::one()).ln(), L::one())
    }
}

fn rate_constants<T: Real>(c: T, reference: T) -> Result<(T, T), ParameterError> {
    let check = Check("Johnson-Cook rate factor");
    Ok((check.not_negative("rate coefficient C", c)?, check.positive("reference rate", reference)?))
}

/// Thermal model: temperature of a point and thermal softening.
pub trait Thermal<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// The temperature column, or [`Nothing`].
    type Temperature<L: Lane<Real = T>>: State<L>;
    /// The temperature of a virgin point.
    fn virgin(&self) -> Self::Temperature<T::Single>;
    /// Homologous temperature T* in \[0, 1\]; zero for a law without temperature.
    #[inline(always)]
    fn homologous<L: Lane<Real = T>>(&self, temperature: &Self::Temperature<L>) -> L {
        let _ = temperature;
        L::zero()
    }
    /// Thermal softening factor S in \[0, 1\].
    fn softening<L: Lane<Real = T>>(&self, temperature: &Self::Temperature<L>) -> L;
    /// Lower bound of S, cheap to compute, not below zero.
    fn softening_bound<L: Lane<Real = T>>(&self, temperature: &Self::Temperature<L>) -> L;
    /// Return the temperature after `work` J/kg of plastic work.
    fn heated<L: Lane<Real = T>>(&self, temperature: &Self::Temperature<L>, work: L) -> Self::Temperature<L>;
}

/// No temperature: S = 1, no column.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Isothermal;

impl<T: Real> Thermal<T> for Isothermal {
    type Temperature<L: Lane<Real = T>> = Nothing;
    fn virgin(&self) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn softening<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::one()
    }
    #[inline(always)]
    fn softening_bound<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::one()
    }
    #[inline(always)]
    fn heated<L: Lane<Real = T>>(&self, _: &Nothing, _: L) -> Nothing {
        Nothing
    }
}

/// The constants of heating and thermal softening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heat<T> {
    /// Room temperature, K; also that of a virgin point.
    pub room: T,
    /// Melting temperature, K.
    pub melt: T,
    /// Softening exponent m.
    pub exponent: T,
    /// Specific heat capacity c_p, J/(kg K).
    pub heat_capacity: T,
    /// Taylor-Quinney coefficient chi: fraction of the plastic work that becomes heat.
    pub taylor_quinney: T,
}

/// Adiabatic heating dT = chi sigma_y d_eps_p / (rho c_p) and softening S = 1 - T*^m with
/// T* = (T - T_room)/(T_melt - T_room) clipped to \[0, 1\]. The softening of a step uses the temperature at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adiabatic<T> {
    heat: Heat<T>,
}

impl<T: Real> Adiabatic<T> {
    /// Create from constants.
    ///
    /// # Errors
    /// Room temperature negative, melting temperature not above it, m or c_p not positive, chi outside \[0, 1\].
    pub fn new(heat: Heat<T>) -> Result<Self, ParameterError> {
        let check = Check("Johnson-Cook heat");
        let chi = heat.taylor_quinney;
        check.not_negative("room temperature", heat.room)?;
        check.that(heat.melt > heat.room, "melting temperature", heat.melt, "above room temperature")?;
        check.positive("softening exponent m", heat.exponent)?;
        check.positive("heat capacity", heat.heat_capacity)?;
        check.that(chi >= T::of(0.0) && chi <= T::of(1.0), "Taylor-Quinney coefficient", chi, "in [0, 1]")?;
        Ok(Adiabatic { heat })
    }

    /// Create from checked constants.
    pub(crate) fn known(heat: Heat<T>) -> Self {
        Adiabatic { heat }
    }
}

impl<T: Real> Thermal<T> for Adiabatic<T> {
    type Temperature<L: Lane<Real = T>> = L;
    fn virgin(&self) -> T::Single {
        T::Single::splat(self.heat.room)
    }
    #[inline(always)]
    fn homologous<L: Lane<Real = T>>(&self, temperature: &L) -> L {
        let per_range = L::splat(T::of(1.0) / (self.heat.melt - self.heat.room));
        ((*temperature - L::splat(self.heat.room)) * per_range).clamp(L::zero(), L::one())
    }
    #[inline(always)]
    fn softening<L: Lane<Real = T>>(&self, temperature: &L) -> L {
        let t = self.homologous(temperature);
        if self.heat.exponent == T::of(1.0) {
            return L::one() - t;
        }
        // Far below one kelvin the power is negligible, and its logarithm needs a positive argument.
        let tiny = L::of(1e-12);
        let softened = L::one() - t.max(tiny).powf(L::splat(self.heat.exponent));
        L::select(t.gt(tiny), softened, L::one())
    }
    /// Lower bound 1 - t^m >= min(1, m) (1 - t): the chord for m >= 1, the tangent at t = 1 for m < 1.
    #[inline(always)]
    fn softening_bound<L: Lane<Real = T>>(&self, temperature: &L) -> L {
        let slope = if self.heat.exponent < T::of(1.0) { self.heat.exponent } else { T::of(1.0) };
        (L::one() - self.homologous(temperature)) * L::splat(slope)
    }
    #[inline(always)]
    fn heated<L: Lane<Real = T>>(&self, temperature: &L, work: L) -> L {
        L::splat(self.heat.taylor_quinney / self.heat.heat_capacity).mul_add(work, *temperature)
    }
}
