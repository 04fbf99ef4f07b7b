//! Root table of a scene file.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

use super::body::Body;
use super::condition::Condition;
use super::contact::{Contact, ContactChoice};
use super::material::Material;
use super::measure::{Check, Measurement, Profile, Until};
use super::method::{Method, TimeStep};
use super::output::Output;
use super::over_time::TableSpec;
use super::several::Several;
use super::shape::{Bodies, MovedShape, Shape};
use super::space::Space;
use crate::formula::Formula;
use crate::quantity::{Acceleration, Parameters, Plain, Quantity, Time};

/// A scene: bodies, materials, method, loads, output.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// Name of the scene, for pages and pictures.
    #[schemars(example = "A copper bar on a wall")]
    pub title: String,
    /// Description: what the scene shows, and sources of its numbers.
    #[serde(default)]
    #[schemars(example = "Constants of Johnson and Cook 1983.")]
    pub description: String,
    /// Dimensions of space and symmetry.
    #[schemars(example = "plane strain")]
    pub space: Space,
    /// End of the simulated time.
    #[schemars(example = "80 us", extend("exclusiveMinimum" = 0))]
    pub end: Quantity<Time>,
    /// Ends of the run before `end`: when a measure is below or above a value. One table, or a list of them, of which the first counts.
    #[serde(default)]
    #[schemars(extend("examples" = [{"measure": "speed", "below": "1 m/s"}]))]
    pub until: Option<Several<Until>>,
    /// Named values, with which all quantities after them may be written.
    #[serde(default)]
    pub parameters: IndexMap<String, Parameter>,
    /// Named values over time, which formulas may contain as a variable: `"= 2 * pulse"`.
    #[serde(default)]
    pub tables: IndexMap<String, TableSpec>,
    /// Method of the scene, with its options.
    pub method: Method,
    /// Materials, by name.
    pub materials: IndexMap<String, Material>,
    /// Bodies, by name.
    pub bodies: IndexMap<String, Body>,
    /// Contact of bodies; required by scenes of several bodies. `"none"`: bodies of `mpm` share one velocity field and stick to each other.
    #[serde(default)]
    pub contact: Option<ContactChoice>,
    /// Boundary conditions.
    #[serde(default)]
    pub conditions: Vec<Condition>,
    /// Acceleration of all bodies, a component an axis: numbers, or formulas of time.
    #[serde(default)]
    #[schemars(example = (0, "-9.81 m/s^2"))]
    pub gravity: Option<Vec<Formula<Acceleration>>>,
    /// Time step. If not given: adaptive, a part of the stable step that suits the method.
    #[serde(default)]
    pub time_step: Option<TimeStep>,
    /// Factor on the masses of all bodies, for slow processes in which inertia does not matter: steps are longer by its square root. Weights
    /// stay. Kinetic over internal energy is reported, and a run at whose end it is above 5 % warns.
    #[serde(default)]
    #[schemars(example = 100, extend("minimum" = 1))]
    pub mass_scaling: Option<Quantity<Plain>>,
    /// Unexplained gain of energy: warn (`true`) instead of stopping the run.
    #[serde(default)]
    pub only_warn: bool,
    /// Measures, by name: columns of `measures.csv` and of sweeps, and values of checks.
    #[serde(default)]
    pub measures: IndexMap<String, Measurement>,
    /// Values of fields along lines, by name: `profiles/NAME.csv`.
    #[serde(default)]
    pub profiles: IndexMap<String, Profile>,
    /// Checks of measures at the end of the run.
    #[serde(default)]
    pub checks: Vec<Check>,
    /// Output while the scene runs.
    #[serde(default)]
    pub output: Output,
    /// The bodies of the scene, repeated ones one by one.
    #[serde(skip)]
    #[schemars(skip)]
    pub expanded: IndexMap<String, Body>,
    /// The parameters, with their units.
    #[serde(skip)]
    #[schemars(skip)]
    pub known: Parameters,
}

/// Maximum number of repeated bodies.
const MOST: u64 = 100_000;

impl SceneFile {
    /// Return the contact of the bodies; `None` for a single body and for bodies that share one velocity field.
    #[must_use]
    pub fn contact(&self) -> Option<&Contact> {
        match &self.contact {
            Some(ContactChoice::By(contact)) => Some(contact),
            Some(ContactChoice::None) | None => None,
        }
    }

    /// Expand repeated bodies to single ones.
    ///
    /// # Errors
    /// Key and reason.
    pub fn expand(&mut self) -> Result<(), (String, String)> {
        let mut all = IndexMap::new();
        for (name, body) in &self.bodies {
            let Some(repeat) = &body.repeat else {
                all.insert(name.clone(), body.clone());
                continue;
            };
            let key = format!("bodies.{name}.repeat");
            let dimensions = self.space.dimensions();
            if repeat.counts.len() != dimensions || repeat.step.len() != dimensions {
                return Err((key, format!("`counts` and `step` need {dimensions} components")));
            }
            let count = repeat
                .counts
                .iter()
                .map(|&c| u64::from(c))
                .try_fold(1u64, u64::checked_mul)
                .unwrap_or(u64::MAX);
            if !(1..=MOST).contains(&count) {
                return Err((key, format!("makes {count} bodies; 1 to {MOST} are allowed")));
            }
            let Some(shape) = &body.shape else {
                return Err((key, "is of bodies with a `shape`".into()));
            };
            for n in 0..count {
                let mut rest = n;
                let by = repeat.counts.iter().zip(&repeat.step).map(|(&count, step)| {
                    let place = rest % u64::from(count);
                    rest /= u64::from(count);
                    Quantity::new(place as f64 * step.value)
                });
                let moved = MovedShape {
                    shape: shape.clone(),
                    by: Some(by.collect()),
                    turn: None,
                    axis: None,
                    about: None,
                };
                let one = Body { shape: Some(Shape::Moved(Box::new(moved))), repeat: None, ..body.clone() };
                all.insert(format!("{name} {}", n + 1), one);
            }
        }
        self.expanded = all;
        self.resolve();
        Ok(())
    }

    /// Replace references to bodies by their shapes.
    fn resolve(&mut self) {
        /// Maximum number of resolved references.
        const NAMES: usize = 100_000;
        let spec = |body: &Body| body.shape.clone();
        let mut shapes: IndexMap<String, Option<Shape>> =
            self.expanded.iter().map(|(name, body)| (name.clone(), spec(body))).collect();
        for name in self.bodies.keys().filter(|name| !self.expanded.contains_key(*name)) {
            let copy =
                |other: &&String| other.strip_prefix(name.as_str()).is_some_and(|n| n.starts_with(' '));
            let copies =
                self.expanded.keys().filter(copy).filter_map(|other| shapes.get(other).cloned().flatten());
            let all = Shape::Union(copies.collect());
            shapes.insert(name.clone(), Some(all));
        }
        let mut bodies = Bodies { shapes: &shapes, trail: Vec::new(), left: NAMES };
        for (name, body) in &mut self.expanded {
            bodies.trail.push(name.clone());
            body.shape.iter_mut().for_each(|shape| shape.resolve(&mut bodies));
            bodies.trail.pop();
            body.traction.0.iter_mut().flat_map(|load| &mut load.region).for_each(|r| r.resolve(&mut bodies));
        }
        if let Method::Mpm(mpm) = &mut self.method {
            mpm.refine
                .0
                .iter_mut()
                .flat_map(|r| &mut r.region)
                .for_each(|region| region.resolve(&mut bodies));
        }
        for condition in &mut self.conditions {
            if let Condition::Prescribed(prescribed) = condition {
                prescribed.region.resolve(&mut bodies);
            }
        }
        for measure in self.measures.values_mut() {
            measure.region_mut().into_iter().for_each(|region| region.resolve(&mut bodies));
        }
    }
}

/// A named value: a number, or a text with a unit or arithmetic with the parameters before it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(example = "3.8 mm")]
pub enum Parameter {
    /// A plain number.
    Number(f64),
    /// A text: `"3.8 mm"`, `"radius / 10"`.
    Text(String),
}
