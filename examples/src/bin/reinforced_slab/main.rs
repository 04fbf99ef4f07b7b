//! Reinforced concrete slab under impact of an ogive rod or under blast: effect of the steel bars, as line elements embedded in the
//! particles of the slab (HFEMP); and on a small slab the same bars as particles.

mod checks;
mod figures;
mod scene;
mod setup;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Resolution, Restart, Totals, case, within};

use scene::Outcome;
use setup::{Bars, Load, Setup};

/// A steel rod of 0.50 kg, or a blast, on a slab of concrete of 48 MPa with bars of steel.
///
/// A quarter of a slab with bars of several sections, and of a small one with bars of lines and of particles. The exit code says whether more
/// steel holds more and whether the books are right; what the bars hold back is shown. Writes pictures and CSV histories.
#[derive(Debug, Parser)]
#[command(name = "reinforced_slab", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// What hits the slab
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["rod", "blast"])]
    load: Vec<Load>,
    /// Impact speed of the rod, m/s, 150 to 1000
    #[arg(long, value_name = "M/S", default_value_t = 250.0, value_parser = within(150.0, 1000.0))]
    speed: f64,
    /// Pressure of the blast at the start, MPa, 1 to 500
    #[arg(long, value_name = "MPA", default_value_t = 50.0, value_parser = within(1.0, 500.0))]
    pressure: f64,
    /// How long it takes to fall, linearly, µs, 10 to 1000
    #[arg(long, value_name = "µs", default_value_t = 200.0, value_parser = within(10.0, 1000.0))]
    duration: f64,
    /// Half the edge of the square on which it acts, m, 0.02 to 1
    #[arg(long, value_name = "M", default_value_t = 0.1, value_parser = within(0.02, 1.0))]
    reach: f64,
    /// Sections of a bar, cm^2, 0.05 to 5; a slab without bars goes before [default: 1; 1,2; 0.5,1,2 by resolution]
    #[arg(long, value_name = "CM2,CM2", value_delimiter = ',', value_parser = within(0.05, 5.0))]
    section: Option<Vec<f64>>,
    /// From bar to bar, mm, 30 to 500
    #[arg(long, value_name = "MM", default_value_t = 50.0, value_parser = within(30.0, 500.0))]
    spacing: f64,
    /// Half the edge of the slab, m, 0.1 to 1
    #[arg(long, value_name = "M", default_value_t = 0.2, value_parser = within(0.1, 1.0))]
    half_width: f64,
    /// Thickness of the slab, m, 0.08 to 0.3
    #[arg(long, value_name = "M", default_value_t = 0.1, value_parser = within(0.08, 0.3))]
    thickness: f64,
    /// Cells through the slab, 6 to 100 [default: 6, 10, 20 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(6..=100))]
    cells: Option<u32>,
    /// Cells across a bar of particles of the small slab, 1 to 8 [default: 1, 2, 2 by resolution; in smoke under the blast alone]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    bar_cells: Option<u32>,
    /// Of the time step, 0.05 to 1
    #[arg(long, value_name = "FACTOR", default_value_t = 0.5, value_parser = within(0.05, 1.0))]
    factor: f64,
    /// Write ParaView frames
    #[arg(long)]
    frames: bool,
}

/// Half edge and thickness of the small slab under rod or blast, m, and half edge of the blast square, m.
const SMALL: [([f64; 2], f64); 2] = [([0.1, 0.1], 0.1), ([0.125, 0.06], 0.05)];
/// Section of the small slab's bars, m^2, and their width, m.
const BARS: [f64; 2] = [1e-4, 1e-2];

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("reinforced_slab")?;
    let files = options.frames.then_some(folder.as_path());
    let bar_cells = options.bar_cells.unwrap_or(common.resolution.choose(1, 2, 2));
    let usual = common.resolution.choose(vec![1.0], vec![1.0, 2.0], vec![0.5, 1.0, 2.0]);
    let mut sections = options.section.clone().unwrap_or(usual);
    sections.sort_by(f64::total_cmp);
    sections.dedup();
    let (mut found, mut all) = (Vec::new(), Vec::<Outcome>::new());
    for &load in &options.load {
        let base = Setup {
            load,
            bars: Bars::Lines,
            speed: options.speed,
            blast: [1e6 * options.pressure, 1e-6 * options.duration, options.reach],
            section: 0.0,
            spacing: 1e-3 * options.spacing,
            slab: [options.half_width, options.thickness],
            cells: options.cells.unwrap_or(common.resolution.choose(6, 10, 20)),
            factor: options.factor,
            threads: common.threads(),
        };
        let hit = |setup: Setup| scene::hit(&setup, files, &folder, restart);
        let name = if load == Load::Rod { "rod" } else { "blast" };
        let mut series = vec![hit(base)?];
        for &section in &sections {
            series.push(hit(Setup { section: 1e-4 * section, ..base })?);
        }
        figures::damage(&series)?.save(folder.join(format!("damage_{name}.png")))?;
        figures::histories(&series.iter().collect::<Vec<_>>())?.save(folder.join(format!("{name}.png")))?;
        found.extend(checks::of_series(&series));

        all.extend(series);
        // A rod this coarse and bars of one cell are not comparable.
        if load == Load::Rod && common.resolution == Resolution::Smoke {
            continue;
        }
        let (slab, reach) = SMALL[usize::from(load == Load::Blast)];
        let cells = (slab[1] / BARS[1]).round() as u32 * bar_cells;
        let [pressure, time, _] = base.blast;
        let small = Setup { slab, cells, blast: [pressure, time, reach], spacing: 0.05, ..base };
        let bars = Setup { section: BARS[0], ..small };
        let trio = [small, bars, Setup { bars: Bars::Particles, ..bars }];
        let [plain, lines, particles] = [hit(trio[0])?, hit(trio[1])?, hit(trio[2])?];
        figures::histories(&[&plain, &lines, &particles])?.save(folder.join(format!("small_{name}.png")))?;
        found.extend(checks::of_comparison(&plain, &lines, &particles));
        all.extend([plain, lines, particles]);
    }
    let books: Vec<&Outcome> = all.iter().collect();
    found.extend(checks::of_books(&books));
    let totals = all.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": all.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "residual_speeds": all.iter().map(Outcome::residual).collect::<Vec<_>>(),
        "deflections": all.iter().map(Outcome::deflection).collect::<Vec<_>>(),
        "points_of_steel": all.iter().map(|o| o.points).collect::<Vec<_>>(),
        "stepping_seconds": all.iter().map(|o| o.totals.wall_seconds).collect::<Vec<_>>(),
    });
    Report::new("reinforced_slab", common.resolution, settings, &totals, found).finish(common, &folder)
}
