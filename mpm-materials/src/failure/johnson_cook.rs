//! Johnson-Cook damage.

use crate::failure::{Failure, Local, Localisation, NoCrack, Observed};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::state;

state! {
    /// State variable of a criterion with accumulated damage.
    pub struct Damaged<L> {
        /// Damage D in \[0, 1\]; the point has failed at one.
        pub failure_damage: L,
    }
}

/// Smallest failure strain unless stated otherwise.
const SMALLEST: f64 = 1e-6;
/// Largest exponent: beyond it the failure strain is unreachable.
const STEEPEST: f64 = 80.0;

/// Johnson-Cook damage D = sum of d_eps_p/eps_f, failure at D = 1, with (\[JohnsonCook1985\], book, "Damage and time to
/// failure")
///
/// eps_f = \[D1 + D2 exp(D3 s*)\] \[1 + D4 ln max(rate*, 1)\] \[1 + D5 T*\],
///
/// s* = -p/sqrt(3/2 s:s) the triaxiality, **tension positive**, so that D3 is negative for metals that tension
/// embrittles; rate* the plastic strain rate of the step over rate0; T* the homologous temperature of the strength
/// (zero for one without temperature). eps_f is floored, since the fit may fall below zero in strong tension (the
/// set of 6061-T6 does at s* = 1.35).
///
/// Damage does not soften: the point carries its full flow stress until it fails, then the stress selected by
/// [`Remains`](crate::failure::Remains). With [`CrackBand`](crate::failure::CrackBand) the failure strain depends on
/// the size of the cell. One state variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JohnsonCookDamage<T, B = Local> {
    d: [T; 5],
    reference: T,
    smallest: T,
    localisation: B,
}

impl<T: Real> JohnsonCookDamage<T> {
    /// Create from D1 to D5 and the reference rate rate0, 1/s.
    ///
    /// # Errors
    /// A constant that is not finite, D2 negative, rate0 not positive.
    pub fn new(d: [T; 5], reference: T) -> Result<Self, ParameterError> {
        let check = Check("Johnson-Cook damage");
        for (name, value) in ["D1", "D2", "D3", "D4", "D5"].into_iter().zip(d) {
            check.that(true, name, value, "finite")?;
        }
        check.not_negative("D2", d[1])?;
        check.positive("reference rate", reference)?;
        Ok(JohnsonCookDamage { d, reference, smallest: T::of(SMALLEST), localisation: Local })
    }

    /// 6061-T6 aluminium: -0.77, 1.45, -0.47, 0, 1.60 (Uintah `JCDamage6061T6Al.xml`; book, "Material constants").
    pub fn aluminium_6061() -> Self {
        Self::known([-0.77, 1.45, -0.47, 0.0, 1.60])
    }

    /// 2024-T3 aluminium: 0.13, 0.13, -1.5, 0.011, 0 (\[Lesuer2000\] as in two public decks; book, "Material constants").
    pub fn aluminium_2024_t3() -> Self {
        Self::known([0.13, 0.13, -1.5, 0.011, 0.0])
    }

    /// OFHC copper: 0.54, 4.89, -3.03, 0.014, 1.12 (\[JohnsonCook1985\] as in Uintah; book, "Material constants").
    pub fn copper_ofhc() -> Self {
        Self::known([0.54, 4.89, -3.03, 0.014, 1.12])
    }

    /// 4340 steel: 0.05, 3.44, -2.12, 0.002, 0.61 (\[JohnsonCook1985\] as in Uintah; book, "Material constants").
    pub fn steel_4340() -> Self {
        Self::known([0.05, 3.44, -2.12, 0.002, 0.61])
    }

    /// Weldox 460 E steel, the later set: 0.636, 1.936, -2.969 (karamelo; book, "Material constants"), -0.014, 1.014 at 5e-4 /s (from
    /// memory of the literature).
    pub fn weldox_460_e() -> Self {
        let reference = T::of(5e-4);
        JohnsonCookDamage { reference, ..Self::known([0.636, 1.936, -2.969, -0.014, 1.014]) }
    }

    fn known(d: [f64; 5]) -> Self {
        let one = T::of(1.0);
        JohnsonCookDamage { d: d.map(T::of), reference: one, smallest: T::of(SMALLEST), localisation: Local }
    }
}

impl<T: Real, B: Localisation<T>> JohnsonCookDamage<T, B> {
    /// Set the lower bound of the failure strain.
    ///
    /// # Errors
    /// A floor that is not positive.
    pub fn with_smallest_strain(self, smallest: T) -> Result<Self, ParameterError> {
        let smallest = Check("Johnson-Cook damage").positive("smallest failure strain", smallest)?;
        Ok(JohnsonCookDamage { smallest, ..self })
    }
    pub(crate) fn localisation(&self) -> B {
        self.localisation
    }
    /// Set the dependence on the size of the cell.
    pub fn with_localisation<C: Localisation<T>>(self, localisation: C) -> JohnsonCookDamage<T, C> {
        let JohnsonCookDamage { d, reference, smallest, .. } = self;
        JohnsonCookDamage { d, reference, smallest, localisation }
    }

    /// Failure strain eps_f at triaxiality s*, relative plastic strain rate and homologous temperature.
    #[inline(always)]
    pub fn failure_strain<L: Lane<Real = T>>(&self, triaxiality: L, rate: L, temperature: L) -> L {
        let [d1, d2, d3, d4, d5] = self.d;
        let (one, steepest) = (L::one(), L::of(STEEPEST));
        let exponent = (L::splat(d3) * triaxiality).clamp(-steepest, steepest);
        let ductile = L::splat(d2).mul_add(exponent.exp(), L::splat(d1));
        let fast = L::splat(d4).mul_add(rate.max(one).ln(), one);
        let hot = L::splat(d5).mul_add(temperature, one);
        (ductile * fast * hot).max(L::splat(self.smallest))
    }
}

impl<T: Real, B: Localisation<T>> Failure<T> for JohnsonCookDamage<T, B> {
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = Damaged<L>;
    fn intact(&self) -> Damaged<T::Single> {
        Damaged { failure_damage: T::Single::zero() }
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &Damaged<L>, _: L) -> L::Mask {
        history.failure_damage.ge(L::one())
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &Damaged<L>) -> Damaged<L> {
        let increment = observed.plastic_strain_increment;
        if !increment.gt(L::zero()).any() {
            return *old;
        }
        // Without plastic flow the equivalent stress may be zero; no damage is added there.
        let equivalent = observed.deviator.equivalent().max(L::of(1e-20));
        let triaxiality = -(observed.pressure / equivalent);
        let rate = increment / (observed.dt * L::splat(self.reference));
        let strain = self.failure_strain(triaxiality, rate, observed.homologous_temperature);
        let grown = self.localisation.weight(observed.length) * increment / strain;
        Damaged { failure_damage: (old.failure_damage + grown).min(L::one()) }
    }
}
