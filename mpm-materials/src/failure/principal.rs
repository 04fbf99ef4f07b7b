//! Failure at a limit of principal or shear stress.

use crate::failure::{Failure, Flag, NoCrack, Observed};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};

/// Failure where the largest principal stress sigma_1 >= sigma_t, or the largest shear stress
/// (sigma_1 - sigma_3)/2 >= tau_f (book, "Failure criteria").
///
/// Principal values are computed only if some point of the pack is near a limit: with q = sqrt(3/2 s:s),
/// sigma_1 <= 2q/3 - p and (sigma_1 - sigma_3)/2 <= q/sqrt 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalStress<T> {
    tension: T,
    shear: T,
}

impl<T: Real> PrincipalStress<T> {
    /// Create from tensile strength sigma_t and shear strength tau_f, Pa; a very large value disables one.
    ///
    /// # Errors
    /// A strength that is not positive and finite.
    pub fn new(tension: T, shear: T) -> Result<Self, ParameterError> {
        let check = Check("principal stress");
        Ok(PrincipalStress {
            tension: check.positive("tensile strength", tension)?,
            shear: check.positive("shear strength", shear)?,
        })
    }
}

impl<T: Real> Failure<T> for PrincipalStress<T> {
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = Flag<L>;
    fn intact(&self) -> Flag<T::Single> {
        Flag::intact()
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &Flag<L>, _: L) -> L::Mask {
        history.is_set()
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &Flag<L>) -> Flag<L> {
        let (tension, shear) = (L::splat(self.tension), L::splat(self.shear));
        let equivalent = observed.deviator.equivalent();
        // Rounded up, so that the bounds exceed the rounded principal values.
        let largest = equivalent * L::of(0.67) - observed.pressure;
        let near = largest.ge(tension) | (equivalent * L::of(0.58)).ge(shear);
        if !near.any() {
            return *old;
        }
        let [first, _, third] = observed.deviator.principal();
        let now = (first - observed.pressure).ge(tension) | ((first - third) * L::of(0.5)).ge(shear);
        // Only lanes whose bound is reached may fail, independent of the other lanes of the pack.
        old.or(now & near)
    }
}
