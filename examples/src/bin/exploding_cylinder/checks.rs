//! Checks of the runs.

use examples::{Check, Resolution};

use crate::gurney;
use crate::scene::Outcome;
use crate::setup::{CHARGE, DENSITY, GURNEY, HARDENING};

/// Tolerances of the speed by resolution: with 16, 40 and 80 cells on the radius of the charge the worst of six runs was
/// 3.5, 1.2 and 0.6 % slow.
const SPEED_TOLERANCE: [f64; 3] = [0.04, 0.015, 0.008];
/// Tolerance of the finite differences with half the zones, small against [`SPEED_TOLERANCE`].
const ZONES_TOLERANCE: f64 = 0.001;
/// Tolerances of the estimate, which neglects waves in the products: finite differences are up to 3.4 % off it, either way,
/// and runs are slower as above.
const GURNEY_TOLERANCE: [f64; 3] = [0.06, 0.05, 0.045];
const ENERGY_TOLERANCE: f64 = 0.01;
const MOMENTUM_TOLERANCE: f64 = 1e-12;
/// Tolerance of the masses: particles that surfaces cut have the volume inside.
const MASS_TOLERANCE: f64 = 1e-3;

/// Check a case that stays whole.
pub fn of_speed(outcome: &Outcome, resolution: Resolution) -> Vec<Check> {
    let (setup, last) = (&outcome.setup, outcome.last());
    let ratio = setup.mass_ratio();
    let name = |what: &str| format!("M/C {ratio:.2}, lit {}: {what}", setup.lit.words());
    let choose = |[smoke, standard, paper]: [f64; 3]| resolution.choose(smoke, standard, paper);
    let (rows, half) = &outcome.alone;
    let alone = rows.last().map_or(f64::NAN, |r| r[1]);
    let differences = "finite differences in one dimension [C]";
    let estimate = "Gurney, energy given off by the products [C]";
    let speed = || name("speed of the case");
    let mut found = vec![
        Check::gate(speed(), last.speed, "m/s", alone, choose(SPEED_TOLERANCE), differences),
        Check::gate(
            name("finite differences with half the zones"),
            *half,
            "m/s",
            alone,
            ZONES_TOLERANCE,
            differences,
        ),
        Check::gate(
            speed(),
            last.speed,
            "m/s",
            gurney::speed(setup, last.volume),
            choose(GURNEY_TOLERANCE),
            estimate,
        ),
        Check::remembered(
            speed(),
            last.speed,
            "m/s",
            gurney::thin(GURNEY[0], ratio),
            "Gurney, sqrt(2 E) = 2.37 km/s [M]",
        ),
        Check::remembered(
            speed(),
            last.speed,
            "m/s",
            gurney::thin(GURNEY[1], ratio),
            "Gurney, sqrt(2 E) = 2.44 km/s [M]",
        ),
    ];
    found.extend(of_books(outcome, &name));
    found
}

fn of_books(outcome: &Outcome, name: &dyn Fn(&str) -> String) -> Vec<Check> {
    let last = outcome.last();
    let energy = (last.kinetic[0] + last.kinetic[1] + last.internal) / outcome.chemical;
    let [gas, case] = outcome.masses;
    vec![
        Check::gate(name("mass of the charge"), gas, "-", 1.0, MASS_TOLERANCE, "exact volume"),
        Check::gate(name("mass of the case"), case, "-", 1.0, MASS_TOLERANCE, "exact volume"),
        Check::gate(
            name("energy gained over the chemical energy"),
            energy,
            "-",
            0.0,
            ENERGY_TOLERANCE,
            "conservation",
        ),
        Check::gate(
            name("momentum error"),
            outcome.totals.momentum_error,
            "-",
            0.0,
            MOMENTUM_TOLERANCE,
            "conservation",
        ),
    ]
}

/// Check a case that breaks: numbers of pieces at all looks, speed against a case that stays whole, balances.
pub fn of_pieces(outcome: &Outcome, pieces: &[usize], whole: Option<&Outcome>) -> Vec<Check> {
    let name = |what: &str| format!("case that breaks: {what}");
    let most = pieces.iter().copied().max().unwrap_or(0);
    let setup = &outcome.setup;
    let mut found = vec![
        Check::gate(
            name("pieces at the first look"),
            pieces.first().map_or(f64::NAN, |&n| n as f64),
            "-",
            1.0,
            0.0,
            "none has failed",
        ),
        Check::at_least(name("pieces"), most as f64, "-", 2.0, "it breaks"),
    ];
    if let Some(breaks) = setup.breaks {
        // Radius at which most sections fail, in plane strain.
        let growth = (0.5 * 3f64.sqrt() * breaks.strain).exp();
        let radius = growth * (CHARGE + 0.5 * setup.case);
        let speed =
            outcome.rows.iter().find(|r| r.radius >= radius).map_or(outcome.last().speed, |r| r.speed);
        let [a, b, n] = HARDENING;
        let stress = 2.0 / 3f64.sqrt() * (a + b * breaks.strain.powf(n));
        let length = 1.5 * (2.0 * stress / (DENSITY[1] * breaks.scatter)).sqrt() * radius / speed;
        let expected = std::f64::consts::TAU * radius / length;
        found.push(Check::remembered(
            name("most pieces, beside Mott"),
            most as f64,
            "-",
            expected,
            "Mott [M]",
        ));
    }
    if let Some(whole) = whole.map(Outcome::last)
        && let Some(then) = outcome.rows.iter().find(|r| r.time >= whole.time)
    {
        found.push(Check::unreferenced(
            name("speed over that of one that keeps whole"),
            then.speed / whole.speed,
            "-",
            "less work goes into plastic flow",
        ));
    }
    found.extend(of_books(outcome, &name));
    found
}
