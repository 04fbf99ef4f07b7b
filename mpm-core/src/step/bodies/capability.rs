//! What only some bodies can do: asked for by [`GridBody`](crate::step::GridBody), never pretended.

use impactite_scene::Exchange;
use impactite_scene::boundary::Boundary;
use impactite_scene::error::{SceneError, Stopped};

use crate::step::between_steps::merging::MergeBook;
use crate::step::between_steps::rest::TakenMotion;
use crate::step::between_steps::splitting::SplitBook;
use crate::step::clients::client::{ClientPoint, SurfaceClient};
use crate::step::clients::near_particles::NearParticle;
use crate::step::clients::new_particles::{NewParticles, Surroundings};
use crate::step::nodes::footprint::NodeWeight;
use crate::step::nodes::layout::Nodes;
use impactite_simd::{Float, Team};

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

/// Steps of a body of another discretisation, whose own forces are not those of the grid.
pub trait ClientSteps<T: Float, const D: usize> {
    /// Move the body's points by its own forces over `dt`, s, and map their velocities to the scene's nodes.
    ///
    /// # Errors
    /// What stops the body.
    fn open(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<(), Stopped>;
    /// Take what the scene's nodes gave, deform and move. Returns the largest rate seen, 1/s, as
    /// [`GridBody::pass`](crate::step::GridBody::pass) does.
    ///
    /// # Errors
    /// As [`ClientSteps::open`].
    fn advance(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<T, Stopped>;
    /// The longest step that it can make, s.
    fn stable_step(&self) -> f64;
    /// Are there proxies on the grid?
    fn on_grid(&self) -> bool;
    /// Is it a part of a body of particles, so that all forces on it are those of nodes?
    fn is_within(&self) -> bool;
    /// Its surface, if particles meet that.
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<T, D>>;
    /// What boundaries and loads of its own gave to the body since the start.
    fn given(&self) -> Exchange;
    /// As [`GridClient::each_box`](crate::step::GridClient::each_box).
    fn each_box(&self, visit: &mut dyn FnMut(&[f64; D], &[f64; D]));
    /// As [`GridClient::bound`](crate::step::GridClient::bound).
    ///
    /// # Errors
    /// A condition that it cannot have.
    fn bound(&mut self, boundary: &Boundary<D>) -> Result<(), SceneError>;
    /// As [`GridClient::convert`](crate::step::GridClient::convert), and make its points on the grid anew where they are others. Did anything change?
    ///
    /// # Errors
    /// What stops the body.
    fn convert(
        &mut self,
        around: &Surroundings<D>,
        new: &mut NewParticles<T, D>,
        team: &Team,
    ) -> Result<bool, Stopped>;
}

/// Particles that meet surfaces one by one ([`SurfaceClient`]).
pub trait MeetsSurfaces<const D: usize> {
    /// Call `visit` with every particle and its weights of which `reaches` does not refuse the box (lower and upper corner, m) that it
    /// sweeps in a step of `dt` seconds, in an order that depends on nothing but the scene.
    fn visit_near(
        &self,
        dt: f64,
        reaches: &dyn Fn(&[f64; D], &[f64; D]) -> bool,
        visit: &mut dyn FnMut(&NearParticle<D>, &[NodeWeight<D>]),
    );
}

/// Velocities of particles that may be set between steps.
pub trait FreeVelocities<T: Float> {
    /// Call `visit` with number and velocity, m/s, of every particle; it may change the velocity.
    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3]));
    /// Where the particles are, by number. `numbers` is memory to work in.
    fn place(&self, numbers: &mut Vec<T>, points: &mut [ClientPoint]);
    /// Stop all particles: what they had (kinetic damping).
    fn stop_motion(&mut self) -> TakenMotion;
    /// Take out of the velocities what the nodes of a cell do not see (null-space filter); the kinetic energy of that, J.
    fn filter(&mut self, team: &Team) -> f64;
}
