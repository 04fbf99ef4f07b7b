//! Bodies of smoothed particles, and the scenes that bodies of particles are members of.

use impactite::contact::SurfaceDistance;
use impactite::contact::particles::{Bodies, ParticleBody};
use impactite::scene::Solver;
use impactite::sph::{Composition, Layout, Sph as SphBody};

use super::common::World;
use super::conditions::loads;
use super::liquid::{self, Pressures};
use super::seeds::{Cells, seeds};
use super::wrong::{At, Made, of_body};
use super::{placement, stressed};
use crate::model::method::Sph;

/// Scene of bodies of particles, or the only body as its own solver.
pub(super) enum Members<'a, const D: usize> {
    /// The only body.
    Alone(&'a mut Option<Box<dyn Solver>>),
    /// One of several bodies.
    Among(&'a mut Bodies<D, SurfaceDistance>),
}

impl<const D: usize> Members<'_, D> {
    /// Add a body.
    pub(super) fn add(&mut self, name: &str, body: impl ParticleBody<D> + Solver) {
        match self {
            Members::Alone(solver) => **solver = Some(Box::new(body)),
            Members::Among(bodies) => {
                bodies.add(name, body);
            }
        }
    }
}

/// Body of smoothed particles to build.
pub(super) struct Smoothed<'a, const D: usize> {
    pub(super) world: &'a World<'a, D>,
    pub(super) options: &'a Sph,
    pub(super) cells: &'a Cells<'a, D>,
    /// Pressures of liquids at the start.
    pub(super) pressures: &'a Pressures,
    pub(super) name: &'a str,
}

impl<const D: usize> Smoothed<'_, D> {
    /// Build the body by a method, with its conditions and loads.
    pub(super) fn add<M: Composition<D>>(&self, method: M, members: &mut Members<'_, D>) -> Made<()> {
        let Smoothed { world, options, cells, pressures, name } = *self;
        let (key, spec) = (format!("bodies.{name}"), &world.scene.expanded[name]);
        let seeds = seeds(world, &key, spec, cells)?;
        let velocity = world.velocity(&key, spec, || Ok(seeds.centroid()))?;
        let law = world.law(&key, spec)?.material;
        let body = SphBody::new(method, law.clone(), &Layout::of_seeds(&seeds), move |x| velocity(x));
        let mut body = body.map_err(|e| of_body(&key, e))?.named(name);
        placement::check_planes(world, &body)?;
        for (key, boundary) in world.conditions()? {
            body.bound(boundary).at(key)?;
        }
        if let Some(gravity) = world.gravity()? {
            body.set_body_force(gravity);
        }
        if let Some(stress) = &spec.initial_stress {
            let key = format!("{key}.initial_stress");
            let states = stressed::states(world, &key, stress, &*law, &seeds.positions)?;
            body.set_numbers(|x, state| state.copy_from_slice(&states(x))).at(&key)?;
        } else if !pressures.is_empty() {
            let states = liquid::states(&key, &*law, &seeds.positions, pressures)?;
            body.set_numbers(|x, state| state.copy_from_slice(&states(x))).at(&key)?;
        }
        for (key, load) in spec.traction.keyed(&format!("{key}.traction")) {
            let load = world.traction_on_particles(&key, load)?;
            loads::loaded(&format!("{key}.region"), &load, &seeds.positions)?;
            let areas = seeds.positions.iter().map(|x| load.area(x, &seeds.half_size)).collect();
            body.load(areas, load.history).at(key)?;
        }
        if let Some(part) = options.local_damping {
            body.set_local_damping(part.value).at("method.sph.local_damping")?;
        }
        if let Some(control) = world.time_control() {
            body.set_time_control(control).at("time_step")?;
        }
        body.set_watch(world.watch());
        members.add(name, body);
        Ok(())
    }
}
