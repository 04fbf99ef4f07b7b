//! The linear hat.

use mpm_materials::{Lane, Real};

use super::{ShapeFunction, Weights};
use crate::dim::{Extent, Stencil};

/// Linear hat functions: the classic material point method. Two nodes an axis; the slope jumps when a particle
/// crosses a cell face. Use with MUSL: with USL the step limit vanishes where a cell holds little material
/// (accuracy.md 1.1, finding 5).
#[derive(Clone, Copy, Debug, Default)]
pub struct Linear;

impl<T: Real, const D: usize> ShapeFunction<T, D> for Linear
where
    Extent<D, 2>: Stencil,
{
    type Extent = Extent<D, 2>;
    const USL_LIMIT: f64 = 0.5;
    const NAME: &'static str = "linear";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, _half: L) -> Weights<L, Self::Extent> {
        let (half, one) = (L::of(0.5), L::one());
        let mut w: Weights<L, Extent<D, 2>> = Weights::zero();
        w.value[0] = half - xi;
        w.value[1] = half + xi;
        w.slope[0] = -one;
        w.slope[1] = one;
        w
    }
}
