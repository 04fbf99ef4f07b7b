//! Bitwise equality of scenes with method and law selected by name and scenes composed as types.

use downstream::choose::{self, Failure, LAWS, METHODS};
use downstream::{StandardLinearSolid, TentAveragedHat};
use impactite::materials::{Constitutive, library};
use impactite::mpm::{
    Apic, Blend, CpGimp, Flip, IntoKernels, Linear, Method, Mls, Mpm, Musl, PlaneStrain, QuadraticBSpline,
    Usl,
};

const STEPS: usize = 40;

fn fingerprint(scene: Result<Mpm<2>, Failure>) -> u64 {
    let mut mpm = scene.expect("a scene");
    for _ in 0..STEPS {
        mpm.step().expect("a step");
    }
    choose::fingerprint(&mpm)
}

/// Compute the fingerprints of all laws, as types, with one method type.
fn with_each_law(method: impl IntoKernels<f64, 2> + Copy) -> Vec<u64> {
    let rubber = StandardLinearSolid::new(1000.0, 2.0e7, 1.0e6, 2.0e6, 1.0e-3).expect("constants");
    vec![
        fingerprint(choose::scene(method, choose::linear_elastic().expect("constants"))),
        fingerprint(choose::scene(method, choose::neo_hookean().expect("constants"))),
        fingerprint(choose::scene(method, library::copper_taylor())),
        fingerprint(choose::scene(method, library::aluminium_6061_t6())),
        fingerprint(choose::scene(
            method,
            library::tungsten_alloy().with_bulk_viscosity(0.06, 1.5).expect("constants"),
        )),
        fingerprint(choose::scene(method, library::slope_soil())),
        fingerprint(choose::scene(method, library::concrete_48())),
        fingerprint(choose::scene(method, rubber.compiled())),
    ]
}

#[test]
fn a_chosen_scene_is_the_composed_one() {
    let blend = Blend::new(choose::TAU).expect("a time");
    let composed = [
        with_each_law(Method::new(Linear, Flip, Musl, PlaneStrain)),
        with_each_law(Method::new(Linear, blend, Musl, PlaneStrain)),
        with_each_law(Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian()),
        with_each_law(Method::new(CpGimp, Flip, Musl, PlaneStrain)),
        with_each_law(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain)),
        with_each_law(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain)),
        with_each_law(Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain)),
        with_each_law(Method::new(TentAveragedHat, Apic, Usl, PlaneStrain).compiled()),
    ];
    let mut all = Vec::new();
    for (method, composed) in METHODS.iter().zip(&composed) {
        for (law, composed) in LAWS.iter().zip(composed) {
            let chosen =
                choose::scene(choose::method(method).expect("a method"), choose::law(law).expect("a law"));
            assert_eq!(fingerprint(chosen), *composed, "{method}, {law}");
            all.push(*composed);
        }
    }
    // All scenes differ.
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), METHODS.len() * LAWS.len());
}

#[test]
fn what_is_not_there_is_refused_by_name() {
    let refused = choose::method("linear-flap").err().expect("no such method").to_string();
    assert!(refused.contains("linear-flap") && refused.contains("linear-flip"), "{refused}");
    let refused = choose::law("cheese").err().expect("no such law").to_string();
    assert!(refused.contains("cheese") && refused.contains("copper"), "{refused}");
}
