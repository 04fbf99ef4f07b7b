//! Fluid whose equation of state and shear stress are values.

use super::eos::AnyEos;
use crate::eos::EnergyColumn;
use crate::fluid::{Bingham, Fluid, Inviscid, Newtonian, ShearViscosity};
use crate::lane::{Lane, Real};
use crate::parameter::ParameterError;
use crate::point::Kinematics;
use crate::tensor::Sym3;
use crate::viscosity::BulkViscosity;

/// Shear stress of a fluid chosen at run time.
#[derive(Clone, Copy, PartialEq)]
pub enum AnyShear<T> {
    /// None.
    Inviscid,
    /// Newton.
    Newtonian(Newtonian<T>),
    /// Bingham.
    Bingham(Bingham<T>),
}

impl<T> From<Inviscid> for AnyShear<T> {
    fn from(_: Inviscid) -> Self {
        AnyShear::Inviscid
    }
}
impl<T> From<Newtonian<T>> for AnyShear<T> {
    fn from(shear: Newtonian<T>) -> Self {
        AnyShear::Newtonian(shear)
    }
}
impl<T> From<Bingham<T>> for AnyShear<T> {
    fn from(shear: Bingham<T>) -> Self {
        AnyShear::Bingham(shear)
    }
}

impl<T: Real> ShearViscosity<T> for AnyShear<T> {
    type Memory<L: Lane<Real = T>> = Sym3<L>;
    type Heat<L: Lane<Real = T>, H: EnergyColumn<L>> = L;
    #[inline(always)]
    fn deviator<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>) -> Sym3<L> {
        match self {
            AnyShear::Inviscid => Sym3::zero(),
            AnyShear::Newtonian(shear) => shear.deviator(kinematics),
            AnyShear::Bingham(shear) => shear.deviator(kinematics),
        }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = T>>(&self, memory: &Sym3<L>) -> Sym3<L> {
        *memory
    }
    #[inline(always)]
    fn largest(&self) -> T {
        match self {
            AnyShear::Inviscid => T::default(),
            AnyShear::Newtonian(shear) => shear.largest(),
            AnyShear::Bingham(shear) => shear.largest(),
        }
    }
    #[inline(always)]
    fn stored(&self) -> Option<u64> {
        if matches!(self, AnyShear::Inviscid) { Some(0) } else { None }
    }
}

/// Fluid whose equation of state and shear stress are chosen at run time: [`Fluid`] with the same stress, for any
/// combination. The energy is a state variable with any equation of state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyFluid<T>(pub(super) Fluid<AnyEos<T>, AnyShear<T>, BulkViscosity<T>>);

impl<T: Real> AnyFluid<T> {
    /// Create from an equation of state, a shear stress ([`Inviscid`], [`Newtonian`], [`Bingham`]) and the coefficients of
    /// bulk viscosity, linear b1 and quadratic b0, zero for none.
    ///
    /// # Errors
    /// A negative coefficient; an equation of state without a speed of sound at rest.
    pub fn new(
        eos: impl Into<AnyEos<T>>,
        shear: impl Into<AnyShear<T>>,
        [linear, quadratic]: [T; 2],
    ) -> Result<Self, ParameterError> {
        let fluid = Fluid::new(eos.into()).with_shear_viscosity(shear.into());
        Ok(AnyFluid(fluid.with_bulk_viscosity(linear, quadratic)?))
    }
}

impl<T: std::fmt::Debug> std::fmt::Debug for AnyShear<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            AnyShear::Inviscid => Inviscid.fmt(f),
            AnyShear::Newtonian(shear) => shear.fmt(f),
            AnyShear::Bingham(shear) => shear.fmt(f),
        }
    }
}
