//! Bodies of another discretisation that act through the grid of a scene: what is asked of them.

use super::near_particles::NearParticles;
use super::new_particles::{Matter, NewParticles, Surroundings};
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, Boundary, Exchange, Stopped};
use impactite_simd::{Float, Team};

/// A point of a [`GridClient`] as the grid has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClientPoint {
    /// Position, m.
    pub position: [f64; 3],
    /// Half edges of its domain, m: how far matter reaches around it, as contact sees it.
    pub half_edges: [[f64; 3]; 3],
}

/// A body of another discretisation that acts on the grid of a scene: finite elements, a scene in the reference configuration, a
/// method of one's own. [`Mpm::add_client`](crate::step::Mpm::add_client) adds it.
///
/// Its points (nodes of elements, particles) stand on the grid as **proxies**: particles of their masses without stress. In a step of
/// `dt` seconds
///
/// ```text
/// open      the body moves its points by its own forces alone: x', the velocity that each moves with
/// grid      v_i = sum m x' N_i(x) / m_i;  contact, walls: J_i;  dx' = sum N_i(x) J_i / m_i of every point
/// advance   the body takes m dx' as an impulse on each point, deforms and moves
/// ```
///
/// so that sum J_i = sum m dx': what bodies do to each other is momentum given and taken, to rounding. The points should be about as far
/// apart as the nodes of the grid, or closer: through wider meshes others' particles slip.
///
/// The step of a scene is not longer than [`GridClient::stable_step`] and [`GridClient::rate`] allow; a body that needs many shorter steps makes them within `open` and
/// `advance`.
pub trait GridClient<T: Float, const D: usize>: Body + Send + Sync {
    /// What it is made of, in words; functions of time by what they give at these, s. A checkpoint is refused where they differ.
    fn constants(&self, times: [f64; 2]) -> Vec<Constant>;
    /// How its coordinates lie in space: the name of the embedding.
    fn embedding(&self) -> &'static str;
    /// Largest half sizes of its points, m: at most half a cell of the grid.
    fn half_size(&self) -> [f64; D];
    /// Mass, kg, and velocity, m/s, of every point, by number; their number never changes.
    fn mass_points(&self) -> Vec<(f64, [f64; D])>;
    /// Where they are, by number.
    fn place(&mut self, points: &mut [ClientPoint]);
    /// Speed of waves over size, 1/s, if the scene's time control is to find the step from it.
    fn rate(&self) -> f64 {
        0.0
    }
    /// The longest step that it can make, s, by a safety factor of its own.
    fn stable_step(&self) -> f64 {
        f64::INFINITY
    }
    /// How far apart its points are, m: the scene warns where that is more than a cell, and particles may slip through.
    fn spacing(&self) -> f64 {
        0.0
    }
    /// Begin a step of `dt`, s: the velocities that points would move with by the body's own forces alone, m/s, by number.
    ///
    /// # Errors
    /// What stops the body.
    fn open(&mut self, dt: T, velocities: &mut [[T; 3]], team: &Team) -> Result<(), Stopped>;
    /// End it: take `changes`, m/s, of these velocities, by number; none where nothing changes. They are memory to work in.
    ///
    /// # Errors
    /// As [`GridClient::open`].
    fn advance(&mut self, dt: T, changes: Option<&mut Vec<[T; 3]>>, team: &Team) -> Result<(), Stopped>;
    /// The body of particles that it is a part of, by name: bars within concrete. On the grid both are one body, which others meet as one,
    /// and matter carries the points of this one (perfect bond). By default none: it is a body of its own, kept apart from others by
    /// the contact algorithm.
    ///
    /// In a step of `dt` seconds proxies of such a body map their velocities x_p' of the last step and the forces m (x' - x_p') / dt, so
    /// that nodes know all forces; `changes` of [`advance`](GridClient::advance) leave each point with x_p' + dt sum N_i(x) a_i, as FLIP
    /// leaves particles.
    fn within(&self) -> Option<&str> {
        None
    }
    /// Before [`GridClient::advance`], of a body [within](GridClient::within) another: the velocities that matter carries its points with
    /// in this step, sum N_i(x) v_i, m/s, by number.
    fn carry(&mut self, velocities: &[[T; 3]]) {
        let _ = velocities;
    }
    /// What its matter is, if that may become particles ([`GridClient::convert`]). They come into a body that the scene makes with this one,
    /// empty at first, of the name that [`within`](GridClient::within) says; points on the grid may be none at first, then, and become others.
    fn matter(&self) -> Option<Matter<T, D>> {
        None
    }
    /// Before a step is [opened](GridClient::open), of a body whose matter may become particles: velocities of its points, m/s, by number.
    fn velocities(&self, velocities: &mut [[T; 3]]) {
        let _ = velocities;
    }
    /// Of a body whose matter may become particles: hold also what is not on the grid by a condition of the scene.
    ///
    /// # Errors
    /// A condition that it cannot have.
    fn bound(&mut self, boundary: &Boundary<D>) -> Result<(), SceneError> {
        let _ = boundary;
        Ok(())
    }
    /// Between steps, and before the first one: have matter become particles where it is to, others being `around`. If its points on the grid
    /// are others then: the number that each had, `u32::MAX` of new ones.
    ///
    /// # Errors
    /// What stops the body.
    fn convert(
        &mut self,
        around: &Surroundings<D>,
        new: &mut NewParticles<T, D>,
    ) -> Result<Option<Vec<u32>>, Stopped> {
        let _ = (around, new);
        Ok(None)
    }
    /// Boxes around the facets of its surface or, if it has none, its nodes, m: so others whose matter may become particles know that it is
    /// near.
    fn each_box(&self, visit: &mut dyn FnMut(&[f64; D], &[f64; D])) {
        let _ = visit;
    }
    /// Its surface, if particles meet that and not proxies on the grid: then [`GridClient::mass_points`] may be empty. Asked anew in every
    /// step, between `open` and `advance`.
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<T, D>> {
        None
    }
    /// What boundaries and loads of its own gave to the body since the start.
    fn given(&self) -> Exchange;
    /// Does it bear shear and tension, so that it is one piece of matter?
    fn coheres(&self) -> bool {
        true
    }
    /// All that changes in a run, to a file or from one.
    ///
    /// # Errors
    /// The file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;
}

/// The surface of a [`GridClient`] that particles meet one by one, whatever the sizes of its facets and of the cells.
///
/// The nodes of the grid have their velocities at the end of the step by then, and particles will move with them: a particle at x_p has
/// the velocity sum N_i(x_p) v_i, and an impulse J on it goes to its nodes, m_i dv_i = N_i(x_p) J. So particles of a cell move together, as
/// they do in all else.
pub trait SurfaceClient<T: Float, const D: usize> {
    /// May particles within this box, m, touch it in this step?
    fn reaches(&self, low: &[f64; D], high: &[f64; D]) -> bool;
    /// Push particles and surface apart, which are trial velocities on both sides; the body takes what it gets with
    /// [`GridClient::advance`]. Returns what that took.
    ///
    /// # Errors
    /// What stops the body.
    fn meet(&mut self, particles: &mut NearParticles<D>, dt: T, team: &Team) -> Result<Taken, Stopped>;
}

/// Kinetic energy that contact took from particles and surface, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taken {
    /// By friction.
    pub friction: f64,
    /// By plastic impacts.
    pub impacts: f64,
}
