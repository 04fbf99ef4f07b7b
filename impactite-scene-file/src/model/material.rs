//! Materials: named sets of the library, or laws composed of parts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parts::parts;
use crate::quantity::{
    Angle, Density, EnergyDensity, HeatCapacity, Length, PerPressure, PerTemperature, Plain, Pressure,
    Quantity, Rate, Speed, SurfaceEnergy, SurfaceTension, Temperature, Time, Viscosity,
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
    /// Failure of a metal: a table of criteria, of which the first that is met counts, or `"library"`: that of the named set. A failed point
    /// carries compression alone, unless `leaves` says otherwise.
    #[serde(default)]
    pub failure: Option<FailureChoice>,
    /// Soil, granular material.
    #[serde(default)]
    pub ground: Option<GroundLaw>,
    /// Fluid.
    #[serde(default)]
    pub fluid: Option<FluidLaw>,
    /// Shear stress of a fluid with a yield stress (`fluid` other than `incompressible`).
    #[serde(default)]
    pub bingham: Option<BinghamConstants>,
    /// Pores of a metal that close under pressure (p-alpha), with `strength` and `eos` of the solid.
    #[serde(default)]
    pub porous: Option<PorousConstants>,
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
    /// J2 plasticity with linear hardening, with rate and temperature where `rate` and `heat` are given.
    J2(Box<J2Constants>),
    /// J2 plasticity with Voce hardening, which saturates, with rate and temperature where `rate` and `heat` are given.
    Voce(Box<VoceConstants>),
    /// J2 plasticity with power hardening up to a largest yield stress, with rate and temperature where `rate` and `heat` are given.
    SaturatingPower(Box<SaturatingConstants>),
    /// Johnson-Cook, with rate and temperature where `rate` and `heat` are given.
    JohnsonCook(Box<JohnsonCookConstants>),
    /// Steinberg-Guinan: yield stress and shear modulus by pressure and temperature, for rates above 1e5 /s.
    SteinbergGuinan(Box<SteinbergConstants>),
    /// Viscoplasticity with damage that softens (Borvik and others), with `failure.damage` at its critical damage unless given.
    Borvik(Box<BorvikConstants>),
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
    /// Mie-Grueneisen with a cubic shock velocity (Steinberg).
    CubicShock(CubicConstants),
    /// Mie-Grueneisen with the Hugoniot p = K1 mu + K2 mu^2 + K3 mu^3.
    PolynomialHugoniot(HugoniotConstants),
    /// p = c0 + c1 mu + c2 mu^2 + c3 mu^3 + (c4 + c5 mu + c6 mu^2) e.
    Polynomial(PolynomialConstants),
    /// p = rho0 c0^2 / 7 ((rho / rho0)^7 - 1).
    Tait(SoundConstants),
}

/// Criteria of failure, or `"library"`.
#[derive(Clone, Debug)]
pub enum FailureChoice {
    /// Failure of the named set (`library`), with its own constants: of the sets that `impactite list materials` shows with one.
    Library,
    /// Given criteria.
    By(Box<Failure>),
}

impl<'de> Deserialize<'de> for FailureChoice {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl<'de> serde::de::Visitor<'de> for Reads {
            type Value = FailureChoice;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "a table of criteria, or \"library\"")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<FailureChoice, E> {
                match text {
                    "library" => Ok(FailureChoice::Library),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(text), &self)),
                }
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<FailureChoice, A::Error> {
                Failure::deserialize(serde::de::value::MapAccessDeserializer::new(map))
                    .map(|criteria| FailureChoice::By(Box::new(criteria)))
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for FailureChoice {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "FailureOrLibrary".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let criteria = generator.subschema_for::<Failure>();
        schemars::json_schema!({
            "description": "Criteria of failure, or \"library\": that of the named set",
            "anyOf": [criteria, { "const": "library" }],
        })
    }
}

/// Stress that a failed point carries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Leaves {
    /// Compression without shear and tension: rubble.
    #[default]
    Compression,
    /// Compression and shear without tension: cracked.
    CompressionAndShear,
    /// Pressure and tension without shear: molten.
    Pressure,
    /// Nothing; the point touches nothing either.
    Nothing,
}

/// Rate factor of a yield stress.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RateWord {
    /// 1 + C ln(rate / reference), one below the reference rate.
    #[default]
    Logarithmic,
    /// 1 + C ln(1 + rate / reference).
    SmoothLogarithmic,
    /// (1 + rate / reference)^C.
    Power,
    /// Cowper and Symonds: 1 + (rate / reference)^(1/q).
    CowperSymonds,
}

/// Soil, granular material.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundLaw {
    /// Drucker-Prager, matched to Mohr-Coulomb by `cone`.
    DruckerPrager(FrictionConstants),
    /// Mohr-Coulomb.
    MohrCoulomb(FrictionConstants),
    /// Concrete by Holmquist, Johnson and Cook: crushing pores, rate, damage.
    Concrete(Box<ConcreteConstants>),
}

/// Fluid.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FluidLaw {
    /// Ideal gas.
    IdealGas(GasConstants),
    /// Liquid by Tait's equation with exponent 7.
    Tait(TaitConstants),
    /// Liquid or gas by a polynomial.
    Polynomial(PolynomialConstants),
    /// Detonation products by Jones, Wilkins and Lee, without burn: `detonation_speed` is not read.
    Jwl(Box<JwlConstants>),
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
        /// Rate factor.
        #[serde(default)]
        rate: Option<RateConstants>,
        /// Heating by plastic work and thermal softening.
        #[serde(default)]
        heat: Option<HeatConstants>,
    }
    /// sigma_y = (A + Q (1 - exp(-b eps))) times the factors of `rate` and `heat`.
    VoceConstants {
        /// Shear modulus G.
        #[schemars(example = "26 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Initial yield stress A.
        #[serde(rename = "yield")]
        #[schemars(example = "270 MPa")]
        yield_stress: Quantity<Pressure>,
        /// Increase Q of the yield stress up to saturation.
        #[schemars(example = "100 MPa")]
        saturation: Quantity<Pressure>,
        /// Exponent b: plastic strain of 1/b for 63 % of the saturation.
        #[schemars(example = 12)]
        b: Quantity<Plain>,
        /// Rate factor.
        #[serde(default)]
        rate: Option<RateConstants>,
        /// Heating by plastic work and thermal softening.
        #[serde(default)]
        heat: Option<HeatConstants>,
    }
    /// sigma_y = min(Y0 (1 + beta (eps + eps_i))^n, largest) times the factors of `rate` and `heat`.
    SaturatingConstants {
        /// Shear modulus G.
        #[schemars(example = "47.7 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Initial yield stress Y0.
        #[serde(rename = "yield")]
        #[schemars(example = "120 MPa")]
        yield_stress: Quantity<Pressure>,
        /// Largest yield stress.
        #[schemars(example = "640 MPa")]
        largest: Quantity<Pressure>,
        /// Hardening coefficient beta.
        #[schemars(example = 36)]
        beta: Quantity<Plain>,
        /// Hardening exponent n.
        #[schemars(example = 0.45, extend("minimum" = 0, "maximum" = 1))]
        n: Quantity<Plain>,
        /// Initial plastic strain eps_i.
        #[serde(default)]
        #[schemars(example = 0)]
        initial_strain: Quantity<Plain>,
        /// Rate factor.
        #[serde(default)]
        rate: Option<RateConstants>,
        /// Heating by plastic work and thermal softening.
        #[serde(default)]
        heat: Option<HeatConstants>,
    }
    /// Constants of Steinberg and Guinan: G = G0 (1 + A p J^(1/3) - B (T - 300 K)), yield stress in proportion.
    SteinbergConstants {
        /// Density rho0.
        #[schemars(example = "8930 kg/m^3")]
        density: Quantity<Density>,
        /// Shear modulus G0.
        #[schemars(example = "47.7 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Increase A of the relative shear modulus with pressure.
        #[schemars(example = "28.3e-12 /Pa")]
        pressure: Quantity<PerPressure>,
        /// Decrease B of the relative shear modulus with temperature.
        #[schemars(example = "0.377e-3 /K")]
        temperature: Quantity<PerTemperature>,
        /// Initial yield stress Y0.
        #[serde(rename = "yield")]
        #[schemars(example = "120 MPa")]
        yield_stress: Quantity<Pressure>,
        /// Largest yield stress.
        #[schemars(example = "640 MPa")]
        largest: Quantity<Pressure>,
        /// Hardening coefficient beta.
        #[schemars(example = 36)]
        beta: Quantity<Plain>,
        /// Hardening exponent n.
        #[schemars(example = 0.45, extend("minimum" = 0, "maximum" = 1))]
        n: Quantity<Plain>,
        /// Room temperature, that of the start.
        #[schemars(example = "300 K")]
        room: Quantity<Temperature>,
        /// Melting temperature at rho0.
        #[schemars(example = "1790 K")]
        melt: Quantity<Temperature>,
        /// Grueneisen gamma0 of the melting curve.
        #[schemars(example = 2.02)]
        gruneisen: Quantity<Plain>,
        /// Volume correction a of gamma.
        #[schemars(example = 1.5)]
        correction: Quantity<Plain>,
        /// Specific heat capacity.
        #[schemars(example = "383 J/(kg K)")]
        capacity: Quantity<HeatCapacity>,
        /// Taylor-Quinney coefficient: part of the plastic work that heats.
        #[serde(default)]
        #[schemars(example = 0.9, extend("default" = TAYLOR_QUINNEY, "minimum" = 0, "maximum" = 1))]
        taylor_quinney: Option<Quantity<Plain>>,
    }
    /// sigma_y = (1 - D)(A + B r^n)(1 + rate*)^C (1 - T*^m), with D = D_c (eps - p_d) / (eps_f - p_d) summed over increments.
    BorvikConstants {
        /// Shear modulus G.
        #[schemars(example = "75.2 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Initial yield stress A.
        #[schemars(example = "490 MPa")]
        a: Quantity<Pressure>,
        /// Hardening coefficient B.
        #[schemars(example = "807 MPa")]
        b: Quantity<Pressure>,
        /// Hardening exponent n.
        #[schemars(example = 0.73)]
        n: Quantity<Plain>,
        /// Rate coefficient C.
        #[schemars(example = 0.0114, extend("minimum" = 0))]
        c: Quantity<Plain>,
        /// Reference strain rate.
        #[schemars(example = "5e-4 /s")]
        reference: Quantity<Rate>,
        /// Heating and thermal softening.
        heat: HeatConstants,
        /// D1 to D5 of the fracture strain; D3 is negative for metals that are less ductile in tension.
        #[schemars(example = (0.0705, 1.732, -0.54, -0.0123, 0))]
        d: [Quantity<Plain>; 5],
        /// Critical damage D_c.
        #[schemars(example = 0.3, extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
        critical: Quantity<Plain>,
        /// Plastic strain p_d at which damage begins.
        #[serde(default)]
        #[schemars(example = 0)]
        threshold: Quantity<Plain>,
        /// Size of the cell for which D1 to D5 are measured (crack band); without it, they are used for any size.
        #[serde(default)]
        #[schemars(example = "1 mm")]
        size: Option<Quantity<Length>>,
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
        /// Rate factor.
        #[serde(default)]
        rate: Option<RateConstants>,
        /// Heating by plastic work and thermal softening.
        #[serde(default)]
        heat: Option<HeatConstants>,
    }
    /// Rate factor of the yield stress.
    #[schemars(extend("examples" = [{"c": 0.014, "reference": "1 /s"}]))]
    RateConstants {
        /// Rate coefficient C, of all laws but `cowper_symonds`.
        #[serde(default)]
        #[schemars(example = 0.014, extend("minimum" = 0))]
        c: Option<Quantity<Plain>>,
        /// Reference strain rate; that of a doubled yield stress with `cowper_symonds`.
        reference: Quantity<Rate>,
        /// Law of the rate.
        #[serde(default)]
        law: RateWord,
        /// Exponent q of `cowper_symonds`.
        #[serde(default)]
        #[schemars(example = 5, extend("exclusiveMinimum" = 0))]
        exponent: Option<Quantity<Plain>>,
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
        /// Volume correction a: gamma = (gamma0 + a mu) / (1 + mu).
        #[serde(default)]
        #[schemars(example = 0.46, extend("minimum" = 0))]
        correction: Quantity<Plain>,
        /// Expands like a gas far above the reference volume: vaporised metal (without `correction`).
        #[serde(default)]
        expanding: bool,
    }
    /// us = c0 + S1 up + S2 (up / us) up + S3 (up / us)^2 up, and Grueneisen coefficient.
    CubicConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// Bulk speed of sound c0.
        #[schemars(example = "3940 m/s")]
        sound_speed: Quantity<Speed>,
        /// S1, S2, S3.
        #[schemars(example = (1.489, 0, 0))]
        slopes: [Quantity<Plain>; 3],
        /// Grueneisen coefficient gamma0.
        #[schemars(example = 1.96)]
        gruneisen: Quantity<Plain>,
        /// Volume correction a: gamma = (gamma0 + a mu) / (1 + mu).
        #[serde(default)]
        #[schemars(example = 0.47, extend("minimum" = 0))]
        correction: Quantity<Plain>,
    }
    /// Hugoniot as a polynomial of mu = rho / rho0 - 1, and Grueneisen coefficient.
    HugoniotConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// K1, K2, K3.
        #[schemars(example = ("139 GPa", "276 GPa", "233 GPa"))]
        coefficients: [Quantity<Pressure>; 3],
        /// Grueneisen coefficient gamma0.
        #[schemars(example = 1.96)]
        gruneisen: Quantity<Plain>,
        /// Volume correction a: gamma = (gamma0 + a mu) / (1 + mu).
        #[serde(default)]
        #[schemars(example = 0.47, extend("minimum" = 0))]
        correction: Quantity<Plain>,
    }
    /// Polynomial of mu = rho / rho0 - 1 with terms of the energy e of a reference volume.
    PolynomialConstants {
        /// Density rho0.
        density: Quantity<Density>,
        /// C0 to C3.
        #[schemars(example = (0, "172 GPa", "200 GPa", 0))]
        cold: [Quantity<Pressure>; 4],
        /// C4 to C6.
        #[serde(default)]
        #[schemars(example = (1.7, 0, 0))]
        thermal: [Quantity<Plain>; 3],
        /// Initial energy of a volume.
        #[serde(default)]
        #[schemars(example = "0 J/m^3")]
        energy: Quantity<EnergyDensity>,
    }
    /// Failure strain (D1 + D2 exp(D3 s*))(1 + D4 ln rate*)(1 + D5 T*) with the triaxiality s*, positive in tension.
    DamageConstants {
        /// D1 to D5; D3 is negative for metals that are less ductile in tension.
        #[schemars(example = (0.05, 3.44, -2.12, 0.002, 0.61))]
        d: [Quantity<Plain>; 5],
        /// Reference strain rate.
        reference: Quantity<Rate>,
        /// Size of the cell for which D1 to D5 are measured (crack band); without it, they are used for any size.
        #[serde(default)]
        #[schemars(example = "1 mm")]
        size: Option<Quantity<Length>>,
    }
    /// Criteria of failure, of which the first that is met counts.
    #[derive(Default)]
    Failure {
        /// Johnson-Cook damage: sum of plastic strain over failure strain.
        #[serde(default)]
        johnson_cook: Option<DamageConstants>,
        /// Spall at a tensile pressure.
        #[serde(default)]
        tensile_pressure: Option<Limit>,
        /// Largest principal stress, or largest shear stress.
        #[serde(default)]
        principal_stress: Option<PrincipalLimits>,
        /// Tuler and Butcher: integral of the overstress over time.
        #[serde(default)]
        tuler_butcher: Option<OverstressConstants>,
        /// Plastic strain.
        #[serde(default)]
        plastic_strain: Option<StrainLimit>,
        /// Damage of the strength (`borvik`).
        #[serde(default)]
        damage: Option<DamageAt>,
        /// Spall whose crack takes work as it opens.
        #[serde(default)]
        cohesive_spall: Option<CohesiveConstants>,
        /// Failure of the named set (`library`), in addition.
        #[serde(default)]
        library: bool,
        /// Stress that a failed point carries.
        #[serde(default)]
        #[schemars(example = &"compression_and_shear")]
        leaves: Option<Leaves>,
    }
    /// Strengths of a brittle material.
    PrincipalLimits {
        /// Tensile strength: largest principal stress.
        #[schemars(example = "500 MPa")]
        tension: Quantity<Pressure>,
        /// Shear strength: largest shear stress.
        #[schemars(example = "1 GPa")]
        shear: Quantity<Pressure>,
    }
    /// Failure where the integral of (sigma_1 / threshold - 1)^exponent dt reaches `time`.
    OverstressConstants {
        /// Threshold of the largest principal stress.
        #[schemars(example = "1 GPa")]
        threshold: Quantity<Pressure>,
        /// Exponent lambda.
        #[schemars(example = 2)]
        exponent: Quantity<Plain>,
        /// Time t_f.
        #[schemars(example = "1 us")]
        time: Quantity<Time>,
    }
    /// Limit of damage.
    DamageAt {
        /// Damage at which the material fails.
        #[schemars(example = 0.3, extend("exclusiveMinimum" = 0, "maximum" = 1))]
        limit: Quantity<Plain>,
    }
    /// Tensile strength and work of fracture.
    CohesiveConstants {
        /// Tensile pressure at which a crack opens.
        #[schemars(example = "1.2 GPa")]
        strength: Quantity<Pressure>,
        /// Work per area of crack.
        #[schemars(example = "50 kJ/m^2")]
        work: Quantity<SurfaceEnergy>,
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
        /// Failed particles carry nothing and touch nothing: `leaves = "nothing"`.
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
    /// Concrete: sigma_eq / f_c = (A (1 - D) + B (p / f_c)^N)(1 + C ln rate*), at most S_max; pressure on a crush curve.
    ConcreteConstants {
        /// Density rho0.
        #[schemars(example = "2440 kg/m^3")]
        density: Quantity<Density>,
        /// Shear modulus G.
        #[schemars(example = "14.86 GPa")]
        shear_modulus: Quantity<Pressure>,
        /// Cohesion A over f_c.
        #[schemars(example = 0.79)]
        a: Quantity<Plain>,
        /// Pressure hardening B.
        #[schemars(example = 1.6)]
        b: Quantity<Plain>,
        /// Exponent N.
        #[schemars(example = 0.61)]
        n: Quantity<Plain>,
        /// Rate coefficient C.
        #[schemars(example = 0.007)]
        c: Quantity<Plain>,
        /// Reference strain rate.
        reference: Quantity<Rate>,
        /// Compressive strength f_c.
        #[schemars(example = "48 MPa")]
        compressive: Quantity<Pressure>,
        /// Tensile strength T: largest mean tension.
        #[schemars(example = "4 MPa")]
        tensile: Quantity<Pressure>,
        /// Largest strength S_max over f_c.
        #[schemars(example = 7)]
        largest: Quantity<Plain>,
        /// Damage constant D1.
        #[schemars(example = 0.04)]
        d1: Quantity<Plain>,
        /// Damage exponent D2.
        #[schemars(example = 1)]
        d2: Quantity<Plain>,
        /// Smallest strain to fracture.
        #[schemars(example = 0.01)]
        smallest_strain: Quantity<Plain>,
        /// Pressure at which pores begin to collapse.
        #[schemars(example = "16 MPa")]
        crush_pressure: Quantity<Pressure>,
        /// Compression mu there.
        #[schemars(example = 0.001)]
        crush_compression: Quantity<Plain>,
        /// Pressure at which all pores are closed.
        #[schemars(example = "800 MPa")]
        lock_pressure: Quantity<Pressure>,
        /// Compression mu of the material without pores at zero pressure.
        #[schemars(example = 0.1)]
        lock_compression: Quantity<Plain>,
        /// K1, K2, K3 of the material without pores.
        #[schemars(example = ("85 GPa", "-171 GPa", "208 GPa"))]
        solid: [Quantity<Pressure>; 3],
        /// Size of the cell for which the damage by plastic strain is measured (crack band).
        #[serde(default)]
        #[schemars(example = "5 mm")]
        size: Option<Quantity<Length>>,
    }
    /// Pores that close under pressure.
    PorousConstants {
        /// Distension alpha_0: density of the solid over that of the porous material.
        #[schemars(example = 1.5, extend("exclusiveMinimum" = 1))]
        distension: Quantity<Plain>,
        /// Pressure p_e at which pores begin to close.
        #[schemars(example = "50 MPa")]
        elastic_limit: Quantity<Pressure>,
        /// Pressure p_s at which all pores are closed.
        #[schemars(example = "500 MPa")]
        full_compaction: Quantity<Pressure>,
    }
    /// Bingham fluid: mud, fresh concrete.
    BinghamConstants {
        /// Yield stress in shear.
        #[serde(rename = "yield")]
        #[schemars(example = "50 Pa")]
        yield_stress: Quantity<Pressure>,
        /// Plastic viscosity.
        #[schemars(example = "10 Pa s")]
        viscosity: Quantity<Viscosity>,
        /// Shear rate below which the fluid creeps instead of yielding: the smaller, the shorter the time step, below 3 h^2 rho / (8 (viscosity +
        /// yield / creep)).
        #[schemars(example = "0.01 /s")]
        creep: Quantity<Rate>,
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
