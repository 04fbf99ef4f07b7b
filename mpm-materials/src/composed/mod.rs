//! Solid whose parts are chosen at run time, for programs that read their materials.
//!
//! A [`Solid`] of types costs a compilation for every combination of strength, equation of state and failure. An
//! [`AnySolid`] has one set of kernels for all of them: its parts are enumerations, whose variant is the same for all
//! points of a call. Results are equal to those of the composed types, bit for bit, and state variables that a
//! combination does not have are not stored.

mod eos;
mod failure;
mod fluid;
mod strength;
mod stretched;

use std::sync::Arc;

pub use eos::AnyEos;
pub use failure::{AnyFailure, AnyFailureCriterion, FailureState};
pub use fluid::{AnyFluid, AnyShear};
pub use strength::{AnyHardening, AnyHeat, AnyLocalisation, AnyRate, AnyStrength, StrengthState};
pub use stretched::Stretched;

use crate::eos::{Eos, MieGruneisen};
use crate::failure::{Failure, NoFailure};
use crate::lane::{Lane, Real};
use crate::material::{AnyLaw, Compiled, IntoMaterial, Material};
use crate::parameter::{Check, ParameterError};
use crate::plane_stress::PlaneStress;
use crate::point::{Kinematics, Nothing};
use crate::porous::Porous;
use crate::solid::Solid;
use crate::strength::{Isothermal, JohnsonCook, RateIndependent, Strength};
use crate::viscosity::{BulkViscosity, NoViscosity, ShockViscosity};
use failure::{Limited, Uncracked};

/// Bulk viscosity, or none, chosen at run time, for a law that stores its stress.
#[derive(Clone, Copy, PartialEq)]
pub struct AnyViscosity<T>(Option<BulkViscosity<T>>);

impl<T: std::fmt::Debug> std::fmt::Debug for AnyViscosity<T> {
    /// Debug of the part.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.0 {
            Some(viscosity) => viscosity.fmt(f),
            None => NoViscosity.fmt(f),
        }
    }
}

impl<T: Real> ShockViscosity<T> for AnyViscosity<T> {
    type Memory<L: Lane<Real = T>> = Nothing;
    type Heat<L: Lane<Real = T>> = Nothing;
    #[inline(always)]
    fn memory<L: Lane<Real = T>>(&self, _: L) -> Nothing {
        Nothing
    }
    #[inline(always)]
    fn remembered<L: Lane<Real = T>>(&self, _: &Nothing) -> L {
        L::zero()
    }
    #[inline(always)]
    fn pressure<L: Lane<Real = T>>(&self, kinematics: &Kinematics<L>, volume_factor: L, density: L) -> L {
        match &self.0 {
            Some(viscosity) => viscosity.pressure(kinematics, volume_factor, density),
            None => L::zero(),
        }
    }
    fn coefficients(&self) -> [T; 2] {
        self.0.map_or([T::default(); 2], |viscosity| viscosity.coefficients())
    }
}

type Parts<T> = Solid<AnyStrength<T>, AnyEos<T>, AnyFailure<T>, AnyViscosity<T>>;

/// Solid whose strength, equation of state, failure and bulk viscosity are chosen at run time: [`Solid`] with the same
/// results, for any combination. It is no [`Constitutive`](crate::Constitutive) law, since the number of its state
/// variables is known at run time alone; [`AnySolid::into_material`] returns the [`Material`] of it.
///
/// ```
/// use mpm_materials::strength::VoceHardening;
/// use mpm_materials::{
///     AnyFailure, AnySolid, CowperSymonds, IntoMaterial, JohnsonCook, JohnsonCookDamage, Polynomial, TensilePressure,
/// };
/// # fn main() -> Result<(), mpm_materials::ParameterError> {
/// let strength = JohnsonCook::from_hardening(80e9, VoceHardening::new(350e6, 200e6, 15.0)?)?
///     .with_rate(CowperSymonds::new(40.0, 5.0)?);
/// let eos = Polynomial::new(7830.0, [0.0, 159e9, 0.0, 0.0], [0.0; 3], 0.0)?;
/// let failure =
///     AnyFailure::default().or(JohnsonCookDamage::steel_4340())?.or(TensilePressure::new(3e9)?)?;
/// let steel = AnySolid::new(strength, eos).with_failure(failure).with_bulk_viscosity(0.06, 1.5)?.into_material();
/// // Stress, volume ratio, energy, plastic strain, damage, flag of the spall.
/// assert_eq!(steel.numbers(), 6 + 1 + 1 + 1 + 1 + 1);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnySolid<T>(Parts<T>);

impl<T: Real> AnySolid<T> {
    /// Create a solid without failure and bulk viscosity.
    pub fn new(strength: impl Into<AnyStrength<T>>, eos: impl Into<AnyEos<T>>) -> Self {
        AnySolid(Solid::of_parts(strength.into(), eos.into(), AnyFailure::default(), AnyViscosity(None)))
    }
    /// Set the failure criteria.
    #[must_use]
    pub fn with_failure(self, failure: impl Into<AnyFailure<T>>) -> Self {
        AnySolid(self.0.with_failure::<T, _, _, Parts<T>>(failure.into()))
    }
    /// Set the bulk viscosity: linear coefficient b1 and quadratic b0 ([`Solid::with_bulk_viscosity`]).
    ///
    /// # Errors
    /// A negative coefficient.
    pub fn with_bulk_viscosity(self, linear: T, quadratic: T) -> Result<Self, ParameterError> {
        let viscosity = BulkViscosity::new(linear, quadratic, self.0.eos().rest_speed())?;
        Ok(AnySolid(self.0.with_viscosity(AnyViscosity(Some(viscosity)))))
    }
}

impl<T: Real> AnySolid<T> {
    /// Create the porous solid whose solid part this is: distension alpha_0, elastic limit p_e and pressure of full
    /// compaction p_s, Pa ([`Porous`]). Strength is that of the porous solid.
    ///
    /// # Errors
    /// Those of [`Porous::new`]; a solid with failure criteria.
    pub fn with_pores(self, distension: T, elastic: T, full: T) -> Result<AnyPorous<T>, ParameterError> {
        let fails = self.0.failure().is_possible();
        Check("p-alpha").that(!fails, "number of failure criteria", T::of(1.0), "0")?;
        let porous = Porous::new(*self.0.strength(), *self.0.eos(), distension, elastic, full)?;
        Ok(AnyPorous(porous.with_viscosity(*self.0.viscosity())))
    }
    /// Return the law of thin plates of this solid.
    pub fn in_plane_stress(self) -> AnyPlate<T> {
        AnyPlate(PlaneStress::new(self.0))
    }
}

/// Porous solid of parts chosen at run time: [`AnySolid::with_pores`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyPorous<T>(Porous<T, AnyStrength<T>, AnyEos<T>, AnyViscosity<T>>);

/// Solid of parts chosen at run time in plane stress: [`AnySolid::in_plane_stress`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnyPlate<T>(PlaneStress<Parts<T>>);

macro_rules! materials {
    ($($any:ty),+ $(,)?) => {$(
        impl IntoMaterial<f64> for $any {
            /// Unknown: the kernels are those of run-time parts.
            type Law = AnyLaw;
            fn law(&self) -> AnyLaw {
                AnyLaw
            }
            #[inline(never)]
            fn into_material(self) -> Arc<dyn Material<f64>> {
                Arc::new(Compiled::narrow(self.0))
            }
        }
    )+};
}
materials!(AnyPorous<f64>, AnyPlate<f64>, AnyFluid<f64>);

impl IntoMaterial<f64> for AnySolid<f64> {
    /// Unknown: the kernels are those of run-time parts.
    type Law = AnyLaw;
    fn law(&self) -> AnyLaw {
        AnyLaw
    }
    #[inline(never)]
    fn into_material(self) -> Arc<dyn Material<f64>> {
        frequent(&self.0).unwrap_or_else(|| Arc::new(Compiled::new(self.0)))
    }
}

/// Return the material of a frequent combination, which has kernels of its own, a quarter faster.
fn frequent(solid: &Parts<f64>) -> Option<Arc<dyn Material<f64>>> {
    type Shocked<S, F> = Solid<S, MieGruneisen<f64>, F, AnyViscosity<f64>>;
    let (AnyStrength::Product(name, law), AnyEos::MieGruneisen(eos)) = (solid.strength(), *solid.eos())
    else {
        return None;
    };
    let (shear, AnyHardening::Power(hardening), rate, thermal) = law.parts() else { return None };
    let (failure, viscosity) = (*solid.failure(), *solid.viscosity());
    macro_rules! compiled {
        ($strength:expr) => {{
            let strength = $strength;
            if Strength::<f64>::name(&strength) != *name {
                return None;
            }
            let failing: Arc<dyn Material<f64>> = if !failure.is_possible() {
                let solid: Shocked<_, NoFailure> = Solid::of_parts(strength, eos, NoFailure, viscosity);
                Arc::new(Compiled::new(solid))
            } else if let Some(limit) = Limited::of(failure) {
                let solid: Shocked<_, Limited<f64>> = Solid::of_parts(strength, eos, limit, viscosity);
                Arc::new(Compiled::new(solid))
            } else {
                let failure = Uncracked::of(failure)?;
                let solid: Shocked<_, Uncracked<f64>> = Solid::of_parts(strength, eos, failure, viscosity);
                Arc::new(Compiled::new(solid))
            };
            failing
        }};
    }
    Some(match (rate, thermal) {
        (AnyRate::Independent, AnyHeat::Isothermal) => {
            compiled!(JohnsonCook::of_parts(shear, hardening, RateIndependent, Isothermal))
        }
        (AnyRate::Logarithmic(rate), AnyHeat::Adiabatic(heat)) => {
            compiled!(JohnsonCook::of_parts(shear, hardening, rate, heat))
        }
        _ => return None,
    })
}

impl<T> From<NoViscosity> for AnyViscosity<T> {
    fn from(_: NoViscosity) -> Self {
        AnyViscosity(None)
    }
}
impl<T> From<BulkViscosity<T>> for AnyViscosity<T> {
    fn from(viscosity: BulkViscosity<T>) -> Self {
        AnyViscosity(Some(viscosity))
    }
}

/// Solid of types, by the kernels of run-time parts.
impl<S, E, F, V> IntoMaterial<f64> for Solid<S, E, F, V>
where
    S: Strength<f64> + Copy + Into<AnyStrength<f64>>,
    E: Eos<f64> + Copy + Into<AnyEos<f64>>,
    F: Failure<f64> + Copy + Into<AnyFailure<f64>>,
    V: ShockViscosity<f64> + Into<AnyViscosity<f64>>,
{
    type Law = Self;
    fn law(&self) -> Self {
        *self
    }
    fn into_material(self) -> Arc<dyn Material<f64>> {
        let (strength, eos, failure) = (*self.strength(), *self.eos(), *self.failure());
        let viscosity = (*self.viscosity()).into();
        AnySolid(Solid::of_parts(strength.into(), eos.into(), failure.into(), viscosity)).into_material()
    }
}
