//! Constitutive laws of materials.

use std::sync::Arc;

use impactite::geometry::Seeds;
use impactite::materials::eos::{CrushConstants, CrushCurve};
use impactite::materials::strength::ConcreteConstants;
use impactite::materials::{
    AnyEos, AnyFailure, AnyFailureCriterion, AnyFluid, AnyShear, AnyStrength, Bingham, BulkViscosity, Cone,
    Constitutive, Detonation, DruckerPrager, Explosive, Fluid, Ground, HolmquistJohnsonCook, IdealGas,
    IntoMaterial, JohnsonCookDamage, Jwl, JwlConstants, LinearElastic, Material, Moduli, MohrCoulomb,
    NeoHookean, Newtonian, NoFailure, PlaneStress, PlasticStrainLimit, Solid, Stretched, Tait, library,
};
use impactite::mpm::{Deformable, FieldForce, Mpm, Splitting, Traction};

use super::solid::{self, Parts};
use super::wrong::{At, Made, Wrong, wrong};
use crate::model::material::{
    BURN_WIDTH, BinghamConstants, ConeWord, ElasticConstants, Eos, ExplosiveLaw, FailureChoice, FluidLaw,
    FrictionConstants, GroundLaw, JwlConstants as JwlSpec, Library, Material as Spec, Strength,
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
                // Splitting needs the accumulated stretch.
                let material: Arc<dyn Material<f64>> = match &splitting {
                    Some(_) => Arc::new(Stretched::new(self.material.clone())),
                    None => self.material.clone(),
                };
                let mut body = body!(material);
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
    only(spec.porous.is_some(), "porous", &["strength", "library"])?;
    only(spec.bingham.is_some(), "bingham", &["fluid"])?;
    if spec.bingham.is_some() && matches!(spec.fluid, Some(FluidLaw::Incompressible(_))) {
        return wrong(
            format!("{key}.bingham"),
            "is not available with `fluid.incompressible`, which has a `viscosity`",
        );
    }
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
    if plate && !["elastic", "strength", "library"].contains(&kind) {
        return wrong(key, NO_PLATE);
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
        return of_library(key, name, spec, plate);
    }
    if let Some(strength) = &spec.strength {
        let Some(eos) = &spec.eos else { return wrong(key, "`strength` goes with an `eos`") };
        return metal(key, strength, eos, spec, plate);
    }
    if let Some(ground) = &spec.ground {
        return of_ground(key, ground, viscosity);
    }
    if let Some(fluid) = &spec.fluid {
        return of_fluid(key, fluid, spec.bingham.as_ref(), viscosity);
    }
    match &spec.explosive {
        Some(ExplosiveLaw::Jwl(k)) => {
            let key = format!("{key}.explosive.jwl");
            let mut charge = Explosive::new(jwl(&key, k)?).at(&key)?;
            if let Some(speed) = k.detonation_speed {
                charge = charge.with_detonation_speed(speed.value).at(&key)?;
            }
            explosive(&key, charge, viscosity, width)
        }
        None => wrong(key, "is of no kind"),
    }
}

fn jwl(key: &str, k: &JwlSpec) -> Made<Jwl<f64>> {
    let constants = JwlConstants {
        density: k.density.value,
        a: k.a.value,
        b: k.b.value,
        r1: k.r1.value,
        r2: k.r2.value,
        omega: k.omega.value,
        energy: k.energy.value,
    };
    Jwl::new(constants).at(key)
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
    ($key:expr, $law:expr, $viscosity:expr) => {{
        let law = $law;
        match $viscosity {
            Some([linear, quadratic]) => {
                there(law.with_bulk_viscosity(linear, quadratic).at(format!("{}.bulk_viscosity", $key))?)
            }
            None => there(law),
        }
    }};
}

/// Return the solid of a named set; `None` if its law is of another kind.
fn solid(name: Library) -> Option<Parts> {
    fn parts<S, E, F>(law: Solid<S, E, F>, within: impl Fn(&F) -> AnyFailure<f64>) -> Parts
    where
        S: Copy + Into<AnyStrength<f64>>,
        E: Copy + Into<AnyEos<f64>>,
    {
        let failure = within(law.failure());
        Parts { strength: (*law.strength()).into(), eos: (*law.eos()).into(), failure }
    }
    let none = |_: &NoFailure| AnyFailure::default();
    Some(match name {
        Library::Aluminium6061T6 => parts(library::aluminium_6061_t6(), none),
        Library::Aluminium2024T3 => parts(library::aluminium_2024_t3(), none),
        Library::AluminiumFeng2014 => parts(library::aluminium_feng_2014(), none),
        Library::CopperFeng2014 => parts(library::copper_feng_2014(), none),
        Library::CopperOfhc => parts(library::copper_ofhc(), none),
        Library::Steel4340 => parts(library::steel_4340(), none),
        Library::TungstenAlloy => parts(library::tungsten_alloy(), none),
        Library::CopperTaylor => parts(library::copper_taylor(), none),
        Library::CopperCasing => parts(library::copper_casing(), none),
        Library::Lead => parts(library::lead(), none),
        Library::CopperSteinberg => parts(library::copper_steinberg(), none),
        Library::Steel4340Steinberg => parts(library::steel_4340_steinberg(), none),
        Library::ArneToolSteel => parts(library::arne_tool_steel(), none),
        Library::Weldox460E => parts(library::weldox_460_e(), |f| (*f).into()),
        Library::Weldox460EUncoupled => parts(library::weldox_460_e_uncoupled(), |f| (*f).into()),
        _ => return None,
    })
}

/// Failure criterion of a named set, from its source; `None` if it has none, or if its law has it already.
fn own_failure(name: Library) -> Option<AnyFailureCriterion<f64>> {
    Some(match name {
        Library::Aluminium6061T6 => JohnsonCookDamage::aluminium_6061().into(),
        Library::Aluminium2024T3 => JohnsonCookDamage::aluminium_2024_t3().into(),
        Library::CopperOfhc => JohnsonCookDamage::copper_ofhc().into(),
        Library::Steel4340 => JohnsonCookDamage::steel_4340().into(),
        Library::Lead => PlasticStrainLimit::new(LEAD_FAILS).ok()?.into(),
        _ => return None,
    })
}

/// Plastic strain at failure of lead in its source.
const LEAD_FAILS: f64 = 3.0;

/// True if the law of a named set fails by itself.
fn fails_by_itself(name: Library) -> bool {
    matches!(name, Library::Weldox460E | Library::Weldox460EUncoupled)
}

/// Return the failure of a named set at `key`.
fn failure_of_set(key: &str, name: Library) -> Made<AnyFailure<f64>> {
    if fails_by_itself(name) {
        return Ok(AnyFailure::default());
    }
    let Some(own) = own_failure(name) else {
        let sets =
            Library::ALL.iter().filter(|(set, _)| own_failure(*set).is_some() || fails_by_itself(*set));
        let sets: Vec<&str> = sets.map(|(_, word)| *word).collect();
        let others = "or give constants: `failure.plastic_strain = { limit = 1 }`, `failure.johnson_cook`";
        return wrong(
            key,
            format!(
                "no failure constants belong to this named set; take one of {}, {others}",
                sets.join(", ")
            ),
        );
    };
    AnyFailure::default().or(own).at(key)
}

fn of_library(key: &str, name: Library, spec: &Spec, plate: bool) -> Made<Law> {
    let viscosity = spec.bulk_viscosity.map(|list| list.map(|q| q.value));
    if let Some(mut parts) = solid(name) {
        let at = format!("{key}.failure");
        let own = || failure_of_set(&at, name);
        match &spec.failure {
            None => {}
            Some(FailureChoice::Library) => {
                for criterion in own()?.criteria() {
                    parts.failure = parts.failure.or(criterion).at(&at)?;
                }
            }
            Some(FailureChoice::By(criteria)) => {
                parts.failure = solid::with_criteria(&at, criteria, &parts, own)?;
            }
        }
        return parts.law(key, viscosity, spec.porous.as_ref(), plate).map(Law::from);
    }
    if plate {
        return wrong(key, NO_PLATE);
    }
    if spec.failure.is_some() {
        let metals = "no failure constants belong to this named set, which is no metal; metals with them: steel_4340, copper_ofhc, lead and others \
                      (`impactite list materials`)";
        return wrong(format!("{key}.failure"), metals);
    }
    if spec.porous.is_some() {
        return wrong(format!("{key}.porous"), "is of metals; this named set is none");
    }
    if viscosity.is_some() && matches!(name, Library::SteelElastic) {
        return wrong(format!("{key}.bulk_viscosity"), "`steel_elastic` has none; take `strength` and `eos`");
    }
    let width = spec.burn_width.map(|q| q.value);
    match name {
        Library::SteelElastic => Ok(there(library::steel_elastic())),
        Library::Concrete48 => Ok(viscous!(key, library::concrete_48(), viscosity)),
        Library::SlopeSoil => Ok(viscous!(key, library::slope_soil(), viscosity)),
        Library::AluminiumBars => Ok(viscous!(key, library::aluminium_bars(), viscosity)),
        Library::DrySand => Ok(viscous!(key, library::dry_sand(), viscosity)),
        Library::Tnt => explosive(key, library::tnt(), viscosity, width),
        Library::Air => Ok(viscous!(key, library::air(), viscosity)),
        Library::Water => Ok(viscous!(key, library::water(), viscosity)),
        Library::WaterShocked => Ok(viscous!(key, library::water_shocked(), viscosity)),
        _ => wrong(key, "is no named set"),
    }
}

/// Error of materials in plane stress.
const NO_PLATE: &str =
    "in plane stress materials are `elastic`, or metals of `strength` and `eos` or of a named set";

/// Named set: law with its constants, and failure.
pub(crate) struct Described {
    pub law: Arc<dyn Material<f64>>,
    pub failure: String,
}

/// Describe a named set; `None` if its law cannot be built alone.
pub(crate) fn described(name: Library) -> Option<Described> {
    let law = of_library("materials", name, &Spec::default(), false).ok()?.material;
    let failure = match own_failure(name) {
        Some(own) => format!("with `failure = \"library\"`: {own:?}"),
        None if fails_by_itself(name) => "always, by its own damage".into(),
        None => "none of its own".into(),
    };
    Some(Described { law, failure })
}

/// Build a metal of strength, equation of state and failure.
fn metal(key: &str, strength: &Strength, eos: &Eos, spec: &Spec, plate: bool) -> Made<Law> {
    let mut parts = solid::parts(key, strength, eos, spec.porous.as_ref())?;
    let at = format!("{key}.failure");
    match &spec.failure {
        None => {}
        Some(FailureChoice::Library) => return without_library(&at),
        Some(FailureChoice::By(criteria)) => {
            parts.failure = solid::with_criteria(&at, criteria, &parts, || without_library(&at))?;
        }
    }
    let viscosity = spec.bulk_viscosity.map(|list| list.map(|q| q.value));
    parts.law(key, viscosity, spec.porous.as_ref(), plate).map(Law::from)
}

fn without_library<T>(key: &str) -> Made<T> {
    wrong(
        key,
        "`library` is the failure of a named set (`library`); of `strength` give constants: \
         `failure.plastic_strain = { limit = 1 }`, `failure.johnson_cook`, `failure.tensile_pressure`",
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
            Ok(viscous!(key, Ground::new(law), viscosity))
        }
        GroundLaw::Concrete(k) => {
            let key_of = format!("{key}.ground.concrete");
            let constants = ConcreteConstants {
                density: k.density.value,
                shear: k.shear_modulus.value,
                a: k.a.value,
                b: k.b.value,
                n: k.n.value,
                c: k.c.value,
                reference_rate: k.reference.value,
                compressive: k.compressive.value,
                tensile: k.tensile.value,
                largest: k.largest.value,
                d1: k.d1.value,
                d2: k.d2.value,
                smallest_strain: k.smallest_strain.value,
            };
            let crush = CrushCurve::new(CrushConstants {
                crush_pressure: k.crush_pressure.value,
                crush_compression: k.crush_compression.value,
                lock_pressure: k.lock_pressure.value,
                lock_compression: k.lock_compression.value,
                solid: k.solid.map(|c| c.value),
            })
            .at(&key_of)?;
            let law = HolmquistJohnsonCook::new(constants, crush).at(&key_of)?;
            if k.size.is_none() {
                return Ok(viscous!(key, Ground::new(law), viscosity));
            }
            let law = Ground::new(law.with_localisation(solid::localisation(&key_of, k.size)?));
            let [linear, quadratic] = viscosity.unwrap_or_default();
            Ok(there(law.with_bulk_viscosity(linear, quadratic).at(format!("{key}.bulk_viscosity"))?))
        }
    }
}

fn of_fluid(
    key: &str,
    fluid: &FluidLaw,
    bingham: Option<&BinghamConstants>,
    viscosity: Option<[f64; 2]>,
) -> Made<Law> {
    // Any equation of state with a shear stress by value.
    let composed = |at: String, eos: AnyEos<f64>, shear: AnyShear<f64>| {
        let law = AnyFluid::new(eos, shear, viscosity.unwrap_or_default()).at(at)?;
        Ok(Law::from(law.into_material()))
    };
    let yields = match bingham {
        Some(k) => {
            let at = format!("{key}.bingham");
            Some(Bingham::new(k.yield_stress.value, k.viscosity.value, k.creep_rate.value).at(at)?)
        }
        None => None,
    };
    macro_rules! sheared {
        ($key:expr, $eos:expr, $shear:expr) => {{
            let eos = $eos.at(&$key)?;
            match ($shear, yields) {
                (Some(_), Some(_)) => {
                    wrong(format!("{}.viscosity", $key), "is part of `bingham`; leave it out")
                }
                (None, Some(bingham)) => composed($key, eos.into(), bingham.into()),
                // Viscous fluids always have the state variables of bulk viscosity.
                (Some(shear), None) => {
                    let shear = Newtonian::new(shear.value).at(&$key)?;
                    let [linear, quadratic] = viscosity.unwrap_or_default();
                    let fluid = Fluid::new(eos).with_shear_viscosity(shear);
                    Ok(there(
                        fluid.with_bulk_viscosity(linear, quadratic).at(format!("{key}.bulk_viscosity"))?,
                    ))
                }
                (None, None) => Ok(viscous!(key, Fluid::new(eos), viscosity)),
            }
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
            match (solid::shock(&at, k)?, yields) {
                (AnyEos::MieGruneisen(eos), None) => Ok(viscous!(key, Fluid::new(eos), viscosity)),
                (eos, shear) => composed(at, eos, shear.map_or(AnyShear::Inviscid, AnyShear::Bingham)),
            }
        }
        FluidLaw::Polynomial(k) => {
            let at = format!("{key}.fluid.polynomial");
            let eos = solid::polynomial(&at, k)?;
            composed(at, eos, yields.map_or(AnyShear::Inviscid, AnyShear::Bingham))
        }
        FluidLaw::Jwl(k) => {
            let at = format!("{key}.fluid.jwl");
            if k.detonation_speed.is_some() {
                return wrong(format!("{at}.detonation_speed"), "is of an `explosive`, which burns");
            }
            let eos = jwl(&at, k)?;
            composed(at, eos.into(), yields.map_or(AnyShear::Inviscid, AnyShear::Bingham))
        }
    }
}
