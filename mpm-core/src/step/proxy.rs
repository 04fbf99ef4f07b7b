//! Bodies of another discretisation that act through the grid: what stands for them there.

use impactite_scene::{Exchange, Stopped};

use super::layout::Nodes;
use crate::parallel::{Float, Team};

/// A body whose own forces act on another grid than that of the scene.
pub trait InReference<T: Float, const D: usize>: Send + Sync {
    /// Move the nodes' velocities by the body's own forces over `dt`, s, and map those of the particles to the scene's nodes.
    ///
    /// # Errors
    /// A particle that cannot go on.
    fn open(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<(), Stopped>;
    /// Take what the scene's nodes gave, deform and move. Returns the largest rate seen, 1/s, as [`GridBody::pass`] does.
    ///
    /// # Errors
    /// As [`InReference::open`].
    fn advance(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<T, Stopped>;
    /// What boundaries and loads of its own gave to the body since the start.
    fn given(&self) -> Exchange;
}

/// A particle as its proxy has it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ProxyState {
    /// Position, m.
    pub(super) position: [f64; 3],
    /// Half edges of its domain, m, as in [`Particle`].
    pub(super) half_edges: [[f64; 3]; 3],
}
