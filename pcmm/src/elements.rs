//! Elements, and their incidence at particles.

use std::sync::OnceLock;

use impactite_simd::Float;

/// Number of elements of a batch, the work of one task; a multiple of the lanes of every vector.
pub(crate) const BATCH: usize = 256;
/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;

pub(crate) type Row = <f64 as Float>::Row;

/// Incidence of elements: for each particle the element corners at it, in ascending order of elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Incidence {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Incidence {
    /// Create the incidence of the elements `nodes` on `particles` particles.
    pub fn of_elements(nodes: &[u32], particles: usize) -> Self {
        let mut starts = vec![0u32; particles + 1];
        for &n in nodes {
            starts[n as usize + 1] += 1;
        }
        for i in 0..particles {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut corners = vec![0; nodes.len()];
        for (at, &n) in nodes.iter().enumerate() {
            corners[next[n as usize] as usize] = at as u32;
            next[n as usize] += 1;
        }
        Incidence { starts, corners }
    }

    /// Return the corners at particle `i`: element times `D + 1` plus the corner's number in it.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.corners[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

/// Batch of elements, the work of one task, and the report of a sweep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch {
    /// State variables of the elements: groups of rows, one row per number.
    pub rows: Vec<Row>,
    pub report: Report,
}

/// Results of a sweep over a batch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Report {
    /// Largest wave speed over smallest altitude, 1/s.
    pub rate: f64,
    /// First element whose law failed, by number in the batch, and the cause.
    pub trouble: Option<(usize, mpm_materials::Breakdown)>,
}

/// All elements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elements {
    /// `D + 1` particles per element.
    pub nodes: Vec<u32>,
    /// Reference volume of each element: mass over reference density.
    pub reference: Vec<f64>,
    pub batches: Vec<Batch>,
    pub incidence: Incidence,
    /// Flags of particles that are not surrounded, computed on demand.
    pub open: OnceLock<Vec<bool>>,
    /// Number of state variables.
    pub numbers: usize,
}

impl Elements {
    pub fn len(&self) -> usize {
        self.reference.len()
    }

    /// Load the state of element `e` into `out`.
    pub fn read(&self, e: usize, out: &mut [f64]) {
        let rows = &self.batches[e / BATCH].rows[e % BATCH / GROUP * self.numbers..];
        for (k, x) in out.iter_mut().enumerate() {
            *x = rows[k].as_ref()[e % GROUP];
        }
    }

    /// Assemble elements `nodes` with reference volumes and states (numbers in sequence). Lanes without an element are virgin.
    pub fn assemble(
        nodes: Vec<u32>,
        reference: Vec<f64>,
        states: &[f64],
        virgin: &[f64],
        particles: usize,
    ) -> Self {
        let (elements, numbers) = (reference.len(), virgin.len());
        let mut batches = vec![Batch::default(); elements.div_ceil(BATCH)];
        for (b, batch) in batches.iter_mut().enumerate() {
            let here = (elements - b * BATCH).min(BATCH);
            batch.rows = vec![Row::default(); here.div_ceil(GROUP) * numbers];
            for (at, row) in batch.rows.iter_mut().enumerate() {
                let (group, k) = (at / numbers, at % numbers);
                for lane in 0..GROUP {
                    let e = b * BATCH + group * GROUP + lane;
                    row.as_mut()[lane] = if e < elements { states[e * numbers + k] } else { virgin[k] };
                }
            }
        }
        let incidence = Incidence::of_elements(&nodes, particles);
        Elements { nodes, reference, batches, incidence, open: OnceLock::new(), numbers }
    }

    pub fn bytes(&self) -> usize {
        let rows: usize = self.batches.iter().map(|b| b.rows.capacity() * size_of::<Row>()).sum();
        rows + self.nodes.capacity() * 2 * size_of::<u32>() + self.reference.capacity() * size_of::<f64>()
    }
}
