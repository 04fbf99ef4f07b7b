//! Measures: what they are called, and whether they are of what there is.

use super::wrong::{At, Made, known, wrong};
use crate::model::body::MeetBy;
use crate::model::measure::{Measurement, Reference};
use crate::model::{SceneFile, Space};

/// The body of a measure, and its axis.
pub fn check(scene: &SceneFile, key: &str, measure: &Measurement) -> Made<()> {
    let body = |name: &str, word: &str| {
        known(&format!("{key}.{word}.body"), "body", name, scene.expanded.keys().map(String::as_str))
            .map(|_| ())
    };
    let place = |at: &[_], word: &str| {
        let (there, wanted) = (at.len(), scene.space.dimensions());
        if there == wanted {
            return Ok(());
        }
        let message = format!("has {there} components; the scene has {wanted} dimensions");
        wrong(format!("{key}.{word}.at"), message)
    };
    use Measurement as M;
    match measure {
        M::Extent(of)
        | M::Highest(of)
        | M::Lowest(of)
        | M::Centre(of)
        | M::MeanVelocity(of)
        | M::Momentum(of) => {
            let word = word(measure);
            body(&of.body, word)?;
            scene.space.axis(of.axis).at(format!("{key}.{word}.axis"))?;
            Ok(())
        }
        M::Kinetic(of) | M::Internal(of) | M::Mass(of) | M::FailedShare(of) => body(&of.body, word(measure)),
        M::Largest(of) | M::Mean(of) => body(&of.body, word(measure)),
        M::PositionAt(of) | M::VelocityAt(of) => {
            let word = word(measure);
            body(&of.body, word)?;
            place(&of.at, word)?;
            scene.space.axis(of.axis).at(format!("{key}.{word}.axis"))?;
            Ok(())
        }
        M::ValueAt(of) => {
            body(&of.body, word(measure))?;
            place(&of.at, word(measure))
        }
        M::ContactForce(of) => {
            let key = format!("{key}.contact_force");
            for (n, name) in of.between.iter().enumerate() {
                known(
                    &format!("{key}.between[{n}]"),
                    "body",
                    name,
                    scene.expanded.keys().map(String::as_str),
                )?;
            }
            let by_surface = |name: &String| {
                let elements = scene.expanded.get(name).and_then(|body| body.elements.as_ref());
                elements.is_some_and(|e| e.within.is_none() && e.by == MeetBy::Surface)
            };
            if let Some(name) = of.between.iter().find(|name| by_surface(name)) {
                let message = format!(
                    "is not available for `{name}`, whose elements meet particles by their surface; write `bodies.{name}.elements.by = \"grid\"`, or measure the `momentum` of a body"
                );
                return wrong(format!("{key}.between"), message);
            }
            if scene.contact().is_none() {
                return wrong(key, "needs a `contact`: bodies in one velocity field have no contact forces");
            }
            if of.between[0] == of.between[1] {
                return wrong(format!("{key}.between"), "must be two bodies");
            }
            scene.space.axis(of.axis).at(format!("{key}.axis"))?;
            Ok(())
        }
        M::EnergyError(_) => Ok(()),
    }
}

/// The word of files.
pub fn word(measure: &Measurement) -> &'static str {
    use Measurement as M;
    match measure {
        M::Extent(_) => "extent",
        M::Highest(_) => "highest",
        M::Lowest(_) => "lowest",
        M::Centre(_) => "centre",
        M::MeanVelocity(_) => "mean_velocity",
        M::Momentum(_) => "momentum",
        M::Kinetic(_) => "kinetic",
        M::Internal(_) => "internal",
        M::Mass(_) => "mass",
        M::Largest(_) => "largest",
        M::Mean(_) => "mean",
        M::PositionAt(_) => "position_at",
        M::VelocityAt(_) => "velocity_at",
        M::ValueAt(_) => "value_at",
        M::ContactForce(_) => "contact_force",
        M::FailedShare(_) => "failed_share",
        M::EnergyError(_) => "energy_error",
    }
}

/// The SI unit of a measure; "-" of plain numbers.
pub fn unit(measure: &Measurement) -> &'static str {
    use Measurement as M;
    match measure {
        M::Extent(_) | M::Highest(_) | M::Lowest(_) | M::Centre(_) => "m",
        M::PositionAt(_) => "m",
        M::MeanVelocity(_) | M::VelocityAt(_) => "m/s",
        M::ContactForce(_) => "N",
        M::Momentum(_) => "kg m/s",
        M::Kinetic(_) | M::Internal(_) => "J",
        M::Mass(_) => "kg",
        M::Largest(of) | M::Mean(of) => field_unit(&of.field),
        M::ValueAt(of) => field_unit(&of.field),
        M::FailedShare(_) | M::EnergyError(_) => "-",
    }
}

/// The unit of a measure in a space, of which extensive ones are a part: [`unit_of_part`](impactite::scene::embedding::unit_of_part).
pub fn unit_in(space: Space, unit: &'static str) -> &'static str {
    match (unit, space) {
        (_, Space::Full) => unit,
        ("kg", Space::Axisymmetric) => "kg/rad",
        ("kg", _) => "kg/m",
        ("J", Space::Axisymmetric) => "J/rad",
        ("J", _) => "J/m",
        ("N", Space::Axisymmetric) => "N/rad",
        ("N", _) => "N/m",
        ("kg m/s", Space::Axisymmetric) => "(kg m/s)/rad",
        ("kg m/s", _) => "(kg m/s)/m",
        _ => unit,
    }
}

fn field_unit(field: &str) -> &'static str {
    match field {
        "pressure" | "von_mises" => "Pa",
        "speed" => "m/s",
        "temperature" => "K",
        _ => "-",
    }
}

/// What a measure should be, in SI units.
pub fn reference(scene: &SceneFile, check: usize) -> Made<f64> {
    let of = &scene.checks[check];
    let key = format!("checks[{check}].reference");
    let Some(measure) = scene.measures.get(&of.measure) else {
        return wrong(key, format!("no measure has the name `{}`", of.measure));
    };
    match &of.reference {
        Reference::Number(number) if number.is_finite() => Ok(*number),
        Reference::Number(number) => wrong(key, format!("{number} is not finite")),
        Reference::Text(text) => {
            let unit = unit(measure);
            scene.known.quantity(text, if unit == "-" { "" } else { unit }).at(key)
        }
    }
}
