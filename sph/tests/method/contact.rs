//! Contact of bodies.

use std::sync::Arc;

use impactite_geometry::{Ball, Cuboid, Filling, Lattice, Shape, fill};
use impactite_scene::{Axisymmetric, Boundary, FullSpace, PlaneStrain, Side, Solver};
use mpm_contact::particles::Bodies;
use mpm_contact::{Adhesion, Coulomb, Frictionless, Pairs, Stick, SurfaceDistance};
use mpm_materials::{IntoMaterial, Moduli, NeoHookean};
use sph::{Composition, Layout, Method, Sph};

use crate::common::{block, linear};

/// Soft rubber with a wave speed of 367 m/s.
fn rubber(poisson: f64) -> impl IntoMaterial<f64> + Copy {
    NeoHookean::new(1000.0, Moduli::young_poisson(100e6, poisson).unwrap()).unwrap()
}

/// Return particles of a shape on a lattice of `h` through the origin, at any position of the shape.
fn filled<const D: usize>(shape: &impl Shape<D>, h: f64, axisymmetric: bool) -> Layout<D> {
    let filling = if axisymmetric { Filling::new().axisymmetric() } else { Filling::new() };
    Layout::of_seeds(&fill(shape, &Lattice::new([0.0; D], h).unwrap(), 1, &filling).unwrap())
}

/// Return the gap at first contact of two bodies that approach each other along an axis, each at `speed`; computed from the speed.
fn gap_at_first_touch<const D: usize, M: Composition<D>>(
    method: M,
    bodies: [&Layout<D>; 2],
    axis: usize,
    speed: f64,
    gap: f64,
) -> f64 {
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Frictionless));
    for (layout, sign) in bodies.into_iter().zip([1.0, -1.0]) {
        let mut velocity = [0.0; D];
        velocity[axis] = sign * speed;
        scene.add("body", Sph::new(method, rubber(0.3), layout, |_| velocity).unwrap());
    }
    let end = 3.0 * gap / speed;
    while scene.time() < end {
        scene.step_towards(end).unwrap();
        if scene.exchange().impacts != 0.0 {
            return gap - 2.0 * speed * scene.time();
        }
    }
    f64::NEG_INFINITY
}

/// First contact is at zero gap to within a tenth of a spacing, at any position on the lattice and in any form.
#[test]
fn surfaces_touch_where_they_are() {
    let h = 1e-3;
    let check = |name: &str, gap: f64| assert!(gap.abs() < 0.1 * h, "{name}: {} spacings", gap / h);
    for (dx, dy) in [(0.0, 2.0), (0.37, 2.26), (0.5, 0.1), (0.13, -5.2)] {
        let disc =
            |x: f64, y: f64| filled(&Ball::new([(x + dx) * h, (y + dy) * h], 10.0 * h).unwrap(), h, false);
        let (left, right) = (disc(-10.2, 0.0), disc(10.2, -2.0 * dy));
        let gap = (20.4 - (400.0f64 - 4.0 * dy * dy).sqrt()) * h;
        check(
            "discs",
            gap_at_first_touch(Method::total_lagrangian(PlaneStrain), [&left, &right], 0, 5.0, gap),
        );
        check("discs", gap_at_first_touch(Method::updated(PlaneStrain), [&left, &right], 0, 5.0, gap));
    }
    for (x, z) in [(6.3, 0.17), (6.0, 0.45)] {
        let rod = |low: f64, high: f64, x: f64| {
            filled(&Cuboid::new([0.0, low * h], [x * h, high * h]).unwrap(), h, true)
        };
        let (lower, upper) = (rod(-6.0, -0.1, x), rod(z, 6.0, 9.7));
        let gap = (z + 0.1) * h;
        check(
            "rods",
            gap_at_first_touch(Method::total_lagrangian(Axisymmetric), [&lower, &upper], 1, 5.0, gap),
        );
        check("rods", gap_at_first_touch(Method::updated(Axisymmetric), [&lower, &upper], 1, 5.0, gap));
    }
    // Facets between particles on a ball of ten spacings across are up to 0.07 spacings within it, on both balls.
    for [x, dy, dz] in [[5.2, 2.0, 1.0], [5.05, 1.0, 0.5], [5.3, 0.4, 0.1], [5.6, 1.3, -2.2], [5.1, 0.0, 0.0]]
    {
        let ball =
            |x: f64, y: f64, z: f64| filled(&Ball::new([x * h, y * h, z * h], 5.0 * h).unwrap(), h, false);
        let (left, right) = (ball(-x, dy, dz), ball(x + 0.035, -dy, -dz));
        let gap = (2.0 * x + 0.035 - (100.0f64 - 4.0 * dy * dy - 4.0 * dz * dz).sqrt()) * h;
        let found = gap_at_first_touch(Method::total_lagrangian(FullSpace), [&left, &right], 0, 5.0, gap);
        assert!(found > -0.17 * h && found < 0.1 * h, "balls {x} {dy} {dz}: {} spacings", found / h);
    }
    for place in [0.0, 0.4] {
        let cube = |low: [f64; 3], high: [f64; 3]| {
            filled(&Cuboid::new(low.map(|x| x * h), high.map(|x| x * h)).unwrap(), h, false)
        };
        let left = cube([-5.0, -2.0, -2.0], [-0.13, 3.0, 3.0]);
        let right = cube([0.17 + place, -1.7, -2.4], [5.0, 3.3, 2.6]);
        let gap = (0.3 + place) * h;
        check("cubes", gap_at_first_touch(Method::total_lagrangian(FullSpace), [&left, &right], 0, 5.0, gap));
        check("cubes", gap_at_first_touch(Method::updated(FullSpace), [&left, &right], 0, 5.0, gap));
    }
}

/// Discs in eccentric impact at half the speed of sound do not penetrate each other, and rotate by friction: momentum and angular momentum
/// are conserved.
#[test]
fn bodies_do_not_pass_through_each_other() {
    let h = 1e-3;
    let disc = |x: f64, y: f64| filled(&Ball::new([x * h, y * h], 10.0 * h).unwrap(), h, false);
    let mut scene = Bodies::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).unwrap()));
    let method = Method::total_lagrangian(PlaneStrain);
    for (layout, speed) in [(disc(-10.1, 2.3), 91.7), (disc(10.17, -2.0), -91.7)] {
        scene.add("disc", Sph::new(method, rubber(0.3), &layout, |_| [speed, 0.0]).unwrap());
    }
    let start = scene.totals();
    scene.run_until(200e-6).unwrap();
    let end = scene.totals();
    let speed = |n: usize| scene.totals_of(n).map_or(0.0, |t| t.momentum[0] / t.mass);
    assert!(speed(0) < -10.0 && speed(1) > 10.0, "{} {}", speed(0), speed(1));
    for d in 0..2 {
        assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-12 * start.momentum_scale);
    }
    // Positions are half a step from velocities: the tolerance detects an exchange between the discs only.
    let lever = 10.0 * h * start.momentum_scale;
    let change = (end.angular_momentum[2] - start.angular_momentum[2]).abs();
    assert!(change < 1e-4 * lever, "{}", change / lever);
    let energy = (end.kinetic + end.internal) / (start.kinetic + start.internal);
    assert!(energy > 0.8 && energy < 1.0, "{energy}");
}

/// Block compressed between walls to 0.98 of its height, with free sides: energy E / (1 - nu^2) e^2 / 2 per volume, for any number of
/// particles. Second-order strains add one per cent.
#[test]
fn walls_press_on_the_surface() {
    for cells in [4.0, 8.0, 16.0] {
        let (size, young, poisson, speed) = (0.2, 100e6, 0.3, 0.5);
        let layout = block([0.0; 2], [size; 2], size / cells, false);
        let squeezed = |x: [f64; 2]| {
            [speed * poisson / (1.0 - poisson) * (2.0 * x[0] / size - 1.0), speed * (1.0 - 2.0 * x[1] / size)]
        };
        let end = 0.01 * size / speed;
        let method = Method::total_lagrangian(PlaneStrain);
        let mut body = Sph::new(method, rubber(poisson), &layout, squeezed).unwrap();
        for (at, side, velocity) in [(0.0, Side::Above, speed), (size, Side::Below, -speed)] {
            body.bound(Boundary::Wall { axis: 1, at, side, velocity }).unwrap();
        }
        body.run_until(end).unwrap();
        let exact = 0.5 * young / (1.0 - poisson * poisson) * 0.02f64.powi(2) * size * size;
        let off = body.internal_energy() / exact - 1.0;
        assert!(off.abs() < 0.02, "{cells} particles: {off}");
    }
}

/// Two halves of a bar in initial contact are one bar under `stick` and under a strong bond, and two under a weak one.
#[test]
fn what_touches_at_the_start_is_bonded() {
    fn halves<M: Composition<2>>(method: M, laws: Pairs<f64>) -> f64 {
        let h = 5e-3;
        let mut scene = Bodies::new(SurfaceDistance::default(), laws);
        for (low, speed) in [(0.0, -1.0), (0.1, 1.0)] {
            let layout = block([low, 0.0], [low + 0.1, 8.0 * h], h, false);
            let velocity = |x: [f64; 2]| [speed * (x[0] - 0.1).abs() / 0.1, 0.0];
            scene.add("half", Sph::new(method, rubber(0.0), &layout, velocity).unwrap());
        }
        // Half the period of the whole bar is its length over the wave speed, 316 m/s: 0.63 ms. Its velocities have reversed.
        scene.run_until(0.75e-3).unwrap();
        scene.totals_of(1).map_or(0.0, |t| t.momentum[0] / t.mass)
    }
    let strength = |s: f64| Pairs::new(Adhesion::new(s, s, 0.0).unwrap());
    for (law, bonded) in [(Pairs::new(Stick), true), (strength(1e9), true), (strength(1e3), false)] {
        let speeds = [
            halves(Method::total_lagrangian(PlaneStrain), law.clone()),
            halves(Method::updated(PlaneStrain), law),
        ];
        for speed in speeds {
            assert!(if bonded { speed < -0.2 } else { speed > 0.3 }, "{speed} m/s, bonded: {bonded}");
        }
    }
}

/// Impact of two bars of 10 cm, one at 10 m/s, one at rest: return both speeds, which are exchanged, and the relative energy error.
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

/// Block sliding on a floor under its weight: friction decelerates it by mu g.
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
    floor.bound(Boundary::Fixed { axis: 1, at: -4.0 * h, side: Side::Above }).unwrap();
    let block = block([5.0 * h, 0.0], [15.0 * h, 6.0 * h], h, false);
    let mut block = Sph::new(method, soft(), &block, |_| [1.0, 0.0]).unwrap();
    block.set_body_force(Arc::new(|_| [0.0, -10.0]));
    scene.add("floor", floor);
    scene.add("block", block);
    let speed = |scene: &Bodies<2, _>| scene.totals_of(1).map_or(0.0, |t| t.momentum[0] / t.mass);
    scene.run_until(0.02).unwrap();
    let before = speed(&scene);
    scene.run_until(0.12).unwrap();
    let slowed = (before - speed(&scene)) / 0.1;
    assert!((slowed / 3.0 - 1.0).abs() < 0.05, "{slowed}");
}
