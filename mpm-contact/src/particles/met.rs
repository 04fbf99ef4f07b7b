//! Contacts of particles found in a step.

/// Two particles, or a particle and a wall, in contact in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOfParticles {
    /// Numbers of the bodies; the smaller first.
    pub bodies: [usize; 2],
    /// Numbers of the particles; 0 for a wall.
    pub particles: [usize; 2],
    /// Position half way between them, m.
    pub position: [f64; 3],
    /// Unit normal, from the first body to the second.
    pub normal: [f64; 3],
    /// Gap: distance of the surfaces along the normal, m, where the detector measures it; negative for overlap.
    pub gap: Option<f64>,
    /// Impulse on the second body, N s; the first receives its opposite.
    pub impulse: [f64; 3],
    /// Work of friction on the slip that is left at the end of the step, J.
    pub friction: f64,
    /// Impact loss: kinetic energy that the impulse took beside friction, J.
    pub taken: f64,
}

/// Contact results of a step.
#[derive(Debug, Default)]
pub(super) struct Met {
    pub contacts: Vec<PairOfParticles>,
    /// Impulse of walls on bodies, N s, and its work with their velocities, J.
    pub impulse: [f64; 3],
    pub work: f64,
}
