//! Density renewal of liquids: volume ratios that follow the space which particles occupy.
//!
//! A weakly compressible liquid integrates its volume ratio J from rates. Two errors grow: differences between the particles of
//! a cell, which nodes do not resolve, and the difference between the sum of the volumes and the space that the particles
//! occupy, since positions and volumes follow the velocity field by different means. Every [`EVERY`] steps
//!
//! - J is moved halfway to a linear fit over its surroundings, J~(x) = sum_i N_i(x) (a_i + b_i . (x - x_i)), with a_i and b_i
//!   the least squares fit of the particles on node i, weighted by mass and N_i: linear fields (hydrostatic pressure) are
//!   unchanged, also at walls and at the surface; differences within a cell and from cell to cell decay;
//! - J is reduced by e times the rate below, where the liquid occupies more than its space, and increased where less. At a
//!   node e = phi_i - 1, phi_i = sum_p V_p N_i(x_p) / integral of N_i over the open space, of all bodies in the scene; planes
//!   bound the open space, and nodes behind a plane are added to their mirror images: a row of particles beside a wall, which is
//!   no integral, has no deviation. Near the free surface, where phi falls without an error, deviations of [`SURFACE`] are allowed and
//!   lower occupancy is no error. The deviation is smoothed over neighbouring nodes: pressure cannot remove one that
//!   alternates from node to node.
//!
//! The occupancy changes pressures through the equation of state, so that momentum is conserved. The change of the elastic
//! energy is booked as numerical viscosity. Sums are in the order of blocks: equal bits for any number of threads.

use crate::dim::{BLOCK, block_nodes, neighbours};
use crate::particles::{Block, Columns, Place};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::bodies::seeding::bears_shear_and_tension;
use crate::step::mpm::Mpm;
use impactite_scene::boundary::{Boundary, Side};
use impactite_scene::error::SceneError;
use impactite_simd::{Float, Team};
use mpm_materials::Material;

/// Steps from one renewal to the next.
const EVERY: u64 = 10;
/// Fraction of the difference to the fit that J changes in a renewal.
const FIT: f64 = 0.5;
/// Times h / c in which a deviation of the occupancy decays: so slowly that pressures of the correction are small,
/// rho e (h / time)^2, and faster than flow causes it.
const TIME: f64 = 20.0;
/// Largest fraction of a deviation that is corrected in a renewal.
const MOST: f64 = 0.5;
/// Least occupancy of the nodes around a node in the interior of the liquid.
const INTERIOR: f64 = 0.85;
/// Least occupancy of the nodes around a node that has at most a small deviation by the shape of the surface.
const NEAR_SURFACE: f64 = 0.5;
/// Deviation of the occupancy near the surface that is no error: 1/48 for a flat surface one cell above a node.
const SURFACE: f64 = 0.03;
/// Least open fraction of a node whose occupancy is known.
const OPEN: f64 = 0.1;
/// Nodes of the stencil of an axis, and of a tile.
const NODES: usize = 3;
const TILE: usize = BLOCK + NODES - 1;
/// Least pivot of a least squares fit, h^2.
const PIVOT: f64 = 0.01;

/// Sums over the particles of a block at the nodes that they reach.
#[derive(Clone, Debug)]
pub struct Tile<const D: usize> {
    coordinates: [i32; D],
    /// `numbers` values per node: occupied volume in cells; with moments also those of [`moments`].
    sums: Vec<f64>,
}

/// Number of moments of a node: w, w x, w x x, w (J - 1), w (J - 1) x.
const fn moments(d: usize) -> usize {
    2 + 2 * d + d * (d + 1) / 2
}

/// Open space between planes: lowest and highest coordinate along each axis, m.
#[derive(Clone, Copy, Debug)]
struct Open<const D: usize> {
    low: [f64; D],
    high: [f64; D],
}

/// Integral of the quadratic B-spline of spacing one from minus infinity.
fn integral(u: f64) -> f64 {
    match u {
        u if u <= -1.5 => 0.0,
        u if u < -0.5 => (u + 1.5).powi(3) / 6.0,
        u if u < 0.5 => 0.5 + 0.75 * u - u.powi(3) / 3.0,
        u if u < 1.5 => 1.0 - (1.5 - u).powi(3) / 6.0,
        _ => 1.0,
    }
}

impl<const D: usize> Open<D> {
    fn of(boundaries: &[Boundary<D>], time: f64, revolved: bool) -> Self {
        let mut open = Open { low: [f64::NEG_INFINITY; D], high: [f64::INFINITY; D] };
        if revolved {
            open.low[0] = 0.0;
        }
        for boundary in boundaries {
            let (axis, at, side) = match *boundary {
                Boundary::Symmetry { axis, at, side }
                | Boundary::Fixed { axis, at, side }
                | Boundary::Absorbing { axis, at, side, .. } => (axis, at, side),
                Boundary::Wall { axis, at, side, velocity } => (axis, at + velocity * time, side),
                Boundary::FrictionWall { axis, at, side, velocity, .. } => {
                    (axis, at + velocity[axis] * time, side)
                }
                _ => continue,
            };
            match side {
                Side::Above => open.low[axis] = open.low[axis].max(at),
                Side::Below => open.high[axis] = open.high[axis].min(at),
            }
        }
        open
    }
    /// Integral of the weight of a node at `x` over the open space, over the volume of a cell.
    fn share(&self, x: &[f64; D], spacing: f64) -> f64 {
        let along =
            |d: usize| integral((self.high[d] - x[d]) / spacing) - integral((self.low[d] - x[d]) / spacing);
        (0..D).map(along).product::<f64>().max(0.0)
    }
}

/// Weights of a particle along each axis.
fn weights<const D: usize>(xi: &[f64; D]) -> [[f64; NODES]; D] {
    xi.map(|xi| [0.5 * (0.5 - xi).powi(2), 0.75 - xi * xi, 0.5 * (0.5 + xi).powi(2)])
}

/// Index in a tile of the first stencil node of a bin.
fn corner<const D: usize>(bin: usize) -> usize {
    let (mut rest, mut stride, mut at) = (bin, 1, 0);
    for _ in 0..D {
        at += rest % BLOCK * stride;
        rest /= BLOCK;
        stride *= TILE;
    }
    at
}

/// Call `visit` with the offset in the tile, the weight, and the position of the particle from the node, in cells.
#[inline(always)]
fn each_node<const D: usize>(xi: &[f64; D], mut visit: impl FnMut(usize, f64, &[f64; D])) {
    let along = weights(xi);
    for n in 0..NODES.pow(D as u32) {
        let (mut rest, mut stride, mut offset, mut weight) = (n, 1, 0, 1.0);
        let mut from = [0.0; D];
        for d in 0..D {
            let a = rest % NODES;
            rest /= NODES;
            weight *= along[d][a];
            from[d] = xi[d] - (a as f64 - 1.0);
            offset += a * stride;
            stride *= TILE;
        }
        visit(offset, weight, &from);
    }
}

/// Coordinates `0..size` of item `n` of a box, x fastest.
fn unfold<const D: usize>(mut n: usize, size: usize) -> [i32; D] {
    std::array::from_fn(|_| {
        let x = n % size;
        n /= size;
        x as i32
    })
}

/// Node blocks around a liquid, with numbers at their nodes.
struct NodeBlocks<const D: usize> {
    coordinates: Vec<[i32; D]>,
    /// Node blocks around each, 3^D, x fastest.
    around: Vec<u32>,
}

impl<const D: usize> NodeBlocks<D> {
    fn around_of(tiles: &[Tile<D>], wrapped: &dyn Fn([i32; D]) -> [i32; D]) -> Self {
        let beside = |at: &[i32; D], n: usize| {
            let off: [i32; D] = unfold(n, 3);
            wrapped(std::array::from_fn(|d| at[d] + off[d] - 1))
        };
        let list = |tile: &Tile<D>| {
            (0..neighbours(D)).map(move |n| beside(&tile.coordinates, n)).collect::<Vec<_>>()
        };
        let mut coordinates: Vec<[i32; D]> = tiles.iter().flat_map(list).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        let find = |at: [i32; D]| coordinates.binary_search(&at).map_or(u32::MAX, |n| n as u32);
        let around = coordinates
            .iter()
            .flat_map(|at| (0..neighbours(D)).map(|n| find(beside(at, n))).collect::<Vec<_>>())
            .collect();
        NodeBlocks { coordinates, around }
    }
    fn len(&self) -> usize {
        self.coordinates.len()
    }
    /// Index of the node at `at` from the first node of block `block`, each coordinate from -BLOCK to 2 BLOCK - 1.
    fn node(&self, block: usize, at: &[i32; D]) -> Option<usize> {
        let (mut beside, mut inside, mut stride, mut step) = (0, 0, 1, 1);
        for x in at {
            beside += (x.div_euclid(BLOCK as i32) + 1) as usize * stride;
            inside += x.rem_euclid(BLOCK as i32) as usize * step;
            stride *= 3;
            step *= BLOCK;
        }
        let found = self.around[block * neighbours(D) + beside];
        (found != u32::MAX).then(|| found as usize * block_nodes(D) + inside)
    }
    /// Add the values of nodes behind a plane to those of their mirror images in front. The plane is across `axis` at the node
    /// coordinate `at`; `sign` is 1 if the open space is above.
    fn mirrored(&self, of: &[[f64; 2]], (axis, at, sign): (usize, f64, i32), team: &Team) -> Vec<[f64; 2]> {
        let (mut to, mut each) = (of.to_vec(), vec![(); self.len()]);
        team.each_piece(&mut to, block_nodes(D), &mut each, |block, to, ()| {
            for (n, to) in to.iter_mut().enumerate() {
                let mut inside: [i32; D] = unfold(n, BLOCK);
                let node = self.coordinates[block][axis] * BLOCK as i32 + inside[axis];
                let front = f64::from(sign) * (f64::from(node) - at);
                if front < -1e-6 {
                    *to = [0.0; 2];
                } else if (1e-6..2.0).contains(&front) {
                    let behind = (2.0 * at - f64::from(node)).round() as i32;
                    if f64::from(sign) * (f64::from(behind) - at) < -1e-6 {
                        inside[axis] += behind - node;
                        if let Some(image) = self.node(block, &inside) {
                            (0..2).for_each(|n| to[n] += of[image][n]);
                        }
                    }
                }
            }
        });
        to
    }
    /// Add the tiles of a body to `sums`, with `count` values per node.
    fn add(
        &self,
        tiles: &[Tile<D>],
        wrapped: &(dyn Fn([i32; D]) -> [i32; D] + Sync),
        count: usize,
        sums: &mut [f64],
        team: &Team,
    ) {
        let mut each = vec![(); self.len()];
        team.each_piece(sums, block_nodes(D) * count, &mut each, |block, sums, ()| {
            for n in 0..neighbours(D) {
                let off: [i32; D] = unfold(n, 3);
                let at = std::array::from_fn(|d| self.coordinates[block][d] + off[d] - 1);
                let Ok(tile) = tiles.binary_search_by_key(&wrapped(at), |tile| tile.coordinates) else {
                    continue;
                };
                let tile = &tiles[tile].sums;
                for node in 0..block_nodes(D) {
                    let inside: [i32; D] = unfold(node, BLOCK);
                    let (mut place, mut stride, mut reached) = (0, 1, true);
                    for d in 0..D {
                        let t = inside[d] + 1 - BLOCK as i32 * (off[d] - 1);
                        reached &= (0..TILE as i32).contains(&t);
                        place += t.max(0) as usize * stride;
                        stride *= TILE;
                    }
                    if reached {
                        let (to, from) =
                            (&mut sums[node * count..][..count], &tile[place * count..][..count]);
                        to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
                    }
                }
            }
        });
    }
}

/// Fit of J - 1 at a node: value and slope per cell.
fn fit<const D: usize>(sums: &[f64]) -> [f64; 4] {
    let mut found = [0.0; 4];
    let mass = sums[0];
    if mass <= 0.0 {
        return found;
    }
    let second = 1 + D;
    let values = second + D * (D + 1) / 2;
    let mean: [f64; D] = std::array::from_fn(|d| sums[1 + d] / mass);
    let value = sums[values] / mass;
    // Cholesky factors of the second moment about the centre, then the slope.
    let (mut l, mut slope, mut n) = ([[0.0; D]; D], [0.0; D], second);
    for i in 0..D {
        for j in i..D {
            l[j][i] = sums[n] / mass - mean[i] * mean[j];
            n += 1;
        }
        slope[i] = sums[values + 1 + i] / mass - value * mean[i];
    }
    let mut known = true;
    for i in 0..D {
        for j in 0..i {
            l[i][i] -= l[i][j] * l[i][j];
        }
        known &= l[i][i] > PIVOT;
        l[i][i] = l[i][i].max(PIVOT).sqrt();
        for k in i + 1..D {
            for j in 0..i {
                l[k][i] -= l[k][j] * l[i][j];
            }
            l[k][i] /= l[i][i];
        }
    }
    found[0] = value;
    if !known {
        return found;
    }
    for i in 0..D {
        for j in 0..i {
            slope[i] -= l[i][j] * slope[j];
        }
        slope[i] /= l[i][i];
    }
    for i in (0..D).rev() {
        for j in i + 1..D {
            slope[i] -= l[j][i] * slope[j];
        }
        slope[i] /= l[i][i];
    }
    found[0] -= slope.iter().zip(&mean).map(|(slope, mean)| slope * mean).sum::<f64>();
    found[1..=D].copy_from_slice(&slope);
    found
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    fn offset(block: &Block<T, D>, at: Place) -> [f64; D] {
        std::array::from_fn(|d| block.get(at, Columns::position() + d).to_double())
    }

    /// Volume of a particle over that of a cell; the reference one without a row of the volume ratio.
    fn cells_of(&self, block: &Block<T, D>, bin: usize, at: Place, row: Option<usize>) -> f64 {
        let mass = self.masses.read(|row| block.get(at, row)).to_double();
        let ratio = row.map_or(1.0, |row| block.get(at, row).to_double());
        let h = self.lattice.spacing();
        let mut cell = h.powi(D as i32);
        if self.facts().hoop {
            let cells =
                f64::from(block.bin_coordinates(bin)[0]) + block.get(at, Columns::position()).to_double();
            cell *= (self.lattice.origin()[0] + h * cells).abs().max(1e-6 * h);
        }
        mass * ratio / (self.material.density().to_double() * cell)
    }

    /// Return the sums of the particles of each block, in the order of blocks; with moments if the body is renewed.
    pub(in crate::step) fn density_tiles(&self, team: &Team) -> Vec<Tile<D>> {
        if self.facts().nodes != NODES {
            return Vec::new();
        }
        let row = self.renewed_row();
        let count = 1 + if self.renewed.is_some() { moments(D) } else { 0 };
        let mut tiles: Vec<Tile<D>> = self
            .in_place()
            .map(|slot| Tile { coordinates: slot.block.coordinates, sums: Vec::new() })
            .collect();
        team.each(&mut tiles, |n, tile| {
            let block = &self.slots[self.index[n].1 as usize].block;
            tile.sums.resize(TILE.pow(D as u32) * count, 0.0);
            for (bin, at) in block.places() {
                let (xi, corner) = (Self::offset(block, at), corner::<D>(bin));
                let volume = self.cells_of(block, bin, at, row);
                let ratio = row.map_or(1.0, |row| block.get(at, row).to_double());
                let (mass, strain) = (volume / ratio, ratio - 1.0);
                each_node(&xi, |offset, weight, from| {
                    let to = &mut tile.sums[(corner + offset) * count..][..count];
                    to[0] += weight * volume;
                    if count == 1 {
                        return;
                    }
                    let w = weight * mass;
                    let (to, mut n) = (&mut to[1..], 1 + D);
                    to[0] += w;
                    for d in 0..D {
                        to[1 + d] += w * from[d];
                        for e in d..D {
                            to[n] += w * from[d] * from[e];
                            n += 1;
                        }
                    }
                    to[n] += w * strain;
                    for d in 0..D {
                        to[n + 1 + d] += w * strain * from[d];
                    }
                });
            }
        });
        tiles
    }

    /// Row of the volume ratio, if the body is renewed.
    fn renewed_row(&self) -> Option<usize> {
        self.renewed.and_then(|_| Some(Columns::state(D) + volume_place(&*self.material)?))
    }

    /// Move volume ratios to the fits and occupancies at the nodes. Return the change of the elastic energy, J.
    fn take_density(
        &mut self,
        nodes: &NodeBlocks<D>,
        fits: &[[f64; 4]],
        errors: &[[f64; 2]],
        rate: f64,
        team: &Team,
    ) -> f64 {
        let Some(row) = self.renewed_row() else { return 0.0 };
        let mut slots = std::mem::take(&mut self.slots);
        let mut changes = vec![0.0; slots.len()];
        let body = &*self;
        let density = self.material.density().to_double();
        team.each_piece(&mut slots, 1, &mut changes, |_, slot, change| {
            let block = &mut slot[0].block;
            let Ok(here) = nodes.coordinates.binary_search(&block.coordinates) else { return };
            let places: Vec<(usize, Place)> = block.places().collect();
            let of_tile: Vec<Option<usize>> = (0..TILE.pow(D as u32))
                .map(|n| nodes.node(here, &unfold::<D>(n, TILE).map(|x| x - 1)))
                .collect();
            let states = body.material.numbers();
            let mut state = vec![T::default(); states];
            for (bin, at) in places {
                let (xi, corner) = (Self::offset(block, at), corner::<D>(bin));
                let (mut strain, mut error, mut open) = (0.0, 0.0, 0.0);
                each_node(&xi, |offset, weight, from| {
                    let Some(node) = of_tile[corner + offset] else { return };
                    let fit = &fits[node];
                    let mut value = fit[0];
                    for d in 0..D {
                        value += fit[1 + d] * from[d];
                    }
                    strain += weight * value;
                    error += weight * errors[node][0] * errors[node][1];
                    open += weight * errors[node][1];
                });
                let energy = |block: &Block<T, D>, state: &mut [T]| {
                    for (n, x) in state.iter_mut().enumerate() {
                        *x = block.get(at, Columns::state(D) + n);
                    }
                    body.material.energy_of(state).map_or(0.0, T::to_double)
                };
                let before = energy(block, &mut state);
                let old = block.get(at, row).to_double();
                let mut ratio = old + FIT * (1.0 + strain - old);
                if open > 0.0 {
                    ratio *= 1.0 - rate * error / open;
                }
                block.set(at, row, T::of(ratio));
                let mass = body.masses.read(|row| block.get(at, row)).to_double();
                *change += mass / density * (energy(block, &mut state) - before);
            }
        });
        self.slots = slots;
        self.index.iter().map(|&(_, slot)| changes[slot as usize]).sum()
    }
}

/// Index of the volume ratio in a state, for a fluid whose pressure depends on it alone: the states of other fluids have an energy,
/// and only fluids bear neither shear nor tension with a volume ratio as first number.
pub(in crate::step) fn volume_place<T: Float>(material: &dyn Material<T>) -> Option<usize> {
    let names = material.state_names();
    let of_fluid = names.first().is_some_and(|name| name == "volume_ratio")
        && !names.iter().any(|name| name == "energy");
    (of_fluid && !bears_shear_and_tension(material)).then_some(0)
}

/// Deviation of the occupancy of a node, not smoothed: `phi` has occupancy and open fraction.
fn deviation<const D: usize>(nodes: &NodeBlocks<D>, phi: &[[f64; 2]], block: usize, at: &[i32; D]) -> f64 {
    let mut least = f64::INFINITY;
    for n in 0..neighbours(D) {
        let off: [i32; D] = unfold(n, 3);
        let beside = nodes.node(block, &std::array::from_fn(|d| at[d] + off[d] - 1));
        let [occupied, open] = beside.map_or([0.0, 1.0], |node| phi[node]);
        if open >= OPEN {
            least = least.min(occupied);
        }
    }
    let more = nodes.node(block, at).map_or(0.0, |node| phi[node][0] - 1.0);
    let over = (more - SURFACE).max(0.0);
    match least {
        least if least > INTERIOR => more,
        least if least > NEAR_SURFACE => over + (more + SURFACE).min(0.0),
        _ => over,
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Renew the densities of liquids, if due.
    pub(in crate::step) fn renew_densities(&mut self, dt: T) {
        if !self.clock.steps.is_multiple_of(EVERY) || !self.scene.bodies.iter().any(|b| b.renewed().is_some())
        {
            return;
        }
        let (team, lattice) = (self.team.clone(), *self.grid.lattice());
        let h = lattice.spacing();
        let wrap = self.wrap().unwrap_or_default();
        let wrapped = |at: [i32; D]| wrap.block(at);
        let open = Open::of(&self.scene.conditions.boundaries, self.clock.time, self.facts().hoop);
        let tiles: Vec<Vec<Tile<D>>> = self.scene.bodies.iter().map(|b| b.density_tiles(&team)).collect();
        for number in 0..self.scene.bodies.len() {
            let Some(speed) = self.scene.bodies[number].renewed() else { continue };
            let nodes = NodeBlocks::around_of(&tiles[number], &wrapped);
            let (size, mut each) = (block_nodes(D), vec![(); nodes.len()]);
            let count = 1 + moments(D);
            let mut sums = vec![0.0; nodes.len() * size * count];
            nodes.add(&tiles[number], &wrapped, count, &mut sums, &team);
            let mut others = vec![0.0; nodes.len() * size];
            for (n, list) in tiles.iter().enumerate().filter(|(n, list)| *n != number && !list.is_empty()) {
                let values = if self.scene.bodies[n].renewed().is_some() { count } else { 1 };
                let mut of = vec![0.0; nodes.len() * size * values];
                nodes.add(list, &wrapped, values, &mut of, &team);
                others.iter_mut().zip(of.chunks_exact(values)).for_each(|(to, of)| *to += of[0]);
            }
            let mut fits = vec![[0.0; 4]; nodes.len() * size];
            let mut phi = vec![[0.0; 2]; nodes.len() * size];
            team.each_piece(&mut fits, size, &mut each, |block, fits, ()| {
                for (n, to) in fits.iter_mut().enumerate() {
                    *to = fit::<D>(&sums[(block * size + n) * count + 1..][..count - 1]);
                }
            });
            team.each_piece(&mut phi, size, &mut each, |block, phi, ()| {
                for (n, to) in phi.iter_mut().enumerate() {
                    let inside: [i32; D] = unfold(n, BLOCK);
                    let x = std::array::from_fn(|d| {
                        let node = nodes.coordinates[block][d] * BLOCK as i32 + inside[d];
                        lattice.origin()[d] + h * f64::from(node)
                    });
                    let (node, share) = (block * size + n, open.share(&x, h));
                    *to = [sums[node * count] + others[node], share];
                }
            });
            for axis in 0..D {
                for (plane, sign) in [(open.low[axis], 1), (open.high[axis], -1)] {
                    if plane.is_finite() {
                        phi = nodes.mirrored(&phi, (axis, (plane - lattice.origin()[axis]) / h, sign), &team);
                    }
                }
            }
            for [occupied, share] in &mut phi {
                *occupied = if *share >= OPEN { *occupied / *share } else { 0.0 };
            }
            let mut raw = vec![0.0; nodes.len() * size];
            team.each_piece(&mut raw, size, &mut each, |block, raw, ()| {
                for (n, to) in raw.iter_mut().enumerate() {
                    *to = deviation(&nodes, &phi, block, &unfold(n, BLOCK));
                }
            });
            // Deviations smoothed over the neighbouring nodes, with their open fractions.
            let mut errors = vec![[0.0; 2]; nodes.len() * size];
            team.each_piece(&mut errors, size, &mut each, |block, errors, ()| {
                for (n, to) in errors.iter_mut().enumerate() {
                    let at: [i32; D] = unfold(n, BLOCK);
                    let (mut sum, mut weights) = (0.0, 0.0);
                    for n in 0..neighbours(D) {
                        let off: [i32; D] = unfold(n, 3);
                        let beside = nodes.node(block, &std::array::from_fn(|d| at[d] + off[d] - 1));
                        let Some(node) = beside else { continue };
                        let across = off.iter().filter(|off| **off != 1).count();
                        let weight = 0.5f64.powi((D + across) as i32) * phi[node][1];
                        sum += weight * raw[node];
                        weights += weight;
                    }
                    *to = [if weights > 0.0 { sum / weights } else { 0.0 }, phi[block * size + n][1]];
                }
            });
            let rate = (EVERY as f64 * dt.to_double() * speed / (TIME * h)).min(MOST);
            if let Some(body) = self.scene.bodies[number].particles_mut() {
                let more = body.take_density(&nodes, &fits, &errors, rate, &team);
                self.ledger.viscosity -= more;
            }
        }
    }

    /// Check that densities of a body can be renewed.
    pub(in crate::step) fn check_renewed(&self, body: &str, place: Option<usize>) -> Result<(), SceneError> {
        let facts = self.facts();
        if place.is_none() {
            return Err(SceneError::NoRenewal(
                body.into(),
                "its law must be a fluid whose pressure depends on the volume alone",
            ));
        }
        if facts.nodes != NODES || facts.domain.carried() || facts.total || facts.before_forces || facts.remap
        {
            return Err(SceneError::NoRenewal(
                body.into(),
                "the method must have quadratic B-splines, USL and the updated Lagrangian frame",
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_field_is_fitted_exactly() {
        // Four particles around a node, off its position.
        let points = [[0.1, 0.2], [0.6, 0.3], [-0.4, 0.7], [0.2, -0.5]];
        let mut sums = [0.0; moments(2)];
        for x in points {
            let value = 0.3 - 2.0 * x[0] + 5.0 * x[1];
            let numbers =
                [1.0, x[0], x[1], x[0] * x[0], x[0] * x[1], x[1] * x[1], value, value * x[0], value * x[1]];
            (0..9).for_each(|n| sums[n] += numbers[n]);
        }
        let found = fit::<2>(&sums);
        for (found, exact) in found.iter().zip([0.3, -2.0, 5.0]) {
            assert!((found - exact).abs() < 1e-13, "{found} is not {exact}");
        }
    }

    #[test]
    fn particles_in_a_row_have_their_mean() {
        let mut sums = [0.0; moments(2)];
        for x in [-0.25f64, 0.25] {
            let numbers = [1.0, x, 0.0, x * x, 0.0, 0.0, 2.0, 2.0 * x, 0.0];
            (0..9).for_each(|n| sums[n] += numbers[n]);
        }
        assert_eq!(fit::<2>(&sums), [2.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn open_fractions_of_all_nodes_are_the_open_space() {
        let open = Open { low: [0.3, f64::NEG_INFINITY], high: [7.1, f64::INFINITY] };
        let sum: f64 = (-3..12).map(|n| open.share(&[f64::from(n), 0.0], 1.0)).sum();
        assert!((sum - 6.8).abs() < 1e-13, "{sum}");
        assert!((open.share(&[0.3 - 0.5, 0.0], 1.0) - 1.0 / 6.0).abs() < 1e-13);
    }
}
