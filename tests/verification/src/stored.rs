//! Stored errors, and what has become of them.

use crate::case::{Case, Outcome, Problem};
use crate::fast;
use crate::formulation::Formulation;
use crate::problems::gates::{self, Gate};
use crate::problems::smoothed::{self, Question};

/// What a stored error may change by.
pub const TOLERANCE: f64 = 0.02;

/// Below this, measures are sums of round-off mostly: they have criteria of their own and are not stored.
pub const ROUND_OFF: f64 = 1e-9;

/// Read where it stands, so that a new one compiles nothing anew.
const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/errors.csv");

/// The word for a run that stops.
const FAILS: &str = "fails";

/// What is run and has rows in the table.
pub trait Stored {
    /// Problem, scheme, particles a cell and axis, cells and Courant number, as columns.
    fn key(&self) -> String;
    /// Cells along the length of the problem.
    fn cells(&self) -> usize;
    /// Run it.
    fn outcome(&self) -> Outcome;
    /// Below this its measures are sums of round-off: they are not stored.
    fn round_off(&self) -> f64 {
        ROUND_OFF
    }
    /// Are its measures such that a table can hold them?
    fn is_kept(&self) -> bool {
        true
    }
}

impl<S: Formulation> Stored for Case<S> {
    fn key(&self) -> String {
        let Case { problem, scheme, per_axis, cells, courant } = self;
        columns(problem.name(), &scheme.name(), *per_axis, *cells, *courant)
    }
    fn cells(&self) -> usize {
        self.cells
    }
    fn outcome(&self) -> Outcome {
        self.run()
    }
    /// Of a flight there are none: what it measures is round-off, and where that grows, the processor's rounding decides whether the run
    /// stops in time.
    fn is_kept(&self) -> bool {
        self.problem != Problem::Flight
    }
}

/// The columns that tell runs apart.
pub(crate) fn columns(problem: &str, scheme: &str, per_axis: usize, cells: usize, courant: f64) -> String {
    format!("{problem},{scheme},{per_axis},{cells},{courant}")
}

/// Runs and what came of them.
pub type Runs<R = Case> = Vec<(R, Outcome)>;

/// Run a list.
pub fn measure<R: Stored>(list: impl IntoIterator<Item = R>) -> Runs<R> {
    let made = |run: R| {
        let outcome = run.outcome();
        (run, outcome)
    };
    list.into_iter().map(made).collect()
}

/// Run a list, print what came of it, and hold it to the table.
///
/// # Panics
/// There is nothing to run, or something differs.
pub fn judged<R: Stored>(list: impl IntoIterator<Item = R>) -> Runs<R> {
    let runs = measure(list);
    assert!(!runs.is_empty(), "nothing to run");
    for (run, outcome) in &runs {
        let why = outcome.failure.as_deref().unwrap_or_default();
        println!("{}: {:?} in {:.2} s {why}", run.key(), outcome.measures, outcome.work.seconds);
    }
    let found = differences(&runs);
    assert!(
        found.is_empty(),
        "{} differ by more than 2 %; where that is meant, make the table anew: \
         cargo run --release -p report -- --store > tests/verification/data/errors.csv\n{}",
        found.len(),
        found.join("\n")
    );
    runs
}

/// What differs from the table by more than [`TOLERANCE`], in words; runs that stop where none did, or do not where
/// they did, and what is not in the table.
pub fn differences<R: Stored>(runs: &[(R, Outcome)]) -> Vec<String> {
    let table = match std::fs::read_to_string(TABLE) {
        Ok(table) => table,
        Err(error) => return vec![format!("{TABLE}: {error}")],
    };
    let mut found = Vec::new();
    for (run, outcome) in runs {
        for (quantity, now) in rows(run, outcome) {
            let key = format!("{},{quantity}", run.key());
            let Some(stored) = table.lines().find_map(|line| line.strip_prefix(&format!("{key},"))) else {
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

/// The whole table anew: runs all that it has.
pub fn table() -> String {
    let mut text = String::from("problem,scheme,particles a cell and axis,cells,Courant,quantity,value\n");
    text += &lines(&measure(fast::cases()));
    text += &lines(&measure(fast::smoothed()));
    text += &lines(&measure(Gate::ALL.into_iter().flat_map(gates::stored)));
    text + &lines(&measure(Question::ALL.into_iter().flat_map(smoothed::stored)))
}

/// Lines of the table from runs.
fn lines<R: Stored>(runs: &[(R, Outcome)]) -> String {
    let mut text = String::new();
    for (run, outcome) in runs {
        for (quantity, value) in rows(run, outcome) {
            text.push_str(&format!("{},{quantity},{value}\n", run.key()));
        }
    }
    text
}

/// Stored quantities of an outcome and their values.
fn rows(run: &impl Stored, outcome: &Outcome) -> Vec<(&'static str, String)> {
    if !run.is_kept() {
        return Vec::new();
    }
    if outcome.failure.is_some() {
        return vec![("run", FAILS.into())];
    }
    let kept = outcome.measures.iter().filter(|m| m.1.is_nan() || m.1.abs() > run.round_off());
    kept.map(|&(quantity, value)| (quantity, format!("{value:.5e}"))).collect()
}

/// A measure over the grids of the runs that are picked: cells and sizes, coarse first.
pub fn series<R: Stored>(
    runs: &[(R, Outcome)],
    quantity: &str,
    pick: impl Fn(&R) -> bool,
) -> Vec<(usize, f64)> {
    let mut list: Vec<(usize, f64)> = runs
        .iter()
        .filter(|(run, _)| pick(run))
        .map(|(run, outcome)| (run.cells(), outcome.get(quantity).abs()))
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
