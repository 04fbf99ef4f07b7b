//! Checks of water entry.

use examples::{Check, Coupling, largest, worst};

use crate::scene::Outcome;
use crate::setup::Method;
use crate::theory::{SIMILARITY, von_karman, wagner};

/// Rounding of 1e-16 per step over thousands of steps.
const MOMENTUM: f64 = 1e-12;
/// Tolerance of the penetration over the particle distance, allowed by contact.
const DEPTH: f64 = 0.05;
/// Tolerance of the force of a rigid wedge between different sizes of elements.
const ALIKE: f64 = 0.02;
/// Cells in the wetted half breadth at mid-run from which the force is evaluated: with fewer it depends on the first cells.
const RESOLVED: f64 = 8.0;
/// Tolerance of the energy gain over the work of the wedge.
const GAIN: f64 = 0.01;
/// Deadrise angle of the similarity solution, rad.
const KNOWN: f64 = std::f64::consts::FRAC_PI_6;

/// Check runs with different sizes of elements.
pub fn of(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks: Vec<Check> = outcomes.iter().flat_map(of_one).collect();
    let rigid: Vec<f64> = outcomes
        .iter()
        .filter(|o| o.setup.method == Method::Mpm && o.setup.young.is_none() && is_tight(o))
        .map(Outcome::factor)
        .collect();
    if let [first, rest @ ..] = &rigid[..]
        && !rest.is_empty()
    {
        let apart = largest(rest.iter().map(|factor| (factor / first - 1.0).abs()));
        checks.push(Check::at_most(
            "force, elements of other sizes",
            apart,
            "-",
            ALIKE,
            "a rigid wedge has none",
        ));
    }
    let momentum = worst(outcomes.iter().map(|o| o.totals.momentum_error));
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"));
    checks
}

/// True if no particle may be in the wedge.
fn is_tight(outcome: &Outcome) -> bool {
    outcome.setup.method == Method::Flow || outcome.setup.coupling == Coupling::Surface
}

fn of_one(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let of = |what: &str| format!("{}: {what}", setup.name());
    let (count, depth) =
        (of("particles with their centre in the wedge"), of("deepest particle, of its size"));
    let (inside, deepest) = (outcome.inside() as f64, outcome.depth());
    let mut checks = if setup.method == Method::Flow {
        vec![Check::at_most(
            of("deepest centre of a particle in the wedge, cells"),
            outcome.deepest() / setup.spacing(),
            "-",
            0.0,
            "impermeable",
        )]
    } else if is_tight(outcome) {
        vec![
            Check::at_most(count, inside, "-", 0.0, "contact"),
            Check::at_most(depth, deepest, "-", DEPTH, "contact"),
        ]
    } else {
        let source = "nodes further apart than those of the grid let particles through";
        vec![
            Check::unreferenced(count, inside, "-", source),
            Check::unreferenced(depth, deepest, "-", source),
        ]
    };
    checks.extend(forces(outcome));
    let [lost, gained] = outcome.energy_errors();
    let by = if setup.method == Method::Flow { "APIC, impacts of liquid on liquid" } else { "APIC, contact" };
    checks.extend([
        Check::at_most(of("energy gained, of the work of the wedge"), gained, "-", GAIN, "conservation"),
        Check::unreferenced(of("energy taken by the method, of the work"), lost, "-", by),
    ]);
    checks
}

/// Check force and pressure.
fn forces(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let of = |what: &str| format!("{}: {what}", setup.name());
    let (factor, name) = (outcome.factor(), of("F / (rho V^3 t)"));
    let pressure = largest(outcome.pressures.iter().map(|[_, pressure]| *pressure));
    if setup.young.is_some() {
        let bend = largest(outcome.rows.iter().map(|r| r.bend));
        return vec![
            Check::unreferenced(name, factor, "-", "an elastic wedge"),
            Check::unreferenced(of("keel bent up by"), 1e3 * bend, "mm", "an elastic wedge"),
        ];
    }
    let resolved = 0.5 * setup.wetted * f64::from(setup.cells) >= RESOLVED;
    let judged = |check: Check| {
        let check = check.judged_if(resolved, "the wetted breadth is a few cells wide");
        let leaks = !is_tight(outcome) && setup.edge > 1.0;
        check.judged_if(!leaks, "elements on the grid that are wider than cells leak")
    };
    let mut checks = vec![
        judged(Check::at_least(name.clone(), factor, "-", von_karman(setup), "no rise of the surface [C]")),
        judged(Check::at_most(name.clone(), factor, "-", wagner(setup), "a flat wedge, Wagner [C]")),
    ];
    if (setup.deadrise - KNOWN).abs() < 1e-9 {
        let source = "similarity solution, Zhao and Faltinsen 1993";
        checks.push(Check::remembered(name, factor, "-", SIMILARITY[0], source));
        let name = of("largest pressure over rho V^2 / 2");
        checks.push(Check::remembered(name, pressure, "-", SIMILARITY[1], source));
    }
    checks
}
