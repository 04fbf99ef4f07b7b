//! The stages that a group of lanes goes through in a pass: from the grid to its particles; strain and law; motion, and
//! from the particles to the grid.

use std::marker::PhantomData;

use mpm_materials::{Constitutive, Fault, Kinematics, Lane, Mask, Mat3, State, Sym3};

use super::cell::{Moments, from_cell, on_cell};
use super::convect::Moved;
use super::gather::{Sampler, Wanted};
use super::mean::Mean;
use super::rows::RowsMut;
use super::scatter::{AFFINE, DIRECT, FORCE, MOMENTUM, Maps, NumbersOf, Records, Room, along_axes, scatter};
use super::sweep::{Cause, Common, ExtentOf, ShapeOf, maps};
use super::tile::{Reads, Stencilled};
use super::total;
use crate::dilatation::Dilatation;
use crate::dim::{Array, BLOCK, Stencil};
use crate::embedding::Embedding;
use crate::frame::Frame;
use crate::method::Composition;
use crate::parallel::{Arch, Float, Pack, lane_numbers};
use crate::particles::Columns;
use crate::scheme::{Nodal, Pass, PassKind};
use crate::shape::ShapeFunction;
use crate::shape::domain::MOST_NUMBERS;
use crate::transfer::Transfer;

/// What stages of a pass hand on of a group.
#[derive(Clone, Copy)]
pub(super) struct Stage<P: Lane> {
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
    /// G_d of [`super::scatter`], column by column.
    force: Mat3<P>,
    /// Particles that stay in their bin.
    pub(super) staying: P::Mask,
}

impl<P: Lane> Stage<P> {
    #[inline(always)]
    pub(super) fn zero() -> Self {
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
            force: none,
            staying: P::Mask::splat(true),
        }
    }
}

/// The bin that the groups belong to.
pub(super) struct Bin<'a, T: Float, E: Stencil, P> {
    /// Its stencil.
    pub(super) stencil: &'a Stencilled<T, E>,
    /// The records of its nodes themselves, first and second, in tile order.
    pub(super) nodes: [&'a [[T; 4]]; 2],
    /// x of its centre, m, for the distance to the axis of revolution.
    pub(super) x: P,
    /// What laws see of a change of volume, if it is not their own.
    pub(super) mean: Option<Mean<P>>,
}

/// What the groups of a block sum up beside their nodes.
#[derive(Clone, Copy)]
pub(super) struct Found<P> {
    /// Largest speed of signals, m/s.
    pub(super) rate: P,
    pub(super) flux: [P; 3],
    pub(super) push: [P; 3],
    pub(super) power: P,
    /// The first particle of the groups at work that cannot go on, by its lane.
    pub(super) broken: Option<(usize, Cause)>,
}

impl<P: Lane> Found<P> {
    #[inline(always)]
    pub(super) fn none() -> Self {
        let zero = P::zero();
        Found { rate: zero, flux: [zero; 3], push: [zero; 3], power: zero, broken: None }
    }
}

/// The stages of the pass `K`, with what all groups of a block share.
pub(super) struct Stages<'a, T: Float, const D: usize, C, M, K, A: Arch<T>> {
    law: &'a C,
    method: &'a M,
    common: &'a Common<T>,
    dt: A::Batch,
    spacing: A::Batch,
    per_spacing: A::Batch,
    per_density: A::Batch,
    /// 0, 1, 2 ...
    lane_index: A::Batch,
    pass: PhantomData<K>,
}

impl<'a, T, const D: usize, C, M, K, A> Stages<'a, T, D, C, M, K, A>
where
    T: Float,
    C: Constitutive<T>,
    M: Composition<T, D>,
    K: PassKind,
    A: Arch<T>,
{
    const DOES: Pass = K::DOES;
    const TOTAL: bool = M::Frame::TOTAL;
    const STRAIN_FIRST: bool = matches!(K::DOES.strain, Some(Nodal::First));
    const STRAIN_SECOND: bool = matches!(K::DOES.strain, Some(Nodal::Second));
    /// Do domains follow the motion?
    const STRETCHES: bool = ShapeOf::<M, T, D>::DOMAIN.carried() && K::DOES.moves;
    /// Are particles split that are stretched too far?
    const SPLITS: bool = K::DOES.splits && !M::Frame::TOTAL;
    const SLOPES_FIRST: bool =
        Self::STRAIN_FIRST || ((Self::STRETCHES || Self::SPLITS) && K::DOES.strain.is_none());
    /// What it reads of a node.
    pub(super) const READS: Reads = Reads {
        first: (K::DOES.velocity && (M::Transfer::READS_VELOCITY || K::DOES.load || K::DOES.field))
            || K::DOES.moves
            || Self::STRAIN_FIRST,
        second: (K::DOES.velocity && M::Transfer::READS_INCREMENT) || Self::STRAIN_SECOND || K::DOES.smooth,
    };
    /// Of these it makes coefficients for its particles. Where a bin's particles are a vector or two, nodal sums take fewer
    /// operations, if nothing but values is wanted.
    pub(super) const BY_COEFFICIENTS: Reads = Reads {
        first: Self::READS.first && !(Self::SUMS_NODES && !Self::SLOPES_FIRST && !M::Transfer::AFFINE),
        second: Self::READS.second && !(Self::SUMS_NODES && !Self::STRAIN_SECOND),
    };
    const SUMS_NODES: bool =
        A::Batch::WIDTH == 8 && ExtentOf::<M, T, D>::NODES == 2 && !ShapeOf::<M, T, D>::DOMAIN.convects();
    const STATE: usize = <C::State<A::Batch> as State<A::Batch>>::LEN;
    const MOTION: usize = Columns::state(D);
    /// First row after the law's state: of the domain, then of loads, displacement and deformation, the mass, and the number, as
    /// far as they are carried.
    const REST: usize = Self::MOTION + Self::STATE;
    /// Rows that every group has.
    pub(super) const ROWS: usize = Self::REST;
    /// Rows at work.
    pub(super) const AT_WORK: usize =
        if K::DOES.strain.is_some() || K::DOES.force || K::DOES.moves { Self::REST } else { Self::MOTION };

    #[inline(always)]
    pub(super) fn new(law: &'a C, method: &'a M, common: &'a Common<T>) -> Self {
        let spacing = A::Batch::splat(common.spacing);
        Stages {
            law,
            method,
            common,
            dt: A::Batch::splat(common.dt),
            spacing,
            per_spacing: spacing.recip(),
            per_density: A::Batch::splat(law.density()).recip(),
            lane_index: lane_numbers::<T, A::Batch>(),
            pass: PhantomData,
        }
    }

    /// Are these the lanes with a particle?
    #[inline(always)]
    fn alive(&self, here: usize) -> <A::Batch as Lane>::Mask {
        self.lane_index.lt(A::Batch::of(here as f64))
    }

    /// The domains of the particles of a group.
    #[inline(always)]
    fn domain(&self, rows: &RowsMut<'_, T>) -> [A::Batch; MOST_NUMBERS] {
        self.common.domains.of::<A::Batch, ShapeOf<M, T, D>, D>(|n: usize| rows.load(Self::REST + n))
    }

    /// The law's state.
    #[inline(always)]
    fn state(rows: &RowsMut<'_, T>) -> C::State<A::Batch> {
        C::State::<A::Batch>::read(&mut rows.reader(Self::MOTION))
    }

    /// Grid to particles.
    #[inline(always)]
    pub(super) fn gather(
        &self,
        (rows, here): (&mut RowsMut<'_, T>, usize),
        bin: &Bin<'_, T, ExtentOf<M, T, D>, A::Batch>,
        stage: &mut Stage<A::Batch>,
        found: &mut Found<A::Batch>,
    ) {
        let (does, reads, maps) = (Self::DOES, Self::READS, maps::<T, D, M, K>());
        let Stage { xi, v, mass, nodal, gradient, affine, increment, hoop_velocity, .. } = stage;
        for d in 0..D {
            xi[d] = rows.load(Columns::position() + d);
            v[d] = rows.load(Columns::velocity(D) + d);
        }
        *mass = self.common.masses.of_group(self.alive(here), |row| rows.load(row));
        let mut sampler = Sampler::<A::Batch, ExtentOf<M, T, D>>::zero();
        let by_coefficients = Self::BY_COEFFICIENTS;
        let mut weights = <ExtentOf<M, T, D> as Stencil>::Nodes::<A::Batch>::filled(A::Batch::zero());
        if Self::SUMS_NODES {
            let along = along_axes(self.method.shape(), xi, &self.domain(rows));
            weights = on_cell::<A::Batch, ExtentOf<M, T, D>>(&along);
        }
        if by_coefficients.first || by_coefficients.second {
            sampler = Sampler::of(self.method.shape(), xi, &self.domain(rows), maps.affine);
        }
        // First nodal vector (velocity) with what is wanted of it. In the moving-least-squares form the gradient is the
        // affine fit.
        if reads.first && !by_coefficients.first {
            for c in 0..D {
                nodal[c] = from_cell::<T, A::Batch, ExtentOf<M, T, D>>(&weights, bin.nodes[0], c);
            }
            *hoop_velocity = nodal[0];
        } else if reads.first {
            let slope = Self::SLOPES_FIRST && !M::Transfer::LEAST_SQUARES;
            let wanted = Wanted { slope, fit: maps.affine };
            for c in 0..D {
                let found = sampler.gather::<T, ShapeOf<M, T, D>, D>(&bin.stencil.first, c, wanted);
                nodal[c] = found.value;
                affine[c] = found.fit;
                if Self::SLOPES_FIRST {
                    gradient.0[c] = if slope { found.slope } else { found.fit };
                }
            }
            *hoop_velocity = nodal[0];
        }
        // Second nodal vector: acceleration (FLIP) or re-mapped velocity (MUSL).
        if reads.second && !by_coefficients.second {
            for c in 0..D {
                increment[c] = from_cell::<T, A::Batch, ExtentOf<M, T, D>>(&weights, bin.nodes[1], c);
            }
        } else if reads.second {
            let wanted = Wanted { slope: Self::STRAIN_SECOND, fit: false };
            for c in 0..D {
                let found = sampler.gather::<T, ShapeOf<M, T, D>, D>(&bin.stencil.second, c, wanted);
                increment[c] = found.value;
                if Self::STRAIN_SECOND {
                    gradient.0[c] = found.slope;
                }
            }
            if Self::STRAIN_SECOND {
                *hoop_velocity = increment[0];
            }
        }
        // The forces on the nodes did their work with the velocities in the middle of the step, here mapped to the
        // particle; where accelerations are not mapped, by what was mapped before.
        if does.velocity && (does.load || does.field) {
            let frame = self.common.frame;
            let area = Self::REST + ShapeOf::<M, T, D>::DOMAIN.numbers(D);
            for d in 0..D {
                let change = if reads.second { self.dt * increment[d] } else { nodal[d] - v[d] };
                let middle = nodal[d] - A::Batch::of(0.5) * change;
                if does.load {
                    found.flux[d] = rows.load::<A::Batch>(area).mul_add(middle, found.flux[d]);
                } else {
                    let push = *mass * rows.load(frame - D + d);
                    found.power = push.mul_add(middle, found.power);
                }
            }
        }
        if does.velocity {
            for d in 0..D {
                v[d] = self.method.transfer().velocity(v[d], nodal[d], self.dt * increment[d], self.dt);
                rows.store(Columns::velocity(D) + d, v[d]);
            }
        }
    }

    /// Strain and stress, at the old position. Lanes without a particle do not deform.
    #[inline(always)]
    pub(super) fn strain(
        &self,
        (rows, here): (&mut RowsMut<'_, T>, usize),
        bin: &Bin<'_, T, ExtentOf<M, T, D>, A::Batch>,
        stage: &mut Stage<A::Batch>,
        found: &mut Found<A::Batch>,
    ) {
        let (does, law) = (Self::DOES, self.law);
        let Stage { xi, v, mass, gradient, hoop_velocity, stress, volume, inverse, .. } = stage;
        let alive = self.alive(here);
        let step = A::Batch::select(alive, self.dt, A::Batch::zero());
        let frame = self.common.frame;
        // Deformation gradient, if mapped in the reference configuration, and its inverse.
        let mut f = Mat3::identity();
        if Self::TOTAL && (does.strain.is_some() || does.force || does.moves) {
            f = total::load::<T, A::Batch, D, M, _>(rows, frame);
            *inverse = total::inverse::<A::Batch, D>(&f);
        }
        let mut signals = None;
        if does.strain.is_some() {
            let mut deformation = *gradient * (step * self.per_spacing);
            if M::Embedding::HOOP {
                deformation.0[2][2] = step * *hoop_velocity / xi[0].mul_add(self.spacing, bin.x);
            }
            if Self::TOTAL {
                f = f + deformation;
                total::store::<T, A::Batch, D, M>(&f, rows, frame);
                deformation = total::product::<A::Batch, D>(&deformation, inverse);
                *inverse = total::inverse::<A::Batch, D>(&f);
            }
            let old = Self::state(rows);
            if M::Dilatation::MEAN
                && let Some(mean) = &bin.mean
            {
                deformation = mean.give::<T, D, M>(deformation, law.volume_ratio(&old));
            }
            let kinematics = Kinematics { increment: deformation, dt: self.dt, length: self.spacing };
            let new = law.update(&kinematics, &old);
            new.state.write(&mut rows.writer(Self::MOTION));
            *stress = new.stress;
            *volume = law.volume_ratio(&new.state) * *mass * self.per_density;
            if new.fault.any() {
                found.broken = found.broken.or(first_fault(here, new.fault));
            }
            if does.force {
                signals = Some(new.state);
            }
        } else if does.force {
            let now = Self::state(rows);
            *stress = law.stress(&now);
            *volume = law.volume_ratio(&now) * *mass * self.per_density;
            signals = Some(now);
        } else if does.moves && self.common.speeds {
            signals = Some(Self::state(rows));
        }
        if let Some(now) = signals
            && self.common.speeds
        {
            let speed = signal::<T, A::Batch, C>(law, &now, v, inverse, Self::TOTAL);
            found.rate = found.rate.max(A::Batch::select(alive, speed, A::Batch::zero()));
        }
    }

    /// Motion, and what the particles give to the nodes from where they are now. Lanes without a particle do not move.
    /// Which lanes leave the bin, and which are cut in two?
    #[inline(always)]
    pub(super) fn advance(
        &self,
        (rows, here): (&mut RowsMut<'_, T>, usize),
        bin: &Bin<'_, T, ExtentOf<M, T, D>, A::Batch>,
        stage: &mut Stage<A::Batch>,
        found: &mut Found<A::Batch>,
        (records, spread): Room<'_, T, A, ExtentOf<M, T, D>>,
    ) -> [u32; 2] {
        let (does, maps) = (Self::DOES, maps::<T, D, M, K>());
        let Stage { xi, v, mass, nodal, gradient, affine, increment, stress, volume, inverse, .. } = stage;
        let zero = A::Batch::zero();
        let alive = self.alive(here);
        let mut domain = self.domain(rows);
        let cells = A::Batch::select(alive, self.dt, zero) * self.per_spacing;
        let frame = self.common.frame;
        // Domains keep their sizes until the particles move, so that all passes of a step use the same weights.
        if Self::STRETCHES {
            let moved = Moved { xi, nodal, gradient, cells };
            moved.domain::<T, ShapeOf<M, T, D>, D>(self.method.shape(), &bin.stencil.first, &mut domain);
            for n in 0..ShapeOf::<M, T, D>::DOMAIN.numbers(D) {
                rows.store(Self::REST + n, domain[n]);
            }
        }

        // Position.
        let mut stays = !0;
        stage.staying = alive;
        if does.moves && Self::TOTAL {
            for d in 0..D {
                let moved = cells.mul_add(nodal[d], rows.load(frame + d));
                rows.store(frame + d, moved);
            }
        } else if does.moves {
            let half = A::Batch::of(0.5);
            let mut inside = <A::Batch as Lane>::Mask::splat(true);
            for d in 0..D {
                xi[d] = cells.mul_add(nodal[d], xi[d]);
                rows.store(Columns::position() + d, xi[d]);
                inside = inside & (-half).le(xi[d]) & xi[d].lt(half);
            }
            stays = A::Batch::bits(inside);
            stage.staying = alive & inside;
        }

        // Particles stretched so far that they are cut in two.
        let mut long = 0;
        if Self::SPLITS {
            let splitter = &self.common.splitter;
            let first = Self::MOTION + splitter.place;
            let mut trace = rows.load::<A::Batch>(first);
            for d in 1..D {
                trace = trace + rows.load(first + d);
            }
            // The largest principal value is at most the sum of all.
            let may = A::Batch::bits(alive & A::Batch::splat(splitter.square).le(trace));
            if may != 0 {
                let axis = M::Embedding::HOOP.then(|| bin.x.lane(0) / self.common.spacing);
                let ratio = self.law.volume_ratio(&Self::state(rows));
                for (n, group) in ratio.part().iter().enumerate().take(A::Batch::GROUPS) {
                    let mut ratio = T::Row::default();
                    group.store(&mut ratio);
                    let may = may >> (n * T::GROUP) & ((1 << T::GROUP) - 1);
                    long |= splitter.long::<D>(rows.group(n), &ratio, may, axis) << (n * T::GROUP);
                }
            }
        }

        // Particles to grid, at the new position.
        let momentum = if does.smooth { *increment } else { *v };
        let mut force_scale = *volume * self.per_spacing;
        if maps.together {
            force_scale = force_scale * A::Batch::splat(self.common.next_dt);
        }
        // In the reference configuration not symmetric.
        let carried =
            if Self::TOTAL { total::nominal::<A::Batch, D>(stress, inverse) } else { stress.to_mat() };
        let mut force = carried * -force_scale;
        if !maps.moments::<ExtentOf<M, T, D>>() {
            // Lanes without a particle have no volume; but zero times their stress need not be zero.
            for c in 0..D {
                for d in 0..D {
                    force.0[c][d] = A::Batch::select(alive, force.0[c][d], zero);
                }
            }
        }
        let mut momenta = [[zero; 3]; 3];
        for d in 0..D {
            for c in 0..D {
                if maps.affine {
                    momenta[c][d] = *mass * affine[c][d];
                }
                if maps.least_squares {
                    let per_inertia = self.method.shape().inertia(xi[d], domain[d]).recip();
                    momenta[c][d] = force.0[c][d].mul_add(per_inertia, momenta[c][d]);
                }
            }
        }
        if maps.least_squares {
            force = Mat3::zero();
        }
        let mut impulse = [*mass * momentum[0], *mass * momentum[1], *mass * momentum[2]];
        if maps.direct {
            let mut direct = [zero; 3];
            if M::Embedding::HOOP {
                // The radius of the new position, like the weights.
                let hoop = -(*volume * carried.0[2][2]) / xi[0].mul_add(self.spacing, bin.x);
                direct[0] = A::Batch::select(alive, hoop, zero);
            }
            if does.load {
                let area = rows.load::<A::Batch>(Self::REST + ShapeOf::<M, T, D>::DOMAIN.numbers(D));
                for d in 0..D {
                    direct[d] = area.mul_add(A::Batch::splat(self.common.traction[d]), direct[d]);
                }
            }
            if does.field {
                for d in 0..D {
                    let push = *mass * rows.load(frame - D + d);
                    direct[d] = direct[d] + push;
                    found.push[d] = found.push[d] + push;
                }
            }
            for d in 0..D {
                if maps.together {
                    direct[d] = direct[d] * A::Batch::splat(self.common.next_dt);
                }
                if maps.least_squares {
                    impulse[d] = impulse[d] + direct[d];
                }
            }
            A::Batch::records(zero, direct[0], direct[1], direct[2], &mut records[DIRECT]);
        }
        fill_records::<T, A, D>(records, *mass, impulse, &momenta, xi, maps);
        if maps.slopes() && !maps.moments::<ExtentOf<M, T, D>>() {
            force_records::<T, A, D>(records, &force);
        }
        let sound = spread.place(self.method.shape(), xi, &domain, maps.slopes());
        if maps.convected {
            let sound = A::Batch::bits(zero.lt(sound));
            if does.moves && !sound & ((1 << here) - 1) != 0 {
                found.broken = found.broken.or(first_inside_out(here, sound));
            }
        }
        stage.force = force;
        [if does.moves && !Self::TOTAL { !stays & ((1 << here) - 1) } else { 0 }, long]
    }

    /// The velocity gradient of the particles of a group, 1/s, D x D rows, for those that are cut in two.
    #[inline(always)]
    pub(super) fn spread_of(&self, stage: &Stage<A::Batch>) -> [NumbersOf<T, A>; 9] {
        let mut spread = [Default::default(); 9];
        if Self::SPLITS {
            for i in 0..D * D {
                (stage.gradient.0[i / D][i % D] * self.per_spacing).store(&mut spread[i]);
            }
        }
        spread
    }

    /// Put the records of forces, which go by way of moments, beside the others, for particles that leave; of those, `long`
    /// are cut in two.
    #[inline(always)]
    pub(super) fn part(stage: &mut Stage<A::Batch>, long: u32, records: &mut Records<T>) {
        if maps::<T, D, M, K>().moments::<ExtentOf<M, T, D>>() {
            force_records::<T, A, D>(records, &stage.force);
            stage.staying = stage.staying & !lanes_of::<T, A>(long);
        }
    }

    /// Particles to grid.
    #[inline(always)]
    pub(super) fn give(
        here: usize,
        corner: usize,
        stage: &mut Stage<A::Batch>,
        (records, spread): Room<'_, T, A, ExtentOf<M, T, D>>,
        moments: &mut Moments<A::Quad, ExtentOf<M, T, D>>,
        tiles: [&mut [[T; 4]]; 2],
    ) {
        let maps = maps::<T, D, M, K>();
        let by_moments = maps.moments::<ExtentOf<M, T, D>>();
        if by_moments {
            for c in 0..D {
                for d in 0..D {
                    let force = &mut stage.force.0[c][d];
                    *force = A::Batch::select(stage.staying, *force, A::Batch::zero());
                }
            }
            moments.add_group::<T, A>(&stage.xi, &stage.force);
        }
        let wide = ExtentOf::<M, T, D>::NODES > 2;
        match A::Batch::WIDTH {
            4 if here <= 2 && wide => {
                scatter::<T, A, ExtentOf<M, T, D>, 2>(tiles, corner, spread, records, maps)
            }
            4 => scatter::<T, A, ExtentOf<M, T, D>, 4>(tiles, corner, spread, records, maps),
            _ if here <= 4 && (wide || A::Batch::GROUPS > 1) => {
                scatter::<T, A, ExtentOf<M, T, D>, 4>(tiles, corner, spread, records, maps)
            }
            _ => scatter::<T, A, ExtentOf<M, T, D>, 8>(tiles, corner, spread, records, maps),
        }
    }
}

/// x of the centre of a bin of the block with the first coordinate `block`, m.
#[inline(always)]
pub(super) fn centre_x<T: Float>(common: &Common<T>, block: i32, bin: usize, centre: f64) -> T {
    let cells = f64::from(block) * BLOCK as f64 + (bin % BLOCK) as f64 + centre;
    common.origin + common.spacing * T::of(cells)
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
    mass: A::Batch,
    mut p: [A::Batch; 3],
    affine: &[[A::Batch; 3]; 3],
    xi: &[A::Batch; 3],
    maps: Maps,
) {
    let zero = A::Batch::zero();
    if maps.momentum {
        if maps.has_affine() {
            for d in 0..D {
                for c in 0..D {
                    p[c] = (-affine[c][d]).mul_add(xi[d], p[c]);
                }
                let a = [affine[0][d], affine[1][d], affine[2][d]];
                A::Batch::records(zero, a[0], a[1], a[2], &mut records[AFFINE + d]);
            }
        }
        A::Batch::records(mass, p[0], p[1], p[2], &mut records[MOMENTUM]);
    }
}

/// The records of the forces of a group.
#[inline(always)]
fn force_records<T: Float, A: Arch<T>, const D: usize>(records: &mut Records<T>, force: &Mat3<A::Batch>) {
    let zero = A::Batch::zero();
    for d in 0..D {
        let third = if D == 3 { force.0[2][d] } else { zero };
        A::Batch::records(zero, force.0[0][d], force.0[1][d], third, &mut records[FORCE + d]);
    }
}

/// The lanes of set bits.
#[inline(always)]
fn lanes_of<T: Float, A: Arch<T>>(bits: u32) -> <A::Batch as Lane>::Mask {
    let mut set = A::Batch::zero();
    for lane in 0..A::Batch::WIDTH {
        set = set.with_lane(lane, T::of(f64::from(bits >> lane & 1)));
    }
    A::Batch::zero().lt(set)
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

/// The first of the particles whose domain is turned inside out.
#[cold]
fn first_inside_out(here: usize, sound: u32) -> Option<(usize, Cause)> {
    (0..here).find(|lane| sound >> lane & 1 == 0).map(|lane| (lane, Cause::InsideOut))
}

/// The first of the particles whose law broke down.
#[cold]
fn first_fault<T: Float, L: Lane<Real = T>>(here: usize, fault: Fault<L>) -> Option<(usize, Cause)> {
    (0..here).find_map(|lane| Some((lane, Cause::Law(fault.cause(lane)?))))
}
