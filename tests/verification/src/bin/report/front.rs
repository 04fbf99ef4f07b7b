//! Which runs are not beaten: none is both cheaper and more accurate.

use crate::record::Record;

/// What a run costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Particle-steps times nodes a particle.
    Units,
    /// Core-seconds.
    Seconds,
}

impl Cost {
    /// Of a run.
    pub fn of(self, record: &Record) -> f64 {
        match self {
            Cost::Units => record.units,
            Cost::Seconds => record.core_seconds,
        }
    }
    /// On axes.
    pub fn label(self) -> &'static str {
        match self {
            Cost::Units => "particle-steps × nodes a particle",
            Cost::Seconds => "core-seconds",
        }
    }
}

/// The unbeaten of some runs, cheap first.
pub fn front<'a>(runs: impl Iterator<Item = &'a Record>, error: &str, cost: Cost) -> Vec<&'a Record> {
    let mut list: Vec<&Record> = runs.filter(|r| r.error(error).is_some()).collect();
    list.sort_by(|a, b| cost.of(a).total_cmp(&cost.of(b)));
    let mut best = f64::INFINITY;
    list.retain(|r| {
        let e = r.error(error).unwrap_or(f64::INFINITY);
        let better = e < best;
        best = best.min(e);
        better
    });
    list
}

/// The cheapest run within an error.
pub fn cheapest<'a>(
    runs: impl Iterator<Item = &'a Record>,
    error: &str,
    cost: Cost,
    within: f64,
) -> Option<&'a Record> {
    runs.filter(|r| r.error(error).is_some_and(|e| e <= within))
        .min_by(|a, b| cost.of(a).total_cmp(&cost.of(b)))
}

/// Schemes that occur, in order of their first run.
pub fn schemes(runs: &[&Record]) -> Vec<String> {
    let mut list: Vec<String> = Vec::new();
    for r in runs {
        if !list.contains(&r.scheme) {
            list.push(r.scheme.clone());
        }
    }
    list
}
