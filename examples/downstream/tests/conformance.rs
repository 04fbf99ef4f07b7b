//! Conformance tests of the framework, one line each.

use downstream::{StandardLinearSolid, TentAveragedHat};
use impactite::materials::conformance::{
    Options, cycles, inversion, isotropy, lanes, not_a_number, objectivity, purity, virgin, wave_speed, work,
};
use impactite::materials::conformance_suite;
use impactite::mpm::{Apic, Flip, FullSpace, Method, Musl, PlaneStrain, Usl, conforms};

fn rubber(relaxation_time: f64) -> StandardLinearSolid {
    StandardLinearSolid::new(1000.0, 2.0e7, 1.0e6, 2.0e6, relaxation_time).expect("constants")
}

// A loading leg lasts 1 s, a step 2.5 ms. All tests apply to a material that relaxes within a step.
conformance_suite!(relaxed, rubber(1.0e-4), Options { duration: 1.0, ..Options::strain(0.01) });

/// Run all tests but `rest`: a material with a longer relaxation time changes while at rest.
fn relaxing(relaxation_time: f64) {
    let (law, options) = (rubber(relaxation_time), Options { duration: 1.0, ..Options::strain(0.01) });
    for property in
        [virgin, isotropy, objectivity, work, cycles, purity, lanes, wave_speed, inversion, not_a_number]
    {
        if let Err(message) = property(&law, &options) {
            panic!("{message}");
        }
    }
}
#[test]
fn relaxing_on_the_way() {
    relaxing(0.3);
}
#[test]
fn nearly_elastic() {
    relaxing(100.0);
}

conforms! {
    tent_2d: smooth::<_, 2>(&TentAveragedHat);
    tent_3d: affine_shape::<_, 3>(&TentAveragedHat);
    tent_apic: method::<_, 2>(Method::new(TentAveragedHat, Apic, Usl, PlaneStrain).compiled());
    tent_flip: method::<_, 3>(Method::new(TentAveragedHat, Flip, Musl, FullSpace).compiled());
}

/// Stress relaxation at fixed shear: the overstress decays by a factor of e in a relaxation time.
#[test]
fn stress_relaxes() {
    use impactite::materials::{Constitutive, Kinematics, Mat3};
    let law = rubber(0.5);
    let step = |shear: f64| Kinematics {
        increment: Mat3([[0.0, shear, 0.0], [0.0; 3], [0.0; 3]]),
        dt: 1.0e-3,
        length: 1.0,
    };
    let mut state = law.update(&step(1.0e-4), &law.virgin()).state;
    let start = law.stress(&state).at(0, 1);
    for _ in 0..500 {
        state = law.update(&step(0.0), &state).state;
    }
    let slow = 1.0e6 * 1.0e-4;
    let expected = slow + (start - slow) * (-1.0f64).exp();
    let found = law.stress(&state).at(0, 1);
    assert!((found / expected - 1.0).abs() < 1.0e-6, "{found} against {expected}");
}
