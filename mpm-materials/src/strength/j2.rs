//! Von Mises plasticity with isotropic hardening.

use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Fault, Nothing};
use crate::strength::{
    FlowStress, Hardened, Hardening, LinearHardening, Loading, PowerHardening, Return, Strength,
    VoceHardening,
};
use crate::tensor::Sym3;

/// J2 plasticity, independent of rate and temperature: sqrt(3/2 s:s) <= sigma_h(eps_p), radial return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct J2<T, H = LinearHardening<T>> {
    shear: T,
    hardening: H,
}

impl<T: Real> J2<T> {
    /// Create with linear hardening sigma_y = Y0 + H eps_p and shear modulus G, all Pa.
    ///
    /// # Errors
    /// G or Y0 not positive, H negative.
    pub fn linear(shear: T, initial: T, modulus: T) -> Result<Self, ParameterError> {
        J2::new(shear, LinearHardening::new(initial, modulus)?)
    }
}

impl<T: Real> J2<T, PowerHardening<T>> {
    /// Create with Ludwik hardening sigma_y = A + B eps_p^n and shear modulus G; G, A, B in Pa.
    ///
    /// # Errors
    /// G, A or n not positive, B negative.
    pub fn ludwik(shear: T, initial: T, coefficient: T, exponent: T) -> Result<Self, ParameterError> {
        J2::new(shear, PowerHardening::new(initial, coefficient, exponent)?)
    }
}

impl<T: Real> J2<T, VoceHardening<T>> {
    /// Create with Voce hardening sigma_y = A + Q \[1 - exp(-b eps_p)\] and shear modulus G; G, A, Q in Pa.
    ///
    /// # Errors
    /// G or A not positive, Q or b negative.
    pub fn voce(shear: T, initial: T, saturation: T, rate: T) -> Result<Self, ParameterError> {
        J2::new(shear, VoceHardening::new(initial, saturation, rate)?)
    }
}

impl<T: Real, H: Hardening<T>> J2<T, H> {
    /// Create from shear modulus G, Pa, and any hardening.
    ///
    /// # Errors
    /// G not positive.
    pub fn new(shear: T, hardening: H) -> Result<Self, ParameterError> {
        Ok(J2 { shear: Check("J2 plasticity").positive("shear modulus G", shear)?, hardening })
    }

    /// Create from checked constants.
    pub(crate) fn parts(self) -> (T, H) {
        (self.shear, self.hardening)
    }

    pub(crate) fn known(shear: f64, hardening: H) -> Self {
        J2 { shear: T::of(shear), hardening }
    }
}

impl<T: Real, H: Hardening<T>> Strength<T> for J2<T, H> {
    type History<L: Lane<Real = T>> = Hardened<L, Nothing>;

    fn name(&self) -> &'static str {
        "J2 plasticity"
    }
    fn shear_modulus(&self) -> T {
        self.shear
    }
    fn virgin(&self) -> Hardened<T::Single, Nothing> {
        Hardened { plastic_strain: T::Single::zero(), temperature: Nothing }
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        _: &Loading<L>,
        old: &Hardened<L, Nothing>,
    ) -> Return<L, Hardened<L, Nothing>> {
        let squared = trial.dot(trial) * L::of(1.5);
        let bound = self.hardening.lower_bound(old.plastic_strain);
        if !(bound * bound).lt(squared).any() {
            return Return { deviator: *trial, history: *old, plastic_work: L::zero(), fault: Fault::none() };
        }
        let equivalent = squared.sqrt();
        let three_g = L::splat(self.shear * T::of(3.0));
        let strain = old.plastic_strain;
        let increment = self.hardening.increment(equivalent, three_g, L::one(), strain);
        let (deviator, plastic_work) = radial_return(trial, equivalent, three_g, increment.value);
        let history = Hardened { plastic_strain: strain + increment.value, temperature: Nothing };
        Return { deviator, history, plastic_work, fault: increment.fault }
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, history: &Hardened<L, Nothing>) -> L {
        history.plastic_strain
    }
}

impl<T: Real, H: Hardening<T>> FlowStress<T> for J2<T, H> {
    #[inline(always)]
    fn flow_stress<L: Lane<Real = T>>(
        &self,
        _: &Loading<L>,
        _: &Hardened<L, Nothing>,
        new: &Hardened<L, Nothing>,
    ) -> L {
        self.hardening.stress(new.plastic_strain)
    }
}

/// Return the trial deviator of equivalent stress `equivalent` radially by 3 G times the plastic strain increment; also
/// return the plastic work per current volume.
#[inline(always)]
pub(crate) fn radial_return<L: Lane>(
    trial: &Sym3<L>,
    equivalent: L,
    three_g: L,
    increment: L,
) -> (Sym3<L>, L) {
    let relaxed = three_g * increment;
    // Without plastic flow `equivalent` may be zero; the quotient is then not used. The reciprocal does not depend on
    // the increment.
    let shrink = L::select(increment.gt(L::zero()), L::one() - relaxed * equivalent.recip(), L::one());
    (*trial * shrink, (equivalent - relaxed) * increment)
}
