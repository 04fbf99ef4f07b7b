//! Mean dilatation of a bin ([`crate::MeanDilatation`]).

use mpm_materials::Lane;
use mpm_materials::material::{Deformation, Material, NO_GROUP, States};

use super::law_batch::{ForMean, LawBatch, Occupant};
use super::rows::of_row;
use super::slot::Common;
use crate::particles::Masses;
use impactite_simd::{Arch, Float, Kernel, Pack, Vectors, lane_numbers};

/// Replace the dilatation increments of a batch by the mass-weighted mean of each bin. `rows` are the rows of the block,
/// `stride` per group; states begin at row `first`.
#[inline(never)]
pub(in crate::step) fn dilate<T: Float, const D: usize>(
    batch: &mut LawBatch<T>,
    material: &dyn Material<T>,
    (rows, stride, first): (&[T::Row], usize, usize),
    common: &Common<T>,
    hoop: bool,
) {
    let axes = if D == 3 || hoop { 3 } else { 2 };
    let ForMean { groups, occupants, deformations, ratios } = batch.for_mean();
    material.volume_ratios(States { all: rows, stride, first, groups }, ratios);
    T::dispatch(Dilate {
        groups,
        occupants,
        deformations,
        ratios,
        rows,
        stride,
        masses: common.masses,
        returned: common.mean_return,
        axes,
    });
}

struct Dilate<'a, T: Float> {
    groups: &'a [u32],
    occupants: &'a [Occupant],
    deformations: &'a mut [Deformation<T::Row>],
    /// Volume ratios before the step.
    ratios: &'a [T::Row],
    rows: &'a [T::Row],
    stride: usize,
    masses: Masses<T>,
    /// Fraction of the deviation of the volume ratio from the mean that a particle recovers.
    returned: T,
    /// Number of axes over which a dilatation is distributed.
    axes: usize,
}

impl<T: Float> Kernel<T> for Dilate<'_, T> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let Dilate { groups, occupants, deformations, ratios, rows, stride, masses, returned, axes } = self;
        let lane_index = lane_numbers::<T, A::Pack>();
        let mut begin = 0;
        while begin < groups.len() {
            let mut end = begin + 1;
            while end < groups.len() && occupants[end].bin == occupants[begin].bin {
                end += 1;
            }
            let there = (begin..end).filter(|&n| groups[n] != NO_GROUP);
            // Sums of mass, and of mass-weighted increment traces and volume ratios.
            let mut sums = [A::Pack::zero(); 3];
            for n in there.clone() {
                let rows = &rows[groups[n] as usize * stride..][..stride];
                for lane in (0..T::GROUP).step_by(A::Pack::WIDTH) {
                    let here = A::Pack::of(f64::from(occupants[n].here) - lane as f64);
                    let alive = lane_index.lt(here);
                    let mass = masses.of_group(alive, |row| of_row::<T, A::Pack>(&rows[row], lane));
                    sums[0] = sums[0] + mass;
                    // Lanes without a particle are undefined and may contain NaN.
                    let known = |x| A::Pack::select(alive, x, A::Pack::zero());
                    let trace = trace::<T, A::Pack>(&deformations[n / 2], n % 2, lane);
                    let ratio = of_row::<T, A::Pack>(&ratios[n], lane);
                    sums[1] = mass.mul_add(known(trace), sums[1]);
                    sums[2] = mass.mul_add(known(ratio), sums[2]);
                }
            }
            let mut of = [T::default(); 3];
            for i in 0..3 {
                for lane in 0..A::Pack::WIDTH {
                    of[i] += sums[i].lane(lane);
                }
            }
            let (mean_trace, mean_ratio) = (A::Pack::splat(of[1] / of[0]), A::Pack::splat(of[2] / of[0]));
            for n in there {
                let (deformation, half) = (&mut deformations[n / 2], n % 2);
                for lane in (0..T::GROUP).step_by(A::Pack::WIDTH) {
                    let here = A::Pack::of(f64::from(occupants[n].here) - lane as f64);
                    let ratio = of_row::<T, A::Pack>(&ratios[n], lane);
                    let back = (mean_ratio - ratio) / ratio * A::Pack::splat(returned);
                    let more = mean_trace + back - trace::<T, A::Pack>(deformation, half, lane);
                    // Correction of the gradient that yields this increment.
                    let step = A::Pack::from_pair(&deformation.step, half, lane);
                    let more = more * A::Pack::of(1.0 / axes as f64) / step;
                    let more = A::Pack::select(lane_index.lt(here), more, A::Pack::zero());
                    for d in 0..axes {
                        let row = &mut deformation.gradient[4 * d];
                        (A::Pack::from_pair(row, half, lane) + more).to_pair(row, half, lane);
                    }
                }
            }
            begin = end;
        }
    }
}

/// Return the traces of the increments of a group.
#[inline(always)]
fn trace<T: Float, P: Pack<T>>(of: &Deformation<T::Row>, half: usize, lane: usize) -> P {
    let diagonal = |d: usize| P::from_pair(&of.gradient[4 * d], half, lane);
    (diagonal(0) + diagonal(1) + diagonal(2)) * P::from_pair(&of.step, half, lane)
}
