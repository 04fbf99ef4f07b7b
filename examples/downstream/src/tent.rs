//! Linear shape function averaged with a tent: three nodes per axis like the quadratic B-spline, but a continuous second derivative.
//!
//! With S the twice integrated tent of half width 1/2 and area 1 (a ramp with a rounded foot),
//! N(x) = S(x + 1) - 2 S(x) + S(x - 1).

use impactite::materials::{Lane, Real};
use impactite::mpm::dim::{Extent, Stencil};
use impactite::mpm::shape::Weights;
use impactite::mpm::{AffineShape, FixedDomain, ShapeFunction};

/// Tent-averaged linear shape function; see the module.
#[derive(Clone, Copy, Debug, Default)]
pub struct TentAveragedHat;

/// Return S and its derivative, for |x| <= 1/2.
#[inline(always)]
fn ramp<L: Lane>(x: L) -> (L, L) {
    let foot = L::of(0.5) - x.abs();
    let (cube, square) = (L::of(2.0 / 3.0) * foot * foot * foot, L::of(2.0) * foot * foot);
    let rising = L::zero().lt(x);
    (L::select(rising, x + cube, cube), L::select(rising, L::one() - square, square))
}

impl<T: Real, const D: usize> ShapeFunction<T, D> for TentAveragedHat
where
    Extent<D, 3>: Stencil,
{
    type Extent = Extent<D, 3>;
    const USL_LIMIT: f64 = 0.5;
    const NAME: &'static str = "tent-averaged linear shape function";

    #[inline(always)]
    fn weights<L: Lane<Real = T>>(&self, xi: L, _half: L) -> Weights<L, Self::Extent> {
        let mut w: Weights<L, Extent<D, 3>> = Weights::zero();
        (w.value[2], w.slope[2]) = ramp(xi);
        let (value, slope) = ramp(-xi);
        (w.value[0], w.slope[0]) = (value, -slope);
        w.value[1] = L::one() - w.value[0] - w.value[2];
        w.slope[1] = -w.slope[0] - w.slope[2];
        w
    }
}

impl AffineShape for TentAveragedHat {}
impl FixedDomain for TentAveragedHat {}
