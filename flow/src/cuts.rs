//! Cut cells: distances to walls at grid nodes, open fractions of cell faces and cells.

use std::sync::Arc;

use impactite_geometry::Lattice;

use crate::blocks::{Blocks, SIDE, local};
use crate::wall::Walls;

/// Nodes along an edge of a block.
const NODES: usize = SIDE + 1;
/// Share of a cell within which a node is on a wall.
const ON_WALL: f64 = 1e-9;

/// Walls in a block of cells.
#[derive(Clone, Debug)]
pub(crate) struct CutBlock<const D: usize> {
    /// Distance to the nearest wall at the 5^D nodes, in cells: negative in the wall.
    pub gap: Vec<f64>,
    /// Index of the nearest wall at the nodes.
    pub nearest: Vec<u16>,
    /// Open fraction of the lower face of each cell, for each axis.
    pub face: [Vec<f64>; D],
    /// Open fraction of each cell.
    pub cell: Vec<f64>,
    /// Cells with a corner less than half a cell from a wall, one bit each.
    pub near: u64,
}

/// Walls in each block; none where a block is open.
pub(crate) type Cuts<const D: usize> = Vec<Option<Arc<CutBlock<D>>>>;

/// Index of a node of a block.
#[inline(always)]
fn node<const D: usize>(at: &[usize; D]) -> usize {
    at.iter().rev().fold(0, |sum, x| sum * NODES + x)
}

/// Open fraction of an edge between nodes at these distances from the wall.
#[inline]
fn open_edge(a: f64, b: f64) -> f64 {
    match (a > 0.0, b > 0.0) {
        (true, true) => 1.0,
        (false, false) => 0.0,
        (true, false) => a / (a - b),
        (false, true) => b / (b - a),
    }
}

/// Open fraction of a square with these distances from the wall at its corners 00, 10, 01, 11: polygons cut by linear interpolation along
/// the edges.
fn open_square(v: [f64; 4]) -> f64 {
    // Corners in the order around the square.
    let ring = [v[0], v[1], v[3], v[2]];
    let open = ring.iter().filter(|x| **x > 0.0).count();
    match open {
        0 => return 0.0,
        4 => return 1.0,
        _ => {}
    }
    let edge = |i: usize| open_edge(ring[i], ring[(i + 1) % 4]);
    let corner = |i: usize| 0.5 * edge(i) * edge((i + 3) % 4);
    let closed = |i: usize| 0.5 * (1.0 - edge(i)) * (1.0 - edge((i + 3) % 4));
    let is = |i: usize| ring[i % 4] > 0.0;
    match open {
        1 => (0..4).filter(|i| is(*i)).map(corner).sum(),
        3 => 1.0 - (0..4).filter(|i| !is(*i)).map(closed).sum::<f64>(),
        _ => {
            if let Some(i) = (0..4).find(|i| is(*i) && is(i + 1)) {
                // Two adjacent corners: a trapezium.
                0.5 * (edge((i + 1) % 4) + edge((i + 3) % 4))
            } else if v.iter().sum::<f64>() > 0.0 {
                1.0 - (0..4).filter(|i| !is(*i)).map(closed).sum::<f64>()
            } else {
                (0..4).filter(|i| is(*i)).map(corner).sum()
            }
        }
    }
}

/// Open fraction of a cell with its lowest corner at `low`: mean over 4^D parts, each cut by a plane at its distance from the wall. Exact for
/// walls on grid planes, edges and corners included.
fn open_cell<const D: usize>(low: [f64; D], h: f64, walls: &Walls<'_, D>) -> f64 {
    const PARTS: usize = 4;
    let (count, width) = (PARTS.pow(D as u32), h / PARTS as f64);
    let mut sum = 0.0;
    for n in 0..count {
        let mut rest = n;
        let x = std::array::from_fn(|d| {
            let part = rest % PARTS;
            rest /= PARTS;
            low[d] + (part as f64 + 0.5) * width
        });
        let part = 0.5 + walls.gap(x).0 / width;
        // Rounding of places on grid planes.
        sum += if part > 1.0 - ON_WALL {
            1.0
        } else if part < ON_WALL {
            0.0
        } else {
            part
        };
    }
    sum / count as f64
}

/// Cut a block of cells by the walls; none if the block and the cells around it are open.
fn cut_block<const D: usize>(
    key: &[i32; D],
    lattice: &Lattice<D>,
    walls: &Walls<'_, D>,
) -> Option<CutBlock<D>> {
    let h = lattice.spacing();
    let position = |at: &[f64; D]| -> [f64; D] {
        std::array::from_fn(|d| lattice.origin()[d] + (f64::from(key[d]) * SIDE as f64 + at[d]) * h)
    };
    let middle = position(&[0.5 * SIDE as f64; D]);
    let reach = (0.5 * SIDE as f64 + 2.0) * (D as f64).sqrt() * h;
    if walls.gap(middle).0 > reach {
        return None;
    }
    let nodes = NODES.pow(D as u32);
    let (mut gap, mut nearest) = (vec![0.0; nodes], vec![0; nodes]);
    for n in 0..nodes {
        let mut rest = n;
        let at: [f64; D] = std::array::from_fn(|_| {
            let part = rest % NODES;
            rest /= NODES;
            part as f64
        });
        let (distance, wall) = walls.gap(position(&at));
        let distance = distance / h;
        gap[n] = if distance.abs() < ON_WALL { 0.0 } else { distance };
        nearest[n] = wall as u16;
    }
    let cells = Blocks::<D>::CELLS;
    let mut face: [Vec<f64>; D] = std::array::from_fn(|_| vec![1.0; cells]);
    let (mut cell, mut near) = (vec![1.0; cells], 0);
    for i in 0..cells {
        let corners = corners(&gap, &local::<D>(i));
        near |= u64::from(corners[..1 << D].iter().any(|gap| *gap < 0.5)) << i;
        for d in 0..D {
            face[d][i] = open_face::<D>(&corners, d);
        }
        if corners[..1 << D].iter().any(|gap| *gap < 1.0) {
            let at = local::<D>(i);
            cell[i] = open_cell(position(&at.map(|x| x as f64)), h, walls);
        }
    }
    Some(CutBlock { gap, nearest, face, cell, near })
}

/// Values at the 2^D corners of a cell; the rest is zero.
#[inline]
fn corners<const D: usize>(gap: &[f64], at: &[usize; D]) -> [f64; 8] {
    let mut values = [0.0; 8];
    for (k, value) in values.iter_mut().enumerate().take(1 << D) {
        let corner: [usize; D] = std::array::from_fn(|d| at[d] + (k >> d & 1));
        *value = gap[node(&corner)];
    }
    values
}

/// Open fraction of the lower face across `axis` of a cell with these distances at its corners.
fn open_face<const D: usize>(v: &[f64; 8], axis: usize) -> f64 {
    let mut on = [0.0; 4];
    let mut count = 0;
    for (k, value) in v.iter().enumerate().take(1 << D) {
        if k >> axis & 1 == 0 {
            on[count] = *value;
            count += 1;
        }
    }
    if D == 2 { open_edge(on[0], on[1]) } else { open_square(on) }
}

/// Cut all blocks. Cuts of `before` are reused for blocks that were there, if no wall moves.
pub(crate) fn cut<const D: usize>(
    blocks: &Blocks<D>,
    before: (&Blocks<D>, &Cuts<D>),
    lattice: &Lattice<D>,
    walls: &Walls<'_, D>,
) -> Cuts<D> {
    let reuse = !walls.moving();
    blocks
        .keys
        .iter()
        .map(|key| {
            let old = if reuse { before.0.find(key) } else { crate::blocks::NONE };
            match before.1.get(old as usize) {
                Some(cut) => cut.clone(),
                None => cut_block(key, lattice, walls).map(Arc::new),
            }
        })
        .collect()
}

impl<const D: usize> CutBlock<D> {
    /// True if a place is in a cell with a corner less than half a cell from a wall. `at` is in cells from the corner of the block, 0 to 4.
    #[inline]
    pub fn is_near(&self, at: &[f64; D]) -> bool {
        let cell = at.iter().rev().fold(0, |sum, y| sum * SIDE + (*y as usize).min(SIDE - 1));
        self.near >> cell & 1 == 1
    }

    /// Distance to the wall at a point, in cells, its gradient, and the nearest wall. `at` is in cells from the corner of the block, 0 to 4.
    pub fn sample(&self, at: &[f64; D]) -> (f64, [f64; D], usize) {
        let (mut low, mut part) = ([0; D], [0.0; D]);
        for d in 0..D {
            low[d] = (at[d] as usize).min(SIDE - 1);
            part[d] = at[d] - low[d] as f64;
        }
        let v = corners(&self.gap, &low);
        let (mut gap, mut slope, mut nearest) = (0.0, [0.0; D], (f64::INFINITY, 0));
        for (k, value) in v.iter().enumerate().take(1 << D) {
            let weight = |d: usize| if k >> d & 1 == 1 { part[d] } else { 1.0 - part[d] };
            gap += value * (0..D).map(weight).product::<f64>();
            for d in 0..D {
                let sign = if k >> d & 1 == 1 { 1.0 } else { -1.0 };
                slope[d] += sign * value * (0..D).filter(|e| *e != d).map(weight).product::<f64>();
            }
            if *value < nearest.0 {
                let corner: [usize; D] = std::array::from_fn(|d| low[d] + (k >> d & 1));
                nearest = (*value, usize::from(self.nearest[node(&corner)]));
            }
        }
        (gap, slope, nearest.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_fractions_of_planes_are_exact() {
        // Planes n.x = c through the unit square: areas by clipping.
        assert_eq!(open_square([1.0, 1.0, 1.0, 1.0]), 1.0);
        assert_eq!(open_square([0.0, 0.0, 1.0, 1.0]), 1.0);
        assert!((open_square([-0.25, -0.25, 0.75, 0.75]) - 0.75).abs() < 1e-15);
        assert!((open_square([0.5, -0.5, -0.5, -1.5]) - 0.125).abs() < 1e-15);
        assert!((open_square([-0.5, 0.5, 0.5, 1.5]) - 0.875).abs() < 1e-15);
        // Across x with different cuts below and above.
        assert!((open_square([0.2, -0.8, 0.6, -0.4]) - 0.4).abs() < 1e-15);
        let cell = [-0.25, 0.75, -0.25, 0.75, -0.25, 0.75, -0.25, 0.75];
        assert!((open_face::<3>(&cell, 1) - 0.75).abs() < 1e-15);
        assert_eq!(open_face::<3>(&cell, 0), 0.0);
    }
}
