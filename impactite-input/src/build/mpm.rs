//! Scenes of the material point method, with bodies of finite elements among the particles.

use std::collections::BTreeSet;
use std::sync::Arc;

use impactite::contact::{
    AnyDetector, AnyNormals, Coulomb, Frictionless, Gradients, SlipWeakening, Stick, SurfaceDistance,
};
use impactite::coupling::Elements;
use impactite::fem::Fem;
use impactite::geometry::Lattice;
use impactite::materials::ParameterError;
use impactite::mpm::{
    BlockGrid, Boundary, ContactAlgorithm, Criterion, DenseGrid, FieldForce, GridContact, Merging,
    Mpm as Scene, NearContact, OneField, Refinement, Rigid, Splitting, StateAbove, Twist, WithBody,
};
use impactite::scene::Solver;

use super::common::World;
use super::conditions::loads;
use super::kernels::Setting;
use super::liquid::{self, Pressures};
use super::material::{Acting, Start};
use super::seeds::{Cells, seeds};
use super::wrong::{At, Made, Wrong, known, of_body, wrong};
use super::{mesh, placement, stressed};
use crate::model::body::{Body, MeetBy};
use crate::model::contact::{Contact as Laws, Detector, Law, Pair};
use crate::model::method::{Dense, Grid, Mpm};
use crate::model::{fixed, formulas};

pub(super) fn build<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Mpm,
) -> Made<Box<dyn Solver>> {
    Ok(Box::new(scene(embedding, world, options)?))
}

/// Build the scene with its own type.
pub(super) fn scene<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Mpm,
) -> Made<Scene<D>> {
    let options_of_parts = liquid::options(world.scene, options);
    let kernels = embedding.kernels(&options_of_parts)?;
    let mut origin = match &options.origin {
        Some(origin) => fixed(origin).at("method.mpm.origin")?,
        None => [0.0; D],
    };
    let conditions = world.conditions()?;
    // A period begins with a block of nodes, so that positions are between its planes. The nodes are the same.
    for (_, boundary) in &conditions {
        if let Boundary::Periodic { axis, low, .. } = *boundary.boundary() {
            let cells = (low - origin[axis]) / options.cell.value;
            if (cells - cells.round()).abs() <= 1e-6 && cells.round() % 4.0 != 0.0 {
                origin[axis] = low;
            }
        }
    }
    let lattice = Lattice::new(origin, options.cell.value).at("method.mpm.cell")?;
    if !(1..=8).contains(&options.particles_per_cell) {
        let message = format!("{} is not allowed; it must be 1 to 8", options.particles_per_cell);
        return wrong("method.mpm.particles_per_cell", message);
    }
    let bodies = &world.scene.expanded;
    // Bodies of elements follow the bodies of particles, as clients of their scene.
    let order: Vec<(&String, &Body)> = bodies
        .iter()
        .filter(|(_, b)| b.elements.is_none())
        .chain(bodies.iter().filter(|(_, b)| b.elements.is_some()))
        .collect();
    let names: Vec<&str> = order.iter().map(|(name, _)| name.as_str()).collect();
    let contact: Arc<dyn ContactAlgorithm<f64, D>> = match world.laws(&names)? {
        None => Arc::new(OneField),
        Some(laws) => {
            let detector = world.scene.contact().map(|c| c.detector).unwrap_or_default();
            Arc::new(GridContact::new(self::detector(detector).at("contact.detector")?, laws))
        }
    };
    let mut mpm = match &options.grid {
        Grid::Blocks => Scene::of(kernels, BlockGrid::new(lattice), contact),
        Grid::Dense(dense) => Scene::of(kernels, all_nodes(&lattice, dense)?, contact),
    };
    // Apply periods before the bodies, whose positions depend on them.
    let (periods, others): (Vec<_>, Vec<_>) =
        conditions.into_iter().partition(|(_, b)| matches!(b.boundary(), Boundary::Periodic { .. }));
    for (key, boundary) in periods {
        mpm.bound(boundary).at(key)?;
    }
    let others = others
        .into_iter()
        .map(|(key, entry)| (key, liquid::bounding(world.scene, options, &lattice, entry)))
        .collect::<Vec<_>>();
    let planes: Vec<Boundary<D>> =
        world.conditions()?.iter().map(|(_, entry)| entry.boundary().clone()).collect();
    let pressures = liquid::pressures(world, options, &lattice, &planes)?;
    refine(world, &mut mpm, options)?;
    mpm.add_together(|mpm| add_particles(world, mpm, &order, options, &pressures))?;
    for (name, body) in order.iter().filter(|(_, b)| b.elements.is_some()) {
        add_elements(embedding, world, &mut mpm, (name, body), options)?;
    }
    check_states(&mpm, options)?;
    // Check bodies behind planes here, since the errors contain the key.
    placement::check_planes(world, &mpm)?;
    for (key, boundary) in others {
        mpm.bound(boundary).at(key)?;
    }
    if let Some(gravity) = world.gravity()? {
        let by_grid =
            |b: &Body| b.elements.as_ref().is_some_and(|e| e.within.is_none() && e.by == MeetBy::Grid);
        if let Some((name, _)) = bodies.iter().find(|(_, b)| by_grid(b)) {
            return Err(Wrong {
                key: "gravity".into(),
                message: format!(
                    "is not available beside elements that meet particles on the grid, as `{name}` does"
                ),
                help: Some(format!(
                    "write `bodies.{name}.elements.by = \"surface\"`, or `body_force` for the bodies of particles"
                )),
            });
        }
        mpm.set_body_force(move |t| gravity(t));
    }
    if let Some(control) = world.time_control() {
        mpm.set_time_control(control).at("time_step")?;
    }
    if let Some(part) = options.local_damping {
        mpm.set_local_damping(part.value).at("method.mpm.local_damping")?;
    }
    if options.kinetic_damping {
        mpm.set_kinetic_damping(true).at("method.mpm.kinetic_damping")?;
    }
    if let Some(every) = options.null_space_filter {
        mpm.set_null_space_filter(every).at("method.mpm.null_space_filter")?;
    }
    mpm.set_watch(world.watch());
    let resting: Vec<&str> =
        bodies.iter().filter(|(_, b)| b.deactivated).map(|(name, _)| name.as_str()).collect();
    if let Some(first) = resting.first() {
        mpm.deactivate(&resting).at(format!("bodies.{first}.deactivated"))?;
    }
    Ok(mpm)
}

/// Refine the cells in regions and by criteria.
fn refine<const D: usize>(world: &World<'_, D>, mpm: &mut Scene<D>, options: &Mpm) -> Made<()> {
    let (mut regions, mut criteria) = (Vec::new(), Vec::new());
    for (key, refine) in options.refine.keyed("method.mpm.refine") {
        let halvings = refine.halvings as usize;
        let criterion: Box<dyn Criterion<f64, D>> = match (&refine.region, &refine.moves_with, &refine.state)
        {
            (Some(region), None, None) => {
                let region = world.region(&format!("{key}.region"), region)?;
                regions.push(Refinement { region, halvings });
                continue;
            }
            (Some(region), Some(body), None) => {
                let bodies = world.scene.expanded.keys().map(String::as_str);
                known(&format!("{key}.moves_with"), "body", body, bodies)?;
                let region = world.region(&format!("{key}.region"), region)?;
                Box::new(WithBody { region, body: body.clone() })
            }
            (None, None, Some(state)) => {
                Box::new(StateAbove { state: state.name.clone(), least: state.least })
            }
            _ => {
                let message = "must have either a `region`, which may have `moves_with`, or a `state`";
                return wrong(key, message.to_string());
            }
        };
        criteria.push((key, criterion, halvings));
    }
    if !regions.is_empty() {
        mpm.refine(&regions).at("method.mpm.refine")?;
    }
    for (key, criterion, halvings) in criteria {
        mpm.refine_where(vec![criterion], halvings).at(key)?;
    }
    let Some(fine) = options.cell.fine else { return Ok(()) };
    let key = "method.mpm.cell.fine";
    let halvings = (options.cell.value / fine).log2();
    if !(fine > 0.0 && halvings > 0.0 && halvings <= 7.0) {
        let message =
            format!("{fine} m is not allowed; it must be smaller than `coarse`, and a 128th of it or more");
        return wrong(key, message);
    }
    // Sizes that are meant to be a power of two apart may differ by rounding.
    let halvings = (halvings - 1e-9).ceil() as usize;
    mpm.refine_where(vec![Box::new(NearContact::default())], halvings).at(key)
}

/// Check that a law of the scene has the state variables that smaller cells depend on.
fn check_states<const D: usize>(mpm: &Scene<D>, options: &Mpm) -> Made<()> {
    for (key, refine) in options.refine.keyed("method.mpm.refine") {
        let Some(state) = &refine.state else { continue };
        let names: BTreeSet<String> = mpm.bodies().iter().flat_map(|body| body.state_names()).collect();
        let names = names.iter().map(String::as_str);
        known(&format!("{key}.state.name"), "state variable of the scene", &state.name, names)?;
        if !state.least.is_finite() {
            return wrong(
                format!("{key}.state.least"),
                format!("{} is not allowed; it must be finite", state.least),
            );
        }
    }
    Ok(())
}

/// Create the contact detector of a key.
fn detector(word: Detector) -> Result<AnyDetector, ParameterError> {
    let gradients = || AnyNormals::Gradients(Gradients::default());
    Ok(AnyDetector::by_distance(match word {
        Detector::Approach => return Ok(AnyDetector::by_approach(Gradients::default())),
        Detector::Compression => return Ok(AnyDetector::by_compression(Gradients::default())),
        Detector::SurfaceDistance => SurfaceDistance::new(AnyNormals::Plane, 0.0)?.locally(),
        Detector::GradientDistance => SurfaceDistance::new(gradients(), 0.0)?,
        Detector::LocalGradientDistance => SurfaceDistance::new(gradients(), 0.0)?.locally(),
        Detector::CentreDistance => SurfaceDistance::between_centres(gradients(), 0.5)?,
        Detector::Regression => return Ok(AnyDetector::by_regression()),
        Detector::RegressionDistance => SurfaceDistance::new(AnyNormals::Regression, 0.0)?,
        Detector::LocalRegressionDistance => SurfaceDistance::new(AnyNormals::Regression, 0.0)?.locally(),
    }))
}

/// Create a dense grid with all nodes of a box.
fn all_nodes<const D: usize>(lattice: &Lattice<D>, dense: &Dense) -> Made<DenseGrid<f64, D>> {
    let key = "method.mpm.grid.dense";
    let (from, to): ([f64; D], [f64; D]) =
        (fixed(&dense.from).at(format!("{key}.from"))?, fixed(&dense.to).at(format!("{key}.to"))?);
    let node = |x: f64, d: usize| (x - lattice.origin()[d]) / lattice.spacing();
    let (low, high) = (std::array::from_fn(|d| node(from[d], d)), std::array::from_fn(|d| node(to[d], d)));
    let most = f64::from(i32::MAX / 2);
    if low.iter().chain(&high).any(|n: &f64| n.is_nan() || n.abs() > most) {
        return wrong(key, "is too far from the origin for cells so small");
    }
    DenseGrid::new(*lattice, low.map(|n| n.floor() as i32), high.map(|n| n.ceil() as i32)).at(key)
}

fn splitting(key: &str, body: &Body) -> Made<Option<Splitting>> {
    let splitting =
        body.split_at.map(|q| Splitting::at(q.value)).transpose().at(format!("{key}.split_at"))?;
    let Some(above) = body.merge_above else { return Ok(splitting) };
    let key = format!("{key}.merge_above");
    let Some(splitting) = splitting else {
        return wrong(key, "merges what was split: the body needs a `split_at`");
    };
    Ok(Some(splitting.with_merging(Merging::above(above as usize).at(key)?)))
}

/// Add a body of finite elements among the particles.
fn add_elements<E: Setting<D>, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    mpm: &mut Scene<D>,
    (name, body): (&str, &Body),
    options: &Mpm,
) -> Made<()> {
    let key = format!("bodies.{name}");
    let mut fem = Fem::new(embedding);
    fem.add(mesh::body(world, name, body)?).map_err(|e| of_body(&key, e))?;
    if let Some(part) = options.local_damping {
        fem.set_local_damping(part.value).at("method.mpm.local_damping")?;
    }
    let spec = body.elements.as_ref();
    if let Some(host) = spec.and_then(|e| e.within.as_deref()) {
        let at = format!("{key}.elements.within");
        if spec.is_some_and(|e| e.by != MeetBy::default()) {
            return wrong(at, "either `by` or `within`");
        }
        let particles =
            world.scene.expanded.iter().filter(|(_, b)| b.elements.is_none() && b.rigid.is_none());
        known(&at, "body of particles", host, particles.map(|(name, _)| name.as_str()))?;
        // Conditions and gravity act through the host particles.
        let elements = Elements::within(fem, host).map_err(|e| of_body(&key, e))?;
        return mpm.add_client(elements).map_err(|e| of_body(&key, e));
    }
    for (key, boundary) in world.conditions()? {
        fem.bound(boundary).at(key)?;
    }
    if let Some(gravity) = world.gravity()? {
        fem.set_body_force(gravity);
    }
    let by = body.elements.as_ref().map(|e| e.by).unwrap_or_default();
    let elements = match by {
        MeetBy::Grid => Elements::on_the_grid(fem),
        MeetBy::Surface => {
            let Some(contact) = world.scene.contact() else {
                return wrong(&key, "elements and particles meet by a law: the scene needs a `contact`");
            };
            match law_with_particles(world, contact, name)? {
                Law::Friction(mu) if mu.value == 0.0 => Elements::by_surface(fem, Frictionless),
                Law::Friction(mu) => Elements::by_surface(fem, Coulomb::new(mu.value).at("contact.law")?),
                Law::Stick(_) => Elements::by_surface(fem, Stick),
                Law::SlipWeakening(w) => {
                    let law = SlipWeakening::new(w.at_rest.value, w.sliding.value, w.distance.value)
                        .at("contact.law")?;
                    Elements::by_surface(fem, law)
                }
                Law::Penalty(_) => {
                    return wrong(
                        "contact",
                        "`penalty` is of bodies of particles; take `friction` or `stick`",
                    );
                }
                Law::Adhesion(_) => {
                    return wrong(
                        "contact",
                        "bonds of elements and particles are not there: take `friction` or `stick`",
                    );
                }
            }
        }
    };
    mpm.add_client(elements.map_err(|e| of_body(&key, e))?).map_err(|e| of_body(&key, e))
}

/// Return the contact law of elements with all bodies of particles.
fn law_with_particles<'a, const D: usize>(
    world: &World<'a, D>,
    contact: &'a Laws,
    name: &str,
) -> Made<&'a Law> {
    let law_with = |other: &str| {
        let both = |pair: &Pair| [name, other].iter().all(|n| pair.between.iter().any(|m| m == n));
        let pair = contact.pairs.iter().enumerate().find(|(_, pair)| both(pair));
        pair.map_or(("contact.law".to_string(), &contact.law), |(n, pair)| {
            (format!("contact.pairs[{n}].law"), &pair.law)
        })
    };
    let particles = world.scene.expanded.iter().filter(|(_, b)| b.elements.is_none() && b.rigid.is_none());
    let mut laws = particles.map(|(other, _)| law_with(other));
    let Some((_, first)) = laws.next() else { return Ok(&contact.law) };
    match laws.find(|(_, law)| format!("{law:?}") != format!("{first:?}")) {
        None => Ok(first),
        Some((key, _)) => Err(Wrong {
            key,
            message: format!(
                "elements by surface meet all particles by one law, and those of `{name}` have several"
            ),
            help: Some(format!(
                "write the same law for each body of particles, or `bodies.{name}.elements.by = \"grid\"`"
            )),
        }),
    }
}

/// Add the bodies of particles and the rigid bodies.
fn add_particles<const D: usize>(
    world: &World<'_, D>,
    mpm: &mut Scene<D>,
    order: &[(&String, &Body)],
    options: &Mpm,
    pressures: &Pressures,
) -> Made<()> {
    let parts = options.particles_per_cell as usize;
    for (name, body) in order {
        let key = format!("bodies.{name}");
        if body.elements.is_some() {
            continue;
        }
        let of_level = |(halvings, lattice): (usize, &Lattice<D>)| {
            let cells = Cells { lattice, parts, key: "method.mpm.cell", halvings: halvings as u32 };
            seeds(world, &key, body, &cells)
        };
        let all = mpm.seed_lattices().iter().enumerate().map(of_level).collect::<Made<Vec<_>>>()?;
        let seeds = mpm.seeds_of_levels(&all);
        match &body.rigid {
            Some(_) => {
                let rigid = rigid(world, &key, body)?;
                mpm.add_rigid(name, &rigid, &seeds).at(&key)?;
            }
            None => {
                let law = world.law(&key, body)?;
                let velocity = world.velocity(&key, body, || Ok(seeds.centroid()))?;
                let mut tractions = Vec::new();
                for (key, spec) in body.traction.keyed(&format!("{key}.traction")) {
                    let load = world.traction_on_particles(&key, spec)?;
                    loads::loaded(&format!("{key}.region"), &load, &seeds.positions)?;
                    tractions.push(load);
                }
                let splitting = splitting(&key, body)?;
                let field = world.body_force(&key, body)?.map(|acceleration| FieldForce { acceleration });
                if !body.lit.is_empty() && law.explosive.is_none() {
                    return wrong(format!("{key}.lit"), "its material is no explosive");
                }
                let mut lit = Vec::new();
                for (n, start) in body.lit.iter().enumerate() {
                    let at: [f64; D] = fixed(&start.at).at(format!("{key}.lit[{n}].at"))?;
                    let wide =
                        |x: [f64; D]| -> [f64; 3] { std::array::from_fn(|d| if d < D { x[d] } else { 0.0 }) };
                    let plane = start
                        .plane
                        .as_ref()
                        .map(|p| fixed::<D, _>(p).at(format!("{key}.lit[{n}].plane")))
                        .transpose()?;
                    lit.push(Start { at: wide(at), plane: plane.map(wide), time: start.time.value });
                }
                if body.initial_stress.is_some() && !lit.is_empty() {
                    return wrong(format!("{key}.initial_stress"), "is not of an explosive that is `lit`");
                }
                if splitting.is_some() && !lit.is_empty() {
                    return wrong(
                        format!("{key}.split_at"),
                        "is not available for an explosive that is `lit`",
                    );
                }
                let material = law.material.clone();
                let stressed = body.initial_stress.as_ref().map(|spec| {
                    stressed::states(
                        world,
                        &format!("{key}.initial_stress"),
                        spec,
                        &*material,
                        &seeds.positions,
                    )
                });
                let mut stressed = stressed.transpose()?;
                let renewed = liquid::renewed(world.scene, options, body).is_some();
                if renewed && stressed.is_none() && !pressures.is_empty() {
                    stressed = Some(liquid::states(&key, &*material, &seeds.positions, pressures)?);
                }
                let state = stressed.as_deref();
                law.add(
                    mpm,
                    name,
                    &seeds,
                    &velocity,
                    Acting { tractions, field, splitting, state, renewed, lit: &lit },
                )
                .at(&key)?;
            }
        }
    }
    Ok(())
}

fn rigid<const D: usize>(world: &World<'_, D>, key: &str, body: &Body) -> Made<Rigid<D>> {
    let Some(spec) = &body.rigid else { return wrong(key, "is not rigid") };
    let at = format!("{key}.rigid");
    let spin = world.spin(key, body)?;
    let list = match (&body.velocity, &body.speed, &body.direction) {
        (Some(list), ..) => Some(formulas::<D, _>(list).at(format!("{key}.velocity"))?),
        _ => None,
    };
    if let Some(list) = &list {
        for (n, formula) in list.iter().enumerate() {
            formula
                .check(world.space().coordinates(), false, spec.prescribed)
                .at(format!("{key}.velocity[{n}]"))?;
        }
    }
    // Prescribe the translation only; the spin comes from the body itself.
    let mut plain = body.clone();
    (plain.spin, plain.velocity) = (None, None);
    let along = world.velocity(key, &plain, || Ok([0.0; D]))?([0.0; D]);
    let velocity = move |t: f64| -> [f64; D] {
        list.as_ref().map_or(along, |list| std::array::from_fn(|d| list[d].at(&[0.0; D], false, t)))
    };
    let density = world.mass_factor() * spec.density.value;
    let mut rigid = if spec.prescribed {
        Rigid::prescribed(density, move |t| Twist { velocity: velocity(t), spin }).at(at.clone())?
    } else {
        Rigid::free(density).at(at.clone())?.with_velocity(velocity(0.0)).with_spin(spin)
    };
    let mut held = [false; D];
    for (n, axis) in spec.hold.iter().enumerate() {
        held[world.space().axis(*axis).at(format!("{at}.hold[{n}]"))?] = true;
    }
    if spec.prescribed && (held.contains(&true) || spec.no_turning) {
        return wrong(at, "`hold` and `no_turning` are of bodies that others move");
    }
    rigid = if held.contains(&true) { rigid.holding(held) } else { rigid };
    Ok(if spec.no_turning { rigid.without_turning() } else { rigid })
}
