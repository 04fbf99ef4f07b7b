//! Kernel of internal forces, and of bounds of the highest frequencies.

use std::marker::PhantomData;

use impactite_simd::{Arch, Kernel, Pack, Vectors};
use mpm_materials::material::Response;
use mpm_materials::{Lane, Mask, Sym3};

use super::batch::{Batch, GROUP, OCTET, Record, Rows};
use super::kernels::{place, reference, scatter, stress_of};
use super::rule::{Rule, Solid};
use super::work::Of;
use crate::shape::{Gradient, Modes, Shape};

/// Kernel of internal forces at the corners, and of bounds of the highest frequencies. Returns half the largest bound.
pub(super) struct Give<'a, S, R, const HOOP: bool> {
    pub of: &'a Of<'a>,
    pub batch: &'a Batch,
    pub modes: &'a [Rows],
    pub closing: &'a [Rows],
    pub averages: &'a [Rows],
    pub response: &'a Response<f64>,
    pub out: Given<'a>,
    pub kind: PhantomData<(S, R)>,
}

/// Output of [`Give`].
pub(super) struct Given<'a> {
    pub rates: &'a mut [Rows],
    /// Bit set of inverted elements.
    pub low: &'a mut [u32],
    pub slots: &'a mut [Record],
}

impl<S: Shape, R: Rule, const HOOP: bool> Kernel<f64> for Give<'_, S, R, HOOP> {
    const VECTORS: Vectors = Vectors::Avx512;
    type Output = f64;

    #[inline(always)]
    fn run<A: Arch<f64>>(mut self) -> f64 {
        let mut fastest = A::Batch::zero();
        for octet in 0..self.batch.octets() {
            for vector in 0..OCTET / A::Batch::WIDTH {
                fastest = fastest.max(self.lanes::<A::Batch>(octet, place::<A::Batch>(vector)));
            }
        }
        let mut most: f64 = 0.0;
        for k in 0..A::Batch::WIDTH {
            most = most.max(fastest.lane(k));
        }
        most
    }
}

impl<S: Shape, R: Rule, const HOOP: bool> Give<'_, S, R, HOOP> {
    #[inline(always)]
    fn lanes<P: Pack<f64>>(&mut self, octet: usize, (half, lane): (usize, usize)) -> P {
        let points = Solid::<S, R, HOOP>::POINTS;
        let corners = &self.batch.corners[octet * S::NODES * OCTET..][..S::NODES * OCTET];
        let mut x = [[P::zero(); 3]; 8];
        for m in 0..S::NODES {
            for d in 0..S::DIM {
                x[m][d] = P::from_pair(&self.modes[octet * 24 + m * 3 + d], half, lane);
            }
        }
        let alive = reference::<P>(&self.batch.reference, octet * points, half, lane).gt(P::zero());
        let mut mean = P::zero();
        if R::DILATATION {
            let (mut sum, mut whole) = (P::zero(), P::zero());
            for point in 0..points {
                let volume = Solid::<S, R, HOOP>::gradient(&x, point).volume;
                let said = &self.response.outputs()[octet * points + point];
                // Weight by the volume according to the law, on which the stress does its work.
                let by_law = reference::<P>(&self.batch.reference, octet * points + point, half, lane)
                    * P::from_pair(&said.volume_ratio, half, lane);
                sum = stress_of::<P>(&said.stress, half, lane).mean().mul_add(by_law, sum);
                whole = whole + volume * P::of(S::SCALE);
            }
            mean = sum / whole;
        }
        let (mut forces, mut bound, mut inverted) = ([[P::zero(); 3]; 8], P::zero(), P::Mask::splat(false));
        for point in 0..points {
            let place = octet * points + point;
            let said = &self.response.outputs()[place];
            let mut g = Solid::<S, R, HOOP>::gradient(&x, point);
            let mut stress = stress_of::<P>(&said.stress, half, lane);
            bound = bound + self.bound(place, (half, lane), &g);
            // NaN counts as inverted.
            inverted = inverted | !g.volume.gt(P::zero());
            if R::DILATATION {
                let by_law = reference::<P>(&self.batch.reference, place, half, lane)
                    * P::from_pair(&said.volume_ratio, half, lane);
                stress = (stress.deviator() * (by_law / (g.volume * P::of(S::SCALE)))).plus_isotropic(mean);
            }
            if R::AVERAGED {
                let ratio = P::from_pair(&said.volume_ratio, half, lane);
                let wanted = P::from_pair(&self.averages[octet], half, lane) / ratio;
                stress = stress.plus_isotropic(wanted - stress.mean());
                // Scale to the volume according to the law: the work is that of the law.
                let scale = reference::<P>(&self.batch.reference, place, half, lane) * ratio
                    / (g.volume * P::of(S::SCALE));
                for m in 0..S::NODES {
                    for d in 0..S::DIM {
                        g.area[m][d] = g.area[m][d] * scale;
                    }
                    g.hoop[m] = g.hoop[m] * scale;
                }
            }
            if !R::DILATATION && !R::AVERAGED && self.of.probe.apart {
                let by_law = reference::<P>(&self.batch.reference, place, half, lane)
                    * P::from_pair(&said.volume_ratio, half, lane);
                stress = stress * (by_law / (g.volume * P::of(S::SCALE)));
            }
            self.push(octet, (half, lane), &stress, &g, &x, &mut forces);
        }
        let mut nodal = S::nodal(&forces);
        for c in 0..S::NODES {
            for d in 0..S::DIM {
                nodal[c][d] = P::select(alive, -nodal[c][d], P::zero());
            }
        }
        scatter(&nodal, None, corners, (half, lane), S::NODES, self.out.slots);
        let inverted = inverted & alive;
        if inverted.any() {
            self.out.low[octet] |= P::bits(inverted) << (half * GROUP + lane);
        }
        let lightest = P::from_pair(&self.batch.sizes[octet][1], half, lane);
        let mut rate = (bound / lightest).sqrt() * P::of(0.5);
        if self.of.probe.shock != [0.0; 2] {
            rate = self.stiffened(octet, (half, lane), rate);
        }
        let rate = P::select(alive, rate, P::zero());
        rate.to_pair(&mut self.out.rates[octet], half, lane);
        rate
    }

    /// Add the forces on the modes: of the stress, and of hourglass control, which also acts on the linear modes.
    #[inline(always)]
    fn push<P: Pack<f64>>(
        &self,
        octet: usize,
        (half, lane): (usize, usize),
        stress: &Sym3<P>,
        g: &Gradient<P>,
        x: &Modes<P>,
        forces: &mut Modes<P>,
    ) {
        let mut pull = (*stress * P::of(S::SCALE)).to_mat();
        if R::CONTROL {
            let kept = &self.batch.kept[octet * Solid::<S, R, HOOP>::KEPT..];
            // Stress Q x / V of the hourglass forces Q; the scales of area and volume cancel.
            let per = g.volume.recip();
            for m in S::FIRST..S::NODES {
                for i in 0..S::DIM {
                    let q = P::from_pair(&kept[(m - S::FIRST) * S::DIM + i], half, lane);
                    forces[m][i] = forces[m][i] + q;
                    let q = -(q * per);
                    for j in 0..S::DIM {
                        pull.0[i][j] = q.mul_add(x[m][j], pull.0[i][j]);
                    }
                }
            }
        }
        for m in 1..S::NODES {
            for i in 0..S::DIM {
                for j in 0..S::DIM {
                    forces[m][i] = pull.0[i][j].mul_add(g.area[m][j], forces[m][i]);
                }
            }
        }
        if HOOP {
            for m in 0..S::NODES {
                forces[m][0] = stress.0[2].mul_add(g.hoop[m], forces[m][0]);
            }
        }
    }

    /// Upper bound of the stiffness of a point for any motion of the corners, N/m: lambda V sum_I |b_I|^2 + 2 G V (largest row sum of sum_I
    /// B_I B_I^T), with b_I the gradient of the volume over it. Exact for boxes.
    #[inline(always)]
    fn bound<P: Pack<f64>>(&self, place: usize, (half, lane): (usize, usize), g: &Gradient<P>) -> P {
        let probe = self.of.probe;
        let (vectors, hoops, times) = S::independent(g);
        let mut gram = [[P::zero(); 3]; 3];
        let (mut hoop, mut across) = (P::zero(), P::zero());
        for m in 0..S::NODES {
            let v = &vectors[m];
            for i in 0..S::DIM {
                for j in i..S::DIM {
                    gram[i][j] = v[i].mul_add(v[j], gram[i][j]);
                }
            }
            if HOOP {
                hoop = hoops[m].mul_add(hoops[m], hoop);
                across = v[0].mul_add(hoops[m], across);
            }
        }
        let (mut trace, mut rows) = (hoop + across + across, P::zero());
        let mut plain = P::zero();
        for i in 0..S::DIM {
            trace = trace + gram[i][i];
            plain = plain + gram[i][i];
            let mut row = gram[i][i];
            for j in 0..S::DIM {
                if j != i {
                    row = row + gram[i.min(j)][i.max(j)].abs();
                }
            }
            rows = rows.max(row);
        }
        rows = rows + hoop;
        let speed = P::from_pair(&self.response.outputs()[place].step_speed, half, lane);
        let volume = reference::<P>(&self.batch.reference, place, half, lane);
        // rho c^2, and the part of the initial shear modulus that it still contains.
        let modulus = P::splat(probe.density / S::SCALE) * volume * speed * speed / g.volume;
        let shear = P::splat(probe.shear);
        let left = ((modulus - P::splat(probe.bulk)) * P::of(0.75)).clamp(P::zero(), shear);
        let twice = left + left;
        let mut sum = (modulus - twice).max(P::zero()).mul_add(trace, twice * rows);
        if R::CONTROL {
            sum = P::splat(self.of.control[0]).mul_add(plain, sum);
        }
        sum * P::of(times * S::SCALE) / g.volume
    }

    /// Frequency bounds raised by bulk viscosity: omega (Q/c + sqrt(1 + Q^2/c^2)), Q = b1 c + b0 l d.
    #[inline(always)]
    fn stiffened<P: Pack<f64>>(&self, octet: usize, (half, lane): (usize, usize), rate: P) -> P {
        let points = Solid::<S, R, HOOP>::POINTS;
        let [linear, quadratic] = self.of.probe.shock;
        let length = P::from_pair(&self.batch.sizes[octet][0], half, lane);
        let mut most = P::zero();
        for point in 0..points {
            let place = octet * points + point;
            let closing = P::from_pair(&self.closing[place], half, lane);
            let speed = P::from_pair(&self.response.outputs()[place].step_speed, half, lane);
            let viscous = (closing * length).mul_add(P::splat(quadratic), P::splat(linear));
            most = most.max(P::select(speed.gt(P::zero()), viscous / speed, P::zero()));
        }
        rate * (most + most.mul_add(most, P::one()).sqrt())
    }
}
