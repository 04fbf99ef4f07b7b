//! Cut cells: distances to walls at grid nodes, open fractions of cell faces and cells.

use std::sync::Arc;

use impactite_geometry::Lattice;

use crate::blocks::{Blocks, SIDE, local, offset};
use crate::transfer::face_centre;
use crate::wall::{Wall, Walls};

/// Nodes along an edge of a block.
pub(crate) const NODES: usize = SIDE + 1;
/// Share of a cell within which a node is on a wall.
pub(crate) const ON_WALL: f64 = 1e-9;

/// Open fraction of a face beside free rigid bodies below which it is closed: liquid that they displace would be too fast in it.
pub(crate) const SLIT: f64 = 0.03;

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
    /// Cells that walls cut, with the integrals of their open part less that of the same volume spread over the cell.
    pub uneven: Vec<(u8, [Moments; 27])>,
    /// Cells with a corner less than half a cell from a wall, one bit each.
    pub near: u64,
    /// True if walls close uncut cells along two axes or more, or may do so.
    pub has_corners: bool,
    /// True if a wall that moves is in reach.
    moving: bool,
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

/// Parts of a cell along each axis.
const PARTS: usize = 4;
/// Departure from a plane, in cells, of distances at the corners of a face, from which it is cut by parts.
const BENT: f64 = 0.05;
/// Largest number of parts of a cell.
const MOST_PARTS: usize = PARTS * PARTS * PARTS;

/// Open fraction of a cell with its lowest corner at `low`, and that of its parts: mean over 4^D parts, each cut by a plane at its distance
/// from the wall. Exact for walls on grid planes, edges and corners included.
fn open_cell<const D: usize>(low: [f64; D], h: f64, walls: &Walls<'_, D>) -> (f64, [f64; MOST_PARTS]) {
    let (count, width) = (PARTS.pow(D as u32), h / PARTS as f64);
    let (mut sum, mut parts) = (0.0, [0.0; MOST_PARTS]);
    for (n, open) in parts.iter_mut().enumerate().take(count) {
        let x = std::array::from_fn(|d| low[d] + (place_of_part(n, d) as f64 + 0.5) * width);
        *open = open_part(walls.gap(x).0 / width);
        sum += *open;
    }
    (sum / count as f64, parts)
}

/// Open fraction of a part with its centre at this distance from a wall, in its widths, but for the rounding of places on grid planes.
fn open_part(gap: f64) -> f64 {
    match 0.5 + gap {
        open if open > 1.0 - ON_WALL => 1.0,
        open if open < ON_WALL => 0.0,
        open => open,
    }
}

/// True if the wall through a square with these distances at its corners 00, 10, 01, 11 is no plane: where walls meet, as along the edges of a tank,
/// polygons between corners lose half of the square.
fn is_bent(v: &[f64; 4]) -> bool {
    let open = v.iter().filter(|gap| **gap > 0.0).count();
    (1..4).contains(&open) && (v[0] + v[3] - v[1] - v[2]).abs() > BENT
}

/// Part of a face across `axis`, whose middle is at `x`, m.
struct FacePart<const D: usize> {
    x: [f64; D],
    axis: usize,
    /// Width of a cell, m.
    h: f64,
    number: usize,
}

impl<const D: usize> FacePart<D> {
    /// Place at these shares of its widths from its lower corner.
    fn place(&self, by: [f64; 2]) -> [f64; D] {
        let mut place = self.x;
        for (e, along) in (1..D).map(|e| (self.axis + e) % D).enumerate() {
            let at = place_of_part(self.number, e) as f64 + by[e] - 0.5 * PARTS as f64;
            place[along] += at * self.h / PARTS as f64;
        }
        place
    }
    fn centre(&self) -> [f64; D] {
        self.place([0.5; 2])
    }
    /// Open fraction with regard to one wall.
    fn open(&self, walls: &Walls<'_, D>, wall: usize) -> f64 {
        let gap = |a: f64, b: f64| {
            let gap = walls.gap_of(wall, &self.place([a, b])) / self.h;
            if gap.abs() < ON_WALL { 0.0 } else { gap }
        };
        if D == 2 {
            return open_edge(gap(0.0, 0.0), gap(1.0, 0.0));
        }
        let on = [gap(0.0, 0.0), gap(1.0, 0.0), gap(0.0, 1.0), gap(1.0, 1.0)];
        if is_bent(&on) { open_part(PARTS as f64 * gap(0.5, 0.5)) } else { open_square(on) }
    }
}

/// Run `task` on all parts of the face across `axis` with its middle at `x`, m; return their number.
fn each_part<const D: usize>(x: [f64; D], axis: usize, h: f64, mut task: impl FnMut(&FacePart<D>)) -> f64 {
    let count = PARTS.pow(D as u32 - 1);
    (0..count).for_each(|number| task(&FacePart { x, axis, h, number }));
    count as f64
}

/// Open fraction of the face across `axis` with its middle at `x`, m, between walls that are near: of each part, the product of the fractions that
/// they leave. Distances to the nearest of them would close what is beside a piston along a wall.
fn open_between<const D: usize>(
    walls: &Walls<'_, D>,
    near: &[usize],
    axis: usize,
    x: [f64; D],
    h: f64,
) -> f64 {
    let mut open = 0.0;
    let count = each_part(x, axis, h, |part| {
        open += near.iter().map(|n| part.open(walls, *n)).product::<f64>();
    });
    open / count
}

/// Place of part `n` of a cell along an axis.
#[inline]
fn place_of_part(n: usize, axis: usize) -> usize {
    n / PARTS.pow(axis as u32) % PARTS
}

/// Weights of the parts of a row of cells in the kernel of the liquid fraction of the middle one: along the axis of a face component, where
/// it is the mean of hat functions at both faces, and across it, the hat function at the centre. The cell at -1, 0 and 1, its parts.
const fn weights_of_parts() -> [[[f64; PARTS]; 3]; 2] {
    let mut weights = [[[0.0; PARTS]; 3]; 2];
    let mut n = 0;
    while n < 3 * PARTS {
        let (cell, part) = (n / PARTS, n % PARTS);
        // Twice the distance from the middle in parts, and from the nearest end of the kernels.
        let twice = (2 * n + 1) as f64 - (3 * PARTS) as f64;
        let s = (if twice < 0.0 { -twice } else { twice }) / (2 * PARTS) as f64;
        weights[0][cell][part] = if s > 0.5 { 0.5 * (1.5 - s) } else { 0.5 };
        weights[1][cell][part] = if s < 1.0 { 1.0 - s } else { 0.0 };
        n += 1;
    }
    weights
}
const WEIGHTS: [[[f64; PARTS]; 3]; 2] = weights_of_parts();

/// Volume, and its first moments in cells, of a body in the kernel of the liquid fraction of a cell.
pub(crate) type Moments = [f64; 4];

/// Integrals of a density, given at the parts of a cell, with the kernel of the liquid fraction of each of the 3^D cells around it.
pub(crate) fn in_kernels<const D: usize>(density: impl Fn(usize) -> f64) -> [Moments; 27] {
    let count = PARTS.pow(D as u32);
    let mut integrals = [[0.0; 4]; 27];
    for (n, integral) in integrals.iter_mut().enumerate().take(Blocks::<D>::AROUND) {
        let to = offset::<D>(n);
        for k in 0..count {
            // The cell is at -to from the receiving one.
            let weight = |along: usize, d: usize| {
                WEIGHTS[usize::from(d != along)][(1 - to[d]) as usize][place_of_part(k, d)]
            };
            let kernel: f64 = (0..D).map(|along| (0..D).map(|d| weight(along, d)).product::<f64>()).sum();
            let volume = kernel * density(k) / (count * D) as f64;
            integral[0] += volume;
            for d in 0..D {
                let place = (place_of_part(k, d) as f64 + 0.5) / PARTS as f64 - 0.5;
                integral[d + 1] += volume * (place - f64::from(to[d]));
            }
        }
    }
    integrals
}

/// Middle of a block, m, and the distance from it within which walls matter, m.
fn surroundings<const D: usize>(key: &[i32; D], lattice: &Lattice<D>) -> ([f64; D], f64) {
    let h = lattice.spacing();
    let half = 0.5 * SIDE as f64;
    let middle = std::array::from_fn(|d| lattice.origin()[d] + (f64::from(key[d]) * SIDE as f64 + half) * h);
    (middle, (half + 2.0) * (D as f64).sqrt() * h)
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
    let (middle, reach) = surroundings(key, lattice);
    if walls.gap(middle).0 > reach {
        return None;
    }
    let moving = walls.gap_of_moving(&middle) <= reach;
    let free = moving && walls.list.iter().any(Wall::follows);
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
    let (mut cell, mut near, mut partial) = (vec![1.0; cells], 0, Vec::new());
    // Slits beside bodies that the liquid moves are closed, too.
    let mut has_corners = free;
    for i in 0..cells {
        let corners = corners(&gap, &local::<D>(i));
        near |= u64::from(corners[..1 << D].iter().any(|gap| *gap < 0.5)) << i;
        let is_closed = |d: &usize| (0..2).any(|side| open_side::<D>(&corners, *d, side) <= 0.0);
        has_corners |= (0..D).filter(is_closed).count() > 1;
        let near_walls = walls_around(&nearest, &local::<D>(i));
        // Bodies have the same open parts in their own equations.
        let follow = near_walls.iter().any(|n| walls.list[*n].follows());
        for d in 0..D {
            face[d][i] = open_face::<D>(&corners, d);
            let bent = D == 3 && is_bent(&on_side::<D>(&corners, d, 0));
            if !follow && (bent || near_walls.len() > 1) {
                face[d][i] = open_between(walls, &near_walls, d, position(&face_centre::<D>(i, d)), h);
            }
            if free && face[d][i] < SLIT {
                face[d][i] = 0.0;
            }
        }
        if corners[..1 << D].iter().any(|gap| *gap < 1.0) {
            let at = local::<D>(i);
            let (open, parts) = open_cell(position(&at.map(|x| x as f64)), h, walls);
            cell[i] = open;
            if open > 0.0 && open < 1.0 {
                partial.push((i as u8, in_kernels::<D>(|k| parts[k] - open)));
            }
        }
    }
    Some(CutBlock { gap, nearest, face, cell, uneven: partial, near, has_corners, moving })
}

/// Nearest walls of the corners of a cell, sorted.
fn walls_around<const D: usize>(nearest: &[u16], at: &[usize; D]) -> Vec<usize> {
    let of = |k: usize| {
        let corner: [usize; D] = std::array::from_fn(|e| at[e] + (k >> e & 1));
        usize::from(nearest[node(&corner)])
    };
    let mut list: Vec<usize> = (0..1 << D).map(of).collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// Values at the 2^D corners of a cell; the rest is zero.
#[inline]
pub(crate) fn corners<const D: usize>(gap: &[f64], at: &[usize; D]) -> [f64; 8] {
    let mut values = [0.0; 8];
    for (k, value) in values.iter_mut().enumerate().take(1 << D) {
        let corner: [usize; D] = std::array::from_fn(|d| at[d] + (k >> d & 1));
        *value = gap[node(&corner)];
    }
    values
}

/// Open fraction of the lower face across `axis` of a cell with these distances at its corners.
fn open_face<const D: usize>(v: &[f64; 8], axis: usize) -> f64 {
    open_side::<D>(v, axis, 0)
}

/// Distances at the corners of the lower (0) or upper (1) face across `axis` of a cell with these distances at its corners; two in the plane.
fn on_side<const D: usize>(v: &[f64; 8], axis: usize, side: usize) -> [f64; 4] {
    let mut on = [0.0; 4];
    let mut count = 0;
    for (k, value) in v.iter().enumerate().take(1 << D) {
        if k >> axis & 1 == side {
            on[count] = *value;
            count += 1;
        }
    }
    on
}

/// Open fraction of the lower (0) or upper (1) face across `axis` of a cell with these distances at its corners.
pub(crate) fn open_side<const D: usize>(v: &[f64; 8], axis: usize, side: usize) -> f64 {
    let on = on_side::<D>(v, axis, side);
    if D == 2 { open_edge(on[0], on[1]) } else { open_square(on) }
}

/// Cut all blocks. Cuts of `before` are reused for blocks that were there, if no wall that moves is or was in reach.
pub(crate) fn cut<const D: usize>(
    blocks: &Blocks<D>,
    before: (&Blocks<D>, &Cuts<D>),
    lattice: &Lattice<D>,
    walls: &Walls<'_, D>,
) -> Cuts<D> {
    let any = walls.moving();
    let away = |key: &[i32; D]| {
        let (middle, reach) = surroundings(key, lattice);
        walls.gap_of_moving(&middle) > reach
    };
    blocks
        .keys
        .iter()
        .map(|key| match before.1.get(before.0.find(key) as usize) {
            Some(cut) if !any || (cut.as_ref().is_none_or(|cut| !cut.moving) && away(key)) => cut.clone(),
            _ => cut_block(key, lattice, walls).map(Arc::new),
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

    /// Nearest walls of the corners of the cell of a point, sorted; `at` is in cells from the corner of the block, 0 to 4.
    fn around(&self, at: &[f64; D]) -> Vec<usize> {
        walls_around(&self.nearest, &at.map(|x| (x as usize).min(SIDE - 1)))
    }

    /// Index of the wall at a point, `at` in the block of the cut and at the place `x`, m, that the nearest corner has at `found`: where walls meet,
    /// the one in which the point is deepest, since corners on several walls name one of them. Beside bodies that the liquid moves it is `found`, as
    /// in their equations.
    pub fn wall_at(&self, walls: &Walls<'_, D>, at: &[f64; D], found: usize, x: &[f64; D]) -> usize {
        let near = self.around(at);
        if near.len() < 2 || near.iter().any(|n| walls.list[*n].follows()) {
            return found;
        }
        let gaps = near.into_iter().map(|n| (walls.gap_of(n, x), n));
        gaps.fold((f64::INFINITY, found), |least, gap| if gap.0 < least.0 { gap } else { least }).1
    }
    /// Mean velocity along `axis` of the closed part, `closed` of the whole, of the lower face across it, `at` in the block and with its centre at
    /// `x`, m. Where walls meet each part of the face has that of its wall; what is in several walls is behind the one that moves least: there,
    /// a piston pushes nothing. None if one wall is near, or bodies that the liquid moves are, which have equations of their own.
    pub fn closed_velocity(
        &self,
        walls: &Walls<'_, D>,
        (at, axis, closed): (&[f64; D], usize, f64),
        (x, h): (&[f64; D], f64),
    ) -> Option<f64> {
        let near = self.around(at);
        if near.len() < 2 || closed <= 0.0 || near.iter().any(|n| walls.list[*n].follows()) {
            return None;
        }
        let mut flux = 0.0;
        let count = each_part(*x, axis, h, |part| {
            let of_wall = |n: &usize| [walls.velocity(*n, &part.centre(), axis), part.open(walls, *n)];
            let mut of_walls: Vec<[f64; 2]> = near.iter().map(of_wall).collect();
            of_walls.sort_by(|a, b| a[0].abs().total_cmp(&b[0].abs()));
            let mut left = 1.0;
            for [velocity, open] in of_walls {
                flux += left * (1.0 - open) * velocity;
                left *= open;
            }
        });
        Some(flux / (count * closed))
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
