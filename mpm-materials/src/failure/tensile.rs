//! Spall: failure at a limit of mean tension.

use crate::failure::{Failure, Flag, NoCrack, Observed};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Failure where the mean tension -p exceeds sigma_sp (book, "Failure criteria").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensilePressure<T> {
    strength: T,
}

impl<T: Real> TensilePressure<T> {
    /// Create from the spall strength sigma_sp, Pa.
    ///
    /// # Errors
    /// sigma_sp not positive.
    pub fn new(strength: T) -> Result<Self, ParameterError> {
        Ok(TensilePressure { strength: Check("tensile pressure").positive("spall strength", strength)? })
    }
}

impl<T: Real> Failure<T> for TensilePressure<T> {
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
        old.or(observed.pressure.lt(L::splat(-self.strength)))
    }
}
