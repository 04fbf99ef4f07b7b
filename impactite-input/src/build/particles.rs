//! Scenes of smoothed particles and of the particle-contact meshfree method.

use std::sync::Arc;

use impactite::contact::SurfaceDistance;
use impactite::contact::particles::Bodies;
use impactite::geometry::{Lattice, Shape, sampled_measure};
use impactite::pcmm::{LocalDelaunay, Masses, Method as PcmmMethod, Packing, Pcmm as PcmmBody};
use impactite::scene::{SceneError, Solver};
use impactite::sph::Method as SphMethod;

use super::common::{World, centre_of_mass};
use super::kernels::Setting;
use super::liquid;
use super::material::Velocity;
use super::placement;
use super::seeds::Cells;
use super::shape::MovedBox;
use super::smoothed::{Members, Smoothed};
use super::wrong::{At, Made, Wrong, of_body, wrong};
use crate::model::condition::Condition;
use crate::model::contact::Detector;
use crate::model::method::{Pcmm, STRETCH, Sph, SphForm, TOLERANCES};
use crate::model::shape::Shape as Spec;

/// Build all bodies of a scene of particles; a single body without contact is its own solver.
///
/// `add` adds the body of a name with its conditions and loads.
pub(super) fn scene<const D: usize>(
    world: &World<'_, D>,
    mut add: impl FnMut(&str, &mut Members<'_, D>) -> Made<()>,
) -> Made<Box<dyn Solver>> {
    let names: Vec<&str> = world.scene.expanded.keys().map(String::as_str).collect();
    let laws = world.laws(&names)?;
    if let ([name], None) = (&names[..], &laws) {
        let mut solver = None;
        add(name, &mut Members::Alone(&mut solver))?;
        return solver.ok_or_else(|| Wrong {
            key: format!("bodies.{name}"),
            message: "was not built".into(),
            help: None,
        });
    }
    let Some(laws) = laws else {
        return wrong("bodies", "several bodies need a `contact`, or they would pass through each other");
    };
    if world.scene.contact().is_some_and(|c| c.detector != Detector::default()) {
        return wrong(
            "contact.detector",
            "bodies of particles meet by `surface_distance`: no other detector is compiled for them",
        );
    }
    let mut bodies = Bodies::new(SurfaceDistance::default(), laws);
    for name in names {
        add(name, &mut Members::Among(&mut bodies))?;
    }
    if let Some(control) = world.time_control() {
        bodies.set_time_control(control).at("time_step")?;
    }
    bodies.set_watch(world.watch());
    Ok(Box::new(bodies))
}

pub(super) fn sph<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Sph,
) -> Made<Box<dyn Solver>> {
    let lattice = Lattice::new([0.0; D], options.spacing.value).at("method.sph.spacing")?;
    let cells = Cells { lattice: &lattice, parts: 1, key: "method.sph.spacing", halvings: 0 };
    let periodic =
        |condition: &Condition| matches!(condition, Condition::Periodic(_)) && world.scene.expanded.len() > 1;
    if let Some(n) = world.scene.conditions.iter().position(periodic) {
        let message = "goes with one body: contact of smoothed particles does not reach across it";
        return wrong(format!("conditions[{n}].periodic"), message);
    }
    let pressures = liquid::pressures_of_smoothed(world, &cells)?;
    scene(world, |name, members| {
        let of = Smoothed { world, options, cells: &cells, pressures: &pressures, name };
        let spec = &world.scene.expanded[name];
        match (liquid::smoothed(world.scene, spec), options.form) {
            (true, None | Some(SphForm::Updated)) => of.add(SphMethod::liquid(embedding), members),
            (false, Some(SphForm::Updated)) => of.add(SphMethod::updated(embedding), members),
            (_, None | Some(SphForm::TotalLagrangian)) => {
                of.add(SphMethod::total_lagrangian(embedding), members)
            }
        }
    })
}

pub(super) fn pcmm<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Pcmm,
) -> Made<Box<dyn Solver>> {
    let spacing = options.spacing.value;
    let tolerance = options.tolerance.map_or(TOLERANCES[usize::from(D == 3)], |q| q.value);
    let stretch = options.stretch.map_or(STRETCH, |q| q.value);
    let lattice = Lattice::new([0.0; D], spacing).at("method.pcmm.spacing")?;
    scene(world, |name, members| {
        let (key, spec) = (format!("bodies.{name}"), &world.scene.expanded[name]);
        let shape = world.shape(&key, spec)?;
        let law = world.law(&key, spec)?.material;
        let delaunay = LocalDelaunay::new(tolerance * spacing, stretch).at("method.pcmm")?;
        let method = PcmmMethod::consistent(embedding, delaunay);
        let body = |packing: &Packing<D>, velocity: Velocity<D>, masses| {
            PcmmBody::new(method, law.clone(), packing, move |x| velocity(x), masses)
        };
        let still: Velocity<D> = Arc::new(|_| [0.0; D]);
        let placed = match nodes_of_box(spec.shape.as_ref(), &lattice) {
            Some(packing) => Ok((packing, Masses::FromElements)),
            None if spec.shape.as_ref().is_some_and(|s| MovedBox::<D>::of(s).is_some()) => {
                Packing::on_nodes(&*shape, &lattice).map(|packing| (packing, Masses::FromElements))
            }
            None => fitted(&*shape, &lattice, |packing| body(packing, still.clone(), Masses::FromElements)),
        };
        let (mut packing, mut masses) = placed.map_err(|e| of_body(&format!("{key}.shape"), e))?;
        if !packing.volumes.is_empty() {
            let volume = match world.metric().measure(&*shape) {
                Some(volume) => volume,
                None => {
                    sampled_measure(&*shape, world.metric(), 0.125 * spacing).at(format!("{key}.shape"))?
                }
            };
            let covered: f64 = packing.volumes.iter().sum();
            packing.volumes.iter_mut().for_each(|v| *v *= volume / covered);
            masses = Masses::FromVolumes;
        }
        let of = |velocity: Velocity<D>| -> Made<PcmmBody<D, _>> {
            body(&packing, velocity, masses).map_err(|e| of_body(&key, e))
        };
        // The masses of particles are those of their elements, which the body has to have.
        let velocity = world.velocity(&key, spec, || {
            let mut masses = Vec::new();
            for body in of(Arc::new(|_| [0.0; D]))?.bodies() {
                body.for_each(&mut |p| masses.push((std::array::from_fn(|d| p.position[d]), p.mass)));
            }
            Ok(centre_of_mass(masses.into_iter()))
        })?;
        let mut body = of(velocity)?.named(name);
        placement::check_planes(world, &body)?;
        for (key, boundary) in world.conditions()? {
            body.bound(boundary).at(key)?;
        }
        if let Some(gravity) = world.gravity()? {
            body.set_body_force(gravity);
        }
        if let Some(control) = world.time_control() {
            body.set_time_control(control).at("time_step")?;
        }
        body.set_watch(world.watch());
        members.add(name, body);
        Ok(())
    })
}

/// Pack the particles of a shape up to its surface, without those that belong to no element of its body, with the masses of
/// their elements as volumes, which the caller scales to the volume of the shape.
fn fitted<const D: usize, B: Solver>(
    shape: &dyn Shape<D>,
    lattice: &Lattice<D>,
    body: impl Fn(&Packing<D>) -> Result<B, SceneError>,
) -> Result<(Packing<D>, Masses), SceneError> {
    let mut packing = Packing::fitted(shape, lattice)?;
    let made = loop {
        match body(&packing) {
            Err(SceneError::NoMass { particle, .. }) if particle < packing.positions.len() => {
                packing.positions.remove(particle);
                packing.radii.remove(particle);
            }
            made => break made?,
        }
    };
    for of_body in made.bodies() {
        of_body.for_each(&mut |p| packing.volumes.push(p.mass));
    }
    Ok((packing, Masses::FromElements))
}

/// Pack the particles of a box from face to face, with the best-fitting count along each axis, if its faces are not on lattice nodes.
fn nodes_of_box<const D: usize>(spec: Option<&Spec>, lattice: &Lattice<D>) -> Option<Packing<D>> {
    let cuboid = MovedBox::<D>::of(spec?)?;
    let (low, high) = (&cuboid.low, &cuboid.high);
    let sites = |x: f64, d: usize| (x - lattice.origin()[d]) / lattice.spacing();
    let on = |x: f64, d: usize| (sites(x, d) - sites(x, d).round()).abs() <= 1e-6;
    let counts: [f64; D] = std::array::from_fn(|d| ((high[d] - low[d]) / lattice.spacing()).round());
    let aligned = cuboid.along_axes() && (0..D).all(|d| on(low[d], d) && on(high[d], d));
    if aligned || counts.iter().any(|n| !(1.0..1e9).contains(n)) || counts.iter().product::<f64>() > 1e8 {
        return None;
    }
    let edges: [f64; D] = std::array::from_fn(|d| (high[d] - low[d]) / counts[d]);
    let rows = counts.map(|n| n as usize + 1);
    let mut positions = Vec::new();
    for site in 0..rows.iter().product() {
        let (mut x, mut rest) = ([0.0; D], site);
        for d in (0..D).rev() {
            x[d] = low[d] + (rest % rows[d]) as f64 * edges[d];
            rest /= rows[d];
        }
        positions.push(cuboid.place(x));
    }
    let radius = 0.5 * edges.iter().fold(f64::INFINITY, |least, edge| least.min(*edge));
    let radii = vec![radius; positions.len()];
    Some(Packing { positions, radii, volumes: Vec::new(), surface: 0.0 })
}
