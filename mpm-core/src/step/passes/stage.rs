//! Stages of a pass for a group of lanes: gather from the grid, strain, motion, and scatter to the grid. The law is called
//! between strain and motion ([`super::sweep`]).

use std::marker::PhantomData;

use mpm_materials::{Lane, Mask, Mat3, Sym3};

use super::cell::{Moments, from_cell};
use super::convect::Moved;
use super::gather::{Sampler, Wanted, gather_on, sampler_of};
use super::rows::RowsMut;
use super::scatter::scatter;
use super::slot::Common;
use super::spec::{ExtentOf, Spec};
use super::spread::on_cell;
use super::spread::{
    DIRECT, MAX_LANES, Maps, Records, Room, SpreadOf, along_axes, fill_records, force_records,
};
use super::tile::{Reads, Stencilled};
use super::total;
use crate::dim::{Array, BLOCK, Stencil};
use crate::particles::Columns;
use crate::scheme::{Nodal, Pass};
use crate::shape::ShapeFunction;
use crate::shape::domain::MOST_NUMBERS;
use crate::transfer::Transfer;
use impactite_scene::Cause;
use impactite_simd::{Arch, Float, Pack, apart, lane_numbers};

/// Particle data of a group, passed between the stages of a pass.
#[derive(Clone, Copy)]
pub(in crate::step) struct Stage<P: Lane> {
    /// Position, in cells from the bin's centre.
    pub(in crate::step) xi: [P; 3],
    /// Velocity, m/s.
    pub(in crate::step) v: [P; 3],
    pub(in crate::step) mass: P,
    /// First nodal vector at the particles.
    pub(in crate::step) nodal: [P; 3],
    /// Second nodal vector at the particles.
    increment: [P; 3],
    /// Velocity gradient of the strain increment.
    gradient: Mat3<P>,
    /// Affine fit of the first nodal vector.
    pub(in crate::step) affine: [[P; 3]; 3],
    /// Radial velocity of the hoop strain increment.
    hoop_velocity: P,
    stress: Sym3<P>,
    /// Volume of the particles, m^3.
    volume: P,
    /// Inverse of the deformation gradient, for mapping in the reference configuration.
    inverse: Mat3<P>,
    /// G_d of [`super::scatter`], column by column.
    force: Mat3<P>,
    /// Lanes with a particle.
    alive: P::Mask,
    /// Particles that stay in their bin.
    staying: P::Mask,
}

impl<P: Lane> Stage<P> {
    #[inline(always)]
    pub(in crate::step) fn zero() -> Self {
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
            alive: P::Mask::splat(true),
            staying: P::Mask::splat(true),
        }
    }
}

/// Bin of the groups.
pub(in crate::step) struct Bin<'a, T: Float, E: Stencil, P> {
    /// Nodal records of the stencil, for a gather.
    pub(in crate::step) stencil: &'a Stencilled<T, E>,
    /// Nodal records without conversion to coefficients, first and second, in tile order.
    pub(in crate::step) nodes: [&'a [[T; 4]]; 2],
    /// x of the bin's centre, m, for the distance to the axis of revolution.
    pub(in crate::step) x: P,
}

/// Sums and maxima over the groups of a block, other than nodal sums.
#[derive(Clone, Copy)]
pub(in crate::step) struct Found<P> {
    /// Largest signal speed, m/s.
    pub(in crate::step) rate: P,
    /// Mass, kg, and momentum, kg m/s, of particles that moved.
    pub(in crate::step) moments: [P; 4],
    /// Lane and cause of the first error in the current groups.
    pub(in crate::step) broken: Option<(usize, Cause)>,
}

impl<P: Lane> Found<P> {
    #[inline(always)]
    pub(in crate::step) fn none() -> Self {
        Found { rate: P::zero(), moments: [P::zero(); 4], broken: None }
    }
}

/// Stages of the pass `P`, with the parameters that all groups of a block share.
pub(in crate::step) struct Stages<'a, T: Float, const D: usize, P: Spec<T, D>, A: Arch<T>> {
    shape: &'a P::Shape,
    transfer: &'a P::Transfer,
    common: &'a Common<T>,
    dt: A::Batch,
    spacing: A::Batch,
    per_spacing: A::Batch,
    per_density: A::Batch,
    /// Lane indices 0, 1, 2 ...
    lane_index: A::Batch,
    pass: PhantomData<P>,
}

impl<'a, T, const D: usize, P, A> Stages<'a, T, D, P, A>
where
    T: Float,
    P: Spec<T, D>,
    A: Arch<T>,
{
    const DOES: Pass = P::DOES;
    const MAPS: Maps = P::MAPS;
    const STRAIN_FIRST: bool = matches!(P::DOES.strain, Some(Nodal::First));
    const STRAIN_SECOND: bool = matches!(P::DOES.strain, Some(Nodal::Second));
    /// True if domains follow the motion.
    const STRETCHES: bool = P::Shape::DOMAIN.carried() && P::DOES.moves;
    /// True if the velocity gradient is needed only to split particles that are stretched too far.
    const MAY_SPLIT: bool = P::DOES.moves && P::DOES.velocity && P::DOES.strain.is_none() && !P::TOTAL;
    const SLOPES_FIRST: bool =
        Self::STRAIN_FIRST || Self::MAY_SPLIT || (Self::STRETCHES && P::DOES.strain.is_none());
    /// Nodal vectors that the pass reads.
    pub(in crate::step) const READS: Reads = Reads {
        first: (P::DOES.velocity && P::Transfer::READS_VELOCITY) || P::DOES.moves || Self::STRAIN_FIRST,
        second: (P::DOES.velocity && P::Transfer::READS_INCREMENT) || Self::STRAIN_SECOND || P::DOES.smooth,
    };
    /// Nodal vectors that are converted to coefficients. With one or two vectors of particles per bin, nodal sums take
    /// fewer operations if only values are needed.
    pub(in crate::step) const BY_COEFFICIENTS: Reads = Reads {
        first: Self::READS.first && !(Self::SUMS_NODES && !Self::SLOPES_FIRST && !P::Transfer::AFFINE),
        second: Self::READS.second && !(Self::SUMS_NODES && !Self::STRAIN_SECOND),
    };
    const SUMS_NODES: bool =
        A::Batch::WIDTH == 8 && ExtentOf::<P, T, D>::NODES == 2 && !P::Shape::DOMAIN.convects();

    #[inline(always)]
    pub(in crate::step) fn new(
        shape: &'a P::Shape,
        transfer: &'a P::Transfer,
        common: &'a Common<T>,
    ) -> Self {
        let spacing = A::Batch::splat(common.spacing);
        Stages {
            shape,
            transfer,
            common,
            dt: A::Batch::splat(common.dt),
            spacing,
            per_spacing: spacing.recip(),
            per_density: A::Batch::splat(common.density).recip(),
            lane_index: lane_numbers::<T, A::Batch>(),
            pass: PhantomData,
        }
    }

    /// Time step and cell size, for laws.
    #[inline(always)]
    pub(in crate::step) fn step(&self) -> [A::Batch; 2] {
        [self.dt, self.spacing]
    }

    /// Return the mask of lanes with a particle.
    #[inline(always)]
    fn alive(&self, here: usize) -> <A::Batch as Lane>::Mask {
        self.lane_index.lt(A::Batch::of(here as f64))
    }

    /// Load the domains of the particles of a group.
    #[inline(always)]
    fn domain(&self, rows: &RowsMut<'_, T>) -> [A::Batch; MOST_NUMBERS] {
        let domains = &self.common.domains;
        domains.of::<A::Batch, P::Shape, D>(|n: usize| rows.load(domains.column + n))
    }

    /// True if the affine fit of the velocity, times the time step, is the strain increment of laws.
    pub(in crate::step) const SHARES: bool =
        P::DOES.strain.is_some() && P::MAPS.affine && P::Transfer::LEAST_SQUARES && !P::HOOP && !P::TOTAL;

    /// Load the rows that all stages of a pass need.
    #[inline(always)]
    pub(in crate::step) fn load(&self, (rows, here): (&RowsMut<'_, T>, usize), stage: &mut Stage<A::Batch>) {
        for d in 0..D {
            stage.xi[d] = rows.load(Columns::position() + d);
            stage.v[d] = rows.load(Columns::velocity(D) + d);
        }
        stage.alive = self.alive(here);
        stage.mass = self.common.masses.of_group(stage.alive, |row| rows.load(row));
    }

    /// Gather from the grid to the particles.
    #[inline(always)]
    pub(in crate::step) fn gather(
        &self,
        (rows, here): (&mut RowsMut<'_, T>, usize),
        bin: &Bin<'_, T, ExtentOf<P, T, D>, A::Batch>,
        stage: &mut Stage<A::Batch>,
    ) {
        let (does, reads, maps) = (Self::DOES, Self::READS, Self::MAPS);
        self.load((rows, here), stage);
        let Stage { xi, v, nodal, gradient, affine, increment, hoop_velocity, .. } = stage;
        let mut sampler = Sampler::<A::Batch, ExtentOf<P, T, D>>::zero();
        let by_coefficients = Self::BY_COEFFICIENTS;
        let mut weights = <ExtentOf<P, T, D> as Stencil>::Nodes::<A::Batch>::filled(A::Batch::zero());
        if Self::SUMS_NODES {
            let along = along_axes(self.shape, xi, &self.domain(rows));
            weights = on_cell::<A::Batch, ExtentOf<P, T, D>>(&along);
        }
        if by_coefficients.first || by_coefficients.second {
            sampler = sampler_of::<T, D, A, P::Shape>(self.shape, xi, &self.domain(rows), maps.affine);
        }
        // First nodal vector (velocity), with gradient and fit as needed. In the moving-least-squares form the gradient is
        // the affine fit.
        if reads.first && !by_coefficients.first {
            for c in 0..D {
                nodal[c] = from_cell::<T, A::Batch, ExtentOf<P, T, D>>(&weights, bin.nodes[0], c);
            }
            *hoop_velocity = nodal[0];
        } else if reads.first {
            let slope = Self::SLOPES_FIRST && !P::Transfer::LEAST_SQUARES;
            let wanted = Wanted { slope, fit: maps.affine };
            for c in 0..D {
                let found = gather_on::<T, D, A, P::Shape>(&sampler, &bin.stencil.first, c, wanted);
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
                increment[c] = from_cell::<T, A::Batch, ExtentOf<P, T, D>>(&weights, bin.nodes[1], c);
            }
        } else if reads.second {
            let wanted = Wanted { slope: Self::STRAIN_SECOND, fit: false };
            for c in 0..D {
                let found = gather_on::<T, D, A, P::Shape>(&sampler, &bin.stencil.second, c, wanted);
                increment[c] = found.value;
                if Self::STRAIN_SECOND {
                    gradient.0[c] = found.slope;
                }
            }
            if Self::STRAIN_SECOND {
                *hoop_velocity = increment[0];
            }
        }
        if does.velocity {
            for d in 0..D {
                v[d] = self.transfer.velocity(v[d], nodal[d], self.dt * increment[d], self.dt);
                rows.store(Columns::velocity(D) + d, v[d]);
            }
        }
    }

    /// Compute the strain of particles at their old positions: the velocity gradient, and the factor that makes it the
    /// increment dt grad v for the law. Lanes without a particle do not deform.
    #[inline(always)]
    pub(in crate::step) fn strain(
        &self,
        rows: &mut RowsMut<'_, T>,
        bin: &Bin<'_, T, ExtentOf<P, T, D>, A::Batch>,
        stage: &Stage<A::Batch>,
    ) -> (Mat3<A::Batch>, A::Batch) {
        let step = self.cells(stage);
        let mut gradient = stage.gradient;
        if P::HOOP {
            gradient.0[2][2] = stage.hoop_velocity * self.spacing / stage.xi[0].mul_add(self.spacing, bin.x);
        }
        if P::TOTAL {
            let frame = self.common.frame;
            let f = total::load::<T, A::Batch, D, _>(rows, frame, P::HOOP);
            let inverse = total::inverse::<A::Batch, D>(&f);
            total::store::<T, A::Batch, D>(&(f + gradient * step), rows, frame, P::HOOP);
            gradient = total::product::<A::Batch, D>(&gradient, &inverse);
        }
        (gradient, step)
    }

    /// Return time step over cell size, s/m; zero in lanes without a particle.
    #[inline(always)]
    fn cells(&self, stage: &Stage<A::Batch>) -> A::Batch {
        A::Batch::select(stage.alive, self.dt * self.per_spacing, A::Batch::zero())
    }

    /// Update domains with the motion. They keep their sizes until the particles move, so that all passes of a step use the
    /// same weights.
    #[inline(always)]
    pub(in crate::step) fn stretch(
        &self,
        rows: &mut RowsMut<'_, T>,
        bin: &Bin<'_, T, ExtentOf<P, T, D>, A::Batch>,
        stage: &Stage<A::Batch>,
    ) {
        if !Self::STRETCHES {
            return;
        }
        let Stage { xi, nodal, gradient, .. } = stage;
        let cells = self.cells(stage);
        let mut domain = self.domain(rows);
        let moved = Moved { xi, nodal, gradient, cells };
        moved.domain::<T, P::Shape, D>(self.shape, &bin.stencil.first, &mut domain);
        for n in 0..P::Shape::DOMAIN.numbers(D) {
            rows.store(self.common.domains.column + n, domain[n]);
        }
    }

    /// Store the response of the law: stress, volume ratio and, if requested, wave speed.
    #[inline(always)]
    pub(in crate::step) fn respond(
        &self,
        rows: &RowsMut<'_, T>,
        stage: &mut Stage<A::Batch>,
        (stress, ratio, speed): (Sym3<A::Batch>, A::Batch, A::Batch),
        found: &mut Found<A::Batch>,
    ) {
        stage.stress = stress;
        stage.volume = ratio * stage.mass * self.per_density;
        if P::TOTAL {
            let f = total::load::<T, A::Batch, D, _>(rows, self.common.frame, P::HOOP);
            stage.inverse = total::inverse::<A::Batch, D>(&f);
        }
        if self.common.speeds {
            // Signal speed over the cells: past a particle, or through the reference configuration.
            let signal =
                if P::TOTAL { speed * total::stretch(&stage.inverse) } else { speed + length(&stage.v) };
            found.rate = found.rate.max(A::Batch::select(stage.alive, signal, A::Batch::zero()));
        }
    }

    /// Update positions. Lanes without a particle do not move.
    #[inline(always)]
    pub(in crate::step) fn drift(&self, rows: &mut RowsMut<'_, T>, stage: &mut Stage<A::Batch>) {
        if !Self::DOES.moves {
            return;
        }
        let cells = self.cells(stage);
        let frame = self.common.frame;
        for d in 0..D {
            if P::TOTAL {
                let moved = cells.mul_add(stage.nodal[d], rows.load(frame + d));
                rows.store(frame + d, moved);
            } else {
                stage.xi[d] = cells.mul_add(stage.nodal[d], stage.xi[d]);
                rows.store(Columns::position() + d, stage.xi[d]);
            }
        }
    }

    /// Compute records and weights of the particles at their new positions. Returns the lanes that left the bin.
    #[inline(always)]
    pub(in crate::step) fn advance(
        &self,
        (rows, here): (&RowsMut<'_, T>, usize),
        bin_x: A::Batch,
        stage: &mut Stage<A::Batch>,
        found: &mut Found<A::Batch>,
        (records, spread): Room<'_, T, A, ExtentOf<P, T, D>>,
    ) -> u32 {
        let (does, maps) = (Self::DOES, Self::MAPS);
        let alive = stage.alive;
        let Stage { xi, v, mass, affine, increment, stress, volume, inverse, .. } = stage;
        let zero = A::Batch::zero();
        let domain = self.domain(rows);
        let mut stays = !0;
        stage.staying = alive;
        if does.moves {
            found.moments[0] = found.moments[0] + A::Batch::select(alive, *mass, zero);
            for d in 0..D {
                let momentum = A::Batch::select(alive, *mass * v[d], zero);
                found.moments[d + 1] = found.moments[d + 1] + momentum;
            }
        }
        if does.moves && !P::TOTAL {
            let half = A::Batch::of(0.5);
            let mut inside = <A::Batch as Lane>::Mask::splat(true);
            for d in 0..D {
                inside = inside & (-half).le(xi[d]) & xi[d].lt(half);
            }
            stays = A::Batch::bits(inside);
            stage.staying = alive & inside;
        }
        if does.moves && !does.velocity && !does.has_law() && self.common.speeds {
            found.rate = found.rate.max(A::Batch::select(alive, length(v), zero));
        }

        // Scatter to the grid, from the new position.
        let momentum = if does.smooth { *increment } else { *v };
        let mut force_scale = *volume * self.per_spacing;
        if maps.together {
            force_scale = force_scale * A::Batch::splat(self.common.next_dt);
        }
        // Not symmetric in the reference configuration.
        let carried = if P::TOTAL { total::nominal::<A::Batch, D>(stress, inverse) } else { stress.to_mat() };
        let mut force = carried * -force_scale;
        if !maps.moments::<ExtentOf<P, T, D>>() {
            // Lanes without a particle have no volume, but zero times their stress may be NaN.
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
                    let per_inertia = self.shape.inertia(xi[d], domain[d]).recip();
                    momenta[c][d] = force.0[c][d].mul_add(per_inertia, momenta[c][d]);
                }
            }
        }
        if maps.least_squares {
            force = Mat3::zero();
        }
        let mut impulse = [*mass * momentum[0], *mass * momentum[1], *mass * momentum[2]];
        if maps.direct {
            // Hoop stress, at the radius of the new position, like the weights.
            let hoop = -(*volume * carried.0[2][2]) / xi[0].mul_add(self.spacing, bin_x);
            let mut direct = A::Batch::select(alive, hoop, zero);
            if maps.together {
                direct = direct * A::Batch::splat(self.common.next_dt);
            }
            if maps.least_squares {
                impulse[0] = impulse[0] + direct;
            }
            A::Batch::records(zero, direct, zero, zero, &mut records[DIRECT]);
        }
        fill_records::<T, A, D>(records, *mass, impulse, &momenta, xi, maps);
        if maps.slopes() && !maps.moments::<ExtentOf<P, T, D>>() {
            force_records::<T, A, D>(records, &force);
        }
        let sound = place::<T, D, A, P::Shape>(spread, self.shape, xi, &domain, maps.slopes());
        if maps.convected {
            let sound = A::Batch::bits(zero.lt(sound));
            if does.moves && !sound & ((1 << here) - 1) != 0 {
                found.broken = found.broken.or(first_inside_out(here, sound));
            }
        }
        stage.force = force;
        if does.moves && !P::TOTAL { !stays & ((1 << here) - 1) } else { 0 }
    }

    /// Store the velocity gradient of the particles of a group, 1/s, D x D numbers each, for those to be split.
    #[inline(always)]
    pub(in crate::step) fn spread_of(&self, stage: &Stage<A::Batch>, spread: &mut [[T; MAX_LANES]; 9]) {
        for i in 0..D * D {
            let rate = stage.gradient.0[i / D][i % D] * self.per_spacing;
            for lane in 0..A::Batch::WIDTH {
                spread[i][lane] = rate.lane(lane);
            }
        }
    }

    /// Store the records of forces, which are summed by moments, for particles that leave; those in the lanes `long` are
    /// split and excluded from the moments.
    #[inline(always)]
    pub(in crate::step) fn part(stage: &mut Stage<A::Batch>, long: u32, records: &mut Records<T>) {
        if Self::MAPS.moments::<ExtentOf<P, T, D>>() {
            force_records::<T, A, D>(records, &stage.force);
            stage.staying = stage.staying & !lanes_of::<T, A>(long);
        }
    }

    /// Scatter from the particles to the grid.
    #[inline(always)]
    pub(in crate::step) fn give(
        here: usize,
        corner: usize,
        stage: &mut Stage<A::Batch>,
        (records, spread): Room<'_, T, A, ExtentOf<P, T, D>>,
        moments: &mut Moments<A::Quad, ExtentOf<P, T, D>>,
        tiles: [&mut [[T; 4]]; 2],
    ) {
        let maps = Self::MAPS;
        if maps.moments::<ExtentOf<P, T, D>>() {
            for c in 0..D {
                for d in 0..D {
                    let force = &mut stage.force.0[c][d];
                    *force = A::Batch::select(stage.staying, *force, A::Batch::zero());
                }
            }
            add_group::<T, A, ExtentOf<P, T, D>>(moments, &stage.xi, &stage.force);
        }
        let wide = ExtentOf::<P, T, D>::NODES > 2;
        match A::Batch::WIDTH {
            1 => scatter::<T, A, ExtentOf<P, T, D>, 1>(tiles, corner, spread, records, maps),
            4 if here <= 2 && wide => {
                scatter::<T, A, ExtentOf<P, T, D>, 2>(tiles, corner, spread, records, maps)
            }
            4 => scatter::<T, A, ExtentOf<P, T, D>, 4>(tiles, corner, spread, records, maps),
            _ if here <= 4 && (wide || A::Batch::GROUPS > 1) => {
                scatter::<T, A, ExtentOf<P, T, D>, 4>(tiles, corner, spread, records, maps)
            }
            _ => scatter::<T, A, ExtentOf<P, T, D>, 8>(tiles, corner, spread, records, maps),
        }
    }
}

/// Return x of the centre of a bin, m, in the block with the first coordinate `block`.
#[inline(always)]
pub(in crate::step) fn centre_x<T: Float>(common: &Common<T>, block: i32, bin: usize, centre: f64) -> T {
    let cells = f64::from(block) * BLOCK as f64 + (bin % BLOCK) as f64 + centre;
    common.origin + common.spacing * T::of(cells)
}

/// Call [`super::spread::Spread::place`].
#[inline(always)]
fn place<T: Float, const D: usize, A: Arch<T>, S: ShapeFunction<T, D>>(
    spread: &mut SpreadOf<T, A, S::Extent>,
    shape: &S,
    xi: &[A::Batch; 3],
    domain: &[A::Batch; MOST_NUMBERS],
    force: bool,
) -> A::Batch {
    if A::APART {
        return apart(|| spread.place(shape, xi, domain, force));
    }
    spread.place(shape, xi, domain, force)
}

/// Call [`Moments::add_group`].
#[inline(always)]
fn add_group<T: Float, A: Arch<T>, E: Stencil>(
    moments: &mut Moments<A::Quad, E>,
    xi: &[A::Batch; 3],
    force: &Mat3<A::Batch>,
) {
    if A::APART {
        return apart(|| moments.add_group::<T, A>(xi, force));
    }
    moments.add_group::<T, A>(xi, force);
}

/// Call [`Moments::give`].
#[inline(always)]
pub(in crate::step) fn give_moments<T: Float, A: Arch<T>, E: Stencil>(
    moments: &Moments<A::Quad, E>,
    nodes: &mut [[T; 4]],
    corner: usize,
) {
    if A::APART {
        return apart(|| moments.give::<T>(nodes, corner));
    }
    moments.give::<T>(nodes, corner);
}

/// Return the length of a vector.
#[inline(always)]
fn length<P: Lane>(v: &[P; 3]) -> P {
    v[0].mul_add(v[0], v[1].mul_add(v[1], v[2] * v[2])).sqrt()
}

/// Return the mask of the lanes of set bits.
#[inline(always)]
fn lanes_of<T: Float, A: Arch<T>>(bits: u32) -> <A::Batch as Lane>::Mask {
    let mut set = A::Batch::zero();
    for lane in 0..A::Batch::WIDTH {
        set = set.with_lane(lane, T::of(f64::from(bits >> lane & 1)));
    }
    A::Batch::zero().lt(set)
}

/// Return the first of the particles whose domain is inverted.
#[cold]
fn first_inside_out(here: usize, sound: u32) -> Option<(usize, Cause)> {
    (0..here).find(|lane| sound >> lane & 1 == 0).map(|lane| (lane, Cause::InsideOut))
}
