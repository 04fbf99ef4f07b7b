//! Conformance tests of solvers, built-in or custom, in one line each. Behind the feature `conformance`.
//!
//! ```ignore
//! impactite_scene::solver_conforms! {
//!     bar: || -> Bar { Bar::new(20, 1.0) }, SolverTests::until(1.0e-3).energy_within(0.01).breaking(1.0, || Bar::new(20, f64::NAN));
//! }
//! ```
//! The line becomes a module `bar` with one test per property. The functions can also be called; they return the first [`Broken`] property.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use impactite_simd::Team;

use super::Broken;
use crate::archive::{Archive, CheckpointError};
use crate::balance::{Account, Books, share};
use crate::body::{PointView, Totals};
use crate::error::Stopped;
use crate::exchange::Exchange;
use crate::observe::{Ledger, ObserveError, Observer, Pace, RunView, VtkSeries};
use crate::run::{Run, RunError};
use crate::solver::Solver;

type Check = Result<(), Broken>;
type Maker = Arc<dyn Fn() -> Box<dyn Solver> + Send + Sync>;

/// Settings of the tests of a solver: end time, some hundred steps from the start at most, and tolerances.
#[derive(Clone)]
pub struct SolverTests {
    end: f64,
    energy: f64,
    momentum: f64,
    breaking: Option<(f64, Maker)>,
}

impl SolverTests {
    /// Run until `end`, s. By default energy is conserved within 1 % of its largest value and momentum within 1e-12.
    #[must_use]
    pub fn until(end: f64) -> Self {
        SolverTests { end, energy: 0.01, momentum: 1e-12, breaking: None }
    }
    /// Set the tolerance of the energy error, as a share of the largest energy.
    #[must_use]
    pub fn energy_within(self, share: f64) -> Self {
        SolverTests { energy: share, ..self }
    }
    /// Set the tolerance of the momentum error, as a share of the largest sum of m |v|.
    #[must_use]
    pub fn momentum_within(self, share: f64) -> Self {
        SolverTests { momentum: share, ..self }
    }
    /// Add a scene that fails before `end`, s, at a point or in one of its own quantities.
    #[must_use]
    pub fn breaking<S: Solver>(self, end: f64, scene: impl Fn() -> S + Send + Sync + 'static) -> Self {
        SolverTests { breaking: Some((end, Arc::new(move || Box::new(scene())))), ..self }
    }
}

/// Constructor of the scene under test.
pub type Scene<'a> = &'a dyn Fn() -> Box<dyn Solver>;

fn broken<X>(solver: &dyn Solver, property: &'static str, detail: impl Into<String>) -> Result<X, Broken> {
    Err(Broken { subject: solver.method(), property, detail: detail.into() })
}

fn run(solver: &mut dyn Solver, end: f64, property: &'static str) -> Check {
    solver.run_until(end).or_else(|error| broken(solver, property, format!("it stopped: {error}")))
}

/// Public state of a scene, by bits.
#[derive(PartialEq)]
struct Seen {
    time: u64,
    steps: u64,
    points: Vec<Vec<u64>>,
    exchange: Vec<u64>,
}

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u64> {
    numbers.into_iter().map(f64::to_bits).collect()
}

fn seen(solver: &dyn Solver) -> Seen {
    let of = |p: &PointView| {
        let PointView { number, position, velocity, mass, volume, stress, state, .. } = p;
        let vectors = position.iter().chain(velocity).chain(stress).chain(state);
        bits(vectors.copied().chain([*number as f64, *mass, *volume]))
    };
    let points = solver.bodies().iter().flat_map(|b| b.points()).map(|p| of(&p)).collect();
    let Exchange {
        impulse,
        load,
        work,
        dropped,
        friction,
        impacts,
        damping,
        viscosity,
        conversion,
        node_contact,
        accounts,
    } = solver.exchange();
    let accounts = accounts.into_iter().flat_map(|booking| booking.impulse.into_iter().chain([booking.work]));
    let vectors = impulse.into_iter().chain(load).chain(dropped).chain(accounts);
    let exchange =
        bits(vectors.chain([work, friction, impacts, damping, viscosity, conversion, node_contact]));
    Seen { time: solver.time().to_bits(), steps: solver.steps(), points, exchange }
}

fn compare(solver: &dyn Solver, property: &'static str, here: &Seen, there: &Seen) -> Check {
    if here == there {
        return Ok(());
    }
    let differ = here.points.iter().zip(&there.points).position(|(a, b)| a != b);
    let detail = match differ {
        _ if (here.time, here.steps) != (there.time, there.steps) => {
            let time = |s: &Seen| f64::from_bits(s.time);
            format!("{} steps to {:e} s, and {} to {:e} s", here.steps, time(here), there.steps, time(there))
        }
        _ if here.points.len() != there.points.len() => {
            format!("{} points and {}", here.points.len(), there.points.len())
        }
        Some(point) => format!("point {point} of all differs"),
        None => "what was exchanged differs".to_string(),
    };
    broken(solver, property, detail)
}

/// Test bodies: unique names, finite points with unique numbers, and counts and masses that agree with the points.
///
/// # Errors
/// The first property that does not hold.
pub fn bodies(scene: Scene<'_>, tests: &SolverTests) -> Check {
    let mut solver = scene();
    for end in [0.0, tests.end] {
        run(&mut *solver, end, "bodies: the run")?;
        let list = solver.bodies();
        for (n, body) in list.iter().enumerate() {
            let name = body.name();
            if name.is_empty() || list[..n].iter().any(|other| other.name() == name) {
                return broken(&*solver, "names of bodies are their own", format!("body {n} is `{name}`"));
            }
            let points = body.points();
            let names = body.state_names().len();
            let mut sum = Totals::default();
            for (k, p) in points.iter().enumerate() {
                sum.add_point(p.mass, &p.position, &p.velocity);
                let numbers =
                    p.position.iter().chain(&p.velocity).chain(&p.stress).chain([&p.mass, &p.volume]);
                if !numbers.chain(&p.state).all(|x| x.is_finite()) {
                    return broken(&*solver, "points are finite", format!("point {k} of `{name}`: {p:?}"));
                }
                if p.state.len() != names {
                    let detail = format!("point {k} of `{name}` has {} for {names} names", p.state.len());
                    return broken(&*solver, "points have a number for every name", detail);
                }
                if k > 0 && points[k - 1].number == p.number {
                    let detail = format!("{} of `{name}` is there twice", p.number);
                    return broken(&*solver, "points have numbers of their own", detail);
                }
            }
            if points.len() != body.len() {
                let detail = format!("{} of {} in `{name}`", points.len(), body.len());
                return broken(&*solver, "points are counted", detail);
            }
            let totals = body.totals();
            // A rigid body with prescribed motion has no mass of its own.
            if totals.mass > 0.0 && (totals.mass - sum.mass).abs() > 1e-12 * sum.mass {
                let detail = format!("`{name}`: {} kg, and {} kg of its points", totals.mass, sum.mass);
                return broken(&*solver, "the mass is that of the points", detail);
            }
        }
    }
    let snapshot = solver.snapshot().map_err(|error| Broken {
        subject: solver.method(),
        property: "the scene can be drawn",
        detail: error.to_string(),
    })?;
    let points: usize = solver.bodies().iter().map(|b| b.len()).sum();
    if snapshot.len() != points {
        return broken(&*solver, "snapshots hold all points", format!("{} of {points}", snapshot.len()));
    }
    Ok(())
}

/// Test the conservation of mass, momentum and energy, up to the exchange.
///
/// # Errors
/// The first property that does not hold.
pub fn balances(scene: Scene<'_>, tests: &SolverTests) -> Check {
    let mut solver = scene();
    let axisymmetric = solver.axisymmetric();
    let mut books = Books::default();
    let first = solver.totals();
    books.enter(&first, &solver.exchange(), axisymmetric);
    for part in 1..=20 {
        run(&mut *solver, tests.end * f64::from(part) / 20.0, "balances: the run")?;
        let now = solver.totals();
        let account = books.enter(&now, &solver.exchange(), axisymmetric);
        if (now.mass - first.mass).abs() > 1e-12 * first.mass {
            return broken(
                &*solver,
                "mass is conserved",
                format!("{} kg became {} kg", first.mass, now.mass),
            );
        }
        let momentum = share(account.missing(), account.momentum_scale);
        if momentum.is_nan() || momentum > tests.momentum {
            let detail = format!("{:?} kg m/s are missing, {momentum:e} of all", account.momentum);
            return broken(&*solver, "momentum is conserved", detail);
        }
        let energy = account.energy_error().abs();
        if energy.is_nan() || energy > tests.energy {
            let detail = format!("{:e} J are missing, {energy:e} of all", account.unexplained);
            return broken(&*solver, "energy is conserved", detail);
        }
    }
    Ok(())
}

/// Test steps: size limit, exact end times, and errors for invalid times.
///
/// # Errors
/// The first property that does not hold.
pub fn steps(scene: Scene<'_>, tests: &SolverTests) -> Check {
    let mut solver = scene();
    let stable = solver.stable_step();
    let stable = stable.or_else(|e| broken(&*solver, "there is a stable step", e.to_string()))?;
    if stable.is_nan() || stable <= 0.0 {
        return broken(&*solver, "the stable step is positive", format!("{stable} s"));
    }
    let left = 0.01 * tests.end.min(stable);
    // A method may have planned its first step before it receives the limit.
    for n in 0..3 {
        let (time, count) = (solver.time(), solver.steps());
        let dt = solver.step_at_most(left).or_else(|e| broken(&*solver, "a step is made", e.to_string()))?;
        if n > 0 && dt > left * (1.0 + 1e-12) {
            let detail = format!("{dt:e} s where {left:e} s were allowed");
            return broken(&*solver, "steps are no longer than allowed", detail);
        }
        if solver.time() <= time || solver.steps() != count + 1 {
            let detail = format!("{time:e} s, then {:e} s after {} steps", solver.time(), solver.steps());
            return broken(&*solver, "a step advances the clock", detail);
        }
    }
    for end in [0.5 * tests.end, tests.end] {
        run(&mut *solver, end, "ends are met")?;
        if solver.time() != end {
            return broken(&*solver, "ends are met exactly", format!("{:e} s for {end:e} s", solver.time()));
        }
    }
    let before = seen(&*solver);
    for (what, end) in [("NaN", f64::NAN), ("infinity", f64::INFINITY), ("the past", 0.5 * tests.end)] {
        let refused = solver.run_until(end);
        if !matches!(&refused, Err(error) if matches!(error.what, Stopped::Clock { .. })) {
            return broken(&*solver, "ends that cannot be are refused", format!("{what}: {refused:?}"));
        }
    }
    for left in [0.0, -1.0, f64::NAN] {
        if solver.step_at_most(left).is_ok() {
            return broken(&*solver, "steps that cannot be are refused", format!("at most {left} s"));
        }
    }
    compare(&*solver, "what is refused changes nothing", &before, &seen(&*solver))?;
    run(&mut *solver, 1.01 * tests.end, "a run goes on after what was refused")
}

/// Test that results are the same bits for any number of threads.
///
/// # Errors
/// The first property that does not hold.
pub fn threads(scene: Scene<'_>, tests: &SolverTests) -> Check {
    let property = "results are the same bits for any number of threads";
    let mut one = scene();
    run(&mut *one, tests.end, property)?;
    let alone = seen(&*one);
    for threads in [1, 2, 3, 4] {
        let mut solver = scene();
        let team = Team::new(threads).or_else(|e| broken(&*solver, property, e.to_string()))?;
        solver.set_team(team);
        run(&mut *solver, tests.end, property)?;
        compare(&*solver, property, &seen(&*solver), &alone)?;
    }
    Ok(())
}

/// Temporary folder, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        Folder(std::env::temp_dir().join(format!("impactite-conformance-{}-{number}", std::process::id())))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Observer that counts its observations.
struct Count {
    pace: Pace,
    looks: u64,
}

impl Observer for Count {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let _ = (now.snapshot()?, now.contact_points(), now.totals());
        let numbers = |account: Account| [account.kinetic, account.internal, account.rest].map(f64::to_bits);
        if numbers(now.account()) != numbers(now.solver().account()) {
            return Err(ObserveError::Other("`account` is not `account_of` the totals".into()));
        }
        self.looks += 1;
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.word(&mut self.looks)
    }
}

/// Observer that stops a run after a step, as if it had been killed.
struct Kill {
    pace: Pace,
    after: u64,
}

impl Observer for Kill {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        if now.step() < self.after { Ok(()) } else { Err(ObserveError::Other("killed".into())) }
    }
    fn archive(&mut self, _: &mut Archive) -> Result<(), CheckpointError> {
        Ok(())
    }
}

/// Test that observers change nothing, are called once per step, and write their output.
///
/// # Errors
/// The first property that does not hold.
pub fn observers(scene: Scene<'_>, tests: &SolverTests) -> Check {
    let property = "observers change nothing";
    let (mut alone, mut watched) = (scene(), scene());
    run(&mut *alone, tests.end, property)?;
    let folder = Folder::new();
    let failed = |error: String| Broken { subject: "observers".into(), property, detail: error };
    let mut ledger = Ledger::new(Pace::every_step());
    let mut count = Count { pace: Pace::every_step(), looks: 0 };
    let made = Pace::interval(0.25 * tests.end).and_then(|pace| VtkSeries::create(&folder.0, "run", pace));
    let mut series = made.map_err(|e| failed(e.to_string()))?;
    let mut observed = Run::new(&mut *watched).observe(&mut ledger).observe(&mut count).observe(&mut series);
    let summary = observed.until(tests.end).map_err(|e| failed(e.to_string()))?;
    compare(&*watched, property, &seen(&*watched), &seen(&*alone))?;
    if summary.steps != watched.steps() || count.looks != summary.steps + 1 {
        let detail = format!("{} looks at {} steps", count.looks, summary.steps);
        return broken(&*watched, "observers see the start and every step once", detail);
    }
    let first = ledger.entries().first().map(|e| (e.kinetic, e.internal));
    let start = scene().totals();
    if first != Some((start.kinetic, start.internal)) {
        return broken(&*watched, "the ledger begins with what there was", format!("{first:?}"));
    }
    let frames = series.frames();
    if !(2..=6).contains(&frames) || !series.index().is_file() {
        return broken(&*watched, "frames are written when they are due", format!("{frames} frames"));
    }
    Ok(())
}

/// Test restart: a run that is saved at any step and resumed makes the steps of the uninterrupted one, bit for bit, on any number of
/// threads, observers included; files that are cut short are errors.
///
/// # Errors
/// The first property that does not hold.
pub fn restart(scene: Scene<'_>, tests: &SolverTests) -> Check {
    let property = "a run that is resumed is the one that was saved, bit for bit";
    let folder = Folder::new();
    std::fs::create_dir_all(&folder.0).map_err(|e| Broken {
        subject: "restart".into(),
        property,
        detail: e.to_string(),
    })?;
    let file = folder.0.join("checkpoint");
    let mut whole = scene();
    let failed = |solver: &dyn Solver, error: String| -> Check { broken(solver, property, error) };
    run(&mut *whole, tests.end, property)?;
    let (expected, steps) = (seen(&*whole), whole.steps());
    let mut saved = scene();
    for at in [0, 1, steps / 3, steps - steps / 4] {
        while saved.steps() < at {
            let step = saved.step_towards(tests.end).map(|_| ());
            step.or_else(|e| failed(&*saved, e.to_string()))?;
        }
        let written = saved.save(&file);
        written.or_else(|e| failed(&*saved, e.to_string()))?;
        let mut again = scene();
        let team = Team::new(1 + at as usize % 3);
        again.set_team(team.or_else(|e| broken(&*saved, property, e.to_string()))?);
        let read = again.resume(&file);
        read.or_else(|e| failed(&*again, e.to_string()))?;
        compare(&*again, "a scene is as it was saved", &seen(&*again), &seen(&*saved))?;
        run(&mut *again, tests.end, property)?;
        compare(&*again, property, &seen(&*again), &expected)?;
    }
    let bytes = std::fs::read(&file).unwrap_or_default();
    for part in [0, bytes.len() / 3, bytes.len() - 1] {
        if std::fs::write(&file, &bytes[..part]).is_ok() && scene().resume(&file).is_ok() {
            let detail = format!("{part} of {} bytes", bytes.len());
            return broken(&*whole, "files that are cut short are refused", detail);
        }
    }
    observed_restart(scene, tests, &file)
}

/// Test an interrupted run with observers that is resumed with its observers.
fn observed_restart(scene: Scene<'_>, tests: &SolverTests, file: &PathBuf) -> Check {
    let property = "observers of a run that is resumed saw what those of the other one saw";
    let made = |e: RunError| Broken { subject: "restart".into(), property, detail: e.to_string() };
    let pace = |e: ObserveError| Broken { subject: "restart".into(), property, detail: e.to_string() };
    let ledger = || Ledger::new(Pace::every_step());
    let (mut whole, mut all) = (scene(), ledger());
    Run::new(&mut *whole).observe(&mut all).until(tests.end).map_err(made)?;
    // The last checkpoint is some steps before the end.
    let kill = |after| Kill { pace: Pace::every_step(), after };
    let (mut first, mut lost, mut killed) = (scene(), ledger(), kill(whole.steps() - whole.steps() / 5));
    let every = Pace::steps((whole.steps() / 3).max(1)).map_err(pace)?;
    let mut run = Run::new(&mut *first).observe(&mut lost).observe(&mut killed).checkpoint(file, every);
    if !matches!(run.until(tests.end), Err(RunError::Observe { .. })) || run.checkpoints() == 0 {
        return broken(&*whole, property, "no checkpoint was written before the run was broken off");
    }
    let (mut again, mut kept, mut spared) = (scene(), ledger(), kill(u64::MAX));
    let run = Run::new(&mut *again).observe(&mut kept).observe(&mut spared);
    let summary = run.resume(file).and_then(|mut run| run.until(tests.end)).map_err(made)?;
    compare(&*again, property, &seen(&*again), &seen(&*whole))?;
    if kept.entries() != all.entries() || summary.steps != whole.steps() {
        let detail = format!("{} entries for {}", kept.entries().len(), all.entries().len());
        return broken(&*again, property, detail);
    }
    Ok(())
}

/// Test errors: a failing scene stops at once, names body, point, position and cause, and makes no further step.
///
/// # Errors
/// The first property that does not hold.
pub fn errors(_: Scene<'_>, tests: &SolverTests) -> Check {
    let Some((end, scene)) = &tests.breaking else { return Ok(()) };
    let mut solver = scene();
    let Err(error) = solver.run_until(*end) else {
        return broken(&*solver, "a scene that breaks stops", "it came to its end");
    };
    let text = error.to_string();
    match &error.what {
        Stopped::Point { body, position, .. } => {
            let bodies = solver.bodies();
            if !bodies.iter().any(|b| b.name() == body) || !text.contains(body.as_str()) {
                return broken(&*solver, "errors name the body", text);
            }
            if !position.iter().all(|x| x.is_finite()) {
                return broken(&*solver, "errors name the place", text);
            }
        }
        Stopped::Outside { .. }
        | Stopped::Scene(_)
        | Stopped::NoTimeStep(_)
        | Stopped::Solve { .. }
        | Stopped::Hook { .. }
        | Stopped::Watch(_) => {}
        _ => return broken(&*solver, "a scene that breaks is not refused by its clock", text),
    }
    if solver.stopped_by() != Some(&error) {
        return broken(&*solver, "a scene that broke knows what stopped it", text);
    }
    let before = seen(&*solver);
    if solver.step_at_most(*end) != Err(error) {
        return broken(&*solver, "a scene that broke makes no further step", text);
    }
    compare(&*solver, "a scene that broke stays as it is", &seen(&*solver), &before)?;
    let folder = Folder::new();
    if std::fs::create_dir_all(&folder.0).is_ok() && solver.save(&folder.0.join("checkpoint")).is_ok() {
        return broken(&*solver, "a scene that broke is not saved", text);
    }
    Ok(())
}

/// Make tests of each line `name: scene, tests;`, where `scene` makes a [`Solver`](crate::Solver) and `tests` are
/// [`SolverTests`](crate::conformance::SolverTests): a module of this name with one test per property.
#[macro_export]
macro_rules! solver_conforms {
    ($($name:ident: $scene:expr, $tests:expr;)*) => {$(
        mod $name {
            #[allow(unused_imports)]
            use super::*;
            #[allow(unused_imports)]
            use $crate::conformance::SolverTests;

            fn holds(
                property: fn($crate::conformance::Scene<'_>, &SolverTests) -> Result<(), $crate::conformance::Broken>,
            ) {
                let tests: SolverTests = $tests;
                let scene = || -> Box<dyn $crate::Solver> { Box::new(($scene)()) };
                if let Err(broken) = property(&scene, &tests) {
                    panic!("{broken}");
                }
            }
            #[test]
            fn has_bodies() {
                holds($crate::conformance::bodies);
            }
            #[test]
            fn keeps_balances() {
                holds($crate::conformance::balances);
            }
            #[test]
            fn makes_steps() {
                holds($crate::conformance::steps);
            }
            #[test]
            fn does_not_depend_on_threads() {
                holds($crate::conformance::threads);
            }
            #[test]
            fn is_not_changed_by_observers() {
                holds($crate::conformance::observers);
            }
            #[test]
            fn restarts() {
                holds($crate::conformance::restart);
            }
            #[test]
            fn stops_with_the_cause() {
                holds($crate::conformance::errors);
            }
        }
    )*};
}
