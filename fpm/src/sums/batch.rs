//! Batch of cells, the work of one task, with their states.

use impactite_scene::{ACCOUNTS, Exchange};
use impactite_simd::Float;
use mpm_materials::Breakdown;

use crate::vector::Tensor;

/// Number of cells of a batch, a multiple of the lanes of every vector.
pub(crate) const BATCH: usize = 128;
/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;

pub(crate) type Row = <f64 as Float>::Row;

/// Face on the surface with a load.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outer<const D: usize> {
    /// Cell of the face, by number in the batch.
    pub cell: u32,
    /// Number of the load.
    pub load: u32,
    /// Area times outward normal.
    pub area: [f64; D],
    /// Arm from the point of the cell to the centroid of the face, m.
    pub arm: [f64; D],
    /// Penalty stiffness, area times eta / l, N/m.
    pub stiffness: f64,
    /// Present force on the cell, N, and displacement of the centroid, m.
    pub force: [f64; D],
    pub moved: [f64; D],
}

/// A batch of cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch<const D: usize> {
    /// State variables: groups of rows, one row per number.
    pub rows: Vec<Row>,
    /// Displacement gradient in the last update of the law.
    pub gradient: Vec<Tensor<D>>,
    /// Lifting: sums over faces of A/2 [u] (x) N, the part of jumps in the gradient times the volume.
    pub lifting: Vec<Tensor<D>>,
    /// With the incomplete flux: lifting and P at the end of the last step.
    pub before: Vec<[Tensor<D>; 2]>,
    /// Cauchy stress, Pa, volume ratio, and wave speed of the time step limit, m/s.
    pub said: Vec<[f64; 8]>,
    /// Squares of the highest frequency by bulk and by penalty at rest, 1/s^2: [`crate::pace`].
    pub rates: Vec<[f64; 2]>,
    /// Velocities at the start of the step, m/s.
    pub start: Vec<[f64; D]>,
    /// Directions in which conditions or contact moved a cell in the last step, one bit each.
    pub held: Vec<u16>,
    /// Faces on the surface with loads, by cell.
    pub outer: Vec<Outer<D>>,
    /// Rigid cells, whose neighbours are too few, or in a line or plane, with their constant gradient.
    pub rigid: Vec<(u32, Tensor<D>)>,
    /// Open sides, by cell: the cell, the crack, and the index of the cell in the crack.
    pub cracks: Vec<(u32, u32, u8)>,
    /// Changes of gradients by new neighbours, not yet passed to the law.
    pub jumps: Vec<(u32, Tensor<D>)>,
    pub report: Report,
}

/// Results of a sweep over a batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    /// Largest square of a frequency, 1/s^2.
    pub rate: f64,
    /// First cell whose law failed, by number in the batch, and the cause.
    pub trouble: Option<(usize, Breakdown)>,
    /// First cell with a non-finite displacement.
    pub lost: Option<usize>,
    /// Exchange with conditions and loads in a step.
    pub given: Exchange,
    /// Energy of the penalty, J.
    pub penalty: f64,
    /// Work of the flux on jumps in the last step, J.
    pub flux: f64,
    /// Work of loads on the surface, J.
    pub work: f64,
    /// Parts of it by the accounts of boundary conditions, J.
    pub work_of: [f64; ACCOUNTS],
    /// Energy change by new neighbours, J.
    pub jumped: f64,
    /// Candidate faces for opening.
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

    /// Load the state of a cell into `out`.
    pub fn read(&self, i: usize, out: &mut [f64]) {
        let rows = &self.rows[i / GROUP * out.len()..];
        for (k, x) in out.iter_mut().enumerate() {
            *x = rows[k].as_ref()[i % GROUP];
        }
    }
    /// Store the state of a cell.
    pub fn write(&mut self, i: usize, state: &[f64]) {
        let rows = &mut self.rows[i / GROUP * state.len()..];
        for (k, x) in state.iter().enumerate() {
            rows[k].as_mut()[i % GROUP] = *x;
        }
    }
    /// Return the gradient of a rigid cell.
    pub fn rigid(&self, i: usize) -> Option<&Tensor<D>> {
        self.rigid.iter().find(|(n, _)| *n as usize == i).map(|(_, h)| h)
    }
}
