//! Particles of a body as observers see them, and their totals.

use std::sync::{Mutex, PoisonError};

use super::particle_body::ParticleBody;
use crate::particles::{Block, Columns, Outbox, Place, Sent};
use crate::step::between_steps::deactivated::Deactivated;
use crate::step::passes::slot::{Outline, Scratch, Slot};
use impactite_scene::{Body, Bounds, Parts, PointView, Totals};
use impactite_simd::{Float, Team};
use mpm_materials::material::States;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    pub(in crate::step) fn particle(&self, block: &Block<T, D>, bin: usize, at: Place) -> PointView {
        let mut p = PointView::default();
        self.read_particle((block, bin, at), Parts::ALL, &self.lead.way(), &mut Vec::new(), &mut p);
        p
    }

    /// Read some parts of a particle into existing memory.
    fn read_particle(
        &self,
        (block, bin, at): (&Block<T, D>, usize, Place),
        parts: Parts,
        way: &[f64; 3],
        numbers: &mut Vec<T>,
        p: &mut PointView,
    ) {
        numbers.clear();
        block.read(at, numbers);
        let numbers = &*numbers;
        p.number = numbers[self.columns.number()].to_double() as usize;
        p.mass = self.masses.of(numbers).to_double();
        (p.position, p.velocity) = (self.position_of(block, bin, at, way), [0.0; 3]);
        if parts.size {
            p.half_edges = self.half_edges(numbers, (self.lattices.level(&block.coordinates), p.position[0]));
        }
        for d in 0..D {
            p.velocity[d] = numbers[Columns::velocity(D) + d].to_double();
        }
        let state = self.state_of(numbers);
        let unstrained = || p.mass / self.material.density().to_double();
        if !parts.law {
            if let Some(ratio) = self.material.volume_ratio_of(state).filter(|_| parts.size) {
                p.volume = unstrained() * ratio.to_double();
            }
            return;
        }
        p.state.clear();
        p.state.extend(state.iter().map(|x| x.to_double()));
        if let Some(said) = self.material.describe_point(state) {
            p.stress = said.stress.map(|x| x.to_double());
            p.in_range = said.in_range;
            p.failed = said.failed;
            p.volume = unstrained() * said.volume_ratio.to_double();
        }
    }

    /// Position of a particle, m; `way` is that of the lead.
    #[inline]
    fn position_of(&self, block: &Block<T, D>, bin: usize, at: Place, way: &[f64; 3]) -> [f64; 3] {
        self.positions(block, way)(bin, at)
    }

    /// Positions of the particles of a block, m, by bin and place; `way` is that of the lead.
    #[inline]
    fn positions<'a>(
        &'a self,
        block: &'a Block<T, D>,
        way: &'a [f64; 3],
    ) -> impl FnMut(usize, Place) -> [f64; 3] + 'a {
        let (centre, total) = (self.bin_centre(), self.facts().total);
        let (mut known, mut lattice, mut coordinates) = (usize::MAX, self.lattice, [0; D]);
        move |bin, at| {
            if bin != known {
                known = bin;
                (lattice, coordinates) = self.lattices.of_node(&block.bin_coordinates(bin));
            }
            let mut position = [0.0; 3];
            for d in 0..D {
                let mut cells =
                    f64::from(coordinates[d]) + centre + block.get(at, Columns::position() + d).to_double();
                if total {
                    cells += block.get(at, self.columns.frame() + d).to_double();
                }
                position[d] = lattice.origin()[d] + lattice.spacing() * cells - way[d];
            }
            position
        }
    }

    /// State variables of the law among the values of a particle.
    pub(in crate::step) fn state_of<'a>(&self, numbers: &'a [T]) -> &'a [T] {
        &numbers[Columns::state(D)..self.columns.domain()]
    }

    /// Mass of a particle, kg.
    pub(in crate::step) fn mass_at(&self, block: &Block<T, D>, at: Place) -> T {
        self.masses.read(|row| block.get(at, row))
    }

    /// All values of a particle.
    pub(in crate::step) fn numbers(&self, block: &Block<T, D>, at: Place) -> Vec<T> {
        let mut numbers = Vec::with_capacity(self.columns.count());
        block.read(at, &mut numbers);
        numbers
    }

    /// States of groups of a block.
    fn states_of<'a>(&self, block: &'a Block<T, D>, groups: &'a [u32]) -> States<'a, T> {
        let (all, stride) = block.all_rows();
        States { all, stride, first: Columns::state(D), groups }
    }

    pub(super) fn totals_of(&self, slot: &Slot<T, D>) -> Totals {
        let mut part = Totals::default();
        let (way, density) = (self.lead.way(), self.material.density());
        let groups = groups_of(&slot.block);
        let (mut energies, mut heats) =
            (vec![T::Row::default(); groups.len()], vec![T::Row::default(); groups.len()]);
        self.material.energies(self.states_of(&slot.block, &groups), &mut energies, &mut heats);
        let (mut place, mut position) = (InGroups::default(), self.positions(&slot.block, &way));
        for (bin, at) in slot.block.places() {
            let number = |column: usize| slot.block.get(at, column);
            let (group, lane) = place.next(&groups, at);
            let x = position(bin, at);
            let mut v = [0.0; 3];
            for d in 0..D {
                v[d] = number(Columns::velocity(D) + d).to_double();
            }
            let mass = self.masses.read(number);
            let [energy, heat] = [&energies, &heats].map(|rows| rows[group].as_ref()[lane]);
            part.internal += (energy * (mass / density)).to_double();
            part.viscous_heat += (heat * (mass / density)).to_double();
            let mass = mass.to_double();
            part.particles += 1;
            part.mass += mass;
            let moment = [x[1] * v[2] - x[2] * v[1], x[2] * v[0] - x[0] * v[2], x[0] * v[1] - x[1] * v[0]];
            for d in 0..3 {
                part.momentum[d] += mass * v[d];
                part.angular_momentum[d] += mass * moment[d];
            }
            let square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
            part.momentum_scale += mass * square.sqrt();
            part.kinetic += 0.5 * mass * square;
        }
        part
    }
}

impl<T: Float, const D: usize> Body for ParticleBody<T, D> {
    fn name(&self) -> &str {
        &self.name
    }
    fn law(&self) -> &'static str {
        self.material.name()
    }
    fn is_plane_stress(&self) -> bool {
        self.material.is_plane_stress()
    }
    fn len(&self) -> usize {
        self.slots.iter().map(|s| s.block.len()).sum()
    }
    fn softens_from(&self, rate: f64) -> Option<f64> {
        mpm_materials::softening::softens_from(&*self.material, rate)
    }
    fn chosen_sound_speed(&self) -> Option<f64> {
        mpm_materials::chosen_sound_speed(&*self.material)
    }
    fn state_names(&self) -> Vec<String> {
        self.columns.state_names().to_vec()
    }
    fn totals(&self) -> Totals {
        let parts = self.in_place().map(|slot| self.totals_of(slot));
        parts.fold(Totals::default(), |sum, part| sum.plus(&part))
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        let (mut numbers, mut p, way) = (Vec::new(), PointView::default(), self.lead.way());
        for slot in self.in_place() {
            for (bin, at) in slot.block.places() {
                self.read_particle((&slot.block, bin, at), parts, &way, &mut numbers, &mut p);
                visit(&p);
            }
        }
    }
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        let mut parts = vec![Bounds::default(); self.index.len()];
        let way = self.lead.way();
        Team::ambient().each(&mut parts, |n, held| {
            let mut p = PointView::default();
            let block = &self.slots[self.index[n].1 as usize].block;
            let groups = groups_of(block);
            let mut ratios = vec![T::Row::default(); groups.len()];
            self.material.volume_ratios(self.states_of(block, &groups), &mut ratios);
            let (mut place, mut position) = (InGroups::default(), self.positions(block, &way));
            for (bin, at) in block.places() {
                p.position = position(bin, at);
                let (group, lane) = place.next(&groups, at);
                let mass = self.mass_at(block, at).to_double();
                let ratio = ratios[group].as_ref()[lane].to_double();
                p.volume = mass / self.material.density().to_double() * ratio;
                held.hold(&p, dimensions, axisymmetric);
            }
        });
        let mut all = Bounds::default();
        parts.iter().for_each(|part| all.join(part));
        all.corners()
    }
    fn bytes(&self) -> usize {
        let slot = |s: &Slot<T, D>| {
            s.block.bytes()
                + s.tile.bytes()
                + s.slots_around.len() * size_of::<u32>()
                + s.affine.capacity() * size_of::<[T; 4]>()
                + size_of::<Slot<T, D>>()
        };
        let own = |s: &Mutex<Scratch<T>>| s.lock().unwrap_or_else(PoisonError::into_inner).bytes();
        self.slots.iter().chain(&self.spare).map(slot).sum::<usize>()
            + self.index.capacity() * size_of::<([i32; D], u32)>()
            + self.wanted.capacity() * size_of::<[i32; D]>()
            + self.links.capacity() * size_of::<(u32, u32, u8)>()
            + self.sent.capacity() * size_of::<Sent>()
            + self.outboxes.iter().map(Outbox::bytes).sum::<usize>()
            + self.scratch.iter().map(own).sum::<usize>()
            + self.outlines.capacity() * size_of::<Outline>()
            + self.starts.capacity() * size_of::<[f64; D]>()
            + self.powers.capacity() * size_of::<T>()
            + self.forces.capacity() * size_of::<[f64; 3]>()
            + (self.contributors.capacity() + self.nodes_around.capacity()) * size_of::<u32>()
            + self.resting.as_ref().map_or(0, Deactivated::bytes)
    }
}

/// Groups of the particles of a block, in the order of [`Block::places`].
fn groups_of<T: Float, const D: usize>(block: &Block<T, D>) -> Vec<u32> {
    let mut groups = Vec::with_capacity(block.len().div_ceil(T::GROUP) + 1);
    for (_, at) in block.places() {
        if groups.last() != Some(&at.group) {
            groups.push(at.group);
        }
    }
    groups
}

/// Position in the list of the groups of a block, as its places are visited.
#[derive(Default)]
struct InGroups(usize);

impl InGroups {
    /// Return the index of the group of the next place, and its lane.
    fn next(&mut self, groups: &[u32], at: Place) -> (usize, usize) {
        self.0 += usize::from(groups[self.0] != at.group);
        (self.0, at.lane as usize)
    }
}
