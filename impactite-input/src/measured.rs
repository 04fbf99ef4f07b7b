//! Measures of a scene as it stands.

use impactite::scene::{Body, PointView, Solver};

use crate::build::describe;
use crate::model::measure::Measurement;
use crate::model::{SceneFile, Space};
use crate::quantity::{Length, Quantity};

/// A measure that the scene cannot give.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("measures.{name}: {why}")]
pub struct MeasureError {
    /// Its name.
    pub name: String,
    /// Why.
    pub why: String,
}

/// Names and SI units of the measures of a scene, in their order. Masses, momenta, forces and energies are per radian in axisymmetric
/// scenes, `kg/rad`, and per metre of depth in the plane, `kg/m`.
#[must_use]
pub fn columns(scene: &SceneFile) -> Vec<(String, &'static str)> {
    let unit = |measure| describe::unit_in(scene.space, describe::unit(measure));
    scene.measures.iter().map(|(name, measure)| (name.clone(), unit(measure))).collect()
}

/// The measures of a scene that was set up.
#[derive(Clone, Debug)]
pub struct Measures {
    space: Space,
    list: Vec<Taken>,
}

/// A measure, and the number of the point that it is taken at.
#[derive(Clone, Debug)]
struct Taken {
    name: String,
    what: Measurement,
    point: Option<usize>,
}

impl Measures {
    /// The measures of a scene as it begins, since points are told by where they are then.
    ///
    /// # Errors
    /// A field that the law of a body does not keep; a body without points.
    pub fn new(scene: &SceneFile, solver: &dyn Solver) -> Result<Self, MeasureError> {
        let bodies = solver.bodies();
        let list = scene.measures.iter().map(|(name, what)| {
            let at = match what {
                Measurement::PositionAt(at) | Measurement::VelocityAt(at) => Some((&at.body, &at.at)),
                Measurement::ValueAt(at) => Some((&at.body, &at.at)),
                _ => None,
            };
            let point =
                at.map(|(body, at)| nearest(find(&bodies, body)?, at, solver.axisymmetric())).transpose();
            let point = point.map_err(|why| MeasureError { name: name.clone(), why })?;
            Ok(Taken { name: name.clone(), what: what.clone(), point })
        });
        let measures = Measures { space: scene.space, list: list.collect::<Result<_, _>>()? };
        measures.take(solver)?;
        Ok(measures)
    }

    /// Their values, in SI units. Of a quarter model they are those of the quarter; of a point that is gone not a number.
    ///
    /// # Errors
    /// A field that the law of a body does not keep.
    pub fn take(&self, solver: &dyn Solver) -> Result<Vec<f64>, MeasureError> {
        let bodies = solver.bodies();
        let one = |taken: &Taken| {
            let value = of(self.space, &bodies, solver, taken);
            value.map_err(|why| MeasureError { name: taken.name.clone(), why })
        };
        self.list.iter().map(one).collect()
    }
}

/// The body of a name.
fn find<'a>(bodies: &[&'a dyn Body], name: &str) -> Result<&'a dyn Body, String> {
    // Bodies of elements among particles are together one body of the scene.
    let named = |b: &&&dyn Body| b.name() == name || b.name().split(" + ").any(|n| n == name);
    bodies.iter().find(named).copied().ok_or_else(|| format!("the scene has no body `{name}`"))
}

/// The number of the point that is nearest to a place; of several the one with the smallest number. A place further than two widths of a
/// point away is refused: it is outside of the body.
fn nearest(body: &dyn Body, at: &[Quantity<Length>], revolved: bool) -> Result<usize, String> {
    let mut best = None;
    body.for_each(&mut |p| {
        let square: f64 = at.iter().zip(p.position).map(|(a, x)| (a.value - x).powi(2)).sum();
        if best.is_none_or(|(least, number, _)| square < least || square == least && p.number < number) {
            // Largest distance of a corner of an element.
            let far =
                |c: &[f64; 3]| (0..at.len()).map(|d| (c[d] - p.position[d]).powi(2)).sum::<f64>().sqrt();
            let half = p.corners.iter().map(far).fold(0.0, f64::max);
            best = Some((square, p.number, half.max(p.drawn_width(at.len(), revolved))));
        }
    });
    let (square, number, width) = best.ok_or_else(|| format!("the body `{}` has no points", body.name()))?;
    if square.sqrt() > 2.0 * width {
        let distance = square.sqrt();
        return Err(format!(
            "the place is outside of `{}`: its nearest point is {distance:.3e} m away",
            body.name()
        ));
    }
    Ok(number)
}

/// What a check of a scene asks for, in SI units: the place of its measure, and the reference.
#[must_use]
pub fn reference(scene: &SceneFile, check: usize) -> Option<(usize, f64)> {
    let place = scene.measures.get_index_of(&scene.checks.get(check)?.measure)?;
    Some((place, describe::reference(scene, check).ok()?))
}

fn of(space: Space, bodies: &[&dyn Body], solver: &dyn Solver, taken: &Taken) -> Result<f64, String> {
    use Measurement as M;
    let (find, measure) = (|name: &str| find(bodies, name), &taken.what);
    // What a point of a body is asked for; no number once it is gone.
    let at_point = |body: &str, ask: &dyn Fn(&PointView) -> f64| {
        let mut value = f64::NAN;
        find(body)?.for_each(&mut |p| {
            if Some(p.number) == taken.point {
                value = ask(p);
            }
        });
        Ok::<f64, String>(value)
    };
    let (dimensions, revolved) = (space.dimensions(), space == Space::Axisymmetric);
    Ok(match measure {
        M::Extent(m) => {
            let axis = space.axis(m.axis)?;
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            find(&m.body)?.for_each(&mut |p| {
                let half = 0.5 * p.drawn_width(dimensions, revolved);
                // Elements end at their nodes.
                let half = if p.corners.is_empty() { half } else { 0.0 };
                low = low.min(p.position[axis] - half);
                high = high.max(p.position[axis] + half);
                for corner in &p.corners {
                    low = low.min(corner[axis]);
                    high = high.max(corner[axis]);
                }
            });
            // Matter of a body of revolution does not cross its axis.
            high - if revolved && axis == 0 { low.max(0.0) } else { low }
        }
        M::Highest(m) | M::Lowest(m) => {
            let axis = space.axis(m.axis)?;
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            find(&m.body)?.for_each(&mut |p| {
                low = low.min(p.position[axis]);
                high = high.max(p.position[axis]);
            });
            if matches!(measure, M::Highest(_)) { high } else { low }
        }
        M::Centre(m) => {
            let axis = space.axis(m.axis)?;
            let (mut mass, mut sum) = (0.0, 0.0);
            find(&m.body)?.for_each(&mut |p| {
                mass += p.mass;
                sum += p.mass * p.position[axis];
            });
            sum / mass
        }
        M::MeanVelocity(m) => {
            let totals = find(&m.body)?.totals();
            totals.momentum_now()[space.axis(m.axis)?] / totals.mass
        }
        M::Momentum(m) => find(&m.body)?.totals().momentum_now()[space.axis(m.axis)?],
        M::Kinetic(m) => find(&m.body)?.totals().kinetic_now(),
        M::Internal(m) => find(&m.body)?.totals().internal,
        M::Mass(m) => find(&m.body)?.totals().mass,
        M::FailedShare(m) => {
            let (mut failed, mut all) = (0usize, 0usize);
            find(&m.body)?.for_each(&mut |p| {
                all += 1;
                failed += usize::from(p.failed);
            });
            failed as f64 / all.max(1) as f64
        }
        M::Largest(m) => {
            let mut most = f64::NEG_INFINITY;
            each(find(&m.body)?, &m.field, &mut |p, value| most = most.max(value(p)))?;
            most
        }
        M::Mean(m) => {
            let (mut mass, mut sum) = (0.0, 0.0);
            each(find(&m.body)?, &m.field, &mut |p, value| {
                mass += p.mass;
                sum += p.mass * value(p);
            })?;
            sum / mass
        }
        M::PositionAt(m) => {
            let axis = space.axis(m.axis)?;
            at_point(&m.body, &|p| p.position[axis])?
        }
        M::VelocityAt(m) => {
            let axis = space.axis(m.axis)?;
            at_point(&m.body, &|p| p.velocity[axis])?
        }
        M::ValueAt(m) => {
            let mut there = f64::NAN;
            each(find(&m.body)?, &m.field, &mut |p, value| {
                if Some(p.number) == taken.point {
                    there = value(p);
                }
            })?;
            there
        }
        M::ContactForce(m) => {
            let axis = space.axis(m.axis)?;
            let number = |name: &String| {
                let body = find(name)?;
                Ok::<_, String>(bodies.iter().position(|b| b.name() == body.name()).unwrap_or(usize::MAX))
            };
            let (first, second) = (number(&m.between[0])?, number(&m.between[1])?);
            let contacts = solver.contacts();
            let pair = contacts.iter().find(|pair| pair.bodies == [first.min(second), first.max(second)]);
            // Of a pair the force is that on the body of the larger number.
            let sign = if second > first { 1.0 } else { -1.0 };
            pair.map_or(0.0, |pair| sign * pair.force[axis])
        }
        M::EnergyError(_) => solver.account().energy_error(),
    })
}

/// A number of a point.
type OfPoint<'a> = dyn Fn(&PointView) -> f64 + 'a;

/// Every point of a body, with what a field is there.
fn each(body: &dyn Body, field: &str, visit: &mut dyn FnMut(&PointView, &OfPoint<'_>)) -> Result<(), String> {
    let names = body.state_names();
    let place = names.iter().position(|n| n == field);
    if place.is_none() && !["pressure", "von_mises", "speed"].contains(&field) {
        let kept = if names.is_empty() { "no state".into() } else { names.join(", ") };
        return Err(format!(
            "the law of `{}` keeps no `{field}`; there are pressure, von_mises, speed, {kept}",
            body.name()
        ));
    }
    let value = |p: &PointView| match (place, field) {
        (Some(n), _) => p.state[n],
        (None, "pressure") => p.pressure(),
        (None, "von_mises") => p.von_mises(),
        (None, _) => p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
    };
    body.for_each(&mut |p| visit(p, &value));
    Ok(())
}
