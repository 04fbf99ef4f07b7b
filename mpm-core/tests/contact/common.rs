//! Scenes of rubber bodies in two and three dimensions.

use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    BlockGrid, ContactAlgorithm, Flip, FullSpace, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain,
    PointView,
};
use mpm_materials::{Moduli, NeoHookean};

pub const H: f64 = 0.05;
pub const YOUNG: f64 = 1.0e6;
/// Speed of longitudinal waves, m/s: Young's modulus 1 MPa, Poisson's ratio 0.3, 1000 kg/m^3.
pub const WAVE: f64 = 36.689969285267;

pub type LinearFlip<const D: usize, E> = Method<Linear, Flip, Musl, E>;

pub fn rubber() -> NeoHookean<f64> {
    NeoHookean::new(1000.0, Moduli::young_poisson(YOUNG, 0.3).expect("moduli")).expect("rubber")
}

pub fn lattice<const D: usize>() -> Lattice<D> {
    Lattice::new([0.0; D], H).expect("lattice")
}

pub fn ball<const D: usize>(centre: [f64; D], radius: f64) -> Seeds<D> {
    fill(&Ball::new(centre, radius).expect("ball"), &lattice(), 2, &Filling::new()).expect("seeds")
}

pub fn cuboid<const D: usize>(low: [f64; D], high: [f64; D]) -> Seeds<D> {
    fill(&Cuboid::new(low, high).expect("cuboid"), &lattice(), 2, &Filling::new()).expect("seeds")
}

pub type Scene<const D: usize> = Vec<(Seeds<D>, [f64; D])>;

pub fn build<const D: usize>(
    method: impl IntoKernels<f64, D>,
    contact: impl ContactAlgorithm<f64, D>,
    scene: &Scene<D>,
) -> Mpm<D> {
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    for (n, (seeds, velocity)) in scene.iter().enumerate() {
        mpm.add(&format!("body {n}"), rubber(), seeds, |_| *velocity).expect("body");
    }
    mpm
}

pub fn plane() -> LinearFlip<2, PlaneStrain> {
    Method::new(Linear, Flip, Musl, PlaneStrain)
}
pub fn space() -> LinearFlip<3, FullSpace> {
    Method::new(Linear, Flip, Musl, FullSpace)
}

/// Create two balls in an off-centre impact.
pub fn two<const D: usize>(speed: f64) -> Scene<D> {
    let (mut a, mut b) = ([0.3; D], [0.3; D]);
    (a[0], b[0], b[1]) = (0.2, 0.63, 0.4);
    let (mut v, mut w) = ([0.0; D], [0.0; D]);
    (v[0], w[0]) = (speed, -speed);
    vec![(ball(a, 0.2), v), (ball(b, 0.2), w)]
}

/// Create three discs that collide in one place at once.
pub fn three(speed: f64) -> Scene<2> {
    let at = |angle: f64, r: f64| [0.5 + r * angle.cos(), 0.5 + r * angle.sin()];
    let third = 2.0 * std::f64::consts::PI / 3.0;
    (0..3)
        .map(|n| {
            let angle = 0.3 + third * f64::from(n);
            let inwards = at(angle + std::f64::consts::PI, speed);
            (ball(at(angle, 0.22), 0.17), [inwards[0] - 0.5, inwards[1] - 0.5])
        })
        .collect()
}

/// Return the particles of every body, by number.
pub fn particles<const D: usize>(mpm: &Mpm<D>) -> Vec<Vec<PointView>> {
    mpm.bodies().iter().map(|body| body.points()).collect()
}
