//! Damage as a diagnostic.

use mpm_materials::failure::{Failure, JohnsonCookDamage, NoCrack, Observed};
use mpm_materials::lane::{Lane, Mask};

/// Johnson-Cook damage of 4340 steel. The reference finite elements have no failure: a point fails at a damage of one only if `failing`;
/// otherwise damage is recorded without effect.
#[derive(Clone, Copy, Debug)]
pub struct Counted {
    pub damage: JohnsonCookDamage<f64>,
    pub failing: bool,
}

/// History variables of the damage model.
type History<L> = <JohnsonCookDamage<f64> as Failure<f64>>::History<L>;

impl Failure<f64> for Counted {
    type Cracks = NoCrack;
    type History<L: Lane<Real = f64>> = History<L>;
    fn intact(&self) -> History<f64> {
        self.damage.intact()
    }
    #[inline(always)]
    fn failed<L: Lane<Real = f64>>(&self, history: &History<L>, plastic_strain: L) -> L::Mask {
        self.damage.failed(history, plastic_strain) & L::Mask::splat(self.failing)
    }
    #[inline(always)]
    fn judge<L: Lane<Real = f64>>(&self, observed: &Observed<L>, old: &History<L>) -> History<L> {
        self.damage.judge(observed, old)
    }
}
