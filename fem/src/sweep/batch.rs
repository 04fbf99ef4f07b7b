//! Batches of elements, and their numbers in memory.

use impactite_simd::{Float, RowPair};
use mpm_materials::Breakdown;

/// Lanes of a group.
pub(crate) const GROUP: usize = <f64 as Float>::GROUP;
/// Elements side by side.
pub(crate) const OCTET: usize = 2 * GROUP;
/// Elements of a batch.
pub(crate) const BATCH: usize = 64;
/// Most groups of integration points of a batch.
pub(super) const MOST_GROUPS: usize = BATCH / GROUP * 8;

pub(crate) type Row = <f64 as Float>::Row;
/// A number of the elements of an octet.
pub(crate) type Rows = RowPair<Row>;
/// What the elements of a batch give to a node: a vector, and one more number.
pub(crate) type Record = [f64; 4];

/// A node of a batch in one line of the cache: position, what is averaged over nodes, velocity.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Moving(pub [f64; 8]);

/// Most nodes of a batch, a power of two: a place in a list of so many needs no look at its length.
pub(crate) const MOST_NODES: usize = BATCH * 8;
/// The nodes of a batch.
pub(crate) type Nodes = [Moving; MOST_NODES];

/// A number of a row pair.
#[inline(always)]
pub(crate) fn lane(rows: &Rows, k: usize) -> f64 {
    rows.0[k / GROUP].as_ref()[k % GROUP]
}

/// The same, to be changed.
#[inline(always)]
pub(crate) fn lane_mut(rows: &mut Rows, k: usize) -> &mut f64 {
    &mut rows.0[k / GROUP].as_mut()[k % GROUP]
}

/// Elements that one task computes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch {
    /// How many there are.
    pub elements: usize,
    /// The nodes, by number in the body.
    pub nodes: Vec<u32>,
    /// Corners of the elements by place in that list: for each octet and corner those of eight elements.
    pub corners: Vec<u16>,
    /// Size of each element, m, and the least mass of its corners, kg.
    pub sizes: Vec<[Rows; 2]>,
    /// Reference volume of every integration point, point by point in an octet; zero where no element is, or none is left.
    pub reference: Vec<Rows>,
    /// States of the points: a row a number, group by group: (octet, point, half).
    pub rows: Vec<Row>,
    /// What elements keep beside: hourglass forces on the modes, and the energy in them; the lateral strain of bars.
    pub kept: Vec<Rows>,
    /// What the last sweep found.
    pub report: Report,
}

impl Batch {
    pub fn octets(&self) -> usize {
        self.sizes.len()
    }
    /// Is element `e` there?
    pub fn alive(&self, e: usize, points: usize) -> bool {
        e < self.elements && lane(&self.reference[e / OCTET * points], e % OCTET) > 0.0
    }
    /// The state of a point of element `e`.
    pub fn read(&self, e: usize, (point, points): (usize, usize), out: &mut [f64]) {
        let group = (e / OCTET * points + point) * 2 + e % OCTET / GROUP;
        let rows = &self.rows[group * out.len()..(group + 1) * out.len()];
        for (x, row) in out.iter_mut().zip(rows) {
            *x = row.as_ref()[e % GROUP];
        }
    }
    /// One number of it, of so many.
    pub fn number(&self, e: usize, (point, points): (usize, usize), (place, numbers): (usize, usize)) -> f64 {
        let group = (e / OCTET * points + point) * 2 + e % OCTET / GROUP;
        self.rows[group * numbers + place].as_ref()[e % GROUP]
    }
    /// Set it.
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

/// What a sweep over a batch found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Report {
    /// The largest frequency bound of an element, half of it, 1/s: a step is stable below one over this.
    pub rate: f64,
    /// The first element that cannot go on, by place in the batch.
    pub trouble: Option<(usize, Trouble)>,
    /// Elements that left.
    pub left: Vec<Left>,
}

/// An element that left its batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Left {
    /// Its place in the batch.
    pub element: usize,
    /// Its internal energy, that of hourglass forces included, and that, J.
    pub energy: f64,
    pub hourglass: f64,
    pub reason: Reason,
}

/// Why an element leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reason {
    Erosion,
    /// It becomes something else, by the criterion of this number.
    Conversion(u32),
}

/// Why an element cannot go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Trouble {
    /// It is inside out.
    Inverted,
    /// Its law broke down.
    Law(Breakdown),
}
