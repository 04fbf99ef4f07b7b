//! Restart of cases: a case that is killed at any moment and resumed from its last checkpoint leaves the output of an
//! uninterrupted run, byte for byte. Checkpoints that cannot be resumed from are refused with the reason.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, SystemTime};

use serde_json::Value;

/// Case small enough to write a checkpoint after every step.
#[derive(Clone, Copy)]
struct Case {
    name: &'static str,
    program: &'static str,
    options: &'static [&'static str],
}

/// MPM: a hundred segments with notes, snapshots, frames for ParaView and a ledger; three simulations.
const COLUMN: Case = Case {
    name: "granular_column",
    program: env!("CARGO_BIN_EXE_granular_column"),
    options: &["--cells", "6,7", "--aspect", "0.5", "--end", "3", "--frames"],
};
/// Particle-contact method: two bodies, segments with snapshots, an observer of the case.
const BULLET: Case = Case {
    name: "tungsten_bullet",
    program: env!("CARGO_BIN_EXE_tungsten_bullet"),
    options: &["--method", "pcmm", "--space", "plane-strain", "--refine", "0.2"],
};
/// Particle-contact method: a single body, histories and frames; two simulations.
const BAR: Case =
    Case { name: "elastic_bar", program: env!("CARGO_BIN_EXE_elastic_bar"), options: &["--cells", "3"] };
/// SPH: a body on a wall of mirror images, and one on a wall; histories and frames; two simulations.
const STEEL: Case = Case {
    name: "taylor_4340",
    program: env!("CARGO_BIN_EXE_taylor_4340"),
    options: &["--cells", "4", "--speed", "224", "--form", "printed,total"],
};

/// Incompressible flow: segments with snapshots, histories and frames; four simulations.
const DAM: Case = Case {
    name: "dam_break",
    program: env!("CARGO_BIN_EXE_dam_break"),
    options: &["--study", "release,column", "--aspect", "1", "--cells", "10", "--frames"],
};

/// Create an empty folder.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("impactite-resume-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

impl Case {
    fn command(&self, out: &Path, more: &[&str]) -> Command {
        let mut command = Command::new(self.program);
        command.args(["--resolution", "smoke", "--json"]).args(self.options).args(more);
        command.arg("--out").arg(out);
        command
    }

    fn run(&self, out: &Path, more: &[&str]) -> Output {
        self.command(out, more).output().expect("it starts")
    }

    /// Kill the case a short delay after so many checkpoints have been seen, at an arbitrary moment of a step. Return true
    /// if it was killed before its end.
    fn killed(&self, out: &Path, checkpoints: u64, delay: Duration) -> bool {
        let mut child = self
            .command(out, &["--checkpoint", "0", "--threads", "1"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        let (mut seen, mut last) = (0, None);
        while seen < checkpoints {
            if child.try_wait().expect("its state").is_some() {
                return false;
            }
            let now = newest(out);
            if now > last {
                (seen, last) = (seen + 1, now);
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        std::thread::sleep(delay);
        // SIGKILL on systems with signals.
        child.kill().expect("killed");
        !child.wait().expect("its state").success()
    }
}

/// Return the latest checkpoint and its time of modification.
fn newest(out: &Path) -> Option<(SystemTime, PathBuf)> {
    let of = |path: PathBuf| Some((path.metadata().ok()?.modified().ok()?, path));
    let files = std::fs::read_dir(out).ok()?.flatten().map(|entry| entry.path());
    files.filter(|path| path.extension().is_some_and(|e| e == "checkpoint")).filter_map(of).max()
}

/// Parse the object on the last line, without entries that depend on time, memory and threads.
fn result(output: &Output) -> Value {
    let text = String::from_utf8_lossy(&output.stdout);
    let last = text.lines().next_back().unwrap_or_else(|| panic!("{}", errors(output)));
    let mut value: Value = serde_json::from_str(last).unwrap_or_else(|_| panic!("{}", errors(output)));
    let object = value.as_object_mut().expect("an object");
    for key in ["wall_seconds", "particle_updates_per_second", "peak_memory_bytes"] {
        assert!(object.remove(key).is_some(), "{key}");
    }
    let settings = object["settings"].as_object_mut().expect("settings");
    settings.retain(|key, _| !["core_seconds", "stepping_seconds", "threads"].contains(&key.as_str()));
    for run in settings.get_mut("runs").and_then(Value::as_array_mut).into_iter().flatten() {
        run.as_object_mut().map(|run| run.remove("threads"));
    }
    value
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Read all output files of a case by name, without the result and the checkpoints.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(inner) = folders.pop() {
        for path in std::fs::read_dir(inner).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| ["csv", "png", "vtp", "pvd"].iter().any(|x| e == *x)) {
                let name = path.strip_prefix(folder).expect("inside").to_path_buf();
                all.insert(name, std::fs::read(path).expect("a file"));
            }
        }
    }
    all
}

/// Return a pseudo-random number below `end` from a seed.
fn random(seed: u64, end: u64) -> u64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) % end
}

/// Kill and resume a case, and compare with an uninterrupted run.
fn comes_back(case: Case, kills: u64) {
    let (whole, killed, resumed) = (
        folder(&format!("{}-whole", case.name)),
        folder(&format!("{}-killed", case.name)),
        folder(&format!("{}-resumed", case.name)),
    );
    let output = case.run(&whole, &["--threads", "1"]);
    assert!(newest(&whole).is_none(), "no checkpoint is due within five minutes");
    let (wanted, left) = (result(&output), files(&whole));
    let steps = wanted["steps"].as_u64().expect("steps");
    let suffix = |end: &str| left.keys().any(|name| name.extension().is_some_and(|e| e == end));
    assert!(["csv", "png"].iter().all(|end| suffix(end)), "{:?}", left.keys());
    for kill in 0..kills {
        let seed = 100 * kill + case.name.len() as u64;
        // The loop sees fewer checkpoints than are written.
        let mut most = 1 + random(seed, steps * 3 / 4);
        // A step takes about a millisecond: the kill comes right after a checkpoint, in the next step, or during the next write.
        let delay = Duration::from_micros(random(seed + 1, 3000));
        loop {
            for folder in [&killed, &resumed] {
                std::fs::remove_dir_all(folder).expect("removed");
            }
            std::fs::create_dir_all(&killed).expect("a folder");
            if case.killed(&killed, most, delay) {
                break;
            }
            assert!(most > 1, "{} is over before its first checkpoint", case.name);
            most /= 2;
        }
        let (_, last) = newest(&killed).expect("a checkpoint");
        // The heading identifies the simulation; the name of the file does not matter.
        let file = killed.join("moved away");
        std::fs::rename(&last, &file).expect("renamed");
        let again = case.run(&resumed, &["--threads", "2", "--resume", file.to_str().expect("a name")]);
        let at = format!("{} from {}, {}", case.name, last.display(), errors(&again));
        assert_eq!(again.status.code(), output.status.code(), "{at}");
        assert_eq!(result(&again), wanted, "{at}");
        let found = files(&resumed);
        assert_eq!(found.keys().collect::<Vec<_>>(), left.keys().collect::<Vec<_>>(), "{at}");
        for (name, bytes) in &left {
            assert!(found[name] == *bytes, "{}: {at}", name.display());
        }
    }
    for folder in [whole, killed, resumed] {
        std::fs::remove_dir_all(folder).expect("removed");
    }
}

#[test]
fn a_column_of_material_points() {
    comes_back(COLUMN, 3);
}

#[test]
fn a_bullet_of_particles_in_contact() {
    comes_back(BULLET, 3);
}

#[test]
fn a_bar_of_particles_in_contact() {
    comes_back(BAR, 2);
}

#[test]
fn a_bar_of_smoothed_particles() {
    comes_back(STEEL, 2);
}

#[test]
fn a_dam_break_of_incompressible_flow() {
    comes_back(DAM, 2);
}

#[test]
fn what_cannot_be_resumed_from_is_refused_by_name() {
    let (folder, out) = (folder("refused"), folder("refused-out"));
    assert!(BAR.killed(&folder, 3, Duration::ZERO), "it was over before it was killed");
    let (_, file) = newest(&folder).expect("a checkpoint");
    let said = |case: Case, file: &Path, more: &[&str]| {
        let resume = ["--resume", file.to_str().expect("a name")];
        let output = case.run(&out, &[&resume[..], more].concat());
        assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
        errors(&output)
    };
    let bytes = std::fs::read(&file).expect("the checkpoint");
    let written = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("written");
        path
    };

    let short = said(BAR, &written("short", &bytes[..bytes.len() / 2]), &[]);
    assert!(short.contains("short: ") && short.contains("no checkpoint that can be read"), "{short}");
    // The checksum detects a flipped bit within a number before anything is run.
    let mut turned = bytes.clone();
    turned[bytes.len() / 2] ^= 4;
    let turned = said(BAR, &written("turned", &turned), &[]);
    assert!(turned.contains("no checkpoint that can be read"), "{turned}");
    let text = said(BAR, &written("text", b"to be or not to be"), &[]);
    assert!(text.contains("no checkpoint that can be read"), "{text}");
    let absent = said(BAR, &folder.join("absent"), &[]);
    assert!(absent.contains("absent") && absent.contains("cannot open"), "{absent}");

    let other = said(COLUMN, &file, &[]);
    assert!(other.contains("case is `elastic_bar` there and `granular_column` here"), "{other}");
    let cells = said(Case { options: &["--cells", "4"], ..BAR }, &file, &[]);
    assert!(cells.contains("--cells is `3` there and `4` here"), "{cells}");
    let default = said(Case { options: &[], ..BAR }, &file, &[]);
    assert!(default.contains("--cells is `3` there and `not given` here"), "{default}");
    let frames = said(BAR, &file, &["--frames", "4"]);
    assert!(frames.contains("--frames is `9` there and `4` here"), "{frames}");

    // Clap rejects the value.
    let negative = BAR.run(&out, &["--checkpoint", "-1"]);
    assert_eq!(negative.status.code(), Some(2));
    for folder in [folder, out] {
        std::fs::remove_dir_all(folder).expect("removed");
    }
}
