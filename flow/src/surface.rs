//! Liquid fraction of cells, level set and kinds of cells.
//!
//! The particles' volume at the faces of a cell, averaged over its 2D faces and divided by the open share of the kernel, is the liquid
//! fraction c. For a flat surface it is a known function of the distance, c = F(-phi), which is odd about c = 1/2: its inverse is the level
//! set phi, exact for rows of particles below flat surfaces across an axis, and volume is not gained by it, as it is by a union of balls. A cell is liquid if
//! phi < 0. Particles without half a kernel of liquid around them are below the resolution and move freely, without pressure.

use impactite_simd::Team;

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::cuts::Cuts;

/// Kind of a cell: open, without liquid.
pub(crate) const AIR: u8 = 0;
/// Kind of a cell: liquid, with a pressure.
pub(crate) const LIQUID: u8 = 1;
/// Kind of a cell: without an open face.
pub(crate) const SOLID: u8 = 2;

/// Binomial filters (1/4, 1/2, 1/4) along every axis.
pub(crate) const PASSES: usize = 6;
/// Open share of the kernel of a cell below which it is not liquid.
const SLIVER: f64 = 1e-3;
/// Entries of the table of distances.
const ENTRIES: usize = 2048;

/// Kernel of the liquid fraction across an axis, at a distance in cells: the mean of hat functions at the faces and at the centre.
fn kernel(dimension: usize, s: f64) -> f64 {
    let hat = |s: f64| (1.0 - s.abs()).max(0.0);
    let d = dimension as f64;
    (0.5 * (hat(s + 0.5) + hat(s - 0.5)) + (d - 1.0) * hat(s)) / d
}

/// Liquid fraction of a cell whose centre is `depth` cells below a flat surface across an axis, in `dimension` dimensions: that of rows of
/// particles `spacing` cells apart, the first half of it below the surface.
pub(crate) fn fraction(dimension: usize, spacing: f64, depth: f64) -> f64 {
    let rows = (4.0 / spacing).ceil() as usize;
    // Rows in reach are at -1.5 to 1.5 from the centre.
    let first = ((depth - 1.5) / spacing - 0.5).floor().max(0.0);
    (0..rows).map(|k| spacing * kernel(dimension, depth - (first + k as f64 + 0.5) * spacing)).sum()
}

/// Inverse of [`fraction`]: level set over liquid fraction, as it is and after the filters of the curvature.
#[derive(Clone, Debug)]
pub(crate) struct Profile {
    dimension: usize,
    spacing: f64,
    sharp: Vec<f64>,
    smooth: Vec<f64>,
}

/// Depths, in cells, at equidistant fractions, of a profile that grows from 0 to 1 within `reach` cells of the surface.
fn inverse(reach: f64, profile: impl Fn(f64) -> f64) -> Vec<f64> {
    let depth = |c: f64| {
        let (mut low, mut high) = (-reach, reach);
        for _ in 0..50 {
            let middle: f64 = 0.5 * (low + high);
            if profile(middle) < c { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    (0..=ENTRIES).map(|n| depth(n as f64 / ENTRIES as f64)).collect()
}

/// Level set, in cells, at a liquid fraction, by a table of depths.
#[inline]
fn look_up(depths: &[f64], fraction: f64) -> f64 {
    let at = fraction.clamp(0.0, 1.0) * ENTRIES as f64;
    let n = (at as usize).min(ENTRIES - 1);
    let part = at - n as f64;
    -(depths[n] + part * (depths[n + 1] - depths[n]))
}

impl Profile {
    /// Profile of particles `spacing` cells apart.
    pub fn new(dimension: usize, spacing: f64) -> Self {
        // Weights of all filters together, by Pascal's triangle.
        let mut weights = [0.0; 2 * PASSES + 1];
        weights[0] = 1.0;
        for _ in 0..2 * PASSES {
            for n in (0..weights.len()).rev() {
                weights[n] = 0.5 * (weights[n] + if n > 0 { weights[n - 1] } else { 0.0 });
            }
        }
        let smooth = |depth: f64| {
            let at = |n: usize| fraction(dimension, spacing, depth + n as f64 - PASSES as f64);
            weights.iter().enumerate().map(|(n, w)| w * at(n)).sum()
        };
        let sharp = inverse(1.5, |depth| fraction(dimension, spacing, depth));
        Profile { dimension, spacing, sharp, smooth: inverse(1.5 + PASSES as f64, smooth) }
    }
    /// Liquid fraction at a distance from a flat surface, in cells.
    pub fn fraction(&self, depth: f64) -> f64 {
        if depth >= 1.5 { 1.0 } else { fraction(self.dimension, self.spacing, depth) }
    }
    /// Level set, in cells, at a liquid fraction: negative in the liquid, -1.5 to 1.5.
    #[inline]
    pub fn level(&self, fraction: f64) -> f64 {
        look_up(&self.sharp, fraction)
    }
    /// Level set, in cells, at a filtered liquid fraction.
    #[inline]
    pub fn smooth_level(&self, fraction: f64) -> f64 {
        look_up(&self.smooth, fraction)
    }
}

/// Surface of the liquid at the cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// Liquid volume over open volume in the kernel of each cell.
    pub fraction: Vec<f64>,
    /// Level set, in cells.
    pub level: Vec<f64>,
    /// Kind of each cell.
    pub kind: Vec<u8>,
}

/// Open share of the kernel of a cell: the mean over axes of (1/4, 1/2, 1/4) along the axis and (1/8, 3/4, 1/8) across it.
fn open_share<const D: usize>(tile: &[f64; TILE_CELLS], at: usize) -> f64 {
    let mut sum = 0.0;
    for n in 0..Blocks::<D>::AROUND {
        let (mut rest, mut place, mut across) = (n, at, [0.0; D]);
        let mut along = [0.0; D];
        for d in 0..D {
            let step = rest % 3;
            rest /= 3;
            place = place + step * stride(d) - stride(d);
            (along[d], across[d]) = if step == 1 { (0.5, 0.75) } else { (0.25, 0.125) };
        }
        let product = |d: usize| along[d] * (0..D).filter(|e| *e != d).map(|e| across[e]).product::<f64>();
        sum += tile[place] * (0..D).map(product).sum::<f64>();
    }
    sum / D as f64
}

/// Open fractions of the lower faces and of the cells of all blocks, 1 where there are no walls.
pub(crate) fn open_fractions<const D: usize>(
    blocks: &Blocks<D>,
    cuts: &Cuts<D>,
    face: &mut [Vec<f64>; D],
    cell: &mut Vec<f64>,
) {
    let cells = Blocks::<D>::CELLS;
    for list in face.iter_mut().chain([&mut *cell]) {
        list.clear();
        list.resize(blocks.cells(), 1.0);
    }
    for (b, cut) in cuts.iter().enumerate() {
        let Some(cut) = cut else { continue };
        let range = b * cells..(b + 1) * cells;
        for d in 0..D {
            face[d][range.clone()].copy_from_slice(&cut.face[d]);
        }
        cell[range].copy_from_slice(&cut.cell);
    }
}

/// Find the surface from the volume at faces.
pub(crate) fn find<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (cuts, open_face, open_cell): (&Cuts<D>, &[Vec<f64>; D], &[f64]),
    volume: &[Vec<f64>; D],
    profile: &Profile,
    surface: &mut Surface,
) {
    let cells = Blocks::<D>::CELLS;
    surface.fraction.resize(blocks.cells(), 0.0);
    surface.level.resize(blocks.cells(), 0.0);
    surface.kind.resize(blocks.cells(), AIR);
    let mut pieces: Vec<(&mut [f64], &mut [u8])> =
        surface.level.chunks_mut(cells).zip(surface.kind.chunks_mut(cells)).collect();
    team.each_piece(&mut surface.fraction, cells, &mut pieces, |b, fraction, (level, kind)| {
        fraction.fill(0.0);
        let mut tile = [0.0; TILE_CELLS];
        for d in 0..D {
            blocks.load(b, &volume[d], 0.0, &mut tile);
            for (i, f) in fraction.iter_mut().enumerate() {
                let at = in_tile(&local::<D>(i));
                *f += (tile[at] + tile[at + stride(d)]) / (2 * D) as f64;
            }
        }
        kind.fill(AIR);
        if cuts[b].is_some() {
            blocks.load(b, open_cell, 1.0, &mut tile);
            for i in 0..cells {
                let share = open_share::<D>(&tile, in_tile(&local::<D>(i)));
                fraction[i] = if share > SLIVER { fraction[i] / share } else { 0.0 };
            }
            kind.fill(SOLID);
            for d in 0..D {
                blocks.load(b, &open_face[d], 1.0, &mut tile);
                for (i, k) in kind.iter_mut().enumerate() {
                    let at = in_tile(&local::<D>(i));
                    if tile[at] + tile[at + stride(d)] > 0.0 {
                        *k = AIR;
                    }
                }
            }
        }
        for i in 0..cells {
            level[i] = profile.level(fraction[i]);
            if level[i] < 0.0 && kind[i] == AIR {
                kind[i] = LIQUID;
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_sets_are_distances_to_flat_surfaces() {
        for dimension in [2, 3] {
            let profile = Profile::new(dimension, 0.5);
            for n in -12..=12 {
                let depth = 0.1 * f64::from(n);
                let level = profile.level(fraction(dimension, 0.5, depth));
                // Linear interpolation in 2048 intervals; the slope is infinite at the ends.
                assert!((level + depth).abs() < 1e-3, "{dimension}: {level} at {depth}");
            }
            assert!(profile.level(0.5).abs() < 1e-14);
        }
    }

    #[test]
    fn the_open_share_is_one_in_open_space_and_seven_eighths_or_less_at_a_wall() {
        let mut tile = [1.0; TILE_CELLS];
        let at = in_tile(&[0, 1, 1]);
        assert!((open_share::<3>(&tile, at) - 1.0).abs() < 1e-15);
        // Closed below x = 0.
        (0..TILE_CELLS).filter(|t| t % 8 < 2).for_each(|t| tile[t] = 0.0);
        assert!((open_share::<3>(&tile, at) - (1.0 - (0.25 + 2.0 * 0.125) / 3.0)).abs() < 1e-15);
    }
}
