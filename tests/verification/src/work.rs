//! What a run cost.

pub use examples::machine::Stopwatch;

/// Work of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Particles; where their number changes, the mean over the steps.
    pub particles: u64,
    /// Steps made.
    pub steps: u64,
    /// Nodes that a particle weighs on; where particles differ, the rounded mean.
    pub nodes: u64,
    /// Core-seconds of the steps alone: without seeding and without looking at errors.
    pub seconds: f64,
    /// Memory of the solver at the end, its grid and scratch included, bytes.
    pub bytes: u64,
}

impl Work {
    /// Of this run and another one after it.
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

    /// Particle-steps times nodes a particle: work that no machine changes.
    pub fn units(&self) -> f64 {
        (self.particles * self.steps * self.nodes) as f64
    }
}
