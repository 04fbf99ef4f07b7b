//! Weakly compressible liquids: what they are where no option of the method says otherwise.
//!
//! A liquid by `fluid.tait` in a scene without `for` and without `parts` has quadratic B-splines with APIC, a density that is renewed
//! from positions ([`Deformable::with_renewed_density`](impactite::mpm::Deformable::with_renewed_density)) and, under gravity, the
//! pressure of an incompressible liquid at the first instant: else its column would fall by g H^2 / (2 c^2) and ring.

use std::collections::HashMap;

use impactite::flow::{Flow, FlowOptions, Fluid, Wall};
use impactite::geometry::{HalfSpace, Lattice, Seeds};
use impactite::materials::Material;
use impactite::mpm::{Boundary, Side, TimeControl};
use impactite::scene::BoundaryEntry;

use super::common::World;
use super::seeds::{Cells, seeds};
use super::stressed;
use super::wrong::{At, Made};
use crate::formula::Formula;
use crate::model::body::Body;
use crate::model::condition::Condition;
use crate::model::material::{FluidLaw, Library, TaitConstants};
use crate::model::method::{Mpm, Purpose};
use crate::model::{Axis, SceneFile};

/// Largest distance of a plane of nodes from a node, in cells.
const ON_NODE: f64 = 1e-6;
/// Step of the first pressure over the time in which gravity moves the liquid by a cell.
const INSTANT: f64 = 1e-6;

/// Constants of the weakly compressible liquid of a body, if its density is renewed.
pub(crate) fn renewed<'a>(scene: &'a SceneFile, options: &Mpm, body: &Body) -> Option<&'a TaitConstants> {
    if options.parts.is_some()
        || options.purpose.is_some()
        || body.elements.is_some()
        || body.split_at.is_some()
    {
        return None;
    }
    match &scene.materials.get(body.material.as_ref()?)?.fluid {
        Some(FluidLaw::Tait(tait)) => Some(tait),
        _ => None,
    }
}

/// Options of the method with the purpose of liquids, if the scene has one whose density is renewed.
pub(super) fn options(scene: &SceneFile, options: &Mpm) -> Mpm {
    let any = scene.expanded.values().any(|body| renewed(scene, options, body).is_some());
    let mut chosen = options.clone();
    if any {
        chosen.purpose = Some(Purpose::ContactAtRest);
    }
    chosen
}

/// True if a scene has nothing that moves but liquids whose density is renewed, and bodies with prescribed motion.
fn alone(scene: &SceneFile, options: &Mpm) -> bool {
    let bodies = || scene.bodies.values();
    bodies().any(|b| renewed(scene, options, b).is_some())
        && bodies().all(|b| match &b.rigid {
            Some(rigid) => rigid.prescribed,
            None => renewed(scene, options, b).is_some(),
        })
}

/// Return the condition as liquids have it: a wall at rest on a plane of nodes is a plane of symmetry. Beside walls that let go, the
/// pressure of the outermost rows is wrong by up to half of that at the floor.
pub(super) fn bounding<const D: usize>(
    scene: &SceneFile,
    options: &Mpm,
    lattice: &Lattice<D>,
    entry: BoundaryEntry<D>,
) -> BoundaryEntry<D> {
    let &Boundary::Wall { axis, at, .. } = entry.boundary() else { return entry };
    let node = (at - lattice.origin()[axis]) / lattice.spacing();
    if (node - node.round()).abs() <= ON_NODE && alone(scene, options) { entry.as_symmetry() } else { entry }
}

/// Keys of conditions and bodies beside which the pressure of a liquid is wrong: fixed planes, rigid bodies, and walls with friction, that
/// move, or between nodes.
pub(crate) fn poor_walls(scene: &SceneFile, options: &Mpm) -> Vec<String> {
    if !scene.bodies.values().any(|b| renewed(scene, options, b).is_some()) {
        return Vec::new();
    }
    let origin = |axis: Axis| {
        let number = scene.space.axis(axis).unwrap_or(0);
        options.origin.as_ref().and_then(|list| list.get(number)).map_or(0.0, |x| x.value)
    };
    let poor = |condition: &Condition| {
        let Condition::Wall(wall) = condition else { return false };
        let node = (wall.at.value - origin(wall.axis)) / options.cell.value;
        let still =
            wall.velocity.as_ref().is_none_or(|list| list.iter().all(|v| v.as_constant() == Some(0.0)));
        !(still && wall.position.is_none() && wall.friction.is_none())
            || (node - node.round()).abs() > ON_NODE
            || !alone(scene, options)
    };
    let list = scene.conditions.iter().enumerate().filter_map(|(n, condition)| match condition {
        Condition::Fixed(_) => Some(format!("conditions[{n}].fixed")),
        condition => poor(condition).then(|| format!("conditions[{n}].wall")),
    });
    let rigid = scene.bodies.iter().filter(|(_, body)| body.rigid.is_some());
    list.chain(rigid.map(|(name, _)| format!("bodies.{name}.rigid"))).collect()
}

/// Pressures at the first instant by position, Pa.
#[derive(Default)]
pub(super) struct Pressures {
    at: HashMap<Vec<u64>, f64>,
}

impl Pressures {
    /// Return the pressure of a particle, Pa.
    pub(super) fn of<const D: usize>(&self, x: &[f64; D]) -> Option<f64> {
        self.at.get(&place(x)).copied()
    }
    /// True if no pressure is known.
    pub(super) fn is_empty(&self) -> bool {
        self.at.is_empty()
    }
}

fn place<const D: usize>(x: &[f64; D]) -> Vec<u64> {
    x.iter().map(|x| x.to_bits()).collect()
}

/// Why the liquids of a scene start without pressure; nothing where they have one, or no weight.
pub(crate) fn without_pressure(scene: &SceneFile, options: &Mpm) -> Option<&'static str> {
    let liquids = || scene.bodies.values().filter_map(|body| renewed(scene, options, body));
    let first = liquids().next()?;
    scene.gravity.as_ref()?;
    if scene.space == crate::model::Space::Axisymmetric {
        return Some("in axisymmetric scenes");
    }
    if scene.bodies.values().any(|b| b.rigid.is_none() && renewed(scene, options, b).is_none()) {
        return Some("beside deformable bodies");
    }
    if scene.bodies.values().any(|b| b.rigid.as_ref().is_some_and(|rigid| !rigid.prescribed)) {
        return Some("beside rigid bodies that it moves");
    }
    if liquids().any(|other| other.density.value != first.density.value) {
        return Some("of several densities");
    }
    None
}

/// True for a body of a liquid, of which smoothed particles have a method of its own.
pub(crate) fn smoothed(scene: &SceneFile, body: &Body) -> bool {
    let material = body.material.as_ref().and_then(|name| scene.materials.get(name));
    material.is_some_and(|spec| {
        matches!(spec.fluid, Some(FluidLaw::Tait(_) | FluidLaw::MieGruneisen(_)))
            || matches!(spec.library, Some(Library::Water | Library::WaterShocked))
    })
}

/// Why liquids of smoothed particles start without pressure; nothing where they have one, or no weight.
pub(crate) fn smoothed_without_pressure(scene: &SceneFile) -> Option<&'static str> {
    let first = scene.bodies.values().find(|body| smoothed(scene, body))?;
    scene.gravity.as_ref()?;
    if scene.space == crate::model::Space::Axisymmetric {
        return Some("in axisymmetric scenes");
    }
    if scene.bodies.values().any(|body| !smoothed(scene, body)) {
        return Some("beside deformable bodies");
    }
    if scene.bodies.values().any(|body| body.material != first.material) {
        return Some("of several materials");
    }
    let period = scene.conditions.iter().find_map(|condition| match condition {
        Condition::Periodic(period) => scene.space.axis(period.axis).ok(),
        _ => None,
    });
    // A force along a period drives the liquid, and has no pressure.
    let across = |axis: usize| {
        let part = |(n, g): (usize, &Formula<_>)| n != axis && g.as_constant() != Some(0.0);
        scene.gravity.iter().flatten().enumerate().any(part)
    };
    if period.is_some_and(across) {
        return Some("between periodic planes");
    }
    None
}

/// Compute the pressures of liquids of smoothed particles at the first instant, on cells of twice their distance.
pub(super) fn pressures_of_smoothed<const D: usize>(
    world: &World<'_, D>,
    cells: &Cells<'_, D>,
) -> Made<Pressures> {
    let scene = world.scene;
    let periodic = |condition: &Condition| matches!(condition, Condition::Periodic(_));
    if scene.conditions.iter().any(periodic)
        || !scene.bodies.values().any(|body| smoothed(scene, body))
        || smoothed_without_pressure(scene).is_some()
    {
        return Ok(Pressures::default());
    }
    let lattice = Lattice::new([0.0; D], 2.0 * cells.lattice.spacing()).at(cells.key)?;
    let planes: Vec<Boundary<D>> =
        world.conditions()?.iter().map(|(_, entry)| entry.boundary().clone()).collect();
    let mut liquids = Vec::new();
    for (name, body) in &scene.expanded {
        liquids.push((name.as_str(), body, world.law(&format!("bodies.{name}"), body)?.material.density()));
    }
    first_pressures(world, &lattice, &planes, liquids.into_iter(), cells)
}

/// Compute the pressure of liquids of the material point method in the first instant.
pub(super) fn pressures<const D: usize>(
    world: &World<'_, D>,
    options: &Mpm,
    lattice: &Lattice<D>,
    boundaries: &[Boundary<D>],
) -> Made<Pressures> {
    let scene = world.scene;
    let liquids = || {
        let of = |b| Some(renewed(scene, options, b)?.density.value);
        scene.expanded.iter().filter_map(move |(n, b)| Some((n.as_str(), b, of(b)?)))
    };
    if liquids().next().is_none() || without_pressure(scene, options).is_some() {
        return Ok(Pressures::default());
    }
    let cells =
        Cells { lattice, parts: options.particles_per_cell as usize, key: "method.mpm.cell", halvings: 0 };
    first_pressures(world, lattice, boundaries, liquids(), &cells)
}

/// Compute the pressure of incompressible liquids at rest in the first instant, with planes and prescribed rigid bodies as walls. `liquids`
/// are names, bodies and densities, kg/m^3, whose particles are in `cells`.
fn first_pressures<'a, const D: usize>(
    world: &World<'_, D>,
    lattice: &Lattice<D>,
    boundaries: &[Boundary<D>],
    liquids: impl Iterator<Item = (&'a str, &'a Body, f64)>,
    cells: &Cells<'_, D>,
) -> Made<Pressures> {
    let scene = world.scene;
    let mut found = Pressures::default();
    let Some(gravity) = world.gravity()? else { return Ok(found) };
    let weight = gravity(0.0);
    let size = weight.iter().map(|g| g * g).sum::<f64>().sqrt();
    if size == 0.0 {
        return Ok(found);
    }
    let key_of_method = cells.key;
    let mut made = FlowOptions::new(*lattice).density_correction(0.0).at(key_of_method)?;
    for boundary in boundaries {
        if let Boundary::Periodic { axis, low, high } = *boundary {
            let cells = ((high - low) / lattice.spacing()).round().max(0.0) as usize;
            made = made.periodic(axis, cells).at("conditions")?;
        }
    }
    let mut flow = Flow::new(made);
    for boundary in boundaries {
        let (axis, at, side) = match *boundary {
            Boundary::Symmetry { axis, at, side }
            | Boundary::Fixed { axis, at, side }
            | Boundary::Wall { axis, at, side, .. }
            | Boundary::FrictionWall { axis, at, side, .. } => (axis, at, side),
            _ => continue,
        };
        let (mut outward, mut point) = ([0.0; D], [0.0; D]);
        outward[axis] = if side == Side::Above { 1.0 } else { -1.0 };
        point[axis] = at;
        flow.add_wall(Wall::solid(HalfSpace::new(point, outward).at("conditions")?)).at("conditions")?;
    }
    for (name, body) in scene.expanded.iter().filter(|(_, b)| b.rigid.is_some()) {
        let key = format!("bodies.{name}");
        flow.add_wall(Wall::solid(world.shape(&key, body)?)).at(&key)?;
    }
    let mut positions: Vec<[f64; D]> = Vec::new();
    for (name, body, density) in liquids {
        let key = format!("bodies.{name}");
        let seeds: Seeds<D> = seeds(world, &key, body, cells)?;
        let fluid = Fluid::new(density).at(&key)?;
        flow.add_fluid(name, fluid, &seeds, |_| [0.0; D]).at(&key)?;
        positions.extend_from_slice(&seeds.positions);
    }
    flow.set_body_force(move |_| weight);
    let step = INSTANT * (lattice.spacing() / size).sqrt();
    flow.set_time_control(TimeControl::Fixed(step)).at(key_of_method)?;
    flow.run_until(step).at("gravity")?;
    // Points are sorted by body and number, as positions are.
    for (x, point) in positions.iter().zip(flow.points()) {
        found.at.insert(place(x), point.pressure());
    }
    Ok(found)
}

/// State vectors of a law by position, m.
pub(super) type States<'a, const D: usize> = Box<dyn Fn([f64; D]) -> Vec<f64> + 'a>;

/// Return the states of a liquid under its pressures at the start.
pub(super) fn states<'a, const D: usize>(
    key: &str,
    material: &'a dyn Material<f64>,
    positions: &[[f64; D]],
    pressures: &'a Pressures,
) -> Made<States<'a, D>> {
    let stress = move |x: &[f64; D]| {
        let p = pressures.of(x).unwrap_or(0.0);
        [-p, -p, -p, 0.0, 0.0, 0.0]
    };
    for x in positions {
        stressed::state(material, &stress(x)).at(key)?;
    }
    Ok(Box::new(move |x| stressed::state(material, &stress(&x)).unwrap_or_else(|_| material.virgin())))
}
