//! Failure criteria: loss of shear and tension.
//!
//! A failed point has no deviator and no tension; it still carries compression (book, "Failure criteria"). Wrappers
//! select other post-failure responses: [`LosesTension`], [`LosesShear`], [`Removed`]. A failed point never heals. Its
//! volume ratio continues to follow the motion, so that a closing gap carries load again only at the original density.
//!
//! A pair combines two criteria: `(JohnsonCookDamage::aluminium_6061(), TensilePressure::new(1.5e9)?)` fails where
//! either does.

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
pub use johnson_cook::{Damaged, JohnsonCookDamage};
pub use localisation::{CrackBand, Local, Localisation};
pub use plastic_strain::PlasticStrainLimit;
pub use principal::PrincipalStress;
pub use tensile::TensilePressure;
pub use tuler_butcher::{Overstressed, TulerButcher};

use crate::lane::{Lane, Mask, Real};
use crate::point::{Nothing, Pair, State};
use crate::state;
use crate::tensor::Sym3;

/// Input of a failure criterion, with the admissible stress at the end of the step.
#[derive(Clone, Copy, Debug)]
pub struct Observed<L> {
    /// Stress deviator, Pa.
    pub deviator: Sym3<L>,
    /// Pressure of the equation of state, Pa, compression positive; viscous pressure left out.
    pub pressure: L,
    /// Accumulated plastic strain.
    pub plastic_strain: L,
    /// Plastic strain increment of the step.
    pub plastic_strain_increment: L,
    /// Homologous temperature T* of the strength, in \[0, 1\]; zero without temperature.
    pub homologous_temperature: L,
    /// Damage of the strength, in \[0, 1\]; zero for a strength without damage.
    pub damage: L,
    /// Time step, s.
    pub dt: L,
    /// Size of the element or cell, m.
    pub length: L,
}

/// Loading of a point with an opening crack.
#[derive(Clone, Copy, Debug)]
pub struct Strain<L> {
    /// Pressure of the material beside the crack, Pa, compression positive, viscous pressure left out.
    pub pressure: L,
    /// Stiffness of the material beside the crack, -dp/dJ, Pa.
    pub stiffness: L,
    /// Size of the element or cell, m.
    pub length: L,
}

/// Failure criterion.
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
    /// True if a point can fail; with `false` no failure code is compiled.
    const POSSIBLE: bool = true;

    /// Post-failure response: stress that a failed point still carries.
    const REMAINS: Remains = Remains::Compression;

    /// Crack model before failure: usually [`NoCrack`], without crack code and with the defaults of the last three
    /// functions. A criterion that opens a crack has [`OpeningCrack`] and implements these functions; it is for a
    /// [`Solid`](crate::Solid), combined only with criteria that open none ([`combine`]).
    type Cracks: Cracking;

    /// State variables of the criterion.
    type History<L: Lane<Real = T>>: State<L>;

    /// True if a point can fail: [`Failure::POSSIBLE`], or less for a set of criteria chosen at run time.
    #[inline(always)]
    fn is_possible(&self) -> bool {
        Self::POSSIBLE
    }

    /// Post-failure response: [`Failure::REMAINS`], unless it is chosen at run time.
    #[inline(always)]
    fn remains(&self) -> Remains {
        Self::REMAINS
    }

    /// True if a crack can open: that of [`Failure::Cracks`], or less for a set of criteria chosen at run time.
    #[inline(always)]
    fn opens_cracks(&self) -> bool {
        <Self::Cracks as Cracking>::OPENS
    }

    /// Bit mask of the stored state variables: [`Constitutive::stored`](crate::Constitutive::stored).
    #[inline(always)]
    fn stored(&self) -> u64 {
        u64::MAX
    }

    /// History of an intact point.
    fn intact(&self) -> Self::History<T::Single>;

    /// True if the point has failed. `plastic_strain` and history are those of the same time.
    fn failed<L: Lane<Real = T>>(&self, history: &Self::History<L>, plastic_strain: L) -> L::Mask;

    /// Update the history at the end of a step. A failed point stays failed.
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &Self::History<L>) -> Self::History<L>;

    /// Volume of the open crack over reference volume: zero before it opens and after failure.
    #[inline(always)]
    fn crack_volume<L: Lane<Real = T>>(&self, history: &Self::History<L>) -> L {
        let _ = history;
        L::zero()
    }

    /// True if a crack opens or closes at this pressure of the material beside it, Pa.
    #[inline(always)]
    fn opens<L: Lane<Real = T>>(&self, history: &Self::History<L>, pressure: L) -> L::Mask {
        let _ = (history, pressure);
        L::Mask::splat(false)
    }

    /// Open or close the crack from `now` by one Newton step, so that crack and material beside it carry the same
    /// tension to first order in the volume; the caller repeats it. `old` is the history before the time step.
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

/// No failure: no memory, no code.
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

/// Failure where either criterion fails; a failed point carries only stress that both leave. At most one opens a crack.
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
    /// Failure flag of a criterion that cannot be evaluated from the rest of the state.
    pub struct Flag<L> {
        /// One where the point has failed, else zero.
        pub failed: L,
    }
}

impl<L: Lane> Flag<L> {
    /// Create the flag of an intact point.
    #[inline(always)]
    pub fn intact() -> Self {
        Flag { failed: L::zero() }
    }
    /// True if the flag is set.
    #[inline(always)]
    pub fn is_set(&self) -> L::Mask {
        self.failed.gt(L::of(0.5))
    }
    /// Set the flag where `now` is true; a set flag stays set.
    #[inline(always)]
    pub fn or(&self, now: L::Mask) -> Self {
        Flag { failed: L::select(now, L::one(), self.failed) }
    }
}
