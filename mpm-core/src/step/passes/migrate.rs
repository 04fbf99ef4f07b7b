//! Particles that leave their bins: out of a bin during its work, into another when all bins of a block are
//! done (if they stay in the block) or between passes.

use mpm_materials::Lane;

use super::cell::{Moments, add_particle};
use super::slot::{Common, Domains, Movers, Report, Trouble};
use super::spread::on_cell;
use super::spread::{
    AFFINE, DIRECT, FORCE, MAX_LANES, MOMENTUM, Maps, RECORDS, Records, along_axes, times_offset,
};
use super::tile::{clear_rows, rows_of, tile_corner, tile_nodes};
use crate::dim::{BLOCK, Stencil, neighbours};
use crate::particles::{Block, Columns, Members, Outbox, Place, Sent};
use crate::shape::domain::{MOST_NUMBERS, table};
use crate::shape::{ShapeFunction, node_offset};
use crate::step::between_steps::splitting::Splitter;
use impactite_scene::Cause;
use impactite_simd::{Arch, Float, Kernel, Quad, Vectors};

/// Who leaves groups of a bin that go through a pass together, by bits of lanes.
pub(in crate::step) struct Leaving<'a, T: Float> {
    pub(in crate::step) bin: usize,
    /// The groups. The last one is the last of them in the bin.
    pub(in crate::step) members: Members,
    /// Particles that left the bin.
    pub(in crate::step) gone: u32,
    pub(in crate::step) cut: Cut<'a, T>,
}

/// Which particles are cut in two, wherever they are.
pub(in crate::step) struct Cut<'a, T: Float> {
    pub(in crate::step) long: u32,
    pub(in crate::step) splitter: &'a Splitter<T>,
    /// The velocity gradient in units of 1/s, D x D numbers of each lane.
    pub(in crate::step) gradient: &'a [[T; MAX_LANES]; 9],
}

/// The numbers of a particle's records that go with it when it leaves its bin: not those that are zero, nor G_dc beside G_cd,
/// nor mass and momentum, where they are those of the particle itself.
pub(crate) struct MigrationPayload {
    /// By kind of record and place in it.
    numbers: [(u8, u8); MOST_LUGGAGE],
    count: usize,
}
/// Momentum, hoop force and load, affine part, force.
const MOST_LUGGAGE: usize = 3 + 3 + 9 + 6;

impl MigrationPayload {
    /// Of the particles in a pass that maps this; may they be cut in two?
    #[inline(always)]
    pub(in crate::step) fn of<const D: usize>(maps: Maps, splits: bool) -> Self {
        // What is cut in two gives each half of what the whole would map.
        let plain = !maps.has_affine() && !splits;
        let mut payload = MigrationPayload { numbers: [(0, 0); MOST_LUGGAGE], count: 0 };
        for kind in 0..RECORDS {
            let from = kind.saturating_sub(FORCE);
            for c in from..if maps.uses::<D>(kind) && !(kind == MOMENTUM && plain) { D } else { 0 } {
                payload.numbers[payload.count] = (kind as u8, c as u8 + 1);
                payload.count += 1;
            }
        }
        payload
    }

    /// How many numbers that are.
    #[inline(always)]
    pub(in crate::step) fn count(&self) -> usize {
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
pub(in crate::step) fn send_away<T: Float, const D: usize>(
    block: &mut Block<T, D>,
    Movers { out, within, moving }: &mut Movers<T>,
    report: &mut Report<T>,
    leaving: Leaving<'_, T>,
    (records, maps, payload): (&mut Records<T>, Maps, &MigrationPayload),
) {
    let Leaving { bin, members, gone, cut: Cut { long, splitter, gradient } } = leaving;
    let columns = block.particle_numbers();
    let mut leave = gone | long;
    // The last lane first: the particle that takes the place of one removed has been at work already.
    while leave != 0 {
        let lane = leave.ilog2();
        leave &= !(1 << lane);
        let (group, at) = members.place::<T>(lane as usize);
        let place = Place { group, lane: at as u32 };
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
            payload.pack(&own, packed);
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
            payload.pack(&own, packed);
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

/// The offset and the domain of a particle of which `number` gives the number in a row.
#[inline(always)]
pub(in crate::step) fn place_of<T: Float, const D: usize, S: ShapeFunction<T, D>>(
    number: impl Fn(usize) -> T,
    domains: &Domains<T>,
) -> ([T::Single; 3], [T::Single; MOST_NUMBERS]) {
    let mut xi = [T::Single::zero(); 3];
    for d in 0..D {
        xi[d] = number(Columns::position() + d).into();
    }
    let carried = |n: usize| T::Single::from(number(domains.column + n));
    (xi, domains.of::<T::Single, S, D>(carried))
}

/// Append particles that come to a block to their bins there, and scatter them, one by one: for a shape function, whatever pass
/// sent them.
pub(in crate::step) struct Arrivals<'a, T: Float, const D: usize, S> {
    pub(in crate::step) shape: &'a S,
    pub(in crate::step) block: &'a mut Block<T, D>,
    /// The block's tile, and its rows that hold sums.
    pub(in crate::step) sums: (&'a mut [[T; 4]], &'a mut u64),
    /// Where they are, which of them they are, and which block they go to as seen from there.
    pub(in crate::step) from: (&'a Outbox<T>, Sent, usize),
    pub(in crate::step) common: &'a Common<T>,
    /// What the pass maps, and what went with them of it.
    pub(in crate::step) mapped: (Maps, &'a MigrationPayload),
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> Kernel<T> for Arrivals<'_, T, D, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Arrivals { shape, block, sums: (tile, rows), from: (outbox, sent, to), common, mapped } = self;
        let (maps, payload) = mapped;
        let columns = block.particle_numbers();
        for (bin, numbers) in outbox.going(sent, to) {
            block.push(bin, &numbers[..columns]);
            let more = rows_of::<S::Extent, D>(1 << bin) & !*rows;
            clear_rows::<T, D, S::Extent>(tile, more, maps);
            *rows |= more;
            let own = payload.unpack::<T, D>(numbers, common.masses.of(numbers), maps);
            let corner = tile_corner::<S::Extent, D>(bin);
            let (first, second) = tile.split_at_mut(tile_nodes::<S::Extent>(D));
            if maps.moments::<S::Extent>() {
                let mut at = [T::default(); 3];
                at[..D].copy_from_slice(&numbers[Columns::position()..][..D]);
                let mut moments = Moments::<A::Quad, S::Extent>::zero();
                moments.add_one(&at, &own);
                moments.give(if maps.together { &mut *first } else { &mut *second }, corner);
            }
            let (xi, domain) = place_of::<T, D, S>(|row| numbers[row], &common.domains);
            if S::Extent::NODES == 2 && !S::DOMAIN.convects() {
                let along = along_axes(shape, &xi, &domain);
                let weights = on_cell::<T::Single, S::Extent>(&along);
                add_particle::<T, A, S::Extent>([first, second], corner, &weights, &own, maps);
                continue;
            }
            give_one::<T, A, S, D>(shape, (&xi, &domain), ([first, second], corner), &own, maps);
        }
    }
}

/// Add one particle to the nodes of its stencil, of which the first lies at `corner` of the tile.
#[inline(always)]
fn give_one<T: Float, A: Arch<T>, S: ShapeFunction<T, D>, const D: usize>(
    shape: &S,
    (xi, domain): (&[T::Single; 3], &[T::Single; MOST_NUMBERS]),
    ([first, second], corner): ([&mut [[T; 4]]; 2], usize),
    records: &[[T; 4]; RECORDS],
    maps: Maps,
) {
    let (count, layers) = (S::Extent::NODES, S::Extent::LAYERS);
    let kind = |kind: usize| A::Quad::load(&records[kind]);
    let (momentum, direct) = (kind(MOMENTUM), kind(DIRECT));
    let affine = [kind(AFFINE), kind(AFFINE + 1), kind(AFFINE + 2)];
    let force = [kind(FORCE), kind(FORCE + 1), kind(FORCE + 2)];
    let convects = S::DOMAIN.convects();
    let (along, weights) = if convects {
        ([crate::shape::Weights::zero(); 3], table::<T, T::Single, S, D>(xi, domain))
    } else {
        (along_axes(shape, xi, domain), crate::shape::domain::Table::zero())
    };
    let number = |x: T::Single| A::Quad::splat(x.into());
    for k in 0..layers {
        for j in 0..count {
            for i in 0..count {
                let (n, at) =
                    ((k * count + j) * count + i, corner + (k * S::Extent::TILE + j) * S::Extent::TILE + i);
                let (x, y, z) = (&along[0], &along[1], &along[2]);
                let (value, slope) = if convects {
                    (weights.value[n], [weights.slope[0][n], weights.slope[1][n], weights.slope[2][n]])
                } else if D == 2 {
                    let slope = [x.slope[i] * y.value[j], x.value[i] * y.slope[j], T::Single::zero()];
                    (x.value[i] * y.value[j], slope)
                } else {
                    let yz = y.value[j] * z.value[k];
                    let slope = [
                        x.slope[i] * yz,
                        x.value[i] * (y.slope[j] * z.value[k]),
                        x.value[i] * (y.value[j] * z.slope[k]),
                    ];
                    (x.value[i] * yz, slope)
                };
                let value = number(value);
                let mut here = momentum;
                if maps.has_affine() {
                    for (d, a) in [i, j, k].into_iter().enumerate().take(D) {
                        here = times_offset(affine[d], node_offset::<S::Extent>(a), here);
                    }
                }
                let mut push = A::Quad::zero();
                if maps.slopes() {
                    for d in 0..D {
                        push = number(slope[d]).mul_add(force[d], push);
                    }
                    if maps.direct {
                        push = value.mul_add(direct, push);
                    }
                }
                if maps.momentum {
                    let mut sum = value.mul_add(here, A::Quad::load(&first[at]));
                    if maps.together {
                        sum = sum + push;
                    }
                    sum.store(&mut first[at]);
                }
                if maps.second() {
                    (A::Quad::load(&second[at]) + push).store(&mut second[at]);
                }
            }
        }
    }
}
