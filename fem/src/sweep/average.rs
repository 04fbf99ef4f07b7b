//! Kernels of nodal averaging.

use std::marker::PhantomData;

use impactite_simd::{Arch, Kernel, Pack, Vectors};
use mpm_materials::Lane;
use mpm_materials::material::Response;

use super::batch::{Batch, Nodes, OCTET, Record, Rows};
use super::kernels::{gather, load, mean_of, place, reference, scatter, stress_of};
use super::work::Of;
use crate::shape::Shape;

/// Kernel that scatters volume changes in a step, and reference volumes, to the nodes.
pub(super) struct Stretch<'a, S, const HOOP: bool> {
    pub of: &'a Of<'a>,
    pub batch: &'a Batch,
    pub moving: &'a Nodes,
    pub slots: &'a mut [Record],
    pub kind: PhantomData<S>,
}

impl<S: Shape, const HOOP: bool> Kernel<f64> for Stretch<'_, S, HOOP> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Stretch { of, batch, moving, slots, .. } = self;
        let (mut at, mut rate) = ([[Rows::default(); 3]; 8], [[Rows::default(); 3]; 8]);
        for octet in 0..batch.octets() {
            let corners = &batch.corners[octet * S::NODES * OCTET..][..S::NODES * OCTET];
            gather(corners, moving, (S::NODES, S::DIM), &mut at, Some(&mut rate));
            for vector in 0..OCTET / A::Batch::WIDTH {
                let (half, lane) = place::<A::Batch>(vector);
                let now = S::modes(&load::<A::Batch>(&at, (half, lane), S::NODES, S::DIM));
                let velocity = S::modes(&load::<A::Batch>(&rate, (half, lane), S::NODES, S::DIM));
                let mut before = now;
                for m in 0..S::NODES {
                    for d in 0..S::DIM {
                        before[m][d] = velocity[m][d].mul_add(A::Batch::of(-of.dt), now[m][d]);
                    }
                }
                let volume = reference::<A::Batch>(&batch.reference, octet, half, lane);
                // Volume change over mean volume: the logarithm of the volume ratio to third order, so that averages are those of rates.
                let (now, before) = (S::mean(&now, HOOP).volume, S::mean(&before, HOOP).volume);
                let change = (now - before) / ((now + before) * A::Batch::of(0.5));
                let alive = volume.gt(A::Batch::zero());
                let weighted = A::Batch::select(alive, change * volume, A::Batch::zero());
                give_numbers::<A::Batch>([weighted, volume], corners, (half, lane), S::NODES, slots);
            }
        }
    }
}

/// Scatter two numbers of an element to all its nodes.
#[inline(always)]
fn give_numbers<P: Pack<f64>>(
    [one, other]: [P; 2],
    corners: &[u16],
    at: (usize, usize),
    n: usize,
    slots: &mut [Record],
) {
    let mut vectors = [[P::zero(); 3]; 8];
    for vector in vectors.iter_mut().take(n) {
        (vector[0], vector[1]) = (one, other);
    }
    scatter(&vectors, None, corners, at, n, slots);
}

/// Kernel that scatters Kirchhoff mean stresses, and reference volumes, to the nodes.
pub(super) struct MeanStress<'a, S> {
    pub batch: &'a Batch,
    pub response: &'a Response<f64>,
    pub slots: &'a mut [Record],
    pub kind: PhantomData<S>,
}

impl<S: Shape> Kernel<f64> for MeanStress<'_, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let MeanStress { batch, response, slots, .. } = self;
        for octet in 0..batch.octets() {
            let corners = &batch.corners[octet * S::NODES * OCTET..][..S::NODES * OCTET];
            let said = &response.outputs()[octet];
            for vector in 0..OCTET / A::Batch::WIDTH {
                let (half, lane) = place::<A::Batch>(vector);
                let volume = reference::<A::Batch>(&batch.reference, octet, half, lane);
                let stress = stress_of::<A::Batch>(&said.stress, half, lane);
                let mean = stress.mean() * A::Batch::from_pair(&said.volume_ratio, half, lane);
                let weighted = A::Batch::select(volume.gt(A::Batch::zero()), mean * volume, A::Batch::zero());
                give_numbers::<A::Batch>([weighted, volume], corners, (half, lane), S::NODES, slots);
            }
        }
    }
}

/// Kernel of the modes of the positions, and of element means of the nodal averages.
pub(super) struct Locate<'a, S> {
    pub batch: &'a Batch,
    pub moving: &'a Nodes,
    pub modes: &'a mut [Rows],
    pub averages: &'a mut [Rows],
    pub kind: PhantomData<S>,
}

impl<S: Shape> Kernel<f64> for Locate<'_, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Locate { batch, moving, modes, averages, .. } = self;
        let mut at = [[Rows::default(); 3]; 8];
        for octet in 0..batch.octets() {
            let corners = &batch.corners[octet * S::NODES * OCTET..][..S::NODES * OCTET];
            gather(corners, moving, (S::NODES, S::DIM), &mut at, None);
            averages[octet] = mean_of(corners, moving, S::NODES);
            for vector in 0..OCTET / A::Batch::WIDTH {
                let (half, lane) = place::<A::Batch>(vector);
                let now = S::modes(&load::<A::Batch>(&at, (half, lane), S::NODES, S::DIM));
                for m in 0..S::NODES {
                    for d in 0..S::DIM {
                        now[m][d].to_pair(&mut modes[octet * 24 + m * 3 + d], half, lane);
                    }
                }
            }
        }
    }
}
