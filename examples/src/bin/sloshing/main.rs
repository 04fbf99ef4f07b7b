//! Sloshing of incompressible liquid in a tank, against linear theory: natural periods, forced sway, viscous decay; volume and energy over 20 s.

mod checks;
mod cost;
mod figures;
mod scene;
mod setup;
mod theory;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, FlowRuns, FlowScheme, Report, Resolution, Restart, Totals, case, within};

use setup::{STRONG, Setup, Study};
use theory::Mode;

/// Sloshing of incompressible liquid in a tank: natural periods, forced sway, viscous decay, and volume over 20 s.
///
/// Periods, the centre of mass of a swaying tank and the rate of viscous decay are compared with linear theory; volume, centre of mass,
/// energy and momentum are checked. The exit code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "sloshing", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Motions to compute [default: all; without cost at smoke]
    #[arg(long, value_enum, value_delimiter = ',')]
    study: Vec<Study>,
    /// Modes of the standing waves, one run each, 1 to 8
    #[arg(long, value_name = "N", value_delimiter = ',', default_values = ["1", "2", "3"], value_parser = clap::value_parser!(u32).range(1..=8))]
    mode: Vec<u32>,
    /// Length of the tank, m, 0.01 to 100
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = within(0.01, 100.0))]
    length: f64,
    /// Depth of the liquid over the length of the tank, 0.1 to 2
    #[arg(long, value_name = "H/L", default_value_t = 0.5, value_parser = within(0.1, 2.0))]
    depth: f64,
    /// Amplitude of the standing waves over the length of the tank, 0.0001 to 0.1
    #[arg(long, value_name = "A/L", default_value_t = 0.005, value_parser = within(1e-4, 0.1))]
    amplitude: f64,
    /// Kinematic viscosity of the wave that decays, m^2/s, 0.00001 to 0.1
    #[arg(long, value_name = "M2/S", default_value_t = 5e-3, value_parser = within(1e-5, 0.1))]
    viscosity: f64,
    /// Cells over the length, 16 to 1000 [default: 40; 64; 128 by resolution, 24; 24; 48 for 20 s]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=1000))]
    cells: Option<u32>,
    /// Scheme of the flow
    #[arg(long, value_enum, default_value_t)]
    scheme: FlowScheme,
    /// Cells over the length of the runs of the cost, one run each and method, 8 to 200
    #[arg(long, value_name = "N", value_delimiter = ',', default_values = ["16", "32", "64"], value_parser = clap::value_parser!(u32).range(8..=200))]
    compared: Vec<u32>,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

impl Options {
    fn studies(&self) -> Vec<Study> {
        let all = [Study::Wave, Study::Sway, Study::Decay, Study::Long, Study::Cost];
        match (&self.study[..], self.common.resolution) {
            ([], Resolution::Smoke) => all[..4].into(),
            ([], _) => all.into(),
            (given, _) => given.into(),
        }
    }
    fn setups(&self, study: Study) -> Vec<Setup> {
        let choose = |smoke, standard, paper| self.common.resolution.choose(smoke, standard, paper);
        let cells = self.cells.unwrap_or_else(|| match study {
            Study::Long => choose(24, 24, 48),
            _ => choose(40, 64, 128),
        });
        let Options { length, viscosity, scheme, .. } = *self;
        let (depth, amplitude) = (self.depth * length, self.amplitude * length);
        let setup = Setup { study, length, depth, cells, mode: 1, amplitude, viscosity, scheme };
        match study {
            Study::Cost => vec![Setup { amplitude: 2.0 * amplitude, ..setup }],
            Study::Wave => self.mode.iter().map(|mode| Setup { mode: *mode, ..setup }).collect(),
            _ => vec![setup],
        }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("sloshing")?;
    let runs = FlowRuns { common: &options.common, folder: &folder, frames: options.frames, restart };
    let (mut outcomes, mut costs) = (Vec::new(), Vec::new());
    for setup in options.studies().into_iter().flat_map(|study| options.setups(study)) {
        if setup.study == Study::Cost {
            costs = cost::compare(&setup, &options.compared, &runs)?;
            examples::cost::chart(&costs, "error of the amplitude over two periods")?
                .save(folder.join("cost.png"))?;
            continue;
        }
        let period = Mode::new(setup.mode, &setup).period();
        let times: Vec<f64> = match setup.study {
            Study::Wave | Study::Decay => vec![4.1 * period],
            Study::Sway => checks::COMPARED.map(|t| t * period).into(),
            Study::Cost => Vec::new(),
            Study::Long => [0.5, 0.9, 1.0, 20.0 / STRONG[2]].map(|part| part * STRONG[2]).into(),
        };
        let outcome = scene::run(&setup, &times, &runs)?;
        figures::history(&outcome)?.save(folder.join(format!("history_{}.png", setup.name())))?;
        if setup.study == Study::Long {
            figures::surface(&outcome)?.save(folder.join("surface.png"))?;
        }
        outcomes.push(outcome);
    }
    let of_runs = outcomes.iter().map(|o| &o.run.totals).chain(costs.iter().map(|c| &c.totals));
    let totals = of_runs.fold(Totals::default(), |sum, totals| sum.plus(totals));
    let settings =
        serde_json::json!({ "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>(), "costs": costs });
    let mut rows = checks::of(&outcomes);
    rows.extend(examples::cost::rows(&costs, "two periods of the first mode, linear theory [C]", 0.01));
    Report::new("sloshing", options.common.resolution, settings, &totals, rows)
        .finish(&options.common, &folder)
}
