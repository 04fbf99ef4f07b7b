//! Particles that leave their bins: out of a block at the end of a bin's work, into another between passes.

use std::marker::PhantomData;

use mpm_materials::Lane;

use super::scatter::{AFFINE, MAX_LANES, MOMENTUM, RECORDS, Records, Spread, scatter};
use super::sweep::{Cause, Common, ExtentOf, ShapeOf, Slot, Trouble, maps};
use super::tile::{add_to_tile, tile_corner};
use crate::dim::{Array, BLOCK, Stencil};
use crate::method::Composition;
use crate::parallel::{Arch, Float, Kernel};
use crate::particles::{Columns, Outbox};
use crate::scheme::PassKind;
use crate::shape::{ShapeFunction, Weights};

/// Take the particles in `slot.leaving` out of a bin and put them, last first, into the outbox. Their records
/// lie there already, first first.
#[cold]
pub(super) fn send_away<T: Float, const D: usize>(slot: &mut Slot<T, D>, bin: usize) {
    let Slot { block, outbox, leaving, report, .. } = slot;
    let records = outbox.records.len() - leaving.len() * RECORDS;
    reverse_records(&mut outbox.records[records..]);
    let columns = block.dummy().len();
    let half = T::of(0.5);
    for (n, index) in leaving.drain(..).rev().enumerate() {
        let index = index as usize;
        let numbers = outbox.numbers.len();
        block.read(bin, index, &mut outbox.numbers);
        let numbers = &mut outbox.numbers[numbers..numbers + columns];
        let records = &mut outbox.records[records + n * RECORDS..][..RECORDS];
        let (mut to, mut to_bin, mut weight, mut bin_weight, mut rest) = (0, 0, 1, 1, bin);
        for d in 0..D {
            let xi = numbers[Columns::position() + d];
            let shift = (xi + half).floor();
            let one_cell = shift.abs() <= T::of(1.0); // false for a value that is not a number
            if !one_cell {
                let particle = numbers[columns - 1].to_double() as usize;
                let trouble = Trouble { bin, particle, cause: Cause::TooFast };
                report.trouble = report.trouble.or(Some(trouble));
            }
            // Rounding may leave xi - shift at 1/2 where xi was just below -1/2: that is the bin's far edge.
            let local = xi - shift;
            numbers[Columns::position() + d] = local;
            // R = [m, m v] - sum A xi refers to the bin's centre.
            for c in 0..4 {
                let a = records[AFFINE + d][c];
                records[MOMENTUM][c] += a * shift;
            }
            let at = (rest % BLOCK) as i32
                + if shift > half {
                    1
                } else if shift < -half {
                    -1
                } else {
                    0
                };
            rest /= BLOCK;
            let (block_shift, place) = crate::particles::split(at);
            to += (block_shift + 1) as usize * weight;
            to_bin += place * bin_weight;
            weight *= 3;
            bin_weight *= BLOCK;
        }
        outbox.to.push(to as u8);
        outbox.bin.push(to_bin as u8);
        outbox.directions |= 1 << to;
        block.remove(bin, index);
    }
}

pub(super) fn reverse_records<T>(records: &mut [[T; 4]]) {
    let n = records.len() / RECORDS;
    for i in 0..n / 2 {
        for k in 0..RECORDS {
            records.swap(i * RECORDS + k, (n - 1 - i) * RECORDS + k);
        }
    }
}

/// Take in the particles that the blocks around sent here: append them to their bins, and scatter them.
pub struct TakeIn<'a, T: Float, const D: usize, M, K> {
    /// The method.
    pub method: &'a M,
    /// The block that takes in.
    pub slot: &'a mut Slot<T, D>,
    /// Outboxes of all slots.
    pub outboxes: &'a [Outbox<T>],
    /// Shared numbers.
    pub common: Common<T>,
    /// Column of the domain half sizes, where particles carry them.
    pub domain: usize,
    /// The pass that sent them.
    pub pass: PhantomData<K>,
}

impl<T, const D: usize, M, K> Kernel<T> for TakeIn<'_, T, D, M, K>
where
    T: Float,
    M: Composition<T, D>,
    K: PassKind,
{
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let TakeIn { method, slot, outboxes, common, domain, .. } = self;
        let maps = maps::<T, D, M, K>();
        let columns = slot.block.dummy().len();
        let mut sums: <ExtentOf<M, T, D> as Stencil>::Nodes<[A::Quad; 2]> =
            Array::filled([A::Quad::zero(); 2]);
        let directions = crate::dim::neighbours(D);
        let mut records: Records<T> = [[[T::default(); 4]; MAX_LANES]; RECORDS];
        let mut spread: Spread<T, ExtentOf<M, T, D>> = Spread::zero();
        for from in 0..directions {
            // What lies in direction `from` of here sent towards the opposite direction.
            let to = directions - 1 - from;
            let Some(outbox) = outboxes.get(slot.slots_around[from] as usize) else { continue };
            if outbox.directions >> to & 1 == 0 {
                continue;
            }
            for n in 0..outbox.to.len() {
                if outbox.to[n] as usize != to {
                    continue;
                }
                let bin = outbox.bin[n] as usize;
                let numbers = &outbox.numbers[n * columns..][..columns];
                slot.block.push(bin, numbers);
                for k in 0..RECORDS {
                    records[k][0] = outbox.records[n * RECORDS + k];
                }
                let mut at = [Weights::<A::Pack, ExtentOf<M, T, D>>::zero(); 3];
                for d in 0..D {
                    let half =
                        if ShapeOf::<M, T, D>::CARRIES_DOMAIN { numbers[domain + d] } else { common.half[d] };
                    let xi = A::Pack::splat(numbers[Columns::position() + d]);
                    at[d] = method.shape().weights(xi, A::Pack::splat(half));
                }
                spread.fill(&at, maps.slopes());
                scatter::<T, A, ExtentOf<M, T, D>>(&mut sums, &spread, &records, 0, maps);
                let corner = tile_corner::<ExtentOf<M, T, D>, D>(bin);
                add_to_tile::<T, D, A, ExtentOf<M, T, D>>(&mut slot.tile, corner, &mut sums, maps);
            }
        }
        slot.block.tidy();
    }
}
