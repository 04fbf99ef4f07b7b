//! Accelerations: sums over neighbours.

use std::marker::PhantomData;

use impactite_scene::Embedding;
use impactite_simd::{Arch, Kernel, Lane, Quad, Vectors};

use super::batch::Near;
use crate::method::Composition;
use crate::records::Records;
use crate::stabilisation::Stabilisation;

/// Accelerations of the particles of a batch by their neighbours.
pub(crate) struct Push<'a, const D: usize, M> {
    pub records: &'a Records<D>,
    pub near: &'a Near,
    pub first: usize,
    /// Coefficients of the pair viscosity.
    pub viscosity: [f64; 2],
    pub out: Pushed<'a>,
    pub method: PhantomData<M>,
}

/// Output arrays.
pub(crate) struct Pushed<'a> {
    /// Acceleration, m/s^2.
    pub acceleration: &'a mut [[f64; 4]],
    /// The part of it by stabilisations without potential energy, if any.
    pub stabilising: &'a mut [[f64; 4]],
}

impl<const D: usize, M: Composition<D>> Kernel<f64> for Push<'_, D, M> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let extra = M::Stabilisation::STRESS || M::Stabilisation::VISCOSITY;
        let count = self.out.acceleration.len();
        for n in 0..count {
            let (mut push, more) = self.sum::<A>(n);
            if extra {
                self.out.stabilising[n] = more;
                (0..4).for_each(|d| push[d] += more[d]);
            }
            self.out.acceleration[n] = push;
        }
    }
}

impl<const D: usize, M: Composition<D>> Push<'_, D, M> {
    /// Return the sum over the neighbours of a particle, and the stabilising part separately.
    #[inline(always)]
    fn sum<A: Arch<f64>>(&self, n: usize) -> ([f64; 4], [f64; 4]) {
        let (records, i) = (self.records, self.first + n);
        let own = &records.place[i];
        let tensor = std::array::from_fn::<_, D, _>(|c| A::Quad::load(&records.tensor[i][c]));
        let now = if M::Stabilisation::PENALTY { A::Quad::load(&records.now[i]) } else { A::Quad::zero() };
        let bias = if M::Stabilisation::PENALTY { records.bias[i] } else { 0.0 };
        let (mut sum, mut extra) = (A::Quad::zero(), A::Quad::zero());
        let (index, slope) = self.near.of(n);
        let start = self.near.starts[n] as usize;
        for (k, (&j, &s)) in index.iter().zip(slope).enumerate() {
            let j = j as usize;
            let other = &records.place[j];
            let columns = &records.tensor[j];
            let weight = s * other[3];
            let mut push = A::Quad::zero();
            for c in 0..D {
                let along = A::Quad::splat(other[c] - own[c]);
                push = (A::Quad::load(&columns[c]) + tensor[c]).mul_add(along, push);
            }
            if M::Stabilisation::PENALTY {
                let apart = A::Quad::load(&records.now[j]) - now;
                // The stiffness is uniform, except for the factor radius.
                let both = if M::Embedding::HOOP { bias + records.bias[j] } else { bias + bias };
                push = apart.mul_add(A::Quad::splat(both), push);
            }
            sum = push.mul_add(A::Quad::splat(weight), sum);
            if M::Stabilisation::STRESS {
                let both =
                    |of: &[[[f64; 4]; D]], c: usize| A::Quad::load(&of[j][c]) + A::Quad::load(&of[i][c]);
                let close = A::Quad::splat(self.near.close[start + k]);
                let mut push = A::Quad::zero();
                for c in 0..D {
                    let along = A::Quad::splat(other[c] - own[c]);
                    let mut stress = both(&records.artificial, c) * close;
                    if M::Stabilisation::BALANCE {
                        stress = stress - both(&records.balance, c);
                    }
                    push = stress.mul_add(along, push);
                }
                extra = push.mul_add(A::Quad::splat(weight), extra);
            }
            if M::Stabilisation::VISCOSITY {
                let push = Viscous { records, viscosity: self.viscosity }.between(i, j) * weight;
                let apart = A::Quad::load(other) - A::Quad::load(own);
                extra = apart.mul_add(A::Quad::splat(push), extra);
            }
        }
        // In the plane the last two numbers are the penalty's.
        let per = own[3] / records.velocity[i][3];
        let fold = |sum: A::Quad| {
            let mut all = [0.0; 4];
            (sum * A::Quad::splat(per)).store(&mut all);
            if D == 2 { [all[0] + all[2], all[1] + all[3], 0.0, 0.0] } else { [all[0], all[1], all[2], 0.0] }
        };
        (fold(sum), fold(extra))
    }
}

/// Pair viscosity.
pub(crate) struct Viscous<'a, const D: usize> {
    pub records: &'a Records<D>,
    /// Linear and quadratic coefficient.
    pub viscosity: [f64; 2],
}

impl<const D: usize> Viscous<'_, D> {
    /// Return the viscous pressure between two approaching particles, negative: Pi rho_i rho_j, Pa.
    #[inline(always)]
    pub fn between(&self, i: usize, j: usize) -> f64 {
        let records = self.records;
        let (mut square, mut closing) = (0.0, 0.0);
        for d in 0..D {
            let x = records.place[j][d] - records.place[i][d];
            square += x * x;
            closing += x * (records.velocity[j][d] - records.velocity[i][d]);
        }
        if closing >= 0.0 {
            return 0.0;
        }
        let h = 0.5 * (records.smoothing[i] + records.smoothing[j]);
        let mu = h * closing / (square + 0.01 * h * h);
        let [[rho_i, c_i], [rho_j, c_j]] = [records.fluid[i], records.fluid[j]];
        let [alpha, beta] = self.viscosity;
        let (rho, c) = (0.5 * (rho_i + rho_j), 0.5 * (c_i + c_j));
        rho * (alpha * c * mu - beta * mu * mu)
    }
}
