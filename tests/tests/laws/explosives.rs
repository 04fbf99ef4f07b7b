//! Detonation products, programmed burn and shock equations of state against closed forms.

use approx::assert_relative_eq;
use mpm_materials::driver::{Path, Step, run};
use mpm_materials::eos::{Hugoniot, chapman_jouguet};
use mpm_materials::*;

#[test]
fn jwl_on_its_isentrope() {
    // Isentrope: p = A exp(-R1 V) + B exp(-R2 V) + C V^-(1+w) with e = A/R1 exp(-R1 V) + B/R2 exp(-R2 V) + C/w
    // V^-w.
    let (a, b, r1, r2, w) = (371.2e9_f64, 3.21e9_f64, 4.15_f64, 0.95_f64, 0.30_f64);
    let law = Jwl::tnt();
    for c in [0.5e9, 1.2e9, 3e9] {
        for v in [0.5_f64, 0.73, 1.0, 2.5, 10.0, 100.0] {
            let (first, second) = (a * (-r1 * v).exp(), b * (-r2 * v).exp());
            let pressure = first + second + c * v.powf(-1.0 - w);
            let energy = first / r1 + second / r2 + c / w * v.powf(-w);
            assert_relative_eq!(law.pressure(v, energy), pressure, max_relative = 1e-12);
            // Sound speed along the isentrope: rho0 c^2 = -V^2 dp/dV.
            let fall = r1 * first + r2 * second + (1.0 + w) * c * v.powf(-2.0 - w);
            assert_relative_eq!(law.speed_squared(v, energy), v * v * fall / 1630.0, max_relative = 1e-12);
        }
    }
}

#[test]
fn products_expand_along_the_isentrope() {
    // Expansion from constant-volume burn, e = E0 at V = 1, to V = e^2, by the trapezoidal rule of the energy:
    // second order.
    let (a, b, r1, r2, w) = (371.2e9_f64, 3.21e9_f64, 4.15_f64, 0.95_f64, 0.30_f64);
    let c = w * (6.993e9 - a * (-r1).exp() / r1 - b * (-r2).exp() / r2);
    let law = Fluid::new(Jwl::<f64>::tnt());
    let error = |steps: usize| {
        let step = Step { dt: 1.0 / steps as f64, steps };
        let table = run(&law, &Path::Isotropic { rate: 2.0 }, step).unwrap();
        let v = table.column("volume_ratio").unwrap()[steps];
        let pressure = a * (-r1 * v).exp() + b * (-r2 * v).exp() + c * v.powf(-1.0 - w);
        (-table.rows[steps].stress.0[0] / pressure - 1.0).abs()
    };
    let (coarse, fine) = (error(500), error(1000));
    assert!(fine < 1e-5 && fine < 0.27 * coarse, "{coarse:e} {fine:e}");
}

#[test]
fn chapman_jouguet_states() {
    // TNT reference: computed for this project by another program (book, "Material constants"), to the digits given
    // there.
    let tnt = chapman_jouguet(&Jwl::<f64>::tnt()).unwrap();
    assert_relative_eq!(tnt.speed, 6928.0, max_relative = 1e-4);
    assert_relative_eq!(tnt.pressure, 20.98e9, max_relative = 3e-4);
    assert_relative_eq!(tnt.volume_ratio, 0.7318, max_relative = 1e-4);
    assert_relative_eq!(tnt.particle_speed, 1858.0, max_relative = 3e-4);
    // Gas of constant gamma: D^2 = 2 (gamma^2 - 1) q, p = 2 (gamma - 1) rho0 q, V = gamma/(gamma + 1).
    let (gamma, density, heat) = (3.0_f64, 1600.0, 4e6);
    let gas = IdealGas::new(density, gamma, (gamma - 1.0) * density * heat).unwrap();
    let found = chapman_jouguet(&gas).unwrap();
    // Accuracy: the root is flat in the speed but not in the volume, where half the digits would suffice.
    assert_relative_eq!(found.speed, (2.0 * (gamma * gamma - 1.0) * heat).sqrt(), max_relative = 1e-12);
    assert_relative_eq!(found.pressure, 2.0 * (gamma - 1.0) * density * heat, max_relative = 1e-10);
    assert_relative_eq!(found.volume_ratio, gamma / (gamma + 1.0), max_relative = 1e-10);
    // Laws without detonation energy.
    assert!(chapman_jouguet(&MieGruneisen::<f64>::copper()).is_none());
    assert!(Explosive::<f64, _>::new(MieGruneisen::copper()).is_err());
}

#[test]
fn a_lit_point_burns_over_its_width() {
    let charge = Explosive::new(Jwl::<f64>::tnt()).unwrap().with_detonation_speed(6930.0).unwrap();
    let (dt, length) = (1e-8, 2e-3);
    let still = Kinematics { increment: Mat3::zero(), dt, length };
    let mut state = charge.lit_after(1e-7).unwrap();
    for k in 1..=80 {
        let new = charge.update(&still, &state);
        assert!(!new.fault.any());
        let behind = (f64::from(k) * dt - 1e-7) * 6930.0 / (1.5 * length);
        assert_relative_eq!(new.state.burn_fraction, behind.clamp(0.0, 1.0), epsilon = 1e-12);
        // Burn at rest without work: the pressure rises, the energy is constant.
        let full = Jwl::<f64>::tnt().pressure(1.0, 6.993e9);
        assert_relative_eq!(new.stress.0[0], -new.state.burn_fraction * full, max_relative = 1e-12);
        assert_eq!(charge.energy(&new.state), 0.0);
        assert!(charge.wave_speed(&new.state) >= if behind < 1.0 { 6930.0 } else { 0.0 });
        state = new.state;
    }
    assert_eq!(state.burn_fraction, 1.0);
    // A virgin point does not burn.
    let mut state = charge.virgin();
    for _ in 0..1000 {
        state = charge.update(&still, &state).state;
    }
    assert_eq!(state.burn_fraction, 0.0);
}

#[test]
fn compression_burns() {
    let charge = Explosive::new(Jwl::<f64>::tnt()).unwrap();
    let squeeze = |charge: &Explosive<f64>, strain: f64| {
        let increment = Mat3([[-strain, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
        charge.update(&Kinematics { increment, dt: 1e-8, length: 1e-3 }, &charge.virgin()).state
    };
    let volume = chapman_jouguet(&Jwl::<f64>::tnt()).unwrap().volume_ratio;
    assert_relative_eq!(squeeze(&charge, 0.1).burn_fraction, 0.1 / (1.0 - volume), max_relative = 1e-12);
    assert_eq!(squeeze(&charge, 0.3).burn_fraction, 1.0);
    assert_eq!(squeeze(&charge.without_compression_burn(), 0.3).burn_fraction, 0.0);
}

#[test]
fn detonation_waves_arrive_along_the_shortest_ray() {
    let wave = Detonation::new(7000.0).unwrap();
    assert_eq!(wave.arrival([0.0; 3]), None);
    let wave = wave
        .from_point([1.0, 0.0, 0.0], 1e-4)
        .unwrap()
        .from_line([0.0, -1.0, 0.0], [0.0, 1.0, 0.0], 0.0)
        .unwrap();
    assert_relative_eq!(wave.arrival([0.3, 0.5, 0.4]).unwrap(), 0.5 / 7000.0, max_relative = 1e-15);
    assert_relative_eq!(wave.arrival([0.0, 5.0, 3.0]).unwrap(), 5.0 / 7000.0, max_relative = 1e-15);
    assert_relative_eq!(wave.arrival([5.0, 0.0, 0.0]).unwrap(), 1e-4 + 4.0 / 7000.0, max_relative = 1e-15);
    let plane = Detonation::new(7000.0).unwrap().from_plane([0.0, 0.0, 2.0], [0.0, 3.0, 4.0], 1e-6).unwrap();
    assert_relative_eq!(plane.arrival([9.0, 5.0, 2.0]).unwrap(), 1e-6 + 3.0 / 7000.0, max_relative = 1e-15);
    assert!(Detonation::new(0.0).is_err());
    assert!(Detonation::new(1.0).unwrap().from_point([f64::NAN, 0.0, 0.0], 0.0).is_err());
    assert!(Detonation::new(1.0).unwrap().from_plane([0.0; 3], [0.0; 3], 0.0).is_err());
}

#[test]
fn a_gas_as_a_polynomial() {
    let gas = IdealGas::<f64>::air();
    let energy = gas.initial_energy();
    let law = Polynomial::new(1.225, [0.0; 4], [0.4, 0.4, 0.0], energy).unwrap();
    for j in [0.2, 0.9, 1.0, 3.0] {
        assert_relative_eq!(law.pressure(j, energy), gas.pressure(j, energy), max_relative = 1e-13);
        let (a, b) = (law.speed_squared(j, energy), gas.speed_squared(j, energy));
        assert_relative_eq!(a, b, max_relative = 1e-13);
    }
}

#[test]
fn polynomial_by_hand() {
    let law = Polynomial::new(2000.0, [1e6, 20e9, 30e9, 40e9], [1.5, 0.5, 0.25], 1e7).unwrap();
    // Test states: mu = 1/4 in compression, -1/5 in expansion.
    let compressed = 1e6 + 20e9 / 4.0 + 30e9 / 16.0 + 40e9 / 64.0 + (1.5 + 0.125 + 0.25 / 16.0) * 2e9;
    assert_relative_eq!(law.pressure(0.8, 2e9), compressed, max_relative = 1e-13);
    let expanded = 1e6 - 20e9 / 5.0 - 40e9 / 125.0 + (1.5 - 0.1) * 2e9;
    assert_relative_eq!(law.pressure(1.25, 2e9), expanded, max_relative = 1e-13);
    assert!(Polynomial::new(2000.0, [0.0, -1.0, 0.0, 0.0], [0.0; 3], 0.0).is_err());
}

#[test]
fn cubic_shock_line() {
    // Hugoniot: U_s = c0 + S1 u + S2 u^2/U_s + S3 u^3/U_s^2, p = rho0 U_s u, eta = u/U_s, e = p eta/2, for any
    // gamma.
    let (rho0, c0, s) = (8930.0, 3940.0, [1.2, 0.3, -0.15]);
    let shock = CubicShock::new(rho0, c0, s).unwrap();
    for (gamma, a) in [(1.96, 0.0), (1.96, 0.47), (1.96, 1.96)] {
        let law = Gruneisen::new(shock, gamma, a).unwrap();
        for u in [1.0, 100.0, 800.0, 2000.0] {
            // Shock speed by independent iteration.
            let mut speed: f64 = c0;
            for _ in 0..200 {
                let r = u / speed;
                speed = c0 + s[0] * u + s[1] * u * r + s[2] * u * r * r;
            }
            let (pressure, eta) = (rho0 * speed * u, u / speed);
            assert_relative_eq!(
                law.pressure(1.0 - eta, 0.5 * pressure * eta),
                pressure,
                max_relative = 1e-10
            );
        }
        // Gruneisen coefficient gamma(mu), off the Hugoniot.
        let j: f64 = 0.8;
        assert_relative_eq!(law.terms(j).thermal, gamma + a * (1.0 / j - 1.0), max_relative = 1e-13);
    }
    assert!(Gruneisen::new(shock, 1.0, 1.5).is_err());
    // Singular compression: zero of the denominator; the law is continued beyond four fifths of it.
    let limit: f64 = shock.singular();
    assert!((1.0 - limit * (1.2 + limit * (0.3 - 0.15 * limit))).abs() < 1e-12);
    let law = Gruneisen::new(shock, 1.97, 0.0).unwrap();
    assert_relative_eq!(law.smallest_volume_ratio(), 1.0 - 0.8 * limit, max_relative = 1e-12);
}

#[test]
fn a_straight_shock_line_is_the_plain_law() {
    let plain = MieGruneisen::new(8930.0, 3940.0, 1.49, 1.96).unwrap().with_correction(0.47).unwrap();
    let cubic =
        Gruneisen::new(CubicShock::new(8930.0, 3940.0, [1.49, 0.0, 0.0]).unwrap(), 1.96, 0.47).unwrap();
    for j in [0.6, 0.8, 0.99, 1.05, 1.2] {
        for e in [0.0, 2e10] {
            assert_relative_eq!(cubic.pressure(j, e), plain.pressure(j, e), max_relative = 1e-12);
            assert_relative_eq!(cubic.speed_squared(j, e), plain.speed_squared(j, e), max_relative = 1e-12);
        }
    }
    assert_relative_eq!(cubic.smallest_volume_ratio(), plain.smallest_volume_ratio(), max_relative = 1e-9);
}

#[test]
fn polynomial_hugoniot_is_the_series_of_the_shock_line() {
    let (rho0, c0, s) = (2700.0, 5386.0, 1.339);
    let series = PolynomialHugoniot::of_shock(rho0, c0, s).unwrap();
    let bulk = rho0 * c0 * c0;
    for mu in [0.01_f64, 0.1] {
        let exact = bulk * mu * (1.0 + mu) / (1.0 - (s - 1.0) * mu).powi(2);
        let cubic = bulk * (mu + (2.0 * s - 1.0) * mu * mu + (s - 1.0) * (3.0 * s - 1.0) * mu.powi(3));
        assert_relative_eq!(series.curve(mu).pressure, cubic, max_relative = 1e-13);
        // Error bound, the next term of the series: (s - 1)^2 (4 s - 1) mu^4.
        assert!((series.curve(mu).pressure - exact).abs() < 1.5 * bulk * 0.115 * 4.36 * mu.powi(4));
    }
    // Pressure on the cold curve, on the Hugoniot and in tension.
    let law = Gruneisen::new(series, 1.99, 0.0).unwrap();
    let (mu, j) = (0.1_f64, 1.0 / 1.1);
    let shocked = series.curve(mu).pressure;
    assert_relative_eq!(law.pressure(j, 0.5 * shocked * (1.0 - j)), shocked, max_relative = 1e-12);
    assert_relative_eq!(law.pressure(1.25, 1e8), -0.2 * bulk + 1.99e8, max_relative = 1e-12);
}

mod battery {
    use mpm_materials::conformance::{Options, eos};
    use mpm_materials::*;

    // Explosives. A burning charge does not stay virgin and yields work in a cycle: only the other checks apply.
    conformance_suite!(
        charge_without_fire,
        Explosive::new(Jwl::tnt()).unwrap().without_compression_burn(),
        Options::strain(0.1)
    );
    conformance_suite!(
        products,
        Fluid::new(Jwl::tnt()),
        Options { stress_free: false, ..Options::strain(0.2) };
        single = Fluid::new(Jwl::<f32>::tnt())
    );

    #[test]
    fn burning_charges_conform() {
        use mpm_materials::conformance as held;
        let options = Options { steps: 1600, ..Options::strain(0.2) };
        let lit = Explosive::new(Jwl::tnt()).unwrap().all_lit_after(3e-7).unwrap();
        let viscous = lit.with_bulk_viscosity(0.06, 1.5).unwrap();
        for verdict in [
            held::rest(&lit, &options),
            held::isotropy(&lit, &options),
            held::objectivity(&lit, &Options { steps: 400, ..options }),
            held::work(&lit, &options),
            held::work(&viscous, &options),
            held::purity(&viscous, &options),
            held::lanes(&lit, &options),
            held::lanes(&viscous, &options),
            held::wave_speed(&lit, &options),
            held::inversion(&lit, &options),
            held::not_a_number(&lit, &options),
            held::not_a_number(&viscous, &options),
        ] {
            verdict.unwrap();
        }
    }

    #[test]
    fn equations_of_state_of_shocked_matter() {
        eos(&Jwl::tnt(), 0.4..10.0, 7e9).unwrap();
        let shock = CubicShock::new(8930.0, 3940.0, [1.2, 0.3, -0.15]).unwrap();
        eos(&Gruneisen::new(shock, 1.96, 0.47).unwrap(), 0.6..1.2, 3e10).unwrap();
        let series = PolynomialHugoniot::of_shock(2700.0, 5386.0, 1.339).unwrap();
        eos(&Gruneisen::new(series, 1.99, 1.99).unwrap(), 0.7..1.2, 3e10).unwrap();
        eos(&Polynomial::new(2000.0, [0.0, 20e9, 30e9, 40e9], [1.5, 0.5, 0.25], 0.0).unwrap(), 0.7..1.3, 1e9)
            .unwrap();
    }
}
