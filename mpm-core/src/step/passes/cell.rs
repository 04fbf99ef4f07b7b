//! Scatter from particles to the nodes of their cell, for stencils of two nodes per axis: the same sums as
//! [`super::scatter`], with fewer operations.
//!
//! The first record is added to all nodes of the cell at once, with the nodal weights. Forces are summed to **moments**
//! first: with N_i = prod_d (1/2 + s_d xi_d), s_d = -1 or 1 the side of the node, and c_a a power of two,
//!
//! ```text
//! sum_p sum_d G_d dN_i/dxi_d = sum_a c_a s^a M_a,      M_x = sum_p G_x,   M_xy = sum_p (xi_y G_x + xi_x G_y),
//!                                                    M_xyz = sum_p (xi_y xi_z G_x + xi_x xi_z G_y + xi_x xi_y G_z)
//! ```
//!
//! over the subsets a of the axes. Lanes of moments are particles; additions once per cell turn moments into nodal sums.
//! Rounding errors are relative to the largest force in the cell. This is harmless for forces, which do not vanish with the
//! mass of a node. Masses and momenta do, and their quotient is a velocity: they are not mapped by moments.

use mpm_materials::{Lane, Mat3};

use super::spread::{AFFINE, DIRECT, FORCE, MOMENTUM, Maps, RECORDS, Records, SpreadOf, times_offset};
use crate::dim::{Array, Stencil};
use crate::shape::node_offset;
use impactite_simd::{Arch, Band, Float, Quad, through_memory};

/// Moments of the forces of one cell. Bits of the index are the axes: x, y, xy, z, xz, yz, xyz from 1 on.
pub(in crate::step) struct Moments<Q: Lane, E: Stencil>(E::Nodes<Q>);

/// Return the contribution of one component of G = (G_x, G_y, G_z) at xi to the moment of the axes `AXES`.
#[inline(always)]
fn moment<L: Lane, const AXES: usize>([x, y, z]: &[L; 3], [gx, gy, gz]: &[L; 3]) -> L {
    match AXES {
        1 => *gx,
        2 => *gy,
        3 => x.mul_add(*gy, *y * *gx),
        4 => *gz,
        5 => x.mul_add(*gz, *z * *gx),
        6 => y.mul_add(*gz, *z * *gy),
        _ => (*y * *z).mul_add(*gx, (*x * *z).mul_add(*gy, (*x * *y) * *gz)),
    }
}

impl<Q: Lane, E: Stencil> Moments<Q, E> {
    /// Return zero moments.
    #[inline(always)]
    pub(in crate::step) fn zero() -> Self {
        Moments(E::Nodes::<Q>::filled(Q::zero()))
    }

    /// Add a group of particles at `xi`; `force` has the columns G_d, zero in lanes without a particle.
    #[inline(always)]
    pub(in crate::step) fn add_group<T, A>(&mut self, xi: &[A::Batch; 3], force: &Mat3<A::Batch>)
    where
        T: Float,
        A: Arch<T, Quad = Q>,
    {
        // One moment after another: all at once exceed the number of registers.
        self.add_moment::<T, A, 1>(xi, force);
        self.add_moment::<T, A, 2>(xi, force);
        self.add_moment::<T, A, 3>(xi, force);
        if E::LAYERS > 1 {
            self.add_moment::<T, A, 4>(xi, force);
            self.add_moment::<T, A, 5>(xi, force);
            self.add_moment::<T, A, 6>(xi, force);
            self.add_moment::<T, A, 7>(xi, force);
        }
    }

    #[inline(always)]
    fn add_moment<T, A, const AXES: usize>(&mut self, xi: &[A::Batch; 3], force: &Mat3<A::Batch>)
    where
        T: Float,
        A: Arch<T, Quad = Q>,
    {
        let f = &force.0;
        let of = [
            A::Batch::zero(),
            moment::<A::Batch, AXES>(xi, &f[0]),
            moment::<A::Batch, AXES>(xi, &f[1]),
            if E::LAYERS > 1 { moment::<A::Batch, AXES>(xi, &f[2]) } else { A::Batch::zero() },
        ];
        self.0[AXES] = self.0[AXES] + A::sums(of);
    }

    /// Add the particle at `xi` with its records.
    #[inline(always)]
    pub(in crate::step) fn add_one<T: Float>(&mut self, xi: &[T; 3], records: &[[T; 4]; RECORDS])
    where
        Q: Quad<T> + Lane<Real = T>,
    {
        let xi = [Q::splat(xi[0]), Q::splat(xi[1]), Q::splat(xi[2])];
        let mut g = [Q::zero(); 3];
        for d in 0..if E::LAYERS > 1 { 3 } else { 2 } {
            g[d] = Q::load(&records[FORCE + d]);
        }
        let m = &mut self.0;
        m[1] = m[1] + moment::<Q, 1>(&xi, &g);
        m[2] = m[2] + moment::<Q, 2>(&xi, &g);
        m[3] = m[3] + moment::<Q, 3>(&xi, &g);
        if E::LAYERS > 1 {
            m[4] = m[4] + moment::<Q, 4>(&xi, &g);
            m[5] = m[5] + moment::<Q, 5>(&xi, &g);
            m[6] = m[6] + moment::<Q, 6>(&xi, &g);
            m[7] = m[7] + moment::<Q, 7>(&xi, &g);
        }
    }

    /// Add the nodal sums to the nodes of the cell, whose first node is at `corner`.
    #[inline(always)]
    pub(in crate::step) fn give<T: Float>(&self, nodes: &mut [[T; 4]], corner: usize)
    where
        Q: Quad<T> + Lane<Real = T>,
    {
        let nodes = &mut nodes[corner..][..E::SPAN];
        let m = &self.0;
        let (half, quarter) = (Q::of(0.5), Q::of(0.25));
        if E::LAYERS == 1 {
            give_layer::<T, Q>(nodes, E::TILE, [Q::zero(), m[1] * half, m[2] * half, m[3]]);
            return;
        }
        let low = [Q::zero(), m[1] * quarter, m[2] * quarter, m[3] * half];
        let high = [m[4] * quarter, m[5] * half, m[6] * half, m[7]];
        let (mut below, mut above) = (low, low);
        for a in 0..4 {
            below[a] = low[a] - high[a];
            above[a] = low[a] + high[a];
        }
        give_layer::<T, Q>(nodes, E::TILE, below);
        give_layer::<T, Q>(&mut nodes[E::TILE * E::TILE..], E::TILE, above);
    }
}

/// Add the 1, x, y and xy terms to the four nodes of a layer, with the signs of their sides.
#[inline(always)]
fn give_layer<T: Float, Q: Quad<T>>(nodes: &mut [[T; 4]], stride: usize, parts: [Q; 4]) {
    let [one, x, y, xy] = parts;
    let (low, low_x, high, high_x) = (one - y, x - xy, one + y, x + xy);
    for (at, sum) in
        [(0, low - low_x), (1, low + low_x), (stride, high - high_x), (stride + 1, high + high_x)]
    {
        (Q::load(&nodes[at]) + sum).store(&mut nodes[at]);
    }
}

/// Number of nodes of a stencil.
#[inline(always)]
const fn nodes_of<E: Stencil>() -> usize {
    E::NODES * E::NODES * E::LAYERS
}

/// Offset of node `n` of the cell in a tile, from the first node on.
#[inline(always)]
const fn place<E: Stencil>(n: usize) -> usize {
    ((n >> 2) * E::TILE + (n >> 1 & 1)) * E::TILE + (n & 1)
}

/// Interpolate component `c` of a nodal vector of the cell, from records in tile order, to particles with these weights.
#[inline(always)]
pub(in crate::step) fn from_cell<T: Float, P: Lane<Real = T>, E: Stencil>(
    weights: &E::Nodes<P>,
    nodes: &[[T; 4]],
    c: usize,
) -> P {
    // Two independent sums, which halve the length of the dependency chain.
    let mut sums = [P::zero(); 2];
    for n in 0..nodes_of::<E>() {
        let number = P::splat(nodes[place::<E>(n)][c + 1]);
        sums[n % 2] = if n < 2 { weights[n] * number } else { weights[n].mul_add(number, sums[n % 2]) };
    }
    sums[0] + sums[1]
}

/// Scatter the first `LANES` particles of a group to the nodes of their cell, whose first node is at `corner` of the tile:
/// momentum to the `first` records, and hoop forces to the `second` if the pass maps two. Forces with weight gradients are
/// excluded.
#[inline(always)]
pub(in crate::step) fn scatter_cell<T: Float, A: Arch<T>, E: Stencil, const LANES: usize>(
    [first, second]: [&mut [[T; 4]]; 2],
    corner: usize,
    spread: &SpreadOf<T, A, E>,
    records: &Records<T>,
    maps: Maps,
) {
    let spread = if A::Band::RECORDS == 1 { through_memory(spread) } else { spread };
    let lanes = (0..LANES).step_by(A::Band::RECORDS);
    if maps.momentum {
        let first = &mut first[corner..][..E::SPAN];
        let mut sums = load_cell::<T, A, E>(first);
        for lane in lanes.clone() {
            let momentum = records.band::<A, LANES>(MOMENTUM, lane);
            if maps.has_affine() {
                add_affine::<T, A, E, LANES>(&mut sums, spread, records, lane, momentum);
            } else {
                add_record::<T, A, E>(&mut sums, spread, lane, momentum);
            }
            if maps.direct && maps.together {
                add_record::<T, A, E>(&mut sums, spread, lane, records.band::<A, LANES>(DIRECT, lane));
            }
        }
        store_cell::<T, A, E>(first, &sums);
    }
    if maps.direct && maps.second() {
        let second = &mut second[corner..][..E::SPAN];
        let mut sums = load_cell::<T, A, E>(second);
        for lane in lanes {
            add_record::<T, A, E>(&mut sums, spread, lane, records.band::<A, LANES>(DIRECT, lane));
        }
        store_cell::<T, A, E>(second, &sums);
    }
}

/// Return a record with its affine part evaluated at node `n` of the cell.
#[inline(always)]
fn seen_from<L: Lane, E: Stencil>(n: usize, mut record: L, affine: &[L; 3]) -> L {
    for d in 0..if E::LAYERS > 1 { 3 } else { 2 } {
        record = times_offset(affine[d], node_offset::<E>(n >> d & 1), record);
    }
    record
}

/// Scatter one particle, with these weights on the nodes of its cell, whose first node is at `corner`, as [`scatter_cell`]
/// does.
#[inline(always)]
pub(in crate::step) fn add_particle<T: Float, A: Arch<T>, E: Stencil>(
    [first, second]: [&mut [[T; 4]]; 2],
    corner: usize,
    weights: &E::Nodes<T::Single>,
    records: &[[T; 4]; RECORDS],
    maps: Maps,
) {
    let (momentum, direct) = (A::Quad::load(&records[MOMENTUM]), A::Quad::load(&records[DIRECT]));
    let mut affine = [A::Quad::zero(); 3];
    for d in 0..3 {
        affine[d] = A::Quad::load(&records[AFFINE + d]);
    }
    for n in 0..nodes_of::<E>() {
        let (weight, at) = (A::Quad::splat(weights[n].into()), corner + place::<E>(n));
        if maps.momentum {
            let mut here = if maps.has_affine() { seen_from::<_, E>(n, momentum, &affine) } else { momentum };
            if maps.direct && maps.together {
                here = here + direct;
            }
            weight.mul_add(here, A::Quad::load(&first[at])).store(&mut first[at]);
        }
        if maps.direct && maps.second() {
            weight.mul_add(direct, A::Quad::load(&second[at])).store(&mut second[at]);
        }
    }
}

#[inline(always)]
fn load_cell<T: Float, A: Arch<T>, E: Stencil>(from: &[[T; 4]]) -> E::Nodes<A::Band> {
    let mut sums = E::Nodes::<A::Band>::filled(A::Band::zero());
    for n in 0..nodes_of::<E>() {
        sums[n] = A::Band::widen(A::Quad::load(&from[place::<E>(n)]));
    }
    sums
}

#[inline(always)]
fn store_cell<T: Float, A: Arch<T>, E: Stencil>(to: &mut [[T; 4]], sums: &E::Nodes<A::Band>) {
    for n in 0..nodes_of::<E>() {
        sums[n].fold().store(&mut to[place::<E>(n)]);
    }
}

#[inline(always)]
fn add_record<T: Float, A: Arch<T>, E: Stencil>(
    sums: &mut E::Nodes<A::Band>,
    spread: &SpreadOf<T, A, E>,
    lane: usize,
    record: A::Band,
) {
    for n in 0..nodes_of::<E>() {
        sums[n] = A::Band::weights(spread.on_node(n), lane).mul_add(record, sums[n]);
    }
}

#[inline(always)]
fn add_affine<T: Float, A: Arch<T>, E: Stencil, const LANES: usize>(
    sums: &mut E::Nodes<A::Band>,
    spread: &SpreadOf<T, A, E>,
    records: &Records<T>,
    lane: usize,
    momentum: A::Band,
) {
    let mut affine = [A::Band::zero(); 3];
    for d in 0..3 {
        affine[d] = records.band::<A, LANES>(AFFINE + d, lane);
    }
    for n in 0..nodes_of::<E>() {
        let here = seen_from::<_, E>(n, momentum, &affine);
        sums[n] = A::Band::weights(spread.on_node(n), lane).mul_add(here, sums[n]);
    }
}
