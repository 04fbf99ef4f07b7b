//! Conditions of a measurement: commit, processor, system; timers.

use std::process::Command;
use std::time::Instant;

use mpm_core::parallel::{Arch, Float, Kernel, Lane, Vectors};

/// Return the commit that is checked out, with `+` if files differ from it; `unknown` outside a repository.
pub fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    let Some(head) = git(&["rev-parse", "--short=9", "HEAD"]) else { return "unknown".into() };
    // Changed pages of results do not count; paths start at the root of the repository.
    let changed = git(&[
        "status",
        "--porcelain",
        "--untracked-files=no",
        "--",
        ":/",
        ":(top,exclude)docs",
        ":(top,exclude)benchmarks/RESULTS.md",
    ]);
    if changed.is_some_and(|list| !list.is_empty()) { format!("{head}+") } else { head }
}

/// Restart this program with its memory in huge pages, which the C library requests if the environment says so (Linux,
/// glibc 2.35). From a million particles on, address translation of 4 KiB pages takes a tenth of the time. A
/// `GLIBC_TUNABLES` that is set, to any value, prevents the restart.
pub fn into_huge_pages() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        use std::os::unix::process::CommandExt;
        const TUNABLES: &str = "GLIBC_TUNABLES";
        if std::env::var_os(TUNABLES).is_some() {
            return;
        }
        if let Ok(program) = std::env::current_exe() {
            // `exec` returns only on failure; then the program continues in small pages.
            let _ = Command::new(program)
                .args(std::env::args_os().skip(1))
                .env(TUNABLES, "glibc.malloc.hugetlb=1")
                .exec();
        }
    }
}

/// Kernel that returns the number of points in a vector.
struct Lanes;

impl Kernel<f64> for Lanes {
    const VECTORS: Vectors = Vectors::Avx512;
    type Output = usize;
    #[inline(always)]
    fn run<A: Arch<f64>>(self) -> usize {
        <A::Batch as Lane>::WIDTH
    }
}

/// Return the processor model, the number of processors, the points in a vector of the compiled kernels, and the operating
/// system.
pub fn class() -> String {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let list = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = list.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split(": ").nth(1));
    let model = model.unwrap_or(std::env::consts::ARCH).trim();
    let lanes = f64::dispatch(Lanes);
    format!("{model}, {processors} processors, vectors of {lanes} numbers, {}", std::env::consts::OS)
}

/// Return the processor time of finished child processes so far, s; `None` if the system does not report it.
pub fn children_seconds() -> Option<f64> {
    processor_seconds(13)
}

/// Return the processor time of this process so far, s, in hundredths; wall-clock time since the first call if the system
/// does not report it.
pub fn core_seconds() -> f64 {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    processor_seconds(11).unwrap_or_else(|| START.elapsed().as_secs_f64())
}

/// Sum user and system time, s, from two fields of `/proc/self/stat`; `first` counts from the field after the name.
fn processor_seconds(first: usize) -> Option<f64> {
    // Clock ticks are hundredths of a second on every Linux.
    const TICK: f64 = 0.01;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields from the third on follow the name, which is in brackets and may contain blanks.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let [user, system] = [fields.get(first)?, fields.get(first + 1)?].map(|f| f.parse::<f64>().ok());
    Some(TICK * (user? + system?))
}

/// Stopwatch for the processor time of this thread (Linux); wall-clock time elsewhere.
pub struct Stopwatch {
    clock: Instant,
    running: Option<u64>,
}

impl Stopwatch {
    /// Start the stopwatch.
    pub fn start() -> Self {
        Stopwatch { clock: Instant::now(), running: on_processor() }
    }
    /// Return the seconds since the start.
    pub fn seconds(&self) -> f64 {
        match (self.running, on_processor()) {
            (Some(before), Some(now)) => (now - before) as f64 * 1e-9,
            _ => self.clock.elapsed().as_secs_f64(),
        }
    }
}

/// Return the processor time of this thread, ns. The system updates it when it schedules the thread, hence the yield.
fn on_processor() -> Option<u64> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok()
}
