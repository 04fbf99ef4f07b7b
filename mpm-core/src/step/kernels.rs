//! The kernels of a method as objects, so that a scene is one type whatever method it is of, and passes are compiled once, where
//! the method is, and not in every program.
//!
//! `MethodKernels` has the passes over particles, with the law behind a call or, for who asks for it
//! ([`Deformable::inlined`](super::Deformable::inlined)), as part of them; `ShapeKernels` what depends on the shape function alone.
//! [`Facts`] are what a step asks of a method otherwise.

use std::marker::PhantomData;
use std::sync::Arc;

use mpm_contact::{NearPoint, SurfaceQuantity};
use mpm_materials::Constitutive;

use impactite_scene::TimeControl;

use super::body::Which;
use super::loads::{BookLoads, LoadTask, MapLoads};
use super::migrate::{Arrivals, MigrationPayload};
use super::spec::{PassOf, Spec, SpecOf};
use super::spread::Maps;
use super::surface_quantity::{
    GRADIENT, NearPoints, NearTask, REACH, SurfaceKernel, SurfaceTask, TRACTION, asked,
};
use super::sweep::{Called, Common, Inlined, Law, Slot, Sweep, Task};
use super::tile::{AddTiles, Sums};
use crate::dilatation::Dilatation;
use crate::dim::{BLOCK, Stencil};
use crate::frame::{Frame, UpdatedLagrangian};
use crate::grid::Node;
use crate::method::{Composition, IntoKernels};
use crate::parallel::Float;
use crate::particles::{Block, Outbox, Sent};
use crate::scheme::{Follow, MapPlace, MuslReturn, Pass, PassKind, Smooth, StressUpdate};
use crate::shape::domain::{MOST_NUMBERS, table};
use crate::shape::{Domain, ShapeFunction};
use crate::transfer::{Flip, Transfer, taken};
use impactite_scene::embedding::{AnySpace, Embedding};

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

    fn of<T: Float, const D: usize, M: Composition<T, D>>(method: &M) -> Self {
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
    /// A method of the same shape function for particles that hold the place of others' ([`super::reference_body`]); none where nodes
    /// do not know accelerations, and in the reference configuration.
    fn for_place(&self) -> Option<Arc<dyn MethodKernels<T, D>>>;
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
        sums: Sums,
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
    /// Weights along an axis and their derivatives, as many as the stencil has nodes, of one particle.
    fn weights(&self, xi: T, half: T) -> [[T; 4]; 2];
    /// Second moment of the weights along an axis.
    fn inertia(&self, xi: T, half: T) -> T;
    /// The half size after a relative elongation, of [`Domain::Axes`].
    fn stretch(&self, half: T, strain: T) -> T;
    /// Weights on all nodes and their derivatives along each axis, of a domain that convects: call `node` for each.
    fn table(&self, xi: &[T; 3], domain: &[T; MOST_NUMBERS], node: &mut dyn FnMut(usize, T, [T; 3]));
}

/// The kernels of a shape function.
pub(super) struct KernelsOfShape<S>(pub(super) S);

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> ShapeKernels<T, D> for KernelsOfShape<S> {
    fn take_in(
        &self,
        block: &mut Block<T, D>,
        sums: (&mut [[T; 4]], &mut u64),
        from: (&Outbox<T>, Sent, usize),
        common: &Common<T>,
        mapped: (Maps, &MigrationPayload),
    ) {
        T::dispatch(Arrivals { shape: &self.0, block, sums, from, common, mapped });
    }
    fn add_tiles(
        &self,
        nodes: &mut [Node<T>],
        slots: &[Slot<T, D>],
        around: [&[u32]; 2],
        sums: Sums,
        two: bool,
    ) {
        T::dispatch(AddTiles::<T, D, S::Extent> { nodes, slots, around, sums, two, extent: PhantomData });
    }
    fn surface_quantity(&self, about: SurfaceTask<'_, T, D>) {
        let said = asked(&about, S::Extent::NODES);
        let (shape, said) = (&self.0, &said[..]);
        match about.what {
            SurfaceQuantity::MassGradient | SurfaceQuantity::VolumeGradient => {
                T::dispatch(SurfaceKernel::<T, D, S, GRADIENT> { shape, about, said });
            }
            SurfaceQuantity::Reach | SurfaceQuantity::LocalReach | SurfaceQuantity::CentreReach => {
                T::dispatch(SurfaceKernel::<T, D, S, REACH> { shape, about, said });
            }
            SurfaceQuantity::Traction => {
                T::dispatch(SurfaceKernel::<T, D, S, TRACTION> { shape, about, said })
            }
        }
    }
    fn near_points(&self, about: NearTask<'_, T, D>, visit: &mut dyn FnMut(u64, &NearPoint<T>)) {
        NearPoints { shape: PhantomData::<S>, about }.visit(visit);
    }
    fn book_loads(&self, task: LoadTask<'_, T, D>) -> T {
        T::dispatch(BookLoads { shape: &self.0, task })
    }
    fn map_loads(&self, task: LoadTask<'_, T, D>) {
        T::dispatch(MapLoads { shape: &self.0, task });
    }
    fn weights(&self, xi: T, half: T) -> [[T; 4]; 2] {
        let along = self.0.weights::<T::Single>(xi.into(), half.into());
        let mut weights = [[T::default(); 4]; 2];
        for a in 0..S::Extent::NODES {
            weights[0][a] = along.value[a].into();
            weights[1][a] = along.slope[a].into();
        }
        weights
    }
    fn inertia(&self, xi: T, half: T) -> T {
        self.0.inertia::<T::Single>(xi.into(), half.into()).into()
    }
    fn stretch(&self, half: T, strain: T) -> T {
        self.0.stretch::<T::Single>(half.into(), strain.into()).into()
    }
    fn table(&self, xi: &[T; 3], domain: &[T; MOST_NUMBERS], node: &mut dyn FnMut(usize, T, [T; 3])) {
        if !S::DOMAIN.convects() {
            return;
        }
        let (xi, domain) = (xi.map(T::Single::from), domain.map(T::Single::from));
        let weights = table::<T, T::Single, S, D>(&xi, &domain);
        for n in 0..S::Extent::NODES * S::Extent::NODES * S::Extent::LAYERS {
            let slope = [weights.slope[0][n], weights.slope[1][n], weights.slope[2][n]];
            node(n, weights.value[n].into(), slope.map(Into::into));
        }
    }
}

/// Something that is asked of a pass as a type.
trait AskPass<A> {
    fn of<K: PassKind>(self) -> A;
}

/// Ask it of a pass of the method `M` by its name; `none` of a pass that the method has not, and that is not compiled.
fn ask<T: Float, const D: usize, M: Composition<T, D>, A>(which: Which, what: impl AskPass<A>, none: A) -> A {
    match which {
        Which::Map => what.of::<<M::Update as StressUpdate>::Map>(),
        Which::Refit if const { <M::Transfer as Transfer<T>>::AFFINE } => {
            what.of::<<M::Update as StressUpdate>::Refit>()
        }
        Which::First => what.of::<<M::Update as StressUpdate>::First>(),
        Which::Second if const { M::Update::REMAP || M::Update::BEFORE_FORCES } => {
            what.of::<<M::Update as StressUpdate>::Second>()
        }
        Which::Smooth if const { <M::Transfer as Transfer<T>>::ORDER > 1 } => what.of::<Smooth>(),
        _ => none,
    }
}

struct AskMaps<T, const D: usize, M>(PhantomData<(T, M)>);
impl<T: Float, const D: usize, M: Composition<T, D>> AskPass<Maps> for AskMaps<T, D, M> {
    fn of<K: PassKind>(self) -> Maps {
        <SpecOf<M, K, T, D> as Spec<T, D>>::MAPS
    }
}

struct AskDoes;
impl AskPass<Pass> for AskDoes {
    fn of<K: PassKind>(self) -> Pass {
        K::DOES
    }
}

/// A pass over a block, the law behind a call.
struct Run<'a, 'b, T: Float, const D: usize, M> {
    method: &'a M,
    shapes: &'a dyn ShapeKernels<T, D>,
    task: Task<'b, T, D>,
}
impl<T: Float, const D: usize, M: Composition<T, D>> AskPass<()> for Run<'_, '_, T, D, M> {
    fn of<K: PassKind>(self) {
        sweep::<T, D, M, K>(self.method, self.shapes, Called, self.task);
    }
}

/// A pass over a block, with its law as part of it: the task, unless no law moves on in the pass.
struct RunInlined<'a, 'b, T: Float, const D: usize, M, C> {
    run: Run<'a, 'b, T, D, M>,
    law: &'a C,
}
impl<'b, T, const D: usize, M, C> AskPass<Option<Task<'b, T, D>>> for RunInlined<'_, 'b, T, D, M, C>
where
    T: Float,
    M: Composition<T, D>,
    C: Constitutive<T>,
{
    fn of<K: PassKind>(self) -> Option<Task<'b, T, D>> {
        let Run { method, shapes, task } = self.run;
        // Where no law is asked, and where it is asked once in a run, the pass is the same.
        if const { K::DOES.strain.is_none() } {
            return Some(task);
        }
        sweep::<T, D, M, K>(method, shapes, Inlined(self.law.clone()), task);
        None
    }
}

fn sweep<T: Float, const D: usize, M: Composition<T, D>, K: PassKind>(
    method: &M,
    shapes: &dyn ShapeKernels<T, D>,
    law: impl Law<T>,
    task: Task<'_, T, D>,
) {
    let transfer = K::transfer::<T, M::Transfer>(*method.transfer());
    let (shape, transfer, pass) = (method.shape(), &transfer, PhantomData);
    T::dispatch(Sweep::<'_, T, D, SpecOf<M, K, T, D>, _> { shape, transfer, law, shapes, task, pass });
}

/// The kernels of a method, laws behind a call.
struct KernelsOf<M, S> {
    method: M,
    shape: KernelsOfShape<S>,
    facts: Facts,
}

impl<T: Float, const D: usize, M: Composition<T, D>> MethodKernels<T, D> for KernelsOf<M, M::Shape> {
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn sweep(&self, which: Which, task: Task<'_, T, D>) {
        ask::<T, D, M, _>(which, Run { method: &self.method, shapes: &self.shape, task }, ());
    }
    fn maps(&self, which: Which) -> Maps {
        ask::<T, D, M, _>(which, AskMaps::<T, D, M>(PhantomData), Maps::NOTHING)
    }
    fn does(&self, which: Which) -> Pass {
        ask::<T, D, M, _>(which, AskDoes, Pass::NOTHING)
    }
    fn taken(&self, dt: T) -> T {
        taken(self.method.transfer(), dt)
    }
    fn shape(&self) -> &dyn ShapeKernels<T, D> {
        &self.shape
    }
    fn for_place(&self) -> Option<Arc<dyn MethodKernels<T, D>>> {
        if const { !M::Transfer::READS_INCREMENT || M::Transfer::ORDER > 1 || M::Frame::TOTAL } {
            return None;
        }
        let facts = Facts {
            before_forces: false,
            remap: true,
            maps_together: false,
            maps_force: false,
            total: false,
            mean: false,
            reads_increment: true,
            affine: false,
            least_squares: false,
            order: 1,
            ..self.facts.clone()
        };
        Some(Arc::new(PlaceKernels { shape: KernelsOfShape(*self.method.shape()), facts }))
    }
}

/// The same with the law of one body as part of the passes in which it moves on.
struct InlinedKernels<T: Float, const D: usize, M, C> {
    of: Arc<dyn MethodKernels<T, D>>,
    method: M,
    law: C,
}

impl<T, const D: usize, M, C> MethodKernels<T, D> for InlinedKernels<T, D, M, C>
where
    T: Float,
    M: Composition<T, D>,
    C: Constitutive<T>,
{
    fn facts(&self) -> &Facts {
        self.of.facts()
    }
    fn sweep(&self, which: Which, task: Task<'_, T, D>) {
        let run = Run { method: &self.method, shapes: self.of.shape(), task };
        // A pass that the method has not is none with the law either.
        if let Some(task) = ask::<T, D, M, _>(which, RunInlined { run, law: &self.law }, None) {
            self.of.sweep(which, task);
        }
    }
    fn maps(&self, which: Which) -> Maps {
        self.of.maps(which)
    }
    fn does(&self, which: Which) -> Pass {
        self.of.does(which)
    }
    fn taken(&self, dt: T) -> T {
        self.of.taken(dt)
    }
    fn shape(&self) -> &dyn ShapeKernels<T, D> {
        self.of.shape()
    }
    fn for_place(&self) -> Option<Arc<dyn MethodKernels<T, D>>> {
        self.of.for_place()
    }
}

/// The kernels of particles that hold the place of others' on a grid: they map mass and velocity, take what the nodes get, and go where
/// they are placed.
struct PlaceKernels<S> {
    shape: KernelsOfShape<S>,
    facts: Facts,
}

impl<S> PlaceKernels<S> {
    fn run<T: Float, const D: usize, K: PassKind>(&self, task: Task<'_, T, D>)
    where
        S: ShapeFunction<T, D>,
    {
        let (shape, transfer, pass) = (&self.shape.0, &K::transfer::<T, Flip>(Flip), PhantomData);
        let shapes = &self.shape;
        type Of<S, K, T> = PassOf<S, <K as PassKind>::Transfer<T, Flip>, AnySpace, UpdatedLagrangian, K>;
        T::dispatch(Sweep::<'_, T, D, Of<S, K, T>, _> { shape, transfer, law: Called, shapes, task, pass });
    }
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> MethodKernels<T, D> for PlaceKernels<S> {
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn sweep(&self, which: Which, task: Task<'_, T, D>) {
        match which {
            Which::Map => self.run::<T, D, MapPlace>(task),
            Which::First => self.run::<T, D, MuslReturn>(task),
            Which::Follow => self.run::<T, D, Follow>(task),
            Which::Refit | Which::Second | Which::Smooth => {}
        }
    }
    fn maps(&self, which: Which) -> Maps {
        let momentum = matches!(which, Which::Map | Which::First);
        Maps { momentum, convected: S::DOMAIN.convects(), ..Maps::NOTHING }
    }
    fn does(&self, which: Which) -> Pass {
        match which {
            Which::Map => MapPlace::DOES,
            Which::First => MuslReturn::DOES,
            Which::Follow => Follow::DOES,
            Which::Refit | Which::Second | Which::Smooth => Pass::NOTHING,
        }
    }
    fn taken(&self, _: T) -> T {
        T::default()
    }
    fn shape(&self) -> &dyn ShapeKernels<T, D> {
        &self.shape
    }
    fn for_place(&self) -> Option<Arc<dyn MethodKernels<T, D>>> {
        None
    }
}

/// The kernels of a method.
pub(crate) fn kernels<T: Float, const D: usize, M: Composition<T, D>>(
    method: M,
) -> Arc<dyn MethodKernels<T, D>> {
    Arc::new(of(method))
}

/// The kernels of a method for the bodies of one law.
pub(crate) fn inlined<T, const D: usize, M, C>(method: M, law: C) -> Arc<dyn MethodKernels<T, D>>
where
    T: Float,
    M: Composition<T, D> + IntoKernels<T, D>,
    C: Constitutive<T>,
{
    Arc::new(InlinedKernels { of: method.into_kernels().kernels, method, law })
}

fn of<T: Float, const D: usize, M: Composition<T, D>>(method: M) -> KernelsOf<M, M::Shape> {
    KernelsOf { shape: KernelsOfShape(*method.shape()), facts: Facts::of(&method), method }
}
