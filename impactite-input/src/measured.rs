//! Measures of a scene as it stands.

use impactite::scene::{Body, Solver};

use crate::build::describe;
use crate::model::measure::{Field, Measurement};
use crate::model::{SceneFile, Space};

/// A measure that the scene cannot give.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("measures.{name}: {why}")]
pub struct MeasureError {
    /// Its name.
    pub name: String,
    /// Why.
    pub why: String,
}

/// Names and SI units of the measures of a scene, in their order.
#[must_use]
pub fn columns(scene: &SceneFile) -> Vec<(String, &'static str)> {
    scene.measures.iter().map(|(name, measure)| (name.clone(), describe::unit(measure))).collect()
}

/// The values of the measures, in SI units. Of a quarter model they are those of the quarter.
///
/// # Errors
/// A field that the law of a body does not keep.
pub fn measure(scene: &SceneFile, solver: &dyn Solver) -> Result<Vec<f64>, MeasureError> {
    let bodies = solver.bodies();
    let one = |name: &String, measure: &Measurement| {
        of(scene.space, &bodies, solver, measure).map_err(|why| MeasureError { name: name.clone(), why })
    };
    scene.measures.iter().map(|(name, measure)| one(name, measure)).collect()
}

/// What a check of a scene asks for, in SI units: the place of its measure, and the reference.
#[must_use]
pub fn reference(scene: &SceneFile, check: usize) -> Option<(usize, f64)> {
    let place = scene.measures.get_index_of(&scene.checks.get(check)?.measure)?;
    Some((place, describe::reference(scene, check).ok()?))
}

fn of(space: Space, bodies: &[&dyn Body], solver: &dyn Solver, measure: &Measurement) -> Result<f64, String> {
    use Measurement as M;
    let find = |name: &str| {
        // Bodies of elements among particles are together one body of the scene.
        let named = |b: &&&dyn Body| b.name() == name || b.name().split(" + ").any(|n| n == name);
        bodies.iter().find(named).copied().ok_or_else(|| format!("the scene has no body `{name}`"))
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
            totals.momentum[space.axis(m.axis)?] / totals.mass
        }
        M::Momentum(m) => find(&m.body)?.totals().momentum[space.axis(m.axis)?],
        M::Kinetic(m) => find(&m.body)?.totals().kinetic,
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
            each(find(&m.body)?, m, &mut |_, value| most = most.max(value))?;
            most
        }
        M::Mean(m) => {
            let (mut mass, mut sum) = (0.0, 0.0);
            each(find(&m.body)?, m, &mut |weight, value| {
                mass += weight;
                sum += weight * value;
            })?;
            sum / mass
        }
        M::EnergyError(_) => solver.account().energy_error(),
    })
}

fn each(body: &dyn Body, field: &Field, visit: &mut dyn FnMut(f64, f64)) -> Result<(), String> {
    let names = body.state_names();
    let place = names.iter().position(|n| *n == field.field);
    if place.is_none() && !["pressure", "von_mises", "speed"].contains(&field.field.as_str()) {
        let kept = if names.is_empty() { "no state".into() } else { names.join(", ") };
        return Err(format!(
            "the law of `{}` keeps no `{}`; there are pressure, von_mises, speed, {kept}",
            field.body, field.field
        ));
    }
    body.for_each(&mut |p| {
        let value = match (place, field.field.as_str()) {
            (Some(n), _) => p.state[n],
            (None, "pressure") => p.pressure(),
            (None, "von_mises") => p.von_mises(),
            (None, _) => p.velocity.iter().map(|v| v * v).sum::<f64>().sqrt(),
        };
        visit(p.mass, value);
    });
    Ok(())
}
