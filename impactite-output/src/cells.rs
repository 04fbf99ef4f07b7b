//! Cells of particles that represent elements.

use super::{OutputError, check_length};

/// Cells of the particles of a snapshot, for elements or for elements beside particles; a free particle has no corners.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cells {
    /// Node positions, without duplicates, m.
    pub nodes: Vec<[f64; 3]>,
    /// Connectivity: node indices of the corners, one cell after the other, in the order of the VTK file format: none (a vertex), two (a
    /// line), three (a triangle), four (a quadrilateral in two dimensions, a tetrahedron in three), eight (a brick in three dimensions), or
    /// in two dimensions any larger number (a polygon).
    pub corners: Vec<u32>,
    /// End of the corners of each particle in `corners`.
    pub ends: Vec<u32>,
}

impl Cells {
    /// Node indices of the corners of the cell of particle `i`.
    #[must_use]
    pub fn of(&self, i: usize) -> &[u32] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.corners[start as usize..self.ends[i] as usize]
    }

    /// Return the VTK type number of a cell with this number of corners.
    pub(crate) fn kind(corners: usize, dimension: usize) -> Option<u8> {
        match (corners, dimension) {
            (0, _) => Some(1),
            (2, _) => Some(3),
            (3, _) => Some(5),
            (4, 2) => Some(9),
            (4, _) => Some(10),
            (8, 3) => Some(12),
            (5.., 2) => Some(7),
            _ => None,
        }
    }

    /// Check the lists against the number of particles.
    pub(crate) fn check(&self, particles: usize, dimension: usize) -> Result<(), OutputError> {
        check_length("ends of cells", self.ends.len(), particles)?;
        let end = self.ends.last().map_or(0, |&end| end as usize);
        check_length("corners of cells", self.corners.len(), end)?;
        if !self.ends.is_sorted() {
            return Err(OutputError::value("ends of cells", "a list that falls", "one that rises"));
        }
        if let Some(corner) = self.corners.iter().find(|&&corner| corner as usize >= self.nodes.len()) {
            return Err(OutputError::value("corner of a cell", corner, "the place of a node"));
        }
        let count = (0..particles).map(|i| self.of(i).len());
        match count.into_iter().find(|&n| Cells::kind(n, dimension).is_none()) {
            Some(n) => Err(OutputError::value(
                "corners of a cell",
                n,
                "0, 2, 3, 4, in space 8, or in the plane any more",
            )),
            None => Ok(()),
        }
    }
}
