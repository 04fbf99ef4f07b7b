//! Particles that leave their bins: out of a bin during its work, into another when all bins of a block are
//! done (if they stay in the block) or between passes.

use std::marker::PhantomData;

use mpm_materials::Lane;

use super::cell::{Moments, add_particle, on_cell};
use super::scatter::{AFFINE, FORCE, MOMENTUM, Maps, RECORDS, Records, Room, SpreadOf, along_axes, scatter};
use super::splitting::Splitter;
use super::sweep::{Cause, Common, ExtentOf, Report, ShapeOf, Slot, Trouble, maps};
use super::tile::{clear_rows, rows_of, tile_corner, tile_nodes};
use crate::dim::{BLOCK, Stencil, neighbours};
use crate::method::Composition;
use crate::parallel::{Arch, Float, Kernel};
use crate::particles::{Block, Columns, Outbox, Place, Sent};
use crate::scheme::PassKind;
use crate::shape::ShapeFunction;
use crate::shape::domain::MOST_NUMBERS;

/// Who leaves groups of a bin that go through a pass together, by bits of lanes.
pub(super) struct Leaving<'a, T: Float, N> {
    pub(super) bin: usize,
    /// The groups, in the order of their lanes. The last one is the last of them in the bin.
    pub(super) groups: [u32; 2],
    /// Particles that left the bin.
    pub(super) gone: u32,
    pub(super) cut: Cut<'a, T, N>,
}

/// Which particles are cut in two, wherever they are.
pub(super) struct Cut<'a, T: Float, N> {
    pub(super) long: u32,
    pub(super) splitter: &'a Splitter<T>,
    /// The velocity gradient in units of 1/s, D x D rows.
    pub(super) gradient: &'a [N],
}

/// The particles that change their bins, as a thread finds them.
#[derive(Clone, Debug, Default)]
pub struct Movers<T> {
    /// Those that leave their block.
    pub(super) out: Outbox<T>,
    /// Those of the block at work that stay in it: its own pass takes them in at its end.
    pub(super) within: Outbox<T>,
    /// The numbers of one on its way, or of the two that it was cut in.
    moving: Vec<T>,
}

impl<T: Float> Movers<T> {
    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.out.bytes() + self.within.bytes() + self.moving.capacity() * size_of::<T>()
    }
}

/// The numbers of a particle's records that go with it when it leaves its bin: not those that are zero, nor G_dc beside G_cd,
/// nor mass and momentum, where they are those of the particle itself.
pub(super) struct Luggage {
    /// By kind of record and place in it.
    numbers: [(u8, u8); MOST_LUGGAGE],
    count: usize,
}
/// Momentum, hoop force and load, affine part, force.
const MOST_LUGGAGE: usize = 3 + 3 + 9 + 6;

impl Luggage {
    /// Of the particles in a pass.
    #[inline(always)]
    pub(super) fn of<T: Float, const D: usize, M: Composition<T, D>, K: PassKind>() -> Self {
        let maps = maps::<T, D, M, K>();
        // What is cut in two gives each half of what the whole would map.
        let plain = !maps.has_affine() && !K::DOES.splits;
        let mut luggage = Luggage { numbers: [(0, 0); MOST_LUGGAGE], count: 0 };
        for kind in 0..RECORDS {
            let from = kind.saturating_sub(FORCE);
            for c in from..if maps.uses::<D>(kind) && !(kind == MOMENTUM && plain) { D } else { 0 } {
                luggage.numbers[luggage.count] = (kind as u8, c as u8 + 1);
                luggage.count += 1;
            }
        }
        luggage
    }

    /// How many numbers that are.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Take them from the records.
    #[inline(always)]
    fn pack<T: Copy>(&self, records: &[[T; 4]; RECORDS], to: &mut [T]) {
        for (x, &(kind, c)) in to.iter_mut().zip(&self.numbers[..self.count]) {
            *x = records[kind as usize][c as usize];
        }
    }

    /// The records of a particle with these numbers, of which those that went with it are the last.
    #[inline(always)]
    fn unpack<T: Float, const D: usize>(&self, numbers: &[T], mass: T, maps: Maps) -> [[T; 4]; RECORDS] {
        let mut records = [[T::default(); 4]; RECORDS];
        if maps.momentum {
            records[MOMENTUM][0] = mass;
            for d in 0..D {
                records[MOMENTUM][d + 1] = mass * numbers[Columns::velocity(D) + d];
            }
        }
        let packed = &numbers[numbers.len() - self.count..];
        for (&x, &(kind, c)) in packed.iter().zip(&self.numbers[..self.count]) {
            records[kind as usize][c as usize] = x;
            if kind as usize >= FORCE {
                records[FORCE + c as usize - 1][kind as usize - FORCE + 1] = x;
            }
        }
        records
    }
}

/// Take the particles that leave groups out of their bin and put them into the outbox, or among those that stay in the
/// block, with their records, of which zeros are left; what is cut in two goes there as two.
#[cold]
#[inline(never)]
pub(super) fn send_away<T: Float, N: AsRef<[T]>, const D: usize, M: Composition<T, D>, K: PassKind>(
    block: &mut Block<T, D>,
    Movers { out, within, moving }: &mut Movers<T>,
    report: &mut Report<T>,
    leaving: Leaving<'_, T, N>,
    records: &mut Records<T>,
) {
    let Leaving { bin, groups, gone, cut: Cut { long, splitter, gradient } } = leaving;
    let maps = maps::<T, D, M, K>();
    let columns = block.particle_numbers();
    let luggage = Luggage::of::<T, D, M, K>();
    let mut leave = gone | long;
    // The last lane first: the particle that takes the place of one removed has been at work already.
    while leave != 0 {
        let lane = leave.ilog2();
        leave &= !(1 << lane);
        let place = Place { group: groups[lane as usize / T::GROUP % 2], lane: lane % T::GROUP as u32 };
        let mut own = [[T::default(); 4]; RECORDS];
        for kind in 0..RECORDS {
            if maps.uses::<D>(kind) {
                own[kind] = std::mem::take(&mut records[kind][lane as usize]);
            }
        }
        let mut xi = [T::default(); 3];
        for d in 0..D {
            xi[d] = block.get(place, Columns::position() + d);
        }
        let address = Address::of::<D>(&xi, bin);
        if address.far {
            let particle = block.number(place);
            let trouble = Trouble { bin, particle, cause: Cause::TooFast };
            report.trouble = report.trouble.or(Some(trouble));
        }
        if long >> lane & 1 == 0 || address.far {
            address.turn::<D>(&mut own, maps);
            let (numbers, packed) = address.room::<D>(out, within).split_at_mut(columns);
            luggage.pack(&own, packed);
            block.take(bin, place, numbers);
            address.shift::<D>(numbers);
            continue;
        }
        // A child takes half of everything its parent maps, from its own place.
        for record in &mut own {
            for x in record {
                *x *= T::of(0.5);
            }
        }
        moving.clear();
        moving.resize(columns, T::default());
        block.take(bin, place, moving);
        report.revealed += splitter.cut::<D>(moving, 0, gradient, lane as usize);
        report.splits += 1;
        for child in moving.chunks_exact(columns) {
            let mut own = own;
            xi[..D].copy_from_slice(&child[Columns::position()..][..D]);
            let address = Address::of::<D>(&xi, bin);
            address.turn::<D>(&mut own, maps);
            let (numbers, packed) = address.room::<D>(out, within).split_at_mut(columns);
            luggage.pack(&own, packed);
            numbers.copy_from_slice(child);
            address.shift::<D>(numbers);
        }
    }
}

/// In which bin is xi, seen from the one it was in?
#[inline(always)]
fn cells_off<T: Float>(xi: T) -> T {
    let (half, far) = (T::of(0.5), T::of(1.5));
    if xi >= half && xi < far {
        T::of(1.0)
    } else if xi >= -half && xi < half {
        T::default()
    } else if xi >= -far && xi < -half {
        T::of(-1.0)
    } else {
        (xi + half).floor()
    }
}

/// Where a particle goes that left its bin.
struct Address<T> {
    /// The block, as an outbox has it.
    to: usize,
    bin: usize,
    /// By how many cells.
    cells: [T; 3],
    /// Is that more than one, or does nobody know?
    far: bool,
}

impl<T: Float> Address<T> {
    /// Of a particle at `xi` of `bin`.
    #[inline(always)]
    fn of<const D: usize>(xi: &[T; 3], bin: usize) -> Self {
        let mut address = Address { to: 0, bin: 0, cells: [T::default(); 3], far: false };
        let (mut weight, mut bin_weight, mut rest) = (1, 1, bin);
        for d in 0..D {
            let cells = cells_off(xi[d]);
            address.cells[d] = cells;
            let within_one = cells.abs() <= T::of(1.0); // false for a value that is not a number
            address.far |= !within_one;
            // Two cells are the most: one moved, less than one from the parent.
            let at = (rest % BLOCK) as i32 + (cells.to_double() as i32).clamp(-2, 2);
            rest /= BLOCK;
            let (block_shift, place) = crate::particles::split(at);
            address.to += (block_shift + 1) as usize * weight;
            address.bin += place * bin_weight;
            weight *= 3;
            bin_weight *= BLOCK;
        }
        address
    }

    /// Make records refer to the bin that the particle goes to: R = [m, m v] - sum A xi refers to the bin's centre.
    #[inline(always)]
    fn turn<const D: usize>(&self, records: &mut [[T; 4]; RECORDS], maps: Maps) {
        for d in 0..if maps.has_affine() { D } else { 0 } {
            for c in 0..4 {
                let more = records[AFFINE + d][c] * self.cells[d];
                records[MOMENTUM][c] += more;
            }
        }
    }

    /// Room for its numbers and what goes with it.
    #[inline(always)]
    fn room<'a, const D: usize>(&self, out: &'a mut Outbox<T>, within: &'a mut Outbox<T>) -> &'a mut [T] {
        let list = if self.to == neighbours(D) / 2 { within } else { out };
        list.post(self.to, self.bin)
    }

    /// Make its position refer to that bin, too. Rounding may leave it at 1/2 where it was just below -1/2: that is the bin's
    /// far edge.
    #[inline(always)]
    fn shift<const D: usize>(&self, numbers: &mut [T]) {
        for d in 0..D {
            numbers[Columns::position() + d] -= self.cells[d];
        }
    }
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

/// The offset and the domain of a particle with these numbers, in every lane.
#[inline(always)]
fn place_of<T: Float, P: Lane<Real = T>, const D: usize, M: Composition<T, D>>(
    numbers: &[T],
    domains: &Domains<T>,
) -> ([P; 3], [P; MOST_NUMBERS]) {
    let mut xi = [P::zero(); 3];
    for d in 0..D {
        xi[d] = P::splat(numbers[Columns::position() + d]);
    }
    let carried = |n: usize| P::splat(numbers[domains.column + n]);
    (xi, domains.of::<P, ShapeOf<M, T, D>, D>(carried))
}

/// Append particles that come to a block to their bins there, and scatter them.
#[inline(always)]
pub(super) fn take_in<'a, T, A, const D: usize, M, K>(
    method: &M,
    block: &mut Block<T, D>,
    (tile, rows): (&mut [[T; 4]], &mut u64),
    arrivals: impl Iterator<Item = (usize, &'a [T])>,
    common: &Common<T>,
    (records, spread): Room<'_, T, A, ExtentOf<M, T, D>>,
) where
    T: Float,
    A: Arch<T>,
    M: Composition<T, D>,
    K: PassKind,
{
    let maps = maps::<T, D, M, K>();
    let columns = block.particle_numbers();
    let luggage = Luggage::of::<T, D, M, K>();
    for (bin, numbers) in arrivals {
        block.push(bin, &numbers[..columns]);
        let more = rows_of::<ExtentOf<M, T, D>, D>(1 << bin) & !*rows;
        clear_rows::<T, D, ExtentOf<M, T, D>>(tile, more, maps);
        *rows |= more;
        let own = luggage.unpack::<T, D>(numbers, common.masses.of(numbers), maps);
        let corner = tile_corner::<ExtentOf<M, T, D>, D>(bin);
        let (first, second) = tile.split_at_mut(tile_nodes::<ExtentOf<M, T, D>>(D));
        if maps.moments::<ExtentOf<M, T, D>>() {
            let mut at = [T::default(); 3];
            at[..D].copy_from_slice(&numbers[Columns::position()..][..D]);
            let mut moments = Moments::<A::Quad, ExtentOf<M, T, D>>::zero();
            moments.add_one(&at, &own);
            moments.give(if maps.together { &mut *first } else { &mut *second }, corner);
        }
        if ExtentOf::<M, T, D>::NODES == 2 && !maps.convected {
            let (xi, domain) = place_of::<T, T::Single, D, M>(numbers, &common.domains);
            let along = along_axes(method.shape(), &xi, &domain);
            let weights = on_cell::<T::Single, ExtentOf<M, T, D>>(&along);
            add_particle::<T, A, ExtentOf<M, T, D>>([first, second], corner, &weights, &own, maps);
            continue;
        }
        for kind in 0..RECORDS {
            records[kind][0] = own[kind];
        }
        let (xi, domain) = place_of::<T, A::Batch, D, M>(numbers, &common.domains);
        spread.place::<T, A::Batch, _, D>(method.shape(), &xi, &domain, maps.slopes());
        scatter::<T, A, ExtentOf<M, T, D>, 1>([first, second], corner, spread, records, maps);
    }
}

/// Take in the particles that the blocks around sent here.
pub struct TakeIn<'a, T: Float, const D: usize, M, K> {
    /// The method.
    pub method: &'a M,
    /// The block that takes in.
    pub slot: &'a mut Slot<T, D>,
    /// What all slots sent, and the outboxes where it is.
    pub sent: &'a [Sent],
    /// The outboxes.
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
        let TakeIn { method, slot, sent, outboxes, common, .. } = self;
        let Slot { block, tile, rows, slots_around, .. } = slot;
        let tile = tile.all_mut();
        let (mut records, mut spread) = (Records::<T>::zero(), SpreadOf::<T, A, ExtentOf<M, T, D>>::zero());
        for from in 0..neighbours(D) {
            // What lies in direction `from` of here sent towards the opposite direction.
            let to = neighbours(D) - 1 - from;
            if from == to {
                continue; // its own pass took them in
            }
            let Some(sent) = sent.get(slots_around[from] as usize).filter(|sent| sent.goes(to)) else {
                continue;
            };
            let arrivals = outboxes[sent.outbox as usize].going(*sent, to);
            let sums = (&mut tile[..], &mut *rows);
            let scratch = (&mut records, &mut spread);
            take_in::<T, A, D, M, K>(method, block, sums, arrivals, &common, scratch);
        }
    }
}
