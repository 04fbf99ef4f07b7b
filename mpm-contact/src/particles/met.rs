//! Contacts of particles that a step found.

/// Two particles, or a particle and a wall, in contact in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOfParticles {
    /// The bodies, by number; the smaller first.
    pub bodies: [usize; 2],
    /// Their particles; of a wall 0.
    pub particles: [usize; 2],
    /// Half way between them, m.
    pub position: [f64; 3],
    /// Unit normal, from the first body to the second.
    pub normal: [f64; 3],
    /// Distance of the surfaces along it, m, where the detector measures it; negative if they overlap.
    pub gap: Option<f64>,
    /// Impulse on the second body, N s; the first gets its opposite.
    pub impulse: [f64; 3],
    /// Work of friction on the slip that is left at the end of the step, J.
    pub friction: f64,
    /// Kinetic energy that the impulse took beside that, J: what colliding particles lose.
    pub taken: f64,
}

/// What contact did in a step.
#[derive(Debug, Default)]
pub(super) struct Met {
    pub contacts: Vec<PairOfParticles>,
    /// Impulse of walls on bodies, N s, and its work with their velocities, J.
    pub impulse: [f64; 3],
    pub work: f64,
}
