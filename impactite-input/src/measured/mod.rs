//! Measures of a scene at the current time.

mod past;
pub(crate) mod profile;
mod value;

use std::fmt;
use std::sync::Arc;

use impactite::observe::RunView;
use impactite::scene::{Archive, Body, CheckpointError, Solver};

use crate::build::conditions::accounts;
use crate::build::wrong::Folder;
use crate::build::{describe, shape};
use crate::document::Source;
use crate::model::measure::{Measurement, Profile};
use crate::model::shape::Shape;
use crate::model::{SceneFile, Space};
use crate::quantity::{Length, Quantity, Time};
use past::{Past, Sample};

/// Measure that cannot be evaluated in the scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("measures.{name}: {why}")]
pub struct MeasureError {
    /// Name of the measure.
    pub name: String,
    /// Reason.
    pub why: String,
}

/// Profile that cannot be evaluated in the scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("profiles.{name}: {why}")]
pub struct ProfileError {
    /// Name of the profile.
    pub name: String,
    /// Reason.
    pub why: String,
}

/// Return names and SI units of the measures of a scene, in their order. Masses, momenta, forces and energies are per radian in
/// axisymmetric scenes, `kg/rad`, and per metre of depth in the plane, `kg/m`.
#[must_use]
pub fn columns(scene: &SceneFile) -> Vec<(String, String)> {
    let unit = |measure| describe::unit_in(scene.space, describe::unit(scene, measure));
    scene.measures.iter().map(|(name, measure)| (name.clone(), unit(measure))).collect()
}

/// Return the columns of a profile: the distances of the centres of its bins from the start of its line, m, and the SI unit of its field.
#[must_use]
pub fn profile_columns(profile: &Profile) -> Vec<(String, String)> {
    let unit = describe::field_unit(&profile.field).to_string();
    profile::centres(profile).map(|s| (format!("{s:.4e} m"), unit.clone())).collect()
}

/// Evaluate a profile: a value a bin, in SI units; NaN for a bin without points.
///
/// # Errors
/// Field that the law of the body does not have.
pub fn profile_values(
    scene: &SceneFile,
    name: &str,
    profile: &Profile,
    now: &RunView<'_>,
) -> Result<Vec<f64>, ProfileError> {
    let values = value::profile_values(&value::Now::new(scene.space, now), profile);
    values.map_err(|why| ProfileError { name: name.into(), why })
}

/// Measures of a scene after set-up, with their history over the steps so far.
#[derive(Clone, Debug)]
pub struct Measures {
    space: Space,
    list: Vec<Taken>,
    ends: Vec<End>,
    /// Step number of the last update.
    looked: Option<u64>,
}

/// Measure with its evaluation data and its history.
#[derive(Clone, Debug)]
struct Taken {
    name: String,
    what: Measurement,
    /// Number of the measured point.
    point: Option<usize>,
    /// Region that restricts the points.
    region: Option<Region>,
    /// Accounts of the boundary conditions that it names; `None` for all conditions.
    accounts: Option<Vec<usize>>,
    /// Profile of which it has a bin.
    profile: Option<Profile>,
    past: Past,
}

/// Predicate: true if a position is in the region.
type Contains = dyn Fn(&[f64; 3]) -> bool + Send + Sync;

/// Region fixed in space.
#[derive(Clone)]
struct Region(Arc<Contains>);

impl Region {
    fn contains(&self, place: &[f64; 3]) -> bool {
        (self.0)(place)
    }
}

impl fmt::Debug for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a region")
    }
}

/// Condition on a measure that ends the run.
#[derive(Clone, Debug)]
struct End {
    /// Index of the measure in the list.
    measure: usize,
    below: Option<f64>,
    above: Option<f64>,
    /// True once the measure was on the other side of the limit: its initial value does not end the run.
    armed: [bool; 2],
}

impl Measures {
    /// Create the measures of a scene at its start; points are identified by their initial positions.
    ///
    /// # Errors
    /// Field that the law of a body does not have; body without points; invalid region.
    pub fn new(source: &Source, scene: &SceneFile, solver: &dyn Solver) -> Result<Self, MeasureError> {
        let bodies = solver.bodies();
        let list = scene.measures.iter().map(|(name, what)| {
            let wrong = |why| MeasureError { name: name.clone(), why };
            let at = match what {
                Measurement::PositionAt(at) | Measurement::VelocityAt(at) => Some((&at.body, &at.at)),
                Measurement::ValueAt(at) => Some((&at.body, &at.at)),
                _ => None,
            };
            let point =
                at.map(|(body, at)| nearest(find(&bodies, body)?, at, solver.axisymmetric())).transpose();
            let region = what.region().map(|shape| region(source, scene.space, shape)).transpose();
            Ok(Taken {
                name: name.clone(),
                what: what.clone(),
                point: point.map_err(wrong)?,
                region: region.map_err(wrong)?,
                accounts: accounts(scene, what),
                profile: match what {
                    Measurement::Profile(of) => scene.profiles.get(&of.of).cloned(),
                    _ => None,
                },
                past: Past::default(),
            })
        });
        let list = list.collect::<Result<Vec<_>, _>>()?;
        let ends = scene.until.iter().flat_map(|until| &until.0).map(|until| {
            let value = |of: &Option<_>| of.as_ref().and_then(|of| describe::value(scene, until, of).ok());
            let measure = scene.measures.get_index_of(&until.measure).unwrap_or_default();
            End { measure, below: value(&until.below), above: value(&until.above), armed: [false; 2] }
        });
        let mut measures = Measures { space: scene.space, list, ends: ends.collect(), looked: None };
        let view = RunView::of(solver);
        measures.look(&view)?;
        measures.take(&view)?;
        Ok(measures)
    }

    /// True if [`look`](Self::look) is needed at every step; otherwise it has no effect.
    #[must_use]
    pub fn looks(&self) -> bool {
        let over_steps =
            |taken: &Taken| matches!(taken.what, Measurement::OverTime(_) | Measurement::ConditionForce(_));
        !self.ends.is_empty() || self.list.iter().any(over_steps)
    }

    /// Update the measures, at the start and after every step: measures over time, forces of the last step, and ends by measures.
    ///
    /// # Errors
    /// Field that the law of a body does not have.
    pub fn look(&mut self, view: &RunView<'_>) -> Result<(), MeasureError> {
        let (solver, steps) = (view.solver(), view.step());
        if !self.looks() || self.looked.replace(steps) == Some(steps) {
            return Ok(());
        }
        let (time, now) = (view.time(), value::Now::new(self.space, view));
        for taken in &mut self.list {
            if let Measurement::ConditionForce(of) = &taken.what {
                let axis = self.space.axis(of.axis).unwrap_or_default();
                let value = value::impulse(solver, taken, axis);
                taken.past.enter_rate(Sample { time, value });
            }
        }
        for n in 0..self.list.len() {
            let Measurement::OverTime(over) = &self.list[n].what else { continue };
            let Some(other) = self.list.iter().find(|taken| taken.name == over.of) else { continue };
            let value = self.value(&now, other)?;
            let mean = matches!(other.what, Measurement::ConditionForce(_) | Measurement::ContactForce(_));
            let time_of = |at: &Option<_>, else_at| at.as_ref().map_or(else_at, |q: &Quantity<Time>| q.value);
            let window = [time_of(&over.from, 0.0), time_of(&over.to, f64::INFINITY)];
            self.list[n].past.enter(Sample { time, value }, window, mean);
        }
        for n in 0..self.ends.len() {
            let value = self.value(&now, &self.list[self.ends[n].measure])?;
            let end = &mut self.ends[n];
            end.armed[0] |= end.below.is_some_and(|below| value >= below);
            end.armed[1] |= end.above.is_some_and(|above| value <= above);
        }
        Ok(())
    }

    /// Return the reason for ending the run now: a measure below or above its limit; `None` to continue.
    ///
    /// # Errors
    /// Field that the law of a body does not have.
    pub fn ended(&self, view: &RunView<'_>) -> Result<Option<String>, MeasureError> {
        let now = value::Now::new(self.space, view);
        for end in &self.ends {
            let (taken, [below, above]) = (&self.list[end.measure], end.armed);
            let value = self.value(&now, taken)?;
            let name = &taken.name;
            if let Some(limit) = end.below.filter(|limit| below && value < *limit) {
                return Ok(Some(format!("`{name}` is {value:.6e}, below {limit:.6e}")));
            }
            if let Some(limit) = end.above.filter(|limit| above && value > *limit) {
                return Ok(Some(format!("`{name}` is {value:.6e}, above {limit:.6e}")));
            }
        }
        Ok(None)
    }

    /// Return warnings at the regular end of a run: limits of `until` that were not passed, measures without a value.
    ///
    /// # Errors
    /// Field that the law of a body does not have.
    pub fn missing(&self, view: &RunView<'_>) -> Result<Vec<String>, MeasureError> {
        let mut list = Vec::new();
        let now = value::Now::new(self.space, view);
        for end in &self.ends {
            let taken = &self.list[end.measure];
            let value = self.value(&now, taken)?;
            let name = &taken.name;
            for (word, limit, armed) in
                [("below", end.below, end.armed[0]), ("above", end.above, end.armed[1])]
            {
                let Some(limit) = limit else { continue };
                let why = if armed { "never was" } else { "never was anything but" };
                list.push(format!(
                    "`until` did not end the run: `{name}`, {value:.6e} at `end`, {why} {word} {limit:.6e}; take a later `end`"
                ));
            }
        }
        for taken in &self.list {
            if self.value(&now, taken)?.is_nan() {
                let why = match taken.what {
                    Measurement::OverTime(_) => "nothing was there to measure between its `from` and `to`",
                    _ => "nothing was there to measure at the end",
                };
                list.push(format!("`measures.{}` has no value: {why}", taken.name));
            }
        }
        Ok(list)
    }

    /// Evaluate the measures, in SI units. A quarter model yields the values of the quarter; a removed point yields NaN.
    ///
    /// # Errors
    /// Field that the law of a body does not have.
    pub fn take(&self, view: &RunView<'_>) -> Result<Vec<f64>, MeasureError> {
        let now = value::Now::new(self.space, view);
        self.list.iter().map(|taken| self.value(&now, taken)).collect()
    }

    fn value(&self, now: &value::Now<'_>, taken: &Taken) -> Result<f64, MeasureError> {
        value::of(now, taken).map_err(|why| MeasureError { name: taken.name.clone(), why })
    }

    /// Store or load the history of the measures.
    ///
    /// # Errors
    /// Error of the checkpoint file.
    pub fn archive(&mut self, file: &mut Archive) -> Result<(), CheckpointError> {
        file.option(&mut self.looked, Archive::word)?;
        self.list.iter_mut().try_for_each(|taken| taken.past.archive(file))?;
        self.ends.iter_mut().flat_map(|end| &mut end.armed).try_for_each(|armed| file.flag(armed))
    }
}

/// Return the accounts of the conditions that a measure names.
fn accounts(scene: &SceneFile, what: &Measurement) -> Option<Vec<usize>> {
    let name = match what {
        Measurement::ConditionForce(of) | Measurement::ConditionImpulse(of) => of.condition.as_ref()?,
        Measurement::ConditionWork(of) => &of.condition,
        _ => return None,
    };
    let (all, places) = (accounts::of(scene), accounts::places(scene, name).unwrap_or_default());
    Some(places.iter().filter_map(|place| all.binary_search(place).ok()).collect())
}

/// Build the region of a shape.
fn region(source: &Source, space: Space, shape: &Shape) -> Result<Region, String> {
    fn of<const D: usize>(source: &Source, shape: &Shape) -> Result<Region, String> {
        let built = shape::build::<D>("region", shape, &Folder(source.folder()));
        let built = built.map_err(|wrong| format!("{}: {}", wrong.key, wrong.message))?;
        Ok(Region(Arc::new(move |place| {
            let place: [f64; D] = std::array::from_fn(|d| place[d]);
            built.contains(place)
        })))
    }
    if space == Space::Full { of::<3>(source, shape) } else { of::<2>(source, shape) }
}

/// Find the body of a name.
fn find<'a>(bodies: &[&'a dyn Body], name: &str) -> Result<&'a dyn Body, String> {
    // Bodies of elements among particles are together one body of the scene.
    let named = |b: &&&dyn Body| b.name() == name || b.name().split(" + ").any(|n| n == name);
    bodies.iter().find(named).copied().ok_or_else(|| format!("the scene has no body `{name}`"))
}

/// Find the point nearest to a position; of several the one with the smallest number. A position more than two point widths away is outside
/// the body and refused.
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

/// Return the index of the measure and the reference, in SI units, of a check.
#[must_use]
pub fn reference(scene: &SceneFile, check: usize) -> Option<(usize, f64)> {
    let place = scene.measures.get_index_of(&scene.checks.get(check)?.measure)?;
    Some((place, describe::reference(scene, check).ok()?))
}
