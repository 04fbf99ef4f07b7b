//! Initial states of bodies that are not virgin.

use impactite_tests::compare::particles;
use impactite_tests::scene::{DENSITY, block, rubber, wave_speed};
use mpm_core::SceneError;
use mpm_core::geometry::Lattice;
use mpm_core::{
    BlockGrid, Boundary, Deformable, Flip, Gimp, Method, Mpm, Musl, PlaneStrain, Side, TimeControl,
};
use mpm_materials::elastic::HyperelasticState;
use mpm_materials::{Constitutive, Mat3, NeoHookean};

const H: f64 = 0.1;
const HEIGHT: f64 = 1.2;
/// Strain at the foot of a column under its own weight.
const COMPRESSION: f64 = 1e-3;

fn column(lattice: Lattice<2>, gravity: f64) -> Mpm<2> {
    let mut mpm = Mpm::new(Method::new(Gimp, Flip, Musl, PlaneStrain).compiled(), BlockGrid::new(lattice));
    let plane = |axis, at, side| Boundary::Symmetry { axis, at, side };
    mpm.bound(plane(1, 0.0, Side::Above)).expect("floor");
    mpm.bound(plane(0, 0.0, Side::Above)).expect("side");
    mpm.bound(plane(0, 3.0 * H, Side::Below)).expect("side");
    mpm.set_body_force(move |_| [0.0, -gravity]);
    mpm.set_time_control(TimeControl::Fixed(0.2 * H / wave_speed())).expect("time control");
    mpm
}

/// Return the state of a neo-Hookean point compressed along y.
fn pressed(strain: f64) -> HyperelasticState<f64> {
    let mut deformation = Mat3::identity();
    deformation.0[1][1] = 1.0 - strain;
    HyperelasticState { deformation }
}

/// A column with the initial stress of its weight stays at rest; a virgin one falls and bounces.
#[test]
fn a_body_may_start_in_equilibrium() {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds = block(&lattice, [0, 0], [3, 12], 2, 0.0);
    // rho g (height - y) = rho c^2 strain, up to the square of the strain.
    let gravity = COMPRESSION * wave_speed().powi(2) / HEIGHT;
    let strain = |y: f64| COMPRESSION * (HEIGHT - y) / HEIGHT;
    let fastest = |mut mpm: Mpm<2>| {
        let mut fastest = 0.0f64;
        // Half of the longest period.
        while mpm.time() < 2.0 * HEIGHT / wave_speed() {
            mpm.step().expect("step");
            fastest = particles(&mpm)[0].iter().map(|p| p.velocity[1].abs()).fold(fastest, f64::max);
        }
        fastest
    };
    let (mut virgin, mut settled) = (column(lattice, gravity), column(lattice, gravity));
    virgin.add("column", rubber(), &seeds, |_| [0.0; 2]).expect("body");
    settled
        .add_body(Deformable::new("column", rubber(), &seeds).in_state(|[_, y]| pressed(strain(y))))
        .expect("body");
    for (p, x) in particles(&settled)[0].iter().zip(&seeds.positions) {
        let mass = DENSITY * seeds.volumes[p.number] / (1.0 - strain(x[1]));
        assert!((p.mass / mass - 1.0).abs() < 1e-14, "the seed's volume is the pressed one: {}", p.mass);
        assert_eq!(p.stress[1], rubber().stress(&pressed(strain(x[1]))).0[1]);
    }
    let (bouncing, resting) = (fastest(virgin), fastest(settled));
    assert!(resting < 0.01 * bouncing, "{resting:e} against {bouncing:e}");
}

/// Equal masses of all particles are stored once per body, not per particle; results are unchanged.
#[test]
fn equal_masses_are_not_carried() {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds = block(&lattice, [0, 0], [3, 12], 2, 0.0);
    let rising = |[_, y]: [f64; 2]| [0.0, 0.2 * wave_speed() * y / HEIGHT];
    let (mut equal, mut own) = (column(lattice, 0.0), column(lattice, 0.0));
    equal.add("column", rubber(), &seeds, rising).expect("body");
    // Bodies with an initial state store particle masses, since points may differ in density; here they are equal.
    own.add_body(Deformable::new("column", rubber(), &seeds).moving(rising).in_state(|_| pressed(0.0)))
        .expect("body");
    assert_eq!(equal.bodies()[0].particle_bytes() + 8, own.bodies()[0].particle_bytes());
    for _ in 0..60 {
        equal.step().expect("step");
        own.step().expect("step");
    }
    let (equal, own) = (particles(&equal), particles(&own));
    let top = equal[0].iter().map(|p| p.position[1]).fold(0.0, f64::max);
    assert!(top > HEIGHT + 0.5 * H, "particles must change their bins: {top}");
    for (a, b) in equal[0].iter().zip(&own[0]) {
        assert_eq!((a.mass, a.position, a.velocity, a.stress), (b.mass, b.position, b.velocity, b.stress));
    }
}

#[test]
fn a_state_that_cannot_be_is_refused() {
    let lattice = Lattice::new([0.0; 2], H).expect("lattice");
    let seeds = block(&lattice, [0, 0], [3, 12], 2, 0.0);
    let refusal = |state: &dyn Fn([f64; 2]) -> HyperelasticState<f64>| {
        let law: NeoHookean<f64> = rubber();
        let body = Deformable::new("column", law, &seeds).in_state(state);
        column(lattice, 1.0).add_body(body).expect_err("refusal")
    };
    let high = seeds.positions.iter().position(|x| x[1] > 1.0).expect("a high one");
    for (strain, what) in
        [(f64::NAN, "number of the initial state"), (1.5, "volume ratio of the initial state")]
    {
        let error = refusal(&|[_, y]| pressed(if y > 1.0 { strain } else { 0.0 }));
        match error {
            SceneError::Seed { body, particle, field, .. } => {
                assert_eq!((body.as_str(), particle, field), ("column", high, what));
            }
            other => panic!("{other}"),
        }
    }
}
