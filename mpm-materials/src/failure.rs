//! Failure: when a point stops carrying shear and tension.
//!
//! A failed point has no deviator and no tension; compression is still carried (book, "Failure criteria"). Other choices
//! are wrappers: [`LosesTension`], [`LosesShear`], [`Removed`]. It never heals. Its volume ratio goes on following
//! the motion, so that a closing gap carries load again only when the density is back.
//!
//! Two criteria together are a pair: `(JohnsonCookDamage::aluminium_6061(), TensilePressure::new(1.5e9)?)` fails
//! where either does.

pub mod aftermath;
pub mod cohesive;
pub mod combine;
pub mod damage_limit;
pub mod johnson_cook;
pub mod localisation;
pub mod plastic_strain;
pub mod principal;
pub mod tensile;
pub mod tuler_butcher;

pub use aftermath::{LosesShear, LosesTension, Remains, Removed};
pub use cohesive::{CohesiveSpall, Crack};
pub use combine::{Cracking, NoCrack, OneCrack, OpeningCrack};
pub use damage_limit::DamageLimit;
pub use johnson_cook::JohnsonCookDamage;
pub use localisation::{CrackBand, Local, Localisation};
pub use plastic_strain::PlasticStrainLimit;
pub use principal::PrincipalStress;
pub use tensile::TensilePressure;
pub use tuler_butcher::TulerButcher;

use crate::lane::{Lane, Mask, Real};
use crate::point::{Nothing, Pair, State};
use crate::state;
use crate::tensor::Sym3;

/// What a criterion looks at: the admissible stress at the end of the step.
#[derive(Clone, Copy, Debug)]
pub struct Observed<L> {
    /// Stress deviator, Pa.
    pub deviator: Sym3<L>,
    /// Pressure of the equation of state, Pa, compression positive; viscous pressure left out.
    pub pressure: L,
    /// Accumulated plastic strain.
    pub plastic_strain: L,
    /// Plastic strain of the step.
    pub plastic_strain_increment: L,
    /// Homologous temperature T* of the strength, in \[0, 1\]; zero without temperature.
    pub homologous_temperature: L,
    /// Damage kept by the strength, in \[0, 1\]; zero for a strength without.
    pub damage: L,
    /// Time step, s.
    pub dt: L,
    /// Size of the element or cell, m.
    pub length: L,
}

/// How a point with an opening crack is strained.
#[derive(Clone, Copy, Debug)]
pub struct Strain<L> {
    /// Pressure of the matter beside the crack, Pa, compression positive, viscous pressure left out.
    pub pressure: L,
    /// How much it grows as that matter loses volume, -dp/dJ, Pa.
    pub stiffness: L,
    /// Size of the element or cell, m.
    pub length: L,
}

/// A failure criterion.
///
/// ```
/// use mpm_materials::failure::{Flag, Observed};
/// use mpm_materials::{Failure, Lane, NoCrack, Real, library};
/// /// Fails where the equivalent stress reaches a limit, Pa.
/// #[derive(Clone, Copy, Debug)]
/// struct StressLimit(f64);
/// impl Failure<f64> for StressLimit {
///     type Cracks = NoCrack;
///     type History<L: Lane<Real = f64>> = Flag<L>;
///     fn intact(&self) -> Flag<<f64 as Real>::Single> {
///         Flag::intact()
///     }
///     #[inline(always)]
///     fn failed<L: Lane<Real = f64>>(&self, history: &Flag<L>, _: L) -> L::Mask {
///         history.is_set()
///     }
///     #[inline(always)]
///     fn judge<L: Lane<Real = f64>>(&self, observed: &Observed<L>, old: &Flag<L>) -> Flag<L> {
///         let squared = observed.deviator.dot(&observed.deviator) * L::of(1.5);
///         old.or(squared.ge(L::splat(self.0 * self.0)))
///     }
/// }
/// let copper = library::copper_ofhc().with_failure(StressLimit(1e9));
/// # let _ = copper;
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a failure criterion",
    note = "two criteria together are a pair, three a pair in a pair: `(a, (b, c))`",
    note = "a criterion of one's own implements `Failure`, with `type Cracks = NoCrack` unless a crack opens in it"
)]
pub trait Failure<T: Real>: std::fmt::Debug + Clone + Send + Sync + 'static {
    /// Can a point fail at all? With `false` nothing of failure is compiled.
    const POSSIBLE: bool = true;

    /// What a failed point still carries.
    const REMAINS: Remains = Remains::Compression;

    /// Does a crack open before the point fails? Nearly always [`NoCrack`], with which nothing of cracks is compiled and the last three
    /// functions are left as they are. One that opens a crack says [`OpeningCrack`] and writes these; it goes into a
    /// [`Solid`](crate::Solid), beside others that open none ([`combine`]).
    type Cracks: Cracking;

    /// What a point remembers of its failure.
    type History<L: Lane<Real = T>>: State<L>;

    /// The history of an intact point.
    fn intact(&self) -> Self::History<T::Single>;

    /// Has the point failed? `plastic_strain` belongs to the same instant as the history.
    fn failed<L: Lane<Real = T>>(&self, history: &Self::History<L>, plastic_strain: L) -> L::Mask;

    /// The history after a step. A failed point stays failed.
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &Self::History<L>) -> Self::History<L>;

    /// Volume of the open crack over reference volume: zero before, zero when the point has failed.
    #[inline(always)]
    fn crack_volume<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        let _ = history;
        L::zero()
    }

    /// Where a crack opens or closes, the matter beside it under this pressure, Pa.
    #[inline(always)]
    fn opens<L: Lane<Real = T>>(&self, history: &Self::History<L>, pressure: L) -> L::Mask {
        let _ = (history, pressure);
        L::Mask::splat(false)
    }

    /// The history after the crack has opened or closed from `now` until it bears what the matter beside it does, to first
    /// order in the volume; a step of Newton's method, which the caller repeats. `old` is the history before the time step.
    #[inline(always)]
    fn opened<L: Lane<Real = T>>(
        &self,
        strain: &Strain<L>,
        now: &Self::History<L>,
        old: &Self::History<L>,
    ) -> Self::History<L> {
        let _ = (strain, old);
        *now
    }
}

/// A point that cannot fail: no memory, no code.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoFailure;

impl<T: Real> Failure<T> for NoFailure {
    const POSSIBLE: bool = false;
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = Nothing;
    fn intact(&self) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, _: &Nothing, _: L) -> L::Mask {
        L::Mask::splat(false)
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, _: &Observed<L>, _: &Nothing) -> Nothing {
        Nothing
    }
}

/// Fails where either criterion does; what remains is what both leave. One of them at most opens a crack.
impl<T: Real, A: Failure<T>, B: Failure<T>> Failure<T> for (A, B)
where
    A::Cracks: OneCrack<B::Cracks>,
{
    const POSSIBLE: bool = A::POSSIBLE || B::POSSIBLE;
    const REMAINS: Remains = A::REMAINS.and(B::REMAINS);
    type Cracks = <A::Cracks as OneCrack<B::Cracks>>::Together;
    type History<L: Lane<Real = T>> = Pair<A::History<L>, B::History<L>>;
    fn intact(&self) -> Self::History<T::Single> {
        Pair(self.0.intact(), self.1.intact())
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &Self::History<L>, plastic_strain: L) -> L::Mask {
        self.0.failed(&history.0, plastic_strain) | self.1.failed(&history.1, plastic_strain)
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &Self::History<L>) -> Self::History<L> {
        Pair(self.0.judge(observed, &old.0), self.1.judge(observed, &old.1))
    }
    #[inline(always)]
    fn crack_volume<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        self.0.crack_volume(&history.0) + self.1.crack_volume(&history.1)
    }
    #[inline(always)]
    fn opens<L: Lane<Real = T>>(&self, history: &Self::History<L>, pressure: L) -> L::Mask {
        self.0.opens(&history.0, pressure) | self.1.opens(&history.1, pressure)
    }
    #[inline(always)]
    fn opened<L: Lane<Real = T>>(
        &self,
        strain: &Strain<L>,
        now: &Self::History<L>,
        old: &Self::History<L>,
    ) -> Self::History<L> {
        Pair(self.0.opened(strain, &now.0, &old.0), self.1.opened(strain, &now.1, &old.1))
    }
}

state! {
    /// Memory of a criterion that cannot be told from the rest of the state.
    pub struct Flag<L> {
        /// One where the point has failed, else zero.
        pub failed: L,
    }
}

impl<L: Lane> Flag<L> {
    /// Intact.
    #[inline(always)]
    pub fn intact() -> Self {
        Flag { failed: L::zero() }
    }
    /// Where is it set?
    #[inline(always)]
    pub fn is_set(&self) -> L::Mask {
        self.failed.gt(L::of(0.5))
    }
    /// Set where it was set or `now` holds.
    #[inline(always)]
    pub fn or(&self, now: L::Mask) -> Self {
        Flag { failed: L::select(now, L::one(), self.failed) }
    }
}
