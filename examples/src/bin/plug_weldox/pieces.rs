//! Connected pieces of the plate.

use mpm_core::geometry::search::{NeighbourSearch, Points, Reach, SearchError, SortedCells};

/// Largest distance of connected particles, in spacings.
const REACH: f64 = 1.5;

/// Label the connected pieces of particles, which are connected up to one and a half spacings apart. The label is the smallest particle
/// index of the piece.
pub fn pieces(positions: &[[f64; 2]], spacings: &[f64]) -> Result<Vec<u32>, SearchError> {
    let radii: Vec<f64> = spacings.iter().map(|s| 0.5 * s).collect();
    let points = Points::new(positions, &radii)?;
    let cells = SortedCells::new(&points, Reach::Sum { factor: REACH, tolerance: 0.0 })?;
    let mut parents: Vec<u32> = (0..positions.len() as u32).collect();
    cells.each_pair(|i, j| {
        let (a, b) = (root(&mut parents, i), root(&mut parents, j));
        parents[a.max(b) as usize] = a.min(b);
    });
    Ok((0..positions.len() as u32).map(|i| root(&mut parents, i)).collect())
}

/// Return the representative particle of a piece (union-find with path halving).
fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
}
