//! Cells that particles of a snapshot stand for, where they are elements.

use super::{OutputError, check_length};

/// For each particle the corners of its cell, or none: a snapshot of elements, or of elements beside particles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cells {
    /// Corners, each once, m.
    pub nodes: Vec<[f64; 3]>,
    /// Those of the cells by place in `nodes`, one cell after the other, in the order of the VTK file format: none (a vertex), two (a line),
    /// three (a triangle), four (in two dimensions a quadrilateral, in three a tetrahedron), eight (in three a brick), or in two dimensions
    /// any more (a polygon).
    pub corners: Vec<u32>,
    /// Where the corners of each particle end in `corners`.
    pub ends: Vec<u32>,
}

impl Cells {
    /// Corners of the cell of particle `i`.
    #[must_use]
    pub fn of(&self, i: usize) -> &[u32] {
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.corners[start as usize..self.ends[i] as usize]
    }

    /// The type of a cell of so many corners, as VTK numbers them.
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

    /// Refuse what is no list of cells of so many particles.
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
