//! Boundary conditions that measures name, and their accounts.

use impactite::scene::ACCOUNTS;

use crate::build::wrong::{Made, Wrong, wrong};
use crate::hint::near;
use crate::model::SceneFile;
use crate::model::condition::Condition;
use crate::model::measure::{ConditionName, Measurement};
use crate::model::method::Method;

/// Return the places of the conditions of a name, a kind or a place in the list.
///
/// # Errors
/// No such condition, with the names that exist.
pub(crate) fn places(scene: &SceneFile, of: &ConditionName) -> Result<Vec<usize>, (String, Option<String>)> {
    let list = &scene.conditions;
    let all = |is: &dyn Fn(&Condition) -> bool| -> Vec<usize> {
        list.iter().enumerate().filter(|(_, c)| is(c)).map(|(n, _)| n).collect()
    };
    let (found, said, help) = match of {
        ConditionName::Place(n) => {
            let found = if (*n as usize) < list.len() { vec![*n as usize] } else { Vec::new() };
            (found, format!("no condition has the place {n}; there are {}, from 0", list.len()), None)
        }
        ConditionName::Name(name) => {
            let named = all(&|c| c.name() == Some(name));
            let found = if named.is_empty() { all(&|c| c.kind() == name) } else { named };
            let mut words: Vec<&str> =
                list.iter().flat_map(|c| [c.name(), Some(c.kind())]).flatten().collect();
            words.sort_unstable();
            words.dedup();
            let help = near(name, words.iter().copied()).map(|n| format!("did you mean `{n}`?"));
            let there = words.join(", ");
            (found, format!("no condition has the name or kind `{name}`; there are {there}"), help)
        }
    };
    if found.is_empty() { Err((said, help)) } else { Ok(found) }
}

/// Return the condition that a measure names, with its key within the measure.
fn named(measure: &Measurement) -> Option<(&'static str, &ConditionName)> {
    match measure {
        Measurement::ConditionForce(of) => Some(("condition_force", of.condition.as_ref()?)),
        Measurement::ConditionImpulse(of) => Some(("condition_impulse", of.condition.as_ref()?)),
        Measurement::ConditionWork(of) => Some(("condition_work", &of.condition)),
        _ => None,
    }
}

/// Return the places of the conditions that have an account: the place in the list is the account.
pub(crate) fn of(scene: &SceneFile) -> Vec<usize> {
    let mut list: Vec<usize> = scene
        .measures
        .values()
        .filter_map(|measure| places(scene, named(measure)?.1).ok())
        .flatten()
        .collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// Check the condition that a measure names.
pub(in crate::build) fn check(scene: &SceneFile, key: &str, measure: &Measurement) -> Made<()> {
    let Some((word, name)) = named(measure) else { return Ok(()) };
    let key = format!("{key}.{word}.condition");
    let found = places(scene, name).map_err(|(message, help)| Wrong { key: key.clone(), message, help })?;
    let grid = matches!(scene.method, Method::Mpm(_) | Method::Sph(_));
    for n in found {
        let condition = &scene.conditions[n];
        if matches!(condition, Condition::Periodic(_)) {
            return wrong(key, "periodic planes exert no force");
        }
        let Condition::Symmetry(plane) = condition else { continue };
        let is_other = |(m, c): (usize, &Condition)| {
            m != n && matches!(c, Condition::Symmetry(other) if other.axis == plane.axis)
        };
        if grid && scene.conditions.iter().enumerate().any(is_other) {
            let message = format!(
                "two planes of symmetry are across the axis {}: their forces are not told apart in this method; make one of them a `wall`",
                plane.axis.name()
            );
            return wrong(key, message);
        }
    }
    let count = of(scene).len();
    if count > ACCOUNTS {
        return wrong(key, format!("measures name {count} conditions; at most {ACCOUNTS} are allowed"));
    }
    Ok(())
}
