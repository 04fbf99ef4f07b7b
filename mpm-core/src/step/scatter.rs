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

use std::ops::{Index, IndexMut};

use mpm_materials::Lane;

use super::cell::scatter_cell;

use crate::dim::{Array, Stencil};
use crate::parallel::{Arch, Float, Pack, Quad};
use crate::shape::domain::{Corners, MOST_NUMBERS, Table};
use crate::shape::{ShapeFunction, Weights, node_offset};

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

/// Records of a group: `[kind][lane]`. Aligned, and with it the stack of a pass: no vector on it straddles two cache lines.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Records<T>([[[T; 4]; MAX_LANES]; RECORDS]);

impl<T: Float> Records<T> {
    /// Zeros.
    #[inline(always)]
    pub fn zero() -> Self {
        Records([[[T::default(); 4]; MAX_LANES]; RECORDS])
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
    /// Weights are no products along the axes.
    pub convected: bool,
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
    /// Do forces go by way of the moments of a cell?
    #[inline(always)]
    pub(super) fn moments<E: Stencil>(self) -> bool {
        E::NODES == 2 && self.slopes() && !self.convected
    }
    /// Are records of this kind mapped in `D` dimensions?
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

/// Products of the weights along y and z, and those along x, where single lanes can be read. Of weights that are no
/// products, and of stencils of two nodes an axis: those on all nodes.
#[derive(Clone, Copy)]
pub struct Spread<N: Copy + Send, E: Stencil> {
    x: E::Axis<N>,
    dx: E::Axis<N>,
    yz: E::Nodes<N>,
    dy: E::Nodes<N>,
    dz: E::Nodes<N>,
    table: [E::Nodes<N>; 2],
}

/// The numbers of a batch of particles.
pub(super) type NumbersOf<T, A> = <<A as Arch<T>>::Batch as Pack<T>>::Numbers;
/// Weights of a batch of particles.
pub(super) type SpreadOf<T, A, E> = Spread<NumbersOf<T, A>, E>;
/// Where the records of a batch and its weights go, one batch after the other.
pub(super) type Room<'a, T, A, E> = (&'a mut Records<T>, &'a mut SpreadOf<T, A, E>);

impl<N: Copy + Default + Send, E: Stencil> Spread<N, E> {
    /// To be filled in.
    #[inline(always)]
    pub fn zero() -> Self {
        let (axis, nodes) = (Array::filled(N::default()), Array::filled(N::default()));
        Spread { x: axis, dx: axis, yz: nodes, dy: nodes, dz: nodes, table: [nodes; 2] }
    }

    /// What particles at `xi` with these domains weigh, with slopes for forces. Returns the signed volume of domains that
    /// convect, which is positive unless they are inside out.
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
            let mut at = [Weights::<P, E>::zero(); 3];
            for d in 0..D {
                at[d] = shape.weights(xi[d], domain[d]);
            }
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

    /// The products for particles with these weights.
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

    /// Weights on all nodes, for particles with these weights along the axes of a cell.
    #[inline(always)]
    fn fill_cell<T: Float, P: Pack<T, Numbers = N>>(&mut self, at: &[Weights<P, E>; 3]) {
        let [x, y, z] = at;
        for k in 0..E::LAYERS {
            for j in 0..E::NODES {
                let yz = if E::LAYERS == 1 { y.value[j] } else { y.value[j] * z.value[k] };
                for i in 0..E::NODES {
                    (x.value[i] * yz).store(&mut self.table[0][(k * E::NODES + j) * E::NODES + i]);
                }
            }
        }
    }

    /// Weight of the particle of a lane on a node, where those on all nodes are kept.
    #[inline(always)]
    pub(super) fn weight<T: Copy>(&self, node: usize, lane: usize) -> T
    where
        N: AsRef<[T]>,
    {
        self.table[0][node].as_ref()[lane]
    }

    /// Add what the particle of a lane gives to the nodes of row `jk`, by its weights on all nodes.
    #[inline(always)]
    fn add_table<T: Float, A: Arch<T>>(
        &self,
        records: &Records<T>,
        lane: usize,
        jk: usize,
        maps: Maps,
        [one, two]: [&mut E::Axis<A::Quad>; 2],
    ) where
        N: AsRef<[T]>,
    {
        let record = |kind: usize| A::Quad::load(&records[kind][lane]);
        let splat = |rows: &E::Nodes<N>, node: usize| A::Quad::splat(rows[node].as_ref()[lane]);
        for i in 0..E::NODES {
            let node = jk * E::NODES + i;
            let value = splat(&self.table[0], node);
            if maps.momentum {
                one[i] = value.mul_add(record(MOMENTUM), one[i]);
            }
            if maps.slopes() {
                let to = if maps.together { &mut one[i] } else { &mut two[i] };
                *to = splat(&self.table[1], node).mul_add(record(FORCE), *to);
                *to = splat(&self.dy, node).mul_add(record(FORCE + 1), *to);
                if E::LAYERS > 1 {
                    *to = splat(&self.dz, node).mul_add(record(FORCE + 2), *to);
                }
                if maps.direct {
                    *to = value.mul_add(record(DIRECT), *to);
                }
            }
        }
    }

    /// What the forces along y and z, `g`, give to the nodes (j, k), before the weight along x.
    #[inline(always)]
    fn across<T: Float, Q: Quad<T> + Lane<Real = T>>(&self, lane: usize, jk: usize, g: [Q; 2]) -> Q
    where
        N: AsRef<[T]>,
    {
        let dy = g[0] * Q::splat(self.dy[jk].as_ref()[lane]);
        if E::LAYERS > 1 { g[1].mul_add(Q::splat(self.dz[jk].as_ref()[lane]), dy) } else { dy }
    }
}

/// Add the particles in the first `LANES` lanes of a group to the nodes of their bin's stencil, of which the
/// first lies at `corner` of the tile: to its `first` records and, where the pass maps two, to its `second`.
/// A lane without a particle has records of zero. Forces that go by way of [`super::cell::Moments`] are left to those.
#[inline(always)]
pub fn scatter<T: Float, A: Arch<T>, E: Stencil, const LANES: usize>(
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
    let mut rows = RowsOut::<T, NumbersOf<T, A>, E, LANES> { first, second, spread, records, maps };
    // By hand: a loop that the compiler does not unroll would decide for each row what is known here.
    rows.add_layer::<A>(0);
    if E::LAYERS > 1 {
        rows.add_layer::<A>(1);
    }
    if E::LAYERS > 2 {
        rows.add_layer::<A>(2);
    }
    if E::LAYERS > 3 {
        rows.add_layer::<A>(3);
    }
}

/// The rows of nodes of a stencil, with what is added to them.
struct RowsOut<'a, T: Float, N: Copy + Send, E: Stencil, const LANES: usize> {
    first: &'a mut [[T; 4]],
    second: &'a mut [[T; 4]],
    spread: &'a Spread<N, E>,
    records: &'a Records<T>,
    maps: Maps,
}

impl<T: Float, N: Copy + Default + Send + AsRef<[T]>, E: Stencil, const LANES: usize>
    RowsOut<'_, T, N, E, LANES>
{
    #[inline(always)]
    fn add_layer<A: Arch<T>>(&mut self, k: usize) {
        self.add::<A>(0, k);
        self.add::<A>(1, k);
        if E::NODES > 2 {
            self.add::<A>(2, k);
        }
        if E::NODES > 3 {
            self.add::<A>(3, k);
        }
    }

    /// Add to row (j, k), which is read and written once for all lanes.
    #[inline(always)]
    fn add<A: Arch<T>>(&mut self, j: usize, k: usize) {
        let RowsOut { first, second, spread, records, maps } = self;
        let (maps, jk) = (*maps, k * E::NODES + j);
        let row = (k * E::TILE + j) * E::TILE;
        let mut one = E::Axis::<A::Quad>::filled(A::Quad::zero());
        let mut two = one;
        for i in 0..E::NODES {
            if maps.momentum {
                one[i] = A::Quad::load(&first[row + i]);
            }
            if maps.second() {
                two[i] = A::Quad::load(&second[row + i]);
            }
        }
        for lane in 0..if maps.convected { LANES } else { 0 } {
            spread.add_table::<T, A>(records, lane, jk, maps, [&mut one, &mut two]);
        }
        for lane in 0..if maps.convected { 0 } else { LANES } {
            let yz = A::Quad::splat(spread.yz[jk].as_ref()[lane]);
            let mut momentum = A::Quad::load(&records[MOMENTUM][lane]);
            let mut affine = A::Quad::zero();
            if maps.has_affine() {
                if E::LAYERS > 1 {
                    let a = A::Quad::load(&records[AFFINE + 2][lane]);
                    momentum = times_offset(a, node_offset::<E>(k), momentum);
                }
                let a = A::Quad::load(&records[AFFINE + 1][lane]);
                momentum = times_offset(a, node_offset::<E>(j), momentum);
                affine = A::Quad::load(&records[AFFINE][lane]) * yz;
            }
            momentum = momentum * yz;
            let (mut along, mut across) = (A::Quad::zero(), A::Quad::zero());
            if maps.slopes() {
                along = A::Quad::load(&records[FORCE][lane]) * yz;
                let g = [A::Quad::load(&records[FORCE + 1][lane]), A::Quad::load(&records[FORCE + 2][lane])];
                across = spread.across(lane, jk, g);
                if maps.direct {
                    across = A::Quad::load(&records[DIRECT][lane]).mul_add(yz, across);
                }
                if maps.together {
                    momentum = momentum + across;
                }
            }
            for i in 0..E::NODES {
                let x = A::Quad::splat(spread.x[i].as_ref()[lane]);
                if maps.momentum {
                    let mut here = momentum;
                    if maps.has_affine() {
                        here = times_offset(affine, node_offset::<E>(i), here);
                    }
                    one[i] = x.mul_add(here, one[i]);
                }
                if maps.slopes() {
                    let sum = if maps.together { one[i] } else { x.mul_add(across, two[i]) };
                    let sum = A::Quad::splat(spread.dx[i].as_ref()[lane]).mul_add(along, sum);
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
                one[i].store(&mut first[row + i]);
            }
            if maps.second() {
                two[i].store(&mut second[row + i]);
            }
        }
    }
}

/// `a * offset + b` for an offset known when compiling.
#[inline(always)]
pub(super) fn times_offset<Q: Lane>(a: Q, offset: f64, b: Q) -> Q {
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
