//! Bodies mapped in their reference configuration, in contact with others on the grid of the current one.
//!
//! Such a body is a separate scene, on a grid in its reference configuration, and a [`GridClient`] of the scene to
//! which it was added. A step is
//!
//! ```text
//! reference:  v_I = p_I / m_I + dt f_I / m_I;  x' = sum N_I(X) v_I, the velocities that particles move with
//! current:    v_i = sum m x' N_i(x) / m_i;  contact, walls: J_i;  P = m sum N_i(x) J_i / m_i of every particle
//! reference:  v_I <- v_I + sum N_I(X) P / m_I;  the rest of a MUSL step
//! ```
//!
//! The two maps of a particle are adjoint: nodes of the current grid receive the velocity that the reference nodes
//! interpolate at the particle, and its impulse is mapped to the reference nodes like a force on it. Hence sum J_i is
//! sum m_I dv_I, momentum is conserved to rounding, and sum J_i v_i = sum P x' = sum N_I P v_I: the work at the nodes
//! is that on the body. (Impulses applied to the particle velocities themselves, which the reference nodes resolve
//! only in part, multiplied the energy of discs by seven or left a third of it.)
//!
//! An impulse returns to its node smoothed twice, and therefore only in part. A contact law that stops the approach,
//! such as Coulomb's, stops a part of it in each step: bodies penetrate a little, and lose energy. A spring
//! ([`Penalty`](mpm_contact::Penalty)) pushes until they stop, and returns its energy.

use super::client::{ClientPoint, GridClient};
use crate::dim::block_nodes;
use crate::grid::Lattices;
use crate::grid::Node;
use crate::particles::{Columns, Place};
use crate::step::bodies::body::{GridBody, Which};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::mpm::Mpm;
use crate::step::nodes::block_place::BlockPlace;
use crate::step::nodes::constraints::free_directions;
use crate::step::nodes::layout::NodeSums;
use crate::step::nodes::node_update::Leave;
use crate::step::nodes::stages::GridStages;
use impactite_scene::Exchange;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, Parts, PointView, StepError, Stopped, Totals};
use impactite_simd::{Float, Team};

/// Scene of one body in its reference configuration, as a client body of another scene.
struct ReferenceScene<T: Float, const D: usize> {
    scene: Mpm<D, T>,
    /// Accelerations of the nodes, m/s^2.
    accelerations: Vec<[T; 4]>,
    /// Scratch memory for the values of a particle.
    numbers: Vec<T>,
}

impl<T: Float, const D: usize> ReferenceScene<T, D> {
    fn own(&self) -> &dyn GridBody<T, D> {
        &*self.scene.scene.bodies[0]
    }
}

impl<T: Float, const D: usize> GridClient<T, D> for ReferenceScene<T, D> {
    fn constants(&self, times: [f64; 2]) -> Vec<Constant> {
        self.own().constants(times)
    }
    fn embedding(&self) -> &'static str {
        self.own().embedding()
    }
    fn half_size(&self) -> [f64; D] {
        self.own().half_size()
    }
    fn mass_points(&self) -> Vec<(f64, [f64; D])> {
        let mut all = vec![(0.0, [0.0; D]); self.len()];
        self.for_each(&mut |p| all[p.number] = (p.mass, std::array::from_fn(|d| p.velocity[d])));
        all
    }
    fn place(&mut self, points: &mut [ClientPoint]) {
        if let Some(particles) = self.scene.scene.bodies[0].free_velocities() {
            particles.place(&mut self.numbers, points);
        }
    }
    fn rate(&self) -> f64 {
        let known = self.scene.stepper.rate;
        let spacing = self.scene.grid.lattice().spacing();
        if known > T::default() { known.to_double() } else { self.own().rate(spacing).to_double() }
    }
    fn open(&mut self, dt: T, velocities: &mut [[T; 3]], team: &Team) -> Result<(), Stopped> {
        self.scene.set_team(team.clone());
        self.scene.accelerate(dt, velocities, &mut self.accelerations).map_err(|e| e.what)
    }
    fn advance(&mut self, dt: T, changes: Option<&mut Vec<[T; 3]>>, _: &Team) -> Result<(), Stopped> {
        self.scene.push(changes, &self.accelerations, dt).map_err(|e| e.what)?;
        self.scene.deform(dt).map_err(|e| e.what)
    }
    fn given(&self) -> Exchange {
        self.scene.exchange()
    }
    fn coheres(&self) -> bool {
        self.own().coheres()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.scene.archive_here(file)
    }
}

impl<T: Float, const D: usize> Body for ReferenceScene<T, D> {
    fn name(&self) -> &str {
        self.own().name()
    }
    fn law(&self) -> &'static str {
        self.own().law()
    }
    fn is_plane_stress(&self) -> bool {
        self.own().is_plane_stress()
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
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        self.own().for_each_with(parts, visit);
    }
    fn bounds(&self, dimensions: usize, axisymmetric: bool) -> Option<[[f64; 3]; 2]> {
        self.own().bounds(dimensions, axisymmetric)
    }
    fn bytes(&self) -> usize {
        self.scene.bytes()
            + self.accelerations.capacity() * size_of::<[T; 4]>()
            + self.numbers.capacity() * size_of::<T>()
    }
}

impl<T: Float, const D: usize> ParticleBody<T, D> {
    /// Call `visit` with number and velocity, m/s, of every particle; it may change the velocity.
    pub(in crate::step) fn show_velocities(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3])) {
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

    /// Store positions and domains of the particles, by number. `numbers` is scratch memory.
    pub(in crate::step) fn place_of_particles(&self, numbers: &mut Vec<T>, points: &mut [ClientPoint]) {
        let (centre, h, origin) = (self.bin_centre(), self.lattice.spacing(), self.lattice.origin());
        for slot in &self.slots {
            for bin in 0..block_nodes(D) {
                let cells = slot.block.bin_coordinates(bin).map(|c| f64::from(c) + centre);
                for at in slot.block.bin_places(bin) {
                    numbers.clear();
                    slot.block.read(at, numbers);
                    let number = numbers[self.columns.number()].to_double() as usize;
                    let Some(point) = points.get_mut(number) else { continue };
                    let mut position = [0.0; 3];
                    for d in 0..D {
                        let mut x = cells[d] + numbers[Columns::position() + d].to_double();
                        if self.facts().total {
                            x += numbers[self.columns.frame() + d].to_double();
                        }
                        position[d] = origin[d] + h * x;
                    }
                    *point = ClientPoint { position, half_edges: self.half_edges(numbers, (0, 0.0)) };
                }
            }
        }
    }
}

impl<T: Float, const D: usize> GridStages<'_, T, D> {
    /// Sum impulses mapped as momentum, and convert the second record to a velocity change: zero where a boundary constrains it.
    fn collect_pushes(&mut self) {
        self.collect_and(NodeSums::Pushes, &Leave);
        let (conditions, lattice, cutoff) = (self.conditions, *self.grid.lattice(), self.cutoff);
        let time = self.of.time + self.of.dt.to_double();
        let copies = if self.of.wide { 1.5 * lattice.spacing() } else { 0.0 };
        let (blocks, planes, layout) = (self.fields.coordinates(), &*self.planes, self.fields.layout());
        let mirrors = planes.copied();
        layout.each(self.team, self.grid.nodes_mut(), self.books, |block, mut nodes, books| {
            let place = BlockPlace::new(&Lattices::one(lattice), &blocks[block]);
            let own = planes.own_masses(layout.start(block), nodes.items.len());
            for (i, (n, node)) in nodes.numbered().enumerate() {
                let mass = node.first[0];
                let free = free_directions(conditions, &place.node(n), time, lattice.spacing(), copies);
                let whole = if place.is_copy(n, mirrors) { 0.0 } else { 1.0 };
                let share = own.share(i, node).unwrap_or(whole);
                let at = (time, 1e-6 * lattice.spacing(), copies);
                let accounts = conditions.boundaries.constraining(&place.node(n), at);
                for d in 0..D {
                    let push = node.second[d + 1];
                    let moves = mass > cutoff && free[d];
                    node.second[d + 1] = if moves { push / mass } else { T::default() };
                    if !moves {
                        let impulse = -share * push.to_double();
                        books.ledger.impulse[d] += impulse;
                        if let Some(account) = accounts[d] {
                            books.ledger.accounts[account].impulse[d] += impulse;
                        }
                    }
                }
            }
        });
        self.planes.extrapolate(self.grid.nodes_mut());
    }
}

impl<const D: usize, T: Float> Mpm<D, T> {
    /// Start a step that another scene completes: compute the velocities of the nodes under the body's own forces.
    /// Store the velocities that move the particles, m/s, by number, and the accelerations of the nodes.
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
        // The pass adds the second record of the nodes, times a step of one, to velocities of zero.
        self.each_velocity(|number, v| velocities[number] = std::mem::take(v));
        self.particle_pass(Which::First, T::of(1.0))?;
        self.each_velocity(|number, v| std::mem::swap(v, &mut velocities[number]));
        Ok(())
    }

    fn each_velocity(&mut self, mut visit: impl FnMut(usize, &mut [T; 3])) {
        if let Some(particles) = self.scene.bodies[0].free_velocities() {
            particles.each_velocity(&mut visit);
        }
    }

    /// Restore the accelerations of the nodes and add `pushes`, m/s, of the particles by number.
    fn push(
        &mut self,
        pushes: Option<&mut Vec<[T; 3]>>,
        accelerations: &[[T; 4]],
        dt: T,
    ) -> Result<(), StepError> {
        let pushed = pushes.is_some();
        if let Some(pushes) = pushes {
            self.each_velocity(|number, v| std::mem::swap(v, &mut pushes[number]));
            // A step of zero changes no velocities: the pass maps them.
            self.particle_pass(Which::First, T::default())?;
            self.stage(dt).collect_pushes();
            self.each_velocity(|number, v| *v = pushes[number]);
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

    /// Complete the step.
    fn deform(&mut self, dt: T) -> Result<(), StepError> {
        self.particle_pass(Which::First, dt)?;
        self.stage(dt).remap_velocities(dt);
        self.particle_pass(Which::Second, dt)?;
        self.close_step(dt)
    }

    /// Add the body of another scene, which maps it in its reference configuration ([`crate::TotalLagrangian`]). Its
    /// forces and strains are computed there, on a separate grid; contact with the bodies and walls of this scene is
    /// computed here.
    ///
    /// A body of moderate deformation thus has no cell-crossing errors, and can be in contact with bodies of any
    /// deformation. Both scenes make the same steps, of the length that this one finds. Boundaries, loads and body
    /// forces of the other scene act there; of those of this one, walls and fixed planes act on the body, while
    /// planes of symmetry are needed in both. The grids may have different cells.
    ///
    /// Use springs for the contact: [`mpm_contact::Penalty`]. With laws that stop the approach, and with walls, the
    /// body penetrates a little and loses energy, discs up to two thirds of it (book, "Bodies in their reference
    /// configuration"); a rigid plate is a better wall.
    ///
    /// ```
    /// # use mpm_core::{BlockGrid, Flip, Linear, Method, Mpm, Musl, PlaneStrain, geometry::*};
    /// # use mpm_core::contact::{ContactAlgorithm, BlockContacts, Scratch, SharedNodes};
    /// # use mpm_materials::{LinearElastic, Moduli};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # #[derive(Debug)]
    /// # struct AnyContact;
    /// # impl ContactAlgorithm<f64, 2> for AnyContact {
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
    /// A scene without contact, in the reference configuration, or whose nodes have no accelerations (PIC, APIC,
    /// FMPM); another scene that is not in the reference configuration with FLIP and MUSL, or that has no or several
    /// bodies, other coordinates, completed steps, damping or a filter; particles larger than a cell of this grid or
    /// outside of it; a body force, kinetic damping, a null-space filter, a body whose particles merge or
    /// [`TimeControl::Gershgorin`](crate::TimeControl::Gershgorin) in this scene.
    pub fn add_total_lagrangian(&mut self, scene: Mpm<D, T>) -> Result<(), SceneError> {
        self.work.add_total_lagrangian(self, scene)
    }

    pub(in crate::step) fn add_total_lagrangian_here(&mut self, scene: Mpm<D, T>) -> Result<(), SceneError> {
        let (what, there) = ("a body in its reference configuration", scene.facts());
        if !there.total || !there.reads_increment || there.order > 1 || !there.remap {
            let why = "its own scene is total Lagrangian, with FLIP and MUSL";
            return Err(SceneError::NotWith { what: what.into(), method: there.description.clone(), why });
        }
        let [own] = &scene.scene.bodies[..] else {
            return Err(SceneError::NotOneBody(scene.scene.bodies.len()));
        };
        let refuse = |what| Err(SceneError::BesideClient { body: own.name().into(), what });
        if scene.clock.steps > 0 || scene.clock.time != self.clock.time {
            return Err(SceneError::Clock { time: scene.clock.time, steps: scene.clock.steps });
        }
        if scene.between_steps.kinetic_damping.is_some() {
            return refuse("kinetic damping");
        }
        if scene.between_steps.filter.is_some() {
            return refuse("a null-space filter");
        }
        if !scene.wrap()?.is_none() {
            return refuse("periodic planes");
        }
        if !scene.hooks.0.is_empty() {
            return refuse("hooks of its own");
        }
        let body = ReferenceScene { scene, accelerations: Vec::new(), numbers: Vec::new() };
        self.add_client_here(what, Box::new(body))
    }
}
