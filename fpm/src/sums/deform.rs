//! Displacement gradients.

use impactite_simd::{Arch, Kernel, Vectors};

use crate::sides::Sides;
use crate::vector::{Tensor, add_dyad, difference, zero};

/// Trial function of a cell: u + H (X - X_0).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trace<const D: usize> {
    /// Displacement of the point, m.
    pub u: [f64; D],
    /// Displacement gradient.
    pub h: Tensor<D>,
}

impl<const D: usize> Default for Trace<D> {
    fn default() -> Self {
        Trace { u: [0.0; D], h: zero() }
    }
}

impl<const D: usize> Trace<D> {
    /// Return the displacement at an arm from the point, m.
    #[inline(always)]
    pub fn at(&self, arm: &[f64; D]) -> [f64; D] {
        let mut at = self.u;
        for d in 0..D {
            for c in 0..D {
                at[d] += self.h[d][c] * arm[c];
            }
        }
        at
    }
}

/// Trial functions of the cells of a batch: H = sum (u_m - u) (x) b_m.
pub(crate) struct Deform<'a, const D: usize> {
    pub sides: &'a Sides<D>,
    pub displacement: &'a [[f64; D]],
    pub first: usize,
    pub out: &'a mut [Trace<D>],
}

impl<const D: usize> Kernel<f64> for Deform<'_, D> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Deform { sides, displacement, first, out } = self;
        for (n, out) in out.iter_mut().enumerate() {
            *out = trace(sides, displacement, first + n);
        }
    }
}

/// Return the trial function of a cell.
#[inline(always)]
pub(crate) fn trace<const D: usize>(sides: &Sides<D>, displacement: &[[f64; D]], cell: usize) -> Trace<D> {
    let u = displacement[cell];
    let range = sides.intact_of(cell);
    let mut h = zero();
    for (&j, b) in sides.neighbour[range.clone()].iter().zip(&sides.gradient[range]) {
        add_dyad(&mut h, 1.0, &difference(&displacement[j as usize], &u), b);
    }
    Trace { u, h }
}
