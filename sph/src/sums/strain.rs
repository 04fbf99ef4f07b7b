//! Moments of velocities and of places, from which gradients follow.

use impactite_simd::{Arch, Kernel, Lane, Quad, Vectors};

use super::batch::Near;
use crate::matrix::Matrix;
use crate::records::Records;

/// Moments of the particles of a batch: sum_j A_j s_ij (u_j - u_i) (x) (X_j - X_i), with u their velocities or, if `places`, X itself.
pub(crate) struct Strain<'a, const D: usize> {
    pub records: &'a Records<D>,
    pub near: &'a Near,
    pub first: usize,
    pub places: bool,
    pub out: &'a mut [Matrix],
}

impl<const D: usize> Kernel<f64> for Strain<'_, D> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Strain { records, near, first, places, out } = self;
        let of = if places { &records.place } else { &records.velocity };
        for (n, out) in out.iter_mut().enumerate() {
            let i = first + n;
            let place = A::Quad::load(&records.place[i]);
            let own = &of[i];
            let mut sums = [A::Quad::zero(); D];
            let (index, slope) = near.of(n);
            for (&j, &s) in index.iter().zip(slope) {
                let other = &records.place[j as usize];
                let weighed = (A::Quad::load(other) - place) * A::Quad::splat(s * other[3]);
                let u = &of[j as usize];
                for c in 0..D {
                    sums[c] = A::Quad::splat(u[c] - own[c]).mul_add(weighed, sums[c]);
                }
            }
            *out = [[0.0; 3]; 3];
            for c in 0..D {
                let mut row = [0.0; 4];
                sums[c].store(&mut row);
                out[c][..D].copy_from_slice(&row[..D]);
            }
        }
    }
}
