//! What a run cost.

pub use examples::machine::Stopwatch;

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
