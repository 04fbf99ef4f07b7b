//! A cylinder of radius 3.2 m rolls, or rolls and slides, down a rough incline for 1.5 s \[Ma2010\]. Distance and spin are compared with
//! exact solutions; three spacings show the influence of contact detection.

mod exact;
mod figures;
mod scene;
mod spacings;
mod track;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Detection, Law, Report, Resolution, Restart, Totals, case, within};
use mpm_core::output::History;

use exact::{Course, Cylinder, Incline};
use scene::{GRAVITY, Outcome, RADIUS, Setup};

/// A cylinder rolls down a rough incline: elastic, plane strain, radius 3.2 m.
///
/// Way and spin at the end are compared with those of a rigid cylinder and of an elastic one, which creeps; the exit code says whether they and the gap are
/// within the tolerances. All runs are repeated with the old detection and at three spacings. Writes pictures
/// and CSV histories.
#[derive(Debug, Parser)]
#[command(name = "rolling_cylinder", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Angle of the incline to the horizontal, degrees, 1 to 80
    #[arg(long, value_name = "DEGREES", default_value_t = 60.0, value_parser = within(1.0, 80.0))]
    angle: f64,
    /// Coefficients of friction, 0 to 10: rolling takes tan(angle) / 3
    #[arg(long, value_name = "MU", value_delimiter = ',', default_values_t = [0.3, 0.6], value_parser = within(0.0, 10.0))]
    friction: Vec<f64>,
    /// How contact is found
    #[arg(long, value_enum, default_value = "plane")]
    detection: Detection,
    /// What the bodies do where they touch
    #[arg(long, value_enum, default_value = "coulomb")]
    law: Law,
    /// Only this many dimensions, 2 (plane strain) or 3 (a cylinder of 4 m) [default: both]
    #[arg(long, value_name = "D", value_parser = clap::value_parser!(u32).range(2..=3))]
    dimensions: Option<u32>,
    /// Cells per radius, 2 to 100 [default: 12, 32 or 64 by resolution in the plane, 8, 16 or 32 in space]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100))]
    cells: Option<u32>,
    /// Moduli of both bodies over those of the paper, 0.1 to 100: harder ones creep less
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = within(0.1, 100.0))]
    stiffness: f64,
    /// End of the run, s, 0.1 to 1.5
    #[arg(long, value_name = "S", default_value_t = 1.5, value_parser = within(0.1, 1.5))]
    end: f64,
    /// Leave out the coarser spacings and the other detections
    #[arg(long)]
    alone: bool,
}

/// Relative tolerance of the distance.
const WAY_TOLERANCE: f64 = 0.01;
/// Relative tolerance of the spin.
const SPIN_TOLERANCE: f64 = 0.02;
/// Tolerance of gap and overlap, cells.
const GAP: f64 = 0.1;
/// Tolerance over the momentum of the cylinder. The impulse of the total weight, ten times the cylinder's, is 30 times that momentum;
/// rounding of 1e-16 in each of 1e4 steps sums to 3e-11 if all errors have the same sign.
const MOMENTUM_TOLERANCE: f64 = 1e-11;

impl Options {
    fn cells(&self, dimensions: u32) -> u32 {
        let resolution = self.common.resolution;
        let cells =
            if dimensions == 3 { resolution.choose(8, 16, 32) } else { resolution.choose(12, 32, 64) };
        self.cells.unwrap_or(cells)
    }
    fn setup(&self, friction: f64, dimensions: u32, detection: Detection, cells: u32) -> Setup {
        let incline = Incline { angle: self.angle.to_radians(), friction };
        Setup {
            incline,
            dimensions,
            detection,
            law: self.law,
            cells,
            stiffness: self.stiffness,
            end: self.end,
            threads: self.common.threads(),
        }
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("rolling_cylinder")?;
    let (mut checks, mut totals) = (Vec::new(), Totals::default());
    for dimensions in (2..=3).filter(|&d| options.dimensions.is_none_or(|only| only == d)) {
        let mut mains = Vec::new();
        for &friction in &options.friction {
            let setup = options.setup(friction, dimensions, options.detection, options.cells(dimensions));
            let outcome = scene::roll(&setup, Some(&folder), restart)?;
            write(&outcome, &folder)?;
            totals = totals.plus(&outcome.totals);
            checks.extend(checks_of(&outcome, options.common.resolution));
            mains.push(outcome);
        }
        figures::cylinder(&mains)?.save(folder.join(format!("cylinder_{dimensions}d.png")))?;
        figures::histories(&mains)?.save(folder.join(format!("histories_{dimensions}d.png")))?;
        if dimensions == 2 && !options.alone {
            checks.extend(spacings::compare(options, &mains, &folder, restart)?);
        }
    }
    let settings = serde_json::json!({
        "angle": options.angle,
        "friction": options.friction,
        "detection": options.detection.name(),
        "cells_per_radius": options.cells(2),
        "cells_per_radius_in_space": options.cells(3),
        "stiffness": options.stiffness,
        "end": options.end,
        "threads": options.common.threads(),
        "particles_steps_seconds_are": "sums over the runs at the finest spacing",
    });
    Report::new("rolling_cylinder", options.common.resolution, settings, &totals, checks)
        .finish(&options.common, &folder)
}

/// Return the exact motion of a cylinder at the times of the rows since release.
pub fn course(outcome: &Outcome, cylinder: Cylinder) -> Vec<Course> {
    let times = outcome.free().iter().map(|r| r.time);
    outcome.setup.incline.course(GRAVITY, cylinder, scene::along, times)
}

/// Return the relative errors of distance and spin at the end, against an elastic cylinder with creep; NaN for an empty history.
fn errors(outcome: &Outcome) -> [f64; 2] {
    let exact = course(outcome, outcome.setup.cylinder());
    let (Some(now), Some(exact)) = (outcome.free().last(), exact.last().copied()) else {
        return [f64::NAN; 2];
    };
    [now.way / exact.way - 1.0, now.spin / exact.spin - 1.0]
}

/// Return the largest gap, cells.
fn gap(outcome: &Outcome) -> f64 {
    outcome.free().iter().map(|r| r.gap).fold(f64::NEG_INFINITY, f64::max) / outcome.setup.spacing()
}

/// Return the largest overlap, cells.
fn overlap(outcome: &Outcome) -> f64 {
    outcome.free().iter().map(|r| -r.gap).fold(f64::NEG_INFINITY, f64::max) / outcome.setup.spacing()
}

fn checks_of(outcome: &Outcome, resolution: Resolution) -> Vec<Check> {
    let incline = outcome.setup.incline;
    let kind = if incline.sticks() { "rolls" } else { "rolls and slides" };
    let name = |what: &str| format!("{}D, mu {}, {kind}: {what}", outcome.setup.dimensions, incline.friction);
    let rigid = course(outcome, Cylinder::rigid(RADIUS)).last().copied();
    let elastic = course(outcome, outcome.setup.cylinder()).last().copied();
    let (Some(now), Some(rigid), Some(elastic)) = (outcome.free().last(), rigid, elastic) else {
        return Vec::new();
    };
    let (hard, soft) = ("rigid cylinder [C]", "elastic cylinder, creeping [C]");
    let mut checks = vec![
        Check::gate(name("way"), now.way, "m", rigid.way, WAY_TOLERANCE, hard),
        Check::gate(name("way"), now.way, "m", elastic.way, WAY_TOLERANCE, soft),
    ];
    if incline.friction > 0.0 {
        // The remaining deficit of the spin is of first order in the cell size, and visible on coarse grids.
        let spin = name("spin");
        let fine = resolution != Resolution::Smoke;
        let coarse = "the deficit of the spin is of first order in the cell size";
        let of = |exact: f64, source: &str| {
            Check::gate(spin.clone(), now.spin, "rad/s", exact, SPIN_TOLERANCE, source)
                .judged_if(fine, coarse)
        };
        let rolls_in_space = outcome.setup.dimensions == 3 && incline.sticks();
        let rigid = of(rigid.spin, hard);
        checks.push(if rolls_in_space {
            rigid.known_miss("2.5 % less: an elastic cylinder creeps")
        } else {
            rigid
        });
        checks.push(of(elastic.spin, soft));
    }
    checks.push(Check::at_most(name("largest gap"), gap(outcome), "cells", GAP, "no lift-off"));
    checks.push(Check::at_most(name("largest overlap"), overlap(outcome), "cells", GAP, "no penetration"));
    let error = outcome.totals.momentum_error;
    checks.push(Check::gate(name("momentum error"), error, "-", 0.0, MOMENTUM_TOLERANCE, "conservation"));
    checks
}

const COLUMNS: [(&str, &str); 11] = [
    ("time", "s"),
    ("way", "m"),
    ("height", "m"),
    ("speed", "m/s"),
    ("spin", "rad/s"),
    ("gap", "m"),
    ("force along", "N/m"),
    ("force across", "N/m"),
    ("contact nodes", "-"),
    ("exact way", "m"),
    ("exact spin", "rad/s"),
];

/// Write the history of the cylinder on the incline.
fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let mut file = History::create(folder.join(format!("cylinder_{}.csv", outcome.setup.name())), COLUMNS)?;
    for (r, e) in outcome.free().iter().zip(course(outcome, outcome.setup.cylinder())) {
        let [f, n] = r.force;
        file.push(&[r.time, r.way, r.height, r.speed, r.spin, r.gap, f, n, r.nodes as f64, e.way, e.spin])?;
    }
    Ok(())
}
