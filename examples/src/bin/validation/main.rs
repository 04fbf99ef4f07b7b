//! The validation page: runs the cases and writes what came of them, beside what should, to one page and one table.

mod page;
mod runs;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use examples::{CaseError, Resolution, case, within};

use runs::{CASES, Run};

/// Run the cases one after the other and write docs/validation.md and docs/validation.csv.
///
/// The cases are the programs beside this one: build them first by `cargo build --release -p examples --bins`. Results
/// are kept in a folder by resolution; the page shows of every case the finest that is there, so that it can be made in
/// stages. A case that fails its checks, breaks off or takes too long is on the page as such.
#[derive(Debug, Parser)]
#[command(name = "validation", version)]
struct Options {
    /// How fine the cases are
    #[arg(long, value_enum, default_value = "smoke")]
    resolution: Resolution,
    /// Cases to run, separated by commas [default: all; none runs none and writes the page]
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    cases: Option<Vec<String>>,
    /// Threads of every case [default: all processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Seconds that a case may take, 1 to 1e6
    #[arg(long, value_name = "S", default_value_t = 3600.0, value_parser = within(1.0, 1e6))]
    at_most: f64,
    /// Folder for the results [default: out/validation]
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
    let mut wanted = options.cases.clone().unwrap_or_else(all);
    wanted.retain(|name| name != "none");
    if let Some(name) = wanted.iter().find(|name| !CASES.contains(&name.as_str())) {
        let allowed = CASES.join(", ");
        return Err(CaseError::Other(format!("case = {name} is not allowed; it must be one of {allowed}")));
    }
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from("out/validation"));
    let limit = Duration::from_secs_f64(options.at_most);
    for name in &wanted {
        println!("{name}");
        let run = Run::make(name, options.resolution, options.threads, limit, &out)?;
        println!("  {}", run.summary());
        run.keep(&out)?;
    }
    let runs = Run::finest(&out)?;
    page::write(&runs, &options.docs)?;
    println!("{} cases on the page in {}", runs.len(), options.docs.display());
    let finished = runs.iter().filter(|r| wanted.contains(&r.case)).all(|r| r.broken.is_none());
    Ok(if finished { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
