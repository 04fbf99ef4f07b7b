//! Materials: named sets of the library, or laws from their parts.

use schemars::JsonSchema;
use serde::Deserialize;

use super::parts::parts;
use crate::quantity::{
    Angle, Density, EnergyDensity, HeatCapacity, Plain, Pressure, Quantity, Rate, Speed, Temperature,
    Viscosity,
};

/// A material: exactly one of `library`, `elastic`, `neo_hookean`, `strength` with `eos`, `ground`, `fluid`, `explosive`; metals with
/// `failure`, all but the first three kinds with `bulk_viscosity`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// A named set of the library (`impactite list materials`).
    #[serde(default)]
    pub library: Option<Library>,
    /// Linear elasticity in rate form.
    #[serde(default)]
    pub elastic: Option<ElasticConstants>,
    /// Compressible neo-Hookean: rubber, and metal at large elastic strain.
    #[serde(default)]
    pub neo_hookean: Option<ElasticConstants>,
    /// Strength of a metal, beside an equation of state.
    #[serde(default)]
    pub strength: Option<Strength>,
    /// The equation of state of a metal.
    #[serde(default)]
    pub eos: Option<Eos>,
    /// When metal fails, and what it bears then.
    #[serde(default)]
    pub failure: Option<Failure>,
    /// Soil, concrete, granular matter.
    #[serde(default)]
    pub ground: Option<GroundLaw>,
    /// A fluid.
    #[serde(default)]
    pub fluid: Option<FluidLaw>,
    /// An explosive.
    #[serde(default)]
    pub explosive: Option<ExplosiveLaw>,
    /// Width of the burn of an explosive, in cells; 1.5 if not given.
    #[serde(default)]
    pub burn_width: Option<Quantity<Plain>>,
    /// Artificial bulk viscosity against ringing behind shocks: linear and quadratic coefficient, as `[0.06, 1.5]`.
    #[serde(default)]
    pub bulk_viscosity: Option<[Quantity<Plain>; 2]>,
}

macro_rules! library {
    ($($(#[$doc:meta])* $name:ident = $word:literal,)*) => {
        /// Named sets of constants, with their sources in the book, "Material constants".
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
        pub enum Library { $($(#[$doc])* #[serde(rename = $word)] $name,)* }
        impl Library {
            /// All of them, with their names.
            pub const ALL: &[(Library, &str)] = &[$((Library::$name, $word),)*];
        }
    };
}

library! {
    /// 6061-T6 aluminium: Johnson-Cook, Mie-Grueneisen.
    Aluminium6061T6 = "aluminium_6061_t6",
    /// Aluminium as printed in Feng 2014.
    AluminiumFeng2014 = "aluminium_feng_2014",
    /// Copper as printed in Feng 2014.
    CopperFeng2014 = "copper_feng_2014",
    /// OFHC copper, the handbook set.
    CopperOfhc = "copper_ofhc",
    /// OFHC copper as fitted to Taylor tests; no rate, no heat.
    CopperTaylor = "copper_taylor",
    /// OFHC copper by Steinberg and Guinan, for rates above 1e5 /s.
    CopperSteinberg = "copper_steinberg",
    /// The casing of a deck of MPM3D-F90.
    CopperCasing = "copper_casing",
    /// 4340 steel.
    Steel4340 = "steel_4340",
    /// 4340 steel by Steinberg and Guinan.
    Steel4340Steinberg = "steel_4340_steinberg",
    /// A steel that does not yield.
    SteelElastic = "steel_elastic",
    /// Weldox 460 E with ductile damage that softens it.
    Weldox460E = "weldox_460_e",
    /// Weldox 460 E with damage that does not soften it.
    Weldox460EUncoupled = "weldox_460_e_uncoupled",
    /// Hardened Arne tool steel.
    ArneToolSteel = "arne_tool_steel",
    /// Tungsten alloy.
    TungstenAlloy = "tungsten_alloy",
    /// Lead.
    Lead = "lead",
    /// Concrete of 48 MPa (Holmquist, Johnson and Cook).
    Concrete48 = "concrete_48",
    /// Soil of a slope (Drucker-Prager).
    SlopeSoil = "slope_soil",
    /// Aluminium bars as granular matter of the plane (Drucker-Prager).
    AluminiumBars = "aluminium_bars",
    /// Dry sand (Drucker-Prager).
    DrySand = "dry_sand",
    /// TNT.
    Tnt = "tnt",
    /// Air at 15 degrees Celsius.
    Air = "air",
    /// Water at true stiffness (Tait).
    Water = "water",
    /// Water under shock (Mie-Grueneisen).
    WaterShocked = "water_shocked",
}

/// Resistance to shear.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// Elastic.
    Elastic(Shear),
    /// J2 plasticity with linear hardening.
    J2(J2Constants),
    /// Johnson-Cook; with rate and heat where they are given.
    JohnsonCook(Box<JohnsonCookConstants>),
}

/// Pressure by density and energy.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Eos {
    /// p = c^2 (rho - rho0).
    LinearDensity(SoundConstants),
    /// p = K ln(rho / rho0).
    LogarithmicBulk(BulkConstants),
    /// Mie-Grueneisen with the Hugoniot us = c0 + s up.
    MieGruneisen(ShockConstants),
}

/// When metal fails; it then bears compression alone, as rubble.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// Damage of Johnson and Cook, D1 to D5 (rate and temperature in D4, D5).
    JohnsonCook(DamageConstants),
    /// Where the tension of a spall reaches this.
    TensilePressure(Limit),
    /// Where the plastic strain reaches this.
    PlasticStrain(StrainLimit),
}

/// Soil, concrete, granular matter.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundLaw {
    /// Drucker-Prager, matched to Mohr and Coulomb by `cone`.
    DruckerPrager(FrictionConstants),
    /// Mohr-Coulomb.
    MohrCoulomb(FrictionConstants),
}

/// A fluid.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FluidLaw {
    /// An ideal gas.
    IdealGas(GasConstants),
    /// Tait's equation, as water.
    Tait(TaitConstants),
    /// A liquid under shock.
    MieGruneisen(ShockConstants),
}

/// An explosive with JWL products.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExplosiveLaw {
    /// JWL.
    Jwl(Box<JwlConstants>),
}

parts! {
    /// Density and moduli.
    ElasticConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Young's modulus E, with `poisson`; instead of both `bulk_modulus` and `shear_modulus`.
        #[serde(default)]
        young: Option<Quantity<Pressure>>,
        /// Poisson's ratio nu.
        #[serde(default)]
        poisson: Option<Quantity<Plain>>,
        /// Bulk modulus K.
        #[serde(default)]
        bulk_modulus: Option<Quantity<Pressure>>,
        /// Shear modulus G.
        #[serde(default)]
        shear_modulus: Option<Quantity<Pressure>>,
    }
    /// Shear modulus.
    Shear {
        /// Shear modulus G.
        shear_modulus: Quantity<Pressure>,
    }
    /// Linear hardening.
    J2Constants {
        /// Shear modulus G.
        shear_modulus: Quantity<Pressure>,
        /// Yield stress.
        #[serde(rename = "yield")]
        yield_stress: Quantity<Pressure>,
        /// Plastic modulus: stress per plastic strain.
        #[serde(default)]
        hardening: Quantity<Pressure>,
    }
    /// sigma_y = (A + B eps^n)(1 + C ln rate*)(1 - T*^m).
    JohnsonCookConstants {
        /// Shear modulus G.
        shear_modulus: Quantity<Pressure>,
        /// A.
        a: Quantity<Pressure>,
        /// B.
        b: Quantity<Pressure>,
        /// n.
        n: Quantity<Plain>,
        /// Rate: C and its reference rate; none without `heat`.
        #[serde(default)]
        rate: Option<RateConstants>,
        /// Heating by plastic work, and thermal softening; none without `rate`.
        #[serde(default)]
        heat: Option<HeatConstants>,
    }
    /// Rate factor.
    RateConstants {
        /// C.
        c: Quantity<Plain>,
        /// Reference rate.
        reference: Quantity<Rate>,
    }
    /// Heat.
    HeatConstants {
        /// Room temperature.
        room: Quantity<Temperature>,
        /// Melting temperature.
        melt: Quantity<Temperature>,
        /// Softening exponent m.
        m: Quantity<Plain>,
        /// Heat capacity.
        capacity: Quantity<HeatCapacity>,
        /// Part of the plastic work that heats (Taylor-Quinney); 0.9 if none is given.
        #[serde(default)]
        taylor_quinney: Option<Quantity<Plain>>,
    }
    /// Density and speed of sound.
    SoundConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Speed of sound c0.
        sound_speed: Quantity<Speed>,
    }
    /// Density and bulk modulus.
    BulkConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Bulk modulus K.
        bulk_modulus: Quantity<Pressure>,
    }
    /// Hugoniot and Grueneisen's coefficient.
    ShockConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Speed of sound c0.
        sound_speed: Quantity<Speed>,
        /// Slope s.
        slope: Quantity<Plain>,
        /// gamma0.
        gruneisen: Quantity<Plain>,
    }
    /// eps_f = (D1 + D2 exp(D3 triaxiality))(1 + D4 ln rate*)(1 + D5 T*).
    DamageConstants {
        /// D1 to D5.
        d: [Quantity<Plain>; 5],
        /// Reference rate.
        reference: Quantity<Rate>,
    }
    /// A stress.
    Limit {
        /// The strength.
        strength: Quantity<Pressure>,
    }
    /// A strain.
    StrainLimit {
        /// The plastic strain.
        limit: Quantity<Plain>,
        /// Does what failed bear nothing from then on, and meet nothing?
        #[serde(default)]
        removed: bool,
    }
    /// Elasticity, friction and cohesion.
    FrictionConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Young's modulus E.
        young: Quantity<Pressure>,
        /// Poisson's ratio nu.
        poisson: Quantity<Plain>,
        /// Friction angle.
        friction: Quantity<Angle>,
        /// Cohesion.
        #[serde(default)]
        cohesion: Quantity<Pressure>,
        /// Dilatancy angle.
        #[serde(default)]
        dilatancy: Quantity<Angle>,
        /// Tensile strength; that of the apex if none is given.
        #[serde(default)]
        tension: Option<Quantity<Pressure>>,
        /// Which cone of Drucker and Prager stands for Mohr and Coulomb's pyramid; `outer` if none is given.
        #[serde(default)]
        cone: Option<ConeWord>,
    }
    /// Of a gas.
    GasConstants {
        /// Density at the start.
        density: Quantity<Density>,
        /// Ratio of heat capacities.
        gamma: Quantity<Plain>,
        /// Pressure at the start.
        pressure: Quantity<Pressure>,
        /// Shear viscosity; none if not given.
        #[serde(default)]
        viscosity: Option<Quantity<Viscosity>>,
    }
    /// Of a liquid.
    TaitConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Speed of sound c0.
        sound_speed: Quantity<Speed>,
        /// Shear viscosity; none if not given.
        #[serde(default)]
        viscosity: Option<Quantity<Viscosity>>,
    }
    /// p = A (1 - omega / (R1 V)) exp(-R1 V) + B (1 - omega / (R2 V)) exp(-R2 V) + omega e.
    JwlConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// A.
        a: Quantity<Pressure>,
        /// B.
        b: Quantity<Pressure>,
        /// R1.
        r1: Quantity<Plain>,
        /// R2.
        r2: Quantity<Plain>,
        /// omega.
        omega: Quantity<Plain>,
        /// Energy of a volume, E0.
        energy: Quantity<EnergyDensity>,
        /// Detonation speed; that of the Chapman-Jouguet state if none is given.
        #[serde(default)]
        detonation_speed: Option<Quantity<Speed>>,
    }
}

/// A cone through, or beside, Mohr and Coulomb's pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConeWord {
    /// Through its inner edges: exact in triaxial extension, safe elsewhere.
    Inner,
    /// Through its outer edges: exact in triaxial compression.
    Outer,
    /// Equal limit loads in plane strain.
    PlaneStrain,
}
