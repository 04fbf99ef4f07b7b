//! Check of a computed number against its reference.
//!
//! | row | constructor | verdict |
//! |---|---|---|
//! | with a reference | [`Check::gate`], [`Check::at_least`], [`Check::at_most`] | passed or failed |
//! | with a reference, known miss | `.known_miss(reason)` | failed, first in the table, does not fail the run |
//! | with a reference, at too coarse a resolution | `.judged_if(resolved, reason)` | none: listed below the table |
//! | with a reference from memory \[M\] | [`Check::remembered`] | none: shown |
//! | without a reference | [`Check::unreferenced`] | none: shown |
//!
//! The verdict is private, so that no other code can remove a row from the count.

use serde::Serialize;

/// Computed number and its reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Name of the quantity.
    pub name: String,
    /// Value of this run, in `unit`.
    pub value: f64,
    /// Unit; "-" if dimensionless.
    pub unit: String,
    /// Reference value, or bound.
    pub reference: Option<f64>,
    /// Tolerance relative to the reference (absolute where the reference is 0). `None` for bounds.
    pub tolerance: Option<f64>,
    /// Source of the reference. \[C\] computed independently, \[M\] from memory of the literature.
    pub source: String,
    pass: Option<bool>,
    known: Option<String>,
    #[serde(skip)]
    unjudged: Option<String>,
}

/// Row that is not judged at the resolution of its run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotJudged {
    /// Name of the quantity.
    pub name: String,
    /// Value of this run, in `unit`.
    pub value: f64,
    /// Unit; "-" if dimensionless.
    pub unit: String,
    /// Reason for not judging it.
    pub reason: String,
}

/// Mark of references from memory of the literature.
const MEMORY: &str = "[M]";

impl Check {
    /// Check that `value` is within `tolerance` of `reference`.
    pub fn gate(
        name: impl Into<String>,
        value: f64,
        unit: &str,
        reference: f64,
        tolerance: f64,
        source: &str,
    ) -> Self {
        let scale = if reference == 0.0 { 1.0 } else { reference.abs() };
        // NaN fails.
        let met = (value - reference).abs() <= tolerance * scale;
        Check { tolerance: Some(tolerance), ..Self::judged(name.into(), value, unit, reference, source, met) }
    }

    /// Check that `value` is not below `reference`.
    pub fn at_least(name: impl Into<String>, value: f64, unit: &str, reference: f64, source: &str) -> Self {
        let met = value.is_finite() && value >= reference;
        Self::judged(format!("{} (at least)", name.into()), value, unit, reference, source, met)
    }

    /// Check that `value` is not above `reference`.
    pub fn at_most(name: impl Into<String>, value: f64, unit: &str, reference: f64, source: &str) -> Self {
        let met = value.is_finite() && value <= reference;
        Self::judged(format!("{} (at most)", name.into()), value, unit, reference, source, met)
    }

    /// Show `value` beside a reference from memory of the literature; it is never judged. The source is marked \[M\] if it is not yet.
    pub fn remembered(name: impl Into<String>, value: f64, unit: &str, reference: f64, source: &str) -> Self {
        let source = if source.contains(MEMORY) { source.into() } else { format!("{source} {MEMORY}") };
        Self::judged(name.into(), value, unit, reference, &source, false)
    }

    /// Show a number without a known reference; it is never judged.
    pub fn unreferenced(name: impl Into<String>, value: f64, unit: &str, remark: &str) -> Self {
        let (name, unit, source) = (name.into(), unit.into(), remark.into());
        Check {
            name,
            value,
            unit,
            reference: None,
            tolerance: None,
            source,
            pass: None,
            known: None,
            unjudged: None,
        }
    }

    fn judged(name: String, value: f64, unit: &str, reference: f64, source: &str, met: bool) -> Self {
        let pass = (!source.contains(MEMORY)).then_some(met);
        Check { reference: Some(reference), pass, ..Self::unreferenced(name, value, unit, source) }
    }

    /// Declare this row as a known miss, with the reason. It counts as missed and stands first in the table, with the
    /// reason; it does not fail the run unless it is not a number. If it passes, the table reports that, and the
    /// declaration should be removed.
    #[must_use]
    pub fn known_miss(self, reason: &str) -> Self {
        Check { known: self.pass.map(|_| reason.into()), ..self }
    }

    /// Judge this row only if the run is `resolved` enough. That must follow from the set-up, never from the value.
    /// Otherwise the row is listed below the table, with its value and the reason, and is not in the table.
    #[must_use]
    pub fn judged_if(self, resolved: bool, reason: &str) -> Self {
        if resolved { self } else { Check { unjudged: Some(reason.into()), ..self } }
    }

    /// Verdict: true if passed; `None` without a reference, and for one from memory.
    pub fn pass(&self) -> Option<bool> {
        self.pass
    }

    /// Reason for the known miss.
    pub fn known(&self) -> Option<&str> {
        self.known.as_deref()
    }

    /// True if the check fails the run: it failed and is no known miss, or failed as NaN.
    pub fn fails(&self) -> bool {
        self.pass == Some(false) && (self.known.is_none() || self.value.is_nan())
    }

    /// Sort key in the table: failures of the run, known misses, known misses that pass, passed rows, rows that are only shown.
    pub(crate) fn rank(&self) -> u8 {
        match (self.pass, self.known.is_some()) {
            (Some(false), _) if self.fails() => 0,
            (Some(false), _) => 1,
            (Some(true), true) => 2,
            (Some(true), false) => 3,
            (None, _) => 4,
        }
    }

    /// Return the check if it is judged or shown, otherwise its row of those that are not judged.
    pub(crate) fn sorted_out(self) -> Result<Check, NotJudged> {
        match self.unjudged {
            None => Ok(self),
            Some(reason) => Err(NotJudged { name: self.name, value: self.value, unit: self.unit, reason }),
        }
    }

    pub(crate) fn verdict(&self) -> String {
        let Some(pass) = self.pass else { return String::new() };
        let allowed = self.tolerance.map_or(String::new(), |t| format!(" ({})", self.allowed(t)));
        match (pass, &self.known) {
            (true, None) => format!("met{allowed}"),
            (true, Some(reason)) => format!("met (declared as missed: {reason})"),
            (false, None) => format!("MISSED{allowed}"),
            (false, Some(reason)) => format!("MISSED{allowed}; declared: {reason}"),
        }
    }

    fn allowed(&self, tolerance: f64) -> String {
        if self.reference == Some(0.0) {
            format!("{tolerance:.0e} allowed")
        } else {
            format!("{:.3} % allowed", 100.0 * tolerance).replace(".000 %", " %").replace("00 %", " %")
        }
    }

    pub(crate) fn difference(&self) -> String {
        match self.reference {
            Some(r) if r != 0.0 => format!("{:+.2} %", 100.0 * (self.value / r - 1.0)),
            _ => String::new(),
        }
    }
}

/// Format a number with its unit.
pub(crate) fn shown(x: f64, unit: &str) -> String {
    let number = match x.abs() {
        0.0 => "0".to_string(),
        a if (0.01..1e5).contains(&a) => format!("{x:.3}"),
        _ => format!("{x:.2e}"),
    };
    if unit == "-" { number } else { format!("{number} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gate_is_relative_unless_the_reference_is_zero() {
        let pass = |value, reference, tolerance| {
            Check::gate("x", value, "-", reference, tolerance, "test").pass == Some(true)
        };
        assert!(pass(16.4, 16.28, 0.015));
        assert!(!pass(16.6, 16.28, 0.015));
        assert!(pass(-0.009, 0.0, 0.01));
        assert!(!pass(f64::NAN, 0.0, 0.01));
    }

    /// Holds for every constructor and declaration.
    #[test]
    fn a_reference_from_memory_cannot_decide() {
        let source = "experiment [M]";
        for value in [1.0, 9.0, f64::NAN] {
            for check in [
                Check::gate("x", value, "-", 1.0, 0.1, source),
                Check::at_least("x", value, "-", 2.0, source),
                Check::at_most("x", value, "-", 2.0, source),
                Check::remembered("x", value, "-", 1.0, "experiment"),
            ] {
                assert!(check.source.contains(MEMORY));
                for check in [check.clone(), check.known_miss("declared")] {
                    assert_eq!((check.pass(), check.known(), check.fails()), (None, None, false));
                }
            }
        }
    }

    #[test]
    fn only_what_has_no_reference_is_not_judged() {
        assert_eq!(Check::unreferenced("x", 1.0, "-", "").pass(), None);
        assert!(Check::gate("x", 1.0, "-", 2.0, 0.1, "[C]").pass().is_some());
        assert!(Check::at_most("x", f64::INFINITY, "-", 2.0, "").fails());
    }

    #[test]
    fn no_declaration_covers_what_is_not_a_number() {
        assert!(Check::gate("x", f64::NAN, "-", 1.0, 0.1, "").known_miss("declared").fails());
        assert!(!Check::gate("x", 2.0, "-", 1.0, 0.1, "").known_miss("declared").fails());
    }
}
