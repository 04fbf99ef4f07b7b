//! Regularisation of softening and damage by the size of the cell.

use crate::lane::{Lane, Real};
use crate::parameter::{Check, ParameterError};

/// Weight of a strain increment in a damage law.
///
/// Strain localises in a softening point, so that a crack is one cell wide for any cell size, and the energy of a new
/// surface vanishes with mesh refinement. [`CrackBand`] corrects this.
pub trait Localisation<T: Real>: std::fmt::Debug + Copy + Send + Sync + 'static {
    /// The weight at a cell of this size, m.
    fn weight<L: Lane<Real = T>>(&self, length: L) -> L;
}

/// Weight one: damage depends on strain only, for any cell size. Costs nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Local;

impl<T: Real> Localisation<T> for Local {
    #[inline(always)]
    fn weight<L: Lane<Real = T>>(&self, _: L) -> L {
        L::one()
    }
}

/// Crack band \[BazantOh1983\]: weight h/h0 for a cell of size h, where h0 is the width over which the failure strain
/// was measured. The opening h eps_f to failure, and with it the work per area of crack, is then that of the test for
/// every h (book, "Damage and time to failure").
///
/// Limits: for a localised band one cell wide. Diffuse damage before localisation is scaled too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackBand<T> {
    size: T,
}

impl<T: Real> CrackBand<T> {
    /// Create from the reference size h0, m.
    ///
    /// # Errors
    /// h0 not positive.
    pub fn new(size: T) -> Result<Self, ParameterError> {
        Ok(CrackBand { size: Check("crack band").positive("reference size h0", size)? })
    }
}

impl<T: Real> Localisation<T> for CrackBand<T> {
    #[inline(always)]
    fn weight<L: Lane<Real = T>>(&self, length: L) -> L {
        length * L::splat(T::of(1.0) / self.size)
    }
}
