//! Space, axes and vectors.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::formula::{Coordinates, Formula};
use crate::quantity::{Measure, Quantity};

/// Dimensions of space and symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
pub enum Space {
    /// Three dimensions, x, y, z.
    #[serde(rename = "3d")]
    Full,
    /// Plane strain in x, y: no motion along z. Masses, forces and energies are per metre of depth.
    #[serde(rename = "plane strain")]
    PlaneStrain,
    /// Plane stress in x, y: no stress along z. A plate one metre thick, for `elastic` materials.
    #[serde(rename = "plane stress")]
    PlaneStress,
    /// Axisymmetric in r, z around the axis r = 0. Masses, forces and energies are per radian.
    #[serde(rename = "axisymmetric")]
    Axisymmetric,
}

impl Space {
    /// Number of dimensions, 2 or 3.
    #[must_use]
    pub fn dimensions(self) -> usize {
        if self == Space::Full { 3 } else { 2 }
    }
    /// Return the coordinate system.
    #[must_use]
    pub fn coordinates(self) -> Coordinates {
        match self {
            Space::Full => Coordinates::Space,
            Space::PlaneStrain | Space::PlaneStress => Coordinates::Plane,
            Space::Axisymmetric => Coordinates::Revolved,
        }
    }
    /// Return the index of an axis.
    ///
    /// # Errors
    /// Axis that this space does not have.
    pub fn axis(self, axis: Axis) -> Result<usize, String> {
        let (there, list): (&[Axis], &str) = match self {
            Space::Full => (&[Axis::X, Axis::Y, Axis::Z], "x, y, z"),
            Space::PlaneStrain | Space::PlaneStress => (&[Axis::X, Axis::Y], "x, y"),
            Space::Axisymmetric => (&[Axis::R, Axis::Z], "r, z"),
        };
        let missing = || format!("there is no axis {} here; the axes are {list}", axis.name());
        there.iter().position(|a| *a == axis).ok_or_else(missing)
    }
    /// Return the word in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Space::Full => "3d",
            Space::PlaneStrain => "plane strain",
            Space::PlaneStress => "plane stress",
            Space::Axisymmetric => "axisymmetric",
        }
    }
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// x.
    X,
    /// y.
    Y,
    /// z; around an axis the axis itself.
    Z,
    /// The distance from the axis.
    R,
}

impl Axis {
    /// Return the letter of the axis.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
            Axis::R => "r",
        }
    }
}

/// Position, direction or vector of the scene: 2 or 3 quantities.
pub type Vector<U> = Vec<Quantity<U>>;

/// Convert a list to one number per dimension.
pub fn fixed<const D: usize, U: Measure>(list: &[Quantity<U>]) -> Result<[f64; D], String> {
    let numbers: Vec<f64> = list.iter().map(|q| q.value).collect();
    numbers.try_into().map_err(|list: Vec<f64>| components(list.len(), D))
}

/// Convert a list to one formula per dimension.
pub fn formulas<const D: usize, U: Measure>(list: &[Formula<U>]) -> Result<[Formula<U>; D], String> {
    list.to_vec().try_into().map_err(|list: Vec<_>| components(list.len(), D))
}

fn components(found: usize, dimensions: usize) -> String {
    format!("has {found} components; the scene has {dimensions} dimensions")
}
