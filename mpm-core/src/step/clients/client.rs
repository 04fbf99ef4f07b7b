//! Interface of bodies of another discretisation that act through the grid of a scene.

use super::near_particles::NearParticles;
use super::new_particles::{Matter, NewParticles, Surroundings};
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, BoundaryEntry, Exchange, Stopped};
use impactite_simd::{Float, Team};

/// Point of a [`GridClient`] on the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClientPoint {
    /// Position, m.
    pub position: [f64; 3],
    /// Half edges of its domain, m: extent of matter around it in contact.
    pub half_edges: [[f64; 3]; 3],
}

/// Body of another discretisation that acts on the grid of a scene: finite elements, a scene in the reference
/// configuration, a custom method. Add it by [`Mpm::add_client`](crate::step::Mpm::add_client).
///
/// **Proxies** represent its points (nodes of elements, particles) on the grid: particles of their masses without
/// stress. In a step of `dt` seconds
///
/// ```text
/// open      the body moves its points by its own forces alone: x', the velocity that each moves with
/// grid      v_i = sum m x' N_i(x) / m_i;  contact, walls: J_i;  dx' = sum N_i(x) J_i / m_i of every point
/// advance   the body takes m dx' as an impulse on each point, deforms and moves
/// ```
///
/// so that sum J_i = sum m dx': momentum exchanged between bodies is conserved to rounding. The points should be at
/// most about as far apart as the nodes of the grid: particles of other bodies slip through wider meshes.
///
/// The step of a scene is at most what [`GridClient::stable_step`] and [`GridClient::rate`] allow; a body that needs
/// many shorter steps subcycles within `open` and `advance`.
pub trait GridClient<T: Float, const D: usize>: Body + Send + Sync {
    /// Describe the properties of the body in words; functions of time by their values at `times`, s. A checkpoint
    /// with others is refused.
    fn constants(&self, times: [f64; 2]) -> Vec<Constant>;
    /// Name of the embedding, which defines the coordinates.
    fn embedding(&self) -> &'static str;
    /// Largest half sizes of its points, m: at most half a cell of the grid.
    fn half_size(&self) -> [f64; D];
    /// Masses, kg, and velocities, m/s, of all points, by number; only [`GridClient::convert`] changes their number.
    fn mass_points(&self) -> Vec<(f64, [f64; D])>;
    /// Store positions and domains of the points, by number.
    fn place(&mut self, points: &mut [ClientPoint]);
    /// Wave speed over size, 1/s, if the time control of the scene is to find the step from it.
    fn rate(&self) -> f64 {
        0.0
    }
    /// Longest step that the body can make, s, including a safety factor.
    fn stable_step(&self) -> f64 {
        f64::INFINITY
    }
    /// Spacing of the points, m. The scene warns if it exceeds a cell, since particles may slip through.
    fn spacing(&self) -> f64 {
        0.0
    }
    /// Begin a step of `dt`, s: compute the velocities of points under the body's own forces alone, m/s, by number.
    ///
    /// # Errors
    /// A failure of the body.
    fn open(&mut self, dt: T, velocities: &mut [[T; 3]], team: &Team) -> Result<(), Stopped>;
    /// End the step: apply `changes`, m/s, of these velocities, by number; none where nothing changes. `changes` may
    /// serve as scratch memory.
    ///
    /// # Errors
    /// Errors of [`GridClient::open`].
    fn advance(&mut self, dt: T, changes: Option<&mut Vec<[T; 3]>>, team: &Team) -> Result<(), Stopped>;
    /// Name of the body of particles in which it is embedded, such as reinforcement bars in concrete. On the grid
    /// both are one body in contact with others, and the matter carries the points of this one (perfect bond). By
    /// default none: it is a separate body, which the contact algorithm keeps apart from others.
    ///
    /// In a step of `dt` seconds the proxies of an embedded body map their velocities x_p' of the last step and the
    /// forces m (x' - x_p') / dt, so that nodes have all forces; `changes` of [`advance`](GridClient::advance) update
    /// each point to x_p' + dt sum N_i(x) a_i, as FLIP updates particles.
    fn within(&self) -> Option<&str> {
        None
    }
    /// Receive the velocities at which matter carries the points of a body [within](GridClient::within) another in
    /// this step, sum N_i(x) v_i, m/s, by number. Called before [`GridClient::advance`].
    fn carry(&mut self, velocities: &[[T; 3]]) {
        let _ = velocities;
    }
    /// Matter of the body, if it may convert to particles ([`GridClient::convert`]). The scene creates an empty body
    /// for the particles, with the name of [`within`](GridClient::within); the body may then start without points on
    /// the grid, and its points may change.
    fn matter(&self) -> Option<Matter<T, D>> {
        None
    }
    /// Store the velocities of the points of a body whose matter may convert to particles, m/s, by number. Called
    /// before a step is [opened](GridClient::open).
    fn velocities(&self, velocities: &mut [[T; 3]]) {
        let _ = velocities;
    }
    /// Apply a boundary condition of the scene to points that are not on the grid, of a body whose matter may convert to particles.
    ///
    /// # Errors
    /// A condition that the body does not support.
    fn bound(&mut self, boundary: &BoundaryEntry<D>) -> Result<(), SceneError> {
        let _ = boundary;
        Ok(())
    }
    /// Convert matter to particles where due, with other bodies `around`; called between steps, and before the first
    /// one. If the points on the grid changed, return the former number of each, `u32::MAX` for new ones.
    ///
    /// # Errors
    /// A failure of the body.
    fn convert(
        &mut self,
        around: &Surroundings<D>,
        new: &mut NewParticles<T, D>,
    ) -> Result<Option<Vec<u32>>, Stopped> {
        let _ = (around, new);
        Ok(None)
    }
    /// Visit bounding boxes of the facets of its surface or, without one, of its nodes, m: other bodies whose matter
    /// may convert to particles detect its proximity by them.
    fn each_box(&self, visit: &mut dyn FnMut(&[f64; D], &[f64; D])) {
        let _ = visit;
    }
    /// Surface of the body, if particles interact with it instead of proxies on the grid: then
    /// [`GridClient::mass_points`] may be empty. Called in every step, between `open` and `advance`.
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<T, D>> {
        None
    }
    /// Exchange of the body with its own boundaries and loads since the start.
    fn given(&self) -> Exchange;
    /// True if it bears shear and tension, so that it is one piece of matter.
    fn coheres(&self) -> bool {
        true
    }
    /// Write all data that change in a run to a file, or read them.
    ///
    /// # Errors
    /// I/O error; damaged file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;
}

/// Surface of a [`GridClient`] in contact with individual particles, for any sizes of its facets and of the cells.
///
/// At this stage the nodes have their velocities at the end of the step, which will move the particles: a particle at
/// x_p has the velocity sum N_i(x_p) v_i, and an impulse J on it acts on its nodes, m_i dv_i = N_i(x_p) J. Particles
/// of a cell therefore move together, as in all other stages.
pub trait SurfaceClient<T: Float, const D: usize> {
    /// True if particles within this box, m, may touch the surface in this step.
    fn reaches(&self, low: &[f64; D], high: &[f64; D]) -> bool;
    /// Apply contact between particles and surface, both with trial velocities; the body applies its own impulses in
    /// [`GridClient::advance`]. Return the energy dissipated.
    ///
    /// # Errors
    /// A failure of the body.
    fn meet(&mut self, particles: &mut NearParticles<D>, dt: T, team: &Team) -> Result<Taken, Stopped>;
}

/// Kinetic energy of particles and surface that contact dissipated, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taken {
    /// Part of friction, J.
    pub friction: f64,
    /// Part of plastic impacts, J.
    pub impacts: f64,
}
