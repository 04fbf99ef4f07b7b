//! Methods with compiled kernels, and scenes built from them.

use std::sync::Arc;

use mpm_materials::{Constitutive, IntoMaterial};

use crate::contact::{ContactAlgorithm, OneField};
use crate::grid::GridStorage;
use crate::method::{CompiledHere, Composition};
use crate::step::passes::compiled::{inlined, kernels};
use crate::step::{Deformable, Kernels, Mpm, Scalar};
use impactite_simd::Float;

/// Methods that a scene accepts: those with kernels compiled in this crate (the implementors below; book, "What is
/// compiled where"), any other by [`Method::compiled`](crate::Method::compiled), and existing kernels.
#[diagnostic::on_unimplemented(
    message = "a scene of {D} dimensions cannot have the method `{Self}`: its kernels are not compiled in `mpm-core`",
    note = "the embedding must have the dimensions of the grid's lattice: in two take `PlaneStrain` or `Axisymmetric`, in three `FullSpace`",
    note = "if it has, compile the kernels in your crate, once, for some seconds: `method.compiled()`"
)]
pub trait IntoKernels<T: Float, const D: usize> {
    /// Return the kernels of the method.
    fn into_kernels(self) -> Kernels<T, D>;
}

impl<T: Float, const D: usize> IntoKernels<T, D> for Kernels<T, D> {
    fn into_kernels(self) -> Kernels<T, D> {
        self
    }
}

impl<T: Scalar<D>, const D: usize, M: Composition<T, D>> IntoKernels<T, D> for CompiledHere<M> {
    fn into_kernels(self) -> Kernels<T, D> {
        Kernels::new(kernels(self.0), T::WORK)
    }
}

/// Grid for the method `M`.
///
/// The bound is on the grid, so that a scene has the dimensions of its lattice. For an embedding of other dimensions
/// the compiler then reports the embedding, and not the grid, the seeds and the boundaries.
pub trait GridFor<M, T: Float, const D: usize>: GridStorage<T, D> {
    /// Return the kernels of the method.
    fn kernels(method: M) -> Kernels<T, D>;
}
impl<G: GridStorage<T, D>, M: IntoKernels<T, D>, T: Float, const D: usize> GridFor<M, T, D> for G {
    fn kernels(method: M) -> Kernels<T, D> {
        method.into_kernels()
    }
}

impl<const D: usize> Mpm<D> {
    /// Create an empty scene in double precision from a method ([`IntoKernels`]) and a grid ([`GridStorage`]) of the
    /// same dimensions. Its bodies share one velocity field.
    ///
    /// ```
    /// use mpm_core::geometry::Lattice;
    /// use mpm_core::{BlockGrid, Flip, FullSpace, Linear, Method, Mpm, Musl};
    ///
    /// // One type, whatever the scene is made of: it can be a field of a struct, and be chosen at run time.
    /// fn scene(spacing: f64) -> Result<Mpm<3>, Box<dyn std::error::Error>> {
    ///     let grid = BlockGrid::new(Lattice::new([0.0; 3], spacing)?);
    ///     Ok(Mpm::new(Method::new(Linear, Flip, Musl, FullSpace), grid))
    /// }
    /// # assert_eq!(scene(0.1).unwrap().particles(), 0);
    /// ```
    pub fn new<M>(method: M, grid: impl GridFor<M, f64, D> + 'static) -> Self {
        Mpm::with_contact(method, grid, OneField)
    }

    /// Create an empty scene in double precision with a contact algorithm between its bodies.
    pub fn with_contact<M>(
        method: M,
        grid: impl GridFor<M, f64, D> + 'static,
        contact: impl ContactAlgorithm<f64, D>,
    ) -> Self {
        Mpm::of(method, grid, contact)
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Create an empty scene in any precision: `Mpm::<3, f32>::of(method, grid, OneField)`. All three arguments may
    /// be objects chosen at run time: [`Kernels`], `Box<dyn GridStorage<T, D>>`, `Arc<dyn ContactAlgorithm<T, D>>`.
    pub fn of<M, G>(method: M, grid: G, contact: impl ContactAlgorithm<T, D>) -> Self
    where
        G: GridFor<M, T, D> + 'static,
    {
        Self::of_parts(G::kernels(method), Box::new(grid), Arc::new(contact))
    }
}

impl<'a, const D: usize, L: IntoMaterial<T>, T: Float> Deformable<'a, D, L, T> {
    /// Inline the law into the passes, which are compiled at the call: the last per cent of speed for one
    /// composition, at the cost of compiling the passes once more for this law. `method` must be that of the scene.
    #[must_use]
    pub fn inlined<M, C>(mut self, method: M) -> Self
    where
        L: IntoMaterial<T, Law = C>,
        M: Composition<T, D> + IntoKernels<T, D>,
        C: Constitutive<T>,
    {
        self.kernels = Some(inlined(method, method.into_kernels().kernels, self.law.law()));
        self
    }
}
