//! What only some bodies can do: asked for by [`GridBody`](super::GridBody), never pretended.

use impactite_scene::error::SceneError;

use super::merging::MergeBook;
use super::rest::TakenMotion;
use super::splitting::SplitBook;
use crate::parallel::{Float, Team};

/// Leaving a body out of the steps while nothing moves it.
pub trait Deactivation<T: Float, const D: usize> {
    /// Leave it out until it is [reactivated](Deactivation::reactivate), tried with a step of `longest` seconds; its node blocks are
    /// arranged next.
    ///
    /// # Errors
    /// A body that something moves.
    fn deactivate(&mut self, longest: T, team: &Team) -> Result<(), SceneError>;
    /// Take it in again, with what the last pass would have mapped; node blocks are arranged next.
    fn reactivate(&mut self, team: &Team);
    /// The node blocks that it would have, sorted, while it is left out and has none.
    fn blocks(&self) -> Option<&[[i32; D]]>;
}

/// Splitting and merging of particles.
pub trait Division {
    /// How particles were split since the start.
    fn splits(&self) -> SplitBook;
    /// How particles were merged since the start, if they are to be.
    fn merges(&self) -> Option<MergeBook>;
    /// Merge particles, if it is time to after so many steps; were any?
    fn merge(&mut self, steps: u64, team: &Team) -> bool;
}

/// Velocities of particles that may be set between steps.
pub trait FreeVelocities {
    /// Stop all particles: what they had (kinetic damping).
    fn stop_motion(&mut self) -> TakenMotion;
    /// Take out of the velocities what the nodes of a cell do not see (null-space filter); the kinetic energy of that, J.
    fn filter(&mut self, team: &Team) -> f64;
}
