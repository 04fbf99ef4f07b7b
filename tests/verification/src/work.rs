//! What a run cost.

use std::time::Instant;

/// Work of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Particles.
    pub particles: u64,
    /// Steps made.
    pub steps: u64,
    /// Nodes that a particle weighs on.
    pub nodes: u64,
    /// Core-seconds of the steps alone: without seeding and without looking at errors.
    pub seconds: f64,
    /// Memory of the solver at the end, its grid and scratch included, bytes.
    pub bytes: u64,
}

impl Work {
    /// Particle-steps times nodes a particle: work that no machine changes.
    pub fn units(&self) -> f64 {
        (self.particles * self.steps * self.nodes) as f64
    }
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
