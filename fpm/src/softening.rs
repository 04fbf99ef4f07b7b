//! List of softening faces, and stiffness of the material against their openings.

use crate::vector::{Tensor, largest_row};

/// Threshold of the blocks of K, over the geometric mean of the stiffnesses of both faces against their own openings: smaller blocks are
/// dropped. In space there are hundreds around a face; with 0.003 a bar of random cells dissipates 0.2 per cent less work, with 0.01 it is
/// not stable.
const NEAR: f64 = 0.001;
/// Place of a face that does not soften.
const GONE: u32 = u32::MAX;

/// Softening faces, and stiffness of the material against their openings.
#[derive(Clone, Debug, Default)]
pub(crate) struct Softening<const D: usize> {
    /// Numbers of the softening faces among open faces, in order.
    pub cracks: Vec<u32>,
    /// Column of K = -dT/d delta of each face, N/m: the faces on which it acts, itself first.
    pub columns: Vec<Vec<(u32, Tensor<D>)>>,
    /// Place of each open face in this list; for each place the columns that act on it, with the index in each column.
    pub places: Vec<u32>,
    pub later: Vec<Vec<[u32; 2]>>,
    /// Cells of softening faces, and these with their neighbours.
    pub cells: Vec<u32>,
    pub around: Vec<u32>,
}

impl<const D: usize> Softening<D> {
    pub fn bytes(&self) -> usize {
        let entries: usize = self.columns.iter().map(|c| c.capacity()).sum();
        entries * size_of::<(u32, Tensor<D>)>()
            + 8 * self.later.iter().map(|l| l.capacity()).sum::<usize>()
            + 4 * (self.cracks.capacity() + self.cells.capacity() + self.around.capacity())
            + 4 * self.places.capacity()
    }

    /// Drop small blocks, and link each face to the columns that act on it.
    pub fn link(&mut self, cracks: usize) {
        self.places.clear();
        self.places.resize(cracks, GONE);
        for (n, &crack) in self.cracks.iter().enumerate() {
            self.places[crack as usize] = n as u32;
        }
        self.later.iter_mut().for_each(Vec::clear);
        self.later.resize(self.cracks.len(), Vec::new());
        let own: Vec<f64> = self.columns.iter().map(|column| largest_row(&column[0].1)).collect();
        for (n, column) in self.columns.iter_mut().enumerate() {
            column.retain(|(crack, block)| {
                let m = self.places[*crack as usize];
                m != GONE && largest_row(block).powi(2) >= NEAR * NEAR * own[n] * own[m as usize]
            });
            for (at, (crack, _)) in column.iter().enumerate().skip(1) {
                self.later[self.places[*crack as usize] as usize].push([n as u32, at as u32]);
            }
        }
    }
}
