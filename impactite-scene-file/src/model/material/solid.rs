//! Parts of solids: strength, equation of state, failure, pores.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::parts::parts;
use crate::quantity::{
    Density, EnergyDensity, HeatCapacity, Length, PerPressure, PerTemperature, Plain, Pressure, Quantity,
    Rate, Speed, SurfaceEnergy, Temperature, Time,
};

/// Default Taylor-Quinney coefficient.
pub const TAYLOR_QUINNEY: f64 = 0.9;

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
pub enum PostFailure {
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

parts! {
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
        post_failure: Option<PostFailure>,
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
        /// Failed particles carry nothing and touch nothing: `post_failure = "nothing"`.
        #[serde(default)]
        removed: bool,
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
}
