//! Bodies that meet.

use impactite_scene::{PlaneStrain, Solver};
use mpm_contact::particles::Bodies;
use mpm_contact::{Coulomb, Frictionless, Pairs, SurfaceDistance};
use sph::{Composition, Method, Sph};

use crate::common::{block, linear};

/// Two bars of 10 cm, one at rest and one at 10 m/s: the second takes the speed of the first over.
fn bars<M: Composition<2>>(method: M) -> (f64, f64, f64) {
    let h = 0.002;
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    let bar = |low: f64, speed: f64| {
        let layout = block([low, 0.0], [low + 0.1, 5.0 * h], h, false);
        Sph::new(method, linear(0.0), &layout, |_| [speed, 0.0]).unwrap()
    };
    scene.add("left", bar(0.0, 10.0));
    scene.add("right", bar(0.1 + 0.1 * h, 0.0));
    let before = scene.totals();
    scene.run_until(60e-6).unwrap();
    let speed = |n: usize| scene.totals_of(n).map_or(0.0, |t| t.momentum[0] / t.mass);
    let after = scene.totals();
    let off = (after.kinetic + after.internal + (scene.exchange().impacts + scene.exchange().viscosity))
        / before.kinetic
        - 1.0;
    assert!((after.momentum[0] - before.momentum[0]).abs() < 1e-12 * before.momentum_scale);
    (speed(0), speed(1), off)
}

#[test]
fn bars_exchange_their_speeds() {
    for (left, right, energy) in
        [bars(Method::total_lagrangian(PlaneStrain)), bars(Method::updated(PlaneStrain))]
    {
        assert!(left.abs() < 0.8 && (right - 10.0).abs() < 0.8, "{left} {right}");
        assert!(energy.abs() < 0.01, "{energy}");
    }
}

/// A block slides on a floor under its weight: friction slows it by mu g.
#[test]
fn a_block_is_slowed_by_friction() {
    let h = 0.01;
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).unwrap()));
    let method = Method::total_lagrangian(PlaneStrain);
    let soft = || {
        let moduli = mpm_materials::Moduli::young_poisson(1e7, 0.3).unwrap();
        mpm_materials::LinearElastic::new(1000.0, moduli).unwrap()
    };
    let floor = block([0.0, -5.0 * h], [40.0 * h, 0.0], h, false);
    let mut floor = Sph::new(method, soft(), &floor, |_| [0.0; 2]).unwrap();
    floor
        .bound(impactite_scene::Boundary::Fixed { axis: 1, at: -4.0 * h, side: impactite_scene::Side::Above })
        .unwrap();
    let block = block([5.0 * h, 0.0], [15.0 * h, 6.0 * h], h, false);
    let mut block = Sph::new(method, soft(), &block, |_| [1.0, 0.0]).unwrap();
    block.set_body_force(std::sync::Arc::new(|_| [0.0, -10.0]));
    scene.add("floor", floor);
    scene.add("block", block);
    let speed = |scene: &Bodies<2, _>| scene.totals_of(1).map_or(0.0, |t| t.momentum[0] / t.mass);
    scene.run_until(0.02).unwrap();
    let before = speed(&scene);
    scene.run_until(0.12).unwrap();
    let slowed = (before - speed(&scene)) / 0.1;
    assert!((slowed / 3.0 - 1.0).abs() < 0.05, "{slowed}");
}
