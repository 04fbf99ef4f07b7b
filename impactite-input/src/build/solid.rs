//! Solids from scene files: strength, equation of state, failure, pores.

use std::sync::Arc;

use impactite::materials::strength::{
    BorvikConstants, LinearHardening, PowerHardening, SaturatingPower, SteinbergConstants, VoceHardening,
};
use impactite::materials::{
    Adiabatic, AnyEos, AnyFailure, AnyHardening, AnyHeat, AnyLocalisation, AnyRate, AnySolid, AnyStrength,
    Borvik, CohesiveSpall, CowperSymonds, CrackBand, CubicShock, DamageLimit, Elastic, Eos as _, Expanding,
    Gruneisen, Heat, IntoMaterial, JohnsonCook, JohnsonCookDamage, LinearDensity, Logarithmic,
    LogarithmicBulk, Material, MieGruneisen, PlasticStrainLimit, Polynomial, PolynomialHugoniot, PowerRate,
    PrincipalStress, Remains, SmoothLogarithmic, SteinbergGuinan, Tait, TensilePressure, TulerButcher,
};

use super::wrong::{At, Made, wrong};
use crate::model::material::{
    CubicConstants, Eos, Failure, HeatConstants, HugoniotConstants, PolynomialConstants, PorousConstants,
    PostFailure, RateConstants, RateWord, ShockConstants, Strength, TAYLOR_QUINNEY,
};
use crate::quantity::{Length, Quantity};

/// Parts of a solid.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    pub strength: AnyStrength<f64>,
    pub eos: AnyEos<f64>,
    /// Criteria that belong to the material whether or not failure is asked for.
    pub failure: AnyFailure<f64>,
}

impl Parts {
    /// Return the law of the parts at `key`, in plane stress if `plate`.
    pub fn law(
        self,
        key: &str,
        viscosity: Option<[f64; 2]>,
        porous: Option<&PorousConstants>,
        plate: bool,
    ) -> Made<Arc<dyn Material<f64>>> {
        let mut solid = AnySolid::new(self.strength, self.eos).with_failure(self.failure);
        if let Some([linear, quadratic]) = viscosity {
            solid = solid.with_bulk_viscosity(linear, quadratic).at(format!("{key}.bulk_viscosity"))?;
        }
        let Some(pores) = porous else {
            let material =
                if plate { solid.in_plane_stress().into_material() } else { solid.into_material() };
            return Ok(material);
        };
        let key = format!("{key}.porous");
        if plate {
            return wrong(key, "is not available in plane stress");
        }
        if self.failure.criteria().next().is_some() {
            return wrong(key, "is not available with `failure`");
        }
        let [distension, elastic, full] =
            [pores.distension.value, pores.elastic_limit.value, pores.full_compaction.value];
        Ok(solid.with_pores(distension, elastic, full).at(key)?.into_material())
    }
}

/// Return the parts of a strength and an equation of state, for a solid with pores of a distension.
pub(super) fn parts(
    key: &str,
    strength: &Strength,
    eos: &Eos,
    pores: Option<&PorousConstants>,
) -> Made<Parts> {
    let eos = of_eos(&format!("{key}.eos"), eos)?;
    let density = eos.density() / pores.map_or(1.0, |k| k.distension.value);
    let (strength, failure) = of_strength(&format!("{key}.strength"), strength, density)?;
    Ok(Parts { strength, eos, failure })
}

fn rate(key: &str, rate: Option<&RateConstants>) -> Made<AnyRate<f64>> {
    let Some(k) = rate else { return Ok(AnyRate::Independent) };
    let key = format!("{key}.rate");
    let reference = k.reference.value;
    let c = || match (k.c, k.exponent) {
        (Some(c), None) => Ok(c.value),
        (None, _) => wrong(&key, "needs `c`"),
        (Some(_), Some(_)) => wrong(format!("{key}.exponent"), "goes with `law = \"cowper_symonds\"`"),
    };
    Ok(match k.law {
        RateWord::Logarithmic => Logarithmic::new(c()?, reference).at(&key)?.into(),
        RateWord::SmoothLogarithmic => SmoothLogarithmic::new(c()?, reference).at(&key)?.into(),
        RateWord::Power => PowerRate::new(c()?, reference).at(&key)?.into(),
        RateWord::CowperSymonds => match (k.c, k.exponent) {
            (None, Some(q)) => CowperSymonds::new(reference, q.value).at(&key)?.into(),
            (Some(_), _) => {
                return wrong(format!("{key}.c"), "is not of `cowper_symonds`, which has an `exponent`");
            }
            (None, None) => return wrong(key, "needs an `exponent`"),
        },
    })
}

fn heat(k: &HeatConstants) -> Heat<f64> {
    Heat {
        room: k.room.value,
        melt: k.melt.value,
        exponent: k.m.value,
        heat_capacity: k.capacity.value,
        taylor_quinney: k.taylor_quinney.map_or(TAYLOR_QUINNEY, |q| q.value),
    }
}

pub(super) fn localisation(key: &str, size: Option<Quantity<Length>>) -> Made<AnyLocalisation<f64>> {
    Ok(match size {
        Some(size) => AnyLocalisation::CrackBand(CrackBand::new(size.value).at(format!("{key}.size"))?),
        None => AnyLocalisation::Local,
    })
}

/// Return the product of a hardening and the factors of rate and heat.
fn product(
    key: &str,
    name: &'static str,
    shear: f64,
    hardening: impl Into<AnyHardening<f64>>,
    (rates, heating): (Option<&RateConstants>, Option<&HeatConstants>),
) -> Made<AnyStrength<f64>> {
    let thermal = match heating {
        Some(k) => AnyHeat::Adiabatic(Adiabatic::new(heat(k)).at(format!("{key}.heat"))?),
        None => AnyHeat::Isothermal,
    };
    let law = JohnsonCook::from_hardening(shear, hardening.into()).at(format!("{key}.shear_modulus"))?;
    Ok(AnyStrength::Product(name, law.with_rate(rate(key, rates)?).with_heat(thermal)))
}

/// Return the strength, with the failure that belongs to it, for a material of this reference density, kg/m^3.
fn of_strength(key: &str, strength: &Strength, density: f64) -> Made<(AnyStrength<f64>, AnyFailure<f64>)> {
    let none = AnyFailure::default();
    Ok(match strength {
        Strength::Elastic(s) => {
            (Elastic::new(s.shear_modulus.value).at(format!("{key}.elastic"))?.into(), none)
        }
        Strength::J2(s) => {
            let key = format!("{key}.j2");
            let hardening = LinearHardening::new(s.yield_stress.value, s.hardening.value).at(&key)?;
            let factors = (s.rate.as_ref(), s.heat.as_ref());
            (product(&key, "J2 plasticity", s.shear_modulus.value, hardening, factors)?, none)
        }
        Strength::Voce(s) => {
            let key = format!("{key}.voce");
            let hardening =
                VoceHardening::new(s.yield_stress.value, s.saturation.value, s.b.value).at(&key)?;
            let factors = (s.rate.as_ref(), s.heat.as_ref());
            (product(&key, "J2 plasticity", s.shear_modulus.value, hardening, factors)?, none)
        }
        Strength::SaturatingPower(s) => {
            let key = format!("{key}.saturating_power");
            let hardening = SaturatingPower::new(
                s.yield_stress.value,
                s.largest.value,
                s.beta.value,
                s.n.value,
                s.initial_strain.value,
            );
            let factors = (s.rate.as_ref(), s.heat.as_ref());
            (product(&key, "J2 plasticity", s.shear_modulus.value, hardening.at(&key)?, factors)?, none)
        }
        Strength::JohnsonCook(s) => {
            let key = format!("{key}.johnson_cook");
            let hardening = PowerHardening::new(s.a.value, s.b.value, s.n.value).at(&key)?;
            let factors = (s.rate.as_ref(), s.heat.as_ref());
            (product(&key, "Johnson-Cook", s.shear_modulus.value, hardening, factors)?, none)
        }
        Strength::SteinbergGuinan(s) => {
            let key = format!("{key}.steinberg_guinan");
            let hardening =
                SaturatingPower::new(s.yield_stress.value, s.largest.value, s.beta.value, s.n.value, 0.0);
            let constants = SteinbergConstants {
                density,
                shear: s.shear_modulus.value,
                pressure: s.pressure.value,
                temperature: s.temperature.value,
                room: s.room.value,
                melt: s.melt.value,
                gruneisen: s.gruneisen.value,
                correction: s.correction.value,
                heat_capacity: s.capacity.value,
                taylor_quinney: s.taylor_quinney.map_or(TAYLOR_QUINNEY, |q| q.value),
            };
            (SteinbergGuinan::new(constants, hardening.at(&key)?).at(key)?.into(), none)
        }
        Strength::Borvik(s) => {
            let key = format!("{key}.borvik");
            let constants = BorvikConstants {
                shear: s.shear_modulus.value,
                hardening: [s.a.value, s.b.value, s.n.value],
                c: s.c.value,
                reference_rate: s.reference.value,
                heat: heat(&s.heat),
                fracture: s.d.map(|d| d.value),
                critical_damage: s.critical.value,
                threshold: s.threshold.value,
            };
            let law = Borvik::new(constants).at(&key)?.with_localisation(localisation(&key, s.size)?);
            let critical = DamageLimit::new(law.critical_damage()).at(&key)?;
            (law.into(), none.or(critical).at(key)?)
        }
    })
}

/// Return the Mie-Grueneisen equation of state of these constants.
pub(super) fn shock(key: &str, k: &ShockConstants) -> Made<AnyEos<f64>> {
    let law =
        MieGruneisen::new(k.density.value, k.sound_speed.value, k.slope.value, k.gruneisen.value).at(key)?;
    if k.expanding && k.correction.value != 0.0 {
        return wrong(format!("{key}.expanding"), "goes without `correction`");
    }
    if k.expanding {
        return Ok(Expanding::new(law).into());
    }
    Ok(law.with_correction(k.correction.value).at(format!("{key}.correction"))?.into())
}

/// Return the polynomial equation of state of these constants.
pub(super) fn polynomial(key: &str, k: &PolynomialConstants) -> Made<AnyEos<f64>> {
    let (cold, thermal) = (k.cold.map(|c| c.value), k.thermal.map(|c| c.value));
    Ok(Polynomial::new(k.density.value, cold, thermal, k.energy.value).at(key)?.into())
}

fn of_eos(key: &str, eos: &Eos) -> Made<AnyEos<f64>> {
    Ok(match eos {
        Eos::LinearDensity(k) => LinearDensity::new(k.density.value, k.sound_speed.value)
            .at(format!("{key}.linear_density"))?
            .into(),
        Eos::LogarithmicBulk(k) => LogarithmicBulk::new(k.density.value, k.bulk_modulus.value)
            .at(format!("{key}.logarithmic_bulk"))?
            .into(),
        Eos::MieGruneisen(k) => shock(&format!("{key}.mie_gruneisen"), k)?,
        Eos::CubicShock(CubicConstants { density, sound_speed, slopes, gruneisen, correction, .. }) => {
            let key = format!("{key}.cubic_shock");
            let curve =
                CubicShock::new(density.value, sound_speed.value, slopes.map(|s| s.value)).at(&key)?;
            Gruneisen::new(curve, gruneisen.value, correction.value).at(key)?.into()
        }
        Eos::PolynomialHugoniot(HugoniotConstants {
            density, coefficients, gruneisen, correction, ..
        }) => {
            let key = format!("{key}.polynomial_hugoniot");
            let curve = PolynomialHugoniot::new(density.value, coefficients.map(|c| c.value)).at(&key)?;
            Gruneisen::new(curve, gruneisen.value, correction.value).at(key)?.into()
        }
        Eos::Polynomial(k) => polynomial(&format!("{key}.polynomial"), k)?,
        Eos::Tait(k) => Tait::new(k.density.value, k.sound_speed.value).at(format!("{key}.tait"))?.into(),
    })
}

/// Add the criteria of a table to those of the parts; `own` returns those of the named set.
pub(super) fn with_criteria(
    key: &str,
    spec: &Failure,
    parts: &Parts,
    own: impl FnOnce() -> Made<AnyFailure<f64>>,
) -> Made<AnyFailure<f64>> {
    let mut all = parts.failure;
    if spec.library {
        for criterion in own()?.criteria() {
            all = all.or(criterion).at(format!("{key}.library"))?;
        }
    }
    if let Some(k) = &spec.johnson_cook {
        let key = format!("{key}.johnson_cook");
        let damage = JohnsonCookDamage::new(k.d.map(|d| d.value), k.reference.value).at(&key)?;
        all = all.or(damage.with_localisation(localisation(&key, k.size)?)).at(key)?;
    }
    if let Some(k) = &spec.tensile_pressure {
        let key = format!("{key}.tensile_pressure");
        all = all.or(TensilePressure::new(k.strength.value).at(&key)?).at(key)?;
    }
    if let Some(k) = &spec.principal_stress {
        let key = format!("{key}.principal_stress");
        all = all.or(PrincipalStress::new(k.tension.value, k.shear.value).at(&key)?).at(key)?;
    }
    if let Some(k) = &spec.tuler_butcher {
        let key = format!("{key}.tuler_butcher");
        let criterion = TulerButcher::new(k.threshold.value, k.exponent.value, k.time.value).at(&key)?;
        all = all.or(criterion).at(key)?;
    }
    if let Some(k) = &spec.plastic_strain {
        let key = format!("{key}.plastic_strain");
        all = all.or(PlasticStrainLimit::new(k.limit.value).at(&key)?).at(key)?;
    }
    if let Some(k) = &spec.damage {
        let key = format!("{key}.damage");
        if !matches!(parts.strength, AnyStrength::Borvik(_)) {
            return wrong(key, "needs a strength with damage: `strength.borvik`");
        }
        let limit = DamageLimit::new(k.limit.value).at(&key)?;
        all = all.replacing(limit).at(key)?;
    }
    if let Some(k) = &spec.cohesive_spall {
        let key = format!("{key}.cohesive_spall");
        all = all.or(CohesiveSpall::of_work(k.strength.value, k.work.value).at(&key)?).at(key)?;
    }
    let of_plastic_flow =
        [("plastic_strain", spec.plastic_strain.is_some()), ("johnson_cook", spec.johnson_cook.is_some())];
    if let (AnyStrength::Elastic(_), Some((word, _))) = (parts.strength, of_plastic_flow.iter().find(|c| c.1))
    {
        let message = "is never reached: `strength.elastic` has no plastic flow; take `strength.j2`, or `tensile_pressure`";
        return wrong(format!("{key}.{word}"), message);
    }
    if all.criteria().next().is_none() {
        return wrong(
            key,
            "specifies no criterion; take `plastic_strain`, `johnson_cook`, `tensile_pressure` or others (`impactite list laws`)",
        );
    }
    let removed = spec.plastic_strain.as_ref().is_some_and(|k| k.removed);
    let remains = match spec.post_failure {
        None if removed => Remains::Nothing,
        None | Some(PostFailure::Compression) => Remains::Compression,
        Some(PostFailure::CompressionAndShear) => Remains::CompressionAndShear,
        Some(PostFailure::Pressure) => Remains::Pressure,
        Some(PostFailure::Nothing) => Remains::Nothing,
    };
    if removed && remains != Remains::Nothing {
        return wrong(format!("{key}.post_failure"), "is `\"nothing\"` with `plastic_strain.removed`");
    }
    all.with_post_failure(remains).at(format!("{key}.post_failure"))
}
