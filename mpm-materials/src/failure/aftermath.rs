//! What a failed point still carries.

use crate::failure::{Failure, Observed, Strain, combine::BearsTension};
use crate::lane::{Lane, Real};

/// What a failed point still carries. A criterion leaves [`Remains::Compression`] unless it is wrapped:
/// [`LosesTension`], [`LosesShear`], [`Removed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remains {
    /// Compression: rubble. No shear, no tension.
    Compression,
    /// Compression and shear: cracked. No mean tension.
    CompressionAndShear,
    /// Pressure and mean tension: molten. No shear.
    Pressure,
    /// Nothing: the point no longer interacts. Its volume and energy stay what they were, its mass and momentum are
    /// those of a free particle, so the books of whoever holds it close with or without it.
    Nothing,
}

impl Remains {
    /// Is shear carried?
    pub const fn shear(self) -> bool {
        matches!(self, Remains::CompressionAndShear)
    }
    /// Is mean tension carried?
    pub const fn tension(self) -> bool {
        matches!(self, Remains::Pressure)
    }
    /// Is compression carried?
    pub const fn compression(self) -> bool {
        !matches!(self, Remains::Nothing)
    }
    /// What is left where one of two criteria has failed: the less of both.
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
    /// The same criterion, after which only mean tension is lost: the deviator stays, up to the flow stress. With a
    /// flow stress that does not depend on the pressure a principal stress may still be tensile.
    LosesTension, Remains::CompressionAndShear
}
aftermath! {
    /// The same criterion, after which only the deviator is lost. Not of one that opens a crack: what a
    /// crack has opened in bears no tension.
    LosesShear, Remains::Pressure, BearsTension
}
aftermath! {
    /// The same criterion, after which the point carries nothing at all: it does no work and takes none, and its
    /// motion can no longer break the law.
    Removed, Remains::Nothing
}
