//! Run of a scene file in a folder.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use impactite::observe::{
    Background, HistoryCsv, LineKind, ObserveError, Observer, Pace, Pictures, Progress, RunView, VtkSeries,
};
use impactite::output::Column;
use impactite::parallel::Team;
use impactite::scene::{Archive, CheckpointError, Run, RunError, Solver};
use impactite_input::measured::{self, Measures};
use impactite_input::model::condition::Condition;
use impactite_input::model::measure::Measurement;
use impactite_input::{SceneFile, Source, shown};
use impactite_report::{Check, Frames, Record, Recorder, write_page};
use serde::{Deserialize, Serialize};

use crate::CliError;
use crate::folder::{CHECKPOINT, FRAMES, FolderLock, MEASURES, PICTURES, RESULT, SCENE, SERIES, remove};
use crate::pictures::Draws;
use crate::shared_progress::{SharedProgress, Shown};

/// Settings of a run.
#[derive(Clone, Debug)]
pub struct Job {
    /// Scene file.
    pub source: Source,
    /// Folder of the run's files.
    pub folder: PathBuf,
    /// Largest number of threads; all processors that this process may use if `None`.
    pub threads: Option<usize>,
    /// Wall-clock time between checkpoints.
    pub checkpoint: Duration,
    /// True to resume from the checkpoint in the folder.
    pub resume: bool,
    /// True to write pictures and frames for ParaView.
    pub pictures: bool,
    /// True to write the report page.
    pub report: bool,
    /// Wall-clock time between lines of the log.
    pub log: Duration,
    /// True to keep the final checkpoint, from which a later `end` can be reached.
    pub keep_checkpoint: bool,
    /// True while the scene is set up: becomes false at the first step and true again after the run.
    pub setting_up: Arc<AtomicBool>,
    /// Progress for a program that displays it itself; `None` for a bar on the terminal and lines in the log.
    pub advance: Option<Arc<SharedProgress>>,
}

/// Result of a run: the keys of the JSON object of `--json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Title of the scene.
    pub case: String,
    /// Resolution: always `file`, since a scene file has one resolution.
    pub resolution: String,
    /// Parameters of the file in SI units, with method, space and threads.
    pub settings: serde_json::Value,
    /// Number of points at the end.
    pub particles: usize,
    /// Number of steps.
    pub steps: u64,
    /// Simulated time, s.
    pub simulated_seconds: f64,
    /// Wall-clock time in steps, s.
    pub wall_seconds: f64,
    /// Point updates per second.
    pub particle_updates_per_second: f64,
    /// Peak memory of the process, bytes.
    pub peak_memory_bytes: usize,
    /// Measures at the end: name, value, SI unit.
    pub measures: Vec<Measured>,
    /// Checks: measures compared with references.
    pub checks: Vec<Check>,
    /// Number of passed checks.
    pub met: usize,
    /// Number of failed checks.
    pub missed: usize,
    /// Largest energy error: change of the total energy over the largest energy so far; NaN, in JSON `null`, if nothing moves.
    #[serde(with = "number")]
    pub energy_error: f64,
    /// Largest momentum error.
    #[serde(with = "number")]
    pub momentum_error: f64,
}

/// Measure at the end of a run: name, value, SI unit (`"-"` for plain numbers).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured(pub String, #[serde(with = "number")] pub f64, pub String);

impl std::fmt::Display for Measured {
    /// Format value and unit with as many digits as the precision; "no value" for NaN.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Measured(_, value, unit) = self;
        let digits = f.precision().unwrap_or(6);
        if value.is_nan() { write!(f, "no value") } else { write!(f, "{value:.digits$e} {unit}") }
    }
}

/// Serialise non-finite numbers as `null`, since JSON has no infinities and no NaN.
mod number {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
        x.is_finite().then_some(*x).serialize(to)
    }
    pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.unwrap_or(f64::NAN))
    }
}

/// Default number of rows of a history.
const ROWS: f64 = 400.0;
/// Default numbers of pictures, and of frames for ParaView.
const PICTURE_STEPS: f64 = 40.0;
const FRAME_STEPS: f64 = 8.0;

impl Job {
    /// Create a job that runs `source` in `folder` and writes all files: all processors, a checkpoint every 300 s.
    #[must_use]
    pub fn new(source: Source, folder: impl Into<PathBuf>) -> Self {
        Job {
            source,
            folder: folder.into(),
            threads: None,
            checkpoint: Duration::from_secs(300),
            resume: false,
            pictures: true,
            report: true,
            log: Duration::from_secs(60),
            keep_checkpoint: false,
            setting_up: Arc::new(AtomicBool::new(true)),
            advance: None,
        }
    }

    /// Create a job that resumes the run in a folder from its checkpoint, with its earlier settings for pictures and report.
    ///
    /// # Errors
    /// Folder without a checkpoint, or with a checkpoint of another program; run that has ended; scene file in the folder that was edited
    /// since.
    pub fn resume(folder: impl Into<PathBuf>) -> Result<Self, CliError> {
        let folder = folder.into();
        let path = folder.join(CHECKPOINT);
        if !path.exists() {
            return Err(CliError::NoResume { why: no_checkpoint(&folder), path: folder });
        }
        let mut job = Job { resume: true, ..Job::new(Source::new("", ""), folder) };
        let read = Run::preface_of(&path).and_then(|mut file| job.preface(&mut file));
        read.map_err(|source| CliError::Resume { path, source })?;
        let kept = job.folder.join(SCENE);
        if let Ok(text) = std::fs::read_to_string(&kept)
            && !job.source.resumes_as(&Source::new(kept.display().to_string(), text))
        {
            let why = format!(
                "`{}` was changed since the run began, and a checkpoint goes on with the scene that it was made of. To lengthen the \
                 run: `--set end=...`; for other changes: run the file anew, in another folder",
                kept.display()
            );
            return Err(CliError::NoResume { path: job.folder, why });
        }
        Ok(job)
    }

    /// Copy the job with other values of keys. A resumed run accepts only keys that change no step: `end`, `title`, `description`,
    /// `checks`. The intervals of histories, pictures and frames stay.
    ///
    /// # Errors
    /// Another key in a resumed run; errors of [`Source::set`].
    pub fn set(mut self, assignments: &[String]) -> Result<Self, CliError> {
        for assignment in assignments {
            let key = assignment.split(['=', '.', '[']).next().unwrap_or_default().trim();
            if self.resume && !impactite_input::RESUMABLE.contains(&key) {
                let why = format!(
                    "a run that goes on keeps its scene; it takes {}. Run the file anew for other changes",
                    impactite_input::RESUMABLE.join(", ")
                );
                return Err(CliError::option(format!("--set {assignment}"), why));
            }
            if self.resume && key == "end" {
                let scene = self.source.parse()?;
                let out = &scene.output;
                let paces = [
                    ("histories", out.histories, ROWS),
                    ("pictures", out.pictures, PICTURE_STEPS),
                    ("frames", out.frames, FRAME_STEPS),
                ];
                for (name, _, usual) in paces.iter().filter(|p| p.1.is_none()) {
                    let interval = scene.end.value / usual;
                    self.source = self.source.set(&format!("output.{name}={interval:?}"))?;
                }
            }
            self.source = self.source.set(assignment)?;
        }
        Ok(self)
    }

    /// Run the scene. The run stops with a checkpoint after the step in which `stop` becomes true.
    ///
    /// # Errors
    /// Invalid scene, failed run, file error, or folder locked by another run. A stopped run leaves its report page with the reason.
    pub fn run(&self, stop: &AtomicBool) -> Result<Outcome, CliError> {
        self.setting_up.store(true, Ordering::Relaxed);
        let start = Instant::now();
        let scene = self.source.parse()?;
        let threads = self.threads();
        let team = Team::new(threads).map_err(|e| CliError::option("--threads", e.to_string()))?;
        if let Some(wanted) = self.threads.filter(|wanted| *wanted > threads) {
            tracing::info!("{threads} of {wanted} threads: this process may use {threads} processors");
        }
        let mut solver = team.run(|| self.source.build(&scene))?;
        if self.advance.as_ref().is_some_and(|advance| !advance.begin(stop)) {
            let (time, steps) = (solver.time(), solver.steps());
            return Err(RunError::Interrupted { time, steps, saved: None }.into());
        }
        if !self.resume {
            let ahead = self.source.estimate(&scene, &mut *solver)?;
            ahead.choices.iter().for_each(|choice| tracing::info!("{choice}"));
            ahead.notes.iter().for_each(|note| tracing::warn!("{note}"));
        }
        solver.set_team(team.clone());
        let points: usize = solver.bodies().iter().map(|b| b.len()).sum();
        tracing::info!("`{}`: {}, {points} points, {threads} threads", scene.title, solver.method());
        let outcome = team.run(|| self.steps(&scene, &mut *solver, &team, start, stop));
        self.setting_up.store(true, Ordering::Relaxed);
        outcome
    }

    /// Number of threads of the run: at most one per processor that this process may use.
    pub(crate) fn threads(&self) -> usize {
        let all = std::thread::available_parallelism().map_or(1, usize::from).min(Team::MOST);
        self.threads.map_or(all, |threads| threads.min(all))
    }

    fn steps(
        &self,
        scene: &SceneFile,
        solver: &mut dyn Solver,
        team: &Team,
        start: Instant,
        stop: &AtomicBool,
    ) -> Result<Outcome, CliError> {
        let threads = team.threads();
        // Invalid measures fail here, before the run.
        let measures = Rc::new(RefCell::new(Measures::new(&self.source, scene, solver)?));
        let folder = &self.folder;
        let lock = FolderLock::new(folder)?;
        if self.resume {
            lock.clear_parts()?
        } else {
            lock.clear()?
        }
        let source = self.source.anchored();
        impactite::output::write_whole(folder.join(SCENE), source.text.clone())?;

        let end = scene.end.value;
        if !self.resume {
            // A killed run leaves a report page, too.
            self.described(scene, solver).unfinished(0.0, end).save(folder)?;
        }
        let pace = |given: Option<f64>, usual: f64| Pace::interval(given.unwrap_or(end / usual));
        let out = &scene.output;
        let histories = out.histories.map(|q| q.value);
        let mut recorder = Recorder::new(pace(histories, ROWS)?);
        let error = recorder.latest_energy_error();
        let mut history =
            history(scene, &measures, folder, pace(histories, ROWS)?, recorder.latest_energy_error())?;
        let mut profiles = crate::profiles::histories(scene, solver, folder)?;
        let bar =
            Progress::new(&scene.title).with_a_line_every(self.log).with_lines(|kind, line| match kind {
                LineKind::Warning => {
                    tracing::warn!("{}", shown(line.strip_prefix("warning: ").unwrap_or(line)))
                }
                _ => tracing::info!("{line}"),
            });
        let mut progress = Shown { bar, advance: self.advance.clone(), last: None };
        let background = Background::new(team);
        let mut pictures = Pictures::drawn_by(
            folder.join(PICTURES),
            SERIES,
            pace(out.pictures.map(|q| q.value), PICTURE_STEPS)?,
            Draws::new(scene),
        )?
        .in_background(&background);
        let mut frames =
            VtkSeries::create(folder.join(FRAMES), SERIES, pace(out.frames.map(|q| q.value), FRAME_STEPS)?)?;
        frames = frames.with_format(self.source.frame_format(scene)?).in_background(&background);
        if out.fields.as_ref().is_none_or(|fields| fields.iter().any(|f| f == "displacement")) {
            frames = frames.with_displacement();
        }
        if let Some(fields) = &out.fields {
            frames = frames.with_fields(fields);
        }

        let mut heading = Job { source, ..self.clone() };
        let mut preface = |file: &mut Archive| heading.preface(file);
        let mut looks = Looks::new(measures.clone())?;
        // Update measures over time before the history, which records their current values.
        let mut observers: Vec<&mut dyn Observer> = vec![&mut recorder, &mut progress, &mut looks];
        if let Some(history) = &mut history {
            observers.push(history);
        }
        observers.extend(profiles.iter_mut().map(|profile| profile as &mut dyn Observer));
        if self.pictures {
            observers.push(&mut pictures);
            observers.push(&mut frames);
        }
        let path = folder.join(CHECKPOINT);
        let mut run = Run::new(solver).preface(&mut preface).observe_all(observers).stop_when(stop);
        run = run.checkpoint_by_clock(&path, self.checkpoint, Instant::now());
        if self.resume {
            run = run.resume(&path).map_err(|error| match error {
                RunError::Checkpoint { source, .. } => CliError::Resume { path: path.clone(), source },
                other => other.into(),
            })?;
            tracing::info!("goes on from `{}`", path.display());
        }
        let setup = start.elapsed().as_secs_f64();
        self.setting_up.store(false, Ordering::Relaxed);
        let ended = run.until(end);
        if ended.is_ok() && self.keep_checkpoint {
            run.save()?;
        }
        let summary = run.summary();
        drop(run);
        if let (Ok(_), Some(why)) = (&ended, &looks.ended) {
            tracing::info!("ended at t = {:.6e} s by `until`: {why}", solver.time());
        }
        if ended.is_ok() && looks.ended.is_none() {
            measures.borrow().missing(&RunView::of(solver))?.iter().for_each(|line| tracing::warn!("{line}"));
        }
        if ended.is_ok() {
            crate::inertia::report(scene, solver);
            crate::cells::report(solver);
        }
        if let Err(RunError::Interrupted { time, .. }) = &ended {
            tracing::warn!(
                "asked to stop at t = {time:.4e} s; `impactite resume {}` goes on",
                folder.display()
            );
        }

        let columns = measured::columns(scene);
        let values = with_energy_error(scene, measures.borrow().take(&RunView::of(solver))?, error());
        let checks = if ended.is_ok() { checks(scene, &columns, &values) } else { Vec::new() };
        let unjudged = columns
            .iter()
            .zip(&values)
            .map(|((name, unit), value)| Check::shown(name, *value, unit, "measured at the end"));
        let mut record = self
            .described(scene, solver)
            .balances(&recorder)
            .summary(&summary, threads)
            .setup(setup)
            .checks(checks.clone())
            .checks(unjudged.filter(|s| !checks.iter().any(|c| c.name == s.name)));
        if !columns.is_empty() {
            record = record.history("measures", MEASURES);
        }
        if self.pictures {
            // A picture whose drawing failed, and the pictures queued after it, have no file.
            let there =
                |n: &usize| folder.join(PICTURES).join(format!("{SERIES}_{:06}.png", n - 1)).is_file();
            let count = (1..=pictures.frames()).rev().find(there).unwrap_or(0);
            if count > 0 {
                record =
                    record.picture(format!("{PICTURES}/{SERIES}_{:06}.png", count - 1), "as it stood last");
                record = record.frames(Frames::series(PICTURES, SERIES, count));
            }
        }
        record = match &ended {
            Ok(_) => record.finished(solver.time()),
            Err(error) => record.stopped(error),
        };
        for late in recorder.late_warnings() {
            tracing::warn!("{}", shown(&format!("{}; {}", late.found, late.remedy)));
        }
        record = record.in_words(shown);
        record.save(folder)?;
        if self.report {
            write_page(folder)?;
        }
        ended?;
        if !self.keep_checkpoint {
            remove(&path)?;
        }
        let [met, judged] = record.met();
        let settings = serde_json::json!({
            "method": solver.method(), "space": scene.space.name(), "threads": threads, "parameters": scene.known.numbers(),
        });
        let outcome = Outcome {
            case: scene.title.clone(),
            resolution: "file".into(),
            settings,
            particles: solver.bodies().iter().map(|b| b.len()).sum(),
            steps: summary.steps,
            simulated_seconds: solver.time(),
            wall_seconds: summary.wall_seconds,
            particle_updates_per_second: summary.rate(),
            peak_memory_bytes: peak_memory().unwrap_or_else(|| solver.bytes()),
            measures: columns
                .iter()
                .zip(&values)
                .map(|((name, unit), value)| Measured(name.clone(), *value, unit.clone()))
                .collect(),
            checks,
            met,
            missed: judged - met,
            energy_error: recorder.energy_error().unwrap_or(f64::NAN),
            momentum_error: recorder.worst_momentum_error(),
        };
        let json =
            serde_json::to_string(&outcome).map_err(|e| CliError::option("result.json", e.to_string()))?;
        impactite::output::write_whole(folder.join(RESULT), format!("{json}\n"))?;
        Ok(outcome)
    }
}

impl Job {
    /// Describe a scene for its report before the run.
    fn described(&self, scene: &SceneFile, solver: &dyn Solver) -> Record {
        let mut record = Record::new(&scene.title)
            .description(&scene.description)
            .scene(&self.source.text)
            .symmetry_planes(planes(scene))
            .setting("space", scene.space.name(), "")
            .setting("end", scene.end.value, "s")
            .bodies_of(solver);
        for (name, number) in scene.known.numbers() {
            record = record.setting(name, number, scene.known.unit(name));
        }
        let cells = solver.points_by_cell();
        for (size, points) in cells.iter().filter(|_| cells.len() > 1) {
            record = record.setting(format!("points on cells of {size:.3e} m"), points, "");
        }
        record
    }
}

/// Observer that updates measures over time after every step, and ends the run when a condition of `until` is met.
struct Looks {
    pace: Pace,
    measures: Rc<RefCell<Measures>>,
    /// Reason to end the run.
    ended: Option<String>,
}

impl Looks {
    fn new(measures: Rc<RefCell<Measures>>) -> Result<Self, ObserveError> {
        Ok(Looks { pace: Pace::steps(1)?, measures, ended: None })
    }
}

impl Observer for Looks {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let said = |e: measured::MeasureError| ObserveError::Other(e.to_string());
        self.measures.borrow_mut().look(now).map_err(said)?;
        self.ended = self.measures.borrow().ended(now).map_err(said)?;
        Ok(())
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.measures.borrow_mut().archive(file)
    }
    fn ends_run(&self) -> bool {
        self.ended.is_some()
    }
}

type Measuring = Box<dyn FnMut(&RunView<'_>) -> Result<Vec<f64>, ObserveError>>;

fn history(
    scene: &SceneFile,
    measures: &Rc<RefCell<Measures>>,
    folder: &Path,
    pace: Pace,
    error: impl Fn() -> f64 + 'static,
) -> Result<Option<HistoryCsv<Measuring>>, CliError> {
    if scene.measures.is_empty() {
        return Ok(None);
    }
    let names = measured::columns(scene);
    let columns: Vec<Column> = [("time", "s")]
        .into_iter()
        .chain(names.iter().map(|(name, unit)| (name.as_str(), unit.as_str())))
        .map(Column::from)
        .collect();
    let (measures, scene) = (measures.clone(), scene.clone());
    let measuring: Measuring = Box::new(move |now| {
        let values = measures.borrow().take(now).map_err(|e| ObserveError::Other(e.to_string()))?;
        let values = with_energy_error(&scene, values, error());
        Ok(std::iter::once(now.time()).chain(values).collect())
    });
    Ok(Some(HistoryCsv::create(folder.join(MEASURES), columns, pace, measuring)?))
}

/// Replace energy errors among the measures by that of the recorder, so that a run reports a single value.
fn with_energy_error(scene: &SceneFile, mut values: Vec<f64>, error: f64) -> Vec<f64> {
    for (value, measure) in values.iter_mut().zip(scene.measures.values()) {
        if matches!(measure, Measurement::EnergyError(_)) {
            *value = error;
        }
    }
    values
}

fn checks(scene: &SceneFile, columns: &[(String, String)], values: &[f64]) -> Vec<Check> {
    let judged = |(n, check): (usize, &impactite_input::model::measure::Check)| {
        let (place, reference) = measured::reference(scene, n)?;
        let (name, unit) = &columns[place];
        Some(Check::within(name, values[place], unit, reference, check.tolerance.value, &check.source))
    };
    scene.checks.iter().enumerate().filter_map(judged).collect()
}

/// Number of symmetry planes that halve the model; the axis of revolution does not count.
fn planes(scene: &SceneFile) -> u32 {
    let revolved = scene.space == impactite_input::model::Space::Axisymmetric;
    let halves = |c: &&Condition| match c {
        Condition::Symmetry(plane) => !(revolved && plane.axis == impactite_input::model::Axis::R),
        _ => false,
    };
    scene.conditions.iter().filter(halves).count() as u32
}

/// Measure the wall-clock time per step, s, without the first step: at most 20 steps or half a second. `None` if the scene has one step
/// only.
///
/// # Errors
/// Failed step.
pub fn seconds_a_step(solver: &mut dyn Solver, end: f64) -> Result<Option<f64>, CliError> {
    let mut taken = Duration::ZERO;
    let mut steps = 0;
    for n in 0..20 {
        if solver.reached(end) || taken > Duration::from_millis(500) {
            break;
        }
        let start = Instant::now();
        solver.step_towards(end).map_err(RunError::from)?;
        // The first step includes initialisation.
        if n > 0 {
            taken += start.elapsed();
            steps += 1;
        }
    }
    Ok((steps > 0).then(|| taken.as_secs_f64() / f64::from(steps)))
}

/// Explain the absence of a checkpoint in a folder.
fn no_checkpoint(folder: &Path) -> String {
    use impactite_report::Progress;
    if !folder.exists() {
        return "there is no such folder".into();
    }
    match Record::open(folder).map(|record| record.progress) {
        Ok(Progress::Finished { time }) => {
            let at = time.map_or(String::new(), |t| format!(" at t = {t:.4e} s"));
            format!(
                "the run has ended{at}. A run with `--keep-checkpoint` can be lengthened: `impactite resume FOLDER --set end=...`"
            )
        }
        Ok(Progress::Stopped { error, .. }) => format!("the run was stopped: {error}"),
        _ => format!(
            "there is no `{CHECKPOINT}`; a run writes it every five minutes (`--checkpoint SECONDS`) and when Ctrl-C stops it"
        ),
    }
}

impl Job {
    /// Store or load the heading of a checkpoint: the scene and its run settings.
    fn preface(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.same("program", "impactite scene file 2")?;
        file.text(&mut self.source.name)?;
        file.text(&mut self.source.text)?;
        file.flag(&mut self.pictures)?;
        file.flag(&mut self.report)?;
        file.flag(&mut self.keep_checkpoint)
    }
}

/// Peak resident memory of this process, bytes; `None` if the system does not report it.
fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
