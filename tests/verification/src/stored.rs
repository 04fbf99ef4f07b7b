//! Stored errors, and comparison of new errors with them.

use crate::case::{Case, Outcome, Problem};
use crate::fast;
use crate::formulation::Formulation;
use crate::problems::gates::{self, Gate};
use crate::problems::smoothed::{self, Question};

/// Relative tolerance of a stored error.
pub const TOLERANCE: f64 = 0.02;

/// Round-off threshold: measures below it are mostly round-off, have criteria of their own and are not stored.
pub const ROUND_OFF: f64 = 1e-9;

/// Path of the table, read at run time, so that a new table needs no compilation.
const TABLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/data/errors.csv");

/// Table entry of a run that stops.
const FAILS: &str = "fails";

/// Run with rows in the table.
pub trait Stored {
    /// Columns of a row: problem, scheme, particles per cell and axis, cells and Courant number.
    fn key(&self) -> String;
    /// Number of cells along the length of the problem.
    fn cells(&self) -> usize;
    /// Run it and return its outcome.
    fn outcome(&self) -> Outcome;
    /// Round-off threshold: measures below it are not stored.
    fn round_off(&self) -> f64 {
        ROUND_OFF
    }
    /// True if its measures are reproducible and stored.
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
    /// Translation (V6) is not stored: it measures round-off, and where that grows, the processor's rounding decides if the run stops in
    /// time.
    fn is_kept(&self) -> bool {
        self.problem != Problem::Flight
    }
}

/// Format the key columns of a run.
pub(crate) fn columns(problem: &str, scheme: &str, per_axis: usize, cells: usize, courant: f64) -> String {
    format!("{problem},{scheme},{per_axis},{cells},{courant}")
}

/// Runs with their outcomes.
pub type Runs<R = Case> = Vec<(R, Outcome)>;

/// Run a list of cases.
pub fn measure<R: Stored>(list: impl IntoIterator<Item = R>) -> Runs<R> {
    let made = |run: R| {
        let outcome = run.outcome();
        (run, outcome)
    };
    list.into_iter().map(made).collect()
}

/// Run a list of cases, print the outcomes and compare them with the table.
///
/// # Panics
/// The list is empty, or an outcome differs.
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

/// Describe differences from the table of more than [`TOLERANCE`], runs that stop against the table or complete
/// against it, and entries missing from it.
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

/// Recompute the whole table by running all its cases.
pub fn table() -> String {
    let mut text = String::from("problem,scheme,particles a cell and axis,cells,Courant,quantity,value\n");
    text += &lines(&measure(fast::cases()));
    text += &lines(&measure(fast::smoothed()));
    text += &lines(&measure(Gate::ALL.into_iter().flat_map(gates::stored)));
    text + &lines(&measure(Question::ALL.into_iter().flat_map(smoothed::stored)))
}

/// Format runs as lines of the table.
fn lines<R: Stored>(runs: &[(R, Outcome)]) -> String {
    let mut text = String::new();
    for (run, outcome) in runs {
        for (quantity, value) in rows(run, outcome) {
            text.push_str(&format!("{},{quantity},{value}\n", run.key()));
        }
    }
    text
}

/// Return the stored quantities of an outcome and their values.
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

/// Return a measure over the grids of selected runs: cells and absolute values, coarse first.
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

/// Order of convergence over the last three grids: slope of the least-squares line in logarithms.
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
