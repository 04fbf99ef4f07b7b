//! Conditions.

use schemars::JsonSchema;
use serde::Deserialize;

use super::Axis;
use super::parts::parts;
use super::shape::Shape;
use crate::formula::Formula;
use crate::quantity::{Length, Plain, Quantity, Speed};

/// A condition on velocities.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// A plane of symmetry.
    Symmetry(Plane),
    /// A rigid wall that only pushes; with friction, and moving, where that is given.
    Wall(Wall),
    /// A plane that waves pass.
    Absorbing(Absorbing),
    /// Two planes that are one.
    Periodic(Periodic),
    /// All on and behind a plane stands still.
    Fixed(Plane),
    /// What is in a region has a velocity.
    Prescribed(Prescribed),
}

/// On which side of a plane the material is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Where the coordinate is larger.
    #[default]
    Above,
    /// Where it is smaller.
    Below,
}

parts! {
    /// A plane across an axis.
    Plane {
        /// The axis.
        axis: Axis,
        /// Where.
        at: Quantity<Length>,
        /// Where the material is; above if not given.
        #[serde(default)]
        side: Side,
    }
    /// A wall across an axis.
    Wall {
        /// The axis.
        axis: Axis,
        /// Where it is at the start.
        at: Quantity<Length>,
        /// Where the material is; above if not given.
        #[serde(default)]
        side: Side,
        /// Its velocity; one component an axis. At rest if not given.
        #[serde(default)]
        velocity: Option<Vec<Quantity<Speed>>>,
        /// Coefficient of friction; none if not given.
        #[serde(default)]
        friction: Option<Quantity<Plain>>,
    }
    /// A plane with dashpots.
    Absorbing {
        /// The axis.
        axis: Axis,
        /// Where.
        at: Quantity<Length>,
        /// Where the material is; above if not given.
        #[serde(default)]
        side: Side,
        /// Speed of longitudinal waves.
        longitudinal: Quantity<Speed>,
        /// Speed of shear waves.
        shear: Quantity<Speed>,
    }
    /// A period along an axis.
    Periodic {
        /// The axis.
        axis: Axis,
        /// The lower plane.
        low: Quantity<Length>,
        /// The upper plane.
        high: Quantity<Length>,
    }
    /// A region and its velocity.
    Prescribed {
        /// The region, fixed in space.
        region: Shape,
        /// Velocity along each axis: a number, a formula of time, or "free".
        velocity: Vec<MayBeFree>,
    }
}

/// A velocity, or none: `"free"`.
#[derive(Clone, Debug)]
pub struct MayBeFree(pub Option<Formula<Speed>>);

impl<'de> Deserialize<'de> for MayBeFree {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl serde::de::Visitor<'_> for Reads {
            type Value = MayBeFree;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "a speed, a formula of time, or \"free\"")
            }
            fn visit_f64<E: serde::de::Error>(self, v: f64) -> Result<MayBeFree, E> {
                serde::de::value::F64Deserializer::new(v).into_formula()
            }
            fn visit_i64<E: serde::de::Error>(self, v: i64) -> Result<MayBeFree, E> {
                serde::de::value::I64Deserializer::new(v).into_formula()
            }
            fn visit_str<E: serde::de::Error>(self, v: &str) -> Result<MayBeFree, E> {
                if v.trim() == "free" {
                    return Ok(MayBeFree(None));
                }
                serde::de::value::StrDeserializer::new(v).into_formula()
            }
        }
        trait IntoFormula<E> {
            fn into_formula(self) -> Result<MayBeFree, E>;
        }
        impl<'de, E: serde::de::Error, T: serde::Deserializer<'de, Error = E>> IntoFormula<E> for T {
            fn into_formula(self) -> Result<MayBeFree, E> {
                Formula::deserialize(self).map(|f| MayBeFree(Some(f)))
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for MayBeFree {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "SpeedOrFree".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "description": "A speed in m/s, a text with a unit, a formula of time, or \"free\"", "type": ["number", "string"] })
    }
}
