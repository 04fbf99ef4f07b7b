//! Neighbours within reach, and their kernel slopes.

use impactite_geometry::search::NeighbourLists;
use impactite_simd::{Arch, Kernel, Lane, Pack, Vectors};

use super::batch::{GROUP, Near, Row};
use crate::images::Images;
use crate::kernel::Kernel as Smoothing;
use crate::records::Records;

/// Neighbours within reach of the particles from `first` on, from lists that may be longer.
pub(crate) struct Weigh<'a, const D: usize, K> {
    pub kernel: &'a K,
    pub records: &'a Records<D>,
    pub lists: &'a NeighbourLists,
    pub first: usize,
    pub count: usize,
    /// Exponent of the artificial stress, if any.
    pub power: Option<i32>,
    /// Mirror images; `walls` is true if some are at walls.
    pub images: &'a Images<D>,
    pub walls: bool,
    /// Stresses of the particles, Pa: walls do not act in tension.
    pub stress: &'a [[f64; 8]],
    pub near: &'a mut Near,
}

impl<const D: usize, K: Smoothing> Kernel<f64> for Weigh<'_, D, K> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Weigh { kernel, records, lists, first, count, power, images, walls, stress, near } = self;
        let room = lists.starts()[first + count] as usize - lists.starts()[first] as usize + 1;
        near.clear(room, power.is_some());
        let mut end = 0;
        let norm = kernel.norm(D);
        // The spacing is h over the ratio of the kernel.
        let at_spacing: f64 = kernel.value(1.0 / kernel.ratio());
        let mut rows = [Row::default(); 4];
        let (mut squares, mut reaches, mut slopes, mut values) =
            (Row::default(), Row::default(), Row::default(), Row::default());
        for i in first..first + count {
            let (place, smoothing) = (&records.place[i], records.smoothing[i]);
            let list = lists.of(i);
            for chunk in list.chunks(GROUP) {
                for (lane, &j) in chunk.iter().enumerate() {
                    let other = &records.place[j as usize];
                    for d in 0..D {
                        rows[d].as_mut()[lane] = other[d] - place[d];
                    }
                    rows[3].as_mut()[lane] = smoothing + records.smoothing[j as usize];
                }
                for lane in (0..GROUP).step_by(A::Pack::WIDTH) {
                    let load = |row: &Row| A::Pack::from_rows([row, row], lane);
                    let mut square = A::Pack::zero();
                    for d in 0..D {
                        let x = load(&rows[d]);
                        square = x.mul_add(x, square);
                    }
                    let reach = load(&rows[3]);
                    // Mean smoothing length h of the pair, q = r / h.
                    let per = A::Pack::of(2.0) / reach;
                    let q = square.sqrt() * per;
                    let mut scale = A::Pack::splat(-norm) * per * per;
                    for _ in 0..D {
                        scale = scale * per;
                    }
                    square.to_row(0, &mut squares, lane);
                    (reach * reach).to_row(0, &mut reaches, lane);
                    (kernel.slope(q) * scale).to_row(0, &mut slopes, lane);
                    if power.is_some() {
                        kernel.value(q).to_row(0, &mut values, lane);
                    }
                }
                for (lane, &j) in chunk.iter().enumerate() {
                    let reached = squares.as_ref()[lane] < reaches.as_ref()[lane];
                    let reached =
                        reached && !(walls && is_let_go(images, records.particles, j, &stress[i - first]));
                    // Branch-free compaction: the next neighbour overwrites one out of reach.
                    near.index[end] = j;
                    near.slope[end] = slopes.as_ref()[lane];
                    if let Some(power) = power {
                        near.close[end] = (values.as_ref()[lane] / at_spacing).min(1.0).powi(power);
                    }
                    end += usize::from(reached);
                }
            }
            near.starts.push(end as u32);
        }
    }
}

/// Return true for an image at a wall that would be in tension at this stress.
fn is_let_go<const D: usize>(images: &Images<D>, particles: usize, j: u32, stress: &[f64; 8]) -> bool {
    let image = (j as usize).checked_sub(particles).and_then(|n| images.all.get(n));
    image.and_then(|image| image.wall).is_some_and(|axis| stress[axis] > 0.0)
}
