//! Post-failure response: stress that a failed point still carries.

use crate::failure::{Failure, Observed, Strain, combine::BearsTension};
use crate::lane::{Lane, Real};

/// Post-failure response. A criterion leaves [`Remains::Compression`] unless it is wrapped: [`LosesTension`],
/// [`LosesShear`], [`Removed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remains {
    /// Compression without shear and tension: rubble.
    Compression,
    /// Compression and shear without mean tension: cracked.
    CompressionAndShear,
    /// Pressure and mean tension without shear: molten.
    Pressure,
    /// Nothing: the point no longer interacts. Its volume and energy stay constant, its mass and momentum are those of
    /// a free particle, so that the balances of the method close with or without it.
    Nothing,
}

impl Remains {
    /// True if shear is carried.
    pub const fn shear(self) -> bool {
        matches!(self, Remains::CompressionAndShear)
    }
    /// True if mean tension is carried.
    pub const fn tension(self) -> bool {
        matches!(self, Remains::Pressure)
    }
    /// True if compression is carried.
    pub const fn compression(self) -> bool {
        !matches!(self, Remains::Nothing)
    }
    /// Combine the responses of two criteria: stress that both carry.
    pub(crate) const fn and(self, other: Self) -> Self {
        if !self.compression() || !other.compression() {
            Remains::Nothing
        } else if self.shear() && other.shear() {
            Remains::CompressionAndShear
        } else if self.tension() && other.tension() {
            Remains::Pressure
        } else {
            Remains::Compression
        }
    }
}

macro_rules! aftermath {
    ($(#[$doc:meta])* $name:ident, $remains:expr $(, $bound:ident)?) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name<F>(
            /// The criterion.
            pub F,
        );

        impl<T: Real, F: Failure<T>> Failure<T> for $name<F>
        $(where
            F::Cracks: $bound,)?
        {
            const POSSIBLE: bool = F::POSSIBLE;
            const REMAINS: Remains = $remains;
            type Cracks = F::Cracks;
            type History<L: Lane<Real = T>> = F::History<L>;
            fn intact(&self) -> Self::History<T::Single> {
                self.0.intact()
            }
            #[inline(always)]
            fn failed<L: Lane<Real = T>>(&self, history: &Self::History<L>, plastic_strain: L) -> L::Mask {
                self.0.failed(history, plastic_strain)
            }
            #[inline(always)]
            fn judge<L: Lane<Real = T>>(
                &self,
                observed: &Observed<L>,
                old: &Self::History<L>,
            ) -> Self::History<L> {
                self.0.judge(observed, old)
            }
            #[inline(always)]
            fn crack_volume<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
                self.0.crack_volume(history)
            }
            #[inline(always)]
            fn opens<L: Lane<Real = T>>(&self, history: &Self::History<L>, pressure: L) -> L::Mask {
                self.0.opens(history, pressure)
            }
            #[inline(always)]
            fn opened<L: Lane<Real = T>>(
        &self,
        strain: &Strain<L>,
        now: &Self::History<L>,
        old: &Self::History<L>,
    ) -> Self::History<L> {
                self.0.opened(strain, now, old)
            }
        }
    };
}

aftermath! {
    /// Criterion after which a point loses only mean tension: the deviator stays, up to the flow stress. With a flow
    /// stress that does not depend on the pressure a principal stress may still be tensile.
    LosesTension, Remains::CompressionAndShear
}
aftermath! {
    /// Criterion after which a point loses only the deviator. Not available for criteria that open a crack: a cracked
    /// point carries no tension.
    LosesShear, Remains::Pressure, BearsTension
}
aftermath! {
    /// Criterion after which a point carries no stress: it does no work, receives none, and its motion can no longer
    /// break the law.
    Removed, Remains::Nothing
}
