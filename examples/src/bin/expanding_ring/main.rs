//! Expansion of thin rings until they rest where rho v^2 / 2 has gone into Y ln(r / r0), by material points and by finite
//! elements, axisymmetric, against the exact radius and time; and fragmentation of faster rings in three dimensions, with
//! sections of scattered strength.

mod breaking;
mod chain;
mod checks;
mod figures;
mod scene;
mod setup;
mod theory;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use setup::{Break, METALS, Means, Metal, Setup};

/// Rings that are thrown outwards: radius and time at which they rest, and how they break.
///
/// Two metals, by material points and by finite elements; with half as much and twice as much thickness, and softer ones. The exit code
/// says whether radius and time are those of the exact solution. Then rings in three dimensions that break; the number of pieces is shown.
/// Writes pictures and CSV histories.
#[derive(Debug, Parser)]
#[command(name = "expanding_ring", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// By what the rings that come to rest are computed
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["mpm", "fem"])]
    method: Vec<Means>,
    /// Speed of all rings that come to rest, m/s, 10 to 400 [default: 100 of the heavy one, 200 of the light one]
    #[arg(long, value_name = "M/S", value_parser = within(10.0, 400.0))]
    speed: Option<f64>,
    /// Yield stress of all rings, MPa, 50 to 2000 [default: 400 and 300]
    #[arg(long = "yield", value_name = "MPA", value_parser = within(50.0, 2000.0))]
    yields: Option<f64>,
    /// Density of all rings, kg/m^3, 1000 to 20000 [default: 8930 and 2700]
    #[arg(long, value_name = "KG/M3", value_parser = within(1000.0, 20000.0))]
    density: Option<f64>,
    /// Young's modulus of the rings that come to rest, GPa, 50 to 10000
    #[arg(long, value_name = "GPA", default_value_t = 1000.0, value_parser = within(50.0, 10000.0))]
    young: f64,
    /// Radius of the middle of the section, mm, 5 to 200
    #[arg(long, value_name = "MM", default_value_t = 20.0, value_parser = within(5.0, 200.0))]
    radius: f64,
    /// Edge of the square section over the radius, 0.01 to 0.1
    #[arg(long, value_name = "PART", default_value_t = 0.05, value_parser = within(0.01, 0.1))]
    thickness: f64,
    /// Cells or elements across the section of a ring that comes to rest, 4 to 64 [default: 8, 16, 32 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=64))]
    cells: Option<u32>,
    /// Speeds of rings that break, m/s, 200 to 1000 [default: 300; 300,500; 300,500 by resolution]
    #[arg(long, value_name = "M/S,M/S", value_delimiter = ',', value_parser = within(200.0, 1000.0))]
    break_speed: Option<Vec<f64>>,
    /// Cells across their section, 2 to 16 [default: 2, 4, 6 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=16))]
    break_cells: Option<u32>,
    /// Plastic strain at which most of their sections break, 0.05 to 1
    #[arg(long, value_name = "STRAIN", default_value_t = 0.25, value_parser = within(0.05, 1.0))]
    break_strain: f64,
    /// How these are scattered: rate g of the hazard exp(g eps), 5 to 1000
    #[arg(long, value_name = "RATE", default_value_t = 30.0, value_parser = within(5.0, 1000.0))]
    scatter: f64,
    /// Of the scatter
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Write ParaView frames of the last ring of each kind
    #[arg(long)]
    frames: bool,
}

/// Young's modulus of aluminium and copper, Pa \[M\]: that of the soft rings, and of those that break.
const SOFT: [f64; 2] = [130e9, 70e9];
/// Travel of a ring that breaks, over its radius.
const WAY: f64 = 0.4;

impl Options {
    fn metals(&self) -> [Metal; 2] {
        METALS.map(|metal| Metal {
            speed: self.speed.unwrap_or(metal.speed),
            yields: self.yields.map_or(metal.yields, |y| 1e6 * y),
            density: self.density.unwrap_or(metal.density),
            young: 1e9 * self.young,
            ..metal
        })
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("expanding_ring")?;
    let files = options.frames.then_some(folder.as_path());
    let (mut found, mut totals) = (Vec::new(), Totals::default());
    let mut setups = Vec::new();
    let (mut thin, mut all) = (Vec::new(), Vec::new());
    let radius = 1e-3 * options.radius;
    for (metal, soft) in options.metals().into_iter().zip(SOFT) {
        let mut of_metal = Vec::new();
        for &means in &options.method {
            let base = Setup {
                metal,
                means,
                radius,
                thickness: options.thickness * radius,
                cells: options.cells.unwrap_or(common.resolution.choose(8, 16, 32)),
                threads: common.threads(),
            };
            let run = |setup: Setup, files: Option<&Path>| scene::expand(&setup, files, &folder, restart);
            let one = run(base, files)?;
            let twice = run(Setup { thickness: 2.0 * base.thickness, ..base }, None)?;
            let half = run(Setup { thickness: 0.5 * base.thickness, ..base }, None)?;
            let soft = run(Setup { metal: Metal { young: soft, ..metal }, ..base }, None)?;
            found.extend(checks::of_rest(&one, &twice));
            found.extend(checks::of_soft(&soft));
            for outcome in [&one, &twice, &half, &soft] {
                totals = totals.plus(&outcome.totals);
                setups.push(outcome.setup);
            }
            all.extend([half, one.clone(), twice]);
            of_metal.push(one);
        }
        if let [one, other] = &of_metal[..] {
            found.push(checks::of_methods(one, other));
        }
        thin.extend(of_metal);
    }
    figures::radius(&thin.iter().collect::<Vec<_>>())?.save(folder.join("radius.png"))?;
    figures::convergence(&all.iter().collect::<Vec<_>>())?.save(folder.join("thickness.png"))?;

    let speeds = common.resolution.choose(vec![300.0], vec![300.0, 500.0], vec![300.0, 500.0]);
    let speeds = options.break_speed.clone().unwrap_or(speeds);
    let mut broken = Vec::new();
    for &speed in &speeds {
        let metal = Metal { speed, young: SOFT[1], ..options.metals()[1] };
        let setup = Break {
            metal,
            radius,
            thickness: options.thickness * radius,
            cells: options.break_cells.unwrap_or(common.resolution.choose(2, 4, 6)),
            strain: options.break_strain,
            scatter: options.scatter,
            seed: options.seed,
            threads: common.threads(),
        };
        let end = WAY * radius / speed;
        let outcome = breaking::burst(&setup, end, files, restart)?;
        figures::write(&outcome, &folder)?;
        figures::pieces(&outcome)?.save(folder.join(format!("pieces_{speed:.0}.png")))?;
        let chain = chain::pieces(&setup, &breaking::strains(&setup), end);
        found.extend(checks::of_break(&outcome, chain));
        totals = totals.plus(&outcome.totals);
        broken.push(outcome);
    }
    found.extend(checks::of_speeds(&broken));
    let settings = serde_json::json!({
        "rings": setups,
        "breaks": broken.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "pieces": broken.iter().map(|o| o.rows.last().map_or(0, |r| r.pieces)).collect::<Vec<_>>(),
    });
    Report::new("expanding_ring", common.resolution, settings, &totals, found).finish(common, &folder)
}
