//! Charts of error against work: runs the sweeps and writes a page.

mod chart;
mod front;
mod page;
mod record;
mod sweep;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use verification::origin::said_by;
use verification::{fast, stored};

use record::Record;

/// Error against work: runs verification problems with every scheme, and writes a page of charts with its data.
///
/// Runs are written down one by one; stopped and started again, the sweep goes on where it was.
#[derive(Debug, Parser)]
#[command(name = "report", version)]
struct Options {
    /// A sweep of some minutes instead of one for the night
    #[arg(long)]
    quick: bool,
    /// Folder for page and data
    #[arg(long, value_name = "DIR", default_value = "out/report")]
    out: PathBuf,
    /// Write the page from the runs there are, without new ones
    #[arg(long)]
    draw: bool,
    /// Instead of all this: run the stored cases and print their table (tests/verification/data/errors.csv)
    #[arg(long)]
    store: bool,
}

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn std::error::Error>> {
    if options.store {
        let runs: Vec<_> = fast::cases().into_iter().map(|case| (case, case.run())).collect();
        print!("{}", stored::table(&runs));
        return Ok(());
    }
    fs::create_dir_all(&options.out)?;
    let file = options.out.join("runs.jsonl");
    let commit = said_by("git", &["describe", "--always", "--dirty"]);
    let charts = sweep::charts();
    if !options.draw {
        make_runs(&charts, options.quick, &file, &commit)?;
    }
    let mut records = record::read(&file)?;
    records.retain(|r| r.case().is_some());
    let making = page::Making {
        commit: records.last().map_or(commit, |r| r.commit.clone()),
        date: said_by("date", &["+%Y-%m-%d"]),
        machine: machine(),
        compiler: said_by("rustc", &["--version"]),
        band: band(&options.out, options.draw)?,
        sweep: if options.quick { "quick" } else { "full" },
    };
    record::write_csv(&options.out.join("runs.csv"), &records)?;
    let page = options.out.join("index.html");
    fs::write(&page, page::page(&charts, &records, &making))?;
    println!("{} runs, {}", records.len(), page.display());
    Ok(())
}

/// Make the runs that are not there yet.
fn make_runs(
    charts: &[sweep::Chart],
    quick: bool,
    file: &Path,
    commit: &str,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut problems: Vec<_> = charts.iter().map(|c| c.problem).collect();
    problems.dedup();
    let there = record::read(file)?;
    let cases: Vec<_> = problems.into_iter().flat_map(|p| sweep::cases(p, quick)).collect();
    let missing: Vec<_> = cases.iter().filter(|c| !there.iter().any(|r| r.is_of(c, commit))).collect();
    println!("{} runs, {} of them there", cases.len(), cases.len() - missing.len());
    let (repeats, start) = (if quick { 2 } else { 5 }, Instant::now());
    for (n, case) in missing.iter().enumerate() {
        let mut record = Record::make(case, commit);
        // The clock is judged by the smallest of some; long runs need it less.
        for _ in 1..repeats {
            if record.core_seconds < if quick { 0.1 } else { 30.0 } {
                record.core_seconds = record.core_seconds.min(Record::make(case, commit).core_seconds);
            }
        }
        record::append(file, &record)?;
        let minutes = start.elapsed().as_secs_f64() / 60.0;
        let note = record.failure.as_deref().map_or("", |_| ", stopped");
        println!("{}/{} at {minutes:.1} min: {}{note}", n + 1, missing.len(), case.name());
    }
    Ok(())
}

/// How much the time of one and the same run differs: two series of five, by turns.
fn band(out: &Path, known: bool) -> Result<f64, Box<dyn std::error::Error>> {
    let file = out.join("band.json");
    if known && file.exists() {
        return Ok(serde_json::from_str(&fs::read_to_string(file)?)?);
    }
    let case = sweep::control();
    let mut best = [f64::INFINITY; 2];
    for n in 0..10 {
        best[n % 2] = best[n % 2].min(case.run().work.seconds);
    }
    let band = (best[0] / best[1] - 1.0).abs();
    fs::write(file, serde_json::to_string(&band)?)?;
    Ok(band)
}

/// The processor.
fn machine() -> String {
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|l| l.strip_prefix("model name")?.split(": ").nth(1));
    name.unwrap_or("processor unknown").to_string()
}
