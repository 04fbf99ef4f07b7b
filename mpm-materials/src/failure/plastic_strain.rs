//! Failure at a limit of plastic strain.

use crate::failure::{Failure, NoCrack, Observed};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Nothing;

/// Failure at eps_p >= eps_f (book, "Failure criteria"; 1.5 to 3 in the public decks). Plastic strain never decreases,
/// so that no state variable is needed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticStrainLimit<T> {
    limit: T,
}

impl<T: Real> PlasticStrainLimit<T> {
    /// Create from the failure strain eps_f.
    ///
    /// # Errors
    /// eps_f not positive.
    pub fn new(limit: T) -> Result<Self, ParameterError> {
        Ok(PlasticStrainLimit { limit: Check("plastic strain limit").positive("failure strain", limit)? })
    }
}

impl<T: Real> Failure<T> for PlasticStrainLimit<T> {
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = Nothing;
    fn intact(&self) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, _: &Nothing, plastic_strain: L) -> L::Mask {
        plastic_strain.ge(L::splat(self.limit))
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, _: &Observed<L>, _: &Nothing) -> Nothing {
        Nothing
    }
}
