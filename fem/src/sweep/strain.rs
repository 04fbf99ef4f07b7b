//! Kernel of strains and hourglass control.

use std::marker::PhantomData;

use impactite_simd::{Arch, Kernel, Pack, Vectors};
use mpm_materials::material::Deformation;
use mpm_materials::{Lane, Mask, Mat3, with_volume};

use super::batch::{Batch, GROUP, Nodes, OCTET, Row, Rows};
use super::kernels::{from_middle, gather, load, mean_of, place, reference, turned};
use super::rule::{Rule, Solid};
use super::work::Of;
use crate::shape::{Gradient, Modes, Shape};

/// Output of [`Strain`].
pub(super) struct Strained<'a> {
    pub modes: &'a mut [Rows],
    pub deformations: &'a mut [Deformation<Row>],
    pub lengths: &'a mut [Row],
    pub closing: &'a mut [Rows],
    pub kept: &'a mut [Rows],
}

/// Kernel of strains, and of forces of hourglass control.
pub(super) struct Strain<'a, S, R, const HOOP: bool> {
    pub of: &'a Of<'a>,
    pub corners: &'a [u16],
    pub sizes: &'a [[Rows; 2]],
    pub reference: &'a [Rows],
    pub moving: &'a Nodes,
    pub out: Strained<'a>,
    pub kind: PhantomData<(S, R)>,
}

impl<S: Shape, R: Rule, const HOOP: bool> Kernel<f64> for Strain<'_, S, R, HOOP> {
    const VECTORS: Vectors = Vectors::Avx512;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(mut self) {
        let (mut at, mut rate) = ([[Rows::default(); 3]; 8], [[Rows::default(); 3]; 8]);
        let points = Solid::<S, R, HOOP>::POINTS;
        for octet in 0..self.sizes.len() {
            let corners = &self.corners[octet * S::NODES * OCTET..][..S::NODES * OCTET];
            gather(corners, self.moving, (S::NODES, S::DIM), &mut at, Some(&mut rate));
            let averages =
                if R::AVERAGED { mean_of(corners, self.moving, S::NODES) } else { Rows::default() };
            for point in 0..points {
                let first = (octet * points + point) * 2;
                self.out.lengths[first..first + 2].copy_from_slice(&self.sizes[octet][0].0);
            }
            for vector in 0..OCTET / A::Batch::WIDTH {
                let place = place::<A::Batch>(vector);
                let now = S::modes(&load::<A::Batch>(&at, place, S::NODES, S::DIM));
                let velocity = S::modes(&load::<A::Batch>(&rate, place, S::NODES, S::DIM));
                self.lanes::<A::Batch>(octet, place, &now, &velocity, &averages);
            }
        }
    }
}

impl<S: Shape, R: Rule, const HOOP: bool> Strain<'_, S, R, HOOP> {
    #[inline(always)]
    fn lanes<P: Pack<f64>>(
        &mut self,
        octet: usize,
        (half, lane): (usize, usize),
        now: &Modes<P>,
        velocity: &Modes<P>,
        averages: &Rows,
    ) {
        let points = Solid::<S, R, HOOP>::POINTS;
        let (dt, back) = (P::splat(self.of.dt), P::of(-0.5));
        let (mut step, mut middle) = (*now, *now);
        for m in 0..S::NODES {
            for d in 0..S::DIM {
                now[m][d].to_pair(&mut self.out.modes[octet * 24 + m * 3 + d], half, lane);
                step[m][d] = velocity[m][d] * dt;
                middle[m][d] = step[m][d].mul_add(back, now[m][d]);
            }
        }
        let alive = reference::<P>(self.reference, octet * points, half, lane).gt(P::zero());
        let mut gradients = [Mat3::<P>::zero(); 8];
        let (mut weights, mut sum, mut whole) = ([P::zero(); 8], P::zero(), P::zero());
        for point in 0..points {
            let g = Solid::<S, R, HOOP>::gradient(&middle, point);
            let per = g.volume.recip();
            let a = &mut gradients[point];
            for m in 1..S::NODES {
                for i in 0..S::DIM {
                    for j in 0..S::DIM {
                        a.0[i][j] = step[m][i].mul_add(g.area[m][j], a.0[i][j]);
                    }
                }
            }
            if HOOP {
                for m in 0..S::NODES {
                    a.0[2][2] = step[m][0].mul_add(g.hoop[m], a.0[2][2]);
                }
            }
            *a = *a * per;
            if R::DILATATION {
                weights[point] = a.trace();
                sum = weights[point].mul_add(g.volume, sum);
                whole = whole + g.volume;
            }
            if R::CONTROL {
                self.control(octet, (half, lane), &g, a, &step, &middle, alive);
            }
        }
        let mean = if R::DILATATION { sum / whole } else { P::zero() };
        for point in 0..points {
            let a = &mut gradients[point];
            if R::DILATATION {
                let more = (mean - weights[point]) * P::of(1.0 / 3.0);
                for i in 0..3 {
                    a.0[i][i] = a.0[i][i] + more;
                }
            }
            let mut x = from_middle(a, S::DIM);
            let mut closing = -a.trace();
            if R::AVERAGED {
                let change = P::select(alive, P::from_pair(averages, half, lane), P::zero());
                let half_way = change * P::of(0.5);
                x = with_volume(&x, (P::one() + half_way) / (P::one() - half_way));
                closing = -change;
            }
            let place = octet * points + point;
            let to = &mut self.out.deformations[place];
            P::one().to_pair(&mut to.step, half, lane);
            for i in 0..3 {
                for j in 0..3 {
                    let x = P::select(alive, x.0[i][j], P::zero());
                    x.to_pair(&mut to.gradient[3 * i + j], half, lane);
                }
            }
            let closing = closing.max(P::zero()) / dt;
            P::select(alive, closing, P::zero()).to_pair(&mut self.out.closing[place], half, lane);
        }
    }

    /// Hourglass control by springs or dashpots: q = u_alpha - A x_alpha of the step's displacement u, which is zero for any linear motion.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn control<P: Pack<f64>>(
        &mut self,
        octet: usize,
        (half, lane): (usize, usize),
        g: &Gradient<P>,
        a: &Mat3<P>,
        step: &Modes<P>,
        middle: &Modes<P>,
        alive: P::Mask,
    ) {
        let kept = &mut self.out.kept[octet * Solid::<S, R, HOOP>::KEPT..][..Solid::<S, R, HOOP>::KEPT];
        let squares = squares::<S, P>(g);
        let [springs, dashpots] = self.of.control;
        let (mut stiffness, mut keep) = (P::splat(springs * S::SCALE) * squares / g.volume, P::one());
        if dashpots > 0.0 {
            let volume = reference::<P>(self.reference, octet, half, lane);
            let root = (squares * P::of(1.0 / S::NODES as f64)).sqrt();
            stiffness = P::splat(dashpots / (self.of.dt * S::UNIT)) * volume * root / g.volume;
            keep = P::zero();
        }
        let count = S::NODES - S::FIRST;
        let mut forces = [[P::zero(); 3]; 4];
        for k in 0..count {
            for d in 0..S::DIM {
                forces[k][d] = P::from_pair(&kept[k * S::DIM + d], half, lane);
            }
        }
        turned(a, &mut forces[..count], S::DIM);
        let mut worked = P::zero();
        for k in 0..count {
            let m = S::FIRST + k;
            for i in 0..S::DIM {
                let mut q = step[m][i];
                for j in 0..S::DIM {
                    q = (-a.0[i][j]).mul_add(middle[m][j], q);
                }
                let new = stiffness.mul_add(q, forces[k][i] * keep);
                worked = (new + forces[k][i]).mul_add(q, worked);
                P::select(alive, new, P::zero()).to_pair(&mut kept[k * S::DIM + i], half, lane);
            }
        }
        let energy = &mut kept[Solid::<S, R, HOOP>::KEPT - 1];
        let sum = worked.mul_add(P::of(0.5), P::from_pair(energy, half, lane));
        P::select(alive, sum, P::zero()).to_pair(energy, half, lane);
    }
}

/// Kernel that finds elements with a collapsed integration point at the end of the step, for erosion before the law is evaluated.
pub(super) struct Check<'a, S, R, const HOOP: bool> {
    pub least: f64,
    pub batch: &'a Batch,
    pub moving: &'a Nodes,
    pub low: &'a mut [u32],
    pub kind: PhantomData<(S, R)>,
}

impl<S: Shape, R: Rule, const HOOP: bool> Kernel<f64> for Check<'_, S, R, HOOP> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Check { least, batch, moving, low, .. } = self;
        let points = Solid::<S, R, HOOP>::POINTS;
        let mut at = [[Rows::default(); 3]; 8];
        for octet in 0..batch.octets() {
            let corners = &batch.corners[octet * S::NODES * OCTET..][..S::NODES * OCTET];
            gather(corners, moving, (S::NODES, S::DIM), &mut at, None);
            for vector in 0..OCTET / A::Batch::WIDTH {
                let (half, lane) = place::<A::Batch>(vector);
                let now = S::modes(&load::<A::Batch>(&at, (half, lane), S::NODES, S::DIM));
                let mut mask = <A::Batch as Lane>::Mask::splat(false);
                for point in 0..points {
                    let volume = Solid::<S, R, HOOP>::gradient(&now, point).volume;
                    // NaN counts as collapsed.
                    let rest = reference::<A::Batch>(&batch.reference, octet * points + point, half, lane);
                    mask = mask | !volume.gt(rest * A::Batch::of(least / S::SCALE));
                }
                let rest = reference::<A::Batch>(&batch.reference, octet * points, half, lane);
                let mask = mask & rest.gt(A::Batch::zero());
                low[octet] |= A::Batch::bits(mask) << (half * GROUP + lane);
            }
        }
    }
}

/// Sum of the squared gradients of the modes, times the squared volume.
#[inline(always)]
fn squares<S: Shape, P: Lane>(g: &Gradient<P>) -> P {
    let mut sum = P::zero();
    for m in 1..S::NODES {
        for d in 0..S::DIM {
            sum = g.area[m][d].mul_add(g.area[m][d], sum);
        }
    }
    sum
}
