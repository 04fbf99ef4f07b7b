//! A run of a scene file in a folder.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use impactite::observe::{
    HistoryCsv, LineKind, ObserveError, Observer, Pace, Pictures, Progress, RunView, VtkSeries,
};
use impactite::output::Column;
use impactite::parallel::Team;
use impactite::scene::{Archive, CheckpointError, Run, RunError, Solver};
use impactite_input::measured::{self, Measures};
use impactite_input::model::condition::Condition;
use impactite_input::{SceneFile, Source};
use impactite_report::{Check, Frames, Record, Recorder, write_page};
use serde::Serialize;

use crate::CliError;
use crate::pictures::Draws;

/// Name of the checkpoint in the folder of a run.
pub const CHECKPOINT: &str = "run.checkpoint";
/// Name of the scene file there.
pub const SCENE: &str = "scene.toml";

/// A run that is to be made.
#[derive(Clone, Debug)]
pub struct Job {
    /// The scene.
    pub source: Source,
    /// Where its files go.
    pub folder: PathBuf,
    /// Threads; all processors if none are given.
    pub threads: Option<usize>,
    /// Seconds by the clock between checkpoints.
    pub checkpoint: Duration,
    /// Go on from the checkpoint in the folder.
    pub resume: bool,
    /// Write pictures and frames for ParaView.
    pub pictures: bool,
    /// Write the page.
    pub report: bool,
    /// Seconds by the clock between lines of the log.
    pub log: Duration,
}

/// What a run came to: the keys of the JSON object of `--json`.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// The title of the scene.
    pub case: String,
    /// `file`: scene files have one resolution, their own.
    pub resolution: &'static str,
    /// The parameters of the file in SI units, with method, space and threads.
    pub settings: serde_json::Value,
    /// Points at the end.
    pub particles: usize,
    /// Steps.
    pub steps: u64,
    /// Simulated time, s.
    pub simulated_seconds: f64,
    /// Wall-clock time in steps, s.
    pub wall_seconds: f64,
    /// Point updates a second.
    pub particle_updates_per_second: f64,
    /// Most memory of the process, bytes.
    pub peak_memory_bytes: usize,
    /// Measures at the end: name, value, SI unit.
    pub measures: Vec<(String, f64, &'static str)>,
    /// What was compared with what.
    pub checks: Vec<Check>,
    /// Checks that are met.
    pub met: usize,
    /// Checks that are missed.
    pub missed: usize,
    /// Largest energy error: the change of the total energy over the largest energy so far.
    pub energy_error: f64,
    /// Largest momentum error.
    pub momentum_error: f64,
}

/// Steps of time between rows of a history, unless the file says otherwise.
const ROWS: f64 = 400.0;
/// Pictures and frames.
const PICTURES: f64 = 40.0;
const FRAMES: f64 = 8.0;

impl Job {
    /// Run a scene in a folder, with all that files say.
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
        }
    }

    /// Go on with the run in a folder from its checkpoint.
    ///
    /// # Errors
    /// A folder without a checkpoint, or with one of another program.
    pub fn resume(folder: impl Into<PathBuf>) -> Result<Self, CliError> {
        let folder = folder.into();
        let path = folder.join(CHECKPOINT);
        let mut source = Source::new("", "");
        let read = Run::preface_of(&path).and_then(|mut file| preface(&mut source, &mut file));
        read.map_err(|source| CliError::Resume { path, source })?;
        Ok(Job { resume: true, ..Job::new(source, folder) })
    }

    /// Run it. It stops with a checkpoint after the step in which `stop` becomes true.
    ///
    /// # Errors
    /// The scene, the run, or a file. A run that is stopped leaves its page, which says why.
    pub fn run(&self, stop: &AtomicBool) -> Result<Outcome, CliError> {
        let start = Instant::now();
        let scene = self.source.parse()?;
        let mut solver = self.source.build(&scene)?;
        let threads = self.threads();
        let team = Team::new(threads).map_err(|e| CliError::option("--threads", e.to_string()))?;
        solver.set_team(team);
        let points: usize = solver.bodies().iter().map(|b| b.len()).sum();
        tracing::info!("`{}`: {}, {points} points, {threads} threads", scene.title, solver.method());
        self.steps(&scene, &mut *solver, threads, start, stop)
    }

    fn threads(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from).min(Team::MOST);
        self.threads.unwrap_or_else(all)
    }

    fn steps(
        &self,
        scene: &SceneFile,
        solver: &mut dyn Solver,
        threads: usize,
        start: Instant,
        stop: &AtomicBool,
    ) -> Result<Outcome, CliError> {
        let folder = &self.folder;
        std::fs::create_dir_all(folder).map_err(CliError::file(folder))?;
        let kept = folder.join(SCENE);
        impactite::output::write_whole(&kept, self.source.text.clone())?;
        // What cannot be measured says so now, and not after an hour.
        let measures = Measures::new(scene, solver)?;

        let end = scene.end.value;
        if !self.resume {
            // What a run that is killed leaves is a page, too.
            self.described(scene, solver).unfinished(0.0, end).save(folder)?;
        }
        let pace = |given: Option<f64>, usual: f64| Pace::interval(given.unwrap_or(end / usual));
        let out = &scene.output;
        let histories = out.histories.map(|q| q.value);
        let mut recorder = Recorder::new(pace(histories, ROWS)?);
        let mut history = history(scene, &measures, folder, pace(histories, ROWS)?)?;
        let mut progress =
            Progress::new(&scene.title).with_a_line_every(self.log).with_lines(|kind, line| match kind {
                LineKind::Warning => tracing::warn!("{line}"),
                _ => tracing::info!("{line}"),
            });
        let mut pictures = Pictures::drawn_by(
            folder.join("pictures"),
            "scene",
            pace(out.pictures.map(|q| q.value), PICTURES)?,
            Draws::new(scene),
        )?;
        let mut frames =
            VtkSeries::create(folder.join("paraview"), "scene", pace(out.frames.map(|q| q.value), FRAMES)?)?;
        frames = frames.with_format(self.source.frame_format(scene)?);
        if out.fields.as_ref().is_none_or(|fields| fields.iter().any(|f| f == "displacement")) {
            frames = frames.with_displacement();
        }
        if let Some(fields) = &out.fields {
            frames = frames.with_fields(fields);
        }

        let mut heading = self.source.clone();
        let mut preface = |file: &mut Archive| preface(&mut heading, file);
        let mut observers: Vec<&mut dyn Observer> = vec![&mut recorder, &mut progress];
        if let Some(history) = &mut history {
            observers.push(history);
        }
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
        let ended = run.until(end);
        let summary = run.summary();
        drop(run);
        if let Err(RunError::Interrupted { time, .. }) = &ended {
            tracing::warn!(
                "asked to stop at t = {time:.4e} s; `impactite resume {}` goes on",
                folder.display()
            );
        }

        let columns = measured::columns(scene);
        let values = measures.take(solver)?;
        let checks = if ended.is_ok() { checks(scene, &columns, &values) } else { Vec::new() };
        let shown = columns
            .iter()
            .zip(&values)
            .map(|((name, unit), value)| Check::shown(name, *value, unit, "measured at the end"));
        let mut record = self
            .described(scene, solver)
            .balances(&recorder)
            .summary(&summary, threads)
            .setup(setup)
            .checks(checks.clone())
            .checks(shown.filter(|s| !checks.iter().any(|c| c.name == s.name)));
        if !columns.is_empty() {
            record = record.history("measures", MEASURES);
        }
        if self.pictures {
            let count = pictures.frames();
            if count > 0 {
                record = record.picture(format!("pictures/scene_{:06}.png", count - 1), "as it stood last");
                record = record.frames(Frames::series("pictures", "scene", count));
            }
        }
        if let Err(error) = &ended {
            record = record.stopped(error);
        }
        record.save(folder)?;
        if self.report {
            write_page(folder)?;
        }
        ended?;
        // A run that came to its end is not resumed.
        if path.exists() {
            std::fs::remove_file(&path).map_err(CliError::file(&path))?;
        }
        let [met, judged] = record.met();
        let settings = serde_json::json!({
            "method": solver.method(), "space": scene.space.name(), "threads": threads, "parameters": scene.known.numbers(),
        });
        let outcome = Outcome {
            case: scene.title.clone(),
            resolution: "file",
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
                .map(|((name, unit), value)| (name.clone(), *value, *unit))
                .collect(),
            checks,
            met,
            missed: judged - met,
            energy_error: recorder.worst_energy_error(),
            momentum_error: recorder.worst_momentum_error(),
        };
        let json =
            serde_json::to_string(&outcome).map_err(|e| CliError::option("result.json", e.to_string()))?;
        impactite::output::write_whole(folder.join("result.json"), format!("{json}\n"))?;
        Ok(outcome)
    }
}

impl Job {
    /// What is known of a scene before it runs.
    fn described(&self, scene: &SceneFile, solver: &dyn Solver) -> Record {
        let mut record = Record::new(&scene.title)
            .scene(&self.source.text)
            .symmetry_planes(planes(scene))
            .setting("space", scene.space.name(), "")
            .setting("end", scene.end.value, "s")
            .bodies_of(solver);
        for (name, number) in scene.known.numbers() {
            record = record.setting(name, number, "SI");
        }
        record
    }
}

/// The history of the measures.
const MEASURES: &str = "measures.csv";

type Measuring = Box<dyn FnMut(&RunView<'_>) -> Result<Vec<f64>, ObserveError>>;

fn history(
    scene: &SceneFile,
    measures: &Measures,
    folder: &Path,
    pace: Pace,
) -> Result<Option<HistoryCsv<Measuring>>, CliError> {
    if scene.measures.is_empty() {
        return Ok(None);
    }
    let names = measured::columns(scene);
    let columns: Vec<Column> = [("time", "s")]
        .into_iter()
        .chain(names.iter().map(|(name, unit)| (name.as_str(), *unit)))
        .map(Column::from)
        .collect();
    let measures = measures.clone();
    let measuring: Measuring = Box::new(move |now| {
        let values = measures.take(now.solver()).map_err(|e| ObserveError::Other(e.to_string()))?;
        Ok(std::iter::once(now.time()).chain(values).collect())
    });
    Ok(Some(HistoryCsv::create(folder.join(MEASURES), columns, pace, measuring)?))
}

fn checks(scene: &SceneFile, columns: &[(String, &'static str)], values: &[f64]) -> Vec<Check> {
    let judged = |(n, check): (usize, &impactite_input::model::measure::Check)| {
        let (place, reference) = measured::reference(scene, n)?;
        let (name, unit) = &columns[place];
        Some(Check::within(name, values[place], unit, reference, check.tolerance.value, &check.source))
    };
    scene.checks.iter().enumerate().filter_map(judged).collect()
}

/// Planes of symmetry that halve a model; around an axis the axis is none.
fn planes(scene: &SceneFile) -> u32 {
    let revolved = scene.space == impactite_input::model::Space::Axisymmetric;
    let halves = |c: &&Condition| match c {
        Condition::Symmetry(plane) => !(revolved && plane.axis == impactite_input::model::Axis::R),
        _ => false,
    };
    scene.conditions.iter().filter(halves).count() as u32
}

/// The scene's text, in front of what a run keeps.
fn preface(source: &mut Source, file: &mut Archive) -> Result<(), CheckpointError> {
    file.same("program", "impactite scene file")?;
    file.text(&mut source.name)?;
    file.text(&mut source.text)
}

/// The largest resident memory of this process so far, bytes, where the system tells.
fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
