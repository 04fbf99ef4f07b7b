//! Batches of elements, and their memory layout.

use impactite_simd::{Float, RowPair};
use mpm_materials::Breakdown;

/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;
/// Number of elements of an octet.
pub(crate) const OCTET: usize = 2 * GROUP;
/// Number of elements of a batch.
pub(crate) const BATCH: usize = 64;
/// Maximum number of groups of integration points of a batch.
pub(super) const MOST_GROUPS: usize = BATCH / GROUP * 8;

pub(crate) type Row = <f64 as Float>::Row;
/// One number of each element of an octet.
pub(crate) type Rows = RowPair<Row>;
/// Contribution of a batch to a node: a vector, and one more number.
pub(crate) type Record = [f64; 4];

/// Node data of a batch in one cache line: position, nodal average, velocity.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Moving(pub [f64; 8]);

/// Maximum number of nodes of a batch, a power of two: an index modulo this length needs no bounds check.
pub(crate) const MOST_NODES: usize = BATCH * 8;
/// Nodes of a batch.
pub(crate) type Nodes = [Moving; MOST_NODES];

/// Lane `k` of a row pair.
#[inline(always)]
pub(crate) fn lane(rows: &Rows, k: usize) -> f64 {
    rows.0[k / GROUP].as_ref()[k % GROUP]
}

/// Mutable lane `k` of a row pair.
#[inline(always)]
pub(crate) fn lane_mut(rows: &mut Rows, k: usize) -> &mut f64 {
    &mut rows.0[k / GROUP].as_mut()[k % GROUP]
}

/// Batch of elements, which one task computes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch {
    /// Number of elements.
    pub elements: usize,
    /// Node numbers in the body.
    pub nodes: Vec<u32>,
    /// Corners of the elements as indices into `nodes`: for each octet and corner those of eight elements.
    pub corners: Vec<u16>,
    /// Size of each element, m, and the least lumped mass of its corners, kg.
    pub sizes: Vec<[Rows; 2]>,
    /// Reference volume of every integration point, point by point in an octet; zero without an element, or after its removal.
    pub reference: Vec<Rows>,
    /// State variables of the points: one row a variable, group by group: (octet, point, half).
    pub rows: Vec<Row>,
    /// History of elements beside the states: hourglass forces on the modes, and hourglass energy; for bars the ratio of lateral to axial
    /// strain.
    pub kept: Vec<Rows>,
    /// Report of the last sweep.
    pub report: Report,
}

impl Batch {
    pub fn octets(&self) -> usize {
        self.sizes.len()
    }
    /// True if element `e` exists and was not removed.
    pub fn alive(&self, e: usize, points: usize) -> bool {
        e < self.elements && lane(&self.reference[e / OCTET * points], e % OCTET) > 0.0
    }
    /// Read the state of a point of element `e`.
    pub fn read(&self, e: usize, (point, points): (usize, usize), out: &mut [f64]) {
        let group = (e / OCTET * points + point) * 2 + e % OCTET / GROUP;
        let rows = &self.rows[group * out.len()..(group + 1) * out.len()];
        for (x, row) in out.iter_mut().zip(rows) {
            *x = row.as_ref()[e % GROUP];
        }
    }
    /// State variable number `place` of `numbers`, at a point of element `e`.
    pub fn number(&self, e: usize, (point, points): (usize, usize), (place, numbers): (usize, usize)) -> f64 {
        let group = (e / OCTET * points + point) * 2 + e % OCTET / GROUP;
        self.rows[group * numbers + place].as_ref()[e % GROUP]
    }
    /// Write the state of a point of element `e`.
    pub fn write(&mut self, e: usize, (point, points): (usize, usize), state: &[f64]) {
        let group = (e / OCTET * points + point) * 2 + e % OCTET / GROUP;
        let rows = &mut self.rows[group * state.len()..(group + 1) * state.len()];
        for (row, x) in rows.iter_mut().zip(state) {
            row.as_mut()[e % GROUP] = *x;
        }
    }
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * 4
            + self.corners.capacity() * 2
            + self.sizes.capacity() * size_of::<[Rows; 2]>()
            + (self.reference.capacity() + self.kept.capacity()) * size_of::<Rows>()
            + self.rows.capacity() * size_of::<Row>()
    }
}

/// Report of a sweep over a batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    /// Half the largest frequency bound of an element, 1/s: the stability limit of the time step is its reciprocal.
    pub rate: f64,
    /// First failed element, by index in the batch, and the cause.
    pub trouble: Option<(usize, Trouble)>,
    /// Removed elements.
    pub left: Vec<Left>,
}

/// Element removed from its batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// Index in the batch.
    pub element: usize,
    /// Internal energy, hourglass energy included, and hourglass energy, J.
    pub energy: f64,
    pub hourglass: f64,
    pub reason: Reason,
}

/// Reason for the removal of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    Erosion,
    /// Conversion by the criterion of this number.
    Conversion(u32),
}

/// Cause of a failed element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// Inverted element: det J <= 0 at an integration point.
    Inverted,
    /// Breakdown of the law.
    Law(Breakdown),
}
