//! Bodies that are mapped in their reference configuration and meet others on the grid of the current one.
//!
//! Such a body is a scene of its own, on a grid in its reference configuration, and has a **proxy** in the scene that
//! it was added to: as many particles of the same masses, without stress, which hold its place among the others. A step
//! is
//!
//! ```text
//! reference:  v_I = p_I / m_I + dt f_I / m_I;  x' = sum N_I(X) v_I, the velocities that particles move with
//! current:    v_i = sum m x' N_i(x) / m_i;  contact, walls: J_i;  P = m sum N_i(x) J_i / m_i of every particle
//! reference:  v_I <- v_I + sum N_I(X) P / m_I;  the rest of a MUSL step
//! ```
//!
//! The two maps of a particle are adjoint: nodes of the current grid see it move as nodes of the reference move it, and
//! what it is pushed with goes to those as a force on it would. So sum J_i is sum m_I dv_I, momentum is what was given to
//! rounding, and sum J_i v_i = sum P x' = sum N_I P v_I, the work of the nodes is that on the body. (Pushes that
//! changed particles' velocities themselves, unseen by the nodes of the reference in part, multiplied the energy of discs by
//! seven or left a third of it.)
//!
//! A push comes back to its node smoothed twice, in part. A law that stops what closes, as Coulomb does, stops a part, and again
//! in the next step: bodies sink into each other a little, and lose energy. A spring ([`Penalty`](mpm_contact::Penalty)) pushes
//! until they stop, and gives back what it took.

use std::sync::Arc;

use super::body::{BodyTrouble, GridBody, Presence, Steps, Which};
use super::footprint::Footprint;
use super::kernels::MethodKernels;
use super::layout::Nodes;
use super::load::{Loading, Loads};
use super::node_update::Leave;
use super::nodes::{BlockPlace, Stage, free_directions};
use super::particle_body::ParticleBody;
use super::proxy::{InReference, ProxyState};
use super::rigid_body::Undeformed;
use super::solver::Mpm;
use super::tile::Sums;
use crate::dim::block_nodes;
use crate::geometry::Lattice;
use crate::grid::Node;
use crate::parallel::{Float, Team};
use crate::particles::{Columns, Place};
use impactite_scene::Exchange;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::control::TimeControl;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, PointView, Totals};
use impactite_scene::{PointKind, StepError, Stopped};

/// The body of a scene of its own, in another one.
struct ReferenceBody<T: Float, const D: usize> {
    scene: Mpm<D, T>,
    /// Its proxy there.
    proxy: ParticleBody<T, D>,
    /// By number: velocity that a particle moves with, then what the scene's nodes add to it, m/s.
    velocities: Vec<[T; 3]>,
    /// Of the nodes, m/s^2.
    accelerations: Vec<[T; 4]>,
    /// By number.
    shapes: Vec<ProxyState>,
    /// Numbers of a particle at work.
    numbers: Vec<T>,
    rate: T,
    /// The pass of the scene in which particles take what nodes got.
    returns: Which,
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// [`Body::each_velocity`].
    pub(super) fn show_velocities(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3])) {
        let first = Columns::velocity(D);
        for slot in &mut self.slots {
            for bin in 0..block_nodes(D) {
                let mut next = slot.block.last_group(bin);
                while let Some((group, here)) = next {
                    next = slot.block.group_before(group);
                    for lane in 0..here as u32 {
                        let at = Place { group, lane };
                        let mut v = [T::default(); 3];
                        (0..D).for_each(|d| v[d] = slot.block.get(at, first + d));
                        let before = v;
                        visit(slot.block.number(at), &mut v);
                        for d in 0..if v == before { 0 } else { D } {
                            slot.block.set(at, first + d, v[d]);
                        }
                    }
                }
            }
        }
    }

    /// [`Body::cast`].
    pub(super) fn export_states(&self, numbers: &mut Vec<T>, shapes: &mut [ProxyState]) {
        let (centre, h, origin) = (self.bin_centre(), self.lattice.spacing(), self.lattice.origin());
        for slot in &self.slots {
            for bin in 0..block_nodes(D) {
                let cells = slot.block.bin_coordinates(bin).map(|c| f64::from(c) + centre);
                for at in slot.block.bin_places(bin) {
                    numbers.clear();
                    slot.block.read(at, numbers);
                    let number = numbers[self.columns.number()].to_double() as usize;
                    let Some(shape) = shapes.get_mut(number) else { continue };
                    let mut position = [0.0; 3];
                    for d in 0..D {
                        let mut x = cells[d] + numbers[Columns::position() + d].to_double();
                        if self.facts().total {
                            x += numbers[self.columns.frame() + d].to_double();
                        }
                        position[d] = origin[d] + h * x;
                    }
                    *shape = ProxyState { position, half_edges: self.half_edges(numbers) };
                }
            }
        }
    }
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Place the particles, by number, where a pass [`Follow`] finds them, and give them their domains.
    fn update_proxy(&mut self, shapes: &[ProxyState], team: &Team) {
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
                        let number = slot.block.number(at);
                        let Some(shape) = shapes.get(number) else { continue };
                        for d in 0..D {
                            let x =
                                (shape.position[d] - lattice.origin()[d]) / h - f64::from(cells[d]) - centre;
                            slot.block.set(at, Columns::position() + d, T::of(x));
                        }
                        if domain.carried() {
                            let edges = shape.half_edges.map(|e| e.map(|x| x / h));
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

    /// Particles where those of `body` are, with as much mass; all else is to come.
    fn shade(&mut self, body: &dyn GridBody<T, D>) {
        let mut index = std::collections::BTreeMap::new();
        let mut numbers = self.dummy.to_vec();
        self.lightest = body.lightest();
        body.for_each(&mut |p| {
            for d in 0..D {
                numbers[Columns::velocity(D) + d] = T::of(p.velocity[d]);
            }
            numbers[self.columns.mass()] = T::of(p.mass);
            numbers[self.columns.number()] = T::of(p.number as f64);
            self.put(&mut index, &std::array::from_fn(|d| p.position[d]), &mut numbers);
        });
        self.settle();
    }
}

impl<T: Float, const D: usize> ReferenceBody<T, D> {
    fn new(
        scene: Mpm<D, T>,
        kernels: Arc<dyn MethodKernels<T, D>>,
        lattice: Lattice<D>,
        returns: Which,
    ) -> Self {
        let own = &scene.bodies[0];
        let (mut mass, mut volume) = (0.0, 0.0);
        own.for_each(&mut |p| {
            mass += p.mass;
            volume += p.volume;
        });
        let law = Arc::new(Undeformed { density: T::of(mass / volume) });
        let none = (Loads::default(), None);
        let mut proxy = ParticleBody::empty(own.name(), law, kernels, lattice, &own.half_size(), none);
        proxy.shade(&**own);
        let (velocities, shapes) =
            (vec![[T::default(); 3]; own.len()], vec![ProxyState::default(); own.len()]);
        let (numbers, rate) = (Vec::new(), T::default());
        let mut body = ReferenceBody {
            scene,
            proxy,
            velocities,
            accelerations: Vec::new(),
            shapes,
            numbers,
            rate,
            returns,
        };
        body.scene.bodies[0].export_states(&mut body.numbers, &mut body.shapes);
        body.proxy.update_proxy(&body.shapes, &Team::one());
        body
    }

    fn own(&self) -> &dyn GridBody<T, D> {
        &*self.scene.bodies[0]
    }

    fn trouble(&self, trouble: BodyTrouble) -> Stopped {
        let BodyTrouble { particle, position, cause } = trouble;
        let (body, law) = (self.own().name().to_string(), self.own().law());
        Stopped::Point { kind: PointKind::Particle, body, number: particle, position, law, cause }
    }
}

impl<T: Float, const D: usize> InReference<T, D> for ReferenceBody<T, D> {
    fn open(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<(), Stopped> {
        self.scene.set_team(team.clone());
        self.scene.accelerate(dt, &mut self.velocities, &mut self.accelerations).map_err(|e| e.what)?;
        let velocities = &self.velocities;
        self.proxy.each_velocity(&mut |number, v| *v = velocities[number]);
        let steps = Steps { this: dt, next: dt, adapt: false, force_time: 0.0 };
        self.proxy.pass(Which::Map, nodes, steps, team).map_err(|t| self.trouble(t))?;
        Ok(())
    }

    fn advance(&mut self, nodes: Nodes<'_, T>, dt: T, team: &Team) -> Result<T, Stopped> {
        let (pushes, mut pushed) = (&mut self.velocities, false);
        self.proxy.each_velocity(&mut |number, v| {
            let push = &mut pushes[number];
            for d in 0..D {
                push[d] = v[d] - push[d];
                pushed |= push[d] != T::default();
            }
        });
        self.scene.push(pushed.then_some(pushes), &self.accelerations, dt).map_err(|e| e.what)?;
        self.scene.deform(dt).map_err(|e| e.what)?;
        self.scene.bodies[0].export_states(&mut self.numbers, &mut self.shapes);
        self.proxy.update_proxy(&self.shapes, team);
        let steps = Steps { this: T::default(), next: T::default(), adapt: true, force_time: 0.0 };
        let followed = self.proxy.sweep(Which::Follow, nodes, steps, team).map_err(|t| self.trouble(t))?;
        self.rate = followed.max(self.scene.rate);
        Ok(self.rate)
    }

    fn given(&self) -> Exchange {
        self.scene.exchange()
    }
}

impl<T: Float, const D: usize> Body for ReferenceBody<T, D> {
    fn name(&self) -> &str {
        self.own().name()
    }
    fn law(&self) -> &'static str {
        self.own().law()
    }
    fn len(&self) -> usize {
        self.own().len()
    }
    fn state_names(&self) -> Vec<String> {
        self.own().state_names()
    }
    fn totals(&self) -> Totals {
        self.own().totals()
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.own().for_each(visit);
    }
    fn bytes(&self) -> usize {
        self.scene.bytes()
            + self.proxy.bytes()
            + self.velocities.capacity() * size_of::<[T; 3]>()
            + self.accelerations.capacity() * size_of::<[T; 4]>()
            + self.shapes.capacity() * size_of::<ProxyState>()
            + self.numbers.capacity() * size_of::<T>()
            + size_of::<Self>()
    }
}

impl<T: Float, const D: usize> GridBody<T, D> for ReferenceBody<T, D> {
    fn constants(&self, times: [f64; 2]) -> Vec<Constant> {
        self.own().constants(times)
    }
    fn embedding(&self) -> &'static str {
        self.own().embedding()
    }
    fn half_size(&self) -> [f64; D] {
        self.own().half_size()
    }
    fn lightest(&self) -> T {
        self.proxy.lightest()
    }
    fn presence(&self) -> &dyn Presence<T, D> {
        &self.proxy
    }
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D> {
        &mut self.proxy
    }
    fn in_reference(&self) -> Option<&dyn InReference<T, D>> {
        Some(self)
    }
    fn in_reference_mut(&mut self) -> Option<&mut dyn InReference<T, D>> {
        Some(self)
    }
    fn rate(&self, spacing: f64) -> T {
        self.own().rate(self.scene.grid.lattice().spacing()).max(self.proxy.rate(spacing))
    }
    /// Of the proxy, which has no stress: velocities in the first pass, all else when the scene's stages are done.
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        if which == self.returns {
            self.proxy.pass(Which::First, nodes, Steps { adapt: false, ..dt }, team)?;
        }
        Ok(self.rate)
    }
    fn loading(&self) -> Loading {
        Loading::default()
    }
    fn locate(&mut self, _: Which, prune: bool, team: &Team) -> bool {
        self.proxy.locate_after(Which::Follow, prune, team)
    }
    fn totals_on(&self, team: &Team, parts: &mut Vec<Totals>) -> Totals {
        self.own().totals_on(team, parts)
    }
    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3])) {
        self.scene.bodies[0].each_velocity(visit);
    }
    fn export_states(&self, numbers: &mut Vec<T>, shapes: &mut [ProxyState]) {
        self.own().export_states(numbers, shapes);
    }
    fn particle_bytes(&self) -> usize {
        self.own().particle_bytes() + self.proxy.particle_bytes()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.scene.archive_here(file)?;
        file.numbers([&mut self.rate])?;
        self.proxy.archive(file)
    }
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        self.proxy.footprints(time, visit);
    }
}

impl<T: Float, const D: usize> Stage<'_, T, D> {
    /// Sum pushes mapped as momentum: the second record becomes a change of velocity, none where a boundary holds it.
    fn collect_pushes(&mut self) {
        self.collect_and(Sums::Pushes, &Leave);
        let (conditions, lattice, cutoff) = (self.conditions, *self.grid.lattice(), self.cutoff);
        let time = self.time + self.dt.to_double();
        let copies = if self.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let (blocks, planes, layout) = (self.fields.coordinates(), &*self.planes, self.fields.layout());
        let mirrors = planes.copied();
        layout.each(self.team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            let place = BlockPlace::new(&lattice, &blocks[block]);
            let own = planes.own_masses(layout.start(block), nodes.items.len());
            for (i, (n, node)) in nodes.numbered().enumerate() {
                let mass = node.first[0];
                let free = free_directions(conditions, &place.node(n), time, lattice.spacing(), copies);
                let whole = if place.is_copy(n, mirrors) { 0.0 } else { 1.0 };
                let share = own.share(i, node).unwrap_or(whole);
                for d in 0..D {
                    let push = node.second[d + 1];
                    let moves = mass > cutoff && free[d];
                    node.second[d + 1] = if moves { push / mass } else { T::default() };
                    if !moves {
                        books.ledger.impulse[d] -= share * push.to_double();
                    }
                }
            }
        });
        self.planes.extrapolate(self.grid.nodes_mut());
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// The first part of a step that another scene completes: velocities of the nodes by the body's own forces. Notes, by number,
    /// those that particles move with, m/s, and the accelerations of the nodes.
    fn accelerate(
        &mut self,
        dt: T,
        velocities: &mut [[T; 3]],
        accelerations: &mut Vec<[T; 4]>,
    ) -> Result<(), StepError> {
        self.map_particles(f64::INFINITY)?;
        self.stage(dt).integrate_momentum(dt, false);
        accelerations.clear();
        for Node { first, second } in self.grid.nodes_mut() {
            accelerations.push(std::mem::replace(second, *first));
        }
        // Velocities that are zero become what nodes have in their second record, times one.
        self.bodies[0].each_velocity(&mut |number, v| velocities[number] = std::mem::take(v));
        self.particle_pass(Which::First, T::of(1.0))?;
        self.bodies[0].each_velocity(&mut |number, v| std::mem::swap(v, &mut velocities[number]));
        Ok(())
    }

    /// Take back the accelerations of the nodes and add `pushes`, m/s, of the particles by number.
    fn push(
        &mut self,
        pushes: Option<&mut Vec<[T; 3]>>,
        accelerations: &[[T; 4]],
        dt: T,
    ) -> Result<(), StepError> {
        let pushed = pushes.is_some();
        if let Some(pushes) = pushes {
            self.bodies[0].each_velocity(&mut |number, v| std::mem::swap(v, &mut pushes[number]));
            // Nothing comes to velocities in no time: the pass maps them.
            self.particle_pass(Which::First, T::default())?;
            self.stage(dt).collect_pushes();
            self.bodies[0].each_velocity(&mut |number, v| *v = pushes[number]);
        }
        for (Node { first, second }, acceleration) in self.grid.nodes_mut().iter_mut().zip(accelerations) {
            let push = std::mem::replace(second, *acceleration);
            for d in 1..if pushed { D + 1 } else { 1 } {
                first[d] += push[d];
                second[d] += push[d] / dt;
            }
        }
        Ok(())
    }

    /// The rest of it.
    fn deform(&mut self, dt: T) -> Result<(), StepError> {
        self.particle_pass(Which::First, dt)?;
        self.stage(dt).remap_velocities(dt);
        self.particle_pass(Which::Second, dt)?;
        self.close_step(dt)
    }

    /// Move bodies in their reference configuration by their own forces, and map their velocities.
    pub(super) fn open_references(&mut self, dt: T) -> Result<(), StepError> {
        if self.conditions.gravity.is_some() {
            self.check_references("a body force of the scene")
                .map_err(|e| self.stopped(Stopped::Scene(e)))?;
        }
        for n in 0..self.references.len() {
            let nodes = Nodes { all: self.grid.nodes(), layout: self.fields.layout() };
            let body = self.bodies[self.references[n]].in_reference_mut();
            let opened = body.map_or(Ok(()), |body| body.open(nodes, dt, &self.team));
            opened.map_err(|what| self.stopped(what))?;
        }
        Ok(())
    }

    /// Have them take what their nodes got, deform and move.
    pub(super) fn advance_references(&mut self, dt: T) -> Result<(), StepError> {
        for n in 0..self.references.len() {
            let nodes = Nodes { all: self.grid.nodes(), layout: self.fields.layout() };
            let body = self.bodies[self.references[n]].in_reference_mut();
            let advanced = body.map_or(Ok(T::default()), |body| body.advance(nodes, dt, &self.team));
            let rate = advanced.map_err(|what| self.stopped(what))?;
            self.rate = self.rate.max(rate);
        }
        Ok(())
    }

    /// Refuse what asks the nodes of the scene for all forces, beside bodies in their reference configuration.
    pub(super) fn check_references(&self, what: &'static str) -> Result<(), SceneError> {
        match self.references.first() {
            None => Ok(()),
            Some(&n) => Err(SceneError::BesideReference { body: self.bodies[n].name().into(), what }),
        }
    }

    /// Add the body of another scene, which maps it in its reference configuration ([`crate::TotalLagrangian`]): its own
    /// forces and strains stay there, on a grid of its own, and it meets the bodies and walls of this scene here.
    ///
    /// So a body that keeps its shape has none of the errors of particles that cross cells, and contact with those that do not
    /// keep theirs. A step of this scene is one of the other, too, of the length that this one finds. Boundaries, loads and body
    /// forces of the other scene act there; of those of this one, walls and fixed planes hold the body, while planes of symmetry
    /// are needed in both. The grids may have different cells.
    ///
    /// Let it meet others by springs: [`mpm_contact::Penalty`]. Laws that stop what closes, and walls, make it sink in a little
    /// and lose energy, discs up to two thirds of it (book, "Bodies in their reference configuration"); a rigid plate is a better wall.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_core::contact::{Contact, BlockContacts, Scratch, SharedNodes};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # #[derive(Debug)]
    /// # struct AnyContact;
    /// # impl Contact<f64, 2> for AnyContact {
    /// #     fn impulses(&self, _: &SharedNodes<'_, f64, 2>, _: &mut BlockContacts<f64>, _: &mut Scratch<f64>) {}
    /// # }
    /// let law = LinearElastic::new(1.0, Moduli::young_poisson(1.0, 0.3)?)?;
    /// let (fine, coarse) = (Lattice::new([0.0; 2], 0.1)?, Lattice::new([0.0; 2], 0.125)?);
    /// let reference = Method::new(Linear, Flip, Musl, PlaneStrain).total_lagrangian();
    /// let mut strip = Mpm::new(reference, BlockGrid::new(fine));
    /// let seeds = fill(&Cuboid::new([0.0; 2], [1.0, 0.2])?, &fine, 2, &Filling::new())?;
    /// strip.add("strip", law, &seeds, |_| [0.1, 0.0])?;
    ///
    /// let method = Method::new(Linear, Flip, Musl, PlaneStrain);
    /// let mut scene = Mpm::with_contact(method, BlockGrid::new(coarse), AnyContact);
    /// scene.add_total_lagrangian(strip)?;
    /// scene.run_until(1.0)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// A scene without contact, or in the reference configuration, or whose nodes know no accelerations (PIC, APIC, FMPM); another
    /// scene that is not in the reference configuration with FLIP and MUSL; one of no or several bodies, of other coordinates, that made
    /// steps, or damps or filters; particles larger than a cell of this grid or outside of it; a body force, kinetic damping, a
    /// null-space filter, a body whose particles merge or [`TimeControl::Gershgorin`] in this scene.
    pub fn add_total_lagrangian(&mut self, scene: Mpm<D, T>) -> Result<(), SceneError> {
        self.work.add_total_lagrangian(self, scene)
    }

    pub(super) fn add_total_lagrangian_here(&mut self, scene: Mpm<D, T>) -> Result<(), SceneError> {
        let what = || "a body in its reference configuration".to_string();
        if !self.contact.separates() {
            return Err(SceneError::NoContact("a body in its reference configuration"));
        }
        self.check_frame(&what(), "the scene that bodies meet in is one of the current configuration")?;
        let (here, there) = (self.facts(), scene.facts());
        let Some(for_place) = self.kernels.for_place() else {
            let why = "such bodies meet others where nodes know accelerations: take FLIP or a blend";
            return Err(SceneError::NotWith { what: what(), method: here.description.clone(), why });
        };
        if !there.total || !there.reads_increment || there.order > 1 || !there.remap {
            let why = "its own scene is total Lagrangian, with FLIP and MUSL";
            return Err(SceneError::NotWith { what: what(), method: there.description.clone(), why });
        }
        let (before_forces, embedding) = (here.before_forces, here.embedding);
        let [own] = &scene.bodies[..] else { return Err(SceneError::NotOneBody(scene.bodies.len())) };
        let (name, here) = (own.name().to_string(), embedding);
        if own.embedding() != here {
            return Err(SceneError::OtherSpace { body: name, there: own.embedding(), here });
        }
        if scene.clock.steps > 0 || scene.clock.time != self.clock.time {
            return Err(SceneError::Clock { time: scene.clock.time, steps: scene.clock.steps });
        }
        let refuse = |what| Err(SceneError::BesideReference { body: name.clone(), what });
        if scene.kinetic_damping.is_some() || self.kinetic_damping.is_some() {
            return refuse("kinetic damping");
        }
        if scene.filter.is_some() || self.filter.is_some() {
            return refuse("a null-space filter");
        }
        if self.bodies.iter().any(|b| b.division().is_some_and(|b| b.merges().is_some())) {
            return refuse("merging");
        }
        if self.conditions.gravity.is_some() {
            return refuse("a body force of the scene");
        }
        if !(self.wrap()?.is_none() && scene.wrap()?.is_none()) {
            return refuse("periodic planes");
        }
        if matches!(self.control, TimeControl::Gershgorin { .. }) {
            return refuse("`TimeControl::Gershgorin`");
        }
        self.check_half_sizes(&name, &own.half_size())?;
        let returns = if before_forces { Which::Second } else { Which::First };
        let body = ReferenceBody::new(scene, for_place, *self.grid.lattice(), returns);
        self.enter(&name, Box::new(body))?;
        self.references.push(self.bodies.len() - 1);
        Ok(())
    }
}
