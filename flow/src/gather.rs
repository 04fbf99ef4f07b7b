//! Transfer from faces to particles, and motion of the particles.

use impactite_simd::{Arch, Float, Kernel, Team};

use crate::blocks::{Blocks, NONE, SIDE, TILE_CELLS};
use crate::cuts::Cuts;
use crate::particles::{Frame, Liquid, Particle};
use crate::transfer::{sample, sample_centres};
use crate::wall::Walls;

/// Smallest distance of a particle from a wall, in cells.
const MARGIN: f64 = 0.01;
/// Largest displacement of a particle in a step, in cells: the tile of a block covers half of it around the block.
const FARTHEST: f64 = 2.0;

/// Data of the transfer.
pub(crate) struct Gather<'a, const D: usize> {
    pub blocks: &'a Blocks<D>,
    pub frame: &'a Frame<D>,
    pub cuts: &'a Cuts<D>,
    pub velocity: &'a [Vec<f64>; D],
    /// Displacement by the density correction, in cells, if there is any.
    pub shift: Option<&'a [Vec<f64>; D]>,
    pub pressure: &'a [f64],
    /// Walls at the end of the step, if any moves.
    pub walls: Option<&'a Walls<'a, D>>,
    pub dt: f64,
    /// Take the velocity of the motion in the middle of it, instead of at its start.
    pub midpoint: bool,
}

/// Sums over the particles of a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<const D: usize> {
    /// Largest speed, m/s.
    pub speed: f64,
    /// Volume times velocity before and after, and volume times displacement.
    pub before: [f64; D],
    pub after: [f64; D],
    pub moved: [f64; D],
    /// Volume times square of the change of velocity.
    pub change: f64,
    /// Index of a particle that cannot move so far, or whose velocity is not finite.
    pub failed: Option<usize>,
}

impl<const D: usize> Default for Sums<D> {
    fn default() -> Self {
        Sums { speed: 0.0, before: [0.0; D], after: [0.0; D], moved: [0.0; D], change: 0.0, failed: None }
    }
}

impl<const D: usize> Sums<D> {
    /// Add the sums of another block.
    pub fn add(&mut self, o: &Sums<D>) {
        self.speed = self.speed.max(o.speed);
        for d in 0..D {
            self.before[d] += o.before[d];
            self.after[d] += o.after[d];
            self.moved[d] += o.moved[d];
        }
        self.change += o.change;
        self.failed = self.failed.or(o.failed);
    }
}

struct Tiles {
    velocity: [[f64; TILE_CELLS]; 3],
    shift: [[f64; TILE_CELLS]; 3],
    pressure: [f64; TILE_CELLS],
}

struct Work<'a, const D: usize> {
    on: &'a Gather<'a, D>,
    block: usize,
    tiles: &'a Tiles,
    particles: &'a mut [Particle<D>],
    sums: &'a mut Sums<D>,
}

impl<const D: usize> Kernel<f64> for Work<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<A: Arch<f64>>(self) {
        let Work { on, block, tiles, particles, sums } = self;
        let (key, per_h) = (&on.blocks.keys[block], 1.0 / on.frame.h);
        let half = 0.5 * on.dt * per_h;
        let (mut fastest, mut local) = (0.0, Sums::<D>::default());
        for (n, p) in particles.iter_mut().enumerate() {
            let at = on.frame.local(&p.x, key);
            let (mut speed, mut middle) = (0.0, at);
            for d in 0..D {
                let (v, c) = sample(&tiles.velocity[d], &at, d);
                local.before[d] += p.volume * p.v[d];
                local.after[d] += p.volume * v;
                local.change += p.volume * (v - p.v[d]) * (v - p.v[d]);
                (p.v[d], p.c[d]) = (v, c);
                speed += v * v;
                middle[d] += half * v;
            }
            p.pressure = sample_centres(&tiles.pressure, &at).0;
            // A velocity that is not a number fails.
            let within = speed * half * half <= 0.25 * FARTHEST * FARTHEST;
            if !within {
                local.failed = local.failed.or(Some(n));
                continue;
            }
            fastest = if speed > fastest { speed } else { fastest };
            for d in 0..D {
                let v = if on.midpoint { sample(&tiles.velocity[d], &middle, d).0 } else { p.v[d] };
                let mut step = on.dt * v;
                if on.shift.is_some() {
                    step += on.frame.h * sample(&tiles.shift[d], &at, d).0;
                }
                p.x[d] += step;
                local.moved[d] += p.volume * step;
            }
        }
        local.speed = fastest.sqrt();
        *sums = local;
    }
}

impl<const D: usize> Gather<'_, D> {
    /// Update the particles of a liquid, and return their sums.
    pub fn run(&self, team: &Team, liquid: &mut Liquid<D>) -> Sums<D> {
        let mut sums = vec![Sums::default(); self.blocks.len()];
        let starts = &liquid.starts;
        team.each_part(&mut liquid.particles, starts, &mut sums, |b, particles, sums| {
            if particles.is_empty() {
                return;
            }
            let mut tiles = Tiles {
                velocity: [[0.0; TILE_CELLS]; 3],
                shift: [[0.0; TILE_CELLS]; 3],
                pressure: [0.0; TILE_CELLS],
            };
            for d in 0..D {
                self.blocks.load(b, &self.velocity[d], 0.0, &mut tiles.velocity[d]);
                if let Some(shift) = self.shift {
                    self.blocks.load(b, &shift[d], 0.0, &mut tiles.shift[d]);
                }
            }
            self.blocks.load(b, self.pressure, 0.0, &mut tiles.pressure);
            f64::dispatch(Work { on: self, block: b, tiles: &tiles, particles: &mut *particles, sums });
            self.finish(b, particles, sums, starts[b]);
        });
        let mut total = Sums::default();
        sums.iter().for_each(|s| total.add(s));
        total
    }

    /// Move the particles of a block out of walls and into the period; `first` is the number of the first of them among all.
    pub fn finish(&self, b: usize, particles: &mut [Particle<D>], sums: &mut Sums<D>, first: u32) {
        let cut = self.cuts[b].is_some() || self.walls.is_some();
        for p in particles {
            if cut {
                let by = self.push(p);
                (0..D).for_each(|d| sums.moved[d] += p.volume * by[d]);
            }
            self.frame.wrap(&mut p.x);
        }
        if let Some(n) = &mut sums.failed {
            *n += first as usize;
        }
    }

    /// Move a particle out of walls, and return the displacement, m: out of one wall after another where they meet, or it would stay in a corner.
    fn push(&self, p: &mut Particle<D>) -> [f64; D] {
        let mut by = [0.0; D];
        for n in 0..=D {
            let (gap, slope) = self.gap(p);
            let least = if n == 0 { MARGIN } else { 0.5 * MARGIN };
            let square: f64 = slope.iter().map(|s| s * s).sum();
            if gap >= least || square <= 0.01 {
                break;
            }
            for d in 0..D {
                let out = (MARGIN - gap) * slope[d] / square * self.frame.h;
                by[d] += out;
                p.x[d] += out;
            }
        }
        by
    }

    /// Distance of a particle from the walls, in cells, and its gradient; the gradient is zero in open space.
    fn gap(&self, p: &Particle<D>) -> (f64, [f64; D]) {
        let mut slope = [0.0; D];
        if let Some(walls) = self.walls {
            let h = self.frame.h;
            let gap = walls.gap(p.x).0 / h;
            if gap < MARGIN {
                for d in 0..D {
                    let at = |by: f64| {
                        let mut x = p.x;
                        x[d] += by * h;
                        walls.gap(x).0 / h
                    };
                    slope[d] = (at(1e-3) - at(-1e-3)) / 2e-3;
                }
            }
            return (gap, slope);
        }
        let Some(key) = self.frame.block(&p.x) else { return (f64::INFINITY, slope) };
        let b = self.blocks.find(&key);
        if let Some(Some(cut)) = (b != NONE).then(|| &self.cuts[b as usize]) {
            let at = self.frame.local(&p.x, &key).map(|y| y.clamp(0.0, SIDE as f64));
            if cut.is_near(&at) {
                let (gap, slope, _) = cut.sample(&at);
                return (gap, slope);
            }
        }
        (f64::INFINITY, slope)
    }
}
