//! Particles that leave their bins: out of a bin during its work, into another when all bins of a block are
//! done (if they stay in the block) or between passes.

use std::marker::PhantomData;

use mpm_materials::Lane;

use super::cell::Moments;
use super::scatter::{AFFINE, MAX_LANES, MOMENTUM, Maps, RECORDS, Records, Spread, scatter};
use super::splitting::Splitter;
use super::sweep::{Cause, Common, ExtentOf, Report, ShapeOf, Slot, Trouble, maps};
use super::tile::{clear_rows, rows_of, tile_corner, tile_nodes};
use crate::dim::{BLOCK, neighbours};
use crate::method::Composition;
use crate::parallel::{Arch, Float, Kernel};
use crate::particles::{Block, Columns, Outbox, Place};
use crate::scheme::PassKind;
use crate::shape::ShapeFunction;
use crate::shape::domain::MOST_NUMBERS;

/// Who leaves a group of a bin, by bits of lanes.
pub(super) struct Leaving<'a, T: Float> {
    pub(super) bin: usize,
    pub(super) group: u32,
    /// Particles that left the bin.
    pub(super) gone: u32,
    pub(super) cut: Cut<'a, T>,
}

/// Which particles are cut in two, wherever they are.
pub(super) struct Cut<'a, T: Float> {
    pub(super) long: u32,
    pub(super) splitter: &'a Splitter<T>,
    /// The velocity gradient in units of 1/s, D x D rows.
    pub(super) gradient: &'a [T::Row],
}

/// The particles of the block at work that change their bins.
#[derive(Clone, Debug, Default)]
pub struct Movers<T> {
    /// Those that stay in the block: its own pass takes them in at its end.
    within: Outbox<T>,
    /// The numbers of one on its way, or of the two that it was cut in.
    moving: Vec<T>,
}

impl<T> Movers<T> {
    /// Empty it, keeping its memory.
    pub(super) fn clear(&mut self) {
        self.within.clear();
    }
    /// Those that stay in the block.
    pub(super) fn within(&self) -> &Outbox<T> {
        &self.within
    }
    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.within.bytes() + self.moving.capacity() * size_of::<T>()
    }
}

/// Take the particles that leave a group out of their bin and put them into the outbox, or among those that stay in the
/// block, with their records, of which zeros are left; what is cut in two goes there as two.
#[cold]
pub(super) fn send_away<T: Float, const D: usize>(
    block: &mut Block<T, D>,
    (outbox, movers): (&mut Outbox<T>, &mut Movers<T>),
    report: &mut Report<T>,
    leaving: Leaving<'_, T>,
    records: &mut Records<T>,
    maps: Maps,
) {
    let Leaving { bin, group, gone, cut: Cut { long, splitter, gradient } } = leaving;
    let columns = block.dummy().len();
    let Movers { within, moving } = movers;
    let mut leave = gone | long;
    // The last lane first: the particle that takes the place of one removed has been at work already.
    while leave != 0 {
        let lane = leave.ilog2();
        leave &= !(1 << lane);
        moving.clear();
        block.read(Place { group, lane }, moving);
        block.remove(bin, Place { group, lane });
        let mut own = [[T::default(); 4]; RECORDS];
        for kind in 0..RECORDS {
            if maps.uses::<D>(kind) {
                own[kind] = std::mem::take(&mut records[kind][lane as usize]);
            }
        }
        let fast = too_fast::<T, D>(moving);
        if let Some(particle) = fast {
            let trouble = Trouble { bin, particle, cause: Cause::TooFast };
            report.trouble = report.trouble.or(Some(trouble));
        }
        if long >> lane & 1 == 1 && fast.is_none() {
            // A child takes half of everything its parent maps, from its own place.
            for record in &mut own {
                for x in record {
                    *x *= T::of(0.5);
                }
            }
            report.revealed += splitter.cut::<D>(moving, 0, gradient, lane as usize);
            report.splits += 1;
        }
        for numbers in moving.chunks_exact_mut(columns) {
            post::<T, D>(outbox, within, bin, numbers, own, maps);
        }
    }
}

/// The number of a particle that moved by more than a cell, or nobody knows where.
fn too_fast<T: Float, const D: usize>(numbers: &[T]) -> Option<usize> {
    for d in 0..D {
        let shift = (numbers[Columns::position() + d] + T::of(0.5)).floor();
        let one_cell = shift.abs() <= T::of(1.0); // false for a value that is not a number
        if !one_cell {
            return Some(numbers[numbers.len() - 1].to_double() as usize);
        }
    }
    None
}

/// Address a particle with these numbers that came out of `bin`: to another block, or `within` this one.
fn post<T: Float, const D: usize>(
    outbox: &mut Outbox<T>,
    within: &mut Outbox<T>,
    bin: usize,
    numbers: &mut [T],
    mut records: [[T; 4]; RECORDS],
    maps: Maps,
) {
    let half = T::of(0.5);
    let (mut to, mut to_bin, mut weight, mut bin_weight, mut rest) = (0, 0, 1, 1, bin);
    for d in 0..D {
        let xi = numbers[Columns::position() + d];
        let shift = (xi + half).floor();
        // Rounding may leave xi - shift at 1/2 where xi was just below -1/2: that is the bin's far edge.
        numbers[Columns::position() + d] = xi - shift;
        if maps.has_affine() {
            // R = [m, m v] - sum A xi refers to the bin's centre.
            for c in 0..4 {
                let more = records[AFFINE + d][c] * shift;
                records[MOMENTUM][c] += more;
            }
        }
        // Two cells are the most: one moved, less than one from the parent.
        let cells = (shift.to_double() as i32).clamp(-2, 2);
        let at = (rest % BLOCK) as i32 + cells;
        rest /= BLOCK;
        let (block_shift, place) = crate::particles::split(at);
        to += (block_shift + 1) as usize * weight;
        to_bin += place * bin_weight;
        weight *= 3;
        bin_weight *= BLOCK;
    }
    let to_list = if to == neighbours(D) / 2 { within } else { outbox };
    let used = records.into_iter().enumerate().filter(|&(kind, _)| maps.uses::<D>(kind));
    to_list.post(to, to_bin, numbers, used.map(|(_, record)| record));
}

/// Where particles' domains come from: their columns, or one box for all.
#[derive(Clone, Copy, Debug)]
pub struct Domains<T> {
    /// The first column, where particles carry them.
    pub column: usize,
    /// Half sizes of those that don't, in units of h.
    pub half: [T; 3],
}

impl<T: Float> Domains<T> {
    /// The numbers of a domain, of which `carried` gives those that particles have of their own.
    #[inline(always)]
    pub(super) fn of<P: Lane<Real = T>, S: ShapeFunction<T, D>, const D: usize>(
        &self,
        carried: impl Fn(usize) -> P,
    ) -> [P; MOST_NUMBERS] {
        let mut domain = [P::of(0.5); MOST_NUMBERS];
        if S::DOMAIN.carried() {
            for n in 0..S::DOMAIN.numbers(D) {
                domain[n] = carried(n);
            }
        } else {
            for d in 0..D {
                domain[d] = P::splat(self.half[d]);
            }
        }
        domain
    }
}

/// Append the particles that an outbox sends in direction `to` to their bins, and scatter them.
#[inline(always)]
pub(super) fn take_in<T, A, const D: usize, M, K>(
    method: &M,
    block: &mut Block<T, D>,
    (tile, rows): (&mut [[T; 4]], &mut u64),
    outbox: &Outbox<T>,
    to: usize,
    domains: Domains<T>,
    scratch: (&mut Records<T>, &mut Spread<T, ExtentOf<M, T, D>>),
) where
    T: Float,
    A: Arch<T>,
    M: Composition<T, D>,
    K: PassKind,
{
    if outbox.directions >> to & 1 == 0 {
        return;
    }
    let maps = maps::<T, D, M, K>();
    let columns = block.dummy().len();
    let mut kinds = 0;
    for kind in 0..RECORDS {
        kinds += usize::from(maps.uses::<D>(kind));
    }
    let (records, spread) = scratch;
    for n in 0..outbox.to.len() {
        if outbox.to[n] as usize != to {
            continue;
        }
        let bin = outbox.bin[n] as usize;
        let numbers = &outbox.numbers[n * columns..][..columns];
        block.push(bin, numbers);
        let more = rows_of::<ExtentOf<M, T, D>, D>(1 << bin) & !*rows;
        clear_rows::<T, D, ExtentOf<M, T, D>>(tile, more, maps);
        *rows |= more;
        let sent = &outbox.records[n * kinds..][..kinds];
        let mut next = 0;
        for kind in 0..RECORDS {
            if maps.uses::<D>(kind) {
                records[kind][0] = sent[next];
                next += 1;
            }
        }
        let mut xi = [A::Pack::zero(); 3];
        for d in 0..D {
            xi[d] = A::Pack::splat(numbers[Columns::position() + d]);
        }
        let carried = |n: usize| A::Pack::splat(numbers[domains.column + n]);
        let domain = domains.of::<A::Pack, ShapeOf<M, T, D>, D>(carried);
        spread.place(method.shape(), &xi, &domain, maps.slopes());
        let corner = tile_corner::<ExtentOf<M, T, D>, D>(bin);
        let (first, second) = tile.split_at_mut(tile_nodes::<ExtentOf<M, T, D>>(D));
        if maps.moments::<ExtentOf<M, T, D>>() {
            let mut at = [T::default(); 3];
            at[..D].copy_from_slice(&numbers[Columns::position()..][..D]);
            let mut moments = Moments::<A::Quad, ExtentOf<M, T, D>>::zero();
            moments.add_one(at, records);
            moments.give(if maps.together { &mut *first } else { &mut *second }, corner);
        }
        scatter::<T, A, ExtentOf<M, T, D>, 1>([first, second], corner, spread, records, maps);
    }
}

/// Take in the particles that the blocks around sent here.
pub struct TakeIn<'a, T: Float, const D: usize, M, K> {
    /// The method.
    pub method: &'a M,
    /// The block that takes in.
    pub slot: &'a mut Slot<T, D>,
    /// Outboxes of all slots.
    pub outboxes: &'a [Outbox<T>],
    /// Shared numbers.
    pub common: Common<T>,
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
        let TakeIn { method, slot, outboxes, common, .. } = self;
        let Slot { block, tile, rows, slots_around, .. } = slot;
        let mut records: Records<T> = [[[T::default(); 4]; MAX_LANES]; RECORDS];
        let mut spread: Spread<T, ExtentOf<M, T, D>> = Spread::zero();
        for from in 0..neighbours(D) {
            // What lies in direction `from` of here sent towards the opposite direction.
            let to = neighbours(D) - 1 - from;
            if from == to {
                continue; // its own pass took them in
            }
            let Some(outbox) = outboxes.get(slots_around[from] as usize) else { continue };
            let scratch = (&mut records, &mut spread);
            let sums = (&mut tile[..], &mut *rows);
            take_in::<T, A, D, M, K>(method, block, sums, outbox, to, common.domains, scratch);
        }
        block.tidy();
    }
}
