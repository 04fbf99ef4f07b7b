//! Differentials of laws against differences of trials and closed forms.

use mpm_materials::strength::VoceHardening;
use mpm_materials::*;

/// Random numbers in \[-1, 1\].
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn matrix(&mut self, size: f64) -> Mat3<f64> {
        Mat3(std::array::from_fn(|_| std::array::from_fn(|_| size * self.next())))
    }
}

/// Compare differentials with central differences along random paths of steps of `size`. Steps whose differences of two sizes do
/// not agree are at a kink; they are few.
fn check<C: Constitutive<f64>>(law: &C, size: f64) {
    let (mut random, mut kinks, mut all) = (Random(7), 0, 0);
    for _ in 0..6 {
        let mut state = law.virgin();
        let drift = random.matrix(size);
        for _ in 0..25 {
            let step = |increment| Kinematics { increment, dt: 1e-6, length: 1e-3 };
            let increment = drift + random.matrix(0.3 * size);
            let direction = random.matrix(1.0);
            let difference = |h: f64| {
                let at = |h: f64| law.trial(&step(increment + direction * h), &state).expect("a trial");
                let (up, down) = (at(h), at(-h));
                Sym3::<f64>(std::array::from_fn(|k| (up.0[k] - down.0[k]) / (2.0 * h)))
            };
            let (coarse, fine) = (difference(1e-3 * size), difference(5e-4 * size));
            let scale = (0..6).fold(0.0_f64, |most, k| most.max(fine.0[k].abs())).max(1e-6);
            let apart =
                |a: &Sym3<f64>, b: &Sym3<f64>| (0..6).map(|k| (a.0[k] - b.0[k]).abs()).fold(0.0, f64::max);
            let exact = law.differential(&step(increment), &state, &direction).expect("a differential");
            all += 1;
            if apart(&coarse, &fine) > 1e-4 * scale {
                kinks += 1;
            } else {
                let off = apart(&exact.change, &fine);
                assert!(off < 1e-3 * scale, "{}: {:?} of {fine:?}", law.name(), exact.change);
            }
            let new = law.update(&step(increment), &state);
            assert_eq!(exact.stress, new.stress, "{}: the trial is the step", law.name());
            state = new.state;
        }
    }
    assert!(10 * kinks <= 3 * all, "{}: {kinks} of {all} at kinks", law.name());
}

#[test]
fn differentials_are_those_of_trials() -> Result<(), ParameterError> {
    check(&LinearElastic::new(7850.0, Moduli::young_poisson(206e9, 0.3)?)?, 1e-3);
    check(&NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.4)?)?, 1e-2);
    check(&library::copper_taylor::<f64>(), 1e-3);
    check(&library::copper_ofhc::<f64>(), 1e-3);
    check(&library::copper_steinberg::<f64>(), 1e-3);
    check(&library::weldox_460_e::<f64>(), 1e-3);
    check(&library::slope_soil::<f64>(), 1e-4);
    let voce = JohnsonCook::from_hardening(26e9, VoceHardening::new(270e6, 100e6, 12.0)?)?;
    check(&Solid::new(voce.with_rate(CowperSymonds::new(40.0, 5.0)?), MieGruneisen::aluminium_6061()), 1e-3);
    let viscous = Fluid::new(Tait::new(1000.0, 1500.0)?).with_shear_viscosity(Newtonian::new(1e-3)?);
    check(&viscous.with_bulk_viscosity(0.06, 1.5)?, 1e-4);
    Ok(())
}

#[test]
fn tangents_at_rest_are_moduli_and_wave_speeds() -> Result<(), Box<dyn std::error::Error>> {
    let rest = Kinematics { increment: Mat3::zero(), dt: 1e-6, length: 1e-3 };
    let (young, nu) = (206e9, 0.3);
    let (lambda, shear) = (young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu)));
    let steel = LinearElastic::new(7850.0, Moduli::young_poisson(young, nu)?)?;
    let tangent: [[f64; 9]; 6] = Tangent::<f64>::tangent(&steel, &rest, &steel.virgin())?;
    for row in 0..3 {
        for column in 0..3 {
            let due = if row == column { lambda + 2.0 * shear } else { lambda };
            assert!((tangent[row][4 * column] - due).abs() < 1e-12 * young);
        }
    }
    // Shear xy from dv_x/dy and dv_y/dx.
    assert!((tangent[5][1] - shear).abs() < 1e-12 * young && (tangent[5][3] - shear).abs() < 1e-12 * young);

    fn modulus<C: Constitutive<f64>>(law: &C) -> Result<(f64, f64), NoDifferential> {
        let rest = Kinematics { increment: Mat3::zero(), dt: 1e-6, length: 1e-3 };
        let speed = law.wave_speed(&law.virgin());
        Ok((law.tangent(&rest, &law.virgin())?[0][0], law.density() * speed * speed))
    }
    let pairs = [
        modulus(&library::copper_ofhc())?,
        modulus(&library::tungsten_alloy())?,
        modulus(&library::weldox_460_e())?,
        modulus(&library::dry_sand())?,
        modulus(&library::water())?,
    ];
    for (tangent, due) in pairs {
        assert!((tangent / due - 1.0).abs() < 1e-9, "{tangent} and {due} Pa");
    }
    Ok(())
}

#[test]
fn a_law_of_single_points_and_a_broken_step_have_no_differential() -> Result<(), ParameterError> {
    let sand = Ground::new(MohrCoulomb::new(1800.0, Moduli::young_poisson(20e6, 0.3)?, 0.6, 1e3, 0.0)?);
    let step = Kinematics { increment: Random(3).matrix(1e-2), dt: 1e-6, length: 1e-3 };
    let found = sand.differential(&step, &sand.virgin(), &Mat3::identity());
    assert_eq!(found, Err(NoDifferential::Pointwise));
    let copper = library::copper_ofhc::<f64>();
    let inverted = Kinematics { increment: Mat3::identity() * -1.5, dt: 1e-6, length: 1e-3 };
    assert!(copper.trial(&inverted, &copper.virgin()).is_err());
    let found = copper.differential(&inverted, &copper.virgin(), &Mat3::identity());
    assert!(matches!(found, Err(NoDifferential::Broken(_))), "{found:?}");
    Ok(())
}
