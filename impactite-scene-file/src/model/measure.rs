//! Measures and checks.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Axis, Vector};
use crate::quantity::{Length, Plain, Quantity};

/// A measured number of the scene. `measures.csv` has it over time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Measurement {
    /// Extent of a body along an axis, between the surfaces of its outermost points, m.
    Extent(OfBody),
    /// Largest coordinate of the centres of a body's points, m.
    Highest(OfBody),
    /// Smallest coordinate of the centres of a body's points, m.
    Lowest(OfBody),
    /// Coordinate of the centre of mass, m.
    Centre(OfBody),
    /// Mean velocity: momentum over mass, m/s.
    MeanVelocity(OfBody),
    /// Momentum, kg m/s.
    Momentum(OfBody),
    /// Kinetic energy, J.
    Kinetic(Whole),
    /// Internal energy, J.
    Internal(Whole),
    /// Mass, kg.
    Mass(Whole),
    /// Largest value of a field over the points of a body.
    Largest(Field),
    /// Mean value of a field, by mass.
    Mean(Field),
    /// Coordinate of the point of a body that was nearest to a place at the start, m; no number once the point is gone.
    PositionAt(AtPlace),
    /// Velocity of the point of a body that was nearest to a place at the start, m/s.
    VelocityAt(AtPlace),
    /// Value of a field at the point of a body that was nearest to a place at the start.
    ValueAt(FieldAtPlace),
    /// Contact force along an axis on the second of two bodies, mean of the last step, N.
    ContactForce(Between),
    /// Failed points over all points of the body.
    FailedShare(Whole),
    /// Energy error: change of the total energy that nothing explains, over the largest energy so far. Negative: lost.
    EnergyError(super::contact::Nothing),
}

/// Of a body, along an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct OfBody {
    /// Name of the body.
    #[schemars(example = &"body")]
    pub body: String,
    /// The axis.
    #[schemars(example = &"y")]
    pub axis: Axis,
}

/// Of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Whole {
    /// Name of the body.
    #[schemars(example = &"body")]
    pub body: String,
}

/// Of the point of a body that was nearest to a place at the start, along an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct AtPlace {
    /// Name of the body.
    #[schemars(example = &"body")]
    pub body: String,
    /// Place at the start.
    #[schemars(example = (0, "5 mm"))]
    pub at: Vector<Length>,
    /// The axis.
    #[schemars(example = &"y")]
    pub axis: Axis,
}

/// A field at the point of a body that was nearest to a place at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct FieldAtPlace {
    /// Name of the body.
    #[schemars(example = &"body")]
    pub body: String,
    /// Place at the start.
    #[schemars(example = (0, "5 mm"))]
    pub at: Vector<Length>,
    /// The field: `pressure`, `von_mises`, `speed`, or a state variable of the law, as `plastic_strain`, `temperature`, `damage`.
    #[schemars(example = &"von_mises")]
    pub field: String,
}

/// Of two bodies, along an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Between {
    /// Names of the two bodies.
    #[schemars(example = ("rod", "plate"))]
    pub between: [String; 2],
    /// The axis.
    #[schemars(example = &"y")]
    pub axis: Axis,
}

/// A field of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// Name of the body.
    #[schemars(example = &"body")]
    pub body: String,
    /// The field: `pressure`, `von_mises`, `speed`, or a state variable of the law, as `plastic_strain`, `temperature`, `damage`.
    #[schemars(example = &"von_mises")]
    pub field: String,
}

/// A comparison of a measure at the end with a reference. A failed check makes the exit code 1.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Name of the measure.
    #[schemars(example = &"length")]
    pub measure: String,
    /// Reference value: a number in SI units, or a text with a unit.
    #[schemars(example = "16.28 mm")]
    pub reference: Reference,
    /// Allowed difference over the reference; absolute where the reference is 0.
    #[schemars(example = 0.02, extend("exclusiveMinimum" = 0))]
    pub tolerance: Quantity<Plain>,
    /// Source of the reference.
    #[schemars(example = "finite elements with the same law")]
    pub source: String,
}

/// A number in the measure's SI unit, or a text with a unit.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Reference {
    /// In SI units.
    Number(f64),
    /// With a unit.
    Text(String),
}
