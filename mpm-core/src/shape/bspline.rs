//! Uniform B-splines.

use mpm_materials::{Lane, Real};

use super::{AffineShape, ShapeFunction, Weights};
use crate::dim::{Extent, Stencil};

/// Quadratic B-spline: three nodes an axis, continuous gradient.
#[derive(Clone, Copy, Debug, Default)]
pub struct QuadraticBSpline;

impl<T: Real, const D: usize> ShapeFunction<T, D> for QuadraticBSpline
where
    Extent<D, 3>: Stencil,
{
    type Extent = Extent<D, 3>;
    const USL_LIMIT: f64 = 0.59;
    const NAME: &'static str = "quadratic B-spline";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, _half: L) -> Weights<L, Self::Extent> {
        let half = L::of(0.5);
        let (left, right) = (half - xi, half + xi);
        let mut w: Weights<L, Extent<D, 3>> = Weights::zero();
        w.value[0] = half * left * left;
        w.value[1] = L::of(0.75) - xi * xi;
        w.value[2] = half * right * right;
        w.slope[0] = -left;
        w.slope[1] = -(xi + xi);
        w.slope[2] = right;
        w
    }

    #[inline(always)]
    fn inertia<L: Lane<Real = T>>(&self, _xi: L, _half: L) -> L {
        L::of(0.25)
    }
}

impl<T: Real, const D: usize> AffineShape<T, D> for QuadraticBSpline where Extent<D, 3>: Stencil {}

/// Cubic B-spline: four nodes an axis, continuous second derivative.
#[derive(Clone, Copy, Debug, Default)]
pub struct CubicBSpline;

impl<T: Real, const D: usize> ShapeFunction<T, D> for CubicBSpline
where
    Extent<D, 4>: Stencil,
{
    type Extent = Extent<D, 4>;
    const USL_LIMIT: f64 = 0.9;
    const NAME: &'static str = "cubic B-spline";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, _half: L) -> Weights<L, Self::Extent> {
        let (half, sixth, two_thirds) = (L::of(0.5), L::of(1.0 / 6.0), L::of(2.0 / 3.0));
        // Distances to the two inner nodes.
        let (l, r) = (half + xi, half - xi);
        let mut w: Weights<L, Extent<D, 4>> = Weights::zero();
        w.value[0] = sixth * r * r * r;
        w.value[1] = (half * l - L::one()) * l * l + two_thirds;
        w.value[2] = (half * r - L::one()) * r * r + two_thirds;
        w.value[3] = sixth * l * l * l;
        w.slope[0] = -(half * r * r);
        w.slope[1] = (L::of(1.5) * l - L::of(2.0)) * l;
        w.slope[2] = -((L::of(1.5) * r - L::of(2.0)) * r);
        w.slope[3] = half * l * l;
        w
    }

    #[inline(always)]
    fn inertia<L: Lane<Real = T>>(&self, _xi: L, _half: L) -> L {
        L::of(1.0 / 3.0)
    }
}

impl<T: Real, const D: usize> AffineShape<T, D> for CubicBSpline where Extent<D, 4>: Stencil {}
