//! The file as a whole.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

use super::body::Body;
use super::condition::Condition;
use super::contact::{Contact, Meeting};
use super::material::Material;
use super::measure::{Check, Measurement};
use super::method::{Method, TimeStep};
use super::output::Output;
use super::shape::{MovedShape, Shape};
use super::space::Space;
use crate::formula::Formula;
use crate::quantity::{Acceleration, Parameters, Quantity, Time};

/// A scene: bodies of materials, how they are computed, what acts on them, and what is written.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
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
    /// How bodies act on each other; needed by scenes of several bodies.
    #[serde(default)]
    pub contact: Option<Meeting>,
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
    /// Contact of the bodies; none of one body, and of bodies that share one velocity field.
    #[must_use]
    pub fn contact(&self) -> Option<&Contact> {
        match &self.contact {
            Some(Meeting::By(contact)) => Some(contact),
            Some(Meeting::None) | None => None,
        }
    }

    /// Bodies that are repeated, one by one.
    ///
    /// # Errors
    /// The key, and what is wrong there.
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
