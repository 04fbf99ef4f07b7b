//! What measured numbers were made with.

use std::process::Command;
use std::time::Instant;

/// The commit that is checked out, with `+` if files differ from it; `unknown` outside a repository.
pub fn commit() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    let Some(head) = git(&["rev-parse", "--short=9", "HEAD"]) else { return "unknown".into() };
    // Pages of numbers themselves do not count, from whatever folder this runs.
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

/// Begin this program anew with its memory in huge pages, if the C library asks for them when told so in the environment (Linux,
/// glibc 2.35). From a million particles on, looking up where pages of 4 KiB lie takes a tenth of the time. Whoever has set
/// `GLIBC_TUNABLES`, to whatever it be, is left alone.
pub fn into_huge_pages() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        use std::os::unix::process::CommandExt;
        const TUNABLES: &str = "GLIBC_TUNABLES";
        if std::env::var_os(TUNABLES).is_some() {
            return;
        }
        if let Ok(program) = std::env::current_exe() {
            // It comes back only if that could not be started; then all goes on in small pages.
            let _ = Command::new(program)
                .args(std::env::args_os().skip(1))
                .env(TUNABLES, "glibc.malloc.hugetlb=1")
                .exec();
        }
    }
}

/// Kind of processor, how many, and system.
pub fn class() -> String {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let list = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = list.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split(": ").nth(1));
    let model = model.unwrap_or(std::env::consts::ARCH).trim();
    format!("{model}, {processors} processors, {}", std::env::consts::OS)
}

/// Processor time that finished children of this process took so far, s, where the system tells.
pub fn children_seconds() -> Option<f64> {
    processor_seconds(13)
}

/// Processor time of this process so far, s, in hundredths; that of the clock since some moment where the system does not tell.
pub fn core_seconds() -> f64 {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    processor_seconds(11).unwrap_or_else(|| START.elapsed().as_secs_f64())
}

/// User and system time, s, from two fields of what Linux says of this process: the first by its place behind the name.
fn processor_seconds(first: usize) -> Option<f64> {
    // Clock ticks are hundredths of a second on every Linux.
    const TICK: f64 = 0.01;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Fields from the third on follow the name, which stands in brackets and may hold blanks.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let [user, system] = [fields.get(first)?, fields.get(first + 1)?].map(|f| f.parse::<f64>().ok());
    Some(TICK * (user? + system?))
}

/// Processor time of this thread, where the system tells it (Linux), else time of the clock.
pub struct Stopwatch {
    clock: Instant,
    running: Option<u64>,
}

impl Stopwatch {
    /// Start.
    pub fn start() -> Self {
        Stopwatch { clock: Instant::now(), running: on_processor() }
    }
    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        match (self.running, on_processor()) {
            (Some(before), Some(now)) => (now - before) as f64 * 1e-9,
            _ => self.clock.elapsed().as_secs_f64(),
        }
    }
}

/// Nanoseconds that this thread ran. The system brings the number up to date when it looks at the thread: it is
/// asked to.
fn on_processor() -> Option<u64> {
    std::thread::yield_now();
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok()
}
