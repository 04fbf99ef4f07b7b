//! The kernels of a method as objects, so that a scene is one type whatever method it is of, and passes are compiled once, where
//! the method is, and not in every program.
//!
//! `MethodKernels` has the passes over particles, with the law behind a call or, for who asks for it
//! ([`Deformable::inlined`](crate::step::Deformable::inlined)), as part of them; `ShapeKernels` what depends on the shape function alone.
//! [`Facts`] are what a step asks of a method otherwise.

use std::sync::Arc;

use mpm_contact::NearPoint;

use impactite_scene::TimeControl;

use super::loads::LoadTask;
use super::migrate::MigrationPayload;
use super::slot::{Common, Slot, Task};
use super::spread::Maps;
use super::surface_quantity::{NearTask, SurfaceTask};
use crate::dilatation::Dilatation;
use crate::dim::{BLOCK, Stencil};
use crate::frame::Frame;
use crate::grid::Node;
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

/// What a step asks of a method beside its kernels.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// A line that names the ingredients.
    pub description: String,
    /// Name of the embedding.
    pub embedding: &'static str,
    /// Is the third direction a hoop around an axis?
    pub hoop: bool,
    /// Nodes of the stencil along an axis.
    pub nodes: usize,
    /// What of its domain a particle carries.
    pub domain: Domain,
    /// Does the basis end at walls and fixed planes?
    pub boundary_modified: bool,
    /// Largest dt c / h measured with USL.
    pub usl_limit: f64,
    /// Is stress updated before the forces (USF)?
    pub before_forces: bool,
    /// Is the momentum mapped a second time (MUSL)?
    pub remap: bool,
    /// Are momentum and the impulse of the coming step mapped together?
    pub maps_together: bool,
    /// Are forces mapped at all?
    pub maps_force: bool,
    /// Do weights belong to the reference configuration?
    pub total: bool,
    /// Do laws see the mean dilatation of a bin?
    pub mean: bool,
    /// Does the transfer read the nodal acceleration?
    pub reads_increment: bool,
    /// Is it affine?
    pub affine: bool,
    /// Is its affine fit also the velocity gradient?
    pub least_squares: bool,
    /// Order of FMPM; 1 for others.
    pub order: usize,
}

impl Facts {
    /// The default time control: half of h / (c + |v|) for MUSL and USF, whose limit is 1.4 and more; for
    /// USL 0.7 of the smallest limit measured in three dimensions for the shape function (book, "The stable time step").
    /// Chart C10 (docs/report/index.html) has the limits of 704 arrangements of particles, and left these factors as they
    /// are. A third or half of the step changes the errors of charts C1 and C2 by less than a quarter, up or down, but those of the
    /// cubic spline with FMPM(4), which has next to none from the grid.
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
    /// Records that it maps to a node.
    pub fn records(&self) -> usize {
        if self.maps_together || !self.maps_force { 1 } else { 2 }
    }
    /// Nodes that the particles of a block reach, in `d` dimensions.
    pub fn tile_nodes(&self, d: usize) -> usize {
        (BLOCK + self.nodes - 1).pow(d as u32)
    }
    /// Do stencils reach behind a plane that particles touch?
    pub fn wide(&self) -> bool {
        self.nodes > 2
    }
    /// Is the stable step that of central differences, which USL falls short of?
    pub fn symplectic(&self) -> bool {
        self.remap || self.before_forces
    }
    /// The last pass of a step.
    pub fn last_pass(&self) -> Which {
        if self.symplectic() { Which::Second } else { Which::First }
    }
}

/// Passes of a method.
pub(crate) trait MethodKernels<T: Float, const D: usize>: Send + Sync {
    /// What a step asks beside them.
    fn facts(&self) -> &Facts;
    /// A pass over a block.
    fn sweep(&self, which: Which, task: Task<'_, T, D>);
    /// What a pass maps.
    fn maps(&self, which: Which) -> Maps;
    /// What a pass does.
    fn does(&self, which: Which) -> Pass;
    /// How much of the nodes' velocity particles take for their own in a step of `dt`, s.
    fn taken(&self, dt: T) -> T;
    /// The shape function's kernels.
    fn shape(&self) -> &dyn ShapeKernels<T, D>;
    /// A method of the same shape function for particles that hold the place of others' ([`crate::step::clients::reference_scene`]); none where nodes
    /// do not know accelerations, and in the reference configuration. With `forces` they map forces, too, as loads.
    fn for_place(&self, forces: bool) -> Option<Arc<dyn MethodKernels<T, D>>>;
}

/// What depends on a shape function alone.
pub(crate) trait ShapeKernels<T: Float, const D: usize>: Send + Sync {
    /// Append particles that come to a block to their bins, and add them to its tile.
    fn take_in(
        &self,
        block: &mut Block<T, D>,
        sums: (&mut [[T; 4]], &mut u64),
        from: (&Outbox<T>, Sent, usize),
        common: &Common<T>,
        mapped: (Maps, &MigrationPayload),
    );
    /// Add the tiles of the slots around a block of nodes, and ask for those around the next one; `two` records a node?
    fn add_tiles(
        &self,
        nodes: &mut [Node<T>],
        slots: &[Slot<T, D>],
        around: [&[u32]; 2],
        sums: NodeSums,
        two: bool,
    );
    /// A quantity of the particles around a block.
    fn surface_quantity(&self, about: SurfaceTask<'_, T, D>);
    /// The particles around a block.
    fn near_points(&self, about: NearTask<'_, T, D>, visit: &mut dyn FnMut(u64, &NearPoint<T>));
    /// Book the power of loads with the velocities that the nodes have.
    fn book_loads(&self, task: LoadTask<'_, T, D>) -> T;
    /// Add loads to the tile of a block.
    fn map_loads(&self, task: LoadTask<'_, T, D>);
    /// Have the particles of a block carry the velocities of the nodes.
    fn carry_velocity(&self, task: LoadTask<'_, T, D>);
    /// Weights along an axis and their derivatives, as many as the stencil has nodes, of one particle.
    fn weights(&self, xi: T, half: T) -> [[T; 4]; 2];
    /// Second moment of the weights along an axis.
    fn inertia(&self, xi: T, half: T) -> T;
    /// The half size after a relative elongation, of [`Domain::Axes`].
    fn stretch(&self, half: T, strain: T) -> T;
    /// Weights on all nodes and their derivatives along each axis, of a domain that convects: call `node` for each.
    fn table(&self, xi: &[T; 3], domain: &[T; MOST_NUMBERS], node: &mut dyn FnMut(usize, T, [T; 3]));
}
