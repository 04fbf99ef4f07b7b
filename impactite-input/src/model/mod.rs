//! What a scene file holds, as types. Every key is checked where it is read; the [schema](crate::schema) is generated from these types.

pub mod body;
pub mod condition;
pub mod contact;
pub mod material;
pub mod measure;
pub mod method;
pub mod output;
pub mod shape;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::formula::{Coordinates, Formula};
use crate::quantity::{Acceleration, Measure, Parameters, Quantity, Time};
use body::Body;
use condition::Condition;
use contact::Contact;
use material::Material;
use measure::{Check, Measurement};
use method::{Method, TimeStep};
use output::Output;

/// A scene: bodies of materials, how they are computed, what acts on them, and what is written.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneFile {
    /// A name for pages and pictures.
    pub title: String,
    /// What the scene shows, and where its numbers are from.
    #[serde(default)]
    pub description: String,
    /// How the scene lies in space.
    pub space: Space,
    /// Simulated time, s.
    pub end: Quantity<Time>,
    /// Named values, with which all quantities after them may be written: `radius = "3.8 mm"`.
    #[serde(default)]
    pub parameters: IndexMap<String, Parameter>,
    /// The method of the scene, with its options: `[method.mpm]`, `[method.fem]`, `[method.sph]`, `[method.fpm]`, `[method.pcmm]`.
    pub method: Method,
    /// The materials, by name.
    pub materials: IndexMap<String, Material>,
    /// The bodies, by name, in the order in which they are added.
    pub bodies: IndexMap<String, Body>,
    /// How bodies act on each other. Without it they share one velocity field (`mpm`), or do not meet.
    #[serde(default)]
    pub contact: Option<Contact>,
    /// Planes of symmetry, walls, prescribed velocities.
    #[serde(default)]
    pub conditions: Vec<Condition>,
    /// Acceleration of everything, m/s^2: numbers, or formulas of time.
    #[serde(default)]
    pub gravity: Option<Vec<Formula<Acceleration>>>,
    /// How steps are chosen; without it as the method does.
    #[serde(default)]
    pub time_step: Option<TimeStep>,
    /// Does a gain of energy that nothing explains only warn, instead of stopping the run?
    #[serde(default)]
    pub only_warn: bool,
    /// Numbers of interest, by name: columns of `measures.csv`, of sweeps, and of checks.
    #[serde(default)]
    pub measures: IndexMap<String, Measurement>,
    /// What measures should be at the end.
    #[serde(default)]
    pub checks: Vec<Check>,
    /// What is written while the scene runs.
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

/// Most bodies that a repetition makes.
const MOST: u64 = 4096;

impl SceneFile {
    /// Bodies that are repeated, one by one.
    ///
    /// # Errors
    /// The key, and what is wrong there.
    pub(crate) fn expand(&mut self) -> Result<(), (String, String)> {
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
                let moved = shape::MovedShape {
                    shape: shape.clone(),
                    by: Some(by.collect()),
                    turn: None,
                    axis: None,
                    about: None,
                };
                let one =
                    Body { shape: Some(shape::Shape::Moved(Box::new(moved))), repeat: None, ..body.clone() };
                all.insert(format!("{name} {}", n + 1), one);
            }
        }
        self.expanded = all;
        Ok(())
    }
}

/// A named value: a number, or a text with a unit or arithmetic with the parameters before it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Parameter {
    /// A plain number.
    Number(f64),
    /// A text: `"3.8 mm"`, `"radius / 10"`.
    Text(String),
}

/// How a scene lies in space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
pub enum Space {
    /// Three dimensions: x, y, z.
    #[serde(rename = "3d")]
    Full,
    /// x and y; nothing moves along z, and everything is per metre of depth.
    #[serde(rename = "plane strain")]
    PlaneStrain,
    /// x and y, without stress along z: plates, one metre thick at the start. For materials that have a law of plates (`elastic`).
    #[serde(rename = "plane stress")]
    PlaneStress,
    /// r and z around the axis r = 0; everything is per radian.
    #[serde(rename = "axisymmetric")]
    Axisymmetric,
}

impl Space {
    /// 2 or 3.
    #[must_use]
    pub fn dimensions(self) -> usize {
        if self == Space::Full { 3 } else { 2 }
    }
    /// Which coordinates there are.
    #[must_use]
    pub fn coordinates(self) -> Coordinates {
        match self {
            Space::Full => Coordinates::Space,
            Space::PlaneStrain | Space::PlaneStress => Coordinates::Plane,
            Space::Axisymmetric => Coordinates::Revolved,
        }
    }
    /// The number of an axis.
    ///
    /// # Errors
    /// An axis that there is not.
    pub fn axis(self, axis: Axis) -> Result<usize, String> {
        let (there, list): (&[Axis], &str) = match self {
            Space::Full => (&[Axis::X, Axis::Y, Axis::Z], "x, y, z"),
            Space::PlaneStrain | Space::PlaneStress => (&[Axis::X, Axis::Y], "x, y"),
            Space::Axisymmetric => (&[Axis::R, Axis::Z], "r, z"),
        };
        let missing = || format!("there is no axis {} here; the axes are {list}", axis.name());
        there.iter().position(|a| *a == axis).ok_or_else(missing)
    }
    /// The word of files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Space::Full => "3d",
            Space::PlaneStrain => "plane strain",
            Space::PlaneStress => "plane stress",
            Space::Axisymmetric => "axisymmetric",
        }
    }
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// x.
    X,
    /// y.
    Y,
    /// z; around an axis the axis itself.
    Z,
    /// The distance from the axis.
    R,
}

impl Axis {
    /// Its letter.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
            Axis::R => "r",
        }
    }
}

/// A place, direction or vector of the scene: 2 or 3 quantities.
pub type Vector<U> = Vec<Quantity<U>>;

/// As many numbers as there are dimensions.
pub(crate) fn fixed<const D: usize, U: Measure>(list: &[Quantity<U>]) -> Result<[f64; D], String> {
    let numbers: Vec<f64> = list.iter().map(|q| q.value).collect();
    numbers.try_into().map_err(|list: Vec<f64>| components(list.len(), D))
}

/// As many formulas as there are dimensions.
pub(crate) fn formulas<const D: usize, U: Measure>(list: &[Formula<U>]) -> Result<[Formula<U>; D], String> {
    list.to_vec().try_into().map_err(|list: Vec<_>| components(list.len(), D))
}

fn components(found: usize, dimensions: usize) -> String {
    format!("has {found} components; the scene has {dimensions} dimensions")
}
