//! Three large and 207 small discs in a shaken container: the large discs rise \[Ma2010\].

mod figures;
mod layout;
mod scene;
mod watch;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Detection, Report, Restart, case, within};
use mpm_core::output::History;

use scene::{Outcome, SETTLING, Setup};

/// Large discs below small ones in a container that is shaken: elastic, frictional, plane strain.
///
/// The large ones shall rise, nothing overlap, get lost, or gain energy. Writes pictures and CSV histories.
#[derive(Debug, Parser)]
#[command(name = "shaken_discs", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Large discs, 1 to 3; the container is as wide as they need [default: 1 at smoke, else 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=3))]
    large: Option<u8>,
    /// Small discs, 1 to 207 [default: 25 at smoke, else 207]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=207))]
    small: Option<u8>,
    /// Cells per radius of a small disc, 2 to 16 [default: 2, at paper 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=16))]
    cells: Option<u32>,
    /// Young's modulus of the discs, MPa, 0.1 to 1000 [default: 1 at smoke, else 9]; in softer ones collisions overlap
    #[arg(long, value_name = "MPA", value_parser = within(0.1, 1000.0))]
    young: Option<f64>,
    /// How contact is detected
    #[arg(long, value_enum, default_value = "distance")]
    detection: Detection,
    /// Coefficient of friction, 0 to 2
    #[arg(long, value_name = "MU", default_value_t = 0.6, value_parser = within(0.0, 2.0))]
    friction: f64,
    /// Largest acceleration of the shaking over gravity, 0 to 10
    #[arg(long, value_name = "G", default_value_t = 6.0, value_parser = within(0.0, 10.0))]
    strength: f64,
    /// Frequency of the shaking, Hz, 1 to 100
    #[arg(long, value_name = "HZ", default_value_t = 10.0, value_parser = within(1.0, 100.0))]
    frequency: f64,
    /// Seconds of shaking, 0.1 to 1000 [default: 0.2, 3.5 or 12.3 by resolution]
    #[arg(long, value_name = "S", value_parser = within(0.1, 1000.0))]
    shaking: Option<f64>,
}

/// Duration of shaking after which the rise of large discs is checked, s.
const LONG: f64 = 3.5;
/// Largest allowed overlap, cells.
const OVERLAP: f64 = 0.2;
/// Tolerance of the energy growth over the largest energy: rounding.
const GROWTH: f64 = 1e-9;
/// Tolerance of the momentum: impulses of gravity and floor are many times the momentum of the discs.
const MOMENTUM_TOLERANCE: f64 = 1e-10;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("shaken_discs")?;
    let resolution = options.common.resolution;
    let setup = Setup {
        large: usize::from(options.large.unwrap_or(resolution.choose(1, 3, 3))),
        small: usize::from(options.small.unwrap_or(resolution.choose(25, 207, 207))),
        cells: options.cells.unwrap_or(resolution.choose(2, 2, 4)),
        young: 1e6 * options.young.unwrap_or(resolution.choose(1.0, 9.0, 9.0)),
        detection: options.detection,
        friction: options.friction,
        strength: options.strength,
        frequency: options.frequency,
        shaking: options.shaking.unwrap_or(resolution.choose(0.2, 3.5, 12.3)),
        threads: options.common.threads(),
    };
    let outcome = scene::shake(&setup, &folder, restart)?;
    write(&outcome, &folder)?;
    figures::pile(&outcome)?.save(folder.join("discs.png"))?;
    figures::histories(&outcome)?.save(folder.join("histories.png"))?;
    let settings = serde_json::json!({
        "large": setup.large,
        "small": outcome.layout.discs.len() - setup.large,
        "cells_per_small_radius": setup.cells,
        "young": setup.young,
        "detection": setup.detection,
        "friction": setup.friction,
        "strength": setup.strength,
        "frequency": setup.frequency,
        "shaking": setup.shaking,
        "threads": setup.threads,
    });
    Report::new("shaken_discs", resolution, settings, &outcome.totals, checks(&outcome))
        .finish(&options.common, &folder)
}

/// Return the mean heights of large and small discs over the first and the last period of the shaking, m.
fn heights(outcome: &Outcome) -> [[f64; 2]; 2] {
    let period = 1.0 / outcome.setup.frequency;
    let end = outcome.rows.last().map_or(0.0, |r| r.time);
    [[SETTLING - period, SETTLING], [end - period, end]].map(|[from, to]| {
        let rows: Vec<_> = outcome.rows.iter().filter(|r| (from..=to).contains(&r.time)).collect();
        std::array::from_fn(|i| rows.iter().map(|r| r.heights[i]).sum::<f64>() / rows.len() as f64)
    })
}

fn checks(outcome: &Outcome) -> Vec<Check> {
    let [before, after] = heights(outcome);
    let h = outcome.setup.spacing();
    let rows = &outcome.rows;
    let deepest = rows.iter().map(|r| r.overlap).fold(f64::NEG_INFINITY, f64::max) / h;
    let [first, last] = [rows.first(), rows.last()].map(|r| r.map_or(0.0, |r| r.particles as f64));
    let rise = 1e3 * ((after[0] - after[1]) - (before[0] - before[1]));
    let height = |what: &str, height: f64| Check::unreferenced(what, 1e3 * height, "mm", "mean of a period");
    vec![
        height("height of the large discs before", before[0]),
        height("height of the small discs before", before[1]),
        height("height of the large discs after", after[0]),
        height("height of the small discs after", after[1]),
        Check::at_least("rise of the large discs among the small ones", rise, "mm", 0.0, "Ma2010 [S]")
            .judged_if(outcome.setup.shaking >= LONG, "less than 3.5 s of shaking"),
        Check::at_most("deepest overlap", deepest, "cells", OVERLAP, "no penetration"),
        Check::at_most("growth of the energy", outcome.growth, "-", GROWTH, "conservation"),
        Check::gate("particles at the end", last, "-", first, 0.0, "conservation"),
        Check::gate(
            "momentum error",
            outcome.totals.momentum_error,
            "-",
            0.0,
            MOMENTUM_TOLERANCE,
            "conservation",
        ),
    ]
}

fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("height of large discs", "m"),
        ("height of small discs", "m"),
        ("deepest overlap", "m"),
        ("of disc", "-"),
        ("and disc or container", "-"),
        ("kinetic energy", "J/m"),
        ("particles", "-"),
    ];
    let mut file = History::create(folder.join("discs.csv"), columns)?;
    for r in &outcome.rows {
        let ([large, small], [one, other]) = (r.heights, r.pair.map(|n| n as f64));
        file.push(&[r.time, large, small, r.overlap, one, other, r.kinetic, r.particles as f64])?;
    }
    Ok(())
}
