//! Cantilever under a shear pulse at its end (case 2.2 of the paper of the fragile points method) against finite elements.

mod checks;
mod elements;
mod figures;
mod scene;

use std::process::ExitCode;

use clap::Parser;
use examples::fragile::Fragile;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use scene::{Beam, Files, Plane, Setup};

/// Elastic cantilever (48 m x 12 m) under a shear traction of 100 Pa for half a second at its end, by the fragile points method.
///
/// Displacements are judged against independent finite elements of second order, stress beside the root against our own finite elements,
/// finer, as no reference has numbers of it; the exit code says whether all are within the tolerances but for what is declared.
#[derive(Debug, Parser)]
#[command(name = "cantilever_pulse", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    fragile: Fragile,
    /// Cells through the height, 2 to 200
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(2..=200))]
    cells: u32,
    /// Poisson's ratio, 0 to 0.4999
    #[arg(long, value_name = "NU", default_value_t = 0.3, value_parser = within(0.0, 0.4999))]
    nu: f64,
    /// What plane
    #[arg(long, value_enum, default_value = "stress")]
    plane: Plane,
    /// End of the runs, s, 0.25 to 100 [default: 0.6 at smoke size, 2 otherwise]
    #[arg(long, value_name = "S", value_parser = within(0.25, 100.0))]
    end: Option<f64>,
    /// ParaView frames a run, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("cantilever_pulse")?;
    let files = Files { folder: &folder, frames: options.frames, restart };
    let (cells, end) =
        (options.cells as usize, options.end.unwrap_or(common.resolution.choose(0.6, 2.0, 2.0)));
    let beam = Beam { poisson: options.nu, plane: options.plane };
    let finer = common.resolution.choose(24, 24, 48);
    let elements = elements::swing(beam, finer, common.threads())?;
    let (mut totals, mut rows, mut outcomes) = (Totals::default(), Vec::new(), Vec::new());
    for &joint in options.fragile.joints() {
        let setup = Setup { joint, fragile: options.fragile, beam, cells, end, threads: common.threads() };
        let outcome = scene::swing(&setup, files)?;
        totals = totals.plus(&outcome.totals);
        rows.extend(checks::of(&outcome, &elements));
        outcomes.push(outcome);
    }
    figures::draw(&outcomes, &elements, &folder)?;
    let settings = serde_json::json!({
        "methods": outcomes.iter().map(|o| o.method.clone()).collect::<Vec<_>>(),
        "cells_through": cells,
        "points": format!("{:?}", options.fragile.points).to_lowercase(),
        "seed": options.fragile.seed,
        "nu": options.nu,
        "plane": format!("{:?}", options.plane).to_lowercase(),
        "elements_through": finer,
        "end": end,
        "threads": common.threads(),
    });
    Report::new("cantilever_pulse", common.resolution, settings, &totals, rows).finish(common, &folder)
}
