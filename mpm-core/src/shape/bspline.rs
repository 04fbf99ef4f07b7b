//! Uniform B-splines.

use mpm_materials::{Lane, Real};

use super::{AffineShape, Basis, FixedDomain, ShapeFunction, Weights};
use crate::dim::{Extent, Stencil};
use crate::grid::Halving;

/// Quadratic B-spline: three nodes per axis, continuous gradient.
#[derive(Clone, Copy, Debug, Default)]
pub struct QuadraticBSpline;

impl<T: Real, const D: usize> ShapeFunction<T, D> for QuadraticBSpline
where
    Extent<D, 3>: Stencil,
{
    type Extent = Extent<D, 3>;
    const POLYNOMIAL: bool = true;
    const HALVING: Option<Halving> = Some(Halving::Quadratic);
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
    fn coefficients<L: Lane<Real = T>>(
        nodes: <Self::Extent as Stencil>::Axis<L>,
    ) -> <Self::Extent as Stencil>::Axis<L> {
        let (sides, half) = (nodes[0] + nodes[2], L::of(0.5));
        let mut c = nodes;
        c[0] = sides.mul_add(L::of(0.125), nodes[1] * L::of(0.75));
        c[1] = (nodes[2] - nodes[0]) * half;
        c[2] = sides.mul_add(half, -nodes[1]);
        c
    }

    #[inline(always)]
    fn basis<L: Lane<Real = T>>(&self, xi: L, _half: L, _fit: bool) -> Basis<L, Self::Extent> {
        let square = xi * xi;
        let mut basis: Basis<L, Extent<D, 3>> = Basis::zero();
        basis.value[1] = xi;
        basis.value[2] = square;
        basis.slope[2] = xi + xi;
        basis.fit[2] = xi * (L::of(3.0) - L::of(4.0) * square);
        basis
    }

    #[inline(always)]
    fn inertia<L: Lane<Real = T>>(&self, _xi: L, _half: L) -> L {
        L::of(0.25)
    }
}

impl AffineShape for QuadraticBSpline {}
impl FixedDomain for QuadraticBSpline {}

/// Cubic B-spline: four nodes per axis, continuous second derivative.
#[derive(Clone, Copy, Debug, Default)]
pub struct CubicBSpline;

impl<T: Real, const D: usize> ShapeFunction<T, D> for CubicBSpline
where
    Extent<D, 4>: Stencil,
{
    type Extent = Extent<D, 4>;
    const POLYNOMIAL: bool = true;
    const HALVING: Option<Halving> = Some(Halving::Cubic);
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
    fn coefficients<L: Lane<Real = T>>(
        nodes: <Self::Extent as Stencil>::Axis<L>,
    ) -> <Self::Extent as Stencil>::Axis<L> {
        // Weights expanded about the centre of the bin, e.g. (1/2 - xi)^3 / 6 for the first node.
        let (outer, inner) = (nodes[0] + nodes[3], nodes[1] + nodes[2]);
        let (across, between) = (nodes[3] - nodes[0], nodes[2] - nodes[1]);
        let mut c = nodes;
        c[0] = outer.mul_add(L::of(1.0 / 48.0), inner * L::of(23.0 / 48.0));
        c[1] = across.mul_add(L::of(1.0 / 8.0), between * L::of(5.0 / 8.0));
        c[2] = (outer - inner) * L::of(0.25);
        c[3] = across.mul_add(L::of(1.0 / 6.0), between * L::of(-0.5));
        c
    }

    #[inline(always)]
    fn basis<L: Lane<Real = T>>(&self, xi: L, _half: L, _fit: bool) -> Basis<L, Self::Extent> {
        let square = xi * xi;
        let mut basis: Basis<L, Extent<D, 4>> = Basis::zero();
        basis.value[1] = xi;
        basis.value[2] = square;
        basis.value[3] = square * xi;
        basis.slope[2] = xi + xi;
        basis.slope[3] = square * L::of(3.0);
        // 3 sum_a N_a (a - xi) p_a, with the nodal values p of xi^2 and of xi^3.
        basis.fit[2] = xi + xi;
        basis.fit[3] = (L::of(4.5) - L::of(3.0) * square) * square - L::of(3.0 / 16.0);
        basis
    }

    #[inline(always)]
    fn inertia<L: Lane<Real = T>>(&self, _xi: L, _half: L) -> L {
        L::of(1.0 / 3.0)
    }
}

impl AffineShape for CubicBSpline {}
impl FixedDomain for CubicBSpline {}
