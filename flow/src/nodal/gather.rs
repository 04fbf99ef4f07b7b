//! Transfer of nodes to particles, FLIP with a share of PIC, and their motion by a Runge-Kutta step of third order.

use impactite_simd::{Arch, Float, Kernel, Team};

use super::nodes::Nodes;
use super::transfer::{corner, hat, step_to};
use crate::blocks::{HALO, SIDE, TILE, TILE_CELLS};
use crate::gather::{Gather, Sums};
use crate::grid::Grid;
use crate::particles::{Frame, Liquid, Particle};
use crate::transfer::sample_centres;

/// Places in a tile: two layers of nodes below the block, of which the place is at most a cell above it.
const PLACES: (usize, usize, usize) = (HALO, HALO + SIDE, TILE);

/// Data of the transfer.
pub(super) struct NodalGather<'a, const D: usize> {
    pub grid: &'a Grid<D>,
    pub frame: &'a Frame<D>,
    pub nodes: &'a Nodes<D>,
    /// Share of PIC.
    pub pic: f64,
    pub dt: f64,
}

struct Tiles<const D: usize> {
    velocity: [[f64; D]; TILE_CELLS],
    change: [[f64; D]; TILE_CELLS],
    pressure: [f64; TILE_CELLS],
}

struct Work<'a, const D: usize> {
    on: &'a NodalGather<'a, D>,
    key: [i32; D],
    tiles: &'a Tiles<D>,
    particles: &'a mut [Particle<D>],
    sums: &'a mut Sums<D>,
}

/// Velocity at a place of a block.
#[inline(always)]
fn velocity_at<const D: usize>(tile: &[[f64; D]; TILE_CELLS], at: &[f64; D]) -> [f64; D] {
    let (base, part) = corner(at, PLACES);
    let mut v = [0.0; D];
    for n in 0..1 << D {
        let weight = hat(&part, n).0;
        let node = &tile[(base + step_to::<D>(n, TILE)) & (TILE_CELLS - 1)];
        (0..D).for_each(|d| v[d] += weight * node[d]);
    }
    v
}

impl<const D: usize> Kernel<f64> for Work<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Work { on, key, tiles, particles, sums } = self;
        let step = on.dt / on.frame.h;
        let mut local = Sums::<D>::default();
        for (n, p) in particles.iter_mut().enumerate() {
            let at = on.frame.local(&p.x, &key);
            let (base, part) = corner(&at, PLACES);
            let (mut v, mut by, mut c) = ([0.0; D], [0.0; D], [[0.0; D]; D]);
            for k in 0..1 << D {
                let (weight, slope) = hat(&part, k);
                let node = (base + step_to::<D>(k, TILE)) & (TILE_CELLS - 1);
                let (u, du) = (&tiles.velocity[node], &tiles.change[node]);
                for d in 0..D {
                    v[d] += weight * u[d];
                    by[d] += weight * du[d];
                    (0..D).for_each(|e| c[d][e] += slope[e] * u[d]);
                }
            }
            let (mut square, mut displacement) = (0.0, 0.0f64);
            for d in 0..D {
                let new = (1.0 - on.pic) * (p.v[d] + by[d]) + on.pic * v[d];
                local.before[d] += p.volume * p.v[d];
                local.after[d] += p.volume * new;
                local.change += p.volume * (new - p.v[d]) * (new - p.v[d]);
                p.v[d] = new;
                square += new * new;
                displacement = displacement.max((step * v[d]).abs());
            }
            p.c = c;
            p.pressure = sample_centres(&tiles.pressure, &at).0;
            // A velocity that is not a number fails.
            let within = displacement <= 1.0 && square.is_finite() && v.iter().all(|v| v.is_finite());
            if !within {
                local.failed = local.failed.or(Some(n));
                continue;
            }
            local.speed = local.speed.max(square.sqrt());
            let moved = runge_kutta(&tiles.velocity, at, v, step);
            for d in 0..D {
                let by = on.frame.h * moved[d];
                p.x[d] += by;
                local.moved[d] += p.volume * by;
            }
        }
        *sums = local;
    }
}

/// Displacement, in cells, of a place with the velocity `v` by the third-order step of Shu and Osher; `step` is time over width of a cell.
#[inline(always)]
fn runge_kutta<const D: usize>(
    tile: &[[f64; D]; TILE_CELLS],
    at: [f64; D],
    v: [f64; D],
    step: f64,
) -> [f64; D] {
    let first: [f64; D] = std::array::from_fn(|d| step * v[d]);
    let place = |by: &[f64; D]| std::array::from_fn(|d| at[d] + by[d].clamp(-1.0, 1.0));
    let v1 = velocity_at(tile, &place(&first));
    let second: [f64; D] = std::array::from_fn(|d| 0.25 * (first[d] + step * v1[d]));
    let v2 = velocity_at(tile, &place(&second));
    std::array::from_fn(|d| 2.0 / 3.0 * (second[d] + step * v2[d]))
}

impl<const D: usize> NodalGather<'_, D> {
    /// Update the particles of a liquid, and return their sums.
    pub fn run(&self, team: &Team, liquid: &mut Liquid<D>) -> Sums<D> {
        let blocks = &self.grid.blocks;
        let mut sums = vec![Sums::default(); blocks.len()];
        let starts = &liquid.starts;
        let walls = Gather {
            blocks,
            frame: self.frame,
            cuts: &self.grid.cuts,
            velocity: &self.grid.velocity,
            shift: None,
            pressure: &self.grid.pressure,
            walls: None,
            dt: self.dt,
            midpoint: false,
        };
        team.each_part(&mut liquid.particles, starts, &mut sums, |b, particles, sums| {
            if particles.is_empty() {
                return;
            }
            let mut tiles = Tiles {
                velocity: [[0.0; D]; TILE_CELLS],
                change: [[0.0; D]; TILE_CELLS],
                pressure: [0.0; TILE_CELLS],
            };
            blocks.load(b, &self.nodes.velocity, [0.0; D], &mut tiles.velocity);
            blocks.load(b, &self.nodes.change, [0.0; D], &mut tiles.change);
            blocks.load(b, &self.grid.pressure, 0.0, &mut tiles.pressure);
            let key = blocks.keys[b];
            f64::dispatch(Work { on: self, key, tiles: &tiles, particles: &mut *particles, sums });
            walls.finish(b, particles, sums, starts[b]);
        });
        let mut total = Sums::default();
        sums.iter().for_each(|s| total.add(s));
        total
    }
}
