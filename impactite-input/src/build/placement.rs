//! Initial placement of bodies: in front of planes, without overlap, at physical speeds.

use impactite::scene::{PointView, Solver};

use super::common::World;
use super::wrong::{Made, Wrong};
use crate::model::condition::{Condition, Side};
use crate::model::method::Method;

/// Speed of light, m/s: upper bound of speeds.
const LIGHT: f64 = 299_792_458.0;
/// Depth of a point within another shape, in spacings, from which bodies overlap. Points on a common face, or fitted to one, are below it.
const DEPTH: f64 = 0.25;

/// Refuse speeds above that of light, fixed planes with all matter behind them, and overlapping bodies.
pub(super) fn check<const D: usize>(world: &World<'_, D>, solver: &dyn Solver) -> Made<()> {
    let mut bounds = Vec::new();
    for body in solver.bodies() {
        let mut fastest = 0.0f64;
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        body.for_each(&mut |p| {
            fastest = fastest.max(p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt());
            for d in 0..D {
                (low[d], high[d]) = (low[d].min(p.position[d]), high[d].max(p.position[d]));
            }
        });
        if fastest >= LIGHT {
            // Elements among particles are one body of the solver.
            let name = body.name().split(" + ").next().unwrap_or_default();
            return Err(Wrong {
                key: format!("bodies.{name}"),
                message: format!(
                    "{fastest:.3e} m/s is not allowed; speeds must be below that of light, {LIGHT:.3e} m/s"
                ),
                help: Some("look at the unit of its `velocity`, `speed` or `spin`".into()),
            });
        }
        bounds.push((low, high));
    }
    fixed(world, solver)?;
    overlap(world, solver, &bounds)
}

/// Plane of a boundary condition, with material on one side.
struct Plane {
    key: String,
    axis: usize,
    letter: &'static str,
    at: f64,
    side: Side,
    fixed: bool,
}

impl Plane {
    /// Return the planes of a scene.
    fn all<const D: usize>(world: &World<'_, D>) -> Vec<Plane> {
        let list = world.scene.conditions.iter().enumerate();
        let of = |(n, condition): (usize, &Condition)| {
            let (word, axis, at, side) = match condition {
                Condition::Symmetry(p) => ("symmetry", p.axis, p.at.value, p.side),
                Condition::Wall(p) => ("wall", p.axis, p.at.value, p.side),
                Condition::Absorbing(p) => ("absorbing", p.axis, p.at.value, p.side),
                Condition::Fixed(p) => ("fixed", p.axis, p.at.value, p.side),
                Condition::Periodic(_) | Condition::Prescribed(_) => return None,
            };
            Some(Plane {
                key: format!("conditions[{n}].{word}"),
                axis: world.space().axis(axis).ok()?,
                letter: axis.name(),
                at,
                side,
                fixed: word == "fixed",
            })
        };
        list.filter_map(of).collect()
    }

    /// Return the distance of a point in front of the plane, m; negative behind it.
    fn distance(&self, p: &PointView) -> f64 {
        let distance = p.position[self.axis] - self.at;
        if self.side == Side::Above { distance } else { -distance }
    }

    /// Return the words for the side of the material and for the opposite side.
    fn sides(&self) -> [&'static str; 2] {
        if self.side == Side::Above { ["above", "below"] } else { ["below", "above"] }
    }
}

/// Refuse bodies behind planes of symmetry, walls and absorbing planes. Errors of the solvers for these planes contain no keys.
pub(super) fn check_planes<const D: usize>(world: &World<'_, D>, solver: &dyn Solver) -> Made<()> {
    let planes: Vec<Plane> = Plane::all(world).into_iter().filter(|plane| !plane.fixed).collect();
    if planes.is_empty() {
        return Ok(());
    }
    let revolved = solver.axisymmetric();
    for body in solver.bodies() {
        let mut behind = vec![(0usize, 0.0f64); planes.len()];
        body.for_each(&mut |p| {
            // Points are fitted to shapes within half a spacing.
            let tolerance = 0.5001 * p.drawn_width(D, revolved);
            for (plane, (count, deepest)) in planes.iter().zip(&mut behind) {
                let depth = -plane.distance(p);
                if depth > tolerance {
                    (*count, *deepest) = (*count + 1, deepest.max(depth));
                }
            }
        });
        let Some((plane, (count, deepest))) = planes.iter().zip(behind).find(|(_, (count, _))| *count > 0)
        else {
            continue;
        };
        let ([side, other], letter) = (plane.sides(), plane.letter);
        let part = if count == body.len() { "all".into() } else { format!("{count} of {}", body.len()) };
        return Err(Wrong {
            key: plane.key.clone(),
            message: format!(
                "{part} points of `{}` are behind it, up to {deepest:.3e} m: material lies {side} {letter} = {:?} m (`side = \"{side}\"`)",
                body.name(),
                plane.at
            ),
            help: Some(if 2 * count > body.len() {
                format!("write `side = \"{other}\"`, or move the plane")
            } else {
                "move the plane or the body".into()
            }),
        });
    }
    Ok(())
}

/// Refuse a fixed plane with no matter in front of it, since nothing moves. Single bodies and parts of bodies may be behind it.
fn fixed<const D: usize>(world: &World<'_, D>, solver: &dyn Solver) -> Made<()> {
    let revolved = solver.axisymmetric();
    for plane in Plane::all(world).into_iter().filter(|plane| plane.fixed) {
        let mut moves = false;
        for body in solver.bodies() {
            body.for_each(&mut |p| moves |= plane.distance(p) >= 1e-6 * p.drawn_width(D, revolved));
        }
        let [side, other] = plane.sides();
        if !moves {
            return Err(Wrong {
                message: format!(
                    "all bodies are behind it, so that nothing moves: points {other} {} = {:?} m are fixed",
                    plane.letter, plane.at
                ),
                help: Some(format!("write `side = \"{other}\"` to fix those {side}")),
                key: plane.key,
            });
        }
    }
    Ok(())
}

/// Refuse bodies that overlap initially: points of one within the shape of another.
fn overlap<const D: usize>(
    world: &World<'_, D>,
    solver: &dyn Solver,
    bounds: &[([f64; D], [f64; D])],
) -> Made<()> {
    // Bodies that share one velocity field may overlap.
    if world.scene.contact().is_none() && !matches!(world.scene.method, Method::Flow(_)) {
        return Ok(());
    }
    let mut shapes = Vec::new();
    for (name, body) in &world.scene.expanded {
        let embedded = body.elements.as_ref().is_some_and(|e| e.within.is_some());
        if body.shape.is_some() && !embedded {
            let shape = world.shape(&format!("bodies.{name}"), body)?;
            shapes.push((name.as_str(), shape.bounds(), shape));
        }
    }
    let revolved = solver.axisymmetric();
    for (body, (low, high)) in solver.bodies().into_iter().zip(bounds) {
        let embedded = |name: &str| {
            let elements = world.scene.expanded.get(name).and_then(|b| b.elements.as_ref());
            elements.is_some_and(|e| e.within.is_some())
        };
        if embedded(body.name()) {
            continue;
        }
        for (other, of, shape) in &shapes {
            let apart = (0..D).any(|d| low[d] > of.max[d] || high[d] < of.min[d]);
            if apart || *other == body.name() {
                continue;
            }
            let (mut count, mut first) = (0, None);
            body.for_each(&mut |p| {
                let x: [f64; D] = std::array::from_fn(|d| p.position[d]);
                let depth = DEPTH * p.drawn_width(D, revolved);
                let within = |n: usize| {
                    let mut moved = x;
                    moved[n / 2] += if n.is_multiple_of(2) { depth } else { -depth };
                    shape.contains(moved)
                };
                if shape.contains(x) && (0..2 * D).all(within) {
                    count += 1;
                    first = first.or(Some(x));
                }
            });
            if let Some(x) = first {
                return Err(Wrong {
                    key: format!("bodies.{}", body.name()),
                    message: format!(
                        "{count} of its {} points lie in the shape of `{other}`, as at {x:?} m",
                        body.len()
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
