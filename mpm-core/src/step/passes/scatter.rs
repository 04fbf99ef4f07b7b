//! Scatter from the particles of a bin to the nodes of its stencil: the adjoint of the gather.
//!
//! Contribution of a particle to node i, with its weight N_i and its derivative dN_i with respect to xi:
//!
//! ```text
//! first:   N_i (R + sum_d A_d i_d)                R = [m, m v] - sum_d A_d xi_d,  A_d = m h C e_d  (APIC)
//! second:  sum_d G_d dN_i/dxi_d + N_i H           G_d = -V sigma e_d / h,  H hoop force
//! ```
//!
//! Both are added to the first record, with G and H multiplied by the time step, if a step needs only the sum of momentum
//! and force impulse. In the moving-least-squares form the force is part of A.
//!
//! Lanes are the four numbers of a node record; particles are processed one at a time.

use mpm_materials::Lane;

use super::cell::scatter_cell;
use super::spread::{AFFINE, DIRECT, FORCE, MOMENTUM, Maps, Records, SpreadOf, times_offset};
use crate::dim::{Array, Stencil};
use crate::shape::node_offset;
use impactite_simd::{Arch, Band, Float, Quad, apart};

/// Scatter the particles in the first `LANES` lanes of a group to the nodes of their bin's stencil, whose first node is at
/// `corner` of the tile: to the first records and, if the pass maps two, to the second. Lanes without a particle have zero
/// records. Forces summed in [`super::cell::Moments`] are excluded.
#[inline(always)]
pub fn scatter<T: Float, A: Arch<T>, E: Stencil, const LANES: usize>(
    tiles: [&mut [[T; 4]]; 2],
    corner: usize,
    spread: &SpreadOf<T, A, E>,
    records: &Records<T>,
    maps: Maps,
) {
    if A::APART {
        return apart(|| scatter_here::<T, A, E, LANES>(tiles, corner, spread, records, maps));
    }
    scatter_here::<T, A, E, LANES>(tiles, corner, spread, records, maps);
}

#[inline(always)]
fn scatter_here<T: Float, A: Arch<T>, E: Stencil, const LANES: usize>(
    [first, second]: [&mut [[T; 4]]; 2],
    corner: usize,
    spread: &SpreadOf<T, A, E>,
    records: &Records<T>,
    maps: Maps,
) {
    if E::NODES == 2 && !maps.convected {
        return scatter_cell::<T, A, E, LANES>([first, second], corner, spread, records, maps);
    }
    let first = if maps.momentum { &mut first[corner..][..E::SPAN] } else { first };
    let second = if maps.second() { &mut second[corner..][..E::SPAN] } else { second };
    let mut rows = RowsOut::<T, A, E, LANES> { first, second, spread, records, maps };
    // Unrolled by hand: a loop that the compiler does not unroll would evaluate these conditions for each row.
    rows.add_layer(0);
    if E::LAYERS > 1 {
        rows.add_layer(1);
    }
    if E::LAYERS > 2 {
        rows.add_layer(2);
    }
    if E::LAYERS > 3 {
        rows.add_layer(3);
    }
}

/// Node rows of a stencil, and the contributions to them.
struct RowsOut<'a, T: Float, A: Arch<T>, E: Stencil, const LANES: usize> {
    first: &'a mut [[T; 4]],
    second: &'a mut [[T; 4]],
    spread: &'a SpreadOf<T, A, E>,
    records: &'a Records<T>,
    maps: Maps,
}

impl<T: Float, A: Arch<T>, E: Stencil, const LANES: usize> RowsOut<'_, T, A, E, LANES> {
    #[inline(always)]
    fn add_layer(&mut self, k: usize) {
        self.add(0, k);
        self.add(1, k);
        if E::NODES > 2 {
            self.add(2, k);
        }
        if E::NODES > 3 {
            self.add(3, k);
        }
    }

    /// Add all lanes to row (j, k), which is read and written once.
    #[inline(always)]
    fn add(&mut self, j: usize, k: usize) {
        let RowsOut { first, second, spread, records, maps } = self;
        let (maps, jk) = (*maps, k * E::NODES + j);
        let row = (k * E::TILE + j) * E::TILE;
        let mut one = E::Axis::<A::Band>::filled(A::Band::zero());
        let mut two = one;
        for i in 0..E::NODES {
            if maps.momentum {
                one[i] = A::Band::widen(A::Quad::load(&first[row + i]));
            }
            if maps.second() {
                two[i] = A::Band::widen(A::Quad::load(&second[row + i]));
            }
        }
        for lane in (0..if maps.convected { LANES } else { 0 }).step_by(A::Band::RECORDS) {
            spread.add_table::<T, A, LANES>(records, lane, jk, maps, [&mut one, &mut two]);
        }
        for lane in (0..if maps.convected { 0 } else { LANES }).step_by(A::Band::RECORDS) {
            let yz = A::Band::weights(&spread.yz[jk], lane);
            let mut momentum = records.band::<A, LANES>(MOMENTUM, lane);
            let mut affine = A::Band::zero();
            if maps.has_affine() {
                if E::LAYERS > 1 {
                    momentum = times_offset(
                        records.band::<A, LANES>(AFFINE + 2, lane),
                        node_offset::<E>(k),
                        momentum,
                    );
                }
                momentum =
                    times_offset(records.band::<A, LANES>(AFFINE + 1, lane), node_offset::<E>(j), momentum);
                affine = records.band::<A, LANES>(AFFINE, lane) * yz;
            }
            momentum = momentum * yz;
            let (mut along, mut across) = (A::Band::zero(), A::Band::zero());
            if maps.slopes() {
                along = records.band::<A, LANES>(FORCE, lane) * yz;
                across = spread.across::<T, A>(
                    lane,
                    jk,
                    [records.band::<A, LANES>(FORCE + 1, lane), records.band::<A, LANES>(FORCE + 2, lane)],
                );
                if maps.direct {
                    across = records.band::<A, LANES>(DIRECT, lane).mul_add(yz, across);
                }
                if maps.together {
                    momentum = momentum + across;
                }
            }
            for i in 0..E::NODES {
                let x = A::Band::weights(&spread.x[i], lane);
                if maps.momentum {
                    let mut here = momentum;
                    if maps.has_affine() {
                        here = times_offset(affine, node_offset::<E>(i), here);
                    }
                    one[i] = x.mul_add(here, one[i]);
                }
                if maps.slopes() {
                    let sum = if maps.together { one[i] } else { x.mul_add(across, two[i]) };
                    let sum = A::Band::weights(&spread.dx[i], lane).mul_add(along, sum);
                    if maps.together {
                        one[i] = sum;
                    } else {
                        two[i] = sum;
                    }
                }
            }
        }
        for i in 0..E::NODES {
            if maps.momentum {
                one[i].fold().store(&mut first[row + i]);
            }
            if maps.second() {
                two[i].fold().store(&mut second[row + i]);
            }
        }
    }
}
