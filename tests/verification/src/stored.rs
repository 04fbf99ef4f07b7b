//! Stored errors, and what has become of them.

use crate::case::{Case, Outcome, Problem};
use crate::fast;

/// What a stored error may change by.
pub const TOLERANCE: f64 = 0.02;

/// Below this, measures are sums of round-off: they have criteria of their own and are not stored.
pub const ROUND_OFF: f64 = 1e-9;

const TABLE: &str = include_str!("../data/errors.csv");

/// The word for a run that stops.
const FAILS: &str = "fails";

/// Run the cases of a problem.
pub fn measure(problem: Problem) -> Vec<(Case, Outcome)> {
    let cases = fast::cases().into_iter().filter(|c| c.problem == problem);
    cases.map(|case| (case, case.run())).collect()
}

/// What differs from the table by more than [`TOLERANCE`], in words; runs that stop where none did, or do not where
/// they did, and what is not in the table.
pub fn differences(runs: &[(Case, Outcome)]) -> Vec<String> {
    let mut found = Vec::new();
    for (case, outcome) in runs {
        for (quantity, now) in rows(case, outcome) {
            let key = key(case, quantity);
            let Some(stored) = TABLE.lines().find_map(|line| line.strip_prefix(&format!("{key},"))) else {
                found.push(format!("{key}: not stored; now {now}"));
                continue;
            };
            let same = match (stored.parse::<f64>(), now.parse::<f64>()) {
                (Ok(before), Ok(now)) => (now - before).abs() <= TOLERANCE * before.abs(),
                _ => stored == now,
            };
            if !same {
                let why = outcome.failure.as_deref().unwrap_or_default();
                found.push(format!("{key}: stored {stored}, now {now} {why}"));
            }
        }
    }
    found
}

/// The whole table anew, from runs.
pub fn table(runs: &[(Case, Outcome)]) -> String {
    let mut text = String::from("problem,scheme,particles a cell and axis,cells,Courant,quantity,value\n");
    for (case, outcome) in runs {
        for (quantity, value) in rows(case, outcome) {
            text.push_str(&format!("{},{value}\n", key(case, quantity)));
        }
    }
    text
}

/// Stored quantities of an outcome and their values. Of a flight there are none: what it measures is round-off, and where
/// that grows, the processor's rounding decides whether the run stops in time.
fn rows(case: &Case, outcome: &Outcome) -> Vec<(&'static str, String)> {
    if case.problem == Problem::Flight {
        return Vec::new();
    }
    if outcome.failure.is_some() {
        return vec![("run", FAILS.into())];
    }
    let kept = outcome.measures.iter().filter(|m| m.1.is_nan() || m.1.abs() > ROUND_OFF);
    kept.map(|&(quantity, value)| (quantity, format!("{value:.5e}"))).collect()
}

fn key(case: &Case, quantity: &str) -> String {
    let Case { problem, scheme, per_axis, cells, courant } = case;
    format!("{},{},{per_axis},{cells},{courant},{quantity}", problem.name(), scheme.name())
}

/// A measure over the grids of the cases that are picked: cells and sizes, coarse first.
pub fn series(runs: &[(Case, Outcome)], quantity: &str, pick: impl Fn(&Case) -> bool) -> Vec<(usize, f64)> {
    let mut list: Vec<(usize, f64)> = runs
        .iter()
        .filter(|(case, _)| pick(case))
        .map(|(case, outcome)| (case.cells, outcome.get(quantity).abs()))
        .collect();
    list.sort_by_key(|s| s.0);
    list
}

/// The order of convergence over the last three grids: the slope of the straight line that fits the logarithms best.
pub fn order(series: &[(usize, f64)]) -> f64 {
    let last = &series[series.len().saturating_sub(3)..];
    let n = last.len() as f64;
    let points: Vec<(f64, f64)> = last.iter().map(|&(cells, e)| (-(cells as f64).ln(), e.ln())).collect();
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let rise: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let run: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    rise / run
}
