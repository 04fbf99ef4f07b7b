//! Shapes: signed distances, exact measures, Boolean operations and transformations.

use std::f64::consts::PI;

use impactite_geometry::*;
use nalgebra::{Rotation2, Rotation3, Vector3};
use proptest::prelude::*;

/// Generator of uniform random points in a box.
struct Points(u64);

impl Points {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn within<const D: usize>(&mut self, b: &Bounds<D>, margin: f64) -> [f64; D] {
        let mut x = [0.0; D];
        for i in 0..D {
            let extent = b.max[i] - b.min[i];
            x[i] = b.min[i] - margin * extent + self.unit() * (1.0 + 2.0 * margin) * extent;
        }
        x
    }
}

fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
}

type Named<const D: usize> = Vec<(&'static str, Box<dyn Shape<D>>)>;

fn solids() -> Named<3> {
    let oblique = [1.0, -2.0, 0.5];
    vec![
        ("cuboid", Box::new(Cuboid::new([1.0, 0.2, -0.3], [-0.5, 0.7, 0.4]).unwrap())),
        ("sphere", Box::new(Sphere::new([0.3, -0.2, 0.1], 0.7).unwrap())),
        ("shell", Box::new(Shell::new([0.3, -0.2, 0.1], 0.4, 0.7).unwrap())),
        ("cylinder", Box::new(Cylinder::new([0.1, 0.0, 0.2], oblique, 1.5, 0.4).unwrap())),
        ("upright", Box::new(Cylinder::new([0.1, 0.0, 0.2], [0.0, 0.0, -1.0], 1.5, 0.4).unwrap())),
        ("tube", Box::new(Tube::new([0.1, 0.0, 0.2], oblique, 1.5, 0.3, 0.4).unwrap())),
        ("frustum", Box::new(Frustum::new([0.1, 0.0, 0.2], oblique, 1.0, [0.6, 0.2]).unwrap())),
        ("cone", Box::new(Frustum::new([0.1, 0.0, 0.2], oblique, 1.0, [0.0, 0.7]).unwrap())),
        ("ogive", Box::new(OgiveRod::new([0.0, 0.1, 0.0], oblique, 0.5, 2.0, 3.0).unwrap())),
        ("blunt", Box::new(OgiveRod::new([0.0, 0.1, 0.0], oblique, 0.5, 1.0, 0.5).unwrap())),
        ("nose", Box::new(OgiveRod::new([0.0, 0.1, 0.0], oblique, 1.0, 0.5 * 15f64.sqrt(), 4.0).unwrap())),
        (
            "turned",
            Box::new(
                Cuboid::new([0.0; 3], [1.0, 0.5, 0.3])
                    .unwrap()
                    .rotated(Rotation3::new(Vector3::new(0.3, 0.9, -0.2)), [0.1, 0.0, 0.0])
                    .unwrap()
                    .scaled(1.3, [0.5, 0.5, 0.5])
                    .unwrap()
                    .translated([0.1, 0.2, 0.3])
                    .unwrap(),
            ),
        ),
    ]
}

fn plane_shapes() -> Named<2> {
    let oblique = [2.0, 1.0];
    let star: Vec<[f64; 2]> = (0..10)
        .map(|k| {
            let (r, a) = (if k % 2 == 0 { 1.0 } else { 0.4 }, PI * k as f64 / 5.0);
            [2.0 + r * a.cos(), 0.3 + r * a.sin()]
        })
        .collect();
    vec![
        ("rectangle", Box::new(Cuboid::new([1.0, 0.2], [0.5, 0.7]).unwrap())),
        ("disc", Box::new(Disc::new([1.0, 0.2], 0.7).unwrap())),
        ("ring", Box::new(Ring::new([1.0, 0.2], 0.3, 0.4).unwrap())),
        ("bar", Box::new(Cylinder::new([2.0, 0.0], oblique, 1.5, 0.4).unwrap())),
        ("bars", Box::new(Tube::new([2.0, 0.0], oblique, 1.5, 0.3, 0.4).unwrap())),
        ("wedge", Box::new(Frustum::new([2.0, 0.0], oblique, 1.0, [0.6, 0.2]).unwrap())),
        ("ogive", Box::new(OgiveRod::new([2.0, 0.0], oblique, 0.5, 2.0, 3.0).unwrap())),
        ("star", Box::new(Polygon::new(star).unwrap())),
        (
            "turned",
            Box::new(
                Cuboid::new([2.0, 0.0], [3.0, 0.4])
                    .unwrap()
                    .rotated(Rotation2::new(0.4), [2.5, 0.0])
                    .unwrap(),
            ),
        ),
    ]
}

/// Gradient of the signed distance by central differences.
fn gradient<const D: usize>(shape: &dyn Shape<D>, x: [f64; D], step: f64) -> [f64; D] {
    let mut g = [0.0; D];
    for i in 0..D {
        let (mut p, mut m) = (x, x);
        p[i] += step;
        m[i] -= step;
        g[i] = (shape.signed_distance(p) - shape.signed_distance(m)) / (2.0 * step);
    }
    g
}

/// Check the signed distance: Lipschitz constant one, gradient of unit length, no change of sign within the distance.
fn check_distance<const D: usize>(name: &str, shape: &dyn Shape<D>) {
    const N: usize = 4000;
    let mut points = Points(88172645463325252);
    let b = shape.bounds();
    let size = distance(b.min, b.max);
    let mut unit_gradients = 0;
    for _ in 0..N {
        let (x, y) = (points.within(&b, 0.3), points.within(&b, 0.3));
        let (dx, dy) = (shape.signed_distance(x), shape.signed_distance(y));
        assert!((dx - dy).abs() <= distance(x, y) * (1.0 + 1e-12), "{name}: not Lipschitz at {x:?}, {y:?}");
        assert_eq!(dx < 0.0, shape.contains(x), "{name}: {x:?}");
        assert!(dx >= 0.0 || b.contains(x), "{name}: inside but out of bounds at {x:?}");
        // A point within the distance is on the same side.
        let step = points.within(&Bounds { min: [-1.0; D], max: [1.0; D] }, 0.0);
        let mut near = x;
        for i in 0..D {
            near[i] += step[i] / distance(step, [0.0; D]) * dx.abs() * 0.999_999;
        }
        assert_eq!(dx < 0.0, shape.contains(near), "{name}: surface too near to {x:?}");
        let g = gradient(shape, x, 1e-6 * size);
        if (distance(g, [0.0; D]) - 1.0).abs() < 1e-4 {
            unit_gradients += 1;
            // The foot of the perpendicular is on the surface if the distance is exact.
            let mut foot = x;
            for i in 0..D {
                foot[i] -= dx * g[i];
            }
            let left = shape.signed_distance(foot).abs();
            assert!(left < 2e-3 * size, "{name}: {left} left at the foot of {x:?}");
        }
    }
    // All points except near ridges.
    assert!(unit_gradients > N * 99 / 100, "{name}: {unit_gradients} of {N} gradients have length one");
}

#[test]
fn distances_are_distances() {
    for (name, shape) in solids() {
        assert!(shape.exact_distance(), "{name}");
        check_distance(name, &shape);
    }
    for (name, shape) in plane_shapes() {
        assert!(shape.exact_distance(), "{name}");
        check_distance(name, &shape);
    }
}

#[test]
fn distances_of_combinations_are_bounds() {
    let ball = Sphere::new([0.0; 3], 0.6).unwrap();
    let block = Cuboid::new([0.0; 3], [1.0, 0.8, 0.7]).unwrap();
    let mut points = Points(7);
    let b = Bounds { min: [-1.0; 3], max: [1.3; 3] };
    let shapes: [&dyn Shape<3>; 3] = [&ball.or(block), &ball.and(block), &block.minus(ball)];
    for shape in shapes {
        assert!(!shape.exact_distance());
        for _ in 0..5000 {
            let (x, y) = (points.within(&b, 0.0), points.within(&b, 0.0));
            let (dx, dy) = (shape.signed_distance(x), shape.signed_distance(y));
            assert!((dx - dy).abs() <= distance(x, y) * (1.0 + 1e-12));
            assert!(dx >= 0.0 || shape.bounds().contains(x));
        }
    }
}

/// Measure and centroid by counting the points of a fine lattice.
fn counted<const D: usize>(
    shape: &dyn Shape<D>,
    n: usize,
    weight: impl Fn([f64; D]) -> f64,
) -> (f64, [f64; D]) {
    let b = shape.bounds();
    let (mut total, mut moment) = (0.0, [0.0; D]);
    let mut cell = 1.0;
    for i in 0..D {
        cell *= (b.max[i] - b.min[i]) / n as f64;
    }
    for code in 0..n.pow(D as u32) {
        let (mut x, mut rest) = ([0.0; D], code);
        for i in 0..D {
            x[i] = b.min[i] + ((rest % n) as f64 + 0.5) / n as f64 * (b.max[i] - b.min[i]);
            rest /= n;
        }
        if shape.contains(x) {
            let w = weight(x) * cell;
            total += w;
            for i in 0..D {
                moment[i] += w * x[i];
            }
        }
    }
    (total, moment.map(|m| m / total))
}

#[test]
fn measures_and_centroids_agree_with_counting() {
    for (name, shape) in solids() {
        let (v, c) = counted(&shape, 110, |_| 1.0);
        let exact = shape.measure().unwrap();
        assert!((v / exact - 1.0).abs() < 6e-3, "{name}: {v} counted, {exact} claimed");
        assert!(distance(c, shape.centroid().unwrap()) < 4e-3, "{name}: centroid {c:?}");
        let sampled = sampled_measure(&shape, Metric::Cartesian, 0.01).unwrap();
        assert!((sampled / exact - 1.0).abs() < 2e-5, "{name}: {sampled} sampled, {exact} claimed");
    }
    for (name, shape) in plane_shapes() {
        let (v, c) = counted(&shape, 1000, |_| 1.0);
        let exact = shape.measure().unwrap();
        assert!((v / exact - 1.0).abs() < 4e-3, "{name}: {v} counted, {exact} claimed");
        assert!(distance(c, shape.centroid().unwrap()) < 2e-3, "{name}: centroid {c:?}");
        let sampled = sampled_measure(&shape, Metric::Cartesian, 0.01).unwrap();
        assert!((sampled / exact - 1.0).abs() < 2e-5, "{name}: {sampled} sampled, {exact} claimed");
        let (v, _) = counted(&shape, 1000, |x| x[0]);
        let exact = shape.revolved_measure().unwrap();
        assert!((v / exact - 1.0).abs() < 4e-3, "{name}: {v} counted per radian, {exact} claimed");
        let sampled = sampled_measure(&shape, Metric::Axisymmetric, 0.01).unwrap();
        assert!((sampled / exact - 1.0).abs() < 2e-5, "{name}: {sampled} sampled, {exact} claimed");
    }
}

#[test]
fn bounds_are_tight() {
    for (name, shape) in solids() {
        // The bounding box of a rotated box is that of its rotated bounding box, hence not tight.
        if name == "turned" {
            continue;
        }
        let b = shape.bounds();
        for axis in 0..3 {
            for face in [b.min[axis], b.max[axis]] {
                let mut nearest = f64::INFINITY;
                for i in 0..=200 {
                    for j in 0..=200 {
                        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
                        let mut x = [face; 3];
                        x[p] = b.min[p] + i as f64 / 200.0 * (b.max[p] - b.min[p]);
                        x[q] = b.min[q] + j as f64 / 200.0 * (b.max[q] - b.min[q]);
                        nearest = nearest.min(shape.signed_distance(x));
                    }
                }
                assert!((-1e-12..1e-2).contains(&nearest), "{name}: face {axis} at {face} is {nearest} away");
            }
        }
    }
}

#[test]
fn the_rod_of_the_oblique_penetration() {
    let rod = OgiveRod::new([0.0; 3], [0.0, 0.0, 1.0], 12.9e-3, 88.9e-3, 3.0).unwrap();
    assert!((rod.measure().unwrap() - 1.0352e-5).abs() < 1e-9);
    assert!((rod.nose_length() - 21.39e-3).abs() < 5e-6);
    // Published formula for the volume of the nose: k pi a^2 l.
    let (psi, a) = (3.0f64, 6.45e-3);
    let root = (4.0 * psi - 1.0).sqrt();
    let k = 4.0 * psi * psi - 4.0 * psi / 3.0 + 1.0 / 3.0
        - 4.0 * psi * psi * (2.0 * psi - 1.0) / root * (root / (2.0 * psi)).asin();
    let expected = PI * a * a * (88.9e-3 - rod.nose_length() * (1.0 - k));
    assert!((rod.measure().unwrap() / expected - 1.0).abs() < 1e-13);
    // A nose of CRH 1/2 is a hemisphere.
    let blunt = OgiveRod::new([0.0; 3], [1.0, 1.0, 0.0], 2.0, 3.0, 0.5).unwrap();
    assert!((blunt.measure().unwrap() - PI * (2.0 + 2.0 / 3.0)).abs() < 1e-13);
    // On the axis of axisymmetric coordinates the section represents the same rod.
    let profile = OgiveRod::new([0.0, 0.5], [0.0, -2.0], 12.9e-3, 88.9e-3, 3.0).unwrap();
    assert!((profile.revolved_measure().unwrap() * 2.0 * PI - rod.measure().unwrap()).abs() < 1e-19);
    let sampled = sampled_measure(&profile, Metric::Axisymmetric, 1e-5).unwrap();
    assert!((sampled / profile.revolved_measure().unwrap() - 1.0).abs() < 1e-5);
}

#[test]
fn volumes_per_radian() {
    let full = |v: f64| 2.0 * PI * v;
    let cylinder = Cuboid::new([0.0, 1.0], [0.3, 3.0]).unwrap();
    assert!((cylinder.revolved_measure().unwrap() - 0.3 * 0.3 * 2.0 / 2.0).abs() < 1e-15);
    // The part at r < 0 does not count.
    let across = Cuboid::new([-0.7, 1.0], [0.3, 3.0]).unwrap();
    assert_eq!(across.revolved_measure(), cylinder.revolved_measure());
    let same = Cylinder::new([0.0, 1.0], [0.0, 1.0], 2.0, 0.3).unwrap();
    assert!((same.revolved_measure().unwrap() - 0.09).abs() < 1e-15);
    let sphere = Disc::new([0.0, 4.0], 0.5).unwrap();
    assert!((full(sphere.revolved_measure().unwrap()) - 4.0 / 3.0 * PI * 0.125).abs() < 1e-15);
    let torus = Disc::new([2.0, 0.0], 0.5).unwrap();
    assert!((full(torus.revolved_measure().unwrap()) - 2.0 * PI * PI * 2.0 * 0.25).abs() < 1e-13);
    // Spindle torus against sampling.
    for centre in [-0.3, -0.1, 0.2, 0.49, 0.51] {
        let spindle = Disc::new([centre, 0.0], 0.5).unwrap();
        let sampled = sampled_measure(&spindle, Metric::Axisymmetric, 1e-3).unwrap();
        assert!((sampled / spindle.revolved_measure().unwrap() - 1.0).abs() < 1e-4, "{centre}");
    }
    assert_eq!(Disc::new([-1.0, 0.0], 0.5).unwrap().revolved_measure(), Some(0.0));
    let hollow = Ring::new([0.0, 0.0], 0.3, 0.5).unwrap();
    assert!((full(hollow.revolved_measure().unwrap()) - 4.0 / 3.0 * PI * (0.125 - 0.027)).abs() < 1e-14);
    let cone = Polygon::new(vec![[0.0, 0.0], [0.5, 0.0], [0.0, 2.0]]).unwrap();
    assert!((full(cone.revolved_measure().unwrap()) - PI / 3.0 * 0.25 * 2.0).abs() < 1e-14);
    let moved = sphere.translated([0.0, 1.0]).unwrap().scaled(2.0, [0.0, 0.0]).unwrap();
    assert!((full(moved.revolved_measure().unwrap()) - 4.0 / 3.0 * PI).abs() < 1e-14);
    let aside = Disc::new([0.0, 0.0], 0.5).unwrap().translated([2.0, 0.0]).unwrap();
    assert!((aside.revolved_measure().unwrap() - torus.revolved_measure().unwrap()).abs() < 1e-14);
}

#[test]
fn combinations_know_their_measure_where_it_is_certain() {
    let block = Cuboid::new([0.0; 3], [2.0; 3]).unwrap();
    let ball = Sphere::new([1.0; 3], 0.9).unwrap();
    let far = Sphere::new([9.0; 3], 0.9).unwrap();
    let cutting = Sphere::new([2.0; 3], 0.9).unwrap();
    let v = ball.measure().unwrap();
    assert_eq!(block.minus(ball).measure(), Some(8.0 - v));
    assert_eq!(block.and(ball).measure(), Some(v));
    assert_eq!(block.or(ball).measure(), Some(8.0));
    assert_eq!(block.or(far).measure(), Some(8.0 + v));
    assert_eq!(block.minus(far).measure(), Some(8.0));
    assert_eq!(block.and(far).measure(), Some(0.0));
    assert_eq!(ball.minus(block).measure(), Some(0.0));
    for unknown in [block.minus(cutting).measure(), block.and(cutting).measure(), block.or(cutting).measure()]
    {
        assert_eq!(unknown, None);
    }
    let c = block.or(block.translated([2.0, 0.0, 0.0]).unwrap()).centroid().unwrap();
    assert!(distance(c, [2.0, 1.0, 1.0]) < 1e-15);
    let c = block.minus(Cuboid::new([1.0, 0.0, 0.0], [2.0; 3]).unwrap()).centroid().unwrap();
    assert!(distance(c, [0.5, 1.0, 1.0]) < 1e-15);
    // One eighth of the ball is in the block.
    let sampled = sampled_measure(&block.and(cutting), Metric::Cartesian, 0.01).unwrap();
    assert!((sampled / (v / 8.0) - 1.0).abs() < 1e-4, "{sampled} {}", v / 8.0);
}

#[test]
fn bad_input_is_refused() {
    let refused = |e: GeometryError, owner: &str, field: &str| match e {
        GeometryError::Parameter { owner: o, field: f, .. } => assert_eq!((o, f), (owner, field)),
        other => panic!("{other}"),
    };
    refused(Cuboid::new([0.0, 1.0], [1.0, 1.0]).unwrap_err(), "Cuboid", "opposite");
    refused(Cuboid::new([0.0, f64::NAN], [1.0, 1.0]).unwrap_err(), "Cuboid", "corner");
    refused(Ball::new([0.0], -1.0).unwrap_err(), "Ball", "radius");
    refused(Ball::new([0.0], f64::INFINITY).unwrap_err(), "Ball", "radius");
    refused(Ring::new([0.0; 2], 2.0, 1.0).unwrap_err(), "Shell", "outer");
    refused(Cylinder::new([0.0; 3], [0.0; 3], 1.0, 1.0).unwrap_err(), "Cylinder", "direction");
    refused(Tube::new([0.0; 3], [1.0; 3], 1.0, 0.0, 1.0).unwrap_err(), "Tube", "inner");
    refused(Frustum::new([0.0; 3], [1.0; 3], 1.0, [0.0, 0.0]).unwrap_err(), "Frustum", "radii");
    refused(OgiveRod::new([0.0; 3], [1.0; 3], 1.0, 1.0, 3.0).unwrap_err(), "ogive rod", "length");
    refused(OgiveRod::new([0.0; 3], [1.0; 3], 1.0, 1.0, 0.4).unwrap_err(), "ogive rod", "crh");
    refused(HalfSpace::new([0.0; 2], [0.0; 2]).unwrap_err(), "half-space", "outward");
    refused(Polygon::new(vec![[0.0; 2]; 2]).unwrap_err(), "Polygon", "corners");
    refused(Polygon::new(vec![[0.0; 2]; 4]).unwrap_err(), "Polygon", "area");
    let ball = Disc::new([0.0; 2], 1.0).unwrap();
    refused(ball.scaled(0.0, [0.0; 2]).unwrap_err(), "scaled", "factor");
    refused(ball.translated([f64::NAN, 0.0]).unwrap_err(), "translated", "offset");
    let skewed = nalgebra::Rotation::from_matrix_unchecked(nalgebra::Matrix2::new(1.0, 0.5, 0.0, 1.0));
    refused(ball.rotated(skewed, [0.0; 2]).unwrap_err(), "rotated", "rotation");
    refused(Lattice::new([0.0; 3], 0.0).unwrap_err(), "Lattice", "spacing");
    refused(Lattice::new([f64::NAN; 3], 1.0).unwrap_err(), "Lattice", "origin");
    let message = OgiveRod::new([0.0; 3], [1.0; 3], -1.0, 1.0, 0.4).unwrap_err().to_string();
    assert_eq!(message, "ogive rod: diameter = -1 is not allowed; it must be positive and finite");
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-2.0..2.0f64)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn combinations_are_sets(x in point(), c in point(), r in 0.1..2.0f64, corner in point()) {
        let a = Sphere::new(c, r).unwrap();
        let b = Cuboid::new(corner, [2.1, 2.2, 2.3]).unwrap();
        let (ia, ib) = (a.contains(x), b.contains(x));
        prop_assert_eq!(a.or(b).contains(x), ia || ib);
        prop_assert_eq!(a.and(b).contains(x), ia && ib);
        prop_assert_eq!(a.minus(b).contains(x), ia && !ib);
        prop_assert_eq!(a.or(b).signed_distance(x), b.or(a).signed_distance(x));
        prop_assert!(!b.minus(a.or(b)).contains(x));
        prop_assert_eq!(a.minus(a.minus(b)).contains(x), a.and(b).contains(x));
        // De Morgan: the complement of a union is the intersection of the complements.
        let all = Cuboid::new([-9.0; 3], [9.0; 3]).unwrap();
        prop_assert_eq!(
            all.minus(a.or(b)).signed_distance(x), all.minus(a).and(all.minus(b)).signed_distance(x)
        );
        prop_assert_eq!(
            all.minus(a.and(b)).signed_distance(x), all.minus(a).or(all.minus(b)).signed_distance(x)
        );
    }

    #[test]
    fn turning_shape_and_point_together_changes_nothing(
        x in point(), angle in point(), pivot in point(), axis in point(), factor in 0.2..5.0f64,
    ) {
        prop_assume!(Vector3::from(axis).norm() > 0.1);
        let tail = [0.1, 0.2, 0.3];
        let rod = OgiveRod::new(tail, axis, 0.5, 1.5, 2.0).unwrap();
        let rotation = Rotation3::new(Vector3::from(angle));
        let turn = |p: [f64; 3]| -> [f64; 3] {
            (rotation * (Vector3::from(p) - Vector3::from(pivot)) + Vector3::from(pivot)).into()
        };
        let turned = rod.rotated(rotation, pivot).unwrap();
        prop_assert!((turned.signed_distance(turn(x)) - rod.signed_distance(x)).abs() < 1e-13);
        // Reference: the rod created at its final position.
        let direction = (rotation * Vector3::from(axis)).into();
        let direct = OgiveRod::new(turn(tail), direction, 0.5, 1.5, 2.0).unwrap();
        prop_assert!((turned.signed_distance(x) - direct.signed_distance(x)).abs() < 1e-13);
        prop_assert_eq!(turned.measure(), rod.measure());
        prop_assert!(distance(turned.centroid().unwrap(), direct.centroid().unwrap()) < 1e-13);
        let (loose, tight) = (turned.bounds(), direct.bounds());
        for i in 0..3 {
            prop_assert!(loose.min[i] <= tight.min[i] + 1e-12 && loose.max[i] >= tight.max[i] - 1e-12);
        }
        let larger = rod.scaled(factor, pivot).unwrap();
        let mut y = pivot;
        for i in 0..3 {
            y[i] += factor * (x[i] - pivot[i]);
        }
        prop_assert!((larger.signed_distance(y) - factor * rod.signed_distance(x)).abs() < 1e-12);
        let ratio = larger.measure().unwrap() / rod.measure().unwrap();
        prop_assert!((ratio / factor.powi(3) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn rows_agree_with_points(start in point(), n in 2..60usize) {
        let last: Vec<f64> = (0..n).map(|i| -2.0 + 4.0 * i as f64 / n as f64).collect();
        let mut inside = vec![false; n];
        for (name, shape) in solids() {
            let cut = (&shape).minus(Sphere::new([0.2; 3], 0.3).unwrap());
            let both: [&dyn Shape<3>; 2] = [&shape, &cut];
            for shape in both {
                shape.contains_row(start, &last, &mut inside);
                for i in 0..n {
                    let x = [start[0], start[1], last[i]];
                    prop_assert_eq!(inside[i], shape.contains(x), "{} at {:?}", name, x);
                }
            }
        }
    }

    #[test]
    fn lattice_helpers_agree(x in point(), origin in point(), h in 0.01..3.0f64) {
        let lattice = Lattice::new(origin, h).unwrap();
        let cell = lattice.cell_of(x).unwrap();
        let b = lattice.cell_bounds(cell);
        let (node, local) = (lattice.node(cell), lattice.local(x));
        for i in 0..3 {
            prop_assert!(b.min[i] - 1e-12 <= x[i] && x[i] <= b.max[i] + 1e-12);
            prop_assert!((node[i] + local[i] * h - x[i]).abs() < 1e-12);
            prop_assert!((0.0..1.0 + 1e-12).contains(&local[i]));
        }
        prop_assert_eq!(lattice.cell_of(lattice.cell_centre(cell)), Some(cell));
        prop_assert!((lattice.cell_measure() / (h * h * h) - 1.0).abs() < 1e-13);
    }
}
