//! Failure criterion of the plate, selected at run time so that its law is compiled once.

use mpm_materials::failure::{Failure, NoCrack, Observed, johnson_cook::Damaged};
use mpm_materials::{JohnsonCookDamage, Lane, Nothing, ParameterError, PlasticStrainLimit};

/// Failure criterion of the plate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ductility {
    /// No failure.
    Whole,
    /// Failure at a plastic strain.
    Strain(PlasticStrainLimit<f64>),
    /// Failure at Johnson-Cook damage one.
    Damage(JohnsonCookDamage<f64>),
}

impl Ductility {
    /// Create the criterion of a plastic strain.
    ///
    /// # Errors
    /// Strain that is not positive.
    pub fn strain(limit: f64) -> Result<Self, ParameterError> {
        Ok(Ductility::Strain(PlasticStrainLimit::new(limit)?))
    }
}

impl Failure<f64> for Ductility {
    type Cracks = NoCrack;
    type History<L: Lane<Real = f64>> = Damaged<L>;

    fn intact(&self) -> Damaged<<f64 as mpm_materials::Real>::Single> {
        JohnsonCookDamage::aluminium_6061().intact()
    }
    #[inline(always)]
    fn failed<L: Lane<Real = f64>>(&self, history: &Damaged<L>, plastic_strain: L) -> L::Mask {
        match self {
            Ductility::Whole => <L::Mask as mpm_materials::Mask>::splat(false),
            Ductility::Strain(limit) => limit.failed(&Nothing, plastic_strain),
            Ductility::Damage(damage) => damage.failed(history, plastic_strain),
        }
    }
    #[inline(always)]
    fn judge<L: Lane<Real = f64>>(&self, observed: &Observed<L>, old: &Damaged<L>) -> Damaged<L> {
        match self {
            Ductility::Whole | Ductility::Strain(_) => *old,
            Ductility::Damage(damage) => damage.judge(observed, old),
        }
    }
}
