//! Integration rules of elements.

use std::marker::PhantomData;

use mpm_materials::Lane;

use crate::shape::{Gradient, Modes, Shape};

/// Integration rule of an element.
pub(super) trait Rule: Send + Sync + 'static {
    /// True for one integration point with the mean gradient.
    const ONE: bool = false;
    /// True with hourglass control.
    const CONTROL: bool = false;
    /// True if every point has the mean dilatation of the element.
    const DILATATION: bool = false;
    /// True if volumes and mean stresses are averaged over the nodes.
    const AVERAGED: bool = false;
}

/// One point with hourglass control.
pub(super) struct OnePoint;
impl Rule for OnePoint {
    const ONE: bool = true;
    const CONTROL: bool = true;
}
/// Full integration.
pub(super) struct Full;
impl Rule for Full {}
/// Full integration with mean dilatation.
pub(super) struct MeanDilatation;
impl Rule for MeanDilatation {
    const DILATATION: bool = true;
}
/// Constant strain with averaged nodal volumes.
pub(super) struct Averaged;
impl Rule for Averaged {
    const AVERAGED: bool = true;
}

/// Elements of shape `S` with rule `R`, around an axis if `HOOP`.
pub(super) struct Solid<S, R, const HOOP: bool>(PhantomData<fn() -> (S, R)>);

impl<S: Shape, R: Rule, const HOOP: bool> Solid<S, R, HOOP> {
    pub const POINTS: usize = if R::ONE { 1 } else { S::POINTS };
    /// Number of hourglass forces, and of their energy.
    pub const KEPT: usize = if R::CONTROL { (S::NODES - S::FIRST) * S::DIM + 1 } else { 0 };

    pub fn new() -> Self {
        Solid(PhantomData)
    }

    /// Gradient at a point.
    #[inline(always)]
    pub fn gradient<P: Lane>(x: &Modes<P>, point: usize) -> Gradient<P> {
        if R::ONE { S::mean(x, HOOP) } else { S::at(x, point, HOOP) }
    }
}
