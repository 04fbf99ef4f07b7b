//! Velocities at faces beyond the liquid, and in walls.

use impactite_simd::Team;

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::cuts::Cuts;
use crate::surface::LIQUID;
use crate::transfer::{face_centre, sample};

/// Mark of a face without a velocity.
pub(crate) const UNKNOWN: u8 = 0;
/// Mark of a face with the velocity of particles that no liquid cell is beside.
pub(crate) const FREE: u8 = 1;
/// Mark of a face with an extrapolated velocity.
const EXTRAPOLATED: u8 = 2;
/// Mark of a closed face of a liquid cell.
pub(crate) const CLOSED: u8 = 3;
/// Mark of an open face of a liquid cell.
pub(crate) const SOLVED: u8 = 4;

/// Layers of faces with extrapolated velocities.
const LAYERS: usize = 3;

/// Mark the faces across axis `d`.
pub(crate) fn mark<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (kind, open, volume): (&[u8], &[f64], &[f64]),
    d: usize,
    marks: &mut Vec<u8>,
) {
    let cells = Blocks::<D>::CELLS;
    marks.resize(blocks.cells(), UNKNOWN);
    team.each_piece(marks, cells, &mut vec![(); blocks.len()], |b, marks, ()| {
        let mut tile = [0; TILE_CELLS];
        blocks.load(b, kind, 0, &mut tile);
        for (i, mark) in marks.iter_mut().enumerate() {
            let at = in_tile(&local::<D>(i));
            let beside = tile[at] == LIQUID || tile[at - stride(d)] == LIQUID;
            let slot = b * cells + i;
            *mark = match (beside, open[slot] > 0.0, volume[slot] > 0.0) {
                (true, true, _) => SOLVED,
                (true, false, _) => CLOSED,
                (false, _, true) => FREE,
                _ => UNKNOWN,
            };
        }
    });
}

/// Scratch memory of the extrapolation.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    values: Vec<f64>,
    marks: Vec<u8>,
}

/// Faces that an extrapolation replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// Closed faces of liquid cells, from the open faces.
    Closed,
    /// Faces beyond the liquid, from the faces of liquid cells.
    Beyond,
}

/// Extrapolate the velocity across one axis: each layer is the mean of the known faces beside it. In the first layer, faces with particles
/// get the mean change of velocity of the faces beside them instead, from that in `before`: so that affine velocities stay as they are.
/// Farther faces with particles keep their velocities.
pub(crate) fn extrapolate<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    reach: Reach,
    (before, volume): (Option<&[f64]>, &[f64]),
    (values, marks): (&mut Vec<f64>, &mut Vec<u8>),
    scratch: &mut Scratch,
) {
    let cells = Blocks::<D>::CELLS;
    let layers = if reach == Reach::Closed { 1 } else { LAYERS };
    for layer in 0..layers {
        scratch.values.resize(values.len(), 0.0);
        scratch.marks.resize(marks.len(), 0);
        let (old, known) = (&*values, &*marks);
        let mut pieces: Vec<&mut [u8]> = scratch.marks.chunks_mut(cells).collect();
        team.each_piece(&mut scratch.values, cells, &mut pieces, |b, new, new_marks| {
            let range = b * cells..(b + 1) * cells;
            new.copy_from_slice(&old[range.clone()]);
            new_marks.copy_from_slice(&known[range.clone()]);
            let replaced = |mark: u8| match (reach, layer) {
                (Reach::Closed, _) => mark == CLOSED,
                (Reach::Beyond, 0) => mark < CLOSED,
                (Reach::Beyond, _) => mark == UNKNOWN,
            };
            let source = |mark: u8| match (reach, layer) {
                (Reach::Closed, _) => mark == SOLVED,
                (Reach::Beyond, 0) => mark >= CLOSED,
                (Reach::Beyond, _) => mark != UNKNOWN,
            };
            if !known[range].iter().any(|m| replaced(*m)) {
                return;
            }
            let (mut tile, mut from) = ([0.0; TILE_CELLS], [0; TILE_CELLS]);
            blocks.load(b, known, UNKNOWN, &mut from);
            blocks.load(b, old, 0.0, &mut tile);
            let mut start = [0.0; TILE_CELLS];
            if let Some(before) = before {
                blocks.load(b, before, 0.0, &mut start);
            }
            for i in 0..cells {
                let at = in_tile(&local::<D>(i));
                if !replaced(from[at]) {
                    continue;
                }
                let changes = before.is_some() && volume[b * cells + i] > 0.0;
                let (mut sum, mut count) = (0.0, 0);
                for e in 0..D {
                    for other in [at - stride(e), at + stride(e)] {
                        if source(from[other]) {
                            sum += if changes { tile[other] - start[other] } else { tile[other] };
                            count += 1;
                        }
                    }
                }
                if count > 0 {
                    new[i] = sum / f64::from(count) + if changes { start[at] } else { 0.0 };
                    new_marks[i] = new_marks[i].max(EXTRAPOLATED);
                }
            }
        });
        std::mem::swap(values, &mut scratch.values);
        std::mem::swap(marks, &mut scratch.marks);
    }
}

/// Apply the velocities of walls to closed faces, either those of liquid cells or all: the normal component at slip walls, and the mirrored velocity at walls without slip.
/// Faces beside no liquid cell are held against approach alone.
pub(crate) fn constrain<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (cuts, open, marks): (&Cuts<D>, &[Vec<f64>; D], &[Vec<u8>; D]),
    reach: Reach,
    walls: &[([f64; D], bool)],
    velocity: &mut [Vec<f64>; D],
    scratch: &mut [Vec<f64>; D],
) {
    let cells = Blocks::<D>::CELLS;
    if walls.is_empty() {
        return;
    }
    let old = &*velocity;
    for d in 0..D {
        scratch[d].resize(blocks.cells(), 0.0);
        team.each_piece(&mut scratch[d], cells, &mut vec![(); blocks.len()], |b, new, ()| {
            new.copy_from_slice(&old[d][b * cells..(b + 1) * cells]);
            let Some(cut) = &cuts[b] else { return };
            let beside = |i: usize| marks[d][b * cells + i] == CLOSED;
            let closed = |i: usize| open[d][b * cells + i] <= 0.0 && (reach == Reach::Beyond || beside(i));
            if !(0..cells).any(closed) {
                return;
            }
            let mut tiles = [[0.0; TILE_CELLS]; 3];
            (0..D).for_each(|e| blocks.load(b, &old[e], 0.0, &mut tiles[e]));
            for i in (0..cells).filter(|i| closed(*i)) {
                let at = face_centre::<D>(i, d);
                let (gap, slope, wall) = cut.sample(&at);
                let length = slope.iter().map(|s| s * s).sum::<f64>().sqrt();
                if length <= 0.0 {
                    continue;
                }
                let normal = slope.map(|s| s / length);
                let (moves, no_slip) = walls[wall];
                if no_slip {
                    // Within the tile: at most one cell beyond the block.
                    let depth = (-gap).clamp(0.0, 0.5);
                    let mirror: [f64; D] = std::array::from_fn(|e| at[e] + 2.0 * depth * normal[e]);
                    let fluid = sample(&tiles[d], &mirror, d).0;
                    new[i] = if depth > 0.0 { 2.0 * moves[d] - fluid } else { moves[d] };
                    continue;
                }
                let mut approach = 0.0;
                for e in 0..D {
                    approach += (sample(&tiles[e], &at, e).0 - moves[e]) * normal[e];
                }
                if beside(i) || approach < 0.0 {
                    new[i] -= normal[d] * approach;
                }
            }
        });
    }
    (0..D).for_each(|d| std::mem::swap(&mut velocity[d], &mut scratch[d]));
}
