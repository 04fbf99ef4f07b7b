//! Creation of the particles of a body: from seeds, or from a body of another scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use mpm_materials::Material;
use mpm_materials::material::{Deformation, Length, Motion, Response, StatesMut};

use super::body::GridBody;
use super::crossing::Crossers;
use super::deformable::{InitialState, Velocity};
use super::load::{Loading, Loads};
use super::particle_body::ParticleBody;
use crate::dim::BLOCK;
use crate::grid::Lattices;
use crate::grid::levels::pack;
use crate::particles::{Columns, Masses, split};
use crate::shape::Domain;
use crate::shape::domain::MOST_NUMBERS;
use crate::step::between_steps::merging::MergeBook;
use crate::step::between_steps::splitting::{SplitBook, Splitter, Splitting};
use crate::step::nodes::wrap::Wrap;
use crate::step::passes::kernels::MethodKernels;
use crate::step::passes::total;
use impactite_geometry::{Lattice, Seeds};
use impactite_scene::CentreLead;
use impactite_simd::Float;

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Create a body without particles, for particles of these half sizes, m.
    pub(in crate::step) fn empty(
        name: &str,
        material: Arc<dyn Material<T>>,
        kernels: Arc<dyn MethodKernels<T, D>>,
        lattice: Lattice<D>,
        half_size: &[f64; D],
        (loads, splitting): (Loads<D>, Option<Splitting>),
    ) -> Self {
        let facts = kernels.facts();
        let (carried, frame) = (facts.domain.numbers(D), total::rows(facts.total, facts.hoop, D));
        let columns = Columns::new(D, material.state_names(), carried, loads.numbers(), frame);
        let mut half = [T::of(0.5); 3];
        for d in 0..D {
            half[d] = T::of(half_size[d] / lattice.spacing());
        }
        // Values in a lane without a particle.
        let mut dummy = vec![T::default(); Columns::state(D)];
        dummy.extend_from_slice(&material.virgin());
        let domain = facts.domain.of_box::<T::Single, D>(half.map(T::Single::from));
        dummy.extend(domain[..carried].iter().map(|&x| -> T { x.into() }));
        dummy.resize(dummy.len() + loads.numbers(), T::default());
        dummy.extend(total::undeformed::<T>(facts.total, facts.hoop, D));
        dummy.resize(columns.count(), T::default());
        let masses = Masses::Each(columns.mass());
        let coheres = bears_shear_and_tension(&*material);
        ParticleBody {
            name: name.into(),
            coheres,
            material,
            kernels,
            lattice,
            lattices: Lattices::one(lattice),
            levels: None,
            crossers: Crossers::default(),
            numbered: [0; 2],
            columns,
            slots: Vec::new(),
            spare: Vec::new(),
            index: Vec::new(),
            wanted: Vec::new(),
            links: Vec::new(),
            sent: Vec::new(),
            outboxes: Vec::new(),
            outlines: Vec::new(),
            scratch: Vec::new(),
            nodes_around: Vec::new(),
            contributors: Vec::new(),
            half,
            lightest: T::of(f64::MAX),
            masses,
            loads,
            loaded_areas: Vec::new(),
            loading: Loading::default(),
            unloaded: None,
            mapped_at: 0.0,
            powers: Vec::new(),
            forces: Vec::new(),
            splitting,
            splitter: Splitter::default(),
            splits: SplitBook::default(),
            merges: MergeBook::default(),
            renewed: None,
            starts: Vec::new(),
            dummy: dummy.into(),
            wrap: Wrap::default(),
            resting: None,
            lead: CentreLead::default(),
        }
    }

    /// Create particles at `seeds`, with velocity (m/s) and, if not virgin, state as functions of position (m).
    pub(in crate::step) fn seed(
        &mut self,
        seeds: &Seeds<D>,
        velocity: &Velocity<'_, D>,
        state: Option<&InitialState<'_, T, D>>,
    ) {
        let density = self.material.density();
        self.numbered = [seeds.positions.len() as u64, 0];
        // Particles of several levels, and those that are divided, have different masses.
        if state.is_none() && self.splitting.is_none() && self.levels.is_none() {
            self.share_mass(seeds.volumes.iter().map(|&volume| density * T::of(volume)));
        }
        self.shorten_numbers(seeds.positions.len());
        let mut index = BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        if self.loads.field.is_some() {
            self.starts.extend_from_slice(&seeds.positions);
        }
        for (n, (&x, &volume)) in seeds.positions.iter().zip(&seeds.volumes).enumerate() {
            let v = velocity(x);
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(v[d]);
            }
            let mut mass = density * T::of(volume);
            if let Some(state) = state {
                let state = state(x);
                let said = self.material.describe_point(&state);
                numbers[Columns::state(D)..self.columns.domain()].copy_from_slice(&state);
                mass /= said.map_or(T::of(1.0), |said| said.volume_ratio);
            }
            let finest = self.levels.as_ref().map_or(1, |levels| levels.count()) as i32 - 1;
            let parts = self.splitting.map_or(1.0, Splitting::lightest) * 0.5f64.powi(D as i32 * finest);
            self.lightest = self.lightest.min(mass * T::of(parts));
            if let Masses::Each(row) = self.masses {
                numbers[row] = mass;
            }
            self.loaded_areas.resize(self.loads.tractions.len(), 0.0);
            let size = if self.levels.is_some() { self.relative_size(mass, 0, x[0]) } else { 1.0 };
            let half_size = seeds.half_size.map(|half| half * size);
            for (t, traction) in self.loads.tractions.iter().enumerate() {
                let area = traction.area(&x, &half_size);
                self.loaded_areas[t] += area;
                numbers[self.columns.load() + t] = T::of(area);
            }
            numbers[self.columns.number()] = T::of(n as f64);
            self.put(&mut index, &x, &mut numbers);
        }
        self.settle();
    }

    /// Store the mass once, if all particles to be created have the same.
    fn share_mass(&mut self, mut masses: impl Iterator<Item = T>) {
        let Some(first) = masses.next() else { return };
        if masses.all(|mass| mass == first) {
            let mut dummy = self.dummy.to_vec();
            dummy.remove(self.columns.mass());
            self.dummy = dummy.into();
            self.columns = self.columns.clone().without_mass();
            self.masses = Masses::Equal(first);
        }
    }

    /// Store the numbers of particles to be created, none above `bound`, in 32 bits if that is enough: splitting
    /// creates larger ones.
    fn shorten_numbers(&mut self, bound: usize) {
        if self.splitting.is_none() && self.levels.is_none() && u32::try_from(bound).is_ok() {
            self.columns = self.columns.clone().with_short_number();
        }
    }

    /// Add a particle with these values at `x`, m.
    pub(in crate::step) fn put(
        &mut self,
        index: &mut BTreeMap<[i32; D], usize>,
        x: &[f64; D],
        numbers: &mut [T],
    ) {
        let centre = self.bin_centre();
        let (mut block, mut bin, mut stride) = ([0; D], 0, 1);
        let level = self.levels.as_ref().map_or(0, |levels| levels.level_at(x, centre));
        let lattice = if level == 0 { self.lattice } else { self.lattices.of(level) };
        for d in 0..D {
            let u = (x[d] - lattice.origin()[d]) / lattice.spacing() - centre;
            let nearest = (u + 0.5).floor();
            let (b, place) = split(nearest as i32);
            block[d] = b;
            bin += place * stride;
            stride *= BLOCK;
            numbers[Columns::position() + d] = T::of(u - nearest);
        }
        let block = if level == 0 { self.wrap.block(block) } else { pack(level, block) };
        let slot = *index.entry(block).or_insert_with(|| {
            self.slots.push(self.empty_slot(block));
            self.slots.len() - 1
        });
        self.slots[slot].block.push(bin, numbers);
    }

    /// Pack, sort and link the slots once all particles are added.
    pub(in crate::step) fn settle(&mut self) {
        for slot in &mut self.slots {
            slot.block.pack();
        }
        self.slots.sort_by_key(|s| s.block.coordinates);
        self.link_slots();
    }

    /// Half edges of the domain of a particle with these values in the cells of a level, m; `radius` is its first coordinate, m.
    pub(in crate::step) fn half_edges(&self, numbers: &[T], (level, radius): (usize, f64)) -> [[f64; 3]; 3] {
        let mut h = self.lattice.spacing();
        if self.levels.is_some() {
            // Particles keep their size where the cells are larger.
            h *= 0.5f64.powi(level as i32) * self.relative_size(self.masses.of(numbers), level, radius);
        }
        let mut edges = [[0.0; 3]; 3];
        for d in 0..D {
            edges[d][d] = self.half[d].to_double() * h;
        }
        let facts = self.facts();
        if facts.total {
            let f = total::gradient::<T, D>(&numbers[self.columns.frame()..], facts.hoop);
            for (k, edge) in edges.iter_mut().enumerate().take(D) {
                let half = edge[k];
                for d in 0..D {
                    let x: T = f.0[d][k].into();
                    edge[d] = x.to_double() * half;
                }
            }
        } else if facts.domain.carried() {
            let (first, count) = self.columns.domains();
            let mut carried = [0.0; MOST_NUMBERS];
            for (x, number) in carried.iter_mut().zip(&numbers[first..first + count]) {
                *x = number.to_double() * h;
            }
            edges = facts.domain.half_edges::<f64, D>(&carried);
        }
        edges
    }

    /// Copy the particles of a body of this law from another scene.
    pub(in crate::step) fn adopt(&mut self, body: &dyn GridBody<T, D>) {
        let h = self.lattice.spacing();
        let (mut masses, mut last) = (Vec::with_capacity(body.len()), 0);
        body.for_each(&mut |p| {
            masses.push(T::of(p.mass));
            last = last.max(p.number);
        });
        if self.splitting.is_none() {
            self.share_mass(masses.into_iter());
        }
        self.shorten_numbers(last);
        let mut index = BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        let (state, domain) = (Columns::state(D), self.columns.domain());
        body.for_each(&mut |p| {
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(p.velocity[d]);
            }
            if let Masses::Each(row) = self.masses {
                numbers[row] = T::of(p.mass);
            }
            self.lightest = self.lightest.min(T::of(p.mass));
            for (number, x) in numbers[state..domain].iter_mut().zip(&p.state) {
                *number = T::of(*x);
            }
            let kind = self.facts().domain;
            let mut carried = kind.of_edges::<f64, D>(&p.half_edges.map(|e| e.map(|x| x / h)));
            if kind == Domain::Axes {
                // Limit the size to the range of the shape function.
                for x in &mut carried[..D] {
                    *x = self.kernels.shape().stretch(T::of(*x), T::default()).to_double();
                }
            }
            for (number, x) in numbers[domain..].iter_mut().zip(&carried[..kind.numbers(D)]) {
                *number = T::of(*x);
            }
            numbers[self.columns.number()] = T::of(p.number as f64);
            let x = std::array::from_fn(|d| p.position[d]);
            self.put(&mut index, &x, &mut numbers);
        });
        self.settle();
    }
}

/// True if a virgin point of the law resists a small uniaxial extension, with shear and with tension.
pub(in crate::step) fn bears_shear_and_tension<T: Float>(law: &dyn Material<T>) -> bool {
    let row = |x: T| {
        let mut row = T::Row::default();
        row.as_mut().fill(x);
        row
    };
    let strain = T::of(1e-6);
    let mut rows: Vec<T::Row> = law.virgin().into_iter().map(row).collect();
    let mut deformation = [Deformation::default()];
    deformation[0].gradient[0].0[0] = row(T::of(1.0));
    deformation[0].step.0[0] = row(strain);
    let motion = Motion { deformation: &deformation, dt: strain, length: Length::Same(T::of(1.0)) };
    let mut response = Response::default();
    let states = StatesMut { all: &mut rows, stride: law.numbers(), first: 0, groups: &[0] };
    law.advance(&motion, states, false, &mut response);
    let Some(output) = response.outputs().first() else { return false };
    let [along, across] = [0, 1].map(|n| output.stress[n].0[0].as_ref()[0].to_double());
    response.faults().is_empty() && along + 2.0 * across > 0.0 && along - across > 1e-3 * along.abs()
}
