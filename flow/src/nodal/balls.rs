//! Level set of particles: the distance to the nearest of balls that cover a cell each, made a distance by sweeping; curvature.

use impactite_simd::Team;

use super::nodes::Balls;
use crate::blocks::{Blocks, NONE, SIDE, TILE_CELLS, in_tile, local, stride};
use crate::particles::{Frame, Liquid};

/// Level, in cells, of cells that are farther from the surface.
const FAR: f64 = 2.0;
/// Largest level, in cells, of a cell beside one that balls cover.
const NEAR: f64 = 1.0;
/// Rounds of the sweep: layers of cells beside the surface whose level is a distance.
const ROUNDS: usize = 3;

/// Find min_p |x_p - x_c| - r at the cells, in cells. The radius r of balls is half of the diagonal of a cell, so that every cell with a
/// particle is liquid.
pub(super) fn level<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    frame: &Frame<D>,
    liquids: &[Liquid<D>],
    level: &mut Vec<f64>,
) {
    let r = 0.5 * (D as f64).sqrt();
    // Cells beside the surface are nearer; the sweep finds the levels of the others.
    let reach = r + NEAR;
    level.clear();
    level.resize(blocks.cells(), 0.0);
    team.each_piece(level, Blocks::<D>::CELLS, &mut vec![(); blocks.len()], |b, level, ()| {
        level.fill(reach * reach);
        for (n, &other) in blocks.near(b).iter().enumerate() {
            if other == NONE {
                continue;
            }
            let by = crate::blocks::offset::<D>(n);
            let there = &blocks.keys[other as usize];
            for p in liquids.iter().flat_map(|l| l.of_block(other as usize)) {
                // In cells from the corner of this block; the neighbour may be an image.
                let mut at = frame.local(&p.x, there);
                (0..D).for_each(|d| at[d] += f64::from(by[d]) * SIDE as f64);
                cover(&at, reach, level);
            }
        }
        level.iter_mut().for_each(|x| *x = x.sqrt() - r);
    });
}

/// Lower the squared distances of the cells of a block to a particle within `reach` cells of it.
fn cover<const D: usize>(at: &[f64; D], reach: f64, square: &mut [f64]) {
    let (mut low, mut high) = ([0usize; 3], [0usize; 3]);
    for d in 0..D {
        let (from, to) = ((at[d] - 0.5 - reach).ceil().max(0.0), (at[d] - 0.5 + reach).floor().min(3.0));
        if from > to {
            return;
        }
        (low[d], high[d]) = (from as usize, to as usize);
    }
    for k in low[2]..=high[2] {
        for j in low[1]..=high[1] {
            for i in low[0]..=high[0] {
                let cell = [i, j, k];
                let distance = (0..D).map(|d| (at[d] - 0.5 - cell[d] as f64).powi(2)).sum::<f64>();
                let place = &mut square[i + SIDE * (j + SIDE * k)];
                *place = place.min(distance);
            }
        }
    }
}

/// Make the level a distance: cells beside the surface keep theirs, the others within some layers solve |grad phi| = 1.
pub(super) fn sweep<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    open_cell: &[f64],
    level: &mut [f64],
    scratch: &mut Balls,
) {
    let cells = Blocks::<D>::CELLS;
    scratch.before.clear();
    scratch.before.extend_from_slice(level);
    scratch.frozen.resize(blocks.cells(), false);
    let before = &scratch.before;
    let mut pieces: Vec<&mut [f64]> = level.chunks_mut(cells).collect();
    team.each_piece(&mut scratch.frozen, cells, &mut pieces, |b, frozen, level| {
        let mut tile = [FAR; TILE_CELLS];
        let mut open = [1.0; TILE_CELLS];
        blocks.load(b, before, FAR, &mut tile);
        blocks.load(b, open_cell, 1.0, &mut open);
        for i in 0..cells {
            let at = in_tile(&local::<D>(i));
            let crosses = |to: usize| open[to] > 0.5 && (tile[to] < 0.0) != (tile[at] < 0.0);
            frozen[i] = (0..D).any(|d| crosses(at - stride(d)) || crosses(at + stride(d)));
            if !frozen[i] {
                level[i] = if tile[at] < 0.0 { -FAR } else { FAR };
            }
        }
    });
    let frozen = &scratch.frozen;
    for _ in 0..ROUNDS {
        scratch.before.copy_from_slice(level);
        let before = &scratch.before;
        team.each_piece(level, cells, &mut vec![(); blocks.len()], |b, level, ()| {
            let mut tile = [FAR; TILE_CELLS];
            let mut open = [1.0; TILE_CELLS];
            blocks.load(b, before, FAR, &mut tile);
            blocks.load(b, open_cell, 1.0, &mut open);
            for (i, level) in level.iter_mut().enumerate() {
                if frozen[b * cells + i] {
                    continue;
                }
                let at = in_tile(&local::<D>(i));
                let of = |to: usize| if open[to] > 0.5 { tile[to].abs() } else { f64::INFINITY };
                let near: [f64; D] = std::array::from_fn(|d| of(at - stride(d)).min(of(at + stride(d))));
                let distance = eikonal(near).min(FAR);
                *level = if *level < 0.0 { -distance } else { distance };
            }
        });
    }
}

/// Solve sum_d max(u - a_d, 0)^2 = 1 for the distance u, with the smallest distances a_d of the neighbours along each axis.
fn eikonal<const D: usize>(mut near: [f64; D]) -> f64 {
    near.sort_by(f64::total_cmp);
    let mut u = near[0] + 1.0;
    for count in 2..=D {
        if u <= near[count - 1] {
            break;
        }
        let (n, known) = (count as f64, &near[..count]);
        let (sum, square) = (known.iter().sum::<f64>(), known.iter().map(|a| a * a).sum::<f64>());
        u = (sum + (sum * sum - n * (square - 1.0)).max(0.0).sqrt()) / n;
    }
    u
}

/// Pressure at the surface by its curvature, div (grad phi / |grad phi|) of the quadratic function that fits the level of 3^D cells best, times
/// `scale`.
pub(super) fn curvature<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (level, scale): (&[f64], f64),
    jump: &mut Vec<f64>,
) {
    jump.resize(blocks.cells(), 0.0);
    team.each_piece(jump, Blocks::<D>::CELLS, &mut vec![(); blocks.len()], |b, jump, ()| {
        let mut tile = [FAR; TILE_CELLS];
        blocks.load(b, level, FAR, &mut tile);
        for (i, jump) in jump.iter_mut().enumerate() {
            let at = in_tile(&local::<D>(i));
            *jump = if tile[at].abs() < FAR { scale * quadratic::<D>(&tile, at) } else { 0.0 };
        }
    });
}

/// Curvature, per cell, of the quadratic function of least squares; 0 where the level is flat, at most that of a ball of a cell.
fn quadratic<const D: usize>(tile: &[f64; TILE_CELLS], at: usize) -> f64 {
    let (mut slope, mut second) = ([0.0; D], [[0.0; D]; D]);
    // Sums of squares of x, x^2 - 2/3 and x y over the 3^D cells.
    let around = Blocks::<D>::AROUND as f64;
    let norms = [around * 2.0 / 3.0, around * 2.0 / 9.0, around * 4.0 / 9.0];
    for n in 0..Blocks::<D>::AROUND {
        let to = crate::blocks::offset::<D>(n);
        let place = (0..D).fold(at as isize, |place, d| place + to[d] as isize * stride(d) as isize);
        let (value, x) = (tile[place as usize], to.map(f64::from));
        for d in 0..D {
            slope[d] += x[d] * value / norms[0];
            for e in 0..D {
                second[d][e] += if d == e {
                    2.0 * (x[d] * x[d] - 2.0 / 3.0) * value / norms[1]
                } else {
                    x[d] * x[e] * value / norms[2]
                };
            }
        }
    }
    let square: f64 = slope.iter().map(|s| s * s).sum();
    if square < 1e-4 {
        return 0.0;
    }
    let mut sum = 0.0;
    for d in 0..D {
        for e in (0..D).filter(|e| *e != d) {
            sum += second[d][d] * slope[e] * slope[e] - second[d][e] * slope[d] * slope[e];
        }
    }
    (sum / (square * square.sqrt())).clamp(1.0 - D as f64, D as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curvature_of_a_ball_is_that_of_its_radius() {
        for (radius, allowed) in [(6.0, 0.02), (12.0, 0.005)] {
            let mut tile = [0.0; TILE_CELLS];
            let centre = [3.0 - 0.6 * radius, 3.0 - 0.8 * radius, 3.0];
            for (t, level) in tile.iter_mut().enumerate() {
                let x = [t % 8, t / 8 % 8, t / 64].map(|x| x as f64);
                *level = (0..3).map(|d| (x[d] - centre[d]).powi(2)).sum::<f64>().sqrt() - radius;
            }
            let at = 3 + 8 * (3 + 8 * 3);
            let space = quadratic::<3>(&tile, at) * radius / 2.0 - 1.0;
            let plane = quadratic::<2>(&tile, at) * radius - 1.0;
            assert!(space.abs() < allowed && plane.abs() < allowed, "{radius}: {space} {plane}");
        }
    }

    #[test]
    fn distances_to_a_corner_and_a_plane_are_solved() {
        assert!((eikonal([0.5, 9.0, 9.0]) - 1.5).abs() < 1e-15);
        let both = eikonal([0.5, 0.5]);
        assert!((2.0 * (both - 0.5f64).powi(2) - 1.0).abs() < 1e-14);
        let all = eikonal([0.2, 0.3, 0.4]);
        assert!((0.2f64, 0.3, 0.4) != (all, all, all));
        assert!(([0.2, 0.3, 0.4].iter().map(|a| (all - a) * (all - a)).sum::<f64>() - 1.0).abs() < 1e-14);
    }
}
