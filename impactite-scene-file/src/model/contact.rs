//! Contact.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::{Length, Plain, Pressure, Quantity};

/// Default frequency of a penalty law, over c / h.
pub const PENALTY_FREQUENCY: f64 = 0.9;
/// Default restitution of a penalty law.
pub const PENALTY_RESTITUTION: f64 = 0.8;

/// Contact of the bodies, or no contact: `"none"`.
#[derive(Clone, Debug)]
pub enum ContactChoice {
    /// Bodies share one velocity field (`mpm`): they stick to each other without resistance at their surfaces.
    None,
    /// Contact by laws.
    By(Contact),
}

impl<'de> Deserialize<'de> for ContactChoice {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl<'de> serde::de::Visitor<'de> for Reads {
            type Value = ContactChoice;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "a table with a `law`, or \"none\"")
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<ContactChoice, E> {
                match text {
                    "none" => Ok(ContactChoice::None),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(text), &self)),
                }
            }
            fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<ContactChoice, A::Error> {
                Contact::deserialize(serde::de::value::MapAccessDeserializer::new(map)).map(ContactChoice::By)
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for ContactChoice {
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

/// Contact of bodies.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Law of all pairs of bodies that are not among `pairs`.
    pub law: Law,
    /// Laws of single pairs of bodies.
    #[serde(default)]
    pub pairs: Vec<Pair>,
    /// Detection of contact on the grid (`mpm`). `sph`, `pcmm` and `fpm` have `surface_distance` alone, `fem` finds nodes on facets.
    #[serde(default)]
    pub detector: Detector,
}

/// A pair of bodies with a law of their own.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Names of the two bodies.
    #[schemars(example = ("rod", "plate"))]
    pub between: [String; 2],
    /// Law of the pair.
    pub law: Law,
}

/// Detection of contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Detector {
    /// Distance of the surfaces along a separating plane.
    #[default]
    SurfaceDistance,
    /// Approach of the bodies' velocities at a node, with normals by gradients of mass.
    Approach,
    /// Approach, where the traction between the bodies is compressive (Bardenhagen).
    Compression,
    /// Distance of all particles around a node, with normals by gradients of mass (Ma).
    GradientDistance,
    /// Distance along the line through the node, with normals by gradients of mass.
    LocalGradientDistance,
    /// Distance of particle centres, closer than half a cell, with normals by gradients of mass (Zhang).
    CentreDistance,
    /// Separating plane by logistic regression, and the margin between the bodies: slowest, best at edges.
    Regression,
    /// Distance of all particles around a node, with normals by logistic regression.
    RegressionDistance,
    /// Distance along the line through the node, with normals by logistic regression.
    LocalRegressionDistance,
}

/// A contact law.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Coulomb friction with this coefficient; 0 is frictionless.
    #[schemars(extend("examples" = [{"friction": 0.3}]))]
    Friction(Quantity<Plain>),
    /// Friction that falls with slip (`mpm`).
    SlipWeakening(SlipWeakening),
    /// Springs where surfaces overlap, which return the energy of a collision (particles of `mpm`, with a detector of distances).
    Penalty(Penalty),
    /// No slip where bodies touch: `law.stick = {}`.
    Stick(Nothing),
    /// Bond that breaks at a strength.
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
    /// Static coefficient of friction.
    #[schemars(example = 0.6)]
    pub at_rest: Quantity<Plain>,
    /// Kinetic coefficient of friction.
    #[schemars(example = 0.3)]
    pub sliding: Quantity<Plain>,
    /// Slip over which the coefficient falls from static to kinetic.
    #[schemars(example = "0.1 mm")]
    pub distance: Quantity<Length>,
}

/// Spring between surfaces.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Penalty {
    /// Angular frequency of the spring over the wave speed of the slower body over the cell.
    #[serde(default)]
    #[schemars(example = 0.9, extend("default" = PENALTY_FREQUENCY, "minimum" = 0.1, "maximum" = 2))]
    pub frequency: Option<Quantity<Plain>>,
    /// Restitution of two colliding masses.
    #[serde(default)]
    #[schemars(example = 0.8, extend("default" = PENALTY_RESTITUTION, "minimum" = 0.1, "maximum" = 1))]
    pub restitution: Option<Quantity<Plain>>,
    /// Coefficient of friction.
    #[serde(default)]
    #[schemars(example = 0.3)]
    pub friction: Quantity<Plain>,
}

/// Strength of a bond.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Adhesion {
    /// Tensile strength of the bond.
    #[schemars(example = "5 MPa")]
    pub strength: Quantity<Pressure>,
    /// Shear strength of the bond.
    #[schemars(example = "8 MPa")]
    pub shear: Quantity<Pressure>,
    /// Coefficient of friction after the bond has broken.
    #[serde(default)]
    #[schemars(example = 0.3)]
    pub friction: Quantity<Plain>,
}
