//! Run-time checks of every run: an energy gain stops it with its cause; numerical fracture, locking and failure by noise cause warnings;
//! sound runs cause none.

use std::f64::consts::TAU;
use std::sync::Arc;

use mpm_core::geometry::{Ball, Cuboid, Filling, Lattice, fill};
use mpm_core::{
    BlockGrid, Boundary, Finding, Flip, FullSpace, GainCause, IntoKernels, Kernels, Linear, Method, Mpm,
    Musl, PlaneStrain, Side, Stopped, Team, TimeControl, Watch,
};
use mpm_materials::failure::PrincipalStress;
use mpm_materials::{
    Constitutive, IntoMaterial, J2, LinearElastic, LogarithmicBulk, Moduli, NeoHookean, Solid, library,
};

/// Build a steel disc of 0.1 m with `cells` cells per radius and rim speed `rim`, m/s; return it with the time of a
/// turn, s.
fn disc<M: IntoKernels<f64, 2>>(
    method: M,
    law: impl IntoMaterial<f64>,
    cells: f64,
    rim: f64,
) -> (Mpm<2>, f64) {
    let lattice = Lattice::new([0.003, -0.002], 0.1 / cells).expect("lattice");
    let seeds = fill(&Ball::new([0.0; 2], 0.1).expect("disc"), &lattice, 2, &Filling::new()).expect("seeds");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    let spin = rim / 0.1;
    mpm.add("disc", law, &seeds, |x| [-spin * x[1], spin * x[0]]).expect("disc");
    (mpm, TAU / spin)
}

#[test]
fn noise_that_tears_a_spinning_disc_is_named() {
    let (mut mpm, turn) =
        disc(Method::new(Linear, Flip, Musl, PlaneStrain), library::arne_tool_steel(), 6.0, 50.0);
    let stopped = mpm.run_until(20.0 * turn).expect_err("the disc gains energy");
    let Stopped::Watch(finding) = &stopped.what else { panic!("{stopped}") };
    let Finding::EnergyGain { share, body, position, cause, .. } = &**finding else { panic!("{stopped}") };
    let radius = position[0].hypot(position[1]);
    assert!(*share > 0.1 && *share < 1.0 && body == "disc" && radius < 0.3, "{stopped}");
    assert!(matches!(cause, GainCause::Unseen { .. }), "{stopped}");
    assert!(stopped.to_string().contains("Method::impact"), "{stopped}");
    // A stopped run stays stopped until the watch is changed.
    assert_eq!(mpm.step().expect_err("stopped"), stopped);
    mpm.set_watch(Watch::default().only_warn());
    mpm.step().expect("step");
    let gains = mpm.warnings().iter().filter(|w| matches!(w.finding, Finding::EnergyGain { .. })).count();
    assert_eq!(gains, 1, "warned of once, at 2 %");

    let (mut mpm, turn) = disc(Method::impact(PlaneStrain), library::arne_tool_steel(), 6.0, 50.0);
    mpm.run_until(turn).expect("run");
    assert_eq!(mpm.warnings(), []);
}

#[test]
fn points_that_noise_fails_one_by_one_are_counted() {
    let h = 0.01;
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let plate = Cuboid::new([0.0; 2], [0.4, 0.4]).expect("plate");
    let seeds = fill(&plate, &lattice, 2, &Filling::new()).expect("seeds");
    let strength = J2::linear(80e9, 800e6, 0.0).expect("strength");
    let eos = LogarithmicBulk::new(7850.0, 165e9).expect("equation of state");
    let failure = PrincipalStress::new(2e8, 1e12).expect("failure");
    let steel = Solid::new(strength, eos).with_failure(failure);
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    // Every fifth cell has an initial velocity jump.
    let kick = |x: [f64; 2]| {
        let cell = x.map(|x| (x / h) as i64 % 5);
        let side = if (x[0] / h).fract() < 0.5 { -16.0 } else { 16.0 };
        [if cell == [2, 2] { side } else { 0.0 }, 0.0]
    };
    mpm.add("plate", steel.compiled(), &seeds, kick).expect("plate");
    mpm.set_watch(Watch::default().only_warn());
    mpm.run_until(4e-5).expect("run");
    let lone = mpm.warnings().iter().find_map(|w| match &w.finding {
        Finding::LoneFailure { failed, alone, .. } => Some((*failed, *alone)),
        _ => None,
    });
    let mut failed = 0;
    mpm.bodies()[0].for_each(&mut |p| failed += u64::from(p.failed));
    assert!(
        lone.is_some_and(|(count, alone)| count == failed && 2 * alone > failed),
        "{failed}: {:?}",
        mpm.warnings()
    );
}

/// Build a vibrating block of 8 x 4 cells with a fixed step `dt`.
fn block(dt: f64) -> Mpm<2> {
    let h = 0.1;
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let seeds = fill(&Cuboid::new([0.0; 2], [0.8, 0.4]).expect("block"), &lattice, 2, &Filling::new())
        .expect("seeds");
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1e7, 0.3).expect("moduli")).expect("law");
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    mpm.add("block", law, &seeds, |x| [1e-3 * (3.0 * x[0]).sin(), 0.0]).expect("block");
    mpm.set_time_control(TimeControl::Fixed(dt)).expect("time control");
    mpm.set_watch(Watch::default().every(8).expect("steps"));
    mpm
}

#[test]
fn a_time_step_too_long_is_named() {
    let bound = 2.0 / block(1.0).frequency_bound().bound;
    // Waves of 116 m/s cross 1.8 cells per step; the stability limit of FLIP with MUSL in one dimension is sqrt 2.
    let dt = 1.8 * 0.1 / (1e7 * 0.7 / (1.3 * 0.4) / 1000.0f64).sqrt();
    let stopped = block(dt).run_until(1e3 * dt).expect_err("unstable");
    let Stopped::Watch(finding) = &stopped.what else { panic!("{stopped}") };
    let Finding::EnergyGain { cause: GainCause::TimeStep { dt: named, limit }, .. } = **finding else {
        panic!("{stopped}")
    };
    assert!((named / dt - 1.0).abs() < 1e-6 && (limit / bound - 1.0).abs() < 0.1, "{stopped}");
    let mut mpm = block(0.9 * bound);
    mpm.run_until(1e3 * bound).expect("stable");
    assert_eq!(mpm.warnings(), []);
}

/// Build a strip that its initial velocity stretches to four times its length.
fn drawn<M: IntoKernels<f64, 2>>(method: M, law: impl IntoMaterial<f64>) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], 0.01).expect("lattice");
    let strip = Cuboid::new([0.0; 2], [0.2, 0.04]).expect("strip");
    let seeds = fill(&strip, &lattice, 2, &Filling::new()).expect("seeds");
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("strip", law, &seeds, |x| [1e4 * x[0], 0.0]).expect("strip");
    mpm.run_until(3e-4).expect("run");
    mpm
}

#[test]
fn numerical_fracture_is_told_from_fragments_and_from_gas() {
    let soft = || NeoHookean::new(1000.0, Moduli::young_poisson(1e5, 0.3).expect("moduli")).expect("law");
    let torn = |mpm: &Mpm<2>| {
        mpm.warnings().iter().find_map(|w| match &w.finding {
            Finding::Torn { body, parts, before, share } => Some((body.clone(), *parts, *before, *share)),
            _ => None,
        })
    };
    let strip = drawn(Method::new(Linear, Flip, Musl, PlaneStrain), soft());
    let (body, parts, before, share) = torn(&strip).expect("a torn strip");
    assert!(body == "strip" && parts > 5 && before == 1 && share > 0.5, "{:?}", strip.warnings());
    let whole = drawn(Method::large_elastic(PlaneStrain), soft());
    assert_eq!(torn(&whole), None);
    let gas = library::air();
    assert_eq!(torn(&drawn(Method::new(Linear, Flip, Musl, PlaneStrain), gas)), None);
}

/// Build a rough footing of half width 1 m pressed 0.05 m into perfectly plastic soil with isochoric flow.
fn footing<M: IntoKernels<f64, 2>>(method: M) -> Mpm<2> {
    let h = 0.25;
    let lattice = Lattice::new([0.0; 2], h).expect("lattice");
    let soil = Cuboid::new([0.0, -2.0], [3.0, 0.0]).expect("soil");
    let moduli = Moduli::<f64>::young_poisson(4000.0, 0.45).expect("moduli");
    let law = Solid::new(
        J2::linear(moduli.shear, 3.0f64.sqrt(), 0.0).expect("strength"),
        LogarithmicBulk::new(1.0, moduli.bulk).expect("equation of state"),
    );
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("soil", law, &fill(&soil, &lattice, 2, &Filling::new()).expect("seeds"), |_| [0.0; 2])
        .expect("soil");
    for (axis, at, side) in [(0, 0.0, Side::Above), (0, 3.0, Side::Below), (1, -2.0, Side::Above)] {
        mpm.bound(Boundary::Symmetry { axis, at, side }).expect("plane");
    }
    let time = 20.0 / moduli.shear.sqrt();
    let region = Arc::new(Cuboid::new([-h, -0.1 * h], [1.0 + 0.1 * h, h]).expect("footing"));
    let velocity = Arc::new(move |_: f64| [Some(0.0), Some(-0.05 / time), None]);
    mpm.bound(Boundary::Prescribed { region, velocity }).expect("footing");
    mpm.set_local_damping(0.3).expect("damping");
    mpm.run_until(time).expect("run");
    mpm
}

#[test]
fn locking_is_told_from_a_pressure_that_is_smooth() {
    let locks = |mpm: &Mpm<2>| mpm.warnings().iter().any(|w| matches!(w.finding, Finding::Locking { .. }));
    let locked = footing(Method::new(Linear, Flip, Musl, PlaneStrain));
    assert!(locks(&locked), "{:?}", locked.warnings());
    let mean = footing(Method::new(Linear, Flip, Musl, PlaneStrain).mean_dilatation().compiled());
    assert!(!locks(&mean), "{:?}", mean.warnings());
}

/// The watch changes no results; balances and checks continue after a restart without a difference.
#[test]
fn watched_runs_are_the_same_bits_and_books_are_saved() {
    let run = |watch: Watch, end: f64| {
        let mut mpm = block(0.3e-3);
        mpm.set_watch(watch);
        mpm.run_until(end).expect("run");
        mpm
    };
    let (often, off) = (Watch::default().every(1).expect("steps"), Watch::off());
    assert_eq!(run(often, 0.05).totals(), run(off, 0.05).totals());

    let file = std::env::temp_dir().join(format!("impactite-watch-{}", std::process::id()));
    let mut first = run(often, 0.02);
    first.save(&file).expect("saved");
    let mut second = block(0.3e-3).resumed(&file).expect("resumed");
    second.set_watch(often);
    std::fs::remove_file(&file).expect("removed");
    first.run_until(0.05).expect("run");
    second.run_until(0.05).expect("run");
    assert_eq!(first.account(), second.account());
    assert!(first.account().energy_scale > 0.0 && first.account().unexplained != 0.0);
}

#[test]
fn limits_that_are_none_are_refused() {
    let refused = [
        (Watch::default().every(0), "every = 0"),
        (Watch::default().stop_at_gain(-0.1), "stop at gain = -0.1"),
        (Watch::default().warn_at_gain(f64::NAN), "warn at gain = NaN"),
        (Watch::default().warn_at_loss(0.0), "warn at loss = 0"),
        (Watch::default().stop_at_momentum(f64::INFINITY), "stop at momentum = inf"),
    ];
    for (watch, what) in refused {
        let message = watch.expect_err(what).to_string();
        assert_eq!(message, format!("watch: {what} is not allowed; it must be positive and finite"));
    }
}

/// Cost of watch checks, in steps: `cargo test --release -p impactite-tests --all-features --test step -- --ignored --nocapture
/// looks_cost`.
#[test]
#[ignore = "a measurement, not a test"]
fn looks_cost() {
    let methods: [(&str, Kernels<f64, 3>); 2] = [
        ("linear FLIP MUSL", Method::new(Linear, Flip, Musl, FullSpace).into_kernels()),
        ("Method::impact", Method::impact(FullSpace).into_kernels()),
    ];
    for threads in [1, 2] {
        for (name, method) in &methods {
            let seconds = |watch: Watch| {
                let h = 1e-3;
                let lattice = Lattice::new([0.0; 3], h).expect("lattice");
                let cube = Cuboid::new([0.0; 3], [30.0 * h; 3]).expect("cube");
                let seeds = fill(&cube, &lattice, 2, &Filling::new()).expect("seeds");
                let mut mpm = Mpm::new(method.clone(), BlockGrid::new(lattice));
                mpm.set_watch(watch);
                mpm.set_team(Team::new(threads).expect("team"));
                let turning = |x: [f64; 3]| {
                    [20.0 * (x[1] / 0.03).sin(), 15.0 * (x[2] / 0.02).cos(), -100.0 * x[2] / 0.03]
                };
                mpm.add("cube", library::copper_taylor(), &seeds, turning).expect("cube");
                let mut best = f64::INFINITY;
                for _ in 0..5 {
                    let clock = std::time::Instant::now();
                    // Sixteen checks, one of them with all bodies.
                    for _ in 0..128 {
                        mpm.step().expect("step");
                    }
                    best = best.min(clock.elapsed().as_secs_f64());
                }
                best
            };
            let often = Watch::default().every(8).expect("steps");
            let [off, books, all] = [Watch::off(), often.without_bodies(), often].map(seconds);
            let step = off / 128.0;
            let (look, bodies) = ((books - off) / step / 16.0, (all - books) / step);
            println!(
                "{name}, {threads} threads, 216 000 particles: {:.1} million updates/s; a look at the books {look:.2} steps, at bodies {bodies:.1}; \
                 together {:.2} % of a run",
                216e-3 / step,
                100.0 * (look / 256.0 + bodies / 4096.0)
            );
        }
    }
}
