//! Rigid bodies on the grid: proxy particles and the impulses on their nodes.

use std::sync::Arc;

use mpm_materials::Material;
use mpm_materials::material::{Described, Motion, PairOutput, Response, States, StatesMut};

use super::motion::{Rigid, RigidState};
use crate::grid::Levels;
use crate::step::bodies::body::{BodyTrouble, GridBody, Presence, Steps, Which};
use crate::step::bodies::load::{Loading, Loads};
use crate::step::bodies::particle_body::ParticleBody;
use crate::step::nodes::footprint::Footprint;
use crate::step::nodes::layout::Nodes;
use crate::step::nodes::occupancy::Tile;
use crate::step::passes::kernels::MethodKernels;
use impactite_geometry::{Lattice, Seeds};
use impactite_scene::archive::{Archive, CheckpointError};
use impactite_scene::constants::Constant;
use impactite_scene::error::SceneError;
use impactite_scene::{Body, Parts, PointView, Totals};
use impactite_simd::{Float, Team};

/// Undeformable material: no stress, no waves.
#[derive(Clone, Copy, Debug)]
pub(in crate::step) struct Undeformed<T> {
    pub(in crate::step) density: T,
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
    fn energies(&self, _: States<'_, T>, energies: &mut [T::Row], heats: &mut [T::Row]) {
        energies.fill(T::Row::default());
        heats.fill(T::Row::default());
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

/// Return the response of a group without strain.
fn undeformed<T: Float>() -> PairOutput<T::Row> {
    let mut said = PairOutput::<T::Row>::default();
    said.volume_ratio.0.iter_mut().for_each(|row| row.as_mut().fill(T::of(1.0)));
    said
}

/// Rigid body on the grid.
pub(in crate::step) struct RigidBody<T: Float, const D: usize> {
    particles: ParticleBody<T, D>,
    state: RigidState<D>,
}

impl<T: Float, const D: usize> RigidBody<T, D> {
    /// Create a body from its seeds.
    pub(in crate::step) fn new(
        name: &str,
        rigid: &Rigid<D>,
        kernels: Arc<dyn MethodKernels<T, D>>,
        (lattice, levels): (Lattice<D>, Option<&Arc<Levels<D>>>),
        seeds: &Seeds<D>,
    ) -> Result<Self, SceneError> {
        let state = RigidState::new(name, rigid, seeds, kernels.facts().hoop)?;
        let law = Arc::new(Undeformed { density: T::of(rigid.density()) });
        let none = (Loads::default(), None);
        let mut particles = ParticleBody::empty(name, law, kernels, lattice, &seeds.half_size, none);
        if let Some(levels) = levels {
            particles.set_levels(levels);
        }
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
    /// Return the totals of the body, not of its particles; only their number if its motion is prescribed.
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
        self.for_each_with(Parts::ALL, visit);
    }
    fn for_each_with(&self, parts: Parts, visit: &mut dyn FnMut(&PointView)) {
        self.particles.for_each_with(parts, &mut |p| {
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
    fn density_tiles(&self, team: &Team) -> Vec<Tile<D>> {
        self.particles.density_tiles(team)
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
        // Bodies with prescribed motion have no centre lead.
        let force = if self.state.is_prescribed() { [0.0; 3] } else { dt.force };
        self.particles.pass(which, nodes, Steps { force, ..dt }, team)
    }
    fn loading(&self) -> Loading {
        self.particles.loading()
    }
    fn locate(&mut self, which: Which, prune: bool, team: &Team) -> bool {
        self.particles.locate(which, prune, team)
    }
    fn set_levels(&mut self, levels: &Arc<Levels<D>>) {
        self.particles.set_levels(levels);
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
