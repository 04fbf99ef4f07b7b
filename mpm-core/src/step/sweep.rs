//! One pass over the particles of a block: the particle stages of a step, fused.
//!
//! The nodes that the block's particles reach are copied once into a tile; each bin reads its stencil from
//! there, each group of lanes is gathered, updated and scattered while it is in registers and cache, and the
//! sums go to the block's own output tile. No other block writes it, so that threads never meet; the grid
//! adds the tiles up in a fixed order ([`super::nodes`]).

use std::marker::PhantomData;

use mpm_materials::{Constitutive, Fault, Kinematics, Lane, Mask, Mat3, Sink, Source, State, Sym3};

use super::cell::Moments;
use super::convect::Moved;
use super::gather::{Sampler, Wanted};
use super::layout::Nodes;
use super::mean::Strained;
use super::migrate::{Cut, Domains, Leaving, Movers, send_away, take_in};
use super::scatter::{AFFINE, DIRECT, FORCE, MAX_LANES, MOMENTUM, Maps, RECORDS, Records, Spread, scatter};
use super::splitting::Splitter;
use super::tile::{Reads, Stencilled, TileIn, clear_rows, rows_of, tile_corner, tile_nodes};
use super::total;
use crate::dilatation::Dilatation;
use crate::dim::{BLOCK, Stencil, block_nodes, neighbours};
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::method::Composition;
use crate::parallel::{Arch, Float, Kernel, Pack};
use crate::particles::{Block, Columns, Outbox};
use crate::scheme::{Nodal, PassKind};
use crate::shape::{ShapeFunction, bin_centre};
use crate::transfer::Transfer;

/// A block of particles with what its passes need and leave behind.
#[derive(Clone, Debug)]
pub struct Slot<T: Float, const D: usize> {
    /// The particles.
    pub block: Block<T, D>,
    /// What they add to the nodes they reach, `TILE` nodes an axis, x fastest: all first records, then, where
    /// the method maps two, all second ones.
    pub tile: Vec<[T; 4]>,
    /// Rows of the tile that hold sums, a bit each; nothing is known of the others.
    pub rows: u64,
    /// Slots around, likewise.
    pub slots_around: Vec<u32>,
    /// Bins whose stencils the body's nodes hold, a bit each.
    pub linked: u64,
    /// What the last pass found.
    pub report: Report<T>,
}

/// Groups of a bin that go through the stages of a pass together. A law is a long chain of operations that wait for each
/// other; those of two groups, one behind the other, run side by side. With two nodes an axis the gather is so
/// short that what the stages hand on costs more than that gains (docs/notes.md 6.2).
const fn together<E: Stencil>() -> usize {
    if E::NODES > 2 { TOGETHER } else { 1 }
}
const TOGETHER: usize = 2;

/// What stages of a pass hand on of a group.
#[derive(Clone, Copy)]
struct Stage<P: Lane> {
    /// Position.
    xi: [P; 3],
    /// Velocity.
    v: [P; 3],
    mass: P,
    /// First nodal vector.
    nodal: [P; 3],
    /// Second nodal vector.
    increment: [P; 3],
    /// Gradient that strains.
    gradient: Mat3<P>,
    /// Affine fit of the first nodal vector.
    affine: [[P; 3]; 3],
    /// Radial velocity that strains around the axis of revolution.
    hoop_velocity: P,
    stress: Sym3<P>,
    /// Volume of the particles, m^3.
    volume: P,
    /// Inverse of the deformation gradient, where the method maps in the reference configuration.
    inverse: Mat3<P>,
}

impl<P: Lane> Stage<P> {
    #[inline(always)]
    fn zero() -> Self {
        let (zero, none) = (P::zero(), Mat3::zero());
        Stage {
            xi: [zero; 3],
            v: [zero; 3],
            mass: zero,
            nodal: [zero; 3],
            increment: [zero; 3],
            gradient: none,
            affine: none.0,
            hoop_velocity: zero,
            stress: Sym3::zero(),
            volume: zero,
            inverse: Mat3::identity(),
        }
    }
}

/// Memory of a thread for a pass over a block.
#[derive(Clone, Debug, Default)]
pub struct Scratch<T> {
    movers: Movers<T>,
    tile_in: TileIn<T>,
}

impl<T: Float> Scratch<T> {
    /// Bytes of its memory.
    pub(super) fn bytes(&self) -> usize {
        self.movers.bytes() + self.tile_in.bytes()
    }
}

/// Bins between the one at work and the one whose particles are asked for.
const AHEAD: usize = 4;

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
    /// Its particles that leave it.
    pub outbox: &'a mut Outbox<T>,
    /// Memory of the thread.
    pub scratch: &'a mut Scratch<T>,
    /// Shared numbers.
    pub common: Common<T>,
    /// The pass.
    pub pass: PhantomData<K>,
}

/// Reads a law's state from the rows of a group.
pub(super) struct Rows<'a, R, P> {
    rows: &'a [R],
    at: usize,
    lanes: PhantomData<P>,
}
impl<'a, R, P> Rows<'a, R, P> {
    #[inline(always)]
    pub(super) fn of(rows: &'a [R]) -> Self {
        Rows { rows, at: 0, lanes: PhantomData }
    }
}
impl<T: Float, P: Pack<T>> Source<P> for Rows<'_, T::Row, P>
where
    P: Lane<Real = T>,
{
    #[inline(always)]
    fn take(&mut self) -> P {
        self.at += 1;
        P::load(&self.rows[self.at - 1])
    }
}
/// Writes a law's state to the rows of a group.
struct RowsMut<'a, R, P> {
    rows: &'a mut [R],
    at: usize,
    lanes: PhantomData<P>,
}
impl<T: Float, P: Pack<T>> Sink<P> for RowsMut<'_, T::Row, P>
where
    P: Lane<Real = T>,
{
    #[inline(always)]
    fn put(&mut self, value: P) {
        value.store(&mut self.rows[self.at]);
        self.at += 1;
    }
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
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Sweep { law, method, nodes, around, slot, outbox, scratch, common, .. } = self;
        let Scratch { movers, tile_in } = scratch;
        let Slot { block, tile, rows, report, .. } = slot;
        let does = K::DOES;
        let maps = maps::<T, D, M, K>();
        let strain_first = matches!(does.strain, Some(Nodal::First));
        let total = M::Frame::TOTAL;
        let stretches = ShapeOf::<M, T, D>::DOMAIN.carried() && does.moves;
        let splits = does.splits && !total;
        let slopes_first = strain_first || ((stretches || splits) && does.strain.is_none());
        let strain_second = matches!(does.strain, Some(Nodal::Second));
        let reads = Reads {
            first: does.velocity || does.moves || strain_first,
            second: (does.velocity && M::Transfer::READS_INCREMENT) || strain_second || does.smooth,
        };
        let state_rows = <C::State<A::Pack> as State<A::Pack>>::LEN;
        // Rows at work.
        let mut soon = 2 * D + 1;
        if does.strain.is_some() || does.force || does.moves {
            soon += state_rows;
        }
        for bin in 0..AHEAD {
            block.prefetch(bin, soon);
        }
        *rows = rows_of::<ExtentOf<M, T, D>, D>(block.occupied());
        clear_rows::<T, D, ExtentOf<M, T, D>>(tile, *rows, maps);
        outbox.clear();
        movers.clear();
        *report = Report::default();
        if block.is_empty() {
            return;
        }
        tile_in.load::<ExtentOf<M, T, D>, D>(nodes, around[0], reads, *rows);
        let mut stencil = Stencilled::<T, ExtentOf<M, T, D>>::zero();
        let (first, second) = tile.split_at_mut(tile_nodes::<ExtentOf<M, T, D>>(D));

        // Constants of the pass, on lanes.
        let (zero, half) = (A::Pack::zero(), A::Pack::of(0.5));
        let spacing = A::Pack::splat(common.spacing);
        let per_spacing = spacing.recip();
        let dt = A::Pack::splat(common.dt);
        let per_density = A::Pack::splat(law.density()).recip();
        let mut lane_index = zero;
        for i in 0..A::Pack::WIDTH {
            lane_index = lane_index.with_lane(i, T::of(i as f64));
        }
        let mut records: Records<T> = [[[T::default(); 4]; MAX_LANES]; RECORDS];
        let mut spread: Spread<T, ExtentOf<M, T, D>> = Spread::zero();
        let mut stages = [Stage::<A::Pack>::zero(); TOGETHER];
        let mut groups = [(0, 0); TOGETHER];
        let together = together::<ExtentOf<M, T, D>>();
        let mut rate = zero;
        let mut flux = [zero; 3];
        let (mut pushed, mut power) = ([zero; 3], zero);

        let by_moments = maps.moments::<ExtentOf<M, T, D>>();
        let side = <ExtentOf<M, T, D> as Stencil>::TILE;
        let rows_in = if D == 3 { side * side } else { side };
        for bin in 0..block_nodes(D) {
            if bin < rows_in && !around[1].is_empty() {
                TileIn::prefetch::<ExtentOf<M, T, D>, D>(nodes, around[1], bin);
            }
            let mut next = block.last_group(bin);
            if next.is_none() {
                continue;
            }
            if bin + AHEAD < block_nodes(D) {
                block.prefetch(bin + AHEAD, soon);
            }
            let corner = tile_corner::<ExtentOf<M, T, D>, D>(bin);
            stencil.load::<D, A::Quad, ShapeOf<M, T, D>>(tile_in, corner, reads);
            // x of the bin's centre, for the distance to the axis of revolution.
            let bin_x = T::of(
                f64::from(block.coordinates[0]) * BLOCK as f64
                    + (bin % BLOCK) as f64
                    + bin_centre::<ExtentOf<M, T, D>>(),
            );
            let bin_x = A::Pack::splat(common.origin + common.spacing * bin_x);

            let mut moments = Moments::<A::Quad, ExtentOf<M, T, D>>::zero();

            // What laws see of a change of volume, if it is not their own.
            let mean = match does.strain {
                Some(nodal) if M::Dilatation::MEAN => {
                    let block = &*block;
                    let bin_x = bin_x.lane(0);
                    let bin = Strained {
                        law,
                        method,
                        block,
                        bin,
                        stencil: &stencil,
                        nodal,
                        common: &common,
                        bin_x,
                    };
                    Some(bin.mean::<A>())
                }
                _ => None,
            };

            while next.is_some() {
                // Grid to particles.
                let mut taken = 0;
                while taken < together
                    && let Some((group, here)) = next
                {
                    next = block.group_before(group);
                    let Stage { xi, v, mass, nodal, gradient, affine, increment, hoop_velocity, .. } =
                        &mut stages[taken];
                    groups[taken] = (group, here);
                    taken += 1;
                    let (motion, rest) = block.group_mut(group).split_at_mut(2 * D + 1);
                    let rest = &mut rest[state_rows..];

                    for d in 0..D {
                        xi[d] = A::Pack::load(&motion[Columns::position() + d]);
                        v[d] = A::Pack::load(&motion[Columns::velocity(D) + d]);
                    }
                    *mass = A::Pack::load(&motion[Columns::mass(D)]);
                    let carried = |n: usize| A::Pack::load(&rest[n]);
                    let domain = common.domains.of::<A::Pack, ShapeOf<M, T, D>, D>(carried);
                    let mut sampler = Sampler::<A::Pack, ExtentOf<M, T, D>>::zero();
                    if reads.first || reads.second {
                        sampler = Sampler::of(method.shape(), xi, &domain, maps.affine);
                    }
                    // Grid to particles: first nodal vector (velocity) with what is wanted of it. In the
                    // moving-least-squares form the gradient is the affine fit.
                    if reads.first {
                        let slope = slopes_first && !M::Transfer::LEAST_SQUARES;
                        let wanted = Wanted { slope, fit: maps.affine };
                        for c in 0..D {
                            let found = sampler.gather::<T, ShapeOf<M, T, D>, D>(&stencil.first, c, wanted);
                            nodal[c] = found.value;
                            affine[c] = found.fit;
                            if slopes_first {
                                gradient.0[c] = if slope { found.slope } else { found.fit };
                            }
                        }
                        *hoop_velocity = nodal[0];
                    }
                    // Second nodal vector: acceleration (FLIP) or re-mapped velocity (MUSL).
                    if reads.second {
                        let wanted = Wanted { slope: strain_second, fit: false };
                        for c in 0..D {
                            let found = sampler.gather::<T, ShapeOf<M, T, D>, D>(&stencil.second, c, wanted);
                            increment[c] = found.value;
                            if strain_second {
                                gradient.0[c] = found.slope;
                            }
                        }
                        if strain_second {
                            *hoop_velocity = increment[0];
                        }
                    }
                    // The forces on the nodes did their work with the velocities in the middle of the step, here mapped to
                    // the particle; where accelerations are not mapped, by what was mapped before.
                    let frame = rest.len() - 1 - total::rows::<T, D, M>();
                    if does.velocity && (does.load || does.field) {
                        let columns = ShapeOf::<M, T, D>::DOMAIN.numbers(D);
                        for d in 0..D {
                            let change = if reads.second { dt * increment[d] } else { nodal[d] - v[d] };
                            let middle = nodal[d] - half * change;
                            if does.load {
                                flux[d] = A::Pack::load(&rest[columns]).mul_add(middle, flux[d]);
                            } else {
                                power = (*mass * A::Pack::load(&rest[frame - D + d])).mul_add(middle, power);
                            }
                        }
                    }
                    if does.velocity {
                        for d in 0..D {
                            v[d] = method.transfer().velocity(v[d], nodal[d], dt * increment[d], dt);
                            v[d].store(&mut motion[Columns::velocity(D) + d]);
                        }
                    }
                }
                // Strain and stress, at the old position. Lanes without a particle do not deform.
                for n in 0..taken {
                    let (group, here) = groups[n];
                    let Stage { xi, v, mass, gradient, hoop_velocity, stress, volume, inverse, .. } =
                        &mut stages[n];
                    let alive = lane_index.lt(A::Pack::of(here as f64));
                    let rest = &mut block.group_mut(group)[2 * D + 1..];
                    let (state, rest) = rest.split_at_mut(state_rows);
                    let step = A::Pack::select(alive, dt, zero);
                    let cells = step * per_spacing;
                    let frame = rest.len() - 1 - total::rows::<T, D, M>();
                    // Deformation gradient, if mapped in the reference configuration, and its inverse.
                    let mut f = Mat3::identity();
                    if total && (does.strain.is_some() || does.force || does.moves) {
                        f = total::load::<T, A::Pack, D, M>(&rest[frame..]);
                        *inverse = total::inverse::<A::Pack, D>(&f);
                    }

                    if does.strain.is_some() {
                        let mut deformation = *gradient * cells;
                        if M::Embedding::HOOP {
                            deformation.0[2][2] = step * *hoop_velocity / xi[0].mul_add(spacing, bin_x);
                        }
                        if total {
                            f = f + deformation;
                            total::store::<T, A::Pack, D, M>(&f, &mut rest[frame..]);
                            deformation = total::product::<A::Pack, D>(&deformation, inverse);
                            *inverse = total::inverse::<A::Pack, D>(&f);
                        }
                        let old = C::State::<A::Pack>::read(&mut Rows::of(state));
                        if let Some(mean) = &mean {
                            deformation = mean.give::<T, D, M>(deformation, law.volume_ratio(&old));
                        }
                        let kinematics = Kinematics { increment: deformation, dt, length: spacing };
                        let new = law.update(&kinematics, &old);
                        new.state.write(&mut RowsMut { rows: state, at: 0, lanes: PhantomData });
                        *stress = new.stress;
                        *volume = law.volume_ratio(&new.state) * *mass * per_density;
                        if new.fault.any() {
                            let numbers = rest[rest.len() - 1].as_ref();
                            note_fault(report, bin, &numbers[..here], new.fault);
                        }
                        if does.force && common.speeds {
                            rate = rate.max(A::Pack::select(
                                alive,
                                signal::<T, A::Pack, C>(law, &new.state, v, inverse, total),
                                zero,
                            ));
                        }
                    } else if does.force {
                        let now = C::State::<A::Pack>::read(&mut Rows::of(state));
                        *stress = law.stress(&now);
                        *volume = law.volume_ratio(&now) * *mass * per_density;
                        if common.speeds {
                            rate = rate.max(A::Pack::select(
                                alive,
                                signal::<T, A::Pack, C>(law, &now, v, inverse, total),
                                zero,
                            ));
                        }
                    } else if does.moves && common.speeds {
                        let now = C::State::<A::Pack>::read(&mut Rows::of(state));
                        rate = rate.max(A::Pack::select(
                            alive,
                            signal::<T, A::Pack, C>(law, &now, v, inverse, total),
                            zero,
                        ));
                    }
                }
                // Motion, and particles to grid. Lanes without a particle do not move.
                for n in 0..taken {
                    let (group, here) = groups[n];
                    let Stage {
                        mut xi,
                        v,
                        mass,
                        nodal,
                        gradient,
                        affine,
                        increment,
                        stress,
                        volume,
                        inverse,
                        ..
                    } = stages[n];
                    let alive = lane_index.lt(A::Pack::of(here as f64));
                    let (motion, rest) = block.group_mut(group).split_at_mut(2 * D + 1);
                    let (state, rest) = rest.split_at_mut(state_rows);
                    let carried = |n: usize| A::Pack::load(&rest[n]);
                    let mut domain = common.domains.of::<A::Pack, ShapeOf<M, T, D>, D>(carried);
                    let cells = A::Pack::select(alive, dt, zero) * per_spacing;
                    let frame = rest.len() - 1 - total::rows::<T, D, M>();
                    // Domains keep their sizes until the particles move, so that all passes of a step use the same
                    // weights.
                    if stretches {
                        let moved = Moved { xi: &xi, nodal: &nodal, gradient: &gradient, cells };
                        moved.domain::<T, ShapeOf<M, T, D>, D>(method.shape(), &stencil.first, &mut domain);
                        for n in 0..ShapeOf::<M, T, D>::DOMAIN.numbers(D) {
                            domain[n].store(&mut rest[n]);
                        }
                    }

                    // Position.
                    let (mut stays, mut staying) = (!0, alive);
                    if does.moves && total {
                        for d in 0..D {
                            let moved = cells.mul_add(nodal[d], A::Pack::load(&rest[frame + d]));
                            moved.store(&mut rest[frame + d]);
                        }
                    } else if does.moves {
                        let mut inside = <A::Pack as Lane>::Mask::splat(true);
                        for d in 0..D {
                            xi[d] = cells.mul_add(nodal[d], xi[d]);
                            xi[d].store(&mut motion[Columns::position() + d]);
                            inside = inside & (-half).le(xi[d]) & xi[d].lt(half);
                        }
                        stays = A::Pack::bits(inside);
                        staying = alive & inside;
                    }

                    // Particles stretched so far that they are cut in two.
                    let mut long = 0;
                    if splits {
                        let (splitter, first) = (&common.splitter, common.splitter.place);
                        let mut trace = A::Pack::load(&state[first]);
                        for d in 1..D {
                            trace = trace + A::Pack::load(&state[first + d]);
                        }
                        // The largest principal value is at most the sum of all.
                        let may = A::Pack::bits(alive & A::Pack::splat(splitter.square).le(trace));
                        if may != 0 {
                            let axis =
                                M::Embedding::HOOP.then(|| (bin_x.lane(0) / common.spacing, &motion[0]));
                            let mut ratio = T::Row::default();
                            law.volume_ratio(&C::State::<A::Pack>::read(&mut Rows::of(state)))
                                .store(&mut ratio);
                            long = splitter.long::<D>(state, &ratio, may, axis);
                        }
                    }

                    // Particles to grid, at the new position.
                    let momentum = if does.smooth { increment } else { v };
                    let mut force_scale = volume * per_spacing;
                    if maps.together {
                        force_scale = force_scale * A::Pack::splat(common.next_dt);
                    }
                    // In the reference configuration not symmetric.
                    let carried =
                        if total { total::nominal::<A::Pack, D>(&stress, &inverse) } else { stress.to_mat() };
                    let mut force = carried * -force_scale;
                    let mut momenta = [[zero; 3]; 3];
                    for d in 0..D {
                        for c in 0..D {
                            if maps.affine {
                                momenta[c][d] = mass * affine[c][d];
                            }
                            if maps.least_squares {
                                let per_inertia = method.shape().inertia(xi[d], domain[d]).recip();
                                momenta[c][d] = force.0[c][d].mul_add(per_inertia, momenta[c][d]);
                            }
                        }
                    }
                    if maps.least_squares {
                        force = Mat3::zero();
                    }
                    let mut impulse = [mass * momentum[0], mass * momentum[1], mass * momentum[2]];
                    if maps.direct {
                        let mut direct = [zero; 3];
                        if M::Embedding::HOOP {
                            // The radius of the new position, like the weights.
                            direct[0] = -(volume * carried.0[2][2]) / xi[0].mul_add(spacing, bin_x);
                        }
                        if does.load {
                            let columns = ShapeOf::<M, T, D>::DOMAIN.numbers(D);
                            let area = A::Pack::load(&rest[columns]);
                            for d in 0..D {
                                direct[d] = area.mul_add(A::Pack::splat(common.traction[d]), direct[d]);
                            }
                        }
                        if does.field {
                            let column = frame - D;
                            for d in 0..D {
                                let push = mass * A::Pack::load(&rest[column + d]);
                                direct[d] = direct[d] + push;
                                pushed[d] = pushed[d] + push;
                            }
                        }
                        for d in 0..D {
                            if maps.together {
                                direct[d] = direct[d] * A::Pack::splat(common.next_dt);
                            }
                            if maps.least_squares {
                                impulse[d] = impulse[d] + direct[d];
                            }
                        }
                        A::Pack::records(zero, direct[0], direct[1], direct[2], &mut records[DIRECT]);
                    }
                    fill_records::<T, A, D>(&mut records, mass, impulse, &momenta, &xi, maps);
                    if maps.slopes() && !by_moments {
                        force_records::<T, A, D>(&mut records, &force);
                    }
                    let volume = spread.place(method.shape(), &xi, &domain, maps.slopes());
                    if maps.convected {
                        let sound = A::Pack::bits(zero.lt(volume));
                        if does.moves && !sound & ((1 << here) - 1) != 0 {
                            note_inside_out(report, bin, &rest[rest.len() - 1].as_ref()[..here], sound);
                        }
                    }
                    if does.moves && !total {
                        let gone = !stays & ((1 << here) - 1);
                        if gone | long != 0 {
                            let mut spread = [T::Row::default(); 9];
                            if splits {
                                for i in 0..D * D {
                                    (gradient.0[i / D][i % D] * per_spacing).store(&mut spread[i]);
                                }
                            }
                            let cut = Cut { long, splitter: &common.splitter, gradient: &spread };
                            if by_moments {
                                force_records::<T, A, D>(&mut records, &force);
                                staying = staying & !lanes_of::<T, A>(long);
                            }
                            let leaving = Leaving { bin, group, gone, cut };
                            send_away::<T, D>(block, (outbox, movers), report, leaving, &mut records, maps);
                        }
                    }
                    for lane in here..T::GROUP {
                        for kind in 0..RECORDS {
                            if maps.uses::<D>(kind) && !(by_moments && kind >= FORCE) {
                                records[kind][lane] = [T::default(); 4];
                            }
                        }
                    }
                    if by_moments {
                        for c in 0..D {
                            for d in 0..D {
                                force.0[c][d] = A::Pack::select(staying, force.0[c][d], zero);
                            }
                        }
                        moments.add_group::<T, A>(&xi, &force);
                    }
                    let (tiles, at) = ([&mut *first, &mut *second], corner);
                    match T::GROUP {
                        4 if here <= 2 && ExtentOf::<M, T, D>::NODES > 2 => {
                            scatter::<T, A, ExtentOf<M, T, D>, 2>(tiles, at, &spread, &records, maps)
                        }
                        4 => scatter::<T, A, ExtentOf<M, T, D>, 4>(tiles, at, &spread, &records, maps),
                        _ if here <= 4 && ExtentOf::<M, T, D>::NODES > 2 => {
                            scatter::<T, A, ExtentOf<M, T, D>, 4>(tiles, at, &spread, &records, maps)
                        }
                        _ => scatter::<T, A, ExtentOf<M, T, D>, 8>(tiles, at, &spread, &records, maps),
                    }
                }
            }
            if by_moments {
                moments.give::<T>(if maps.together { &mut *first } else { &mut *second }, corner);
            }
        }
        if does.moves && !total {
            let here = neighbours(D) / 2;
            let scratch = (&mut records, &mut spread);
            take_in::<T, A, D, M, K>(
                method,
                block,
                (tile, rows),
                movers.within(),
                here,
                common.domains,
                scratch,
            );
        }
        for i in 0..A::Pack::WIDTH {
            report.rate = report.rate.max(rate.lane(i));
            for d in 0..D {
                report.flux[d] += flux[d].lane(i);
                report.push[d] += pushed[d].lane(i);
            }
            report.power += power.lane(i);
        }
        report.rate /= common.spacing;
    }
}

/// Speed of signals past a particle, c + |v|, m/s.
#[inline(always)]
fn speed<T, P, C>(law: &C, now: &C::State<P>, v: &[P; 3]) -> P
where
    T: Float,
    P: Pack<T>,
    C: Constitutive<T>,
{
    law.wave_speed(now) + v[0].mul_add(v[0], v[1].mul_add(v[1], v[2] * v[2])).sqrt()
}

/// The records of a group but those of forces; see [`super::scatter`].
#[inline(always)]
fn fill_records<T: Float, A: Arch<T>, const D: usize>(
    records: &mut Records<T>,
    mass: A::Pack,
    mut p: [A::Pack; 3],
    affine: &[[A::Pack; 3]; 3],
    xi: &[A::Pack; 3],
    maps: Maps,
) {
    let zero = A::Pack::zero();
    if maps.momentum {
        if maps.has_affine() {
            for d in 0..D {
                for c in 0..D {
                    p[c] = (-affine[c][d]).mul_add(xi[d], p[c]);
                }
                let a = [affine[0][d], affine[1][d], affine[2][d]];
                A::Pack::records(zero, a[0], a[1], a[2], &mut records[AFFINE + d]);
            }
        }
        A::Pack::records(mass, p[0], p[1], p[2], &mut records[MOMENTUM]);
    }
}

/// The records of the forces of a group.
#[inline(always)]
fn force_records<T: Float, A: Arch<T>, const D: usize>(records: &mut Records<T>, force: &Mat3<A::Pack>) {
    let zero = A::Pack::zero();
    for d in 0..D {
        let third = if D == 3 { force.0[2][d] } else { zero };
        A::Pack::records(zero, force.0[0][d], force.0[1][d], third, &mut records[FORCE + d]);
    }
}

/// The lanes of set bits.
#[inline(always)]
fn lanes_of<T: Float, A: Arch<T>>(bits: u32) -> <A::Pack as Lane>::Mask {
    let mut set = A::Pack::zero();
    for lane in 0..A::Pack::WIDTH {
        set = set.with_lane(lane, T::of(f64::from(bits >> lane & 1)));
    }
    A::Pack::zero().lt(set)
}

/// Speed of signals over the cells, m/s: past a particle, or through the reference configuration.
#[inline(always)]
fn signal<T, P, C>(law: &C, now: &C::State<P>, v: &[P; 3], inverse: &Mat3<P>, total: bool) -> P
where
    T: Float,
    P: Pack<T>,
    C: Constitutive<T>,
{
    if total { total::speed::<T, P, C>(law, now, inverse) } else { speed(law, now, v) }
}

#[cold]
fn note_inside_out<T: Float>(report: &mut Report<T>, bin: usize, numbers: &[T], sound: u32) {
    let bad = numbers.iter().enumerate().find(|(lane, _)| sound >> lane & 1 == 0);
    if let (None, Some((_, number))) = (report.trouble, bad) {
        let particle = number.to_double() as usize;
        report.trouble = Some(Trouble { bin, particle, cause: Cause::InsideOut });
    }
}

#[cold]
fn note_fault<T: Float, L: Lane<Real = T>>(
    report: &mut Report<T>,
    bin: usize,
    numbers: &[T],
    fault: Fault<L>,
) {
    for (lane, number) in numbers.iter().enumerate() {
        if let (None, Some(cause)) = (report.trouble, fault.cause(lane)) {
            let particle = number.to_double() as usize;
            report.trouble = Some(Trouble { bin, particle, cause: Cause::Law(cause) });
        }
    }
}
