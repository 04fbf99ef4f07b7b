//! Liquid fraction of cells, level set and kinds of cells.
//!
//! The particles' volume at the faces of a cell, averaged over its 2D faces and divided by the open share of the kernel, is the liquid
//! fraction c. For a flat surface it is a known function of the distance, c = F(-phi), which is odd about c = 1/2: its inverse is the level
//! set phi, exact for rows of particles below flat surfaces across an axis, and volume is not gained by it, as it is by a union of balls. A cell is liquid if
//! phi < 0. Particles without half a kernel of liquid around them are below the resolution and move freely, without pressure.

use impactite_simd::Team;

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, offset, stride};
use crate::cuts::{Cuts, Moments, in_kernels};

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

/// Open fractions of the lower faces and of the cells of all blocks, 1 where there are no walls, and what cells that walls cut add to the
/// open share of the kernels around them.
pub(crate) fn open_fractions<const D: usize>(
    blocks: &Blocks<D>,
    cuts: &Cuts<D>,
    (face, cell, uneven): (&mut [Vec<f64>; D], &mut Vec<f64>, &mut Vec<Moments>),
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
    uneven.clear();
    if cuts.iter().flatten().all(|cut| cut.uneven.is_empty()) {
        return;
    }
    uneven.resize(blocks.cells(), [0.0; 4]);
    for (b, cut) in cuts.iter().enumerate() {
        for (i, by) in cut.iter().flat_map(|cut| &cut.uneven) {
            let at = local::<D>(usize::from(*i));
            for (n, by) in by.iter().enumerate().take(Blocks::<D>::AROUND) {
                if let Some(slot) = blocks.around_cell(b, &at, &offset::<D>(n)) {
                    (0..=D).for_each(|m| uneven[slot][m] += by[m]);
                }
            }
        }
    }
}

/// Find the surface from the volume at faces.
pub(crate) fn find<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (cuts, open_face, open_cell, uneven): (&Cuts<D>, &[Vec<f64>; D], &[f64], &[Moments]),
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
                let mut share = open_share::<D>(&tile, in_tile(&local::<D>(i)));
                if let Some(by) = uneven.get(b * cells + i) {
                    share += by[0];
                }
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
    if !uneven.is_empty() {
        centre(team, blocks, (open_cell, uneven), surface);
        fill_enclosed(blocks, cuts, (open_face, open_cell), surface);
    }
}

/// Make cut cells liquid that are beside liquid and not beside an uncut cell of air: a sliver between liquid and a wall has too few
/// particles to tell, and would be a hole in the liquid. The level set is the mean of the liquid cells beside it.
fn fill_enclosed<const D: usize>(
    blocks: &Blocks<D>,
    cuts: &Cuts<D>,
    (open_face, open_cell): (&[Vec<f64>; D], &[f64]),
    surface: &mut Surface,
) {
    let cells = Blocks::<D>::CELLS;
    let mut enclosed = Vec::new();
    for (b, _) in cuts.iter().enumerate().filter(|(_, cut)| cut.is_some()) {
        for i in 0..cells {
            let slot = b * cells + i;
            if surface.kind[slot] != AIR || open_cell[slot] >= 1.0 {
                continue;
            }
            let (mut sum, mut count, mut beside_air) = (0.0, 0, false);
            for (d, up) in (0..D).flat_map(|d| [(d, false), (d, true)]) {
                let Some(other) = blocks.beside(b, i, d, up) else { continue };
                if open_face[d][if up { other } else { slot }] <= 0.0 {
                    continue;
                }
                match surface.kind[other] {
                    LIQUID => (sum, count) = (sum + surface.level[other], count + 1),
                    AIR => beside_air |= open_cell[other] >= 1.0,
                    _ => {}
                }
            }
            if count > 0 && !beside_air {
                enclosed.push((slot, sum / f64::from(count)));
            }
        }
    }
    for (slot, level) in enclosed {
        (surface.kind[slot], surface.level[slot]) = (LIQUID, level);
    }
}

/// Largest number of cells of a pocket.
const POCKET: usize = 64;

/// Make pockets of few cells air, and return their cells, sorted, with the first cell of each pocket: places that bodies and walls enclose which are nearer to each other than the grid
/// resolves. Gaps of less than a cell let the liquid out, and it would hold the bodies if it could not leave.
pub(crate) fn open_pockets<const D: usize>(
    blocks: &Blocks<D>,
    cuts: &Cuts<D>,
    open_face: &[Vec<f64>; D],
    surface: &mut Surface,
) -> Vec<(usize, usize)> {
    let cells = Blocks::<D>::CELLS;
    let (mut pockets, mut seen) = (Vec::new(), vec![false; blocks.cells()]);
    for start in (0..blocks.cells()).filter(|slot| cuts[slot / cells].is_some()) {
        if surface.kind[start] == SOLID || seen[start] {
            continue;
        }
        let (mut region, mut next, mut closed) = (vec![start], 0, true);
        seen[start] = true;
        // Large regions are followed no further than it takes to know it.
        while closed && next < region.len() {
            let slot = region[next];
            next += 1;
            for (d, up) in (0..D).flat_map(|d| [(d, false), (d, true)]) {
                if !up && open_face[d][slot] <= 0.0 {
                    continue;
                }
                let other = blocks.beside(slot / cells, slot % cells, d, up);
                if other.is_some_and(|o| up && open_face[d][o] <= 0.0) {
                    continue;
                }
                let Some(other) = other.filter(|o| region.len() <= POCKET && cuts[o / cells].is_some())
                else {
                    closed = false;
                    break;
                };
                if !region.contains(&other) {
                    // What is beside a region that is no pocket is in none.
                    closed &= !seen[other];
                    seen[other] = true;
                    region.push(other);
                }
            }
        }
        if closed {
            for &slot in &region {
                (surface.kind[slot], surface.level[slot]) = (AIR, 0.5);
            }
            pockets.extend(region.iter().map(|slot| (*slot, start)));
        }
    }
    pockets.sort_unstable();
    pockets
}

/// Largest number of layers of cells from a pocket to the liquid that leaks into it.
const LEAK: usize = 4;

/// Liquid cell nearest to a cell of a pocket, whose pressure the pocket has, over the cells `through`; none if there is none near.
pub(crate) fn host<const D: usize>(
    blocks: &Blocks<D>,
    kind: &[u8],
    pocket: usize,
    through: &dyn Fn(usize) -> bool,
) -> Option<usize> {
    let cells = Blocks::<D>::CELLS;
    let (mut seen, mut from) = (vec![pocket], 0);
    for _ in 0..LEAK {
        let end = seen.len();
        for n in from..end {
            for (d, up) in (0..D).flat_map(|d| [(d, false), (d, true)]) {
                let Some(other) = blocks.beside(seen[n] / cells, seen[n] % cells, d, up) else { continue };
                if kind[other] == LIQUID {
                    return Some(other);
                }
                if !seen.contains(&other) && through(other) {
                    seen.push(other);
                }
            }
        }
        from = end;
    }
    None
}

/// Distance from the surface, in cells, from which the level set is not known.
const FAR: f64 = 1.4;

/// Correct the level set of cells in whose kernels a wall cuts cells. The open part of such a kernel has its centre beside that of the cell,
/// by c; what the fraction tells is the distance there, phi + c . grad phi.
fn centre<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (open_cell, uneven): (&[f64], &[Moments]),
    surface: &mut Surface,
) {
    let cells = Blocks::<D>::CELLS;
    let even = in_kernels::<D>(|_| 1.0);
    let before = surface.level.clone();
    let kinds = surface.kind.clone();
    let mut pieces: Vec<&mut [u8]> = surface.kind.chunks_mut(cells).collect();
    team.each_piece(&mut surface.level, cells, &mut pieces, |b, level, kind| {
        let (mut open, mut tile) = ([0.0; TILE_CELLS], [0.0; TILE_CELLS]);
        let corrected = |i: usize| uneven[b * cells + i] != [0.0; 4] && before[b * cells + i].abs() < FAR;
        if !(0..cells).any(corrected) {
            return;
        }
        blocks.load(b, open_cell, 1.0, &mut open);
        blocks.load(b, &before, FAR, &mut tile);
        let mut kinds_tile = [AIR; TILE_CELLS];
        blocks.load(b, &kinds, AIR, &mut kinds_tile);
        for i in (0..cells).filter(|i| corrected(*i)) {
            if kind[i] == SOLID {
                continue;
            }
            let at = in_tile(&local::<D>(i));
            let mut sum = uneven[b * cells + i];
            for (n, even) in even.iter().enumerate().take(Blocks::<D>::AROUND) {
                let to = offset::<D>(n);
                let place = (0..D).fold(at as isize, |place, d| place - to[d] as isize * stride(d) as isize);
                (0..=D).for_each(|m| sum[m] += open[place as usize] * even[m]);
            }
            if sum[0] <= SLIVER || !beside_air::<D>(&kinds_tile, at) {
                continue;
            }
            let slope: [f64; D] = std::array::from_fn(|d| slope(&tile, &open, at, d));
            let length = slope.iter().map(|s| s * s).sum::<f64>().sqrt().max(1.0);
            let by: f64 = (0..D).map(|d| sum[d + 1] / sum[0] * slope[d] / length).sum();
            level[i] = (level[i] - by).clamp(-1.5, 1.5);
            kind[i] = if level[i] < 0.0 { LIQUID } else { AIR };
        }
    });
}

/// True if one of the 3^D cells around the cell at this place of a tile is open and without liquid.
pub(crate) fn beside_air<const D: usize>(kind: &[u8; TILE_CELLS], at: usize) -> bool {
    (0..Blocks::<D>::AROUND).any(|n| {
        let by = offset::<D>(n);
        let place = (0..D).fold(at as isize, |place, d| place + by[d] as isize * stride(d) as isize);
        kind[place as usize] == AIR
    })
}

/// Slope of the level set along an axis, from the cells beside a cell that are not wholly in a wall.
fn slope(level: &[f64; TILE_CELLS], open: &[f64; TILE_CELLS], at: usize, d: usize) -> f64 {
    let (low, up) = (at - stride(d), at + stride(d));
    match (open[low] > 0.0, open[up] > 0.0) {
        (true, true) => 0.5 * (level[up] - level[low]),
        (true, false) => level[at] - level[low],
        (false, true) => level[up] - level[at],
        (false, false) => 0.0,
    }
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
