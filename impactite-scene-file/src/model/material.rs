//! Materials: named sets of the library, or laws composed of parts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parts::parts;
use crate::quantity::{
    Angle, Density, EnergyDensity, HeatCapacity, Plain, Pressure, Quantity, Rate, Speed, SurfaceTension,
    Temperature, Viscosity,
};

/// Default Taylor-Quinney coefficient.
pub const TAYLOR_QUINNEY: f64 = 0.9;
/// Default burn width of an explosive, in cells.
pub const BURN_WIDTH: f64 = 1.5;

/// A material: exactly one of `library`, `elastic`, `neo_hookean`, `strength` with `eos`, `ground`, `fluid`, `explosive`; metals with
/// `failure`, all but `elastic` and `neo_hookean` with `bulk_viscosity`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Named set of constants (`impactite list materials`).
    #[serde(default)]
    #[schemars(example = &"steel_4340")]
    pub library: Option<Library>,
    /// Linear elasticity in rate form.
    #[serde(default)]
    pub elastic: Option<ElasticConstants>,
    /// Compressible neo-Hookean law: rubber, and metal at large elastic strain.
    #[serde(default)]
    pub neo_hookean: Option<ElasticConstants>,
    /// Strength of a metal, with an equation of state.
    #[serde(default)]
    pub strength: Option<Strength>,
    /// Equation of state of a metal, with a strength.
    #[serde(default)]
    pub eos: Option<Eos>,
    /// Failure of a metal. A failed point carries compression alone, unless its key `removed` is true.
    #[serde(default)]
    pub failure: Option<Failure>,
    /// Soil, granular material.
    #[serde(default)]
    pub ground: Option<GroundLaw>,
    /// Fluid.
    #[serde(default)]
    pub fluid: Option<FluidLaw>,
    /// Explosive.
    #[serde(default)]
    pub explosive: Option<ExplosiveLaw>,
    /// Width of the burn of an explosive, in cells.
    #[serde(default)]
    #[schemars(example = 4, extend("default" = BURN_WIDTH, "exclusiveMinimum" = 0))]
    pub burn_width: Option<Quantity<Plain>>,
    /// Artificial bulk viscosity against ringing behind shocks: linear and quadratic coefficient. None if not given; `[0.06, 1.5]` is usual.
    #[serde(default)]
    #[schemars(example = (0.06, 1.5))]
    pub bulk_viscosity: Option<[Quantity<Plain>; 2]>,
}

macro_rules! library {
    ($($(#[$doc:meta])* $name:ident = $word:literal,)*) => {
        /// Named sets of constants, with their sources in the book, "Material constants".
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
        pub enum Library { $($(#[$doc])* #[serde(rename = $word)] $name,)* }
        impl Library {
            /// All named sets, with their keys.
            pub const ALL: &[(Library, &str)] = &[$((Library::$name, $word),)*];
        }
    };
}

library! {
    /// 6061-T6 aluminium: Johnson-Cook, Mie-Grueneisen. Source: Uintah \[V\].
    Aluminium6061T6 = "aluminium_6061_t6",
    /// 2024-T3 aluminium: Johnson-Cook, Mie-Grueneisen. Source: Lesuer 2000 \[V2\], moduli and Hugoniot Steinberg 1996 \[V\].
    Aluminium2024T3 = "aluminium_2024_t3",
    /// Aluminium as printed in Feng 2014. Source: Feng 2014 \[S\], with its faults, for repeating that paper.
    AluminiumFeng2014 = "aluminium_feng_2014",
    /// Copper as printed in Feng 2014. Source: Feng 2014 \[S\], misprints replaced, for repeating that paper.
    CopperFeng2014 = "copper_feng_2014",
    /// OFHC copper, the handbook set. Source: three public tables \[V\].
    CopperOfhc = "copper_ofhc",
    /// OFHC copper as fitted to Taylor tests; no rate, no heat. Source: MPM3D-F90 \[V\].
    CopperTaylor = "copper_taylor",
    /// OFHC copper by Steinberg and Guinan, for rates above 1e5 /s. Source: Steinberg 1996 \[V\], hardening \[M\].
    CopperSteinberg = "copper_steinberg",
    /// The casing of a deck of MPM3D-F90. Source: MPM3D-F90 \[V\].
    CopperCasing = "copper_casing",
    /// 4340 steel: Johnson-Cook, Mie-Grueneisen. Source: Uintah \[V\].
    Steel4340 = "steel_4340",
    /// 4340 steel by Steinberg and Guinan. Source: Uintah \[V\], two misprints corrected \[I\].
    Steel4340Steinberg = "steel_4340_steinberg",
    /// A steel that does not yield. Source: usual values \[M\].
    SteelElastic = "steel_elastic",
    /// Weldox 460 E with ductile damage that softens it. Source: Borvik 2001, most \[M\], damage \[V\].
    Weldox460E = "weldox_460_e",
    /// Weldox 460 E with damage that does not soften it. Source: karamelo \[V\], rate and heat \[M\].
    Weldox460EUncoupled = "weldox_460_e_uncoupled",
    /// Hardened Arne tool steel: J2 with linear hardening. Source: \[M\].
    ArneToolSteel = "arne_tool_steel",
    /// Tungsten alloy: Johnson-Cook, Mie-Grueneisen. Source: Uintah \[V\], melting temperature and heat capacity \[M\].
    TungstenAlloy = "tungsten_alloy",
    /// Lead: Johnson-Cook without rate and heat, Mie-Grueneisen. Source: MPM3D-F90 \[V\].
    Lead = "lead",
    /// Concrete of 48 MPa (Holmquist, Johnson and Cook). Source: Holmquist, Johnson and Cook 1993 \[V2\].
    Concrete48 = "concrete_48",
    /// Soil of a slope (Drucker-Prager). Source: MPM3D-F90 \[V\].
    SlopeSoil = "slope_soil",
    /// Aluminium bars as granular matter of the plane (Drucker-Prager). Source: after Bui 2008 \[V2\].
    AluminiumBars = "aluminium_bars",
    /// Dry sand (Drucker-Prager). Source: typical values \[M\].
    DrySand = "dry_sand",
    /// TNT: JWL products, programmed burn. Source: MPM3D-F90 \[V\].
    Tnt = "tnt",
    /// Air at 15 degrees Celsius. Source: standard atmosphere.
    Air = "air",
    /// Water at true stiffness (Tait). Source: handbook values \[M\].
    Water = "water",
    /// Water under shock (Mie-Grueneisen). Source: \[M\].
    WaterShocked = "water_shocked",
}

/// Strength of a metal.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// Elastic: never yields.
    Elastic(Shear),
    /// J2 plasticity with linear hardening.
    J2(J2Constants),
    /// Johnson-Cook, with rate and temperature where `rate` and `heat` are given.
    JohnsonCook(Box<JohnsonCookConstants>),
}

/// Equation of state: pressure by density and energy.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Eos {
    /// p = c0^2 (rho - rho0).
    LinearDensity(SoundConstants),
    /// p = K ln(rho / rho0).
    LogarithmicBulk(BulkConstants),
    /// Mie-Grueneisen with the Hugoniot us = c0 + s up.
    MieGruneisen(ShockConstants),
}

/// Failure of a metal.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// Johnson-Cook damage: sum of plastic strain over failure strain.
    JohnsonCook(DamageConstants),
    /// Spall at a tensile pressure.
    TensilePressure(Limit),
    /// Failure at a plastic strain.
    PlasticStrain(StrainLimit),
    /// Failure of the named set (`library`), with its own constants: of the sets that `impactite list materials` shows with one.
    Library,
}

/// Soil, granular material.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundLaw {
    /// Drucker-Prager, matched to Mohr-Coulomb by `cone`.
    DruckerPrager(FrictionConstants),
    /// Mohr-Coulomb.
    MohrCoulomb(FrictionConstants),
}

/// Fluid.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FluidLaw {
    /// Ideal gas.
    IdealGas(GasConstants),
    /// Liquid by Tait's equation with exponent 7.
    Tait(TaitConstants),
    /// Liquid under shock: Mie-Grueneisen.
    #[schemars(extend("examples" = [{"mie_gruneisen": {"density": 1000, "sound_speed": "1490 m/s", "slope": 1.79, "gruneisen": 1.65}}]))]
    MieGruneisen(ShockConstants),
    /// Incompressible Newtonian liquid (`flow`).
    Incompressible(LiquidConstants),
}

/// Explosive with JWL products.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExplosiveLaw {
    /// Jones-Wilkins-Lee, with programmed burn.
    Jwl(Box<JwlConstants>),
}

parts! {
    /// Density and two moduli.
    #[schemars(extend("examples" = [{"density": "7850 kg/m^3", "young": "206 GPa", "poisson": 0.3}]))]
    ElasticConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Young's modulus E, with `poisson`. Instead of both `bulk_modulus` with `shear_modulus`.
        #[serde(default)]
        #[schemars(example = "206 GPa")]
        young: Option<Quantity<Pressure>>,
        /// Poisson's ratio nu.
        #[serde(default)]
        #[schemars(example = 0.3, extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
        poisson: Option<Quantity<Plain>>,
        /// Bulk modulus K.
        #[serde(default)]
        #[schemars(example = "172 GPa")]
        bulk_modulus: Option<Quantity<Pressure>>,
        /// Shear modulus G.
        #[serde(default)]
        #[schemars(example = "79 GPa")]
        shear_modulus: Option<Quantity<Pressure>>,
    }
    /// Shear modulus.
    Shear {
        /// Shear modulus G.
        #[schemars(example = "79 GPa")]
        shear_modulus: Quantity<Pressure>,
    }
    /// Linear hardening.
    J2Constants {
        /// Shear modulus G.
        #[schemars(example = "79 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Initial yield stress.
        #[serde(rename = "yield")]
        #[schemars(example = "350 MPa")]
        yield_stress: Quantity<Pressure>,
        /// Plastic modulus: increase of the yield stress over plastic strain.
        #[serde(default)]
        #[schemars(example = "1 GPa")]
        hardening: Quantity<Pressure>,
    }
    /// sigma_y = (A + B eps^n)(1 + C ln rate*)(1 - T*^m).
    JohnsonCookConstants {
        /// Shear modulus G.
        #[schemars(example = "80 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Initial yield stress A.
        #[schemars(example = "792 MPa")]
        a: Quantity<Pressure>,
        /// Hardening coefficient B.
        #[schemars(example = "510 MPa")]
        b: Quantity<Pressure>,
        /// Hardening exponent n.
        #[schemars(example = 0.26)]
        n: Quantity<Plain>,
        /// Rate factor, together with `heat`.
        #[serde(default)]
        rate: Option<RateConstants>,
        /// Heating by plastic work and thermal softening, together with `rate`.
        #[serde(default)]
        heat: Option<HeatConstants>,
    }
    /// Rate factor 1 + C ln(rate / reference).
    RateConstants {
        /// Rate coefficient C.
        #[schemars(example = 0.014, extend("minimum" = 0))]
        c: Quantity<Plain>,
        /// Reference strain rate.
        reference: Quantity<Rate>,
    }
    /// Heating and thermal softening.
    HeatConstants {
        /// Room temperature, that of the start.
        #[schemars(example = "294 K")]
        room: Quantity<Temperature>,
        /// Melting temperature.
        #[schemars(example = "1793 K")]
        melt: Quantity<Temperature>,
        /// Softening exponent m.
        #[schemars(example = 1.03)]
        m: Quantity<Plain>,
        /// Specific heat capacity.
        capacity: Quantity<HeatCapacity>,
        /// Taylor-Quinney coefficient: part of the plastic work that heats.
        #[serde(default)]
        #[schemars(example = 0.9, extend("default" = TAYLOR_QUINNEY, "minimum" = 0, "maximum" = 1))]
        taylor_quinney: Option<Quantity<Plain>>,
    }
    /// Density and speed of sound.
    SoundConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Bulk speed of sound c0.
        #[schemars(example = "4570 m/s")]
        sound_speed: Quantity<Speed>,
    }
    /// Density and bulk modulus.
    BulkConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Bulk modulus K.
        #[schemars(example = "172 GPa")]
        bulk_modulus: Quantity<Pressure>,
    }
    /// Hugoniot and Grueneisen coefficient.
    ShockConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Bulk speed of sound c0.
        #[schemars(example = "3574 m/s")]
        sound_speed: Quantity<Speed>,
        /// Slope s of the Hugoniot.
        #[schemars(example = 1.92)]
        slope: Quantity<Plain>,
        /// Grueneisen coefficient gamma0.
        #[schemars(example = 1.69)]
        gruneisen: Quantity<Plain>,
    }
    /// Failure strain (D1 + D2 exp(D3 s*))(1 + D4 ln rate*)(1 + D5 T*) with the triaxiality s*, positive in tension.
    DamageConstants {
        /// D1 to D5; D3 is negative for metals that are less ductile in tension.
        #[schemars(example = (0.05, 3.44, -2.12, 0.002, 0.61))]
        d: [Quantity<Plain>; 5],
        /// Reference strain rate.
        reference: Quantity<Rate>,
    }
    /// A tensile strength.
    Limit {
        /// Tensile pressure at which the material spalls.
        #[schemars(example = "1.2 GPa")]
        strength: Quantity<Pressure>,
    }
    /// A plastic strain.
    StrainLimit {
        /// Plastic strain at which the material fails.
        #[schemars(example = 1.5)]
        limit: Quantity<Plain>,
        /// Failed particles carry nothing and touch nothing.
        #[serde(default)]
        removed: bool,
    }
    /// Elasticity, friction and cohesion.
    FrictionConstants {
        /// Density rho0.
        #[schemars(example = "1800 kg/m^3")]
        density: Quantity<Density>,
        /// Young's modulus E.
        #[schemars(example = "20 MPa")]
        young: Quantity<Pressure>,
        /// Poisson's ratio nu.
        #[schemars(example = 0.3, extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
        poisson: Quantity<Plain>,
        /// Friction angle phi.
        friction: Quantity<Angle>,
        /// Cohesion c.
        #[serde(default)]
        #[schemars(example = "5 kPa")]
        cohesion: Quantity<Pressure>,
        /// Dilatancy angle psi.
        #[serde(default)]
        #[schemars(example = "5 deg")]
        dilatancy: Quantity<Angle>,
        /// Tensile strength; that of the apex of the cone, c / tan(phi), if not given.
        #[serde(default)]
        #[schemars(example = "1 kPa")]
        tension: Option<Quantity<Pressure>>,
        /// Cone that replaces the pyramid of Mohr-Coulomb (`drucker_prager` alone).
        #[serde(default)]
        #[schemars(example = &"plane_strain", extend("default" = ConeWord::default()))]
        cone: Option<ConeWord>,
    }
    /// An ideal gas.
    GasConstants {
        /// Initial density.
        #[schemars(example = "1.225 kg/m^3")]
        density: Quantity<Density>,
        /// Ratio of heat capacities.
        #[schemars(example = 1.4)]
        gamma: Quantity<Plain>,
        /// Initial pressure.
        #[schemars(example = "101325 Pa")]
        pressure: Quantity<Pressure>,
        /// Shear viscosity; inviscid if not given.
        #[serde(default)]
        #[schemars(example = "18 uPa s")]
        viscosity: Option<Quantity<Viscosity>>,
    }
    /// A liquid.
    TaitConstants {
        /// Density rho0.
        #[schemars(example = "1000 kg/m^3")]
        density: Quantity<Density>,
        /// Speed of sound c0. For free surfaces ten times the fastest flow is enough.
        #[schemars(example = "1480 m/s")]
        sound_speed: Quantity<Speed>,
        /// Shear viscosity; inviscid if not given.
        #[serde(default)]
        #[schemars(example = "1 mPa s")]
        viscosity: Option<Quantity<Viscosity>>,
    }
    /// Constants of an incompressible liquid.
    LiquidConstants {
        /// Density rho.
        #[schemars(example = "1000 kg/m^3")]
        density: Quantity<Density>,
        /// Dynamic viscosity mu; inviscid if not given.
        #[serde(default)]
        #[schemars(example = "1 mPa s")]
        viscosity: Quantity<Viscosity>,
        /// Surface tension sigma; none if not given.
        #[serde(default)]
        #[schemars(example = "0.072 N/m")]
        surface_tension: Quantity<SurfaceTension>,
    }
    /// p = A (1 - omega / (R1 V)) exp(-R1 V) + B (1 - omega / (R2 V)) exp(-R2 V) + omega e.
    JwlConstants {
        /// Density rho0.
        #[schemars(example = "1630 kg/m^3")]
        density: Quantity<Density>,
        /// A.
        #[schemars(example = "371.2 GPa")]
        a: Quantity<Pressure>,
        /// B.
        #[schemars(example = "3.21 GPa")]
        b: Quantity<Pressure>,
        /// R1.
        #[schemars(example = 4.15)]
        r1: Quantity<Plain>,
        /// R2.
        #[schemars(example = 0.95)]
        r2: Quantity<Plain>,
        /// omega.
        #[schemars(example = 0.3)]
        omega: Quantity<Plain>,
        /// Detonation energy E0 of a volume.
        #[schemars(example = "6.993 GJ/m^3")]
        energy: Quantity<EnergyDensity>,
        /// Detonation speed; that of the Chapman-Jouguet state if not given.
        #[serde(default)]
        #[schemars(example = "6930 m/s")]
        detonation_speed: Option<Quantity<Speed>>,
    }
}

/// Cone of Drucker-Prager through, or beside, the pyramid of Mohr-Coulomb.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConeWord {
    /// Inner edges: exact in triaxial extension, safe elsewhere.
    Inner,
    /// Outer edges: exact in triaxial compression.
    #[default]
    Outer,
    /// Equal limit loads in plane strain.
    PlaneStrain,
}
