//! Scenes with known answers, run with default options. Scenes of `scenes/trust` pass all their checks without a warning, unless they set
//! `only_warn`. Scenes of `scenes/public`, made from bug reports of other programs, have a line `# Verdict:` with the expected result.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Number of concurrent runs.
const AT_A_TIME: usize = 2;

/// Expected result of a scene, from its line `# Verdict:`.
enum Verdict {
    /// All checks passed, without a warning.
    Met,
    /// Run completed without a warning; the scene has no checks.
    Runs,
    /// No check failed, and a warning contains these words.
    Warned(String),
    /// Error before the first step contains these words.
    Refused(String),
    /// A check failed, for a cause stated in the line.
    Missed,
}

impl Verdict {
    fn of(text: &str) -> Self {
        let Some(verdict) = text.lines().find_map(|line| line.strip_prefix("# Verdict: ")) else {
            return Verdict::Met;
        };
        let (word, rest) = verdict.split_once(": ").unwrap_or((verdict, ""));
        match word {
            "met" => Verdict::Met,
            "runs" => Verdict::Runs,
            "warned" => Verdict::Warned(rest.into()),
            "refused" => Verdict::Refused(rest.into()),
            "missed" => Verdict::Missed,
            _ => panic!("`{verdict}` is no verdict: met, runs, warned: WORDS, refused: WORDS, missed: CAUSE"),
        }
    }
}

/// Result of a run: name, wall-clock time (s), numbers of checks passed and failed, and the output if the result is unexpected.
struct Ran {
    name: String,
    seconds: f64,
    met: u64,
    missed: u64,
    wrong: Option<String>,
}

fn run(scene: &Path, out: &Path) -> Ran {
    let name = scene.file_stem().and_then(|n| n.to_str()).unwrap_or_default().to_string();
    let begun = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_impactite"))
        .args(["run", "--json", "-q", "--threads", "1", "--set", "output.pictures=1e6"])
        .arg(scene)
        .arg("--out")
        .arg(out.join(&name))
        .output()
        .expect("the program");
    let text = String::from_utf8_lossy(&output.stdout).to_string();
    let warnings = String::from_utf8_lossy(&output.stderr).to_string();
    let result: serde_json::Value =
        serde_json::from_str(text.lines().last().unwrap_or_default()).unwrap_or_default();
    let count = |key: &str| result[key].as_u64().unwrap_or(0);
    let (met, missed) = (count("met"), count("missed"));
    let file = std::fs::read_to_string(scene).expect("a scene");
    let warns = file.contains("only_warn = true");
    let right = match Verdict::of(&file) {
        Verdict::Met => output.status.success() && met > 0 && missed == 0 && (warns || warnings.is_empty()),
        Verdict::Runs => output.status.success() && warnings.is_empty(),
        Verdict::Warned(words) => output.status.success() && missed == 0 && warnings.contains(&words),
        Verdict::Refused(words) => output.status.code() == Some(2) && warnings.contains(&words),
        Verdict::Missed => output.status.code() == Some(1) && missed > 0,
    };
    let checks = result["checks"].to_string();
    let wrong = (!right).then(|| format!("{name}: {checks}\n{warnings}"));
    Ran { name, seconds: begun.elapsed().as_secs_f64(), met, missed, wrong }
}

/// Run all scenes of a folder, and require at least `least` of them.
fn run_all(folder: &str, least: usize) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(folder);
    let out = std::env::temp_dir().join(format!("impactite-{folder}-{}", std::process::id()));
    let entries = std::fs::read_dir(&root).expect("the folder of scenes");
    let mut scenes: Vec<PathBuf> = entries
        .filter_map(|e| Some(e.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    assert!(scenes.len() >= least, "{} scenes", scenes.len());
    let (next, all) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(scene) = scenes.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let ran = run(scene, &out);
                    all.lock().expect("no thread panics").push(ran);
                }
            });
        }
    });
    let mut all = all.into_inner().expect("no thread panics");
    all.sort_by(|a, b| a.name.cmp(&b.name));
    for ran in &all {
        println!("{:40} {:5.1} s, {} met, {} missed", ran.name, ran.seconds, ran.met, ran.missed);
    }
    let wrong: Vec<&str> = all.iter().filter_map(|ran| ran.wrong.as_deref()).collect();
    assert!(wrong.is_empty(), "{} of {} scenes are wrong:\n{}", wrong.len(), all.len(), wrong.join("\n"));
    std::fs::remove_dir_all(out).expect("the folder of the runs");
}

#[test]
fn scenes_with_exact_answers_meet_them_by_default_and_without_a_warning() {
    run_all("trust", 90);
}

#[test]
fn scenes_of_public_reports_of_bugs_come_out_as_they_say() {
    run_all("public", 36);
}
