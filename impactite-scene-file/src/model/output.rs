//! What is written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::{Plain, Quantity, Time};

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
    /// A field: a number of the law's state, `pressure`, `von_mises`, `velocity` (its magnitude).
    pub field: String,
    /// Where the colours begin and end, in SI units; the values of each picture if not given.
    #[serde(default)]
    pub range: Option<[Quantity<Plain>; 2]>,
}
