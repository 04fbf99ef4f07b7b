//! Interface of bodies to the solver: dynamic dispatch between bodies, static inside the loops.

use std::sync::Arc;

use mpm_contact::{NearPoint, SurfaceQuantity};

use super::capability::{ClientSteps, Deactivation, Division, FreeVelocities, MeetsSurfaces};
use super::load::Loading;
use crate::grid::{Levels, Node};
use crate::step::clients::new_particles::NewParticles;
use crate::step::nodes::footprint::Footprint;
use crate::step::nodes::layout::Claim;
use crate::step::nodes::layout::NodeSums;
use crate::step::nodes::layout::{Layout, Nodes};
use crate::step::nodes::occupancy::{NodeBlocks, Tile};
use crate::step::rigid::motion::RigidState;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::body::{Body, Totals};
use impactite_scene::constants::Constant;
use impactite_scene::error::Cause;
use impactite_simd::{Float, Team};

/// Kind of pass over the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// Map at the start of a run.
    Map,
    /// Map at the start of a run, repeated with the affine field of the nodes.
    Refit,
    /// First pass of a step.
    First,
    /// Second pass of a step.
    Second,
    /// Smoothing of FMPM.
    Smooth,
    /// Sorting into bins of particles that were placed elsewhere.
    Follow,
}

/// Sizes of the present and the next step, s.
#[derive(Clone, Copy, Debug)]
pub struct Steps<T> {
    /// Size of the present step, s.
    pub this: T,
    /// Size of the next step, s.
    pub next: T,
    /// True if later steps follow the wave speeds.
    pub adapt: bool,
    /// Time at which the forces of the pass act, s.
    pub force_time: f64,
    /// Body force at the start of the run, m/s^2, along axes in which the scene contains the centres of bodies
    /// ([`impactite_scene::CentreLead`]).
    pub force: [f64; 3],
}

/// Failure of a particle.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTrouble {
    /// Number of the particle.
    pub particle: usize,
    /// Position of the particle, m.
    pub position: [f64; 3],
    /// Cause of the failure.
    pub cause: Cause,
}

/// Footprint of a body on the grid: node blocks that it claims, contributions to them, particles near them.
pub trait Presence<T: Float, const D: usize>: Send + Sync {
    /// Append the node blocks that the particles reach or may reach, as claims of body `number`; with `ahead` also
    /// those that they reach from a neighbouring cell.
    fn claims(&mut self, number: u32, ahead: bool, list: &mut Vec<Claim<D>>);
    /// True if a particle reached a position where the body has no node.
    fn reaches_further(&mut self, layout: &Layout) -> bool;
    /// True if a particle reaches this block of the body's own list.
    fn reaches(&self, block: usize) -> bool;
    /// Store the present indices of the node blocks, and append them to `places`: this is the body's own list of blocks.
    fn link(&mut self, find: &dyn Fn(&[i32; D]) -> Option<usize>, places: &mut Vec<u32>);
    /// Add the contributions of the particles to the nodes of a block, given by its index in the body's own list.
    fn add_tiles(&self, block: usize, sums: NodeSums, nodes: &mut [Node<T>]);
    /// Add the affine part of the momentum that the particles map to a node of a block of the body's own list, by axis of the
    /// distance, kg m/s a cell: for nodes that depend on those of larger cells.
    fn add_affine(&self, block: usize, node: usize, sums: &mut [[T; 4]; 3]) {
        let _ = (block, node, sums);
    }
    /// Add a contact quantity of the particles near some nodes of a block of the body's own list to `out`, one entry
    /// per node ([`SurfaceQuantity::Reach`]: the maximum). `nodes` has a bit per node; `normals` are unit vectors,
    /// one per node, where the quantity needs them.
    fn surface_quantity(
        &self,
        block: usize,
        what: SurfaceQuantity,
        nodes: u64,
        normals: &[[T; 3]],
        out: &mut [[T; 3]],
    );
    /// Call `visit` for every particle near some nodes of a block, a bit each, with those of them in its stencil;
    /// particles are in order of place, those of a bin consecutive.
    fn near_points(&self, block: usize, nodes: u64, visit: &mut dyn FnMut(u64, &NearPoint<T>));
    /// Call `visit` for every block of particles with the bit mask of its occupied bins.
    fn each_block(&self, visit: &mut dyn FnMut(&[i32; D], u64));
    /// Add the number of particles in blocks of each level of cells to `counts`.
    fn count_by_level(&self, counts: &mut [usize]);
}

/// Body that receives particles between steps.
pub trait Receives<T: Float, const D: usize> {
    /// Receive particles. If the start of the step is already mapped, `map` contains its step sizes, and the new
    /// particles are mapped as well. Return the largest (c + |v|) / h of the new particles, 1/s.
    ///
    /// # Errors
    /// A particle that failed.
    fn receive(
        &mut self,
        new: &NewParticles<T, D>,
        map: Option<Steps<T>>,
        team: &Team,
    ) -> Result<T, BodyTrouble>;
}

/// Body whose particles act through a grid.
pub trait GridBody<T: Float, const D: usize>: Body + Send + Sync {
    /// Describe the properties of the body in words; functions of time by their values at `times`, s.
    fn constants(&self, times: [f64; 2]) -> Vec<Constant>;
    /// Name of the embedding, which defines the coordinates.
    fn embedding(&self) -> &'static str;
    /// Half sizes of the particles at the start, m.
    fn half_size(&self) -> [f64; D];
    /// Smallest particle mass, kg.
    fn lightest(&self) -> T;
    /// Footprint on the grid: that of the particles or of their proxies.
    fn presence(&self) -> &dyn Presence<T, D>;
    /// Mutable footprint, for the arrangement of node blocks.
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D>;
    /// Position and motion, if the body is rigid.
    fn rigid(&self) -> Option<&RigidState<D>> {
        None
    }
    /// Mutable position and motion, if the body is rigid.
    fn rigid_mut(&mut self) -> Option<&mut RigidState<D>> {
        None
    }

    /// Steps of a body of another discretisation ([`GridClient`](crate::step::GridClient)), if it is one.
    fn client(&self) -> Option<&dyn ClientSteps<T, D>> {
        None
    }
    /// Mutable steps of a body of another discretisation, if it is one.
    fn client_mut(&mut self) -> Option<&mut dyn ClientSteps<T, D>> {
        None
    }

    /// Receiver of particles between steps, if the body supports it.
    fn receiver(&mut self) -> Option<&mut dyn Receives<T, D>> {
        None
    }

    /// Particles near a surface, if the body supports contact with surfaces.
    fn meets_surfaces(&self) -> Option<&dyn MeetsSurfaces<D>> {
        None
    }

    /// Deactivation of the body, if it supports it.
    fn deactivation(&self) -> Option<&dyn Deactivation<T, D>> {
        None
    }
    /// Mutable deactivation of the body, if it supports it.
    fn deactivation_mut(&mut self) -> Option<&mut dyn Deactivation<T, D>> {
        None
    }
    /// True if the body is deactivated ([`Mpm::deactivate`](crate::step::Mpm::deactivate)).
    fn is_deactivated(&self) -> bool {
        self.deactivated_blocks().is_some()
    }
    /// Node blocks that a deactivated body would claim, sorted; it has none.
    fn deactivated_blocks(&self) -> Option<&[[i32; D]]> {
        self.deactivation()?.blocks()
    }
    /// Reactivate the body, if it is deactivated.
    fn reactivate(&mut self, team: &Team) {
        if let Some(body) = self.deactivation_mut() {
            body.reactivate(team);
        }
    }
    /// Splitting and merging of particles, if the body supports it.
    fn division(&self) -> Option<&dyn Division> {
        None
    }
    /// Mutable splitting and merging of particles, if the body supports it.
    fn division_mut(&mut self) -> Option<&mut dyn Division> {
        None
    }
    /// Sound speed at rest, m/s, if the density is renewed from positions
    /// ([`Deformable::with_renewed_density`](crate::Deformable::with_renewed_density)) and the body is active.
    fn renewed(&self) -> Option<f64> {
        None
    }
    /// Space that the particles of each block occupy at the nodes, in the order of blocks; none for other bodies than those of
    /// particles.
    fn density_tiles(&self, team: &Team) -> Vec<Tile<D>> {
        let _ = team;
        Vec::new()
    }
    /// Move volume ratios to the fits and occupancies at the nodes, and return the change of the elastic energy, J.
    fn take_density(
        &mut self,
        nodes: &NodeBlocks<D>,
        fits: &[[f64; 4]],
        errors: &[[f64; 2]],
        rate: f64,
        team: &Team,
    ) -> f64 {
        let _ = (nodes, fits, errors, rate, team);
        0.0
    }
    /// Particle velocities that may be set between steps, unless they are prescribed.
    fn free_velocities(&mut self) -> Option<&mut dyn FreeVelocities<T>> {
        None
    }

    /// Largest (c + |v|) / h of the particles in their present state, 1/s, for cells of `spacing`, m.
    fn rate(&self, spacing: f64) -> T;

    /// Make one pass over the particles. Return their largest (c + |v|) / h, 1/s.
    ///
    /// # Errors
    /// The first particle that failed.
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble>;
    /// Force of the load mapped last, and power of the load that acted in the step.
    fn loading(&self) -> Loading;
    /// Sort particles that left their bins into new ones, and create blocks where needed; `prune` removes empty
    /// blocks. Return true if the set of blocks changed.
    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool;

    /// Return [`Body::totals`], computed on these threads; `parts` is scratch memory.
    fn totals_on(&self, team: &Team, parts: &mut Vec<Totals>) -> Totals {
        let _ = (team, parts);
        self.totals()
    }
    /// True if the law bears shear and tension, so that the body is one piece of matter.
    fn coheres(&self) -> bool {
        false
    }
    /// Change the cells of blocks: their particles leave them in the next pass.
    fn set_levels(&mut self, levels: &Arc<Levels<D>>) {
        let _ = levels;
    }
    /// Call `visit` for every block with a particle whose state variable `state` is `least` or more, in the order of blocks.
    fn each_block_above(&self, state: &str, least: f64, team: &Team, visit: &mut dyn FnMut(&[i32; D])) {
        let _ = (state, least, team, visit);
    }
    /// Bytes per particle.
    fn particle_bytes(&self) -> usize;
    /// Write all data that change in a run to a file, or read them.
    ///
    /// # Errors
    /// I/O error; damaged file.
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError>;

    /// Call `visit` with the footprint of every particle on the nodes, with loads at `time`, s.
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>));
}
