//! Bodies of another discretisation in a scene, with the proxies of their points on the grid.

use std::sync::Arc;

use super::client::{ClientPoint, GridClient, SurfaceClient};
use super::new_particles::{NewParticles, Surroundings};
use crate::dim::block_nodes;
use crate::particles::{Columns, Place};
use crate::step::bodies::body::{BodyTrouble, GridBody, Presence, Steps, Which};
use crate::step::bodies::capability::ClientSteps;
use crate::step::bodies::load::{Given, Loading, Loads};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::nodes::footprint::Footprint;
use crate::step::nodes::layout::Nodes;
use crate::step::passes::kernels::MethodKernels;
use crate::step::rigid::proxies::Undeformed;
use impactite_geometry::Lattice;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, BoundaryEntry, Exchange, Parts, PointKind, PointView, Stopped, Totals};
use impactite_simd::{Float, Team};

/// A [`GridClient`] in a scene.
pub(in crate::step) struct ClientBody<T: Float, const D: usize> {
    client: Box<dyn GridClient<T, D>>,
    proxy: ParticleBody<T, D>,
    /// Velocities of the points, then their changes by the nodes of the scene, m/s, by number.
    velocities: Vec<[T; 3]>,
    /// Points on the grid, by number.
    points: Vec<ClientPoint>,
    /// Velocities at which matter carries the points of an embedded body, m/s, by number; empty for other bodies.
    carried: Vec<[T; 3]>,
    within: bool,
    /// Least mass of a particle that the matter may convert to, kg.
    to_come: Option<T>,
    /// Kernels of the method of the scene.
    method: Arc<dyn MethodKernels<T, D>>,
    rate: T,
    /// Pass of the scene in which particles gather the nodal velocities.
    returns: Which,
}

impl<T: Float, const D: usize> ClientBody<T, D> {
    /// Create the body on a grid, with the kernels of the scene and those of proxies.
    pub(in crate::step) fn new(
        mut client: Box<dyn GridClient<T, D>>,
        [method, kernels]: [Arc<dyn MethodKernels<T, D>>; 2],
        lattice: Lattice<D>,
        returns: Which,
    ) -> Self {
        let (mut mass, mut volume) = (0.0, 0.0);
        client.for_each(&mut |p| {
            mass += p.mass;
            volume += p.volume;
        });
        let law = Arc::new(Undeformed { density: T::of(mass / volume) });
        let within = client.within().is_some();
        // Map momentum like particles of the same body.
        let given = match (within, method.facts().affine) {
            (false, _) => Given::Nothing,
            (true, false) => Given::Acceleration,
            (true, true) => Given::Affine,
        };
        let none = (Loads { given, ..Loads::default() }, None);
        let mut proxy = ParticleBody::empty(client.name(), law, kernels, lattice, &client.half_size(), none);
        let to_come = client.matter().map(|matter| T::of(matter.lightest));
        let given = client.mass_points();
        let mut points = vec![ClientPoint::default(); given.len()];
        client.place(&mut points);
        proxy.stand_for(&given, &points);
        proxy.place_at(&points, &Team::one());
        let velocities = vec![[T::default(); 3]; points.len()];
        let carried = vec![[T::default(); 3]; if within { points.len() } else { 0 }];
        let rate = T::default();
        ClientBody { client, proxy, velocities, points, carried, within, to_come, method, rate, returns }
    }

    /// Rebuild the proxies after the points changed: `known` contains the former number of each. Proxies keep the
    /// velocity gradient of the nodes.
    fn stand_anew(&mut self, known: &[u32], team: &Team) {
        let proxy = &self.proxy;
        let (law, kernels, half) = (proxy.material.clone(), proxy.kernels.clone(), self.client.half_size());
        let loads = (Loads { given: proxy.loads.given, ..Loads::default() }, None);
        let mut anew = ParticleBody::empty(self.client.name(), law, kernels, proxy.lattice, &half, loads);
        let given = self.client.mass_points();
        self.points.clear();
        self.points.resize(given.len(), ClientPoint::default());
        self.client.place(&mut self.points);
        anew.stand_for(&given, &self.points);
        anew.place_at(&self.points, team);
        if let Some(row) = proxy.loads.rows(proxy.columns.load()).affine {
            let mut before = vec![None; self.velocities.len()];
            for slot in &proxy.slots {
                for (_, at) in slot.block.places() {
                    let gradient: [T; 9] = std::array::from_fn(|n| {
                        if n < D * D { slot.block.get(at, row + n) } else { T::default() }
                    });
                    before[slot.block.number(at)] = Some(gradient);
                }
            }
            for slot in &mut anew.slots {
                for (_, at) in slot.block.places().collect::<Vec<_>>() {
                    let was = known.get(slot.block.number(at)).and_then(|n| before.get(*n as usize));
                    let Some(Some(gradient)) = was else { continue };
                    (0..D * D).for_each(|n| slot.block.set(at, row + n, gradient[n]));
                }
            }
        }
        self.proxy = anew;
        for list in [&mut self.velocities, &mut self.carried] {
            list.clear();
            list.resize(given.len(), [T::default(); 3]);
        }
    }

    fn trouble(&self, trouble: BodyTrouble) -> Stopped {
        let BodyTrouble { particle, position, cause } = trouble;
        let (body, law) = (self.name().to_string(), self.law());
        Stopped::Point { kind: PointKind::Particle, body, number: particle, position, law, cause }
    }
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Create proxy particles of these masses and velocities at these points; other values are set later.
    fn stand_for(&mut self, given: &[(f64, [f64; D])], points: &[ClientPoint]) {
        let mut index = std::collections::BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        self.lightest = T::of(given.iter().fold(f64::MAX, |least, (mass, _)| least.min(*mass)));
        for (number, ((mass, velocity), point)) in given.iter().zip(points).enumerate() {
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(velocity[d]);
            }
            numbers[self.columns.mass()] = T::of(*mass);
            numbers[self.columns.number()] = T::of(number as f64);
            self.put(&mut index, &std::array::from_fn(|d| point.position[d]), &mut numbers);
        }
        self.settle();
    }

    /// Place the particles, by number, for a pass [`Follow`](crate::scheme::Follow), and set their domains.
    fn place_at(&mut self, points: &[ClientPoint], team: &Team) {
        let (centre, domain) = (self.bin_centre(), self.facts().domain);
        let (columns, lattice) = (&self.columns, &self.lattice);
        let h = lattice.spacing();
        team.each(&mut self.slots, |_, slot| {
            for bin in 0..block_nodes(D) {
                let cells = slot.block.bin_coordinates(bin);
                let mut next = slot.block.last_group(bin);
                while let Some((group, here)) = next {
                    next = slot.block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        let Some(point) = points.get(slot.block.number(at)) else { continue };
                        for d in 0..D {
                            let x =
                                (point.position[d] - lattice.origin()[d]) / h - f64::from(cells[d]) - centre;
                            slot.block.set(at, Columns::position() + d, T::of(x));
                        }
                        if domain.carried() {
                            let edges = point.half_edges.map(|e| e.map(|x| x / h));
                            let carried = domain.of_edges::<f64, D>(&edges);
                            for (n, x) in carried[..domain.numbers(D)].iter().enumerate() {
                                slot.block.set(at, columns.domain() + n, T::of(*x));
                            }
                        }
                    }
                }
            }
        });
    }
}

impl<T: Float, const D: usize> ClientSteps<T, D> for ClientBody<T, D> {
    fn open(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<(), Stopped> {
        if self.to_come.is_some() {
            self.client.velocities(&mut self.velocities);
            let velocities = &self.velocities;
            self.proxy.show_velocities(&mut |number, v| *v = velocities[number]);
        }
        self.client.open(dt, &mut self.velocities, team)?;
        if !self.on_grid() {
            return Ok(());
        }
        let steps = Steps { this: dt, next: dt, adapt: false, force_time: 0.0, force: [0.0; 3] };
        if !self.within {
            let velocities = &self.velocities;
            self.proxy.show_velocities(&mut |number, v| *v = velocities[number]);
        }
        self.proxy.pass(Which::Map, nodes, steps, team).map_err(|t| self.trouble(t))?;
        if self.within {
            let (velocities, per_dt) = (&self.velocities, T::of(1.0) / dt);
            let give = |number: usize, v: [T; 3]| -> [T; 3] {
                std::array::from_fn(|d| (velocities[number][d] - v[d]) * per_dt)
            };
            self.proxy.map_given(steps, &give, team);
        }
        Ok(())
    }

    fn advance(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<T, Stopped> {
        let (mut share, mut changed) = (T::default(), false);
        if self.within && self.on_grid() {
            let steps = Steps { this: dt, next: dt, adapt: false, force_time: 0.0, force: [0.0; 3] };
            self.proxy.carried(nodes, steps, &mut self.carried, team);
            self.client.carry(&self.carried);
            share = self.method.taken(dt);
        }
        let (changes, carried) = (&mut self.velocities, &self.carried);
        self.proxy.show_velocities(&mut |number, v| {
            let change = &mut changes[number];
            for d in 0..D {
                // The same update as for particles of the same body, or momentum would be lost between them.
                if share > T::default() {
                    v[d] += share * (carried[number][d] - v[d]);
                }
                change[d] = v[d] - change[d];
                changed |= change[d] != T::default();
            }
        });
        self.client.advance(dt, changed.then_some(&mut self.velocities), team)?;
        if !self.on_grid() {
            self.rate = T::of(self.client.rate());
            return Ok(self.rate);
        }
        self.client.place(&mut self.points);
        self.proxy.place_at(&self.points, team);
        let steps =
            Steps { this: T::default(), next: T::default(), adapt: true, force_time: 0.0, force: [0.0; 3] };
        let followed = self.proxy.sweep(Which::Follow, nodes, steps, team).map_err(|t| self.trouble(t))?;
        self.rate = followed.max(T::of(self.client.rate()));
        Ok(self.rate)
    }

    fn stable_step(&self) -> f64 {
        self.client.stable_step()
    }
    fn on_grid(&self) -> bool {
        !self.points.is_empty()
    }
    fn is_within(&self) -> bool {
        self.within
    }
    fn surface(&mut self) -> Option<&mut dyn SurfaceClient<T, D>> {
        self.client.surface()
    }
    fn given(&self) -> Exchange {
        self.client.given()
    }
    fn each_box(&self, visit: &mut dyn FnMut(&[f64; D], &[f64; D])) {
        self.client.each_box(visit);
    }
    fn bound(&mut self, boundary: &BoundaryEntry<D>) -> Result<(), SceneError> {
        if self.to_come.is_some() { self.client.bound(boundary) } else { Ok(()) }
    }
    fn convert(
        &mut self,
        around: &Surroundings<D>,
        new: &mut NewParticles<T, D>,
        team: &Team,
    ) -> Result<bool, Stopped> {
        let others = self.client.convert(around, new)?;
        if let Some(known) = &others {
            self.stand_anew(known, team);
        }
        Ok(others.is_some())
    }
}

impl<T: Float, const D: usize> Body for ClientBody<T, D> {
    fn name(&self) -> &str {
        self.client.name()
    }
    fn law(&self) -> &'static str {
        self.client.law()
    }
    fn len(&self) -> usize {
        self.client.len()
    }
    fn state_names(&self) -> Vec<String> {
        self.client.state_names()
    }
    fn totals(&self) -> Totals {
        self.client.totals()
    }
    fn given_by_others(&self) -> Option<Exchange> {
        self.client.given_by_others()
    }
    fn surface_area(&self) -> Option<f64> {
        self.client.surface_area()
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.client.for_each(visit);
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        self.client.for_each_with(parts, visit);
    }
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        self.client.bounds(dimensions, axisymmetric)
    }
    fn bytes(&self) -> usize {
        self.client.bytes()
            + self.proxy.bytes()
            + (self.velocities.capacity() + self.carried.capacity()) * size_of::<[T; 3]>()
            + self.points.capacity() * size_of::<ClientPoint>()
            + size_of::<Self>()
    }
}

impl<T: Float, const D: usize> GridBody<T, D> for ClientBody<T, D> {
    fn constants(&self, times: [f64; 2]) -> Vec<Constant> {
        self.client.constants(times)
    }
    fn embedding(&self) -> &'static str {
        self.client.embedding()
    }
    fn half_size(&self) -> [f64; D] {
        self.client.half_size()
    }
    fn lightest(&self) -> T {
        self.to_come.unwrap_or_else(|| self.proxy.lightest())
    }
    fn presence(&self) -> &dyn Presence<T, D> {
        &self.proxy
    }
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D> {
        &mut self.proxy
    }
    fn client(&self) -> Option<&dyn ClientSteps<T, D>> {
        Some(self)
    }
    fn client_mut(&mut self) -> Option<&mut dyn ClientSteps<T, D>> {
        Some(self)
    }
    fn rate(&self, spacing: f64) -> T {
        T::of(self.client.rate()).max(self.proxy.rate(spacing))
    }
    /// Update the velocities of the proxies in the pass in which particles gather theirs. Proxies have no stress;
    /// they move after the stages of the scene.
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        if which == self.returns && self.on_grid() {
            self.proxy.pass(Which::First, nodes, Steps { adapt: false, ..dt }, team)?;
        }
        // Only the pass that updates strain returns rates of particles, and thus the rate of this body.
        let finds = self.method.does(which).strain.is_some();
        Ok(if finds { self.rate } else { T::default() })
    }
    fn loading(&self) -> Loading {
        Loading::default()
    }
    fn locate(&mut self, _: Which, prune: bool, team: &Team) -> bool {
        self.on_grid() && self.proxy.locate_after(Which::Follow, prune, team)
    }
    fn coheres(&self) -> bool {
        self.client.coheres()
    }
    fn particle_bytes(&self) -> usize {
        self.proxy.particle_bytes()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.client.archive(file)?;
        file.numbers([&mut self.rate])?;
        if file.reads() && self.to_come.is_some() {
            self.stand_anew(&[], &Team::one());
        }
        self.proxy.archive(file)
    }
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        self.proxy.footprints(time, visit);
    }
}
