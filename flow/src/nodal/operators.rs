//! Operators between nodes and cells: divergence, gradient, hourglass filter, extrapolation.

use impactite_simd::Team;

use super::nodes::Nodes;
use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::pressure::{Cells, Tile};
use crate::surface::LIQUID;

/// Layers of nodes beyond the liquid that get a velocity.
const LAYERS: usize = 2;

/// Distance in a tile of corner `n` of a cell from its lowest one.
fn corner<const D: usize>(n: usize) -> usize {
    (0..D).map(|d| (n >> d & 1) * stride(d)).sum()
}

/// Divergence of the nodal velocity at the centres of liquid cells by the hat functions, times -1 and the width of a cell, m/s.
pub(super) fn divergence<const D: usize>(
    team: &Team,
    at: &Cells<'_, D>,
    velocity: &[[f64; D]],
    right: &mut Vec<f64>,
) {
    let cells = Blocks::<D>::CELLS;
    right.resize(at.blocks.cells(), 0.0);
    let share = 1.0 / f64::from(1 << (D - 1));
    team.each_piece(right, cells, &mut vec![(); at.blocks.len()], |b, right, ()| {
        right.fill(0.0);
        let kind = &at.kind[b * cells..(b + 1) * cells];
        if !kind.contains(&LIQUID) {
            return;
        }
        let mut tile = [[0.0; D]; TILE_CELLS];
        at.blocks.load(b, velocity, [0.0; D], &mut tile);
        for i in (0..cells).filter(|i| kind[*i] == LIQUID) {
            let low = in_tile(&local::<D>(i));
            for n in 0..1 << D {
                let v = &tile[low + corner::<D>(n)];
                for d in 0..D {
                    right[i] -= share * if n >> d & 1 == 1 { v[d] } else { -v[d] };
                }
            }
        }
    });
}

/// Subtract from the nodal velocity the mean of the gradients of q at the open faces around the node that touch liquid.
pub(super) fn subtract_gradient<const D: usize>(
    team: &Team,
    at: &Cells<'_, D>,
    q: &[f64],
    velocity: &mut [[f64; D]],
) {
    let cells = Blocks::<D>::CELLS;
    team.each_piece(velocity, cells, &mut vec![(); at.blocks.len()], |b, velocity, ()| {
        let tile = Tile::load(at, b, q);
        if !tile.kind.contains(&LIQUID) {
            return;
        }
        for d in 0..D {
            let mut open = [0.0; TILE_CELLS];
            at.blocks.load(b, &at.open[d], 1.0, &mut open);
            for (i, v) in velocity.iter_mut().enumerate() {
                let node = in_tile(&local::<D>(i));
                let (mut sum, mut count) = (0.0, 0u32);
                for n in (0..1 << D).filter(|n| n >> d & 1 == 0) {
                    let up = node - corner::<D>(n);
                    let low = up - stride(d);
                    if open[up] > 0.0 && (tile.kind[low] == LIQUID || tile.kind[up] == LIQUID) {
                        sum += tile.gradient(low, up);
                        count += 1;
                    }
                }
                if count > 0 {
                    v[d] -= sum / f64::from(count);
                }
            }
        }
    });
}

/// Normalised hourglass modes of a cell: products of the signs of two or more axes.
fn modes(dimension: usize) -> impl Iterator<Item = usize> {
    (0..1usize << dimension).filter(|mask| mask.count_ones() > 1)
}

/// Subtract the share `alpha` of the hourglass modes of the liquid cells from the nodal velocity.
pub(super) fn filter<const D: usize>(
    team: &Team,
    at: &Cells<'_, D>,
    alpha: f64,
    from: &[[f64; D]],
    velocity: &mut [[f64; D]],
) {
    if alpha == 0.0 {
        return;
    }
    let cells = Blocks::<D>::CELLS;
    // Modes are normalised by the square root of the number of corners.
    let share = alpha / f64::from(1 << D);
    let sign = |mask: usize, n: usize| if (mask & !n).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
    team.each_piece(velocity, cells, &mut vec![(); at.blocks.len()], |b, velocity, ()| {
        let mut kind = [0; TILE_CELLS];
        at.blocks.load(b, at.kind, 0, &mut kind);
        if !kind.contains(&LIQUID) {
            return;
        }
        let mut tile = [[0.0; D]; TILE_CELLS];
        at.blocks.load(b, from, [0.0; D], &mut tile);
        for (i, v) in velocity.iter_mut().enumerate() {
            let node = in_tile(&local::<D>(i));
            // Cells whose corner `mine` the node is.
            for mine in 0..1 << D {
                let low = node - corner::<D>(mine);
                if kind[low] != LIQUID {
                    continue;
                }
                for mask in modes(D) {
                    let mut sum = [0.0; D];
                    for n in 0..1 << D {
                        let s = sign(mask, n);
                        let other = &tile[low + corner::<D>(n)];
                        (0..D).for_each(|d| sum[d] += s * other[d]);
                    }
                    (0..D).for_each(|d| v[d] -= share * sign(mask, mine) * sum[d]);
                }
            }
        }
    });
}

/// Turn the velocity that particles brought into the change of velocity in the step.
pub(super) fn find_change<const D: usize>(nodes: &mut Nodes<D>) {
    for ((change, v), volume) in nodes.change.iter_mut().zip(&nodes.velocity).zip(&nodes.volume) {
        *change = if *volume > 0.0 { std::array::from_fn(|d| v[d] - change[d]) } else { [0.0; D] };
    }
}

/// Give nodes without liquid the mean velocity of those around them, layer by layer.
pub(super) fn extrapolate<const D: usize>(team: &Team, blocks: &Blocks<D>, nodes: &mut Nodes<D>) {
    let cells = Blocks::<D>::CELLS;
    let mut known: Vec<bool> = nodes.volume.iter().map(|volume| *volume > 0.0).collect();
    let mut next = known.clone();
    for _ in 0..LAYERS {
        nodes.spare.clone_from(&nodes.velocity);
        let spare = &nodes.spare;
        let mut pieces: Vec<&mut [bool]> = next.chunks_mut(cells).collect();
        team.each_piece(&mut nodes.velocity, cells, &mut pieces, |b, velocity, next| {
            let (mut there, mut tile) = ([false; TILE_CELLS], [[0.0; D]; TILE_CELLS]);
            blocks.load(b, &known, false, &mut there);
            if !there.contains(&true) {
                return;
            }
            blocks.load(b, spare, [0.0; D], &mut tile);
            for i in 0..cells {
                let at = in_tile(&local::<D>(i));
                if there[at] {
                    continue;
                }
                let (mut sum, mut count) = ([0.0; D], 0u32);
                for n in 0..Blocks::<D>::AROUND {
                    let to = crate::blocks::offset::<D>(n);
                    let place =
                        (0..D).fold(at as isize, |place, d| place + to[d] as isize * stride(d) as isize);
                    if there[place as usize] {
                        (0..D).for_each(|d| sum[d] += tile[place as usize][d]);
                        count += 1;
                    }
                }
                if count > 0 {
                    (velocity[i], next[i]) = (sum.map(|v| v / f64::from(count)), true);
                }
            }
        });
        known.clone_from(&next);
    }
}
