//! Validation page: run the cases of one commit, and write their results and references to one page and one table.

mod page;
mod runs;
mod tree;

use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::Duration;

use clap::Parser;
use examples::{CaseError, Resolution, case, machine, within};

use mpm_core::Team;
use page::Made;
use runs::{CASES, Run};

/// Build and run the cases one after the other and write docs/validation.md and docs/validation.csv.
///
/// The page is of one commit: a working tree with changed or new files is refused, before the first case and after the
/// last, and no result of an earlier run is taken. Commit the page before it is made again. A case that misses a row,
/// breaks off or takes too long is on the page as such; the exit code says whether all came to their ends and missed no
/// row but those that are declared.
#[derive(Debug, Parser)]
#[command(name = "validation", version)]
struct Options {
    /// How fine the cases are
    #[arg(long, value_enum, default_value = "smoke")]
    resolution: Resolution,
    /// Cases to run, separated by commas [default: all]; the page says how many there are
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    cases: Option<Vec<String>>,
    /// Threads of every case [default: all processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=Team::MOST as i64))]
    threads: Option<u16>,
    /// Seconds that a case may take, 1 to 1e6
    #[arg(long, value_name = "S", default_value_t = 3600.0, value_parser = within(1.0, 1e6))]
    at_most: f64,
    /// Run the programs that lie beside this one as they were built; the page says so
    #[arg(long)]
    as_built: bool,
    /// Folder for the files of the cases [default: out/validation]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Folder of the page
    #[arg(long, value_name = "DIR", default_value = "docs")]
    docs: PathBuf,
}

fn main() -> ExitCode {
    case::start(run)
}

fn run(options: &Options) -> Result<ExitCode, CaseError> {
    let all = || CASES.map(String::from).to_vec();
    let wanted = options.cases.clone().unwrap_or_else(all);
    if let Some(name) = wanted.iter().find(|name| !CASES.contains(&name.as_str())) {
        let allowed = CASES.join(", ");
        return Err(CaseError::Other(format!("case = {name} is not allowed; it must be one of {allowed}")));
    }
    let commit = tree::clean_commit()?;
    if !options.as_built {
        build()?;
    }
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from("out/validation"));
    let limit = Duration::from_secs_f64(options.at_most);
    let mut runs = Vec::new();
    for name in &wanted {
        println!("{name}");
        let run = Run::make(name, options.resolution, options.threads, limit, &out)?;
        println!("  {}", run.summary());
        runs.push(run);
    }
    let now = tree::clean_commit()?;
    if now != commit {
        let said = format!("commit = {now} is not allowed; it must be {commit}, of which the cases were run");
        return Err(CaseError::Other(said));
    }
    let made = Made { commit, machine: machine::class(), as_built: options.as_built };
    page::write(&made, &runs, &options.docs)?;
    println!("{} cases on the page in {}", runs.len(), options.docs.display());
    Ok(if runs.iter().all(Run::passed) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Build the cases into the folder of this program, so that they belong to the commit.
fn build() -> Result<(), CaseError> {
    let here = std::env::current_exe().map_err(|e| CaseError::Other(e.to_string()))?;
    // The folder of a profile has the profile's name, except for `dev`.
    let folder =
        here.parent().and_then(|p| p.file_name()).map_or("release".into(), |name| name.to_string_lossy());
    let profile = if folder == "debug" { "dev".into() } else { folder };
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let failed = |why: String| CaseError::Other(format!("cargo build -p examples --bins: {why}"));
    let status =
        Command::new(cargo).args(["build", "-p", "examples", "--bins", "--profile", &profile]).status();
    let status = status.map_err(|e| failed(e.to_string()))?;
    if status.success() { Ok(()) } else { Err(failed(status.to_string())) }
}
