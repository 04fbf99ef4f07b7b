//! Any set of failure criteria, chosen at run time.

use std::fmt::{self, Debug, Formatter};

use super::strength::AnyLocalisation;
use crate::failure::{
    CohesiveSpall, Crack, DamageLimit, Damaged, Failure, Flag, JohnsonCookDamage, Localisation, LosesShear,
    LosesTension, NoCrack, NoFailure, Observed, OpeningCrack, Overstressed, PlasticStrainLimit,
    PrincipalStress, Remains, Removed, Strain, TensilePressure, TulerButcher,
};
use crate::lane::{Lane, Mask, Real};
use crate::parameter::{Check, ParameterError};
use crate::point::Nothing;
use crate::state;

/// Failure criterion chosen at run time.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyFailureCriterion<T> {
    /// Johnson-Cook damage.
    JohnsonCook(JohnsonCookDamage<T, AnyLocalisation<T>>),
    /// Spall at a tensile pressure.
    TensilePressure(TensilePressure<T>),
    /// Largest principal stress and largest shear stress.
    PrincipalStress(PrincipalStress<T>),
    /// Tuler and Butcher's integral of overstress over time.
    TulerButcher(TulerButcher<T>),
    /// Plastic strain.
    PlasticStrainLimit(PlasticStrainLimit<T>),
    /// Damage of the strength.
    DamageLimit(DamageLimit<T>),
    /// Spall with a work of fracture.
    CohesiveSpall(CohesiveSpall<T>),
}

/// Set of failure criteria, at most one of each kind: a point fails where the first does. Empty by default.
///
/// ```
/// use mpm_materials::{AnyFailure, JohnsonCookDamage, Remains, TensilePressure};
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let failure = AnyFailure::<f64>::default()
///     .or(JohnsonCookDamage::steel_4340())?
///     .or(TensilePressure::new(3e9)?)?
///     .with_post_failure(Remains::CompressionAndShear)?;
/// # let _ = failure;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct AnyFailure<T> {
    johnson_cook: Option<JohnsonCookDamage<T, AnyLocalisation<T>>>,
    tensile: Option<TensilePressure<T>>,
    principal: Option<PrincipalStress<T>>,
    tuler_butcher: Option<TulerButcher<T>>,
    plastic_strain: Option<PlasticStrainLimit<T>>,
    damage_limit: Option<DamageLimit<T>>,
    cohesive: Option<CohesiveSpall<T>>,
    remains: Remains,
}

impl<T> Default for AnyFailure<T> {
    fn default() -> Self {
        AnyFailure {
            johnson_cook: None,
            tensile: None,
            principal: None,
            tuler_butcher: None,
            plastic_strain: None,
            damage_limit: None,
            cohesive: None,
            remains: Remains::Compression,
        }
    }
}

impl<T: Real> AnyFailure<T> {
    /// Add a criterion.
    ///
    /// # Errors
    /// A second criterion of the same kind.
    pub fn or(mut self, criterion: impl Into<AnyFailureCriterion<T>>) -> Result<Self, ParameterError> {
        let twice = self.set(criterion.into());
        Check("failure").that(!twice, "number of criteria of one kind", T::of(2.0), "at most 1")?;
        self.with_post_failure(self.remains)
    }
    /// Add a criterion in place of one of the same kind.
    ///
    /// # Errors
    /// Those of [`AnyFailure::with_post_failure`].
    pub fn replacing(mut self, criterion: impl Into<AnyFailureCriterion<T>>) -> Result<Self, ParameterError> {
        self.set(criterion.into());
        self.with_post_failure(self.remains)
    }
    fn only(criterion: impl Into<AnyFailureCriterion<T>>) -> Self {
        let mut set = AnyFailure::default();
        set.set(criterion.into());
        set
    }
    /// Set a criterion. Return true if there was one of the same kind.
    fn set(&mut self, criterion: AnyFailureCriterion<T>) -> bool {
        fn set<C>(place: &mut Option<C>, criterion: C) -> bool {
            place.replace(criterion).is_some()
        }
        match criterion {
            AnyFailureCriterion::JohnsonCook(c) => set(&mut self.johnson_cook, c),
            AnyFailureCriterion::TensilePressure(c) => set(&mut self.tensile, c),
            AnyFailureCriterion::PrincipalStress(c) => set(&mut self.principal, c),
            AnyFailureCriterion::TulerButcher(c) => set(&mut self.tuler_butcher, c),
            AnyFailureCriterion::PlasticStrainLimit(c) => set(&mut self.plastic_strain, c),
            AnyFailureCriterion::DamageLimit(c) => set(&mut self.damage_limit, c),
            AnyFailureCriterion::CohesiveSpall(c) => set(&mut self.cohesive, c),
        }
    }
    /// Set the post-failure response, [`Remains::Compression`] by default.
    ///
    /// # Errors
    /// [`Remains::Pressure`] with a criterion that opens a crack: a cracked point carries no tension.
    pub fn with_post_failure(self, remains: Remains) -> Result<Self, ParameterError> {
        let bears = remains == Remains::Pressure && self.cohesive.is_some();
        Check("cohesive spall").that(!bears, "tension carried after failure", T::of(1.0), "0")?;
        Ok(AnyFailure { remains, ..self })
    }
    #[inline(always)]
    fn has_flag(&self) -> bool {
        self.tensile.is_some() || self.principal.is_some() || self.damage_limit.is_some()
    }
}

impl<T: Copy> AnyFailure<T> {
    /// Iterate over the criteria.
    pub fn criteria(&self) -> impl Iterator<Item = AnyFailureCriterion<T>> {
        let list = [
            self.johnson_cook.map(AnyFailureCriterion::JohnsonCook),
            self.tensile.map(AnyFailureCriterion::TensilePressure),
            self.principal.map(AnyFailureCriterion::PrincipalStress),
            self.tuler_butcher.map(AnyFailureCriterion::TulerButcher),
            self.plastic_strain.map(AnyFailureCriterion::PlasticStrainLimit),
            self.damage_limit.map(AnyFailureCriterion::DamageLimit),
            self.cohesive.map(AnyFailureCriterion::CohesiveSpall),
        ];
        list.into_iter().flatten()
    }
}

impl<T> From<NoFailure> for AnyFailure<T> {
    fn from(_: NoFailure) -> Self {
        AnyFailure::default()
    }
}
macro_rules! criteria {
    ($($part:ident),+ $(,)?) => {$(
        impl<T> From<$part<T>> for AnyFailureCriterion<T> {
            fn from(part: $part<T>) -> Self {
                AnyFailureCriterion::$part(part)
            }
        }
        impl<T: Real> From<$part<T>> for AnyFailure<T> {
            fn from(part: $part<T>) -> Self {
                AnyFailure::only(part)
            }
        }
    )+};
}
criteria!(TensilePressure, PrincipalStress, TulerButcher, PlasticStrainLimit, DamageLimit, CohesiveSpall);
impl<T: Real, B: Localisation<T> + Into<AnyLocalisation<T>>> From<JohnsonCookDamage<T, B>>
    for AnyFailureCriterion<T>
{
    fn from(part: JohnsonCookDamage<T, B>) -> Self {
        let localisation = part.localisation().into();
        AnyFailureCriterion::JohnsonCook(part.with_localisation(localisation))
    }
}
impl<T: Real, B: Localisation<T> + Into<AnyLocalisation<T>>> From<JohnsonCookDamage<T, B>> for AnyFailure<T> {
    fn from(part: JohnsonCookDamage<T, B>) -> Self {
        AnyFailure::only(part)
    }
}
macro_rules! responses {
    ($($wrapper:ident => $remains:ident),+ $(,)?) => {$(
        impl<T, F: Into<AnyFailure<T>>> From<$wrapper<F>> for AnyFailure<T> {
            fn from(failure: $wrapper<F>) -> Self {
                AnyFailure { remains: Remains::$remains, ..failure.0.into() }
            }
        }
    )+};
}
responses! { Removed => Nothing, LosesTension => CompressionAndShear, LosesShear => Pressure }

state! {
    /// State variables of a set of failure criteria; those that it does not have are zero and not stored.
    pub struct FailureState<L> {
        /// Johnson-Cook damage, sum of plastic strain over failure strain.
        pub failure_damage: L,
        /// Tuler and Butcher's integral, s.
        pub overstress_time: L,
        /// One where a criterion of stress or of the strength's damage has been met, else zero.
        pub failed: L,
        /// Volume of the open crack over reference volume.
        pub crack_volume: L,
        /// Largest opening of the crack over that at failure.
        pub crack_damage: L,
    }
}

impl<L: Lane> FailureState<L> {
    #[inline(always)]
    fn crack(&self) -> Crack<L> {
        Crack { crack_volume: self.crack_volume, crack_damage: self.crack_damage }
    }
}

impl<T: Real> Failure<T> for AnyFailure<T> {
    type Cracks = OpeningCrack;
    type History<L: Lane<Real = T>> = FailureState<L>;

    #[inline(always)]
    fn is_possible(&self) -> bool {
        self.johnson_cook.is_some()
            || self.tuler_butcher.is_some()
            || self.plastic_strain.is_some()
            || self.cohesive.is_some()
            || self.has_flag()
    }
    #[inline(always)]
    fn remains(&self) -> Remains {
        self.remains
    }
    #[inline(always)]
    fn opens_cracks(&self) -> bool {
        self.cohesive.is_some()
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        let bit = |there: bool, at: u32| u64::from(there) << at;
        bit(self.johnson_cook.is_some(), 0)
            | bit(self.tuler_butcher.is_some(), 1)
            | bit(self.has_flag(), 2)
            | bit(self.cohesive.is_some(), 3)
            | bit(self.cohesive.is_some(), 4)
    }
    fn intact(&self) -> FailureState<T::Single> {
        let zero = T::Single::zero();
        FailureState {
            failure_damage: zero,
            overstress_time: zero,
            failed: zero,
            crack_volume: zero,
            crack_damage: zero,
        }
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &FailureState<L>, plastic_strain: L) -> L::Mask {
        let mut failed = L::Mask::splat(false);
        if let Some(c) = &self.johnson_cook {
            failed = failed | c.failed(&Damaged { failure_damage: history.failure_damage }, plastic_strain);
        }
        if let Some(c) = &self.tuler_butcher {
            let history = Overstressed { overstress_time: history.overstress_time };
            failed = failed | c.failed(&history, plastic_strain);
        }
        if let Some(c) = &self.plastic_strain {
            failed = failed | c.failed(&Nothing, plastic_strain);
        }
        if let Some(c) = &self.cohesive {
            failed = failed | c.failed(&history.crack(), plastic_strain);
        }
        if self.has_flag() {
            failed = failed | Flag { failed: history.failed }.is_set();
        }
        failed
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &FailureState<L>) -> FailureState<L> {
        let mut new = *old;
        if let Some(c) = &self.johnson_cook {
            new.failure_damage =
                c.judge(observed, &Damaged { failure_damage: old.failure_damage }).failure_damage;
        }
        if let Some(c) = &self.tuler_butcher {
            let old = Overstressed { overstress_time: old.overstress_time };
            new.overstress_time = c.judge(observed, &old).overstress_time;
        }
        let mut flag = Flag { failed: old.failed };
        if let Some(c) = &self.tensile {
            flag = c.judge(observed, &flag);
        }
        if let Some(c) = &self.principal {
            flag = c.judge(observed, &flag);
        }
        if let Some(c) = &self.damage_limit {
            flag = c.judge(observed, &flag);
        }
        new.failed = flag.failed;
        new
    }
    #[inline(always)]
    fn crack_volume<L: Lane<Real = T>>(&self, history: &FailureState<L>) -> L {
        history.crack_volume
    }
    #[inline(always)]
    fn opens<L: Lane<Real = T>>(&self, history: &FailureState<L>, pressure: L) -> L::Mask {
        match &self.cohesive {
            Some(c) => c.opens(&history.crack(), pressure),
            None => L::Mask::splat(false),
        }
    }
    #[inline(always)]
    fn opened<L: Lane<Real = T>>(
        &self,
        strain: &Strain<L>,
        now: &FailureState<L>,
        old: &FailureState<L>,
    ) -> FailureState<L> {
        match &self.cohesive {
            Some(c) => {
                let Crack { crack_volume, crack_damage } = c.opened(strain, &now.crack(), &old.crack());
                FailureState { crack_volume, crack_damage, ..*now }
            }
            None => *now,
        }
    }
}

impl<T: Debug> Debug for AnyFailureCriterion<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            AnyFailureCriterion::JohnsonCook(c) => c.fmt(f),
            AnyFailureCriterion::TensilePressure(c) => c.fmt(f),
            AnyFailureCriterion::PrincipalStress(c) => c.fmt(f),
            AnyFailureCriterion::TulerButcher(c) => c.fmt(f),
            AnyFailureCriterion::PlasticStrainLimit(c) => c.fmt(f),
            AnyFailureCriterion::DamageLimit(c) => c.fmt(f),
            AnyFailureCriterion::CohesiveSpall(c) => c.fmt(f),
        }
    }
}

impl<T: Debug> Debug for AnyFailure<T> {
    /// Debug of the criteria, as those of composed types print it where one of them is alone.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        fn part<C: Debug>(criterion: &Option<C>) -> Option<&dyn Debug> {
            criterion.as_ref().map(|c| c as &dyn Debug)
        }
        let list = [
            part(&self.johnson_cook),
            part(&self.tensile),
            part(&self.principal),
            part(&self.tuler_butcher),
            part(&self.plastic_strain),
            part(&self.damage_limit),
            part(&self.cohesive),
        ];
        let criteria: Vec<&dyn Debug> = list.into_iter().flatten().collect();
        debug(f, &criteria, self.remains)
    }
}

/// Print criteria, as those of composed types print where one of them is alone.
fn debug(f: &mut Formatter<'_>, criteria: &[&dyn Debug], remains: Remains) -> fmt::Result {
    match (criteria, remains) {
        ([], _) => NoFailure.fmt(f),
        ([one], Remains::Compression) => one.fmt(f),
        (all, remains) => {
            f.debug_struct("Failure").field("criteria", &all).field("remains", &remains).finish()
        }
    }
}

/// Set of criteria none of which opens a crack.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Uncracked<T>(AnyFailure<T>);

impl<T: Real> Uncracked<T> {
    /// Wrap a set; `None` if a criterion opens a crack.
    pub fn of(failure: AnyFailure<T>) -> Option<Self> {
        (!failure.opens_cracks()).then_some(Uncracked(failure))
    }
}

impl<T: Debug> Debug for Uncracked<T> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl<T: Real> Failure<T> for Uncracked<T> {
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = FailureState<L>;

    #[inline(always)]
    fn remains(&self) -> Remains {
        self.0.remains()
    }
    #[inline(always)]
    fn stored(&self) -> u64 {
        self.0.stored()
    }
    fn intact(&self) -> FailureState<T::Single> {
        self.0.intact()
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &FailureState<L>, plastic_strain: L) -> L::Mask {
        self.0.failed(history, plastic_strain)
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, observed: &Observed<L>, old: &FailureState<L>) -> FailureState<L> {
        self.0.judge(observed, old)
    }
}

/// Limit of the plastic strain alone.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Limited<T> {
    limit: PlasticStrainLimit<T>,
    remains: Remains,
}

impl<T: Real> Limited<T> {
    /// Create from a set; `None` if it has other criteria.
    pub fn of(failure: AnyFailure<T>) -> Option<Self> {
        let limit = failure.plastic_strain?;
        (failure.criteria().count() == 1).then_some(Limited { limit, remains: failure.remains })
    }
}

impl<T: Debug> Debug for Limited<T> {
    /// Debug of the set.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        debug(f, &[&self.limit], self.remains)
    }
}

impl<T: Real> Failure<T> for Limited<T> {
    type Cracks = NoCrack;
    type History<L: Lane<Real = T>> = Nothing;

    #[inline(always)]
    fn remains(&self) -> Remains {
        self.remains
    }
    fn intact(&self) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn failed<L: Lane<Real = T>>(&self, history: &Nothing, plastic_strain: L) -> L::Mask {
        self.limit.failed(history, plastic_strain)
    }
    #[inline(always)]
    fn judge<L: Lane<Real = T>>(&self, _: &Observed<L>, _: &Nothing) -> Nothing {
        Nothing
    }
}
