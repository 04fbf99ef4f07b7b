//! Space that particles occupy at the nodes: sums over particles, fits of their surroundings, and deviations from the open space.

use crate::dim::{BLOCK, block_nodes, neighbours};
use impactite_scene::boundary::{Boundary, Side};
use impactite_simd::Team;

/// Least occupancy of the nodes around a node in the interior of the liquid.
pub(in crate::step) const INTERIOR: f64 = 0.85;
/// Least occupancy of the nodes around a node that has at most a small deviation by the shape of the surface.
pub(in crate::step) const NEAR_SURFACE: f64 = 0.5;
/// Deviation of the occupancy near the surface that is no error: 1/48 for a flat surface one cell above a node.
pub(in crate::step) const SURFACE: f64 = 0.03;
/// Least open fraction of a node whose occupancy is known.
pub(in crate::step) const OPEN: f64 = 0.1;
/// Nodes of the stencil of an axis, and of a tile.
pub(in crate::step) const NODES: usize = 3;
pub(in crate::step) const TILE: usize = BLOCK + NODES - 1;
/// Least pivot of a least squares fit, h^2.
pub(in crate::step) const PIVOT: f64 = 0.01;

/// Sums over the particles of a block at the nodes that they reach.
#[derive(Clone, Debug)]
pub struct Tile<const D: usize> {
    pub(in crate::step) coordinates: [i32; D],
    /// `numbers` values per node: occupied volume in cells; with moments also those of [`moments`].
    pub(in crate::step) sums: Vec<f64>,
}

/// Number of moments of a node: w, w x, w x x, w (J - 1), w (J - 1) x.
pub(in crate::step) const fn moments(d: usize) -> usize {
    2 + 2 * d + d * (d + 1) / 2
}

/// Open space between planes: lowest and highest coordinate along each axis, m.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Open<const D: usize> {
    pub(in crate::step) low: [f64; D],
    pub(in crate::step) high: [f64; D],
}

/// Integral of the quadratic B-spline of spacing one from minus infinity.
pub(in crate::step) fn integral(u: f64) -> f64 {
    match u {
        u if u <= -1.5 => 0.0,
        u if u < -0.5 => (u + 1.5).powi(3) / 6.0,
        u if u < 0.5 => 0.5 + 0.75 * u - u.powi(3) / 3.0,
        u if u < 1.5 => 1.0 - (1.5 - u).powi(3) / 6.0,
        _ => 1.0,
    }
}

impl<const D: usize> Open<D> {
    pub(in crate::step) fn of(boundaries: &[Boundary<D>], time: f64, revolved: bool) -> Self {
        let mut open = Open { low: [f64::NEG_INFINITY; D], high: [f64::INFINITY; D] };
        if revolved {
            open.low[0] = 0.0;
        }
        for boundary in boundaries {
            let (axis, at, side) = match *boundary {
                Boundary::Symmetry { axis, at, side }
                | Boundary::Fixed { axis, at, side }
                | Boundary::Absorbing { axis, at, side, .. } => (axis, at, side),
                Boundary::Wall { axis, at, side, velocity } => (axis, at + velocity * time, side),
                Boundary::FrictionWall { axis, at, side, velocity, .. } => {
                    (axis, at + velocity[axis] * time, side)
                }
                _ => continue,
            };
            match side {
                Side::Above => open.low[axis] = open.low[axis].max(at),
                Side::Below => open.high[axis] = open.high[axis].min(at),
            }
        }
        open
    }
    /// Integral of the weight of a node at `x` over the open space, over the volume of a cell.
    pub(in crate::step) fn share(&self, x: &[f64; D], spacing: f64) -> f64 {
        let along =
            |d: usize| integral((self.high[d] - x[d]) / spacing) - integral((self.low[d] - x[d]) / spacing);
        (0..D).map(along).product::<f64>().max(0.0)
    }
}

/// Weights of a particle along each axis.
pub(in crate::step) fn weights<const D: usize>(xi: &[f64; D]) -> [[f64; NODES]; D] {
    xi.map(|xi| [0.5 * (0.5 - xi).powi(2), 0.75 - xi * xi, 0.5 * (0.5 + xi).powi(2)])
}

/// Index in a tile of the first stencil node of a bin.
pub(in crate::step) fn corner<const D: usize>(bin: usize) -> usize {
    let (mut rest, mut stride, mut at) = (bin, 1, 0);
    for _ in 0..D {
        at += rest % BLOCK * stride;
        rest /= BLOCK;
        stride *= TILE;
    }
    at
}

/// Call `visit` with the offset in the tile, the weight, and the position of the particle from the node, in cells.
#[inline(always)]
pub(in crate::step) fn each_node<const D: usize>(
    xi: &[f64; D],
    mut visit: impl FnMut(usize, f64, &[f64; D]),
) {
    let along = weights(xi);
    for n in 0..NODES.pow(D as u32) {
        let (mut rest, mut stride, mut offset, mut weight) = (n, 1, 0, 1.0);
        let mut from = [0.0; D];
        for d in 0..D {
            let a = rest % NODES;
            rest /= NODES;
            weight *= along[d][a];
            from[d] = xi[d] - (a as f64 - 1.0);
            offset += a * stride;
            stride *= TILE;
        }
        visit(offset, weight, &from);
    }
}

/// Coordinates `0..size` of item `n` of a box, x fastest.
pub(in crate::step) fn unfold<const D: usize>(mut n: usize, size: usize) -> [i32; D] {
    std::array::from_fn(|_| {
        let x = n % size;
        n /= size;
        x as i32
    })
}

/// Node blocks around a liquid, with numbers at their nodes.
pub struct NodeBlocks<const D: usize> {
    pub(in crate::step) coordinates: Vec<[i32; D]>,
    /// Node blocks around each, 3^D, x fastest.
    pub(in crate::step) around: Vec<u32>,
}

impl<const D: usize> NodeBlocks<D> {
    pub(in crate::step) fn around_of(tiles: &[Tile<D>], wrapped: &dyn Fn([i32; D]) -> [i32; D]) -> Self {
        let beside = |at: &[i32; D], n: usize| {
            let off: [i32; D] = unfold(n, 3);
            wrapped(std::array::from_fn(|d| at[d] + off[d] - 1))
        };
        let list = |tile: &Tile<D>| {
            (0..neighbours(D)).map(move |n| beside(&tile.coordinates, n)).collect::<Vec<_>>()
        };
        let mut coordinates: Vec<[i32; D]> = tiles.iter().flat_map(list).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        let find = |at: [i32; D]| coordinates.binary_search(&at).map_or(u32::MAX, |n| n as u32);
        let around = coordinates
            .iter()
            .flat_map(|at| (0..neighbours(D)).map(|n| find(beside(at, n))).collect::<Vec<_>>())
            .collect();
        NodeBlocks { coordinates, around }
    }
    pub(in crate::step) fn len(&self) -> usize {
        self.coordinates.len()
    }
    /// Index of the node at `at` from the first node of block `block`, each coordinate from -BLOCK to 2 BLOCK - 1.
    pub(in crate::step) fn node(&self, block: usize, at: &[i32; D]) -> Option<usize> {
        let (mut beside, mut inside, mut stride, mut step) = (0, 0, 1, 1);
        for x in at {
            beside += (x.div_euclid(BLOCK as i32) + 1) as usize * stride;
            inside += x.rem_euclid(BLOCK as i32) as usize * step;
            stride *= 3;
            step *= BLOCK;
        }
        let found = self.around[block * neighbours(D) + beside];
        (found != u32::MAX).then(|| found as usize * block_nodes(D) + inside)
    }
    /// Add the values of nodes behind a plane to those of their mirror images in front. The plane is across `axis` at the node
    /// coordinate `at`; `sign` is 1 if the open space is above.
    pub(in crate::step) fn mirrored(
        &self,
        of: &[[f64; 2]],
        (axis, at, sign): (usize, f64, i32),
        team: &Team,
    ) -> Vec<[f64; 2]> {
        let (mut to, mut each) = (of.to_vec(), vec![(); self.len()]);
        team.each_piece(&mut to, block_nodes(D), &mut each, |block, to, ()| {
            for (n, to) in to.iter_mut().enumerate() {
                let mut inside: [i32; D] = unfold(n, BLOCK);
                let node = self.coordinates[block][axis] * BLOCK as i32 + inside[axis];
                let front = f64::from(sign) * (f64::from(node) - at);
                if front < -1e-6 {
                    *to = [0.0; 2];
                } else if (1e-6..2.0).contains(&front) {
                    let behind = (2.0 * at - f64::from(node)).round() as i32;
                    if f64::from(sign) * (f64::from(behind) - at) < -1e-6 {
                        inside[axis] += behind - node;
                        if let Some(image) = self.node(block, &inside) {
                            (0..2).for_each(|n| to[n] += of[image][n]);
                        }
                    }
                }
            }
        });
        to
    }
    /// Add the tiles of a body to `sums`, with `count` values per node.
    pub(in crate::step) fn add(
        &self,
        tiles: &[Tile<D>],
        wrapped: &(dyn Fn([i32; D]) -> [i32; D] + Sync),
        count: usize,
        sums: &mut [f64],
        team: &Team,
    ) {
        let mut each = vec![(); self.len()];
        team.each_piece(sums, block_nodes(D) * count, &mut each, |block, sums, ()| {
            for n in 0..neighbours(D) {
                let off: [i32; D] = unfold(n, 3);
                let at = std::array::from_fn(|d| self.coordinates[block][d] + off[d] - 1);
                let Ok(tile) = tiles.binary_search_by_key(&wrapped(at), |tile| tile.coordinates) else {
                    continue;
                };
                let tile = &tiles[tile].sums;
                for node in 0..block_nodes(D) {
                    let inside: [i32; D] = unfold(node, BLOCK);
                    let (mut place, mut stride, mut reached) = (0, 1, true);
                    for d in 0..D {
                        let t = inside[d] + 1 - BLOCK as i32 * (off[d] - 1);
                        reached &= (0..TILE as i32).contains(&t);
                        place += t.max(0) as usize * stride;
                        stride *= TILE;
                    }
                    if reached {
                        let (to, from) =
                            (&mut sums[node * count..][..count], &tile[place * count..][..count]);
                        to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
                    }
                }
            }
        });
    }
}

/// Fit of J - 1 at a node: value and slope per cell.
pub(in crate::step) fn fit<const D: usize>(sums: &[f64]) -> [f64; 4] {
    let mut found = [0.0; 4];
    let mass = sums[0];
    if mass <= 0.0 {
        return found;
    }
    let second = 1 + D;
    let values = second + D * (D + 1) / 2;
    let mean: [f64; D] = std::array::from_fn(|d| sums[1 + d] / mass);
    let value = sums[values] / mass;
    // Cholesky factors of the second moment about the centre, then the slope.
    let (mut l, mut slope, mut n) = ([[0.0; D]; D], [0.0; D], second);
    for i in 0..D {
        for j in i..D {
            l[j][i] = sums[n] / mass - mean[i] * mean[j];
            n += 1;
        }
        slope[i] = sums[values + 1 + i] / mass - value * mean[i];
    }
    let mut known = true;
    for i in 0..D {
        for j in 0..i {
            l[i][i] -= l[i][j] * l[i][j];
        }
        known &= l[i][i] > PIVOT;
        l[i][i] = l[i][i].max(PIVOT).sqrt();
        for k in i + 1..D {
            for j in 0..i {
                l[k][i] -= l[k][j] * l[i][j];
            }
            l[k][i] /= l[i][i];
        }
    }
    found[0] = value;
    if !known {
        return found;
    }
    for i in 0..D {
        for j in 0..i {
            slope[i] -= l[i][j] * slope[j];
        }
        slope[i] /= l[i][i];
    }
    for i in (0..D).rev() {
        for j in i + 1..D {
            slope[i] -= l[j][i] * slope[j];
        }
        slope[i] /= l[i][i];
    }
    found[0] -= slope.iter().zip(&mean).map(|(slope, mean)| slope * mean).sum::<f64>();
    found[1..=D].copy_from_slice(&slope);
    found
}

/// Deviation of the occupancy of a node, not smoothed: `phi` has occupancy and open fraction.
pub(in crate::step) fn deviation<const D: usize>(
    nodes: &NodeBlocks<D>,
    phi: &[[f64; 2]],
    block: usize,
    at: &[i32; D],
) -> f64 {
    let mut least = f64::INFINITY;
    for n in 0..neighbours(D) {
        let off: [i32; D] = unfold(n, 3);
        let beside = nodes.node(block, &std::array::from_fn(|d| at[d] + off[d] - 1));
        let [occupied, open] = beside.map_or([0.0, 1.0], |node| phi[node]);
        if open >= OPEN {
            least = least.min(occupied);
        }
    }
    let more = nodes.node(block, at).map_or(0.0, |node| phi[node][0] - 1.0);
    let over = (more - SURFACE).max(0.0);
    match least {
        least if least > INTERIOR => more,
        least if least > NEAR_SURFACE => over + (more + SURFACE).min(0.0),
        _ => over,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_field_is_fitted_exactly() {
        // Four particles around a node, off its position.
        let points = [[0.1, 0.2], [0.6, 0.3], [-0.4, 0.7], [0.2, -0.5]];
        let mut sums = [0.0; moments(2)];
        for x in points {
            let value = 0.3 - 2.0 * x[0] + 5.0 * x[1];
            let numbers =
                [1.0, x[0], x[1], x[0] * x[0], x[0] * x[1], x[1] * x[1], value, value * x[0], value * x[1]];
            (0..9).for_each(|n| sums[n] += numbers[n]);
        }
        let found = fit::<2>(&sums);
        for (found, exact) in found.iter().zip([0.3, -2.0, 5.0]) {
            assert!((found - exact).abs() < 1e-13, "{found} is not {exact}");
        }
    }

    #[test]
    fn particles_in_a_row_have_their_mean() {
        let mut sums = [0.0; moments(2)];
        for x in [-0.25f64, 0.25] {
            let numbers = [1.0, x, 0.0, x * x, 0.0, 0.0, 2.0, 2.0 * x, 0.0];
            (0..9).for_each(|n| sums[n] += numbers[n]);
        }
        assert_eq!(fit::<2>(&sums), [2.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn open_fractions_of_all_nodes_are_the_open_space() {
        let open = Open { low: [0.3, f64::NEG_INFINITY], high: [7.1, f64::INFINITY] };
        let sum: f64 = (-3..12).map(|n| open.share(&[f64::from(n), 0.0], 1.0)).sum();
        assert!((sum - 6.8).abs() < 1e-13, "{sum}");
        assert!((open.share(&[0.3 - 0.5, 0.0], 1.0) - 1.0 / 6.0).abs() < 1e-13);
    }
}
