//! Rigid bodies, against exact solutions.

use std::f64::consts::PI;

use crate::common::{H, ball, cuboid, lattice, particles, plane, rubber, space};
use mpm_contact::{Coulomb, Frictionless, Pairs, SurfaceDistance};
use mpm_core::geometry::{Seeds, rings};
use mpm_core::{
    Apic, BlockGrid, Flip, FullSpace, GridContact, IntoKernels, Linear, Method, Mpm, Musl, PlaneStrain,
    QuadraticBSpline, Rigid, Stopped, Team, TimeControl, Twist, Usf, Usl,
};
use mpm_materials::{Moduli, NeoHookean};

fn scene<const D: usize>(method: impl IntoKernels<f64, D>, friction: Option<f64>) -> Mpm<D> {
    let laws = match friction {
        Some(mu) => Pairs::new(Coulomb::new(mu).expect("law")),
        None => Pairs::new(Frictionless),
    };
    over(method, SurfaceDistance::default(), laws)
}

fn over<const D: usize>(
    method: impl IntoKernels<f64, D>,
    detector: SurfaceDistance,
    laws: Pairs<f64>,
) -> Mpm<D> {
    let contact = GridContact::new(detector, laws);
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    mpm.set_time_control(TimeControl::Fixed(5e-4)).expect("control");
    mpm
}

fn free<const D: usize>() -> Rigid<D> {
    Rigid::free(1000.0).expect("rigid")
}

/// Kinetic damping would not stop a free body: the second of the two is refused.
#[test]
fn free_bodies_and_kinetic_damping_exclude_each_other() {
    let mut mpm = scene(plane(), None);
    mpm.set_kinetic_damping(true).expect("nothing moves by itself yet");
    let stone = cuboid([0.0; 2], [2.0 * H; 2]);
    let refused = mpm.add_rigid("stone", &free(), &stone).expect_err("a free body").to_string();
    assert!(refused.contains("free rigid body `stone`"), "{refused}");
    mpm.set_kinetic_damping(false).expect("off");
    mpm.add_rigid("stone", &free(), &stone).expect("a free body");
    let refused = mpm.set_kinetic_damping(true).expect_err("a free body").to_string();
    assert!(refused.contains("its motion must be prescribed"), "{refused}");
}

/// Check a brick with unequal moments of inertia, spinning freely about an axis near the middle one, which is unstable.
fn tumbles(method: impl IntoKernels<f64, 3>) {
    let mut mpm = scene(method, None);
    let brick = cuboid([0.0; 3], [0.4, 0.2, 0.1]);
    let rigid = free().with_velocity([1.0, 2.0, -1.5]).with_spin([0.05, 6.0, 0.02]);
    mpm.add_rigid("brick", &rigid, &brick).expect("brick");
    let start = (mpm.totals(), particles(&mpm));
    mpm.run_until(1.5).expect("run");
    let (now, then) = (mpm.totals(), &start.0);
    for d in 0..3 {
        let moment = (now.angular_momentum[d] - then.angular_momentum[d]).abs();
        assert!(moment < 1e-10 * then.momentum_scale, "angular momentum {d}: {moment:e}");
        assert!((now.momentum[d] - then.momentum[d]).abs() < 1e-12 * then.momentum_scale);
    }
    let energy = now.kinetic / then.kinetic - 1.0;
    assert!(energy.abs() < 2e-5, "energy {energy:e}");
    // Particle positions relative to the centre are rotated by the body's rotation.
    let (was, is) = (&start.1[0], &particles(&mpm)[0]);
    let state = mpm.bodies()[0].rigid().expect("rigid");
    let turned = state.rotation();
    assert!((0..3).any(|d| turned[d][d] < 0.5), "it hardly turned: {turned:?}");
    let centre = [0.2, 0.1, 0.05];
    for (a, b) in was.iter().zip(is) {
        for (d, row) in turned.iter().enumerate() {
            let r: f64 = (0..3).map(|e| row[e] * (a.position[e] - centre[e])).sum();
            let error = b.position[d] - state.centre()[d] - r;
            assert!(error.abs() < 1e-10, "particle {} is {error:e} m off", a.number);
        }
    }
}

#[test]
fn free_bodies_tumble_and_keep_their_shape() {
    tumbles(space());
    tumbles(Method::new(QuadraticBSpline, Apic, Usl, FullSpace));
    tumbles(Method::new(Linear, Flip, Usf, FullSpace).compiled());
}

#[test]
fn prescribed_bodies_go_where_they_are_told() {
    let mut mpm = scene(plane(), None);
    let motion = |t: f64| Twist { velocity: [0.3 * (3.0 * t).cos(), 0.0], spin: [0.0, 0.0, 2.0 * t] };
    let rigid = Rigid::prescribed(1000.0, motion).expect("rigid").about([0.1, 0.1]);
    mpm.add_rigid("rotor", &rigid, &cuboid([0.1, 0.1], [0.4, 0.3])).expect("rotor");
    let start = particles(&mpm);
    mpm.run_until(1.2).expect("run");
    let (angle, way) = (1.2f64 * 1.2, 0.1 * 3.6f64.sin());
    for (a, b) in start[0].iter().zip(&particles(&mpm)[0]) {
        let [x, y] = [a.position[0] - 0.1, a.position[1] - 0.1];
        let due = [0.1 + way + x * angle.cos() - y * angle.sin(), 0.1 + x * angle.sin() + y * angle.cos()];
        for d in 0..2 {
            assert!((b.position[d] - due[d]).abs() < 1e-9, "{:?} and not {due:?}", b.position);
        }
    }
    assert_eq!(mpm.totals().momentum, [0.0; 3], "what is prescribed is not in the books");
}

/// Check momentum and angular momentum of two spinning bodies in an off-centre impact with friction.
fn collide(method: impl IntoKernels<f64, 2>) {
    let mut mpm = scene(method, Some(0.4));
    let (a, b) = (ball([0.2, 0.3], 0.15), cuboid([0.45, 0.3], [0.7, 0.65]));
    mpm.add_rigid("disc", &free().with_velocity([2.0, 0.0]).with_spin([0.0, 0.0, 5.0]), &a).expect("disc");
    mpm.add_rigid("block", &free().with_velocity([-1.0, 0.0]), &b).expect("block");
    let start = mpm.totals();
    let mut most = start.kinetic;
    while mpm.time() < 0.2 {
        mpm.step().expect("step");
        let now = mpm.totals();
        assert!(now.kinetic <= most * (1.0 + 1e-12), "energy grew from {most} to {}", now.kinetic);
        most = now.kinetic;
    }
    let end = mpm.totals();
    for d in 0..3 {
        let scale = start.momentum_scale;
        assert!((end.momentum[d] - start.momentum[d]).abs() < 1e-12 * scale, "momentum {d}");
        let moment = end.angular_momentum[d] - start.angular_momentum[d];
        assert!(moment.abs() < 1e-12 * scale, "angular momentum {d}: {moment:e}");
    }
    assert!(end.kinetic < 0.9 * start.kinetic, "they did not meet");
}

#[test]
fn free_bodies_exchange_momentum_and_angular_momentum() {
    collide(plane());
    collide(Method::new(Linear, Flip, Usf, PlaneStrain).compiled());
    collide(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
}

/// An elastic bar hits a free rigid mass M: M dV/dt = rho c A (v0 - V) during the first wave, so V = v0 (1 - exp(-rho
/// c A t / M)) until 2 L/c.
#[test]
fn a_bar_pushes_a_rigid_mass() {
    let (speed, young, length) = (0.2, 1.0e6, 2.0);
    let wave = (young / 1000.0f64).sqrt();
    let mut mpm = scene(plane(), None);
    mpm.set_time_control(TimeControl::Courant { factor: 0.3, growth: 1.1 }).expect("control");
    let law = NeoHookean::new(1000.0, Moduli::young_poisson(young, 0.0).expect("moduli")).expect("law");
    mpm.add("bar", law, &cuboid([0.0, 0.0], [length, 0.2]), |_| [speed, 0.0]).expect("bar");
    mpm.add_rigid("mass", &free(), &cuboid([length, 0.0], [length + 1.0, 0.2])).expect("mass");
    let start = mpm.totals();
    let mut worst: f64 = 0.0;
    while mpm.time() < 1.9 * length / wave {
        mpm.step().expect("step");
        let state = mpm.bodies()[1].rigid().expect("rigid");
        // rho c A / M = c / 1 m.
        let exact = speed * (1.0 - (-wave * mpm.time()).exp());
        worst = worst.max((state.velocity()[0] - exact).abs());
    }
    // The wave starts up to half a cell late: rho c A v0 / M times h / 2 c.
    assert!(worst < 0.5 * H * speed, "worst error {worst} of {speed} m/s");
    let end = mpm.totals();
    assert!((end.momentum[0] - start.momentum[0]).abs() < 1e-12 * start.momentum_scale);
    let energy = (end.kinetic + end.internal) / start.kinetic - 1.0;
    // Nodes that stop at once dissipate h / 2L, here 1.3 %, as at a wall.
    assert!(energy < 1e-3 && energy > -0.025, "energy {energy}");
}

/// Block and disc on an incline at rest: the block slides at g (sin - mu cos), the disc rolls at g sin / (1 + I/(M
/// R^2)), with the inertia of its particles.
#[test]
fn blocks_slide_and_discs_roll() {
    let (gravity, angle, mu) = (10.0, PI / 6.0, 0.3);
    let run = |seeds: &Seeds<2>| {
        let mut mpm = over(plane(), SurfaceDistance::default(), Pairs::new(Coulomb::new(mu).expect("law")));
        let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid");
        mpm.add_rigid("plane", &still, &cuboid([0.0, -0.2], [4.0, 0.0])).expect("plane");
        mpm.add_rigid("body", &free(), seeds).expect("body");
        mpm.set_body_force(move |_| [gravity * angle.sin(), -gravity * angle.cos()]);
        mpm.run_until(0.6).expect("run");
        let state = mpm.bodies()[1].rigid().expect("rigid");
        let (m, g) = (state.mass(), gravity * 0.6);
        // All impulses of the plane are booked.
        let booked = mpm.exchange().impulse[0] + mpm.exchange().load[0];
        assert!((m * state.velocity()[0] - booked).abs() < 1e-10 * m * g, "momentum and books differ");
        (state.velocity(), state.spin()[2], state.centre())
    };
    let (velocity, ..) = run(&cuboid([0.2, 0.0], [0.6, 0.2]));
    let exact = 0.6 * gravity * (angle.sin() - mu * angle.cos());
    assert!((velocity[0] / exact - 1.0).abs() < 0.01, "sliding at {} m/s and not {exact}", velocity[0]);
    assert!(velocity[1].abs() < 0.01 * exact, "lifts off at {} m/s", velocity[1]);

    // Rings of particles are rough: the error decreases as the radius grows from 6 to 12 and 18 cells.
    for (radius, tolerances) in [(0.3, [0.06, 0.15]), (0.6, [0.04, 0.05]), (0.9, [0.02, 0.05])] {
        let (velocity, spin, centre) =
            run(&rings([0.5, radius], radius, (radius / (0.5 * H)).round() as usize).expect("rings"));
        let exact = 0.6 * gravity * angle.sin() / 1.5;
        let errors = [velocity[0] / exact - 1.0, spin / (-exact / radius) - 1.0];
        let within = (0..2).all(|i| errors[i].abs() < tolerances[i]);
        assert!(within, "radius {radius}: errors of velocity and spin {errors:?}");
        assert!((centre[1] - radius).abs() < 0.1 * H, "centre at {} m", centre[1]);
    }
}

/// An elastic disc bounces off a rigid wall without an energy gain, at any factor of the time step. Linear shape
/// functions at the largest factor are excluded: a vibrating disc gains energy with them in free flight, more with
/// longer steps.
#[test]
fn no_bounce_gains_energy() {
    let splines = || Method::new(QuadraticBSpline, Flip, Musl, PlaneStrain).into_kernels();
    let hats = || plane().into_kernels();
    for (factor, method) in
        [(0.1, splines()), (0.5, splines()), (0.8, splines()), (0.1, hats()), (0.5, hats())]
    {
        let mut mpm = scene(method, None);
        mpm.set_time_control(TimeControl::Courant { factor, growth: 1.1 }).expect("control");
        let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid");
        mpm.add_rigid("wall", &still, &cuboid([0.0, 0.0], [0.2, 1.0])).expect("wall");
        mpm.add("disc", rubber(), &ball([0.43, 0.5], 0.2), |_| [-3.0, 0.0]).expect("disc");
        let start = mpm.totals();
        mpm.run_until(0.08).expect("run");
        let end = mpm.totals();
        let gained = (end.kinetic + end.internal) / start.kinetic - 1.0;
        assert!(end.momentum[0] > 0.5 * start.momentum_scale, "it did not bounce");
        let missing = end.momentum[0] - start.momentum[0] - mpm.exchange().impulse[0];
        assert!(missing.abs() < 1e-12 * start.momentum_scale, "momentum and books differ by {missing:e}");
        assert!(gained < 0.002, "factor {factor}: energy {gained}");
    }
}

#[test]
fn bodies_held_keep_their_velocity() {
    let mut mpm = scene(plane(), None);
    let rigid = free().with_velocity([1.0, 0.0]).holding([false, true]).without_turning();
    mpm.add_rigid("slider", &rigid, &cuboid([0.1, 0.1], [0.4, 0.3])).expect("slider");
    mpm.set_body_force(|_| [2.0, -10.0]);
    mpm.run_until(0.5).expect("run");
    let state = mpm.bodies()[0].rigid().expect("rigid");
    assert!(
        (state.velocity()[0] - 2.0).abs() < 1e-10 && state.velocity()[1] == 0.0,
        "{:?}",
        state.velocity()
    );
    let (ledger, totals) = (mpm.exchange(), mpm.totals());
    for d in 0..2 {
        let start = if d == 0 { totals.mass } else { 0.0 };
        let missing = totals.momentum[d] - start - ledger.impulse[d] - ledger.load[d];
        assert!(missing.abs() < 1e-10 * totals.mass, "{d}: {missing:e}");
    }
}

#[test]
fn threads_change_nothing() {
    let run = |threads: usize| {
        let mut mpm = scene(plane(), Some(0.3));
        let turns = Rigid::prescribed(1000.0, |t| Twist { velocity: [0.0; 2], spin: [0.0, 0.0, 20.0 * t] });
        mpm.add_rigid("rotor", &turns.expect("rigid"), &cuboid([0.3, 0.3], [0.8, 0.45])).expect("rotor");
        mpm.add_rigid("block", &free(), &cuboid([0.1, 0.5], [0.5, 0.7])).expect("block");
        mpm.add("disc", rubber(), &ball([0.7, 0.65], 0.18), |_| [0.0; 2]).expect("disc");
        mpm.set_body_force(|_| [0.0, -10.0]);
        mpm.set_team(Team::new(threads).expect("team"));
        mpm.run_until(0.2).expect("run");
        particles(&mpm)
    };
    let one = run(1);
    assert!((2..=4).all(|threads| run(threads) == one));
}

#[test]
fn motions_that_are_none_are_refused() {
    let refused = |rigid: Rigid<2>| {
        let seeds = cuboid([0.0; 2], [0.2; 2]);
        scene(plane(), None).add_rigid("odd", &rigid, &seeds).expect_err("refused").to_string()
    };
    let text = refused(free().with_spin([1.0, 0.0, 0.0]));
    assert_eq!(
        text,
        "rigid body `odd`: spin along x or y = 1 is not allowed; it must be 0 in two dimensions"
    );
    let text = refused(free().with_velocity([f64::NAN, 0.0]));
    assert_eq!(text, "rigid body `odd`: velocity = NaN is not allowed; it must be finite");
    assert!(Rigid::<2>::free(-1.0).is_err());

    let mut mpm = scene(plane(), None);
    let breaks =
        Rigid::prescribed(1000.0, |t| Twist::along([if t < 0.1 { 1.0 } else { f64::INFINITY }, 0.0]))
            .expect("rigid");
    mpm.add_rigid("engine", &breaks, &cuboid([0.0; 2], [0.2; 2])).expect("engine");
    let error = mpm.run_until(0.2).expect_err("stopped");
    assert!(matches!(error.what, Stopped::Scene(_)) && error.time < 0.1, "{error}");
    assert!(error.to_string().contains("rigid body `engine`: velocity = inf"), "{error}");
}
