//! Plane stress laws against closed-form solutions.
#![allow(missing_docs)]

use mpm_materials::{
    Breakdown, Constitutive, J2, Kinematics, Lane, LinearElastic, LogarithmicBulk, Mat3, Moduli, PlaneStress,
    PlaneStressState, Solid, library,
};

const YOUNG: f64 = 200e9;
const POISSON: f64 = 0.3;

fn moduli() -> Moduli<f64> {
    Moduli::young_poisson(YOUNG, POISSON).unwrap()
}

type States<C> = <PlaneStress<C> as Constitutive<f64>>::State<f64>;

/// Strain a virgin point in the plane in `steps` steps.
fn strained<C: Constitutive<f64>>(law: &PlaneStress<C>, strain: [[f64; 2]; 2], steps: usize) -> States<C> {
    let mut state = law.virgin();
    for _ in 0..steps {
        let mut increment = Mat3([[0.0; 3]; 3]);
        for a in 0..2 {
            for b in 0..2 {
                increment.0[a][b] = strain[a][b] / steps as f64;
            }
        }
        let update = law.update(&Kinematics { increment, dt: 1e-3, length: 1e-3 }, &state);
        assert_eq!(update.fault.cause(0), None);
        state = update.state;
        assert!(update.stress.0[2].abs() <= 1e-6 * 300e9 * 2.0 * strain[0][0].abs().max(strain[0][1].abs()));
    }
    state
}

#[test]
fn a_plate_is_stretched_with_the_modulus_of_plates() {
    let law = PlaneStress::new(LinearElastic::new(7850.0, moduli()).unwrap());
    let e = 1e-6;
    for steps in [1, 7] {
        let state = strained(&law, [[e, 0.0], [0.0, 0.0]], steps);
        let stress = law.stress(&state).0;
        let plate = YOUNG / (1.0 - POISSON * POISSON);
        assert!((stress[0] / (plate * e) - 1.0).abs() < 3e-6, "{}", stress[0]);
        assert!((stress[1] / (POISSON * plate * e) - 1.0).abs() < 3e-6);
        let across = -POISSON / (1.0 - POISSON) * e;
        assert!(((state.thickness - 1.0) / across - 1.0).abs() < 1e-5, "{}", state.thickness);
        // Free along y, too: uniaxial stress.
        let state = strained(&law, [[e, 0.0], [0.0, -POISSON * e]], steps);
        let stress = law.stress(&state).0;
        assert!((stress[0] / (YOUNG * e) - 1.0).abs() < 3e-6 && stress[1].abs() < 3e-6 * YOUNG * e);
    }
    // Shear causes no thickness change.
    let state = strained(&law, [[0.0, e], [e, 0.0]], 3);
    assert!((state.thickness - 1.0).abs() < 1e-11, "{}", state.thickness);
    assert!((law.stress(&state).0[5] / (2.0 * moduli().shear * e) - 1.0).abs() < 1e-5);
}

#[test]
fn a_plate_that_yields_bears_what_von_mises_says() {
    const YIELD: f64 = 400e6;
    let bulk = LogarithmicBulk::new(7850.0, moduli().bulk).unwrap();
    let law = PlaneStress::new(Solid::new(J2::linear(moduli().shear, YIELD, 0.0).unwrap(), bulk));
    // Equal biaxial stretch: sigma = Y in both directions.
    let e = 0.02;
    let state = strained(&law, [[e, 0.0], [0.0, e]], 400);
    let stress = law.stress(&state).0;
    assert!((stress[0] / YIELD - 1.0).abs() < 2e-3 && (stress[1] / YIELD - 1.0).abs() < 2e-3, "{stress:?}");
    // Thickness strain: elastic part, plus the compensation of the isochoric plastic strain in the plane.
    let elastic = YIELD * (1.0 - POISSON) / YOUNG;
    let across = -2.0 * POISSON * YIELD / YOUNG - 2.0 * (e - elastic);
    assert!((state.thickness.ln() / across - 1.0).abs() < 2e-3, "{} {across}", state.thickness);
    // Fixed along y: 2 Y / sqrt 3 and Y / sqrt 3.
    let state = strained(&law, [[e, 0.0], [0.0, 0.0]], 400);
    let stress = law.stress(&state).0;
    let root = 3.0f64.sqrt();
    assert!((stress[0] / (2.0 * YIELD / root) - 1.0).abs() < 2e-3, "{stress:?}");
    assert!((stress[1] / (YIELD / root) - 1.0).abs() < 1e-2, "{stress:?}");
}

#[test]
fn any_law_does_in_plates() {
    let copper = PlaneStress::new(library::copper_taylor::<f64>());
    let state = strained(&copper, [[0.05, 0.02], [0.0, -0.01]], 200);
    assert!(state.thickness < 1.0 && copper.energy(&state) > 0.0);
    let rubber = PlaneStress::new(
        mpm_materials::NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.49).unwrap()).unwrap(),
    );
    // Nearly incompressible: thickness times area is constant.
    let state = strained(&rubber, [[0.3, 0.0], [0.0, 0.0]], 30);
    let stretch = (1.0f64 + 0.01).powi(30);
    assert!((state.thickness * stretch - 1.0).abs() < 0.02, "{}", state.thickness);
}

#[test]
fn what_is_found_does_not_depend_on_the_points_beside_it() {
    use mpm_materials::Wide;
    let copper = library::copper_taylor::<f64>();
    let law = PlaneStress::new(copper);
    let strains = [1e-5, 0.02, 0.0, -3e-3];
    let mut wide = Mat3([[Wide([0.0; 4]); 3]; 3]);
    wide.0[0][0] = Wide(strains);
    wide.0[0][1] = Wide(strains.map(|e| 0.5 * e));
    let virgin: PlaneStressState<_, _> = mpm_materials::spread(&law.virgin());
    let all =
        law.update(&Kinematics { increment: wide, dt: Wide([1e-6; 4]), length: Wide([1e-3; 4]) }, &virgin);
    for (lane, e) in strains.into_iter().enumerate() {
        let mut increment = Mat3([[0.0; 3]; 3]);
        (increment.0[0][0], increment.0[0][1]) = (e, 0.5 * e);
        let one = law.update(&Kinematics { increment, dt: 1e-6, length: 1e-3 }, &law.virgin());
        let there = all.state.thickness.lane(lane);
        assert_eq!(one.state.thickness.to_bits(), there.to_bits(), "lane {lane}");
        assert_eq!(one.stress.0[0].to_bits(), all.stress.0[0].0[lane].to_bits());
    }
}

#[test]
fn a_point_that_finds_no_strain_across_breaks_down() {
    let law = PlaneStress::new(LinearElastic::new(7850.0, moduli()).unwrap());
    let mut increment = Mat3([[0.0; 3]; 3]);
    increment.0[0][0] = f64::NAN;
    let update = law.update(&Kinematics { increment, dt: 1e-6, length: 1e-3 }, &law.virgin());
    assert!(update.fault.cause(0).is_some());
    // Inverted in the plane.
    increment.0[0][0] = -1.5;
    let update = law.update(&Kinematics { increment, dt: 1e-6, length: 1e-3 }, &law.virgin());
    let cause = update.fault.cause(0).expect("it breaks");
    assert!(matches!(cause, Breakdown::InvertedVolume | Breakdown::NotConverged | Breakdown::NotFinite));
}
