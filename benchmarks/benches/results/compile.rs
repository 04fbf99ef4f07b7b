//! Times of compilers, from nothing and after a change.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use examples::CaseError;

use crate::page::table;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn seconds(target: &Path, arguments: &[&str]) -> Result<f64, CaseError> {
    let clock = Instant::now();
    let status = Command::new(env!("CARGO"))
        .current_dir(ROOT)
        .args(arguments)
        .env("CARGO_TARGET_DIR", target)
        .env_remove("CARGO_INCREMENTAL")
        .output()
        .map_err(|e| CaseError::Other(format!("cargo does not start: {e}")))?;
    if !status.status.success() {
        let text = String::from_utf8_lossy(&status.stderr).into_owned();
        return Err(CaseError::Other(format!("cargo {}: {text}", arguments.join(" "))));
    }
    Ok(clock.elapsed().as_secs_f64())
}

/// Make a file newer.
fn touch(path: &Path) -> Result<(), CaseError> {
    let fail = |source| CaseError::File { path: path.into(), source };
    let text = std::fs::read(path).map_err(fail)?;
    std::fs::write(path, text).map_err(fail)
}

/// The workspace and a program of a user.
pub fn times() -> Result<Option<String>, CaseError> {
    let target: PathBuf = std::env::temp_dir().join(format!("impactite-compile-{}", std::process::id()));
    let user = "examples/downstream/Cargo.toml";
    let mut rows: Vec<[String; 2]> = Vec::new();
    let mut add = |what: &str, seconds: f64| rows.push([what.into(), format!("{seconds:.0}")]);
    add(
        "libraries, release, from nothing",
        seconds(&target, &["build", "--release", "-p", "mpm-core", "-p", "mpm-contact", "-p", "pcmm"])?,
    );
    add(
        "`taylor_bar`, release, after that",
        seconds(&target, &["build", "--release", "-p", "examples", "--bin", "taylor_bar"])?,
    );
    add("a user's program, debug, from nothing", seconds(&target, &["build", "--manifest-path", user])?);
    touch(&Path::new(ROOT).join("examples/downstream/src/main.rs"))?;
    add(
        "the same after a change of its `main.rs` (15 are asked)",
        seconds(&target, &["build", "--manifest-path", user])?,
    );
    touch(&Path::new(ROOT).join("examples/downstream/src/lib.rs"))?;
    add("the same after a change of its law", seconds(&target, &["build", "--manifest-path", user])?);
    let _ = std::fs::remove_dir_all(&target);
    Ok(Some(format!("## Compile times\n\nSeconds on this machine.\n\n{}", table(["what", "s"], &rows))))
}
