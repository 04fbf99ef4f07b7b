//! Breathing spheres and cylinders (gates 3.2).

use impactite_geometry::{Ball, Cuboid};
use impactite_scene::{Axisymmetric, Boundary, FullSpace, Side, Solver};
use mpm_materials::LinearElastic;
use sph::{Composition, CubicSpline, GradientCorrection, Layout, Method, Sph, Unstabilised, Updated};

use crate::{STEEL, particles, steel};

const RADIUS: f64 = 10e-3;

/// Frequency of a body that breathes: from the second and the third time that its particles stop.
fn frequency<const D: usize, M: Composition<D>>(
    method: M,
    layout: &Layout<D>,
    planes: &[Boundary<D>],
    mode: impl Fn([f64; D]) -> [f64; D],
    expected: f64,
) -> (f64, f64) {
    let law = LinearElastic::new(STEEL, steel()).unwrap();
    let mut body = Sph::new(method, law, layout, &mode).unwrap();
    for plane in planes {
        body.bound(plane.clone()).unwrap();
    }
    let start = body.totals();
    let amplitude = |body: &Sph<D, M>| -> f64 {
        (0..body.positions().len())
            .map(|i| {
                let (v, shape) = (body.velocity(i), mode(body.positions()[i]));
                body.mass(i) * (0..D).map(|d| v[d] * shape[d]).sum::<f64>()
            })
            .sum()
    };
    let (mut before, mut stops) = (amplitude(&body), Vec::new());
    while stops.len() < 5 {
        let dt = body.step_towards(3.0 / expected).unwrap();
        let now = amplitude(&body);
        if now * before < 0.0 {
            // Velocities are those of the middle of a step.
            stops.push(body.time() - 0.5 * dt - dt * now / (now - before));
        }
        before = now;
    }
    let after = body.totals();
    let energy = (after.kinetic + after.internal) / start.kinetic - 1.0;
    (2.0 / (stops[4] - stops[0]), energy)
}

/// The lowest mode of a sphere: u = sin(kr)/r^2 - k cos(kr)/r with kR = 2.6702.
fn sphere<const D: usize>(x: [f64; D]) -> [f64; D] {
    let k = 2.6702 / RADIUS;
    let r = x.iter().map(|c| c * c).sum::<f64>().sqrt();
    let u = ((k * r).sin() / (r * r) - k * (k * r).cos() / r) / (k * k * k);
    x.map(|c| c * u / r * 1e3)
}

/// The particles of which no coordinate is negative.
fn part_above<const D: usize>(mut layout: Layout<D>) -> Layout<D> {
    let keep: Vec<bool> = layout.positions.iter().map(|x| x.iter().all(|c| *c > 0.0)).collect();
    fn pick<X: Copy>(list: &mut Vec<X>, keep: &[bool]) {
        let mut n = 0..;
        list.retain(|_| n.next().is_some_and(|n: usize| keep[n]));
    }
    pick(&mut layout.positions, &keep);
    pick(&mut layout.volumes, &keep);
    pick(&mut layout.spacings, &keep);
    layout
}

fn above<const D: usize>(axis: usize) -> Boundary<D> {
    Boundary::Symmetry { axis, at: 0.0, side: Side::Above }
}

#[test]
fn a_sphere_breathes() {
    let expected = 248.88e3;
    let ball = |h: f64| part_above(particles(&Ball::<2>::new([0.0; 2], RADIUS).unwrap(), h, true));
    let mut errors = Vec::new();
    for cells in [10.0, 20.0] {
        let layout = ball(RADIUS / cells);
        let total = Method::total_lagrangian(Axisymmetric);
        let (found, energy) = frequency(total, &layout, &[above(1)], sphere, expected);
        errors.push(found / expected - 1.0);
        assert!(energy.abs() < 1e-3, "energy {energy:e}");
    }
    assert!(errors[1].abs() < 0.01 && errors[1].abs() < 0.6 * errors[0].abs(), "{errors:?}");
    let updated =
        Method::new(Axisymmetric, CubicSpline::default(), Updated, GradientCorrection, Unstabilised);
    let (found, _) = frequency(updated, &ball(RADIUS / 20.0), &[above(1)], sphere, expected);
    assert!((found / expected - 1.0).abs() < 0.01, "{found}");
    // An eighth of it in space.
    let eighth = part_above(particles(&Ball::<3>::new([0.0; 3], RADIUS).unwrap(), RADIUS / 10.0, false));
    let planes = [above(0), above(1), above(2)];
    let (found, energy) = frequency(Method::total_lagrangian(FullSpace), &eighth, &planes, sphere, expected);
    assert!((found / expected - 1.0).abs() < 0.04 && energy.abs() < 1e-3, "{found} {energy:e}");
}

/// The Bessel function J1, by its series.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (0.5 * x, 0.0);
    for n in 1..30 {
        sum += term;
        term *= -0.25 * x * x / f64::from(n * (n + 1));
    }
    sum
}

#[test]
fn a_cylinder_breathes() {
    let expected = 198.13e3;
    let h = RADIUS / 20.0;
    let layout = particles(&Cuboid::new([0.0; 2], [RADIUS, 4.0 * h]).unwrap(), h, true);
    let planes = [above(1), Boundary::Symmetry { axis: 1, at: 4.0 * h, side: Side::Below }];
    let mode = |[r, _]: [f64; 2]| [bessel(2.1257 * r / RADIUS), 0.0];
    let (found, energy) = frequency(Method::total_lagrangian(Axisymmetric), &layout, &planes, mode, expected);
    assert!((found / expected - 1.0).abs() < 2e-3 && energy.abs() < 1e-3, "{found} {energy:e}");
}
