//! Boundary conditions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Axis;
use super::parts::parts;
use super::shape::Shape;
use crate::formula::Formula;
use crate::quantity::{Length, Plain, Quantity, Speed};

/// A boundary condition.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Plane of symmetry: no velocity across it.
    Symmetry(Plane),
    /// Rigid wall: no velocity into it; with friction, and moving, where these keys are given.
    Wall(Wall),
    /// Absorbing plane: dashpots that let waves pass.
    Absorbing(Absorbing),
    /// Periodic planes: what leaves through one enters through the other.
    Periodic(Periodic),
    /// Fixed plane: no velocity on and behind it.
    Fixed(Plane),
    /// Prescribed velocity in a region.
    Prescribed(Prescribed),
}

impl Condition {
    /// Word of the kind of the condition.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Condition::Symmetry(_) => "symmetry",
            Condition::Wall(_) => "wall",
            Condition::Absorbing(_) => "absorbing",
            Condition::Periodic(_) => "periodic",
            Condition::Fixed(_) => "fixed",
            Condition::Prescribed(_) => "prescribed",
        }
    }
    /// Name of the condition, if it has one.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        match self {
            Condition::Symmetry(plane) | Condition::Fixed(plane) => plane.name.as_deref(),
            Condition::Wall(wall) => wall.name.as_deref(),
            Condition::Absorbing(plane) => plane.name.as_deref(),
            Condition::Prescribed(prescribed) => prescribed.name.as_deref(),
            Condition::Periodic(_) => None,
        }
    }
}

/// Side of a plane on which the material is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Where the coordinate is larger than `at`.
    #[default]
    Above,
    /// Where the coordinate is smaller than `at`.
    Below,
}

parts! {
    /// A plane across an axis.
    Plane {
        /// Axis normal to the plane.
        axis: Axis,
        /// Coordinate of the plane.
        #[schemars(example = 0)]
        at: Quantity<Length>,
        /// Side of the plane on which the material is.
        #[serde(default)]
        #[schemars(example = &"below")]
        side: Side,
        /// Name of the condition, for measures; several conditions of one name are measured together.
        #[serde(default)]
        #[schemars(example = &"base")]
        name: Option<String>,
    }
    /// A wall across an axis.
    Wall {
        /// Axis normal to the wall.
        axis: Axis,
        /// Initial coordinate of the wall.
        #[schemars(example = 0)]
        at: Quantity<Length>,
        /// Side of the wall on which the material is.
        #[serde(default)]
        #[schemars(example = &"below")]
        side: Side,
        /// Velocity of the wall, a component an axis: numbers, or formulas of time; at rest if not given.
        #[serde(default)]
        #[schemars(example = (0, "2 m/s"))]
        velocity: Option<Vec<Formula<Speed>>>,
        /// Coordinate of the wall over time, a formula that begins at `at`; instead of `velocity`.
        #[serde(default)]
        #[schemars(example = &"= 0.02 * sin(50 * t)")]
        position: Option<Formula<Length>>,
        /// Coefficient of Coulomb friction; frictionless if not given.
        #[serde(default)]
        #[schemars(example = 0.3, extend("minimum" = 0))]
        friction: Option<Quantity<Plain>>,
        /// Name of the condition, for measures; several conditions of one name are measured together.
        #[serde(default)]
        #[schemars(example = &"floor")]
        name: Option<String>,
    }
    /// A plane with dashpots.
    Absorbing {
        /// Axis normal to the plane.
        axis: Axis,
        /// Coordinate of the plane.
        #[schemars(example = 0)]
        at: Quantity<Length>,
        /// Side of the plane on which the material is.
        #[serde(default)]
        #[schemars(example = &"below")]
        side: Side,
        /// Speed of longitudinal waves in the material.
        #[schemars(example = "5.9 km/s")]
        longitudinal: Quantity<Speed>,
        /// Speed of shear waves in the material.
        #[schemars(example = "3.2 km/s")]
        shear: Quantity<Speed>,
        /// Name of the condition, for measures; several conditions of one name are measured together.
        #[serde(default)]
        #[schemars(example = &"far end")]
        name: Option<String>,
    }
    /// A period along an axis.
    Periodic {
        /// Axis of the period.
        axis: Axis,
        /// Coordinate of the lower plane.
        #[schemars(example = 0)]
        low: Quantity<Length>,
        /// Coordinate of the upper plane.
        #[schemars(example = "20 mm")]
        high: Quantity<Length>,
    }
    /// A region and its velocity.
    Prescribed {
        /// The region: fixed in space, or moving with its matter where `follows` is given.
        region: Shape,
        /// Velocity, a component an axis: a number, a formula of time, or `"free"`.
        #[schemars(example = ("= 2 * t", "free"))]
        velocity: Vec<MayBeFree>,
        /// The region moves with the prescribed velocity, so that matter that starts in it stays in it: a grip. Along free axes it stays
        /// where it is.
        #[serde(default)]
        follows: bool,
        /// Name of the condition, for measures; several conditions of one name are measured together.
        #[serde(default)]
        #[schemars(example = &"grip")]
        name: Option<String>,
    }
}

/// Velocity, or unconstrained: `"free"`.
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
