//! Holmquist-Johnson-Cook concrete.

use crate::eos::crush::{CrushConstants, CrushCurve};
use crate::failure::{Local, Localisation};
use crate::ground::{Admissible, Geomaterial, Trial};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Breakdown, Fault};
use crate::state;
use crate::strength::j2::radial_return;

state! {
    /// State variables of concrete, in addition to stress, volume and energy.
    pub struct Concrete<L> {
        /// Accumulated equivalent plastic strain.
        pub plastic_strain: L,
        /// Damage D in \[0, 1\].
        pub damage: L,
        /// Largest compression mu_max reached on the loading curve, at least mu_crush.
        pub largest_compression: L,
    }
}

/// Volume factor beyond zero pressure at which a fully damaged point counts as debris: far more than one step closes.
const OPEN: f64 = 1.1;

/// Constants of strength and damage of [`HolmquistJohnsonCook`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConcreteConstants<T> {
    /// Reference density rho0, kg/m^3.
    pub density: T,
    /// Shear modulus G, Pa.
    pub shear: T,
    /// Normalised cohesive strength A.
    pub a: T,
    /// Normalised pressure hardening coefficient B.
    pub b: T,
    /// Pressure hardening exponent N.
    pub n: T,
    /// Rate coefficient C.
    pub c: T,
    /// Reference rate, 1/s.
    pub reference_rate: T,
    /// Unconfined compressive strength f_c, Pa.
    pub compressive: T,
    /// Tensile strength T, Pa: the largest mean tension.
    pub tensile: T,
    /// Largest normalised strength S_max.
    pub largest: T,
    /// Damage constant D1.
    pub d1: T,
    /// Damage exponent D2.
    pub d2: T,
    /// Smallest strain to fracture EF_min.
    pub smallest_strain: T,
}

/// Holmquist-Johnson-Cook concrete (\[HolmquistJohnsonCook1993\], book, "Concrete"), a
/// [`Geomaterial`]; `Ground::new` turns it into a law. With P* = P/f_c, T* = T/f_c and rate* the
/// equivalent deviatoric rate over its reference, floored at one:
///
/// - strength sqrt(3/2 s:s)/f_c <= min( \[A (1 - D) + B P*^N\] \[1 + C ln rate*\], S_max ) for P* >= 0,
///   A (1 + P/T) (1 - D) \[1 + C ln rate*\] for P* < 0, zero at P = -T;
/// - pressure on a [`CrushCurve`], not below -T (1 - D);
/// - damage D = sum (d_eps_p + d_mu_p)/(eps_f + mu_f), eps_f + mu_f = max( D1 (P* + T*)^D2, EF_min ).
///
/// The pressure is that at the end of the step, the return radial and exact; damage acts from the next step on, so that
/// it is explicit. A point opened beyond the tension cut-off closes along its unloading line: pressure returns with the
/// density. With [`CrackBand`](crate::CrackBand) the damage by plastic strain depends on the size of the cell. Limits:
/// no energy term, so no shock heating; flow without dilatancy, whose tangent may exceed rho c^2 by some per cent where
/// B matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HolmquistJohnsonCook<T, B = Local> {
    constants: ConcreteConstants<T>,
    crush: CrushCurve<T>,
    localisation: B,
}

impl<T: Real> HolmquistJohnsonCook<T> {
    /// Create from the constants of strength and damage, and the crush curve.
    ///
    /// # Errors
    /// Density, G, N, reference rate, f_c, T, S_max, D1, D2 or EF_min not positive; A, B or C negative.
    pub fn new(constants: ConcreteConstants<T>, crush: CrushCurve<T>) -> Result<Self, ParameterError> {
        let check = Check("HJC concrete");
        let k = &constants;
        for (name, value) in [
            ("density rho0", k.density),
            ("shear modulus G", k.shear),
            ("exponent N", k.n),
            ("reference rate", k.reference_rate),
            ("compressive strength f_c", k.compressive),
            ("tensile strength T", k.tensile),
            ("largest strength S_max", k.largest),
            ("D1", k.d1),
            ("D2", k.d2),
            ("smallest strain EF_min", k.smallest_strain),
        ] {
            check.positive(name, value)?;
        }
        check.not_negative("A", k.a)?;
        check.not_negative("B", k.b)?;
        check.not_negative("C", k.c)?;
        Ok(HolmquistJohnsonCook { constants, crush, localisation: Local })
    }

    /// Concrete of 48 MPa: rho0 2440 kg/m^3, G 14.86 GPa, A 0.79, B 1.60, N 0.61, C 0.007 at 1 /s, f_c 48 MPa,
    /// T 4.0 MPa, S_max 7.0, D1 0.04, D2 1.0, EF_min 0.01; P_crush 16 MPa at 0.001, P_lock 0.80 GPa, mu_lock 0.10,
    /// K1 85, K2 -171, K3 208 GPa (two public sources, book, "Material constants").
    pub fn concrete_48() -> Self {
        let solid = [85e9, -171e9, 208e9].map(T::of);
        let crush = CrushConstants {
            crush_pressure: T::of(16e6),
            crush_compression: T::of(0.001),
            lock_pressure: T::of(0.8e9),
            lock_compression: T::of(0.1),
            solid,
        };
        let constants = ConcreteConstants {
            density: T::of(2440.0),
            shear: T::of(14.86e9),
            a: T::of(0.79),
            b: T::of(1.60),
            n: T::of(0.61),
            c: T::of(0.007),
            reference_rate: T::of(1.0),
            compressive: T::of(48e6),
            tensile: T::of(4e6),
            largest: T::of(7.0),
            d1: T::of(0.04),
            d2: T::of(1.0),
            smallest_strain: T::of(0.01),
        };
        HolmquistJohnsonCook { constants, crush: CrushCurve::known(crush), localisation: Local }
    }
}

impl<T: Real, B: Localisation<T>> HolmquistJohnsonCook<T, B> {
    /// Set the dependence of damage by plastic strain on the size of the cell; damage by crushing of pores does not
    /// depend on it.
    pub fn with_localisation<C: Localisation<T>>(self, localisation: C) -> HolmquistJohnsonCook<T, C> {
        HolmquistJohnsonCook { constants: self.constants, crush: self.crush, localisation }
    }

    /// The crush curve.
    pub fn crush(&self) -> &CrushCurve<T> {
        &self.crush
    }
    /// The constants of strength and damage.
    pub fn constants(&self) -> &ConcreteConstants<T> {
        &self.constants
    }

    /// Strength sqrt(3/2 s:s), Pa, at pressure P, damage and relative rate >= 1.
    #[inline(always)]
    pub fn strength<L: Lane<Real = T>>(&self, pressure: L, damage: L, relative_rate: L) -> L {
        let k = &self.constants;
        let (zero, one) = (L::zero(), L::one());
        let sound = one - damage;
        let relative = pressure * L::splat(T::of(1.0) / k.compressive);
        // The power is negligible below any pressure of interest, and its logarithm needs a positive argument.
        let tiny = L::of(1e-15);
        let hardened = L::splat(k.b) * relative.max(tiny).powf(L::splat(k.n));
        let hardened = L::select(relative.gt(tiny), hardened, zero);
        let cohesion = L::splat(k.a) * sound;
        let opened = (pressure * L::splat(T::of(1.0) / k.tensile) + one).max(zero);
        let still = L::select(pressure.ge(zero), cohesion + hardened, cohesion * opened);
        let rate = L::splat(k.c).mul_add(relative_rate.ln(), one);
        (still * rate).min(L::splat(k.largest)) * L::splat(k.compressive)
    }

    /// Strain to fracture eps_f + mu_f at pressure P.
    #[inline(always)]
    pub fn fracture_strain<L: Lane<Real = T>>(&self, pressure: L) -> L {
        let k = &self.constants;
        let relative = (pressure + L::splat(k.tensile)) * L::splat(T::of(1.0) / k.compressive);
        let tiny = L::of(1e-15);
        let clipped = relative.max(tiny);
        // Usual exponent: the branch is uniform over all points.
        let power = if k.d2 == T::of(1.0) { clipped } else { clipped.powf(L::splat(k.d2)) };
        (L::splat(k.d1) * power).max(L::splat(k.smallest_strain))
    }

    /// Lower bound of the strength, cheap to compute: without friction and rate.
    #[inline(always)]
    fn cohesion<L: Lane<Real = T>>(&self, pressure: L, damage: L) -> L {
        let k = &self.constants;
        let one = L::one();
        let opened = (pressure * L::splat(T::of(1.0) / k.tensile) + one).clamp(L::zero(), one);
        (L::splat(k.a) * (one - damage) * opened).min(L::splat(k.largest)) * L::splat(k.compressive)
    }
}

impl<T: Real, B: Localisation<T>> Geomaterial<T> for HolmquistJohnsonCook<T, B> {
    type History<L: Lane<Real = T>> = Concrete<L>;

    fn name(&self) -> &'static str {
        "HJC concrete"
    }
    fn density(&self) -> T {
        self.constants.density
    }
    fn shear_modulus(&self) -> T {
        self.constants.shear
    }
    fn virgin(&self) -> Concrete<T::Single> {
        let zero = T::Single::zero();
        let largest_compression = T::Single::splat(self.crush.crush_compression());
        Concrete { plastic_strain: zero, damage: zero, largest_compression }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Trial<L>,
        old: &Concrete<L>,
    ) -> Admissible<L, Concrete<L>> {
        let k = &self.constants;
        let (zero, one) = (L::zero(), L::one());
        let mu = trial.volume_ratio.recip() - one;
        let largest = old.largest_compression.max(mu);
        let cut_off = L::splat(-k.tensile) * (one - old.damage);
        let pressure = self.crush.pressure(mu, largest).max(cut_off);

        // A maximum may mask NaN.
        let fault = Fault::none().require((mu + old.damage).is_finite(), Breakdown::NotFinite);
        let equivalent = trial.deviator.equivalent();
        let crushes = mu.gt(old.largest_compression);
        if !(self.cohesion(pressure, old.damage).lt(equivalent) | crushes).any() {
            return Admissible { deviator: trial.deviator, pressure, history: *old, fault };
        }

        let rate = (trial.equivalent_rate() * L::splat(T::of(1.0) / k.reference_rate)).max(one);
        let limit = self.strength(pressure, old.damage, rate);
        let three_g = L::splat(k.shear * T::of(3.0));
        let increment = (equivalent - limit).max(zero) / three_g;
        let (deviator, _) = radial_return(&trial.deviator, equivalent, three_g, increment);

        let crushed = (self.crush.crushing(largest) - self.crush.crushing(old.largest_compression)).max(zero);
        let sheared = self.localisation.weight(trial.length) * increment;
        let grown = (sheared + crushed) / self.fracture_strain(pressure);
        let history = Concrete {
            plastic_strain: old.plastic_strain + increment,
            damage: (old.damage + grown).min(one),
            largest_compression: largest,
        };
        Admissible { deviator, pressure, history, fault }
    }
    #[inline(always)]
    fn bulk_modulus<L: Lane<Real = T>>(&self, volume_ratio: L, history: &Concrete<L>) -> L {
        let largest = history.largest_compression;
        let slope = self.crush.unloading_slope(largest).max(self.crush.loading_slope(largest));
        slope / volume_ratio
    }
    /// Zero for a fully damaged point that is open by a tenth of its volume beyond the end of its unloading line: its
    /// strength at zero pressure is zero.
    #[inline(always)]
    fn shear_stiffness<L: Lane<Real = T>>(&self, volume_ratio: L, history: &Concrete<L>) -> L {
        let (zero, one) = (L::zero(), L::one());
        let closed = self
            .crush
            .pressure((volume_ratio * L::of(1.0 / OPEN)).recip() - one, history.largest_compression);
        let torn = history.damage.ge(one) & closed.lt(zero);
        L::select(torn, zero, L::splat(self.constants.shear))
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Concrete<L>) -> L {
        history.plastic_strain
    }
    #[inline(always)]
    fn damage<L: Lane<Real = T>>(&self, history: &Concrete<L>) -> L {
        history.damage
    }
}
