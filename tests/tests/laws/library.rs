//! Named materials: each runs in both precisions and agrees with its source.

use approx::assert_relative_eq;
use mpm_materials::eos::chapman_jouguet;
use mpm_materials::{Constitutive, Eos, Jwl, Kinematics, Mat3, library};

/// Compress and stretch a law by one per cent: no breakdown, correct sign of stress, sound speed within `speeds`,
/// m/s.
fn runs<M: Constitutive<f64>, N: Constitutive<f32>>(
    law: M,
    single: N,
    density: f64,
    speeds: std::ops::Range<f64>,
) {
    let name = law.name();
    assert_eq!(law.density(), density, "{name}");
    let speed: f64 = law.wave_speed(&law.virgin());
    assert!(speeds.contains(&speed), "{name}: {speed} m/s");
    let (mut a, mut b) = (law.virgin(), single.virgin());
    let rest = law.stress(&a).mean();
    for part in [-1e-4, 1e-4] {
        for _ in 0..100 {
            let increment = Mat3([[part, 0.5 * part, 0.0], [0.0; 3], [0.0; 3]]);
            let new = law.update(&Kinematics { increment, dt: 1e-8, length: 1e-3 }, &a);
            assert!(!new.fault.any(), "{name}");
            a = new.state;
            let increment = Mat3(increment.0.map(|row| row.map(|x| x as f32)));
            let new = single.update(&Kinematics { increment, dt: 1e-8, length: 1e-3 }, &b);
            assert!(!new.fault.any(), "{name}");
            b = new.state;
        }
        let (double, rounded) = (law.stress(&a), single.stress(&b));
        if part < 0.0 {
            assert!(double.mean() < rest, "{name}");
        }
        // Tolerance: single precision relative to the wave modulus.
        let tolerance = 2e-5 * density * speed * speed + 2e-3 * double.mean().abs();
        assert!((double.mean() - f64::from(rounded.mean())).abs() < tolerance, "{name}");
        assert!((double.0[5] - f64::from(rounded.0[5])).abs() < tolerance, "{name}");
    }
}

#[test]
fn every_material_runs() {
    use library::*;
    // Longitudinal wave speeds: 2 to 7 km/s for metals, far less for soils.
    runs(aluminium_6061_t6(), aluminium_6061_t6(), 2700.0, 6000.0..6600.0);
    runs(aluminium_2024_t3(), aluminium_2024_t3(), 2785.0, 6400.0..6600.0);
    runs(copper_feng_2014(), copper_feng_2014(), 8940.0, 4400.0..5000.0);
    runs(aluminium_feng_2014(), aluminium_feng_2014(), 2703.0, 6000.0..6600.0);
    runs(copper_ofhc(), copper_ofhc(), 8930.0, 4600.0..4900.0);
    runs(copper_taylor(), copper_taylor(), 8930.0, 4600.0..4900.0);
    runs(copper_steinberg(), copper_steinberg(), 8930.0, 4600.0..4900.0);
    runs(copper_casing(), copper_casing(), 8900.0, 4100.0..4300.0);
    runs(steel_4340(), steel_4340(), 7830.0, 5000.0..6000.0);
    runs(steel_4340_steinberg(), steel_4340_steinberg(), 7830.0, 5000.0..6000.0);
    runs(steel_elastic(), steel_elastic(), 7850.0, 5900.0..6000.0);
    runs(weldox_460_e(), weldox_460_e(), 7850.0, 6000.0..6200.0);
    runs(weldox_460_e_uncoupled(), weldox_460_e_uncoupled(), 7750.0, 6300.0..6400.0);
    runs(arne_tool_steel(), arne_tool_steel(), 7850.0, 6100.0..6300.0);
    runs(tungsten_alloy(), tungsten_alloy(), 18167.0, 5000.0..5300.0);
    runs(lead(), lead(), 11350.0, 2200.0..2400.0);
    runs(concrete_48(), concrete_48(), 2440.0, 3700.0..3900.0);
    runs(slope_soil(), slope_soil(), 2100.0, 200.0..230.0);
    runs(aluminium_bars(), aluminium_bars(), 2650.0, 18.0..22.0);
    runs(dry_sand(), dry_sand(), 1600.0, 85.0..100.0);
    runs(air(), air(), 1.225, 340.0..341.0);
    runs(water(), water(), 1000.0, 1479.9..1480.1);
    runs(water_shocked(), water_shocked(), 1000.0, 1489.9..1490.1);
    runs(tnt().all_lit_after(0.0).unwrap(), tnt().all_lit_after(0.0).unwrap(), 1630.0, 6929.9..6930.1);
}

#[test]
fn charges_know_their_chapman_jouguet_state() {
    let tnt = library::tnt::<f64>();
    let state = chapman_jouguet(tnt.products()).unwrap();
    // Tolerance: published for D, rounded to four digits for V.
    assert_relative_eq!(state.speed, tnt.detonation_speed(), max_relative = 1e-3);
    let still = Mat3([[state.volume_ratio - 1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
    let new = tnt.update(&Kinematics { increment: still, dt: 1e-9, length: 1e-3 }, &tnt.virgin());
    assert_relative_eq!(new.state.burn_fraction, 1.0, max_relative = 1e-3);
    assert_eq!(Jwl::<f64>::tnt().initial_energy(), 6.993e9);
}
