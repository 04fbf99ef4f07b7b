//! Constitutive laws for impact, penetration and granular flow.
//!
//! A law acts at one material point in three dimensions, independent of particles, nodes and elements. It maps the
//! kinematics of a step ([`Kinematics`]) and the state variables ([`State`]) to the new state and the Cauchy stress
//! ([`Constitutive::update`]). Units are SI; stress is tension-positive, pressure compression-positive.

pub mod capability;
mod compiled;
pub mod composed;
#[cfg(feature = "conformance")]
pub mod conformance;
pub mod detonation;
pub mod driver;
pub mod elastic;
pub mod eos;
pub mod explosive;
pub mod failure;
pub mod fluid;
pub mod ground;
pub mod library;
mod mass_scaled;
pub mod material;
pub mod parameter;
pub mod plane_stress;
pub mod point;
pub mod porous;
pub mod rate;
pub mod softening;
pub mod solid;
pub mod strength;
pub mod stretching;
pub mod tangent;
pub mod tensor;
pub mod viscosity;

pub use capability::{Hyperelastic, Stretches, Yields};
pub use composed::{
    AnyEos, AnyFailure, AnyFailureCriterion, AnyFluid, AnyHardening, AnyHeat, AnyLocalisation, AnyPlate,
    AnyPorous, AnyRate, AnyShear, AnySolid, AnyStrength, Stretched,
};
pub use detonation::Detonation;
pub use elastic::{LinearElastic, Moduli, NeoHookean};
pub use eos::{
    CubicShock, Eos, Expanding, Gruneisen, IdealGas, Jwl, JwlConstants, KeepEnergy, LinearDensity,
    LogarithmicBulk, MieGruneisen, Polynomial, PolynomialHugoniot, Tait,
};
pub use explosive::{Explosive, ExplosiveState};
pub use failure::{
    CohesiveSpall, CrackBand, DamageLimit, Failure, JohnsonCookDamage, Local, LosesShear, LosesTension,
    NoCrack, NoFailure, OpeningCrack, PlasticStrainLimit, PrincipalStress, Remains, Removed, TensilePressure,
    TulerButcher,
};
pub use fluid::{Bingham, Fluid, FluidState, Inviscid, Newtonian, chosen_sound_speed};
pub use ground::{Geomaterial, Ground, GroundState};
pub use impactite_simd::Dual;
pub use impactite_simd::lane::{self, Lane, Mask, Real, Wide};
pub use mass_scaled::MassScaled;
pub use material::{AnyLaw, Compiled, IntoMaterial, Material, MaySplit};
pub use parameter::{Check, ParameterError};
pub use plane_stress::{PlaneStress, PlaneStressState};
pub use point::{
    Breakdown, CompiledHere, Constitutive, Fault, Increments, Kinematics, Nothing, Pair, Sink, Source, State,
    Update, lane_of, named, pointwise, spread, with_volume,
};
pub use porous::{Porous, PorousState};
pub use rate::{HughesWinget, ObjectiveRate, SmallRotation};
pub use solid::{Solid, SolidState};
pub use strength::{
    Adiabatic, AdiabaticJohnsonCook, Borvik, Cone, CowperSymonds, DruckerPrager, Elastic, Heat,
    HolmquistJohnsonCook, Isothermal, J2, JohnsonCook, Logarithmic, MohrCoulomb, PowerRate, RateIndependent,
    SimplifiedJohnsonCook, SmoothLogarithmic, SteinbergGuinan, Strength,
};
pub use stretching::{Stretching, StretchingState};
pub use tangent::{Differential, NoDifferential, Tangent};
pub use tensor::{Mat3, Sym3};
pub use viscosity::{BulkViscosity, NoViscosity, ShockViscosity};
