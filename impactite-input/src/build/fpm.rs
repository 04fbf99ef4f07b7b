//! Scenes of the fragile points method.

use impactite::fpm::{
    AnyCriterion, Cells, CellsError, Cohesive, Domain, Flux, Fpm as Body, Incomplete, MaximumTension, Method,
    MixedTensionShear, NoCracks, Notch, OuterFace, Penalty, Space, Symmetric, relaxed, scattered,
};
use impactite::geometry::{Bounds, Cuboid, Lattice, Polygon};
use impactite::scene::{Embedding, Solver};

use super::common::{World, centre_of_mass};
use super::conditions::loads::{Load, Part, Surface};
use super::shape::Motion;
use super::wrong::{At, Made, of_body, wrong};
use super::{mesh, particles, placement, seeds};
use crate::model::body::Body as Spec;
use crate::model::fixed;
use crate::model::method::{Cracks, Flux as FluxWord, Fpm, PENALTY, Points};
use crate::model::shape::Shape;

/// Longest notch, in spacings of points.
const LONGEST: f64 = 1e6;
/// Number of Lloyd iterations for random points.
const LLOYD: usize = 3;

pub(super) fn build<E, const D: usize>(
    embedding: E,
    world: &World<'_, D>,
    options: &Fpm,
) -> Made<Box<dyn Solver>>
where
    E: Space<D> + Embedding<D> + Copy + std::fmt::Debug,
    NotchMaker: MakesNotches<D>,
{
    match options.flux {
        FluxWord::Symmetric => of_flux(Symmetric, embedding, world, options),
        FluxWord::Incomplete => of_flux(Incomplete, embedding, world, options),
    }
}

fn of_flux<X: Flux, E, const D: usize>(
    flux: X,
    embedding: E,
    world: &World<'_, D>,
    options: &Fpm,
) -> Made<Box<dyn Solver>>
where
    E: Space<D> + Embedding<D> + Copy + std::fmt::Debug,
    NotchMaker: MakesNotches<D>,
{
    let penalty = Penalty::new(options.penalty.map_or(PENALTY, |eta| eta.value)).at("method.fpm.penalty")?;
    let criterion = criterion(options)?;
    particles::scene(world, |name, members| {
        let (key, spec) = (format!("bodies.{name}"), &world.scene.expanded[name]);
        let cells = cells(world, &key, spec, options)?;
        let velocity = world.velocity(&key, spec, || {
            Ok(centre_of_mass(cells.points().iter().copied().zip(cells.volumes().iter().copied())))
        })?;
        let method = Method::new(embedding, flux, penalty, criterion);
        let law = world.law(&key, spec)?.material;
        let body = Body::new(method, law, &cells, move |x| velocity(x));
        let mut body = body.map_err(|e| of_body(&key, e))?.named(name);
        if let Some(friction) = options.friction {
            body.set_friction(friction.value).at("method.fpm.friction")?;
        }
        placement::check_planes(world, &body)?;
        for (key, boundary) in world.conditions()? {
            body.bound(boundary).at(key)?;
        }
        for (key, load) in spec.traction.keyed(&format!("{key}.traction")) {
            let Surface { part, axis, load } = world.load(&key, load)?;
            let Part::Region(region) = part else {
                return wrong(format!("{key}.surface"), "is of the method `fem`; cells have a `region`");
            };
            let across = |f: &OuterFace<D>| axis.is_none_or(|axis| f.normal[axis].abs() > 0.5);
            let on = |f: &OuterFace<D>| across(f) && region.contains(f.centroid);
            match load {
                Load::Traction(history) => body.load_faces(on, history).at(key)?,
                Load::Pressure(history) => body.press_faces(on, history).at(key)?,
            };
        }
        if let Some(gravity) = world.gravity()? {
            body.set_body_force(gravity);
        }
        if let Some(part) = options.local_damping {
            body.set_local_damping(part.value).at("method.fpm.local_damping")?;
        }
        if let Some(control) = world.time_control() {
            body.set_time_control(control).at("time_step")?;
        }
        body.set_watch(world.watch());
        members.add(name, body);
        Ok(())
    })
}

fn criterion(options: &Fpm) -> Made<AnyCriterion> {
    let Some(cracks) = &options.cracks else { return Ok(AnyCriterion::None(NoCracks)) };
    let key = "method.fpm.cracks";
    Ok(match cracks {
        Cracks::MaximumTension(k) => AnyCriterion::Tension(MaximumTension::new(k.strength.value).at(key)?),
        Cracks::MixedTensionShear(k) => {
            AnyCriterion::Mixed(MixedTensionShear::new(k.tension.value, k.shear.value).at(key)?)
        }
        Cracks::Cohesive(k) => {
            let cohesive = Cohesive::new(k.strength.value, k.energy.value).at(key)?;
            AnyCriterion::Cohesive(if k.parted { cohesive.parted() } else { cohesive })
        }
    })
}

fn cells<const D: usize>(world: &World<'_, D>, key: &str, spec: &Spec, options: &Fpm) -> Made<Cells<D>>
where
    NotchMaker: MakesNotches<D>,
{
    let mut notches = Vec::new();
    for (n, notch) in spec.notches.iter().enumerate() {
        let key = format!("{key}.notches[{n}]");
        let corners: Made<Vec<[f64; D]>> =
            notch.corners.iter().map(|c| fixed(c).at(format!("{key}.corners"))).collect();
        let corners = corners?;
        let long = corners.iter().flat_map(|a| {
            corners.iter().map(move |b| (0..D).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt())
        });
        let long = long.fold(0.0, f64::max);
        if long.is_nan() || long > LONGEST * options.spacing.value {
            let message = format!(
                "is {long:.3e} m long, {:.1e} spacings; at most {LONGEST:.0e} are allowed",
                long / options.spacing.value
            );
            return wrong(format!("{key}.corners"), message);
        }
        let mut made = NotchMaker::notch(&key, corners)?;
        if let Some(gap) = notch.gap {
            made = made.with_gap(gap.value).at(&key)?;
        }
        notches.push((key, made));
    }
    let mut cells = if spec.mesh.is_some() {
        Cells::of_mesh(&mesh::of(world, key, spec)?).at(format!("{key}.mesh"))?
    } else {
        let spacing = options.spacing.value;
        let domain = domain(key, spec, spacing)?;
        let mut points = match options.points {
            Points::Random => {
                let points = scattered(&domain, options.seed, |_| spacing).at("method.fpm.spacing")?;
                relaxed(points, &domain, LLOYD).at("method.fpm.spacing")?
            }
            Points::Lattice => {
                let lattice = Lattice::new([0.0; D], spacing).at("method.fpm.spacing")?;
                let cells =
                    seeds::Cells { lattice: &lattice, parts: 1, key: "method.fpm.spacing", halvings: 0 };
                seeds::seeds(world, key, spec, &cells)?.positions
            }
        };
        for (key, notch) in &notches {
            points = NotchMaker::lined(notch, points, &domain, spacing).at(key)?;
        }
        Cells::voronoi(&points, &domain).at(format!("{key}.shape"))?
    };
    for (key, notch) in &notches {
        cells = cells.with_notch(notch).at(key)?;
    }
    Ok(cells)
}

/// Number of sides of the polygon that stands for a disc, per spacing of its circumference.
const SIDES: f64 = 2.0;

/// Return the convex domain of a body, to which Voronoi cells are clipped. A disc is a polygon of the same area.
fn domain<const D: usize>(key: &str, spec: &Spec, spacing: f64) -> Made<Domain<D>> {
    let key = format!("{key}.shape");
    let Some(shape) = &spec.shape else { return wrong(key, "needs a `shape`, or a `mesh`") };
    let (shape, motion) = Motion::<D>::of(&key, shape)?;
    match shape {
        Shape::Box(s) => {
            let cuboid = Cuboid::<D>::new(fixed(&s.from).at(&key)?, fixed(&s.to).at(&key)?).at(&key)?;
            moved_box(&cuboid, &motion).at(key)
        }
        Shape::Polygon(s) => {
            convex(&key, s.corners.iter().map(|c| c.each_ref().map(|x| x.value)).collect(), &motion)
        }
        Shape::Ball(s) if D == 2 => {
            let (centre, radius) = (fixed::<2, _>(&s.centre).at(&key)?, s.radius.value);
            let sides = (SIDES * std::f64::consts::TAU * radius / spacing).ceil().clamp(12.0, 1e4);
            let angle = std::f64::consts::TAU / sides;
            let corner = radius * (angle / angle.sin()).sqrt();
            let at = |n: usize| {
                let (sin, cos) = (angle * n as f64).sin_cos();
                [centre[0] + corner * cos, centre[1] + corner * sin]
            };
            convex(&key, (0..sides as usize).map(at).collect(), &motion)
        }
        _ => wrong(
            key,
            "cells of points are cut to a `box`, in the plane also a `ball` or a convex `polygon`, each of them also `moved`; other bodies have a `mesh`",
        ),
    }
}

/// Cut the domain of a moved box from the box around it.
fn moved_box<const D: usize>(cuboid: &Cuboid<D>, motion: &Motion<D>) -> Result<Domain<D>, CellsError> {
    let (low, high) = (cuboid.min(), cuboid.max());
    let corner = |n: usize| -> [f64; D] {
        motion.place(std::array::from_fn(|d| if n >> d & 1 == 1 { high[d] } else { low[d] }))
    };
    let bounds = Bounds::around((0..1 << D).map(corner));
    let mut domain = Domain::cuboid(bounds.min, bounds.max)?;
    let first = corner(0);
    for d in 0..D {
        let last = corner(1 << d);
        let edge: [f64; D] = std::array::from_fn(|e| last[e] - first[e]);
        if edge.iter().filter(|c| **c != 0.0).count() == 1 {
            continue;
        }
        let along = |x: &[f64; D]| -> f64 { (0..D).map(|e| edge[e] * x[e]).sum() };
        domain = domain.cut(edge, along(&last))?.cut(edge.map(|c| -c), -along(&first))?;
    }
    Ok(domain)
}

/// Create a convex polygon of the plane, moved.
fn convex<const D: usize>(key: &str, corners: Vec<[f64; 2]>, motion: &Motion<D>) -> Made<Domain<D>> {
    let place = |x: [f64; 2]| -> [f64; 2] {
        let moved = motion.place(std::array::from_fn(|d| x[d.min(1)]));
        std::array::from_fn(|d| moved[d.min(D - 1)])
    };
    let polygon = Polygon::new(corners.into_iter().map(place).collect()).at(key)?;
    let any: Box<dyn std::any::Any> = Box::new(Domain::polygon(&polygon).at(key)?);
    match any.downcast() {
        Ok(domain) => Ok(*domain),
        Err(_) => wrong(key, "a polygon is a shape of the plane"),
    }
}

/// Constructor of notches in two and three dimensions.
pub(super) struct NotchMaker;

pub(super) trait MakesNotches<const D: usize> {
    fn notch(key: &str, corners: Vec<[f64; D]>) -> Made<Notch<D>>;
    fn lined(
        notch: &Notch<D>,
        points: Vec<[f64; D]>,
        domain: &Domain<D>,
        spacing: f64,
    ) -> Result<Vec<[f64; D]>, impactite::fpm::CellsError>;
}
impl MakesNotches<2> for NotchMaker {
    fn notch(key: &str, corners: Vec<[f64; 2]>) -> Made<Notch<2>> {
        match corners[..] {
            [from, to] => Notch::segment(from, to).at(key),
            _ => wrong(key, "in the plane a notch has two ends"),
        }
    }
    fn lined(
        notch: &Notch<2>,
        points: Vec<[f64; 2]>,
        domain: &Domain<2>,
        spacing: f64,
    ) -> Result<Vec<[f64; 2]>, impactite::fpm::CellsError> {
        notch.lined(points, domain, spacing)
    }
}
impl MakesNotches<3> for NotchMaker {
    fn notch(key: &str, corners: Vec<[f64; 3]>) -> Made<Notch<3>> {
        Notch::polygon(corners).at(key)
    }
    /// In three dimensions points are not aligned with the notch.
    fn lined(
        _: &Notch<3>,
        points: Vec<[f64; 3]>,
        _: &Domain<3>,
        _: f64,
    ) -> Result<Vec<[f64; 3]>, impactite::fpm::CellsError> {
        Ok(points)
    }
}
