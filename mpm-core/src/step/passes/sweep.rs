//! Pass over the particles of a block: the fused particle stages of a step.
//!
//! The nodes that the block's particles reach are copied once into a tile. Each bin reads its stencil from there; each
//! group of lanes is gathered, updated and scattered while it is in registers and cache. Sums are added to the block's own
//! output tile, which no other block writes, so that threads do not interfere; the grid adds the tiles in a fixed order
//! (`nodes`).

use impactite_scene::Cause;
use std::marker::PhantomData;

use mpm_materials::material::{Length, Material, Motion, States, StatesMut};
use mpm_materials::{Constitutive, Fault, Kinematics, Lane, State, Sym3};

use super::cell::Moments;
use super::kernels::ShapeKernels;
use super::law_batch::ForLaw;
use super::mean;
use super::migrate::{Cut, Leaving, MigrationPayload, send_away, spread_affine};
use super::rows::RowsMut;
use super::slot::{Common, Scratch, Slot, Task};
use super::spec::{ExtentOf, Spec};
use super::spread::{MAX_LANES, Maps, Records, SpreadOf};
use super::stage::{Bin, Found, Stage, Stages, centre_x, give_moments};
use super::tile::{Reads, Stencilled, TileIn, clear_rows, rows_of, tile_corner, tile_nodes};
use crate::dim::{Stencil, block_nodes, neighbours};
use crate::particles::{Columns, Groups, Members, Sent};
use crate::shape::bin_centre;
use impactite_simd::{Arch, Float, Kernel, Pack, Vectors, through_memory};

/// Number of groups of a bin that pass through the stages together. A law is a long dependency chain; the chains of two
/// groups overlap. With two nodes per axis the gather is so short that passing data between the stages costs more than the
/// overlap gains (book, "What helped, what did not"); the same holds if one vector has two groups.
const fn groups_at_once<E: Stencil>(lanes: usize, groups: usize) -> usize {
    if E::NODES > 2 && groups == 1 && lanes > 1 { GROUPS_AT_ONCE } else { 1 }
}
const GROUPS_AT_ONCE: usize = 2;

/// Prefetch distance: bins between the current one and the one whose particles are prefetched.
const AHEAD: usize = 8;

/// Properties of a pass for its preparation.
struct Setting<'a> {
    /// Number of rows that the pass uses.
    at_work: usize,
    /// Row of the masses, if outside these rows.
    mass_row: Option<usize>,
    reads: Reads,
    maps: Maps,
    payload: &'a MigrationPayload,
}

impl<T: Float, const D: usize> Task<'_, T, D> {
    /// Prepare the buffers of a pass over the block, and reset those of the last one. The code is common to all passes of a
    /// stencil, and so no part of their kernels. Returns true if the block has a particle.
    #[inline(never)]
    fn prepare<E: Stencil>(&mut self, setting: &Setting<'_>, groups_a_vector: usize) -> bool {
        let Slot { block, tile, rows, report, affine, .. } = &mut *self.slot;
        let Scratch { movers, tile_in, idle, batch, .. } = &mut *self.scratch;
        for bin in 0..AHEAD {
            block.prefetch(bin, setting.at_work, setting.mass_row);
        }
        *rows = rows_of::<E, D>(block.occupied());
        clear_rows::<T, D, E>(tile.all_mut(), *rows, setting.maps);
        affine.fill([T::default(); 4]);
        *self.sent = Sent::default();
        movers.within.clear(block.particle_numbers() + setting.payload.count());
        *report = Default::default();
        if block.is_empty() {
            return false;
        }
        idle.clear();
        for &number in self.dummy.iter().filter(|_| groups_a_vector > 1) {
            let mut row = T::Row::default();
            row.as_mut().fill(number);
            idle.push(row);
        }
        tile_in.load::<E, D>(self.nodes, self.around[0], setting.reads, *rows);
        batch.clear();
        if let Some(next) = self.next {
            next.ask_first();
        }
        true
    }
}

/// Access of a pass to the law of its particles.
pub(in crate::step) trait Law<T: Float> {
    /// True if the law is part of the kernel; otherwise it is called for groups of particles together.
    const INLINED: bool;
    /// Number of rows of a state, if known at compile time.
    const ROWS: usize;
    /// Update a pack whose state begins at row `at`, or evaluate its state if there is no `motion`: stress, volume ratio,
    /// wave speed and fault.
    fn step<P: Pack<T>>(
        &self,
        rows: &mut RowsMut<'_, T>,
        at: usize,
        motion: Option<Kinematics<P>>,
        speeds: bool,
        length: P,
    ) -> (Sym3<P>, P, P, Fault<P>);
}

/// Dynamically called law: [`Material`].
pub(in crate::step) struct Called;

impl<T: Float> Law<T> for Called {
    const INLINED: bool = false;
    const ROWS: usize = 0;
    #[inline(always)]
    fn step<P: Pack<T>>(
        &self,
        _: &mut RowsMut<'_, T>,
        _: usize,
        _: Option<Kinematics<P>>,
        _: bool,
        _: P,
    ) -> (Sym3<P>, P, P, Fault<P>) {
        (Sym3::zero(), P::zero(), P::zero(), Fault::none())
    }
}

/// Inlined law: a copy in the kernel, so that laws of plain numbers, which no write to memory can change, can stay in
/// vectors.
pub(in crate::step) struct Inlined<C>(pub(in crate::step) C);

impl<T: Float, C: Constitutive<T>> Law<T> for Inlined<C> {
    const INLINED: bool = true;
    const ROWS: usize = <C::State<T::Single> as State<T::Single>>::LEN;
    #[inline(always)]
    fn step<P: Pack<T>>(
        &self,
        rows: &mut RowsMut<'_, T>,
        at: usize,
        motion: Option<Kinematics<P>>,
        speeds: bool,
        length: P,
    ) -> (Sym3<P>, P, P, Fault<P>) {
        let law = &self.0;
        let old = C::State::<P>::read(&mut rows.reader(at));
        let (now, stress, fault) = match motion {
            Some(motion) => {
                let new = law.update(&motion, &old);
                new.state.write(&mut rows.writer(at));
                (new.state, new.stress, new.fault)
            }
            None => (old, law.stress(&old), Fault::none()),
        };
        let speed = if speeds { law.step_speed(&now, length) } else { P::zero() };
        (stress, law.volume_ratio(&now), speed, fault)
    }
}

/// Pass `P` over one block.
pub(in crate::step) struct Sweep<'a, T: Float, const D: usize, P: Spec<T, D>, L> {
    pub(in crate::step) shape: &'a P::Shape,
    pub(in crate::step) transfer: &'a P::Transfer,
    pub(in crate::step) law: L,
    pub(in crate::step) shapes: &'a dyn ShapeKernels<T, D>,
    pub(in crate::step) task: Task<'a, T, D>,
    pub(in crate::step) pass: PhantomData<P>,
}

/// Minimum number of groups for a call of the law, if the block has as many: few enough for the batch to stay in the
/// first-level cache, enough to make the cost of the call negligible.
const ENOUGH: usize = 4;

impl<T, const D: usize, P, L> Kernel<T> for Sweep<'_, T, D, P, L>
where
    T: Float,
    P: Spec<T, D>,
    L: Law<T>,
{
    const VECTORS: Vectors = P::VECTORS;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Sweep { shape, transfer, law, shapes, task, .. } = self;
        let (maps, does) = (P::MAPS, P::DOES);
        let called = const { P::DOES.has_law() && !L::INLINED };
        let stages = Stages::<T, D, P, A>::new(shape, transfer, task.common);
        let by_coefficients = Stages::<T, D, P, A>::BY_COEFFICIENTS;
        let states = Columns::state(D);
        let least = states + L::ROWS;
        // Rows that the pass uses, and the mass row if outside them.
        let at_work = if does.has_law() || does.moves { task.common.domains.column } else { states };
        let mass_row = task.common.masses.row().filter(|row| *row >= at_work);
        let payload = MigrationPayload::of::<D>(maps, task.common.splitter.is_on());
        let setting =
            Setting { at_work, mass_row, reads: Stages::<T, D, P, A>::READS, maps, payload: &payload };
        let mut task = task;
        if !task.prepare::<ExtentOf<P, T, D>>(&setting, A::Batch::GROUPS) {
            return;
        }
        let Task { material, nodes, around, slot, next: soon, sent, scratch, common, .. } = task;
        let Scratch { number: thread, movers, tile_in, idle, batch } = scratch;
        let Slot { block, tile, rows, report, affine, border, evacuated, .. } = slot;
        let (tile, tile_in, sent_before) = (tile.all_mut(), tile_in.records(), movers.out.posted());
        let mut stencil = Stencilled::<T, ExtentOf<P, T, D>>::zero();
        let (first, second) = tile.split_at_mut(tile_nodes::<ExtentOf<P, T, D>>(D));
        let (mut records, mut spread) = (Records::<T>::zero(), SpreadOf::<T, A, ExtentOf<P, T, D>>::zero());
        let mut found = Found::<A::Batch>::none();
        let (mut stage, mut at) =
            ([Stage::<A::Batch>::zero(); GROUPS_AT_ONCE], [Part::default(); GROUPS_AT_ONCE]);
        let shares = Stages::<T, D, P, A>::SHARES && !common.mean;
        let at_once =
            if called { 1 } else { groups_at_once::<ExtentOf<P, T, D>>(A::Batch::WIDTH, A::Batch::GROUPS) };
        let by_moments = maps.moments::<ExtentOf<P, T, D>>();
        let side = <ExtentOf<P, T, D> as Stencil>::TILE;
        let rows_in = if D == 3 { side * side } else { side };
        let block_x = block.coordinates[0];
        let centre = bin_centre::<ExtentOf<P, T, D>>();
        let summed = tile_nodes::<ExtentOf<P, T, D>>(D) * (1 + usize::from(maps.second()));
        let mut groups = block.groups(least);
        for number in 0..block_nodes(D) {
            if number < rows_in && !around[1].is_empty() {
                TileIn::prefetch::<ExtentOf<P, T, D>, D>(nodes, around[1], number);
            }
            if let Some(soon) = soon {
                soon.ask::<T, D>(number, summed);
            }
            let mut parts = Parts::of(groups.last(number));
            if !parts.is_empty() {
                if number + AHEAD < block_nodes(D) {
                    groups.prefetch(number + AHEAD, at_work, mass_row);
                }
                let corner = tile_corner::<ExtentOf<P, T, D>, D>(number);
                stencil.load::<D, A, P::Shape>(tile_in, corner, by_coefficients);
                let nodes = tile_in.map(|records| &records[corner..][..<ExtentOf<P, T, D> as Stencil>::SPAN]);
                let x = A::Batch::splat(centre_x(common, block_x, number, centre));
                let mut moments = Moments::<A::Quad, ExtentOf<P, T, D>>::zero();
                if called {
                    let kept = if shares { 0 } else { numbers_kept::<T, D, P>() };
                    let mut writer = batch.open(groups.of_bin(number), kept);
                    let stencil = if A::Batch::GROUPS > 1 { through_memory(&stencil) } else { &stencil };
                    let bin = Bin { stencil, nodes, x };
                    while !parts.is_empty() {
                        let part = parts.take::<T, A::Batch>(&groups);
                        let entry = writer.enter::<A::Batch>(part.members, part.here);
                        let rows = &mut groups.rows_of::<A::Batch>(part.members, idle);
                        let stage = &mut stage[0];
                        stages.gather((rows, part.here), &bin, stage);
                        if does.strain.is_some() {
                            let (mut gradient, step) = stages.strain(rows, &bin, stage);
                            if shares {
                                gradient.0 = stage.affine;
                            } else {
                                writer.keep(&entry, kept, |i| stage.affine[i / D][i % D]);
                            }
                            writer.put_gradient(&entry, &gradient, step);
                            stages.stretch(rows, &bin, stage);
                        } else if maps.affine {
                            writer.keep(&entry, kept, |i| stage.affine[i / D][i % D]);
                        }
                        stages.drift(rows, stage);
                    }
                    let counted = writer.counted();
                    batch.close(number, counted);
                }
                while !parts.is_empty() {
                    // Load the stencil from memory: the compiler would broadcast all its numbers to vectors once per bin,
                    // which has only one or two batches.
                    let stencil = if A::Batch::GROUPS > 1 { through_memory(&stencil) } else { &stencil };
                    let bin = Bin { stencil, nodes, x };
                    let mut taken = 0;
                    while taken < at_once && !parts.is_empty() {
                        let part = parts.take::<T, A::Batch>(&groups);
                        at[taken] = part;
                        let rows = &mut groups.rows_of::<A::Batch>(part.members, idle);
                        let stage = &mut stage[taken];
                        stages.gather((rows, part.here), &bin, stage);
                        taken += 1;
                    }
                    for n in 0..taken {
                        let (part, stage) = (at[n], &mut stage[n]);
                        let rows = &mut groups.rows_of::<A::Batch>(part.members, idle);
                        if does.has_law() {
                            let mut motion = None;
                            let [dt, length] = stages.step();
                            if does.strain.is_some() {
                                let (gradient, step) = stages.strain(rows, &bin, stage);
                                motion = Some(Kinematics { increment: gradient * step, dt, length });
                            }
                            let (stress, ratio, speed, fault) =
                                law.step::<A::Batch>(rows, states, motion, common.speeds, length);
                            if fault.any() {
                                found.broken = found.broken.or(first_fault(part.here, fault));
                            }
                            stages.respond(rows, stage, (stress, ratio, speed), &mut found);
                            report.note(&mut found.broken, number, part.members, &groups);
                        }
                    }
                    for n in 0..taken {
                        let (part, stage) = (at[n], &mut stage[n]);
                        let rows = &mut groups.rows_of::<A::Batch>(part.members, idle);
                        stages.stretch(rows, &bin, stage);
                        stages.drift(rows, stage);
                        let room = (&mut records, &mut spread);
                        let gone = stages.advance((rows, part.here), x, stage, &mut found, room);
                        report.note(&mut found.broken, number, part.members, &groups);
                        let mut long = 0;
                        if const { P::DOES.moves && !P::TOTAL } && common.splitter.is_on() {
                            long = too_long::<T, D>(&groups, material, common, part, x.lane(0));
                        }
                        let gone = gone
                            | if const { P::MAPS.affine } && *evacuated { all_lanes(part.here) } else { 0 };
                        if gone | long != 0 {
                            let mut gradient = [[T::default(); MAX_LANES]; 9];
                            if long != 0 {
                                stages.spread_of(stage, &mut gradient);
                            }
                            Stages::<T, D, P, A>::part(stage, long, &mut records);
                            let cut = Cut { long, splitter: &common.splitter, gradient: &gradient };
                            let leaving = Leaving { bin: number, members: part.members, gone, cut };
                            send_away::<T, D>(block, movers, report, leaving, (&mut records, maps, &payload));
                            groups = block.groups(least);
                        }
                        if const { P::MAPS.affine } && *border >> number & 1 != 0 {
                            let lanes = lanes_of_xi::<T, A::Batch, D>(&stage.xi, part.here);
                            spread_affine::<T, P::Shape, D>(
                                shape,
                                &lanes[..part.here],
                                corner,
                                &records,
                                affine,
                            );
                        }
                        let (tiles, room) = ([&mut *first, &mut *second], (&mut records, &mut spread));
                        Stages::<T, D, P, A>::give(part.here, corner, stage, room, &mut moments, tiles);
                    }
                }
                if by_moments && !called {
                    let tile = if maps.together { &mut *first } else { &mut *second };
                    give_moments::<T, A, ExtentOf<P, T, D>>(&moments, tile, corner);
                }
            }
            if !called || batch.groups() == 0 || (batch.groups() < ENOUGH && number + 1 < block_nodes(D)) {
                continue;
            }

            // Call the law for all groups gathered so far, and complete their stages.
            let (all, stride) = groups.all_rows();
            if does.strain.is_some() {
                if common.mean {
                    mean::dilate::<T, D>(batch, material, (&*all, stride, states), common, P::HOOP);
                }
                let ForLaw { groups: list, deformation, response } = batch.for_law();
                let motion = Motion { deformation, dt: common.dt, length: Length::Same(common.spacing) };
                let moved = StatesMut { all, stride, first: states, groups: list };
                material.advance(&motion, moved, common.speeds, response);
                if let Some((bin, entry, lane, cause)) = batch.first_fault::<A::Batch>() {
                    found.broken = Some((lane, Cause::Law(cause)));
                    report.note(&mut found.broken, bin, entry.members, &groups);
                }
            } else {
                let ForLaw { groups: list, response, .. } = batch.for_law();
                let said = States { all: &*all, stride, first: states, groups: list };
                material.describe(said, common.spacing, response);
            }
            let reader = batch.reader();
            for bin in reader.bins {
                let number = bin.number as usize;
                let corner = tile_corner::<ExtentOf<P, T, D>, D>(number);
                let x = A::Batch::splat(centre_x(common, block_x, number, centre));
                let mut moments = Moments::<A::Quad, ExtentOf<P, T, D>>::zero();
                for entry in reader.entries(bin) {
                    let (stage, here) = (&mut stage[0], entry.here as usize);
                    let rows = &mut groups.rows_of::<A::Batch>(entry.members, idle);
                    stages.load((rows, here), stage);
                    if shares {
                        reader.gradient::<D, A::Batch>(entry, &mut stage.affine);
                    } else {
                        reader.kept(entry, numbers_kept::<T, D, P>(), |i, number| {
                            stage.affine[i / D][i % D] = number
                        });
                    }
                    stages.respond(rows, stage, reader.outputs::<A::Batch>(entry, common.speeds), &mut found);
                    let room = (&mut records, &mut spread);
                    let gone = stages.advance((rows, here), x, stage, &mut found, room);
                    report.note(&mut found.broken, number, entry.members, &groups);
                    let mut long = 0;
                    if const { P::DOES.moves && !P::TOTAL } && common.splitter.is_on() {
                        let part = Part { members: entry.members, here };
                        long = too_long::<T, D>(&groups, material, common, part, x.lane(0));
                    }
                    let gone =
                        gone | if const { P::MAPS.affine } && *evacuated { all_lanes(here) } else { 0 };
                    if gone | long != 0 {
                        let mut gradient = [[T::default(); MAX_LANES]; 9];
                        if long != 0 {
                            let unit = T::of(1.0) / common.spacing;
                            reader.gradients::<D, A::Batch>(entry, unit, &mut gradient);
                        }
                        Stages::<T, D, P, A>::part(stage, long, &mut records);
                        let cut = Cut { long, splitter: &common.splitter, gradient: &gradient };
                        let leaving = Leaving { bin: number, members: entry.members, gone, cut };
                        send_away::<T, D>(block, movers, report, leaving, (&mut records, maps, &payload));
                        groups = block.groups(least);
                    }
                    if const { P::MAPS.affine } && *border >> number & 1 != 0 {
                        let lanes = lanes_of_xi::<T, A::Batch, D>(&stage.xi, here);
                        spread_affine::<T, P::Shape, D>(shape, &lanes[..here], corner, &records, affine);
                    }
                    let (tiles, room) = ([&mut *first, &mut *second], (&mut records, &mut spread));
                    Stages::<T, D, P, A>::give(here, corner, stage, room, &mut moments, tiles);
                }
                if by_moments {
                    let tile = if maps.together { &mut *first } else { &mut *second };
                    give_moments::<T, A, ExtentOf<P, T, D>>(&moments, tile, corner);
                }
            }
            batch.clear();
        }
        if does.moves && !P::TOTAL {
            let here = neighbours(D) / 2;
            let stayed = movers.within.since(0, 0);
            if const { P::MAPS.affine } && *evacuated {
                movers.out.append(&movers.within);
            } else if stayed.goes(here) {
                shapes.take_in(
                    block,
                    (&mut tile[..], rows, affine),
                    (&movers.within, stayed, here),
                    common,
                    (maps, &payload),
                );
            }
            *sent = movers.out.since(sent_before, *thread);
        }
        for i in 0..A::Batch::WIDTH {
            report.rate = report.rate.max(found.rate.lane(i));
            (0..4).for_each(|k| report.moments[k] += found.moments[k].lane(i));
        }
        report.rate /= common.spacing;
    }
}

/// Return the bits of the first `here` lanes.
const fn all_lanes(here: usize) -> u32 {
    ((1u64 << here) - 1) as u32
}

/// Return the offsets of the particles of a group from the centre of their bin, cells.
#[cold]
#[inline(never)]
fn lanes_of_xi<T: Float, P: Pack<T>, const D: usize>(xi: &[P; 3], here: usize) -> [[T; 3]; MAX_LANES] {
    let mut lanes = [[T::default(); 3]; MAX_LANES];
    for (lane, at) in lanes.iter_mut().enumerate().take(here) {
        (0..D).for_each(|d| at[d] = xi[d].lane(lane));
    }
    lanes
}

/// Number of values of a particle passed on in addition to its increment: the affine part of its velocity.
const fn numbers_kept<T: Float, const D: usize, P: Spec<T, D>>() -> usize {
    if P::MAPS.affine { D * D } else { 0 }
}

/// Particles of a bin that pass through the stages together.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::step) struct Part {
    /// Groups of the particles.
    members: Members,
    /// Number of particles.
    here: usize,
}

/// Remaining parts of a bin: groups in reverse order, and lanes in reverse order if processed one by one.
#[derive(Clone, Copy)]
struct Parts {
    next: Option<(u32, usize)>,
}

impl Parts {
    #[inline(always)]
    fn of(last: Option<(u32, usize)>) -> Self {
        Parts { next: last }
    }
    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.next.is_none()
    }
    /// Remove and return the next part.
    #[inline(always)]
    fn take<T: Float, P: Pack<T>>(&mut self, groups: &Groups<'_, T>) -> Part {
        let Some((group, here)) = self.next else { return Part::default() };
        if P::WIDTH == 1 {
            let lane = here as u32 - 1;
            self.next = if lane > 0 { Some((group, here - 1)) } else { groups.before(group) };
            return Part { members: Members { groups: [group; 2], lane }, here: 1 };
        }
        self.next = groups.before(group);
        if P::GROUPS > 1
            && let Some((before, full)) = self.next
        {
            self.next = groups.before(before);
            return Part { members: Members { groups: [before, group], lane: 0 }, here: full + here };
        }
        Part { members: Members { groups: [group; 2], lane: 0 }, here }
    }
}

/// Return the lanes of a part whose particles must be split.
#[cold]
#[inline(never)]
fn too_long<T: Float, const D: usize>(
    groups: &Groups<'_, T>,
    material: &dyn Material<T>,
    common: &Common<T>,
    part: Part,
    bin_x: T,
) -> u32 {
    let mut long = 0;
    for lane in 0..part.here {
        let (group, at) = part.members.place::<T>(lane);
        let number = |row: usize| groups.row(group, row).as_ref()[at];
        if common.splitter.is_long::<D>(number, material, bin_x / common.spacing) {
            long |= 1 << lane;
        }
    }
    long
}

/// Return the first of the particles whose law failed.
#[cold]
fn first_fault<T: Float, L: Lane<Real = T>>(here: usize, fault: Fault<L>) -> Option<(usize, Cause)> {
    (0..here).find_map(|lane| Some((lane, Cause::Law(fault.cause(lane)?))))
}
