//! Connected pieces of the cloud on the grid: neighbouring cells with particles belong together.

use std::collections::{BTreeMap, BTreeSet};

use mpm_core::output::Snapshot;

use crate::setup::THICKNESS;

/// Pieces of the material behind the plate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts {
    /// Number of pieces, connected by faces, edges or corners of cells.
    pub pieces: usize,
    /// Number of cells with particles.
    pub cells: usize,
    /// Number of cells without a neighbour.
    pub alone: usize,
}

/// Count the pieces of a snapshot on cells of size `h`, m.
pub fn parts(snapshot: &Snapshot, h: f64) -> Parts {
    let mut cells: BTreeSet<[i64; 3]> = BTreeSet::new();
    for x in snapshot.positions().iter().filter(|x| x[0] > THICKNESS) {
        cells.insert(x.map(|c| (c / h).floor() as i64));
    }
    let mut piece: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    let mut sizes = Vec::new();
    for &first in &cells {
        if piece.contains_key(&first) {
            continue;
        }
        let (mut open, mut size) = (vec![first], 0);
        piece.insert(first, sizes.len());
        while let Some(cell) = open.pop() {
            size += 1;
            for n in 0..27 {
                let near = [cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1];
                if cells.contains(&near) && !piece.contains_key(&near) {
                    piece.insert(near, sizes.len());
                    open.push(near);
                }
            }
        }
        sizes.push(size);
    }
    Parts { pieces: sizes.len(), cells: cells.len(), alone: sizes.iter().filter(|&&s| s == 1).count() }
}
