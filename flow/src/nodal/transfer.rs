//! Transfer of particles to nodes, by hat functions, and forces of their deviatoric stress.

use impactite_simd::{Arch, Float, Kernel, Team};

use super::nodes::{Nodes, Scratch};
use crate::blocks::{Blocks, HALO, NONE, SIDE, TILE, TILE_CELLS, local, offset};
use crate::options::Fluid;
use crate::particles::{Frame, Liquid};

/// Edge of the nodes that the particles of a block reach.
const REACH: usize = SIDE + 1;

/// Volume of a node over that of a cell below which the stress does not accelerate it more: particles act on a node by the gradients of their hat
/// functions, which do not vanish as its mass does.
const LIGHT: f64 = 1.0 / 16.0;

/// Number of nodes that the particles of a block reach.
const fn reached(dimension: usize) -> usize {
    REACH.pow(dimension as u32)
}

/// Index of the lowest of the 2^D nodes around a place of a block, and the offset from it in cells. `low` is the number of layers of nodes
/// below the block in an array of this edge, `most` the largest node.
#[inline(always)]
pub(super) fn corner<const D: usize>(
    at: &[f64; D],
    (low, most, edge): (usize, usize, usize),
) -> (usize, [f64; D]) {
    let (mut base, mut part) = (0, [0.0; D]);
    for e in (0..D).rev() {
        // Positive, so that truncation is the floor.
        let y = at[e] + low as f64;
        let node = (y as usize).min(most);
        part[e] = y - node as f64;
        base = base * edge + node;
    }
    (base, part)
}

/// Hat function of corner `n` at an offset in cells, and its gradient per cell.
#[inline(always)]
pub(super) fn hat<const D: usize>(part: &[f64; D], n: usize) -> (f64, [f64; D]) {
    let (mut weight, mut slope) = (1.0, [1.0; D]);
    for e in 0..D {
        let (w, s) = if n >> e & 1 == 1 { (part[e], 1.0) } else { (1.0 - part[e], -1.0) };
        weight *= w;
        for (d, slope) in slope.iter_mut().enumerate() {
            *slope *= if d == e { s } else { w };
        }
    }
    (weight, slope)
}

/// Distance of corner `n` of a cell from its lowest one in an array of this edge.
#[inline(always)]
pub(super) fn step_to<const D: usize>(n: usize, edge: usize) -> usize {
    (0..D).rev().fold(0, |sum, e| sum * edge + (n >> e & 1))
}

/// Deviatoric stress, Pa, and its power per volume, W/m^3, of a change `c` of the velocity over a cell; in the plane without strain across it.
#[inline(always)]
fn deviatoric<const D: usize>(c: &[[f64; D]; D], viscosity: f64, h: f64) -> ([[f64; D]; D], f64) {
    let trace: f64 = (0..D).map(|d| c[d][d]).sum();
    let (mut stress, mut power) = ([[0.0; D]; D], 0.0);
    for d in 0..D {
        for e in 0..D {
            let mut rate = 0.5 * (c[d][e] + c[e][d]) / h;
            if d == e {
                rate -= trace / (3.0 * h);
            }
            stress[d][e] = 2.0 * viscosity * rate;
            power += stress[d][e] * rate;
        }
    }
    if D == 2 {
        let across = trace / (3.0 * h);
        power += 2.0 * viscosity * across * across;
    }
    (stress, power)
}

/// Quantity that a block scatters to its records.
enum What<'a, const D: usize> {
    /// Volume and momentum of particles.
    Momentum,
    /// Force of the deviatoric stress at this viscosity, Pa s, with the velocities of nodes in the tile of the block.
    Force(f64, &'a [[f64; D]; TILE_CELLS]),
}

struct Scatter<'a, const D: usize> {
    what: What<'a, D>,
    liquids: &'a [Liquid<D>],
    block: usize,
    key: [i32; D],
    frame: &'a Frame<D>,
    records: &'a mut [(f64, [f64; D])],
}

impl<const D: usize> Kernel<f64> for Scatter<'_, D> {
    /// Power of the stress, W.
    type Output = f64;
    #[inline(always)]
    fn run<A: Arch<f64>>(self) -> f64 {
        let (h, mut sum) = (self.frame.h, 0.0);
        self.records.fill((0.0, [0.0; D]));
        for p in self.liquids.iter().flat_map(|liquid| liquid.of_block(self.block)) {
            let at = self.frame.local(&p.x, &self.key);
            let (base, part) = corner(&at, (0, SIDE - 1, REACH));
            match self.what {
                What::Momentum => {
                    for n in 0..1 << D {
                        let (volume, momentum) = &mut self.records[base + step_to::<D>(n, REACH)];
                        let share = p.volume * hat(&part, n).0;
                        *volume += share;
                        (0..D).for_each(|d| momentum[d] += share * p.v[d]);
                    }
                }
                What::Force(viscosity, velocity) => {
                    let (stress, power) = deviatoric(&gradient(velocity, &at), viscosity, h);
                    sum += p.volume * power;
                    for n in 0..1 << D {
                        let slope = hat(&part, n).1;
                        let force = &mut self.records[base + step_to::<D>(n, REACH)].1;
                        for d in 0..D {
                            let inner: f64 = (0..D).map(|e| stress[d][e] * slope[e]).sum();
                            force[d] -= p.volume * inner / h;
                        }
                    }
                }
            }
        }
        sum
    }
}

/// Change of the velocity of the nodes in a tile over a cell, at a place of its block.
#[inline(always)]
fn gradient<const D: usize>(velocity: &[[f64; D]; TILE_CELLS], at: &[f64; D]) -> [[f64; D]; D] {
    let (base, part) = corner(at, (HALO, HALO + SIDE - 1, TILE));
    let mut c = [[0.0; D]; D];
    for n in 0..1 << D {
        let slope = hat(&part, n).1;
        let u = &velocity[base + step_to::<D>(n, TILE)];
        for d in 0..D {
            (0..D).for_each(|e| c[d][e] += slope[e] * u[d]);
        }
    }
    c
}

/// Transfer all liquids to nodes: volume over that of a cell, and velocity.
pub(super) fn to_nodes<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    frame: &Frame<D>,
    liquids: &[Liquid<D>],
    nodes: &mut Nodes<D>,
) {
    let filled = |b: &usize| liquids.iter().any(|l| l.starts[*b] != l.starts[b + 1]);
    let scratch = &mut nodes.scratch;
    scratch.occupied.clear();
    scratch.occupied.extend((0..blocks.len()).filter(filled));
    scratch.place.clear();
    scratch.place.resize(blocks.len(), NONE);
    scratch.occupied.iter().enumerate().for_each(|(n, &b)| scratch.place[b] = n as u32);
    scratch.records.resize(scratch.occupied.len() * reached(D), (0.0, [0.0; D]));
    let Scratch { records, occupied, .. } = scratch;
    team.each_piece(records, reached(D), occupied, |_, records, &mut b| {
        let (what, key) = (What::Momentum, blocks.keys[b]);
        f64::dispatch(Scatter { what, liquids, block: b, key, frame, records });
    });
    let cell = frame.h.powi(D as i32);
    nodes.volume.resize(blocks.cells(), 0.0);
    nodes.velocity.resize(blocks.cells(), [0.0; D]);
    add(
        team,
        blocks,
        &nodes.scratch,
        (&mut nodes.volume, &mut nodes.velocity),
        |(v, q), volume, velocity| {
            *volume = v / cell;
            *velocity = if v > 0.0 { q.map(|q| q / v) } else { [0.0; D] };
        },
    );
    nodes.change.clone_from(&nodes.velocity);
}

/// Add to the nodal velocity what the deviatoric stress does in `dt` seconds, with the gradients of the velocity `from` at the particles.
/// Return the power of the stress, W.
pub(super) fn add_stress<const D: usize>(
    team: &Team,
    (blocks, frame): (&Blocks<D>, &Frame<D>),
    liquids: &[Liquid<D>],
    (fluid, dt): (Fluid, f64),
    nodes: &mut Nodes<D>,
) -> f64 {
    let from = &nodes.velocity;
    let Scratch { records, occupied, .. } = &mut nodes.scratch;
    let mut with: Vec<(usize, f64)> = occupied.iter().map(|b| (*b, 0.0)).collect();
    team.each_piece(records, reached(D), &mut with, |_, records, (b, power)| {
        let mut tile = [[0.0; D]; TILE_CELLS];
        blocks.load(*b, from, [0.0; D], &mut tile);
        let what = What::Force(fluid.viscosity, &tile);
        *power = f64::dispatch(Scatter { what, liquids, block: *b, key: blocks.keys[*b], frame, records });
    });
    let mass = fluid.density * frame.h.powi(D as i32);
    add(
        team,
        blocks,
        &nodes.scratch,
        (&mut nodes.volume, &mut nodes.velocity),
        |(_, f), volume, velocity| {
            if *volume > 0.0 {
                (0..D).for_each(|d| velocity[d] += dt * f[d] / (mass * volume.max(LIGHT)));
            }
        },
    );
    with.iter().map(|(_, power)| power).sum()
}

/// Add the records of blocks at their common nodes, and take the sums to volume and velocity.
fn add<const D: usize>(
    team: &Team,
    blocks: &Blocks<D>,
    scratch: &Scratch<D>,
    (volume, velocity): (&mut [f64], &mut [[f64; D]]),
    take: impl Fn((f64, [f64; D]), &mut f64, &mut [f64; D]) + Sync + Send,
) {
    let (cells, length) = (Blocks::<D>::CELLS, reached(D));
    let mut pieces: Vec<&mut [[f64; D]]> = velocity.chunks_mut(cells).collect();
    team.each_piece(volume, cells, &mut pieces, |b, volume, velocity| {
        let mut sum = [(0.0, [0.0; D]); 64];
        for (n, &other) in blocks.near(b).iter().enumerate() {
            let by = offset::<D>(n);
            if other == NONE || scratch.place[other as usize] == NONE || by.contains(&1) {
                continue;
            }
            let records = &scratch.records[scratch.place[other as usize] as usize * length..][..length];
            for (i, sum) in sum.iter_mut().enumerate().take(cells) {
                // Only the lowest nodes are those at the upper end of a block below.
                let at = local::<D>(i);
                if (0..D).any(|d| by[d] < 0 && at[d] > 0) {
                    continue;
                }
                let there = (0..D).rev().fold(0, |t, d| t * REACH + if by[d] < 0 { SIDE } else { at[d] });
                let (v, q) = &records[there];
                sum.0 += v;
                (0..D).for_each(|d| sum.1[d] += q[d]);
            }
        }
        for i in 0..cells {
            take(sum[i], &mut volume[i], &mut velocity[i]);
        }
    });
}
