//! Checks of the runs.

use examples::Check;

use crate::plane::{self, Row as Plane};
use crate::scene::Outcome;
use crate::setup::{END, Plate, SHOCK, SPEED, THICKNESS};

const STATE_TOLERANCE: f64 = 0.01;
/// Tolerance of the peak pressure near the axis: the front is some particles wide.
const PEAK_TOLERANCE: f64 = 0.03;
/// Tolerance of the mass: particles at surfaces have the volume inside, by quadrature.
const SHAPE_TOLERANCE: f64 = 1e-6;
const ENERGY_TOLERANCE: f64 = 0.02;
const MOMENTUM_TOLERANCE: f64 = 1e-12;

/// Check the state behind a plane shock in cells of this size.
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

/// Check one cloud.
pub fn of_cloud(outcome: &Outcome) -> Vec<Check> {
    let theory = plane::shocked();
    let name = |what: &str| {
        let how = match (outcome.setup.method, outcome.setup.cutting) {
            (Plate::Afemp, _) => "plate of elements",
            (_, Some(_)) => "split",
            (_, None) => "not split",
        };
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
    let gauged = outcome.setup.method == Plate::Mpm;
    vec![
        Check::gate(
            name("peak pressure in the middle of the plate"),
            1e-9 * peak,
            "GPa",
            1e-9 * theory.pressure,
            PEAK_TOLERANCE,
            hugoniot,
        )
        .judged_if(
            gauged && outcome.setup.layers >= 10,
            "a plate of less than ten layers is less than five cells thick, and elements have no gauge",
        ),
        Check::at_most(
            name("front of the cloud"),
            1e3 * last.front,
            "mm",
            1e3 * reach,
            "free surface of a plane shock [C]",
        ),
        Check::at_most(name("mean speed of the cloud"), mean, "m/s", 0.5 * SPEED, "half the impact speed"),
        Check::remembered(
            name("length over width of the cloud"),
            0.5 * length / last.radius,
            "-",
            1.39,
            memory,
        ),
        Check::remembered(name("diameter of the hole at the end"), 2e3 * last.hole, "mm", 34.5, memory),
        Check::unreferenced(name(ALONE), alone(outcome), "-", "an unbroken cloud has none"),
        Check::gate(name("mass"), outcome.mass[0], "-", 1.0, 1e-12, free),
        Check::gate(
            name("mass over that of the shapes"),
            outcome.mass[1],
            "-",
            1.0,
            SHAPE_TOLERANCE,
            "exact volumes",
        ),
        Check::gate(name("momentum error"), momentum, "-", 0.0, MOMENTUM_TOLERANCE, free),
        Check::gate(name("energy error"), energy, "-", 0.0, ENERGY_TOLERANCE, free),
        Check::unreferenced(
            name("energy that splitting brought to light"),
            outcome.cuts.kinetic / outcome.energy,
            "-",
            "books",
        ),
    ]
}

const ALONE: &str = "cells of the cloud that touch no other";

/// Fraction of the cells of the cloud without a neighbour.
fn alone(outcome: &Outcome) -> f64 {
    outcome.parts.alone as f64 / outcome.parts.cells as f64
}

/// Compare both clouds: splitting keeps a cloud together.
pub fn of_both(outcomes: &[Outcome]) -> Vec<Check> {
    let [whole, split] = outcomes else { return Vec::new() };
    if split.setup.method == Plate::Afemp {
        return of_elements(whole, split);
    }
    let ratio = alone(split) / alone(whole);
    vec![Check::at_most(
        format!("{ALONE}, split over not split"),
        ratio,
        "-",
        0.5,
        "splitting keeps it together",
    )]
}

/// Number of layers from which the cloud of a plate is judged.
const FINE: u32 = 8;
const DEAR: &str =
    "0.89 and 0.78 with 8 layers on plates of 80 and 160 mm: sphere and cloud are particles in both";

/// Compare a plate of elements that become particles with one of particles.
fn of_elements(particles: &Outcome, elements: &Outcome) -> Vec<Check> {
    let name = |what: &str| format!("plate of elements: {what}");
    let beside = "a plate of particles";
    let [a, b] = [elements, particles].map(Outcome::last);
    let speed = |row: &crate::track::Row| row.momentum / row.mass;
    let cost = elements.totals.wall_seconds / particles.totals.wall_seconds;
    let fine = elements.setup.layers >= FINE;
    let thin = "a plate of three cells is mostly surface";
    let cost = Check::at_most(name("cost"), cost, "-", 0.6, beside).known_miss(DEAR);
    let mut checks = vec![
        Check::gate(name("mean speed of the cloud"), speed(&a), "m/s", speed(&b), 0.03, beside)
            .judged_if(fine, thin),
        Check::gate(name("mass of the cloud"), 1e3 * a.mass, "g", 1e3 * b.mass, 0.03, beside)
            .judged_if(fine, thin),
        Check::gate(name("front of the cloud"), 1e3 * a.front, "mm", 1e3 * b.front, 0.03, beside),
        cost.judged_if(fine, thin),
    ];
    if let Some(book) = &elements.converted {
        let share = book.energy.abs() / elements.energy;
        checks.push(Check::at_most(
            name("energy that appeared"),
            share,
            "-",
            0.03,
            "of the energy at impact",
        ));
        let shape = THICKNESS * elements.setup.half_width.powi(2) * SHOCK[0];
        checks.push(Check::unreferenced(
            name("mass that became particles"),
            book.mass / shape,
            "-",
            "of the plate",
        ));
    }
    checks
}
