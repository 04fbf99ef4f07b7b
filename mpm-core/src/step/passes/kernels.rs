//! Kernels of a method as trait objects: a scene has one type for all methods, and passes are compiled once, in the crate
//! that defines the method, not in every program.
//!
//! `MethodKernels` has the passes over particles, with the constitutive law called dynamically or, on request
//! ([`Deformable::inlined`](crate::step::Deformable::inlined)), inlined; `ShapeKernels` has the kernels that depend on the
//! shape function alone. [`Facts`] are the other properties of a method that a step needs.

use std::sync::Arc;

use mpm_contact::NearPoint;

use impactite_scene::TimeControl;

use super::loads::LoadTask;
use super::migrate::{MigrationPayload, Sums};
use super::slot::{Common, Slot, Task};
use super::spread::Maps;
use super::surface_quantity::{NearTask, SurfaceTask};
use crate::dilatation::Dilatation;
use crate::dim::{BLOCK, Stencil};
use crate::frame::Frame;
use crate::grid::{Halving, Node};
use crate::method::Composition;
use crate::particles::{Block, Outbox, Sent};
use crate::scheme::{Pass, StressUpdate};
use crate::shape::domain::MOST_NUMBERS;
use crate::shape::{Domain, ShapeFunction};
use crate::step::bodies::body::Which;
use crate::step::nodes::layout::NodeSums;
use crate::transfer::Transfer;
use impactite_scene::embedding::Embedding;
use impactite_simd::Float;

/// Properties of a method that a step needs, other than its kernels.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// One-line description of the method: names of its components.
    pub description: String,
    /// Name of the embedding.
    pub embedding: &'static str,
    /// True if the third direction is the hoop direction around an axis.
    pub hoop: bool,
    /// Number of stencil nodes per axis.
    pub nodes: usize,
    /// Particle domain: data that each particle stores.
    pub domain: Domain,
    /// Refinement relation of the shape function, if cells of several sizes are available.
    pub halving: Option<Halving>,
    /// True if the basis ends at walls and fixed planes.
    pub boundary_modified: bool,
    /// Largest stable Courant number dt c / h measured with USL.
    pub usl_limit: f64,
    /// True if stress is updated before the forces (USF).
    pub before_forces: bool,
    /// True if the momentum is mapped a second time (MUSL).
    pub remap: bool,
    /// True if momentum and the impulse of the coming step are mapped together.
    pub maps_together: bool,
    /// True if forces are mapped.
    pub maps_force: bool,
    /// True if weights are evaluated in the reference configuration.
    pub total: bool,
    /// True if laws use the mean dilatation of a bin.
    pub mean: bool,
    /// True if the transfer reads the nodal acceleration.
    pub reads_increment: bool,
    /// True if the transfer is affine.
    pub affine: bool,
    /// True if the affine fit is also the velocity gradient.
    pub least_squares: bool,
    /// Order of FMPM; 1 for other transfers.
    pub order: usize,
}

impl Facts {
    /// Return the default time control. MUSL and USF, with a limit of 1.4 and more, use half of h / (c + |v|); USL uses 0.7
    /// of the smallest limit measured in three dimensions for the shape function (book, "The stable time step"). Chart C10
    /// (docs/report/index.html) has the limits of 704 particle arrangements, which did not change these factors. A third or
    /// half of the step changes the errors of charts C1 and C2 by less than a quarter, up or down, except for the cubic
    /// spline with FMPM(4), whose error from the grid is almost zero.
    pub fn time_control(&self) -> TimeControl {
        let factor = if self.symplectic() { 0.5 } else { 0.7 * self.usl_limit };
        TimeControl::Courant { factor, growth: 1.1 }
    }

    pub(in crate::step) fn of<T: Float, const D: usize, M: Composition<T, D>>(method: &M) -> Self {
        Facts {
            description: method.describe(),
            embedding: M::Embedding::NAME,
            hoop: M::Embedding::HOOP,
            nodes: <M::Shape as ShapeFunction<T, D>>::Extent::NODES,
            domain: M::Shape::DOMAIN,
            halving: M::Shape::HALVING,
            boundary_modified: M::Shape::BOUNDARY_MODIFIED,
            usl_limit: M::Shape::USL_LIMIT,
            before_forces: M::Update::BEFORE_FORCES,
            remap: M::Update::REMAP,
            maps_together: M::MAPS_TOGETHER,
            maps_force: true,
            total: M::Frame::TOTAL,
            mean: M::Dilatation::MEAN,
            reads_increment: M::Transfer::READS_INCREMENT,
            affine: M::Transfer::AFFINE,
            least_squares: M::Transfer::LEAST_SQUARES,
            order: M::Transfer::ORDER,
        }
    }
    /// Number of records that the method maps to a node.
    pub fn records(&self) -> usize {
        if self.maps_together || !self.maps_force { 1 } else { 2 }
    }
    /// Number of nodes that the particles of a block reach, in `d` dimensions.
    pub fn tile_nodes(&self, d: usize) -> usize {
        (BLOCK + self.nodes - 1).pow(d as u32)
    }
    /// Return true if stencils extend beyond a plane that particles touch.
    pub fn wide(&self) -> bool {
        self.nodes > 2
    }
    /// Return true if the time step limit is that of central differences; the limit of USL is lower.
    pub fn symplectic(&self) -> bool {
        self.remap || self.before_forces
    }
    /// Return the last pass of a step.
    pub fn last_pass(&self) -> Which {
        if self.symplectic() { Which::Second } else { Which::First }
    }
}

/// Passes of a method.
pub(crate) trait MethodKernels<T: Float, const D: usize>: Send + Sync {
    /// Properties of the method that a step needs.
    fn facts(&self) -> &Facts;
    /// Run a pass over a block.
    fn sweep(&self, which: Which, task: Task<'_, T, D>);
    /// Quantities that a pass maps to the grid.
    fn maps(&self, which: Which) -> Maps;
    /// Operations of a pass.
    fn does(&self, which: Which) -> Pass;
    /// PIC fraction of the transfer in a step of `dt`, s: 0 for FLIP, 1 for PIC and APIC.
    fn taken(&self, dt: T) -> T;
    /// Kernels of the shape function.
    fn shape(&self) -> &dyn ShapeKernels<T, D>;
    /// Kernels with the same shape function for proxy particles ([`crate::step::clients::reference_scene`]); none for
    /// transfers without nodal accelerations, FMPM of higher order and the reference configuration. With `forces` the
    /// proxies map forces, too, as loads.
    fn for_place(&self, forces: bool) -> Option<Arc<dyn MethodKernels<T, D>>>;
}

/// Kernels that depend on the shape function alone.
pub(crate) trait ShapeKernels<T: Float, const D: usize>: Send + Sync {
    /// Append particles that arrive in a block to their bins, and scatter them to its tile.
    fn take_in(
        &self,
        block: &mut Block<T, D>,
        sums: Sums<'_, T>,
        from: (&Outbox<T>, Sent, usize),
        common: &Common<T>,
        mapped: (Maps, &MigrationPayload),
    );
    /// Add the tiles of the slots around a node block, and prefetch those around the next one; with `two`, nodes have two
    /// records.
    fn add_tiles(
        &self,
        nodes: &mut [Node<T>],
        slots: &[Slot<T, D>],
        around: [&[u32]; 2],
        sums: NodeSums,
        two: bool,
    );
    /// Compute a surface quantity of the particles around a block.
    fn surface_quantity(&self, about: SurfaceTask<'_, T, D>);
    /// Visit the particles around a block.
    fn near_points(&self, about: NearTask<'_, T, D>, visit: &mut dyn FnMut(u64, &NearPoint<T>));
    /// Return the power of loads, W, with the current nodal velocities.
    fn book_loads(&self, task: LoadTask<'_, T, D>) -> T;
    /// Add loads to the tile of a block.
    fn map_loads(&self, task: LoadTask<'_, T, D>);
    /// Store the nodal velocities at the particles of a block.
    fn carry_velocity(&self, task: LoadTask<'_, T, D>);
    /// Return the weights of one particle along an axis, one per stencil node, and their derivatives.
    fn weights(&self, xi: T, half: T) -> [[T; 4]; 2];
    /// Second moment of the weights along an axis.
    fn inertia(&self, xi: T, half: T) -> T;
    /// Return the half size of a [`Domain::Axes`] domain after a relative elongation.
    fn stretch(&self, half: T, strain: T) -> T;
    /// Call `node` with the weight on each node of a convected domain, and its derivative along each axis.
    fn table(&self, xi: &[T; 3], domain: &[T; MOST_NUMBERS], node: &mut dyn FnMut(usize, T, [T; 3]));
}
