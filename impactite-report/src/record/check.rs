//! Comparisons of results with references.

use serde::{Deserialize, Serialize};

use crate::number::{maybe, real};

/// Comparison of a result of the run with a reference. Keys are those of the checks in `result.json` of the example cases.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Check {
    /// Name of the quantity.
    pub name: String,
    /// Result of this run, in `unit`.
    #[serde(with = "real")]
    pub value: f64,
    /// Unit; "-" if dimensionless.
    pub unit: String,
    /// Reference value, or a bound.
    #[serde(default, with = "maybe")]
    pub reference: Option<f64>,
    /// Tolerance relative to the reference (absolute if the reference is 0). `None` for bounds.
    #[serde(default, with = "maybe")]
    pub tolerance: Option<f64>,
    /// Source of the reference.
    #[serde(default)]
    pub source: String,
    /// True if passed; `None` if it is shown but not judged.
    #[serde(default)]
    pub pass: Option<bool>,
    /// Reason of a failure that is expected at present.
    #[serde(default)]
    pub known: Option<String>,
}

impl Check {
    /// Create a check of `value` that is shown but not judged.
    #[must_use]
    pub fn shown(name: impl Into<String>, value: f64, unit: &str, remark: &str) -> Self {
        Check { name: name.into(), value, unit: unit.into(), source: remark.into(), ..Check::default() }
    }

    /// Create a check that `value` is within `tolerance` of `reference`, relative to it (absolute if it is 0). NaN fails.
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

    /// Create a check of `value` against `reference` with a verdict from elsewhere.
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

    /// Set the tolerance: see [`Check::tolerance`].
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Check { tolerance: Some(tolerance), ..self }
    }

    /// Mark the failure as expected at present, with the reason.
    #[must_use]
    pub fn known_miss(self, reason: impl Into<String>) -> Self {
        Check { known: Some(reason.into()), ..self }
    }

    /// Rank in the table: failed, expected failure, passed, shown.
    pub(crate) fn rank(&self) -> u8 {
        match (self.pass, &self.known) {
            (Some(false), None) => 0,
            (Some(false), Some(_)) => 1,
            (Some(true), _) => 2,
            (None, _) => 3,
        }
    }
}
