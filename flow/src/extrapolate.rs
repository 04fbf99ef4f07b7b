//! Velocities at faces beyond the liquid, and in walls.

use impactite_simd::Team;

use crate::blocks::{Blocks, NONE, TILE_CELLS, in_tile, local, stride};
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

/// Blocks whose marks are collected at once.
const GROUP: usize = 64;
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
    /// Marks of the faces of each block, one bit each.
    present: Vec<u8>,
}

/// New values of a block.
#[derive(Clone, Debug)]
struct Replaced {
    block: u32,
    /// Cells whose faces are replaced, one bit each.
    which: u64,
    /// Closed faces without liquid that no open face is beside: their velocity is not known.
    lost: u64,
    /// Values of each field.
    values: [[f64; 64]; 2],
}

/// Field that is extrapolated: values of the faces across an axis, and those before the projection, of which changes are extrapolated.
pub(crate) struct Field<'a> {
    pub values: &'a mut [f64],
    pub before: Option<&'a [f64]>,
}

/// New velocities of the closed faces of a block.
#[derive(Clone, Debug)]
pub(crate) struct Held<const D: usize> {
    block: u32,
    /// Cells whose lower faces walls hold, one bit each, for each axis.
    which: [u64; D],
    values: [[f64; 64]; D],
}

/// Faces that an extrapolation replaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// Closed faces of liquid cells, from the open faces.
    Closed,
    /// Faces beyond the liquid, from the faces of liquid cells.
    Beyond,
}

/// Extrapolate one or two fields across one axis: each layer is the mean of the known faces beside it. In the first layer, faces with particles
/// get the mean change of velocity of the faces beside them instead, from that in `before`: so that affine velocities stay as they are.
/// Farther faces with particles keep their velocities.
pub(crate) fn extrapolate<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    reach: Reach,
    fields: &mut [Field<'_>],
    (volume, marks): (&[f64], &mut [u8]),
    scratch: &mut Scratch,
) {
    let cells = Blocks::<D>::CELLS;
    let layers = if reach == Reach::Closed { 1 } else { LAYERS };
    for layer in 0..layers {
        let rule = Rule { reach, layer };
        scratch.blocks.clear();
        scratch.present.clear();
        scratch.present.resize(blocks.len(), 0);
        let known = &*marks;
        let mut groups = vec![(); blocks.len().div_ceil(GROUP)];
        team.each_piece(&mut scratch.present, GROUP, &mut groups, |n, present, ()| {
            for (present, marks) in present.iter_mut().zip(known[n * GROUP * cells..].chunks(cells)) {
                *present = marks.iter().fold(0, |all, mark| all | 1 << mark);
            }
        });
        let (replaced, taken) = (rule.bits(Rule::replaces), rule.bits(Rule::takes));
        for (b, present) in scratch.present.iter().enumerate().filter(|(_, present)| *present & replaced != 0)
        {
            let near = |other: &u32| *other != NONE && scratch.present[*other as usize] & taken != 0;
            // Without a face to take from, a closed face may be lost.
            if reach == Reach::Closed || present & taken != 0 || blocks.near(b).iter().any(near) {
                scratch.blocks.push(Replaced { block: b as u32, which: 0, lost: 0, values: [[0.0; 64]; 2] });
            }
        }
        let (old, known) = (&*fields, &*marks);
        team.each(&mut scratch.blocks, |_, new| extend_block(blocks, rule, old, (volume, known), new));
        for new in scratch.blocks.iter().filter(|new| new.which | new.lost != 0) {
            for i in (0..cells).filter(|i| new.lost >> i & 1 == 1) {
                marks[new.block as usize * cells + i] = UNKNOWN;
            }
            for i in (0..cells).filter(|i| new.which >> i & 1 == 1) {
                let slot = new.block as usize * cells + i;
                for (field, values) in fields.iter_mut().zip(&new.values) {
                    field.values[slot] = values[i];
                }
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
    /// Marks of which this holds, one bit each.
    fn bits(self, of: impl Fn(Self, u8) -> bool) -> u8 {
        (UNKNOWN..=SOLVED).filter(|mark| of(self, *mark)).fold(0, |bits, mark| bits | 1 << mark)
    }
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
    fields: &[Field<'_>],
    (volume, known): (&[f64], &[u8]),
    new: &mut Replaced,
) {
    let (b, cells) = (new.block as usize, Blocks::<D>::CELLS);
    let mut from = [0; TILE_CELLS];
    blocks.load(b, known, UNKNOWN, &mut from);
    if !from[..1 << (3 * D)].iter().any(|m| rule.takes(*m)) {
        return;
    }
    let beside = |at: usize| {
        (0..D).flat_map(move |e| [at - stride(e), at + stride(e)]).filter(|other| rule.takes(from[*other]))
    };
    for i in 0..cells {
        let at = in_tile(&local::<D>(i));
        if rule.replaces(from[at]) {
            if beside(at).next().is_some() {
                new.which |= 1 << i;
            } else if rule.reach == Reach::Closed && volume[b * cells + i] <= 0.0 {
                new.lost |= 1 << i;
            }
        }
    }
    if new.which == 0 {
        return;
    }
    for (field, values) in fields.iter().zip(&mut new.values) {
        let (mut tile, mut start) = ([0.0; TILE_CELLS], [0.0; TILE_CELLS]);
        blocks.load(b, field.values, 0.0, &mut tile);
        if let Some(before) = field.before {
            blocks.load(b, before, 0.0, &mut start);
        }
        for i in (0..cells).filter(|i| new.which >> i & 1 == 1) {
            let at = in_tile(&local::<D>(i));
            let changes = field.before.is_some() && volume[b * cells + i] > 0.0;
            let (mut sum, mut count) = (0.0, 0);
            for other in beside(at) {
                sum += if changes { tile[other] - start[other] } else { tile[other] };
                count += 1;
            }
            values[i] = sum / f64::from(count) + if changes { start[at] } else { 0.0 };
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
    scratch: &mut Vec<Held<D>>,
) {
    let cells = Blocks::<D>::CELLS;
    if walls.list.is_empty() {
        return;
    }
    let old = &*velocity;
    let held = |mark: u8| if reach == Reach::Closed { mark == CLOSED } else { mark != UNKNOWN };
    let cut = |b: &u32| cuts[*b as usize].is_some();
    let mut list: Vec<_> = (0..blocks.len() as u32).filter(cut).map(|b| (b, [0; D])).collect();
    team.each(&mut list, |_, (b, which)| {
        for (d, which) in which.iter_mut().enumerate() {
            for i in 0..cells {
                let slot = *b as usize * cells + i;
                *which |= u64::from(open[d][slot] <= 0.0 && held(marks[d][slot])) << i;
            }
        }
    });
    scratch.clear();
    let any = list.into_iter().filter(|(_, which)| *which != [0; D]);
    scratch.extend(any.map(|(block, which)| Held { block, which, values: [[0.0; 64]; D] }));
    team.each(scratch, |_, new| {
        let b = new.block as usize;
        let Some(cut) = &cuts[b] else { return };
        let mut tiles = [[0.0; TILE_CELLS]; 3];
        (0..D).for_each(|e| blocks.load(b, &old[e], 0.0, &mut tiles[e]));
        // At first, faces beyond the liquid have no velocity yet.
        let known = (reach == Reach::Closed).then(|| {
            let mut known = [[1.0; TILE_CELLS]; 3];
            let mut tile = [UNKNOWN; TILE_CELLS];
            for e in 0..D {
                blocks.load(b, &marks[e], UNKNOWN, &mut tile);
                for ((known, value), mark) in known[e].iter_mut().zip(&mut tiles[e]).zip(&tile) {
                    *known = if *mark >= CLOSED { 1.0 } else { 0.0 };
                    *value *= *known;
                }
            }
            known
        });
        for d in 0..D {
            for i in (0..cells).filter(|i| new.which[d] >> i & 1 == 1) {
                let beside = marks[d][b * cells + i] == CLOSED;
                let free = old[d][b * cells + i];
                new.values[d][i] =
                    wall_velocity(cut, (&tiles, known.as_ref()), (i, d, beside), free, |wall| {
                        if !moves {
                            return ([0.0; D], false);
                        }
                        let at = face_centre::<D>(i, d);
                        let x = frame.place(&blocks.keys[b], &at);
                        let wall = if walls.moving() { cut.wall_at(walls, &at, wall, &x) } else { wall };
                        (std::array::from_fn(|e| walls.velocity(wall, &x, e)), walls.list[wall].is_no_slip())
                    });
            }
        }
    });
    for new in &*scratch {
        for (d, velocity) in velocity.iter_mut().enumerate() {
            for i in (0..cells).filter(|i| new.which[d] >> i & 1 == 1) {
                velocity[new.block as usize * cells + i] = new.values[d][i];
            }
        }
    }
}

/// Limit the velocities in walls beside cells in corners, which walls close along two axes and more, by their mirror images: those towards the
/// corner by that of the open face; those through a wall are that of the closed one. Extrapolated velocities need not be free of divergence
/// there, and a corner that draws particles in collects them, all at one point in the end.
pub(crate) fn limit_at_corners<const D: usize>(
    blocks: &Blocks<D>,
    (cuts, open, open_cell): (&Cuts<D>, &[Vec<f64>; D], &[f64]),
    velocity: &mut [Vec<f64>; D],
) {
    let cells = Blocks::<D>::CELLS;
    let beside = |slot: usize, axis: usize, up: bool| blocks.beside(slot / cells, slot % cells, axis, up);
    let has_corners = |b: &usize| cuts[*b].as_ref().is_some_and(|cut| cut.has_corners);
    for slot in (0..blocks.len()).filter(has_corners).flat_map(|b| b * cells..(b + 1) * cells) {
        // Walls on lines of the grid alone: round ones close the faces of the cells that they cut.
        if open_cell[slot] < 1.0 {
            continue;
        }
        // Closed side of each axis: none, the lower or the upper one.
        let side: [Option<bool>; D] = std::array::from_fn(|d| {
            let low = open[d][slot] <= 0.0;
            let up = beside(slot, d, true).is_some_and(|up| open[d][up] <= 0.0);
            (low != up).then_some(up)
        });
        if side.iter().flatten().count() < 2 {
            continue;
        }
        for d in 0..D {
            let Some(closed) = side[d] else { continue };
            // The face that the wall closes, whose velocity is that of the wall, and the open one.
            for is_open in [false, true] {
                let lower = closed == is_open;
                let Some(face) = (if lower { Some(slot) } else { beside(slot, d, true) }) else { continue };
                let value = velocity[d][face];
                for axes in (1..1usize << D).filter(|axes| axes >> d & 1 == 0) {
                    let across = |face: Option<usize>, e: usize| match (axes >> e & 1, side[e]) {
                        (0, _) => face,
                        (_, Some(up)) => beside(face?, e, up),
                        _ => None,
                    };
                    if let Some(mirror) = (0..D).fold(Some(face), across) {
                        let of = &mut velocity[d][mirror];
                        *of = match (is_open, closed) {
                            (false, _) => value,
                            (true, true) => of.min(value),
                            (true, false) => of.max(value),
                        };
                    }
                }
            }
        }
    }
}

/// Velocity of the closed face `i` across axis `d` by its wall; `free` without it. Values of faces that are not known are zero; all are known
/// without `known`.
fn wall_velocity<const D: usize>(
    cut: &CutBlock<D>,
    (tiles, known): (&[[f64; TILE_CELLS]; 3], Option<&[[f64; TILE_CELLS]; 3]>),
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
    for e in (0..D).filter(|e| normal[*e] != 0.0) {
        let share = known.map_or(1.0, |known| sample(&known[e], &at, e).0);
        if share > 0.0 {
            approach += (sample(&tiles[e], &at, e).0 / share - moves[e]) * normal[e];
        }
    }
    if beside || approach < 0.0 { free - normal[d] * approach } else { free }
}
