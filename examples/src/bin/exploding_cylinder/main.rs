//! Long cylinders of TNT in cases of copper of several thicknesses: speed of the case against finite differences along the
//! radius and Gurney's estimate with the energy released by the products; and fragmentation of a case.

mod checks;
mod figures;
mod gurney;
mod scene;
mod setup;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use setup::{Breaks, Lit, Setup};

/// TNT (radius 10 mm) in cases of copper: speed of the case over the mass ratio, and pieces.
///
/// The speed is compared with finite differences along the radius and with Gurney's estimate, whose energy is that of the products on their
/// isentrope; the exit code says whether it and the books are within the tolerances. Writes pictures, charts and CSV histories.
#[derive(Debug, Parser)]
#[command(name = "exploding_cylinder", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Thicknesses of the case, mm, 0.5 to 10
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', default_values_t = [1.0, 2.0, 4.0], value_parser = within(0.5, 10.0))]
    case: Vec<f64>,
    /// Where the charge is lit
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["axis", "all"])]
    lit: Vec<Lit>,
    /// Cells along the radius of the charge, 8 to 200 [default: 16, 40 or 80 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=200))]
    cells: Option<u32>,
    /// Volume of the products at the end over that of the charge, 1.5 to 8
    #[arg(long, value_name = "RATIO", default_value_t = 4.0, value_parser = within(1.5, 8.0))]
    expansion: f64,
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
    /// Plastic strain at which most sections of the thickest case break, 0.05 to 2
    #[arg(long, value_name = "STRAIN", default_value_t = 0.5, value_parser = within(0.05, 2.0))]
    break_strain: f64,
    /// Volume of the products at the end of that run over that of the charge, 1.5 to 8
    #[arg(long, value_name = "RATIO", default_value_t = 6.0, value_parser = within(1.5, 8.0))]
    break_expansion: f64,
    /// How these are scattered: rate g of the hazard exp(g eps), 2 to 1000
    #[arg(long, value_name = "RATE", default_value_t = 10.0, value_parser = within(2.0, 1000.0))]
    scatter: f64,
    /// Of the scatter
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("exploding_cylinder")?;
    let files = options.frames.then_some(folder.as_path());
    let setup = |case: f64, lit: Lit| Setup {
        case: 1e-3 * case,
        lit,
        cells: options.cells.unwrap_or(common.resolution.choose(16, 40, 80)),
        expansion: options.expansion,
        viscosity: [options.linear_viscosity, options.quadratic_viscosity],
        memory: options.memory,
        factor: options.factor,
        breaks: None,
        threads: common.threads(),
    };
    let mut cases = options.case.clone();
    cases.sort_by(f64::total_cmp);
    let mut outcomes = Vec::new();
    for &lit in &options.lit {
        for &case in &cases {
            outcomes.push(scene::burst(&setup(case, lit), files, &folder, restart)?);
        }
    }
    figures::speeds(&outcomes)?.save(folder.join("speeds.png"))?;
    figures::ratios(&outcomes)?.save(folder.join("ratios.png"))?;
    let mut found: Vec<_> = outcomes.iter().flat_map(|o| checks::of_speed(o, common.resolution)).collect();

    // The thickest case breaks into the largest pieces.
    let Some(thickest) = cases.last().zip(options.lit.first()) else {
        return Err(CaseError::Other("case = none is not allowed; there must be one".into()));
    };
    let breaks = Breaks { strain: options.break_strain, scatter: options.scatter, seed: options.seed };
    let base = setup(*thickest.0, *thickest.1);
    let whole = outcomes.iter().find(|o| o.setup == base);
    let setup = Setup { breaks: Some(breaks), expansion: options.break_expansion, ..base };
    let broken = scene::burst(&setup, files, &folder, restart)?;
    // Pieces count if heavier than a square of half the thickness.
    let least = setup::DENSITY[1] * 0.25 * base.case * base.case;
    let counts = (0..broken.snapshots.len()).map(|look| Ok(scene::pieces(&broken, look)?.heavier(least)));
    let counts: Vec<usize> = counts.collect::<Result<_, CaseError>>()?;
    figures::pieces(&broken, &counts)?.save(folder.join("pieces.png"))?;
    found.extend(checks::of_pieces(&broken, &counts, whole));

    let totals = outcomes.iter().chain([&broken]).fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": outcomes.iter().chain([&broken]).map(|o| o.setup).collect::<Vec<_>>(),
        "mass_ratios": outcomes.iter().map(|o| o.setup.mass_ratio()).collect::<Vec<_>>(),
        "speeds": outcomes.iter().map(|o| o.last().speed).collect::<Vec<_>>(),
        "pieces": counts,
    });
    Report::new("exploding_cylinder", common.resolution, settings, &totals, found).finish(common, &folder)
}
