//! Conversion of matter of other discretisations to particles between steps.

use super::new_particles::{Matter, NewParticles, Occupied, Surroundings};
use crate::dim::{BLOCK, neighbours};
use crate::grid::OutsideGrid;
use crate::particles::Columns;
use crate::step::bodies::body::{BodyTrouble, GridBody, Receives, Steps, Which};
use crate::step::bodies::load::{Given, Loads};
use crate::step::bodies::particle_body::{NONE, ParticleBody};
use crate::step::mpm::Mpm;
use crate::step::nodes::layout::{Layout, Nodes};
use crate::step::passes::kernels::Facts;
use crate::step::passes::spread::Maps;
use impactite_scene::error::{SceneError, StepError, Stopped};
use impactite_scene::{Body, PointKind, TimeControl};
use impactite_simd::{Float, Team};

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Create an empty body for particles from converted matter.
    pub(in crate::step) fn to_come(
        name: &str,
        matter: &Matter<T, D>,
        beside: &Mpm<D, T>,
    ) -> Result<Self, SceneError> {
        let (kernels, lattice) = (beside.kernels.clone(), *beside.grid.lattice());
        let none = (Loads::default(), None);
        let mut body =
            ParticleBody::empty(name, matter.law.clone(), kernels, lattice, &matter.half_size, none);
        body.wrap = beside.wrap()?;
        body.lightest = T::of(matter.lightest);
        body.settle();
        Ok(body)
    }

    /// Add these particles, with numbers from `first` on.
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

    /// Move the particles of a body of the same kind into this one, without the loads that they carry, and add their
    /// map if `mapped`.
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

    /// Add the momentum due to the velocity gradient that the particles carry.
    fn map_gradients(&mut self, steps: Steps<T>, team: &Team) {
        let nodes = Nodes { all: &[], layout: &Layout::default() };
        let maps = Maps { momentum: true, force: true, ..Maps::NOTHING };
        self.each_load(nodes, maps, (steps.force_time, steps), team, |shape, loads| {
            shape.map_loads(loads);
            T::default()
        });
    }
}

impl<T: Float, const D: usize> Receives<T, D> for ParticleBody<T, D> {
    fn receive(
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
}

/// Number of nodes of a tile along an axis.
fn tile_width(facts: &Facts) -> usize {
    BLOCK + facts.nodes - 1
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Convert matter of the clients to particles where due, and arrange node blocks again if anything changed.
    pub(in crate::step) fn convert_clients(&mut self) -> Result<(), StepError> {
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

    /// Convert matter of one client to particles of the body `into`. Return true if node blocks must be arranged again.
    pub(in crate::step) fn convert_client(&mut self, client: usize, into: usize) -> Result<bool, Stopped> {
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
        let steps = Steps { this: T::default(), next, adapt, force_time, force: [0.0; 3] };
        let map = self.stepper.mapped.then_some(steps);
        let team = self.team.clone();
        let Some(body) = self.scene.bodies[into].receiver() else { return Ok(changed) };
        let received = body.receive(&new, map, &team);
        let rate = received.map_err(|trouble| self.stopped_particle(into, trouble))?;
        if rate > self.stepper.rate {
            (self.stepper.rate, self.stepper.fastest) = (rate, into);
            // The planned step does not account for them and may be too long.
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

    /// Space occupied by bodies other than a client and its host, and by other clients within the host.
    fn surroundings(&self, but: [usize; 2]) -> Surroundings<D> {
        let nowhere = Occupied::new(*self.grid.lattice(), crate::dim::centre(self.facts().nodes));
        let mut around = Surroundings { others: nowhere.clone(), within: nowhere };
        for (n, body) in self.scene.bodies.iter().enumerate().filter(|(n, _)| !but.contains(n)) {
            let same = self.grid.fields.owner_of(n as u32) as usize == but[1];
            let where_it_is = if same { &mut around.within } else { &mut around.others };
            match body.client() {
                Some(client) => client.each_box(&mut |low, high| where_it_is.add_box(low, high)),
                None => {
                    body.presence().each_block(&mut |block, bins| where_it_is.blocks.push((*block, bins)));
                }
            }
        }
        around.others.settle();
        around.within.settle();
        around
    }
}
