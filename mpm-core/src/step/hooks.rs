//! Hooks: operations of a user in a time step, at named places.

use std::sync::Arc;

use impactite_scene::{Archive, Body, CheckpointError};
use impactite_simd::Float;

use super::point_operator::PointOperator;

/// Error of a hook, which stops the run.
pub type HookError = Box<dyn std::error::Error + Send + Sync>;

/// Operation of a user in the time steps of a scene: [`Mpm::add_hook`](crate::Mpm::add_hook). Hooks of a scene are called in the order of their
/// addition, on the thread that makes the step. Scenes without hooks have no cost.
///
/// A hook that changes velocities of nodes acts like a load: impulse and work of its changes are booked as those of loads, so
/// that the balances of the scene close. Its results must not depend on clocks or threads.
pub trait Hook<T: Float, const D: usize>: Send + Sync {
    /// Name in errors and checkpoints.
    fn name(&self) -> &str;

    /// Called before the particles of a step are mapped.
    ///
    /// # Errors
    /// An error stops the run.
    fn before_step(&mut self, step: &StepView<'_, D>) -> Result<(), HookError> {
        let _ = step;
        Ok(())
    }

    /// Called with the trial velocities of the nodes at the end of the step: after forces, boundary conditions and contact, before
    /// walls on particles, damping and the return to the particles. A solve for velocities stands here.
    ///
    /// # Errors
    /// An error stops the run.
    fn trial(&mut self, nodes: &mut TrialNodes<D>, dt: f64) -> Result<(), HookError> {
        let _ = (nodes, dt);
        Ok(())
    }

    /// Called with the nodal velocities that strain the matter in the step, which are final: those of [`Hook::trial`] after walls on particles and
    /// damping, or with MUSL those that the particles give back to the nodes. What moves with the matter, as a surface of it, moves with these.
    /// Not called with USF, whose strain is by the velocities at the start of a step, nor unless [`Hook::needs_strain`].
    ///
    /// # Errors
    /// An error stops the run.
    fn strain(&mut self, nodes: &mut StrainNodes<D>, dt: f64) -> Result<(), HookError> {
        let _ = (nodes, dt);
        Ok(())
    }

    /// False for a hook without [`Hook::trial`]: then it is not called, and no list of nodes is made.
    fn needs_nodes(&self) -> bool {
        true
    }

    /// True for a hook that needs the weights of the particles on the nodes in [`Hook::trial`]: [`TrialNodes::points`].
    fn needs_points(&self) -> bool {
        false
    }

    /// True for a hook with [`Hook::strain`], for which a second list of nodes is made.
    fn needs_strain(&self) -> bool {
        false
    }

    /// Called at the end of a step, with new positions and states.
    ///
    /// # Errors
    /// An error stops the run.
    fn after_step(&mut self, step: &StepView<'_, D>) -> Result<(), HookError> {
        let _ = step;
        Ok(())
    }

    /// Write or read what changes in a run. Default: nothing.
    ///
    /// # Errors
    /// I/O error; damaged file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let _ = file;
        Ok(())
    }
}

/// Scene between two steps.
pub struct StepView<'a, const D: usize> {
    /// Time, s.
    pub time: f64,
    /// Number of completed steps.
    pub steps: u64,
    /// Bodies of the scene.
    pub bodies: Vec<&'a dyn Body>,
}

/// Node with its trial velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrialNode<const D: usize> {
    /// Body whose velocity field the node belongs to; `None` for the field of all bodies.
    pub body: Option<usize>,
    /// Coordinates of the node in the lattice, cells.
    pub index: [i32; D],
    /// Position, m; that of the reference configuration in total Lagrangian form.
    pub position: [f64; D],
    /// Mass, kg (per metre of depth or radian); with that of mirror images on planes of symmetry.
    pub mass: f64,
    /// Velocity at the end of the step, m/s.
    pub velocity: [f64; D],
    /// Velocity at the start of the step, m/s; in [`Hook::strain`] with MUSL that at its end.
    pub start: [f64; D],
    /// Directions in which a boundary condition prescribes the velocity, where changes have no effect.
    pub held: [bool; D],
    /// Place of the node in the grid.
    pub(in crate::step) place: usize,
}

/// Nodes of a scene with their trial velocities, ordered by block: nodes with mass, of deformable bodies of particles, without
/// mirror images.
pub struct TrialNodes<const D: usize> {
    pub(in crate::step) nodes: Vec<TrialNode<D>>,
    pub(in crate::step) points: Option<Arc<PointOperator<D>>>,
    pub(in crate::step) spacing: f64,
    pub(in crate::step) changed: bool,
}

impl<const D: usize> TrialNodes<D> {
    /// Nodes.
    pub fn nodes(&self) -> &[TrialNode<D>] {
        &self.nodes
    }
    /// Particles of deformable bodies with their weights on the nodes; none unless [`Hook::needs_points`].
    pub fn points(&self) -> Option<Arc<PointOperator<D>>> {
        self.points.clone()
    }
    /// Cell size, m.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
    /// Set the velocity of node `n` of the list at the end of the step, m/s.
    ///
    /// # Panics
    /// An `n` outside of the list.
    pub fn set_velocity(&mut self, n: usize, velocity: [f64; D]) {
        self.nodes[n].velocity = velocity;
        self.changed = true;
    }
}

/// Nodes of a scene with the velocities that strain the matter, in the order of [`TrialNodes`].
pub struct StrainNodes<const D: usize> {
    pub(in crate::step) nodes: Vec<TrialNode<D>>,
    pub(in crate::step) work: f64,
}

impl<const D: usize> StrainNodes<D> {
    /// Nodes.
    pub fn nodes(&self) -> &[TrialNode<D>] {
        &self.nodes
    }
    /// Add to the work, J, that was booked for the changes of [`Hook::trial`] with the trial velocities. An impulse J on a point does the work
    /// J . (v + v') / 2 by its velocities of strain in this step and the last one: the stress does its own with them.
    pub fn add_work(&mut self, work: f64) {
        self.work += work;
    }
}

/// Hooks of a scene.
pub(in crate::step) struct Hooks<T: Float, const D: usize>(pub(in crate::step) Vec<Box<dyn Hook<T, D>>>);

impl<T: Float, const D: usize> Default for Hooks<T, D> {
    fn default() -> Self {
        Hooks(Vec::new())
    }
}

impl<T: Float, const D: usize> Hooks<T, D> {
    /// Write or read the states of all hooks; the file must be of the same ones.
    pub(in crate::step) fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        let names: Vec<&str> = self.0.iter().map(|hook| hook.name()).collect();
        file.same("hooks", &names.join(", "))?;
        self.0.iter_mut().try_for_each(|hook| hook.archive(file))
    }
}
