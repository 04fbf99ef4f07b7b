//! Plate impacts (gates D, E), and impacts of rubber rings.

use impactite_geometry::{Cuboid, Ring};
use impactite_scene::{Body, Boundary, PlaneStrain, Side, Solver};
use mpm_contact::particles::Bodies;
use mpm_contact::{Frictionless, Pairs, SurfaceDistance};
use mpm_materials::strength::LinearHardening;
use mpm_materials::{Elastic, Fluid, IntoMaterial, J2, LogarithmicBulk, MieGruneisen, Moduli, Solid};
use sph::{Composition, Layout, Method, Sph};

use crate::particles;

/// Impact of a bar between planes of symmetry on a wall, half of a symmetric impact. Return the mean pressure and stress along it, Pa, and
/// the density, kg/m^3, in the middle part behind the first wave.
fn plate<M: Composition<2>>(
    method: M,
    law: impl IntoMaterial<f64>,
    speed: f64,
    cells: usize,
    time: f64,
    part: [f64; 2],
) -> [f64; 3] {
    let h = 1e-3;
    let layout = particles(&Cuboid::new([0.0; 2], [cells as f64 * h, 4.0 * h]).unwrap(), h);
    let mut bar = Sph::new(method, law, &layout, |_| [-speed, 0.0]).unwrap();
    bar.bound(Boundary::Wall { axis: 0, at: 0.0, side: Side::Above, velocity: 0.0 }).unwrap();
    bar.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
    bar.bound(Boundary::Symmetry { axis: 1, at: 4.0 * h, side: Side::Below }).unwrap();
    bar.run_until(time).unwrap();
    let mut sums = [0.0; 4];
    bar.for_each(&mut |p| {
        if (part[0]..part[1]).contains(&p.position[0]) {
            sums[0] += p.pressure();
            sums[1] -= p.stress[0];
            sums[2] += p.mass / p.volume;
            sums[3] += 1.0;
        }
    });
    [0, 1, 2].map(|n| sums[n] / sums[3])
}

/// Copper on copper at 500 m/s without strength: 9.6277 GPa, 9479.54 kg/m^3 behind a shock of 4312.5 m/s; by the original formulation,
/// which gate D of `tests/verification` does not cover.
#[test]
fn a_shock_has_the_pressure_and_density_of_rankine_and_hugoniot() {
    let eos = MieGruneisen::new(8930.0, 3940.0, 1.49, 2.0).unwrap();
    let law = Fluid::new(eos).with_bulk_viscosity(0.3, 1.5).unwrap();
    // After 16 us the shock is at 65 mm.
    let [pressure, _, density] = plate(Method::printed(PlaneStrain), law, 250.0, 100, 16e-6, [15e-3, 45e-3]);
    assert!((pressure / 9.6277e9 - 1.0).abs() < 0.01, "{pressure:e}");
    assert!((density / 9479.54 - 1.0).abs() < 0.005, "{density}");
}

/// Elastic precursor and plastic wave, symmetric at 100 m/s: 0.86667 GPa between the waves, 1.8492 GPa behind.
#[test]
fn a_plastic_wave_follows_its_precursor() {
    let moduli = Moduli::young_poisson(117e9, 0.35).unwrap();
    let law = || {
        let strength = J2::new(moduli.shear, LinearHardening::new(0.4e9, 0.0).unwrap()).unwrap();
        let solid = Solid::new(strength, LogarithmicBulk::new(8930.0, moduli.bulk).unwrap());
        solid.with_bulk_viscosity(0.3, 1.5).unwrap()
    };
    // After 30 us the precursor is at 137 mm, the plastic wave at 114 mm.
    let behind = plate(Method::total_lagrangian(PlaneStrain), law(), 50.0, 160, 30e-6, [20e-3, 95e-3])[1];
    let between = plate(Method::total_lagrangian(PlaneStrain), law(), 50.0, 160, 30e-6, [121e-3, 130e-3])[1];
    assert!((behind / 1.8492e9 - 1.0).abs() < 0.01, "{behind:e}");
    assert!((between / 0.86667e9 - 1.0).abs() < 0.03, "{between:e}");
}

/// Rubber rings (K 121.7, G 26.1 MPa, 1010 kg/m^3) at 30 m/s each rebound from each other and stay whole.
#[test]
fn rings_of_rubber_bounce() {
    let h = 1e-3;
    let law = || Solid::new(Elastic::new(26.1e6).unwrap(), LogarithmicBulk::new(1010.0, 121.7e6).unwrap());
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    for (name, x, speed) in [("left", -41e-3, 30.0), ("right", 41e-3, -30.0)] {
        let ring: Layout<2> = particles(&Ring::new([x, 0.0], 30e-3, 40e-3).unwrap(), h);
        scene.add(
            name,
            Sph::new(Method::total_lagrangian(PlaneStrain), law(), &ring, |_| [speed, 0.0]).unwrap(),
        );
    }
    let before = scene.totals();
    scene.run_until(6e-3).unwrap();
    let after = scene.totals();
    let speed = |n: usize| scene.totals_of(n).map_or(0.0, |t| t.momentum[0] / t.mass);
    assert!(speed(0) < -10.0 && speed(1) > 10.0, "{} {}", speed(0), speed(1));
    assert!((after.momentum[0] - before.momentum[0]).abs() < 1e-12 * before.momentum_scale);
    let energy = (after.kinetic + after.internal + (scene.exchange().impacts + scene.exchange().viscosity))
        / before.kinetic
        - 1.0;
    // Contact dissipates energy in proportion to the step.
    assert!(energy.abs() < 0.02, "{energy}");
}
