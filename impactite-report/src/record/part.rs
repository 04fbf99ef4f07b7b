//! Fraction of the whole body that a scene models.

use impactite_scene::embedding::{part_in_words, unit_of_part};
use serde::{Deserialize, Serialize};

/// Fraction of the whole body that the scene models: extensive quantities refer to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Part {
    /// Number of symmetry planes: a quarter has two.
    pub planes: u32,
    /// Reference measure of a scene of less than three dimensions.
    pub per: Per,
}

/// Reference measure of extensive quantities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Per {
    /// None: whole quantities.
    #[default]
    Whole,
    /// Per radian about an axis: times 2 pi for a full revolution.
    Radian,
    /// Per metre of depth.
    Depth,
    /// Per square metre of cross-section.
    Area,
}

impl Part {
    /// The fraction in words, `one quarter of the body`; `None` for the whole.
    #[must_use]
    pub fn share(&self) -> Option<String> {
        match self.planes {
            0 => None,
            1 => Some("one half of the body".into()),
            2 => Some("one quarter of the body".into()),
            3 => Some("one eighth of the body".into()),
            n => Some(format!("one part in {} of the body", 2_f64.powi(n.min(64) as i32))),
        }
    }

    /// Note on the reference of masses, momenta, forces and energies, one sentence; `None` if they refer to the whole.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let factor = 2_f64.powi(self.planes.min(64) as i32);
        let (dimensions, axisymmetric) = self.per.of();
        let words = part_in_words(dimensions, axisymmetric).trim();
        let turn = if axisymmetric { " (times 2π for a whole turn)" } else { "" };
        let per = (!words.is_empty()).then(|| format!("{words}{turn}"));
        let what = "masses, momenta, forces and energies are";
        match (self.share(), per) {
            (None, None) => None,
            (None, Some(per)) => Some(format!("{} {per}.", capital(what))),
            (Some(share), None) => {
                Some(format!("{}: {what} of that part (times {factor} for the whole).", capital(&share)))
            }
            (Some(share), Some(per)) => Some(format!(
                "{}: {what} of that part (times {factor} for the whole), and {per}.",
                capital(&share)
            )),
        }
    }

    /// Unit of an extensive quantity: [`unit_of_part`].
    pub(crate) fn unit(&self, unit: &str) -> String {
        let (dimensions, axisymmetric) = self.per.of();
        unit_of_part(unit, dimensions, axisymmetric)
    }

    /// Names of the axes of the scene.
    pub(crate) fn axes(&self, dimensions: usize) -> &'static [&'static str] {
        match (self.per, dimensions) {
            (Per::Radian, _) => &["r", "z"],
            (_, 1) => &["x"],
            (_, 2) => &["x", "y"],
            _ => &["x", "y", "z"],
        }
    }
}

impl Per {
    /// Number of dimensions of the scene, and true if axisymmetric.
    fn of(self) -> (usize, bool) {
        match self {
            Per::Whole => (3, false),
            Per::Radian => (2, true),
            Per::Depth => (2, false),
            Per::Area => (1, false),
        }
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
