//! Laws whose kernels are compiled once, here, for all programs: those of [`crate::library`], each without and with
//! bulk viscosity, metals with their most common failure criteria, and linear elasticity in plane stress.

use std::sync::Arc;

use crate::eos::{IdealGas, LinearDensity, LogarithmicBulk, MieGruneisen, Tait};
use crate::explosive::Explosive;
use crate::failure::{DamageLimit, JohnsonCookDamage, NoFailure, TensilePressure};
use crate::fluid::{Fluid, Inviscid};
use crate::ground::Ground;
use crate::material::{Compiled, IntoMaterial, Material};
use crate::solid::Solid;
use crate::strength::{
    AdiabaticJohnsonCook, Borvik, DruckerPrager, Elastic, HolmquistJohnsonCook, J2, JohnsonCook,
    SteinbergGuinan,
};
use crate::viscosity::{BulkViscosity, NoViscosity};
use crate::{Jwl, LinearElastic, NeoHookean, PlaneStress};

macro_rules! compiled {
    ($t:ty: $($law:ty),+ $(,)?) => {$(
        impl IntoMaterial<$t> for $law {
            type Law = Self;
            fn law(&self) -> Self {
                *self
            }
            #[inline(never)]
            fn into_material(self) -> Arc<dyn Material<$t>> {
                Arc::new(Compiled::new(self))
            }
        }
    )+};
}

macro_rules! with_viscosity {
    ($t:ty, $v:ty) => {
        compiled! {
            $t:
            Solid<Elastic<$t>, LinearDensity<$t>, NoFailure, $v>,
            Solid<Elastic<$t>, LogarithmicBulk<$t>, NoFailure, $v>,
            Solid<J2<$t>, LogarithmicBulk<$t>, NoFailure, $v>,
            Solid<JohnsonCook<$t>, MieGruneisen<$t>, NoFailure, $v>,
            Solid<AdiabaticJohnsonCook<$t>, MieGruneisen<$t>, NoFailure, $v>,
            Solid<AdiabaticJohnsonCook<$t>, MieGruneisen<$t>, JohnsonCookDamage<$t>, $v>,
            Solid<AdiabaticJohnsonCook<$t>, MieGruneisen<$t>, TensilePressure<$t>, $v>,
            Solid<SteinbergGuinan<$t>, MieGruneisen<$t>, NoFailure, $v>,
            Solid<Borvik<$t>, LogarithmicBulk<$t>, DamageLimit<$t>, $v>,
            Ground<DruckerPrager<$t>, NoFailure, $v>,
            Ground<HolmquistJohnsonCook<$t>, NoFailure, $v>,
            Explosive<$t, Jwl<$t>, $v>,
            Fluid<IdealGas<$t>, Inviscid, $v>,
            Fluid<Tait<$t>, Inviscid, $v>,
            Fluid<MieGruneisen<$t>, Inviscid, $v>,
        }
    };
}

compiled! {
    f64:
    LinearElastic<f64>,
    PlaneStress<LinearElastic<f64>>,
    NeoHookean<f64>,
}
with_viscosity!(f64, NoViscosity);
with_viscosity!(f64, BulkViscosity<f64>);

#[cfg(feature = "single")]
compiled! {
    f32:
    LinearElastic<f32>,
    NeoHookean<f32>,
    Solid<AdiabaticJohnsonCook<f32>, MieGruneisen<f32>, NoFailure, BulkViscosity<f32>>,
}
