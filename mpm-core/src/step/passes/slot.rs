//! What a pass over a block of particles works on: the block's own data, the memory of a thread, the numbers that all blocks
//! of a body share.

use mpm_materials::Lane;
use mpm_materials::material::Material;

use super::law_batch::LawBatch;
use super::tile::TileIn;
use crate::dim::block_nodes;
use crate::particles::{Block, Groups, Masses, Members, Outbox, Sent};
use crate::shape::ShapeFunction;
use crate::shape::domain::MOST_NUMBERS;
use crate::step::between_steps::splitting::Splitter;
use crate::step::nodes::layout::Nodes;
use impactite_scene::Cause;
use impactite_simd::{AlignedRecords, Float, LINE, Whereabouts};

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

/// Memory of a thread for a pass over a block.
#[derive(Debug, Default)]
pub struct Scratch<T: Float> {
    /// Which one it is among those of all threads.
    pub(in crate::step) number: u32,
    pub(in crate::step) movers: Movers<T>,
    pub(in crate::step) tile_in: TileIn<T>,
    /// What goes through a pass beside a group that has no other.
    pub(in crate::step) idle: Vec<T::Row>,
    /// Groups on their way through their law.
    pub(in crate::step) batch: LawBatch<T>,
}

impl<T: Float> Scratch<T> {
    /// The `number`-th one, empty.
    pub(in crate::step) fn new(number: usize) -> Self {
        Scratch { number: number as u32, ..Scratch::default() }
    }
    /// Particles that left their blocks.
    pub(in crate::step) fn out(&mut self) -> &mut Outbox<T> {
        &mut self.movers.out
    }
    /// Room for nodal records.
    pub(in crate::step) fn tile_in(&mut self) -> &mut TileIn<T> {
        &mut self.tile_in
    }
    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.movers.bytes()
            + self.tile_in.bytes()
            + self.idle.capacity() * size_of::<T::Row>()
            + self.batch.bytes()
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
    pub(in crate::step) fn of<T: Float, const D: usize>(slot: &Slot<T, D>) -> Self {
        let [runs, before, groups] = slot.block.outline();
        let (tables, tile) = ([runs, before], Whereabouts::of(slot.tile.all()));
        Outline { slot: Whereabouts::of(std::slice::from_ref(slot)), tables, groups, tile }
    }

    /// Ask for the slot and its tables.
    #[inline(always)]
    pub(in crate::step) fn ask_first(&self) {
        for memory in [self.slot, self.tables[0], self.tables[1]] {
            memory.prefetch_early();
        }
    }

    /// Ask for what falls to one of the bins of the block at work: some of the first `records` of the tile; towards the end,
    /// the groups that lie first, which are those of the first bins if few moved.
    #[inline(always)]
    pub(in crate::step) fn ask<T: Float, const D: usize>(&self, bin: usize, records: usize) {
        let lines = (records * size_of::<[T; 4]>()).div_ceil(LINE * block_nodes(D));
        self.tile.prefetch_lines_early(bin * lines, lines);
        let late = block_nodes(D) * 3 / 4;
        if bin >= late {
            self.groups.prefetch_lines_early((bin - late) * FIRST_LINES, FIRST_LINES);
        }
    }
}

/// Cache lines of the groups that lie first that are asked for beside each of the last bins of the block before: in space two
/// groups of full bins are about fifteen, so that all of them are those of some eight bins.
const FIRST_LINES: usize = 8;

/// What a pass found out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report<T> {
    /// Largest (c + |v|) / h, 1/s.
    pub rate: T,
    /// Mass, kg, and momentum, kg m/s, of the particles, where they moved.
    pub moments: [T; 4],
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
    pub(in crate::step) fn note(
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
    /// Reference density of the law, kg/m^3.
    pub density: T,
    /// Are wave speeds wanted, for the next time step?
    pub speeds: bool,
    /// Does the law see the mean dilatation of a bin?
    pub mean: bool,
    /// Domain half sizes of the particles, in units of h.
    pub domains: Domains<T>,
    /// What particles weigh.
    pub masses: Masses<T>,
    /// First row of displacement and deformation, where particles are mapped in their reference configuration.
    pub frame: usize,
    /// When particles are split.
    pub splitter: Splitter<T>,
}

/// A block for a pass over it.
pub struct Task<'a, T: Float, const D: usize> {
    /// The body's law.
    pub material: &'a dyn Material<T>,
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
    pub common: &'a Common<T>,
}

/// The particles that change their bins, as a thread finds them.
#[derive(Clone, Debug, Default)]
pub struct Movers<T> {
    /// Those that leave their block.
    pub(in crate::step) out: Outbox<T>,
    /// Those of the block at work that stay in it: its own pass takes them in at its end.
    pub(in crate::step) within: Outbox<T>,
    /// The numbers of one on its way, or of the two that it was cut in.
    pub(in crate::step) moving: Vec<T>,
}

impl<T: Float> Movers<T> {
    /// Bytes of its memory.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.out.bytes() + self.within.bytes() + self.moving.capacity() * size_of::<T>()
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
    pub(in crate::step) fn of<P: Lane<Real = T>, S: ShapeFunction<T, D>, const D: usize>(
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
