//! Observers: they change no results, record correct values, and refuse invalid names.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use mpm_materials::{LinearElastic, Moduli, NeoHookean};

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::observe::*;
use mpm_core::{
    Archive, Axisymmetric, Blend, BlockGrid, Boundary, CheckpointError, Flip, Linear, Method, Mpm, Musl,
    PlaneStrain, PointView, Run, RunError, Side, Solver, TimeControl,
};

/// Build an elastic square of 8 x 8 cells of 1 mm, 2 mm from the left wall and moving towards it.
fn square<E>(embedding: E) -> Mpm<2>
where
    Method<Linear, Flip, Musl, E>: mpm_core::IntoKernels<f64, 2>,
{
    let lattice = Lattice::new([0.0; 2], 1e-3).unwrap();
    let shape = Cuboid::new([2e-3, 2e-3], [10e-3, 10e-3]).unwrap();
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1e7, 0.3).unwrap()).unwrap();
    let seeds = fill(&shape, &lattice, 2, &Filling::new()).unwrap();
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, embedding), BlockGrid::new(lattice));
    mpm.add("square", law, &seeds, |[_, y]| [1.0 + 100.0 * y, -5.0]).unwrap();
    mpm.bound(Boundary::Wall { axis: 1, at: 2e-3, side: Side::Above, velocity: 0.0 }).unwrap();
    mpm
}

fn states(mpm: &Mpm<2>) -> Vec<PointView> {
    mpm.bodies()[0].points()
}

/// Counter of calls to `observe` and of calls at the end.
struct Count(Pace, u64, Arc<AtomicU64>);
impl Observer for Count {
    fn pace(&mut self) -> &mut Pace {
        &mut self.0
    }
    fn observe(&mut self, _: &RunView<'_>) -> Result<(), ObserveError> {
        self.1 += 1;
        if self.1 > 1000 { Err(ObserveError::Other("enough".into())) } else { Ok(()) }
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.1)
    }
    fn finish(&mut self) -> Result<(), ObserveError> {
        self.2.fetch_add(1, Ordering::Relaxed);
        Ok(())
    }
}

#[test]
fn a_watched_run_makes_the_same_steps() {
    let (mut alone, mut watched) = (square(PlaneStrain), square(PlaneStrain));
    alone.run_until(1e-3).unwrap();
    let mut ledger = Ledger::new(Pace::interval(7.7e-5).unwrap());
    let ends = Arc::new(AtomicU64::new(0));
    let mut count = Count(Pace::every_step(), 0, ends.clone());
    let run = Run::new(&mut watched).observe(&mut ledger).observe(&mut count).until(1e-3).unwrap();
    assert_eq!(alone.steps(), watched.steps());
    assert_eq!(states(&alone), states(&watched));
    assert_eq!(run.steps, watched.steps());
    assert_eq!(run.updates, (run.steps * 256) as f64);
    assert_eq!(count.1, run.steps + 1, "the start and every step, once");
    assert_eq!(ends.load(Ordering::Relaxed), 1);
    let first = ledger.entries().first().unwrap();
    let last = ledger.entries().last().unwrap();
    assert_eq!((first.step, last.step), (0, run.steps));
    assert_eq!(last.time, watched.time());
    for pair in ledger.entries().windows(2) {
        assert!(pair[0].time < pair[1].time);
    }
    // A run continued with the same observers observes no step twice.
    Run::new(&mut watched).observe(&mut count).until(1e-3).unwrap();
    assert_eq!(count.1, run.steps + 1);
}

#[test]
fn the_ledger_closes() {
    let mut mpm = square(PlaneStrain);
    let mut ledger = Ledger::new(Pace::every_step());
    // Until separation from the wall: later, linear shape functions cause noise.
    Run::new(&mut mpm).observe(&mut ledger).until(1.3e-4).unwrap();
    assert!(ledger.worst_momentum_error() < 1e-13, "{:e}", ledger.worst_momentum_error());
    // Kinetic and internal energy are half a step apart in time: their sum oscillates while the eight cells decelerate, half as much at
    // half the step.
    let worst = ledger.worst_energy_error();
    let (mut shorter, mut halved) = (square(PlaneStrain), Ledger::new(Pace::every_step()));
    shorter.set_time_control(TimeControl::Courant { factor: 0.25, growth: 1.1 }).unwrap();
    Run::new(&mut shorter).observe(&mut halved).until(1.3e-4).unwrap();
    let half = halved.worst_energy_error();
    assert!(worst.abs() < 0.045 && half.abs() < 0.6 * worst.abs(), "{worst:e}, with half the step {half:e}");
    let (first, last) = (ledger.entries()[0], *ledger.entries().last().unwrap());
    assert_eq!(last.total, last.kinetic + last.internal - last.work);
    // Scale: largest energy so far, slightly above the initial energy.
    assert!((last.energy_error - (last.total / first.total - 1.0)).abs() < 1e-3);
    let pushed = mpm.exchange().impulse[1];
    assert!(pushed > 0.0, "the wall pushes upwards: {pushed}");
    // Work of gravity, in a scene that starts at rest.
    let mut mpm = square(PlaneStrain);
    mpm.set_body_force(|_| [0.0, -1e4]);
    let mut ledger = Ledger::new(Pace::every_step());
    Run::new(&mut mpm).observe(&mut ledger).until(2e-4).unwrap();
    assert!(ledger.worst_momentum_error() < 1e-13, "{:e}", ledger.worst_momentum_error());
}

/// Energy and momentum balance of a FLIP/PIC blend at a symmetry plane: the plane includes the FLIP and PIC parts.
#[test]
fn the_ledger_closes_for_a_blend_on_a_plane() {
    let lattice = Lattice::new([0.0; 2], 1e-3).unwrap();
    let shape = Cuboid::new([0.0, 0.0], [8e-3, 8e-3]).unwrap();
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1e7, 0.3).unwrap()).unwrap();
    let seeds = fill(&shape, &lattice, 2, &Filling::new()).unwrap();
    let method = Method::new(Linear, Blend::new(1e-4).unwrap(), Musl, PlaneStrain);
    let mut mpm = Mpm::new(method, BlockGrid::new(lattice));
    mpm.add("square", law, &seeds, |[_, y]| [0.0, -1e3 * y]).unwrap();
    mpm.bound(Boundary::Symmetry { axis: 1, at: 0.0, side: Side::Above }).unwrap();
    let mut ledger = Ledger::new(Pace::every_step());
    Run::new(&mut mpm).observe(&mut ledger).until(2e-4).unwrap();
    assert!(ledger.worst_momentum_error() < 1e-13, "{:e}", ledger.worst_momentum_error());
}

#[test]
fn an_axisymmetric_ledger_looks_along_the_axis() {
    let mut mpm = square(Axisymmetric);
    let mut ledger = Ledger::new(Pace::every_step());
    Run::new(&mut mpm).observe(&mut ledger).until(3e-4).unwrap();
    assert!(ledger.worst_momentum_error() < 1e-13, "{:e}", ledger.worst_momentum_error());
}

#[test]
fn probes_read_their_particle() {
    let mut mpm = square(PlaneStrain);
    let list = [
        Probe::new(0, 37, Quantity::Position(0)),
        Probe::new(0, 37, Quantity::Velocity(1)),
        Probe::new(0, 200, Quantity::VonMises),
        Probe::new(0, 200, Quantity::State("stress_xy".into())),
        Probe::new(0, 200, Quantity::Stress(5)),
    ];
    let mut probes = Probes::new(list, Pace::steps(10).unwrap());
    Run::new(&mut mpm).observe(&mut probes).until(2e-4).unwrap();
    let last = probes.rows().last().unwrap();
    let all = states(&mpm);
    let find = |n: usize| all.iter().find(|p| p.number == n).unwrap();
    assert_eq!(last.values[0], find(37).position[0]);
    assert_eq!(last.values[1], find(37).velocity[1]);
    assert_eq!(last.values[3], find(200).stress[5]);
    assert_eq!(last.values[3], last.values[4]);
    assert!(last.values[2] >= 3f64.sqrt() * last.values[4].abs());
}

#[test]
fn a_snapshot_holds_all_particles_and_state() {
    let mut mpm = square(PlaneStrain);
    mpm.run_until(2e-4).unwrap();
    let snapshot = mpm.snapshot().unwrap();
    assert_eq!((snapshot.len(), snapshot.dimension(), snapshot.step()), (256, 2, mpm.steps()));
    let names: Vec<&str> = snapshot.fields().map(|f| f.0).collect();
    assert_eq!(names[..5], ["velocity", "stress", "pressure", "von_mises", "particle"]);
    let kept = mpm.bodies()[0].state_names().len();
    assert_eq!(names.len(), 5 + kept - 6, "{names:?}: all the law keeps but its stress");
    // Particle size: a quarter of a cell, nearly undeformed.
    assert!((snapshot.size_of(0) / 0.5e-3 - 1.0).abs() < 0.1, "{}", snapshot.size_of(0));
    let mut round = square(Axisymmetric);
    round.run_until(1e-5).unwrap();
    let size = round.snapshot().unwrap().size_of(0);
    // Seeds in the plane metric have an area, not an area times radius: only the magnitude is checked.
    assert!(size.is_finite() && size > 0.0);
}

#[test]
fn what_is_not_there_is_refused_by_name() {
    let mut mpm = square(PlaneStrain);
    let mut refuse = |probe: Probe| {
        let mut probes = Probes::new([probe], Pace::every_step());
        Run::new(&mut mpm).observe(&mut probes).until(1e-4).unwrap_err().to_string()
    };
    let body = refuse(Probe::new(3, 0, Quantity::Pressure));
    assert!(body.contains("probe of body 3") && body.contains("1 bodies"), "{body}");
    let particle = refuse(Probe::new(0, 256, Quantity::Pressure));
    assert!(particle.contains("particle 256 of body `square`") && particle.contains("256"), "{particle}");
    let state = refuse(Probe::new(0, 0, Quantity::State("heat".into())));
    assert!(state.contains("`heat`") && state.contains("stress_xx"), "{state}");
    let end = Run::new(&mut mpm).until(f64::NAN).unwrap_err().to_string();
    assert!(end.contains("end = NaN"), "{end}");
    mpm.run_until(1e-4).unwrap();
    assert!(matches!(Run::new(&mut mpm).until(1e-5), Err(RunError::End { .. })));
}

#[test]
fn an_observer_that_fails_stops_the_run() {
    let mut mpm = square(PlaneStrain);
    let ends = Arc::new(AtomicU64::new(0));
    let mut count = Count(Pace::every_step(), 1000, ends.clone());
    let said = Run::new(&mut mpm).observe(&mut count).until(1e-3).unwrap_err().to_string();
    assert_eq!(said, "observer at t = 0.000000e0 s: enough");
    assert_eq!(ends.load(Ordering::Relaxed), 1, "it is told of the end all the same");
}

#[test]
fn files_hold_a_row_or_frame_a_look() {
    let folder = std::env::temp_dir().join(format!("impactite-observe-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut mpm = square(PlaneStrain);
    let pace = Pace::interval(1e-4).unwrap();
    let mut ledger = Ledger::new(pace).with_csv(folder.join("ledger.csv")).unwrap();
    let mut probes =
        Probes::new([Probe::new(0, 5, Quantity::Volume)], pace).with_csv(folder.join("probes.csv")).unwrap();
    let columns = [("time", "s"), ("particles", "-")];
    let mut history = HistoryCsv::create(folder.join("history.csv"), columns, pace, |now: &RunView<'_>| {
        Ok(vec![now.time(), now.totals().particles as f64])
    })
    .unwrap();
    let mut vtk = VtkSeries::create(&folder, "square", pace).unwrap();
    let mut pictures = Pictures::create(&folder, "square", pace, |s| {
        mpm_core::output::picture::FieldPicture::new(64, 64).draw(s)
    })
    .unwrap();
    let mut bar = Progress::new("square");
    let all: [&mut dyn Observer; 6] =
        [&mut ledger, &mut probes, &mut history, &mut vtk, &mut pictures, &mut bar];
    Run::new(&mut mpm).observe_all(all).until(3e-4).unwrap();
    for name in ["ledger.csv", "probes.csv", "history.csv"] {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(text.lines().count(), 1 + 4, "{name}:\n{text}");
    }
    assert_eq!((vtk.frames(), pictures.frames()), (4, 4));
    assert!(vtk.index().is_file() && folder.join("square_000003.png").is_file());
    std::fs::remove_dir_all(folder).unwrap();
    assert!(Pictures::create(".", "a/b", pace, |_| unreachable!()).is_err());
}

/// A square that flies and spins is of small strain at any angle; a square in fast impact on a wall is not.
#[test]
fn bodies_of_small_strain_are_told_from_others() {
    let scene = || {
        let lattice = Lattice::new([0.0; 2], 1e-3).unwrap();
        let law = || NeoHookean::new(1000.0, Moduli::young_poisson(1e6, 0.3).unwrap()).unwrap();
        let square = |low: [f64; 2]| {
            let shape = Cuboid::new(low, low.map(|x| x + 4e-3)).unwrap();
            fill(&shape, &lattice, 2, &Filling::new()).unwrap()
        };
        let mut mpm = Mpm::new(Method::impact(PlaneStrain), BlockGrid::new(lattice));
        mpm.add("spins", law(), &square([20e-3, 20e-3]), |[x, y]| {
            [-400.0 * (y - 22e-3), 400.0 * (x - 22e-3)]
        })
        .unwrap();
        mpm.add("strikes", law(), &square([2e-3, 2e-3]), |_| [0.0, -12.0]).unwrap();
        mpm.bound(Boundary::Wall { axis: 1, at: 2e-3, side: Side::Above, velocity: 0.0 }).unwrap();
        mpm
    };
    let observer = || SmallStrain::new(Pace::interval(2e-5).unwrap(), 0.05);
    let (mut mpm, mut strain) = (scene(), observer());
    let mut run = Run::new(&mut mpm).observe(&mut strain);
    run.until(1e-3).and_then(|_| run.until(2e-3)).unwrap();
    drop(run);
    let report = strain.report();
    let [spins, strikes] = &report[..] else { panic!("{report:?}") };
    assert!(spins.elements_would_do() && spins.points == 64 && spins.of_all == 0.5, "{spins}");
    assert!(spins.to_string().contains("finite elements would do, and save up to 50 %"), "{spins}");
    assert!(!strikes.elements_would_do() && strikes.small < 0.7, "{strikes}");
    assert!(!strikes.to_string().contains("elements would"), "{strikes}");

    // A run resumed half way gives the same result.
    let file = std::env::temp_dir().join(format!("impactite-small-strain-{}", std::process::id()));
    let (mut first, mut before) = (scene(), observer());
    Run::new(&mut first).observe(&mut before).checkpoint(&file, Pace::every_step()).until(1e-3).unwrap();
    let (mut second, mut after) = (scene(), observer());
    Run::new(&mut second).observe(&mut after).resume(&file).unwrap().until(2e-3).unwrap();
    std::fs::remove_file(&file).unwrap();
    assert_eq!(after.report(), report);
}
