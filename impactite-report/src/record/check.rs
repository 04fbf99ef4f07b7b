//! Numbers of a run beside what they should be.

use serde::{Deserialize, Serialize};

use crate::number::{maybe, real};

/// A number of a run beside what it should be. Keys are those of the checks in `result.json` of the example cases.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Check {
    /// What it is.
    pub name: String,
    /// This run's, in `unit`.
    #[serde(with = "real")]
    pub value: f64,
    /// Its unit; "-" if it has none.
    pub unit: String,
    /// What it should be, or the bound that it keeps to.
    #[serde(default, with = "maybe")]
    pub reference: Option<f64>,
    /// How far from the reference it may be, relative to it (absolute where the reference is 0). `None` of bounds.
    #[serde(default, with = "maybe")]
    pub tolerance: Option<f64>,
    /// Where the reference is from.
    #[serde(default)]
    pub source: String,
    /// Is it met? `None` if it is shown and not judged.
    #[serde(default)]
    pub pass: Option<bool>,
    /// Why it is declared as missed at present.
    #[serde(default)]
    pub known: Option<String>,
}

impl Check {
    /// `value` that is shown and not judged.
    #[must_use]
    pub fn shown(name: impl Into<String>, value: f64, unit: &str, remark: &str) -> Self {
        Check { name: name.into(), value, unit: unit.into(), source: remark.into(), ..Check::default() }
    }

    /// `value` within `tolerance` of `reference`, relative to it (absolute where it is 0). NaN is not.
    #[must_use]
    pub fn within(
        name: impl Into<String>,
        value: f64,
        unit: &str,
        reference: f64,
        tolerance: f64,
        source: &str,
    ) -> Self {
        let scale = if reference == 0.0 { 1.0 } else { reference.abs() };
        let met = (value - reference).abs() <= tolerance * scale;
        Check::judged(name, value, unit, reference, source, met).with_tolerance(tolerance)
    }

    /// `value` beside `reference`, which another one judged.
    #[must_use]
    pub fn judged(
        name: impl Into<String>,
        value: f64,
        unit: &str,
        reference: f64,
        source: &str,
        met: bool,
    ) -> Self {
        let shown = Check::shown(name, value, unit, source);
        Check { reference: Some(reference), pass: Some(met), ..shown }
    }

    /// How far from the reference it may be, as [`Check::tolerance`].
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Check { tolerance: Some(tolerance), ..self }
    }

    /// Declared as missed at present, and why.
    #[must_use]
    pub fn known_miss(self, reason: impl Into<String>) -> Self {
        Check { known: Some(reason.into()), ..self }
    }

    /// Its place in the table: missed, declared as missed, met, shown.
    pub(crate) fn rank(&self) -> u8 {
        match (self.pass, &self.known) {
            (Some(false), None) => 0,
            (Some(false), Some(_)) => 1,
            (Some(true), _) => 2,
            (None, _) => 3,
        }
    }
}
