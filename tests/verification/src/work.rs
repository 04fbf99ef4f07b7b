//! Computational work of a run.

pub use examples::machine::Stopwatch;

/// Work of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Number of particles; mean over the steps if it changes.
    pub particles: u64,
    /// Number of steps.
    pub steps: u64,
    /// Number of nodes per particle; rounded mean if particles differ.
    pub nodes: u64,
    /// Core-seconds of the steps only, without seeding and error evaluation.
    pub seconds: f64,
    /// Memory of the solver at the end including grid and scratch, bytes.
    pub bytes: u64,
}

impl Work {
    /// Combine the work of this run and a subsequent run.
    #[must_use]
    pub fn and(&self, other: &Work) -> Work {
        let mean = |sum: u64, parts: u64| (sum as f64 / parts.max(1) as f64).round() as u64;
        let (steps, points) = (self.steps + other.steps, |work: &Work| work.particles * work.steps);
        let nodes = |work: &Work| points(work) * work.nodes;
        Work {
            particles: mean(points(self) + points(other), steps),
            nodes: mean(nodes(self) + nodes(other), points(self) + points(other)),
            steps,
            seconds: self.seconds + other.seconds,
            bytes: self.bytes.max(other.bytes),
        }
    }

    /// Particle-steps times nodes per particle: machine-independent work.
    pub fn units(&self) -> f64 {
        (self.particles * self.steps * self.nodes) as f64
    }
}
