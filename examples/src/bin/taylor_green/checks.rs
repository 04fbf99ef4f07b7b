//! Checks of viscous flow.

use examples::series::{interpolate, order};
use examples::{Check, worst};

use crate::scene::{ERROR, Outcome, PROJECTED, Study};

/// Tolerance of the amplitude of vortices after L / U on the finest grid.
const AMPLITUDE: f64 = 0.01;
/// Root-mean-square error of channel flow, of the final speed, over the square of a cell over the height.
const CHANNEL: f64 = 0.5;
/// Least observed order of errors.
const ORDER: f64 = 1.8;
/// Rounding of thousands of steps.
const MOMENTUM: f64 = 1e-11;

const NOISE: &str = "noise of the particles, which the transfer dissipates: it does not fall with the cells";

/// Check all runs: grids of decreasing cells of each flow.
pub fn of(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks = Vec::new();
    for grids in outcomes.chunk_by(|a, b| a.setup.study == b.setup.study) {
        checks.extend(if grids[0].setup.study == Study::Vortices { vortices(grids) } else { channel(grids) });
    }
    let momentum = worst(outcomes.iter().map(|o| o.run.totals.momentum_error));
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"));
    checks
}

/// Cells and errors of grids.
pub fn errors(grids: &[Outcome], of: impl Fn(&Outcome) -> f64) -> Vec<[f64; 2]> {
    grids.iter().map(|o| [o.setup.spacing(), of(o)]).collect()
}

/// Check the decay of vortices.
fn vortices(grids: &[Outcome]) -> Vec<Check> {
    let source = "exp(-2 nu k^2 t) [C]";
    let row = |(n, o): (usize, &Outcome)| {
        let (name, found) = (
            format!("vortices, {} cells: amplitude after L / U over the exact one", o.setup.cells),
            o.run.last()[PROJECTED],
        );
        if n + 1 < grids.len() {
            return Check::unreferenced(name, found, "-", source);
        }
        Check::gate(name, found, "-", 1.0, AMPLITUDE, source).known_miss(NOISE)
    };
    let mut checks: Vec<Check> = grids.iter().enumerate().map(row).collect();
    let observed = order(&errors(grids, |o| o.run.last()[ERROR]));
    let name = "vortices: order of the root-mean-square error of the velocity";
    checks.push(Check::at_least(name, observed, "-", ORDER, "second order").known_miss(NOISE));
    checks
}

/// Check the start of channel flow at its times.
fn channel(grids: &[Outcome]) -> Vec<Check> {
    let Some(finest) = grids.last() else { return Vec::new() };
    let (name, nu) = (finest.setup.study.name(), finest.setup.viscosity());
    let at = |o: &Outcome, time: f64| interpolate(o.run.series(ERROR), time * (1.0 - 1e-12));
    let allowed = CHANNEL * finest.setup.spacing().powi(2);
    let rows = finest.setup.times().into_iter().flat_map(|time| {
        let when = format!("at nu t / H^2 = {:.2}", nu * time);
        let observed = order(&errors(grids, |o| at(o, time)));
        [
            Check::at_most(
                format!("{name}: root-mean-square error {when}, of the final speed"),
                at(finest, time),
                "-",
                allowed,
                "series [C]",
            ),
            Check::at_least(format!("{name}: its order {when}"), observed, "-", ORDER, "second order"),
        ]
    });
    rows.collect()
}
