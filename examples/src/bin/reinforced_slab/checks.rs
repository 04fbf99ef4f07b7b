//! Checks of reinforced slabs.

use examples::{Check, worst};

use crate::scene::Outcome;
use crate::setup::{DENSITY, Load, Setup};

/// Rounding of 1e-16 per step over some thousand steps; 1e-12 if all errors have the same sign.
const MOMENTUM: f64 = 1e-12;
/// Mass of line elements: rounding.
const MASS: f64 = 1e-12;
/// Tolerance of the energy gain over the largest energy of a run. Losses are shown only.
const GAIN: f64 = 0.01;
/// Required ratio of the numbers of particles and nodes of bars.
const FEWER: f64 = 20.0;

/// Check slabs of increasing reinforcement, the first without bars.
pub fn of_series(outcomes: &[Outcome]) -> Vec<Check> {
    let mut found = Vec::new();
    if let Some(plain) = outcomes.first() {
        let name = format!("{}: {}", words(&plain.setup), load(&plain.setup));
        found.push(Check::unreferenced(name, value(plain), unit(&plain.setup), ""));
    }
    for outcome in outcomes {
        let setup = &outcome.setup;
        let name = |what: &str| format!("{}: {what}", words(setup));
        let last = outcome.last();
        match setup.load {
            Load::Rod => {
                let taken = setup.energy() * (1.0 - (last.speed / setup.speed).powi(2));
                if setup.section > 0.0 {
                    let part = last.internal[0] / taken;
                    let remark = "of what the rod lost";
                    found.push(Check::unreferenced(name("energy in the bars"), part, "-", remark));
                }
            }
            Load::Blast => {
                let most =
                    outcome.rows.iter().map(|r| r.internal[0] / (r.internal[0] + r.internal[1]).max(1e-300));
                if setup.section > 0.0 {
                    let part = most.fold(0.0, f64::max);
                    let remark = "of all internal energy, at most";
                    found.push(Check::unreferenced(name("energy in the bars"), part, "-", remark));
                }
            }
        }
        found.push(Check::unreferenced(name("damaged part of the slab"), last.damaged, "-", "fully"));
        if setup.section > 0.0 {
            let mass = setup.bars_mass(DENSITY[1] - DENSITY[0]);
            let exact = "section times length, less the concrete";
            found.push(Check::gate(name("mass of the bars"), outcome.mass, "kg", mass, MASS, exact));
        }
    }
    for pair in outcomes.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        let (a, b) = (words(&a.setup), words(&b.setup));
        let [before, after] = [&pair[0], &pair[1]].map(value);
        let what = load(&pair[0].setup);
        let source = format!("more steel holds more: that of {a}");
        found.push(Check::at_most(format!("{b}: {what}"), after, unit(&pair[0].setup), before, &source));
    }
    found
}

/// Compare a slab without bars, with line elements and with bars of particles.
pub fn of_comparison(plain: &Outcome, lines: &Outcome, particles: &Outcome) -> Vec<Check> {
    let setup = &lines.setup;
    let name = |what: &str| format!("small slab, {}: {what}", load(setup));
    let [none, line, resolved] = [plain, lines, particles].map(value);
    let exact = setup.bars_mass(DENSITY[1]);
    vec![
        Check::unreferenced(name("without bars"), none, unit(setup), ""),
        Check::unreferenced(name("bars of lines"), line, unit(setup), ""),
        Check::unreferenced(name("bars of particles"), resolved, unit(setup), ""),
        Check::unreferenced(name("lines over particles"), line / resolved, "-", "the same bars"),
        Check::unreferenced(
            name("what lines hold back over what particles do"),
            (none - line) / (none - resolved),
            "-",
            "the same bars",
        ),
        Check::at_most(name("lines over no bars"), line / none, "-", 1.0, "bars hold"),
        Check::at_most(name("particles over no bars"), resolved / none, "-", 1.0, "bars hold"),
        Check::gate(
            name("mass of the bars of particles"),
            particles.mass,
            "kg",
            exact,
            MASS_OF_PARTICLES,
            "section times length",
        ),
        Check::at_least(
            name("particles of steel over nodes of lines"),
            particles.points as f64 / lines.points as f64,
            "-",
            FEWER,
            "asked for",
        )
        .judged_if(setup.cell() < 0.6 * setup.section.sqrt(), "two particles across a bar"),
    ]
}

/// Tolerance of the mass: resolved bars are on the lattice, and do not cross.
const MASS_OF_PARTICLES: f64 = 1e-9;

fn value(outcome: &Outcome) -> f64 {
    match outcome.setup.load {
        Load::Rod => outcome.residual(),
        Load::Blast => 1e3 * outcome.deflection(),
    }
}

fn unit(setup: &Setup) -> &'static str {
    match setup.load {
        Load::Rod => "m/s",
        Load::Blast => "mm",
    }
}

fn load(setup: &Setup) -> &'static str {
    match setup.load {
        Load::Rod => "residual speed",
        Load::Blast => "deflection",
    }
}

/// Describe the slab in words.
pub fn words(setup: &Setup) -> String {
    let load = match setup.load {
        Load::Rod => format!("{:.0} m/s", setup.speed),
        Load::Blast => format!("{:.0} MPa", 1e-6 * setup.blast[0]),
    };
    if setup.section == 0.0 {
        format!("{load}, no bars")
    } else {
        format!("{load}, bars of {:.2} cm^2", 1e4 * setup.section)
    }
}

/// Check conservation in all runs.
pub fn of_books(outcomes: &[&Outcome]) -> Vec<Check> {
    let gained = outcomes.iter().map(|o| o.gained).fold(0.0, f64::max);
    let lost = outcomes.iter().map(|o| -o.totals.energy_error).fold(0.0, f64::max);
    let momentum = worst(outcomes.iter().map(|o| o.totals.momentum_error));
    vec![
        Check::at_most("energy gained, of the largest energy", gained, "-", GAIN, "conservation"),
        Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"),
        Check::unreferenced("energy lost by contact and filter, at most", lost, "-", "of the largest energy"),
    ]
}
