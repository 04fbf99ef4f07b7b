//! All that the page of a run shows, but for its files, which it names.

use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use impactite_output::write_whole;
use impactite_scene::{RunSummary, Solver};

use crate::error::ReportError;
use crate::number::{maybe, real, reals};
use crate::recorder::{Recorder, Row, Warned};

/// The version of records that this crate writes and reads.
pub const FORMAT: u32 = 1;
/// The file of a record in the folder of its run.
pub const FILE: &str = "run.json";

/// A run: what it computed, what came of it, and what it took.
///
/// Made by a program after its run, saved whole as `run.json` in the folder of the run, and shown by
/// [`write_page`](crate::write_page). Files are named relative to that folder.
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
    /// [`FORMAT`].
    pub format: u32,
    /// What the run is called.
    pub title: String,
    /// The method, in a line of words.
    #[serde(default)]
    pub method: String,
    /// Dimensions of the scene; 0 if not told.
    #[serde(default)]
    pub dimensions: usize,
    /// What part of the whole the scene is.
    #[serde(default)]
    pub part: Part,
    /// The scene as its author wrote it.
    #[serde(default)]
    pub scene: String,
    /// Settings, in the order given.
    #[serde(default)]
    pub settings: Vec<Setting>,
    /// The bodies.
    #[serde(default)]
    pub bodies: Vec<BodyRecord>,
    /// What it ran on.
    #[serde(default)]
    pub machine: Machine,
    /// How far it came.
    #[serde(default)]
    pub progress: Progress,
    /// Histories, in CSV files.
    #[serde(default)]
    pub histories: Vec<HistoryRecord>,
    /// Pictures, the most telling one first.
    #[serde(default)]
    pub pictures: Vec<PictureRecord>,
    /// Frames of an animation.
    #[serde(default)]
    pub animation: Option<Frames>,
    /// Mass, momentum and energy.
    #[serde(default)]
    pub balances: Option<Balances>,
    /// Numbers of the run beside what they should be.
    #[serde(default)]
    pub checks: Vec<Check>,
    /// Where the time went.
    #[serde(default)]
    pub timing: Timing,
    /// What limited the step, where that is known.
    #[serde(default)]
    pub limits: Vec<Limit>,
    /// What the run warned of.
    #[serde(default)]
    pub warnings: Vec<Warned>,
}

/// What part of the whole the scene is: extensive quantities are of that part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Part {
    /// Planes of symmetry at which the whole was cut: a quarter has two.
    pub planes: u32,
    /// How a scene of less than three dimensions lies in space.
    pub per: Per,
}

/// What extensive quantities are per.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Per {
    /// Nothing: they are whole.
    #[default]
    Whole,
    /// Radian, around an axis: times 2 pi for a whole turn.
    Radian,
    /// Metre of depth.
    Depth,
    /// Square metre of cross-section, along a line.
    Area,
}

impl Part {
    /// The part in words, `one quarter of the body`; none of the whole.
    #[must_use]
    pub fn share(&self) -> Option<String> {
        match self.planes {
            0 => None,
            1 => Some("one half of the body".into()),
            2 => Some("one quarter of the body".into()),
            3 => Some("one eighth of the body".into()),
            n => Some(format!("one part in {} of the body", 2_f64.powi(n.min(64) as i32))),
        }
    }

    /// What masses, momenta, forces and energies are of, in a sentence; none where they are of the whole.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let factor = 2_f64.powi(self.planes.min(64) as i32);
        let per = match self.per {
            Per::Whole => None,
            Per::Radian => Some("per radian (times 2π for a whole turn)"),
            Per::Depth => Some("per metre of depth"),
            Per::Area => Some("per square metre of cross-section"),
        };
        let what = "masses, momenta, forces and energies are";
        match (self.share(), per) {
            (None, None) => None,
            (None, Some(per)) => Some(format!("{} {per}.", capital(what))),
            (Some(share), None) => {
                Some(format!("{}: {what} of that part (times {factor} for the whole).", capital(&share)))
            }
            (Some(share), Some(per)) => Some(format!(
                "{}: {what} of that part (times {factor} for the whole), and {per}.",
                capital(&share)
            )),
        }
    }

    /// `unit` of an extensive quantity: `J per radian`.
    pub(crate) fn unit(&self, unit: &str) -> String {
        match self.per {
            Per::Whole => unit.into(),
            Per::Radian => format!("{unit} / rad"),
            Per::Depth => format!("{unit} / m"),
            Per::Area => format!("{unit} / m²"),
        }
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A setting of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    /// What it is.
    pub name: String,
    /// What was chosen, in words or numbers.
    pub value: String,
    /// Its unit; empty if it has none.
    #[serde(default)]
    pub unit: String,
}

/// A body at the time of the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct BodyRecord {
    /// Its name.
    pub name: String,
    /// Its constitutive law.
    pub material: String,
    /// Its points.
    pub points: usize,
    /// Mass, kg, of the [`Part`] that is computed.
    #[serde(with = "real")]
    pub mass: f64,
    /// Width of its smallest point, m; NaN of a body without points.
    #[serde(with = "real")]
    pub smallest: f64,
    /// Speed of its fastest point, m/s; NaN of a body without points.
    #[serde(with = "real")]
    pub fastest: f64,
}

/// What a run ran on, and when.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Machine {
    /// Programs and libraries, and their versions.
    #[serde(default)]
    pub versions: Vec<[String; 2]>,
    /// Processor architecture, and the vector instructions that it has.
    #[serde(default)]
    pub features: String,
    /// Threads; 0 if not told.
    #[serde(default)]
    pub threads: usize,
    /// When the run started, seconds since 1970 in universal time.
    #[serde(default)]
    pub started: Option<u64>,
    /// When it ended.
    #[serde(default)]
    pub ended: Option<u64>,
}

/// How far a run came. Times are s.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "state", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Progress {
    /// Nobody said.
    #[default]
    Unknown,
    /// To its end.
    Finished {
        /// The end, if that is known.
        #[serde(default, with = "maybe")]
        time: Option<f64>,
    },
    /// An error stopped it.
    Stopped {
        /// Where, if that is known.
        #[serde(default, with = "maybe")]
        time: Option<f64>,
        /// What it said.
        error: String,
    },
    /// It was broken off, or goes on still.
    Interrupted {
        /// Where it stood when the record was made.
        #[serde(with = "real")]
        time: f64,
        /// Where it was to end.
        #[serde(with = "real")]
        end: f64,
    },
}

/// A history in a CSV file, as [`impactite_output::History`] writes them: `name [unit]` above each column, what it runs over first.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HistoryRecord {
    /// What it shows.
    pub title: String,
    /// The file, relative to the folder of the run.
    pub file: String,
    /// Names of the columns that are drawn; empty for all.
    #[serde(default)]
    pub columns: Vec<String>,
}

impl HistoryRecord {
    /// The history `title` in `file`, with all of its columns.
    #[must_use]
    pub fn new(title: impl Into<String>, file: impl Into<String>) -> Self {
        HistoryRecord { title: title.into(), file: file.into(), columns: Vec::new() }
    }

    /// Draw these columns alone, by name.
    #[must_use]
    pub fn columns<T: Into<String>>(self, names: impl IntoIterator<Item = T>) -> Self {
        HistoryRecord { columns: names.into_iter().map(Into::into).collect(), ..self }
    }
}

/// A picture in a PNG, JPEG, WebP or SVG file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PictureRecord {
    /// The file, relative to the folder of the run.
    pub file: String,
    /// What it shows.
    pub caption: String,
}

/// PNG files of one size that make an animation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// The files, relative to the folder of the run, in order.
    pub files: Vec<String>,
    /// Simulated times of the frames, s; empty if not told.
    #[serde(default, with = "reals")]
    pub times: Vec<f64>,
    /// What they show.
    #[serde(default)]
    pub caption: String,
}

impl Frames {
    /// The pictures `name_000000.png`, ... that [`impactite_scene::observe::Pictures`] left in a folder named so, relative to the folder
    /// of the run (empty for that folder itself).
    #[must_use]
    pub fn series(folder: &str, name: &str, count: usize) -> Self {
        let folder = if folder.is_empty() { String::new() } else { format!("{folder}/") };
        let files = (0..count).map(|n| format!("{folder}{name}_{n:06}.png")).collect();
        Frames { files, ..Frames::default() }
    }

    /// What they show.
    #[must_use]
    pub fn caption(self, caption: impl Into<String>) -> Self {
        Frames { caption: caption.into(), ..self }
    }

    /// Their simulated times, s.
    #[must_use]
    pub fn times(self, times: impl IntoIterator<Item = f64>) -> Self {
        Frames { times: times.into_iter().collect(), ..self }
    }
}

/// Numbers over time, a column each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// What it is.
    pub name: String,
    /// Its unit; "-" if it has none.
    pub unit: String,
    /// The numbers.
    #[serde(with = "reals")]
    pub values: Vec<f64>,
}

/// Balances of mass, momentum and energy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Balances {
    /// What they are over time; all columns have one length. Empty where errors alone are known.
    pub series: Vec<Column>,
    /// [`Recorder::worst_mass_error`].
    #[serde(default, with = "maybe")]
    pub mass_error: Option<f64>,
    /// [`Recorder::worst_momentum_error`].
    #[serde(with = "real")]
    pub momentum_error: f64,
    /// [`Recorder::worst_energy_error`].
    #[serde(with = "real")]
    pub energy_error: f64,
    /// The largest sum of m |v| of the run, kg m/s.
    #[serde(default, with = "maybe")]
    pub momentum_scale: Option<f64>,
    /// The largest kinetic energy, or sum of kinetic and internal energy, of the run, J.
    #[serde(default, with = "maybe")]
    pub energy_scale: Option<f64>,
}

impl Balances {
    /// What is meant by the mass error.
    pub const MASS_ERROR: &str = "change of the mass of all bodies since the start, over the mass at the start; negative: lost. Mass goes with points that are removed";
    /// What is meant by the momentum error.
    pub const MOMENTUM_ERROR: &str = "amount of the change of momentum since the start that no impulse of boundaries, loads and body forces explains, over the largest sum of m |v| so far; around an axis along that alone";
    /// What is meant by the energy error.
    pub const ENERGY_ERROR: &str = "change since the start of kinetic + internal energy − work + friction + impacts − conversion, over the largest kinetic energy, or sum of kinetic and internal energy, so far; negative: energy was lost";

    /// The numbers of this column, if it is there.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.series.iter().find(|column| column.name == name)
    }

    /// Errors alone.
    pub(crate) fn errors(energy_error: f64, momentum_error: f64) -> Self {
        Balances {
            series: Vec::new(),
            mass_error: None,
            momentum_error,
            energy_error,
            momentum_scale: None,
            energy_scale: None,
        }
    }

    fn of(recorder: &Recorder) -> Self {
        let rows = recorder.rows();
        let column = |name: &str, unit: &str, of: &dyn Fn(&Row) -> f64| Column {
            name: name.into(),
            unit: unit.into(),
            values: rows.iter().map(of).collect(),
        };
        let series = vec![
            column("time", "s", &|r| r.time),
            column("step", "-", &|r| r.step as f64),
            column("time step", "s", &|r| r.dt),
            column("points", "-", &|r| r.points as f64),
            column("mass", "kg", &|r| r.mass),
            column("kinetic energy", "J", &|r| r.kinetic),
            column("internal energy", "J", &|r| r.internal),
            column("work", "J", &|r| r.work),
            column("friction", "J", &|r| r.friction),
            column("impacts", "J", &|r| r.impacts),
            column("conversion", "J", &|r| r.conversion),
            column("total", "J", &Row::total),
            column("energy error", "-", &|r| r.energy_error),
            column("momentum x", "kg m/s", &|r| r.momentum[0]),
            column("momentum y", "kg m/s", &|r| r.momentum[1]),
            column("momentum z", "kg m/s", &|r| r.momentum[2]),
            column("momentum error", "-", &|r| r.momentum_error),
            column("wall clock", "s", &|r| r.wall_seconds),
            column("updates", "-", &|r| r.updates),
        ];
        let [energy_scale, momentum_scale] = recorder.scales();
        Balances {
            series,
            mass_error: Some(recorder.worst_mass_error()),
            momentum_error: recorder.worst_momentum_error(),
            energy_error: recorder.worst_energy_error(),
            momentum_scale: Some(momentum_scale),
            energy_scale: Some(energy_scale),
        }
    }
}

/// A number of a run beside what it should be. Keys are those of the checks in `result.json` of the example cases.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Check {
    /// What it is.
    pub name: String,
    /// This run's, in `unit`.
    #[serde(with = "real")]
    pub value: f64,
    /// Its unit; "-" if it has none.
    pub unit: String,
    /// What it should be, or the bound that it keeps to.
    #[serde(default, with = "maybe")]
    pub reference: Option<f64>,
    /// How far from the reference it may be, relative to it (absolute where the reference is 0). `None` of bounds.
    #[serde(default, with = "maybe")]
    pub tolerance: Option<f64>,
    /// Where the reference is from.
    #[serde(default)]
    pub source: String,
    /// Is it met? `None` if it is shown and not judged.
    #[serde(default)]
    pub pass: Option<bool>,
    /// Why it is declared as missed at present.
    #[serde(default)]
    pub known: Option<String>,
}

impl Check {
    /// `value` that is shown and not judged.
    #[must_use]
    pub fn shown(name: impl Into<String>, value: f64, unit: &str, remark: &str) -> Self {
        Check { name: name.into(), value, unit: unit.into(), source: remark.into(), ..Check::default() }
    }

    /// `value` within `tolerance` of `reference`, relative to it (absolute where it is 0). NaN is not.
    #[must_use]
    pub fn within(
        name: impl Into<String>,
        value: f64,
        unit: &str,
        reference: f64,
        tolerance: f64,
        source: &str,
    ) -> Self {
        let scale = if reference == 0.0 { 1.0 } else { reference.abs() };
        let met = (value - reference).abs() <= tolerance * scale;
        Check::judged(name, value, unit, reference, source, met).with_tolerance(tolerance)
    }

    /// `value` beside `reference`, which another one judged.
    #[must_use]
    pub fn judged(
        name: impl Into<String>,
        value: f64,
        unit: &str,
        reference: f64,
        source: &str,
        met: bool,
    ) -> Self {
        let shown = Check::shown(name, value, unit, source);
        Check { reference: Some(reference), pass: Some(met), ..shown }
    }

    /// How far from the reference it may be, as [`Check::tolerance`].
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Check { tolerance: Some(tolerance), ..self }
    }

    /// Declared as missed at present, and why.
    #[must_use]
    pub fn known_miss(self, reason: impl Into<String>) -> Self {
        Check { known: Some(reason.into()), ..self }
    }

    /// Its place in the table: missed, declared as missed, met, shown.
    pub(crate) fn rank(&self) -> u8 {
        match (self.pass, &self.known) {
            (Some(false), None) => 0,
            (Some(false), Some(_)) => 1,
            (Some(true), _) => 2,
            (None, _) => 3,
        }
    }
}

/// Where the time went, by the clock on the wall, s. What is `None` was not measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Timing {
    /// Steps made.
    pub steps: u64,
    /// In steps.
    #[serde(default, with = "maybe")]
    pub stepping: Option<f64>,
    /// Between steps: observers, files, pictures, checkpoints.
    #[serde(default, with = "maybe")]
    pub observers: Option<f64>,
    /// Before the first step.
    #[serde(default, with = "maybe")]
    pub setup: Option<f64>,
    /// Point updates.
    pub updates: f64,
    /// Bytes of bodies and scratch.
    pub bytes: Option<usize>,
}

impl Timing {
    /// Point updates a second, if steps took time.
    #[must_use]
    pub fn rate(&self) -> Option<f64> {
        self.stepping.filter(|&seconds| seconds > 0.0).map(|seconds| self.updates / seconds)
    }
}

/// What limited the step, and how often.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Limit {
    /// What: a body and its waves, a contact, the growth allowed from one step to the next, the end of the run.
    pub cause: String,
    /// In how many steps.
    pub steps: u64,
}

impl Record {
    /// A record called so.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Record {
            format: FORMAT,
            title: title.into(),
            method: String::new(),
            dimensions: 0,
            part: Part::default(),
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

    /// The scene as its author wrote it.
    #[must_use]
    pub fn scene(self, text: impl Into<String>) -> Self {
        Record { scene: text.into(), ..self }
    }

    /// A setting, in `unit` (empty if it has none).
    #[must_use]
    pub fn setting(mut self, name: impl Into<String>, value: impl ToString, unit: impl Into<String>) -> Self {
        self.settings.push(Setting { name: name.into(), value: value.to_string(), unit: unit.into() });
        self
    }

    /// The whole was cut at so many planes of symmetry: the scene is a half, a quarter, an eighth of it.
    #[must_use]
    pub fn symmetry_planes(mut self, planes: u32) -> Self {
        self.part.planes = planes;
        self
    }

    /// Another program or library that had to do with the run.
    #[must_use]
    pub fn version(mut self, name: impl Into<String>, version: impl Into<String>) -> Self {
        self.machine.versions.push([name.into(), version.into()]);
        self
    }

    /// Method, dimensions, bodies and memory of a scene as it stands.
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
        self
    }

    /// Balances, warnings, times and how far the run came, as `recorder` saw it. A run that is said to have
    /// [stopped](Record::stopped) stays so.
    #[must_use]
    pub fn balances(mut self, recorder: &Recorder) -> Self {
        self.balances = Some(Balances::of(recorder));
        self.warnings = recorder.warnings().to_vec();
        self.warnings.extend(recorder.removed());
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

    /// What the run took, on so many threads.
    #[must_use]
    pub fn summary(mut self, summary: &RunSummary, threads: usize) -> Self {
        self.timing.steps = summary.steps;
        self.timing.stepping = Some(summary.wall_seconds);
        self.timing.updates = summary.updates;
        self.machine.threads = threads;
        self
    }

    /// Seconds by the clock on the wall before the first step.
    #[must_use]
    pub fn setup(mut self, seconds: f64) -> Self {
        self.timing.setup = Some(seconds);
        self
    }

    /// The run stands at `time`, s, and is to go on to `end`: of a record that is saved before the run is over, so that a run that is
    /// broken off has a page, too.
    #[must_use]
    pub fn unfinished(self, time: f64, end: f64) -> Self {
        Record { progress: Progress::Interrupted { time, end }, ..self }
    }

    /// An error stopped the run.
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

    /// A picture in `file`, relative to the folder of the run. The first one is the main one.
    #[must_use]
    pub fn picture(mut self, file: impl Into<String>, caption: impl Into<String>) -> Self {
        self.pictures.push(PictureRecord { file: file.into(), caption: caption.into() });
        self
    }

    /// Frames of an animation.
    #[must_use]
    pub fn frames(self, frames: Frames) -> Self {
        Record { animation: Some(frames), ..self }
    }

    /// A history in the CSV file `file`, relative to the folder of the run, with all of its columns.
    #[must_use]
    pub fn history(self, title: impl Into<String>, file: impl Into<String>) -> Self {
        self.history_of(HistoryRecord::new(title, file))
    }

    /// A history.
    #[must_use]
    pub fn history_of(mut self, history: HistoryRecord) -> Self {
        self.histories.push(history);
        self
    }

    /// A number of the run beside what it should be.
    #[must_use]
    pub fn check(mut self, check: Check) -> Self {
        self.checks.push(check);
        self
    }

    /// Such numbers.
    #[must_use]
    pub fn checks(mut self, checks: impl IntoIterator<Item = Check>) -> Self {
        self.checks.extend(checks);
        self
    }

    /// What limited the step in so many steps.
    #[must_use]
    pub fn limited_by(mut self, cause: impl Into<String>, steps: u64) -> Self {
        self.limits.push(Limit { cause: cause.into(), steps });
        self
    }

    /// Rows of the checks that are met, and rows that are judged.
    #[must_use]
    pub fn met(&self) -> [usize; 2] {
        let judged = self.checks.iter().filter_map(|check| check.pass);
        [judged.clone().filter(|&met| met).count(), judged.count()]
    }

    /// Save it whole as `run.json` in the folder of the run, which is made if it is not there.
    ///
    /// # Errors
    /// A title that is empty, a file that is not within the folder, times of frames that are not one a frame; a file that cannot be
    /// written.
    pub fn save(&self, folder: impl AsRef<Path>) -> Result<PathBuf, ReportError> {
        self.check_fields()?;
        let folder = folder.as_ref();
        std::fs::create_dir_all(folder).map_err(impactite_output::OutputError::file("create", folder))?;
        let path = folder.join(FILE);
        let json = serde_json::to_string_pretty(self).map_err(|error| ReportError::damaged(&path, error))?;
        write_whole(&path, json + "\n")?;
        Ok(path)
    }

    /// Refuse what no record can have.
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

/// The architecture, and the vector instructions that the processor has.
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
