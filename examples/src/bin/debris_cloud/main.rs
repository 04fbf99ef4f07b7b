//! Debris cloud of a lead sphere of 15 mm that hits a lead plate of 6.36 mm at 6.58 km/s, in three dimensions (the MPM3D
//! deck `LeadHypervelocityImpact`, after Anderson et al. 1990): state at impact, front of the cloud and balances, with and
//! without splitting of particles.

mod checks;
mod figures;
mod parts;
mod plane;
mod scene;
mod setup;
mod track;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use setup::{Cutting, HALF_WIDTH, Plate, Setup};

/// Lead sphere (15 mm) on a lead plate (6.36 mm) at 6.58 km/s, a quarter of both.
///
/// Twice: with particles as they are seeded, and with particles that are split where the cloud draws them out. The state
/// behind the shock is measured on plane plates of the same cells and compared with the Hugoniot; the front of the cloud
/// with the free surface behind a plane shock. The exit code says whether all are within the tolerances.
#[derive(Debug, Parser)]
#[command(name = "debris_cloud", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Particles across the thickness of the plate, 4 to 60; the deck has 6 [default: 6, 10 or 16 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=60))]
    layers: Option<u32>,
    /// Half the edge of the plate, m, 0.03 to 0.2 [default: 0.03, 0.04 or that of the deck, 0.080, by resolution]
    #[arg(long, value_name = "M", value_parser = within(0.03, 0.2))]
    half_width: Option<f64>,
    /// What the plate is made of; afemp is run once, as seeded, and compared with the plate of particles
    #[arg(long, value_enum, default_value = "mpm")]
    method: Plate,
    /// Which of the two
    #[arg(long, value_enum, default_value = "both")]
    particles: Particles,
    /// Stretch at which a particle is split, 1.1 to 4
    #[arg(long, value_name = "STRETCH", default_value_t = 2.0, value_parser = within(1.1, 4.0))]
    stretch: f64,
    /// Most cuts of a seed, 1 to 16
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=16))]
    generations: u32,
    /// Linear and quadratic coefficient of the bulk viscosity, 0 to 5
    #[arg(long, value_name = "B1,B0", num_args = 1, value_delimiter = ',', default_values_t = [0.5, 2.0], value_parser = within(0.0, 5.0))]
    viscosity: Vec<f64>,
    /// FLIP forgets what the nodes do not see while sound crosses this many cells, 1 to 1e9
    #[arg(long, value_name = "CELLS", default_value_t = 100.0, value_parser = within(1.0, 1e9))]
    memory: f64,
    /// Of the time step, 0.05 to 1
    #[arg(long, value_name = "FACTOR", default_value_t = 0.3, value_parser = within(0.05, 1.0))]
    factor: f64,
    /// Write ParaView frames and ledgers
    #[arg(long)]
    frames: bool,
}

/// Which runs to make.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Particles {
    /// As seeded
    Whole,
    /// Split where they are stretched
    Split,
    /// Both
    Both,
    /// Neither: the plane impact alone
    None,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("debris_cloud")?;
    let whole = Setup {
        layers: options.layers.unwrap_or(common.resolution.choose(6, 10, 16)),
        half_width: options.half_width.unwrap_or(common.resolution.choose(0.03, 0.04, HALF_WIDTH)),
        method: Plate::Mpm,
        cutting: None,
        viscosity: [options.viscosity[0], options.viscosity[options.viscosity.len() - 1]],
        memory: options.memory,
        factor: options.factor,
        threads: common.threads(),
    };
    let cutting = Cutting { stretch: options.stretch, generations: options.generations };
    let split = Setup { cutting: Some(cutting), ..whole };
    let elements = Setup { method: Plate::Afemp, ..whole };
    let setups = match options.particles {
        _ if options.method == Plate::Afemp => vec![whole, elements],
        Particles::Whole => vec![whole],
        Particles::Split => vec![split],
        Particles::Both => vec![whole, split],
        Particles::None => vec![],
    };

    let row = plane::row(&whole, restart)?;
    figures::profile(&row)?.save(folder.join("plane.png"))?;
    let mut outcomes = Vec::new();
    for setup in &setups {
        let outcome = scene::shoot(setup, options.frames.then_some(&folder), restart)?;
        figures::write(&outcome, &folder)?;
        figures::cuts(&outcome)?.save(folder.join(format!("cloud_{}.png", setup.name())))?;
        outcomes.push(outcome);
    }
    figures::front(&outcomes)?.save(folder.join("front.png"))?;

    let mut found = checks::of_plane(&row);
    found.extend(outcomes.iter().flat_map(checks::of_cloud));
    found.extend(checks::of_both(&outcomes));
    // Totals are those of the clouds; the row of cells is negligible.
    let totals = outcomes.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": setups,
        "seeds": outcomes.iter().map(|o| o.seeds).collect::<Vec<_>>(),
        "particles_at_the_end": outcomes.iter().map(|o| o.totals.particles).collect::<Vec<_>>(),
        "cuts": outcomes.iter().map(|o| o.cuts.cuts).collect::<Vec<_>>(),
        "pieces": outcomes.iter().map(|o| o.parts.pieces).collect::<Vec<_>>(),
        "stepping_seconds": outcomes.iter().map(|o| o.totals.wall_seconds).collect::<Vec<_>>(),
        "plane_error": [row.totals.energy_error, row.totals.momentum_error],
        "free_surface": plane::free_surface(),
    });
    Report::new("debris_cloud", common.resolution, settings, &totals, found).finish(common, &folder)
}
