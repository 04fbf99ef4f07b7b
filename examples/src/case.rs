//! Interface of a case: options in; pictures, histories, a table of checks and one JSON object out.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::{ArgMatches, Args, Command, FromArgMatches, Parser, ValueEnum};
use mpm_core::geometry::GeometryError;
use mpm_core::observe::{Ledger, ObserveError};
use mpm_core::output::{OutputError, write_whole};
use mpm_core::parallel::{Team, TeamError};
use mpm_core::scene::control::ControlError;
use mpm_core::{CheckpointError, RunError, RunSummary, SceneError, Solver};
use mpm_materials::ParameterError;
use serde::Serialize;

use crate::check::{Check, NotJudged, shown};
use crate::machine;
use crate::restart::{Options, Restart};

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
    /// Select one of three values by resolution.
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
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=Team::MOST as i64))]
    pub threads: Option<u16>,
    /// Folder for pictures, histories and ParaView files [default: out/NAME]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the result as one JSON object on the last line
    #[arg(long)]
    pub json: bool,
    /// Seconds by the clock between two checkpoints of a simulation, DIR/SIMULATION.checkpoint; 0: one after every step
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = within(0.0, 1.0e6))]
    pub checkpoint: f64,
    /// Resume the simulation that this checkpoint is of; needs the options of the run that wrote it but for threads, out, json,
    /// checkpoint. The other simulations of the case run again. All results are as without the interruption
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
}

/// Options that no result depends on: they may differ when a run is resumed.
const OF_NO_RESULT: [&str; 7] = ["threads", "out", "json", "checkpoint", "resume", "help", "version"];

impl Common {
    /// Return the number of threads to use.
    pub fn threads(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from).min(Team::MOST);
        self.threads.map_or_else(all, usize::from)
    }

    /// Return the folder for the files of the case `name`; create it if it does not exist.
    ///
    /// # Errors
    /// Folder that cannot be created.
    pub fn folder(&self, name: &str) -> Result<PathBuf, CaseError> {
        let folder = self.out.clone().unwrap_or_else(|| Path::new("out").join(name));
        std::fs::create_dir_all(&folder)
            .map_err(|source| CaseError::File { path: folder.clone(), source })?;
        Ok(folder)
    }

    /// Set up the checkpoints of the case `name` with these options in its folder, and the one to resume from.
    ///
    /// # Errors
    /// Folder that cannot be created; checkpoint that cannot be resumed from.
    pub fn restart(&self, name: &str, options: Options) -> Result<Restart, CaseError> {
        let every = Duration::from_secs_f64(self.checkpoint);
        Restart::new(name, options, &self.folder(name)?, every, self.resume.as_deref())
    }
}

/// Error that stops a case.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// Invalid material constant.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Invalid shape or lattice.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Invalid scene definition.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Error of the run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Error of an observer.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// Error of a picture or file.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// File or folder that cannot be written.
    #[error("cannot write `{}`: {source}", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A checkpoint that cannot be resumed from.
    #[error("--resume {}: {source}", path.display())]
    Resume {
        /// Path of the checkpoint.
        path: PathBuf,
        /// Reason for the refusal.
        source: CheckpointError,
    },
    /// Result that cannot be serialised as JSON.
    #[error("cannot write the result as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Other error, as text.
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

impl From<flow::FluidError> for CaseError {
    fn from(e: flow::FluidError) -> Self {
        CaseError::Other(e.to_string())
    }
}

impl From<mpm_core::StepError> for CaseError {
    fn from(e: mpm_core::StepError) -> Self {
        CaseError::Run(e.into())
    }
}

/// Return a parser for command-line numbers from `low` to `high`.
pub fn within(low: f64, high: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match text.parse::<f64>() {
        Ok(x) if (low..=high).contains(&x) => Ok(x),
        _ => Err(format!("it must be a number from {low} to {high}")),
    }
}

/// Totals over the runs of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Number of particles of all runs.
    pub particles: usize,
    /// Number of steps of all runs.
    pub steps: u64,
    /// Simulated time of all runs, s.
    pub simulated_seconds: f64,
    /// Wall-clock time of the steps of all runs, s, without scene construction, observers and pictures.
    pub wall_seconds: f64,
    /// Number of particle updates of all runs.
    pub updates: f64,
    /// Memory of the largest run as counted by its solver, bytes.
    pub bytes: usize,
    /// Energy error of largest magnitude.
    pub energy_error: f64,
    /// Largest momentum error.
    pub momentum_error: f64,
}

impl Totals {
    /// Collect the totals of one run, with the largest errors of its ledger.
    #[must_use]
    pub fn of(solver: &dyn Solver, run: &RunSummary, ledger: &Ledger) -> Totals {
        Totals {
            particles: solver.bodies().iter().map(|body| body.len()).sum(),
            steps: run.steps,
            simulated_seconds: solver.time(),
            wall_seconds: run.wall_seconds,
            updates: run.updates,
            bytes: solver.bytes(),
            energy_error: ledger.worst_energy_error(),
            momentum_error: ledger.worst_momentum_error(),
        }
    }

    /// Add totals; keep the larger memory and the larger errors.
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

/// Return the largest of the values and zero; NaN if one is NaN.
#[must_use]
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| if b.is_nan() || b > a { b } else { a })
}

/// Return the value of largest magnitude, with its sign; NaN if one is NaN, zero if there are none.
#[must_use]
pub fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a: f64, b| if b.is_nan() || b.abs() > a.abs() { b } else { a })
}

/// Result of a case: the keys of its JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the case.
    pub case: String,
    /// Resolution of the run.
    pub resolution: Resolution,
    /// Other options, and quantities derived from them.
    pub settings: serde_json::Value,
    /// Number of particles, summed over the runs of the case.
    pub particles: usize,
    /// Number of steps, summed over runs.
    pub steps: u64,
    /// Simulated time, summed over runs, s.
    pub simulated_seconds: f64,
    /// Wall-clock time of steps, summed over runs, s, without observers, files and pictures.
    pub wall_seconds: f64,
    /// Particle updates of all runs over `wall_seconds`, 1/s.
    pub particle_updates_per_second: f64,
    /// Peak memory of the process so far, bytes (of the largest run where the system does not report it).
    pub peak_memory_bytes: usize,
    /// Checks: failed ones first, then passed ones, then those that are only shown.
    pub checks: Vec<Check>,
    /// Number of rows with a reference that passed.
    pub met: usize,
    /// Number of rows with a reference that failed, known misses included.
    pub missed: usize,
    /// Number of rows that are shown and not judged: reference from memory of the literature, or none.
    pub shown: usize,
    /// Rows that are not judged at this resolution; they are not among the checks.
    pub not_judged: Vec<NotJudged>,
    /// Energy error of largest magnitude of all runs.
    pub energy_error: f64,
    /// Largest momentum error of all runs.
    pub momentum_error: f64,
}

impl Report {
    /// Assemble the report from the totals of the runs and all rows.
    pub fn new(
        case: &str,
        resolution: Resolution,
        settings: serde_json::Value,
        totals: &Totals,
        rows: Vec<Check>,
    ) -> Self {
        let (mut checks, mut not_judged) = (Vec::new(), Vec::new());
        for check in rows {
            match check.sorted_out() {
                Ok(check) => checks.push(check),
                Err(row) => not_judged.push(row),
            }
        }
        checks.sort_by_key(Check::rank);
        let count = |pass| checks.iter().filter(|c| c.pass() == pass).count();
        let [met, missed, shown] = [Some(true), Some(false), None].map(count);
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
            met,
            missed,
            shown,
            not_judged,
            energy_error: totals.energy_error,
            momentum_error: totals.momentum_error,
        }
    }

    /// True if no check [fails](Check::fails) the run.
    pub fn passed(&self) -> bool {
        !self.checks.iter().any(Check::fails)
    }

    /// Print the table of checks, failed ones first, the counts and, if requested, the JSON object on the last line; write
    /// the JSON to the folder too. The exit code reports whether the run [passed](Report::passed): a known miss counts as
    /// missed but does not fail the run.
    ///
    /// # Errors
    /// File that cannot be written.
    pub fn finish(&self, common: &Common, folder: &Path) -> Result<ExitCode, CaseError> {
        self.finish_in(common.json, folder)
    }

    /// Print and write the report as [`Report::finish`], for binaries with options of their own.
    ///
    /// # Errors
    /// File that cannot be written.
    pub fn finish_in(&self, print_json: bool, folder: &Path) -> Result<ExitCode, CaseError> {
        let json = serde_json::to_string(self)?;
        let path = folder.join("result.json");
        write_whole(path, format!("{json}\n"))?;
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

    /// Format the table: judged rows, failed ones first; rows that are only shown; counts.
    fn table(&self) -> String {
        let head = ["quantity", "this run", "reference", "difference", "source", "met or not"];
        let row = |c: &Check| {
            let reference = c.reference.map_or(String::new(), |r| shown(r, &c.unit));
            [
                c.name.clone(),
                shown(c.value, &c.unit),
                reference,
                c.difference(),
                c.source.clone(),
                c.verdict(),
            ]
        };
        let (judged, rest): (Vec<&Check>, Vec<&Check>) = self.checks.iter().partition(|c| c.pass().is_some());
        let of = |rows: Vec<&Check>| {
            columns(&[vec![head.map(String::from)], rows.into_iter().map(row).collect()].concat())
        };
        let mut text = of(judged);
        if !rest.is_empty() {
            text += &format!(
                "\nshown, not judged: from memory of the literature [M], or without a reference\n{}",
                of(rest)
            );
        }
        if !self.not_judged.is_empty() {
            text += "\n";
        }
        for NotJudged { name, value, unit, reason } in &self.not_judged {
            text += &format!("not judged at this resolution: {name}, {}: {reason}\n", shown(*value, unit));
        }
        text + &format!("\n{}\n", self.counts())
    }

    /// Format the counts of rows by verdict.
    pub fn counts(&self) -> String {
        let known = self.checks.iter().filter(|c| c.pass() == Some(false) && !c.fails()).count();
        let unneeded = self.checks.iter().filter(|c| c.pass() == Some(true) && c.known().is_some()).count();
        let mut text = format!("{} of {} met, {} missed", self.met, self.met + self.missed, self.missed);
        if self.missed > 0 {
            text += &format!(" ({known} declared)");
        }
        if unneeded > 0 {
            text += &format!(", {unneeded} met though declared as missed");
        }
        format!(
            "{text}; {} shown, not judged; {} not judged at this resolution",
            self.shown,
            self.not_judged.len()
        )
    }
}

/// Format rows of text in columns, with a rule under the first row. Numbers are right-aligned. The last column may be long.
pub fn columns<const N: usize>(rows: &[[String; N]]) -> String {
    let widths: Vec<usize> =
        (0..N).map(|c| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for (i, row) in rows.iter().enumerate() {
        let mut line = String::new();
        for (c, cell) in row.iter().enumerate() {
            let blank = " ".repeat(widths[c] - cell.chars().count());
            // A cell is a number if its first word parses as one; the first column has names.
            let number = c > 0 && cell.split(' ').next().is_some_and(|w| w.parse::<f64>().is_ok());
            line += &if number { format!("{blank}{cell}") } else { format!("{cell}{blank}") };
            line += "  ";
        }
        text += line.trim_end();
        text += "\n";
        if i == 0 {
            let last = widths.last().map_or(0, |w| w.saturating_sub(WIDEST));
            text += &"─".repeat(widths.iter().sum::<usize>() + 2 * (N - 1) - last);
            text += "\n";
        }
    }
    text
}

/// Characters of the last column under which the rule extends.
const WIDEST: usize = 24;

/// Return the peak resident memory of this process, bytes; `None` if the system does not report it.
pub fn peak_memory() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// Run a program with its command-line options, in huge pages if available; print errors to the standard error stream.
pub fn start<O: Parser>(run: impl FnOnce(&O) -> Result<ExitCode, CaseError>) -> ExitCode {
    machine::into_huge_pages();
    let mut command = command::<O>();
    let parsed = O::from_arg_matches(&command.clone().get_matches());
    told(run(&parsed.unwrap_or_else(|error| error.format(&mut command).exit())))
}

/// Build the command-line parser of a program. Negative numbers are values, so that an error states the allowed range.
fn command<O: Parser>() -> Command {
    O::command().mut_args(|argument| {
        let negative = argument.get_action().takes_values();
        argument.allow_negative_numbers(negative)
    })
}

/// Run a case like [`start`]: its options include [`Common`] and its simulations can be resumed.
pub fn start_case<O: Parser>(run: impl FnOnce(&O, &Restart) -> Result<ExitCode, CaseError>) -> ExitCode {
    machine::into_huge_pages();
    let mut command = command::<O>();
    let matches = command.clone().get_matches();
    let (name, given) = (command.get_name().to_string(), given(&command, &matches));
    let parsed = O::from_arg_matches(&matches).and_then(|options| {
        let common = Common::from_arg_matches(&matches)?;
        Ok((options, common))
    });
    let (options, common) = parsed.unwrap_or_else(|error| error.format(&mut command).exit());
    told(common.restart(&name, given).and_then(|restart| run(&options, &restart)))
}

fn told(ended: Result<ExitCode, CaseError>) -> ExitCode {
    ended.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

/// Return the options that affect results, as given or by default.
fn given(command: &Command, matches: &ArgMatches) -> Options {
    let of = |argument: &clap::Arg| {
        let name = argument.get_long().filter(|name| !OF_NO_RESULT.contains(name))?;
        let values = matches.try_get_raw(argument.get_id().as_str()).ok()??;
        let values: Vec<_> = values.map(|v| v.to_string_lossy()).collect();
        Some((format!("--{name}"), values.join(",")))
    };
    command.get_arguments().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(checks: Vec<Check>) -> Report {
        Report::new("t", Resolution::Smoke, serde_json::json!({}), &Totals::default(), checks)
    }

    fn good() -> Check {
        Check::gate("good", 1.0, "-", 1.0, 0.1, "[C]")
    }

    fn bad() -> Check {
        Check::gate("bad", 2.0, "-", 1.0, 0.1, "[C]")
    }

    #[test]
    fn a_report_fails_with_one_missed_row() {
        let memory = Check::remembered("m", 9.0, "-", 1.0, "a book");
        assert!(report(vec![good(), memory]).passed());
        assert!(!report(vec![good(), bad()]).passed());
    }

    /// A failed row counts as missed, whatever is declared.
    #[test]
    fn a_missed_row_always_counts() {
        for miss in
            [bad(), bad().known_miss("so it is"), bad().judged_if(true, "fine enough").known_miss("so it is")]
        {
            let report = report(vec![good(), miss]);
            assert_eq!((report.met, report.missed, report.shown), (1, 1, 0));
            assert_eq!(report.checks[0].name, "bad", "first");
            let json = serde_json::to_value(&report).expect("JSON");
            assert_eq!((&json["met"], &json["missed"]), (&1.into(), &1.into()));
            assert_eq!(json["checks"][0]["pass"], false);
            assert!(report.table().contains("1 of 2 met, 1 missed"), "{}", report.table());
        }
        assert!(report(vec![bad().known_miss("so it is")]).passed(), "what is declared does not fail a run");
    }

    #[test]
    fn rows_that_are_missed_come_first_with_their_reasons() {
        let table = report(vec![
            good(),
            bad().known_miss("it is coarse"),
            Check::gate("worse", 3.0, "-", 1.0, 0.1, ""),
        ])
        .table();
        let at = |what: &str| table.find(what).expect(what);
        assert!(at("worse") < at("bad") && at("bad") < at("good"), "{table}");
        assert!(table.contains("MISSED (10 % allowed); declared: it is coarse"), "{table}");
        assert!(table.contains("1 of 3 met, 2 missed (1 declared); 0 shown"), "{table}");
    }

    #[test]
    fn a_declared_miss_that_is_met_says_so() {
        let report = report(vec![good().known_miss("it was coarse")]);
        assert_eq!((report.met, report.missed), (1, 0));
        assert!(report.table().contains("met (declared as missed: it was coarse)"), "{}", report.table());
        assert!(report.counts().contains("1 met though declared as missed"));
    }

    #[test]
    fn what_says_nothing_at_a_resolution_is_named_and_not_in_the_table() {
        let report = report(vec![good(), bad().judged_if(false, "two cells")]);
        assert_eq!((report.met, report.missed, report.shown, report.not_judged.len()), (1, 0, 0, 1));
        let table = report.table();
        assert!(table.contains("not judged at this resolution: bad, 2.000: two cells"), "{table}");
        assert!(table.contains("1 not judged at this resolution"), "{table}");
        assert_eq!(serde_json::to_value(&report).expect("JSON")["checks"].as_array().map(Vec::len), Some(1));
    }

    #[test]
    fn columns_stand_below_each_other() {
        let rows = [["a", "b", "c"], ["long", "1", "text"], ["d", "22", ""]].map(|r| r.map(String::from));
        assert_eq!(columns(&rows), "a     b   c\n──────────────\nlong   1  text\nd     22\n");
    }
}
