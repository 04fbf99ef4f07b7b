//! Lifting: the part of jumps in the gradient.

use impactite_simd::{Arch, Kernel, Vectors};

use super::deform::Trace;
use crate::sides::{Sides, Surface};
use crate::vector::{Tensor, add_dyad, zero};

/// Return the jump of the displacement across a face, m: on the side of the cell, minus that on the other one.
#[inline(always)]
pub(crate) fn jump<const D: usize>(own: &Trace<D>, other: &Trace<D>, surface: &Surface<D>) -> [f64; D] {
    let (mut here, there) = (own.at(&surface.own), other.at(&surface.other));
    for d in 0..D {
        here[d] -= there[d];
    }
    here
}

/// Lifting of some cells: sum over intact faces of A/2 [u] (x) N.
pub(crate) struct Lift<'a, const D: usize> {
    pub sides: &'a Sides<D>,
    pub traces: &'a [Trace<D>],
    pub first: usize,
    pub out: &'a mut [Tensor<D>],
}

impl<const D: usize> Kernel<f64> for Lift<'_, D> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Lift { sides, traces, first, out } = self;
        for (n, out) in out.iter_mut().enumerate() {
            *out = lifting(sides, traces, first + n);
        }
    }
}

/// Return the lifting of a cell.
#[inline(always)]
pub(crate) fn lifting<const D: usize>(sides: &Sides<D>, traces: &[Trace<D>], cell: usize) -> Tensor<D> {
    let mut sum = zero();
    let range = sides.intact_of(cell);
    for (&j, surface) in sides.neighbour[range.clone()].iter().zip(&sides.surface[range]) {
        add_dyad(&mut sum, 0.5, &jump(&traces[cell], &traces[j as usize], surface), &surface.area);
    }
    sum
}
