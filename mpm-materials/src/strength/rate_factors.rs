//! Additional rate factors for [`JohnsonCook`](crate::JohnsonCook).

use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};
use crate::strength::{Loading, RateFactor};

/// Power rate factor R = (1 + rate/rate0)^C, the power form of the Johnson-Cook factor (\[Borvik2001\], book, "Other
/// flow stresses"). Smooth at rest; for small C and high rates 1 + C ln rate* to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerRate<T> {
    c: T,
    reference: T,
}

impl<T: Real> PowerRate<T> {
    /// Create from C and the reference rate rate0, 1/s.
    ///
    /// # Errors
    /// C negative or rate0 not positive.
    pub fn new(c: T, reference: T) -> Result<Self, ParameterError> {
        let check = Check("power rate factor");
        check.not_negative("rate coefficient C", c)?;
        Ok(PowerRate { c, reference: check.positive("reference rate", reference)? })
    }
    pub(crate) fn known(c: f64, reference: f64) -> Self {
        PowerRate { c: T::of(c), reference: T::of(reference) }
    }
    /// Rate factor R at a strain rate, 1/s.
    #[inline(always)]
    pub fn at<L: Lane<Real = T>>(&self, rate: L) -> L {
        rate.mul_add(L::splat(T::of(1.0) / self.reference), L::one()).powf(L::splat(self.c))
    }
}

impl<T: Real> RateFactor<T> for PowerRate<T> {
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>) -> L {
        self.at(loading.equivalent_rate())
    }
}

/// Cowper-Symonds rate factor R = 1 + (rate/D)^(1/q) (book, "Other flow stresses").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CowperSymonds<T> {
    reference: T,
    exponent: T,
}

impl<T: Real> CowperSymonds<T> {
    /// Create from D, 1/s, the rate that doubles the flow stress, and q.
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn new(reference: T, exponent: T) -> Result<Self, ParameterError> {
        let check = Check("Cowper-Symonds");
        Ok(CowperSymonds {
            reference: check.positive("reference rate D", reference)?,
            exponent: check.positive("exponent q", exponent)?,
        })
    }
}

impl<T: Real> RateFactor<T> for CowperSymonds<T> {
    #[inline(always)]
    fn factor<L: Lane<Real = T>>(&self, loading: &Loading<L>) -> L {
        let relative = loading.equivalent_rate() * L::splat(T::of(1.0) / self.reference);
        // The power is negligible below this, unless q is very large, and its logarithm needs a positive argument.
        let tiny = L::of(1e-30);
        let power = relative.max(tiny).powf(L::splat(T::of(1.0) / self.exponent));
        L::one() + L::select(relative.gt(tiny), power, L::zero())
    }
}
