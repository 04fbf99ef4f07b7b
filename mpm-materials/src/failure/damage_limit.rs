//! Failure at a limit of the damage of a strength.

use crate::failure::{Failure, Flag, NoCrack, Observed};
use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Failure where the damage of the strength, [`Strength::damage`](crate::Strength::damage), reaches D_c: for use with
/// [`Borvik`](crate::strength::Borvik), whose damage softens the flow stress before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DamageLimit<T> {
    limit: T,
}

impl<T: Real> DamageLimit<T> {
    /// Create from the critical damage D_c.
    ///
    /// # Errors
    /// D_c outside (0, 1\].
    pub fn new(limit: T) -> Result<Self, ParameterError> {
        let inside = limit > T::of(0.0) && limit <= T::of(1.0);
        let limit = Check("damage limit").that(inside, "critical damage", limit, "above 0 and at most 1")?;
        Ok(DamageLimit { limit })
    }

    /// Create from a checked limit.
    pub(crate) fn known(limit: T) -> Self {
        DamageLimit { limit }
    }
}

impl<T: Real> Failure<T> for DamageLimit<T> {
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
        old.or(observed.damage.ge(L::splat(self.limit)))
    }
}
