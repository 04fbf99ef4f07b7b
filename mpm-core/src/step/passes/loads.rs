//! Loads of particles on the grid: force and power.
//!
//! Loads are separate from the passes, so that bodies without a load do not pay for them. The forces of a loaded body are
//! added to its tiles after the pass that maps forces, when its particles are in their bins; their power is recorded before
//! the pass that changes the velocities.

use mpm_materials::Lane;

use super::migrate::place_of;
use super::slot::{Common, Slot};
use super::spread::on_cell;
use super::spread::{Maps, along_axes};
use super::tile::{Reads, TileIn, rows_of, tile_corner, tile_nodes};
use crate::dim::{Array, Stencil, block_nodes};
use crate::particles::{Block, Columns};
use crate::shape::ShapeFunction;
use crate::shape::domain::table;
use crate::step::bodies::load::LoadRows;
use crate::step::nodes::layout::Nodes;
use impactite_simd::{Arch, Float, Kernel, Quad, Vectors};

/// Loads of the particles of a block.
pub struct LoadTask<'a, T: Float, const D: usize> {
    pub(in crate::step) slot: &'a mut Slot<T, D>,
    pub(in crate::step) common: &'a Common<T>,
    /// Particle rows of the loads.
    pub(in crate::step) rows: LoadRows,
    /// Tractions on the loaded areas, Pa.
    pub(in crate::step) tractions: &'a [[f64; 3]],
    /// Quantities that the pass maps.
    pub(in crate::step) maps: Maps,
    /// All nodes of the grid, and the node blocks around the block.
    pub(in crate::step) nodes: (Nodes<'a, T>, &'a [u32]),
    /// True if nodes store accelerations.
    pub(in crate::step) reads_increment: bool,
    /// Memory of the thread.
    pub(in crate::step) tile_in: &'a mut TileIn<T>,
}

impl<T: Float, const D: usize> LoadTask<'_, T, D> {
    /// Return the load on a particle, N; none if it is zero.
    #[inline(always)]
    fn force(&self, block: &Block<T, D>, at: crate::particles::Place) -> Option<[T; 3]> {
        let mut force = [T::default(); 3];
        for (row, traction) in (self.rows.areas[0]..).zip(self.tractions) {
            let area = block.get(at, row);
            for d in 0..D {
                force[d] += area * T::of(traction[d]);
            }
        }
        if let Some(row) = self.rows.acceleration {
            let mass = self.common.masses.read(|row| block.get(at, row));
            for d in 0..D {
                force[d] += mass * block.get(at, row + d);
            }
        }
        (force != [T::default(); 3]).then_some(force)
    }
}

/// Evaluate the weights of a particle on all nodes of its stencil.
#[inline(always)]
fn weights_of<T: Float, S: ShapeFunction<T, D>, const D: usize>(
    shape: &S,
    number: impl Fn(usize) -> T,
    common: &Common<T>,
) -> <S::Extent as Stencil>::Nodes<T::Single> {
    let (xi, domain) = place_of::<T, D, S>(number, &common.domains);
    if S::DOMAIN.convects() {
        return table::<T, T::Single, S, D>(&xi, &domain).value;
    }
    let [x, y, z] = along_axes(shape, &xi, &domain);
    if S::Extent::NODES == 2 {
        return on_cell::<T::Single, S::Extent>(&[x, y, z]);
    }
    let count = S::Extent::NODES;
    let mut weights = <S::Extent as Stencil>::Nodes::<T::Single>::filled(T::Single::zero());
    for n in 0..count * count * S::Extent::LAYERS {
        let xy = x.value[n % count] * y.value[n / count % count];
        weights[n] = if D == 3 { xy * z.value[n / (count * count)] } else { xy };
    }
    weights
}

/// Return the vector from a particle at `xi` to node `n` of its stencil, cells.
#[inline(always)]
fn offset_of<T: Float, E: Stencil, const D: usize>(n: usize, xi: impl Fn(usize) -> T) -> [T; D] {
    let at = [n % E::NODES, n / E::NODES % E::NODES, n / (E::NODES * E::NODES)];
    let middle = 0.5 * (E::NODES - 1) as f64;
    std::array::from_fn(|d| T::of(at[d] as f64 - middle) - xi(d))
}

/// Return the tile index of node `n` of the stencil that begins at `corner`.
#[inline(always)]
fn node_at<E: Stencil>(corner: usize, n: usize) -> usize {
    let (i, j, k) = (n % E::NODES, n / E::NODES % E::NODES, n / (E::NODES * E::NODES));
    corner + (k * E::TILE + j) * E::TILE + i
}

/// Add the loads of a block's particles to its tile.
pub(in crate::step) struct MapLoads<'a, T: Float, const D: usize, S> {
    pub(in crate::step) shape: &'a S,
    pub(in crate::step) task: LoadTask<'a, T, D>,
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> Kernel<T> for MapLoads<'_, T, D, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let MapLoads { shape, task } = self;
        let scale = if task.maps.together { task.common.next_dt } else { T::of(1.0) };
        let mut tile = std::mem::take(&mut task.slot.tile);
        let block = &task.slot.block;
        let (first, second) = tile.all_mut().split_at_mut(tile_nodes::<S::Extent>(D));
        let to = if task.maps.second() { second } else { first };
        for bin in 0..block_nodes(D) {
            let corner = tile_corner::<S::Extent, D>(bin);
            for at in block.bin_places(bin) {
                let Some([x, y, z]) = task.force(block, at) else { continue };
                let weights = weights_of::<T, S, D>(shape, |row| block.get(at, row), task.common);
                let force = A::Quad::load(&[T::default(), x * scale, y * scale, z * scale]);
                for n in 0..S::Extent::NODES * S::Extent::NODES * S::Extent::LAYERS {
                    let node = &mut to[node_at::<S::Extent>(corner, n)];
                    let weight = A::Quad::splat(weights[n].into());
                    weight.mul_add(force, A::Quad::load(node)).store(node);
                }
            }
        }
        if let Some(row) = task.rows.affine {
            let first = &mut tile.all_mut()[..tile_nodes::<S::Extent>(D)];
            for bin in 0..block_nodes(D) {
                let corner = tile_corner::<S::Extent, D>(bin);
                for at in block.bin_places(bin) {
                    let weights = weights_of::<T, S, D>(shape, |row| block.get(at, row), task.common);
                    let mass = task.common.masses.read(|row| block.get(at, row));
                    for n in 0..S::Extent::NODES * S::Extent::NODES * S::Extent::LAYERS {
                        let off = offset_of::<T, S::Extent, D>(n, |d| block.get(at, Columns::position() + d));
                        let weight: T = weights[n].into();
                        let node = &mut first[node_at::<S::Extent>(corner, n)];
                        for c in 0..D {
                            for d in 0..D {
                                node[c + 1] += mass * weight * block.get(at, row + D * c + d) * off[d];
                            }
                        }
                    }
                }
            }
        }
        task.slot.tile = tile;
    }
}

/// Store the nodal velocities interpolated to a block's particles, m/s, in place of their acceleration, and the velocity
/// gradient of the APIC fit.
pub(in crate::step) struct CarryVelocity<'a, T: Float, const D: usize, S> {
    pub(in crate::step) shape: &'a S,
    pub(in crate::step) task: LoadTask<'a, T, D>,
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> Kernel<T> for CarryVelocity<'_, T, D, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = ();

    #[inline(always)]
    fn run<A: Arch<T>>(self) {
        let CarryVelocity { shape, task } = self;
        let Some(row) = task.rows.acceleration else { return };
        let (nodes, around) = task.nodes;
        let rows = rows_of::<S::Extent, D>(task.slot.block.occupied());
        task.tile_in.load::<S::Extent, D>(nodes, around, Reads { first: true, second: false }, rows);
        let [first, _] = task.tile_in.records();
        let block = &mut task.slot.block;
        for bin in 0..block_nodes(D) {
            let corner = tile_corner::<S::Extent, D>(bin);
            let mut next = block.last_group(bin);
            while let Some((group, here)) = next {
                next = block.group_before(group);
                for lane in 0..here as u32 {
                    let at = crate::particles::Place { group, lane };
                    let weights = weights_of::<T, S, D>(shape, |row| block.get(at, row), task.common);
                    let mut velocity = A::Quad::zero();
                    for n in 0..S::Extent::NODES * S::Extent::NODES * S::Extent::LAYERS {
                        let node = node_at::<S::Extent>(corner, n);
                        let weight = A::Quad::splat(weights[n].into());
                        velocity = weight.mul_add(A::Quad::load(&first[node]), velocity);
                    }
                    for d in 0..D {
                        block.set(at, row + d, velocity.lane(d + 1));
                    }
                    let Some(affine) = task.rows.affine else { continue };
                    let mut moments = [[T::default(); D]; D];
                    for n in 0..S::Extent::NODES * S::Extent::NODES * S::Extent::LAYERS {
                        let off = offset_of::<T, S::Extent, D>(n, |d| block.get(at, Columns::position() + d));
                        let (weight, node): (T, _) =
                            (weights[n].into(), &first[node_at::<S::Extent>(corner, n)]);
                        for c in 0..D {
                            for d in 0..D {
                                moments[c][d] += weight * node[c + 1] * off[d];
                            }
                        }
                    }
                    let (xi, domain) = place_of::<T, D, S>(|row| block.get(at, row), &task.common.domains);
                    for d in 0..D {
                        let inertia: T = shape.inertia(xi[d], domain[d]).into();
                        for c in 0..D {
                            block.set(at, affine + D * c + d, moments[c][d] / inertia);
                        }
                    }
                }
            }
        }
    }
}

/// Power of the loads of a block's particles, W: force times mid-step nodal velocity, interpolated to the particles.
/// Without nodal accelerations, the particle velocity replaces the nodal velocity before the step.
pub(in crate::step) struct BookLoads<'a, T: Float, const D: usize, S> {
    pub(in crate::step) shape: &'a S,
    pub(in crate::step) task: LoadTask<'a, T, D>,
}

impl<T: Float, const D: usize, S: ShapeFunction<T, D>> Kernel<T> for BookLoads<'_, T, D, S> {
    const VECTORS: Vectors = Vectors::Avx2;
    type Output = T;

    #[inline(always)]
    fn run<A: Arch<T>>(self) -> T {
        let BookLoads { shape, task } = self;
        let block = &task.slot.block;
        let reads = Reads { first: true, second: task.reads_increment };
        let (nodes, around) = task.nodes;
        let rows = rows_of::<S::Extent, D>(block.occupied());
        task.tile_in.load::<S::Extent, D>(nodes, around, reads, rows);
        let [first, second] = task.tile_in.records();
        let half = T::of(0.5);
        let mut power = T::default();
        for bin in 0..block_nodes(D) {
            let corner = tile_corner::<S::Extent, D>(bin);
            for at in block.bin_places(bin) {
                let Some(force) = task.force(block, at) else { continue };
                let weights = weights_of::<T, S, D>(shape, |row| block.get(at, row), task.common);
                let (mut velocity, mut gain) = (A::Quad::zero(), A::Quad::zero());
                for n in 0..S::Extent::NODES * S::Extent::NODES * S::Extent::LAYERS {
                    let node = node_at::<S::Extent>(corner, n);
                    let weight = A::Quad::splat(weights[n].into());
                    velocity = weight.mul_add(A::Quad::load(&first[node]), velocity);
                    if task.reads_increment {
                        gain = weight.mul_add(A::Quad::load(&second[node]), gain);
                    }
                }
                for d in 0..D {
                    let nodal = velocity.lane(d + 1);
                    let change = if task.reads_increment {
                        task.common.dt * gain.lane(d + 1)
                    } else {
                        nodal - block.get(at, Columns::velocity(D) + d)
                    };
                    power += force[d] * (nodal - half * change);
                }
            }
        }
        power
    }
}
