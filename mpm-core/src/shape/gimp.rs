//! Generalised interpolation: the linear shape function averaged over the particle's box (book, "GIMP").

use mpm_materials::{Lane, Real};

use super::{AffineShape, Domain, FixedDomain, ShapeFunction, Weights};
use crate::dim::{Extent, Stencil};

/// Uniform GIMP: the particle's box keeps its initial size; its half size is at most half a cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gimp;

/// Contiguous-particle GIMP: the box follows the stretch along each axis, so that boxes tile as long as the deformation is
/// axis-aligned. Half sizes are clamped to \[0.05 h, 0.5 h\].
///
/// The half size is integrated, l <- l (1 + d_eps_dd): a rigid rotation leaves it unchanged, whereas a box scaled by the
/// diagonal of F would vanish at 90 degrees.
#[derive(Clone, Copy, Debug, Default)]
pub struct CpGimp;

#[inline(always)]
fn weights<L: Lane, E: Stencil>(xi: L, half: L) -> Weights<L, E> {
    let one = L::one();
    let per_half = half.recip();
    let mut w: Weights<L, E> = Weights::zero();
    // Node of the bin: the box rounds the tip of the linear shape function.
    let r = xi.abs();
    let tip = r.le(half);
    w.value[1] = L::select(tip, one - (xi * xi + half * half) * per_half * L::of(0.5), one - r);
    let away = L::select(xi.lt(L::zero()), one, -one);
    w.slope[1] = L::select(tip, -(xi * per_half), away);
    // Outer nodes: the linear shape function, or its quadratic tail if the box extends past its support.
    for (node, toward) in [(0, -one), (2, one)] {
        let distance = one - toward * xi;
        let reach = (one + half - distance).max(L::zero());
        let tail = (one - half).lt(distance);
        let t = reach * per_half * L::of(0.5);
        w.value[node] = L::select(tail, t * reach * L::of(0.5), one - distance);
        w.slope[node] = toward * L::select(tail, t, one);
    }
    w
}

impl<T: Real, const D: usize> ShapeFunction<T, D> for Gimp
where
    Extent<D, 3>: Stencil,
{
    type Extent = Extent<D, 3>;
    const USL_LIMIT: f64 = 0.5;
    const NAME: &'static str = "uGIMP";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, half: L) -> Weights<L, Self::Extent> {
        weights(xi, half)
    }
}

impl AffineShape for Gimp {}
impl FixedDomain for Gimp {}

impl<T: Real, const D: usize> ShapeFunction<T, D> for CpGimp
where
    Extent<D, 3>: Stencil,
{
    type Extent = Extent<D, 3>;
    const DOMAIN: Domain = Domain::Axes;
    const USL_LIMIT: f64 = 0.5;
    const NAME: &'static str = "cpGIMP";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, half: L) -> Weights<L, Self::Extent> {
        weights(xi, half)
    }

    #[inline(always)]
    fn stretch<L: Lane<Real = T>>(&self, half: L, strain: L) -> L {
        strain.mul_add(half, half).clamp(L::of(0.05), L::of(0.5))
    }
}

impl AffineShape for CpGimp {}
