//! Materials: named sets of the library, or laws composed of parts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod solid;

pub use solid::*;

use super::parts::parts;
use crate::quantity::{
    Angle, Density, EnergyDensity, Length, Plain, Pressure, Quantity, Rate, Speed, SurfaceTension, Viscosity,
};

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
    /// carries compression alone, unless `post_failure` says otherwise.
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
        /// yield / creep_rate)).
        #[schemars(example = "0.01 /s")]
        creep_rate: Quantity<Rate>,
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
