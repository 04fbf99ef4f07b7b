//! Linear shape function.

use mpm_materials::{Lane, Real};

use super::{Basis, FixedDomain, ShapeFunction, Weights};
use crate::dim::{Extent, Stencil};

/// Linear shape functions: the classic material point method. Two nodes per axis; the slope jumps when a particle crosses a
/// cell face. Use with MUSL: with USL the time step limit vanishes if a cell contains little material (book, "Properties of
/// stress updates and transfers", finding 5).
#[derive(Clone, Copy, Debug, Default)]
pub struct Linear;

impl<T: Real, const D: usize> ShapeFunction<T, D> for Linear
where
    Extent<D, 2>: Stencil,
{
    type Extent = Extent<D, 2>;
    const POLYNOMIAL: bool = true;
    const USL_LIMIT: f64 = 0.5;
    const NAME: &'static str = "linear";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, _half: L) -> Weights<L, Self::Extent> {
        let (half, one) = (L::of(0.5), L::one());
        let mut w: Weights<L, Extent<D, 2>> = Weights::zero();
        w.value[0] = half - xi;
        // Never zero: a particle exactly on a face would map no mass to the far node, but its slope would still use the
        // undefined velocity of that node.
        w.value[1] = (half + xi).max(L::splat(T::default_epsilon()));
        w.slope[0] = -one;
        w.slope[1] = one;
        w
    }

    #[inline(always)]
    fn coefficients<L: Lane<Real = T>>(
        nodes: <Self::Extent as Stencil>::Axis<L>,
    ) -> <Self::Extent as Stencil>::Axis<L> {
        let mut c = nodes;
        c[0] = (nodes[0] + nodes[1]) * L::of(0.5);
        c[1] = nodes[1] - nodes[0];
        c
    }

    #[inline(always)]
    fn basis<L: Lane<Real = T>>(&self, xi: L, _half: L, _fit: bool) -> Basis<L, Self::Extent> {
        let mut basis: Basis<L, Extent<D, 2>> = Basis::zero();
        basis.value[1] = xi;
        basis
    }
}

impl FixedDomain for Linear {}
