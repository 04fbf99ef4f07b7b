//! Checks of the runs.

use examples::Check;

use crate::breaking;
use crate::scene::Outcome;
use crate::setup::Means;
use crate::theory::{elastic, mott, rigid};

/// Tolerances of radius and time off a thin ring, over (thickness over radius)^2: 0.011 and 0.017 were found for the radius,
/// 0.055 for the time, on the finest grids.
const THICKNESS: [f64; 2] = [0.02, 0.07];
/// Tolerances of the limit of a thin ring: errors of fourth order in the thickness, and of the grid, were 5e-6 and 3e-5
/// with eight cells.
const LIMIT: [f64; 2] = [1e-5, 5e-5];
/// Tolerance of the order in the thickness: terms of fourth order took up to 0.12 from it.
const ORDER: f64 = 0.2;
/// Tolerance of the stress: 1e-4 was found for material points.
const STRESS: f64 = 1e-3;
/// Tolerance of the energy of material points, over the kinetic energy at the start: the dissipation of AFLIP falls with
/// the cell, 8e-5 with eight of them.
const ENERGY: f64 = 2e-4;
/// Tolerance of the energy of elements, which conserve it to second order in the step: 1e-9 was found.
const ELEMENTS_ENERGY: f64 = 1e-8;
/// Tolerance between both methods at the same size: 1e-6 was found.
const METHODS: f64 = 1e-5;
const MASS: f64 = 5e-3;
const MOMENTUM: f64 = 1e-12;
/// Tolerance of the energy of a breaking ring, over that at the start: 1 % with two cells, 0.7 % with four.
const BROKEN_ENERGY: f64 = 0.015;

/// Check the thin ring, and its limit extrapolated with the one twice as thick, by the same method.
pub fn of_rest(thin: &Outcome, thick: &Outcome) -> Vec<Check> {
    let setup = thin.setup;
    let (metal, r0) = (&setup.metal, setup.radius);
    let (limit, exact) = (rigid(metal, r0), elastic(metal, r0));
    let name = |what: &str| format!("{}, {}: {what}", metal.name, setup.means.name());
    let square = (setup.thickness / r0).powi(2);
    let formula = "rigid thin ring, r0 exp(rho v^2 / 2 Y) [C]";
    let with = "elastic thin ring [C]";
    // The effect of elasticity is known; that of the thickness was measured.
    let allowed = |limit: f64, exact: f64, part: f64| (exact / limit - 1.0).abs() + part * square;
    let extrapolated = |thin: f64, thick: f64| (4.0 * thin - thick) / 3.0;
    let off = |o: &Outcome| (o.rest.radius / exact.radius - 1.0).abs();
    vec![
        Check::gate(
            name("radius at rest"),
            1e3 * thin.rest.radius,
            "mm",
            1e3 * limit.radius,
            allowed(limit.radius, exact.radius, THICKNESS[0]),
            formula,
        ),
        Check::gate(
            name("time to rest"),
            1e6 * thin.rest.time,
            "µs",
            1e6 * limit.time,
            allowed(limit.time, exact.time, THICKNESS[1]),
            formula,
        ),
        Check::gate(
            name("radius at rest, no thickness"),
            1e3 * extrapolated(thin.rest.radius, thick.rest.radius),
            "mm",
            1e3 * exact.radius,
            LIMIT[0],
            with,
        ),
        Check::gate(
            name("time to rest, no thickness"),
            1e6 * extrapolated(thin.rest.time, thick.rest.time),
            "µs",
            1e6 * exact.time,
            LIMIT[1],
            with,
        ),
        Check::gate(
            name("order in the thickness"),
            (off(thick) / off(thin)).log2(),
            "-",
            2.0,
            ORDER,
            "theory",
        ),
        Check::gate(name("hoop stress over yield stress"), thin.hoop, "-", 1.0, STRESS, "thin ring [C]"),
        Check::gate(
            name("energy error"),
            thin.totals.energy_error,
            "-",
            0.0,
            if setup.means == Means::Mpm { ENERGY } else { ELEMENTS_ENERGY },
            "conservation",
        ),
    ]
}

/// Check a softer ring.
pub fn of_soft(soft: &Outcome) -> Vec<Check> {
    let setup = soft.setup;
    let (metal, r0) = (&setup.metal, setup.radius);
    let exact = elastic(metal, r0);
    let square = (setup.thickness / r0).powi(2);
    let name =
        |what: &str| format!("{}, {}, {:.0} GPa: {what}", metal.name, setup.means.name(), 1e-9 * metal.young);
    let with = "elastic thin ring [C]";
    let [r, t] = [soft.rest.radius, soft.rest.time];
    vec![
        Check::gate(name("radius at rest"), 1e3 * r, "mm", 1e3 * exact.radius, THICKNESS[0] * square, with),
        Check::gate(name("time to rest"), 1e6 * t, "µs", 1e6 * exact.time, THICKNESS[1] * square, with),
    ]
}

/// Compare two methods.
pub fn of_methods(one: &Outcome, other: &Outcome) -> Check {
    Check::gate(
        format!(
            "{}: radius of {} over that of {}",
            one.setup.metal.name,
            one.setup.means.name(),
            other.setup.means.name()
        ),
        one.rest.radius / other.rest.radius,
        "-",
        1.0,
        METHODS,
        "the same ring",
    )
}

/// Check a ring that breaks; `chain` is the number of its pieces as a chain of bars.
pub fn of_break(outcome: &breaking::Outcome, chain: usize) -> Vec<Check> {
    let setup = &outcome.setup;
    let name = |what: &str| format!("{:.0} m/s: {what}", setup.metal.speed);
    let count = |n: usize| n as f64;
    let end = outcome.rows.last();
    let pieces = end.map_or(0, |r| r.pieces);
    let before = outcome.rows.iter().rev().nth(outcome.rows.len() / 3).map_or(0, |r| r.pieces);
    // Most bars break near the mode of the strains.
    let radius = setup.radius * setup.strain.exp();
    let expected =
        std::f64::consts::TAU * radius / mott(&setup.metal, setup.scatter, setup.metal.speed / radius);
    vec![
        Check::gate(name("mass"), outcome.mass, "-", 1.0, MASS, "exact volume"),
        Check::at_least(name("pieces"), count(pieces), "-", 2.0, "it breaks"),
        Check::gate(
            name("pieces at the end over those at two thirds of the time"),
            count(pieces) / count(before),
            "-",
            1.0,
            0.1,
            "pieces are unloaded",
        ),
        Check::gate(
            name("momentum error"),
            outcome.totals.momentum_error,
            "-",
            0.0,
            MOMENTUM,
            "conservation",
        ),
        Check::gate(
            name("energy error"),
            outcome.totals.energy_error,
            "-",
            0.0,
            BROKEN_ENERGY,
            "conservation",
        ),
        Check::remembered(name("pieces beside Mott"), count(pieces), "-", expected, "Mott [M]"),
        Check::unreferenced(
            name("pieces of a chain of bars"),
            count(chain),
            "-",
            "bars of a cell; it goes with their length",
        ),
    ]
}

/// Check that a faster ring has more pieces.
pub fn of_speeds(outcomes: &[breaking::Outcome]) -> Option<Check> {
    let (first, last) = (outcomes.first()?, outcomes.last()?);
    let pieces = |o: &breaking::Outcome| o.rows.last().map_or(0.0, |r| r.pieces as f64);
    let [slow, fast] = [first, last].map(|o| o.setup.metal.speed);
    (fast > slow).then(|| {
        let name = format!("pieces at {fast:.0} m/s over those at {slow:.0} m/s");
        Check::at_least(name, pieces(last) / pieces(first), "-", 1.0, "the faster, the more")
    })
}
