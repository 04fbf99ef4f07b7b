//! Collapse of a column of aluminium bars on a floor \[Bui2008\]: run-out and deposit against published experiments.

mod checks;
mod figures;
mod scene;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use scene::{Outcome, Setup};

/// A column of granular matter, let go beside a wall on a rough floor.
///
/// Drucker-Prager in plane strain, without cohesion. The run-out on grids that get finer is held against published
/// scaling laws, the deposit against the angle of friction, and mass, momentum and rest are checked; the exit code
/// says whether they are within the tolerances. Writes pictures, CSV histories and ParaView files.
#[derive(Debug, Parser)]
#[command(name = "granular_column", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Height of the column, m, 0.01 to 10
    #[arg(long, value_name = "M", default_value_t = 0.1, value_parser = within(0.01, 10.0))]
    height: f64,
    /// Height over width, 0.2 to 4, the first one on all grids, the others on the second [default: 0.5,1,1.5]
    #[arg(long, value_name = "A,A", value_delimiter = ',', value_parser = within(0.2, 4.0))]
    aspect: Vec<f64>,
    /// Cells over the height, 6 to 200 [default: 10,20; 10,20,40; 20,40,80 by resolution]
    #[arg(long, value_name = "N,N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(6..=200))]
    cells: Vec<u32>,
    /// Angle of friction, 5 to 45
    #[arg(long, value_name = "DEGREES", default_value_t = 19.8, value_parser = within(5.0, 45.0))]
    friction: f64,
    /// End of the runs, in times sqrt(height / g), 2 to 50
    #[arg(long, value_name = "TIMES", default_value_t = 8.0, value_parser = within(2.0, 50.0))]
    end: f64,
    /// Write ParaView frames of the finest run
    #[arg(long)]
    frames: bool,
}

/// Angle of friction of the columns of sand, degrees: sands have 30 to 33.
const SAND: f64 = 30.0;

impl Options {
    /// Return the set-ups of the first column on all grids.
    fn setups(&self) -> Vec<Setup> {
        let choose = |low: Vec<u32>, middle, high| self.common.resolution.choose(low, middle, high);
        let mut cells = self.cells.clone();
        if cells.is_empty() {
            cells = choose(vec![10, 20], vec![10, 20, 40], vec![20, 40, 80]);
        }
        cells.sort_unstable();
        cells.dedup();
        let aspect = self.aspect.first().copied().unwrap_or(0.5);
        let setup = |cells| Setup {
            height: self.height,
            aspect,
            friction: self.friction.to_radians(),
            cells,
            end: self.end,
            threads: self.common.threads(),
        };
        cells.into_iter().map(setup).collect()
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("granular_column")?;
    let setups = options.setups();
    let mut grids = Vec::new();
    for (n, setup) in setups.iter().enumerate() {
        let finest = n + 1 == setups.len();
        let files = (finest && options.frames).then_some(folder.as_path());
        let outcome = scene::collapse(setup, &[0.8, 1.6, 2.4], files, restart)?;
        figures::write(&outcome, &folder)?;
        grids.push(outcome);
    }
    let aspects = if options.aspect.is_empty() { vec![0.5, 1.0, 1.5] } else { options.aspect.clone() };
    let second = setups[setups.len().min(2) - 1];
    let mut columns = Vec::new();
    for &aspect in &aspects[1..] {
        columns.push(scene::collapse(&Setup { aspect, ..second }, &[], None, restart)?);
    }
    // Columns of sand, the material of the published fits.
    for aspect in aspects {
        columns.push(scene::collapse(
            &Setup { aspect, friction: SAND.to_radians(), ..second },
            &[],
            None,
            restart,
        )?);
    }
    if let Some(finest) = grids.last() {
        figures::column(finest)?.save(folder.join("column.png"))?;
    }
    figures::deposits(&grids)?.save(folder.join("deposits.png"))?;
    figures::fronts(&grids)?.save(folder.join("fronts.png"))?;
    let mut found = checks::of_grids(&grids);
    found.extend(checks::of_columns(&columns));
    let books: Vec<&Outcome> = grids.iter().chain(&columns).collect();
    found.extend(checks::of_books(&books));
    let totals = books.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": books.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "run_outs": books.iter().map(|o| o.run_out()).collect::<Vec<_>>(),
    });
    Report::new("granular_column", options.common.resolution, settings, &totals, found)
        .finish(&options.common, &folder)
}
