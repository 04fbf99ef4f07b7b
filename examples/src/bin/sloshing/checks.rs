//! Checks of sloshing.

use std::f64::consts::PI;

use examples::series::{decay, extrema, interpolate, period};
use examples::{Check, largest, worst};

use crate::scene::{CENTRE, HEIGHT, KINETIC, MODE, Outcome, UNEXPLAINED, VOLUME, WALL, WALL_MODES};
use crate::setup::{SWAY, Study};
use crate::theory::{Mode, shift};

/// Tolerance of periods: time integration, (w dt)^2 / 24, and the nonlinear change, of the order of (k a)^2, are below 0.1 % each.
const PERIOD: f64 = 2e-3;
/// Cells over a wavelength from which periods are judged.
const WAVE: u32 = 40;
/// Tolerance of the amplitude after four periods.
const AMPLITUDE: f64 = 0.02;
/// Tolerance of the forced sway, of the largest shift of the theory.
const FORCED: f64 = 0.02;
/// Tolerance of the rate of decay: 2 % of amplitude over four periods, beside a decay by 37 %.
const DECAY: f64 = 0.05;
/// Tolerance of the volume of the level set.
const VOLUME_KEPT: f64 = 1e-3;
/// Tolerance of the height of the centre of mass at rest, cells: it is displaced by the density correction.
const LIFTED: f64 = 0.02;
/// Tolerance of the energy over the largest kinetic energy.
const ENERGY: f64 = 0.02;
/// Rounding of hundreds of impulses of gravity, each a thousand times the momentum of a small wave.
const MOMENTUM: f64 = 1e-10;
/// Multiples of the first period at which the sway is compared.
pub const COMPARED: [f64; 5] = [1.0, 1.5, 2.0, 2.5, 3.0];

const LINEAR: &str = "linear theory [C]";
const NORMAL: &str = "the normal viscous stress at the surface is that of the cells beside it: the rate is 6, 3, 2 % low with 40, 64, 128 cells";
const LOW: &str = "waves lower than a cell: periods of mode 2 within 0.21 %, amplitudes of mode 3 within 2.2 %, since a tenth of the divergence is not reflected";
const LIFT: &str = "the density correction lifts the centre of mass by some joules of potential energy";
const LEVEL: &str =
    "the level set of particles near walls and in crests has the volume within some thousandths";

/// Check all runs.
pub fn of(outcomes: &[Outcome]) -> Vec<Check> {
    let mut checks: Vec<Check> = outcomes.iter().flat_map(of_one).collect();
    if outcomes.is_empty() {
        return checks;
    }
    let momentum = worst(outcomes.iter().map(|o| o.run.totals.momentum_error));
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM, "conservation"));
    checks
}

fn of_one(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let name = |what: &str| format!("{}: {what}", setup.name());
    let mut checks = match setup.study {
        Study::Wave => wave(outcome),
        Study::Sway => sway(outcome),
        Study::Decay => viscous(outcome),
        Study::Cost => Vec::new(),
        Study::Long => {
            let most = largest(outcome.run.values(KINETIC));
            let unexplained = worst(outcome.run.values(UNEXPLAINED)) / most;
            let lifted = (outcome.run.last()[HEIGHT] - outcome.run.rows[0].1[HEIGHT]) / setup.spacing();
            vec![
                Check::gate(
                    name("unexplained energy over the largest kinetic one"),
                    unexplained,
                    "-",
                    0.0,
                    ENERGY,
                    "conservation",
                )
                .known_miss(LIFT),
                Check::unreferenced(
                    name("rise of the centre of mass at the end, cells"),
                    lifted,
                    "-",
                    "it still moves",
                ),
            ]
        }
    };
    let volumes = || outcome.run.values(VOLUME).filter(|v| *v > 0.0).map(|v| v / setup.volume() - 1.0);
    let volume = Check::gate(
        name("change of volume, largest"),
        worst(volumes()),
        "-",
        0.0,
        VOLUME_KEPT,
        "incompressible",
    );
    checks.push(if setup.study == Study::Long { volume.known_miss(LEVEL) } else { volume });
    checks
}

/// Check a standing wave: its period over the last three and a half periods, its amplitude in the first and in the last.
fn wave(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let name = |what: &str| format!("{}: {what}", setup.name());
    let (mode, series) = (Mode::new(setup.mode, setup), outcome.run.series(MODE));
    let peaks = extrema(&series);
    let kept = peaks.last().map_or(f64::NAN, |last| last[1]) / setup.amplitude;
    let mean = outcome.run.values(HEIGHT).sum::<f64>() / outcome.run.rows.len() as f64;
    let lifted = (mean - 0.5 * setup.depth) / setup.spacing();
    // Elevations raise the centre of mass by the mean square over 2 H, half of the square of the amplitude, a half of it over time.
    let raised = setup.amplitude.powi(2) / (8.0 * setup.depth) / setup.spacing();
    let duration = Check::gate(name("period"), period(&series), "s", mode.period(), PERIOD, LINEAR)
        .judged_if(2 * setup.cells >= WAVE * setup.mode, "a wave has less than 40 cells");
    let amplitude = name("amplitude after four periods over the first");
    let amplitude = Check::gate(amplitude, kept, "-", 1.0, AMPLITUDE, "inviscid");
    vec![
        if setup.mode == 2 && setup.cells == 64 { duration.known_miss(LOW) } else { duration },
        if setup.mode == 3 && setup.cells >= 64 { amplitude.known_miss(LOW) } else { amplitude },
        Check::gate(
            name("mean rise of the centre of mass, cells"),
            lifted - raised,
            "-",
            0.0,
            LIFTED,
            "conservation",
        ),
    ]
}

/// Check the shift of the centre of mass and the elevation at the wall in a tank that sways.
fn sway(outcome: &Outcome) -> Vec<Check> {
    let (setup, first) = (&outcome.setup, Mode::new(1, &outcome.setup));
    let w = SWAY[1] * first.frequency();
    let wall =
        |t: f64| WALL_MODES.iter().map(|n| Mode::new(*n, setup).swayed(w, t, setup.length)).sum::<f64>();
    let check = |what: &str, measure: usize, rest: f64, exact: &dyn Fn(f64) -> f64| {
        let scale = largest(COMPARED.iter().map(|p| exact(p * first.period()).abs()));
        let series = outcome.run.series(measure);
        COMPARED.map(|periods| {
            let t = periods * first.period();
            let found = (interpolate(series.iter().copied(), t * (1.0 - 1e-12)) - rest) / SWAY[0];
            let name = format!("sway: {what} over A at {periods} T1");
            // The tolerance is relative to the largest value.
            Check::gate(name, found, "-", exact(t), FORCED * scale / exact(t).abs(), LINEAR)
        })
    };
    let centre = check("centre of mass", CENTRE, 0.5 * setup.length, &|t| shift(setup, w, t));
    let wall = check("elevation at the wall, modes 1, 3, 5,", WALL, 0.0, &wall);
    centre.into_iter().chain(wall).collect()
}

/// Check the decay of a standing wave.
fn viscous(outcome: &Outcome) -> Vec<Check> {
    let setup = &outcome.setup;
    let (mode, series) = (Mode::new(1, setup), outcome.run.series(MODE));
    let exact = mode.decay(setup.viscosity, setup.depth);
    let found = decay(&series);
    let theory = "no stress at the surface, linear theory [C]";
    let rate = Check::gate("decay: rate", found, "1/s", exact, DECAY, theory);
    vec![
        if setup.cells <= 40 { rate.known_miss(NORMAL) } else { rate },
        Check::unreferenced(
            "decay: rate over 2 nu k^2",
            found / (2.0 * setup.viscosity * (PI / setup.length).powi(2)),
            "-",
            "1/2 without the normal viscous stress [C]",
        ),
    ]
}
