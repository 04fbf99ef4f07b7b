//! The program `impactite`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use impactite::parallel::Team;
use impactite::scene::RunError;
use impactite_cli::job::CHECKPOINT;
use impactite_cli::lists::{self, Word};
use impactite_cli::sweep::{Values, sweep};
use impactite_cli::{CliError, Job, Outcome, templates};
use impactite_input::Source;

/// Runs scenes of impact, penetration, explosion, fracture and granular flow from files.
#[derive(Debug, Parser)]
#[command(name = "impactite", version, propagate_version = true)]
struct Options {
    #[command(subcommand)]
    command: Command,
    /// More lines in the log (-v: debug, -vv: trace); RUST_LOG says it more finely
    #[arg(short, long, action = clap::ArgAction::Count, global = true)]
    verbose: u8,
    /// Only warnings and errors in the log
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene file; pictures, histories, a ParaView series and report.html go into a folder
    Run(RunOptions),
    /// Read a scene file and set the scene up, without running it
    Check(SceneOptions),
    /// Go on with a run that was stopped
    Resume(ResumeOptions),
    /// Run a scene file for each value of a key; a table and a chart of its measures
    Sweep(SweepOptions),
    /// List what scene files accept
    List(ListOptions),
    /// Write a scene file to begin with
    New(NewOptions),
    /// Rebuild report.html of a run folder
    Report {
        /// The folder of a run
        folder: PathBuf,
    },
    /// The JSON Schema of scene files, for editors
    Schema,
}

#[derive(Debug, Args)]
struct SceneOptions {
    /// The scene file, TOML or JSON
    scene: PathBuf,
    /// Change a key of the file, as bodies.rod.speed=600 or parameters.radius="4 mm"
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

#[derive(Debug, Args)]
struct HowOptions {
    /// Threads [default: all processors]; results are the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=Team::MOST as i64))]
    threads: Option<u16>,
    /// Wall-clock seconds between checkpoints (0: after every step)
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = seconds)]
    checkpoint: f64,
    /// Wall-clock seconds between lines of the log
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    log_every: f64,
    /// No pictures, and no files for ParaView
    #[arg(long)]
    no_pictures: bool,
    /// No report.html
    #[arg(long)]
    no_report: bool,
    /// Print the result as one JSON object on the last line
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct RunOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Folder for the files [default: out/NAME, NAME that of the scene file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    how: HowOptions,
}

#[derive(Debug, Args)]
struct ResumeOptions {
    /// The folder of the run, or its checkpoint
    folder: PathBuf,
    #[command(flatten)]
    how: HowOptions,
}

#[derive(Debug, Args)]
struct SweepOptions {
    #[command(flatten)]
    run: RunOptions,
    /// The key and its values: KEY=A,B,C or KEY="A..B/N UNIT"; several keys: all combinations
    #[arg(long = "over", value_name = "KEY=VALUES", required = true)]
    over: Vec<Values>,
}

#[derive(Debug, Args)]
struct ListOptions {
    /// Topic; the topics if not given
    topic: Option<Word>,
    /// Part of the keys, as bodies.plate.shape or conditions.wall (topic `keys`)
    prefix: Option<String>,
    /// Print the page of the book (topic `keys`)
    #[arg(long)]
    markdown: bool,
}

#[derive(Debug, Args)]
struct NewOptions {
    /// Name of the template; `impactite list templates`
    template: String,
    /// File to write [default: TEMPLATE.toml]; files that the template reads are written beside it
    file: Option<PathBuf>,
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..=1e9).contains(&x) => Ok(x),
        _ => Err("it must be a number from 0 to 1e9".into()),
    }
}

fn main() -> ExitCode {
    let options = Options::parse();
    log(&options);
    let stop = match signals() {
        Ok(stop) => stop,
        Err(error) => return refused(&error),
    };
    match perform(options.command, &stop) {
        Ok(code) => code,
        Err(CliError::Run(error @ RunError::Interrupted { .. })) => {
            eprintln!("{error}");
            ExitCode::from(130)
        }
        Err(error) => refused(&error),
    }
}

fn refused(error: &CliError) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}

/// To the standard error, by `RUST_LOG` (levels, or `target=level` separated by commas) or the options.
fn log(options: &Options) {
    use tracing_subscriber::filter::{LevelFilter, Targets};
    use tracing_subscriber::layer::{Layer, SubscriberExt};
    use tracing_subscriber::util::SubscriberInitExt;
    let level = match (options.quiet, options.verbose) {
        (true, _) => LevelFilter::WARN,
        (_, 0) => LevelFilter::INFO,
        (_, 1) => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    let filter = std::env::var("RUST_LOG").ok().and_then(|said| said.parse().ok());
    let filter = filter.unwrap_or_else(|| Targets::new().with_default(level));
    let lines = tracing_subscriber::fmt::layer().with_target(false).with_writer(std::io::stderr).compact();
    tracing_subscriber::registry().with(lines.with_filter(filter)).init();
}

/// Set by SIGINT and SIGTERM; a second one ends the program at once.
fn signals() -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [signal_hook::consts::SIGINT, signal_hook::consts::SIGTERM] {
        let wrong = |e: std::io::Error| CliError::Option { option: "signals".into(), why: e.to_string() };
        // In this order: the first one finds it false, sets it, and the second finds it true.
        signal_hook::flag::register_conditional_shutdown(signal, 130, stop.clone()).map_err(wrong)?;
        signal_hook::flag::register(signal, stop.clone()).map_err(wrong)?;
    }
    Ok(stop)
}

fn perform(command: Command, stop: &AtomicBool) -> Result<ExitCode, CliError> {
    match command {
        Command::Run(options) => {
            let job = job(&options)?;
            told(&job.run(stop)?, &job.folder, &options.how)
        }
        Command::Resume(ResumeOptions { folder, how }) => {
            let folder = if folder.is_file() {
                folder.parent().map(Path::to_path_buf).unwrap_or_default()
            } else {
                folder
            };
            let job = with(Job::resume(&folder)?, &how);
            told(&job.run(stop)?, &job.folder, &how)
        }
        Command::Check(options) => {
            let source = source(&options)?;
            let scene = source.parse()?;
            let solver = source.build(&scene)?;
            impactite_input::measured::Measures::new(&scene, &*solver)?;
            println!("{}: {}", scene.title, solver.method());
            for body in solver.bodies() {
                println!(
                    "  {}: {} points, {:.4e} kg, {}",
                    body.name(),
                    body.len(),
                    body.totals().mass,
                    body.law()
                );
            }
            Ok(ExitCode::SUCCESS)
        }
        Command::Sweep(SweepOptions { run, over }) => {
            let mut job = job(&run)?;
            // Each run has a folder; the table has the numbers.
            job.report &= !run.how.no_report;
            let points = sweep(&job, &over, stop)?;
            for point in &points {
                let keys: Vec<String> =
                    over.iter().zip(&point.values).map(|(k, v)| format!("{} = {v}", k.key)).collect();
                match &point.outcome {
                    Ok(outcome) => {
                        let list = outcome
                            .measures
                            .iter()
                            .map(|(name, value, unit)| format!("{name} {value:.5e} {unit}"));
                        println!("{}: {}", keys.join(", "), list.collect::<Vec<_>>().join(", "));
                    }
                    Err(why) => println!("{}: {why}", keys.join(", ")),
                }
            }
            println!("files in {}", job.folder.display());
            Ok(if points.iter().all(|p| p.outcome.is_ok()) { ExitCode::SUCCESS } else { ExitCode::FAILURE })
        }
        Command::List(ListOptions { topic, prefix, markdown }) => {
            let list = lists::list(topic, prefix.as_deref(), markdown);
            print!("{}", list.map_err(|why| CliError::Option { option: "list".into(), why })?);
            Ok(ExitCode::SUCCESS)
        }
        Command::New(NewOptions { template, file }) => {
            let path = file.unwrap_or_else(|| format!("{template}.toml").into());
            for other in &templates::write(&template, &path)?[1..] {
                println!("{}", other.display());
            }
            println!("{}: `impactite run {}`", path.display(), path.display());
            Ok(ExitCode::SUCCESS)
        }
        Command::Report { folder } => {
            let page = impactite_report::write_page(&folder)?;
            println!("{}", page.display());
            Ok(ExitCode::SUCCESS)
        }
        Command::Schema => {
            println!("{:#}", impactite_input::schema().to_value());
            Ok(ExitCode::SUCCESS)
        }
    }
}

fn source(options: &SceneOptions) -> Result<Source, CliError> {
    let mut source = Source::read(&options.scene)?;
    for assignment in &options.set {
        source = source.set(assignment)?;
    }
    Ok(source)
}

fn job(options: &RunOptions) -> Result<Job, CliError> {
    let source = source(&options.scene)?;
    let name = options.scene.scene.file_stem().unwrap_or_default();
    let folder = options.out.clone().unwrap_or_else(|| Path::new("out").join(name));
    if folder.join(CHECKPOINT).exists() {
        tracing::warn!(
            "`{}` has the checkpoint of a run that was stopped (`impactite resume` goes on with it); it begins anew",
            folder.display()
        );
    }
    Ok(with(Job::new(source, folder), &options.how))
}

fn with(job: Job, how: &HowOptions) -> Job {
    Job {
        threads: how.threads.map(usize::from),
        checkpoint: Duration::from_secs_f64(how.checkpoint),
        log: Duration::from_secs_f64(how.log_every),
        pictures: !how.no_pictures,
        report: !how.no_report,
        ..job
    }
}

/// The measures, the checks with the missed ones first, and the exit code: failure if a check is missed.
fn told(outcome: &Outcome, folder: &Path, how: &HowOptions) -> Result<ExitCode, CliError> {
    for (name, value, unit) in &outcome.measures {
        println!("{name}: {value:.6e} {unit}");
    }
    let mut checks: Vec<_> = outcome.checks.iter().collect();
    checks.sort_by_key(|c| c.pass != Some(false));
    for check in checks {
        let verdict = if check.pass == Some(true) { "met" } else { "MISSED" };
        let reference = check.reference.unwrap_or(f64::NAN);
        let allowed = check.tolerance.unwrap_or(0.0);
        // Of a reference of zero the difference is the value.
        let (off, allowed) = if reference == 0.0 {
            (String::new(), format!("{allowed:.1e}"))
        } else {
            (
                format!("{:+.2} %; ", 100.0 * (check.value / reference - 1.0)),
                format!("{:.1} %", 100.0 * allowed),
            )
        };
        println!(
            "{verdict}: {} {:.4e} {unit}, reference {reference:.4e} {unit} ({off}{allowed} allowed), {}",
            check.name,
            check.value,
            check.source,
            unit = check.unit,
        );
    }
    println!(
        "{} of {} checks met; {} steps of {} points in {:.2} s of stepping: {:.2} million updates a second; largest energy error {:+.2} %",
        outcome.met,
        outcome.met + outcome.missed,
        outcome.steps,
        outcome.particles,
        outcome.wall_seconds,
        1e-6 * outcome.particle_updates_per_second,
        100.0 * outcome.energy_error,
    );
    let page = folder.join("report.html");
    println!(
        "files in {}{}",
        folder.display(),
        if how.no_report { String::new() } else { format!("; look at {}", page.display()) }
    );
    if how.json {
        let json = serde_json::to_string(outcome)
            .map_err(|e| CliError::Option { option: "--json".into(), why: e.to_string() })?;
        println!("{json}");
    }
    Ok(if outcome.missed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
