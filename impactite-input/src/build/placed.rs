//! A scene as it was set up: bodies on the right sides of planes, apart from each other, and of possible speeds.

use impactite::geometry::Shape as _;
use impactite::scene::{Body, Solver};

use super::common::World;
use super::shape;
use super::wrong::{Made, Wrong};
use crate::model::Space;
use crate::model::condition::{Condition, Side};

/// The speed of light, m/s: nothing here is relativistic.
const LIGHT: f64 = 299_792_458.0;

/// Where a body lies, and how fast it is.
struct Placed<const D: usize> {
    name: String,
    points: Vec<([f64; D], f64)>,
    fastest: f64,
}

/// Refuse bodies behind planes, bodies within bodies, and speeds that nothing has.
pub(super) fn check<const D: usize>(world: &World<'_, D>, solver: &dyn Solver) -> Made<()> {
    let placed = bodies::<D>(solver);
    for body in &placed {
        // Elements among particles are one body of the solver.
        let name = body.name.split(" + ").next().unwrap_or_default();
        if body.fastest >= LIGHT {
            return Err(Wrong {
                key: format!("bodies.{name}"),
                message: format!(
                    "{:.3e} m/s is not allowed; speeds must be below that of light, {LIGHT:.3e} m/s",
                    body.fastest
                ),
                help: Some("look at the unit of its `velocity`, `speed` or `spin`".into()),
            });
        }
    }
    for (n, condition) in world.scene.conditions.iter().enumerate() {
        behind(world, n, condition, &placed)?;
    }
    overlap(world, &placed)
}

/// Refuse bodies behind planes, but for fixed ones, behind which some bodies of a scene may be: before solvers see the planes, whose
/// words have no keys.
pub(super) fn check_planes<const D: usize>(world: &World<'_, D>, solver: &dyn Solver) -> Made<()> {
    let placed = bodies::<D>(solver);
    let mut conditions = world.scene.conditions.iter().enumerate();
    conditions.try_for_each(|(n, c)| {
        if matches!(c, Condition::Fixed(_)) { Ok(()) } else { behind(world, n, c, &placed) }
    })
}

fn bodies<const D: usize>(solver: &dyn Solver) -> Vec<Placed<D>> {
    let revolved = solver.axisymmetric();
    let of = |body: &dyn Body| {
        let mut here =
            Placed { name: body.name().into(), points: Vec::with_capacity(body.len()), fastest: 0.0 };
        body.for_each(&mut |p| {
            let at = std::array::from_fn(|d| p.position[d]);
            here.points.push((at, p.drawn_width(D, revolved)));
            let square = p.velocity.iter().map(|v| v * v).sum::<f64>();
            here.fastest = here.fastest.max(square.sqrt());
        });
        here
    };
    solver.bodies().into_iter().map(of).collect()
}

/// Refuse bodies behind a plane of a condition: what it does to them there is not what it says.
fn behind<const D: usize>(
    world: &World<'_, D>,
    number: usize,
    condition: &Condition,
    placed: &[Placed<D>],
) -> Made<()> {
    let key = format!("conditions[{number}]");
    let (word, axis, at, side) = match condition {
        Condition::Symmetry(p) => ("symmetry", p.axis, p.at.value, p.side),
        Condition::Wall(p) => ("wall", p.axis, p.at.value, p.side),
        Condition::Absorbing(p) => ("absorbing", p.axis, p.at.value, p.side),
        Condition::Fixed(p) => ("fixed", p.axis, p.at.value, p.side),
        Condition::Periodic(_) | Condition::Prescribed(_) => return Ok(()),
    };
    let Ok(d) = world.space().axis(axis) else { return Ok(()) };
    let (sign, said, other) = match side {
        Side::Above => (1.0, "above", "below"),
        Side::Below => (-1.0, "below", "above"),
    };
    // Points are fitted to shapes within half a spacing.
    let back = |(x, width): &([f64; D], f64)| sign * (x[d] - at) < -0.5001 * width;
    let mut all_behind = true;
    for body in placed.iter().filter(|b| !b.points.is_empty()) {
        let count = body.points.iter().filter(|p| back(p)).count();
        let whole = count == body.points.len();
        all_behind &= body.points.iter().all(|(x, width)| sign * (x[d] - at) < 1e-6 * width);
        // What is behind a fixed plane stands still: part of a body, or a whole one beside others.
        if word == "fixed" || count == 0 {
            continue;
        }
        let deepest = body.points.iter().map(|(x, _)| -sign * (x[d] - at)).fold(0.0, f64::max);
        let part = if whole { "all".into() } else { format!("{count} of {}", body.points.len()) };
        let axis = axis.name();
        return Err(Wrong {
            key: format!("{key}.{word}"),
            message: format!(
                "{part} points of `{}` are behind it, up to {deepest:.3e} m: its material is {said} {axis} = {at:?} m (`side = \"{said}\"`)",
                body.name
            ),
            help: Some(if 2 * count > body.points.len() {
                format!("write `side = \"{other}\"`, or move the plane")
            } else {
                "move the plane or the body".into()
            }),
        });
    }
    if word == "fixed" && all_behind {
        return Err(Wrong {
            key: format!("{key}.fixed"),
            message: format!(
                "all bodies are behind it, so that nothing moves: what is {other} {} = {at:?} m stands still",
                axis.name()
            ),
            help: Some(format!("write `side = \"{other}\"` to hold what is {said}")),
        });
    }
    Ok(())
}

/// Refuse bodies that lie in each other at the start.
fn overlap<const D: usize>(world: &World<'_, D>, placed: &[Placed<D>]) -> Made<()> {
    // Bodies that share one velocity field may.
    if world.scene.contact().is_none() {
        return Ok(());
    }
    let mut shapes = Vec::new();
    for (name, body) in &world.scene.expanded {
        let embedded = body.elements.as_ref().is_some_and(|e| e.within.is_some());
        let Some(spec) = body.shape.as_ref().filter(|_| !embedded) else { continue };
        let shape = shape::build::<D>(&format!("bodies.{name}.shape"), spec, world.folder)?;
        shapes.push((name, shape.bounds(), shape));
    }
    for body in placed.iter().filter(|b| !b.points.is_empty()) {
        let [mut low, mut high] = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
        for (x, _) in &body.points {
            for d in 0..D {
                (low[d], high[d]) = (low[d].min(x[d]), high[d].max(x[d]));
            }
        }
        for (other, bounds, shape) in &shapes {
            if **other == body.name || (0..D).any(|d| low[d] > bounds.max[d] || high[d] < bounds.min[d]) {
                continue;
            }
            let within = body.points.iter().filter(|(x, _)| shape.contains(*x)).count();
            // Points on a common face may count for either.
            if within * 50 > body.points.len() {
                let place = body.points.iter().find(|(x, _)| shape.contains(*x)).map(|p| p.0);
                let place = place.map_or(String::new(), |x| format!(", as at {x:?} m"));
                return Err(Wrong {
                    key: format!("bodies.{}", body.name),
                    message: format!(
                        "{within} of its {} points lie in the shape of `{other}`{place}",
                        body.points.len()
                    ),
                    help: Some(format!(
                        "bodies in contact must not overlap at the start: move one, or cut `{other}` out of it by `shape.difference`"
                    )),
                });
            }
        }
    }
    Ok(())
}

/// Words for a mass in these coordinates: kilograms of a part of the whole.
pub(crate) fn mass_unit(space: Space) -> &'static str {
    match space {
        Space::Full => "kg",
        Space::PlaneStrain | Space::PlaneStress => "kg/m",
        Space::Axisymmetric => "kg/rad",
    }
}
