//! Instructions a particle and step of the kernels of `throughput`, counted by callgrind: they stay within 2 % of the
//! counts in `instructions.csv`. Counts do not depend on the load of a machine; they do depend on the compiler, which
//! `rust-toolchain.toml` fixes. After a change that is meant:
//!
//! ```text
//! IMPACTITE_STORE_COUNTS=1 cargo test --release -p examples --test instructions
//! ```
//!
//! Without valgrind, or on a processor without AVX2, nothing is counted, and the test says so.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const STORED: &str = include_str!("instructions.csv");
const KERNELS: [&str; 3] = ["linear-musl-elastic", "linear-musl-johnson-cook", "quadratic-apic-usl"];
const PARTICLES: u32 = 27_000;
const STEPS: [u32; 2] = [3, 13];
const TOLERANCE: f64 = 0.02;

/// Instructions of a whole run.
fn count(kernel: &str, steps: u32, folder: &Path) -> f64 {
    let file = folder.join(format!("{kernel}-{steps}"));
    let status = Command::new("valgrind")
        // As it is, the program does not begin anew, where valgrind would lose it.
        .env("GLIBC_TUNABLES", "")
        .arg("--tool=callgrind")
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(env!("CARGO_BIN_EXE_throughput"))
        .args(["--kernel", kernel, "--threads", "1", "--particles", &PARTICLES.to_string()])
        .args(["--steps", &steps.to_string(), "--out"])
        .arg(folder)
        .output()
        .expect("valgrind starts");
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));
    let text = std::fs::read_to_string(&file).expect("callgrind's file");
    let total = text.lines().find_map(|line| line.strip_prefix("summary: ")).expect("a summary");
    total.trim().parse().expect("a number")
}

#[test]
fn kernels_need_no_more_instructions_than_they_did() {
    let has_avx2 = std::fs::read_to_string("/proc/cpuinfo").is_ok_and(|text| text.contains("avx2"));
    if !has_avx2 || Command::new("valgrind").arg("--version").output().is_err() {
        eprintln!("not counted: this needs valgrind and AVX2");
        return;
    }
    let folder = std::env::temp_dir().join(format!("impactite-instructions-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for temporary files");
    let counted: Vec<(&str, f64)> = std::thread::scope(|scope| {
        let all = KERNELS.map(|kernel| {
            let folder = &folder;
            let between = move || STEPS.map(|steps| count(kernel, steps, folder));
            (kernel, scope.spawn(between))
        });
        let per = f64::from((STEPS[1] - STEPS[0]) * PARTICLES);
        all.map(|(kernel, runs)| {
            let [few, many] = runs.join().expect("both runs");
            (kernel, (many - few) / per)
        })
        .into()
    });
    std::fs::remove_dir_all(&folder).expect("the folder goes");

    if std::env::var_os("IMPACTITE_STORE_COUNTS").is_some() {
        let mut text = String::from("kernel,instructions a particle and step\n");
        for (kernel, count) in &counted {
            writeln!(text, "{kernel},{count:.1}").expect("text");
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions.csv");
        std::fs::write(path, text).expect("written");
        return;
    }
    for (kernel, count) in counted {
        let row = STORED.lines().find_map(|line| line.strip_prefix(kernel)?.strip_prefix(','));
        let stored: f64 = row.expect("a stored count").parse().expect("a number");
        let change = count / stored - 1.0;
        assert!(
            change.abs() <= TOLERANCE,
            "{kernel}: {count:.1} instructions a particle and step, {stored} stored ({:+.1} %)",
            100.0 * change
        );
    }
}
