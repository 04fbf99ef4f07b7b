//! What decides.

use examples::Check;

use crate::plane::{self, Row as Plane};
use crate::scene::Outcome;
use crate::setup::{END, SHOCK, SPEED, THICKNESS};

const STATE_TOLERANCE: f64 = 0.01;
const ENERGY_TOLERANCE: f64 = 0.02;
const MOMENTUM_TOLERANCE: f64 = 1e-12;

/// The state behind a plane shock in cells of this size.
pub fn of_plane(row: &Plane) -> Vec<Check> {
    let theory = plane::shocked();
    let hugoniot = "Hugoniot [C], shock line [V]";
    let density = 1e-3 * SHOCK[0];
    let (found, due) = (density / row.volume_ratio, density / theory.volume_ratio);
    vec![
        Check::gate(
            "pressure at impact, plane",
            1e-9 * row.pressure,
            "GPa",
            1e-9 * theory.pressure,
            STATE_TOLERANCE,
            hugoniot,
        ),
        Check::gate("density at impact, plane", found, "g/cm³", due, STATE_TOLERANCE, hugoniot),
    ]
}

/// Of one cloud.
pub fn of_cloud(outcome: &Outcome) -> Vec<Check> {
    let theory = plane::shocked();
    let name = |what: &str| {
        let how = if outcome.setup.cutting.is_some() { "split" } else { "not split" };
        format!("{how}: {what}")
    };
    let last = outcome.last();
    let hugoniot = "Hugoniot [C]";
    let surface = plane::free_surface();
    let reach = THICKNESS + surface * (END - THICKNESS / theory.front);
    let mean = last.momentum / last.mass;
    let peak = outcome.rows.iter().map(|r| r.pressure).fold(0.0, f64::max);
    let length = last.front - THICKNESS;
    let (energy, momentum) = (outcome.totals.energy_error, outcome.totals.momentum_error);
    let free = "conservation";
    let memory = "Anderson 1990 [M]";
    vec![
        Check::shown(
            name("peak pressure in the middle of the plate"),
            1e-9 * peak,
            "GPa",
            1e-9 * theory.pressure,
            hugoniot,
        ),
        Check::at_most(
            name("front of the cloud"),
            1e3 * last.front,
            "mm",
            1e3 * reach,
            "free surface of a plane shock [C]",
        ),
        Check::shown(name("mean speed of the cloud"), mean, "m/s", 0.5 * SPEED, "half the impact speed"),
        Check::shown(name("length over width of the cloud"), 0.5 * length / last.radius, "-", 1.39, memory),
        Check::shown(name("diameter of the hole at the end"), 2e3 * last.hole, "mm", 34.5, memory),
        Check::shown(
            name("cells of the cloud that touch no other"),
            outcome.parts.alone as f64 / outcome.parts.cells as f64,
            "-",
            0.0,
            "an unbroken cloud",
        ),
        Check::gate(name("mass"), outcome.mass[0], "-", 1.0, 1e-12, free),
        Check::shown(name("mass over that of the shapes"), outcome.mass[1], "-", 1.0, "exact volumes"),
        Check::gate(name("momentum error"), momentum, "-", 0.0, MOMENTUM_TOLERANCE, free),
        Check::gate(name("energy error"), energy, "-", 0.0, ENERGY_TOLERANCE, free),
        Check::shown(
            name("energy that splitting brought to light"),
            outcome.cuts.kinetic / outcome.energy,
            "-",
            0.0,
            "books",
        ),
    ]
}
