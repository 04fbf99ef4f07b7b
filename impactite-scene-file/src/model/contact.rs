//! Contact.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::quantity::{Length, Plain, Pressure, Quantity};

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
