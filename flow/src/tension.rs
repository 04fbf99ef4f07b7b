//! Curvature of the surface.
//!
//! The liquid fraction is smoothed by [`PASSES`] binomial filters, which make its kernel nearly isotropic and average over the particles near
//! the surface. The inverse of the profile of a flat surface then makes a level set of it, which is smooth and close to the distance, and
//! whose curvature is kappa = div(grad phi / |grad phi|) by central differences: of second order, since the level sets of a smoothed ball are
//! spheres. Walls are mirrors: no share of a cell goes through their closed faces, and the surface meets them at a right angle.

use impactite_simd::Team;

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::surface::{PASSES, Profile};

/// Open fractions of the faces across each axis and of the cells.
pub(crate) type Open<'a, const D: usize> = (&'a [Vec<f64>; D], &'a [f64]);

/// Magnitude of the level set up to which there is a curvature, in cells.
const BAND: f64 = 2.0;

/// Smoothed fields and the curvature.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tension {
    liquid: Vec<f64>,
    scratch: Vec<f64>,
    /// Level set of the smoothed liquid, in cells.
    level: Vec<f64>,
    /// Curvature near the surface over that of a cell, kappa h: positive for a drop; else 0.
    pub curvature: Vec<f64>,
}

/// Smooth a field, which is zero in cells that do not exist, between the open faces of cells.
fn smooth<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    field: &mut Vec<f64>,
    open: Option<&[Vec<f64>; D]>,
    scratch: &mut Vec<f64>,
) {
    scratch.resize(field.len(), 0.0);
    for _ in 0..PASSES {
        for d in 0..D {
            let old = &*field;
            team.each_piece(scratch, Blocks::<D>::CELLS, &mut vec![(); blocks.len()], |b, new, ()| {
                let mut tile = [0.0; TILE_CELLS];
                blocks.load(b, old, 0.0, &mut tile);
                let Some(open) = open else {
                    for (i, new) in new.iter_mut().enumerate() {
                        let at = in_tile(&local::<D>(i));
                        *new = 0.5 * tile[at] + 0.25 * (tile[at - stride(d)] + tile[at + stride(d)]);
                    }
                    return;
                };
                let mut faces = [1.0; TILE_CELLS];
                blocks.load(b, &open[d], 1.0, &mut faces);
                for (i, new) in new.iter_mut().enumerate() {
                    let (at, step) = (in_tile(&local::<D>(i)), stride(d));
                    let low = faces[at] * (tile[at - step] - tile[at]);
                    let up = faces[at + step] * (tile[at + step] - tile[at]);
                    *new = tile[at] + 0.25 * (low + up);
                }
            });
            std::mem::swap(field, scratch);
        }
    }
}

/// Curvature times the width of a cell at a place of a tile of the level set.
fn curvature<const D: usize>(tile: &[f64; TILE_CELLS], at: usize) -> f64 {
    let (mut slope, mut second) = ([0.0; D], [[0.0; D]; D]);
    for d in 0..D {
        let (low, up) = (tile[at - stride(d)], tile[at + stride(d)]);
        slope[d] = 0.5 * (up - low);
        second[d][d] = up - 2.0 * tile[at] + low;
        for e in 0..d {
            let corner =
                |a: usize, b: usize| tile[at + a * stride(d) + b * stride(e) - stride(d) - stride(e)];
            second[d][e] = 0.25 * (corner(2, 2) - corner(0, 2) - corner(2, 0) + corner(0, 0));
            second[e][d] = second[d][e];
        }
    }
    let square: f64 = slope.iter().map(|s| s * s).sum();
    // The level set is close to the distance: a slope far from one is no surface.
    if square < 0.01 {
        return 0.0;
    }
    let mut sum = 0.0;
    for d in 0..D {
        for e in 0..D {
            let projected = if d == e { square } else { 0.0 } - slope[d] * slope[e];
            sum += projected * second[d][e];
        }
    }
    sum / (square * square.sqrt())
}

/// Continue the level into cells of walls as that of the cell beside them; into those of edges and corners from these.
fn continue_into_walls<const D: usize>(blocks: &Blocks<D>, open_cell: &[f64], level: &mut [f64]) {
    let cells = Blocks::<D>::CELLS;
    let mut known: Vec<bool> = open_cell.iter().map(|open| *open > 0.0).collect();
    for _ in 0..D {
        let mut found = Vec::new();
        for slot in (0..blocks.cells()).filter(|slot| !known[*slot]) {
            let sides = (0..D).flat_map(|d| [(d, false), (d, true)]);
            let near = sides.filter_map(|(d, up)| blocks.beside(slot / cells, slot % cells, d, up));
            let (sum, count) =
                near.filter(|s| known[*s]).fold((0.0, 0u32), |(sum, n), s| (sum + level[s], n + 1));
            if count > 0 {
                found.push((slot, sum / f64::from(count)));
            }
        }
        for (slot, value) in found {
            (level[slot], known[slot]) = (value, true);
        }
    }
}

impl Tension {
    /// Find the curvature from the liquid fraction, and the open fractions where there are walls.
    pub fn find<const D: usize>(
        &mut self,
        team: &Team,
        blocks: &Blocks<D>,
        (fraction, open): (&[f64], Option<Open<'_, D>>),
        profile: &Profile,
    ) {
        self.liquid.clear();
        self.liquid.extend_from_slice(fraction);
        smooth(team, blocks, &mut self.liquid, open.map(|open| open.0), &mut self.scratch);
        let cells = Blocks::<D>::CELLS;
        self.level.resize(blocks.cells(), 0.0);
        self.level.iter_mut().zip(&self.liquid).for_each(|(level, c)| *level = profile.smooth_level(*c));
        if let Some((_, open_cell)) = open {
            continue_into_walls(blocks, open_cell, &mut self.level);
        }
        self.curvature.resize(blocks.cells(), 0.0);
        let level = &self.level;
        team.each_piece(&mut self.curvature, cells, &mut vec![(); blocks.len()], |b, out, ()| {
            out.fill(0.0);
            if !level[b * cells..(b + 1) * cells].iter().any(|l| l.abs() < BAND) {
                return;
            }
            let mut tile = [0.0; TILE_CELLS];
            blocks.load(b, level, profile.smooth_level(0.0), &mut tile);
            for (i, out) in out.iter_mut().enumerate() {
                let at = in_tile(&local::<D>(i));
                if tile[at].abs() < BAND {
                    *out = curvature::<D>(&tile, at);
                }
            }
        });
    }

    /// Allocated memory, bytes.
    pub fn bytes(&self) -> usize {
        let lists = [&self.liquid, &self.scratch, &self.level, &self.curvature];
        lists.into_iter().map(|list| 8 * list.capacity()).sum()
    }
}
