//! Laws whose kernels are compiled once, here, for all programs: those of [`crate::library`] other than metals, each
//! without and with bulk viscosity, linear elasticity in plane stress, and viscous fluids. Metals have the kernels of
//! [`crate::composed`].

use std::sync::Arc;

use crate::composed::AnyLocalisation;
use crate::eos::{IdealGas, MieGruneisen, Tait};
use crate::explosive::Explosive;
use crate::failure::NoFailure;
use crate::fluid::{Fluid, Inviscid, Newtonian};
use crate::ground::Ground;
use crate::material::{Compiled, IntoMaterial, Material};
#[cfg(feature = "single")]
use crate::solid::Solid;
#[cfg(feature = "single")]
use crate::strength::AdiabaticJohnsonCook;
use crate::strength::{DruckerPrager, HolmquistJohnsonCook, MohrCoulomb};
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
            Ground<DruckerPrager<$t>, NoFailure, $v>,
            Ground<MohrCoulomb<$t>, NoFailure, $v>,
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
    Ground<HolmquistJohnsonCook<f64, AnyLocalisation<f64>>, NoFailure, BulkViscosity<f64>>,
    Fluid<IdealGas<f64>, Newtonian<f64>, BulkViscosity<f64>>,
    Fluid<Tait<f64>, Newtonian<f64>, BulkViscosity<f64>>,
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
