//! Measures and checks.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Axis, Vector};
use crate::quantity::{Length, Plain, Quantity};

/// A number of the scene at a time.
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
    /// Momentum over mass, m/s.
    MeanVelocity(OfBody),
    /// Momentum, kg m/s.
    Momentum(OfBody),
    /// Kinetic energy, J.
    Kinetic(Whole),
    /// Internal energy, J.
    Internal(Whole),
    /// Mass, kg.
    Mass(Whole),
    /// Largest of a number of the law's state, or of `pressure`, `von_mises`, `speed`.
    Largest(Field),
    /// Mean, by mass, of the same.
    Mean(Field),
    /// Coordinate, along an axis, of the point of a body that was nearest to a place at the start, m; no number once it is gone.
    PositionAt(AtPlace),
    /// The same of its velocity, m/s.
    VelocityAt(AtPlace),
    /// There, a number of the law's state, or `pressure`, `von_mises`, `speed`.
    ValueAt(FieldAtPlace),
    /// Contact force along an axis on the second of two bodies, mean of the last step, N.
    ContactForce(Between),
    /// Points that failed, over all points of the body.
    FailedShare(Whole),
    /// Energy error: change of the total energy that nothing explains, over the largest energy so far. Negative: lost.
    EnergyError(super::contact::Nothing),
}

/// Of a body, along an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct OfBody {
    /// The body's name.
    pub body: String,
    /// The axis.
    pub axis: Axis,
}

/// Of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Whole {
    /// The body's name.
    pub body: String,
}

/// Of the point of a body that was nearest to a place at the start, along an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct AtPlace {
    /// The body's name.
    pub body: String,
    /// The place.
    pub at: Vector<Length>,
    /// The axis.
    pub axis: Axis,
}

/// A field at the point of a body that was nearest to a place at the start.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct FieldAtPlace {
    /// The body's name.
    pub body: String,
    /// The place.
    pub at: Vector<Length>,
    /// The field: a number of the law's state (as `plastic_strain`), `pressure`, `von_mises` or `speed`.
    pub field: String,
}

/// Of two bodies, along an axis.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Between {
    /// The bodies' names.
    pub between: [String; 2],
    /// The axis.
    pub axis: Axis,
}

/// A field of a body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Field {
    /// The body's name.
    pub body: String,
    /// The field: a number of the law's state (as `plastic_strain`), `pressure`, `von_mises` or `speed`.
    pub field: String,
}

/// What a measure should be at the end.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Name of the measure.
    pub measure: String,
    /// What it should be: a number in SI units, or a text with a unit.
    pub reference: Reference,
    /// Allowed difference over the reference (absolute where the reference is 0).
    pub tolerance: Quantity<Plain>,
    /// Where the reference is from.
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
