//! Scenes of the finite element method.

use impactite::fem::{Fem as Scene, SurfaceFacet};
use impactite::scene::Solver;

use super::common::{Surface, World};
use super::kernels::Setting;
use super::wrong::{At, Made, known, of_body, wrong};
use super::{mesh, placement};
use crate::model::contact::Detector;
use crate::model::method::{Fem, SUBCYCLES};

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
            let Surface { region, axis, history } = world.load(&key, load)?;
            let picked =
                |facet: &SurfaceFacet<D>| facet.normal[axis].abs() > 0.5 && region.contains(facet.centre);
            fem.load(number, &format!("faces across axis {axis} in a region"), picked, history)
                .at(format!("{key}.region"))?;
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
