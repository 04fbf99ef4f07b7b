//! Pareto front of runs: no other run is both cheaper and more accurate.

use verification::Scheme;
use verification::problems::gates::{Gate, Way};

use crate::contact::DETECTIONS;
use crate::job::Key;
use crate::peers;
use crate::record::Record;

/// Cost measure of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Particle-steps times nodes per particle.
    Units,
    /// Instructions of the steps.
    Instructions,
    /// Core-seconds.
    Seconds,
    /// Particle-steps.
    ParticleSteps,
}

impl Cost {
    /// Return the cost of a run; none if it was not counted.
    pub fn of(self, record: &Record) -> Option<f64> {
        let cost = match self {
            Cost::Units => record.units,
            Cost::Instructions => record.instructions?,
            Cost::Seconds => record.core_seconds,
            Cost::ParticleSteps => (record.particles * record.steps) as f64,
        };
        (cost > 0.0).then_some(cost)
    }
    /// Axis label.
    pub fn label(self) -> &'static str {
        match self {
            Cost::Units => "work, particle-steps × nodes a particle",
            Cost::Instructions => "work, instructions",
            Cost::Seconds => "time, core-seconds",
            Cost::ParticleSteps => "particle-steps",
        }
    }
}

/// Return the Pareto front of some runs, cheap first.
pub fn front<'a>(runs: impl Iterator<Item = &'a Record>, error: &str, cost: Cost) -> Vec<&'a Record> {
    let known = |r: &'a Record| Some((cost.of(r)?, r.error(error)?, r));
    let mut list: Vec<(f64, f64, &Record)> = runs.filter_map(known).collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut best = f64::INFINITY;
    list.retain(|r| {
        let better = r.1 < best;
        best = best.min(r.1);
        better
    });
    list.into_iter().map(|r| r.2).collect()
}

/// Return the cheapest run within an error limit whose finer grids, all else equal, are also within it: where an error
/// changes sign, a coarse grid may have almost none by chance.
pub fn cheapest<'a>(
    runs: impl Iterator<Item = &'a Record>,
    error: &str,
    cost: Cost,
    within: f64,
) -> Option<&'a Record> {
    let runs: Vec<&Record> = runs.collect();
    let fits = |r: &Record| r.error(error).is_some_and(|e| e <= within);
    let finer = |r: &Record, o: &Record| {
        Key { cells: r.key.cells, ..o.key.clone() } == r.key && o.key.cells > r.key.cells
    };
    let holds = |r: &Record| fits(r) && runs.iter().filter(|o| finer(r, o)).all(|o| fits(o));
    let known = runs.iter().filter_map(|r| Some((cost.of(r)?, *r))).filter(|(_, r)| holds(r));
    known.min_by(|a, b| a.0.total_cmp(&b.0)).map(|r| r.1)
}

/// Return runs whose error exceeds that on the next coarser grid by more than 15 % and exceeds `least`, the accuracy of the reference:
/// refinement increases their error.
pub fn growing<'a>(runs: &[&'a Record], error: &str, least: f64) -> Vec<&'a Record> {
    let coarser = |r: &Record, o: &Record| {
        Key { cells: r.key.cells, ..o.key.clone() } == r.key && o.key.cells < r.key.cells
    };
    let grows = |r: &&&'a Record| {
        let Some(e) = r.error(error) else { return false };
        let before = runs.iter().filter(|o| coarser(r, o));
        let nearest = before.max_by_key(|o| o.key.cells).and_then(|o| o.error(error));
        e > least && nearest.is_some_and(|before| e > 1.15 * before)
    };
    runs.iter().filter(grows).copied().collect()
}

/// List the schemes of the runs: those of this library before those of peers, by frame, kernel and transfer, variants in the order of
/// their options; methods of the gates in their order.
pub fn schemes(runs: &[&Record]) -> Vec<String> {
    let mut list: Vec<String> = runs.iter().map(|r| r.scheme().to_string()).collect();
    let all = Scheme::all();
    let ways: Vec<Way> = Gate::ALL.into_iter().flat_map(Gate::ways).collect();
    let rank = |name: &str| {
        let (peer, name) = peers::split(name);
        let (method, variant) = name.split_once(", ").unwrap_or((name, ""));
        let gate = ways.iter().position(|way| way.name() == method);
        let method = all.iter().position(|s| s.name() == method);
        (peer, gate, method, DETECTIONS.iter().position(|d| d.name() == variant), variant.to_string())
    };
    list.sort_by_cached_key(|name| rank(name));
    list.dedup();
    list
}
