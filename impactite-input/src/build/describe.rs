//! Measures: names, units and validity in the scene.

use super::conditions::accounts;
use super::wrong::{At, Made, known, wrong};
use crate::model::body::MeetBy;
use crate::model::measure::{Measurement, OverTime, Reference, Statistic, Until};
use crate::model::{SceneFile, Space};

/// Check that body, axis and place of a measure are valid in the scene.
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
        M::Highest(of) | M::Lowest(of) => {
            let word = word(measure);
            body(&of.body, word)?;
            scene.space.axis(of.axis).at(format!("{key}.{word}.axis"))?;
            let share = of.share.map_or(0.0, |share| share.value);
            if (0.0..=1.0).contains(&share) {
                return Ok(());
            }
            wrong(format!("{key}.{word}.share"), format!("{share} is not allowed; it must be from 0 to 1"))
        }
        M::Extent(of) | M::Centre(of) | M::MeanVelocity(of) | M::Momentum(of) => {
            let word = word(measure);
            body(&of.body, word)?;
            scene.space.axis(of.axis).at(format!("{key}.{word}.axis"))?;
            Ok(())
        }
        M::Kinetic(of) | M::Internal(of) => body(&of.body, word(measure)),
        M::Mass(of) | M::Volume(of) | M::FailedShare(of) => body(&of.body, word(measure)),
        M::Largest(of) | M::Smallest(of) | M::Mean(of) => body(&of.body, word(measure)),
        M::AngularMomentum(of) => {
            let word = word(measure);
            body(&of.body, word)?;
            of.about.as_ref().map_or(Ok(()), |about| {
                let (there, wanted) = (about.len(), scene.space.dimensions());
                let message = format!("has {there} components; the scene has {wanted} dimensions");
                if there == wanted { Ok(()) } else { wrong(format!("{key}.{word}.about"), message) }
            })?;
            match (scene.space, of.axis) {
                (Space::Axisymmetric, _) => wrong(
                    format!("{key}.{word}"),
                    "is not of axisymmetric scenes, in which nothing turns about the axis",
                ),
                (Space::Full, None) => wrong(format!("{key}.{word}"), "needs an `axis`: x, y or z"),
                (Space::Full, Some(axis)) => {
                    scene.space.axis(axis).at(format!("{key}.{word}.axis")).map(|_| ())
                }
                (_, Some(_)) => wrong(
                    format!("{key}.{word}.axis"),
                    "is not of scenes in the plane, whose bodies turn about z alone; leave it out",
                ),
                (_, None) => Ok(()),
            }
        }
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
        M::ConditionForce(of) | M::ConditionImpulse(of) => {
            let whole = key;
            let key = format!("{key}.{}", word(measure));
            if scene.conditions.is_empty() {
                return wrong(key, "needs `conditions`; the scene has none");
            }
            accounts::check(scene, whole, measure)?;
            scene.space.axis(of.axis).at(format!("{key}.axis")).map(|_| ())
        }
        M::ConditionWork(_) => accounts::check(scene, key, measure),
        M::SurfaceArea(of) => body(&of.body, word(measure)),
        M::Profile(of) => {
            let key = format!("{key}.profile");
            known(&format!("{key}.of"), "profile", &of.of, scene.profiles.keys().map(String::as_str))?;
            let bins = scene.profiles.get(&of.of).map_or(0, |profile| profile.bins);
            if (1..=bins).contains(&of.bin) {
                return Ok(());
            }
            let message = format!("{} is not allowed; it must be 1 to {bins}", of.bin);
            wrong(format!("{key}.bin"), message)
        }
        M::OverTime(of) => over_time(scene, &format!("{key}.over_time"), of),
        M::Balance(_) | M::EnergyError(_) | M::KineticShare(_) => Ok(()),
    }
}

fn over_time(scene: &SceneFile, key: &str, over: &OverTime) -> Made<()> {
    let of_key = format!("{key}.of");
    known(&of_key, "measure", &over.of, scene.measures.keys().map(String::as_str))?;
    if matches!(scene.measures.get(&over.of), Some(Measurement::OverTime(_))) {
        return wrong(of_key, format!("`{}` is over time itself; name what that is of", over.of));
    }
    let (from, to) = (over.from.map_or(0.0, |q| q.value), over.to.map_or(scene.end.value, |q| q.value));
    if from < 0.0 || from >= scene.end.value {
        let end = scene.end.value;
        return wrong(
            format!("{key}.from"),
            format!("{from} s is not allowed; it must be 0 or more and below `end`, {end} s"),
        );
    }
    if to <= from {
        return wrong(
            format!("{key}.to"),
            format!("{to} s is not allowed; it must be above `from`, {from} s"),
        );
    }
    Ok(())
}

/// Check the names and values of the measures in `until`.
pub fn ends(scene: &SceneFile) -> Made<()> {
    for (key, until) in scene.until.iter().flat_map(|until| until.keyed("until")) {
        known(
            &format!("{key}.measure"),
            "measure",
            &until.measure,
            scene.measures.keys().map(String::as_str),
        )?;
        let values = [("below", &until.below), ("above", &until.above)];
        let given = values.iter().filter_map(|(word, value)| Some((word, value.as_ref()?)));
        let mut any = false;
        for (word, of) in given {
            any = true;
            value(scene, until, of).at(format!("{key}.{word}"))?;
        }
        if !any {
            return wrong(key, "needs `below` or `above`");
        }
    }
    Ok(())
}

/// Return the value of a condition of `until`, in SI units.
pub fn value(scene: &SceneFile, until: &Until, of: &Reference) -> Result<f64, String> {
    let measure = scene.measures.get(&until.measure);
    let measure = measure.ok_or_else(|| format!("no measure has the name `{}`", until.measure))?;
    number(scene, measure, of)
}

/// Return the key of a measure in scene files.
pub fn word(measure: &Measurement) -> &'static str {
    use Measurement as M;
    match measure {
        M::Extent(_) => "extent",
        M::Highest(_) => "highest",
        M::Lowest(_) => "lowest",
        M::Centre(_) => "centre",
        M::MeanVelocity(_) => "mean_velocity",
        M::Momentum(_) => "momentum",
        M::AngularMomentum(_) => "angular_momentum",
        M::Kinetic(_) => "kinetic",
        M::Internal(_) => "internal",
        M::Mass(_) => "mass",
        M::Volume(_) => "volume",
        M::Largest(_) => "largest",
        M::Smallest(_) => "smallest",
        M::Mean(_) => "mean",
        M::PositionAt(_) => "position_at",
        M::VelocityAt(_) => "velocity_at",
        M::ValueAt(_) => "value_at",
        M::ContactForce(_) => "contact_force",
        M::ConditionForce(_) => "condition_force",
        M::ConditionImpulse(_) => "condition_impulse",
        M::ConditionWork(_) => "condition_work",
        M::SurfaceArea(_) => "surface_area",
        M::Profile(_) => "profile",
        M::KineticShare(_) => "kinetic_share",
        M::FailedShare(_) => "failed_share",
        M::Balance(_) => "balance",
        M::EnergyError(_) => "energy_error",
        M::OverTime(_) => "over_time",
    }
}

/// Return the SI unit of a measure; "-" for plain numbers.
pub fn unit(scene: &SceneFile, measure: &Measurement) -> &'static str {
    use Measurement as M;
    match measure {
        M::Extent(_) | M::Highest(_) | M::Lowest(_) | M::Centre(_) => "m",
        M::PositionAt(_) => "m",
        M::MeanVelocity(_) | M::VelocityAt(_) => "m/s",
        M::ContactForce(_) | M::ConditionForce(_) => "N",
        M::ConditionImpulse(_) => "N s",
        M::Momentum(_) => "kg m/s",
        M::AngularMomentum(_) => "kg m^2/s",
        M::Kinetic(_) | M::Internal(_) | M::Balance(_) | M::ConditionWork(_) => "J",
        M::SurfaceArea(_) => "m^2",
        M::Profile(of) => scene.profiles.get(&of.of).map_or("-", |profile| field_unit(&profile.field)),
        M::Mass(_) => "kg",
        M::Volume(_) => "m^3",
        M::Largest(of) | M::Smallest(of) | M::Mean(of) => field_unit(&of.field),
        M::ValueAt(of) => field_unit(&of.field),
        M::FailedShare(_) | M::EnergyError(_) | M::KineticShare(_) => "-",
        M::OverTime(of) => {
            let unit = match scene.measures.get(&of.of) {
                // An `over_time` of an `over_time` is invalid.
                None | Some(M::OverTime(_)) => "-",
                Some(measure) => unit(scene, measure),
            };
            match of.take {
                Statistic::TimeOfLargest | Statistic::TimeOfSmallest => "s",
                Statistic::Integral => times_seconds(unit),
                Statistic::Largest | Statistic::Smallest | Statistic::Mean => unit,
            }
        }
    }
}

/// Return the unit of the integral over time.
fn times_seconds(unit: &'static str) -> &'static str {
    match unit {
        "m" => "m s",
        "m/s" => "m",
        "N" => "N s",
        "N s" => "N s^2",
        "kg m/s" => "kg m",
        "kg m^2/s" => "kg m^2",
        "J" => "J s",
        "kg" => "kg s",
        "m^2" => "m^2 s",
        "m^3" => "m^3 s",
        "kg/m^3" => "kg s/m^3",
        "Pa" => "Pa s",
        "K" => "K s",
        _ => "s",
    }
}

/// Return the unit of a measure in a space: extensive quantities are per radian or per metre of depth.
pub fn unit_in(space: Space, unit: &str) -> String {
    let extensive = ["kg", "J", "N", "m^2", "m^3"].iter().any(|of| unit.split(' ').next() == Some(of));
    if !extensive {
        return unit.into();
    }
    impactite::scene::embedding::unit_of_part(unit, space.dimensions(), space == Space::Axisymmetric)
}

/// Return the SI unit of a field.
pub fn field_unit(field: &str) -> &'static str {
    match field {
        "pressure" | "von_mises" => "Pa",
        "speed" => "m/s",
        "temperature" => "K",
        "density" => "kg/m^3",
        _ if field.starts_with("position_") => "m",
        _ if field.starts_with("velocity_") => "m/s",
        _ if field.starts_with("stress_") => "Pa",
        _ => "-",
    }
}

/// Return the reference of a check, in SI units.
pub fn reference(scene: &SceneFile, check: usize) -> Made<f64> {
    let of = &scene.checks[check];
    let key = format!("checks[{check}].reference");
    let Some(measure) = scene.measures.get(&of.measure) else {
        return wrong(key, format!("no measure has the name `{}`", of.measure));
    };
    number(scene, measure, &of.reference).at(key)
}

/// Convert a value of a measure to SI units.
fn number(scene: &SceneFile, measure: &Measurement, of: &Reference) -> Result<f64, String> {
    match of {
        Reference::Number(number) if number.is_finite() => Ok(*number),
        Reference::Number(number) => Err(format!("{number} is not finite")),
        Reference::Text(text) => {
            let unit = unit(scene, measure);
            scene.known.quantity(text, if unit == "-" { "" } else { unit })
        }
    }
}
