//! Whole commands: the program with the scene files of the repository, including all output.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use examples::CaseError;
use examples::throughput::Spread;

use crate::page::table;
use crate::sample::{Sample, Subject, attempt};

const SCENES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes");

/// Scenes of the table of threads: name, file below `scenes`, and what is set in it.
const SIZES: [(&str, &str, &[&str]); 10] = [
    ("Taylor bar, 5 cells on the radius", "taylor_bar.toml", &["parameters.cells=5"]),
    ("Taylor bar, 10 cells", "taylor_bar.toml", &[]),
    ("Taylor bar, 20 cells", "taylor_bar.toml", &["parameters.cells=20", "end=10 us"]),
    ("29 bodies in contact", "pressed_balls.toml", &[]),
    (
        "1001 bodies in contact",
        "pressed_balls.toml",
        &["parameters.balls=10", "bodies.ball.repeat.counts=[10,10,10]", "end=4 us"],
    ),
    ("rod and plate in contact", "oblique_penetration.toml", &[]),
    ("finite elements", "templates/fem_bar.toml", &["parameters.elements=50", "end=10 us"]),
    ("smoothed particles", "templates/sph_bars.toml", &["parameters.particles=40"]),
    ("fragile points", "templates/fpm_spall.toml", &["parameters.cells=40"]),
    ("particle contact", "elastic_bar.toml", &[]),
];

/// Output of runs whose steps alone are measured.
const QUIET: [&str; 3] = ["output.histories=1 s", "output.pictures=1 s", "output.frames=1 s"];

/// Measured run of a scene file.
struct Ran {
    /// Wall-clock times of the command, of its start and of its steps, s.
    wall: f64,
    start: f64,
    steps: f64,
    /// Times of stages of the steps, by name, s.
    stages: BTreeMap<String, f64>,
    /// Number of point updates.
    updates: f64,
    /// Final number of points.
    points: f64,
    /// Peak memory, bytes.
    bytes: f64,
}

fn run(
    program: &Path,
    (scene, set): (&Path, &[&str]),
    threads: usize,
    folder: &Path,
) -> Result<Ran, CaseError> {
    // Delete old results, which a program that refuses the scene would leave in place.
    let path = folder.join("result.json");
    let _ = std::fs::remove_file(&path);
    let start = Instant::now();
    let mut command = Command::new(program);
    command.arg("run").arg(scene).args(["--threads", &threads.to_string(), "--out"]).arg(folder);
    set.iter().for_each(|set| {
        command.args(["--set", set]);
    });
    let done = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map_err(|source| CaseError::File { path: program.into(), source })?;
    let wall = start.elapsed().as_secs_f64();
    // A failed check also sets the exit status; the result file is decisive.
    let failed = |why: String| CaseError::Other(format!("{}: {why}", scene.display()));
    let text = std::fs::read_to_string(&path).map_err(|_| failed(format!("no result, {done}")))?;
    let said: serde_json::Value = serde_json::from_str(&text).map_err(|e| failed(e.to_string()))?;
    let number = |key: &str| said[key].as_f64().ok_or_else(|| failed(format!("no number `{key}`")));
    let steps = number("wall_seconds")?;
    let record = std::fs::read_to_string(folder.join("run.json")).unwrap_or_default();
    let record: serde_json::Value = serde_json::from_str(&record).unwrap_or_default();
    let start = record["timing"]["setup"].as_f64().unwrap_or(f64::NAN);
    let updates = number("particle_updates_per_second")? * steps;
    let stages: Vec<(String, f64)> =
        serde_json::from_value(record["timing"]["stages"].clone()).unwrap_or_default();
    Ok(Ran {
        wall,
        start,
        steps,
        stages: stages.into_iter().collect(),
        updates,
        points: number("particles")?,
        bytes: number("peak_memory_bytes")?,
    })
}

/// List the scene files by name.
fn scenes() -> Result<Vec<PathBuf>, CaseError> {
    let failed = |source| CaseError::File { path: SCENES.into(), source };
    let mut list = Vec::new();
    for entry in std::fs::read_dir(SCENES).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e == "toml") {
            list.push(path);
        }
    }
    list.sort();
    Ok(list)
}

/// Measure time, share of steps and memory of every scene file on one and two threads, compared with an earlier
/// program.
pub fn cost(
    quick: bool,
    program: Option<&Path>,
    previous: Option<&Path>,
) -> Result<Option<String>, CaseError> {
    let Some(program) = program else {
        eprintln!("without --program there is nothing to run");
        return Ok(None);
    };
    let folder = std::env::temp_dir().join(format!("impactite-runs-{}", std::process::id()));
    let (mut rows, mut of_stages, mut all) = (Vec::new(), Vec::new(), [[0.0; 2]; 4]);
    for scene in scenes()? {
        let name = scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        for threads in [1, 2] {
            let subject = |name: &str, program: PathBuf| {
                let (scene, folder) = (&scene, &folder);
                Subject::new(name, move || run(&program, (scene, &[]), threads, folder))
            };
            let mut subjects = vec![subject("now", program.into())];
            subjects.extend(previous.map(|previous| subject("before", previous.into())));
            let samples = attempt(&subjects, if quick { 1 } else { 3 });
            let [now, before] = [samples.first(), samples.get(1)];
            let Some(now) = now.filter(|s| s.failure.is_none()) else {
                eprintln!("{name}: {}", now.and_then(|s| s.failure.clone()).unwrap_or_default());
                continue;
            };
            let before = before.filter(|s| s.failure.is_none());
            let of = |sample: Option<&Sample<Ran>>, number: fn(&Ran) -> f64| sample.map(|s| s.spread(number));
            let text = |spread: Option<Spread>| spread.map_or("-".into(), |s| s.text(2));
            let (wall, steps) = (now.spread(|r| r.wall), now.spread(|r| r.steps));
            let (wall_before, steps_before) = (of(before, |r| r.wall), of(before, |r| r.steps));
            // Sums are over scenes that both programs run.
            if previous.is_none() || before.is_some() {
                let spreads = [Some(&wall), Some(&steps), wall_before.as_ref(), steps_before.as_ref()];
                for (sum, spread) in all.iter_mut().zip(spreads) {
                    sum[threads - 1] += spread.map_or(0.0, |s| s.median);
                }
            }
            of_stages.extend(shares(&name, threads, now));
            rows.push([
                name.clone(),
                format!("{:.0} x {:.0}", now.first().points, now.first().updates / now.first().points),
                threads.to_string(),
                text(wall_before),
                wall.text(2),
                format!("{:.2}", now.spread(|r| r.start).median),
                text(steps_before),
                steps.text(2),
                format!("{:.2}", steps.median / wall.median),
                now.spread(|r| 1e-6 * r.updates / r.steps).text(2),
                format!("{:.0}", 1e-6 * now.spread(|r| r.bytes).median),
            ]);
        }
    }
    for threads in [1, 2] {
        let [wall, steps, wall_before, steps_before] = all.map(|sum| sum[threads - 1]);
        let before = |sum: f64| if previous.is_some() { format!("{sum:.1}") } else { "-".into() };
        rows.push([
            if previous.is_some() { "all that both run" } else { "all" }.into(),
            String::new(),
            threads.to_string(),
            before(wall_before),
            format!("{wall:.1}"),
            String::new(),
            before(steps_before),
            format!("{steps:.1}"),
            format!("{:.2}", steps / wall),
            String::new(),
            String::new(),
        ]);
    }
    let title = [
        "scene",
        "points x steps",
        "threads",
        "command before, s",
        "command, s",
        "of it start, s",
        "steps before, s",
        "steps, s",
        "share of steps",
        "10^6 updates a second",
        "memory, MB",
    ];
    let of_threads = threads(quick, program, previous, &folder)?;
    let _ = std::fs::remove_dir_all(&folder);
    Ok(Some(format!(
        "## Whole commands\n\n`impactite run` on the scene files of `scenes/` with default options: pictures, frames, histories and page are made. Seconds of the \
         whole command and of its steps; medians with least and most of rounds in alternation with the program of an earlier commit. With two threads pictures are \
         drawn and frames written by one of them while the run goes on.\n\n{}\n\nShares of the stages of steps of the material point method, in the same runs:\n\n{}\n\n{}",
        table(title, &rows),
        table(
            ["scene", "threads", "steps, s", "particles", "contact", "arrangement", "nodes and conditions"],
            &of_stages
        ),
        of_threads
    )))
}

/// Return the row of a scene in the table of stages, if its method measures them.
fn shares(name: &str, threads: usize, runs: &Sample<Ran>) -> Option<[String; 7]> {
    let share = |stage: &str| {
        let of = |run: &Ran| run.stages.get(stage).copied().unwrap_or(0.0) / run.steps;
        runs.spread(of).median
    };
    let steps = runs.spread(|run| run.steps).median;
    let [particles, contact, arrangement] = ["particles", "contact", "arrangement"].map(share);
    let rest = 1.0 - particles - contact - arrangement;
    (!runs.first().stages.is_empty()).then(|| {
        let texts = [particles, contact, arrangement, rest].map(|share| format!("{share:.2}"));
        let [particles, contact, arrangement, rest] = texts;
        [name.into(), threads.to_string(), format!("{steps:.2}"), particles, contact, arrangement, rest]
    })
}

/// Measure steps on one and two threads without pictures and frames.
fn threads(quick: bool, program: &Path, previous: Option<&Path>, folder: &Path) -> Result<String, CaseError> {
    let mut rows = Vec::new();
    for (name, file, set) in SIZES {
        let scene = Path::new(SCENES).join(file);
        let set: Vec<&str> = set.iter().copied().chain(QUIET).collect();
        let of = |program: &Path, threads: usize| {
            let (program, scene, set) = (program.to_path_buf(), &scene, &set);
            move || run(&program, (scene, set), threads, folder)
        };
        let mut subjects: Vec<Subject<'_, Ran>> =
            [1, 2].map(|t| Subject::new(format!("now {t}"), of(program, t))).into();
        let of_before = |program| [1, 2].map(|t| Subject::new(format!("before {t}"), of(program, t)));
        subjects.extend(previous.into_iter().flat_map(of_before));
        let samples = attempt(&subjects, if quick { 1 } else { 3 });
        if let Some(failure) = samples.iter().find_map(|s| s.failure.clone()) {
            eprintln!("{name}: {failure}");
            continue;
        }
        let nanoseconds = |s: &Sample<Ran>| s.spread(|r| 1e9 * r.steps / r.updates);
        let times: Vec<Spread> = samples.iter().map(nanoseconds).collect();
        let gain = |one: usize| match times.get(one..one + 2) {
            Some([one, two]) => format!("{:.2}", one.median / two.median),
            _ => "-".into(),
        };
        let text = |n: usize| times.get(n).map_or("-".into(), |t| t.text(0));
        let points = format!("{:.0}", samples[0].first().points);
        rows.push([name.into(), points, text(2), text(0), text(3), text(1), gain(2), gain(0)]);
    }
    let title = [
        "scene",
        "points",
        "1 thread before",
        "1 thread",
        "2 threads before",
        "2 threads",
        "gain before",
        "gain",
    ];
    Ok(format!(
        "Nanoseconds of steps a point and step, and the gain of the second thread:\n\n{}",
        table(title, &rows)
    ))
}
