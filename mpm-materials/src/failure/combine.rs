//! Allowed combinations of failure criteria, and a single compiler message for others, where they are passed to a law.
//!
//! A point has one crack. At most one criterion of a pair opens it ([`OneCrack`]). A criterion in
//! [`LosesShear`](crate::LosesShear) opens none, since a cracked point carries no tension ([`BearsTension`]). A
//! criterion of [`Ground`](crate::Ground) opens none, since the crack is solved with an equation of state.
//! [`Failure::Cracks`] declares the crack model of a criterion.
//!
//! The type of a law with a criterion follows from the bound on the criterion, so that later uses of an invalid law
//! cause no messages. For this [`OfSolid`] and [`OfGround`] have two implementations each, the second with a bound that
//! no type satisfies: the compiler selects the implementation whose bounds are satisfied, and if none is, there is no
//! type, and one message.

use crate::failure::Failure;
use crate::lane::Real;

/// Crack model without a crack: a point is intact until it fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoCrack {}
/// Crack model with a crack that opens before the point fails: [`CohesiveSpall`](crate::CohesiveSpall).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpeningCrack {}

mod sealed {
    pub trait Sealed {}
    impl Sealed for super::NoCrack {}
    impl Sealed for super::OpeningCrack {}
}

/// Crack model of a criterion: [`NoCrack`] or [`OpeningCrack`].
pub trait Cracking: sealed::Sealed + OneCrack<NoCrack, Together = Self> {
    /// True if a crack opens; with `false` no crack code is compiled.
    const OPENS: bool;
}
impl Cracking for NoCrack {
    const OPENS: bool = false;
}
impl Cracking for OpeningCrack {
    const OPENS: bool = true;
}

/// At most one crack together with the crack model `C`.
#[diagnostic::on_unimplemented(
    message = "two criteria of a pair open a crack, and a point has one",
    note = "take one that opens none for one of them, such as `TensilePressure` or `PrincipalStress`",
    note = "generic code asks for it: `where A::Cracks: OneCrack<B::Cracks>`"
)]
pub trait OneCrack<C> {
    /// Crack model of the combination.
    type Together: Cracking;
}
impl<C: Cracking> OneCrack<C> for NoCrack {
    type Together = C;
}
impl OneCrack<NoCrack> for OpeningCrack {
    type Together = OpeningCrack;
}

/// Crack model of criteria whose failed points may keep tension: [`NoCrack`], since no crack has opened.
#[diagnostic::on_unimplemented(
    message = "`LosesShear` keeps tension, which what a crack has opened in does not bear",
    note = "take the criterion that opens one without it, or in `LosesTension` or `Removed`",
    note = "generic code asks for it: `where F: Failure<T, Cracks = NoCrack>`"
)]
pub trait BearsTension {}
impl BearsTension for NoCrack {}

/// Marker of the implementation with satisfiable bounds.
#[derive(Clone, Copy, Debug)]
pub struct Holding;
/// Marker of the implementation with unsatisfiable bounds.
#[derive(Clone, Copy, Debug)]
pub struct Failing;
/// Trait that no type implements.
pub trait Never {}

/// Failure criterion for a [`Solid`](crate::Solid): a [`Failure`]; the resulting type `R` of the solid `M` is `M`.
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
    /// Return the law.
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

/// Failure criterion for [`Ground`](crate::Ground): a [`Failure`] that opens no crack; the resulting type `R` of the
/// ground `M` is `M`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a failure criterion that ground can have",
    label = "not in ground",
    note = "a crack that opens, as that of `CohesiveSpall`, is solved with the equation of state of a `Solid`, and `Ground` has a pressure of its \
            own: take `TensilePressure` or `PrincipalStress`",
    note = "a criterion of one's own implements `Failure` with `type Cracks = NoCrack`; generic code asks for it: \
            `where F: Failure<T, Cracks = NoCrack>`"
)]
pub trait OfGround<T, W, M, R> {
    /// Return the law.
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
