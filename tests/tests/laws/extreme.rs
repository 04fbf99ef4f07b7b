//! Extreme states far beyond any data: equations of state and laws stay defined and conserve energy.

use mpm_materials::eos::{Eos, balance};
use mpm_materials::*;

/// Decreasing volume ratios from `high` to `low` with logarithmic spacing.
fn falling(low: f64, high: f64) -> impl Iterator<Item = f64> {
    const PARTS: i32 = 4000;
    (0..=PARTS).map(move |k| high * (low / high).powf(f64::from(k) / f64::from(PARTS)))
}

/// Assert that the pressure increases with the density from `low` to `high` at these energies, and c^2 > 0 in
/// compression.
fn monotone<E: Eos<f64>>(eos: &E, [low, high]: [f64; 2], energies: &[f64]) {
    for &e in energies {
        let mut last = f64::NEG_INFINITY;
        for j in falling(low, high) {
            let (p, squared) = (eos.pressure(j, e), eos.speed_squared(j, e));
            assert!(p.is_finite() && squared.is_finite(), "{}: {p:e} at J = {j}", eos.name());
            // In tension the pressure may be thermal only and independent of the density.
            assert!(p > last || j > 1.0 && p == last, "{}: {last:e} {p:e} at J = {j}, e = {e:e}", eos.name());
            assert!(j >= 1.0 || squared > 0.0, "{}: c^2 = {squared:e} at J = {j}, e = {e:e}", eos.name());
            last = p;
        }
    }
}

const ENERGIES: [f64; 5] = [0.0, 1e6, 1e9, 1e10, 1e11];
const ALL: [f64; 2] = [0.01, 100.0];

#[test]
fn equations_of_state_are_monotone_for_every_volume() {
    let metals = [
        MieGruneisen::copper(),
        MieGruneisen::aluminium_6061(),
        MieGruneisen::steel_4340(),
        MieGruneisen::lead(),
        MieGruneisen::tungsten_alloy(),
        *library::aluminium_feng_2014::<f64>().eos(),
        *library::copper_feng_2014::<f64>().eos(),
        *library::copper_casing::<f64>().eos(),
        *library::water_shocked::<f64>().eos(),
        MieGruneisen::new(2000.0, 3000.0, 0.0, 0.0).unwrap(),
        MieGruneisen::new(2000.0, 3000.0, 0.5, 2.5).unwrap(),
        MieGruneisen::new(2000.0, 3000.0, 3.0, 3.0).unwrap(),
    ];
    for metal in metals {
        let corrected = metal.with_correction(0.3 * metal.gruneisen()).unwrap();
        for law in [metal, metal.constant_gamma(), corrected] {
            monotone(&law, ALL, &ENERGIES);
            monotone(&Expanding::new(law), [0.01, 1e6], &ENERGIES);
            // Consistency of c^2 with the pressure beyond the range, too.
            for j in [0.99, 0.7, 0.5, 0.3, 0.1, 0.02] {
                let (e, h) = (1e10, 1e-5 * j);
                if (j - law.smallest_volume_ratio()).abs() < 2.0 * h {
                    continue;
                }
                let p = law.pressure(j, e);
                let slope = (law.pressure(j + h, e - p * h) - law.pressure(j - h, e + p * h)) / (2.0 * h);
                let (given, expected) = (law.speed_squared(j, e), -slope * j * j / law.density());
                assert!((given / expected - 1.0).abs() < 1e-5, "{given:e} {expected:e} at {j}");
            }
        }
    }
    for slopes in [[1.4, 0.2, -0.1], [1.2, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0, -0.5, 2.0]] {
        let shock = CubicShock::new(2700.0, 5000.0, slopes).unwrap();
        for (gamma, a) in [(2.0, 0.0), (2.0, 2.0), (1.5, 0.5)] {
            monotone(&Gruneisen::new(shock, gamma, a).unwrap(), ALL, &ENERGIES);
        }
    }
    let series = PolynomialHugoniot::of_shock(2700.0, 5386.0, 1.339).unwrap();
    let bent = PolynomialHugoniot::new(2700.0, [80e9, 30e9, -40e9]).unwrap();
    for curve in [series, bent] {
        monotone(&Gruneisen::new(curve, 1.97, 0.48).unwrap(), ALL, &ENERGIES[..1]);
        // A series that decreases in tension is not used there: p = K mu.
        monotone(&Gruneisen::new(curve, 1.97, 1.97).unwrap(), ALL, &ENERGIES);
    }
    monotone(&Jwl::tnt(), [0.01, 1e6], &ENERGIES[1..]);
    monotone(&Jwl::tnt(), [0.01, 10.0], &ENERGIES);
    monotone(&IdealGas::air(), [0.01, 1e6], &ENERGIES[1..]);
    monotone(&Tait::new(1000.0, 1480.0).unwrap(), [0.01, 10.0], &[0.0]);
    monotone(&LinearDensity::new(1000.0, 50.0).unwrap(), ALL, &[0.0]);
    monotone(&LogarithmicBulk::new(7850.0, 160e9).unwrap(), ALL, &[0.0]);
    monotone(
        &Polynomial::new(2000.0, [0.0, 20e9, 30e9, 40e9], [1.5, 0.5, 0.25], 0.0).unwrap(),
        ALL,
        &ENERGIES,
    );
}

#[test]
fn the_balance_has_a_solution_for_every_step() {
    let law = MieGruneisen::<f64>::copper();
    for j in [1e-3, 0.05, 0.3, 1.0, 30.0, 1e6] {
        for factor in [1e-3, 0.05, 0.5, 2.0, 100.0] {
            for e in [0.0, 1e8, 1e11] {
                let change = j - j / factor;
                let found = balance(law.terms(j), e, change);
                assert!(found.pressure.is_finite() && found.energy.is_finite());
                // Energy balance: the energy includes the work of the returned pressure.
                let work = e - 0.5 * change * found.pressure;
                assert!((found.energy - work).abs() <= 1e-12 * (e + (change * found.pressure).abs()));
            }
        }
    }
}

fn squeezed(from: f64, to: f64) -> Kinematics<f64> {
    let x = (to / from).cbrt() - 1.0;
    Kinematics { increment: Mat3([[x, 0.0, 0.0], [0.0, x, 0.0], [0.0, 0.0, x]]), dt: 1e-9, length: 1e-3 }
}

#[test]
fn a_metal_crushed_to_a_twentieth_keeps_its_books() {
    fn check<S: Strength<f64>>(law: Solid<S, MieGruneisen<f64>>) {
        let mut state = law.virgin();
        let (mut work, mut most) = (0.0, 0.0_f64);
        let path: Vec<f64> = falling(0.05, 1.0).collect();
        let back = path.iter().rev().copied();
        for to in path.iter().copied().chain(back) {
            let update = law.update(&squeezed(state.volume_ratio, to), &state);
            assert!(!update.fault.any(), "{:?} at J = {to}", update.fault.cause(0));
            let new = update.state;
            let mean = -0.5 * (state.stress.mean() + new.stress.mean());
            work -= mean * (new.volume_ratio - state.volume_ratio);
            assert!(law.wave_speed(&new).is_finite() && law.wave_speed(&new) < 1e6);
            state = new;
            most = most.max(state.energy);
            // Tolerance: round-off of thousands of steps.
            assert!((law.energy(&state) - work).abs() <= 1e-9 * most, "{:e} {work:e}", state.energy);
        }
        // An isentropic cycle yields no work up to the order of the scheme: 2 x 4000 steps of 7e-4.
        assert!(most > 1e11 && state.energy.abs() < 1e-3 * most, "{:e} of {most:e}", state.energy);
        assert!((state.volume_ratio - 1.0).abs() < 1e-9);
        // Compression in one step, to a twentieth and to a hundredth.
        for to in [0.05, 0.01] {
            let update = law.update(&squeezed(1.0, to), &law.virgin());
            assert!(!update.fault.any() && update.stress.mean() < 0.0);
            assert!(!law.in_range(&update.state) && law.in_range(&law.virgin()));
        }
    }
    check(library::copper_ofhc::<f64>());
    check(library::lead::<f64>());
    check(Solid::new(JohnsonCook::aluminium_6061(), MieGruneisen::aluminium_6061().constant_gamma()));
}

#[test]
fn hot_debris_is_computed_however_thin() {
    let law = library::lead::<f64>().with_failure(TensilePressure::new(1e8).unwrap());
    let thin = Solid::new(JohnsonCook::lead(), Expanding::new(MieGruneisen::lead()))
        .with_failure(TensilePressure::new(1e8).unwrap());
    fn scattered<C: Constitutive<f64>>(law: &C, mut state: C::State<f64>) {
        for to in [1.5, 10.0, 1e3, 1e6, 1e2, 1.2, 0.9, 0.1] {
            let from: f64 = law.volume_ratio(&state);
            let update = law.update(&squeezed(from, to), &state);
            assert!(!update.fault.any(), "{:?} at J = {to}", update.fault.cause(0));
            state = update.state;
            assert!(law.wave_speed(&state).is_finite() && law.energy(&state).is_finite());
        }
    }
    for energy in [0.0, 1e9, 1e11] {
        let mut state = law.virgin();
        state.energy = energy;
        scattered(&law, state);
        let mut state = thin.virgin();
        state.energy = energy;
        scattered(&thin, state);
    }
}

#[test]
fn one_precision_is_enough() {
    let law = library::copper_ofhc::<f32>();
    let mut state = law.virgin();
    for k in 1..=100 {
        let to = 0.05_f32.powf(k as f32 / 100.0);
        let x = (to / state.volume_ratio).cbrt() - 1.0;
        let increment = Mat3([[x, 0.0, 0.0], [0.0, x, 0.0], [0.0, 0.0, x]]);
        let update = law.update(&Kinematics { increment, dt: 1e-9, length: 1e-3 }, &state);
        assert!(!update.fault.any());
        state = update.state;
    }
    assert!(law.wave_speed(&state).is_finite());
}
