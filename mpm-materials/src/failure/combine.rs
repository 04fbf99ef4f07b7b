//! Which criteria go together, and what is said of those that do not: once, where they are handed to a law.
//!
//! A point has one crack. So a pair has one criterion that opens one at most ([`OneCrack`]), [`LosesShear`](crate::LosesShear) none, since what a
//! crack has opened in bears no tension ([`BearsTension`]), and [`Ground`](crate::Ground) none, since the crack is solved with an equation of state. A
//! criterion says by [`Failure::Cracks`] what it is.
//!
//! What a law with a criterion is follows from the bound on the criterion, so that nothing is reported of what is done with a law that is
//! none. For that [`OfSolid`] and [`OfGround`] have two implementations each, of which the second never holds: of two the compiler takes
//! the one whose bounds hold, and where neither does, there is no type, and one message.

use crate::failure::Failure;
use crate::lane::Real;

/// What opens no crack: a point is whole until it has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoCrack {}
/// What opens a crack before the point fails: [`CohesiveSpall`](crate::CohesiveSpall).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpeningCrack {}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::NoCrack {}
    impl Sealed for super::OpeningCrack {}
}

/// Does a criterion open a crack? [`NoCrack`] or [`OpeningCrack`].
pub trait Cracking: sealed::Sealed + OneCrack<NoCrack, Together = Self> {
    /// It does. With `false` nothing of cracks is compiled.
    const OPENS: bool;
}
impl Cracking for NoCrack {
    const OPENS: bool = false;
}
impl Cracking for OpeningCrack {
    const OPENS: bool = true;
}

/// One crack at most, together with `C`.
#[diagnostic::on_unimplemented(
    message = "two criteria of a pair open a crack, and a point has one",
    note = "take one that opens none for one of them, such as `TensilePressure` or `PrincipalStress`",
    note = "generic code asks for it: `where A::Cracks: OneCrack<B::Cracks>`"
)]
pub trait OneCrack<C> {
    /// What the two do.
    type Together: Cracking;
}
impl<C: Cracking> OneCrack<C> for NoCrack {
    type Together = C;
}
impl OneCrack<NoCrack> for OpeningCrack {
    type Together = OpeningCrack;
}

/// [`NoCrack`]: nothing has opened in a point that has failed, so that it may keep tension.
#[diagnostic::on_unimplemented(
    message = "`LosesShear` keeps tension, which what a crack has opened in does not bear",
    note = "take the criterion that opens one without it, or in `LosesTension` or `Removed`",
    note = "generic code asks for it: `where F: Failure<T, Cracks = NoCrack>`"
)]
pub trait BearsTension {}
impl BearsTension for NoCrack {}

/// The implementation that counts.
#[derive(Clone, Copy, Debug)]
pub struct Holding;
/// The one that never holds.
#[derive(Clone, Copy, Debug)]
pub struct Failing;
/// What no type is.
pub trait Never {}

/// A criterion for a [`Solid`](crate::Solid): a [`Failure`]; what makes `R` of the solid `M` is the same.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a failure criterion that a solid can have",
    label = "not in a solid",
    note = "a point has one crack: of the two criteria of a pair one at most opens one, as `CohesiveSpall` does; take `TensilePressure` or \
            `PrincipalStress` for the other",
    note = "`LosesShear` keeps tension, which what a crack has opened in does not bear: take what opens one without it, or in `LosesTension` \
            or `Removed`",
    note = "a criterion of one's own implements `Failure`; generic code asks for it: `where F: Failure<T>`, for a pair of two unknown ones \
            also `A::Cracks: OneCrack<B::Cracks>`"
)]
pub trait OfSolid<T, W, M, R> {
    /// It.
    fn made(law: M) -> R;
}
impl<T: Real, F: Failure<T>, M> OfSolid<T, Holding, M, M> for F {
    fn made(law: M) -> M {
        law
    }
}
impl<T, F: Never, M> OfSolid<T, Failing, M, M> for F {
    fn made(law: M) -> M {
        law
    }
}

/// A criterion for [`Ground`](crate::Ground): a [`Failure`] that opens no crack; what makes `R` of the ground `M` is the same.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a failure criterion that ground can have",
    label = "not in ground",
    note = "a crack that opens, as that of `CohesiveSpall`, is solved with the equation of state of a `Solid`, and `Ground` has a pressure of its \
            own: take `TensilePressure` or `PrincipalStress`",
    note = "a criterion of one's own implements `Failure` with `type Cracks = NoCrack`; generic code asks for it: \
            `where F: Failure<T, Cracks = NoCrack>`"
)]
pub trait OfGround<T, W, M, R> {
    /// It.
    fn made(law: M) -> R;
}
impl<T: Real, F: Failure<T, Cracks = NoCrack>, M> OfGround<T, Holding, M, M> for F {
    fn made(law: M) -> M {
        law
    }
}
impl<T, F: Never, M> OfGround<T, Failing, M, M> for F {
    fn made(law: M) -> M {
        law
    }
}
