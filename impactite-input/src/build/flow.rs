//! Scenes of incompressible flow with a free surface.

use std::sync::Arc;

use impactite::coupling::{ElementsInLiquid, ParticlesInLiquid};
use impactite::fem::Fem;
use impactite::flow::{Flow as Scene, FlowOptions, Fluid, RigidBody, SemiStaggered, Wall};
use impactite::geometry::{Facets, HalfSpace, Lattice, Shape};
use impactite::scene::{Embedding, Solver};

use super::common::{Acting, World};
use super::conditions::accounts;
use super::fem::load;
use super::kernels::Setting;
use super::kinds::is_solid;
use super::seeds::{Cells, seeds};
use super::wrong::{At, Made, Wrong, of_body, wrong};
use super::{material, mesh, mpm, placement};
use crate::formula::Formula;
use crate::model::SceneFile;
use crate::model::body::{Body, Mesh};
use crate::model::condition::{Condition, Plane, Side};
use crate::model::formulas;
use crate::model::material::{FluidLaw, Library, Material};
use crate::model::method::{Flow, Method, Purpose, SemiStaggered as Shares};
use crate::quantity::Speed;

/// Nodes, on (-1, 1), and weights of Gauss's quadrature of four points.
const GAUSS: [[f64; 2]; 4] = [
    [-0.861_136_311_594_052_6, 0.347_854_845_137_453_86],
    [-0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_86],
];
/// Edge of a facet of the surface of particles in the liquid, in their cells.
const FACET: f64 = 0.5;
/// Number of intervals of a run by which a velocity over time is integrated.
const INTERVALS: usize = 4096;

/// Displacement over time, m.
type Displacement<const D: usize> = Arc<dyn Fn(f64) -> [f64; D] + Send + Sync>;

/// Parameters of the semi-staggered scheme at this key.
fn semi_staggered(key: &str, given: &Shares) -> Made<SemiStaggered> {
    let mut made = SemiStaggered::default();
    if let Some(share) = given.hourglass {
        made = made.with_hourglass(share.value).at(format!("{key}.hourglass"))?;
    }
    if let Some(share) = given.pic {
        made = made.with_pic(share.value).at(format!("{key}.pic"))?;
    }
    Ok(made)
}

pub(super) fn build<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Flow,
) -> Made<Box<dyn Solver>> {
    let key = "method.flow";
    if !(1..=8).contains(&options.particles_per_cell) {
        let message = format!("{} is not allowed; it must be 1 to 8", options.particles_per_cell);
        return wrong(format!("{key}.particles_per_cell"), message);
    }
    refuse_what_is_not_read(world)?;
    let lattice = Lattice::new(origin(world)?, options.cell.value).at(format!("{key}.cell"))?;
    let mut made = FlowOptions::new(lattice);
    if let Some(share) = options.density_correction {
        made = made.density_correction(share.value).at(format!("{key}.density_correction"))?;
    }
    if let Some(scheme) = &options.semi_staggered {
        if options.density_correction.is_some() {
            return wrong(
                format!("{key}.density_correction"),
                "is not available with `semi_staggered`, which corrects no density; leave it out",
            );
        }
        made = made.semi_staggered(semi_staggered(&format!("{key}.semi_staggered"), scheme)?);
    }
    let mut periods = [false; D];
    for (n, condition) in world.scene.conditions.iter().enumerate() {
        if let Condition::Periodic(period) = condition {
            let key = format!("conditions[{n}].periodic");
            let axis = world.space().axis(period.axis).at(format!("{key}.axis"))?;
            if std::mem::replace(&mut periods[axis], true) {
                return wrong(key, "the axis has a period already");
            }
            let cells = (period.high.value - period.low.value) / options.cell.value;
            if (cells - cells.round()).abs() > 1e-6 * cells.abs().max(1.0) {
                return wrong(key, format!("the period is {cells} cells; it must be a multiple of 4 cells"));
            }
            made = made.periodic(axis, cells.round().max(0.0) as usize).at(key)?;
        }
    }
    let mut flow = Scene::new(made);
    for (n, condition) in world.scene.conditions.iter().enumerate() {
        if let Some(wall) = wall(world, &format!("conditions[{n}]"), condition)? {
            flow.add_wall(wall).at(format!("conditions[{n}]"))?;
        }
    }
    let cells = Cells {
        lattice: &lattice,
        parts: options.particles_per_cell as usize,
        key: "method.flow.cell",
        halvings: 0,
    };
    if let Some(elements) = elements(embedding, world)? {
        let key = if periods.contains(&true) { "conditions" } else { "method.flow.cell" };
        flow.add_deformable(ElementsInLiquid::new(elements)).at(key)?;
    }
    if let Some(particles) = particles(embedding, world, options)? {
        let key = if periods.contains(&true) { "conditions" } else { "method.flow.cell" };
        flow.add_deformable(particles).at(key)?;
    }
    for (name, body) in &world.scene.expanded {
        let key = format!("bodies.{name}");
        if body.mesh.is_some() || is_submerged(world.scene, body) {
            continue;
        }
        if let Some(spec) = &body.rigid {
            if spec.prescribed {
                flow.add_wall(solid(world, &key, body)?).at(&key)?;
            } else {
                let rigid = afloat(world, &key, body)?;
                flow.add_rigid(name, rigid).at(format!("{key}.rigid"))?;
            }
            continue;
        }
        let fluid = fluid(world, &key, body)?;
        let seeds = seeds(world, &key, body, &cells)?;
        let velocity = world.velocity(&key, body, || Ok(seeds.centroid()))?;
        flow.add_fluid(name, fluid, &seeds, |x| velocity(x)).map_err(|e| of_body(&key, e))?;
    }
    if let Some((name, field)) = field(world)? {
        flow.set_force_field(move |x, t| field(&x, t));
        flow.check_force_field().at(format!("bodies.{name}.body_force"))?;
    }
    placement::check_planes(world, &flow)?;
    flow.check_scheme().at(format!("{key}.semi_staggered"))?;
    if let Some(gravity) = world.gravity()? {
        flow.set_body_force(move |t| gravity(t));
    }
    if let Some(control) = world.time_control() {
        flow.set_time_control(control).at("time_step")?;
    }
    flow.set_watch(world.watch());
    Ok(Box::new(flow))
}

/// Body force of the liquid by place and time, m/s^2, and the body that has it first; none without a `body_force`. All bodies of liquid have the
/// same one.
fn field<'a, const D: usize>(world: &World<'a, D>) -> Made<Option<(&'a str, Acting<D>)>> {
    let liquids =
        world.scene.expanded.iter().filter(|(_, body)| {
            body.mesh.is_none() && body.rigid.is_none() && !is_submerged(world.scene, body)
        });
    let mut first: Option<(&str, &Body)> = None;
    for (name, body) in liquids {
        match first {
            None => first = Some((name, body)),
            Some((other, of)) if !have_same_force(of, body) => {
                let key = format!("bodies.{name}.body_force");
                return wrong(&key, format!("is that of all liquid: write the same for `bodies.{other}`"));
            }
            _ => {}
        }
    }
    let Some((name, body)) = first else { return Ok(None) };
    let force = world.body_force(&format!("bodies.{name}"), body)?;
    Ok(force.map(|force| (name, force)))
}

/// True if both bodies have the same `body_force`, or none.
fn have_same_force(one: &Body, other: &Body) -> bool {
    match (&one.body_force, &other.body_force) {
        (None, None) => true,
        (Some(a), Some(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.is_same(b)),
        _ => false,
    }
}

/// Build the bodies of elements in the liquid, with the conditions, the gravity and the contact of the scene; none without such bodies.
fn elements<E: Embedding<D>, const D: usize>(embedding: E, world: &World<'_, D>) -> Made<Option<Fem<D>>> {
    let mut fem = Fem::new(embedding);
    let mut names = Vec::new();
    for (name, body) in world.scene.expanded.iter().filter(|(_, body)| body.mesh.is_some()) {
        if matches!(body.mesh, Some(Mesh::Bars(_))) {
            let message = "has no surface that bounds a liquid; take elements of the plane or of space";
            return wrong(format!("bodies.{name}.mesh.bars"), message);
        }
        let spec = body.material.as_ref().and_then(|name| world.scene.materials.get(name));
        if let Some(spec) = spec
            && constants(world, &format!("bodies.{name}"), body, spec)?.is_some()
        {
            return Err(Wrong {
                key: format!("bodies.{name}.mesh"),
                message: "is of a solid: a liquid of `flow` is of particles".into(),
                help: Some("leave out `mesh`, or give the body the material of a solid".into()),
            });
        }
        let number =
            fem.add(mesh::body(world, name, body)?).map_err(|e| of_body(&format!("bodies.{name}"), e))?;
        for (key, spec) in body.traction.keyed(&format!("bodies.{name}.traction")) {
            load(world, &mut fem, number, &key, spec)?;
        }
        names.push(name.as_str());
    }
    if names.is_empty() {
        return Ok(None);
    }
    if let Some(laws) = world.laws(&names)? {
        fem.touch(laws).at("contact")?;
    }
    for (key, boundary) in world.conditions()? {
        fem.bound(boundary).at(key)?;
    }
    if let Some(gravity) = world.gravity()? {
        fem.set_body_force(gravity);
    }
    fem.set_watch(world.watch());
    Ok(Some(fem))
}

/// Build the bodies of particles in the liquid, with the conditions, the gravity and the contact of the scene; none without such bodies.
fn particles<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Flow,
) -> Made<Option<ParticlesInLiquid<D>>> {
    let mut scene = world.scene.clone();
    scene.expanded.retain(|_, body| is_submerged(world.scene, body));
    scene.bodies.retain(|_, body| is_submerged(world.scene, body));
    let Some(first) = scene.expanded.keys().next() else {
        if options.solids.is_some() {
            return wrong("method.flow.solids", "no body is of a solid without a `mesh`");
        }
        return Ok(None);
    };
    if let Some((name, _)) = world.scene.expanded.iter().find(|(_, body)| body.mesh.is_some()) {
        return Err(Wrong {
            key: format!("bodies.{name}.mesh"),
            message: format!("is not available beside `{first}`, a body of particles in the liquid"),
            help: Some("give all solids a `mesh`, or none".into()),
        });
    }
    if let Some(purpose) = options.solids.as_ref().and_then(|solids| solids.purpose)
        && matches!(purpose, Purpose::LargeElastic | Purpose::ContactAtRest)
    {
        return Err(Wrong {
            key: "method.flow.solids.for".into(),
            message: "is not available in a liquid".into(),
            help: Some("take `machine parts`, or `impact`, which damps vibrations".into()),
        });
    }
    // The steps of the scene are those of the liquid.
    scene.time_step = None;
    let method = options.method_of_solids();
    let spacing = FACET * method.cell.value;
    scene.method = Method::Mpm(method.clone());
    let own = World::new(&scene, world.folder);
    let named = |mut wrong: Wrong| {
        if let Some(rest) = wrong.key.strip_prefix("method.mpm") {
            wrong.key = if options.solids.is_some() {
                format!("method.flow.solids{rest}")
            } else {
                "method.flow.cell".into()
            };
        }
        wrong
    };
    let mpm = mpm::scene(embedding, &own, &method).map_err(named)?;
    let surfaces = scene.expanded.iter().map(|(name, body)| {
        let key = format!("bodies.{name}.shape");
        Facets::of(&*own.shape(&format!("bodies.{name}"), body)?, spacing).at(key)
    });
    let surfaces: Vec<Facets<D>> = surfaces.collect::<Made<_>>()?;
    Ok(Some(ParticlesInLiquid::new(mpm, &surfaces).at("method.flow.solids").map_err(|wrong| {
        let key = if options.solids.is_some() { wrong.key } else { "method.flow.cell".into() };
        Wrong { key, ..wrong }
    })?))
}

/// True if a body is of particles of a solid in the liquid.
fn is_submerged(scene: &SceneFile, body: &Body) -> bool {
    body.rigid.is_none() && body.mesh.is_none() && is_solid(scene, body)
}

/// True if the scene has deformable bodies in the liquid.
fn deforms<const D: usize>(world: &World<'_, D>) -> bool {
    world.scene.expanded.values().any(|body| body.mesh.is_some() || is_submerged(world.scene, body))
}

/// Refuse keys of the scene that incompressible flow does not read.
fn refuse_what_is_not_read<const D: usize>(world: &World<'_, D>) -> Made<()> {
    if world.scene.mass_scaling.is_some() {
        return wrong("mass_scaling", "is not of `flow`, whose step no speed of sound limits");
    }
    if world.scene.contact.is_some() && !deforms(world) {
        let message = "is not of `flow`: liquids of a scene are one, and solids and walls are impermeable";
        return wrong("contact", message);
    }
    if let Some(n) = accounts::of(world.scene).first() {
        return Err(Wrong {
            key: format!("conditions[{n}]"),
            message: "forces of single conditions are not measured in `flow`".into(),
            help: Some("leave `condition` out of the measure: it is then that of all walls together".into()),
        });
    }
    Ok(())
}

/// Return the origin of the grid: at the lower planes of periods, else zero.
fn origin<const D: usize>(world: &World<'_, D>) -> Made<[f64; D]> {
    let mut origin = [0.0; D];
    for (n, condition) in world.scene.conditions.iter().enumerate() {
        if let Condition::Periodic(period) = condition {
            let axis = world.space().axis(period.axis).at(format!("conditions[{n}].periodic.axis"))?;
            origin[axis] = period.low.value;
        }
    }
    Ok(origin)
}

/// Return the half space behind a plane, m.
fn behind<const D: usize>(key: &str, axis: usize, at: f64, side: Side) -> Made<HalfSpace<D>> {
    let mut outward = [0.0; D];
    outward[axis] = if side == Side::Above { 1.0 } else { -1.0 };
    let mut point = [0.0; D];
    point[axis] = at;
    HalfSpace::new(point, outward).at(key)
}

/// Return the wall of a condition, unless it is periodic.
fn wall<const D: usize>(world: &World<'_, D>, key: &str, condition: &Condition) -> Made<Option<Wall<D>>> {
    let plane = |plane: &Plane, word: &str| -> Made<Wall<D>> {
        let axis = world.space().axis(plane.axis).at(format!("{key}.{word}.axis"))?;
        Ok(Wall::solid(behind(key, axis, plane.at.value, plane.side)?))
    };
    Ok(Some(match condition {
        Condition::Periodic(_) => return Ok(None),
        Condition::Symmetry(p) => plane(p, "symmetry")?,
        Condition::Fixed(p) => plane(p, "fixed")?.no_slip(),
        Condition::Wall(spec) => {
            let key = format!("{key}.wall");
            if spec.friction.is_some() {
                return Err(Wrong {
                    key: format!("{key}.friction"),
                    message: "is not of a liquid".into(),
                    help: Some("`fixed` instead of `wall` is a wall without slip, by the viscosity".into()),
                });
            }
            let axis = world.space().axis(spec.axis).at(format!("{key}.axis"))?;
            let wall = Wall::solid(behind(&key, axis, spec.at.value, spec.side)?);
            match (&spec.velocity, &spec.position) {
                (Some(_), Some(_)) => {
                    return wrong(format!("{key}.position"), "either `velocity` or `position`");
                }
                (None, None) => wall,
                (Some(list), None) => {
                    let still = |(d, v): (usize, &Formula<Speed>)| d == axis || v.as_constant() == Some(0.0);
                    if !list.iter().enumerate().all(still) {
                        let message = "a wall of `flow` drags nothing along; `fixed` is without slip";
                        return wrong(format!("{key}.velocity"), message);
                    }
                    let moved = displacement(world, &format!("{key}.velocity"), list)?;
                    wall.moving(move |t| moved(t))
                }
                (None, Some(_)) => {
                    let (at, position) = (spec.at.value, world.wall_position(&key, spec)?);
                    wall.moving(move |t| {
                        let mut moved = [0.0; D];
                        moved[axis] = position(t) - at;
                        moved
                    })
                }
            }
        }
        // Of the deformable bodies alone.
        Condition::Prescribed(_) if deforms(world) => return Ok(None),
        Condition::Absorbing(_) | Condition::Prescribed(_) => {
            return Err(Wrong {
                key: key.into(),
                message: format!("`{}` is not available in `flow`", condition.kind()),
                help: Some(
                    "planes `wall`, `fixed`, `symmetry` and `periodic`, and rigid bodies bound a liquid; `prescribed` holds deformable bodies"
                        .into(),
                ),
            });
        }
    }))
}

/// Return a rigid body that the liquid moves.
fn afloat<const D: usize>(world: &World<'_, D>, key: &str, body: &Body) -> Made<RigidBody<D>> {
    let Some(spec) = &body.rigid else { return wrong(key, "is not rigid") };
    let at = format!("{key}.rigid");
    if let Some((name, _)) = tense(world) {
        return Err(Wrong {
            key: at,
            message: format!(
                "a rigid body that the liquid moves is not available beside the surface tension of `{name}`"
            ),
            help: Some("leave out `surface_tension`, or prescribe the motion of the body".into()),
        });
    }
    if let Some(list) = &body.velocity {
        for (n, formula) in formulas::<D, _>(list).at(format!("{key}.velocity"))?.iter().enumerate() {
            formula.check(world.space().coordinates(), false, false).at(format!("{key}.velocity[{n}]"))?;
            if formula.as_constant().is_none() {
                let message = "of a rigid body that the liquid moves is a number: that of the start";
                return wrong(format!("{key}.velocity[{n}]"), message);
            }
        }
    }
    // The spin comes from the body itself.
    let mut plain = body.clone();
    plain.spin = None;
    let velocity = world.velocity(key, &plain, || Ok([0.0; D]))?([0.0; D]);
    let mut rigid = RigidBody::new(world.shape(key, body)?, spec.density.value)
        .at(&at)?
        .with_velocity(velocity)
        .with_spin(world.spin(key, body)?);
    if !spec.hold.is_empty() {
        let mut held = [false; D];
        for (n, axis) in spec.hold.iter().enumerate() {
            held[world.space().axis(*axis).at(format!("{at}.hold[{n}]"))?] = true;
        }
        rigid = rigid.holding(held);
    }
    Ok(if spec.no_turning { rigid.without_turning() } else { rigid })
}

/// Return the name of a material with surface tension, if there is one.
fn tense<'a, const D: usize>(world: &World<'a, D>) -> Option<(&'a String, &'a Material)> {
    let tension = |m: &Material| match &m.fluid {
        Some(FluidLaw::Incompressible(k)) => k.surface_tension.value > 0.0,
        _ => false,
    };
    world.scene.materials.iter().find(|(_, m)| tension(m))
}

/// Return the wall of a rigid body whose motion is prescribed: it turns about its centroid.
fn solid<const D: usize>(world: &World<'_, D>, key: &str, body: &Body) -> Made<Wall<D>> {
    let Some(spec) = &body.rigid else { return wrong(key, "is not rigid") };
    if !spec.hold.is_empty() || spec.no_turning {
        return wrong(format!("{key}.rigid"), "`hold` and `no_turning` are of bodies that others move");
    }
    let shape = world.shape(key, body)?;
    let spin = world.spin(key, body)?;
    let turns = (spin != [0.0; 3]).then(|| shape.centroid());
    let mut wall = Wall::solid(shape);
    if let Some(centre) = turns {
        let Some(centre) = centre else {
            let message = "needs a shape whose centroid is known: a body of `flow` turns about it";
            return wrong(format!("{key}.spin"), message);
        };
        wall = wall.turning(centre, spin);
    }
    match &body.velocity {
        Some(list) => {
            let moved = displacement(world, &format!("{key}.velocity"), list)?;
            Ok(wall.moving(move |t| moved(t)))
        }
        None => {
            let mut plain = body.clone();
            plain.spin = None;
            let velocity = world.velocity(key, &plain, || Ok([0.0; D]))?([0.0; D]);
            Ok(if velocity == [0.0; D] { wall } else { wall.moving(move |t| velocity.map(|v| v * t)) })
        }
    }
}

/// Integrate velocities over time, m/s, from the start: exact for constant ones, else by Gauss's quadrature over parts of the run.
fn displacement<const D: usize>(
    world: &World<'_, D>,
    key: &str,
    list: &[Formula<Speed>],
) -> Made<Displacement<D>> {
    let list: [Formula<Speed>; D] = formulas(list).at(key)?;
    for (n, formula) in list.iter().enumerate() {
        formula.check(world.space().coordinates(), false, true).at(format!("{key}[{n}]"))?;
    }
    let constant = list.each_ref().map(Formula::as_constant);
    if constant.iter().all(Option::is_some) {
        let velocity = constant.map(|v| v.unwrap_or(0.0));
        return Ok(Arc::new(move |t| velocity.map(|v| v * t)));
    }
    let velocity = move |t: f64| -> [f64; D] { std::array::from_fn(|d| list[d].at(&[0.0; D], false, t)) };
    let part = world.scene.end.value / INTERVALS as f64;
    let over = move |from: f64, to: f64| -> [f64; D] {
        let (mean, half) = (0.5 * (from + to), 0.5 * (to - from));
        GAUSS.iter().fold([0.0; D], |sum, [node, weight]| {
            let v = velocity(mean + half * node);
            std::array::from_fn(|d| sum[d] + weight * half * v[d])
        })
    };
    let mut table = vec![[0.0; D]];
    for n in 0..INTERVALS {
        let step = over(part * n as f64, part * (n + 1) as f64);
        let last = table[n];
        table.push(std::array::from_fn(|d| last[d] + step[d]));
    }
    Ok(Arc::new(move |t| {
        let n = ((t / part).floor().max(0.0) as usize).min(INTERVALS);
        let rest = over(part * n as f64, t);
        std::array::from_fn(|d| table[n][d] + rest[d])
    }))
}

/// Return the liquid of a body.
fn fluid<const D: usize>(world: &World<'_, D>, key: &str, body: &Body) -> Made<Fluid> {
    let Some(name) = &body.material else { return wrong(key, "needs a `material`") };
    let Some(spec) = world.scene.materials.get(name) else {
        return wrong(format!("{key}.material"), format!("no material has the name `{name}`"));
    };
    let at = format!("materials.{name}");
    if spec.bulk_viscosity.is_some() {
        return wrong(format!("{at}.bulk_viscosity"), "has no effect on an incompressible liquid");
    }
    material::kind(&at, spec)?;
    let Some([density, viscosity, tension]) = constants(world, key, body, spec)? else {
        return Err(Wrong {
            key: at,
            message: "is no liquid, as `flow` needs".into(),
            help: Some(
                "take `fluid.incompressible = { density, viscosity, surface_tension }`, or `library = \"water\"`".into(),
            ),
        });
    };
    let at = format!("{at}.fluid");
    let fluid = Fluid::new(density).at(&at)?.with_viscosity(viscosity).at(&at)?;
    fluid.with_surface_tension(tension).at(&at)
}

/// Return density, kg/m^3, dynamic viscosity, Pa s, and surface tension, N/m, of a liquid; `None` for other materials.
fn constants<const D: usize>(
    world: &World<'_, D>,
    key: &str,
    body: &Body,
    spec: &Material,
) -> Made<Option<[f64; 3]>> {
    Ok(match (&spec.fluid, spec.library) {
        (Some(FluidLaw::Incompressible(k)), None) => {
            Some([k.density.value, k.viscosity.value, k.surface_tension.value])
        }
        (Some(FluidLaw::Tait(k)), None) => Some([k.density.value, k.viscosity.map_or(0.0, |q| q.value), 0.0]),
        (Some(FluidLaw::MieGruneisen(k)), None) => Some([k.density.value, 0.0, 0.0]),
        (None, Some(Library::Water | Library::WaterShocked)) => {
            Some([world.law(key, body)?.material.density(), 0.0, 0.0])
        }
        _ => None,
    })
}
