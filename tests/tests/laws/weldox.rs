//! Smooth tension test of Weldox 460 E. A finite element analysis of the test, published as a data file \[V\], has its largest nominal
//! stress of 569.9 MPa at a strain of 10 %; 566 to 572 MPa are accepted. Two sets of constants are in use, each for a law of its own.
//!
//! The bar of that analysis breaks at 26 % in its neck, which a point does not have: here it stretches uniformly until its law
//! fails.

use mpm_materials::driver::{Path, Row, Step, Table, run};
use mpm_materials::strength::BorvikConstants;
use mpm_materials::*;

/// Strain rate, 1/s: far below the reference rates, without rate hardening.
const RATE: f64 = 1e-9;
/// Strain increment of a step.
const STRAIN: f64 = 2e-4;

/// Constants of 2001 with this Taylor-Quinney coefficient.
fn constants(taylor_quinney: f64) -> BorvikConstants<f64> {
    let heat = Heat { room: 293.0, melt: 1800.0, exponent: 0.94, heat_capacity: 452.0, taylor_quinney };
    BorvikConstants {
        shear: 200e9 / 2.66,
        hardening: [490e6, 807e6, 0.73],
        c: 0.0114,
        reference_rate: 5e-4,
        heat,
        fracture: [0.0705, 1.732, -0.54, -0.0123, 0.0],
        critical_damage: 0.30,
        threshold: 0.0,
    }
}

fn bulk(young: f64) -> LogarithmicBulk<f64> {
    LogarithmicBulk::new(7850.0, young / 1.02).unwrap()
}

fn stretched<M: Constitutive<f64>>(law: &M, strain: f64) -> Table<f64> {
    let steps = (strain / STRAIN).round() as usize;
    run(law, &Path::UniaxialStress { rate: RATE }, Step { dt: STRAIN / RATE, steps }).unwrap()
}

/// Nominal stress, MPa, over nominal strain: the area follows the lateral strain.
fn nominal(table: &Table<f64>) -> Vec<[f64; 2]> {
    let of = |row: &Row<f64>| {
        let area = (row.strain.0[1] + row.strain.0[2]).exp();
        [row.strain.0[0].exp_m1(), 1e-6 * row.stress.0[0] * area]
    };
    table.rows.iter().map(of).collect()
}

fn peak(curve: &[[f64; 2]]) -> [f64; 2] {
    curve.iter().copied().fold([0.0; 2], |most, now| if now[1] > most[1] { now } else { most })
}

fn at(curve: &[[f64; 2]], strain: f64) -> f64 {
    curve.iter().find(|point| point[0] >= strain).map_or(f64::NAN, |point| point[1])
}

/// Largest nominal stress, MPa, and its nominal strain, for a uniformly stretched bar of flow stress sigma(p), MPa, and Young's modulus
/// (Pa): axial strain p plus sigma/E, lateral strain p/2 plus nu sigma/E.
fn of_curve(young: f64, flow: impl Fn(f64) -> f64) -> [f64; 2] {
    let point = |p: f64| {
        let (stress, elastic) = (flow(p), flow(p) * 1e6 / young);
        [(p + elastic).exp_m1(), stress * (-p - 0.66 * elastic).exp()]
    };
    peak(&(1..100_000).map(|n| point(f64::from(n) * 1e-5)).collect::<Vec<_>>())
}

/// Assert agreement of peaks: the position of a peak is less accurate than its height.
fn agree(found: [f64; 2], expected: [f64; 2]) {
    assert!((found[1] / expected[1] - 1.0).abs() < 5e-4, "{found:?} {expected:?}");
    assert!((found[0] - expected[0]).abs() < 3e-3, "{found:?} {expected:?}");
}

/// Later constants 499/382/0.458: 571.9 MPa at 10 %, as measured.
#[test]
fn the_later_set_bears_what_the_steel_bears() {
    let strength = JohnsonCook::<f64>::weldox_460_e().with_heat(Isothermal);
    let law = Solid::new(strength, bulk(211e9)).with_failure(JohnsonCookDamage::weldox_460_e());
    let table = stretched(&law, 1.6);
    let curve = nominal(&table);
    let found = peak(&curve);
    agree(found, of_curve(211e9, |p| 499.0 + 382.0 * p.powf(0.458)));
    assert!((566.0..572.0).contains(&found[1]) && (0.09..0.11).contains(&found[0]), "{found:?}");
    assert!((566.0..572.0).contains(&at(&curve, 0.10)), "{}", at(&curve, 0.10));

    // Failure at D1 + D2 exp(D3 / 3), 1.36, as in the neck of the steel; full flow stress until then.
    let damage = table.column("damage.failure_damage").or_else(|| table.column("failure_damage"));
    let failed = damage.unwrap().iter().position(|d| *d >= 1.0).unwrap();
    let strain = 0.636 + 1.936 * f64::exp(-2.969 / 3.0);
    let found = table.rows[failed].strain.0[0];
    assert!((found - strain).abs() < 0.01, "{found} {strain}");
    assert!(table.rows[failed + 1].stress.0[0].abs() < 1e6, "a failed point bears no tension");
}

/// Constants 490/807/0.73 with their damage: 564 MPa at 10 %, and 577 MPa at 22 %, since damage ends the hardening late.
#[test]
fn the_set_of_2001_needs_its_damage() {
    assert_eq!(Borvik::new(constants(0.9)).unwrap(), Borvik::weldox_460_e(), "the set of the library");
    let strength = Borvik::new(constants(0.0)).unwrap();
    let law = Solid::new(strength, bulk(200e9)).with_failure(DamageLimit::new(0.3).unwrap());
    let curve = nominal(&stretched(&law, 0.4));
    // Closed form in uniform tension: D = D_c p / p_f, r its undamaged part.
    let fracture = 0.0705 + 1.732 * f64::exp(-0.54 / 3.0);
    let coupled = |p: f64| {
        let damage = 0.30 * p / fracture;
        (1.0 - damage) * (490.0 + 807.0 * (p * (1.0 - 0.5 * damage)).powf(0.73))
    };
    let found = peak(&curve);
    agree(found, of_curve(200e9, coupled));
    // Within 1.5 % of the steel at its peak and at the own peak, but at too large a strain: the steel necks at 10
    // %.
    for stress in [found[1], at(&curve, 0.10)] {
        assert!((stress / 569.9 - 1.0).abs() < 0.015, "{stress}");
    }
}

/// Constants of 2001 without damage: 611 MPa at 34 %, 7 % above the steel, outside the accepted range.
#[test]
fn without_its_damage_the_set_of_2001_is_too_strong() {
    let law = Solid::new(JohnsonCook::new(200e9 / 2.66, 490e6, 807e6, 0.73).unwrap(), bulk(200e9));
    let found = peak(&nominal(&stretched(&law, 0.5)));
    agree(found, of_curve(200e9, |p| 490.0 + 807.0 * p.powf(0.73)));
    assert!((found[1] - 611.0).abs() < 2.0 && (found[0] - 0.34).abs() < 0.01, "{found:?}");
}
