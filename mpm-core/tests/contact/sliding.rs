//! Blocks that slide on blocks: no edge ploughs, and a contact without pressure does not brake, for any direction of the faces.

use mpm_contact::{Coulomb, Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Compose, Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    Apic, BlockGrid, Flip, FullSpace, GridContact, IntoKernels, Kernels, Linear, Method, Mpm, Musl,
    PlaneStrain, QuadraticBSpline, Rigid, Twist, Usl,
};
use mpm_materials::{Moduli, NeoHookean};
use nalgebra::{Rotation2, Rotation3};

const SPEED: f64 = 2.0;

fn laws(friction: f64) -> Pairs<f64> {
    if friction > 0.0 { Pairs::new(Coulomb::new(friction).expect("law")) } else { Pairs::new(Frictionless) }
}

fn rubber() -> NeoHookean<f64> {
    NeoHookean::new(1000.0, Moduli::young_poisson(1e7, 0.3).expect("moduli")).expect("law")
}

/// Type of the lower body.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Floor {
    Free,
    Rigid,
}

/// Return the velocity of the upper block at the end, tangential and normal to the faces.
fn slide(
    method: Kernels<f64, 2>,
    degrees: f64,
    h: f64,
    floor: Floor,
    [friction, gravity, end]: [f64; 3],
) -> [f64; 2] {
    let lattice = Lattice::new([0.013, 0.007], h).expect("lattice");
    let angle = degrees.to_radians();
    let (s, c) = angle.sin_cos();
    let block = |low: [f64; 2], high: [f64; 2]| -> Seeds<2> {
        let shape =
            Cuboid::new(low, high).expect("block").rotated(Rotation2::new(angle), [0.0; 2]).expect("turned");
        fill(&shape, &lattice, 2, &Filling::new()).expect("seeds")
    };
    let contact = GridContact::new(SurfaceDistance::default(), laws(friction));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact);
    mpm.add("block", rubber(), &block([0.0, 0.0], [0.4, 0.2]), |_| [SPEED * c, SPEED * s]).expect("block");
    let low = block([-0.3, -0.3], [1.3, 0.0]);
    match floor {
        Floor::Free => mpm.add("floor", rubber(), &low, |_| [0.0; 2]).expect("floor"),
        Floor::Rigid => {
            let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid");
            mpm.add_rigid("floor", &still, &low).expect("floor");
        }
    }
    mpm.set_body_force(move |_| [s * gravity, -c * gravity]);
    mpm.run_until(end).expect("run");
    let (mut mass, mut p) = (0.0, [0.0; 2]);
    mpm.bodies()[0].for_each(&mut |q| {
        mass += q.mass;
        (0..2).for_each(|d| p[d] += q.mass * q.velocity[d]);
    });
    [(c * p[0] + s * p[1]) / mass, (c * p[1] - s * p[0]) / mass]
}

fn methods() -> [(&'static str, Kernels<f64, 2>); 2] {
    [
        ("linear FLIP", Method::new(Linear, Flip, Musl, PlaneStrain).into_kernels()),
        ("quadratic APIC", Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).into_kernels()),
    ]
}

/// Without load there is no friction and no separation: the exact speed is the initial one.
#[test]
fn faces_that_touch_slide_freely() {
    for (name, method) in methods() {
        for degrees in [0.0, 45.0, 23.0] {
            for floor in [Floor::Free, Floor::Rigid] {
                for friction in [0.0, 0.5] {
                    let [along, across] = slide(method.clone(), degrees, 0.05, floor, [friction, 0.0, 0.1]);
                    let what = format!(
                        "{name}, {degrees} degrees, {floor:?}, friction {friction}: {along} {across}"
                    );
                    assert!((along / SPEED - 1.0).abs() < 1e-3 && across.abs() < 1e-3 * SPEED, "{what}");
                }
            }
        }
    }
}

/// Under its weight the block is decelerated by mu g alone. The remaining normal velocity is its elastic vibration:
/// the weight is applied at once, which causes up to g L / c = 0.02 m/s.
#[test]
fn friction_is_that_of_the_weight() {
    for (name, method) in methods() {
        for (degrees, h) in [(0.0, 0.05), (45.0, 0.05), (23.0, 0.05), (0.0, 0.025)] {
            let [along, across] = slide(method.clone(), degrees, h, Floor::Rigid, [0.2, 10.0, 0.3]);
            let exact = SPEED - 0.2 * 10.0 * 0.3;
            let what = format!("{name}, {degrees} degrees, h {h}: {along} {across}");
            assert!((along / exact - 1.0).abs() < 0.01 && across.abs() < 0.02, "{what}");
        }
    }
}

/// Sliding blocks in three dimensions, with faces rotated about two axes.
#[test]
fn blocks_slide_in_space() {
    let h = 0.1;
    let lattice = Lattice::new([0.013, 0.007, -0.021], h).expect("lattice");
    for (name, method) in [
        ("linear FLIP", Method::new(Linear, Flip, Musl, FullSpace).into_kernels()),
        ("quadratic APIC", Method::new(QuadraticBSpline, Apic, Usl, FullSpace).into_kernels()),
    ] {
        for turn in [
            Rotation3::identity(),
            Rotation3::from_euler_angles(0.0, 0.0, 0.785),
            Rotation3::from_euler_angles(0.4, 0.2, 0.5),
        ] {
            let block = |low: [f64; 3], high: [f64; 3]| {
                let shape = Cuboid::new(low, high).expect("block").rotated(turn, [0.0; 3]).expect("turned");
                fill(&shape, &lattice, 2, &Filling::new()).expect("seeds")
            };
            let velocity: [f64; 3] = (turn * nalgebra::Vector3::new(SPEED, 0.0, 0.0)).into();
            let contact = GridContact::new(SurfaceDistance::default(), laws(0.5));
            let mut mpm = Mpm::with_contact(method.clone(), BlockGrid::new(lattice), contact);
            mpm.add("block", rubber(), &block([0.0, 0.0, 0.0], [0.4, 0.2, 0.3]), |_| velocity)
                .expect("block");
            mpm.add("floor", rubber(), &block([-0.3, -0.3, -0.2], [1.0, 0.0, 0.5]), |_| [0.0; 3])
                .expect("floor");
            mpm.run_until(0.05).expect("run");
            let (mut mass, mut p) = (0.0, nalgebra::Vector3::zeros());
            mpm.bodies()[0].for_each(&mut |q| {
                mass += q.mass;
                p += q.mass * nalgebra::Vector3::from(q.velocity);
            });
            let v = turn.inverse() * p / mass;
            let off = (v - nalgebra::Vector3::new(SPEED, 0.0, 0.0)).norm();
            assert!(off < 1e-3 * SPEED, "{name}, {turn}: {v}");
        }
    }
}
