//! Free rigid bodies on walls and fixed planes, against exact solutions.

use crate::common::{H, cuboid, lattice, particles};
use mpm_contact::{Coulomb, Pairs, SurfaceDistance};
use mpm_core::geometry::{Ball, Filling, Seeds, fill, rings};
use mpm_core::{
    Apic, BlockGrid, Boundary, CpGimp, Flip, FullSpace, GridContact, IntoKernels, Linear, Method, Mpm, Musl,
    PlaneStrain, QuadraticBSpline, Rigid, Side, Team, TimeControl, Usf, Usl,
};

const DT: f64 = 1e-3;

fn scene<const D: usize>(method: impl IntoKernels<f64, D>, gravity: [f64; D]) -> Mpm<D> {
    let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Coulomb::new(0.5).expect("law")));
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    mpm.set_time_control(TimeControl::Fixed(DT)).expect("control");
    mpm.set_body_force(move |_| gravity);
    mpm
}

fn free<const D: usize>() -> Rigid<D> {
    Rigid::free(2000.0).expect("rigid")
}

fn rough<const D: usize>(axis: usize, at: f64, side: Side, friction: f64) -> Boundary<D> {
    Boundary::FrictionWall { axis, at, side, velocity: [0.0; D], friction }
}

/// Check that a box dropped from 2 cells comes to rest on a plane, which carries its weight, and stays.
fn rests(method: impl IntoKernels<f64, 2>, plane: Boundary<2>, axis: usize, up: f64, steps: usize) {
    let (at, mut gravity) = (1.0, [0.0; 2]);
    gravity[axis] = -up * 9.81;
    let mut mpm = scene(method, gravity);
    mpm.bound(plane).expect("plane");
    let ([mut low, mut high], size) = ([[0.3; 2], [0.3; 2]], [4.0 * H, 6.0 * H]);
    high[1 - axis] += size[1];
    (low[axis], high[axis]) =
        if up > 0.0 { (at + 2.0 * H, at + 6.0 * H) } else { (at - 6.0 * H, at - 2.0 * H) };
    mpm.add_rigid("box", &free(), &cuboid(low, high)).expect("box");
    mpm.run_until(0.3).expect("run");
    let (start, steps_before) = (mpm.exchange().impulse[axis], mpm.time());
    let place = |mpm: &Mpm<2>| mpm.bodies()[0].rigid().expect("rigid").centre();
    let landed = place(&mpm);
    assert!((landed[axis] - at - up * 2.0 * H).abs() < 1e-9, "landed at {landed:?}");
    for _ in 0..steps {
        mpm.step().expect("step");
    }
    let force = (mpm.exchange().impulse[axis] - start) / (mpm.time() - steps_before);
    let weight = 9.81 * mpm.bodies()[0].rigid().expect("rigid").mass();
    assert!((up * force / weight - 1.0).abs() < 1e-9, "a force of {force} N carries {weight} N");
    let now = place(&mpm);
    (0..2).for_each(|d| assert!((now[d] - landed[d]).abs() < 1e-12, "creeps from {landed:?} to {now:?}"));
}

#[test]
fn bodies_rest_on_planes() {
    let wall = |axis, side| Boundary::Wall { axis, at: 1.0, side, velocity: 0.0 };
    rests(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), wall(1, Side::Above), 1, 1.0, 2000);
    rests(Method::new(Linear, Flip, Musl, PlaneStrain), wall(0, Side::Below), 0, -1.0, 500);
    let fixed = |axis, side| Boundary::Fixed { axis, at: 1.0, side };
    rests(Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled(), fixed(1, Side::Below), 1, -1.0, 500);
    rests(Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain), fixed(0, Side::Above), 0, 1.0, 500);
    // Plane between nodes.
    let between = Boundary::Wall { axis: 1, at: 1.0, side: Side::Above, velocity: 0.0 };
    rests(Method::new(CpGimp, Flip, Usl, PlaneStrain), between, 1, 1.0, 500);
}

#[test]
#[ignore = "a minute"]
fn a_body_rests_for_a_hundred_thousand_steps() {
    let wall = Boundary::Wall { axis: 1, at: 1.0, side: Side::Above, velocity: 0.0 };
    rests(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), wall, 1, 1.0, 100_000);
}

#[test]
fn blocks_slide_on_friction_walls() {
    for (mu, g) in [(0.3, [5.0, -8.0]), (0.7, [5.0, -8.0])] {
        let mut mpm = scene(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), g);
        mpm.bound(rough(1, 1.0, Side::Above, mu)).expect("wall");
        mpm.add_rigid("block", &free(), &cuboid([0.2, 1.0], [0.7, 1.2])).expect("block");
        mpm.run_until(0.5).expect("run");
        let due = (5.0 - 8.0 * mu).max(0.0) * mpm.time();
        let state = mpm.bodies()[0].rigid().expect("rigid");
        assert!((state.velocity()[0] - due).abs() < 1e-7, "{} m/s and not {due}", state.velocity()[0]);
        assert!(state.spin()[2].abs() < 1e-7, "it turns");
        let books = mpm.exchange();
        let missing = mpm.totals().kinetic - books.work + books.friction + books.impacts;
        assert!(missing.abs() < 1e-9 * books.work.abs().max(1.0), "energy: {missing:e} J");
    }
}

/// Check that a disc and a ball roll at g sin a / (1 + I / (m R^2)), with the inertia of their particles.
fn rolls<const D: usize>(
    method: impl IntoKernels<f64, D>,
    seeds: &Seeds<D>,
    radius: f64,
    share: f64,
    mu: f64,
) {
    let mut gravity = [0.0; D];
    (gravity[0], gravity[1]) = (3.0, -9.0);
    let mut mpm = scene(method, gravity);
    mpm.bound(rough(1, 1.0, Side::Above, mu)).expect("wall");
    mpm.add_rigid("round", &free(), seeds).expect("body");
    mpm.run_until(0.4).expect("run");
    let state = mpm.bodies()[0].rigid().expect("rigid");
    let (speed, due) = (state.velocity()[0], share * 3.0 * mpm.time());
    println!("{D} dimensions: speed {} of {due}, centre {}", speed / due, state.centre()[1] - 1.0);
    assert!((speed / due - 1.0).abs() < 0.01, "{speed} m/s and not {due}");
    assert!((state.spin()[2] * radius / due + 1.0).abs() < 0.01, "spin {}", state.spin()[2]);
    assert!(
        (state.centre()[1] - 1.0 - radius).abs() < 0.05 * H,
        "centre {} m above the wall",
        state.centre()[1] - 1.0
    );
}

#[test]
fn discs_and_balls_roll_on_friction_walls() {
    let disc =
        |centre, radius| fill(&Ball::new(centre, radius).expect("ball"), &lattice(), 2, &Filling::new());
    for radius in [4.0, 6.3, 10.0].map(|cells| cells * H) {
        let seeds = disc([0.5, 1.0 + radius], radius).expect("seeds");
        rolls(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), &seeds, radius, 2.0 / 3.0, 0.15);
    }
    let seeds = rings([0.5, 1.3], 0.3, 12).expect("rings");
    rolls(Method::new(Linear, Flip, Musl, PlaneStrain), &seeds, 0.3, 2.0 / 3.0, 0.15);
    let ball = fill(&Ball::new([0.5, 1.25, 0.4], 0.25).expect("ball"), &lattice(), 2, &Filling::new());
    rolls(Method::new(CpGimp, Flip, Musl, FullSpace), &ball.expect("seeds"), 0.25, 5.0 / 7.0, 0.15);
}

/// A moving wall carries a body along by friction, and its work is booked.
#[test]
fn walls_that_move_carry_bodies() {
    let mut mpm = scene(Method::new(CpGimp, Flip, Musl, PlaneStrain), [0.0, -10.0]);
    let velocity = [0.5, 0.3];
    mpm.bound(Boundary::FrictionWall { axis: 1, at: 1.0, side: Side::Above, velocity, friction: 0.4 })
        .expect("wall");
    mpm.add_rigid("block", &free(), &cuboid([0.2, 1.0], [0.7, 1.2])).expect("block");
    mpm.run_until(0.4).expect("run");
    let state = mpm.bodies()[0].rigid().expect("rigid");
    (0..2).for_each(|d| assert!((state.velocity()[d] - velocity[d]).abs() < 1e-9, "{:?}", state.velocity()));
    assert!((state.centre()[1] - 1.1 - 0.3 * mpm.time()).abs() < 1e-9, "{:?}", state.centre());
    let books = mpm.exchange();
    let missing = mpm.totals().kinetic - books.work + books.friction + books.impacts;
    assert!(missing.abs() < 1e-9 * books.work, "energy: {missing:e} J");
}

/// A stack on a wall, thrown at another wall: identical for any number of threads, and no body penetrates a wall.
#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let mut mpm = scene(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain), [6.0, -10.0]);
        mpm.bound(rough(1, 1.0, Side::Above, 0.2)).expect("wall");
        mpm.bound(Boundary::Wall { axis: 0, at: 1.3, side: Side::Below, velocity: 0.0 }).expect("wall");
        mpm.add_rigid("lower", &free(), &cuboid([0.2, 1.05], [0.7, 1.2])).expect("lower");
        mpm.add_rigid("upper", &free(), &cuboid([0.3, 1.25], [0.5, 1.45])).expect("upper");
        mpm.set_team(Team::new(threads).expect("team"));
        mpm.run_until(0.8).expect("run");
        particles(&mpm)
    };
    let one = run(1);
    for p in one.iter().flatten() {
        assert!(p.position[0] < 1.3 && p.position[1] > 1.0, "{:?} is behind a wall", p.position);
    }
    assert!((2..=3).all(|threads| run(threads) == one));
}
