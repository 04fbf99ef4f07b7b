//! Unlimited strength.

use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::{Fault, Nothing};
use crate::strength::{Loading, Return, Strength};
use crate::tensor::Sym3;

/// No yield: the deviator stays elastic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Elastic<T> {
    shear: T,
}

impl<T: Real> Elastic<T> {
    /// Create from the shear modulus G, Pa.
    ///
    /// # Errors
    /// G not positive.
    pub fn new(shear: T) -> Result<Self, ParameterError> {
        Ok(Elastic { shear: Check("elastic strength").positive("shear modulus G", shear)? })
    }
}

impl<T: Real> Strength<T> for Elastic<T> {
    type History<L: Lane<Real = T>> = Nothing;

    fn name(&self) -> &'static str {
        "elastic solid"
    }
    fn shear_modulus(&self) -> T {
        self.shear
    }
    fn virgin(&self) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn return_map<L: Lane<Real = T>>(
        &self,
        trial: &Sym3<L>,
        _: &Loading<L>,
        _: &Nothing,
    ) -> Return<L, Nothing> {
        Return { deviator: *trial, history: Nothing, plastic_work: L::zero(), fault: Fault::none() }
    }
    #[inline(always)]
    fn plastic_strain<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::zero()
    }
}
