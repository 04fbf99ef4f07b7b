//! What one task computes: some particles, with their neighbours and states.

use impactite_scene::Exchange;
use impactite_simd::Float;
use mpm_materials::Breakdown;

use crate::matrix::{Matrix, times};

/// Particles of a batch. A multiple of the lanes of every vector.
pub(crate) const BATCH: usize = 128;
/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;

pub(crate) type Row = <f64 as Float>::Row;

/// The neighbours of some particles that are within reach.
#[derive(Clone, Debug, Default)]
pub(crate) struct Near {
    /// Where the neighbours of each particle begin; one more than there are.
    pub starts: Vec<u32>,
    pub index: Vec<u32>,
    /// -W'/r, 1/m^(D + 2).
    pub slope: Vec<f64>,
    /// The kernel over its value at the spacing, to a power, with artificial stress.
    pub close: Vec<f64>,
}

impl Near {
    /// The neighbours of a particle of the batch, and their slopes.
    #[inline]
    pub fn of(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.starts[i] as usize..self.starts[i + 1] as usize;
        (&self.index[range.clone()], &self.slope[range])
    }
    /// None, with room for so many.
    pub fn clear(&mut self, room: usize, close: bool) {
        self.starts.clear();
        self.starts.push(0);
        self.index.resize(room, 0);
        self.slope.resize(room, 0.0);
        self.close.resize(if close { room } else { 0 }, 0.0);
    }
    /// How many pairs.
    pub fn pairs(&self) -> usize {
        self.starts.last().map_or(0, |&end| end as usize)
    }
    pub fn bytes(&self) -> usize {
        4 * (self.starts.capacity() + self.index.capacity())
            + 8 * (self.slope.capacity() + self.close.capacity())
    }
}

/// A batch of particles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch {
    /// States: groups of rows, one a number.
    pub rows: Vec<Row>,
    pub near: Near,
    /// Moments K of velocities, or of places, of the last sum: [`Strain`](super::Strain); their first rows, gradients of density.
    pub moments: Vec<Matrix>,
    /// What makes velocity gradients of them, C: grad v = K C.
    pub correction: Vec<Matrix>,
    /// In the total Lagrangian form, C of the reference: C is that times F^-1.
    pub first: Vec<Matrix>,
    /// And the deformation gradient F since.
    pub deformation: Vec<Matrix>,
    /// The one from the start to the reference, once that was renewed.
    pub before: Vec<Matrix>,
    /// Cauchy stress, Pa, volume ratio, and the wave speed that steps are held by, m/s.
    pub stress: Vec<[f64; 8]>,
    /// With artificial stress, how far particles turned in the last step: yx, zx, zy of the spin times the step.
    pub spin: Vec<[f64; 3]>,
    /// Accelerations that stabilise and are in no energy, m/s^2.
    pub stabilising: Vec<[f64; 4]>,
    /// With a diffusion of density, the rate at which it makes particles denser: that of the logarithm, 1/s.
    pub diffusing: Vec<f64>,
    /// Velocities at the start of the step, m/s.
    pub start: Vec<[f64; 4]>,
    pub report: Report,
}

/// What a sweep over a batch found.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Report {
    /// Largest Courant rate, 1/s.
    pub rate: f64,
    /// Largest stretch since the reference, or its inverse.
    pub stretch: f64,
    /// The first particle that cannot go on: its number in the batch.
    pub trouble: Option<(usize, Breakdown)>,
    /// The first whose velocity is no number, or that came to the axis.
    pub lost: Option<usize>,
    /// What a diffusion of density did to laws in a step, J.
    pub diffused: f64,
    /// What mirrors, conditions and loads gave in a step.
    pub given: Exchange,
}

impl Batch {
    pub fn bytes(&self) -> usize {
        let matrices = self.moments.capacity()
            + self.correction.capacity()
            + self.first.capacity()
            + self.deformation.capacity()
            + self.before.capacity();
        self.rows.capacity() * size_of::<Row>()
            + self.near.bytes()
            + matrices * size_of::<Matrix>()
            + self.stress.capacity() * size_of::<[f64; 8]>()
            + (self.stabilising.capacity() + self.start.capacity()) * size_of::<[f64; 4]>()
            + self.spin.capacity() * size_of::<[f64; 3]>()
            + 8 * self.diffusing.capacity()
    }

    /// How a particle is deformed since the start, in `d` dimensions, where that is known.
    #[inline]
    pub fn whole(&self, i: usize, d: usize) -> Option<Matrix> {
        let f = self.deformation.get(i)?;
        Some(self.before.get(i).map_or(*f, |before| times(f, before, d)))
    }

    /// The state of a particle, in `out`.
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
}
