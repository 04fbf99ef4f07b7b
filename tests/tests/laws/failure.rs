//! Failure criteria and post-failure responses against closed forms.

use approx::assert_relative_eq;
use mpm_materials::driver::{Path, Step, run};
use mpm_materials::failure::Observed;
use mpm_materials::*;

fn stretched(axial: f64, lateral: f64) -> Mat3<f64> {
    Mat3([[axial, 0.0, 0.0], [0.0, lateral, 0.0], [0.0, 0.0, lateral]])
}

fn seen(pressure: f64, increment: f64, dt: f64) -> Observed<f64> {
    Observed {
        // Von Mises stress 600 MPa.
        deviator: Sym3([400e6, -200e6, -200e6, 0.0, 0.0, 0.0]),
        pressure,
        plastic_strain: 0.0,
        plastic_strain_increment: increment,
        homologous_temperature: 0.25,
        damage: 0.0,
        dt,
        length: 1e-3,
    }
}

#[test]
fn johnson_cook_failure_strain() {
    let law = JohnsonCookDamage::new([0.05, 3.44, -2.12, 0.002, 0.61], 2.0).unwrap();
    for (pressure, rate) in [(0.0, 0.1), (-300e6, 1.0), (-900e6, 1e4), (600e6, 1e6)] {
        let s = -pressure / 600e6;
        let fast = 1.0 + 0.002 * f64::max(rate / 2.0, 1.0).ln();
        let strain = (0.05 + 3.44 * (-2.12 * s).exp()) * fast * (1.0 + 0.61 * 0.25);
        let increment = 1e-3;
        let new = law.judge(&seen(pressure, increment, increment / rate), &law.intact());
        assert_relative_eq!(new.failure_damage, increment / strain, max_relative = 1e-12);
        let broken = law.judge(&seen(pressure, 1.01 * strain, 1.01 * strain / rate), &law.intact());
        assert!(law.failed(&broken, 0.0) && broken.failure_damage == 1.0);
        assert!(
            !law.failed(&law.judge(&seen(pressure, 0.99 * strain, 0.99 * strain / rate), &law.intact()), 0.0)
        );
    }
    // 6061-T6 in strong tension: the fit is negative there, and the lower limit applies.
    let soft = JohnsonCookDamage::<f64>::aluminium_6061();
    assert_eq!(soft.failure_strain(1.5, 1.0, 0.0), 1e-6);
    assert_relative_eq!(soft.failure_strain(0.0, 1.0, 0.5), 0.68 * 1.8, max_relative = 1e-12);
    assert_eq!(soft.with_smallest_strain(0.01).unwrap().failure_strain(1.5, 1.0, 0.0), 0.01);
    // No plastic flow and no stress: no damage.
    let mut nothing = seen(0.0, 0.0, 1e-9);
    nothing.deviator = Sym3::zero();
    assert_eq!(soft.judge(&nothing, &soft.intact()).failure_damage, 0.0);
}

#[test]
fn johnson_cook_damage_in_a_tension_test() {
    // Uniaxial stress has triaxiality 1/3: damage is plastic strain over a constant.
    let strain = 0.05 + 0.4 * f64::exp(-1.5 / 3.0);
    let law = Solid::new(J2::linear(26e9, 300e6, 0.0).unwrap(), LogarithmicBulk::new(2700.0, 70e9).unwrap())
        .with_failure(JohnsonCookDamage::new([0.05, 0.4, -1.5, 0.0, 0.0], 1.0).unwrap());
    let table = run(&law, &Path::UniaxialStress { rate: 1.0 }, Step { dt: 1e-4, steps: 2000 }).unwrap();
    let damage = table.column("failure_damage").unwrap();
    let plastic = table.column("plastic_strain").unwrap();
    for k in 0..=2000 {
        // Tolerance: the driver iterates the lateral stress to zero.
        assert_relative_eq!(damage[k], plastic[k] / strain, max_relative = 1e-8, epsilon = 1e-12);
    }
    assert!(damage[2000] > 0.5 && damage[2000] < 1.0);
}

#[test]
fn crack_bands_open_alike() {
    // Crack band: the opening h eps_f at failure equals that of the reference size for every cell size.
    for size in [0.5e-3, 1e-3, 4e-3] {
        let law = JohnsonCookDamage::new([0.2, 0.0, 0.0, 0.0, 0.0], 1.0)
            .unwrap()
            .with_localisation(CrackBand::new(2e-3).unwrap());
        let mut observed = seen(0.0, 1e-3, 1e-6);
        observed.length = size;
        let grown = law.judge(&observed, &law.intact()).failure_damage;
        let opening = size * 1e-3 / grown;
        assert_relative_eq!(opening, 0.2 * 2e-3, max_relative = 1e-13);
    }
    assert!(CrackBand::new(0.0).is_err());
}

#[test]
fn square_pulses_break_after_their_time() {
    // Loading by one elastic step, then rest: constant sigma_1.
    let (bulk, shear) = (70e9, 26e9);
    for (exponent, size) in [(1.0, 1e-3_f64), (2.0, 1e-3), (2.5, 2e-3)] {
        // Strain increment of a step at its middle.
        let stress = bulk * (1.0 + size).ln() + 4.0 / 3.0 * shear * size / (1.0 + 0.5 * size);
        let (threshold, time) = (60e6, 1e-6);
        let law = Solid::new(Elastic::new(shear).unwrap(), LogarithmicBulk::new(2700.0, bulk).unwrap())
            .with_failure(TulerButcher::new(threshold, exponent, time).unwrap());
        let dt = 1e-10;
        let step = |increment| Kinematics { increment, dt, length: 1e-3 };
        let mut state = law.update(&step(stretched(size, 0.0)), &law.virgin()).state;
        let expected = time / (stress / threshold - 1.0).powf(exponent);
        let mut elapsed = dt;
        while !law.failed(&state) {
            let share = elapsed / expected * time;
            assert_relative_eq!(state.failure.overstress_time, share, max_relative = 1e-9);
            state = law.update(&step(Mat3::zero()), &state).state;
            elapsed += dt;
            assert!(elapsed < 2.0 * expected);
        }
        assert!((elapsed - expected).abs() <= 1.001 * dt);
        assert_eq!(law.stress(&state).0, [0.0; 6]);
    }
}

type Metal<F> = Solid<J2<f64>, MieGruneisen<f64>, F>;

/// Pull a solid that fails at 1 GPa of mean tension beyond failure in one direction. Returns the law, the stress
/// after each leg, and energy and stress work.
fn pulled<F: Failure<f64>>(failure: F) -> (Metal<F>, Vec<Sym3<f64>>, [f64; 2]) {
    let law = Solid::new(J2::linear(26e9, 300e6, 0.0).unwrap(), MieGruneisen::aluminium_6061());
    let law = law.with_failure(failure);
    let (mut state, mut stresses, mut work) = (law.virgin(), vec![], 0.0);
    let step = |increment| Kinematics { increment, dt: 1e-9, length: 1e-3 };
    let legs = [stretched(1e-5, 0.0), Mat3([[0.0, 1e-5, 0.0], [0.0; 3], [0.0; 3]]), stretched(-2e-5, 0.0)];
    for leg in legs {
        for _ in 0..2000 {
            let new = law.update(&step(leg), &state);
            assert!(!new.fault.any());
            let (a, b) = (law.stress(&state) * state.volume_ratio, new.stress * new.state.volume_ratio);
            work += (a + b).dot(&leg.symmetric()) * 0.5;
            state = new.state;
        }
        stresses.push(law.stress(&state));
    }
    assert!(law.failed(&state));
    let energy = law.energy(&state);
    (law, stresses, [energy, work])
}

#[test]
fn what_remains_is_a_choice() {
    let spall = TensilePressure::new(1e9).unwrap();
    // Stresses after the pull, after a shear, and after a compression to 0.98 of the volume.
    let (_, rubble, books) = pulled(spall);
    assert_eq!(rubble[0].0, [0.0; 6]);
    assert_eq!(rubble[1].0, [0.0; 6]);
    assert!(rubble[2].mean() < -1e9 && rubble[2].deviator().equivalent() < 1.0);
    // Tolerance: stress work by the trapezoidal rule is of first order in the step of failure.
    assert_relative_eq!(books[0], books[1], max_relative = 2e-3);

    let (_, cracked, books) = pulled(LosesTension(spall));
    assert!(cracked[0].mean().abs() < 1.0);
    assert_relative_eq!(cracked[1].deviator().equivalent(), 300e6, max_relative = 1e-9);
    assert!(cracked[2].mean() < -1e9);
    assert_relative_eq!(books[0], books[1], max_relative = 2e-3);

    let (_, molten, books) = pulled(LosesShear(spall));
    assert!(molten[0].mean() > 1e9 && molten[0].deviator().equivalent() < 1.0);
    assert!(molten[2].mean() < -1e9 && molten[2].deviator().equivalent() < 1.0);
    assert_relative_eq!(books[0], books[1], max_relative = 2e-3);

    let (law, gone, books) = pulled(Removed(spall));
    assert!(gone.iter().all(|s| s.0 == [0.0; 6]));
    assert_relative_eq!(books[0], books[1], max_relative = 2e-3);
    // A removed point no longer breaks under any deformation and keeps its energy.
    let mut state = law.virgin();
    state.failure = law.failure().0.judge(&seen(-2e9, 0.0, 1.0), &state.failure);
    state.energy = 5e6;
    let inside_out = Kinematics { increment: stretched(-1.5, 0.0), dt: 1e-9, length: 1e-3 };
    let new = law.update(&inside_out, &state);
    assert!(!new.fault.any());
    assert_eq!((new.state.energy, new.state.volume_ratio), (5e6, 1.0));
}

#[test]
fn two_criteria_fail_where_either_does() {
    let both = (PlasticStrainLimit::new(0.5).unwrap(), TensilePressure::new(1e9).unwrap());
    let intact = Failure::<f64>::intact(&both);
    assert!(!both.failed(&intact, 0.4) && both.failed(&intact, 0.6));
    assert!(both.failed(&both.judge(&seen(-2e9, 0.0, 1.0), &intact), 0.0));
    const fn remains<F: Failure<f64>>() -> Remains {
        F::REMAINS
    }
    type Spall = TensilePressure<f64>;
    assert_eq!(remains::<(Spall, Spall)>(), Remains::Compression);
    assert_eq!(remains::<(LosesShear<Spall>, LosesShear<Spall>)>(), Remains::Pressure);
    assert_eq!(remains::<(LosesTension<Spall>, LosesTension<Spall>)>(), Remains::CompressionAndShear);
    assert_eq!(remains::<(LosesTension<Spall>, LosesShear<Spall>)>(), Remains::Compression);
    assert_eq!(remains::<(LosesTension<Spall>, Removed<Spall>)>(), Remains::Nothing);
}

#[test]
fn bad_failure_constants_are_refused() {
    assert!(JohnsonCookDamage::new([0.0, -1.0, 0.0, 0.0, 0.0], 1.0).is_err());
    assert!(JohnsonCookDamage::new([f64::NAN, 1.0, 0.0, 0.0, 0.0], 1.0).is_err());
    assert!(JohnsonCookDamage::<f64>::steel_4340().with_smallest_strain(0.0).is_err());
    assert!(TulerButcher::new(1e9, 0.0, 1e-6).is_err());
    assert!(DamageLimit::new(1.1).is_err());
    assert!(CohesiveSpall::new(0.0, 1e-5).is_err() && CohesiveSpall::new(1e9, f64::NAN).is_err());
    assert!(CohesiveSpall::of_work(1e9, -1.0).is_err());
}

/// Expand a law isotropically in cells of this size, m, until it fails; return opening, m, and tension, Pa, of each
/// step, and the energy per crack area, J/m^2.
fn opened<E: Eos<f64>>(law: &Solid<J2<f64>, E, CohesiveSpall<f64>>, size: f64) -> (Vec<[f64; 2]>, f64) {
    let step = |size| Kinematics { increment: Mat3::identity() * 1e-6, dt: 1e-9, length: size };
    let (mut state, mut curve) = (law.virgin(), vec![]);
    while !law.failed(&state) {
        let new = law.update(&step(size), &state);
        assert!(!new.fault.any() && curve.len() < 1_000_000);
        state = new.state;
        curve.push([size * state.failure.crack_volume, new.stress.mean()]);
    }
    (curve, size * law.energy(&state))
}

#[test]
fn cracks_take_their_work_whatever_the_cell() {
    let (strength, work) = (1e9, 5e3);
    let spall = CohesiveSpall::of_work(strength, work).unwrap();
    assert_relative_eq!(spall.opening(), 1e-5, max_relative = 1e-15);
    let j2 = J2::linear(26e9, 300e6, 0.0).unwrap();
    // Law without thermal pressure: heat would expand the material under tension.
    let law = Solid::new(j2, LogarithmicBulk::new(2700.0, 74e9).unwrap()).with_failure(spall);
    for size in [1e-5, 1e-4, 5e-4] {
        let (curve, taken) = opened(&law, size);
        let bearing = curve[..curve.len() - 1].iter().copied();
        let (closed, open): (Vec<[f64; 2]>, Vec<_>) = bearing.partition(|c| c[0] == 0.0);
        assert!(closed.len() > 100 && open.len() > 100);
        for [opening, tension] in open {
            assert_relative_eq!(tension, strength * (1.0 - opening / 1e-5), epsilon = 1e-10 * strength);
        }
        // Energy balance: all stored energy was returned, and the crack surface dissipated the rest, by the trapezoidal
        // rule; the loss in the last step did no work.
        assert_relative_eq!(taken, work, max_relative = 1e-3);
        assert_eq!(curve[curve.len() - 1], [0.0, 0.0]);
    }
    // With thermal pressure the tension is the same.
    let hot = Solid::new(j2, MieGruneisen::aluminium_6061()).with_failure(spall);
    let (curve, _) = opened(&hot, 1e-4);
    for [opening, tension] in curve[..curve.len() - 1].iter().filter(|c| c[0] > 0.0) {
        assert_relative_eq!(*tension, strength * (1.0 - opening / 1e-5), epsilon = 1e-10 * strength);
    }
    // Limit of the cell size, stiffness over strength times the opening: 74e9/1e9 * 1e-5 m. Beyond it failure is
    // abrupt.
    let (curve, taken) = opened(&law, 1e-3);
    assert!(curve.iter().all(|c| c[0] == 0.0));
    assert!(taken > 1.2 * work, "{taken}");
}

#[test]
fn closing_cracks_go_back_to_the_origin() {
    let spall = CohesiveSpall::new(1e9, 1e-5).unwrap();
    let solid = Solid::new(J2::linear(26e9, 300e6, 0.0).unwrap(), MieGruneisen::aluminium_6061());
    let law = solid.with_failure((spall, PlasticStrainLimit::new(2.0).unwrap()));
    let mut state = law.virgin();
    let mut go = |change: f64, until: &dyn Fn(f64, f64) -> bool| {
        let step = Kinematics { increment: Mat3::identity() * change, dt: 1e-9, length: 1e-4 };
        let mut curve: Vec<[f64; 2]> = vec![];
        while !curve.last().is_some_and(|&[v, t]| until(v, t)) {
            assert!(curve.len() < 100_000);
            let new = law.update(&step, &state);
            assert!(!new.fault.any() && !law.failed(&new.state));
            state = new.state;
            curve.push([1e-4 * state.failure.0.crack_volume, new.stress.mean()]);
        }
        (curve, state)
    };
    let (_, wide) = go(1e-6, &|opening, _| opening > 0.6e-5);
    let damage = wide.failure.0.crack_damage;
    let slope = 1e9 * (1.0 - damage) / (damage * 1e-5);
    let on_line = |curve: &[[f64; 2]]| {
        for [opening, tension] in curve.iter().filter(|c| c[0] > 0.0 && c[0] < damage * 1e-5) {
            assert_relative_eq!(*tension, slope * opening, epsilon = 1e-10 * 1e9);
        }
    };
    let (curve, shut) = go(-1e-6, &|_, tension| tension < -0.5e9);
    on_line(&curve);
    assert_eq!((shut.failure.0.crack_volume, shut.failure.0.crack_damage), (0.0, damage));
    // Closed crack: equal to the intact solid except for the heat of the crack.
    let whole = solid.eos().pressure(shut.volume_ratio, shut.energy);
    assert_relative_eq!(-shut.stress.mean(), whole, max_relative = 1e-12);
    let (curve, state) = go(1e-6, &|opening, _| opening > 0.7e-5);
    on_line(&curve);
    let again = curve[curve.len() - 1];
    assert_relative_eq!(again[1], 1e9 * (1.0 - again[0] / 1e-5), max_relative = 1e-9);
    assert!(state.failure.0.crack_damage > damage);
}

mod battery {
    use mpm_materials::conformance::{self as held, Options};
    use mpm_materials::*;

    fn metal(strain: f64) -> Options {
        Options { wave_tolerance: 0.05, ..Options::strain(strain) }
    }
    type Plain = Solid<JohnsonCook<f64, Logarithmic<f64>, Adiabatic<f64>>, MieGruneisen<f64>>;
    fn aluminium() -> Plain {
        Solid::new(JohnsonCook::aluminium_6061(), MieGruneisen::aluminium_6061())
    }

    conformance_suite!(
        damage_not_reached,
        aluminium().with_failure(JohnsonCookDamage::new([2.0, 1.45, -0.47, 0.01, 1.6], 1.0).unwrap()),
        metal(0.05),
        yields
    );
    conformance_suite!(
        time_not_reached,
        aluminium().with_failure(TulerButcher::new(0.5e9, 2.0, 1e3).unwrap()),
        metal(0.05),
        yields
    );
    conformance_suite!(
        removed_not_reached,
        aluminium().with_failure(Removed(PlasticStrainLimit::new(3.0).unwrap())),
        metal(0.05),
        yields
    );

    conformance_suite!(
        crack_not_opened,
        aluminium().with_failure(CohesiveSpall::new(20e9, 1e-5).unwrap()),
        metal(0.05),
        yields
    );

    #[test]
    fn failed_points_stay_failed() {
        let options = metal(0.05);
        let damage = aluminium().with_failure(JohnsonCookDamage::aluminium_6061());
        let small = JohnsonCookDamage::new([0.02, 0.01, -0.47, 0.01, 0.0], 1.0).unwrap();
        let damage_soon = aluminium().with_failure(small);
        let band = small.with_localisation(CrackBand::new(1.5e-3).unwrap());
        let banded = aluminium().with_failure(band);
        let timed = aluminium().with_failure(TulerButcher::new(0.5e9, 2.0, 1e-7).unwrap());
        held::not_a_number(&damage, &options).unwrap();
        held::fails(&damage_soon, &options).unwrap();
        held::lanes(&damage_soon, &options).unwrap();
        held::fails(&banded, &options).unwrap();
        held::fails(&timed, &options).unwrap();
        held::lanes(&timed, &options).unwrap();
        held::not_a_number(&timed, &options).unwrap();
        let crack = CohesiveSpall::new(0.5e9, 1e-7).unwrap();
        held::fails(&aluminium().with_failure(crack), &options).unwrap();
        held::lanes(&aluminium().with_failure(crack), &options).unwrap();
        held::not_a_number(&aluminium().with_failure(crack), &options).unwrap();
        let slow = CohesiveSpall::new(0.5e9, 1e-3).unwrap();
        held::lanes(&aluminium().with_failure((small, slow)), &options).unwrap();
        let pair = (small, TensilePressure::new(1.2e9).unwrap());
        held::fails(&aluminium().with_failure(pair), &options).unwrap();
        held::lanes(&aluminium().with_failure(Removed(pair)), &options).unwrap();
        held::not_a_number(&aluminium().with_failure(LosesTension(pair)), &options).unwrap();
    }

    #[test]
    fn memory_of_failure() {
        let length = |n: usize, expected: usize| assert_eq!(n, expected);
        length(held::state_length(&aluminium().with_failure(JohnsonCookDamage::aluminium_6061())), 11);
        length(held::state_length(&aluminium().with_failure(CohesiveSpall::new(1e9, 1e-5).unwrap())), 12);
        length(
            held::state_length(&aluminium().with_failure(Removed(PlasticStrainLimit::new(3.0).unwrap()))),
            10,
        );
    }
}

#[test]
fn debris_that_flies_apart_has_no_shear_wave() {
    let whole =
        Solid::new(J2::linear(26e9, 300e6, 0.0).unwrap(), LogarithmicBulk::new(2700.0, 70e9).unwrap());
    let law = whole.with_failure(PlasticStrainLimit::new(0.1).unwrap());
    let mut state = law.virgin();
    assert_relative_eq!(law.wave_speed(&state), whole.wave_speed(&whole.virgin()), max_relative = 1e-15);
    state.strength.plastic_strain = 0.2;
    state.volume_ratio = 50.0;
    let bulk = whole.eos().speed_squared(50.0, 0.0).max(0.0).sqrt();
    assert_relative_eq!(law.wave_speed(&state), bulk, max_relative = 1e-15);
    // Only points without shear stiffness slow down: a cracked point keeps its wave speed.
    let cracked = whole.with_failure(LosesTension(PlasticStrainLimit::new(0.1).unwrap()));
    assert!(cracked.wave_speed(&state) > bulk);
}
