//! What one task computes: some cells, with their states.

use impactite_scene::Exchange;
use impactite_simd::Float;
use mpm_materials::Breakdown;

use crate::vector::Tensor;

/// Cells of a batch. A multiple of the lanes of every vector.
pub(crate) const BATCH: usize = 128;
/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;

pub(crate) type Row = <f64 as Float>::Row;

/// A face on the surface that something acts on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outer<const D: usize> {
    /// Its cell, by number in the batch.
    pub cell: u32,
    /// What acts on it.
    pub load: u32,
    /// Area times outward normal.
    pub area: [f64; D],
    /// From the point of its cell to its centroid, m.
    pub arm: [f64; D],
    /// Area times eta / l of the penalty, N/m.
    pub stiffness: f64,
    /// Force on the cell, N, and displacement of the centroid, m, as they stand.
    pub force: [f64; D],
    pub moved: [f64; D],
}

/// A batch of cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch<const D: usize> {
    /// States: groups of rows, one a number.
    pub rows: Vec<Row>,
    /// The displacement gradient that the law saw last.
    pub gradient: Vec<Tensor<D>>,
    /// Sums over faces of A/2 [u] (x) N: what jumps are of the gradient, times the volume.
    pub lifting: Vec<Tensor<D>>,
    /// With the incomplete flux, that and P at the end of the last step.
    pub before: Vec<[Tensor<D>; 2]>,
    /// Cauchy stress, Pa, volume ratio, and the wave speed that steps are held by, m/s.
    pub said: Vec<[f64; 8]>,
    /// Squares of the highest frequency by bulk and by penalty, 1/s^2, as they are at rest: [`crate::pace`].
    pub rates: Vec<[f64; 2]>,
    /// Velocities at the start of the step, m/s.
    pub start: Vec<[f64; D]>,
    /// Directions in which something else than neighbours moved a cell in the last step, a bit each.
    pub held: Vec<u16>,
    /// Faces on the surface that something acts on, by cell.
    pub outer: Vec<Outer<D>>,
    /// Cells whose neighbours are too few, or in a line or plane, with their gradient, which stays.
    pub rigid: Vec<(u32, Tensor<D>)>,
    /// Sides that are open, by cell: the cell, the crack, and which of its two sides.
    pub cracks: Vec<(u32, u32, u8)>,
    /// Changes of gradients that came with new neighbours, and that the law has yet to see.
    pub jumps: Vec<(u32, Tensor<D>)>,
    pub report: Report,
}

/// What a sweep over a batch found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    /// Largest square of a frequency, 1/s^2.
    pub rate: f64,
    /// The first cell that cannot go on: its number in the batch.
    pub trouble: Option<(usize, Breakdown)>,
    /// The first whose velocity is no number.
    pub lost: Option<usize>,
    /// What conditions and loads gave in a step.
    pub given: Exchange,
    /// Energy of the penalty, J.
    pub penalty: f64,
    /// Work of the flux on jumps in the last step, J.
    pub flux: f64,
    /// Work of what acts on the surface, J.
    pub work: f64,
    /// Energy that new neighbours took or gave, J.
    pub jumped: f64,
    /// Faces that may open.
    pub candidates: Vec<u32>,
}

impl<const D: usize> Batch<D> {
    pub fn bytes(&self) -> usize {
        let tensors = self.gradient.capacity()
            + self.lifting.capacity()
            + 2 * self.before.capacity()
            + self.rigid.capacity()
            + self.jumps.capacity();
        self.rows.capacity() * size_of::<Row>()
            + tensors * size_of::<Tensor<D>>()
            + 64 * self.said.capacity()
            + 16 * self.rates.capacity()
            + 8 * D * self.start.capacity()
            + self.outer.capacity() * size_of::<Outer<D>>()
            + self.held.capacity()
    }

    /// The state of a cell, in `out`.
    pub fn read(&self, i: usize, out: &mut [f64]) {
        let rows = &self.rows[i / GROUP * out.len()..];
        for (k, x) in out.iter_mut().enumerate() {
            *x = rows[k].as_ref()[i % GROUP];
        }
    }
    /// Let it be this.
    pub fn write(&mut self, i: usize, state: &[f64]) {
        let rows = &mut self.rows[i / GROUP * state.len()..];
        for (k, x) in state.iter().enumerate() {
            rows[k].as_mut()[i % GROUP] = *x;
        }
    }
    /// The gradient of a rigid cell.
    pub fn rigid(&self, i: usize) -> Option<&Tensor<D>> {
        self.rigid.iter().find(|(n, _)| *n as usize == i).map(|(_, h)| h)
    }
}
