//! Contact.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::quantity::{Length, Plain, Pressure, Quantity};

/// Contact of the bodies, or none: `"none"`.
#[derive(Clone, Debug)]
pub enum Meeting {
    /// Bodies share one velocity field (`mpm`): they stick to each other without resistance at their surfaces.
    None,
    /// Contact by laws.
    By(Contact),
}

impl<'de> Deserialize<'de> for Meeting {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl<'de> serde::de::Visitor<'de> for Reads {
            type Value = Meeting;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "a table with a `law`, or \"none\"")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Meeting, E> {
                match text {
                    "none" => Ok(Meeting::None),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(text), &self)),
                }
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<Meeting, A::Error> {
                Contact::deserialize(serde::de::value::MapAccessDeserializer::new(map)).map(Meeting::By)
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for Meeting {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ContactOrNone".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let contact = generator.subschema_for::<Contact>();
        schemars::json_schema!({
            "description": "Contact of the bodies, or \"none\": one velocity field (`mpm`)",
            "anyOf": [contact, { "const": "none" }],
        })
    }
}

/// How bodies act on each other.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// The law of all pairs that are not among `pairs`.
    pub law: Law,
    /// Laws of pairs of bodies.
    #[serde(default)]
    pub pairs: Vec<Pair>,
    /// How contact is found on the grid (`mpm`); between particles (`sph`, `pcmm`, `fpm`) it is by the distance of the surfaces.
    #[serde(default)]
    pub detector: Detector,
}

/// A pair of bodies with a law of their own.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// The names of the bodies.
    pub between: [String; 2],
    /// Their law.
    pub law: Law,
}

/// How contact is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Detector {
    /// By the distance of the surfaces along a separating plane.
    #[default]
    SurfaceDistance,
    /// Where bodies approach, with normals by gradients of mass.
    Approach,
    /// By the plane of a logistic regression (slowest, best at edges).
    Regression,
}

/// A contact law.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Coulomb friction with this coefficient; 0: none.
    Friction(Quantity<Plain>),
    /// Friction that falls with slip.
    SlipWeakening(SlipWeakening),
    /// Bodies stick where they touch.
    Stick(Nothing),
    /// Bodies stick until a strength is reached.
    Adhesion(Adhesion),
}

/// No options.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Nothing {}

/// Friction that falls with slip.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct SlipWeakening {
    /// Static coefficient.
    pub at_rest: Quantity<Plain>,
    /// Kinetic coefficient.
    pub sliding: Quantity<Plain>,
    /// Slip over which it falls.
    pub distance: Quantity<Length>,
}

/// Strength of a bond.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Adhesion {
    /// Tensile strength.
    pub strength: Quantity<Pressure>,
    /// Shear strength.
    pub shear: Quantity<Pressure>,
    /// Coefficient of friction afterwards.
    #[serde(default)]
    pub friction: Quantity<Plain>,
}
