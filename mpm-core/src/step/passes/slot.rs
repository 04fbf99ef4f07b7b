//! Data of a pass over a block of particles: block data, thread memory, and parameters that all blocks of a body share.

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

/// Block of particles with the input and output of its passes.
///
/// Fields that sums over tiles need come first, in one cache line.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct Slot<T: Float, const D: usize> {
    /// Contributions of the particles to the nodes that they reach, `TILE` nodes per axis, x fastest: all first records,
    /// then, if the method maps two, all second ones.
    pub tile: AlignedRecords<T>,
    /// Rows of the tile that contain sums, one bit each; the others are undefined.
    pub rows: u64,
    /// Block of particles.
    pub block: Block<T, D>,
    /// Slots around the block, 3^D, x fastest (`u32::MAX` if absent).
    pub slots_around: Vec<u32>,
    /// Bins whose stencil nodes are allocated for the body, one bit each.
    pub linked: u64,
    /// Results of the last pass.
    pub report: Report<T>,
    /// Affine part of the momentum that the particles map, D records a node of the tile: for blocks at the border of a level of
    /// cells, where nodes depend on others. Empty for other blocks.
    pub affine: Vec<[T; 4]>,
    /// Bins whose particles reach such nodes, one bit each.
    pub border: u64,
    /// True if the cells of the block have just changed their size: its particles leave in the next pass.
    pub evacuated: bool,
}

/// Thread memory for a pass over a block.
#[derive(Debug, Default)]
pub struct Scratch<T: Float> {
    /// Index among the memories of all threads.
    pub(in crate::step) number: u32,
    pub(in crate::step) movers: Movers<T>,
    pub(in crate::step) tile_in: TileIn<T>,
    /// Rows of a dummy group that fills the second half of a vector.
    pub(in crate::step) idle: Vec<T::Row>,
    /// Batch of groups for the constitutive law.
    pub(in crate::step) batch: LawBatch<T>,
}

impl<T: Float> Scratch<T> {
    /// Create the empty memory of thread `number`.
    pub(in crate::step) fn new(number: usize) -> Self {
        Scratch { number: number as u32, ..Scratch::default() }
    }
    /// Outbox of the particles that left their blocks.
    pub(in crate::step) fn out(&mut self) -> &mut Outbox<T> {
        &mut self.movers.out
    }
    /// Buffer for nodal records.
    pub(in crate::step) fn tile_in(&mut self) -> &mut TileIn<T> {
        &mut self.tile_in
    }
    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.movers.bytes()
            + self.tile_in.bytes()
            + self.idle.capacity() * size_of::<T::Row>()
            + self.batch.bytes()
    }
}

/// Memory locations of a slot, to be prefetched while another slot is processed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outline {
    slot: Whereabouts,
    /// Tables of the block.
    tables: [Whereabouts; 2],
    /// Groups of the block.
    groups: Whereabouts,
    tile: Whereabouts,
}

impl Outline {
    /// Return the memory locations of a slot.
    pub(in crate::step) fn of<T: Float, const D: usize>(slot: &Slot<T, D>) -> Self {
        let [runs, before, groups] = slot.block.outline();
        let (tables, tile) = ([runs, before], Whereabouts::of(slot.tile.all()));
        Outline { slot: Whereabouts::of(std::slice::from_ref(slot)), tables, groups, tile }
    }

    /// Prefetch the slot and its tables.
    #[inline(always)]
    pub(in crate::step) fn ask_first(&self) {
        for memory in [self.slot, self.tables[0], self.tables[1]] {
            memory.prefetch_early();
        }
    }

    /// Prefetch the share of one bin of the current block: some of the first `records` of the tile and, for the last bins,
    /// the leading groups, which are those of the first bins if few particles moved.
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

/// Cache lines of the leading groups to prefetch with each of the last bins of the previous block. In 3D two groups of a
/// full bin are about fifteen lines, so that all prefetched lines cover about eight bins.
const FIRST_LINES: usize = 8;

/// Results of a pass.
#[derive(Clone, Copy, Debug, Default)]
pub struct Report<T> {
    /// Largest signal rate (c + |v|) / h, 1/s.
    pub rate: T,
    /// Mass, kg, and momentum, kg m/s, of the particles, for passes that move them.
    pub moments: [T; 4],
    /// Number of split particles.
    pub splits: u32,
    /// Kinetic energy of the motion within split particles, J.
    pub revealed: T,
    /// First particle with an error.
    pub trouble: Option<Trouble>,
}

impl<T: Float> Report<T> {
    /// Record a particle with an error, from groups of a bin.
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

/// Particle with an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trouble {
    /// Bin of the particle in its block.
    pub bin: usize,
    /// Number of the particle.
    pub particle: usize,
    /// Cause of the error.
    pub cause: Cause,
}

/// Parameters of a pass, shared by all blocks of a body.
#[derive(Clone, Copy, Debug)]
pub struct Common<T> {
    /// Time step, s.
    pub dt: T,
    /// Next time step, s, for impulses mapped together with momentum.
    pub next_dt: T,
    /// Node spacing h, m.
    pub spacing: T,
    /// x of node zero, m (the axis of revolution is x = 0).
    pub origin: T,
    /// Reference density of the law, kg/m^3.
    pub density: T,
    /// True if wave speeds are requested, for the next time step.
    pub speeds: bool,
    /// True if the law uses the mean dilatation of a bin.
    pub mean: bool,
    /// Fraction of the deviation from the mean of its bin that the volume of a particle recovers.
    pub mean_return: T,
    /// Domain half sizes of the particles, in units of h.
    pub domains: Domains<T>,
    /// Masses of the particles.
    pub masses: Masses<T>,
    /// First row of displacement and deformation gradient, for mapping in the reference configuration.
    pub frame: usize,
    /// Splitting criterion of particles.
    pub splitter: Splitter<T>,
}

/// Parameters of a pass for the blocks of each level of cells.
#[derive(Clone, Debug)]
pub struct Commons<T> {
    /// Level of the largest cells.
    pub coarsest: Common<T>,
    /// Further levels.
    pub finer: Vec<Common<T>>,
}

impl<T> Commons<T> {
    /// Return the parameters for the blocks of a level.
    #[inline(always)]
    pub(in crate::step) fn of(&self, level: usize) -> &Common<T> {
        level.checked_sub(1).and_then(|finer| self.finer.get(finer)).unwrap_or(&self.coarsest)
    }
}

/// Input of a pass over a block.
pub struct Task<'a, T: Float, const D: usize> {
    /// Constitutive law of the body.
    pub material: &'a dyn Material<T>,
    /// All nodes of the grid.
    pub nodes: Nodes<'a, T>,
    /// Node blocks around the block, 3^D, x fastest (`u32::MAX` if absent), and those around the next block, if any.
    pub around: [&'a [u32]; 2],
    /// Slot of the block.
    pub slot: &'a mut Slot<T, D>,
    /// Memory locations of the next block.
    pub next: Option<&'a Outline>,
    /// Selection of the particles in the thread's outbox that left the block.
    pub sent: &'a mut Sent,
    /// Values of lanes without a particle, as in the block, from memory that all blocks share.
    pub dummy: &'a [T],
    /// Memory of the thread.
    pub scratch: &'a mut Scratch<T>,
    /// Shared parameters.
    pub common: &'a Common<T>,
}

/// Particles that change their bins, collected by a thread.
#[derive(Clone, Debug, Default)]
pub struct Movers<T> {
    /// Particles that leave their block.
    pub(in crate::step) out: Outbox<T>,
    /// Particles that change bins within the current block; its pass inserts them at its end.
    pub(in crate::step) within: Outbox<T>,
    /// Numbers of a particle to be split, then of its two children.
    pub(in crate::step) moving: Vec<T>,
}

impl<T: Float> Movers<T> {
    /// Allocated memory, bytes.
    pub(in crate::step) fn bytes(&self) -> usize {
        self.out.bytes() + self.within.bytes() + self.moving.capacity() * size_of::<T>()
    }
}

/// Particle domains: from columns, or one box for all particles.
#[derive(Clone, Copy, Debug)]
pub struct Domains<T> {
    /// First column, if particles store their domains.
    pub column: usize,
    /// Half sizes of the common box, in units of h.
    pub half: [T; 3],
}

impl<T: Float> Domains<T> {
    /// Return the numbers of a domain; `carried` reads those that particles store.
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
