//! Compile times: from scratch, and after edits of the text of a law, a shape function and a scene.
//!
//! Each state of the project is cloned into its own folder, so that the measurement is that of a user. An edit changes a
//! number in a line of code, to a new value each time; if the program stays the same, the measurement fails.

use std::path::PathBuf;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use examples::CaseError;

use crate::page::table;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const USER: &str = "examples/downstream/Cargo.toml";
const CASE: &str = "release/taylor_bar";

/// Edit of a line of code: replaced text and replacement; `{}` is a number that differs each time.
struct Edit {
    file: &'static str,
    from: &'static str,
    to: &'static str,
}
const LAW: Edit = Edit {
    file: "examples/downstream/src/viscoelastic.rs",
    from: "L::of(2.0 * self.shear)",
    to: "L::of(2.0{} * self.shear)",
};
const SHAPE: Edit = Edit {
    file: "examples/downstream/src/tent.rs",
    from: "L::of(2.0 / 3.0) * foot",
    to: "L::of(2.0{} / 3.0) * foot",
};
const SCENE: Edit =
    Edit { file: "examples/downstream/src/main.rs", from: "[0.0, -5.0]", to: "[0.0, -5.0{}]" };
const CASE_SCENE: Edit = Edit {
    file: "examples/src/bin/taylor_bar/scene.rs",
    from: "BULK_VISCOSITY: [f64; 2] = [0.06, 1.5]",
    to: "BULK_VISCOSITY: [f64; 2] = [0.06{}, 1.5]",
};

/// Clone of the project at a commit.
struct Clone {
    folder: PathBuf,
    target: PathBuf,
    edits: u32,
}

impl Drop for Clone {
    fn drop(&mut self) {
        // Leftover files in a temporary folder are harmless.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

impl Clone {
    fn new(commit: &str) -> Result<Self, CaseError> {
        let folder = std::env::temp_dir().join(format!("impactite-compile-{}-{commit}", std::process::id()));
        let clone = Clone { target: folder.join("target"), folder, edits: 0 };
        let place = clone.folder.display().to_string();
        run(Command::new("git").args(["clone", "--quiet", ROOT, &place]))?;
        run(Command::new("git").current_dir(&clone.folder).args(["checkout", "--quiet", commit]))?;
        Ok(clone)
    }
    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.folder).env("CARGO_TARGET_DIR", &self.target);
        // Remove the build environment of the benchmark itself.
        for name in ["CARGO_INCREMENTAL", "RUSTFLAGS", "CARGO_MANIFEST_DIR", "RUSTUP_TOOLCHAIN"] {
            command.env_remove(name);
        }
        command
    }
    /// Run a shell line; return its time, s.
    fn shell(&self, line: &str) -> Result<f64, CaseError> {
        run(self.command("sh").args(["-c", line]))
    }
    /// Run cargo; return its time, s.
    fn cargo(&self, arguments: &str) -> Result<f64, CaseError> {
        run(self.command("cargo").args(arguments.split(' ')))
    }
    fn read(&self, file: &str) -> Result<String, CaseError> {
        let path = self.folder.join(file);
        std::fs::read_to_string(&path).map_err(|source| CaseError::File { path, source })
    }
    fn program(&self, name: &str) -> Result<Vec<u8>, CaseError> {
        let path = self.target.join(name);
        std::fs::read(&path).map_err(|source| CaseError::File { path, source })
    }
    fn edit(&mut self, edit: &Edit) -> Result<(), CaseError> {
        self.edits += 1;
        let path = self.folder.join(edit.file);
        // Restore the file as checked out, including the number of a previous edit.
        run(Command::new("git").current_dir(&self.folder).args(["checkout", "--quiet", "--", edit.file]))?;
        let text = self.read(edit.file)?;
        if text.matches(edit.from).count() != 1 {
            return Err(CaseError::Other(format!("{} has no `{}`, or several", edit.file, edit.from)));
        }
        let number = format!("{:06}", self.edits);
        let text = text.replace(edit.from, &edit.to.replace("{}", &number));
        std::fs::write(&path, text).map_err(|source| CaseError::File { path, source })
    }
    /// Run cargo after an edit that changes the program `name`; return its time, s.
    fn after(&mut self, edit: &Edit, arguments: &str, name: &str) -> Result<f64, CaseError> {
        let before = self.program(name)?;
        self.edit(edit)?;
        let seconds = self.cargo(arguments)?;
        if self.program(name)? == before {
            return Err(CaseError::Other(format!("{name} is the same after an edit of {}", edit.file)));
        }
        Ok(seconds)
    }
    /// Return the `n`-th command in README.
    fn readme(&self, n: usize) -> Result<String, CaseError> {
        let text = self.read("README.md")?;
        let block = text.split("```sh\n").nth(n + 1).and_then(|rest| rest.split("```").next());
        block
            .map(|line| line.trim().to_string())
            .ok_or_else(|| CaseError::Other("README has no command".into()))
    }
}

/// Run a command that must succeed; return its time, s.
fn run(command: &mut Command) -> Result<f64, CaseError> {
    let clock = Instant::now();
    let output =
        command.output().map_err(|e| CaseError::Other(format!("{command:?} does not start: {e}")))?;
    if !output.status.success() {
        // Error messages are at the end of either stream.
        let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
        let text = format!("{out}\n{err}");
        return Err(CaseError::Other(format!("{command:?}: {text}")));
    }
    Ok(clock.elapsed().as_secs_f64())
}

/// Measure the peak memory of a single compiler process while `job` runs, in bytes, if the system provides it
/// (Linux).
fn largest_compiler<R>(job: impl FnOnce() -> R) -> (R, u64) {
    let (ended, most) = (AtomicBool::new(false), AtomicU64::new(0));
    let result = thread::scope(|scope| {
        scope.spawn(|| {
            while !ended.load(Ordering::Relaxed) {
                most.fetch_max(compilers(), Ordering::Relaxed);
                thread::sleep(Duration::from_millis(20));
            }
        });
        let result = job();
        ended.store(true, Ordering::Relaxed);
        result
    });
    (result, most.into_inner())
}

/// Return the largest peak memory of the compilers running now.
fn compilers() -> u64 {
    let Ok(processes) = std::fs::read_dir("/proc") else { return 0 };
    let most = processes.flatten().filter_map(|process| {
        let status = std::fs::read_to_string(process.path().join("status")).ok()?;
        let field = |name: &str| status.lines().find_map(|line| line.strip_prefix(name)).map(str::trim);
        if field("Name:")? != "rustc" {
            return None;
        }
        field("VmHWM:")?.strip_suffix("kB")?.trim().parse::<u64>().ok()
    });
    1024 * most.max().unwrap_or(0)
}

/// Table row: quantity, requirement, and measurements of each state of the project.
struct Row {
    what: &'static str,
    asked: &'static str,
    measured: Vec<String>,
}

/// Measure a state of the project.
fn state(commit: &str) -> Result<Vec<(&'static str, &'static str, String)>, CaseError> {
    let mut clone = Clone::new(commit)?;
    let mut rows = Vec::new();
    let seconds = |x: f64| format!("{x:.1} s");

    let command = clone.readme(0)?;
    eprintln!("  {commit}: {command}");
    let (first, memory) = largest_compiler(|| clone.shell(&command));
    if !clone.folder.join("out/taylor_bar/profile_taylor.png").is_file() {
        return Err(CaseError::Other("README's first command made no picture".into()));
    }
    rows.push(("README's first command, until the picture is there", "90 s", seconds(first?)));
    rows.push((
        "largest memory of one compiler process there",
        "1.2 GB",
        format!("{:.2} GB", memory as f64 / 1e9),
    ));
    let size = clone.program(CASE)?.len();
    rows.push(("size of the `taylor_bar` binary", "a quarter", format!("{:.1} MB", size as f64 / 1e6)));

    eprintln!("  {commit}: edits");
    let build = "build --release -p examples --bin taylor_bar";
    let scene = clone.after(&CASE_SCENE, build, CASE)?;
    rows.push(("`taylor_bar`, release, after an edit of its scene", "5 s", seconds(scene)));
    clone.cargo("build --release -p examples --lib")?;
    let (bins, memory) = largest_compiler(|| clone.cargo("build --release -p examples --bins"));
    rows.push(("all other case binaries, release, after the libraries", "a sixth", seconds(bins?)));
    rows.push(("largest memory of one compiler process there", "", format!("{:.2} GB", memory as f64 / 1e9)));

    let user = format!("build --release --manifest-path {USER}");
    let nothing = clone.cargo(&user)?;
    rows.push((
        "a user's crate (own law, own shape function), release, after the case",
        "",
        seconds(nothing),
    ));
    let program = "release/downstream";
    rows.push(("the same after an edit of its scene", "5 s", seconds(clone.after(&SCENE, &user, program)?)));
    rows.push(("the same after an edit of its law", "10 s", seconds(clone.after(&LAW, &user, program)?)));
    let shape = clone.after(&SHAPE, &user, program)?;
    rows.push(("the same after an edit of its shape function", "30 s", seconds(shape)));
    let user = format!("build --manifest-path {USER}");
    rows.push(("a user's crate, debug, from nothing", "", seconds(clone.cargo(&user)?)));
    let debug = clone.after(&LAW, &user, "debug/downstream")?;
    rows.push(("the same after an edit of its law", "3 s", seconds(debug)));
    let check = format!("check --manifest-path {USER}");
    clone.cargo(&check)?;
    clone.edit(&LAW)?;
    rows.push(("`cargo check` after an edit of its law", "3 s", seconds(clone.cargo(&check)?)));
    Ok(rows)
}

/// Compare the compile times of HEAD with those of the commits in `before`.
pub fn times(before: &[String]) -> Result<Option<String>, CaseError> {
    let mut rows: Vec<Row> = Vec::new();
    let commits: Vec<&str> = before.iter().map(String::as_str).chain(["HEAD"]).collect();
    for commit in &commits {
        for (at, (what, asked, measured)) in state(commit)?.into_iter().enumerate() {
            if at == rows.len() {
                rows.push(Row { what, asked, measured: Vec::new() });
            }
            rows[at].measured.push(measured);
        }
    }
    let mut head: Vec<&str> = vec!["what"];
    head.extend(&commits[..commits.len() - 1]);
    head.extend(["now", "asked"]);
    let lines: Vec<Vec<String>> = rows
        .into_iter()
        .map(|row| {
            let mut cells = vec![row.what.to_string()];
            cells.extend(row.measured);
            cells.push(row.asked.into());
            cells
        })
        .collect();
    Ok(Some(format!(
        "## Compile times\n\nOf clones of the repository, with packages fetched. Edits change a number in a line of code, and the \
         program with it.\n\n{}",
        table(&head, &lines)
    )))
}

/// Measure README's second command or `.ci/run`, from scratch.
pub fn tests(ci: bool) -> Result<Option<String>, CaseError> {
    let clone = Clone::new("HEAD")?;
    let (what, command, asked) = if ci {
        ("`.ci/run`", ".ci/run".into(), 14)
    } else {
        ("README's second command", clone.readme(1)?, 15)
    };
    let minutes = clone.shell(&command)? / 60.0;
    Ok(Some(format!(
        "## {what}\n\nIn a clone of the repository, with packages fetched and nothing built: {minutes:.1} min ({asked} min are asked)."
    )))
}
