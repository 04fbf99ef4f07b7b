//! Scenes of the finite element method.

use impactite::fem::{Fem as Scene, SurfaceFacet};
use impactite::scene::{SceneError, Solver};

use super::common::World;
use super::conditions::loads::{Load, Part, Surface};
use super::kernels::Setting;
use super::wrong::{At, Made, known, of_body, wrong};
use super::{mesh, placement};
use crate::model::body::Traction;
use crate::model::contact::Detector;
use crate::model::method::{Fem, SUBCYCLES};

/// Apply a load to the surface of a body.
pub(super) fn load<const D: usize>(
    world: &World<'_, D>,
    fem: &mut Scene<D>,
    number: usize,
    key: &str,
    spec: &Traction,
) -> Made<()> {
    let Surface { part, axis, load } = world.load(key, spec)?;
    let across = |facet: &SurfaceFacet<D>| axis.is_none_or(|axis| facet.normal[axis].abs() > 0.5);
    let normal = axis.map_or(String::new(), |axis| format!(" across axis {axis}"));
    match part {
        Part::Region(region) => {
            let picked = |facet: &SurfaceFacet<D>| across(facet) && region.contains(facet.centre);
            let key = format!("{key}.region");
            apply(fem, number, &format!("faces{normal} in a region"), picked, load).at(key)?;
        }
        Part::Named(name) => {
            let key = format!("{key}.surface");
            let sets = &fem.body(number).mesh().node_sets;
            let alike = || sets.keys().find(|set| set.eq_ignore_ascii_case(&name));
            let there = sets.keys().map(String::as_str);
            let place = match sets.get_key_value(&name).map(|(set, _)| set).or_else(alike) {
                Some(set) => set.clone(),
                None => {
                    known(&key, "surface", &name, there)?;
                    name.clone()
                }
            };
            let nodes = sets.get(&place).cloned().unwrap_or_default();
            let within = |node: &u32| nodes.binary_search(node).is_ok();
            let picked = |facet: &SurfaceFacet<D>| across(facet) && facet.nodes.iter().flatten().all(within);
            apply(fem, number, &format!("faces{normal} of `{place}`"), picked, load).at(key)?;
        }
    }
    Ok(())
}

/// Apply a load over time to the picked facets.
fn apply<const D: usize>(
    fem: &mut Scene<D>,
    number: usize,
    facets: &str,
    picked: impl Fn(&SurfaceFacet<D>) -> bool,
    load: Load<D>,
) -> Result<usize, SceneError> {
    match load {
        Load::Traction(history) => fem.load(number, facets, picked, history),
        Load::Pressure(history) => fem.press(number, facets, picked, history),
    }
}

pub(super) fn build<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Fem,
) -> Made<Box<dyn Solver>> {
    let mut fem = Scene::new(embedding);
    let names: Vec<&str> = world.scene.expanded.keys().map(String::as_str).collect();
    for (name, body) in &world.scene.expanded {
        let number =
            fem.add(mesh::body(world, name, body)?).map_err(|e| of_body(&format!("bodies.{name}"), e))?;
        for (key, load) in body.traction.keyed(&format!("bodies.{name}.traction")) {
            self::load(world, &mut fem, number, &key, load)?;
        }
    }
    if world.scene.contact().is_some_and(|c| c.detector != Detector::default()) {
        return wrong("contact.detector", "of elements nodes meet facets: there is nothing to choose");
    }
    match world.laws(&names)? {
        Some(laws) => fem.touch(laws).at("contact")?,
        None if !options.touch_themselves.is_empty() => {
            return wrong("method.fem.touch_themselves", "the scene needs a `contact`");
        }
        None => {}
    }
    for (n, name) in options.touch_themselves.iter().enumerate() {
        let key = format!("method.fem.touch_themselves[{n}]");
        fem.touch_itself(known(&key, "body", name, names.iter().copied())?).at(key)?;
    }
    placement::check_planes(world, &fem)?;
    for (key, boundary) in world.conditions()? {
        fem.bound(boundary).at(key)?;
    }
    if let Some(gravity) = world.gravity()? {
        fem.set_body_force(gravity);
    }
    fem.set_subcycling(options.subcycles.unwrap_or(SUBCYCLES)).at("method.fem.subcycles")?;
    if let Some(part) = options.local_damping {
        fem.set_local_damping(part.value).at("method.fem.local_damping")?;
    }
    if let Some(control) = world.time_control() {
        fem.set_time_control(control).at("time_step")?;
    }
    fem.set_watch(world.watch());
    Ok(Box::new(fem))
}
