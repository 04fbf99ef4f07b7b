//! Sums and renewal of the densities of a body of particles.

use super::particle_body::ParticleBody;
use super::seeding::bears_shear_and_tension;
use crate::particles::{Block, Columns, Place};
use crate::step::nodes::occupancy::{NODES, NodeBlocks, TILE, Tile, corner, each_node, moments, unfold};
use impactite_simd::{Float, Team};
use mpm_materials::Material;

/// Fraction of the difference to the fit that J changes in a renewal.
const FIT: f64 = 0.5;

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
    pub(in crate::step) fn take_density(
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
