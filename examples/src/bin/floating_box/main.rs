//! Rigid box that floats in incompressible water: depth by Archimedes, heave against linear potential flow, a light box, a box that rolls over,
//! free fall.

mod checks;
mod figures;
mod scene;
mod setup;
mod theory;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, FlowRuns, Report, Restart, Totals, case, within};

use scene::Outcome;
use setup::{Setup, Study};

/// Rigid box that floats in a tank of incompressible water: depth, period of heave, stability, momentum.
///
/// A box of 0.3 m in a tank 1 m wide with 0.5 m of water. Depths are compared with the law of Archimedes, the period of heave with linear
/// potential flow in the tank, a box of half the density of water has to roll over and a light one to stay upright; energy and momentum are
/// checked. The exit code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "floating_box", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Motions to compute
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["heave", "space", "light", "roll", "fall"])]
    study: Vec<Study>,
    /// Densities of the boxes in heave, kg/m^3, one run each, 250 to 950
    #[arg(long, value_name = "KG/M3", value_delimiter = ',', default_values = ["500", "800"], value_parser = within(250.0, 950.0))]
    density: Vec<f64>,
    /// Height of the release in heave above the depth at rest, m, 0.001 to 0.1
    #[arg(long, value_name = "M", default_value_t = 0.025, value_parser = within(1e-3, 0.1))]
    lifted: f64,
    /// Density of the light box, kg/m^3, 10 to 200
    #[arg(long, value_name = "KG/M3", default_value_t = 50.0, value_parser = within(10.0, 200.0))]
    light: f64,
    /// Cells over the width of the tank in the plane, 20 to 400 [default: 40; 80; 100 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(20..=400))]
    cells: Option<u32>,
    /// Cells over the width of the tank in space, 12 to 100 [default: 20; 30; 40 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(12..=100))]
    cells_in_space: Option<u32>,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

impl Options {
    fn setups(&self, study: Study) -> Vec<Setup> {
        let choose = |smoke, standard, paper| self.common.resolution.choose(smoke, standard, paper);
        let cells = self.cells.unwrap_or_else(|| choose(40, 80, 100));
        let box_of = |density: f64, lifted: f64, end: f64| Setup { study, cells, density, lifted, end };
        match study {
            // Four periods.
            Study::Heave => self.density.iter().map(|density| box_of(*density, self.lifted, 4.5)).collect(),
            Study::Space => {
                let cells = self.cells_in_space.unwrap_or_else(|| choose(20, 30, 40));
                vec![Setup { cells, ..box_of(500.0, 2.0 * self.lifted, 3.2) }]
            }
            Study::Light => vec![box_of(self.light, -2.0 * self.lifted, 4.0)],
            Study::Roll => vec![box_of(500.0, 0.0, 8.0)],
            Study::Fall => vec![box_of(300.0, 0.0, 0.2)],
        }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("floating_box")?;
    let runs = FlowRuns { common: &options.common, folder: &folder, frames: options.frames, restart };
    let mut outcomes = Vec::new();
    for &study in &options.study {
        let shares: &[f64] = match study {
            Study::Roll | Study::Light => &[0.0625, 0.25, 0.5, 1.0],
            _ => &[1.0],
        };
        for setup in options.setups(study) {
            outcomes.push(scene::run(&setup, shares, &runs)?);
        }
    }
    let of = |studies: &[Study]| -> Vec<&Outcome> {
        outcomes.iter().filter(|o| studies.contains(&o.setup.study)).collect()
    };
    let (upright, free) = (of(&[Study::Heave, Study::Space]), of(&[Study::Light, Study::Roll]));
    if !upright.is_empty() {
        figures::heave(&upright)?.save(folder.join("heave.png"))?;
    }
    if !free.is_empty() {
        figures::turn(&free)?.save(folder.join("turn.png"))?;
        for outcome in free {
            figures::water(outcome)?.save(folder.join(format!("water_{}.png", outcome.setup.name())))?;
        }
    }
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.run.totals));
    let settings = serde_json::json!({ "runs": outcomes.iter().map(|o| o.setup).collect::<Vec<_>>() });
    Report::new("floating_box", options.common.resolution, settings, &totals, checks::of(&outcomes))
        .finish(&options.common, &folder)
}
