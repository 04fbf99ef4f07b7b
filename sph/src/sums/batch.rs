//! Batch of particles, the work of one task, with their neighbours and states.

use impactite_scene::Exchange;
use impactite_simd::Float;
use mpm_materials::Breakdown;

use crate::matrix::{Matrix, times};

/// Number of particles of a batch, a multiple of the lanes of every vector.
pub(crate) const BATCH: usize = 128;
/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;

pub(crate) type Row = <f64 as Float>::Row;

/// Neighbours within reach of the particles of a batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Near {
    /// Start of the neighbours of each particle, and the end of the last.
    pub starts: Vec<u32>,
    pub index: Vec<u32>,
    /// Kernel slope -W'/r, 1/m^(D + 2).
    pub slope: Vec<f64>,
    /// With artificial stress: kernel over its value at the spacing, to a power.
    pub close: Vec<f64>,
}

impl Near {
    /// Return the neighbours of a particle of the batch, and their kernel slopes.
    #[inline]
    pub fn of(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.starts[i] as usize..self.starts[i + 1] as usize;
        (&self.index[range.clone()], &self.slope[range])
    }
    /// Clear the lists, with room for this number of pairs.
    pub fn clear(&mut self, room: usize, close: bool) {
        self.starts.clear();
        self.starts.push(0);
        self.index.resize(room, 0);
        self.slope.resize(room, 0.0);
        self.close.resize(if close { room } else { 0 }, 0.0);
    }
    /// Number of pairs.
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
    /// State variables: groups of rows, one row per number.
    pub rows: Vec<Row>,
    pub near: Near,
    /// Moments K of velocities or places from the last sum: [`Strain`](super::Strain); their first rows also store density gradients.
    pub moments: Vec<Matrix>,
    /// Gradient correction C: grad v = K C.
    pub correction: Vec<Matrix>,
    /// With density diffusion and gradients that are not corrected: correction of density gradients.
    pub of_density: Vec<Matrix>,
    /// With these: true for particles with enough neighbours for a density gradient.
    pub surrounded: Vec<bool>,
    /// In the total Lagrangian form: gradient correction C0 of the reference, with C = C0 F^-1.
    pub first: Vec<Matrix>,
    /// In the total Lagrangian form: deformation gradient F since the reference.
    pub deformation: Vec<Matrix>,
    /// Deformation gradient from the start to the reference, after an update of the reference.
    pub before: Vec<Matrix>,
    /// Cauchy stress, Pa, volume ratio, and wave speed of the time step limit, m/s.
    pub stress: Vec<[f64; 8]>,
    /// With artificial stress: rotation of particles in the last step, yx, zx, zy of the spin times the step.
    pub spin: Vec<[f64; 3]>,
    /// Accelerations by stabilisations without potential energy, m/s^2.
    pub stabilising: Vec<[f64; 4]>,
    /// With density diffusion: its rate of the logarithm of density, 1/s.
    pub diffusing: Vec<f64>,
    /// Forces of the mirrors of a liquid on the particles, N; last: the part along the axis by the weight between particles and images.
    pub by_mirror: Vec<[f64; 4]>,
    /// Velocities at the start of the step, m/s.
    pub start: Vec<[f64; 4]>,
    pub report: Report,
}

/// Results of a sweep over a batch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Report {
    /// Largest Courant rate, 1/s.
    pub rate: f64,
    /// Largest stretch, or inverse stretch, since the reference.
    pub stretch: f64,
    /// First particle whose law failed, by number in the batch, and the cause.
    pub trouble: Option<(usize, Breakdown)>,
    /// First particle with a non-finite position, or at the axis.
    pub lost: Option<usize>,
    /// Work of density diffusion on laws in a step, J.
    pub diffused: f64,
    /// Exchange with mirrors, conditions and loads in a step.
    pub given: Exchange,
}

impl Batch {
    pub fn bytes(&self) -> usize {
        let matrices = self.moments.capacity()
            + self.correction.capacity()
            + self.of_density.capacity()
            + self.first.capacity()
            + self.deformation.capacity()
            + self.before.capacity();
        self.rows.capacity() * size_of::<Row>()
            + self.near.bytes()
            + matrices * size_of::<Matrix>()
            + self.stress.capacity() * size_of::<[f64; 8]>()
            + (self.stabilising.capacity() + self.start.capacity()) * size_of::<[f64; 4]>()
            + self.spin.capacity() * size_of::<[f64; 3]>()
            + self.by_mirror.capacity() * size_of::<[f64; 4]>()
            + 8 * self.diffusing.capacity()
            + self.surrounded.capacity()
    }

    /// Return the deformation gradient of a particle since the start, in `d` dimensions, if known.
    #[inline]
    pub fn whole(&self, i: usize, d: usize) -> Option<Matrix> {
        let f = self.deformation.get(i)?;
        Some(self.before.get(i).map_or(*f, |before| times(f, before, d)))
    }

    /// Load the state of a particle into `out`.
    pub fn read(&self, i: usize, out: &mut [f64]) {
        let rows = &self.rows[i / GROUP * out.len()..];
        for (k, x) in out.iter_mut().enumerate() {
            *x = rows[k].as_ref()[i % GROUP];
        }
    }
    /// Store the state of a particle.
    pub fn write(&mut self, i: usize, state: &[f64]) {
        let rows = &mut self.rows[i / GROUP * state.len()..];
        for (k, x) in state.iter().enumerate() {
            rows[k].as_mut()[i % GROUP] = *x;
        }
    }
}
