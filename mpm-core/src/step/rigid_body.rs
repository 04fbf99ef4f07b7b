//! Rigid bodies on the grid: particles that hold a place there, and what their nodes get.

use std::sync::Arc;

use mpm_materials::Material;
use mpm_materials::material::{Described, Motion, PairOutput, Response, States, StatesMut};

use super::body::{BodyTrouble, GridBody, Presence, Steps, Which};
use super::fields::Fields;
use super::footprint::Footprint;
use super::kernels::MethodKernels;
use super::layout::{Nodes, Piece, numbers};
use super::load::{Loading, Loads};
use super::nodes::{BlockPlace, Stage};
use super::particle_body::ParticleBody;
use super::proxy::ProxyState;
use super::rigid::{Rigid, RigidState};
use super::tile::Sums;
use crate::geometry::{Lattice, Seeds};
use crate::grid::Node;
use crate::parallel::{Float, Team};
use impactite_scene::Exchange;
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, PointView, Totals};

/// Matter that never deforms: no stress, no waves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Undeformed<T> {
    pub(super) density: T,
}

impl<T: Float> Material<T> for Undeformed<T> {
    fn name(&self) -> &'static str {
        "rigid"
    }
    fn density(&self) -> T {
        self.density
    }
    fn constants(&self) -> String {
        format!("{self:?}")
    }
    fn numbers(&self) -> usize {
        0
    }
    fn state_names(&self) -> Vec<String> {
        Vec::new()
    }
    fn virgin(&self) -> Vec<T> {
        Vec::new()
    }
    fn advance(&self, _: &Motion<'_, T>, states: StatesMut<'_, T>, _: bool, response: &mut Response<T>) {
        response.fill(states.groups.len(), undeformed::<T>());
    }
    fn describe(&self, states: States<'_, T>, _: T, response: &mut Response<T>) {
        response.fill(states.groups.len(), undeformed::<T>());
    }
    fn volume_ratios(&self, _: States<'_, T>, ratios: &mut [T::Row]) {
        ratios.fill(undeformed::<T>().volume_ratio.0[0]);
    }
    fn describe_point(&self, state: &[T]) -> Option<Described<T>> {
        let (zero, volume_ratio) = (T::default(), T::of(1.0));
        state.is_empty().then_some(Described {
            stress: [zero; 6],
            volume_ratio,
            wave_speed: zero,
            energy: zero,
            in_range: true,
            failed: false,
        })
    }
    fn step_speed(&self, _: &[T], _: T) -> Option<T> {
        Some(T::default())
    }
    fn energy_of(&self, _: &[T]) -> Option<T> {
        Some(T::default())
    }
    fn merged(&self, _: &[(f64, &[T])]) -> Option<Vec<T>> {
        None
    }
    fn stretch_place(&self) -> Option<usize> {
        None
    }
}

/// What is said of a group without strain.
fn undeformed<T: Float>() -> PairOutput<T::Row> {
    let mut said = PairOutput::<T::Row>::default();
    said.volume_ratio.0.iter_mut().for_each(|row| row.as_mut().fill(T::of(1.0)));
    said
}

/// A rigid body.
pub(super) struct RigidBody<T: Float, const D: usize> {
    particles: ParticleBody<T, D>,
    state: RigidState<D>,
}

impl<T: Float, const D: usize> RigidBody<T, D> {
    /// A body of these seeds.
    pub(super) fn new(
        name: &str,
        rigid: &Rigid<D>,
        kernels: Arc<dyn MethodKernels<T, D>>,
        lattice: Lattice<D>,
        seeds: &Seeds<D>,
    ) -> Result<Self, SceneError> {
        let state = RigidState::new(name, rigid, seeds, kernels.facts().hoop)?;
        let law = Arc::new(Undeformed { density: T::of(rigid.density()) });
        let none = (Loads::default(), None);
        let mut particles = ParticleBody::empty(name, law, kernels, lattice, &seeds.half_size, none);
        particles.seed(seeds, &|x| std::array::from_fn(|d| state.velocity_at(&x)[d]), None);
        Ok(RigidBody { particles, state })
    }
}

impl<T: Float, const D: usize> Body for RigidBody<T, D> {
    fn name(&self) -> &str {
        self.particles.name()
    }
    fn law(&self) -> &'static str {
        self.particles.law()
    }
    fn len(&self) -> usize {
        self.particles.len()
    }
    fn state_names(&self) -> Vec<String> {
        Vec::new()
    }
    /// Of the body, not of its particles; nothing but their number if its motion is prescribed.
    fn totals(&self) -> Totals {
        let particles = self.len();
        if self.state.is_prescribed() {
            return Totals { particles, ..Totals::default() };
        }
        let (state, mut totals) = (&self.state, self.particles.totals());
        let ([x, y, z], [u, v, w]) = (state.centre(), state.velocity());
        let (moment, own) = ([y * w - z * v, z * u - x * w, x * v - y * u], state.angular_momentum());
        totals.mass = state.mass();
        for d in 0..3 {
            totals.momentum[d] = state.mass() * state.velocity()[d];
            totals.angular_momentum[d] = state.mass() * moment[d] + own[d];
        }
        totals.kinetic = state.kinetic();
        totals.internal = 0.0;
        totals
    }
    fn for_each(&self, visit: &mut dyn FnMut(&PointView)) {
        self.particles.for_each(&mut |p| {
            let x = std::array::from_fn(|d| p.position[d]);
            visit(&PointView { velocity: self.state.velocity_at(&x), ..p.clone() });
        });
    }
    fn bytes(&self) -> usize {
        self.particles.bytes() + size_of::<Self>()
    }
}

impl<T: Float, const D: usize> GridBody<T, D> for RigidBody<T, D> {
    fn constants(&self, times: [f64; 2]) -> Vec<Constant> {
        self.state.constants_at(times)
    }
    fn embedding(&self) -> &'static str {
        self.particles.embedding()
    }
    fn half_size(&self) -> [f64; D] {
        self.particles.half_size()
    }
    fn lightest(&self) -> T {
        self.particles.lightest()
    }
    fn presence(&self) -> &dyn Presence<T, D> {
        &self.particles
    }
    fn presence_mut(&mut self) -> &mut dyn Presence<T, D> {
        &mut self.particles
    }
    fn rigid(&self) -> Option<&RigidState<D>> {
        Some(&self.state)
    }
    fn rigid_mut(&mut self) -> Option<&mut RigidState<D>> {
        Some(&mut self.state)
    }
    fn rate(&self, spacing: f64) -> T {
        self.particles.rate(spacing)
    }
    fn pass(
        &mut self,
        which: Which,
        nodes: Nodes<'_, T>,
        dt: Steps<T>,
        team: &Team,
    ) -> Result<T, BodyTrouble> {
        self.particles.pass(which, nodes, dt, team)
    }
    fn loading(&self) -> Loading {
        self.particles.loading()
    }
    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool {
        self.particles.locate(which, prune, team)
    }
    fn each_velocity(&mut self, visit: &mut dyn FnMut(usize, &mut [T; 3])) {
        self.particles.each_velocity(visit);
    }
    fn export_states(&self, numbers: &mut Vec<T>, shapes: &mut [ProxyState]) {
        self.particles.export_states(numbers, shapes);
    }
    fn particle_bytes(&self) -> usize {
        self.particles.particle_bytes()
    }
    fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        self.particles.exchange_particles(file)?;
        self.state.exchange(file)
    }
    fn footprints(&self, time: f64, visit: &mut dyn FnMut(&Footprint<'_, D>)) {
        self.particles.footprints(time, &mut |p| visit(&Footprint { rigid: true, ..*p }));
    }
}

/// The rigid body whose block this is.
pub(super) fn rigid_of<'a, T: Float, const D: usize>(
    bodies: &'a [Box<dyn GridBody<T, D>>],
    fields: &Fields<D>,
    block: usize,
) -> Option<&'a RigidState<D>> {
    bodies.get(fields.owner(block) as usize)?.rigid()
}

/// Give the nodes of a rigid body, as they are mapped, the body's own velocities. Says whether they are complete: a
/// body of prescribed motion obeys no forces.
pub(super) fn carry<T: Float, const D: usize>(
    body: &RigidState<D>,
    sums: Sums,
    place: &BlockPlace<D>,
    nodes: &mut Piece<'_, Node<T>>,
) -> bool {
    let free = !body.is_prescribed();
    for (n, node) in nodes.numbered() {
        let x = place.node(n);
        let mass = node.first[0];
        let put = |record: &mut [T; 4], values: [f64; 3], by: T| {
            for d in 0..D {
                record[d + 1] = by * T::of(values[d]);
            }
        };
        match sums {
            Sums::All if free => put(&mut node.first, body.velocity_at(&x), mass),
            Sums::Again if free => put(&mut node.second, body.velocity_at(&x), mass),
            Sums::Again => put(&mut node.second, body.velocity_at(&x), T::of(1.0)),
            Sums::All | Sums::Force if !free => {
                put(&mut node.first, body.mean_velocity(&x), T::of(1.0));
                put(&mut node.second, body.acceleration(&x), T::of(1.0));
            }
            Sums::All | Sums::Force | Sums::Smoothed | Sums::Pushes => {}
        }
    }
    !free
}

/// Impulse on a block of nodes of a free body, and its moment about the body's centre.
#[derive(Clone, Copy, Debug, Default)]
struct Push {
    impulse: [f64; 3],
    moment: [f64; 3],
}

impl<T: Float, const D: usize> Stage<'_, T, D> {
    /// What the nodes of the free body `number` got in this step: impulse and moment about its centre.
    pub fn push_on(&self, number: usize, state: &RigidState<D>) -> ([f64; 3], [f64; 3]) {
        let lattice = *self.grid.lattice();
        let (fields, takes, dt) = (self.fields, self.takes.to_double(), self.dt.to_double());
        let mirrors = self.planes.copied();
        let mut sum = Push::default();
        let layout = fields.layout();
        for block in (0..fields.len()).filter(|block| fields.owner(*block) as usize == number) {
            let place = BlockPlace::new(&lattice, &fields.coordinates()[block]);
            let nodes = layout.of(self.grid.nodes(), block);
            // Beside planes of symmetry nodes stand for the body's image, too: the body gets what its own particles there do.
            let own = self.planes.own_masses(layout.start(block), nodes.len());
            for (i, (n, node)) in numbers(layout.kept(block)).zip(nodes).enumerate() {
                let whole = if place.is_copy(n, mirrors) { 0.0 } else { 1.0 };
                let share = own.share(i, node).unwrap_or(whole);
                if node.first[0] <= self.cutoff || share == 0.0 {
                    continue;
                }
                let (x, mass) = (place.node(n), share * node.first[0].to_double());
                let now = state.velocity_at(&x);
                let (mut arm, mut given) = ([0.0; 3], [0.0; 3]);
                for d in 0..D {
                    arm[d] = x[d] - state.centre()[d];
                    let gained = node.second[d + 1].to_double() * dt;
                    let start = node.first[d + 1].to_double() - gained;
                    given[d] = mass * (gained + takes * (start - now[d]));
                    sum.impulse[d] += given[d];
                }
                let ([x, y, z], [u, v, w]) = (arm, given);
                let moment = [y * w - z * v, z * u - x * w, x * v - y * u];
                (0..3).for_each(|d| sum.moment[d] += moment[d]);
            }
        }
        (sum.impulse, sum.moment)
    }

    /// Have the nodes of free bodies move as the bodies do in this step.
    pub fn move_rigid(&mut self) {
        let lattice = *self.grid.lattice();
        let (bodies, fields) = (self.bodies, self.fields);
        let (layout, team) = (fields.layout(), self.team);
        layout.each(team, self.grid.nodes_mut(), self.books, |block, mut nodes, _| {
            let Some(body) = rigid_of(bodies, fields, block).filter(|b| !b.is_prescribed()) else { return };
            let place = BlockPlace::new(&lattice, &fields.coordinates()[block]);
            for (n, node) in nodes.numbered() {
                let x = place.node(n);
                let (way, gain) = (body.mean_velocity(&x), body.acceleration(&x));
                for d in 0..D {
                    node.first[d + 1] = T::of(way[d]);
                    node.second[d + 1] = T::of(gain[d]);
                }
            }
        });
    }
}

/// Book what a body of prescribed motion gives to others at a node: the opposite of `impulse` on itself, N s.
pub(super) fn book<const D: usize>(
    body: &RigidState<D>,
    x: &[f64; D],
    impulse: &[f64; 3],
    ledger: &mut Exchange,
) {
    let velocity = body.mean_velocity(x);
    for d in 0..D {
        ledger.impulse[d] -= impulse[d];
        ledger.work -= impulse[d] * velocity[d];
    }
}
