//! Checks of cased charges.

use examples::{Check, Resolution};

use crate::scene::Outcome;
use crate::setup::{GURNEY, gurney, mass_ratio};

/// Tolerance of the case speed by resolution: the error decreases with the cell size, 2.4 % with 16 cells.
const SPEED_TOLERANCE: [f64; 3] = [0.04, 0.015, 0.01];
/// Tolerance of the one-dimensional run with half as many zones: a tenth of the smallest tolerance of the speed.
const ZONES_TOLERANCE: f64 = 0.001;
const ROUND_TOLERANCE: f64 = 0.05;
const ENERGY_TOLERANCE: f64 = 0.02;
const MOMENTUM_TOLERANCE: f64 = 1e-12;
const MASS_TOLERANCE: f64 = 0.01;

/// Check the cylinder: `alone` is the one-dimensional run, and `coarse` the same with half as many zones.
pub fn of_cylinder(
    outcome: &Outcome,
    alone: &[[f64; 3]],
    coarse: &[[f64; 3]],
    resolution: Resolution,
) -> Vec<Check> {
    let last = outcome.last();
    let [smoke, standard, paper] = SPEED_TOLERANCE;
    let tolerance = resolution.choose(smoke, standard, paper);
    let at_end = |rows: &[[f64; 3]]| rows.last().map_or(0.0, |r| r[1]);
    let half = last.time * 0.5;
    let midway = |rows: &[[f64; 3]]| rows.iter().find(|r| r[0] >= half).map_or(0.0, |r| r[1]);
    let here = outcome.rows.iter().find(|r| r.time >= half).map_or(0.0, |r| r.speed);
    let differences = "finite differences in one dimension [C]";
    let memory = "Gurney, sqrt(2 E) = 2.37 km/s [M]";
    let constant = last.speed * (mass_ratio() + 0.5).sqrt();
    vec![
        Check::gate(
            "cylinder: speed of the case at the end",
            last.speed,
            "m/s",
            at_end(alone),
            tolerance,
            differences,
        ),
        Check::gate(
            "cylinder: speed of the case at half the time",
            here,
            "m/s",
            midway(alone),
            tolerance,
            differences,
        ),
        Check::gate(
            "finite differences: speed with half the zones",
            at_end(coarse),
            "m/s",
            at_end(alone),
            ZONES_TOLERANCE,
            differences,
        ),
        Check::remembered("cylinder: speed of the case by Gurney", last.speed, "m/s", gurney(), memory),
        Check::remembered("cylinder: Gurney's constant from that speed", constant, "m/s", GURNEY, memory),
        Check::gate(
            "cylinder: speed of the fastest sector less the slowest",
            (last.range[0] - last.range[1]) / last.speed,
            "-",
            0.0,
            ROUND_TOLERANCE,
            "it stays round",
        ),
    ]
}

/// Check conservation for either form.
pub fn of_books(outcome: &Outcome) -> Vec<Check> {
    let name = |what: &str| format!("{}: {what}", outcome.setup.name());
    let last = outcome.last();
    let kinetic = (last.kinetic[0] + last.kinetic[1]) / outcome.chemical;
    // The ledger's error is relative to its largest energy, which may be small compared with the energy of the charge.
    let energy = (outcome.books.kinetic + outcome.books.internal) / outcome.chemical;
    let [gas, case] = outcome.masses;
    let free = "conservation";
    let lattice = "exact volumes";
    vec![
        Check::gate(name("mass of the charge"), gas, "-", 1.0, MASS_TOLERANCE, lattice),
        Check::gate(name("mass of the case"), case, "-", 1.0, MASS_TOLERANCE, lattice),
        Check::at_most(name("kinetic energy over the chemical energy"), kinetic, "-", 1.0, "all of it"),
        Check::gate(name("energy gained over the chemical energy"), energy, "-", 0.0, ENERGY_TOLERANCE, free),
        Check::gate(
            name("momentum error"),
            outcome.totals.momentum_error,
            "-",
            0.0,
            MOMENTUM_TOLERANCE,
            free,
        ),
    ]
}
