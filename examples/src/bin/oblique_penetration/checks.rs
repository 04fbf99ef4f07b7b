//! Checks of penetration, cost and conservation.

use examples::{CaseError, Check, Coupling, largest, worst};

use crate::curve::Point;
use crate::estimate::Estimate;
use crate::flight::Flight;
use crate::scene::Outcome;
use crate::setup::{Kernel, RodFrame, Target};
use crate::{EXPERIMENT, PAPER};

/// Bounds of the residual speed, m/s: 3 % below and 2 % above the experiment.
const ASKED: [f64; 2] = [441.0, 465.0];
/// Rounding of 1e-16 per step over three thousand steps; 1e-12 if all errors have the same sign.
const MOMENTUM: f64 = 1e-12;
/// Number of cells through the plate from which checks are evaluated: half a cell is a tenth of the rod's radius, and the error of second
/// order is below 4 %.
const RESOLVED: u32 = 20;
const CAVITY: &str = "rigid rod, cavity expansion [C]";
const SINKS: &str = "a rod in its reference configuration sinks in a little while others stop it";
const SPLINES: &str = "21.8, 13.5, 9.5, 7.6 % with 8, 12, 16, 20 cells by Method::impact, twice what linear shape functions lose: splines reach twice as far, which was not shown to be the cause";
const ON_THE_GRID: &str = "29 % with 8 cells: the grid stops whole cells of elements and particles that share a node; by surface 10 %";
const TREMBLES: &str = "linear shape functions with FLIP: the elastic rod trembles as it flies through the grid, after it is through the plate: 9, 40, 62 % with 20, 24, 28 cells";
const NEAR: f64 = 0.04;
/// Tolerance of the energy gain over the kinetic energy.
const GAIN: f64 = 0.01;
/// Tolerance of the plate volume deeper than half a cell inside the rod, over the volume of the hole: single debris particles.
const OVERLAP: f64 = 0.01;

/// Number of cells through the plate on the coarser of the last two grids of the paper.
const FINE: u32 = 24;

/// Extrapolate the residual speed to cell size zero from the last two runs, with an error of second order, m/s.
pub fn limit(outcomes: &[Outcome]) -> Option<f64> {
    let [.., a, b] = outcomes else { return None };
    let [x, y] = [a, b].map(|o| o.setup.spacing().powi(2));
    Some(b.residual() + (b.residual() - a.residual()) * y / (x - y))
}

/// Check one shot on successively finer grids.
pub fn of_grids(outcomes: &[Outcome]) -> Result<Vec<Check>, CaseError> {
    let Some(finest) = outcomes.last() else { return Ok(Vec::new()) };
    let setup = finest.setup;
    let mut checks = Vec::new();
    let cavity = Estimate::of(&setup)?.residual(setup.speed);
    for outcome in outcomes {
        let cells = outcome.setup.cells;
        let name = format!("residual speed, {cells} cells through the plate");
        let (exact, source) =
            if setup.is_the_paper_s() { (EXPERIMENT, "experiment [S]") } else { (cavity, CAVITY) };
        checks.push(resolved(Check::gate(name, outcome.residual(), "m/s", exact, NEAR, source), cells));
    }
    if setup.is_the_paper_s() {
        let value = finest.residual();
        let paper = Check::gate("residual speed of the paper", value, "m/s", PAPER, NEAR, "MPM3Dpp [S]");
        let mut gates = vec![
            if setup.rod == RodFrame::Fem { paper.known_miss(ABOVE) } else { paper },
            Check::gate("residual speed, rigid rod", value, "m/s", cavity, NEAR, CAVITY),
            Check::at_least("residual speed", value, "m/s", ASKED[0], "experiment - 3 % [S]"),
            Check::at_most("residual speed", value, "m/s", ASKED[1], "experiment + 2 % [S]"),
        ];
        if let Some(limit) = limit(outcomes) {
            let before = outcomes[outcomes.len() - 2].residual();
            let change = value / before - 1.0;
            let change = Check::at_most("change of the last refinement", change, "-", 0.02, "asked");
            gates.push(change.judged_if(setup.cells >= FINE, "asked of the paper's grids"));
            // The extrapolated value has an error of its own; the scatter of the experiment is not known.
            let name = "residual speed, cells of size 0";
            let limit = Check::gate(name, limit, "m/s", EXPERIMENT, 0.03, "experiment [S]");
            gates.push(limit.known_miss(
                "470 m/s by 16 and 20 cells, and by 24 and 28 with linear shape functions: 3.3 % above the experiment",
            ));
        }
        checks.extend(gates.into_iter().map(|gate| resolved(gate, setup.cells)));
    }
    for outcome in outcomes {
        let cells = outcome.setup.cells;
        let errors = || outcome.ledger.iter().map(|e| e.energy_error);
        let (lost, gained) = (largest(errors().map(|e| -e)), largest(errors()));
        let name = |what| format!("energy {what}, {cells} cells");
        let books = Check::at_most(name("lost"), lost, "-", lost_allowed(cells), "contact of first order");
        let splines = outcome.setup.kernel == Kernel::Impact;
        checks.push(match (outcome.setup.rod, outcome.setup.coupling, splines) {
            (RodFrame::Reference, ..) => books.known_miss(SINKS),
            (RodFrame::Fem, Coupling::Grid, _) => books.known_miss(ON_THE_GRID),
            (RodFrame::Current, _, true) => books.known_miss(SPLINES),
            _ => books,
        });
        let gain = Check::at_most(name("gained"), gained, "-", GAIN, "conservation");
        let trembles = outcome.setup.rod == RodFrame::Current && !splines && cells >= RESOLVED;
        checks.push(if trembles { gain.known_miss(TREMBLES) } else { gain });
    }
    let first = finest.ledger.first().map_or(f64::NAN, |e| e.kinetic);
    if setup.friction > 0.0 {
        let share = finest.books().friction / first;
        checks.push(Check::unreferenced("work of friction, of the kinetic energy", share, "-", "booked"));
    }
    let momentum = worst(outcomes.iter().map(|o| o.totals.momentum_error));
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"));
    let overlap = largest(outcomes.iter().map(Outcome::overlap));
    let inside = Check::at_most("plate inside the rod, of the hole", overlap, "-", OVERLAP, "half a cell");
    let by_surface = |o: &Outcome| o.setup.rod == RodFrame::Fem && o.setup.coupling == Coupling::Surface;
    let coarse = outcomes.iter().any(|o| o.setup.cells < 12 && !by_surface(o));
    checks.push(if coarse {
        inside.known_miss("1.8 % with 8 cells through the plate, 0.2 % from 12 on")
    } else {
        inside
    });
    let [occupied, box_of] = finest.cells;
    let share = 100.0 * occupied as f64 / box_of.max(1) as f64;
    let name = "cells with particles, of the box around all";
    checks.push(Check::unreferenced(name, share, "%", "the paper has another box, of which 13.13 %"));
    checks.extend(finest.flight.iter().flat_map(Flight::checks));
    let megabytes = 1e-6 * finest.totals.bytes as f64;
    let source = "200 864 particles [S]";
    let paper = 1.048_576 * 55.02 * finest.totals.particles as f64 / 200_864.0;
    let memory = Check::at_most("memory", megabytes, "MB", paper, source);
    let memory = if setup.target == Target::Afemp { memory.known_miss(NODES) } else { memory };
    checks.push(memory.judged_if(finest.setup.cells >= RESOLVED, "small scenes are mostly surface"));
    Ok(checks)
}

const ABOVE: &str = "460 m/s by a rod of elements, through a plate of particles as through one of elements: 1 % above the experiment";
const NODES: &str =
    "twice of it: nodes and points of elements take memory, and particles alone are what is counted";
const DEAR: &str = "1.28 and 0.72 on two threads with 12 cells through plates of 6 and 16 diameters, 1.18 and 0.54 on one: contact of the rod costs as \
                    much in both, and what is done between steps runs on one thread";
/// Number of cells through the plate from which its cost is evaluated.
const THICK: u32 = 12;

/// Compare a plate of elements that convert to particles with a plate of particles.
pub fn of_target(elements: &Outcome, particles: &Outcome) -> Vec<Check> {
    let cells = elements.setup.cells;
    let name = |what: &str| format!("plate of elements, {cells} cells: {what}");
    let beside = "a plate of particles";
    let cost = elements.totals.wall_seconds / particles.totals.wall_seconds;
    let cost = Check::at_most(name("cost"), cost, "-", 0.4, beside).known_miss(DEAR);
    let mut checks = vec![
        Check::gate(name("residual speed"), elements.residual(), "m/s", particles.residual(), 0.02, beside),
        cost.judged_if(cells >= THICK, "a plate of few cells costs little"),
    ];
    if let Some(book) = &elements.converted {
        let first = elements.ledger.first().map_or(f64::NAN, |e| e.kinetic);
        let energy = book.energy.abs() / first;
        checks.push(Check::at_most(name("energy that appeared"), energy, "-", 0.01, "of the kinetic energy"));
        let share = book.mass / (book.mass + rest(elements));
        checks.push(Check::unreferenced(name("mass that became particles"), share, "-", "of the plate"));
    }
    checks
}

/// Mass of the plate that is still elements, kg.
fn rest(outcome: &Outcome) -> f64 {
    let setup = &outcome.setup;
    let whole = 2.0 * setup.half_width * setup.half_width * crate::THICKNESS * 2700.0;
    (whole - outcome.converted.as_ref().map_or(0.0, |book| book.mass)).max(0.0)
}

/// Allowed loss of kinetic energy by contact of first order in the cell size: a layer of half a cell along the hole is stopped
/// inelastically.
fn lost_allowed(cells: u32) -> f64 {
    0.8 / f64::from(cells)
}

/// Check shots at several speeds.
pub fn of_curve(points: &[Point], cells: u32) -> Vec<Check> {
    let name = |p: &Point| format!("residual speed, {:.0} m/s, {:.0} degrees", p.speed, p.angle.to_degrees());
    let check = |p: &Point| Check::gate(name(p), p.residual, "m/s", p.estimate, NEAR, CAVITY);
    points.iter().map(|p| resolved(check(p), cells)).collect()
}

/// Evaluate the check on fine grids only.
fn resolved(check: Check, cells: u32) -> Check {
    check.judged_if(cells >= RESOLVED, "half a cell is more than a tenth of the rod's radius")
}
