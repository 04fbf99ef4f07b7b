//! Footprints of particles.

use super::*;
use crate::dim::offset_of;

use crate::particles::{Block, Columns, Place};
use crate::shape::domain::MOST_NUMBERS;
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::mpm::Mpm;
use crate::step::passes::total;
use impactite_simd::Float;

use mpm_materials::Sym3;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Visit every particle, with loads at `time`, s. Nodes are those of the whole lattice.
    pub(in crate::step) fn show_footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        let mut nodes = Vec::new();
        for slot in &self.slots {
            for (bin, at) in slot.block.places() {
                self.node_weights(&slot.block, bin, at, &mut nodes);
                if let Some(footprint) = self.footprint(&slot.block, bin, at, time, &nodes) {
                    visit(&footprint);
                }
            }
        }
    }

    /// Return the domain of a particle; `number` reads its value in a row.
    fn domain_of(&self, number: impl Fn(usize) -> T) -> [T; MOST_NUMBERS] {
        let (first, count) = self.columns.domains();
        let mut domain = [T::of(0.5); MOST_NUMBERS];
        domain[..D].copy_from_slice(&self.half[..D]);
        for n in 0..count {
            domain[n] = number(first + n);
        }
        domain
    }

    /// Compute the weights of a particle on its nodes: products of axis weights, unless its domain is convected.
    pub(in crate::step) fn node_weights(
        &self,
        block: &Block<T, D>,
        bin: usize,
        at: Place,
        list: &mut Vec<NodeWeight<D>>,
    ) {
        let (shape, facts) = (self.kernels.shape(), self.facts());
        let (n, coordinates, centre) = (facts.nodes, block.bin_coordinates(bin), self.bin_centre());
        let per_spacing = 1.0 / self.lattices.of_block(&block.coordinates).0.spacing();
        list.clear();
        let domain = self.domain_of(|row| block.get(at, row));
        if facts.domain.convects() {
            let mut xi = [T::default(); 3];
            for d in 0..D {
                xi[d] = block.get(at, Columns::position() + d);
            }
            shape.table(&xi, &domain, &mut |s, value, slope| {
                let place = [s % n, s / n % n, s / (n * n)];
                let node = std::array::from_fn(|d| {
                    let offset = offset_of(n, place[d]);
                    (f64::from(coordinates[d]) + centre + offset).round() as i32
                });
                let gradient = std::array::from_fn(|d| slope[d].to_double() * per_spacing);
                list.push(NodeWeight { node, value: value.to_double(), gradient, sign: [1.0; 3] });
            });
            return;
        }
        list.push(NodeWeight { node: [0; D], value: 1.0, gradient: [1.0; D], sign: [1.0; 3] });
        for d in 0..D {
            let xi = block.get(at, Columns::position() + d);
            let [values, slopes] = shape.weights(xi, domain[d]);
            let inertia = shape.inertia(xi, domain[d]);
            // In reverse order, so that no entry is overwritten before it is used.
            let before = list.len();
            list.resize(before * n, list[0]);
            for from in (0..before).rev() {
                let w = list[from];
                for a in 0..n {
                    let offset = offset_of(n, a);
                    let (value, mut slope) = (values[a].to_double(), slopes[a].to_double());
                    if facts.least_squares {
                        slope = value * (offset - xi.to_double()) / inertia.to_double();
                    }
                    let next = &mut list[from * n + a];
                    *next = w;
                    next.node[d] = (f64::from(coordinates[d]) + centre + offset).round() as i32;
                    next.value *= value;
                    for e in 0..D {
                        next.gradient[e] *= if e == d { slope * per_spacing } else { value };
                    }
                }
            }
        }
    }

    fn footprint<'a>(
        &self,
        block: &Block<T, D>,
        bin: usize,
        at: Place,
        time: f64,
        nodes: &'a [NodeWeight<D>],
    ) -> Option<Footprint<'a, D>> {
        let (numbers, facts) = (self.numbers(block, at), self.facts());
        let said = self.material.describe_point(self.state_of(&numbers))?;
        let mass = self.masses.of(&numbers).to_double();
        let volume = mass / self.material.density().to_double() * said.volume_ratio.to_double();
        let cauchy = Sym3(said.stress.map(T::Single::from));
        let (mut carried, mut speed) = (cauchy.to_mat(), said.wave_speed);
        if facts.total {
            let f = total::gradient::<T, D>(&numbers[self.columns.frame()..], facts.hoop);
            let inverse = total::inverse::<T::Single, D>(&f);
            carried = total::nominal::<T::Single, D>(&cauchy, &inverse);
            let stretch: T = total::stretch(&inverse).into();
            speed *= stretch;
        }
        let mut stress = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let s: T = carried.0[i][j].into();
                stress[i][j] = volume * s.to_double();
            }
        }
        let (lattice, bins) = (self.lattices.of_block(&block.coordinates).0, block.bin_coordinates(bin));
        let position: [f64; D] = std::array::from_fn(|d| {
            let xi = numbers[Columns::position() + d].to_double();
            lattice.origin()[d] + lattice.spacing() * (f64::from(bins[d]) + self.bin_centre() + xi)
        });
        let mut hoop = [0.0; 3];
        if facts.hoop {
            hoop[0] = -stress[2][2] / position[0];
        }
        let volume = if facts.total { mass / self.material.density().to_double() } else { volume };
        let (mut velocity, mut load) = ([0.0; 3], [0.0; 3]);
        let areas = self.loads.rows(self.columns.load()).areas[0]..;
        let number = numbers[self.columns.number()].to_double() as usize;
        for d in 0..D {
            velocity[d] = numbers[Columns::velocity(D) + d].to_double();
        }
        for (row, traction) in areas.zip(self.loads.tractions(time)) {
            (0..D).for_each(|d| load[d] += numbers[row].to_double() * traction[d]);
        }
        if let Some(field) = &self.loads.field {
            let acceleration = (field.acceleration)(&self.starts[number % self.starts.len()], time);
            (0..D).for_each(|d| load[d] += mass * acceleration[d]);
        }
        let wave_speed = speed.to_double();
        // The scene numbers its bodies.
        let (body, rigid) = (0, false);
        Some(Footprint {
            body,
            number,
            mass,
            volume,
            position,
            velocity,
            wave_speed,
            stress,
            hoop,
            load,
            rigid,
            nodes,
        })
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Visit every particle with its nodes; nodes behind symmetry planes and edges are replaced by those that represent
    /// them. Loads are current. Computed particle by particle, for diagnostics: about ten times the cost of a step.
    pub fn for_each_footprint(&self, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        self.work.for_each_footprint(self, visit)
    }

    pub(in crate::step) fn for_each_footprint_here(&self, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        let modified = self.facts().boundary_modified;
        let folds = Folds::of(&self.scene.conditions.boundaries, &self.grid.fields, modified);
        let mut folded = Vec::new();
        for (body, of) in self.scene.bodies.iter().enumerate() {
            of.footprints(self.clock.time, &mut |footprint| {
                folds.fold(footprint.nodes, &mut folded);
                visit(&Footprint { body, nodes: &folded, ..*footprint });
            });
        }
    }
}
