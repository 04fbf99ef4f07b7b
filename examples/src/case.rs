//! The contract of a case: options in; pictures, histories, a table and one JSON object out.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, ValueEnum};
use mpm_core::geometry::GeometryError;
use mpm_core::observe::{Ledger, ObserveError, RunError, RunSummary};
use mpm_core::output::OutputError;
use mpm_core::parallel::TeamError;
use mpm_core::step::SceneError;
use mpm_core::step::control::ControlError;
use mpm_core::{Float, Mpm};
use mpm_materials::ParameterError;
use serde::Serialize;

use crate::machine;

/// How fine a case is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Resolution {
    /// Seconds: does it run, and is it roughly right?
    Smoke,
    /// A minute or so: the numbers in the documentation.
    Standard,
    /// As long as it takes: the numbers for a publication.
    Paper,
}

impl Resolution {
    /// One of three values, by resolution.
    pub fn choose<X>(self, smoke: X, standard: X, paper: X) -> X {
        match self {
            Resolution::Smoke => smoke,
            Resolution::Standard => standard,
            Resolution::Paper => paper,
        }
    }
}

/// Options of every case.
#[derive(Clone, Debug, Args)]
pub struct Common {
    /// How fine: smoke takes seconds, standard about a minute, paper as long as it takes
    #[arg(long, value_enum, default_value = "standard")]
    pub resolution: Resolution,
    /// Threads [default: all processors]; results are the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Folder for pictures, histories and ParaView files [default: out/NAME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the result as one JSON object on the last line
    #[arg(long)]
    pub json: bool,
}

impl Common {
    /// The number of threads to use.
    pub fn threads(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.map_or_else(all, usize::from)
    }

    /// The folder for the files of the case `name`, made if it does not exist.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn folder(&self, name: &str) -> Result<PathBuf, CaseError> {
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(name));
        std::fs::create_dir_all(&folder)
            .map_err(|source| CaseError::File { path: folder.clone(), source })?;
        Ok(folder)
    }
}

/// Why a case could not be run to its end.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// A material constant.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A shape or lattice.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An observer.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// A picture or file.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A file or folder.
    #[error("cannot write `{}`: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The result as JSON.
    #[error("cannot write the result as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Anything else.
    #[error("{0}")]
    Other(String),
}

impl From<TeamError> for CaseError {
    fn from(e: TeamError) -> Self {
        CaseError::Other(e.to_string())
    }
}

impl From<ControlError> for CaseError {
    fn from(e: ControlError) -> Self {
        CaseError::Other(e.to_string())
    }
}

impl From<pcmm::SceneError> for CaseError {
    fn from(e: pcmm::SceneError) -> Self {
        CaseError::Other(e.to_string())
    }
}

impl From<pcmm::BodyError> for CaseError {
    fn from(e: pcmm::BodyError) -> Self {
        CaseError::Other(e.to_string())
    }
}

impl From<pcmm::StepError> for CaseError {
    fn from(e: pcmm::StepError) -> Self {
        CaseError::Other(e.to_string())
    }
}

impl From<mpm_core::StepError> for CaseError {
    fn from(e: mpm_core::StepError) -> Self {
        CaseError::Run(e.into())
    }
}

/// A number of a run, and what it should be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// What it is.
    pub name: String,
    /// This run's, in `unit`.
    pub value: f64,
    /// Its unit; "-" if it has none.
    pub unit: String,
    /// What it should be.
    pub reference: Option<f64>,
    /// How far from the reference it may be, relative to it (absolute where the reference is 0). `None`: the
    /// reference is only shown, or a bound.
    pub tolerance: Option<f64>,
    /// Where the reference is from. \[C\] computed independently, \[M\] from memory of the literature.
    pub source: String,
    /// Is it within the tolerance? `None` without one: such a check never fails a case.
    pub pass: Option<bool>,
}

impl Check {
    /// A check that decides: `value` within `tolerance` of `reference`.
    pub fn gate(
        name: impl Into<String>,
        value: f64,
        unit: &str,
        reference: f64,
        tolerance: f64,
        source: &str,
    ) -> Self {
        let scale = if reference == 0.0 { 1.0 } else { reference.abs() };
        // NaN is not within.
        let pass = Some((value - reference).abs() <= tolerance * scale);
        let (name, unit, source) = (name.into(), unit.into(), source.into());
        Check { name, value, unit, reference: Some(reference), tolerance: Some(tolerance), source, pass }
    }

    /// A check that decides: `value` not below `reference`.
    pub fn at_least(name: impl Into<String>, value: f64, unit: &str, reference: f64, source: &str) -> Self {
        let pass = Some(value.is_finite() && value >= reference);
        Check { pass, ..Self::shown(format!("{} (at least)", name.into()), value, unit, reference, source) }
    }

    /// A check that decides: `value` not above `reference`.
    pub fn at_most(name: impl Into<String>, value: f64, unit: &str, reference: f64, source: &str) -> Self {
        let pass = Some(value.is_finite() && value <= reference);
        Check { pass, ..Self::shown(format!("{} (at most)", name.into()), value, unit, reference, source) }
    }

    /// A reference that is shown and decides nothing.
    pub fn shown(name: impl Into<String>, value: f64, unit: &str, reference: f64, source: &str) -> Self {
        let (name, unit, source) = (name.into(), unit.into(), source.into());
        Check { name, value, unit, reference: Some(reference), tolerance: None, source, pass: None }
    }

    /// A check that decides nothing where it would fail, and says NOT MET instead: for what a method is known not to
    /// reach at a resolution.
    #[must_use]
    pub fn noted(self) -> Self {
        if self.pass == Some(false) {
            Check { name: format!("NOT MET: {}", self.name), pass: None, tolerance: None, ..self }
        } else {
            self
        }
    }

    fn verdict(&self) -> String {
        match (self.pass, self.tolerance) {
            (Some(true), Some(t)) => format!("pass ({})", self.allowed(t)),
            (Some(false), Some(t)) => format!("FAIL ({})", self.allowed(t)),
            (Some(true), None) => "pass".into(),
            (Some(false), None) => "FAIL".into(),
            (None, _) => "shown only".into(),
        }
    }

    fn allowed(&self, tolerance: f64) -> String {
        if self.reference == Some(0.0) {
            format!("{tolerance:.0e} allowed")
        } else {
            format!("{:.3} % allowed", 100.0 * tolerance).replace(".000 %", " %").replace("00 %", " %")
        }
    }

    fn difference(&self) -> String {
        match self.reference {
            Some(r) if r != 0.0 => format!("{:+.2} %", 100.0 * (self.value / r - 1.0)),
            _ => String::new(),
        }
    }
}

/// Options on the command line that are numbers from `low` to `high`: a parser for them.
pub fn within(low: f64, high: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match text.parse::<f64>() {
        Ok(x) if (low..=high).contains(&x) => Ok(x),
        _ => Err(format!("it must be a number from {low} to {high}")),
    }
}

/// Sums over the runs of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Particles of all runs.
    pub particles: usize,
    /// Steps of all runs.
    pub steps: u64,
    /// Simulated time of all runs, s.
    pub simulated_seconds: f64,
    /// Wall-clock time of all runs in steps alone, s: building the scene, observers, pictures are left out.
    pub wall_seconds: f64,
    /// Particle updates of all runs.
    pub updates: f64,
    /// Memory of the largest run by its own count, bytes.
    pub bytes: usize,
    /// The energy error largest by amount.
    pub energy_error: f64,
    /// The largest momentum error.
    pub momentum_error: f64,
}

impl Totals {
    /// Of one run, its errors the worst that a ledger saw.
    #[must_use]
    pub fn of<T: Float, const D: usize>(mpm: &Mpm<D, T>, run: &RunSummary, ledger: &Ledger) -> Totals {
        Totals {
            particles: mpm.particles(),
            steps: run.steps,
            simulated_seconds: mpm.time(),
            wall_seconds: run.wall_seconds,
            updates: run.updates,
            bytes: mpm.bytes(),
            energy_error: ledger.worst_energy_error(),
            momentum_error: ledger.worst_momentum_error(),
        }
    }

    /// Sums, and the worst of the errors.
    #[must_use]
    pub fn plus(self, o: &Totals) -> Totals {
        let worse = |a: f64, b: f64| worst([a, b]);
        Totals {
            particles: self.particles + o.particles,
            steps: self.steps + o.steps,
            simulated_seconds: self.simulated_seconds + o.simulated_seconds,
            wall_seconds: self.wall_seconds + o.wall_seconds,
            updates: self.updates + o.updates,
            bytes: self.bytes.max(o.bytes),
            energy_error: worse(self.energy_error, o.energy_error),
            momentum_error: worse(self.momentum_error, o.momentum_error),
        }
    }
}

/// The largest of these and zero; not a number if one is none.
#[must_use]
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| if b.is_nan() || b > a { b } else { a })
}

/// The one of these that is largest by amount, with its sign; not a number if one is none, zero if there is none.
#[must_use]
pub fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, b| if b.is_nan() || b.abs() > a.abs() { b } else { a })
}

/// The result of a case: the keys of its JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Its name.
    pub case: String,
    /// Its resolution.
    pub resolution: Resolution,
    /// Its other options, and what follows from them.
    pub settings: serde_json::Value,
    /// Particles, summed over the runs of the case.
    pub particles: usize,
    /// Steps, summed over runs.
    pub steps: u64,
    /// Simulated time, summed over runs, s.
    pub simulated_seconds: f64,
    /// Wall-clock time spent in steps, summed over runs, s. Observers, files and pictures are left out.
    pub wall_seconds: f64,
    /// Particle updates of all runs over `wall_seconds`, 1/s.
    pub particle_updates_per_second: f64,
    /// Largest memory of the process so far, bytes (where the system does not tell, of the largest run).
    pub peak_memory_bytes: usize,
    /// What was compared with what.
    pub checks: Vec<Check>,
    /// The energy error largest by amount, of all runs.
    pub energy_error: f64,
    /// The largest momentum error of all runs.
    pub momentum_error: f64,
}

impl Report {
    /// From sums over runs.
    pub fn new(
        case: &str,
        resolution: Resolution,
        settings: serde_json::Value,
        totals: &Totals,
        checks: Vec<Check>,
    ) -> Self {
        let rate = if totals.wall_seconds > 0.0 { totals.updates / totals.wall_seconds } else { 0.0 };
        Report {
            case: case.into(),
            resolution,
            settings,
            particles: totals.particles,
            steps: totals.steps,
            simulated_seconds: totals.simulated_seconds,
            wall_seconds: totals.wall_seconds,
            particle_updates_per_second: rate,
            peak_memory_bytes: peak_memory().unwrap_or(totals.bytes),
            checks,
            energy_error: totals.energy_error,
            momentum_error: totals.momentum_error,
        }
    }

    /// Did every check that decides pass?
    pub fn passed(&self) -> bool {
        self.checks.iter().all(|c| c.pass != Some(false))
    }

    /// Print the table of checks and, if asked, the JSON object on the last line; keep the JSON in the folder
    /// too. The exit code says whether the checks passed.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(&self, common: &Common, folder: &Path) -> Result<ExitCode, CaseError> {
        self.finish_in(common.json, folder)
    }

    /// As [`Report::finish`], for binaries with options of their own.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish_in(&self, print_json: bool, folder: &Path) -> Result<ExitCode, CaseError> {
        let json = serde_json::to_string(self)?;
        let path = folder.join("result.json");
        std::fs::write(&path, format!("{json}\n")).map_err(|source| CaseError::File { path, source })?;
        println!("\n{}", self.table());
        println!(
            "{} steps of {} particles in {:.2} s of stepping: {:.2} million particle updates a second",
            self.steps,
            self.particles,
            self.wall_seconds,
            1e-6 * self.particle_updates_per_second
        );
        println!("files in {}", folder.display());
        if print_json {
            println!("{json}");
        }
        Ok(if self.passed() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
    }

    fn table(&self) -> String {
        let head = ["quantity", "this run", "reference", "difference", "source", "verdict"];
        let mut rows = vec![head.map(String::from)];
        for c in &self.checks {
            let reference = c.reference.map_or(String::new(), |r| shown(r, &c.unit));
            let value = shown(c.value, &c.unit);
            rows.push([c.name.clone(), value, reference, c.difference(), c.source.clone(), c.verdict()]);
        }
        columns(&rows)
    }
}

/// A number with its unit, readable.
fn shown(x: f64, unit: &str) -> String {
    let number = match x.abs() {
        0.0 => "0".to_string(),
        a if (0.01..1e5).contains(&a) => format!("{x:.3}"),
        _ => format!("{x:.2e}"),
    };
    if unit == "-" { number } else { format!("{number} {unit}") }
}

/// Rows of text in columns; a rule under the first row. Numbers are set flush right.
pub fn columns<const N: usize>(rows: &[[String; N]]) -> String {
    let widths: Vec<usize> =
        (0..N).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for (i, row) in rows.iter().enumerate() {
        for (c, cell) in row.iter().enumerate() {
            let blank = " ".repeat(widths[c] - cell.chars().count());
            // The first word of a cell says whether it is a number; the first column names things.
            let number = c > 0 && cell.split(' ').next().is_some_and(|w| w.parse::<f64>().is_ok());
            text += &if number { format!("{blank}{cell}") } else { format!("{cell}{blank}") };
            text += if c + 1 < N { "  " } else { "\n" };
        }
        if i == 0 {
            text += &"─".repeat(widths.iter().sum::<usize>() + 2 * (N - 1));
            text += "\n";
        }
    }
    text
}

/// The largest resident memory of this process so far, bytes, where the system tells.
pub fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// Run a case with the options of the command line, in huge pages where there are any; errors go to the standard error
/// stream.
pub fn start<O: Parser>(run: impl FnOnce(&O) -> Result<ExitCode, CaseError>) -> ExitCode {
    machine::into_huge_pages();
    run(&O::parse()).unwrap_or_else(|e| {
        eprintln!("error: {e}");
        ExitCode::FAILURE
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_is_relative_unless_the_reference_is_zero() {
        let pass = |value, reference, tolerance| {
            Check::gate("x", value, "-", reference, tolerance, "test").pass == Some(true)
        };
        assert!(pass(16.4, 16.28, 0.015));
        assert!(!pass(16.6, 16.28, 0.015));
        assert!(pass(-0.009, 0.0, 0.01));
        assert!(!pass(f64::NAN, 0.0, 0.01));
        assert_eq!(Check::shown("x", 1.0, "-", 2.0, "test").pass, None);
    }

    #[test]
    fn a_report_fails_with_one_failed_gate() {
        let good = Check::gate("good", 1.0, "-", 1.0, 0.1, "");
        let bad = Check::gate("bad", 2.0, "-", 1.0, 0.1, "");
        let of = |checks| {
            Report::new("t", Resolution::Smoke, serde_json::json!({}), &Totals::default(), checks).passed()
        };
        assert!(of(vec![good.clone(), Check::shown("m", 9.0, "-", 1.0, "")]));
        assert!(!of(vec![good, bad]));
    }
}
