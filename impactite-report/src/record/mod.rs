//! Record of a run: all data of its page, with references to its files.

mod balances;
mod check;
mod files;
mod part;
mod run;

use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use impactite_output::write_whole;
use impactite_scene::{RunSummary, Solver};

pub use balances::{Balances, Column};
pub use check::Check;
pub use files::{Frames, HistoryRecord, PictureRecord};
pub use part::{Part, Per};
pub use run::{BodyRecord, Limit, Machine, Progress, Setting, Timing};

use crate::error::ReportError;
use crate::recorder::{Recorder, Warned};

/// Format version of records that this crate writes and reads.
pub const FORMAT: u32 = 1;

/// Name of the record file in the folder of its run.
pub const FILE: &str = "run.json";

/// Record of a run: scene, results and computing time.
///
/// A program creates it after a run and saves it as `run.json` in the folder of the run;
/// [`write_page`](crate::write_page) shows it. File paths are relative to that folder.
///
/// ```
/// use impactite_report::{Check, Record};
/// # let folder = std::env::temp_dir().join(format!("impactite-doc-record-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let record = Record::new("Taylor bar")
///     .setting("speed", 190.0, "m/s")
///     .symmetry_planes(2)
///     .picture("bar.png", "The bar after 80 µs, coloured by plastic strain")
///     .history("Length of the bar", "length.csv")
///     .check(Check::within("length", 16.3e-3, "m", 16.2e-3, 0.02, "[S] Wilkins and Guinan"));
/// record.save(&folder)?;
/// assert_eq!(Record::open(&folder)?, record);
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Record {
    /// Format version, [`FORMAT`].
    pub format: u32,
    /// Title of the run.
    pub title: String,
    /// Numerical method, one line.
    #[serde(default)]
    pub method: String,
    /// Number of dimensions of the scene; 0 if unknown.
    #[serde(default)]
    pub dimensions: usize,
    /// Fraction of the whole body that the scene models.
    #[serde(default)]
    pub part: Part,
    /// Description of the scene by its author; paragraphs are separated by empty lines.
    #[serde(default)]
    pub description: String,
    /// Text of the scene file.
    #[serde(default)]
    pub scene: String,
    /// Settings, in the order of addition.
    #[serde(default)]
    pub settings: Vec<Setting>,
    /// Bodies of the scene.
    #[serde(default)]
    pub bodies: Vec<BodyRecord>,
    /// Machine and versions of the run.
    #[serde(default)]
    pub machine: Machine,
    /// Progress of the run.
    #[serde(default)]
    pub progress: Progress,
    /// Histories, in CSV files.
    #[serde(default)]
    pub histories: Vec<HistoryRecord>,
    /// Pictures; the first one is the main picture.
    #[serde(default)]
    pub pictures: Vec<PictureRecord>,
    /// Frames of an animation.
    #[serde(default)]
    pub animation: Option<Frames>,
    /// Balances of mass, momentum and energy.
    #[serde(default)]
    pub balances: Option<Balances>,
    /// Comparisons with references.
    #[serde(default)]
    pub checks: Vec<Check>,
    /// Wall-clock times.
    #[serde(default)]
    pub timing: Timing,
    /// Causes of the time step limit, if known.
    #[serde(default)]
    pub limits: Vec<Limit>,
    /// Warnings of the run.
    #[serde(default)]
    pub warnings: Vec<Warned>,
}

impl Record {
    /// Create a record with this title.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Record {
            format: FORMAT,
            title: title.into(),
            method: String::new(),
            dimensions: 0,
            part: Part::default(),
            description: String::new(),
            scene: String::new(),
            settings: Vec::new(),
            bodies: Vec::new(),
            machine: Machine {
                versions: vec![["impactite".into(), env!("CARGO_PKG_VERSION").into()]],
                features: features(),
                ..Machine::default()
            },
            progress: Progress::Unknown,
            histories: Vec::new(),
            pictures: Vec::new(),
            animation: None,
            balances: None,
            checks: Vec::new(),
            timing: Timing::default(),
            limits: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Set the description of the scene by its author.
    #[must_use]
    pub fn description(self, text: impl Into<String>) -> Self {
        Record { description: text.into(), ..self }
    }

    /// Translate the warnings, and the error that stopped the run, by `words`: a front end can name remedies in its own terms.
    #[must_use]
    pub fn in_words(mut self, words: impl Fn(&str) -> String) -> Self {
        for warned in &mut self.warnings {
            (warned.found, warned.remedy) = (words(&warned.found), words(&warned.remedy));
        }
        if let Progress::Stopped { error, .. } = &mut self.progress {
            *error = words(error);
        }
        self
    }

    /// Set the text of the scene file.
    #[must_use]
    pub fn scene(self, text: impl Into<String>) -> Self {
        Record { scene: text.into(), ..self }
    }

    /// Add a setting, in `unit` (empty if it has none).
    #[must_use]
    pub fn setting(mut self, name: impl Into<String>, value: impl ToString, unit: impl Into<String>) -> Self {
        self.settings.push(Setting { name: name.into(), value: value.to_string(), unit: unit.into() });
        self
    }

    /// Set the number of symmetry planes: the scene is a half, a quarter, an eighth of the body.
    #[must_use]
    pub fn symmetry_planes(mut self, planes: u32) -> Self {
        self.part.planes = planes;
        self
    }

    /// Add the version of another program or library of the run.
    #[must_use]
    pub fn version(mut self, name: impl Into<String>, version: impl Into<String>) -> Self {
        self.machine.versions.push([name.into(), version.into()]);
        self
    }

    /// Set method, dimensions, bodies and memory from the current state of a scene.
    #[must_use]
    pub fn bodies_of(mut self, solver: &(dyn Solver + 'static)) -> Self {
        self.method = solver.method();
        self.dimensions = solver.dimensions();
        self.part.per = match (solver.dimensions(), solver.axisymmetric()) {
            (_, true) => Per::Radian,
            (1, _) => Per::Area,
            (2, _) => Per::Depth,
            _ => Per::Whole,
        };
        let (dimensions, axisymmetric) = (solver.dimensions(), solver.axisymmetric());
        let bodies = solver.bodies();
        self.bodies = Vec::with_capacity(bodies.len());
        for body in bodies {
            let (mut smallest, mut square) = (f64::NAN, f64::NAN);
            body.for_each(&mut |p| {
                smallest = smallest.min(p.drawn_width(dimensions, axisymmetric));
                square = square.max(p.velocity.iter().map(|v| v * v).sum());
            });
            self.bodies.push(BodyRecord {
                name: body.name().into(),
                material: body.law().into(),
                points: body.len(),
                mass: body.totals().mass,
                smallest,
                fastest: square.sqrt(),
            });
        }
        self.timing.bytes = Some(solver.bytes());
        self.timing.stages =
            solver.stage_seconds().into_iter().map(|(name, seconds)| (name.into(), seconds)).collect();
        self
    }

    /// Set balances, warnings, times and progress from `recorder`. A run that is marked as
    /// [stopped](Record::stopped) stays so.
    #[must_use]
    pub fn balances(mut self, recorder: &Recorder) -> Self {
        self.balances = Some(Balances::of(recorder));
        self.warnings = recorder.warnings().to_vec();
        self.warnings.extend(recorder.late_warnings());
        let limits = recorder.limits().iter();
        self.limits = limits.map(|(cause, looks)| Limit { cause: cause.clone(), looks: *looks }).collect();
        if let Some([time, end]) = recorder.time_and_end() {
            self.progress = match self.progress {
                Progress::Stopped { error, .. } => Progress::Stopped { time: Some(time), error },
                _ if recorder.reached() => Progress::Finished { time: Some(time) },
                _ => Progress::Interrupted { time, end },
            };
        }
        if let Some([started, ended]) = recorder.started_and_ended() {
            (self.machine.started, self.machine.ended) = (since_1970(started), since_1970(ended));
        }
        let rows = recorder.rows();
        if let (Some(last), 0) = (rows.last(), self.timing.steps) {
            (self.timing.steps, self.timing.stepping) = (last.step, Some(last.wall_seconds));
            self.timing.updates = last.updates;
        }
        let steps = rows.last().map(|row| row.wall_seconds);
        self.timing.observers = steps.map(|seconds| (recorder.seconds() - seconds).max(0.0));
        self
    }

    /// Set steps, times and number of threads from the summary of a run.
    #[must_use]
    pub fn summary(mut self, summary: &RunSummary, threads: usize) -> Self {
        self.timing.steps = summary.steps;
        self.timing.stepping = Some(summary.wall_seconds);
        self.timing.updates = summary.updates;
        self.machine.threads = threads;
        self
    }

    /// Set the wall-clock time before the first step, s.
    #[must_use]
    pub fn setup(mut self, seconds: f64) -> Self {
        self.timing.setup = Some(seconds);
        self
    }

    /// Mark the run as unfinished at `time`, s, of `end`: for a record saved during the run, so that an interrupted
    /// run has a page, too.
    #[must_use]
    pub fn unfinished(self, time: f64, end: f64) -> Self {
        Record { progress: Progress::Interrupted { time, end }, ..self }
    }

    /// Mark the run as finished at `time`, s.
    #[must_use]
    pub fn finished(self, time: f64) -> Self {
        Record { progress: Progress::Finished { time: Some(time) }, ..self }
    }

    /// Mark the run as stopped by an error.
    #[must_use]
    pub fn stopped(mut self, error: &dyn std::fmt::Display) -> Self {
        let time = match self.progress {
            Progress::Finished { time } | Progress::Stopped { time, .. } => time,
            Progress::Interrupted { time, .. } => Some(time),
            Progress::Unknown => None,
        };
        self.progress = Progress::Stopped { time, error: error.to_string() };
        self
    }

    /// Add a picture in `file`, relative to the folder of the run. The first one is the main picture.
    #[must_use]
    pub fn picture(mut self, file: impl Into<String>, caption: impl Into<String>) -> Self {
        self.pictures.push(PictureRecord { file: file.into(), caption: caption.into() });
        self
    }

    /// Set the frames of an animation.
    #[must_use]
    pub fn frames(self, frames: Frames) -> Self {
        Record { animation: Some(frames), ..self }
    }

    /// Add a history in the CSV file `file`, relative to the folder of the run, with all of its columns.
    #[must_use]
    pub fn history(self, title: impl Into<String>, file: impl Into<String>) -> Self {
        self.history_of(HistoryRecord::new(title, file))
    }

    /// Add a history.
    #[must_use]
    pub fn history_of(mut self, history: HistoryRecord) -> Self {
        self.histories.push(history);
        self
    }

    /// Add a comparison with a reference.
    #[must_use]
    pub fn check(mut self, check: Check) -> Self {
        self.checks.push(check);
        self
    }

    /// Add comparisons with references.
    #[must_use]
    pub fn checks(mut self, checks: impl IntoIterator<Item = Check>) -> Self {
        self.checks.extend(checks);
        self
    }

    /// Number of checks passed, and number of checks judged.
    #[must_use]
    pub fn met(&self) -> [usize; 2] {
        let judged = self.checks.iter().filter_map(|check| check.pass);
        [judged.clone().filter(|&met| met).count(), judged.count()]
    }

    /// Save the record atomically as `run.json` in the folder of the run, which is created if it does not exist.
    ///
    /// # Errors
    /// An empty title, a file outside the folder, a number of frame times unlike that of frames; a file that cannot be written.
    pub fn save(&self, folder: impl AsRef<Path>) -> Result<PathBuf, ReportError> {
        self.check_fields()?;
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder).map_err(impactite_output::OutputError::file("create", folder))?;
        let path = folder.join(FILE);
        let json = serde_json::to_string(self).map_err(|error| ReportError::damaged(&path, error))?;
        write_whole(&path, json + "\n")?;
        Ok(path)
    }

    /// Check the fields.
    pub(crate) fn check_fields(&self) -> Result<(), ReportError> {
        let refuse = |field, value: &str, allowed| {
            Err(ReportError::Field { field, value: format!("{value:?}"), allowed })
        };
        if self.title.trim().is_empty() {
            return refuse("title", &self.title, "words");
        }
        let within = |file: &str| {
            let mut parts = Path::new(file).components();
            !file.is_empty() && parts.all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        };
        let frames = self.animation.iter().flat_map(|frames| &frames.files).map(|f| ("frame", f));
        let named = self.pictures.iter().map(|p| ("picture", &p.file));
        for (field, file) in named.chain(self.histories.iter().map(|h| ("history", &h.file))).chain(frames) {
            if !within(file) {
                return refuse(field, file, "a path within the folder of the run, relative to it");
            }
        }
        if let Some(Frames { files, times, .. }) = &self.animation
            && !times.is_empty()
            && times.len() != files.len()
        {
            let value = format!("{} times for {} frames", times.len(), files.len());
            return refuse("times of frames", &value, "one a frame, or none");
        }
        if let Some(balances) = &self.balances {
            let rows = balances.series.first().map_or(0, |column| column.values.len());
            if let Some(other) = balances.series.iter().find(|column| column.values.len() != rows) {
                let value = format!("{} rows of `{}`", other.values.len(), other.name);
                return refuse("balances", &value, "columns of one length");
            }
        }
        Ok(())
    }
}

fn since_1970(time: SystemTime) -> Option<u64> {
    time.duration_since(SystemTime::UNIX_EPOCH).ok().map(|since| since.as_secs())
}

/// Architecture and vector instructions of the processor.
fn features() -> String {
    let mut words = vec![std::env::consts::ARCH];
    #[cfg(target_arch = "x86_64")]
    {
        let known = [
            ("AVX2", std::is_x86_feature_detected!("avx2")),
            ("FMA", std::is_x86_feature_detected!("fma")),
            ("AVX-512F", std::is_x86_feature_detected!("avx512f")),
        ];
        words.extend(known.iter().filter(|(_, there)| *there).map(|(name, _)| *name));
    }
    words.join(", ")
}
