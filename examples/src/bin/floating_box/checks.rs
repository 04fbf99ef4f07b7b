//! Checks of a floating box.

use examples::{Check, largest, worst};

use crate::scene::{ENERGY, HEIGHT, MOMENTUM, Outcome, TURN, VOLUME};
use crate::setup::{EDGE, GRAVITY, Setup, Study};
use crate::theory::{ROLLED, heave_period};

/// Tolerance of the depth of a box that floats.
const DEPTH: f64 = 0.01;
/// Largest change of the level, cells: twice the fiftieth of a cell by which the centroid of particles is uncertain.
const RISE: f64 = 0.04;
/// Tolerance of the period: the nonlinear change is of the order of the square of amplitude over draught, 3 %, times a fraction.
const PERIOD: f64 = 0.01;
/// Tolerance of the amplitude of a period over that of the period before.
const GROWTH: f64 = 1.005;
/// Tolerance of the depth of a light box, cells: it is less than one cell.
const SHALLOW: f64 = 0.1;
/// Largest turn of a box that is stable upright, degrees.
const UPRIGHT: f64 = 10.0;
/// Tolerance of the mean turn of a box that rolled over and swings about its rest.
const OVER: f64 = 0.1;
/// Rounding of hundreds of steps.
const ROUNDING: f64 = 1e-10;
/// Elements over half of the tank for the linear theory.
const ELEMENTS: usize = 80;

const ARCHIMEDES: &str = "Archimedes [C]";
const LINEAR: &str = "linear potential flow, finite elements [C]";

/// Check all runs.
pub fn of(outcomes: &[Outcome]) -> Vec<Check> {
    outcomes.iter().flat_map(of_one).collect()
}

fn of_one(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let name = |what: &str| format!("{}: {what}", setup.name());
    let mut checks = match setup.study {
        Study::Heave | Study::Space => heaves(outcome),
        Study::Light => light(outcome),
        Study::Roll => rolls(outcome),
        Study::Fall => falls(outcome),
    };
    if setup.study != Study::Fall {
        let gained = largest(outcome.run.values(ENERGY)) / setup.uncertain();
        checks.push(Check::at_most(
            name("largest energy over that of the start, of the uncertain one"),
            gained,
            "-",
            1.0,
            "conservation; centroids are uncertain by a hundredth of a cell",
        ));
        let momentum = outcome.run.totals.momentum_error;
        checks.push(Check::gate(name("momentum error"), momentum, "-", 0.0, ROUNDING, "conservation"));
    }
    let totals = &outcome.run.totals;
    let cost = 1e3 * totals.wall_seconds / totals.steps as f64;
    checks.push(Check::unreferenced(
        name("time of a step"),
        cost,
        "ms",
        &format!("{} points", totals.particles),
    ));
    checks
}

/// Heave of a box.
pub struct Heave {
    /// Mean height of the centre over whole periods, m.
    pub mean: f64,
    /// Mean period, s.
    pub period: f64,
    /// Largest deviation from the mean in each period, m.
    pub turns: Vec<f64>,
}

/// Evaluate heights over time: periods lie between falls through the mean height.
pub fn heave(heights: &[[f64; 2]]) -> Heave {
    let mean_of = |rows: &[[f64; 2]]| {
        let areas = rows.windows(2).map(|w| 0.5 * (w[1][0] - w[0][0]) * (w[1][1] + w[0][1]));
        areas.sum::<f64>() / (rows[rows.len() - 1][0] - rows[0][0])
    };
    let level = mean_of(heights);
    let falls = |w: &[[f64; 2]]| w[0][1] > level && w[1][1] <= level;
    let falls: Vec<usize> = (1..heights.len()).filter(|n| falls(&heights[n - 1..=*n])).collect();
    let time = |n: usize| {
        let [[t0, y0], [t1, y1]] = [heights[n - 1], heights[n]];
        t0 + (t1 - t0) * (y0 - level) / (y0 - y1)
    };
    let [first, .., last] = falls[..] else {
        return Heave { mean: f64::NAN, period: f64::NAN, turns: Vec::new() };
    };
    let mean = mean_of(&heights[first..=last]);
    let period = (time(last) - time(first)) / (falls.len() - 1) as f64;
    let turn = |w: &[usize]| largest(heights[w[0]..w[1]].iter().map(|[_, y]| (y - mean).abs()));
    Heave { mean, period, turns: falls.windows(2).map(turn).collect() }
}

/// Depth of the lower face below the surface at rest, m, of an upright box with this height of the centre.
fn depth(setup: &Setup, height: f64) -> f64 {
    setup.level() - (height - 0.5 * EDGE)
}

/// Check an upright box.
fn heaves(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let name = |what: &str| format!("{}: {what}", setup.name());
    let Heave { mean, period, turns } = heave(&outcome.run.series(HEIGHT));
    let grown = largest(turns.windows(2).map(|t| t[1] / t[0]));
    // The surface of particles is uncertain by hundredths of a cell; the law of Archimedes is about the liquid that is there.
    let rise = (late(outcome, VOLUME, 0.5) - setup.water()) / setup.area();
    let mut checks = vec![
        Check::at_most(
            name("rise of the level, cells"),
            (rise / setup.spacing()).abs(),
            "-",
            RISE,
            "incompressible",
        ),
        Check::gate(
            name("mean depth below the level"),
            1e3 * (depth(setup, mean) + rise),
            "mm",
            1e3 * setup.draught(),
            DEPTH,
            ARCHIMEDES,
        ),
        Check::at_most(
            name("largest growth of the heave in a period"),
            grown,
            "-",
            GROWTH,
            "waves take energy from it; half a per cent is the reading of an extremum between steps",
        ),
    ];
    if setup.study == Study::Heave {
        let exact = heave_period(setup, ELEMENTS);
        checks.insert(2, Check::gate(name("period of heave"), period, "s", exact, PERIOD, LINEAR));
    }
    checks
}

/// Mean of a measure over the last part of a run.
fn late(outcome: &Outcome, measure: usize, part: f64) -> f64 {
    let rows = outcome.run.series(measure);
    let from = (1.0 - part) * outcome.setup.end;
    let inside: Vec<[f64; 2]> = rows.into_iter().filter(|row| row[0] >= from).collect();
    let area: f64 = inside.windows(2).map(|w| 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1])).sum();
    area / (inside[inside.len() - 1][0] - inside[0][0])
}

/// Check a box that is light and free.
fn light(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let mean = late(outcome, HEIGHT, 0.5);
    let error = (depth(setup, mean) - setup.draught()) / setup.spacing();
    let turned = worst(outcome.run.values(TURN)).to_degrees().abs();
    vec![
        Check::gate(
            "light: error of the mean depth in the second half, cells",
            error,
            "-",
            0.0,
            SHALLOW,
            ARCHIMEDES,
        ),
        Check::at_most(
            "light: largest turn",
            turned,
            "degrees",
            UPRIGHT,
            "stable upright below 0.2113 of the density of water [C]",
        ),
    ]
}

/// Check a box that is unstable upright.
fn rolls(outcome: &Outcome) -> Vec<Check> {
    let turned = late(outcome, TURN, 0.5).to_degrees().abs();
    vec![
        Check::gate(
            "roll: mean turn in the second half",
            turned,
            "degrees",
            ROLLED,
            OVER,
            "least potential energy [C]",
        ),
        Check::unreferenced(
            "roll: turn at the end",
            outcome.run.last()[TURN].to_degrees(),
            "degrees",
            "it swings",
        ),
    ]
}

/// Check free fall.
fn falls(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let lost = largest(outcome.run.values(MOMENTUM));
    let fallen = outcome.run.rows[0].1[HEIGHT] - outcome.run.last()[HEIGHT];
    vec![
        Check::gate("fall: momentum lost", lost, "-", 0.0, ROUNDING, "conservation"),
        Check::gate(
            "fall: way of the box",
            fallen,
            "m",
            0.5 * GRAVITY * setup.end.powi(2),
            ROUNDING,
            "g t^2 / 2",
        ),
        Check::gate("fall: turn of the box", outcome.run.last()[TURN], "rad", 0.0, ROUNDING, "no pressure"),
    ]
}
