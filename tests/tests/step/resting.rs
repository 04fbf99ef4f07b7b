//! Deactivated bodies: a body at rest until contact needs no computation, and the results are the same bit for bit.

use std::sync::Arc;

use impactite_tests::scene::{block, lattice, metal, rubber, wave_speed};
use mpm_core::SceneError;
use mpm_core::geometry::Cuboid;
use mpm_core::{
    Apic, Axisymmetric, BlockGrid, Boundary, Composition, CpGimp, Cpdi2, CubicBSpline, Deformable, DenseGrid,
    Embedding, FieldForce, Flip, Float, Fmpm, FullSpace, GridStorage, IntoKernels, Linear, Method, Mls, Mpm,
    Musl, OneField, Pic, PlaneStrain, QuadraticBSpline, Side, Splitting, Team, TimeControl, Usf, Usl,
};
use mpm_materials::{Constitutive, Explosive, IntoMaterial, Moduli, NeoHookean, Stretching, library};

/// Cells between the projectile and the plate at the start: more than five blocks.
const BEFORE: i64 = 22;
/// First node of the projectile, at positive radii.
const LOW: i64 = 4;

/// Parameters of a scene other than method, grid and law.
struct Flight {
    /// Speed of the projectile over the sound speed.
    speed: f64,
    control: TimeControl,
    /// Sound speed, m/s.
    sound: f64,
    /// Axis of flight.
    along: usize,
    /// True if the scene has symmetry planes and a fixed plane.
    planes: bool,
}

impl Flight {
    fn at(speed: f64) -> Flight {
        let control = TimeControl::Courant { factor: 0.3, growth: 1.05 };
        Flight { speed, control, sound: wave_speed(), along: 0, planes: true }
    }

    /// Build the scene: two bodies, the second one at rest.
    fn scene<T: Float, const D: usize, M, G, C>(&self, method: M, grid: G, law: C) -> Mpm<D, T>
    where
        M: IntoKernels<T, D>,
        G: GridStorage<T, D> + 'static,
        C: IntoMaterial<T> + Clone,
    {
        let lattice = *grid.lattice();
        let mut mpm = Mpm::of(method, grid, OneField);
        let mut velocity = [0.0; D];
        velocity[self.along] = self.speed * self.sound;
        let (cells, mut low) = (if D == 2 { [3, 4, 0] } else { [2, 3, 3] }, [LOW; D]);
        let mut size = std::array::from_fn(|d| cells[d]);
        size.swap(0, self.along);
        let projectile = block(&lattice, low, [2; D], 2, 0.6);
        mpm.add("projectile", law.clone(), &projectile, |_| velocity).expect("projectile");
        low[self.along] += 2 + BEFORE;
        mpm.add("plate", law, &block(&lattice, low, size, 2, 0.6), |_| [0.0; D]).expect("plate");
        if self.planes {
            let plane = lattice.node([LOW; D]);
            for axis in (0..D).filter(|axis| *axis != self.along) {
                let symmetry = Boundary::Symmetry { axis, at: plane[axis], side: Side::Above };
                mpm.bound(symmetry).expect("plane");
            }
            let (axis, behind) = (self.along, lattice.node([low[self.along] + 3; D])[self.along]);
            mpm.bound(Boundary::Fixed { axis, at: behind, side: Side::Below }).expect("plane");
        }
        mpm.set_time_control(self.control).expect("time control");
        mpm
    }
}

fn space<const D: usize>() -> BlockGrid<f64, D> {
    BlockGrid::new(lattice())
}

/// Compare runs with and without the plate deactivated: equal bits before and after the impact. Returns the fraction of
/// particle updates saved.
fn compare<T: Float, const D: usize>(what: &str, steps: usize, scene: impl Fn() -> Mpm<D, T>) -> f64 {
    compare_with(what, &["plate"], steps, scene)
}

/// Compare runs with and without these bodies deactivated.
fn compare_with<T: Float, const D: usize>(
    what: &str,
    bodies: &[&str],
    steps: usize,
    scene: impl Fn() -> Mpm<D, T>,
) -> f64 {
    let mut saved = Vec::new();
    for threads in [1, 2] {
        let (mut plain, mut resting) = (scene(), scene());
        resting.deactivate(bodies).expect("bodies at rest");
        resting.set_team(Team::new(threads).expect("threads"));
        let start = resting.bodies()[1].points();
        let (mut made, mut all) = (0, 0);
        let mut after = 0;
        for step in 0.. {
            assert!(step < 2000, "{what}: no hit");
            all += plain.particles();
            made += resting.moving_particles();
            let rests = resting.bodies()[1].is_deactivated();
            let dt = plain.step().expect("step");
            assert!(resting.step().expect("step") == dt, "{what}: step {step}");
            if step == 0 {
                let [own, all] = [&resting, &plain].map(|mpm| mpm.bytes());
                assert!(own < all, "{what}: {own} bytes, {all} without rest");
            }
            assert_eq!(
                format!("{:?}", plain.exchange()),
                format!("{:?}", resting.exchange()),
                "{what}: books"
            );
            if step % 10 == 0 || rests != resting.bodies()[1].is_deactivated() {
                assert_eq!(plain.totals(), resting.totals(), "{what}: step {step}");
            }
            after += usize::from(after > 0 || resting.bodies()[1].totals().kinetic > 0.0);
            if after == steps {
                break;
            }
        }
        for (a, b) in plain.bodies().iter().zip(resting.bodies()) {
            assert!(a.points() == b.points(), "{what}: `{}` differs", a.name());
        }
        assert!(
            !resting.bodies()[1].is_deactivated() && resting.bodies()[1].points() != start,
            "{what}: no hit"
        );
        saved.push(1.0 - made as f64 / all as f64);
    }
    assert_eq!(saved[0], saved[1], "{what}: threads");
    println!("{what}: {:.0} % of the particle updates saved", 100.0 * saved[0]);
    saved[0]
}

/// Check a projectile at half the sound speed.
fn check<const D: usize, M: Composition<f64, D> + IntoKernels<f64, D>>(method: M) {
    // In axisymmetry the rod flies along the axis.
    let along = usize::from(<M::Embedding as Embedding<D>>::HOOP);
    let scene = || Flight { along, ..Flight::at(0.5) }.scene(method, space::<D>(), rubber());
    // The plate has at least half of the particles and is deactivated for at least half of the steps.
    let saved = compare(&method.describe(), 40, scene);
    assert!(saved > 0.25, "{saved}");
}

#[test]
fn hats() {
    check::<2, _>(Method::new(Linear, Flip, Musl, PlaneStrain));
    check::<3, _>(Method::new(Linear, Flip, Musl, FullSpace));
    check::<2, _>(Method::new(Linear, Flip, Usf, Axisymmetric).compiled());
    check::<2, _>(Method::new(Linear, Flip, Musl, PlaneStrain).mean_dilatation().compiled());
}

#[test]
fn splines() {
    check::<2, _>(Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain));
    check::<3, _>(Method::new(QuadraticBSpline, Apic, Usl, FullSpace));
    check::<2, _>(Method::new(QuadraticBSpline, Mls, Usl, PlaneStrain));
    check::<2, _>(Method::new(CubicBSpline, Fmpm::<2>, Usl, PlaneStrain).compiled());
    check::<2, _>(Method::new(QuadraticBSpline, Flip, Usf, PlaneStrain).compiled());
    check::<2, _>(Method::new(QuadraticBSpline, Pic, Usl, PlaneStrain).compiled());
}

#[test]
fn domains() {
    check::<2, _>(Method::new(CpGimp, Flip, Musl, PlaneStrain));
    check::<2, _>(Method::new(Cpdi2, Flip, Usl, PlaneStrain).compiled());
}

#[test]
fn grids_speeds_and_steps() {
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let dense = || DenseGrid::new(lattice(), [-10; 2], [40; 2]).expect("box");
    compare("dense", 40, || Flight::at(0.5).scene(method, dense(), metal()));
    // Displacement of 0.9 cells per step: the plate is reactivated in time.
    let fixed = TimeControl::Fixed(0.9 * 0.1 / (5.0 * wave_speed()));
    let fast = || Flight { control: fixed, ..Flight::at(5.0) };
    compare("five times as fast as sound", 10, || fast().scene(method, space::<2>(), metal()));
    let bound = TimeControl::Gershgorin { factor: 0.5, growth: 1.05, every: 7 };
    let bounded = || Flight { control: bound, planes: false, ..Flight::at(0.5) };
    compare("Gershgorin", 30, || bounded().scene(method, space::<2>(), metal()));
    let damped = || {
        let mut mpm = Flight::at(0.5).scene(method, space::<2>(), rubber());
        mpm.set_kinetic_damping(true).expect("damping");
        mpm.set_null_space_filter(7).expect("filter");
        mpm
    };
    let mut mpm = damped();
    mpm.deactivate(&["plate"]).expect("rest");
    let mut plain = damped();
    for _ in 0..30 {
        assert_eq!(mpm.step(), plain.step());
    }
    assert!(
        mpm.bodies()[1].is_deactivated() && mpm.stops() == plain.stops() && mpm.totals() == plain.totals()
    );
}

/// Single precision, and a metal with plasticity, equation of state, heat and viscosity.
#[test]
fn precisions_and_laws() {
    let single = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain).compiled();
    let law = NeoHookean::new(2.0f32, Moduli::young_poisson(3.0, 0.3).expect("moduli"));
    let law = law.expect("law");
    compare("single precision", 40, || {
        Flight::at(0.5).scene(single, BlockGrid::<f32, 2>::new(lattice()), law)
    });
    let metal = library::aluminium_6061_t6::<f64>().with_bulk_viscosity(0.06, 1.5).expect("viscosity");
    let hats = Method::new(Linear, Flip, Musl, FullSpace);
    let fast = || Flight { sound: 6000.0, ..Flight::at(0.2) };
    compare("aluminium", 60, || fast().scene(hats, space::<3>(), metal));
}

/// Particles of the plate that are split upon impact.
#[test]
fn splitting() {
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let scene = || {
        let mut mpm = Mpm::new(method, space());
        let law = Stretching::new(rubber()).compiled();
        let fast = |_| [2.0 * wave_speed(), 0.0];
        mpm.add("projectile", metal(), &block(&lattice(), [LOW; 2], [2; 2], 2, 0.0), fast).expect("body");
        let plate = block(&lattice(), [LOW + 2 + BEFORE, LOW], [3, 4], 2, 0.0);
        let splitting = Splitting::at(1.05).expect("stretch");
        mpm.add_body(Deformable::new("plate", law, &plate).with_splitting(splitting)).expect("plate");
        mpm
    };
    compare("splitting", 60, scene);
    let mut mpm = scene();
    mpm.deactivate(&["plate"]).expect("rest");
    for _ in 0..150 {
        mpm.step().expect("step");
    }
    assert!(mpm.bodies()[1].division().expect("particles").splits().cuts > 0, "nothing was split");
}

/// Two plates in contact: reactivation of the first one reactivates the second one.
#[test]
fn neighbours_wake_together() {
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let scene = || {
        let mut mpm = Flight { planes: false, ..Flight::at(0.5) }.scene(method, space::<2>(), rubber());
        let backing = block(&lattice(), [LOW + 2 + BEFORE + 3, LOW], [4, 4], 2, 0.0);
        mpm.add("backing", rubber(), &backing, |_| [0.0; 2]).expect("body");
        mpm
    };
    // A body beside an active one cannot be deactivated.
    let mut mpm = scene();
    mpm.deactivate(&["plate"]).expect("rest");
    assert_eq!(mpm.moving_particles(), mpm.particles());
    compare_with("neighbours", &["backing", "plate"], 40, scene);
}

/// During the flight the grid has only the nodes of the projectile.
#[test]
fn no_nodes_at_rest() {
    let method = Method::new(Linear, Flip, Musl, FullSpace);
    let mut mpm = Flight::at(0.5).scene::<f64, 3, _, _, _>(method, space(), rubber());
    let all = mpm.grid().nodes().len();
    mpm.deactivate(&["plate"]).expect("rest");
    let mut alone = Mpm::new(method, space());
    let projectile = block(&lattice(), [LOW; 3], [2; 3], 2, 0.6);
    alone.add("projectile", rubber(), &projectile, |_| [0.0; 3]).expect("projectile");
    assert_eq!(mpm.grid().nodes().len(), alone.grid().nodes().len());
    assert!(mpm.grid().nodes().len() < all);
    assert_eq!(mpm.moving_particles(), projectile.positions.len());
    // Without another body, steps only advance time.
    let still = || {
        let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), space());
        mpm.add("plate", rubber(), &block(&lattice(), [2; 2], [4; 2], 2, 0.6), |_| [0.0; 2]).expect("plate");
        mpm
    };
    let (mut plain, mut resting) = (still(), still());
    resting.deactivate(&["plate"]).expect("rest");
    assert!(resting.grid().nodes().is_empty() && resting.moving_particles() == 0);
    for _ in 0..5 {
        assert_eq!(plain.step(), resting.step());
    }
    assert_eq!(plain.bodies()[0].points(), resting.bodies()[0].points());
    assert_eq!(plain.time(), resting.time());
}

/// A run saved while the plate is deactivated, or after impact, resumes bit for bit.
#[test]
fn checkpoints() {
    let file = std::env::temp_dir().join(format!("impactite-{}-resting", std::process::id()));
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let scene = || Flight::at(0.5).scene::<f64, 2, _, _, _>(method, space(), rubber());
    let rested = || {
        let mut mpm = scene();
        mpm.deactivate(&["plate"]).expect("rest");
        mpm
    };
    let told = |mpm: &Mpm<2>| {
        let all: Vec<_> = mpm.bodies().iter().map(|b| b.points()).collect();
        format!("{} {:?} {:?} {:?}", mpm.steps(), mpm.time(), mpm.exchange(), all)
    };
    let mut whole = scene();
    let mut run = rested();
    for rests in [true, false] {
        for _ in 0..if rests { 60 } else { 160 } {
            whole.step().expect("step");
            run.step().expect("step");
        }
        assert_eq!(run.bodies()[1].is_deactivated(), rests);
        run.save(&file).expect("checkpoint");
        run = rested().resumed(&file).expect("the scene");
        assert_eq!(run.bodies()[1].is_deactivated(), rests);
        assert!(told(&run) == told(&whole), "resting: {rests}");
        // A scene without a call to `deactivate` restores deactivation from the checkpoint.
        let other = scene().resumed(&file).expect("the scene");
        assert_eq!(other.bodies()[1].is_deactivated(), rests);
    }
    for _ in 0..20 {
        whole.step().expect("step");
        run.step().expect("step");
    }
    assert!(told(&run) == told(&whole));
    std::fs::remove_file(&file).expect("file");
}

/// Changes of the scene that act on a deactivated body reactivate it.
#[test]
fn woken_by_the_scene() {
    let method = Method::new(QuadraticBSpline, Apic, Usl, PlaneStrain);
    let wall = |side| Boundary::Wall { axis: 1, at: -1.0, side, velocity: 0.1 };
    let region = |low: f64| {
        let region = Arc::new(Cuboid::new([low; 2], [low + 0.5; 2]).expect("region"));
        Boundary::Prescribed { region, velocity: Arc::new(|_| [Some(0.1), None, None]) }
    };
    type Change<'a> = (bool, &'a dyn Fn(&mut Mpm<2>));
    let changes: [Change<'_>; 4] = [
        (true, &|mpm| mpm.set_body_force(|_| [0.0, -0.3])),
        (true, &|mpm| mpm.bound(wall(Side::Above)).expect("wall")),
        (true, &|mpm| mpm.bound(region(1.4)).expect("region")),
        (false, &|mpm| mpm.bound(region(30.0)).expect("region")),
    ];
    for (n, (wakes, change)) in changes.into_iter().enumerate() {
        let scene = || Flight { planes: false, ..Flight::at(0.5) }.scene(method, space::<2>(), rubber());
        let (mut plain, mut resting) = (scene(), scene());
        resting.deactivate(&["plate"]).expect("rest");
        for step in 0..30 {
            if step == 10 {
                assert!(resting.bodies()[1].is_deactivated());
                change(&mut plain);
                change(&mut resting);
            }
            assert_eq!(plain.step(), resting.step(), "change {n}");
        }
        assert_eq!(resting.bodies()[1].is_deactivated(), !wakes, "change {n}");
        assert_eq!(plain.bodies()[1].points(), resting.bodies()[1].points(), "change {n}");
        assert_eq!(format!("{:?}", plain.exchange()), format!("{:?}", resting.exchange()), "change {n}");
        // Deactivation is refused if the change was made before.
        let mut later = scene();
        change(&mut later);
        let refused = later.deactivate(&["plate"]);
        assert_eq!(matches!(refused, Err(SceneError::Disturbed { .. })), wakes, "change {n}: {refused:?}");
        change(&mut later);
        later.step().expect("a scene that was refused goes on");
    }
}

#[test]
fn what_does_not_rest_is_refused() {
    let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    let plate = || block::<2>(&lattice(), [2; 2], [4; 2], 2, 0.0);
    let scene = || Mpm::new(method, space());
    let message = |refused: Result<(), SceneError>| refused.expect_err("refused").to_string();

    let mut mpm = scene();
    mpm.add("plate", rubber(), &plate(), |_| [0.0; 2]).expect("body");
    let none = message(mpm.deactivate(&["plat"]));
    assert_eq!(none, "body `plat` is not in the scene; it must be one of plate");
    assert_eq!(mpm.deactivate(&["plate"]), Ok(()));
    assert_eq!(mpm.deactivate(&["plate"]), Ok(()), "told twice");

    // If one body is refused, all bodies stay active.
    let mut mpm = scene();
    mpm.add("still", rubber(), &block(&lattice(), [20; 2], [4; 2], 2, 0.0), |_| [0.0; 2]).expect("body");
    mpm.add("plate", rubber(), &plate(), |x| [0.0, if x[0] > 0.15 { 0.1 } else { 0.0 }]).expect("body");
    let moving = message(mpm.deactivate(&["still", "plate"]));
    assert!(!mpm.bodies()[0].is_deactivated());
    assert!(moving.contains("velocity of particle ") && moving.contains("= 0.1 is not"), "{moving}");
    mpm.step().expect("it goes on");

    let mut mpm = scene();
    let stressed = |_| {
        let mut state = metal().virgin();
        state.stress.0[1] = 3.0e-4;
        state
    };
    mpm.add_body(Deformable::new("plate", metal(), &plate()).in_state(stressed)).expect("body");
    let message_of = message(mpm.deactivate(&["plate"]));
    assert!(
        message_of.contains("stress of particle 0 = 0.0003 is not allowed; it must be zero"),
        "{message_of}"
    );

    let mut mpm = scene();
    let field = FieldForce { acceleration: Arc::new(|_, _| [0.0; 2]) };
    mpm.add_body(Deformable::new("plate", rubber(), &plate()).with_field_force(field)).expect("body");
    assert!(matches!(mpm.deactivate(&["plate"]), Err(SceneError::Disturbed { .. })));
    mpm.step().expect("it goes on");

    // An explosive charge at rest is refused, since its ignition time elapses.
    let charge = Explosive::<f64>::tnt().all_lit_after(1.0e-3).expect("charge");
    let scene = || {
        let mut mpm = scene();
        mpm.add("charge", charge, &plate(), |_| [0.0; 2]).expect("body");
        mpm
    };
    let (mut plain, mut mpm) = (scene(), scene());
    let clock = message(mpm.deactivate(&["charge"]));
    assert!(clock.contains("time_to_light of particle") && clock.contains("(0.001)"), "{clock}");
    for _ in 0..200 {
        assert_eq!(plain.step(), mpm.step());
    }
    assert!(plain.totals().kinetic > 0.0 && plain.bodies()[0].points() == mpm.bodies()[0].points());
}
