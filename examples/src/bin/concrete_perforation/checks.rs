//! What the runs are held against.

use examples::{Check, Resolution, largest, worst};

use crate::scene::Outcome;
use crate::setup::SHOTS;

/// Impulses of ten thousand steps pass through the sums, rounded by 1e-16 each; 1e-12 if all fall the same way.
const MOMENTUM: f64 = 1e-12;
/// Of the kinetic energy.
const GAIN: f64 = 0.01;
/// Of the volume of the hole, slab that may be more than half a cell inside the rod: debris of single particles.
const OVERLAP: f64 = 0.01;
/// Part of the impact speed by which the residual speed may miss the experiment, and from which speed on, m/s.
const ASKED: (f64, f64) = (0.10, 400.0);
const EXPERIMENT: &str = "experiment [M]";

/// Speed below which no rod comes through, m/s: at most that which the slab took from the slowest that did, and at
/// least that of the fastest that did not, if there is one.
pub fn limit(outcomes: &[Outcome]) -> Option<[f64; 2]> {
    let taken = |o: &Outcome| (o.setup.speed.powi(2) - o.residual().powi(2)).max(0.0).sqrt();
    let slowest =
        outcomes.iter().filter(|o| o.through).min_by(|a, b| a.setup.speed.total_cmp(&b.setup.speed))?;
    let stopped = outcomes.iter().filter(|o| !o.through).map(|o| o.setup.speed).fold(0.0, f64::max);
    Some([stopped, taken(slowest)])
}

/// Of one shot at each of several speeds.
pub fn of_curve(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks = Vec::new();
    let (mut squares, mut worst, mut count): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for outcome in outcomes {
        let (speed, value) = (outcome.setup.speed, outcome.residual());
        let name = format!("residual speed, {speed:.0} m/s");
        let shot = SHOTS.iter().find(|s| s[0] == speed);
        let Some([_, left]) = shot else {
            checks.push(Check::shown(name, value, "m/s", 0.0, "no experiment"));
            continue;
        };
        checks.push(Check::shown(name, value, "m/s", *left, EXPERIMENT));
        squares += (value - left).powi(2);
        count += 1.0;
        if speed > ASKED.1 {
            worst = worst.max((value - left).abs() / speed);
        }
    }
    if count > 0.0 {
        checks.push(Check::shown("root mean square error", (squares / count).sqrt(), "m/s", 0.0, EXPERIMENT));
        let name = "worst error above 400 m/s, of the impact speed (asked: at most)";
        checks.push(Check::shown(name, worst, "-", ASKED.0, EXPERIMENT));
    }
    if let Some([low, high]) = limit(outcomes) {
        checks.push(Check::shown(
            "ballistic limit is at most (asked: 280 to 380)",
            high,
            "m/s",
            350.0,
            EXPERIMENT,
        ));
        checks.push(Check::shown("ballistic limit is at least", low, "m/s", 301.0, EXPERIMENT));
    }
    // A faster rod comes out faster.
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

/// Of the same shot on grids that get finer.
pub fn of_grids(outcomes: &[Outcome], resolution: Resolution) -> Vec<Check> {
    let mut checks = Vec::new();
    for outcome in outcomes {
        let name = format!("residual speed, {:.0} m/s, {} cells", outcome.setup.speed, outcome.setup.cells);
        let shot = SHOTS.iter().find(|s| s[0] == outcome.setup.speed);
        let [value, left] = [outcome.residual(), shot.map_or(0.0, |s| s[1])];
        checks.push(Check::shown(name, value, "m/s", left, EXPERIMENT));
    }
    if let [.., a, b] = outcomes
        && resolution != Resolution::Smoke
    {
        let change = (b.residual() - a.residual()).abs() / b.setup.speed;
        let name = "change of the last refinement, of the impact speed";
        checks.push(Check::at_most(name, change, "-", 0.04, "asked").noted());
    }
    checks
}

/// Of what every run must keep.
pub fn of_books(outcomes: &[&Outcome]) -> Vec<Check> {
    let errors = || outcomes.iter().flat_map(|o| &o.ledger).map(|e| e.energy_error);
    let (lost, gained) = (largest(errors().map(|e| -e)), largest(errors()));
    let momentum = worst(outcomes.iter().map(|o| o.totals.momentum_error));
    let overlap = largest(outcomes.iter().map(|o| o.overlap()));
    vec![
        Check::shown("energy lost by contact and filter, at most", lost, "-", 0.0, "of the kinetic energy"),
        // An elastic rod may tremble as it flies through the grid.
        Check::at_most("energy gained", gained, "-", GAIN, "conservation").noted(),
        Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"),
        Check::at_most("slab inside the rod, of the hole", overlap, "-", OVERLAP, "half a cell").noted(),
    ]
}
