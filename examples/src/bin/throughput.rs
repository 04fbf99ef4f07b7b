//! Throughput: particle updates per second on fixed scenes, one JSON line per run, and the ratio to a reference program (yardstick) of
//! hand-written kernels, run in alternation.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use clap::{Parser, ValueEnum};
use examples::{CaseError, Check, Report, Resolution, Totals, case};

use examples::throughput::{self, Job, Kernel, Measured, Spread, Way};
use mpm_core::Team;

/// Particle updates a second on fixed scenes: a cube with a smooth velocity field (S1) and a copper cylinder on
/// a wall (S2). Prints one JSON line a run.
///
/// Timed are the steps alone, with all migration of particles; not the building of the scene.
#[derive(Debug, Parser)]
#[command(name = "throughput", version)]
struct Options {
    /// How much: smoke takes a second, standard runs 30k and 200k particles, paper 2M too
    #[arg(long, value_enum, default_value = "standard")]
    resolution: Resolution,
    /// Kernels, separated by commas [default: all]
    #[arg(long, value_enum, value_delimiter = ',')]
    kernel: Vec<Kernel>,
    /// Numbers of particles, separated by commas [default: by resolution]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u64).range(64..=50_000_000))]
    particles: Vec<u64>,
    /// Numbers of threads, separated by commas [default: 1,2]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=Team::MOST as i64))]
    threads: Vec<u16>,
    /// Steps a run [default: 30 million particle updates, 30 to 200 steps]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    steps: Option<u64>,
    /// Runs of each kind [default: 1, or 5 with --against]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeat: Option<u16>,
    /// Precision of particles and nodes
    #[arg(long, value_enum, default_value = "f64")]
    precision: Precision,
    /// A built yardstick to compare with: run before each of our runs, so that both see the same machine
    #[arg(long, value_name = "PROGRAM", conflicts_with = "before")]
    against: Option<PathBuf>,
    /// A build of this program at another commit to compare with, in the same way
    #[arg(long, value_name = "PROGRAM")]
    before: Option<PathBuf>,
    /// How passes reach the law of their particles
    #[arg(long, value_enum, default_value = "called")]
    way: Way,
    /// Folder for the result
    #[arg(long, value_name = "DIR", default_value = "out/throughput")]
    out: PathBuf,
    /// Print the result as one JSON object on the last line
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Precision {
    /// Double
    F64,
    /// Single
    F32,
}

/// Minimum update rate over the yardstick's; the minimum over a build at another commit is 0.90 by call and 0.95 inlined.
const LEAST_RATIO: f64 = 0.5;
/// Largest allowed memory per particle over the yardstick's.
const MOST_BYTES: f64 = 1.3;

/// Runs of one kind.
struct Sample {
    ours: Vec<Measured>,
    /// Yardstick: updates per second, and bytes per particle.
    theirs: Vec<(f64, f64)>,
}

fn main() -> ExitCode {
    case::start(run)
}

impl Options {
    fn jobs(&self) -> Vec<Job> {
        let or =
            |given: &[u64], default: &[u64]| if given.is_empty() { default.to_vec() } else { given.to_vec() };
        let sizes: &[u64] =
            self.resolution.choose(&[6_000], &[30_000, 200_000], &[30_000, 200_000, 2_000_000]);
        let threads: Vec<u64> = self.threads.iter().map(|t| u64::from(*t)).collect();
        let kernels = if self.kernel.is_empty() { Kernel::value_variants() } else { &self.kernel };
        let mut jobs = Vec::new();
        for &kernel in kernels {
            for n in or(&self.particles, sizes) {
                let most = if self.resolution == Resolution::Smoke { 20 } else { 200 };
                let steps = self.steps.unwrap_or((30_000_000 / n).clamp(30, 200).min(most));
                for threads in or(&threads, &[1, 2]) {
                    let [particles, threads] = [n, threads].map(|n| n as usize);
                    jobs.push(Job { kernel, particles, threads, steps, way: self.way });
                }
            }
        }
        jobs
    }

    fn repeat(&self) -> u16 {
        self.repeat.unwrap_or(if self.other().is_some() { 5 } else { 1 })
    }

    /// Return the program for comparison, and its kind.
    fn other(&self) -> Option<(&Path, &'static str)> {
        let yardstick = self.against.as_deref().map(|program| (program, "yardstick"));
        yardstick.or(self.before.as_deref().map(|program| (program, "before")))
    }

    /// Return the minimum ratio of our update rate to that of the other program.
    fn least_ratio(&self) -> f64 {
        match (&self.before, self.way) {
            (None, _) => LEAST_RATIO,
            (Some(_), Way::Called) => 0.90,
            (Some(_), Way::Inlined) => 0.95,
        }
    }

    fn measure(&self, job: &Job) -> Result<Measured, CaseError> {
        match self.precision {
            Precision::F64 => throughput::measure::<f64>(job),
            #[cfg(feature = "single")]
            Precision::F32 => throughput::measure::<f32>(job),
            #[cfg(not(feature = "single"))]
            Precision::F32 => {
                let how = "--precision f32: build with `--features single`, which compiles kernels in single precision";
                Err(CaseError::Other(how.into()))
            }
        }
    }
}

fn run(options: &Options) -> Result<ExitCode, CaseError> {
    std::fs::create_dir_all(&options.out)
        .map_err(|source| CaseError::File { path: options.out.clone(), source })?;
    let mut samples = Vec::new();
    for job in options.jobs() {
        let mut sample = Sample { ours: Vec::new(), theirs: Vec::new() };
        for _ in 0..options.repeat() {
            if let Some(program) = &options.against {
                sample.theirs.push(yardstick(program, &job, options.precision)?);
            }
            if let Some(program) = &options.before {
                sample.theirs.push(earlier(program, &job, options)?);
            }
            let measured = options.measure(&job)?;
            println!("{}", serde_json::to_string(&measured)?);
            sample.ours.push(measured);
        }
        samples.push(sample);
    }
    if let Some((_, other)) = options.other() {
        println!("\nMillion particle updates a second: median [least - most] of {}\n", options.repeat());
        println!("{}", table(&samples, other));
        let mean = samples.iter().map(|s| s.ratio().ln()).sum::<f64>() / samples.len() as f64;
        println!("Geometric mean of the ratios: {:.3}\n", mean.exp());
    }
    report(options, &samples).finish_in(options.json, &options.out)
}

/// Run the yardstick once. Return updates per second and bytes per particle.
fn yardstick(program: &Path, job: &Job, precision: Precision) -> Result<(f64, f64), CaseError> {
    let kernel = match (job.kernel, precision) {
        (Kernel::LinearMuslElastic, Precision::F64) => "K1",
        (Kernel::LinearMuslJohnsonCook, Precision::F64) => "K2",
        (Kernel::QuadraticApicUsl, Precision::F64) => "K3",
        (Kernel::QuadraticApicUsl, Precision::F32) => "K3f",
        (kernel, Precision::F32) => {
            let name = kernel.name();
            return Err(CaseError::Other(format!("--against: the yardstick has no {name} in f32")));
        }
    };
    let found = throughput::hand_written(program, kernel, job.kernel.scene(), job)?;
    println!("{found}");
    let number = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
    Ok((number("particle_updates_per_second"), number("bytes_per_particle")))
}

/// Run a build of this program at another commit once, on the same job.
fn earlier(program: &Path, job: &Job, options: &Options) -> Result<(f64, f64), CaseError> {
    let [particles, threads] = [job.particles, job.threads].map(|n| n.to_string());
    let kernel = job.kernel.to_possible_value().map(|v| v.get_name().to_string()).unwrap_or_default();
    let precision = format!("{:?}", options.precision).to_lowercase();
    let found = throughput::printed(
        Command::new(program)
            .args(["--kernel", &kernel, "--particles", &particles, "--threads", &threads])
            .args(["--steps", &job.steps.to_string(), "--precision", &precision, "--json", "--out"])
            .arg(options.out.join("before")),
    )?;
    let run = &found["settings"]["runs"][0];
    println!("{run}");
    let number = |key: &str| run[key].as_f64().unwrap_or(f64::NAN);
    Ok((number("particle_updates_per_second"), number("bytes_per_particle")))
}

impl Sample {
    fn ours(&self) -> Spread {
        Spread::of(self.ours.iter().map(|m| 1e-6 * m.particle_updates_per_second))
    }
    fn theirs(&self) -> Spread {
        Spread::of(self.theirs.iter().map(|t| 1e-6 * t.0))
    }
    fn ratio(&self) -> f64 {
        self.ours().median / self.theirs().median
    }
}

fn table(samples: &[Sample], other: &str) -> String {
    let head = ["kernel", "particles", "threads", "impactite", other, "ratio", "bytes", "other bytes"];
    let mut rows = vec![head.map(String::from)];
    for s in samples {
        let (Some(m), Some(y)) = (s.ours.first(), s.theirs.first()) else { continue };
        rows.push([
            m.kernel.clone(),
            m.particles.to_string(),
            m.threads.to_string(),
            s.ours().text(1),
            s.theirs().text(1),
            format!("{:.2}", s.ratio()),
            m.bytes_per_particle.to_string(),
            format!("{:.0}", y.1),
        ]);
    }
    case::columns(&rows)
}

fn report(options: &Options, samples: &[Sample]) -> Report {
    let mut totals = Totals::default();
    let mut checks = Vec::new();
    for sample in samples {
        for m in &sample.ours {
            totals = totals.plus(&totals_of(m));
        }
        checks.extend(checks_of(options, sample));
    }
    let settings = serde_json::json!({
        "precision": format!("{:?}", options.precision).to_lowercase(),
        "repeat": options.repeat(),
        "way": format!("{:?}", options.way).to_lowercase(),
        "against": options.other().map(|(p, _)| p.display().to_string()),
        "runs": samples.iter().flat_map(|s| &s.ours).collect::<Vec<_>>(),
        "yardstick": samples.iter().map(|s| s.theirs.iter().map(|t| t.0).collect()).collect::<Vec<Vec<f64>>>(),
    });
    Report::new("throughput", options.resolution, settings, &totals, checks)
}

fn totals_of(m: &Measured) -> Totals {
    Totals {
        particles: m.particles,
        steps: m.steps,
        simulated_seconds: 0.0,
        wall_seconds: m.seconds,
        updates: m.particles as f64 * m.steps as f64,
        bytes: (m.total_bytes_per_particle * m.particles as f64) as usize,
        energy_error: m.energy_drift,
        momentum_error: m.momentum_drift,
    }
}

/// Check the momentum of each run, and speed and memory against the yardstick, if present.
fn checks_of(options: &Options, sample: &Sample) -> Vec<Check> {
    let Some(m) = sample.ours.first() else { return Vec::new() };
    let name = |what: &str| format!("{} {} x{}: {what}", m.kernel, m.particles, m.threads);
    let worst = examples::worst(sample.ours.iter().map(|m| m.momentum_drift));
    let tolerance = if options.precision == Precision::F64 { 1e-12 } else { 1e-4 };
    let mut checks = vec![Check::gate(name("momentum drift"), worst, "-", 0.0, tolerance, "conservation")];
    if let Some(theirs) = sample.theirs.first() {
        let bytes = m.bytes_per_particle as f64 / theirs.1;
        checks.push(Check::at_least(
            name("rate ratio"),
            sample.ratio(),
            "-",
            options.least_ratio(),
            "other program",
        ));
        checks.push(Check::at_most(name("bytes ratio"), bytes, "-", MOST_BYTES, "other program"));
    }
    checks
}
