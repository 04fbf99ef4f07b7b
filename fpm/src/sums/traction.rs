//! Tractions on faces, and loads of cells.

use std::marker::PhantomData;

use impactite_simd::{Arch, Kernel, Vectors};

use super::deform::Trace;
use super::lift::jump;
use crate::crack::Criterion;
use crate::flux::Flux;
use crate::method::Composition;
use crate::sides::Sides;
use crate::vector::{Tensor, add_dyad, dot};

/// Load of a cell, with the virtual work r . du - Q : dH.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load<const D: usize> {
    /// V P minus the sum of t (x) arm, J.
    pub q: Tensor<D>,
    /// Sum of the forces t on the faces of the cell, N.
    pub r: [f64; D],
}

impl<const D: usize> Default for Load<D> {
    fn default() -> Self {
        Load { q: [[0.0; D]; D], r: [0.0; D] }
    }
}

impl<const D: usize> Load<D> {
    /// Add a force on a face, N, at an arm from the point, m.
    #[inline(always)]
    pub fn add(&mut self, force: &[f64; D], arm: &[f64; D]) {
        add_dyad(&mut self.q, -1.0, force, arm);
        for d in 0..D {
            self.r[d] += force[d];
        }
    }
}

/// Loads of some cells by intact faces, t = A ({P} N - eta / l [u]).
pub(crate) struct Traction<'a, const D: usize, M> {
    pub sides: &'a Sides<D>,
    pub traces: &'a [Trace<D>],
    /// P of all cells, Pa.
    pub stress: &'a [Tensor<D>],
    pub volume: &'a [f64],
    pub first: usize,
    /// Smallest magnitude of a traction that may open a face, Pa.
    pub least: f64,
    pub out: &'a mut [Load<D>],
    /// Sums of A/2 [u] (x) N; an output with the incomplete flux only.
    pub lifting: &'a mut [Tensor<D>],
    pub candidates: &'a mut Vec<u32>,
    pub method: PhantomData<M>,
}

impl<const D: usize, M: Composition<D>> Kernel<f64> for Traction<'_, D, M> {
    const VECTORS: Vectors = Vectors::Avx2;
    /// Energy of the penalty, J.
    type Output = f64;

    #[inline(always)]
    fn run<A: Arch<f64>>(self) -> f64 {
        let Traction { sides, traces, stress, volume, first, least, out, lifting, candidates, .. } = self;
        let square = least * least;
        let mut energy = 0.0;
        for (n, out) in out.iter_mut().enumerate() {
            let cell = first + n;
            let (own, p) = (&traces[cell], &stress[cell]);
            let mut load = Load { q: *p, r: [0.0; D] };
            for row in &mut load.q {
                for q in row {
                    *q *= volume[cell];
                }
            }
            let mut lifted = [[0.0; D]; D];
            let range = sides.intact_of(cell);
            let near = &sides.neighbour[range.clone()];
            for (s, (&j, surface)) in near.iter().zip(&sides.surface[range.clone()]).enumerate() {
                let other = &stress[j as usize];
                let jump = jump(own, &traces[j as usize], surface);
                let mut force = [0.0; D];
                for d in 0..D {
                    let mut mean = 0.0;
                    for c in 0..D {
                        mean += (p[d][c] + other[d][c]) * surface.area[c];
                    }
                    force[d] = 0.5 * mean - surface.stiffness * jump[d];
                }
                load.add(&force, &surface.own);
                energy += 0.25 * surface.stiffness * dot(&jump, &jump);
                if !M::Flux::LIFTED {
                    add_dyad(&mut lifted, 0.5, &jump, &surface.area);
                }
                // Check each face from one side.
                if M::Criterion::OPENS
                    && (j as usize) > cell
                    && dot(&force, &force) >= square * dot(&surface.area, &surface.area)
                {
                    candidates.push(sides.face[range.start + s]);
                }
            }
            if !M::Flux::LIFTED {
                lifting[n] = lifted;
            }
            *out = load;
        }
        energy
    }
}
