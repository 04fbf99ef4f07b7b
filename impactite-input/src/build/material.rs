//! Constitutive laws of materials.

use std::sync::Arc;

use impactite::geometry::Seeds;
use impactite::materials::{
    Adiabatic, BulkViscosity, Cone, Constitutive, Detonation, DruckerPrager, Elastic, Explosive, Fluid,
    Ground, Heat, IdealGas, IntoMaterial, J2, JohnsonCook, JohnsonCookDamage, Jwl, JwlConstants,
    LinearDensity, LinearElastic, Logarithmic, LogarithmicBulk, Material, MieGruneisen, Moduli, MohrCoulomb,
    NeoHookean, Newtonian, PlaneStress, PlasticStrainLimit, Removed, Solid, Tait, TensilePressure, library,
};
use impactite::mpm::{Deformable, FieldForce, Mpm, Splitting, Traction};

use super::wrong::{At, Made, Wrong, wrong};
use crate::model::material::{
    BURN_WIDTH, ConeWord, ElasticConstants, Eos, ExplosiveLaw, Failure, FluidLaw, FrictionConstants,
    GroundLaw, Library, Material as Spec, Strength, TAYLOR_QUINNEY,
};

/// Velocity field, m/s, as a function of position, m.
pub(super) type Velocity<const D: usize> = Arc<dyn Fn([f64; D]) -> [f64; D] + Send + Sync>;

/// Constitutive law of a body.
#[derive(Clone)]
pub(crate) struct Law {
    pub material: Arc<dyn Material<f64>>,
    /// Explosive, for programmed burn.
    pub explosive: Option<Charge>,
}

/// Loads, field forces, splitting and initial states of a body of particles.
pub(crate) struct Acting<'a, const D: usize> {
    pub tractions: Vec<Traction<D>>,
    pub field: Option<FieldForce<D>>,
    pub splitting: Option<Splitting>,
    /// Initial state vector as a function of position, m.
    pub state: Option<&'a dyn Fn([f64; D]) -> Vec<f64>>,
    /// True for a liquid whose density is renewed from positions.
    pub renewed: bool,
    pub lit: &'a [Start],
}

/// Detonation point or plane: position, m, and lighting time, s.
pub(crate) struct Start {
    pub at: [f64; 3],
    /// Normal of a plane that is lit at once; a point if `None`.
    pub plane: Option<[f64; 3]>,
    pub time: f64,
}

/// Explosive with or without bulk viscosity.
#[derive(Clone, Copy)]
pub(crate) enum Charge {
    Plain(Explosive<f64>),
    Viscous(Explosive<f64, Jwl<f64>, BulkViscosity<f64>>),
}

impl From<Arc<dyn Material<f64>>> for Law {
    fn from(material: Arc<dyn Material<f64>>) -> Self {
        Law { material, explosive: None }
    }
}

impl Law {
    /// Add a body of particles with this law.
    pub fn add<const D: usize>(
        &self,
        mpm: &mut Mpm<D>,
        name: &str,
        seeds: &Seeds<D>,
        velocity: &Velocity<D>,
        acting: Acting<'_, D>,
    ) -> Result<(), String> {
        let Acting { tractions, field, splitting, state, renewed, lit } = acting;
        let velocity = velocity.clone();
        macro_rules! body {
            ($law:expr) => {{
                let mut body = Deformable::new(name, $law, seeds).moving(move |x| velocity(x));
                for traction in tractions {
                    body = body.with_traction(traction);
                }
                if let Some(field) = field {
                    body = body.with_field_force(field);
                }
                body
            }};
        }
        macro_rules! lights {
            ($charge:expr) => {{
                let charge = $charge;
                let mut wave = Detonation::new(charge.detonation_speed()).map_err(|e| e.to_string())?;
                for start in lit {
                    wave = match start.plane {
                        Some(normal) => wave.from_plane(start.at, normal, start.time),
                        None => wave.from_point(start.at, start.time),
                    }
                    .map_err(|e| e.to_string())?;
                }
                let state = move |x: [f64; D]| {
                    let x: [f64; 3] = std::array::from_fn(|d| if d < D { x[d] } else { 0.0 });
                    wave.arrival(x).and_then(|t| charge.lit_after(t).ok()).unwrap_or_else(|| charge.virgin())
                };
                mpm.add_body(body!(charge).in_state(state)).map_err(|e| e.to_string())
            }};
        }
        match (self.explosive, lit.is_empty()) {
            (Some(Charge::Plain(charge)), false) => lights!(charge),
            (Some(Charge::Viscous(charge)), false) => lights!(charge),
            _ => {
                let mut body = body!(self.material.clone());
                if let Some(splitting) = splitting {
                    body = body.with_splitting(splitting);
                }
                if let Some(state) = state {
                    body = body.in_numbers(state);
                }
                if renewed {
                    body = body.with_renewed_density();
                }
                mpm.add_body(body).map_err(|e| e.to_string())
            }
        }
    }
}

/// Wrap a law whose kernels are compiled in the library.
fn there<L: IntoMaterial<f64>>(law: L) -> Law {
    Law::from(law.into_material())
}

/// Wrap a law whose kernels are compiled in this crate.
fn here<C: Constitutive<f64>>(law: C) -> Law {
    Law::from(law.compiled().into_material())
}

/// Return the key that says of what kind the material at `key` is, exactly one; refuse the other keys that do not go with it.
pub(super) fn kind(key: &str, spec: &Spec) -> Made<&'static str> {
    let kinds = [
        ("library", spec.library.is_some()),
        ("elastic", spec.elastic.is_some()),
        ("neo_hookean", spec.neo_hookean.is_some()),
        ("strength", spec.strength.is_some()),
        ("ground", spec.ground.is_some()),
        ("fluid", spec.fluid.is_some()),
        ("explosive", spec.explosive.is_some()),
    ];
    let given: Vec<&str> = kinds.iter().filter(|k| k.1).map(|k| k.0).collect();
    let [kind] = given[..] else {
        let all = kinds.map(|k| k.0).join(", ");
        let message = match given.len() {
            0 => format!("says of what kind it is by none of {all}"),
            _ => format!("is of several kinds: {}; take one of {all}", given.join(", ")),
        };
        return wrong(key, message);
    };
    let only = |used: bool, field: &str, kinds: &[&str]| {
        if used && !kinds.contains(&kind) {
            return wrong(
                format!("{key}.{field}"),
                format!("goes with {}, not with `{kind}`", kinds.join(", ")),
            );
        }
        Ok(())
    };
    only(spec.eos.is_some(), "eos", &["strength"])?;
    only(spec.failure.is_some(), "failure", &["strength", "library"])?;
    only(
        spec.bulk_viscosity.is_some(),
        "bulk_viscosity",
        &["library", "strength", "ground", "fluid", "explosive"],
    )?;
    if spec.burn_width.is_some() && !explodes(kind, spec) {
        return wrong(format!("{key}.burn_width"), "is of explosives");
    }
    Ok(kind)
}

/// True for a material that is lit.
fn explodes(kind: &str, spec: &Spec) -> bool {
    kind == "explosive" || spec.library == Some(Library::Tnt)
}

/// Build the law of the material at `key`; a plane-stress law if `plate`.
pub(crate) fn build(key: &str, spec: &Spec, plate: bool) -> Made<Law> {
    let kind = kind(key, spec)?;
    let width = spec.burn_width.map(|q| q.value);
    if kind == "strength" && matches!(spec.failure, Some(Failure::Library)) {
        return without_library(key);
    }
    if plate && kind != "elastic" {
        return wrong(
            key,
            "in plane stress materials are `elastic`: of no other is a law of plates compiled",
        );
    }
    let viscosity = spec.bulk_viscosity.map(|list| list.map(|q| q.value));
    if let Some(constants) = &spec.elastic {
        let key = format!("{key}.elastic");
        let law = LinearElastic::new(constants.density.value, moduli(&key, constants)?).at(key)?;
        return Ok(if plate { there(PlaneStress::new(law)) } else { there(law) });
    }
    if let Some(constants) = &spec.neo_hookean {
        let key = format!("{key}.neo_hookean");
        return Ok(there(NeoHookean::new(constants.density.value, moduli(&key, constants)?).at(key)?));
    }
    if let Some(name) = spec.library {
        return of_library(key, name, spec.failure.as_ref(), viscosity, width);
    }
    if let Some(strength) = &spec.strength {
        let Some(eos) = &spec.eos else { return wrong(key, "`strength` goes with an `eos`") };
        return metal(key, strength, eos, spec.failure.as_ref(), viscosity);
    }
    if let Some(ground) = &spec.ground {
        return of_ground(key, ground, viscosity);
    }
    if let Some(fluid) = &spec.fluid {
        return of_fluid(key, fluid, viscosity);
    }
    match &spec.explosive {
        Some(ExplosiveLaw::Jwl(k)) => {
            let key = format!("{key}.explosive.jwl");
            let constants = JwlConstants {
                density: k.density.value,
                a: k.a.value,
                b: k.b.value,
                r1: k.r1.value,
                r2: k.r2.value,
                omega: k.omega.value,
                energy: k.energy.value,
            };
            let mut charge = Explosive::new(Jwl::new(constants).at(&key)?).at(&key)?;
            if let Some(speed) = k.detonation_speed {
                charge = charge.with_detonation_speed(speed.value).at(&key)?;
            }
            explosive(&key, charge, viscosity, width)
        }
        None => wrong(key, "is of no kind"),
    }
}

fn moduli(key: &str, k: &ElasticConstants) -> Made<Moduli<f64>> {
    match (k.young, k.poisson, k.bulk_modulus, k.shear_modulus) {
        (Some(young), Some(poisson), None, None) => Moduli::young_poisson(young.value, poisson.value).at(key),
        (None, None, Some(bulk), Some(shear)) => Moduli::bulk_shear(bulk.value, shear.value).at(key),
        _ => wrong(key, "needs `young` and `poisson`, or `bulk_modulus` and `shear_modulus`"),
    }
}

fn explosive(
    key: &str,
    charge: Explosive<f64>,
    viscosity: Option<[f64; 2]>,
    width: Option<f64>,
) -> Made<Law> {
    let charge = charge.with_burn_width(width.unwrap_or(BURN_WIDTH)).at(format!("{key}.burn_width"))?;
    Ok(match viscosity {
        Some([linear, quadratic]) => {
            let charge = charge.with_bulk_viscosity(linear, quadratic).at(key)?;
            Law { explosive: Some(Charge::Viscous(charge)), ..there(charge) }
        }
        None => Law { explosive: Some(Charge::Plain(charge)), ..there(charge) },
    })
}

/// Wrap a law with or without bulk viscosity, both compiled in the library.
macro_rules! viscous {
    ($key:expr, $law:expr, $viscosity:expr) => {
        viscous!($key, $law, $viscosity, there)
    };
    // With kernels compiled in this crate, absent viscosity has zero coefficients: one law to compile instead of two.
    ($key:expr, $law:expr, $viscosity:expr, here) => {{
        let [linear, quadratic] = $viscosity.unwrap_or([0.0; 2]);
        here($law.with_bulk_viscosity(linear, quadratic).at(format!("{}.bulk_viscosity", $key))?)
    }};
    ($key:expr, $law:expr, $viscosity:expr, there) => {{
        let law = $law;
        match $viscosity {
            Some([linear, quadratic]) => {
                there(law.with_bulk_viscosity(linear, quadratic).at(format!("{}.bulk_viscosity", $key))?)
            }
            None => there(law),
        }
    }};
}

fn of_library(
    key: &str,
    name: Library,
    failure: Option<&Failure>,
    viscosity: Option<[f64; 2]>,
    width: Option<f64>,
) -> Made<Law> {
    macro_rules! adiabatic {
        ($law:expr) => {
            match (failure, own_failure(name)) {
                (Some(Failure::Library), Some(Own::Damage(damage))) => {
                    Ok(viscous!(key, $law.with_failure(damage), viscosity))
                }
                _ => with_failure(key, $law, failure, viscosity),
            }
        };
    }
    macro_rules! plain {
        ($law:expr) => {{
            let law = $law;
            let limit = match (failure, own_failure(name)) {
                (Some(Failure::PlasticStrain(limit)), _) if !limit.removed => Some(limit.limit.value),
                (Some(Failure::Library), Some(Own::PlasticStrain(limit))) => Some(limit),
                _ => None,
            };
            match (failure, limit) {
                (None, _) => Ok(viscous!(key, law, viscosity)),
                (Some(_), Some(limit)) => {
                    let failure =
                        PlasticStrainLimit::new(limit).at(format!("{key}.failure.plastic_strain"))?;
                    Ok(viscous!(key, law.with_failure(failure), viscosity, here))
                }
                (Some(other), None) => wrong(
                    format!("{key}.failure"),
                    format!(
                        "`{}` is not compiled for this material; take `plastic_strain`, or none",
                        failure_word(other)
                    ),
                ),
            }
        }};
    }
    let own = own_failure(name);
    if matches!(failure, Some(Failure::Library)) && own.is_none() {
        let sets = Library::ALL.iter().filter(|(set, _)| own_failure(*set).is_some());
        let sets: Vec<&str> = sets.map(|(_, word)| *word).collect();
        return wrong(
            format!("{key}.failure"),
            format!(
                "the named set has no failure constants of its own; these have: {}. Give constants: \
                 `failure.plastic_strain = {{ limit = 1 }}`",
                sets.join(", ")
            ),
        );
    }
    let within = matches!((failure, own), (Some(Failure::Library), Some(Own::Within)));
    if failure.is_some()
        && !within
        && !matches!(
            name,
            Library::Aluminium6061T6
                | Library::Aluminium2024T3
                | Library::AluminiumFeng2014
                | Library::CopperFeng2014
                | Library::CopperOfhc
                | Library::Steel4340
                | Library::TungstenAlloy
                | Library::CopperTaylor
                | Library::CopperCasing
                | Library::Lead
        )
    {
        let what = match own {
            Some(Own::Within) => {
                "the named set fails by its own damage; leave `failure` away, or write `failure = \"library\"`"
            }
            _ => "no failure is compiled for this named set",
        };
        return wrong(format!("{key}.failure"), what);
    }
    if viscosity.is_some() && matches!(name, Library::SteelElastic) {
        return wrong(format!("{key}.bulk_viscosity"), "`steel_elastic` has none; take `strength` and `eos`");
    }
    match name {
        Library::Aluminium6061T6 => adiabatic!(library::aluminium_6061_t6()),
        Library::Aluminium2024T3 => adiabatic!(library::aluminium_2024_t3()),
        Library::AluminiumFeng2014 => adiabatic!(library::aluminium_feng_2014()),
        Library::CopperFeng2014 => adiabatic!(library::copper_feng_2014()),
        Library::CopperOfhc => adiabatic!(library::copper_ofhc()),
        Library::Steel4340 => adiabatic!(library::steel_4340()),
        Library::TungstenAlloy => adiabatic!(library::tungsten_alloy()),
        Library::CopperTaylor => plain!(library::copper_taylor()),
        Library::CopperCasing => plain!(library::copper_casing()),
        Library::Lead => plain!(library::lead()),
        Library::CopperSteinberg => Ok(viscous!(key, library::copper_steinberg(), viscosity)),
        Library::Steel4340Steinberg => Ok(viscous!(key, library::steel_4340_steinberg(), viscosity)),
        Library::SteelElastic => Ok(there(library::steel_elastic())),
        Library::Weldox460E => Ok(viscous!(key, library::weldox_460_e(), viscosity)),
        Library::Weldox460EUncoupled => Ok(viscous!(key, library::weldox_460_e_uncoupled(), viscosity, here)),
        Library::ArneToolSteel => Ok(viscous!(key, library::arne_tool_steel(), viscosity)),
        Library::Concrete48 => Ok(viscous!(key, library::concrete_48(), viscosity)),
        Library::SlopeSoil => Ok(viscous!(key, library::slope_soil(), viscosity)),
        Library::AluminiumBars => Ok(viscous!(key, library::aluminium_bars(), viscosity)),
        Library::DrySand => Ok(viscous!(key, library::dry_sand(), viscosity)),
        Library::Tnt => explosive(key, library::tnt(), viscosity, width),
        Library::Air => Ok(viscous!(key, library::air(), viscosity)),
        Library::Water => Ok(viscous!(key, library::water(), viscosity)),
        Library::WaterShocked => Ok(viscous!(key, library::water_shocked(), viscosity)),
    }
}

fn failure_word(failure: &Failure) -> &'static str {
    match failure {
        Failure::JohnsonCook(_) => "johnson_cook",
        Failure::TensilePressure(_) => "tensile_pressure",
        Failure::PlasticStrain(_) => "plastic_strain",
        Failure::Library => "library",
    }
}

/// Failure model of a named set, from its source.
#[derive(Clone, Copy, Debug)]
enum Own {
    Damage(JohnsonCookDamage<f64>),
    PlasticStrain(f64),
    /// Damage that is part of the law of the set, and always active.
    Within,
}

fn own_failure(name: Library) -> Option<Own> {
    Some(match name {
        Library::Aluminium6061T6 => Own::Damage(JohnsonCookDamage::aluminium_6061()),
        Library::Aluminium2024T3 => Own::Damage(JohnsonCookDamage::aluminium_2024_t3()),
        Library::CopperOfhc => Own::Damage(JohnsonCookDamage::copper_ofhc()),
        Library::Steel4340 => Own::Damage(JohnsonCookDamage::steel_4340()),
        Library::Lead => Own::PlasticStrain(LEAD_FAILS),
        Library::Weldox460E | Library::Weldox460EUncoupled => Own::Within,
        _ => return None,
    })
}

/// Plastic strain at failure of lead in its source.
const LEAD_FAILS: f64 = 3.0;

/// Named set: law with its constants, and failure.
pub(crate) struct Described {
    pub law: Arc<dyn Material<f64>>,
    pub failure: String,
}

/// Describe a named set; `None` if its law cannot be built alone.
pub(crate) fn described(name: Library) -> Option<Described> {
    let law = of_library("materials", name, None, None, None).ok()?.material;
    let failure = match own_failure(name) {
        Some(Own::Damage(damage)) => format!("with `failure = \"library\"`: {damage:?}"),
        Some(Own::PlasticStrain(limit)) => format!("with `failure = \"library\"`: plastic strain {limit}"),
        Some(Own::Within) => "always, by its own damage".into(),
        None => "none of its own".into(),
    };
    Some(Described { law, failure })
}

/// Combine a metal with rate and temperature with a failure model.
fn with_failure(
    key: &str,
    law: library::Metal<f64>,
    failure: Option<&Failure>,
    viscosity: Option<[f64; 2]>,
) -> Made<Law> {
    let at = |word: &str| format!("{key}.failure.{word}");
    Ok(match failure {
        None => viscous!(key, law, viscosity),
        Some(Failure::Library) => return without_library(key),
        Some(Failure::JohnsonCook(k)) => {
            let damage =
                JohnsonCookDamage::new(k.d.map(|d| d.value), k.reference.value).at(at("johnson_cook"))?;
            viscous!(key, law.with_failure(damage), viscosity)
        }
        Some(Failure::TensilePressure(k)) => {
            let spall = TensilePressure::new(k.strength.value).at(at("tensile_pressure"))?;
            viscous!(key, law.with_failure(spall), viscosity)
        }
        Some(Failure::PlasticStrain(k)) => {
            let limit = PlasticStrainLimit::new(k.limit.value).at(at("plastic_strain"))?;
            if k.removed {
                viscous!(key, law.with_failure(Removed(limit)), viscosity, here)
            } else {
                viscous!(key, law.with_failure(limit), viscosity, here)
            }
        }
    })
}

fn metal(
    key: &str,
    strength: &Strength,
    eos: &Eos,
    failure: Option<&Failure>,
    viscosity: Option<[f64; 2]>,
) -> Made<Law> {
    let shock = |k: &crate::model::material::ShockConstants| {
        MieGruneisen::new(k.density.value, k.sound_speed.value, k.slope.value, k.gruneisen.value)
            .at(format!("{key}.eos.mie_gruneisen"))
    };
    let bulk = |k: &crate::model::material::BulkConstants| {
        LogarithmicBulk::new(k.density.value, k.bulk_modulus.value).at(format!("{key}.eos.logarithmic_bulk"))
    };
    match (strength, eos, failure) {
        (Strength::Elastic(s), eos, None) => {
            let strength = Elastic::new(s.shear_modulus.value).at(format!("{key}.strength.elastic"))?;
            Ok(match eos {
                Eos::LinearDensity(k) => {
                    let eos = LinearDensity::new(k.density.value, k.sound_speed.value);
                    viscous!(
                        key,
                        Solid::new(strength, eos.at(format!("{key}.eos.linear_density"))?),
                        viscosity
                    )
                }
                Eos::LogarithmicBulk(k) => viscous!(key, Solid::new(strength, bulk(k)?), viscosity),
                Eos::MieGruneisen(k) => viscous!(key, Solid::new(strength, shock(k)?), viscosity, here),
            })
        }
        (Strength::J2(s), eos, failure) => {
            let strength = J2::linear(s.shear_modulus.value, s.yield_stress.value, s.hardening.value)
                .at(format!("{key}.strength.j2"))?;
            match (eos, failure) {
                (Eos::LogarithmicBulk(k), None) => {
                    Ok(viscous!(key, Solid::new(strength, bulk(k)?), viscosity))
                }
                (Eos::MieGruneisen(k), None) => {
                    Ok(viscous!(key, Solid::new(strength, shock(k)?), viscosity, here))
                }
                (Eos::LogarithmicBulk(k), Some(Failure::PlasticStrain(limit))) if !limit.removed => {
                    let limit = PlasticStrainLimit::new(limit.limit.value)
                        .at(format!("{key}.failure.plastic_strain"))?;
                    Ok(viscous!(key, Solid::new(strength, bulk(k)?).with_failure(limit), viscosity, here))
                }
                _ => not_compiled(key),
            }
        }
        (Strength::JohnsonCook(s), Eos::MieGruneisen(k), failure) => {
            let at = format!("{key}.strength.johnson_cook");
            let plain = JohnsonCook::new(s.shear_modulus.value, s.a.value, s.b.value, s.n.value).at(&at)?;
            match (&s.rate, &s.heat) {
                (None, None) => match failure {
                    None => Ok(viscous!(key, Solid::new(plain, shock(k)?), viscosity)),
                    Some(Failure::PlasticStrain(limit)) if !limit.removed => {
                        let limit = PlasticStrainLimit::new(limit.limit.value)
                            .at(format!("{key}.failure.plastic_strain"))?;
                        Ok(viscous!(key, Solid::new(plain, shock(k)?).with_failure(limit), viscosity, here))
                    }
                    Some(_) => not_compiled(key),
                },
                (rate, heat) => {
                    // Rate without heat, or heat without rate: the absent factor has no effect.
                    let rate = match rate {
                        Some(rate) => Logarithmic::new(rate.c.value, rate.reference.value),
                        None => Logarithmic::new(0.0, 1.0),
                    };
                    let heat = match heat {
                        Some(heat) => Heat {
                            room: heat.room.value,
                            melt: heat.melt.value,
                            exponent: heat.m.value,
                            heat_capacity: heat.capacity.value,
                            taylor_quinney: heat.taylor_quinney.map_or(TAYLOR_QUINNEY, |q| q.value),
                        },
                        None => COLD,
                    };
                    let heat = Adiabatic::new(heat).at(format!("{at}.heat"))?;
                    let strength = plain.with_rate(rate.at(format!("{at}.rate"))?).with_heat(heat);
                    with_failure(key, Solid::new(strength, shock(k)?), failure, viscosity)
                }
            }
        }
        _ => not_compiled(key),
    }
}

/// Heat without temperature rise and softening, for laws with a rate only.
const COLD: Heat<f64> =
    Heat { room: 293.15, melt: 1e4, exponent: 1.0, heat_capacity: 1e3, taylor_quinney: 0.0 };

fn without_library<T>(key: &str) -> Made<T> {
    wrong(
        format!("{key}.failure"),
        "`library` is the failure of a named set (`library`); of `strength` give constants: \
         `failure.plastic_strain = { limit = 1 }`, `failure.johnson_cook`, `failure.tensile_pressure`",
    )
}

/// Compiled combinations of laws of metals: strength and equation of state, and failures.
pub(crate) const METALS: &[(&str, &str)] = &[
    ("strength.elastic with any eos", "no failure"),
    ("strength.j2 with eos.logarithmic_bulk", "failure.plastic_strain without `removed`, or none"),
    ("strength.j2 with eos.mie_gruneisen", "no failure"),
    (
        "strength.johnson_cook without rate and heat, with eos.mie_gruneisen",
        "failure.plastic_strain without `removed`, or none",
    ),
    ("strength.johnson_cook with rate and heat, with eos.mie_gruneisen", "any failure, or none"),
];

fn not_compiled(key: &str) -> Made<Law> {
    let list: Vec<String> = METALS.iter().map(|(laws, failures)| format!("{laws} ({failures})")).collect();
    wrong(
        key,
        format!(
            "this combination of strength, eos and failure is not compiled in the program; there are: {} (`impactite list parts`)",
            list.join("; ")
        ),
    )
}

fn of_ground(key: &str, ground: &GroundLaw, viscosity: Option<[f64; 2]>) -> Made<Law> {
    let moduli =
        |k: &FrictionConstants, key: &str| Moduli::young_poisson(k.young.value, k.poisson.value).at(key);
    match ground {
        GroundLaw::DruckerPrager(k) => {
            let at = format!("{key}.ground.drucker_prager");
            let (density, moduli) = (k.density.value, moduli(k, &at)?);
            let cone = match k.cone.unwrap_or_default() {
                ConeWord::Outer => Cone::Outer,
                ConeWord::Inner => Cone::Inner,
                ConeWord::PlaneStrain => Cone::PlaneStrain,
            };
            let angles = (k.friction.value, k.cohesion.value, k.dilatancy.value);
            let mut law =
                DruckerPrager::matching(density, moduli, cone, angles.0, angles.1, angles.2).at(&at)?;
            if let Some(tension) = k.tension {
                law = law.with_tension_cap(tension.value).at(&at)?;
            }
            Ok(viscous!(key, Ground::new(law), viscosity))
        }
        GroundLaw::MohrCoulomb(k) => {
            let at = format!("{key}.ground.mohr_coulomb");
            if k.cone.is_some() {
                return wrong(
                    format!("{at}.cone"),
                    "Mohr and Coulomb's law is the pyramid itself: a cone is of `drucker_prager`",
                );
            }
            let (density, moduli) = (k.density.value, moduli(k, &at)?);
            let mut law =
                MohrCoulomb::new(density, moduli, k.friction.value, k.cohesion.value, k.dilatancy.value)
                    .at(&at)?;
            if let Some(tension) = k.tension {
                law = law.with_tension_cutoff(tension.value).at(&at)?;
            }
            Ok(viscous!(key, Ground::new(law), viscosity, here))
        }
    }
}

fn of_fluid(key: &str, fluid: &FluidLaw, viscosity: Option<[f64; 2]>) -> Made<Law> {
    macro_rules! sheared {
        ($key:expr, $eos:expr, $shear:expr) => {{
            let fluid = Fluid::new($eos.at(&$key)?);
            Ok(match $shear {
                Some(shear) => {
                    let shear = Newtonian::new(shear.value).at(&$key)?;
                    viscous!(key, fluid.with_shear_viscosity(shear), viscosity, here)
                }
                None => viscous!(key, fluid, viscosity),
            })
        }};
    }
    match fluid {
        FluidLaw::IdealGas(k) => {
            let at = format!("{key}.fluid.ideal_gas");
            sheared!(at, IdealGas::new(k.density.value, k.gamma.value, k.pressure.value), k.viscosity)
        }
        FluidLaw::Tait(k) => {
            let at = format!("{key}.fluid.tait");
            sheared!(at, Tait::new(k.density.value, k.sound_speed.value), k.viscosity)
        }
        FluidLaw::Incompressible(_) => Err(Wrong {
            key: format!("{key}.fluid.incompressible"),
            message: "is for the method `flow` alone".into(),
            help: Some("take `tait`, with a speed of sound of ten times the fastest flow".into()),
        }),
        FluidLaw::MieGruneisen(k) => {
            let at = format!("{key}.fluid.mie_gruneisen");
            let eos =
                MieGruneisen::new(k.density.value, k.sound_speed.value, k.slope.value, k.gruneisen.value);
            Ok(viscous!(key, Fluid::new(eos.at(&at)?), viscosity))
        }
    }
}
