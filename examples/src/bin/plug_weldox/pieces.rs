//! What of the plate hangs together.

use mpm_core::geometry::search::{NeighbourSearch, Points, Reach, SearchError, SortedCells};

/// Particles hang together up to so many spacings apart.
const REACH: f64 = 1.5;

/// Numbers of the pieces that particles belong to, which hang together up to one and a half spacings apart: the smallest number of a
/// particle of each.
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

/// The particle that stands for the piece of another one; the way there is halved.
fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        parents[i as usize] = parents[parents[i as usize] as usize];
        i = parents[i as usize];
    }
    i
}
