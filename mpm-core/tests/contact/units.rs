//! Scale of the length: a scene a thousand times smaller or larger, with times in proportion, has the same motion. Lengths
//! change by powers of two, which are exact.

use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::{
    BlockGrid, Boundary, ContactAlgorithm, FullSpace, GridContact, IntoKernels, Method, Mpm, PlaneStrain,
    Side,
};
use mpm_materials::{Moduli, NeoHookean};

/// Edge of a cell, m, at scale one.
const H: f64 = 0.125;

fn contact<const D: usize>() -> impl ContactAlgorithm<f64, D> {
    GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.3).expect("law")))
}

/// Return the positions over the scale after a ball hit a block on a wall with friction, beside a plane of symmetry.
fn places<const D: usize>(method: impl IntoKernels<f64, D>, scale: f64, per_axis: usize) -> Vec<f64> {
    let h = scale * H;
    let lattice = Lattice::new([0.0; D], h).expect("a lattice");
    let law = NeoHookean::new(1000.0, Moduli::young_poisson(1.0e6, 0.3).expect("moduli")).expect("a law");
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice), contact::<D>());
    let mut high = [6.0 * h; D];
    high[D - 1] = 4.0 * h;
    let block = Cuboid::new([0.0; D], high).expect("a block");
    let mut centre = [3.0 * h; D];
    centre[D - 1] = 6.125 * h;
    let ball = Ball::new(centre, 2.0 * h).expect("a ball");
    let mut down = [1.0; D];
    down[D - 1] = -4.0;
    for (name, seeds, velocity) in [
        ("block", fill(&block, &lattice, per_axis, &Filling::new()), [0.0; D]),
        ("ball", fill(&ball, &lattice, per_axis, &Filling::new()), down),
    ] {
        mpm.add(name, law, &seeds.expect("particles"), |_| velocity).expect("a body");
    }
    mpm.bound(Boundary::Symmetry { axis: 0, at: 0.0, side: Side::Above }).expect("a plane");
    let (axis, velocity) = (D - 1, [0.0; D]);
    let wall = Boundary::FrictionWall { axis, at: 0.0, side: Side::Above, velocity, friction: 0.5 };
    mpm.bound(wall).expect("a wall");
    for _ in 0..60 {
        mpm.step().expect("a step");
    }
    assert!(
        mpm.contacts().iter().any(|pair| pair.taken > 0.0),
        "no contact at scale {scale}, {per_axis} an axis"
    );
    let mut list = Vec::new();
    for body in mpm.bodies() {
        body.points().iter().for_each(|p| list.extend(p.position.map(|x| x / scale)));
    }
    list
}

fn same_at_all_scales<const D: usize>(name: &str, run: impl Fn(f64, usize) -> Vec<f64>) {
    for per_axis in [1, 2] {
        let one = run(1.0, per_axis);
        for power in [-10, 10] {
            let other = run(2f64.powi(power), per_axis);
            let off = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / H;
            assert!(
                off < 1e-9,
                "{name} in {D} dimensions, {per_axis} an axis, scale 2^{power}: {off:e} cells"
            );
        }
    }
}

#[test]
fn motion_does_not_depend_on_the_unit_of_length() {
    same_at_all_scales::<2>("impact", |s, n| places(Method::impact(PlaneStrain), s, n));
    same_at_all_scales::<3>("impact", |s, n| places(Method::impact(FullSpace), s, n));
    same_at_all_scales::<2>("machine parts", |s, n| places(Method::machine_parts(PlaneStrain), s, n));
    same_at_all_scales::<3>("contact at rest", |s, n| places(Method::contact_at_rest(FullSpace), s, n));
}
