//! Output of a run.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::parts::parts;
use super::{Axis, Vector};
use crate::quantity::{Length, Plain, Quantity, Time};

/// What is written while a scene runs, and how often.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Simulated time between rows of histories; a four hundredth of `end` if not given.
    #[serde(default)]
    pub histories: Option<Quantity<Time>>,
    /// Simulated time between pictures; a fortieth of `end` if not given.
    #[serde(default)]
    pub pictures: Option<Quantity<Time>>,
    /// Simulated time between frames for ParaView; an eighth of `end` if not given.
    #[serde(default)]
    pub frames: Option<Quantity<Time>>,
    /// Fields in the frames for ParaView; all if not given. `displacement` is where a point is, less where it was first seen, m.
    #[serde(default)]
    pub fields: Option<Vec<String>>,
    /// What files the frames for ParaView are.
    #[serde(default)]
    pub format: FrameFormat,
    /// What gives the colour of pictures: a field, or bodies if not given.
    #[serde(default)]
    pub colour: Option<Colour>,
    /// From where pictures look: from the matter to the eye; in space.
    #[serde(default)]
    pub seen_from: Option<[Quantity<Plain>; 3]>,
    /// Mirror images across planes of symmetry in pictures: where an axis has one such plane if not given, `false` for none, or a list of
    /// axes, across all their planes.
    #[serde(default)]
    #[schemars(example = false)]
    pub mirror: Mirror,
    /// The part of space that pictures show; if not given, that of the bodies at the start and where they fly, which grows as they leave it.
    #[serde(default)]
    pub window: Option<Window>,
}

parts! {
    /// A box that pictures show.
    Window {
        /// The corner with the smallest coordinates.
        from: Vector<Length>,
        /// The corner with the largest coordinates.
        #[schemars(example = ("60 mm", "40 mm"))]
        to: Vector<Length>,
    }
}

/// Planes of symmetry at which pictures have mirror images.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// At each axis with exactly one plane (`true`), or nowhere (`false`).
    Single(bool),
    /// At all planes normal to these axes.
    Axes(Vec<Axis>),
}

impl Default for Mirror {
    fn default() -> Self {
        Mirror::Single(true)
    }
}

impl<'de> Deserialize<'de> for Mirror {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reads;
        impl<'de> serde::de::Visitor<'de> for Reads {
            type Value = Mirror;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                write!(f, "true, false, or a list of axes, as [\"x\"]")
            }
            fn visit_bool<E: serde::de::Error>(self, v: bool) -> Result<Mirror, E> {
                Ok(Mirror::Single(v))
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(self, list: A) -> Result<Mirror, A::Error> {
                Vec::deserialize(serde::de::value::SeqAccessDeserializer::new(list)).map(Mirror::Axes)
            }
        }
        from.deserialize_any(Reads)
    }
}

impl JsonSchema for Mirror {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Mirror".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "true: across the plane of symmetry of each axis that has one; false: none; or a list of axes: across all their planes",
            "anyOf": [
                { "type": "boolean" },
                { "type": "array", "items": { "enum": ["x", "y", "z", "r"] } },
            ],
        })
    }
}

/// What files the frames for ParaView are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[non_exhaustive]
#[serde(rename_all = "lowercase")]
pub enum FrameFormat {
    /// VTK's XML: `.vtp`, of elements `.vtu`, and a `.pvd`.
    #[default]
    Xml,
    /// VTK's HDF5: `.vtkhdf` and a `.vtkhdf.series`, of programs with the feature `hdf5`.
    Vtkhdf,
}

/// The colour of pictures.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[non_exhaustive]
#[serde(deny_unknown_fields)]
pub struct Colour {
    /// A field: a number of the law's state, `pressure`, `von_mises`, `speed`, or a component, as `velocity_x` and `stress_xy`. Bodies
    /// without it are grey.
    pub field: String,
    /// Where the colours begin and end, in SI units; if not given, round numbers that hold all values so far.
    #[serde(default)]
    pub range: Option<[Quantity<Plain>; 2]>,
}
