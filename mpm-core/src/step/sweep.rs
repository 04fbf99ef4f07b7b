//! One pass over the particles of a block: the particle stages of a step, fused.
//!
//! The nodes that the block's particles reach are copied once into a tile; each bin reads its stencil from
//! there, each group of lanes is gathered, updated and scattered while it is in registers and cache, and the
//! sums go to the block's own output tile. No other block writes it, so that threads never meet; the grid
//! adds the tiles up in a fixed order ([`super::nodes`]).

use std::marker::PhantomData;

use mpm_materials::{Constitutive, Lane};

use super::cell::Moments;
use super::layout::Nodes;
use super::mean::Strained;
use super::migrate::{Cut, Domains, Leaving, Luggage, Movers, send_away, take_in};
use super::rows::RowsMut;
use super::scatter::{Maps, NumbersOf, Records, SpreadOf};
use super::splitting::Splitter;
use super::stage::{Bin, Found, Stage, Stages, centre_x};
use super::tile::{Stencilled, TileIn, clear_rows, rows_of, tile_corner, tile_nodes};
use crate::dilatation::Dilatation;
use crate::dim::{Stencil, block_nodes, neighbours};
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::method::Composition;
use crate::parallel::{AlignedRecords, Arch, Float, Kernel, LINE, Pack, Whereabouts, through_memory};
use crate::particles::{Block, Groups, Masses, Members, Outbox, Sent};
use crate::scheme::PassKind;
use crate::shape::{ShapeFunction, bin_centre};
use crate::transfer::Transfer;

/// A block of particles with what its passes need and leave behind.
///
/// What sums over tiles need comes first, in one cache line.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Slot<T: Float, const D: usize> {
    /// What its particles add to the nodes they reach, `TILE` nodes an axis, x fastest: all first records, then, where
    /// the method maps two, all second ones.
    pub tile: AlignedRecords<T>,
    /// Rows of the tile that hold sums, a bit each; nothing is known of the others.
    pub rows: u64,
    /// The particles.
    pub block: Block<T, D>,
    /// Slots around, likewise.
    pub slots_around: Vec<u32>,
    /// Bins whose stencils the body's nodes hold, a bit each.
    pub linked: u64,
    /// What the last pass found.
    pub report: Report<T>,
}

/// Groups of a bin that go through the stages of a pass together. A law is a long chain of operations that wait for each
/// other; those of two groups, one behind the other, run side by side. With two nodes an axis the gather is so
/// short that what the stages hand on costs more than that gains (docs/notes.md 6.2); so it does where one vector holds
/// two groups.
const fn together<E: Stencil>(groups: usize) -> usize {
    if E::NODES > 2 && groups == 1 { TOGETHER } else { 1 }
}
const TOGETHER: usize = 2;

/// Memory of a thread for a pass over a block.
#[derive(Debug, Default)]
pub struct Scratch<T: Float> {
    /// Which one it is among those of all threads.
    number: u32,
    movers: Movers<T>,
    tile_in: TileIn<T>,
    /// What goes through a pass beside a group that has no other.
    idle: Vec<T::Row>,
}

impl<T: Float> Scratch<T> {
    /// The `number`-th one, empty.
    pub(super) fn new(number: usize) -> Self {
        Scratch { number: number as u32, ..Scratch::default() }
    }
    /// Particles that left their blocks.
    pub(super) fn out(&mut self) -> &mut Outbox<T> {
        &mut self.movers.out
    }
    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.movers.bytes() + self.tile_in.bytes() + self.idle.capacity() * size_of::<T::Row>()
    }
}

/// Where the memory of a slot lies: to be asked for while another slot is at work.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outline {
    slot: Whereabouts,
    /// Tables of its block.
    tables: [Whereabouts; 2],
    /// The groups of its block.
    groups: Whereabouts,
    tile: Whereabouts,
}

impl Outline {
    /// Of a slot.
    pub(super) fn of<T: Float, const D: usize>(slot: &Slot<T, D>) -> Self {
        let [runs, before, groups] = slot.block.outline();
        let (tables, tile) = ([runs, before], Whereabouts::of(slot.tile.all()));
        Outline { slot: Whereabouts::of(std::slice::from_ref(slot)), tables, groups, tile }
    }

    /// Ask for the slot and its tables.
    #[inline(always)]
    fn ask_first(&self) {
        for memory in [self.slot, self.tables[0], self.tables[1]] {
            memory.prefetch_early();
        }
    }

    /// Ask for what falls to one of the bins of the block at work: some of the first `records` of the tile; towards the end,
    /// the groups that lie first, which are those of the first bins if few moved.
    #[inline(always)]
    fn ask<T: Float, const D: usize>(&self, bin: usize, records: usize) {
        let lines = (records * size_of::<[T; 4]>()).div_ceil(LINE * block_nodes(D));
        self.tile.prefetch_lines_early(bin * lines, lines);
        let late = block_nodes(D) * 3 / 4;
        if bin >= late {
            self.groups.prefetch_lines_early((bin - late) * FIRST_LINES, FIRST_LINES);
        }
    }
}

/// Bins between the one at work and the one whose particles are asked for.
const AHEAD: usize = 8;
/// Cache lines of the groups that lie first that are asked for beside each of the last bins of the block before: in space two
/// groups of full bins are about fifteen, so that all of them are those of some eight bins.
const FIRST_LINES: usize = 8;

/// What a pass found out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report<T> {
    /// Largest (c + |v|) / h, 1/s.
    pub rate: T,
    /// Sum of loaded area times velocity in the middle of the step, m^3/s.
    pub flux: [T; 3],
    /// Force of a force field, N.
    pub push: [T; 3],
    /// Power of a force field with the velocities in the middle of the step, W.
    pub power: T,
    /// Particles that were split.
    pub splits: u32,
    /// Kinetic energy of the motion within them, J.
    pub revealed: T,
    /// The first particle that cannot go on.
    pub trouble: Option<Trouble>,
}

impl<T: Float> Report<T> {
    /// Note a particle that cannot go on, of groups of a bin.
    #[inline(always)]
    fn note(
        &mut self,
        broken: &mut Option<(usize, Cause)>,
        bin: usize,
        members: Members,
        groups: &Groups<'_, T>,
    ) {
        if let Some((lane, cause)) = *broken {
            let trouble = Trouble { bin, particle: groups.number(members, lane), cause };
            self.trouble = self.trouble.or(Some(trouble));
            *broken = None;
        }
    }
}

/// What the pass `K` of the method `M` maps.
#[inline(always)]
pub(super) fn maps<T: Float, const D: usize, M: Composition<T, D>, K: PassKind>() -> Maps {
    let does = K::DOES;
    Maps {
        momentum: does.momentum,
        affine: does.velocity && does.momentum && M::Transfer::AFFINE,
        force: does.force,
        direct: does.force && (M::Embedding::HOOP || does.load || does.field),
        together: does.force && does.momentum && M::MAPS_TOGETHER,
        least_squares: does.force && M::Transfer::LEAST_SQUARES,
        convected: ShapeOf::<M, T, D>::DOMAIN.convects(),
    }
}

/// A particle that cannot go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trouble {
    /// Its bin in the block.
    pub bin: usize,
    /// Its number.
    pub particle: usize,
    /// What happened.
    pub cause: Cause,
}

/// What happens to particles.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Cause {
    /// Its law broke down.
    #[error("{0}")]
    Law(mpm_materials::Breakdown),
    /// It would move further than one cell in a step, or its velocity is not a number.
    #[error("it would move more than one cell in the step, or its velocity is not a finite number")]
    TooFast,
    /// Its domain has a corner of no angle, or of more than a straight one.
    #[error("its domain is turned inside out")]
    InsideOut,
}

/// The numbers every block of a body shares in a pass.
#[derive(Clone, Copy, Debug)]
pub struct Common<T> {
    /// Time step, s.
    pub dt: T,
    /// The step after it, s, which impulses mapped together with momentum are for.
    pub next_dt: T,
    /// Node spacing h, m.
    pub spacing: T,
    /// x of node zero, m (the axis of revolution is x = 0).
    pub origin: T,
    /// Traction on the loaded areas, Pa.
    pub traction: [T; 3],
    /// Are wave speeds wanted, for the next time step?
    pub speeds: bool,
    /// Domain half sizes of the particles, in units of h.
    pub domains: Domains<T>,
    /// What particles weigh.
    pub masses: Masses<T>,
    /// First row of displacement and deformation, where particles are mapped in their reference configuration.
    pub frame: usize,
    /// When particles are split.
    pub splitter: Splitter<T>,
}

/// The pass `K` over one block.
pub struct Sweep<'a, T: Float, const D: usize, C, M, K> {
    /// The body's law.
    pub law: &'a C,
    /// The method.
    pub method: &'a M,
    /// All nodes of the grid.
    pub nodes: Nodes<'a, T>,
    /// Blocks of nodes around the block, 3^D, x fastest (`u32::MAX` where there is none), and those around the
    /// block that comes next, if one does.
    pub around: [&'a [u32]; 2],
    /// The block.
    pub slot: &'a mut Slot<T, D>,
    /// The one that comes next.
    pub next: Option<&'a Outline>,
    /// Which of the thread's particles on their way left it.
    pub sent: &'a mut Sent,
    /// What lanes without a particle hold, as its block has it, from a place that all blocks share.
    pub dummy: &'a [T],
    /// Memory of the thread.
    pub scratch: &'a mut Scratch<T>,
    /// Shared numbers.
    pub common: Common<T>,
    /// The pass.
    pub pass: PhantomData<K>,
}

pub(super) type ShapeOf<M, T, const D: usize> = <M as Composition<T, D>>::Shape;
pub(super) type ExtentOf<M, T, const D: usize> = <ShapeOf<M, T, D> as ShapeFunction<T, D>>::Extent;

impl<T, const D: usize, C, M, K> Kernel<T> for Sweep<'_, T, D, C, M, K>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    K: PassKind,
{
    const BATCHES: bool = true;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Sweep { law, method, nodes, around, slot, next: soon, sent, dummy, scratch, common, .. } = self;
        // A copy of a law of plain numbers, which no write to memory can change, can stay in vectors.
        let own;
        let law = if std::mem::needs_drop::<C>() {
            law
        } else {
            own = law.clone();
            &own
        };
        let Scratch { number: thread, movers, tile_in, idle } = scratch;
        let Slot { block, tile, rows, report, .. } = slot;
        let (tile, maps) = (tile.all_mut(), maps::<T, D, M, K>());
        let stages = Stages::<T, D, C, M, K, A>::new(law, method, &common);
        let (at_work, least) = (Stages::<T, D, C, M, K, A>::AT_WORK, Stages::<T, D, C, M, K, A>::ROWS);
        let reads = Stages::<T, D, C, M, K, A>::READS;
        let by_coefficients = Stages::<T, D, C, M, K, A>::BY_COEFFICIENTS;
        // What lies apart of what is at work.
        let mass_row = common.masses.row().filter(|row| *row >= at_work);
        let mut groups = block.groups(least);
        for bin in 0..AHEAD {
            groups.prefetch(bin, at_work, mass_row);
        }
        *rows = rows_of::<ExtentOf<M, T, D>, D>(block.occupied());
        clear_rows::<T, D, ExtentOf<M, T, D>>(tile, *rows, maps);
        *sent = Sent::default();
        let sent_before = movers.out.posted();
        movers.within.clear(block.particle_numbers() + Luggage::of::<T, D, M, K>().count());
        *report = Report::default();
        if block.is_empty() {
            return;
        }
        if A::Batch::GROUPS > 1 {
            idle.clear();
            for &number in dummy {
                let mut row = T::Row::default();
                row.as_mut().fill(number);
                idle.push(row);
            }
        }
        tile_in.load::<ExtentOf<M, T, D>, D>(nodes, around[0], reads, *rows);
        let tile_in = tile_in.records();
        let mut stencil = Stencilled::<T, ExtentOf<M, T, D>>::zero();
        let (first, second) = tile.split_at_mut(tile_nodes::<ExtentOf<M, T, D>>(D));
        let (mut records, mut spread) = (Records::<T>::zero(), SpreadOf::<T, A, ExtentOf<M, T, D>>::zero());
        let mut found = Found::<A::Batch>::none();
        let (mut stage, mut at) = ([Stage::<A::Batch>::zero(); TOGETHER], [(Members::One(0), 0); TOGETHER]);
        let together = together::<ExtentOf<M, T, D>>(A::Batch::GROUPS);
        let by_moments = maps.moments::<ExtentOf<M, T, D>>();
        let side = <ExtentOf<M, T, D> as Stencil>::TILE;
        let rows_in = if D == 3 { side * side } else { side };
        let block_x = block.coordinates[0];
        let summed = tile_nodes::<ExtentOf<M, T, D>>(D) * (1 + usize::from(maps.second()));
        if let Some(soon) = soon {
            soon.ask_first();
        }
        groups = block.groups(least);
        for number in 0..block_nodes(D) {
            if number < rows_in && !around[1].is_empty() {
                TileIn::prefetch::<ExtentOf<M, T, D>, D>(nodes, around[1], number);
            }
            if let Some(soon) = soon {
                soon.ask::<T, D>(number, summed);
            }
            let mut next = groups.last(number);
            if next.is_none() {
                continue;
            }
            if number + AHEAD < block_nodes(D) {
                groups.prefetch(number + AHEAD, at_work, mass_row);
            }
            let corner = tile_corner::<ExtentOf<M, T, D>, D>(number);
            stencil.load::<D, A, ShapeOf<M, T, D>>(tile_in, corner, by_coefficients);
            let nodes = tile_in.map(|records| &records[corner..][..<ExtentOf<M, T, D> as Stencil>::SPAN]);
            let x = centre_x(&common, block_x, number, bin_centre::<ExtentOf<M, T, D>>());
            let mean = match K::DOES.strain {
                Some(nodal) if M::Dilatation::MEAN => {
                    let stencil = &stencil;
                    let bin = Strained {
                        law,
                        method,
                        block,
                        bin: number,
                        stencil,
                        nodal,
                        common: &common,
                        bin_x: x,
                    };
                    let mean = bin.mean::<A>();
                    groups = block.groups(least);
                    Some(mean)
                }
                _ => None,
            };
            let x = A::Batch::splat(x);
            let mut moments = Moments::<A::Quad, ExtentOf<M, T, D>>::zero();
            while next.is_some() {
                // Numbers of the stencil from memory: the compiler would make vectors of all of them once a bin, where a
                // bin's particles are one batch or two.
                let stencil = if A::Batch::GROUPS > 1 { through_memory(&stencil) } else { &stencil };
                let bin = Bin { stencil, nodes, x, mean };
                let (mut taken, mut leave) = (0, [0; 2]);
                while taken < together
                    && let Some((group, here)) = next
                {
                    next = groups.before(group);
                    at[taken] = (Members::One(group), here);
                    if A::Batch::GROUPS > 1
                        && let Some((before, full)) = next
                    {
                        next = groups.before(before);
                        at[taken] = (Members::Two([before, group]), full + here);
                    }
                    let (members, here) = at[taken];
                    let rows = &mut RowsMut::<T>::pair(groups.members::<A::Batch>(members, idle));
                    let stage = &mut stage[taken];
                    stages.gather((rows, here), &bin, stage, &mut found);
                    if together == 1 {
                        stages.strain((rows, here), &bin, stage, &mut found);
                        let scratch = (&mut records, &mut spread);
                        leave = stages.advance((rows, here), &bin, stage, &mut found, scratch);
                        report.note(&mut found.broken, number, members, &groups);
                    }
                    taken += 1;
                }
                if together > 1 {
                    for n in 0..taken {
                        let rows = &mut RowsMut::<T>::pair(groups.members::<A::Batch>(at[n].0, idle));
                        stages.strain((rows, at[n].1), &bin, &mut stage[n], &mut found);
                        report.note(&mut found.broken, number, at[n].0, &groups);
                    }
                }
                for n in 0..taken {
                    let ((members, here), stage) = (at[n], &mut stage[n]);
                    if together > 1 {
                        let rows = &mut RowsMut::<T>::pair(groups.members::<A::Batch>(members, idle));
                        let scratch = (&mut records, &mut spread);
                        leave = stages.advance((rows, here), &bin, stage, &mut found, scratch);
                        report.note(&mut found.broken, number, members, &groups);
                    }
                    let [gone, long] = leave;
                    if gone | long != 0 {
                        let gradient = &stages.spread_of(stage);
                        let cut = Cut { long, splitter: &common.splitter, gradient };
                        Stages::<T, D, C, M, K, A>::part(stage, long, &mut records);
                        let leaving = Leaving { bin: number, groups: members.both(), gone, cut };
                        let records = &mut records;
                        send_away::<T, NumbersOf<T, A>, D, M, K>(block, movers, report, leaving, records);
                        groups = block.groups(least);
                    }
                    let tiles = [&mut *first, &mut *second];
                    Stages::<T, D, C, M, K, A>::give(
                        here,
                        corner,
                        stage,
                        (&mut records, &mut spread),
                        &mut moments,
                        tiles,
                    );
                }
            }
            if by_moments {
                moments.give::<T>(if maps.together { &mut *first } else { &mut *second }, corner);
            }
        }
        if K::DOES.moves && !M::Frame::TOTAL {
            let here = neighbours(D) / 2;
            let stayed = movers.within.since(0, 0);
            let arrivals = movers.within.going(stayed, here);
            let scratch = (&mut records, &mut spread);
            take_in::<T, A, D, M, K>(method, block, (&mut tile[..], rows), arrivals, &common, scratch);
            *sent = movers.out.since(sent_before, *thread);
        }
        for i in 0..A::Batch::WIDTH {
            report.rate = report.rate.max(found.rate.lane(i));
            for d in 0..D {
                report.flux[d] += found.flux[d].lane(i);
                report.push[d] += found.push[d].lane(i);
            }
            report.power += found.power.lane(i);
        }
        report.rate /= common.spacing;
    }
}
