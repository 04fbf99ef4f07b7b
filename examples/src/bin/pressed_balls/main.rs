//! A plate presses a cubic pack of aluminium balls \[Ma2010\]: stress waves pass through the contacts. Also the cost of contact with a
//! thousand bodies.

mod chain;
mod compare;
mod figures;
mod scene;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Detection, Report, Restart, case, within};
use mpm_core::observe::{Pace, VtkSeries};
use mpm_core::output::History;

use scene::{ALUMINIUM, Outcome, SPACING, Setup, Switch};

/// A loaded plate on n x n x n aluminium balls in a box: 10 in the paper, 652 000 particles.
///
/// Momentum, load and arrival of the wave at the ground are checked; the exit code says whether they are within
/// the tolerances. Writes pictures, a CSV history and ParaView files. With --compare it only measures the cost of
/// contact, in alternation.
#[derive(Debug, Parser)]
#[command(name = "pressed_balls", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Balls along each edge, 1 to 30 [default: 3, 6 or 10 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=30))]
    balls: Option<u32>,
    /// Keep the balls apart, or let them share one velocity field
    #[arg(long, value_enum, default_value = "on")]
    contact: Switch,
    /// How contact is detected
    #[arg(long, value_enum, default_value = "plane")]
    detection: Detection,
    /// Coefficient of friction, 0 to 10
    #[arg(long, value_name = "MU", default_value_t = 0.0, value_parser = within(0.0, 10.0))]
    friction: f64,
    /// Pressure on the plate from the start, MPa, 0.01 to 100
    #[arg(long, value_name = "MPA", default_value_t = 10.0, value_parser = within(0.01, 100.0))]
    pressure: f64,
    /// ParaView frames [default: 4 in smoke, else 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: Option<u32>,
    /// Only measure what contact costs in time and memory, by turns with and without
    #[arg(long)]
    compare: bool,
    /// Rounds of that measurement, 1 to 1000
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,
}

/// Tolerance of the mean reaction in the second half of a run against the load: the reaction still oscillates by 0.8 of the load, and
/// averaging over three periods leaves 0.8 / (3 * 2 pi).
const LOAD_TOLERANCE: f64 = 0.05;
/// The total impulse of the load is 40 times the largest momentum; rounding of 1e-16 in each of 2e3 steps sums to 1e-11 if all errors have
/// the same sign.
const MOMENTUM_TOLERANCE: f64 = 1e-11;

/// Tolerance of the energy gain over kinetic and internal energy at any time. Both energies are half a step apart: if all energy changes
/// between them as sound crosses pack and plate, 20 cells or more, half a step of half a cell shifts 1 %.
const ENERGY_GAIN: f64 = 0.01;

/// Reason for the late arrival of the load. With staircase surfaces, faces of several particles were in contact from the start, and it
/// arrived in time.
const COARSE: &str =
    "five cells a diameter: balls that touch in a point begin 0.05 cells apart, and approach by 0.02";

impl Options {
    fn setup(&self) -> Setup {
        let balls = self.balls.unwrap_or(self.common.resolution.choose(3, 6, 10));
        Setup {
            balls,
            contact: self.contact,
            detection: self.detection,
            friction: self.friction,
            pressure: 1e6 * self.pressure,
            threads: self.common.threads(),
        }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("pressed_balls")?;
    let setup = options.setup();
    let (checks, totals, faces) = if options.compare {
        let (checks, totals) = compare::compare(&setup, options.rounds)?;
        (checks, totals, None)
    } else {
        let outcome = scene::press(&setup, series(options, &setup, &folder)?, restart)?;
        let chain = ALUMINIUM.chain(setup.balls as usize, setup.pressure, setup.end());
        figures::waves(&setup, &outcome)?.save(folder.join("waves.png"))?;
        figures::reaction(&outcome, &chain)?.save(folder.join("reaction.png"))?;
        write(&outcome, &folder)?;
        (checks_of(&setup, &outcome, &chain), outcome.totals, Some(outcome.faces))
    };
    let settings = serde_json::json!({
        "balls": setup.balls,
        "contact": setup.contact,
        "detection": setup.detection,
        "friction": setup.friction,
        "pressure": setup.pressure,
        "end": setup.end(),
        "threads": setup.threads,
        "compare": options.compare,
        "most_faces_in_contact": faces,
    });
    Report::new("pressed_balls", options.common.resolution, settings, &totals, checks)
        .finish(&options.common, &folder)
}

fn series(options: &Options, setup: &Setup, folder: &Path) -> Result<Option<VtkSeries>, CaseError> {
    let frames = options.frames.unwrap_or(options.common.resolution.choose(4, 1, 1));
    if frames == 0 {
        return Ok(None);
    }
    let pace = Pace::interval(setup.end() / f64::from(frames))?;
    Ok(Some(VtkSeries::create(folder.join("paraview"), "balls", pace)?))
}

/// Return the mean of the reaction in the second half of the run, over the load.
fn mean(outcome: &Outcome) -> f64 {
    let rows = &outcome.reaction[outcome.reaction.len() / 2..];
    let (mut impulse, mut time) = (0.0, 0.0);
    for pair in rows.windows(2) {
        impulse += pair[1][1] * (pair[1][0] - pair[0][0]);
        time += pair[1][0] - pair[0][0];
    }
    impulse / time
}

fn checks_of(setup: &Setup, outcome: &Outcome, chain: &[[f64; 2]]) -> Vec<Check> {
    let arrives = |level| 1e6 * chain::arrival(&outcome.reaction, level);
    // A signal may arrive earlier by the node at which it acts, on either side.
    let ahead = 2.0 * SPACING / ALUMINIUM.wave_speed();
    let first = 1e6 * (setup.transit() - ahead);
    let half = 1e6 * chain::arrival(chain, 0.5);
    let error = outcome.totals.momentum_error;
    let mut checks = vec![
        Check::at_most("energy gained", outcome.totals.energy_error, "-", ENERGY_GAIN, "conservation"),
        Check::gate("momentum error", error, "-", 0.0, MOMENTUM_TOLERANCE, "conservation"),
    ];
    let (load, wave, hertz) =
        ("mean reaction over load", "1 % of the load arrives", "half of the load arrives");
    let sources = ["statics [C]", "longitudinal wave [C]", "chain of Hertz contacts [C]"];
    checks.extend(match setup.contact {
        Switch::On => [
            Check::gate(load, mean(outcome), "-", 1.0, LOAD_TOLERANCE, sources[0]).known_miss(COARSE),
            Check::at_least(wave, arrives(0.01), "µs", first, sources[1]),
            Check::at_most(hertz, arrives(0.5), "µs", half, sources[2]).known_miss(COARSE),
        ],
        Switch::Off => {
            let other = "balls that stick are another body, which still swings at the end";
            [
                Check::unreferenced(load, mean(outcome), "-", other),
                Check::unreferenced(wave, arrives(0.01), "µs", other),
                Check::unreferenced(hertz, arrives(0.5), "µs", other),
            ]
        }
    });
    checks
}

fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [("time", "s"), ("reaction of the ground over the load", "-")];
    let mut file = History::create(folder.join("reaction.csv"), columns)?;
    for row in &outcome.reaction {
        file.push(row)?;
    }
    Ok(())
}
