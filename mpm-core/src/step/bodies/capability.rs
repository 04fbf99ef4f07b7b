//! Optional capabilities of bodies, accessed through [`GridBody`](crate::step::GridBody).

use impactite_scene::error::{SceneError, Stopped};
use impactite_scene::{BoundaryEntry, Exchange};

use crate::step::between_steps::merging::MergeBook;
use crate::step::between_steps::rest::TakenMotion;
use crate::step::between_steps::splitting::SplitBook;
use crate::step::clients::client::{ClientPoint, SurfaceClient};
use crate::step::clients::near_particles::NearParticle;
use crate::step::clients::new_particles::{NewParticles, Surroundings};
use crate::step::nodes::footprint::NodeWeight;
use crate::step::nodes::layout::Nodes;
use impactite_simd::{Float, Team};

/// Deactivation of a body while nothing moves it.
pub trait Deactivation<T: Float, const D: usize> {
    /// Deactivate the body until it is [reactivated](Deactivation::reactivate), after a trial step of `longest`
    /// seconds; node blocks must be arranged next.
    ///
    /// # Errors
    /// A body that moves, is stressed, loaded or changes in the trial step.
    fn deactivate(&mut self, longest: T, team: &Team) -> Result<(), SceneError>;
    /// Reactivate the body with the map of its last pass; node blocks must be arranged next.
    fn reactivate(&mut self, team: &Team);
    /// Node blocks that a deactivated body would claim, sorted.
    fn blocks(&self) -> Option<&[[i32; D]]>;
}

/// Splitting and merging of particles.
pub trait Division {
    /// Book of particle splits since the start.
    fn splits(&self) -> SplitBook;
    /// Book of particle merges since the start, if merging is enabled.
    fn merges(&self) -> Option<MergeBook>;
    /// Merge particles, if due after so many steps. Return true if any were merged.
    fn merge(&mut self, steps: u64, team: &Team) -> bool;
}

/// Steps of a body of another discretisation, whose own forces are not those of the grid.
pub trait ClientSteps<T: Float, const D: usize> {
    /// Move the points of the body by its own forces over `dt`, s, and map their velocities to the nodes of the scene.
    ///
    /// # Errors
    /// A failure of the body.
    fn open(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<(), Stopped>;
    /// Apply the velocity changes of the nodes of the scene, deform and move. Return the largest rate, 1/s, as
    /// [`GridBody::pass`](crate::step::GridBody::pass) does.
    ///
    /// # Errors
    /// Errors of [`ClientSteps::open`].
    fn advance(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<T, Stopped>;
    /// Longest step that the body can make, s.
    fn stable_step(&self) -> f64;
    /// True if the body has proxies on the grid.
    fn on_grid(&self) -> bool;
    /// True if it is embedded in a body of particles, so that all forces on it are nodal forces.
    fn is_within(&self) -> bool;
    /// Surface of the body, if particles interact with it.
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<T, D>>;
    /// Exchange of the body with its own boundaries and loads since the start.
    fn given(&self) -> Exchange;
    /// Visit bounding boxes of the surface; see [`GridClient::each_box`](crate::step::GridClient::each_box).
    fn each_box(&self, visit: &mut dyn FnMut(&[f64; D], &[f64; D]));
    /// Apply a boundary condition of the scene; see [`GridClient::bound`](crate::step::GridClient::bound).
    ///
    /// # Errors
    /// A condition that the body does not support.
    fn bound(&mut self, boundary: &BoundaryEntry<D>) -> Result<(), SceneError>;
    /// Convert matter to particles ([`GridClient::convert`](crate::step::GridClient::convert)), and rebuild the
    /// proxies if the points on the grid changed. Return true if anything changed.
    ///
    /// # Errors
    /// A failure of the body.
    fn convert(
        &mut self,
        around: &Surroundings<D>,
        new: &mut NewParticles<T, D>,
        team: &Team,
    ) -> Result<bool, Stopped>;
}

/// Body whose particles interact individually with surfaces ([`SurfaceClient`]).
pub trait MeetsSurfaces<const D: usize> {
    /// Call `visit` with every particle and its weights, unless `reaches` refuses the box (lower and upper corner, m)
    /// that it sweeps in a step of `dt` seconds. The order depends on the scene only.
    fn visit_near(
        &self,
        dt: f64,
        reaches: &dyn Fn(&[f64; D], &[f64; D]) -> bool,
        visit: &mut dyn FnMut(&NearParticle<D>, &[NodeWeight<D>]),
    );
}

/// Particle velocities that may be set between steps.
pub trait FreeVelocities<T: Float> {
    /// Call `visit` with number and velocity, m/s, of every particle; it may change the velocity.
    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3]));
    /// Store positions and domains of the particles, by number. `numbers` is scratch memory.
    fn place(&self, numbers: &mut Vec<T>, points: &mut [ClientPoint]);
    /// Stop all particles (kinetic damping), and return the momentum and energy removed.
    fn stop_motion(&mut self) -> TakenMotion;
    /// Remove velocity components that the nodes of a cell do not resolve (null-space filter), and return their kinetic energy, J.
    fn filter(&mut self, team: &Team) -> f64;
}
