//! TNT slab: a layer of TNT, lit at a rigid wall, burns to its other end in plane strain. The detonation front, the pressure behind it and
//! the following Taylor wave are compared with the Chapman-Jouguet theory of the products (JWL), computed independently.

mod figures;
mod scene;
mod taylor_wave;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Report, Restart, case, within};

use scene::{LENGTH, Outcome, Setup};
use taylor_wave::CHAPMAN_JOUGUET;

/// TNT slab: 100 mm of TNT, lit at a rigid wall, burn to the other end.
///
/// Arrival times at four gauges, the pressure there and the flow behind the front are compared with the
/// Chapman-Jouguet state and the exact Taylor wave of the products; the exit code says whether all are within the
/// tolerances. Writes charts, CSV histories and a ParaView series.
#[derive(Debug, Parser)]
#[command(name = "tnt_slab", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Cells along the slab, 100 to 100000 [default: 1000, 2000 or 4000 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..=100_000))]
    cells: Option<u32>,
    /// Width of the burn in cells, 0.5 to 20
    #[arg(long, value_name = "CELLS", default_value_t = 4.0, value_parser = within(0.5, 20.0))]
    burn_width: f64,
    /// Only the programmed wave lights; what is compressed to the Chapman-Jouguet volume does not burn by itself
    #[arg(long)]
    no_compression_burn: bool,
    /// Time step over that of the sound speed, 0.01 to 1
    #[arg(long, value_name = "FACTOR", default_value_t = 0.3, value_parser = within(0.01, 1.0))]
    time_factor: f64,
    /// ParaView frames, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// Position from which gauges are evaluated, m: the front has built up.
const DECIDES_FROM: f64 = 0.03;
const BUILDS_UP: &str = "the front has not built up there yet: 1.1 % late and 6.2 % low with 2000 cells";
const ARRIVAL_TOLERANCE: f64 = 0.01;
const PRESSURE_TOLERANCE: f64 = 0.05;
const WAVE_TOLERANCE: f64 = 0.03;
const ENERGY_TOLERANCE: f64 = 0.01;
const MOMENTUM_TOLERANCE: f64 = 1e-12;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("tnt_slab")?;
    let setup = Setup {
        cells: options.cells.unwrap_or(common.resolution.choose(1000, 2000, 4000)),
        burn_width: options.burn_width,
        compression_burn: !options.no_compression_burn,
        time_factor: options.time_factor,
        threads: common.threads(),
    };
    let outcome = scene::burn(&setup, &folder, options.frames, restart)?;
    figures::draw(&outcome, &folder)?;
    let settings = serde_json::json!({
        "cells": setup.cells,
        "spacing": setup.spacing(),
        "burn_width": setup.burn_width,
        "compression_burn": setup.compression_burn,
        "time_factor": setup.time_factor,
        "threads": setup.threads,
        "length": LENGTH,
    });
    Report::new("tnt_slab", common.resolution, settings, &outcome.totals, checks_of(&outcome))
        .finish(common, &folder)
}

fn checks_of(outcome: &Outcome) -> Vec<Check> {
    let [detonation, pressure, ..] = CHAPMAN_JOUGUET;
    let theory = "Chapman-Jouguet state of the products [C]";
    let mut checks = Vec::new();
    let mut before = 0.0;
    for gauge in &outcome.gauges {
        let place = gauge.place;
        let at = format!("{:.1} mm", 1e3 * place);
        let (arrival, due) = (1e6 * gauge.arrival, 1e6 * gauge.place / detonation);
        let (peak, whole) = (1e-9 * gauge.peak, 1e-9 * pressure);
        if place >= DECIDES_FROM {
            let name = format!("{at}: arrival of the front");
            checks.push(Check::gate(name, arrival, "µs", due, ARRIVAL_TOLERANCE, theory));
            let name = format!("{at}: peak pressure");
            checks.push(Check::gate(name, peak, "GPa", whole, PRESSURE_TOLERANCE, theory));
            checks.push(Check::at_least(
                format!("{at}: peak over that of the gauge before"),
                peak / before,
                "-",
                1.0,
                "it rises with the distance run",
            ));
        } else {
            let name = format!("{at}: arrival of the front");
            let arrival = Check::gate(name, arrival, "µs", due, ARRIVAL_TOLERANCE, theory);
            checks.push(arrival.known_miss(BUILDS_UP));
            let name = format!("{at}: peak pressure");
            let peak = Check::gate(name, peak, "GPa", whole, PRESSURE_TOLERANCE, theory);
            checks.push(peak.known_miss(BUILDS_UP));
        }
        before = peak;
    }
    let last = outcome.gauges.last().map_or(0.0, |g| 1e-9 * g.peak);
    let name = "peak pressure at the last gauge";
    checks.push(Check::at_most(
        name,
        last,
        "GPa",
        1e-9 * pressure,
        "from below: the exact peak has no width",
    ));
    let exact = "exact Taylor wave on the isentrope [C]";
    let [speed, press] = outcome.wave_errors;
    checks.push(Check::gate("Taylor wave: mean error of u / u_CJ", speed, "-", 0.0, WAVE_TOLERANCE, exact));
    checks.push(Check::gate("Taylor wave: mean error of p / p_CJ", press, "-", 0.0, WAVE_TOLERANCE, exact));
    let (energy, momentum) = (outcome.totals.energy_error, outcome.totals.momentum_error);
    checks.push(Check::gate("energy error", energy, "-", 0.0, ENERGY_TOLERANCE, "conservation"));
    checks.push(Check::gate("momentum error", momentum, "-", 0.0, MOMENTUM_TOLERANCE, "conservation"));
    checks
}
