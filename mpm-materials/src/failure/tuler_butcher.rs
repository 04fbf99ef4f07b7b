//! Tuler-Butcher criterion: failure after a time under tension.

use crate::failure::{Failure, NoCrack, Observed};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::state;

state! {
    /// State variable of a criterion with time to failure.
    pub struct Overstressed<L> {
        /// Integral of (sigma_1/sigma_0 - 1)^lambda over time, s.
        pub overstress_time: L,
    }
}

/// Time to failure \[TulerButcher1968\]: failure when the integral over time of (sigma_1/sigma_0 - 1)^lambda, where the
/// largest principal stress sigma_1 exceeds sigma_0, reaches t_f (book, "Damage and time to failure"). In the usual
/// form, integral of (sigma_1 - sigma_0)^lambda = K_f, the constant is K_f = sigma_0^lambda t_f.
///
/// lambda = 1 is a critical impulse, lambda = 2 about a critical energy; a large lambda is a critical stress. A square
/// pulse of stress sigma causes failure after t_f/(sigma/sigma_0 - 1)^lambda. One state variable. Principal values are
/// computed only if some point of the pack is near sigma_0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TulerButcher<T> {
    threshold: T,
    exponent: T,
    time: T,
}

impl<T: Real> TulerButcher<T> {
    /// Create from threshold stress sigma_0, Pa, exponent lambda and time t_f, s, at twice the threshold.
    ///
    /// # Errors
    /// A number that is not positive.
    pub fn new(threshold: T, exponent: T, time: T) -> Result<Self, ParameterError> {
        let check = Check("Tuler-Butcher");
        Ok(TulerButcher {
            threshold: check.positive("threshold stress", threshold)?,
            exponent: check.positive("exponent lambda", exponent)?,
            time: check.positive("time t_f", time)?,
        })
    }
}

impl<T: Real> Failure<T> for TulerButcher<T> {
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = Overstressed<L>;
    fn intact(&self) -> Overstressed<T::Single> {
        Overstressed { overstress_time: T::Single::zero() }
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &Overstressed<L>, _: L) -> L::Mask {
        history.overstress_time.ge(L::splat(self.time))
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &Overstressed<L>) -> Overstressed<L> {
        // sigma_1 <= 2/3 sqrt(3/2 s:s) - p, rounded up a little.
        let bound = observed.deviator.equivalent() * L::of(0.67) - observed.pressure;
        let threshold = L::splat(self.threshold);
        if !bound.gt(threshold).any() {
            return *old;
        }
        let [first, ..] = observed.deviator.principal();
        let over = (first - observed.pressure) * L::splat(T::of(1.0) / self.threshold) - L::one();
        let counts = over.gt(L::zero()) & bound.gt(threshold);
        // Use the base one in lanes without overstress.
        let rate = L::select(counts, over, L::one()).powf(L::splat(self.exponent));
        let grown = (old.overstress_time + rate * observed.dt).min(L::splat(self.time));
        Overstressed { overstress_time: L::select(counts, grown, old.overstress_time) }
    }
}
