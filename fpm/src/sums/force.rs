//! Forces on points.

use impactite_simd::{Arch, Kernel, Vectors};

use super::traction::Load;
use crate::sides::Sides;

/// Forces on the points of some cells: r + sum (Q b_m - Q_m b), by tractions and the gradients of the cell and of its neighbours.
pub(crate) struct Force<'a, const D: usize> {
    pub sides: &'a Sides<D>,
    pub loads: &'a [Load<D>],
    /// Masses of all cells, kg.
    pub mass: &'a [f64],
    pub first: usize,
    /// Accelerations, m/s^2.
    pub out: &'a mut [[f64; D]],
}

impl<const D: usize> Kernel<f64> for Force<'_, D> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Force { sides, loads, mass, first, out } = self;
        for (n, out) in out.iter_mut().enumerate() {
            let cell = first + n;
            let Load { q, r } = &loads[cell];
            let (mut force, range) = (*r, sides.intact_of(cell));
            let near = sides.neighbour[range.clone()].iter();
            let weights = sides.gradient[range.clone()].iter().zip(&sides.back[range]);
            for (&j, (b, back)) in near.zip(weights) {
                let other = &loads[j as usize].q;
                for d in 0..D {
                    for c in 0..D {
                        force[d] += q[d][c] * b[c] - other[d][c] * back[c];
                    }
                }
            }
            let per = 1.0 / mass[cell];
            for d in 0..D {
                out[d] = per * force[d];
            }
        }
    }
}
