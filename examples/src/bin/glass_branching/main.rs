//! Crack propagation and branching in a notched plate of glass under a sudden tension, by fragile points.

mod branches;
mod checks;
mod figures;
mod setup;

use std::process::ExitCode;

use clap::Parser;
use examples::cracks::{self, CrackOption, Plane, Softening};
use examples::fragile::Joint;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use branches::Branches;
use setup::Setup;

/// A plate of glass, 100 mm x 40 mm, with a notch of 50 mm, under a tension that acts on its long edges from the start.
///
/// With fracture energy the crack is to branch after some 33 us under 1 MPa; under less it stays one, under more it branches again and
/// again. With a strength alone it follows the cells. The exit code says whether all is within the tolerances. Writes pictures, CSV histories
/// and ParaView series.
#[derive(Debug, Parser)]
#[command(name = "glass_branching", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Tensions, MPa, one run each, 0.01 to 100
    #[arg(long, value_name = "MPA,MPA", value_delimiter = ',', default_values = ["0.5", "1", "1.5"], value_parser = within(0.01, 100.0))]
    load: Vec<f64>,
    /// Width of the cells, mm, one run each, 0.05 to 2 [default: 1.5; 0.5; 0.5,0.25 by resolution]
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', value_parser = within(0.05, 2.0))]
    spacing: Vec<f64>,
    /// When faces open, one run each; strength alone under 1 MPa only [default: cohesive,strength]
    #[arg(long, value_enum, value_delimiter = ',')]
    cracks: Vec<CrackOption>,
    /// Cells of a cohesive face while it softens. Parted, as a crack then branches when it is said to, and takes 2.65 J/m^2 of 3; joined, it takes
    /// 3.00, and branches after 58 us on one set of points, and not at all on another
    #[arg(long, value_enum, default_value = "parted")]
    softening: Softening,
    /// Flux between cells
    #[arg(long, value_enum, default_value = "symmetric")]
    flux: Joint,
    /// Plane strain or plane stress
    #[arg(long, value_enum, default_value = "strain")]
    plane: Plane,
    /// Seeds of the random points, one run each
    #[arg(long, value_name = "SEED,SEED", value_delimiter = ',', default_values = ["1"])]
    seed: Vec<u64>,
    /// Strength, MPa, 0.1 to 1000
    #[arg(long, value_name = "MPA", default_value_t = 3.08, value_parser = within(0.1, 1000.0))]
    strength: f64,
    /// Fracture energy, J/m^2, 0.01 to 1000
    #[arg(long, value_name = "J/M2", default_value_t = 3.0, value_parser = within(0.01, 1000.0))]
    energy: f64,
    /// Penalty over Young's modulus, 0.1 to 100
    #[arg(long, value_name = "ETA", default_value_t = 5.0, value_parser = within(0.1, 100.0))]
    eta: f64,
    /// End, us, 1 to 1000
    #[arg(long, value_name = "US", default_value_t = 80.0, value_parser = within(1.0, 1000.0))]
    end: f64,
    /// ParaView frames a run, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

impl Options {
    fn setups(&self) -> Vec<Setup> {
        let spacings = match self.spacing[..] {
            [] => self.common.resolution.choose(&[1.5][..], &[0.5], &[0.5, 0.25]).to_vec(),
            _ => self.spacing.clone(),
        };
        let cracks = match self.cracks[..] {
            [] => vec![CrackOption::Cohesive, CrackOption::Strength],
            _ => self.cracks.clone(),
        };
        let mut setups = Vec::new();
        for &cracks in &cracks {
            // Cracks that follow the cells are run in cells of half the width, too.
            let halves = if cracks.has_energy() || !self.spacing.is_empty() { 1 } else { 2 };
            let loads =
                if cracks.has_energy() || self.load.len() == 1 { &self.load[..] } else { &[REFERENCE] };
            for &load in loads {
                for &spacing in &spacings {
                    for half in 0..halves {
                        setups.extend(self.seed.iter().map(|&seed| Setup {
                            cracks,
                            softening: self.softening,
                            flux: self.flux,
                            plane: self.plane,
                            load: 1e6 * load,
                            spacing: 1e-3 * spacing / f64::from(1 << half),
                            seed,
                            strength: 1e6 * self.strength,
                            energy: self.energy,
                            eta: self.eta,
                            end: 1e-6 * self.end,
                            threads: self.common.threads(),
                        }));
                    }
                }
            }
        }
        setups.dedup_by(|a, b| a == b);
        setups
    }
}

/// Load of the references, MPa.
const REFERENCE: f64 = 1.0;

/// Run with its result.
struct Run {
    setup: Setup,
    outcome: cracks::Outcome,
    branches: Branches,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("glass_branching")?;
    let mut runs: Vec<Run> = Vec::new();
    for setup in options.setups() {
        let cells = setup.cells()?;
        let outcome = cracks::tear(&setup.torn(&cells, &folder, options.frames)?, restart)?;
        outcome.write_history(&folder.join(format!("history_{}.csv", setup.name())))?;
        runs.push(Run { branches: Branches::of(&outcome.cracks), setup, outcome });
    }
    figures::draw(&runs, &folder)?;
    let totals = runs.iter().fold(Totals::default(), |sum, run| sum.plus(&run.outcome.totals));
    let settings = serde_json::json!({
        "runs": runs.iter().map(|run| run.setup).collect::<Vec<_>>(),
        "branches": runs.iter().map(|run| run.branches.most).collect::<Vec<_>>(),
        "threads": options.common.threads(),
    });
    Report::new("glass_branching", options.common.resolution, settings, &totals, checks::of(&runs))
        .finish(&options.common, &folder)
}
