//! Viscous incompressible flow against exact solutions: Taylor-Green vortices \[TaylorGreen1937\], start of Poiseuille and Couette flow, with
//! observed orders.

mod checks;
mod figures;
mod scene;
mod theory;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, FlowRuns, FlowScheme, Report, Restart, Totals, case, within};

use scene::{Setup, Study};

/// Viscous incompressible flow: decay of Taylor-Green vortices, start of channel flow by a pressure gradient and by a moving wall.
///
/// Each flow runs on several grids; amplitudes, profiles and the orders of the errors are compared with exact solutions. The exit code says
/// whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "taylor_green", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Flows to compute
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["vortices", "poiseuille", "couette"])]
    study: Vec<Study>,
    /// Cells over the period or the height of the channel, 8 to 512, multiples of 4, one run each [default: 8,16,32; to 64; to 128 by resolution]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(8..=512))]
    cells: Vec<u32>,
    /// Reynolds number U L / nu of the vortices, 1 to 10000
    #[arg(long, value_name = "RE", default_value_t = 100.0, value_parser = within(1.0, 1e4))]
    reynolds: f64,
    /// Scheme of the flow
    #[arg(long, value_enum, default_value_t)]
    scheme: FlowScheme,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("taylor_green")?;
    let runs = FlowRuns { common: &options.common, folder: &folder, frames: options.frames, restart };
    let by_default = options.common.resolution.choose(&[8, 16, 32][..], &[8, 16, 32, 64], &[16, 32, 64, 128]);
    let cells = if options.cells.is_empty() { by_default } else { &options.cells };
    let mut outcomes = Vec::new();
    for &study in &options.study {
        for &cells in cells {
            let setup = Setup { study, cells, reynolds: options.reynolds, scheme: options.scheme };
            outcomes.push(scene::run(&setup, &runs)?);
        }
        let Some(finest) = outcomes.last() else { continue };
        let picture =
            if study == Study::Vortices { figures::vortices(finest)? } else { figures::profiles(finest)? };
        picture.save(folder.join(format!("{}.png", study.name().to_lowercase())))?;
    }
    figures::orders(&outcomes)?.save(folder.join("order.png"))?;
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.run.totals));
    let settings = serde_json::json!({ "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>() });
    Report::new("taylor_green", options.common.resolution, settings, &totals, checks::of(&outcomes))
        .finish(&options.common, &folder)
}
