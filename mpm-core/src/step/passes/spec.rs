//! Specification of a pass of a method, as a type for which its kernels are compiled.

use std::marker::PhantomData;

use super::spread::Maps;
use crate::frame::Frame;
use crate::method::Composition;
use crate::scheme::{Pass, PassKind};
use crate::shape::ShapeFunction;
use crate::transfer::Transfer;
use impactite_scene::embedding::Embedding;
use impactite_simd::{Float, Vectors};

/// Pass, with the properties of its method that it needs.
pub(in crate::step) trait Spec<T: Float, const D: usize>: Send + Sync + 'static {
    /// The shape function.
    type Shape: ShapeFunction<T, D>;
    /// Transfer, if velocities change.
    type Transfer: Transfer<T>;
    /// Operations of the pass.
    const DOES: Pass;
    /// Vector extensions for which its kernels are compiled.
    const VECTORS: Vectors;
    /// True if the third direction is the hoop direction around an axis.
    const HOOP: bool;
    /// True if weights are evaluated in the reference configuration.
    const TOTAL: bool;
    /// Quantities that the pass maps.
    const MAPS: Maps;
}

/// The pass `K` with the shape function `S`, the transfer `X`, the embedding `E` and the frame `F`.
pub(in crate::step) struct PassOf<S, X, E, F, K>(PhantomData<(S, X, E, F, K)>);

impl<T, const D: usize, S, X, E, F, K> Spec<T, D> for PassOf<S, X, E, F, K>
where
    T: Float,
    S: ShapeFunction<T, D>,
    X: Transfer<T>,
    E: Embedding<D>,
    F: Frame,
    K: PassKind,
{
    type Shape = S;
    type Transfer = X;
    const DOES: Pass = K::DOES;
    const VECTORS: Vectors = match K::VECTORS {
        Vectors::Avx512 if D < 3 => Vectors::Avx2,
        vectors => vectors,
    };
    const HOOP: bool = E::HOOP;
    const TOTAL: bool = F::TOTAL;
    const MAPS: Maps = Maps {
        momentum: K::DOES.momentum,
        affine: K::DOES.velocity && K::DOES.momentum && X::AFFINE,
        force: K::DOES.force,
        direct: K::DOES.force && E::HOOP,
        together: K::DOES.force && K::DOES.momentum && K::PLANS && !X::READS_INCREMENT,
        least_squares: K::DOES.force && X::LEAST_SQUARES,
        convected: S::DOMAIN.convects(),
    };
}

/// Pass `K` of the method `M`, reduced to the components that the pass needs.
pub(in crate::step) type SpecOf<M, K, T, const D: usize> = PassOf<
    <M as Composition<T, D>>::Shape,
    <K as PassKind>::Transfer<T, <M as Composition<T, D>>::Transfer>,
    <K as PassKind>::Embedding<D, <M as Composition<T, D>>::Embedding>,
    <K as PassKind>::Frame<<M as Composition<T, D>>::Frame>,
    K,
>;

/// The stencil of a pass.
pub(in crate::step) type ExtentOf<P, T, const D: usize> =
    <<P as Spec<T, D>>::Shape as ShapeFunction<T, D>>::Extent;
