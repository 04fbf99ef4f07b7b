//! Hardening, rate factors, Steinberg-Guinan, Borvik, Bingham and p-alpha against closed forms; energy balance of
//! points with heating and melting.

use approx::assert_relative_eq;
use mpm_materials::driver::{Path, Step, run};
use mpm_materials::eos::Eos;
use mpm_materials::strength::{
    BorvikConstants, Hardened, Hardening, Loading, RateFactor, SaturatingPower, Softened, SteinbergConstants,
    Strength, VoceHardening,
};
use mpm_materials::*;

/// Strain direction with sqrt(2/3 e:e) = 1.
fn direction() -> Sym3<f64> {
    let direction = Sym3([0.5, 0.1, -0.6, 0.3, -0.2, 0.4]);
    direction * (1.5 / direction.dot(&direction)).sqrt()
}

fn loading(part: f64, rate: f64, pressure: f64, specific_volume: f64) -> Loading<f64> {
    Loading { strain_deviator: direction() * part, dt: part / rate, length: 1e-3, pressure, specific_volume }
}

/// Strain a strength law proportionally to `strain` in `count` steps; return all state variables and flow stresses.
fn strained<S: Strength<f64>>(
    law: &S,
    strain: f64,
    count: usize,
    rate: f64,
    pressure: f64,
) -> Vec<(S::History<f64>, f64)> {
    let (mut deviator, mut history) = (Sym3([0.0; 6]), law.virgin());
    let mut list = vec![];
    for _ in 0..count {
        let loading = loading(strain / count as f64, rate, pressure, 1.0 / 8000.0);
        let trial = deviator + loading.strain_deviator * (2.0 * law.shear_modulus());
        let new = law.return_map(&trial, &loading, &history);
        assert!(!new.fault.any());
        (deviator, history) = (new.deviator, new.history);
        list.push((history, deviator.equivalent()));
    }
    list
}

#[test]
fn voce_hardening_curve() {
    let (g, a, q, b) = (26e9, 200e6, 150e6, 12.0);
    let law = J2::voce(g, a, q, b).unwrap();
    for (strain, count) in [(0.01, 1), (0.5, 1), (0.5, 7), (1.0, 1000)] {
        for (k, (history, flow)) in strained(&law, strain, count, 1.0, 0.0).into_iter().enumerate() {
            let plastic: f64 = history.plastic_strain;
            if plastic > 0.0 {
                assert_relative_eq!(flow, a + q * (1.0 - (-b * plastic).exp()), max_relative = 1e-12);
            }
            let total = strain * (k + 1) as f64 / count as f64;
            assert_relative_eq!(plastic + flow / (3.0 * g), total, max_relative = 1e-11);
        }
    }
    assert!(J2::voce(g, a, -1.0, b).is_err());
}

#[test]
fn saturating_power_curve() {
    let curve = SaturatingPower::new(120e6, 640e6, 36.0, 0.45, 0.02).unwrap();
    for strain in [0.0_f64, 0.1, 0.5] {
        let expected = 120e6 * (1.0 + 36.0 * (strain + 0.02)).powf(0.45);
        assert_relative_eq!(curve.stress(strain), expected.min(640e6), max_relative = 1e-13);
    }
    assert_eq!(curve.stress(5.0), 640e6);
    assert!(SaturatingPower::new(120e6, 100e6, 36.0, 0.45, 0.0).is_err());
    assert!(SaturatingPower::new(120e6, 640e6, 36.0, 1.45, 0.0).is_err());
    assert!(VoceHardening::new(0.0, 1.0, 1.0).is_err());
}

#[test]
fn rate_factors() {
    for rate in [1e-3_f64, 1.0, 2e4] {
        let loading = loading(1e-3, rate, 0.0, 1e-4);
        let power = PowerRate::new(0.0114, 5e-4).unwrap().factor(&loading);
        assert_relative_eq!(power, (1.0 + rate / 5e-4).powf(0.0114), max_relative = 1e-12);
        let cowper = CowperSymonds::new(40.4, 5.0).unwrap().factor(&loading);
        assert_relative_eq!(cowper, 1.0 + (rate / 40.4).powf(0.2), max_relative = 1e-12);
    }
    let mut still = loading(1e-3, 1.0, 0.0, 1e-4);
    still.strain_deviator = Sym3::zero();
    assert_eq!(CowperSymonds::new(40.4, 5.0).unwrap().factor(&still), 1.0);
    assert_eq!(PowerRate::new(0.01, 1.0).unwrap().factor(&still), 1.0);
    let simple = JohnsonCook::simplified(26e9, [300e6, 200e6, 0.3], 0.01, 2.0).unwrap();
    let (history, flow) = strained(&simple, 0.2, 5, 1e3, 0.0)[4];
    let expected = (300e6 + 200e6 * history.plastic_strain.powf(0.3)) * (1.0 + 0.01 * 500_f64.ln());
    assert_relative_eq!(flow, expected, max_relative = 1e-10);
}

fn steinberg() -> SteinbergConstants<f64> {
    SteinbergConstants {
        density: 8000.0,
        shear: 50e9,
        pressure: 25e-12,
        temperature: 3e-4,
        room: 300.0,
        melt: 1800.0,
        gruneisen: 2.0,
        correction: 1.5,
        heat_capacity: 400.0,
        taylor_quinney: 0.0,
    }
}

#[test]
fn steinberg_guinan_under_pressure() {
    let curve = SaturatingPower::new(120e6, 640e6, 36.0, 0.45, 0.0).unwrap();
    let law = SteinbergGuinan::new(steinberg(), curve).unwrap();
    let (j, pressure, warm) = (0.8_f64, 30e9, 500.0);
    let old = Hardened { plastic_strain: 0.1, temperature: warm };
    let r = 1.0 + 25e-12 * pressure * j.cbrt() - 3e-4 * (warm - 300.0);
    for part in [1e-4, 1e-2] {
        let loading = loading(part, 1e6, pressure, j / 8000.0);
        let trial = loading.strain_deviator * (2.0 * law.shear_modulus());
        let new = law.return_map(&trial, &loading, &old);
        let elastic = 3.0 * 50e9 * r * part;
        let yield_now = r * 120e6 * (1.0 + 36.0 * new.history.plastic_strain).powf(0.45);
        assert_relative_eq!(new.deviator.equivalent(), elastic.min(yield_now), max_relative = 1e-11);
        let lost = (elastic - new.deviator.equivalent()) / (3.0 * 50e9 * r);
        assert_relative_eq!(new.history.plastic_strain - 0.1, lost, max_relative = 1e-9, epsilon = 1e-15);
    }
    assert_relative_eq!(law.stiffening(pressure, j, &old), r, max_relative = 1e-12);
    // Melting temperature: T_m0 exp(2 a (1 - 1/eta)) eta^(2 (gamma0 - a - 1/3)), eta = 1/J.
    let eta = 1.0 / j;
    let melt = 1800.0 * (3.0 * (1.0 - 1.0 / eta)).exp() * eta.powf(2.0 * (2.0 - 1.5 - 1.0 / 3.0));
    assert_relative_eq!(law.melting_temperature(j), melt, max_relative = 1e-12);
    for (temperature, molten) in [(melt - 1.0, false), (melt + 1.0, true)] {
        let old = Hardened { plastic_strain: 0.1, temperature };
        let loading = loading(1e-2, 1e6, pressure, j / 8000.0);
        let trial = loading.strain_deviator * (2.0 * law.shear_modulus());
        let new = law.return_map(&trial, &loading, &old);
        assert_eq!(new.deviator.equivalent() < 1.0, molten);
    }
    assert!(SteinbergGuinan::new(SteinbergConstants { melt: 0.0, ..steinberg() }, curve).is_err());
}

#[test]
fn steinberg_guinan_heats() {
    // Heat without thermal softening: closed-form integral of the flow curve.
    let constants = SteinbergConstants { temperature: 0.0, taylor_quinney: 0.9, ..steinberg() };
    let curve = SaturatingPower::new(120e6, 1e12, 36.0, 0.45, 0.0).unwrap();
    let law = SteinbergGuinan::new(constants, curve).unwrap();
    let error = |count: usize| {
        let (history, _) = strained(&law, 1.0, count, 1.0, 0.0)[count - 1];
        let strain: f64 = history.plastic_strain;
        let work = 120e6 / (36.0 * 1.45) * ((1.0 + 36.0 * strain).powf(1.45) - 1.0);
        (history.temperature - 300.0 - 0.9 * work / (8000.0 * 400.0)).abs()
    };
    let (coarse, fine) = (error(1000), error(2000));
    assert!(fine < 0.1 && fine < 0.52 * coarse, "{coarse} {fine}");
}

fn borvik(threshold: f64) -> BorvikConstants<f64> {
    // Melting temperature so high that thermal softening is negligible in the integrated tests.
    let heat = Heat { room: 293.0, melt: 1e9, exponent: 1.0, heat_capacity: 452.0, taylor_quinney: 0.0 };
    BorvikConstants {
        shear: 75e9,
        hardening: [490e6, 807e6, 0.73],
        c: 0.0114,
        reference_rate: 5e-4,
        heat,
        fracture: [0.0705, 1.732, -0.54, -0.0123, 0.0],
        critical_damage: 0.3,
        threshold,
    }
}

#[test]
fn borvik_damages_and_softens() {
    // Closed form at constant rate and zero pressure: p_f constant, so that D = D_c (p - p_d)/(p_f - p_d) and r
    // follows.
    for threshold in [0.0, 0.1] {
        let law = Borvik::new(borvik(threshold)).unwrap();
        let (rate, count) = (1e3, 2000);
        let strain = 0.8;
        let list = strained(&law, strain, count, rate, 0.0);
        let mut old: Softened<f64> = law.virgin();
        for (history, flow) in list {
            let (p, r, d) = (history.plastic_strain, history.hardening_strain, history.damage);
            // Exact update of each step: initial damage, final hardening.
            let sound = 1.0 - old.damage;
            assert_relative_eq!(
                r - old.hardening_strain,
                sound * (p - old.plastic_strain),
                max_relative = 1e-9,
                epsilon = 1e-14
            );
            if p > old.plastic_strain {
                let factor = sound * (1.0 + sound * rate / 5e-4).powf(0.0114);
                assert_relative_eq!(flow, factor * (490e6 + 807e6 * r.powf(0.73)), max_relative = 1e-9);
                let grown = p - old.plastic_strain;
                let fast = (1.0 + grown / (strain / count as f64 / rate) / 5e-4).powf(-0.0123);
                let fracture = (0.0705 + 1.732) * fast;
                let beyond = grown.min((p - threshold).max(0.0));
                let expected = old.damage + 0.3 * beyond / (fracture - threshold);
                assert_relative_eq!(d, expected, max_relative = 1e-10, epsilon = 1e-15);
            }
            old = history;
        }
        // Integrated damage: the plastic rate is nearly the total rate.
        let fracture = 1.8025 * (1.0 + rate / 5e-4).powf(-0.0123);
        let expected = 0.3 * (old.plastic_strain - threshold) / (fracture - threshold);
        assert_relative_eq!(old.damage, expected, max_relative = 1e-3);
    }
    // Damage is limited to D_c, where the failure criterion applies.
    let law = Borvik::new(borvik(0.0)).unwrap();
    let last = strained(&law, 5.0, 1000, 1e3, 0.0)[999].0;
    assert_eq!(law.damage(&last), 0.3);
    // Crack band: half the cell size, half the damage per strain.
    let banded = law.with_localisation(CrackBand::new(2e-3).unwrap());
    let (whole, half) = (strained(&law, 0.1, 1, 1.0, 0.0)[0].0, strained(&banded, 0.1, 1, 1.0, 0.0)[0].0);
    assert_relative_eq!(half.damage, 0.5 * whole.damage, max_relative = 1e-12);
    // Pressure dependence: tension accelerates damage, compression delays it.
    let damage = |pressure| strained(&law, 0.1, 10, 1.0, pressure)[9].0.damage;
    assert!(damage(-500e6) > damage(0.0) && damage(0.0) > damage(500e6));
    assert!(Borvik::new(BorvikConstants { critical_damage: 1.0, ..borvik(0.0) }).is_err());
}

#[test]
fn bingham_fluid_in_simple_shear() {
    let (yield_stress, viscosity, creep) = (50.0, 2.0, 0.01);
    let law = Fluid::new(LinearDensity::new(1500.0, 50.0).unwrap())
        .with_shear_viscosity(Bingham::new(yield_stress, viscosity, creep).unwrap());
    for rate in [1e-9, 1e-5, 1e-3, 0.01, 0.3, 30.0_f64] {
        let table = run(&law, &Path::SimpleShear { rate }, Step { dt: 1e-3 / rate, steps: 1 }).unwrap();
        let expected = yield_stress * (-(-rate / creep).exp_m1()) + viscosity * rate;
        assert_relative_eq!(table.rows[1].stress.0[5], expected, max_relative = 1e-10);
    }
    assert!(Bingham::new(0.0, 1.0, 1.0).is_err());
}

/// Sand-like law: alpha_0 1.6, thermal pressure by `gamma`, negligible strength.
fn porous(gamma: f64) -> Porous<f64, J2<f64>, MieGruneisen<f64>> {
    let solid = MieGruneisen::new(2650.0, 4000.0, 1.5, gamma).unwrap();
    Porous::new(J2::linear(1e3, 1.0, 0.0).unwrap(), solid, 1.6, 1e7, 2e9).unwrap()
}

fn squeezed(from: f64, to: f64) -> Kinematics<f64> {
    let h = (to / from).cbrt() - 1.0;
    Kinematics { increment: Mat3::identity() * h, dt: 1e-6, length: 1e-3 }
}

#[test]
fn p_alpha_compacts_along_its_curve() {
    let law = porous(0.0);
    let solid = |j: f64| {
        let eta = 1.0 - j;
        let bulk = 2650.0 * 4000.0 * 4000.0;
        if eta > 0.0 { bulk * eta / (1.0 - 1.5 * eta).powi(2) } else { bulk * eta / j }
    };
    let mut state = law.virgin();
    let (mut compacting, mut full) = (0, 0);
    for k in 1..=500 {
        let j = 1.0 - 1e-3 * f64::from(k);
        let new = law.update(&squeezed(state.volume_ratio, j), &state);
        assert!(!new.fault.any());
        let (alpha, p) = (new.state.distension, -new.stress.mean());
        // Pressure of the solid part, over the distension.
        assert_relative_eq!(
            p,
            solid(1.6 * new.state.volume_ratio / alpha) / alpha,
            max_relative = 1e-9,
            epsilon = 1.0
        );
        if alpha < state.distension && alpha > 1.0 {
            compacting += 1;
            // Herrmann's quadratic compaction curve.
            let expected = 1.0 + 0.6 * ((2e9 - p) / (2e9 - 1e7)).powi(2);
            assert_relative_eq!(alpha, expected, max_relative = 1e-8);
        }
        if alpha == 1.0 {
            full += 1;
        }
        state = new.state;
    }
    assert!(compacting > 300 && full > 50, "{compacting} {full}");
    // Unloading at constant distension.
    let (alpha, j) = (state.distension, state.volume_ratio);
    state = law.update(&squeezed(j, 1.1 * j), &state).state;
    assert_eq!(state.distension, alpha);
}

#[test]
fn p_alpha_shock_in_one_step() {
    // One step from rest has the Hugoniot energy, e = p (1 - J)/2: fully compacted at these volume ratios.
    let gamma = 1.5;
    let law = porous(gamma);
    let solid = MieGruneisen::new(2650.0, 4000.0, 1.5, gamma).unwrap();
    for j in [0.6, 0.55, 0.5] {
        let new = law.update(&squeezed(1.0, j), &law.virgin());
        assert!(!new.fault.any());
        let cold = solid.pressure(1.6 * j, 0.0);
        let pressure = cold / (1.0 - 0.5 * gamma * 1.6 * (1.0 - j));
        assert_eq!(new.state.distension, 1.0);
        // The strength of one pascal is negligible.
        assert_relative_eq!(-new.stress.mean(), pressure, max_relative = 1e-8);
        assert_relative_eq!(new.state.energy, 0.5 * pressure * (1.0 - j), max_relative = 1e-8);
    }
    assert!(Porous::new(J2::linear(1e3, 1.0, 0.0).unwrap(), solid, 1.0, 1e7, 2e9).is_err());
    assert!(Porous::new(J2::linear(1e3, 1.0, 0.0).unwrap(), solid, 1.5, 1e7, 1e6).is_err());
}

/// Shear a law at `rate` for `steps` of `dt`; return stress work, energy, heat by the temperature rise, and
/// temperatures.
fn sheared<S, F>(
    law: &Solid<S, MieGruneisen<f64>, F>,
    steps: usize,
    dt: f64,
    rate: f64,
) -> ([f64; 3], Vec<f64>)
where
    S: Strength<f64>,
    F: Failure<f64>,
{
    let table = run(law, &Path::SimpleShear { rate }, Step { dt, steps }).unwrap();
    let mut work = 0.0;
    for pair in table.rows.windows(2) {
        work += 0.5 * (pair[0].stress.0[5] + pair[1].stress.0[5]) * rate * dt;
    }
    let end = &table.rows[steps];
    let temperature = table.column("temperature").unwrap();
    let density = law.density();
    let heat = density * 383.0 * (temperature[steps] - temperature[0]);
    ([work, end.energy, heat], temperature)
}

#[test]
fn the_ledger_of_a_point_that_heats_and_melts_closes() {
    // Adiabatic shear of copper to eight: stress work = internal energy = elastic + plastic, heat = 0.9 plastic.
    let copper = Solid::new(JohnsonCook::<f64>::copper(), MieGruneisen::copper());
    let gap = |steps: usize| {
        let ([work, energy, heat], _) = sheared(&copper, steps, 8e-4 / steps as f64, 1e4);
        let stored = energy - heat / 0.9;
        // Elastic remainder: s:s/4G and a small volumetric part, far below one per cent.
        assert!(stored > 0.0 && stored < 0.01 * energy, "{stored:e} of {energy:e}");
        (energy - work).abs() / work
    };
    let (coarse, fine) = (gap(4000), gap(8000));
    assert!(fine < 1e-6 + 0.6 * coarse && fine < 1e-3, "{coarse:e} {fine:e}");

    // Constants that melt during shear: from then on no strength, no work and no further heat, with the same
    // balance.
    let heat = Heat { room: 294.0, melt: 400.0, exponent: 1.0, heat_capacity: 383.0, taylor_quinney: 1.0 };
    let soft = JohnsonCook::new(47.7e9, 400e6, 300e6, 0.5).unwrap().with_heat(Adiabatic::new(heat).unwrap());
    let soft = Solid::new(soft, MieGruneisen::copper());
    let ([work, energy, heat], temperature) = sheared(&soft, 40_000, 2e-8, 1e4);
    let end = temperature[temperature.len() - 1];
    assert!(end > 399.0 && end < 400.5, "{end}");
    assert_relative_eq!(energy, work, max_relative = 2e-3);
    assert_relative_eq!(heat, energy, max_relative = 1e-2);
}

mod battery {
    use mpm_materials::conformance::{self as held, Options};
    use mpm_materials::*;

    fn metal(strain: f64) -> Options {
        Options { wave_tolerance: 0.05, ..Options::strain(strain) }
    }
    conformance_suite!(
        voce,
        Solid::new(J2::voce(26e9, 200e6, 150e6, 12.0).unwrap(), MieGruneisen::aluminium_6061()),
        metal(0.1),
        yields
    );
    conformance_suite!(
        cowper_symonds,
        Solid::new(
            JohnsonCook::new(80e9, 300e6, 200e6, 0.4)
                .unwrap()
                .with_rate(CowperSymonds::new(40.4, 5.0).unwrap()),
            MieGruneisen::steel_4340()
        ),
        metal(0.1),
        yields
    );
    // Pressure-dependent G: elasticity in rate form is not conservative and yields or dissipates little work in a
    // cycle.
    conformance_suite!(
        steinberg_copper,
        Solid::new(SteinbergGuinan::copper(), MieGruneisen::copper()),
        Options { work_tolerance: 5e-3, ..metal(0.05) },
        yields;
        single = Solid::new(SteinbergGuinan::<f32>::copper(), MieGruneisen::copper())
    );
    conformance_suite!(
        steinberg_steel,
        Solid::new(SteinbergGuinan::steel_4340(), MieGruneisen::steel_4340()),
        Options { work_tolerance: 5e-3, ..metal(0.05) },
        yields
    );
    conformance_suite!(
        weldox,
        Solid::new(Borvik::weldox_460_e(), MieGruneisen::steel_4340()),
        metal(0.1),
        yields;
        single = Solid::new(Borvik::<f32>::weldox_460_e(), MieGruneisen::steel_4340())
    );
    conformance_suite!(
        bingham,
        Fluid::new(KeepEnergy(LinearDensity::new(1500.0, 50.0).unwrap()))
            .with_shear_viscosity(Bingham::new(50.0, 2.0, 1.0).unwrap()),
        Options { duration: 1e-2, ..Options::strain(0.05) }
    );
    fn sand() -> Porous<f64, J2<f64>, MieGruneisen<f64>> {
        let solid = MieGruneisen::new(2650.0, 4000.0, 1.5, 1.0).unwrap();
        Porous::new(J2::linear(2e9, 20e6, 0.0).unwrap(), solid, 1.3, 1e7, 1e9).unwrap()
    }
    conformance_suite!(
        porous_elastic,
        {
            let solid = MieGruneisen::new(2650.0, 4000.0, 1.5, 1.0).unwrap();
            Porous::new(J2::linear(2e9, 20e6, 0.0).unwrap(), solid, 1.3, 1e10, 1e11).unwrap()
        },
        metal(0.02)
    );
    conformance_suite!(porous_compacting, sand().with_bulk_viscosity(0.06, 1.5).unwrap(), metal(0.05));

    #[test]
    fn damaged_steel_fails() {
        let steel = Solid::new(Borvik::weldox_460_e(), MieGruneisen::steel_4340());
        let brittle = Borvik::new(strength::BorvikConstants {
            fracture: [0.05, 0.02, -0.5, 0.0, 0.0],
            ..super::borvik(0.0)
        })
        .unwrap();
        let law =
            Solid::new(brittle, MieGruneisen::steel_4340()).with_failure(DamageLimit::new(0.3).unwrap());
        held::fails(&law, &metal(0.1)).unwrap();
        held::lanes(&law, &metal(0.1)).unwrap();
        held::not_a_number(&steel.with_failure(DamageLimit::new(0.3).unwrap()), &metal(0.1)).unwrap();
    }
}
