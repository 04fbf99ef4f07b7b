//! Bodies as the solver sees them: dynamic between bodies, static inside the loops.

use mpm_contact::{NearPoint, SurfaceQuantity};

use super::capability::{ClientSteps, Deactivation, Division, FreeVelocities, MeetsSurfaces};
use super::load::Loading;
use crate::grid::Node;
use crate::step::clients::new_particles::NewParticles;
use crate::step::nodes::footprint::Footprint;
use crate::step::nodes::layout::Claim;
use crate::step::nodes::layout::NodeSums;
use crate::step::nodes::layout::{Layout, Nodes};
use crate::step::rigid::motion::RigidState;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::body::{Body, Totals};
use impactite_scene::constants::Constant;
use impactite_scene::error::Cause;
use impactite_simd::{Float, Team};

/// Which pass of a method to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The map at the start of a run.
    Map,
    /// The map anew with the affine field of the nodes.
    Refit,
    /// The first of a step.
    First,
    /// The second of a step.
    Second,
    /// A smoothing of FMPM.
    Smooth,
    /// To where particles were placed.
    Follow,
}

/// The time step, and the one after it, s.
#[derive(Clone, Copy, Debug)]
pub struct Steps<T> {
    /// This step.
    pub this: T,
    /// The next.
    pub next: T,
    /// Do later steps follow the wave speeds?
    pub adapt: bool,
    /// Time at which the forces act that a pass maps, s.
    pub force_time: f64,
    /// Body force at the start of the run, m/s^2, along axes that have centres of bodies ([`impactite_scene::CentreLead`]).
    pub force: [f64; 3],
}

/// What broke in a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTrouble {
    /// Number of the particle.
    pub particle: usize,
    /// Its position, m.
    pub position: [f64; 3],
    /// What happened.
    pub cause: Cause,
}

/// How a body is present among the nodes of a scene: which blocks it takes, what it maps to them, what is near them.
pub trait Presence<T: Float, const D: usize>: Send + Sync {
    /// Append the node blocks that the particles reach or may come to, as claims of body `number`; to look `ahead`, those
    /// that they reach from a cell beside as well.
    fn claims(&mut self, number: u32, ahead: bool, list: &mut Vec<Claim<D>>);
    /// Did a particle come to where the body has no node?
    fn reaches_further(&mut self, layout: &Layout) -> bool;
    /// Does a particle reach this block of the body's own list?
    fn reaches(&self, block: usize) -> bool;
    /// Note where the node blocks are now, and append their places: this is the body's own list of blocks.
    fn link(&mut self, find: &dyn Fn(&[i32; D]) -> Option<usize>, places: &mut Vec<u32>);
    /// Add what this body's particles map to the nodes of a block, by its place in the body's own list.
    fn add_tiles(&self, block: usize, sums: NodeSums, nodes: &mut [Node<T>]);
    /// What contact wants to know of the particles near some nodes of a block of the body's own list; `nodes`
    /// has a bit for each. Adds to `out`, one entry a node ([`SurfaceQuantity::Reach`]: the larger one), for the unit
    /// vectors in `normals`, one a node, where the quantity needs them.
    fn surface_quantity(
        &self,
        block: usize,
        what: SurfaceQuantity,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    );
    /// Call `visit` for every particle near some nodes of a block, a bit each, with those of them that it has in its
    /// stencil; particles in order of place, those of a bin one behind the other.
    fn near_points(&self, block: usize, nodes: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>));
    /// Call `visit` for every block of particles with a bit for each bin that has some.
    fn each_block(&self, visit: &mut dyn FnMut(&[i32; D], u64));
}

/// Takes particles in between steps.
pub trait Receives<T: Float, const D: usize> {
    /// Take these in. Where the others have mapped what a step begins with, `map` says for which steps, and these map it too. Returns the
    /// largest (c + |v|) / h of them, 1/s.
    ///
    /// # Errors
    /// A particle that cannot go on.
    fn receive(
        &mut self,
        new: &NewParticles<T, D>,
        map: Option<Steps<T>>,
        team: &Team,
    ) -> Result<T, BodyTrouble>;
}

/// A body whose particles act through a grid.
pub trait GridBody<T: Float, const D: usize>: Body + Send + Sync {
    /// What it is made of, in words; functions of time by what they give at these, s.
    fn constants(&self, times: [f64; 2]) -> Vec<Constant>;
    /// How its coordinates lie in space: the name of the embedding.
    fn embedding(&self) -> &'static str;
    /// Half sizes of the particles at the start, m.
    fn half_size(&self) -> [f64; D];
    /// Smallest particle mass, kg.
    fn lightest(&self) -> T;
    /// Its presence among the nodes: that of its particles, or of what stands for them.
    fn presence(&self) -> &dyn Presence<T, D>;
    /// The same, to be arranged anew.
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D>;
    /// Place and motion, if the body is rigid.
    fn rigid(&self) -> Option<&RigidState<D>> {
        None
    }
    /// The same, to be moved.
    fn rigid_mut(&mut self) -> Option<&mut RigidState<D>> {
        None
    }

    /// The parts of a step of its own, if the body is of another discretisation ([`GridClient`](crate::step::GridClient)).
    fn client(&self) -> Option<&dyn ClientSteps<T, D>> {
        None
    }
    /// The same, to be made.
    fn client_mut(&mut self) -> Option<&mut dyn ClientSteps<T, D>> {
        None
    }

    /// Itself, if particles may come into it between steps.
    fn receiver(&mut self) -> Option<&mut dyn Receives<T, D>> {
        None
    }

    /// Its particles near a surface, if they can meet one.
    fn meets_surfaces(&self) -> Option<&dyn MeetsSurfaces<D>> {
        None
    }

    /// Leaving it out of the steps while nothing moves it, if it can be.
    fn deactivation(&self) -> Option<&dyn Deactivation<T, D>> {
        None
    }
    /// The same, to be changed.
    fn deactivation_mut(&mut self) -> Option<&mut dyn Deactivation<T, D>> {
        None
    }
    /// Is it left out of the steps ([`Mpm::deactivate`](crate::step::Mpm::deactivate))?
    fn is_deactivated(&self) -> bool {
        self.deactivated_blocks().is_some()
    }
    /// The node blocks that it would have, sorted, while it is left out and has none.
    fn deactivated_blocks(&self) -> Option<&[[i32; D]]> {
        self.deactivation()?.blocks()
    }
    /// Take it in again, if it is left out.
    fn reactivate(&mut self, team: &Team) {
        if let Some(body) = self.deactivation_mut() {
            body.reactivate(team);
        }
    }
    /// Splitting and merging of its particles, if they can be.
    fn division(&self) -> Option<&dyn Division> {
        None
    }
    /// The same, to be done.
    fn division_mut(&mut self) -> Option<&mut dyn Division> {
        None
    }
    /// Velocities of its particles that may be set between steps, if nothing prescribes them.
    fn free_velocities(&mut self) -> Option<&mut dyn FreeVelocities<T>> {
        None
    }

    /// Largest (c + |v|) / h of the particles as they stand, 1/s, for cells of `spacing`, m.
    fn rate(&self, spacing: f64) -> T;

    /// One pass over the particles. Returns the largest (c + |v|) / h seen, 1/s.
    ///
    /// # Errors
    /// The first particle that cannot go on.
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble>;
    /// Force of the load that was mapped last, and power of the one that acted in the step.
    fn loading(&self) -> Loading;
    /// Bring particles that left their bins to the new ones, and make blocks where they come to; `prune`
    /// blocks that are empty. Returns whether the set of blocks changed.
    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool;

    /// [`Body::totals`], found on these threads; `parts` is memory to work in.
    fn totals_on(&self, team: &Team, parts: &mut Vec<Totals>) -> Totals {
        let _ = (team, parts);
        self.totals()
    }
    /// Does its law bear shear and tension, so that it is one piece of matter?
    fn coheres(&self) -> bool {
        false
    }
    /// Bytes that a particle carries.
    fn particle_bytes(&self) -> usize;
    /// Take all that changes in a run to a file, or from one.
    ///
    /// # Errors
    /// The file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// Show every particle as its nodes see it, loads as they are at `time`, s.
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>));
}
