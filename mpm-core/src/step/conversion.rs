//! Matter of bodies of another discretisation that becomes particles between steps.

use std::sync::Arc;

use mpm_materials::Material;

use super::body::{BodyTrouble, GridBody, Steps, Which};
use super::kernels::Facts;
use super::layout::{Layout, Nodes};
use super::load::{Given, Loads};
use super::mpm::Mpm;
use super::particle_body::{NONE, ParticleBody};
use super::spread::Maps;
use crate::dim::{BLOCK, neighbours};
use crate::geometry::Lattice;
use crate::grid::OutsideGrid;
use crate::parallel::{Float, Team};
use crate::particles::{Columns, split};
use impactite_scene::error::{SceneError, StepError, Stopped};
use impactite_scene::{Body, PointKind, TimeControl};

/// What the matter of a [`GridClient`](super::GridClient) is that may become particles.
#[derive(Clone)]
pub struct Matter<T: Float, const D: usize> {
    /// Its law.
    pub law: Arc<dyn Material<T>>,
    /// Half sizes of the particles to come, m, of shape functions whose domains do not follow the strain; at most half a cell.
    pub half_size: [f64; D],
    /// The least mass of one, kg.
    pub lightest: f64,
}

/// A particle that comes into a body between steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewParticle<const D: usize> {
    /// Position, m.
    pub position: [f64; D],
    /// Velocity, m/s.
    pub velocity: [f64; D],
    /// dv_c/dx_d around it, 1/s: affine transfers map it once, as they do that of particles that the nodes moved.
    pub gradient: [[f64; D]; D],
    /// Mass, kg.
    pub mass: f64,
    /// Half edges of its domain, m.
    pub half_edges: [[f64; 3]; 3],
}

/// Particles that come into a body between steps, with the numbers of their states.
#[derive(Clone, Debug, Default)]
pub struct NewParticles<T, const D: usize> {
    particles: Vec<NewParticle<D>>,
    states: Vec<T>,
}

impl<T: Copy, const D: usize> NewParticles<T, D> {
    /// One more, with the numbers of its state.
    pub fn push(&mut self, particle: NewParticle<D>, state: &[T]) {
        self.particles.push(particle);
        self.states.extend_from_slice(state);
    }
    /// How many there are.
    pub fn len(&self) -> usize {
        self.particles.len()
    }
    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }
}

/// Where matter of other bodies is: bins of the size of a cell, in blocks of 4^D.
#[derive(Clone, Debug)]
pub struct Surroundings<const D: usize> {
    lattice: Lattice<D>,
    /// Where the centres of bins lie between nodes, in cells.
    centre: f64,
    /// Blocks with a bit for each bin, sorted.
    blocks: Vec<([i32; D], u64)>,
    /// Around them all, in bins; none if there are none.
    bounds: Option<[[i32; D]; 2]>,
}

impl<const D: usize> Surroundings<D> {
    fn new(lattice: Lattice<D>, centre: f64) -> Self {
        Surroundings { lattice, centre, blocks: Vec::new(), bounds: None }
    }

    fn bin(&self, x: f64, d: usize) -> i32 {
        let cells = (x - self.lattice.origin()[d]) / self.lattice.spacing() - self.centre + 0.5;
        cells.floor().clamp(-1e9, 1e9) as i32
    }

    fn add_box(&mut self, low: &[f64; D], high: &[f64; D]) {
        let first: [i32; D] = std::array::from_fn(|d| self.bin(low[d], d));
        let last: [i32; D] = std::array::from_fn(|d| self.bin(high[d], d));
        let mut at = first;
        loop {
            let (mut block, mut bin, mut stride) = ([0; D], 0, 1);
            for d in 0..D {
                let (b, place) = split(at[d]);
                block[d] = b;
                bin += place * stride;
                stride *= BLOCK;
            }
            self.blocks.push((block, 1 << bin));
            let Some(d) = (0..D).find(|&d| at[d] < last[d]) else { break };
            at[d] += 1;
            at[..d].copy_from_slice(&first[..d]);
        }
    }

    /// All are there.
    fn settle(&mut self) {
        self.blocks.sort_unstable();
        self.blocks.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            kept.1 |= if same { next.1 } else { 0 };
            same
        });
        self.bounds = None;
        for (block, _) in &self.blocks {
            let low: [i32; D] = block.map(|b| b * BLOCK as i32);
            let high: [i32; D] = low.map(|b| b + BLOCK as i32 - 1);
            let [below, above] = self.bounds.get_or_insert([low, high]);
            for d in 0..D {
                (below[d], above[d]) = (below[d].min(low[d]), above[d].max(high[d]));
            }
        }
    }

    /// Is there nothing?
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Edge of a bin, m.
    pub fn spacing(&self) -> f64 {
        self.lattice.spacing()
    }

    /// Is matter of others in a bin that this box (lower and upper corner, m) touches?
    pub fn touches(&self, low: &[f64; D], high: &[f64; D]) -> bool {
        let Some([below, above]) = self.bounds else { return false };
        let first: [i32; D] = std::array::from_fn(|d| self.bin(low[d], d).max(below[d]));
        let last: [i32; D] = std::array::from_fn(|d| self.bin(high[d], d).min(above[d]));
        if (0..D).any(|d| first[d] > last[d]) {
            return false;
        }
        let blocks: [[i32; D]; 2] = [first, last].map(|at| at.map(|x| split(x).0));
        let mut at = blocks[0];
        loop {
            let found = self.blocks.binary_search_by_key(&at, |b| b.0);
            if found.is_ok_and(|found| self.blocks[found].1 & within(&at, &first, &last) != 0) {
                return true;
            }
            let Some(d) = (0..D).find(|&d| at[d] < blocks[1][d]) else { return false };
            at[d] += 1;
            at[..d].copy_from_slice(&blocks[0][..d]);
        }
    }
}

/// The bins of a block between two others, a bit each.
fn within<const D: usize>(block: &[i32; D], first: &[i32; D], last: &[i32; D]) -> u64 {
    let side = BLOCK as i32;
    let mut range = [[0, 1]; 3];
    for d in 0..D {
        range[d] = [(first[d] - block[d] * side).max(0), (last[d] + 1 - block[d] * side).min(side)];
    }
    let row = (1u64 << range[0][1]) - (1 << range[0][0]);
    let mut bins = 0;
    for z in range[2][0]..range[2][1] {
        for y in range[1][0]..range[1][1] {
            bins |= row << ((z * side + y) * side);
        }
    }
    bins
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// An empty body of matter that is to come.
    pub(super) fn to_come(name: &str, matter: &Matter<T, D>, beside: &Mpm<D, T>) -> Result<Self, SceneError> {
        let (kernels, lattice) = (beside.kernels.clone(), *beside.grid.lattice());
        let none = (Loads::default(), None);
        let mut body =
            ParticleBody::empty(name, matter.law.clone(), kernels, lattice, &matter.half_size, none);
        body.wrap = beside.wrap()?;
        body.lightest = T::of(matter.lightest);
        body.settle();
        Ok(body)
    }

    /// Take particles in. Where the others have mapped what a step begins with, `map` says for which steps, and these map it too. Returns
    /// the largest (c + |v|) / h of them, 1/s.
    pub(super) fn receive(
        &mut self,
        new: &NewParticles<T, D>,
        map: Option<Steps<T>>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        let affine = self.facts().affine && map.is_some();
        let given = if affine { Given::Affine } else { Given::Nothing };
        let loads = (Loads { given, ..Loads::default() }, None);
        let (law, kernels) = (self.material.clone(), self.kernels.clone());
        let mut fresh = ParticleBody::empty(&self.name, law, kernels, self.lattice, &self.half_size(), loads);
        fresh.wrap = self.wrap;
        fresh.fill(new, self.len());
        let spacing = self.lattice.spacing();
        let mut rate = fresh.rate(spacing);
        if let Some(steps) = map {
            fresh.nodes_around = vec![NONE; fresh.slots.len() * neighbours(D)];
            let nodes = Nodes { all: &[], layout: &Layout::default() };
            rate = rate.max(fresh.sweep(Which::Map, nodes, steps, team)?);
            if affine {
                fresh.map_gradients(steps, team);
            }
        }
        self.absorb(fresh, map.is_some());
        Ok(rate)
    }

    /// Put these particles in, with numbers from `first` on.
    fn fill(&mut self, new: &NewParticles<T, D>, first: usize) {
        let (h, domain) = (self.lattice.spacing(), self.facts().domain);
        let count = self.material.numbers();
        let affine = self.loads.rows(self.columns.load()).affine;
        let mut numbers = self.dummy.to_vec();
        let mut index = std::collections::BTreeMap::new();
        for (n, (particle, state)) in new.particles.iter().zip(new.states.chunks(count)).enumerate() {
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(particle.velocity[d]);
            }
            numbers[Columns::state(D)..self.columns.domain()].copy_from_slice(state);
            if domain.carried() {
                let edges = particle.half_edges.map(|e| e.map(|x| x / h));
                let carried = domain.of_edges::<f64, D>(&edges);
                for (k, x) in carried[..domain.numbers(D)].iter().enumerate() {
                    numbers[self.columns.domain() + k] = T::of(*x);
                }
            }
            if let Some(row) = affine {
                for c in 0..D {
                    for d in 0..D {
                        numbers[row + D * c + d] = T::of(particle.gradient[c][d] * h);
                    }
                }
            }
            numbers[self.columns.mass()] = T::of(particle.mass);
            numbers[self.columns.number()] = T::of((first + n) as f64);
            self.put(&mut index, &particle.position, &mut numbers);
        }
        self.settle();
    }

    /// Take over the particles of a body like this one that carry loads, and what they mapped.
    fn absorb(&mut self, fresh: Self, mapped: bool) {
        let known = |at: &[i32; D], index: &[([i32; D], u32)]| index.binary_search_by_key(at, |e| e.0).ok();
        let coordinates = fresh.slots.iter().map(|slot| slot.block.coordinates);
        let mut wanted: Vec<_> = coordinates.filter(|at| known(at, &self.index).is_none()).collect();
        if self.make_slots(&mut wanted) {
            self.link_slots();
        }
        let width = tile_width(self.facts());
        let (records, nodes) = (self.facts().records(), self.facts().tile_nodes(D));
        let (load, frame) = (fresh.columns.load(), fresh.columns.frame());
        let mut numbers = Vec::new();
        for from in &fresh.slots {
            let Some(at) = known(&from.block.coordinates, &self.index) else { continue };
            let to = &mut self.slots[self.index[at].1 as usize];
            for row in (0..nodes / width).filter(|row| mapped && from.rows >> row & 1 == 1) {
                for record in 0..records {
                    let place = record * nodes + row * width;
                    let there = &mut to.tile.all_mut()[place..place + width];
                    if to.rows >> row & 1 == 0 {
                        there.fill([T::default(); 4]);
                    }
                    for (sum, add) in there.iter_mut().zip(&from.tile.all()[place..]) {
                        (0..4).for_each(|d| sum[d] += add[d]);
                    }
                }
            }
            to.rows |= if mapped { from.rows } else { 0 };
            for (bin, place) in from.block.places() {
                numbers.clear();
                from.block.read(place, &mut numbers);
                numbers.drain(load..frame);
                to.block.push(bin, &numbers);
            }
            to.block.tidy();
        }
    }

    /// Add the momentum that the particles have by the gradient that they carry.
    fn map_gradients(&mut self, steps: Steps<T>, team: &Team) {
        let nodes = Nodes { all: &[], layout: &Layout::default() };
        let maps = Maps { momentum: true, force: true, ..Maps::NOTHING };
        self.each_load(nodes, maps, (steps.force_time, steps), team, |shape, loads| {
            shape.map_loads(loads);
            T::default()
        });
    }
}

/// Nodes of a tile along an axis.
fn tile_width(facts: &Facts) -> usize {
    BLOCK + facts.nodes - 1
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Have matter of the clients become particles that is to. Must node blocks be arranged anew?
    pub(super) fn convert_clients(&mut self) -> Result<(), StepError> {
        let mut any = false;
        for n in 0..self.scene.growing.len() {
            let (client, body) = self.scene.growing[n];
            any |= self.convert_client(client, body).map_err(|what| self.stopped(what))?;
        }
        if any {
            self.arrange().map_err(|outside: OutsideGrid| self.stopped(self.who_left(outside)))?;
        }
        Ok(())
    }

    /// The same of one client, into this body.
    pub(super) fn convert_client(&mut self, client: usize, into: usize) -> Result<bool, Stopped> {
        let around = self.surroundings([client, into]);
        let mut new = NewParticles { particles: Vec::new(), states: Vec::new() };
        let Some(steps) = self.scene.bodies[client].client_mut() else { return Ok(false) };
        let changed = steps.convert(&around, &mut new, &self.team)?;
        if new.is_empty() {
            return Ok(changed);
        }
        let adapt = matches!(self.stepper.control, TimeControl::Courant { .. });
        let next = self.stepper.planned;
        let force_time = self.clock.time + next.to_double();
        let steps = Steps { this: T::default(), next, adapt, force_time };
        let map = self.stepper.mapped.then_some(steps);
        let team = self.team.clone();
        let Some(body) = self.scene.bodies[into].receiver() else { return Ok(changed) };
        let received = body.receive(&new, map, &team);
        let rate = received.map_err(|trouble| self.stopped_particle(into, trouble))?;
        if rate > self.stepper.rate {
            (self.stepper.rate, self.stepper.fastest) = (rate, into);
            // A step that was planned without them may be too long.
            if self.facts().maps_together && self.stepper.mapped {
                let allowed = self.stepper.control.next(rate.to_double(), self.clock.last);
                self.stepper.mapped = self.stepper.planned.to_double() <= allowed;
            }
        }
        Ok(true)
    }

    fn stopped_particle(&self, body: usize, trouble: BodyTrouble) -> Stopped {
        let BodyTrouble { particle, position, cause } = trouble;
        let (body, law) = (self.scene.bodies[body].name().to_string(), self.scene.bodies[body].law());
        Stopped::Point { kind: PointKind::Particle, body, number: particle, position, law, cause }
    }

    /// Where bodies other than these are.
    fn surroundings(&self, but: [usize; 2]) -> Surroundings<D> {
        let centre = crate::dim::centre(self.facts().nodes);
        let mut around = Surroundings::new(*self.grid.lattice(), centre);
        for (n, body) in self.scene.bodies.iter().enumerate().filter(|(n, _)| !but.contains(n)) {
            // Elements within the same body are no others.
            if self.grid.fields.owner_of(n as u32) as usize == but[1] {
                continue;
            }
            match body.client() {
                Some(client) => client.each_surface_box(&mut |low, high| around.add_box(low, high)),
                None => {
                    body.presence().each_block(&mut |block, bins| around.blocks.push((*block, bins)));
                }
            }
        }
        around.settle();
        around
    }
}
