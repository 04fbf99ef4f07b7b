//! Program `impactite`.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use impactite::parallel::Team;
use impactite::scene::RunError;
use impactite_cli::converge::{Refinement, converge};
use impactite_cli::folder::CHECKPOINT;
use impactite_cli::job::seconds_a_step;
use impactite_cli::lists;
use impactite_cli::resume::{Swept, resume};
use impactite_cli::sweep::{PLAN, Point, Values, sweep};
use impactite_cli::{CliError, Job, Outcome, templates};
use impactite_input::{Source, shown};
use impactite_report::convergence::{Convergence, PAGE};
use impactite_report::{checks_passed, energy_error};

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
    /// Read a scene file, set the scene up, make its first steps, and print its size and cost
    Check(SceneOptions),
    /// Go on with a run that was stopped
    Resume(ResumeOptions),
    /// Run a scene file for each value of a key; a table and a chart of its measures
    Sweep(SweepOptions),
    /// Run a scene file at several resolutions; observed order, extrapolated value and error band of each measure
    Converge(ConvergeOptions),
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
    /// Largest number of threads, at most one per processor [default: all processors]; results are the same for any number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=Team::MOST as i64))]
    threads: Option<u16>,
    /// Wall-clock seconds between checkpoints (0: after every step)
    #[arg(long, value_name = "SECONDS", default_value_t = 300.0, value_parser = seconds)]
    checkpoint: f64,
    /// Wall-clock seconds between lines of the log
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    log_every: f64,
    /// Print the result as one JSON object on the last line; of a run that fails, its error
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct FilesOptions {
    /// No pictures, and no files for ParaView
    #[arg(long)]
    no_pictures: bool,
    /// No report.html
    #[arg(long)]
    no_report: bool,
    /// Keep the checkpoint of the end, so that `resume --set end=...` can lengthen the run
    #[arg(long)]
    keep_checkpoint: bool,
}

#[derive(Debug, Args)]
struct RunOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Folder for the files [default: out/NAME, NAME that of the scene file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    files: FilesOptions,
    #[command(flatten)]
    how: HowOptions,
}

#[derive(Debug, Args)]
struct ResumeOptions {
    /// The folder of the run, the sweep or the study of convergence, or a checkpoint
    folder: PathBuf,
    /// Change a key that no step depends on, as end="200 us"; title, description, checks
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
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
struct ConvergeOptions {
    #[command(flatten)]
    scene: SceneOptions,
    /// Folder for the files [default: out/NAME-converge, NAME that of the scene file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of levels; two have no order
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(2..=8))]
    levels: u32,
    /// Ratio of the sizes of neighbouring levels
    #[arg(long, value_name = "R", default_value_t = 2.0, value_parser = ratio)]
    ratio: f64,
    /// The scene as it is written is the finest level, and not the coarsest
    #[arg(long)]
    coarser: bool,
    /// Key to scale, as parameters.spacing; may be repeated [default: cell or spacing of the method, edges of meshes, time_step.fixed]
    #[arg(long, value_name = "KEY")]
    refine: Vec<String>,
    #[command(flatten)]
    files: FilesOptions,
    #[command(flatten)]
    how: HowOptions,
}

#[derive(Debug, Args)]
struct ListOptions {
    /// Topic; the topics if not given
    #[arg(value_parser = lists::topic_parser())]
    topic: Option<String>,
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

fn ratio(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (1.2..=10.0).contains(&x) => Ok(x),
        _ => Err("it must be a number from 1.2 to 10".into()),
    }
}

/// Exit codes: failed checks, errors, and 130 for Ctrl-C as in shells.
const CHECKS_FAILED: u8 = 1;
const ERROR: u8 = 2;
const STOPPED: u8 = 130;

fn main() -> ExitCode {
    let options = Options::parse();
    log(&options);
    let json = match &options.command {
        Command::Run(RunOptions { how, .. })
        | Command::Resume(ResumeOptions { how, .. })
        | Command::Converge(ConvergeOptions { how, .. }) => how.json,
        _ => false,
    };
    let done = Signals::new().and_then(|signals| perform(options.command, &signals));
    // Output to a closed pipe (`| head`) is no error.
    match done.and_then(|code| flush().map(|()| code)) {
        Ok(code) => code,
        Err(error) if error.is_closed_pipe() => ExitCode::SUCCESS,
        Err(error) => {
            let code = match &error {
                CliError::Run(RunError::Interrupted { .. }) => {
                    print_error(&error.to_string());
                    STOPPED
                }
                _ => {
                    print_error(&format!("error: {error}"));
                    ERROR
                }
            };
            if json {
                let _ = print_line(format_args!(
                    "{}",
                    serde_json::json!({ "error": error.to_string(), "exit_code": code })
                ));
                let _ = flush();
            }
            ExitCode::from(code)
        }
    }
}

/// Print a line to standard error; write errors are ignored.
fn print_error(line: &str) {
    let _ = writeln!(std::io::stderr(), "{}", shown(line));
}

/// Print a line for people to standard output: in words of scene files, without terminal control characters.
fn print_words(line: std::fmt::Arguments<'_>) -> Result<(), CliError> {
    print_line(format_args!("{}", shown(&line.to_string())))
}

/// Print a line to standard output.
fn print_line(line: std::fmt::Arguments<'_>) -> Result<(), CliError> {
    writeln!(std::io::stdout(), "{line}").map_err(CliError::file("standard output"))
}

fn flush() -> Result<(), CliError> {
    std::io::stdout().flush().map_err(CliError::file("standard output"))
}

/// Configure the log to standard error by `RUST_LOG` (levels, or `target=level` separated by commas) or by the options.
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
    // Colour output on terminals that support it.
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let dumb = set("TERM").is_some_and(|term| term == "dumb");
    let colours = std::io::stderr().is_terminal() && set("NO_COLOR").is_none() && !dumb;
    let lines = tracing_subscriber::fmt::layer()
        .with_target(false)
        .with_ansi(colours)
        .log_internal_errors(false)
        .with_writer(std::io::stderr)
        .compact();
    tracing_subscriber::registry().with(lines.with_filter(filter)).init();
}

/// Handling of SIGINT and SIGTERM: during set-up they end the program at once; in a run the first one stops it with a checkpoint, a second
/// one ends it at once.
struct Signals {
    stop: Arc<AtomicBool>,
    setting_up: Arc<AtomicBool>,
}

impl Signals {
    fn new() -> Result<Self, CliError> {
        use signal_hook::{consts, flag};
        let signals = Signals { stop: Arc::default(), setting_up: Arc::new(AtomicBool::new(true)) };
        let wrong = |e: std::io::Error| CliError::Option { option: "signals".into(), why: e.to_string() };
        for signal in [consts::SIGINT, consts::SIGTERM] {
            let code = i32::from(STOPPED);
            flag::register_conditional_shutdown(signal, code, signals.setting_up.clone()).map_err(wrong)?;
            // Order matters: on the first signal the conditional shutdown finds `stop` false, then `stop` is set; the second signal finds
            // it true.
            flag::register_conditional_shutdown(signal, code, signals.stop.clone()).map_err(wrong)?;
            flag::register(signal, signals.stop.clone()).map_err(wrong)?;
        }
        // With a handler, exceeding the file size limit fails the write with an error instead of ending the program.
        #[cfg(unix)]
        flag::register(consts::SIGXFSZ, Arc::default()).map_err(wrong)?;
        Ok(signals)
    }
}

fn perform(command: Command, signals: &Signals) -> Result<ExitCode, CliError> {
    let stop = &*signals.stop;
    match command {
        Command::Run(options) => {
            let job = job(&options, signals)?;
            print_outcome(&job.run(stop)?, &job, &options.how)
        }
        Command::Resume(ResumeOptions { folder, set, how }) => {
            let folder = if folder.is_file() {
                if folder.file_name().is_none_or(|name| name != CHECKPOINT) {
                    let name = Path::new("out").join(folder.file_stem().unwrap_or_default());
                    let why = format!(
                        "it is a file; give the folder of a run, as `impactite resume {}`",
                        name.display()
                    );
                    return Err(CliError::NoResume { path: folder, why });
                }
                folder.parent().map(Path::to_path_buf).unwrap_or_default()
            } else {
                folder
            };
            if folder.join(PLAN).exists() && set.is_empty() {
                let swept = resume(&folder, |job| with(job, &how, signals), stop)?;
                return match swept {
                    Swept::Values(points) => print_sweep(&points, &folder),
                    Swept::Levels(study) => print_convergence(&study, &folder, how.json),
                };
            }
            let job = with(Job::resume(&folder)?, &how, signals).set(&set)?;
            print_outcome(&job.run(stop)?, &job, &how)
        }
        Command::Check(options) => {
            let source = source(&options)?;
            let scene = source.parse()?;
            let mut solver = source.build(&scene)?;
            impactite_input::measured::Measures::new(&source, &scene, &*solver)?;
            let ahead = source.estimate(&scene, &mut *solver)?;
            print_words(format_args!("{}: {}", scene.title, solver.method()))?;
            // The first steps detect errors that only a step finds, and measure the time per step.
            let team = Team::new(std::thread::available_parallelism().map_or(1, usize::from).min(Team::MOST));
            solver.set_team(
                team.map_err(|e| CliError::Option { option: "threads".into(), why: e.to_string() })?,
            );
            let seconds = seconds_a_step(&mut *solver, scene.end.value)?;
            for line in ahead.lines(seconds) {
                print_words(format_args!("  {line}"))?;
            }
            Ok(ExitCode::SUCCESS)
        }
        Command::Sweep(SweepOptions { run, over }) => {
            let job = job(&run, signals)?;
            print_sweep(&sweep(&job, &over, stop)?, &job.folder)
        }
        Command::Converge(ConvergeOptions { scene, out, levels, ratio, coarser, refine, files, how }) => {
            let name = scene.scene.file_stem().unwrap_or_default().to_string_lossy();
            let out = out.unwrap_or_else(|| Path::new("out").join(format!("{name}-converge")));
            let json = how.json;
            let job = job(&RunOptions { scene, out: Some(out), files, how }, signals)?;
            let refinement = Refinement { levels, ratio, coarser, keys: refine };
            print_convergence(&converge(&job, &refinement, stop)?, &job.folder, json)
        }
        Command::List(ListOptions { topic, prefix, markdown }) => {
            let list = lists::list(topic.as_deref(), prefix.as_deref(), markdown);
            let list = list.map_err(|why| CliError::Option { option: "list".into(), why })?;
            print_line(format_args!("{}", list.trim_end_matches('\n')))?;
            Ok(ExitCode::SUCCESS)
        }
        Command::New(NewOptions { template, file }) => {
            let path = file.unwrap_or_else(|| format!("{template}.toml").into());
            for other in &templates::write(&template, &path)?[1..] {
                print_words(format_args!("{}", other.display()))?;
            }
            print_words(format_args!("{}: `impactite run {}`", path.display(), path.display()))?;
            Ok(ExitCode::SUCCESS)
        }
        Command::Report { folder } => {
            let page = impactite_report::write_page(&folder)?;
            print_words(format_args!("{}", page.display()))?;
            Ok(ExitCode::SUCCESS)
        }
        Command::Schema => {
            print_line(format_args!("{:#}", impactite_input::schema().to_value()))?;
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

fn job(options: &RunOptions, signals: &Signals) -> Result<Job, CliError> {
    let source = source(&options.scene)?;
    let name = options.scene.scene.file_stem().unwrap_or_default();
    let folder = options.out.clone().unwrap_or_else(|| Path::new("out").join(name));
    if folder.join(CHECKPOINT).exists() {
        tracing::warn!(
            "`{}` has the checkpoint of a run that was stopped (`impactite resume` goes on with it); it begins anew",
            folder.display()
        );
    }
    let files = &options.files;
    let job = Job {
        pictures: !files.no_pictures,
        report: !files.no_report,
        keep_checkpoint: files.keep_checkpoint,
        ..Job::new(source, folder)
    };
    Ok(with(job, &options.how, signals))
}

fn with(job: Job, how: &HowOptions, signals: &Signals) -> Job {
    Job {
        threads: how.threads.map(usize::from),
        checkpoint: Duration::from_secs_f64(how.checkpoint),
        log: Duration::from_secs_f64(how.log_every),
        setting_up: signals.setting_up.clone(),
        ..job
    }
}

/// Print the measures of each run of a sweep.
fn print_sweep(points: &[Point], folder: &Path) -> Result<ExitCode, CliError> {
    for point in points {
        let values = point.values.join(", ");
        match &point.outcome {
            Ok(outcome) => {
                let list = outcome.measures.iter().map(|measured| format!("{} {measured:.5}", measured.0));
                print_words(format_args!("{values}: {}", list.collect::<Vec<_>>().join(", ")))?;
            }
            Err(why) => print_words(format_args!("{values}: failed: {why}"))?,
        }
    }
    print_words(format_args!("files in {}", folder.display()))?;
    Ok(if points.iter().all(|p| p.outcome.is_ok()) { ExitCode::SUCCESS } else { ExitCode::from(ERROR) })
}

/// Print the table of a convergence study with its checks. Return the exit code: failure if a run or a check of the finest level failed.
fn print_convergence(study: &Convergence, folder: &Path, json: bool) -> Result<ExitCode, CliError> {
    for line in study.lines() {
        print_words(format_args!("{line}"))?;
    }
    let page = folder.join(PAGE);
    let look = if page.is_file() { format!("; look at {}", page.display()) } else { String::new() };
    print_words(format_args!("files in {}{look}", folder.display()))?;
    if json {
        print_json(study)?;
    }
    Ok(if study.levels.iter().any(|level| level.error.is_some()) {
        ExitCode::from(ERROR)
    } else if study.checks.iter().any(|judged| judged.check.pass == Some(false)) {
        ExitCode::from(CHECKS_FAILED)
    } else {
        ExitCode::SUCCESS
    })
}

/// Print the JSON object of `--json` on one line.
fn print_json(result: &impl serde::Serialize) -> Result<(), CliError> {
    let json = serde_json::to_string(result)
        .map_err(|e| CliError::Option { option: "--json".into(), why: e.to_string() })?;
    print_line(format_args!("{json}"))
}

/// Print the measures and the checks, failed ones first. Return the exit code: failure if a check failed.
fn print_outcome(outcome: &Outcome, job: &Job, how: &HowOptions) -> Result<ExitCode, CliError> {
    for measured in &outcome.measures {
        print_words(format_args!("{}: {measured:.6}", measured.0))?;
    }
    let mut checks: Vec<_> = outcome.checks.iter().collect();
    checks.sort_by_key(|c| c.pass != Some(false));
    for check in checks {
        let verdict = if check.pass == Some(true) { "passed" } else { "FAILED" };
        let reference = check.reference.unwrap_or(f64::NAN);
        let allowed = check.tolerance.unwrap_or(0.0);
        // Absolute difference for a reference of zero.
        let (off, allowed) = if reference == 0.0 {
            (String::new(), format!("{allowed:.1e}"))
        } else {
            (
                format!("{:+.2} %; ", 100.0 * (check.value / reference - 1.0)),
                format!("{:.1} %", 100.0 * allowed),
            )
        };
        print_words(format_args!(
            "{verdict}: {} {:.4e} {unit}, reference {reference:.4e} {unit} ({off}{allowed} allowed), {}",
            check.name,
            check.value,
            check.source,
            unit = check.unit,
        ))?;
    }
    print_words(format_args!(
        "{}; {} steps of {} points in {:.2} s of stepping: {:.2} million updates a second; largest energy error {}",
        checks_passed([outcome.met, outcome.met + outcome.missed]),
        outcome.steps,
        outcome.particles,
        outcome.wall_seconds,
        1e-6 * outcome.particle_updates_per_second,
        energy_error(Some(outcome.energy_error).filter(|error| !error.is_nan())),
    ))?;
    let page = job.folder.join("report.html");
    print_words(format_args!(
        "files in {}{}",
        job.folder.display(),
        if job.report { format!("; look at {}", page.display()) } else { String::new() }
    ))?;
    if how.json {
        print_json(outcome)?;
    }
    Ok(if outcome.missed == 0 { ExitCode::SUCCESS } else { ExitCode::from(CHECKS_FAILED) })
}
