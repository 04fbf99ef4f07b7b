//! Bodies mapped in their reference configuration, in contact with others on the grid of the current one.

use crate::common::{H, Scene, WAVE, ball, cuboid, lattice, particles, plane, rubber, space, three, two};
use mpm_contact::{Coulomb, Frictionless, Pairs, Penalty, Regression, SurfaceDistance};
use mpm_core::geometry::{Cuboid, Filling, Lattice, Seeds, fill};
use mpm_core::{
    Blend, BlockGrid, Boundary, ContactAlgorithm, CpGimp, Deformable, Flip, FullSpace, IntoKernels, Linear,
    Merging, Method, Mpm, Musl, PlaneStrain, QuadraticBSpline, Rigid, Side, Splitting, Team, TimeControl,
    Twist, Usf, Usl, Watch,
};
use mpm_core::{GridContact, SceneError, Totals};
use mpm_materials::{Constitutive, Elastic, LinearDensity, LinearElastic, Moduli, Solid, Stretching};

type LinearTotal<E> = Method<Linear, Flip, Musl, E, mpm_core::TotalLagrangian>;

/// Create a scene of one body in its reference configuration.
fn total<const D: usize>(
    name: &str,
    method: impl IntoKernels<f64, D>,
    lattice: Lattice<D>,
    seeds: &Seeds<D>,
    velocity: impl Fn([f64; D]) -> [f64; D],
) -> Mpm<D> {
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add(name, rubber(), seeds, velocity).expect("body");
    mpm
}

fn linear_total<E>(embedding: E) -> LinearTotal<E> {
    Method::new(Linear, Flip, Musl, embedding).total_lagrangian()
}

/// Create a scene with the bodies of odd number, or all, in their reference configuration.
fn build<const D: usize>(
    method: impl IntoKernels<f64, D>,
    reference: impl IntoKernels<f64, D> + Clone,
    contact: impl ContactAlgorithm<f64, D>,
    scene: &Scene<D>,
    all: bool,
) -> Mpm<D> {
    let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
    for (n, (seeds, velocity)) in scene.iter().enumerate() {
        let name = format!("body {n}");
        if n % 2 == 1 || all {
            let own = total(&name, reference.clone(), lattice(), seeds, |_| *velocity);
            mpm.add_total_lagrangian(own).expect("body");
        } else {
            mpm.add(&name, rubber(), seeds, |_| *velocity).expect("body");
        }
    }
    mpm
}

fn meeting() -> Mpm<2> {
    Mpm::with_contact(plane(), BlockGrid::new(lattice()), springs())
}

fn surfaces() -> SurfaceDistance<Regression> {
    SurfaceDistance::new(Regression, 0.0).expect("detector").locally()
}

fn springs() -> GridContact<SurfaceDistance<Regression>, f64> {
    let law = Penalty::new(0.9 * WAVE / H, 0.8, 0.3).expect("law");
    GridContact::new(surfaces(), Pairs::new(law))
}

fn coulomb() -> Pairs<f64> {
    Pairs::new(Coulomb::new(0.3).expect("law"))
}

/// Check that momentum is conserved in every step of a collision, and that bodies separate with about as much energy
/// as those that move through cells.
fn bounce<const D: usize>(
    name: &str,
    method: impl IntoKernels<f64, D> + Clone,
    reference: impl IntoKernels<f64, D> + Clone,
    scene: &Scene<D>,
    all: bool,
) {
    let mut mpm = build(method.clone(), reference, springs(), scene, all);
    let start = mpm.totals();
    let (mut met, mut last) = (0, start);
    for _ in 0..150 {
        mpm.step().expect("step");
        met += mpm.contact_points().len();
        last = mpm.totals();
        for d in 0..D {
            let error = (last.momentum[d] - start.momentum[d]).abs();
            assert!(error < 1e-13 * start.momentum_scale, "{name}: momentum {error:e}");
        }
    }
    assert!(met > 50, "{name}: {met} nodes touched");
    let mut usual = crate::common::build(method, springs(), scene);
    // Linear shape functions with FLIP gain energy in cell crossing, also for the strip below.
    usual.set_watch(Watch::off());
    usual.run_until(mpm.time()).expect("run");
    let usual = usual.totals();
    let energy = |t: &Totals| [t.kinetic / start.kinetic, (t.kinetic + t.internal) / start.kinetic];
    let [[motion, all], [usual_motion, usual_all]] = [energy(&last), energy(&usual)];
    println!(
        "{name}: kinetic energy {motion:.3} (through cells {usual_motion:.3}), all {all:.3} ({usual_all:.3})"
    );
    assert!(all < 1.02 && all > 0.84, "{name}: energy {all}");
    assert!(motion > usual_motion - 0.1, "{name}: kinetic energy {motion}");
}

#[test]
fn what_one_gives_the_other_gets() {
    let reference = linear_total(PlaneStrain);
    bounce("both, linear shape functions", plane(), reference, &two(0.1 * WAVE), true);
    bounce("one of two", plane(), reference, &two(0.1 * WAVE), false);
    bounce("three discs", plane(), reference, &three(0.1 * WAVE), false);
    bounce(
        "USL",
        Method::new(QuadraticBSpline, Flip, Usl, PlaneStrain).compiled(),
        reference,
        &two(0.1 * WAVE),
        false,
    );
    bounce("USF", Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled(), reference, &two(0.1 * WAVE), false);
    let solid = Method::new(Linear, Flip, Musl, FullSpace).total_lagrangian();
    bounce("space", space(), solid, &two(0.1 * WAVE), false);
}

/// A single body moves as in its own scene, bit for bit: its own forces never use the other grid.
#[test]
fn alone_it_is_as_before() {
    let flow = |x: [f64; 2]| [0.1 * WAVE + 3.0 * (x[1] - 0.2), -2.0 * x[0]];
    let seeds = ball([0.3; 2], 0.2);
    let mut alone = total("disc", linear_total(PlaneStrain), lattice(), &seeds, flow);
    let mut mpm =
        Mpm::with_contact(plane(), BlockGrid::new(lattice()), GridContact::new(Regression, coulomb()));
    mpm.add_total_lagrangian(total("disc", linear_total(PlaneStrain), lattice(), &seeds, flow))
        .expect("body");
    let control = TimeControl::Fixed(0.3 * H / WAVE);
    alone.set_time_control(control).expect("control");
    mpm.set_time_control(control).expect("control");
    for _ in 0..200 {
        alone.step().expect("step");
        mpm.step().expect("step");
    }
    assert_eq!(particles(&alone), particles(&mpm));
    assert_eq!(alone.totals(), mpm.totals());
}

/// A strip in flight vibrates along its length. In its reference configuration it vibrates as at rest, up to
/// rounding; through cells it does not.
#[test]
fn a_strip_swings_as_it_flies() {
    let strip = cuboid([0.0, 0.0], [0.6, 0.1]);
    let swing = |speed: f64| move |x: [f64; 2]| [speed + 0.01 * (5.0 * (x[0] - 0.3)).sin() * WAVE, 0.0];
    let fly = |mut mpm: Mpm<2>| {
        mpm.set_time_control(TimeControl::Fixed(0.3 * H / WAVE)).expect("control");
        mpm.set_watch(Watch::off());
        mpm.run_until(10.0 / (0.3 * WAVE)).expect("run");
        let totals = mpm.totals();
        let along = totals.momentum[0];
        totals.internal + totals.kinetic - 0.5 * along * along / totals.mass
    };
    let shot = |speed: f64| {
        let mut through = meeting();
        through.add("strip", rubber(), &strip, swing(speed)).expect("body");
        let mut kept = meeting();
        kept.add_total_lagrangian(total("strip", linear_total(PlaneStrain), lattice(), &strip, swing(speed)))
            .expect("body");
        [fly(through), fly(kept)]
    };
    let ([through, kept], [still, held]) = (shot(0.3 * WAVE), shot(0.0));
    println!(
        "energy of the swing in flight over that at rest: through cells {:.3}, reference {:.12}",
        through / still,
        kept / held
    );
    assert!((kept / held - 1.0).abs() < 1e-9, "{}", kept / held);
}

/// A wall of the scene stops the block, and is booked; a plate at rest reflects it.
#[test]
fn a_block_comes_down() {
    let block = cuboid([0.0, 0.0], [0.4, 0.3]);
    let velocity = [0.03 * WAVE, -0.05 * WAVE];
    let land = |plate: bool| {
        let mut mpm = meeting();
        let own = total("block", linear_total(PlaneStrain), lattice(), &block, |_| velocity);
        mpm.add_total_lagrangian(own).expect("body");
        if plate {
            let still = Rigid::prescribed(1000.0, |_| Twist::along([0.0; 2])).expect("rigid");
            mpm.add_rigid("plate", &still, &cuboid([-0.2, -0.2], [0.8, -0.1])).expect("body");
        } else {
            mpm.bound(Boundary::Wall { axis: 1, at: -0.1, side: Side::Above, velocity: 0.0 }).expect("wall");
        }
        let start = mpm.totals();
        mpm.run_until(0.12).expect("run");
        let (end, ledger) = (mpm.totals(), mpm.exchange());
        for d in 0..2 {
            let error = end.momentum[d] - start.momentum[d] - ledger.impulse[d] - ledger.dropped[d];
            assert!(error.abs() < 1e-12 * start.momentum_scale, "axis {d}: {error:e}");
        }
        let up = -end.momentum[1] / start.momentum[1];
        println!(
            "plate {plate}: {up:.3} of the momentum up, energy {:.3}",
            (end.kinetic + end.internal) / start.kinetic
        );
        let lowest = mpm.bodies()[0].points().iter().map(|p| p.position[1]).fold(1.0, f64::min);
        assert!(lowest > -0.1 - 0.5 * H, "it went through: {lowest}");
        assert!(end.kinetic + end.internal < 1.01 * start.kinetic);
        up
    };
    assert!(land(false) > -0.1);
    assert!(land(true) > 0.85);
}

/// Half a scene at a plane of symmetry is equivalent to half of the whole.
#[test]
fn half_is_half_of_the_whole() {
    let run = |low: f64| {
        let (left, right) = (cuboid([-0.5, low], [0.0, 0.2]), cuboid([0.0, low], [0.4, 0.2]));
        let contact = GridContact::new(SurfaceDistance::default(), Pairs::new(Frictionless));
        // A PIC fraction applies to particles of the scene, but not to those of the body in its reference configuration.
        let blend = Blend::new(100.0 * H / WAVE).expect("time");
        let method = Method::new(Linear, blend, Musl, PlaneStrain);
        let mut mpm = Mpm::with_contact(method, BlockGrid::new(lattice()), contact);
        mpm.add("left", rubber(), &left, |_| [0.1 * WAVE, 0.0]).expect("body");
        let mut own = total("right", linear_total(PlaneStrain), lattice(), &right, |_| [-0.1 * WAVE, 0.0]);
        if low == 0.0 {
            let symmetry = Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above };
            own.bound(symmetry.clone()).expect("plane");
            mpm.bound(symmetry).expect("plane");
        }
        mpm.add_total_lagrangian(own).expect("body");
        mpm.set_time_control(TimeControl::Fixed(0.3 * H / WAVE)).expect("control");
        let start = mpm.totals();
        for _ in 0..120 {
            mpm.step().expect("step");
        }
        let (end, ledger) = (mpm.totals(), mpm.exchange());
        for d in 0..2 {
            let error = end.momentum[d] - start.momentum[d] - ledger.impulse[d] - ledger.dropped[d];
            assert!(error.abs() < 1e-12 * start.momentum_scale, "axis {d}: {error:e}");
        }
        assert!(!mpm.contacts().is_empty());
        let mut all = particles(&mpm).concat();
        all.retain(|p| p.position[1] > 0.0);
        all.sort_by(|p, q| p.position.partial_cmp(&q.position).expect("finite"));
        all
    };
    let (half, whole) = (run(0.0), run(-0.2));
    assert_eq!(half.len(), whole.len());
    for (p, q) in half.iter().zip(&whole) {
        for d in 0..2 {
            let (x, v) = (p.position[d] - q.position[d], p.velocity[d] - q.velocity[d]);
            assert!(x.abs() < 1e-10 * H && v.abs() < 1e-9 * WAVE, "{p:?} {q:?}");
        }
    }
}

/// Bars end to end (V8), one of them in its reference configuration, with its own cells: exact velocity and stress at
/// the joint. Small uniaxial strain.
#[test]
fn bars_meet_at_the_exact_velocity() {
    let (cells, speed) = (40, 0.05);
    let h = 1.0 / f64::from(cells);
    let (density, wave) = (1000.0, 100.0);
    let law = LinearElastic::new(density, Moduli::young_poisson(density * wave * wave, 0.0).expect("moduli"))
        .expect("law");
    let strip = |spacing: f64, from: f64, to: f64| {
        let lattice = Lattice::new([0.0; 2], spacing).expect("lattice");
        let shape = Cuboid::new([from, 0.0], [to, 2.0 * h]).expect("strip");
        (lattice, fill(&shape, &lattice, 2, &Filling::new()).expect("seeds"))
    };
    for own in [h, 0.5 * h] {
        let bound = |axis_at: f64, side| Boundary::Symmetry { axis: 1, at: axis_at, side };
        let contact =
            GridContact::new(surfaces(), Pairs::new(Penalty::new(0.9 * wave / h, 0.8, 0.0).expect("law")));
        let (lattice, first) = strip(h, -1.0, 0.0);
        let mut mpm = Mpm::with_contact(plane(), BlockGrid::new(lattice), contact);
        let (fine, second) = strip(own, 0.0, 1.0);
        let mut bar = Mpm::new(linear_total(PlaneStrain), BlockGrid::new(fine));
        for (at, side) in [(0.0, Side::Above), (2.0 * h, Side::Below)] {
            mpm.bound(bound(at, side)).expect("plane");
            bar.bound(bound(at, side)).expect("plane");
        }
        bar.add("second", law, &second, |_| [0.0; 2]).expect("body");
        mpm.add("first", law, &first, |_| [speed, 0.0]).expect("body");
        mpm.add_total_lagrangian(bar).expect("body");
        mpm.run_until(0.8 / wave).expect("run");
        let mut sums = [0.0; 3];
        for p in particles(&mpm).concat().iter().filter(|p| p.position[0].abs() < 0.4) {
            for (sum, x) in sums.iter_mut().zip([1.0, p.velocity[0], p.stress[0]]) {
                *sum += p.mass * x;
            }
        }
        let [velocity, stress] =
            [sums[1] / sums[0] / (0.5 * speed), sums[2] / sums[0] / (-0.5 * density * wave * speed)];
        println!("cells of {own} m: velocity {velocity:.4}, stress {stress:.4} of the exact ones");
        assert!((velocity - 1.0).abs() < 0.01 && (stress - 1.0).abs() < 0.03, "{velocity} {stress}");
    }
}

/// Results are bitwise identical for any number of threads, and for a resumed run.
#[test]
fn the_same_bits() {
    let scene = || {
        let contact = springs();
        build(plane(), linear_total(PlaneStrain), contact, &three(0.1 * WAVE), false)
    };
    let told = |mpm: &Mpm<2>| format!("{:?} {:?} {:?}", mpm.totals(), particles(mpm), mpm.contact_points());
    let file = std::env::temp_dir().join(format!("impactite-{}-reference", std::process::id()));
    let mut one = scene();
    for _ in 0..40 {
        one.step().expect("step");
    }
    assert!(!one.contact_points().is_empty());
    one.save(&file).expect("checkpoint");
    let mut resumed = scene().resumed(&file).expect("scene");
    std::fs::remove_file(&file).expect("file");
    let mut three = scene();
    three.set_team(Team::new(3).expect("threads"));
    for _ in 0..40 {
        three.step().expect("step");
    }
    assert!(told(&one) == told(&three), "threads");
    assert!(told(&one) == told(&resumed), "resumed");
    for mpm in [&mut one, &mut three, &mut resumed] {
        for _ in 0..40 {
            mpm.step().expect("step");
        }
    }
    assert!(told(&one) == told(&three), "threads, later");
    assert!(told(&one) == told(&resumed), "resumed, later");
}

#[test]
fn what_is_refused() {
    let one = || total("disc", linear_total(PlaneStrain), lattice(), &ball([0.3; 2], 0.2), |_| [1.0, 0.0]);
    let mut mpm = meeting();
    let empty = Mpm::new(linear_total(PlaneStrain), BlockGrid::new(lattice()));
    assert_eq!(mpm.add_total_lagrangian(empty), Err(SceneError::NotOneBody(0)));
    let mut late = one();
    late.step().expect("step");
    assert!(matches!(mpm.add_total_lagrangian(late), Err(SceneError::Clock { steps: 1, .. })));
    let mut damped = one();
    damped.set_kinetic_damping(true).expect("damping");
    assert!(matches!(mpm.add_total_lagrangian(damped), Err(SceneError::BesideClient { .. })));
    let coarse = Lattice::new([0.0; 2], 3.0 * H).expect("lattice");
    let large =
        fill(&Cuboid::new([0.0; 2], [0.6; 2]).expect("block"), &coarse, 2, &Filling::new()).expect("seeds");
    let large = total("block", linear_total(PlaneStrain), coarse, &large, |_| [0.0; 2]);
    assert!(matches!(mpm.add_total_lagrangian(large), Err(SceneError::HalfSize { .. })));
    mpm.add_total_lagrangian(one()).expect("body");
    let refused = mpm.set_kinetic_damping(true).expect_err("damping");
    assert!(
        refused.to_string().contains("kinetic damping is not allowed beside the body `disc`"),
        "{refused}"
    );
    assert!(mpm.set_null_space_filter(1).is_err());
    let sharp = TimeControl::Gershgorin { factor: 0.9, growth: 1.1, every: 10 };
    assert!(mpm.set_time_control(sharp).is_err());
    assert!(matches!(mpm.deactivate(&["disc"]), Err(SceneError::Disturbed { .. })));
    mpm.set_body_force(|_| [0.0, -9.81]);
    let stopped = mpm.step().expect_err("weight");
    assert!(stopped.to_string().contains("a body force of the scene is not allowed beside"), "{stopped}");
}

/// Merging removes particles from the scene, and is not available beside bodies in their reference configuration: the
/// second of the two is refused.
#[test]
fn no_merging_beside_them() {
    let elastic = Solid::new(
        Elastic::new(100.0 * WAVE * WAVE).expect("strength"),
        LinearDensity::new(1000.0, WAVE).expect("equation of state"),
    );
    let splitting = Splitting::at(2.0).expect("stretch");
    let merging = splitting.with_merging(Merging::above(8).expect("count"));
    let disc = || total("disc", linear_total(PlaneStrain), lattice(), &ball([0.3; 2], 0.2), |_| [1.0, 0.0]);
    let cloud = |mpm: &mut Mpm<2>, splitting| {
        let law = Stretching::new(elastic).compiled();
        mpm.add_body(Deformable::new("cloud", law, &ball([0.9; 2], 0.2)).with_splitting(splitting))
    };
    let mut first = meeting();
    first.add_total_lagrangian(disc()).expect("body");
    let mut then = meeting();
    cloud(&mut then, merging).expect("body");
    for refused in [cloud(&mut first, merging), then.add_total_lagrangian(disc())] {
        let refused = refused.expect_err("merging");
        assert!(refused.to_string().contains("merging is not allowed beside the body `disc`"), "{refused}");
    }
    // Splitting alone adds particles only to its own body.
    cloud(&mut first, splitting).expect("body");
    let mut then = meeting();
    cloud(&mut then, splitting).expect("body");
    then.add_total_lagrangian(disc()).expect("body");
}
