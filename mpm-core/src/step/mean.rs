//! The mean dilatation of a bin ([`crate::MeanDilatation`]).

use mpm_materials::{Constitutive, Lane, Mat3, State};

use super::gather::{Sampler, Wanted};
use super::rows::Rows;
use super::sweep::{Common, ExtentOf, ShapeOf};
use super::tile::Stencilled;
use super::total;
use crate::dilatation::MeanDilatation;
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::method::Composition;
use crate::parallel::{Arch, Float, Pack, lane_numbers};
use crate::particles::{Block, Columns};
use crate::scheme::Nodal;
use crate::transfer::Transfer;

/// Axes that a dilatation is spread over.
#[inline(always)]
fn axes<T: Float, const D: usize, M: Composition<T, D>>() -> usize {
    if D == 3 || M::Embedding::HOOP { 3 } else { 2 }
}

/// Means over the particles of a bin, by mass.
#[derive(Clone, Copy)]
pub(super) struct Mean<L> {
    /// Of the traces of the step's increments.
    trace: L,
    /// Of the volume ratios before it.
    ratio: L,
}

impl<L: Lane> Mean<L> {
    /// The increment as laws see it, of particles of this volume ratio.
    #[inline(always)]
    pub(super) fn give<T: Float, const D: usize, M: Composition<T, D>>(
        &self,
        mut increment: Mat3<L>,
        ratio: L,
    ) -> Mat3<L>
    where
        L: Lane<Real = T>,
    {
        let axes = axes::<T, D, M>();
        let back = (self.ratio - ratio) / ratio * L::of(MeanDilatation::RETURN);
        let more = (self.trace + back - increment.trace()) * L::of(1.0 / axes as f64);
        for d in 0..axes {
            increment.0[d][d] = increment.0[d][d] + more;
        }
        increment
    }
}

/// Where a bin's particles take their strain from.
pub(super) struct Strained<'a, T: Float, const D: usize, C, M: Composition<T, D>> {
    pub(super) law: &'a C,
    pub(super) method: &'a M,
    pub(super) block: &'a Block<T, D>,
    pub(super) bin: usize,
    pub(super) stencil: &'a Stencilled<T, ExtentOf<M, T, D>>,
    pub(super) nodal: Nodal,
    pub(super) common: &'a Common<T>,
    /// x of the bin's centre, m.
    pub(super) bin_x: T,
}

impl<T: Float, const D: usize, C: Constitutive<T>, M: Composition<T, D>> Strained<'_, T, D, C, M> {
    /// The means of the bin.
    #[inline(always)]
    pub(super) fn mean<A: Arch<T>>(&self) -> Mean<A::Batch> {
        let mut sums = [A::Pack::zero(); 3];
        let mut next = self.block.last_group(self.bin);
        let lane_index = lane_numbers::<T, A::Pack>();
        while let Some((group, here)) = next {
            next = self.block.group_before(group);
            let rows = self.block.group(group);
            let alive = lane_index.lt(A::Pack::of(here as f64));
            let now = C::State::<A::Pack>::read(&mut Rows::of(rows).reader(Columns::state(D)));
            let mass = self.common.masses.of_group(alive, |row| A::Pack::load(&rows[row]));
            sums[0] = sums[0] + mass;
            sums[1] = mass.mul_add(self.trace::<A>(rows, alive), sums[1]);
            let ratio = A::Pack::select(alive, self.law.volume_ratio(&now), A::Pack::zero());
            sums[2] = mass.mul_add(ratio, sums[2]);
        }
        let (mut mass, mut trace, mut ratio) = (T::default(), T::default(), T::default());
        for lane in 0..A::Pack::WIDTH {
            mass += sums[0].lane(lane);
            trace += sums[1].lane(lane);
            ratio += sums[2].lane(lane);
        }
        Mean { trace: A::Batch::splat(trace / mass), ratio: A::Batch::splat(ratio / mass) }
    }

    /// The trace of the increment of a group's particles; zero in a lane without one.
    #[inline(always)]
    fn trace<A: Arch<T>>(&self, rows: &[T::Row], alive: <A::Pack as Lane>::Mask) -> A::Pack {
        let Strained { method, stencil, common, .. } = *self;
        let zero = A::Pack::zero();
        let first = matches!(self.nodal, Nodal::First);
        let fit = M::Transfer::LEAST_SQUARES && first;
        let mut xi = [zero; 3];
        for d in 0..D {
            xi[d] = A::Pack::load(&rows[Columns::position() + d]);
        }
        let carried = |n: usize| A::Pack::load(&rows[common.domains.column + n]);
        let domain = common.domains.of::<A::Pack, ShapeOf<M, T, D>, D>(carried);
        let sampler = Sampler::of(method.shape(), &xi, &domain, fit);
        let nodes = if first { &stencil.first } else { &stencil.second };
        let mut gradient = Mat3::<A::Pack>::zero();
        let mut outward = zero;
        for c in 0..D {
            let wanted = Wanted { slope: !fit, fit };
            let found = sampler.gather::<T, ShapeOf<M, T, D>, D>(nodes, c, wanted);
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
            let f = total::load::<T, A::Pack, D, M, _>(&Rows::of(rows), common.frame);
            increment = total::product::<A::Pack, D>(&increment, &total::inverse::<A::Pack, D>(&f));
        }
        A::Pack::select(alive, increment.trace(), zero)
    }
}
