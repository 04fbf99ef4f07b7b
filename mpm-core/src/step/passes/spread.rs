//! Contributions of particles to the nodes of their stencil: records, and the weights that distribute them
//! ([`super::scatter`]).

use std::ops::{Index, IndexMut};

use mpm_materials::{Lane, Mat3};

use crate::dim::{Array, Stencil};
use crate::shape::domain::{Corners, MOST_NUMBERS, Table};
use crate::shape::{ShapeFunction, Weights};
use impactite_simd::{Arch, Band, Float, Pack, Quad};

/// Number of records per particle: `R`, `H`, then `A_d`, then `G_d`.
pub const RECORDS: usize = 8;
/// Index of R.
pub const MOMENTUM: usize = 0;
/// Index of H.
pub const DIRECT: usize = 1;
/// Index of A_0.
pub const AFFINE: usize = 2;
/// Index of G_0.
pub const FORCE: usize = 5;

/// Maximum number of lanes of a group.
pub const MAX_LANES: usize = 8;

/// Records of a group: `[kind][lane]`. The alignment also aligns the stack of a pass: no vector on it straddles two cache
/// lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Records<T>([[[T; 4]; MAX_LANES]; RECORDS]);

impl<T: Float> Records<T> {
    /// Return zero records.
    #[inline(always)]
    pub fn zero() -> Self {
        Records([[[T::default(); 4]; MAX_LANES]; RECORDS])
    }
    /// Load the records of the particle in a lane and, unless it is the last one of `LANES`, of the next one.
    #[inline(always)]
    pub(in crate::step) fn band<A: Arch<T>, const LANES: usize>(&self, kind: usize, lane: usize) -> A::Band {
        if lane + 1 == LANES {
            A::Band::widen(A::Quad::load(&self.0[kind][lane]))
        } else {
            A::Band::load(&self.0[kind][lane..])
        }
    }
}

impl<T> Index<usize> for Records<T> {
    type Output = [[T; 4]; MAX_LANES];
    #[inline(always)]
    fn index(&self, kind: usize) -> &Self::Output {
        &self.0[kind]
    }
}

impl<T> IndexMut<usize> for Records<T> {
    #[inline(always)]
    fn index_mut(&mut self, kind: usize) -> &mut Self::Output {
        &mut self.0[kind]
    }
}

/// Quantities that a pass maps to the grid.
#[derive(Clone, Copy)]
pub struct Maps {
    /// Mass and momentum.
    pub momentum: bool,
    /// The affine part of the momentum.
    pub affine: bool,
    /// Forces.
    pub force: bool,
    /// Forces mapped with weights instead of weight gradients: hoop stress.
    pub direct: bool,
    /// Forces are added to the first record, as impulses.
    pub together: bool,
    /// Forces in affine form, without slopes.
    pub least_squares: bool,
    /// Weights are not tensor products.
    pub convected: bool,
}

impl Maps {
    /// No quantity.
    pub(in crate::step) const NOTHING: Maps = Maps {
        momentum: false,
        affine: false,
        force: false,
        direct: false,
        together: false,
        least_squares: false,
        convected: false,
    };
    /// Return true if slopes of the weights are needed.
    #[inline(always)]
    pub const fn slopes(self) -> bool {
        self.force && !self.least_squares
    }
    /// Return true if anything is added to the second record.
    #[inline(always)]
    pub fn second(self) -> bool {
        self.slopes() && !self.together
    }
    /// Return true if the first record has an affine part.
    #[inline(always)]
    pub fn has_affine(self) -> bool {
        self.affine || (self.force && self.least_squares)
    }
    /// Return true if forces are summed by the moments of a cell.
    #[inline(always)]
    pub(in crate::step) const fn moments<E: Stencil>(self) -> bool {
        E::NODES == 2 && self.slopes() && !self.convected
    }
    /// Return true if records of this kind are mapped in `D` dimensions.
    #[inline(always)]
    pub fn uses<const D: usize>(self, kind: usize) -> bool {
        match kind {
            MOMENTUM => self.momentum,
            DIRECT => self.direct,
            AFFINE..FORCE => self.has_affine() && kind - AFFINE < D,
            _ => self.slopes() && kind - FORCE < D,
        }
    }
}

/// Weights of a batch in memory, where single lanes can be read: products along y and z, and those along x. For weights
/// that are not products, and for stencils of two nodes per axis: weights on all nodes.
#[derive(Clone, Copy)]
pub struct Spread<N: Copy + Send, E: Stencil> {
    pub(in crate::step) x: E::Axis<N>,
    pub(in crate::step) dx: E::Axis<N>,
    pub(in crate::step) yz: E::Nodes<N>,
    dy: E::Nodes<N>,
    dz: E::Nodes<N>,
    table: [E::Nodes<N>; 2],
}

/// Stored numbers of a batch of particles.
pub(in crate::step) type NumbersOf<T, A> = <<A as Arch<T>>::Batch as Pack<T>>::Numbers;
/// Weights of a batch of particles.
pub(in crate::step) type SpreadOf<T, A, E> = Spread<NumbersOf<T, A>, E>;
/// Buffers for the records of a batch and its weights, reused by each batch.
pub(in crate::step) type Room<'a, T, A, E> = (&'a mut Records<T>, &'a mut SpreadOf<T, A, E>);

impl<N: Copy + Default + Send, E: Stencil> Spread<N, E> {
    /// Return zero weights.
    #[inline(always)]
    pub fn zero() -> Self {
        let (axis, nodes) = (Array::filled(N::default()), Array::filled(N::default()));
        Spread { x: axis, dx: axis, yz: nodes, dy: nodes, dz: nodes, table: [nodes; 2] }
    }

    /// Evaluate the weights of particles at `xi` with these domains, with slopes if `force`. Returns the signed volume of
    /// convected domains, which is positive unless they are inverted.
    #[inline(always)]
    pub fn place<T, P, S, const D: usize>(
        &mut self,
        shape: &S,
        xi: &[P; 3],
        domain: &[P; MOST_NUMBERS],
        force: bool,
    ) -> P
    where
        T: Float,
        P: Pack<T, Numbers = N>,
        S: ShapeFunction<T, D, Extent = E>,
    {
        if !S::DOMAIN.convects() {
            let at = along_axes(shape, xi, domain);
            if E::NODES == 2 {
                self.fill_cell(&at);
            } else {
                self.fill(&at, force);
            }
            return P::one();
        }
        let corners = Corners::of::<D>(S::DOMAIN, domain);
        let table = Table::<P, E>::of::<D>(&corners, xi);
        let [value, dx] = &mut self.table;
        for node in 0..E::NODES * E::NODES * E::LAYERS {
            table.value[node].store(&mut value[node]);
            if force {
                table.slope[0][node].store(&mut dx[node]);
                table.slope[1][node].store(&mut self.dy[node]);
                table.slope[2][node].store(&mut self.dz[node]);
            }
        }
        corners.volume
    }

    /// Store the products of these axis weights.
    #[inline(always)]
    fn fill<T: Float, P: Pack<T, Numbers = N>>(&mut self, at: &[Weights<P, E>; 3], force: bool) {
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

    /// Store the weights on all nodes of a cell, from these axis weights.
    #[inline(always)]
    fn fill_cell<T: Float, P: Pack<T, Numbers = N>>(&mut self, at: &[Weights<P, E>; 3]) {
        let weights = on_cell::<P, E>(at);
        for node in 0..E::NODES * E::NODES * E::LAYERS {
            weights[node].store(&mut self.table[0][node]);
        }
    }

    /// Return the weights on a node, if those on all nodes are stored.
    #[inline(always)]
    pub(in crate::step) fn on_node(&self, node: usize) -> &N {
        &self.table[0][node]
    }

    /// Add the contributions of the particles of a band to the nodes of row `jk`, with weights on all nodes.
    #[inline(always)]
    pub(in crate::step) fn add_table<T: Float, A: Arch<T>, const LANES: usize>(
        &self,
        records: &Records<T>,
        lane: usize,
        jk: usize,
        maps: Maps,
        [one, two]: [&mut E::Axis<A::Band>; 2],
    ) where
        A::Batch: Pack<T, Numbers = N>,
    {
        for i in 0..E::NODES {
            let node = jk * E::NODES + i;
            let value = A::Band::weights(&self.table[0][node], lane);
            if maps.momentum {
                one[i] = value.mul_add(records.band::<A, LANES>(MOMENTUM, lane), one[i]);
            }
            if maps.slopes() {
                let to = if maps.together { &mut one[i] } else { &mut two[i] };
                *to = A::Band::weights(&self.table[1][node], lane)
                    .mul_add(records.band::<A, LANES>(FORCE, lane), *to);
                *to = A::Band::weights(&self.dy[node], lane)
                    .mul_add(records.band::<A, LANES>(FORCE + 1, lane), *to);
                if E::LAYERS > 1 {
                    *to = A::Band::weights(&self.dz[node], lane)
                        .mul_add(records.band::<A, LANES>(FORCE + 2, lane), *to);
                }
                if maps.direct {
                    *to = value.mul_add(records.band::<A, LANES>(DIRECT, lane), *to);
                }
            }
        }
    }

    /// Return the contribution of the forces along y and z, `g`, to the nodes (j, k), before the weight along x.
    #[inline(always)]
    pub(in crate::step) fn across<T: Float, A: Arch<T>>(
        &self,
        lane: usize,
        jk: usize,
        g: [A::Band; 2],
    ) -> A::Band
    where
        A::Batch: Pack<T, Numbers = N>,
    {
        let dy = g[0] * A::Band::weights(&self.dy[jk], lane);
        if E::LAYERS > 1 { g[1].mul_add(A::Band::weights(&self.dz[jk], lane), dy) } else { dy }
    }
}

/// Evaluate the weights along each axis of particles at `xi` with these domains.
#[inline(always)]
pub(in crate::step) fn along_axes<T, P, S, const D: usize>(
    shape: &S,
    xi: &[P; 3],
    domain: &[P; MOST_NUMBERS],
) -> [Weights<P, S::Extent>; 3]
where
    T: Float,
    P: Lane<Real = T>,
    S: ShapeFunction<T, D>,
{
    let mut at = [Weights::zero(); 3];
    for d in 0..D {
        at[d] = shape.weights(xi[d], domain[d]);
    }
    at
}

/// Multiply axis weights to the weights on all nodes of a cell.
#[inline(always)]
pub(in crate::step) fn on_cell<P: Lane, E: Stencil>([x, y, z]: &[Weights<P, E>; 3]) -> E::Nodes<P> {
    let mut weights = E::Nodes::<P>::filled(P::zero());
    for k in 0..E::LAYERS {
        for j in 0..E::NODES {
            let yz = if E::LAYERS == 1 { y.value[j] } else { y.value[j] * z.value[k] };
            for i in 0..E::NODES {
                weights[(k * E::NODES + j) * E::NODES + i] = x.value[i] * yz;
            }
        }
    }
    weights
}

/// Return `a * offset + b` for an offset known at compile time.
#[inline(always)]
pub(in crate::step) fn times_offset<Q: Lane>(a: Q, offset: f64, b: Q) -> Q {
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

/// Fill the records of a group except those of forces; see [`super::scatter`].
#[inline(always)]
pub(in crate::step) fn fill_records<T: Float, A: Arch<T>, const D: usize>(
    records: &mut Records<T>,
    mass: A::Batch,
    mut p: [A::Batch; 3],
    affine: &[[A::Batch; 3]; 3],
    xi: &[A::Batch; 3],
    maps: Maps,
) {
    let zero = A::Batch::zero();
    if maps.momentum {
        if maps.has_affine() {
            for d in 0..D {
                for c in 0..D {
                    p[c] = (-affine[c][d]).mul_add(xi[d], p[c]);
                }
                let a = [affine[0][d], affine[1][d], affine[2][d]];
                A::Batch::records(zero, a[0], a[1], a[2], &mut records[AFFINE + d]);
            }
        }
        A::Batch::records(mass, p[0], p[1], p[2], &mut records[MOMENTUM]);
    }
}

/// Fill the records of the forces of a group.
#[inline(always)]
pub(in crate::step) fn force_records<T: Float, A: Arch<T>, const D: usize>(
    records: &mut Records<T>,
    force: &Mat3<A::Batch>,
) {
    let zero = A::Batch::zero();
    for d in 0..D {
        let third = if D == 3 { force.0[2][d] } else { zero };
        A::Batch::records(zero, force.0[0][d], force.0[1][d], third, &mut records[FORCE + d]);
    }
}
