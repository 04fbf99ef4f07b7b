//! Loads of a body of particles: force field, tractions, their power.

use super::body::{Steps, Which};
use super::particle_body::ParticleBody;
use crate::dim::{block_nodes, neighbours};
use crate::particles::{Columns, Place};
use crate::step::nodes::layout::{Layout, Nodes};
use crate::step::passes::kernels::ShapeKernels;
use crate::step::passes::loads::LoadTask;
use crate::step::passes::spread::Maps;
use impactite_simd::{Float, Team};

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Set the acceleration of every particle by the force field at a time, s, and store the total force of all loads.
    pub(super) fn accelerate(&mut self, time: f64, team: &Team) {
        self.loading.force = [0.0; 3];
        for (traction, area) in self.loads.tractions(time).zip(&self.loaded_areas) {
            (0..3).for_each(|d| self.loading.force[d] += traction[d] * area);
        }
        let Some(field) = &self.loads.field else { return };
        let (starts, columns, masses) = (&self.starts, &self.columns, self.masses);
        let Some(first) = self.loads.rows(columns.load()).acceleration else { return };
        let mut forces = std::mem::take(&mut self.forces);
        forces.clear();
        forces.resize(self.slots.len(), [0.0; 3]);
        team.each_piece(&mut self.slots, 1, &mut forces, |_, slot, force| {
            let block = &mut slot[0].block;
            for bin in 0..block_nodes(D) {
                let mut next = block.last_group(bin);
                while let Some((group, here)) = next {
                    next = block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        // The seed identifies the children of a split particle.
                        let a = (field.acceleration)(&starts[block.number(at) % starts.len()], time);
                        let mass = masses.read(|row| block.get(at, row)).to_double();
                        for d in 0..D {
                            block.set(at, first + d, T::of(a[d]));
                            force[d] += mass * a[d];
                        }
                    }
                }
            }
        });
        for &(_, slot) in &self.index {
            for d in 0..3 {
                self.loading.force[d] += forces[slot as usize][d];
            }
        }
        self.forces = forces;
    }

    /// Run `task` on the loads of every slot, and return the sum of its results.
    pub(in crate::step) fn each_load(
        &mut self,
        nodes: Nodes<'_, T>,
        maps: Maps,
        (time, dt): (f64, Steps<T>),
        team: &Team,
        task: impl Fn(&dyn ShapeKernels<T, D>, LoadTask<'_, T, D>) -> T + Send + Sync,
    ) -> f64 {
        self.have_scratch(team);
        let common = &self.common(dt);
        let (kernels, scratch, around) = (&*self.kernels, &self.scratch, &self.nodes_around);
        let lattices = self.lattices;
        let rows = self.loads.rows(self.columns.load());
        let mut acting = std::mem::take(&mut self.loads.acting);
        acting.clear();
        acting.extend(self.loads.tractions(time));
        let tractions = &acting[..];
        let reads_increment = kernels.facts().reads_increment;
        self.powers.clear();
        self.powers.resize(self.slots.len(), T::default());
        team.each_piece(&mut self.slots, 1, &mut self.powers, |s, slot, power| {
            let slot = &mut slot[0];
            let common = common.of(lattices.level(&slot.block.coordinates));
            let mut own = team.own(scratch);
            let tile_in = own.tile_in();
            let around = around.get(s * neighbours(D)..).unwrap_or_default();
            let around = &around[..neighbours(D).min(around.len())];
            let nodes = (nodes, around);
            let loads = LoadTask { slot, common, rows, tractions, maps, nodes, reads_increment, tile_in };
            *power = task(kernels.shape(), loads);
        });
        self.loads.acting = acting;
        self.index.iter().map(|&(_, slot)| self.powers[slot as usize].to_double()).sum()
    }

    /// Store the power of the loads that act in a step, in the pass that updates velocities.
    pub(super) fn book_loads(&mut self, nodes: Nodes<'_, T>, which: Which, dt: Steps<T>, team: &Team) {
        // The acting traction is that of the last force.
        let (time, maps) = (self.mapped_at, self.kernels.maps(which));
        self.loading.power =
            self.each_load(nodes, maps, (time, dt), team, |shape, loads| shape.book_loads(loads));
    }

    /// Add the loads to the tiles, at the time at which the forces of a pass act.
    pub(super) fn map_loads(&mut self, which: Which, dt: Steps<T>, team: &Team) {
        let nodes = Nodes { all: &[], layout: &Layout::default() };
        let maps = self.kernels.maps(which);
        self.each_load(nodes, maps, (dt.force_time, dt), team, |shape, loads| {
            shape.map_loads(loads);
            T::default()
        });
    }

    /// Set the accelerations of the particles, m/s^2, by number and velocity, m/s, and add their forces to the tiles,
    /// whose second records contain nothing else.
    pub(in crate::step) fn map_given(
        &mut self,
        dt: Steps<T>,
        give: &(dyn Fn(usize, [T; 3]) -> [T; 3] + Sync),
        team: &Team,
    ) {
        let Some(row) = self.loads.rows(self.columns.load()).acceleration else { return };
        let first = Columns::velocity(D);
        let forces = self.facts().tile_nodes(D);
        team.each(&mut self.slots, |_, slot| {
            slot.tile.all_mut()[forces..].fill([T::default(); 4]);
            for bin in 0..block_nodes(D) {
                let mut next = slot.block.last_group(bin);
                while let Some((group, here)) = next {
                    next = slot.block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        let mut v = [T::default(); 3];
                        (0..D).for_each(|d| v[d] = slot.block.get(at, first + d));
                        let a = give(slot.block.number(at), v);
                        (0..D).for_each(|d| slot.block.set(at, row + d, a[d]));
                    }
                }
            }
        });
        let nodes = Nodes { all: &[], layout: &Layout::default() };
        let maps = Maps { momentum: true, force: true, ..Maps::NOTHING };
        self.each_load(nodes, maps, (dt.force_time, dt), team, |shape, loads| {
            shape.map_loads(loads);
            T::default()
        });
    }

    /// Interpolate the nodal velocities at the particles, m/s, by number.
    pub(in crate::step) fn carried(
        &mut self,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        out: &mut [[T; 3]],
        team: &Team,
    ) {
        let Some(row) = self.loads.rows(self.columns.load()).acceleration else { return };
        self.each_load(nodes, Maps::NOTHING, (dt.force_time, dt), team, |shape, loads| {
            shape.carry_velocity(loads);
            T::default()
        });
        for slot in &self.slots {
            for (_, at) in slot.block.places() {
                if let Some(v) = out.get_mut(slot.block.number(at)) {
                    (0..D).for_each(|d| v[d] = slot.block.get(at, row + d));
                }
            }
        }
    }
}
