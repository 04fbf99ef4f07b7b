//! Block on an incline with friction: gravity is rotated, the wall is across an axis.
//!
//! The block sticks where tan a < mu, else it slides with g (sin a - mu cos a).

use super::*;
use mpm_core::{Exchange, FullSpace, Method, PlaneStrain};

/// Gravity, m/s^2.
const G: f64 = 10.0;
const H: f64 = 0.1;

/// Create a block that moves along axis 0, on a wall across the last axis.
fn on_a_wall<const D: usize>(
    mut mpm: Mpm<D>,
    seeds: &Seeds<D>,
    angle: f64,
    friction: f64,
    speed: f64,
) -> Mpm<D> {
    let mut velocity = [0.0; D];
    velocity[0] = speed;
    mpm.add("block", law(), seeds, |_| velocity).expect("block");
    let floor =
        Boundary::FrictionWall { axis: D - 1, at: 0.0, side: Side::Above, velocity: [0.0; D], friction };
    mpm.bound(floor).expect("floor");
    mpm.set_body_force(move |_| {
        let mut g = [0.0; D];
        (g[0], g[D - 1]) = (G * angle.sin(), -G * angle.cos());
        g
    });
    mpm
}

fn plane(angle: f64, friction: f64, speed: f64) -> Mpm<2> {
    let (lattice, seeds) = block([0.0, 0.0], [1.2, 0.3], H);
    let mpm = Mpm::new(Method::contact_at_rest(PlaneStrain), BlockGrid::new(lattice));
    on_a_wall(mpm, &seeds, angle, friction, speed)
}

fn space(angle: f64, friction: f64) -> Mpm<3> {
    let (lattice, seeds) = block([0.0; 3], [1.2, 0.3, 0.3], H);
    let mpm = Mpm::new(Method::contact_at_rest(FullSpace), BlockGrid::new(lattice));
    on_a_wall(mpm, &seeds, angle, friction, 0.0)
}

/// Mean velocity along the incline, m/s.
fn speed<const D: usize>(mpm: &Mpm<D>) -> f64 {
    mpm.totals().momentum[0] / mpm.totals().mass
}

/// Return the mean acceleration between two times, m/s^2, and the exchange in between.
fn slides<const D: usize>(mpm: &mut Mpm<D>, from: f64, to: f64) -> (f64, Exchange) {
    mpm.run_until(from).expect("a settled block");
    let (before, start) = (mpm.exchange(), speed(mpm));
    mpm.run_until(to).expect("a sliding block");
    let mut given = mpm.exchange();
    for d in 0..3 {
        given.impulse[d] -= before.impulse[d];
    }
    given.friction -= before.friction;
    given.work -= before.work;
    ((speed(mpm) - start) / (to - from), given)
}

#[test]
fn a_block_slides_as_newton_and_coulomb_say() {
    let (angle, friction) = (30f64.to_radians(), 0.4);
    let exact = G * (angle.sin() - friction * angle.cos());
    for (name, (a, given), mass, slip) in [
        {
            let mut mpm = plane(angle, friction, 0.0);
            let found = slides(&mut mpm, 0.4, 1.2);
            ("plane strain", found, mpm.totals().mass, 0.5 * exact * (1.44 - 0.16))
        },
        {
            let mut mpm = space(angle, friction);
            let found = slides(&mut mpm, 0.4, 1.2);
            ("three dimensions", found, mpm.totals().mass, 0.5 * exact * (1.44 - 0.16))
        },
    ] {
        println!("{name}: {a} m/s^2, exact {exact}");
        assert!((a / exact - 1.0).abs() < 0.01, "{name}: {a} m/s^2, exact {exact}");
        // All contact points slip the same way, in space a little to the sides as well: the tangential impulse of the
        // wall is mu times the normal one.
        let ratio = -given.impulse[0] / given.impulse[if name == "plane strain" { 1 } else { 2 }];
        println!("{name}: impulse along over across {ratio}");
        let sides = if name == "plane strain" { 0.0 } else { 1e-3 };
        assert!((ratio / friction - 1.0).abs() < 1e-4 + sides, "{name}: {ratio}");
        // Friction on the slip of a block that starts at rest. The foot of an elastic block that slides vibrates
        // \[Adams1995\], and slips a little less than its middle.
        let heat = mass * G * friction * angle.cos() * slip;
        println!("{name}: heat {} J, exact {heat}", given.friction);
        assert!(
            (given.friction / heat - 1.0).abs() < 0.05,
            "{name}: heat {} J, exact {heat}",
            given.friction
        );
    }
}

#[test]
fn a_block_sticks_below_the_angle_of_friction() {
    let mut mpm = plane(15f64.to_radians(), 0.4, 0.0);
    mpm.run_until(1.0).expect("a block at rest");
    let (slow, exchange) = (speed(&mpm).abs(), mpm.exchange());
    let moved = mpm.bodies()[0].points().iter().map(|p| p.position[0]).fold(f64::INFINITY, f64::min) - 0.025;
    println!("speed {slow} m/s, moved {moved} m, heat {} J", exchange.friction);
    // It would slide 1.3 m without friction. Its shear under its own weight is rho g H sin a / G H / 2 = 0.3 mm, and
    // it slips while it settles on the floor at first.
    assert!(slow < 1e-3 && moved.abs() < 4e-3, "{slow} m/s after {moved} m");
    // Its corners, with the lowest pressure, slip last, and ever less.
    let mut heat_until = |time| {
        mpm.run_until(time).expect("a block at rest");
        mpm.exchange().friction
    };
    let [first, then, late, end] = [1.0, 1.2, 5.0, 5.2].map(&mut heat_until);
    println!("heat {} J, then {} J", then - first, end - late);
    assert!(end - late < 0.3 * (then - first) && then - first < 1e-3 * first, "heat without slip");
}

#[test]
fn friction_does_not_depend_on_who_moves() {
    // A belt under a block at rest, and the same motion seen from the belt: a block on a floor at rest.
    let (lattice, seeds) = block([0.0, 0.0], [0.8, 0.4], H);
    let run = |block: f64, belt: f64| {
        let method = Method::new(mpm_core::Linear, mpm_core::Flip, mpm_core::Musl, PlaneStrain);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        mpm.add("block", law(), &seeds, |_| [block, 0.0]).expect("block");
        let velocity = [belt, 0.0];
        let floor = Boundary::FrictionWall { axis: 1, at: 0.0, side: Side::Above, velocity, friction: 0.4 };
        mpm.bound(floor).expect("floor");
        mpm.set_body_force(|_| [0.0, -G]);
        mpm.set_time_control(TimeControl::Fixed(1e-3)).expect("step");
        mpm.run_until(0.2).expect("a run");
        (speed(&mpm), mpm.exchange(), mpm.totals())
    };
    let (v, given, _) = run(1.0, 0.0);
    let (w, dragged, totals) = run(0.0, -1.0);
    println!("{v} {w}: heat {} {}", given.friction, dragged.friction);
    // The grid does not move with the frame: two cells further, nodal masses differ.
    assert!((v - (w + 1.0)).abs() < 0.03 * (1.0 - v), "{v} m/s seen from the floor, {w} from the block");
    assert!((given.friction / dragged.friction - 1.0).abs() < 0.03);
    // The work of the belt is the friction heat and the energy of the block.
    let left = dragged.work - dragged.friction - totals.kinetic - totals.internal;
    assert!(left.abs() < 0.02 * dragged.friction, "{left} J of {}", dragged.friction);
}

#[test]
fn books_close_and_sliding_heats_as_it_brakes() {
    // With FLIP velocities before and after are known: friction removes J . (v- + v+) / 2 from the nodes, and thus
    // from the particles except for velocities that no node resolves.
    let (lattice, seeds) = block([0.0, 0.0], [0.8, 0.4], H);
    let method = Method::new(mpm_core::Linear, mpm_core::Flip, mpm_core::Musl, PlaneStrain);
    let mpm = Mpm::new(method, BlockGrid::new(lattice));
    let mut mpm = on_a_wall(mpm, &seeds, 0.0, 0.3, 4.0);
    mpm.set_time_control(TimeControl::Fixed(5e-4)).expect("step");
    let (mut independent, mut before) = (0.0, (mpm.exchange(), speed(&mpm)));
    for _ in 0..1000 {
        mpm.step().expect("a step");
        let now = (mpm.exchange(), speed(&mpm));
        independent -= (now.0.impulse[0] - before.0.impulse[0]) * 0.5 * (now.1 + before.1);
        before = now;
    }
    let account = mpm.account();
    println!(
        "heat {} J, impulse times mean velocity {independent} J, unexplained {} of {}",
        account.friction, account.unexplained, account.energy_scale
    );
    println!("speed {}, momentum missing {}", before.1, account.missing());
    assert!((before.1 - (4.0 - 0.3 * G * 0.5)).abs() < 0.05, "{} m/s", before.1);
    // The foot of the block vibrates, as above.
    assert!((account.friction / independent - 1.0).abs() < 0.03);
    assert!(account.missing() < 1e-12 * account.momentum_scale);
    assert!(account.energy_error().abs() < 5e-3, "{}", account.energy_error());
}

#[test]
fn a_smooth_friction_wall_is_a_wall() {
    let run = |friction: Option<f64>| {
        let (lattice, seeds) = block([0.0, 0.0], [0.4, 0.4], H);
        let method = Method::new(mpm_core::Linear, mpm_core::Flip, mpm_core::Musl, PlaneStrain);
        let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
        mpm.add("block", law(), &seeds, |x| [0.3 - x[1], -1.0]).expect("block");
        let (axis, at, side) = (1, 0.0, Side::Above);
        mpm.bound(match friction {
            Some(friction) => Boundary::FrictionWall { axis, at, side, velocity: [0.7, 0.2], friction },
            None => Boundary::Wall { axis, at, side, velocity: 0.2 },
        })
        .expect("wall");
        mpm.run_until(0.05).expect("a run");
        (bits(&mpm), mpm.exchange())
    };
    assert!(run(Some(0.0)) == run(None));
    assert!(run(Some(0.2)).1.friction > 0.0);
}

/// No work is done on a body at rest on a wall, even with methods whose nodes do not know the velocity at the start of a step.
#[test]
fn weight_does_no_work_on_what_rests() {
    let mut mpm = plane(0.0, 0.4, 0.0);
    mpm.run_until(2.0).expect("a block that comes to rest");
    let (before, start) = (mpm.exchange(), mpm.totals());
    mpm.run_until(3.0).expect("a block at rest");
    let (given, end) = (mpm.exchange().work - before.work, mpm.totals());
    let gained = end.kinetic + end.internal - start.kinetic - start.internal;
    // The weight times the displacement of a step of free fall, in every step, would be 7 % of the stored energy.
    assert!(end.kinetic < 1e-6 * end.internal, "it moves: {end:?}");
    assert!(
        (given - gained).abs() < 1e-3 * end.internal,
        "{given:e} J given, {gained:e} J gained of {end:?}"
    );
}
