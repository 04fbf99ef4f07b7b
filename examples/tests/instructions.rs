//! Instruction counts per particle and step of the kernels of `throughput`, with called and inlined laws, by callgrind:
//! within 2 % of the counts in `instructions.csv`. Counts do not depend on the load of a machine but on the compiler, which
//! `rust-toolchain.toml` fixes. After an intended change:
//!
//! ```text
//! IMPACTITE_STORE_COUNTS=1 cargo test --release --workspace --all-features --test instructions
//! ```
//!
//! Without valgrind, or on a processor without AVX2, the test counts nothing and prints that.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const STORED: &str = include_str!("instructions.csv");
const KERNELS: [&str; 3] = ["linear-musl-elastic", "linear-musl-johnson-cook", "quadratic-apic-usl"];
const WAYS: [&str; 2] = ["called", "inlined"];
const PARTICLES: u32 = 27_000;
const STEPS: [u32; 2] = [3, 9];
const TOLERANCE: f64 = 0.02;
const TUNABLES: &str =
    "glibc.cpu.x86_rep_stosb_threshold=1000000000:glibc.cpu.x86_rep_movsb_threshold=1000000000";

/// Count the instructions of a whole run.
fn count(kernel: &str, way: &str, steps: u32, folder: &Path) -> f64 {
    let file = folder.join(format!("{kernel}-{way}-{steps}"));
    let status = Command::new("valgrind")
        // With any tunables set the program does not restart itself, which valgrind cannot follow. Callgrind counts a
        // repeated instruction once per repeat, and it depends on the compiler whether memory is cleared by one: these
        // thresholds disable them.
        .env("GLIBC_TUNABLES", TUNABLES)
        .arg("--tool=callgrind")
        .arg(format!("--callgrind-out-file={}", file.display()))
        .arg(env!("CARGO_BIN_EXE_throughput"))
        .args(["--kernel", kernel, "--way", way, "--threads", "1", "--particles", &PARTICLES.to_string()])
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
    let counted: Vec<(&str, [f64; 2])> = std::thread::scope(|scope| {
        let all = KERNELS.map(|kernel| {
            let folder = &folder;
            let between = move || WAYS.map(|way| STEPS.map(|steps| count(kernel, way, steps, folder)));
            (kernel, scope.spawn(between))
        });
        let per = f64::from((STEPS[1] - STEPS[0]) * PARTICLES);
        all.map(|(kernel, runs)| {
            (kernel, runs.join().expect("all runs").map(|[few, many]| (many - few) / per))
        })
        .into()
    });
    std::fs::remove_dir_all(&folder).expect("the folder goes");

    if std::env::var_os("IMPACTITE_STORE_COUNTS").is_some() {
        let mut text = format!("kernel,{}\n", WAYS.join(","));
        for (kernel, [called, inlined]) in &counted {
            writeln!(text, "{kernel},{called:.1},{inlined:.1}").expect("text");
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/instructions.csv");
        std::fs::write(path, text).expect("written");
        return;
    }
    for (kernel, counts) in counted {
        let row = STORED.lines().find_map(|line| line.strip_prefix(kernel)?.strip_prefix(','));
        let stored = row.expect("stored counts").split(',').map(|count| count.parse().expect("a number"));
        for ((way, count), stored) in WAYS.into_iter().zip(counts).zip(stored) {
            let stored: f64 = stored;
            let change = count / stored - 1.0;
            assert!(
                change.abs() <= TOLERANCE,
                "{kernel}, {way}: {count:.1} instructions a particle and step, {stored} stored ({:+.1} %)",
                100.0 * change
            );
        }
    }
}
