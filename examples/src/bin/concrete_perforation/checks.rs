//! Checks of the runs.

use examples::{Check, largest, worst};

use crate::scene::Outcome;
use crate::setup::{Kernel, Rod, SHOTS};

/// Tolerance of the momentum: impulses of ten thousand steps are summed, rounded by 1e-16 each; 1e-12 if all errors have one sign.
const MOMENTUM: f64 = 1e-12;
/// Limit of the energy gain, over the kinetic energy.
const GAIN: f64 = 0.01;
/// Limit of the slab volume more than half a cell inside the rod, over the volume of the hole: debris of single particles.
const OVERLAP: f64 = 0.01;
/// Tolerance of the residual speed, over the impact speed, and impact speed from which it applies, m/s.
const ASKED: (f64, f64) = (0.10, 400.0);
const EXPERIMENT: &str = "experiment [M]";
/// Reason for judging no residual speed. No other reference is known: the only printed statement on residual speeds that
/// could be read is on concrete of 140 MPa, whose constants are not available.
const UNREAD: &str = "the table of the experiment is known from memory alone [M], which decides nothing; beside it the error is 58 m/s \
     in the root mean square with 26 cells through the slab";
/// Reason for the difference between grids.
const CHANGES: &str = "769 and 842 m/s with 20 and 26 cells, 6.9 % of the impact speed";
/// Reason for slab inside the rod.
const SINKS: &str = "2.9 % with 26 cells through the slab by Method::impact; why is not known";
/// Reason for an energy gain.
const TREMBLES: &str = "the elastic rod trembles with linear shape functions as it flies through the grid: 1.9 % with 26 cells through the slab, 21.5 % with 50";

/// Bounds of the ballistic limit, m/s: the highest impact speed without perforation (0 if there is none), and the speed
/// that the slab took from the slowest rod that perforated it. `None` without perforation.
pub fn limit(outcomes: &[Outcome]) -> Option<[f64; 2]> {
    let taken = |o: &Outcome| (o.setup.speed.powi(2) - o.residual().powi(2)).max(0.0).sqrt();
    let slowest =
        outcomes.iter().filter(|o| o.through).min_by(|a, b| a.setup.speed.total_cmp(&b.setup.speed))?;
    let stopped = outcomes.iter().filter(|o| !o.through).map(|o| o.setup.speed).fold(0.0, f64::max);
    Some([stopped, taken(slowest)])
}

/// Check one shot at each of several speeds.
pub fn of_curve(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks = Vec::new();
    let (mut squares, mut worst, mut count): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for outcome in outcomes {
        let (speed, value) = (outcome.setup.speed, outcome.residual());
        let name = format!("residual speed, {speed:.0} m/s");
        let shot = SHOTS.iter().find(|s| s[0] == speed);
        let Some([_, left]) = shot else {
            checks.push(Check::unreferenced(name, value, "m/s", "no experiment"));
            continue;
        };
        checks.push(Check::remembered(name, value, "m/s", *left, EXPERIMENT));
        squares += (value - left).powi(2);
        count += 1.0;
        if speed > ASKED.1 {
            worst = worst.max((value - left).abs() / speed);
        }
    }
    if count > 0.0 {
        let error = (squares / count).sqrt();
        checks.push(Check::remembered("root mean square error", error, "m/s", 0.0, EXPERIMENT));
        let name = "worst error above 400 m/s, of the impact speed (asked: at most)";
        checks.push(Check::remembered(name, worst, "-", ASKED.0, EXPERIMENT));
    }
    if let Some([low, high]) = limit(outcomes) {
        checks.push(Check::remembered(
            "ballistic limit is at most (asked: 280 to 380)",
            high,
            "m/s",
            350.0,
            EXPERIMENT,
        ));
        checks.push(Check::remembered("ballistic limit is at least", low, "m/s", 301.0, EXPERIMENT));
    }
    // The residual speed, the purpose of the case, cannot be judged: that counts as missed.
    let name = "residual speeds beside a reference that may decide";
    let all = outcomes.len() as f64;
    checks.push(Check::at_least(name, 0.0, "shots", all, "a table that could be read").known_miss(UNREAD));
    // The rod loses energy in the slab.
    let gain = outcomes.iter().map(|o| o.residual() / o.setup.speed).fold(0.0, f64::max);
    checks.push(Check::at_most("largest residual over impact speed", gain, "-", 1.0, "physics"));
    // The residual speed rises with the impact speed.
    let mut sorted: Vec<&Outcome> = outcomes.iter().collect();
    sorted.sort_by(|a, b| a.setup.speed.total_cmp(&b.setup.speed));
    let rise = sorted.windows(2).map(|w| w[1].residual() - w[0].residual()).fold(f64::INFINITY, f64::min);
    if outcomes.len() > 1 {
        checks.push(Check::at_least(
            "smallest rise of residual with impact speed",
            rise,
            "m/s",
            0.0,
            "physics",
        ));
    }
    checks
}

/// Check the same shot on successively finer grids.
pub fn of_grids(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks = Vec::new();
    for outcome in outcomes {
        let name = format!("residual speed, {:.0} m/s, {} cells", outcome.setup.speed, outcome.setup.cells);
        let shot = SHOTS.iter().find(|s| s[0] == outcome.setup.speed);
        let value = outcome.residual();
        checks.push(match shot {
            Some([_, left]) => Check::remembered(name, value, "m/s", *left, EXPERIMENT),
            None => Check::unreferenced(name, value, "m/s", "no experiment"),
        });
    }
    if let [.., a, b] = outcomes {
        let change = (b.residual() - a.residual()).abs() / b.setup.speed;
        let name = "change of the last refinement, of the impact speed";
        let change = Check::at_most(name, change, "-", 0.04, "asked");
        let coarse = "from 16 cells through the slab on a cell is less than the rod's radius";
        let change = change.judged_if(a.setup.cells >= 16, coarse);
        checks.push(if b.setup.cells < 50 { change.known_miss(CHANGES) } else { change });
    }
    checks
}

/// Check the balances of every run.
pub fn of_books(outcomes: &[&Outcome]) -> Vec<Check> {
    let errors = || outcomes.iter().flat_map(|o| &o.ledger).map(|e| e.energy_error);
    let (lost, gained) = (largest(errors().map(|e| -e)), largest(errors()));
    let momentum = worst(outcomes.iter().map(|o| o.totals.momentum_error));
    let overlap = largest(outcomes.iter().map(|o| o.overlap()));
    let gain = Check::at_most("energy gained", gained, "-", GAIN, "conservation");
    let hats = |o: &&&Outcome| o.setup.rod == Rod::Elastic && o.setup.kernel != Kernel::Impact;
    let trembles = outcomes.iter().filter(hats).any(|o| o.setup.cells >= 26);
    let inside = Check::at_most("slab inside the rod, of the hole", overlap, "-", OVERLAP, "half a cell");
    vec![
        Check::unreferenced("energy lost by contact and filter, at most", lost, "-", "of the kinetic energy"),
        if trembles { gain.known_miss(TREMBLES) } else { gain },
        Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"),
        if outcomes.iter().any(|o| o.setup.cells >= 20 && o.setup.rod != Rod::Fem) {
            inside.known_miss(SINKS)
        } else {
            inside
        },
    ]
}
