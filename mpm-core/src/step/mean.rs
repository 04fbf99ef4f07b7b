//! The mean dilatation of a bin ([`crate::MeanDilatation`]).

use mpm_materials::{Lane, Mat3};

use super::gather::{Wanted, gather};
use super::sweep::{Common, ExtentOf, ShapeOf};
use super::tile::Stencilled;
use super::total;
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::method::Composition;
use crate::parallel::{Arch, Float, Pack};
use crate::particles::{Block, Columns};
use crate::scheme::Nodal;
use crate::shape::{Basis, ShapeFunction};
use crate::transfer::Transfer;

/// Axes that a dilatation is spread over.
#[inline(always)]
fn axes<T: Float, const D: usize, M: Composition<T, D>>() -> usize {
    if D == 3 || M::Embedding::HOOP { 3 } else { 2 }
}

/// The increment with another trace.
#[inline(always)]
pub(super) fn with_trace<T: Float, const D: usize, M: Composition<T, D>, L: Lane<Real = T>>(
    mut increment: Mat3<L>,
    trace: L,
) -> Mat3<L> {
    let axes = axes::<T, D, M>();
    let more = (trace - increment.trace()) * L::of(1.0 / axes as f64);
    for d in 0..axes {
        increment.0[d][d] = increment.0[d][d] + more;
    }
    increment
}

/// Where a bin's particles take their strain from.
pub(super) struct Strained<'a, T: Float, const D: usize, M: Composition<T, D>> {
    pub(super) method: &'a M,
    pub(super) block: &'a Block<T, D>,
    pub(super) bin: usize,
    pub(super) stencil: &'a Stencilled<T, ExtentOf<M, T, D>>,
    pub(super) nodal: Nodal,
    pub(super) common: &'a Common<T>,
    /// x of the bin's centre, m.
    pub(super) bin_x: T,
}

impl<T: Float, const D: usize, M: Composition<T, D>> Strained<'_, T, D, M> {
    /// Mean over the particles of the bin of the trace of the step's increment, by mass.
    #[inline(always)]
    pub(super) fn mean_trace<A: Arch<T>>(&self) -> A::Pack {
        let (mut sum, mut mass) = (A::Pack::zero(), A::Pack::zero());
        let mut next = self.block.last_group(self.bin);
        while let Some((group, _)) = next {
            next = self.block.group_before(group);
            // Lanes without a particle weigh nothing.
            let rows = self.block.group(group);
            let m = A::Pack::load(&rows[Columns::mass(D)]);
            sum = m.mul_add(self.trace::<A>(rows), sum);
            mass = mass + m;
        }
        let (mut s, mut m) = (T::default(), T::default());
        for lane in 0..A::Pack::WIDTH {
            s += sum.lane(lane);
            m += mass.lane(lane);
        }
        A::Pack::splat(s / m)
    }

    /// The trace of the increment of a group's particles; zero in a lane without one.
    #[inline(always)]
    fn trace<A: Arch<T>>(&self, rows: &[T::Row]) -> A::Pack {
        let Strained { method, stencil, common, .. } = *self;
        let zero = A::Pack::zero();
        let first = matches!(self.nodal, Nodal::First);
        let fit = M::Transfer::LEAST_SQUARES && first;
        let mut basis = [Basis::<A::Pack, ExtentOf<M, T, D>>::zero(); 3];
        for d in 0..D {
            let xi = A::Pack::load(&rows[Columns::position() + d]);
            let domain = if ShapeOf::<M, T, D>::CARRIES_DOMAIN {
                A::Pack::load(&rows[common.domains.column + d])
            } else {
                A::Pack::splat(common.domains.half[d])
            };
            basis[d] = method.shape().basis(xi, domain, fit);
        }
        let nodes = if first { &stencil.first } else { &stencil.second };
        let mut gradient = Mat3::<A::Pack>::zero();
        let mut outward = zero;
        for c in 0..D {
            let wanted = Wanted { slope: !fit, fit };
            let found = gather::<T, D, A::Pack, ShapeOf<M, T, D>>(nodes, &basis, c, wanted);
            gradient.0[c] = if fit { found.fit } else { found.slope };
            if c == 0 {
                outward = found.value;
            }
        }
        let (dt, spacing) = (A::Pack::splat(common.dt), A::Pack::splat(common.spacing));
        let mut increment = gradient * (dt * spacing.recip());
        if M::Embedding::HOOP {
            let xi = A::Pack::load(&rows[Columns::position()]);
            increment.0[2][2] = dt * outward / xi.mul_add(spacing, A::Pack::splat(self.bin_x));
        }
        if M::Frame::TOTAL {
            let frame = rows.len() - 1 - total::rows::<T, D, M>();
            let f = total::load::<T, A::Pack, D, M>(&rows[frame..]);
            increment = total::product::<A::Pack, D>(&increment, &total::inverse::<A::Pack, D>(&f));
        }
        let mass = A::Pack::load(&rows[Columns::mass(D)]);
        A::Pack::select(mass.gt(zero), increment.trace(), zero)
    }
}
