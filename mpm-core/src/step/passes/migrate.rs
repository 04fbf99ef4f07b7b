//! Migration of particles between bins: removal during the pass over a bin, insertion after all bins of a block (if they
//! stay in the block) or between passes.

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

/// Particles that leave the groups of a bin that pass through the stages together, as bits of lanes.
pub(in crate::step) struct Leaving<'a, T: Float> {
    pub(in crate::step) bin: usize,
    /// Groups, in the order of the bin.
    pub(in crate::step) members: Members,
    /// Particles that left the bin, one bit each.
    pub(in crate::step) gone: u32,
    pub(in crate::step) cut: Cut<'a, T>,
}

/// Particles to be split, inside or outside their bin.
pub(in crate::step) struct Cut<'a, T: Float> {
    pub(in crate::step) long: u32,
    pub(in crate::step) splitter: &'a Splitter<T>,
    /// Velocity gradient, 1/s, D x D numbers per lane.
    pub(in crate::step) gradient: &'a [[T; MAX_LANES]; 9],
}

/// Components of a particle's records that migrate with it: without zeros, without G_dc (equal to G_cd), and without mass
/// and momentum if they follow from the particle itself.
pub(crate) struct MigrationPayload {
    /// Kind of record, and index of the component.
    numbers: [(u8, u8); MOST_LUGGAGE],
    count: usize,
}
/// Largest number of components: momentum, hoop force and load, affine part, force.
const MOST_LUGGAGE: usize = 3 + 3 + 9 + 6;

impl MigrationPayload {
    /// Select the components for a pass that maps `maps`; with `splits`, particles may be split.
    #[inline(always)]
    pub(in crate::step) fn of<const D: usize>(maps: Maps, splits: bool) -> Self {
        // The halves of a split particle map half of the parent's records, not their own momentum.
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

    /// Number of components.
    #[inline(always)]
    pub(in crate::step) fn count(&self) -> usize {
        self.count
    }

    /// Refer the components of a particle to another bin, at `turn` from the old one, and to cells of which `scale` make an old
    /// one; `turn` is in old cells.
    pub(in crate::step) fn change_cells<T: Float, const D: usize>(
        &self,
        packed: &mut [T],
        turn: &[T; D],
        scale: T,
    ) {
        let mut records = [[T::default(); 4]; RECORDS];
        for (&x, &(kind, c)) in packed.iter().zip(&self.numbers[..self.count]) {
            records[kind as usize][c as usize] = x;
        }
        for d in 0..D {
            for c in 0..4 {
                let more = records[AFFINE + d][c] * turn[d];
                records[MOMENTUM][c] += more;
                records[AFFINE + d][c] *= T::of(1.0) / scale;
                records[FORCE + d][c] *= scale;
            }
        }
        self.pack(&records, packed);
    }

    /// Return the affine part of the momentum among the components, `[d][c]`, kg m/s a cell.
    pub(in crate::step) fn affine_of<T: Float>(&self, packed: &[T]) -> [[T; 3]; 3] {
        let mut affine = [[T::default(); 3]; 3];
        for (&x, &(kind, c)) in packed.iter().zip(&self.numbers[..self.count]) {
            if (AFFINE..FORCE).contains(&(kind as usize)) {
                affine[kind as usize - AFFINE][c as usize - 1] = x;
            }
        }
        affine
    }

    /// Copy the components from the records.
    #[inline(always)]
    fn pack<T: Copy>(&self, records: &[[T; 4]; RECORDS], to: &mut [T]) {
        for (x, &(kind, c)) in to.iter_mut().zip(&self.numbers[..self.count]) {
            *x = records[kind as usize][c as usize];
        }
    }

    /// Restore the records of a particle from its numbers, the last of which are the migrated components.
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

/// Move leaving particles from their bin to the outbox, or to `within` if they stay in the block, together with their
/// records, which are set to zero. A split particle is moved as its two children.
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
    // Last lane first: the particle that replaces a removed one has been processed already.
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
        // Each child maps half of its parent's records, from its own position.
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

/// Return the offset of the bin of xi from the old bin, cells.
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

/// Destination of a particle that left its bin.
struct Address<T> {
    /// Index of the destination block, as in an outbox.
    to: usize,
    bin: usize,
    /// Offset from the old bin, cells.
    cells: [T; 3],
    /// True if the offset exceeds one cell or is not a number.
    far: bool,
}

impl<T: Float> Address<T> {
    /// Compute the destination of a particle at `xi` of `bin`.
    #[inline(always)]
    fn of<const D: usize>(xi: &[T; 3], bin: usize) -> Self {
        let mut address = Address { to: 0, bin: 0, cells: [T::default(); 3], far: false };
        let (mut weight, mut bin_weight, mut rest) = (1, 1, bin);
        for d in 0..D {
            let cells = cells_off(xi[d]);
            address.cells[d] = cells;
            let within_one = cells.abs() <= T::of(1.0); // false for a value that is not a number
            address.far |= !within_one;
            // At most two cells: one by motion, less than one from the parent to the child.
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

    /// Refer records to the centre of the destination bin: R = [m, m v] - sum A xi.
    #[inline(always)]
    fn turn<const D: usize>(&self, records: &mut [[T; 4]; RECORDS], maps: Maps) {
        for d in 0..if maps.has_affine() { D } else { 0 } {
            for c in 0..4 {
                let more = records[AFFINE + d][c] * self.cells[d];
                records[MOMENTUM][c] += more;
            }
        }
    }

    /// Reserve space for the numbers of the particle and its payload.
    #[inline(always)]
    fn room<'a, const D: usize>(&self, out: &'a mut Outbox<T>, within: &'a mut Outbox<T>) -> &'a mut [T] {
        let list = if self.to == neighbours(D) / 2 { within } else { out };
        list.post(self.to, self.bin)
    }

    /// Refer the position to the centre of the destination bin. Rounding may turn a value just below -1/2 into 1/2, the far
    /// edge of the bin.
    #[inline(always)]
    fn shift<const D: usize>(&self, numbers: &mut [T]) {
        for d in 0..D {
            numbers[Columns::position() + d] -= self.cells[d];
        }
    }
}

/// Return the offset and the domain of a particle; `number` reads its value in a row.
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

/// Append particles that arrive in a block to their bins, and scatter them one by one; independent of the pass that sent
/// them.
pub(in crate::step) struct Arrivals<'a, T: Float, const D: usize, S> {
    pub(in crate::step) shape: &'a S,
    pub(in crate::step) block: &'a mut Block<T, D>,
    /// Tile of the block, its rows that contain sums, and the affine part of the momentum at the border of a level.
    pub(in crate::step) sums: Sums<'a, T>,
    /// Outbox, selection of its particles, and index of the destination block seen from the sender.
    pub(in crate::step) from: (&'a Outbox<T>, Sent, usize),
    pub(in crate::step) common: &'a Common<T>,
    /// Quantities that the pass maps, and the components that migrated.
    pub(in crate::step) mapped: (Maps, &'a MigrationPayload),
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> Kernel<T> for Arrivals<'_, T, D, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Arrivals { shape, block, sums, from: (outbox, sent, to), common, mapped } = self;
        let (tile, rows, border) = sums;
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
            if maps.affine && !border.is_empty() {
                let mut records = Records::zero();
                (0..RECORDS).for_each(|kind| records[kind][0] = own[kind]);
                let mut at = [[T::default(); 3]];
                at[0][..D].copy_from_slice(&numbers[Columns::position()..][..D]);
                spread_affine::<T, S, D>(shape, &at, corner, &records, border);
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

/// Tile of a block, its rows that contain sums, and the affine part of the momentum at the border of a level.
pub(in crate::step) type Sums<'a, T> = (&'a mut [[T; 4]], &'a mut u64, &'a mut [[T; 4]]);

/// Add the affine part of the momentum of particles at these offsets from the centre of their bin, at most [`MAX_LANES`], to the nodes of
/// their stencil, whose first node is at `corner` of the tile.
#[cold]
#[inline(never)]
pub(in crate::step) fn spread_affine<T: Float, S: ShapeFunction<T, D>, const D: usize>(
    shape: &S,
    xi: &[[T; 3]],
    corner: usize,
    records: &Records<T>,
    affine: &mut [[T; 4]],
) {
    T::dispatch(SpreadAffine { shape, xi, corner, records, affine });
}

/// Kernel of [`spread_affine`].
struct SpreadAffine<'a, T: Float, S, const D: usize> {
    shape: &'a S,
    xi: &'a [[T; 3]],
    corner: usize,
    records: &'a Records<T>,
    affine: &'a mut [[T; 4]],
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> Kernel<T> for SpreadAffine<'_, T, S, D> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let SpreadAffine { shape, xi, corner, records, affine } = self;
        let domain = [T::Single::of(0.5); MOST_NUMBERS];
        let mut along = [[crate::shape::Weights::<T::Single, S::Extent>::zero(); 3]; MAX_LANES];
        for (along, xi) in along.iter_mut().zip(xi) {
            *along = along_axes(shape, &xi.map(T::Single::from), &domain);
        }
        let (along, count) = (&along[..xi.len().min(MAX_LANES)], S::Extent::NODES);
        for n in 0..count * count * S::Extent::LAYERS {
            let (i, j, k) = (n % count, n / count % count, n / (count * count));
            let node = corner + (k * S::Extent::TILE + j) * S::Extent::TILE + i;
            let to = &mut affine[D * node..][..D];
            let mut sums = [A::Quad::zero(); 3];
            (0..D).for_each(|d| sums[d] = A::Quad::load(&to[d]));
            for (lane, [x, y, z]) in along.iter().enumerate() {
                let xy = x.value[i] * y.value[j];
                let weight = A::Quad::splat((if D == 3 { xy * z.value[k] } else { xy }).into());
                for d in 0..D {
                    sums[d] = sums[d] + weight * A::Quad::load(&records[AFFINE + d][lane]);
                }
            }
            (0..D).for_each(|d| sums[d].store(&mut to[d]));
        }
    }
}

/// Scatter one particle to the nodes of its stencil, whose first node is at `corner` of the tile.
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
