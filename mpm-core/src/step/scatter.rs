//! From the particles of a bin to the nodes of its stencil: the adjoint of the gather.
//!
//! What a particle adds to node i is, with N_i its weight and dN_i its derivative with respect to xi,
//!
//! ```text
//! first:   N_i (R + sum_d A_d i_d)                R = [m, m v] - sum_d A_d xi_d,  A_d = m h C e_d  (APIC)
//! second:  sum_d G_d dN_i/dxi_d + N_i H           G_d = -V sigma e_d / h,  H hoop force and load
//! ```
//!
//! Where a step needs only their sum, momentum plus the impulse of the force, both go to the first record with
//! G and H multiplied by the step; in the moving-least-squares form the force is part of A.
//!
//! Lanes here are the four numbers of a node record, one particle at a time.

use mpm_materials::Lane;

use crate::dim::{Array, Stencil};
use crate::parallel::{Arch, Float, Pack, Quad};
use crate::shape::{Weights, node_offset};

/// The records of the particles of a group. `R` and `H` come first, then `A_d`, then `G_d`.
pub const RECORDS: usize = 8;
/// Index of R.
pub const MOMENTUM: usize = 0;
/// Index of H.
pub const DIRECT: usize = 1;
/// Index of A_0.
pub const AFFINE: usize = 2;
/// Index of G_0.
pub const FORCE: usize = 5;

/// Most lanes a group has.
pub const MAX_LANES: usize = 8;

/// Records of a group: `[kind][lane]`.
pub type Records<T> = [[[T; 4]; MAX_LANES]; RECORDS];

/// What a pass maps to the grid.
#[derive(Clone, Copy)]
pub struct Maps {
    /// Mass and momentum.
    pub momentum: bool,
    /// The affine part of the momentum.
    pub affine: bool,
    /// Forces.
    pub force: bool,
    /// Forces that act as such, without gradients of weights: of the hoop stress and of surface loads.
    pub direct: bool,
    /// Forces go to the first record, as impulses.
    pub together: bool,
    /// Forces have the affine form and need no slopes.
    pub least_squares: bool,
}

impl Maps {
    /// Are slopes of the weights needed?
    #[inline(always)]
    pub fn slopes(self) -> bool {
        self.force && !self.least_squares
    }
    /// Does anything go to the second record?
    #[inline(always)]
    pub fn second(self) -> bool {
        self.slopes() && !self.together
    }
    /// Is there an affine part in the first record?
    #[inline(always)]
    pub fn has_affine(self) -> bool {
        self.affine || (self.force && self.least_squares)
    }
}

/// Products of the weights along y and z, and those along x, where single lanes can be read.
#[derive(Clone, Copy)]
pub struct Spread<T: Float, E: Stencil> {
    x: E::Axis<T::Row>,
    dx: E::Axis<T::Row>,
    yz: E::Nodes<T::Row>,
    dy: E::Nodes<T::Row>,
    dz: E::Nodes<T::Row>,
}

impl<T: Float, E: Stencil> Spread<T, E> {
    /// To be filled in.
    #[inline(always)]
    pub fn zero() -> Self {
        let (axis, nodes) = (Array::filled(T::Row::default()), Array::filled(T::Row::default()));
        Spread { x: axis, dx: axis, yz: nodes, dy: nodes, dz: nodes }
    }

    /// The products for particles with these weights.
    #[inline(always)]
    pub fn fill<P: Pack<T>>(&mut self, at: &[Weights<P, E>; 3], force: bool) {
        let [x, y, z] = at;
        for i in 0..E::NODES {
            x.value[i].store(&mut self.x[i]);
            if force {
                x.slope[i].store(&mut self.dx[i]);
            }
        }
        for k in 0..E::LAYERS {
            for j in 0..E::NODES {
                let jk = k * E::NODES + j;
                if E::LAYERS == 1 {
                    y.value[j].store(&mut self.yz[jk]);
                    if force {
                        y.slope[j].store(&mut self.dy[jk]);
                    }
                } else {
                    (y.value[j] * z.value[k]).store(&mut self.yz[jk]);
                    if force {
                        (y.slope[j] * z.value[k]).store(&mut self.dy[jk]);
                        (y.value[j] * z.slope[k]).store(&mut self.dz[jk]);
                    }
                }
            }
        }
    }
}

/// Add the particle in lane `lane` to the sums of its bin's nodes.
#[inline(always)]
pub fn scatter<T: Float, A: Arch<T>, E: Stencil>(
    sums: &mut E::Nodes<[A::Quad; 2]>,
    spread: &Spread<T, E>,
    records: &Records<T>,
    lane: usize,
    maps: Maps,
) {
    let r = A::Quad::load(&records[MOMENTUM][lane]);
    let direct = A::Quad::load(&records[DIRECT][lane]);
    let a = [
        A::Quad::load(&records[AFFINE][lane]),
        A::Quad::load(&records[AFFINE + 1][lane]),
        A::Quad::load(&records[AFFINE + 2][lane]),
    ];
    let g = [
        A::Quad::load(&records[FORCE][lane]),
        A::Quad::load(&records[FORCE + 1][lane]),
        A::Quad::load(&records[FORCE + 2][lane]),
    ];
    let mut x = E::Axis::<A::Quad>::filled(A::Quad::zero());
    let mut dx = x;
    for i in 0..E::NODES {
        x[i] = A::Quad::splat(spread.x[i].as_ref()[lane]);
        if maps.slopes() {
            dx[i] = A::Quad::splat(spread.dx[i].as_ref()[lane]);
        }
    }
    for k in 0..E::LAYERS {
        let mut layer = r;
        if maps.has_affine() && E::LAYERS > 1 {
            layer = times_offset(a[2], node_offset::<E>(k), layer);
        }
        for j in 0..E::NODES {
            let jk = k * E::NODES + j;
            let yz = A::Quad::splat(spread.yz[jk].as_ref()[lane]);
            let mut momentum = layer;
            let mut affine = a[0];
            if maps.has_affine() {
                momentum = times_offset(a[1], node_offset::<E>(j), momentum);
                affine = affine * yz;
            }
            momentum = momentum * yz;
            let (mut along, mut across) = (g[0], g[1]);
            if maps.slopes() {
                along = along * yz;
                across = across * A::Quad::splat(spread.dy[jk].as_ref()[lane]);
                if E::LAYERS > 1 {
                    across = g[2].mul_add(A::Quad::splat(spread.dz[jk].as_ref()[lane]), across);
                }
                if maps.direct {
                    across = direct.mul_add(yz, across);
                }
                if maps.together {
                    momentum = momentum + across;
                }
            }
            for i in 0..E::NODES {
                let sum = &mut sums[jk * E::NODES + i];
                if maps.momentum {
                    let mut here = momentum;
                    if maps.has_affine() {
                        here = times_offset(affine, node_offset::<E>(i), here);
                    }
                    sum[0] = x[i].mul_add(here, sum[0]);
                    if maps.slopes() && maps.together {
                        sum[0] = dx[i].mul_add(along, sum[0]);
                    }
                }
                if maps.slopes() && !maps.together {
                    sum[1] = dx[i].mul_add(along, x[i].mul_add(across, sum[1]));
                }
            }
        }
    }
}

/// `a * offset + b` for an offset known when compiling.
#[inline(always)]
fn times_offset<Q: Lane>(a: Q, offset: f64, b: Q) -> Q {
    if offset == 0.0 {
        b
    } else if offset == 1.0 {
        b + a
    } else if offset == -1.0 {
        b - a
    } else {
        a.mul_add(Q::of(offset), b)
    }
}
