//! Velocities at faces beyond the liquid, and in walls.

use impactite_simd::Team;

use crate::blocks::{Blocks, TILE_CELLS, in_tile, local, stride};
use crate::cuts::{CutBlock, Cuts};
use crate::particles::Frame;
use crate::surface::LIQUID;
use crate::transfer::{face_centre, sample};
use crate::wall::Walls;

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

/// Scratch memory of the extrapolation: blocks with faces to replace, and their new values.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    blocks: Vec<Replaced>,
}

/// New values of a block.
#[derive(Clone, Debug)]
struct Replaced {
    block: u32,
    /// Cells whose faces are replaced, one bit each.
    which: u64,
    /// Closed faces without liquid that no open face is beside: their velocity is not known.
    lost: u64,
    values: [f64; 64],
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
    (values, marks): (&mut [f64], &mut [u8]),
    scratch: &mut Scratch,
) {
    let cells = Blocks::<D>::CELLS;
    let layers = if reach == Reach::Closed { 1 } else { LAYERS };
    for layer in 0..layers {
        let rule = Rule { reach, layer };
        scratch.blocks.clear();
        for (b, marks) in marks.chunks(cells).enumerate() {
            if marks.iter().any(|m| rule.replaces(*m)) {
                scratch.blocks.push(Replaced { block: b as u32, which: 0, lost: 0, values: [0.0; 64] });
            }
        }
        let (old, known) = (&*values, &*marks);
        team.each(&mut scratch.blocks, |_, new| {
            extend_block(blocks, rule, (before, volume), (old, known), new)
        });
        for new in scratch.blocks.iter().filter(|new| new.which | new.lost != 0) {
            for i in (0..cells).filter(|i| new.lost >> i & 1 == 1) {
                marks[new.block as usize * cells + i] = UNKNOWN;
            }
            for i in (0..cells).filter(|i| new.which >> i & 1 == 1) {
                let slot = new.block as usize * cells + i;
                values[slot] = new.values[i];
                marks[slot] = marks[slot].max(EXTRAPOLATED);
            }
        }
    }
}

/// Faces that a layer replaces, and those that it takes velocities from.
#[derive(Clone, Copy)]
struct Rule {
    reach: Reach,
    layer: usize,
}

impl Rule {
    #[inline(always)]
    fn replaces(self, mark: u8) -> bool {
        match (self.reach, self.layer) {
            (Reach::Closed, _) => mark == CLOSED,
            (Reach::Beyond, 0) => mark < CLOSED,
            (Reach::Beyond, _) => mark == UNKNOWN,
        }
    }
    #[inline(always)]
    fn takes(self, mark: u8) -> bool {
        match (self.reach, self.layer) {
            (Reach::Closed, _) => mark == SOLVED,
            (Reach::Beyond, 0) => mark >= CLOSED,
            (Reach::Beyond, _) => mark != UNKNOWN,
        }
    }
}

/// Find the new values of a block.
fn extend_block<const D: usize>(
    blocks: &Blocks<D>,
    rule: Rule,
    (before, volume): (Option<&[f64]>, &[f64]),
    (old, known): (&[f64], &[u8]),
    new: &mut Replaced,
) {
    let (b, cells) = (new.block as usize, Blocks::<D>::CELLS);
    let mut from = [0; TILE_CELLS];
    blocks.load(b, known, UNKNOWN, &mut from);
    if !from[..1 << (3 * D)].iter().any(|m| rule.takes(*m)) {
        return;
    }
    let (mut tile, mut start) = ([0.0; TILE_CELLS], [0.0; TILE_CELLS]);
    blocks.load(b, old, 0.0, &mut tile);
    if let Some(before) = before {
        blocks.load(b, before, 0.0, &mut start);
    }
    for i in 0..cells {
        let at = in_tile(&local::<D>(i));
        if !rule.replaces(from[at]) {
            continue;
        }
        let changes = before.is_some() && volume[b * cells + i] > 0.0;
        let (mut sum, mut count) = (0.0, 0);
        for e in 0..D {
            for other in [at - stride(e), at + stride(e)] {
                if rule.takes(from[other]) {
                    sum += if changes { tile[other] - start[other] } else { tile[other] };
                    count += 1;
                }
            }
        }
        if count > 0 {
            new.values[i] = sum / f64::from(count) + if changes { start[at] } else { 0.0 };
            new.which |= 1 << i;
        } else if rule.reach == Reach::Closed && volume[b * cells + i] <= 0.0 {
            new.lost |= 1 << i;
        }
    }
}

/// Apply the velocities of walls to closed faces, either those of liquid cells or all with a velocity: the normal component at slip walls,
/// and the mirrored velocity at walls without slip. Faces beside no liquid cell are held against approach alone.
/// Without `moves` the walls rest, without friction.
pub(crate) fn constrain<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    (cuts, open, marks): (&Cuts<D>, &[Vec<f64>; D], &[Vec<u8>; D]),
    reach: Reach,
    (walls, moves, frame): (&Walls<'_, D>, bool, &Frame<D>),
    velocity: &mut [Vec<f64>; D],
    scratch: &mut [Scratch; D],
) {
    let cells = Blocks::<D>::CELLS;
    if walls.list.is_empty() {
        return;
    }
    let old = &*velocity;
    for (d, scratch) in scratch.iter_mut().enumerate() {
        scratch.blocks.clear();
        let held = |mark: u8| if reach == Reach::Closed { mark == CLOSED } else { mark != UNKNOWN };
        for b in (0..blocks.len()).filter(|b| cuts[*b].is_some()) {
            let mut which = 0;
            for i in 0..cells {
                let slot = b * cells + i;
                which |= u64::from(open[d][slot] <= 0.0 && held(marks[d][slot])) << i;
            }
            if which != 0 {
                scratch.blocks.push(Replaced { block: b as u32, which, lost: 0, values: [0.0; 64] });
            }
        }
        team.each(&mut scratch.blocks, |_, new| {
            let b = new.block as usize;
            let Some(cut) = &cuts[b] else { return };
            let mut tiles = [[0.0; TILE_CELLS]; 3];
            (0..D).for_each(|e| blocks.load(b, &old[e], 0.0, &mut tiles[e]));
            // At first, faces beyond the liquid have no velocity yet.
            let mut known = [[1.0; TILE_CELLS]; 3];
            if reach == Reach::Closed {
                let mut tile = [UNKNOWN; TILE_CELLS];
                for e in 0..D {
                    blocks.load(b, &marks[e], UNKNOWN, &mut tile);
                    for ((known, value), mark) in known[e].iter_mut().zip(&mut tiles[e]).zip(&tile) {
                        *known = if *mark >= CLOSED { 1.0 } else { 0.0 };
                        *value *= *known;
                    }
                }
            }
            for i in (0..cells).filter(|i| new.which >> i & 1 == 1) {
                let beside = marks[d][b * cells + i] == CLOSED;
                let free = old[d][b * cells + i];
                new.values[i] = wall_velocity(cut, (&tiles, &known), (i, d, beside), free, |wall| {
                    if !moves {
                        return ([0.0; D], false);
                    }
                    let x = frame.place(&blocks.keys[b], &face_centre::<D>(i, d));
                    (std::array::from_fn(|e| walls.velocity(wall, &x, e)), walls.list[wall].is_no_slip())
                });
            }
        });
    }
    for (velocity, scratch) in velocity.iter_mut().zip(scratch) {
        for new in &scratch.blocks {
            for i in (0..cells).filter(|i| new.which >> i & 1 == 1) {
                velocity[new.block as usize * cells + i] = new.values[i];
            }
        }
    }
}

/// Velocity of the closed face `i` across axis `d` by its wall; `free` without it. Values of faces that are not known are zero.
fn wall_velocity<const D: usize>(
    cut: &CutBlock<D>,
    (tiles, known): (&[[f64; TILE_CELLS]; 3], &[[f64; TILE_CELLS]; 3]),
    (i, d, beside): (usize, usize, bool),
    free: f64,
    walls: impl Fn(usize) -> ([f64; D], bool),
) -> f64 {
    let at = face_centre::<D>(i, d);
    let (gap, slope, wall) = cut.sample(&at);
    let length = slope.iter().map(|s| s * s).sum::<f64>().sqrt();
    if length <= 0.0 {
        return free;
    }
    let normal = slope.map(|s| s / length);
    let (moves, no_slip) = walls(wall);
    if no_slip {
        // Within the tile: at most one cell beyond the block.
        let depth = (-gap).clamp(0.0, 0.5);
        let mirror: [f64; D] = std::array::from_fn(|e| at[e] + 2.0 * depth * normal[e]);
        let fluid = sample(&tiles[d], &mirror, d).0;
        return if depth > 0.0 { 2.0 * moves[d] - fluid } else { moves[d] };
    }
    let mut approach = 0.0;
    for e in 0..D {
        let share = sample(&known[e], &at, e).0;
        if share > 0.0 {
            approach += (sample(&tiles[e], &at, e).0 / share - moves[e]) * normal[e];
        }
    }
    if beside || approach < 0.0 { free - normal[d] * approach } else { free }
}
