//! Cased charge: TNT in a copper case, a long cylinder lit along its axis and the cube of the MPM3D deck `TNT3D`, lit at its centre. Speed
//! of the case against a one-dimensional computation and Gurney's formula; energy balance.

mod checks;
mod figures;
mod scene;
mod setup;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Cased, Common, Report, Restart, Totals, case, within};

use setup::{Form, Setup};

/// TNT (radius or half edge 10 mm) in a copper case of 2 mm: a cylinder, and the cube of a public deck.
///
/// The speed of the cylinder's case is compared with finite differences along the radius and with Gurney's formula; the
/// exit code says whether it and the books are within the tolerances. Writes pictures, charts and CSV histories.
#[derive(Debug, Parser)]
#[command(name = "tnt_cased", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Cells along the radius of the cylinder, 8 to 200 [default: 16, 40 or 80 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=200))]
    cells: Option<u32>,
    /// Cells along half the edge of the cube, 4 to 60; the deck has 10 [default: 5, 10 or 20 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=60))]
    cube_cells: Option<u32>,
    /// End of the cylinder's flight, µs, 3 to 40; the cube flies for 6 µs as in the deck
    #[arg(long, value_name = "µs", default_value_t = 14.0, value_parser = within(3.0, 40.0))]
    end: f64,
    /// Linear coefficient of the bulk viscosity, 0 to 2
    #[arg(long, value_name = "B1", default_value_t = 0.06, value_parser = within(0.0, 2.0))]
    linear_viscosity: f64,
    /// Quadratic coefficient of the bulk viscosity, 0 to 5
    #[arg(long, value_name = "B0", default_value_t = 1.5, value_parser = within(0.0, 5.0))]
    quadratic_viscosity: f64,
    /// FLIP forgets what the nodes do not see while the detonation crosses this many cells, 1 to 1e9
    #[arg(long, value_name = "CELLS", default_value_t = 100.0, value_parser = within(1.0, 1e9))]
    memory: f64,
    /// Of the time step, 0.05 to 1
    #[arg(long, value_name = "FACTOR", default_value_t = 0.3, value_parser = within(0.05, 1.0))]
    factor: f64,
    /// Write ParaView frames and ledgers
    #[arg(long)]
    frames: bool,
}

/// End of the run of the cube, s.
const CUBE_END: f64 = 6.0e-6;
/// Number of zones along the radius of the charge in the one-dimensional computation.
const ZONES: usize = 400;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("tnt_cased")?;
    let cylinder = Setup {
        form: Form::Cylinder,
        cells: options.cells.unwrap_or(common.resolution.choose(16, 40, 80)),
        end: 1e-6 * options.end,
        viscosity: [options.linear_viscosity, options.quadratic_viscosity],
        memory: options.memory,
        factor: options.factor,
        threads: common.threads(),
    };
    let cells = options.cube_cells.unwrap_or(common.resolution.choose(5, 10, 20));
    let cube = Setup { form: Form::Cube, cells, end: CUBE_END, ..cylinder };
    let one = Cased { charge: setup::CHARGE, case: setup::CASE, from_axis: true, zones: ZONES };
    let alone = one.speeds(cylinder.end);
    let coarse = Cased { zones: ZONES / 2, ..one }.speeds(cylinder.end);

    let mut found = Vec::new();
    let mut totals = Totals::default();
    let mut seconds = Vec::new();
    for setup in [cylinder, cube] {
        let outcome = scene::burst(&setup, options.frames.then_some(&folder), restart)?;
        let file = |what: &str| folder.join(format!("{what}_{}.png", setup.name()));
        figures::write(&outcome, &folder)?;
        figures::sections(&outcome)?.save(file("section"))?;
        figures::energies(&outcome)?.save(file("energy"))?;
        if setup.form == Form::Cylinder {
            figures::speeds(&outcome, &alone)?.save(file("speed"))?;
            found.extend(checks::of_cylinder(&outcome, &alone, &coarse, common.resolution));
        }
        found.extend(checks::of_books(&outcome));
        seconds.push(outcome.totals.wall_seconds);
        totals = totals.plus(&outcome.totals);
    }
    let settings = serde_json::json!({
        "runs": [cylinder, cube],
        "stepping_seconds": seconds,
        "mass_ratio": setup::mass_ratio(),
    });
    Report::new("tnt_cased", common.resolution, settings, &totals, found).finish(common, &folder)
}
