//! Transfer between particles and faces: affine particle-in-cell with multilinear weights on the lattice of each face component.
//!
//! A face velocity is u_i = sum_p V_p w_ip (v_p + C_p (x_i - x_p)) / sum_p V_p w_ip; back, v_p = sum_i w_ip u_i and C_p = sum_i u_i grad w_ip
//! (\[Jiang2017\]). The transfer conserves linear and angular momentum and reproduces affine velocities.

use impactite_simd::{Arch, Float, Kernel, Team};

use crate::blocks::{Blocks, HALO, NONE, SIDE, TILE, TILE_CELLS, local, offset};
use crate::particles::{Frame, Liquid, Particle};

/// Edge of the nodes that the particles of a block reach.
const REACH: usize = SIDE + 2;

/// Number of nodes that the particles of a block reach.
#[inline(always)]
const fn reached(dimension: usize) -> usize {
    if dimension == 2 { REACH * REACH } else { REACH * REACH * REACH }
}

/// Volume and volume times velocity at the faces that the particles of a block reach.
pub(crate) type Record = [f64; 2];

/// Scatter the particles of a block to its records: those of one face component after another.
struct Scatter<'a, const D: usize> {
    liquids: &'a [Liquid<D>],
    block: usize,
    key: [i32; D],
    frame: &'a Frame<D>,
    records: &'a mut [Record],
}

impl<const D: usize> Kernel<f64> for Scatter<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        self.records.fill([0.0; 2]);
        for liquid in self.liquids {
            for p in liquid.of_block(self.block) {
                let at = self.frame.local(&p.x, &self.key);
                for d in 0..D {
                    let records = &mut self.records[d * reached(D)..(d + 1) * reached(D)];
                    scatter_component(p, &at, d, records);
                }
            }
        }
    }
}

/// Index of the lowest node of the stencil and the offset from it in cells, of component `d` at a place in a block. `low` is the number of
/// layers of nodes below the block, `edge` the edge of the array.
#[inline(always)]
fn stencil<const D: usize>(at: &[f64; D], d: usize, low: usize, edge: usize) -> (usize, [f64; D]) {
    let (mut base, mut part) = (0, [0.0; D]);
    for e in (0..D).rev() {
        // Positive, so that truncation is the floor.
        let y = at[e] + if e == d { low as f64 } else { low as f64 - 0.5 };
        let node = y as i32;
        part[e] = y - f64::from(node);
        base = base * edge + node as usize;
    }
    (base, part)
}

#[inline(always)]
fn scatter_component<const D: usize>(p: &Particle<D>, at: &[f64; D], d: usize, records: &mut [Record]) {
    let (base, part) = stencil(at, d, 1, REACH);
    let c = &p.c[d];
    let mut lowest = p.v[d];
    for e in 0..D {
        lowest -= c[e] * part[e];
    }
    let layers = if D == 3 { 2 } else { 1 };
    for k in 0..layers {
        let wk = if D == 3 { if k == 0 { 1.0 - part[D - 1] } else { part[D - 1] } } else { 1.0 };
        let vk = if D == 3 && k == 1 { lowest + c[D - 1] } else { lowest };
        for j in 0..2 {
            let wj = p.volume * wk * if j == 0 { 1.0 - part[1] } else { part[1] };
            let vj = if j == 1 { vk + c[1] } else { vk };
            let first = base + j * REACH + k * REACH * REACH;
            let pair = &mut records[first..first + 2];
            let (w0, w1) = (wj * (1.0 - part[0]), wj * part[0]);
            pair[0][0] += w0;
            pair[0][1] += w0 * vj;
            pair[1][0] += w1;
            pair[1][1] += w1 * (vj + c[0]);
        }
    }
}

/// Scratch memory of the transfer to faces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    records: Vec<Record>,
    /// Place of the records of each block; [`NONE`] without particles.
    place: Vec<u32>,
}

/// Transfer all liquids to faces: the volume at each face over that of a cell, and the velocity, 0 without volume.
pub(crate) fn to_faces<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    frame: &Frame<D>,
    liquids: &[Liquid<D>],
    scratch: &mut Scratch,
    (volume, velocity): (&mut [Vec<f64>; D], &mut [Vec<f64>; D]),
) {
    let filled = |b: &usize| liquids.iter().any(|l| l.starts[*b] != l.starts[b + 1]);
    let mut occupied: Vec<usize> = (0..blocks.len()).filter(filled).collect();
    scratch.place.clear();
    scratch.place.resize(blocks.len(), NONE);
    occupied.iter().enumerate().for_each(|(n, &b)| scratch.place[b] = n as u32);
    let length = D * reached(D);
    scratch.records.resize(occupied.len() * length, [0.0; 2]);
    team.each_piece(&mut scratch.records, length, &mut occupied, |_, records, &mut b| {
        f64::dispatch(Scatter { liquids, block: b, key: blocks.keys[b], frame, records });
    });
    let (records, place) = (&scratch.records, &scratch.place);
    let cell = frame.h.powi(D as i32);
    let cells = Blocks::<D>::CELLS;
    for d in 0..D {
        volume[d].resize(blocks.cells(), 0.0);
        velocity[d].resize(blocks.cells(), 0.0);
        let mut pieces: Vec<&mut [f64]> = velocity[d].chunks_mut(cells).collect();
        team.each_piece(&mut volume[d], cells, &mut pieces, |b, volume, velocity| {
            let mut sum = [[0.0; 2]; 64];
            for (n, &other) in blocks.near(b).iter().enumerate() {
                if other != NONE && place[other as usize] != NONE {
                    let first = place[other as usize] as usize * length + d * reached(D);
                    add_overlap::<D>(&offset(n), &records[first..first + reached(D)], &mut sum);
                }
            }
            for i in 0..cells {
                let [v, q] = sum[i];
                volume[i] = v / cell;
                velocity[i] = if v > 0.0 { q / v } else { 0.0 };
            }
        });
    }
}

/// Add the records of the block at `offset` to the faces of a block.
#[inline(always)]
fn add_overlap<const D: usize>(offset: &[i32; D], records: &[Record], sum: &mut [Record; 64]) {
    let (mut from, mut to) = ([0usize; 3], [1usize; 3]);
    for d in 0..D {
        (from[d], to[d]) = match offset[d] {
            -1 => (0, 1),
            0 => (0, SIDE),
            _ => (SIDE - 1, SIDE),
        };
    }
    let there = |i: usize, d: usize| (i as i32 + 1 - offset.get(d).unwrap_or(&0) * SIDE as i32) as usize;
    for k in from[2]..to[2] {
        for j in from[1]..to[1] {
            let row = if D == 3 { there(k, 2) * REACH * REACH } else { 0 } + there(j, 1) * REACH;
            for i in from[0]..to[0] {
                let r = records[row + there(i, 0)];
                let s = &mut sum[i + SIDE * (j + SIDE * k)];
                s[0] += r[0];
                s[1] += r[1];
            }
        }
    }
}

/// Value and gradient (per cell) of component `d` at a place of a block, by multilinear interpolation in a tile of its faces.
#[inline(always)]
pub(crate) fn sample<const D: usize>(tile: &[f64; TILE_CELLS], at: &[f64; D], d: usize) -> (f64, [f64; D]) {
    let (base, part) = stencil(at, d, HALO, TILE);
    interpolate(tile, base, &part)
}

/// Value and gradient (per cell) of a field of cell centres at a place of a block.
#[inline(always)]
pub(crate) fn sample_centres<const D: usize>(tile: &[f64; TILE_CELLS], at: &[f64; D]) -> (f64, [f64; D]) {
    // No component is along an axis beyond the dimension.
    let (base, part) = stencil(at, D, HALO, TILE);
    interpolate(tile, base, &part)
}

#[inline(always)]
fn interpolate<const D: usize>(tile: &[f64; TILE_CELLS], base: usize, part: &[f64; D]) -> (f64, [f64; D]) {
    let mut slope = [0.0; D];
    // The mask spares checks of bounds; stencils are within the tile.
    let of = |place: usize| tile[place & (TILE_CELLS - 1)];
    let plane = |first: usize| {
        let (a, b) = (of(first), of(first + 1));
        let (c, d) = (of(first + TILE), of(first + TILE + 1));
        let (low, high) = (a + part[0] * (b - a), c + part[0] * (d - c));
        let dx = (b - a) + part[1] * ((d - c) - (b - a));
        (low + part[1] * (high - low), dx, high - low)
    };
    let (v, dx, dy) = plane(base);
    if D == 2 {
        (slope[0], slope[1]) = (dx, dy);
        return (v, slope);
    }
    let (v1, dx1, dy1) = plane(base + TILE * TILE);
    let z = part[D - 1];
    slope[0] = dx + z * (dx1 - dx);
    slope[1] = dy + z * (dy1 - dy);
    slope[D - 1] = v1 - v;
    (v + z * (v1 - v), slope)
}

/// Local coordinates of the centre of the lower face across `d` of cell `i`, in cells from the corner of its block.
pub(crate) fn face_centre<const D: usize>(i: usize, d: usize) -> [f64; D] {
    let at = local::<D>(i);
    std::array::from_fn(|e| at[e] as f64 + if e == d { 0.0 } else { 0.5 })
}
