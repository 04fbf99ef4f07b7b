//! Kernels of a method, compiled from its components.

use std::marker::PhantomData;
use std::sync::Arc;

use mpm_contact::{NearPoint, SurfaceQuantity};
use mpm_materials::Constitutive;

use super::kernels::{Facts, MethodKernels, ShapeKernels};
use super::loads::{BookLoads, CarryVelocity, LoadTask, MapLoads};
use super::migrate::{Arrivals, MigrationPayload, Sums};
use super::slot::{Common, Slot, Task};
use super::spec::{PassOf, Spec, SpecOf};
use super::spread::Maps;
use super::surface_quantity::{
    GRADIENT, NearPoints, NearTask, REACH, SurfaceKernel, SurfaceTask, TRACTION, asked,
};
use super::sweep::{Called, Inlined, Law, Sweep};
use crate::dim::Stencil;
use crate::frame::{Frame, UpdatedLagrangian};
use crate::grid::Node;
use crate::method::Composition;
use crate::particles::{Block, Outbox, Sent};
use crate::scheme::{Follow, MapPlace, MuslReturn, Pass, PassKind, Smooth, StressUpdate};
use crate::shape::ShapeFunction;
use crate::shape::domain::{MOST_NUMBERS, table};
use crate::step::bodies::body::Which;
use crate::step::nodes::add_tiles::AddTiles;
use crate::step::nodes::layout::NodeSums;
use crate::transfer::{Flip, Transfer, taken};
use impactite_scene::embedding::AnySpace;
use impactite_simd::Float;

/// Kernels of a shape function.
pub(in crate::step) struct KernelsOfShape<S>(pub(in crate::step) S);

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> ShapeKernels<T, D> for KernelsOfShape<S> {
    fn take_in(
        &self,
        block: &mut Block<T, D>,
        sums: Sums<'_, T>,
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
        sums: NodeSums,
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
    fn carry_velocity(&self, task: LoadTask<'_, T, D>) {
        T::dispatch(CarryVelocity { shape: &self.0, task });
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

/// Query that a pass type answers.
trait AskPass<A> {
    fn of<K: PassKind>(self) -> A;
}

/// Evaluate the query `what` for the pass `which` of the method `M`; `none` for passes that the method lacks, which are not
/// compiled.
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

/// Pass over a block with a dynamically called constitutive law.
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

/// Pass over a block with an inlined constitutive law. Returns the task unprocessed if the pass does not update the law.
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
        // Passes without a law, or with one that is evaluated once per run, are those of the dynamically called law.
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

/// Kernels of a method with dynamically called constitutive laws.
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
    fn for_place(&self, forces: bool) -> Option<Arc<dyn MethodKernels<T, D>>> {
        if const { !M::Transfer::READS_INCREMENT || M::Transfer::ORDER > 1 || M::Frame::TOTAL } {
            return None;
        }
        let facts = Facts {
            before_forces: false,
            remap: true,
            maps_together: false,
            maps_force: forces,
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

/// Kernels of a method with the law of one body inlined in the passes that update it.
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
        // The result is `None`, too, for passes that the method lacks.
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
    fn for_place(&self, forces: bool) -> Option<Arc<dyn MethodKernels<T, D>>> {
        self.of.for_place(forces)
    }
}

/// Kernels of proxy particles, which represent particles of another solver on a grid: they map mass and velocity, gather
/// nodal velocity changes, and follow prescribed positions.
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
    fn for_place(&self, _: bool) -> Option<Arc<dyn MethodKernels<T, D>>> {
        None
    }
}

/// Compile the kernels of a method, with dynamically called laws.
pub(crate) fn kernels<T: Float, const D: usize, M: Composition<T, D>>(
    method: M,
) -> Arc<dyn MethodKernels<T, D>> {
    Arc::new(of(method))
}

/// Compile the kernels of a method for the bodies of one law, which is inlined; `of` has those with dynamically called
/// laws.
pub(crate) fn inlined<T, const D: usize, M, C>(
    method: M,
    of: Arc<dyn MethodKernels<T, D>>,
    law: C,
) -> Arc<dyn MethodKernels<T, D>>
where
    T: Float,
    M: Composition<T, D>,
    C: Constitutive<T>,
{
    Arc::new(InlinedKernels { of, method, law })
}

fn of<T: Float, const D: usize, M: Composition<T, D>>(method: M) -> KernelsOf<M, M::Shape> {
    KernelsOf { shape: KernelsOfShape(*method.shape()), facts: Facts::of(&method), method }
}
