//! Free drops of incompressible liquid: elliptic drop, oscillation by surface tension \[Rayleigh1879\], \[Lamb1932\], square and cube that become
//! circle and sphere, drop at rest.

mod checks;
mod figures;
mod scene;
mod setup;
mod theory;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, FlowRuns, FlowScheme, Report, Restart, Totals, case, within};

use scene::{Outcome, RATE};
use setup::{Setup, Study};

/// Free drops of incompressible liquid, without gravity, with and without surface tension.
///
/// An elliptic drop is compared with its ordinary differential equations, the period of oscillating drops with Rayleigh and Lamb, squares, cubes
/// and drops at rest with circle, sphere and the pressure of Laplace. The exit code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "drop", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Drops to compute
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["elliptic", "rayleigh", "lamb", "square", "cube", "rest"])]
    study: Vec<Study>,
    /// Cells over the radius, or half of the edge, 4 to 100, one run each [default: by study and resolution]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(4..=100))]
    cells: Vec<u32>,
    /// Radius of the drops that oscillate or rest, m, 0.00001 to 1
    #[arg(long, value_name = "M", default_value_t = 5e-3, value_parser = within(1e-5, 1.0))]
    radius: f64,
    /// Surface tension of the drops that oscillate or rest, N/m, 0.001 to 1
    #[arg(long, value_name = "N/M", default_value_t = 0.072, value_parser = within(1e-3, 1.0))]
    tension: f64,
    /// Dynamic viscosity of the drops that oscillate or rest, Pa s, 0 to 1
    #[arg(long, value_name = "PA S", default_value_t = 1e-3, value_parser = within(0.0, 1.0))]
    viscosity: f64,
    /// Stretch at the start of the drops that oscillate, less 1, 0.01 to 0.5
    #[arg(long, value_name = "PART", default_value_t = 0.05, value_parser = within(0.01, 0.5))]
    stretch: f64,
    /// Scheme of the flow
    #[arg(long, value_enum, default_value_t)]
    scheme: FlowScheme,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

impl Options {
    fn setups(&self, study: Study) -> Vec<Setup> {
        let by_default: &[u32] = match (study, self.common.resolution.choose(0, 1, 2)) {
            (Study::Elliptic, level) => [&[16][..], &[32], &[64]][level],
            (Study::Rayleigh, level) => [&[6, 10][..], &[6, 12, 24], &[12, 24, 48]][level],
            (Study::Lamb, level) => [&[5][..], &[6, 12], &[6, 12, 24]][level],
            (Study::Square, level) => [&[8][..], &[5, 10, 20], &[10, 20, 40]][level],
            (Study::Cube, level) => [&[5][..], &[5], &[5, 10]][level],
            (Study::Rest, level) => [&[8, 16][..], &[8, 16, 32], &[8, 16, 32, 64]][level],
        };
        let Options { radius, tension, viscosity, stretch, scheme, .. } = *self;
        let at_rest =
            Setup { study, size: radius, cells: 0, tension, viscosity, stretch: 0.0, end: 0.0, scheme };
        let of = |cells: u32| {
            let setup = Setup { cells, ..at_rest };
            match study {
                Study::Elliptic => {
                    Setup { size: 1.0, tension: 0.0, viscosity: 0.0, end: 2.0 / RATE, ..setup }
                }
                Study::Rayleigh | Study::Lamb => Setup { stretch, end: 1.3 * setup.drop().period(), ..setup },
                // Edge, surface tension and viscosity of the reference; the mode 4, overdamped, decays by exp(-5).
                Study::Square | Study::Cube => {
                    Setup { size: 5e-3, tension: 2.4e-3, viscosity: 0.05, end: 0.4, ..setup }
                }
                Study::Rest => Setup { end: 0.1 * setup.drop().period(), ..setup },
            }
        };
        let cells = if self.cells.is_empty() { by_default } else { &self.cells };
        cells.iter().copied().map(of).collect()
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("drop")?;
    let runs = FlowRuns { common: &options.common, folder: &folder, frames: options.frames, restart };
    let mut outcomes = Vec::new();
    for &study in &options.study {
        let shares: &[f64] = match study {
            Study::Elliptic => &[0.25, 0.5, 0.75, 1.0],
            Study::Square | Study::Cube => &[0.01, 0.2, 1.0],
            _ => &[1.0],
        };
        let first = outcomes.len();
        for setup in options.setups(study) {
            outcomes.push(scene::run(&setup, shares, &runs)?);
        }
        let grids: Vec<&Outcome> = outcomes[first..].iter().collect();
        match (study, grids.last()) {
            (Study::Rayleigh | Study::Lamb, _) => {
                figures::oscillation(&grids)?.save(folder.join(format!("period_{}.png", study.name())))?;
            }
            (_, Some(finest)) => {
                figures::shapes(finest)?.save(folder.join(format!("shape_{}.png", study.name())))?
            }
            _ => {}
        }
    }
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.run.totals));
    let settings = serde_json::json!({ "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>() });
    Report::new("drop", options.common.resolution, settings, &totals, checks::of(&outcomes))
        .finish(&options.common, &folder)
}
