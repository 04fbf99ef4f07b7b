//! From the nodes of a stencil to the lanes of a group, by sum factorisation: along x, then y, then z.

use mpm_materials::Lane;

use crate::dim::{Array, Stencil};
use crate::parallel::Float;
use crate::shape::{Weights, node_offset};

/// One component of a nodal vector at the particles.
#[derive(Clone, Copy)]
pub struct Gathered<P> {
    /// sum_i N_i v_i.
    pub value: P,
    /// sum_i v_i dN_i/dxi_d.
    pub slope: [P; 3],
    /// sum_i N_i v_i (i - xi)_d: the affine moment of APIC.
    pub moment: [P; 3],
}

/// Weights of a group along all axes, and first moments N_a (a - xi) where asked for.
#[derive(Clone, Copy)]
pub struct AxisWeights<P: Lane, E: Stencil> {
    /// N and its derivative along each axis.
    pub weights: [Weights<P, E>; 3],
    /// N_a (a - xi) along each axis.
    pub moments: [E::Axis<P>; 3],
}

impl<P: Lane, E: Stencil> AxisWeights<P, E> {
    /// To be filled in.
    #[inline(always)]
    pub fn zero() -> Self {
        AxisWeights { weights: [Weights::zero(); 3], moments: [Array::filled(P::zero()); 3] }
    }
    /// First moments from the weights, for particles at `xi`.
    #[inline(always)]
    pub fn fill_moments(&mut self, d: usize, xi: P) {
        for a in 0..E::NODES {
            self.moments[d][a] = self.weights[d].value[a] * (P::of(node_offset::<E>(a)) - xi);
        }
    }
}

/// Component `c` of a nodal vector (of records `[scalar, x, y, z]`), with slopes and moments if asked for.
///
/// The flags are constants at every call, so that what is not asked for is not computed.
#[inline(always)]
pub fn gather<T: Float, P: Lane<Real = T>, E: Stencil>(
    nodes: &E::Nodes<[T; 4]>,
    at: &AxisWeights<P, E>,
    c: usize,
    slopes: bool,
    moments: bool,
) -> Gathered<P> {
    let zero = P::zero();
    let [x, y, z] = &at.weights;
    let mut sum = Gathered { value: zero, slope: [zero; 3], moment: [zero; 3] };
    for k in 0..E::LAYERS {
        let (mut plane, mut plane_dx, mut plane_dy) = (zero, zero, zero);
        let (mut plane_mx, mut plane_my) = (zero, zero);
        for j in 0..E::NODES {
            let (mut row, mut row_dx, mut row_mx) = (zero, zero, zero);
            for i in 0..E::NODES {
                let v = P::splat(nodes[(k * E::NODES + j) * E::NODES + i][c + 1]);
                row = x.value[i].mul_add(v, row);
                if slopes {
                    row_dx = x.slope[i].mul_add(v, row_dx);
                }
                if moments {
                    row_mx = at.moments[0][i].mul_add(v, row_mx);
                }
            }
            plane = y.value[j].mul_add(row, plane);
            if slopes {
                plane_dx = y.value[j].mul_add(row_dx, plane_dx);
                plane_dy = y.slope[j].mul_add(row, plane_dy);
            }
            if moments {
                plane_mx = y.value[j].mul_add(row_mx, plane_mx);
                plane_my = at.moments[1][j].mul_add(row, plane_my);
            }
        }
        if E::LAYERS == 1 {
            return Gathered {
                value: plane,
                slope: [plane_dx, plane_dy, zero],
                moment: [plane_mx, plane_my, zero],
            };
        }
        sum.value = z.value[k].mul_add(plane, sum.value);
        if slopes {
            sum.slope[0] = z.value[k].mul_add(plane_dx, sum.slope[0]);
            sum.slope[1] = z.value[k].mul_add(plane_dy, sum.slope[1]);
            sum.slope[2] = z.slope[k].mul_add(plane, sum.slope[2]);
        }
        if moments {
            sum.moment[0] = z.value[k].mul_add(plane_mx, sum.moment[0]);
            sum.moment[1] = z.value[k].mul_add(plane_my, sum.moment[1]);
            sum.moment[2] = at.moments[2][k].mul_add(plane, sum.moment[2]);
        }
    }
    sum
}
