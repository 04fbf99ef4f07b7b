//! Taylor bar of OFHC copper, 10 mm x 70 mm, on a rigid wall at 165 m/s (case 2 of Feng 2014), by the particle-contact
//! meshfree method: as printed, with the constants of the material put right, axisymmetric, and the same bar by the
//! material point method.

mod figures;
mod mpm;
mod scene;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Report, Resolution, Restart, Totals, case};

use scene::{END, Files, Outcome, Parts, SPEED, Setup, Space};

/// Copper bar (10 mm x 70 mm) on a rigid wall at 165 m/s by the particle-contact meshfree method.
///
/// Length and radius of the face are compared with independent finite elements, axisymmetric and in plane strain; the
/// exit code says whether all are within the tolerances but for what is declared. The method as printed, the printed
/// hardening coefficient of 45 MPa, and the material point method are judged beside; what is printed misses by declaration.
#[derive(Debug, Parser)]
#[command(name = "taylor_copper", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Spacings on the radius, 2 to 100; the paper has 25 [default: 5, 10 or 25 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100))]
    cells: Option<u32>,
    /// Only the two runs of our parts
    #[arg(long)]
    only_ours: bool,
    /// Also a quarter of the bar in three dimensions: half a minute with 3 cells, many with 5
    #[arg(long)]
    space: bool,
    /// ParaView frames a run, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// B, Pa: the usual one, and the printed one.
const STANDARD: f64 = 291.64e6;
const MISPRINT: f64 = 45e6;
const LENGTH_TOLERANCE: f64 = 0.02;
const RADIUS_TOLERANCE: f64 = 0.05;
const MOMENTUM_TOLERANCE: f64 = 1e-11;
const ENERGY_TOLERANCE: f64 = 0.005;
/// Elements at the corner of the face that are stretched tenfold, or whose angles fall below half a degree, crack: a few
/// of thousands, with the heat in them.
const COVER_TOLERANCE: f64 = 0.005;
const ADDED_TOLERANCE: f64 = 0.02;

/// Length and radius of the face by independent finite elements, m.
fn finite_elements(space: Space) -> [f64; 2] {
    match space {
        Space::Axisymmetric | Space::Quarter => [50.37e-3, 8.64e-3],
        Space::PlaneStrain => [52.79e-3, 15.67e-3],
    }
}

impl Options {
    fn cells(&self) -> u32 {
        self.cells.unwrap_or(self.common.resolution.choose(5, 10, 25))
    }

    /// Spacings on the radius of the runs beside them.
    fn coarse(&self) -> u32 {
        self.cells().min(self.common.resolution.choose(4, 5, 10))
    }

    /// Cells on the radius of the material point method.
    fn beside(&self) -> u32 {
        self.cells().min(self.common.resolution.choose(4, 10, 10))
    }

    /// The runs.
    fn setups(&self) -> Vec<Setup> {
        let ours = |name, space, parts, hardening| Setup {
            name,
            space,
            parts,
            hardening,
            reach: 0.0,
            cells: self.cells(),
            threads: self.common.threads(),
        };
        let mut list = vec![
            ours("axisymmetric", Space::Axisymmetric, Parts::Consistent, STANDARD),
            ours("plane strain", Space::PlaneStrain, Parts::Consistent, STANDARD),
        ];
        if self.space {
            let quarter = ours("three dimensions", Space::Quarter, Parts::Consistent, STANDARD);
            list.push(Setup { cells: self.cells().min(10), ..quarter });
        }
        if self.only_ours {
            return list;
        }
        let cells = self.coarse();
        let coarse = |setup: Setup| Setup { cells, ..setup };
        list.push(coarse(ours("locking", Space::Axisymmetric, Parts::Locking, STANDARD)));
        let printed = |name, reach, hardening| Setup {
            reach,
            ..coarse(ours(name, Space::PlaneStrain, Parts::Printed, hardening))
        };
        list.push(printed("printed, delta h", 1.0, STANDARD));
        list.push(printed("printed, delta h, 45 MPa", 1.0, MISPRINT));
        if self.common.resolution != Resolution::Smoke {
            list.push(printed("printed, delta 0.45 h", 0.45, STANDARD));
            list.push(printed("printed, delta 2 h", 2.0, STANDARD));
            let cells = cells.min(5);
            let soft = ours("axisymmetric, 45 MPa", Space::Axisymmetric, Parts::Consistent, MISPRINT);
            list.push(Setup { cells, ..soft });
        }
        list
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("taylor_copper")?;
    let (mut totals, mut checks, mut bars) = (Totals::default(), Vec::new(), Vec::new());
    for setup in options.setups() {
        let outcome = scene::impact(&setup, Files { folder: &folder, frames: options.frames, restart })?;
        totals = totals.plus(&Totals { energy_error: 0.0, ..outcome.totals });
        checks.extend(checks_of(&outcome));
        bars.push(outcome);
    }
    let mut beside = Vec::new();
    if !options.only_ours {
        for space in [Space::Axisymmetric, Space::PlaneStrain] {
            let outcome = mpm::impact(space, STANDARD, options.beside(), common.threads(), restart)?;
            totals = totals.plus(&outcome.totals);
            checks.extend(checks_beside(&outcome, options.beside()));
            beside.push(outcome);
        }
    }
    figures::draw(&bars, &beside, &folder)?;
    let settings = serde_json::json!({
        "cells_on_radius": options.cells(),
        "runs": bars.iter().map(|b| b.setup.name).collect::<Vec<_>>(),
        "deleted_for_contact_small_angle_large_angle_short_edge":
            bars.iter().map(|b| b.audit.flaws).collect::<Vec<_>>(),
        "elements_deleted_created":
            bars.iter().map(|b| [b.audit.removed.elements, b.audit.created.elements]).collect::<Vec<_>>(),
        "core_seconds": bars.iter().map(|b| b.totals.wall_seconds).collect::<Vec<_>>(),
        "core_seconds_mpm": beside.iter().map(|b| b.totals.wall_seconds).collect::<Vec<_>>(),
        "threads": common.threads(),
        "impact_speed": SPEED,
        "end": END,
        "particles_steps_seconds_are": "sums over the runs; wall_seconds in steps alone",
    });
    Report::new("taylor_copper", common.resolution, settings, &totals, checks).finish(common, &folder)
}

fn source(space: Space) -> &'static str {
    match space {
        Space::Axisymmetric | Space::Quarter => "axisymmetric finite elements [C]",
        Space::PlaneStrain => "plane-strain finite elements [C]",
    }
}

/// The sizes of a bar, and what it lost. What is printed, or meant to show a defect, is judged alike; where it fails is
/// declared.
fn checks_of(outcome: &Outcome) -> Vec<Check> {
    let Setup { name: run, space, parts, hardening, .. } = outcome.setup;
    let name = |what: &str| format!("{run}: {what}");
    let [length, radius] = outcome.sizes.map(|x| 1e3 * x);
    let added = outcome.audit.energy_added() / outcome.start;
    let [l, r] = finite_elements(space).map(|x| 1e3 * x);
    let standard = hardening == STANDARD;
    let (l, from) =
        if standard { (l, source(space)) } else { (1e3 * ROD_MODEL, "rod model with B = 45 MPa [C]") };
    let (whole, free) = ("nothing uncovered, nothing covered twice", "conservation");
    let mut rows = vec![
        (Size::Length, Check::gate(name("length"), length, "mm", l, LENGTH_TOLERANCE, from)),
        (
            Size::Radius,
            match standard {
                true => Check::gate(name("radius of the face"), radius, "mm", r, RADIUS_TOLERANCE, from),
                false => {
                    Check::unreferenced(name("radius of the face"), radius, "mm", "the rod model has none")
                }
            },
        ),
        (Size::Cover, {
            let name = name("mass of elements / at the start");
            Check::gate(name, outcome.covered, "-", 1.0, COVER_TOLERANCE, whole)
        }),
        (Size::Added, Check::gate(name("energy added by revisions"), added, "-", 0.0, ADDED_TOLERANCE, free)),
    ];
    for (size, row) in &mut rows {
        if let Some(reason) = known(&outcome.setup, *size) {
            *row = row.clone().known_miss(reason);
        }
    }
    let mut checks: Vec<Check> = rows.into_iter().map(|(_, row)| row).collect();
    if parts == Parts::Consistent && standard {
        let Totals { energy_error, momentum_error, .. } = outcome.totals;
        checks.push(Check::gate(name("energy error"), energy_error, "-", 0.0, ENERGY_TOLERANCE, free));
        checks.push(Check::gate(name("momentum error"), momentum_error, "-", 0.0, MOMENTUM_TOLERANCE, free));
    }
    if let Some(cause) = &outcome.broke {
        let end = Check::at_least(name("time reached"), 1e6 * outcome.time, "µs", 1e6 * END, "the end");
        checks.push(if parts == Parts::Printed { end.known_miss(&format!("broke: {cause}")) } else { end });
    }
    checks
}

/// Length of the rod model with the printed hardening, m.
const ROD_MODEL: f64 = 38.1e-3;

/// What is measured of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    Length,
    Radius,
    Cover,
    Added,
}

/// Why a run is known to miss a size.
fn known(setup: &Setup, size: Size) -> Option<&'static str> {
    match (setup.parts, size) {
        (Parts::Locking, Size::Radius) => {
            Some("elements that keep their own volume lock, which this run is to show: 18 % too small")
        }
        (Parts::Printed, Size::Length) if setup.reach <= 1.0 => {
            Some("the method as printed: 4 to 30 % too short")
        }
        (Parts::Printed, Size::Radius) if setup.reach != 1.0 => Some(
            "the method as printed: 34 % too small with a reach of 2 h, about 90 % too large with 0.45 h",
        ),
        (Parts::Printed, Size::Cover) => {
            Some("the method as printed: matter uncovered and covered twice, 3 to 25 %")
        }
        (Parts::Printed, Size::Added) => {
            Some("the method as printed: revisions add 28 to 46 % of the energy at the start")
        }
        (Parts::Consistent, Size::Cover) if setup.hardening != STANDARD => {
            Some("five spacings on the radius of a face that spreads to three radii: 0.53 %")
        }
        _ => None,
    }
}

/// The same bar by the material point method.
fn checks_beside(outcome: &mpm::Outcome, cells: u32) -> Vec<Check> {
    let [length, radius] = outcome.sizes.map(|x| 1e3 * x);
    let [l, r] = finite_elements(outcome.space).map(|x| 1e3 * x);
    let space = match outcome.space {
        Space::Axisymmetric | Space::Quarter => "mpm, axisymmetric",
        Space::PlaneStrain => "mpm, plane strain",
    };
    let short = outcome.space == Space::PlaneStrain && cells >= 10;
    let check =
        Check::gate(format!("{space}: length"), length, "mm", l, LENGTH_TOLERANCE, source(outcome.space));
    vec![
        if short {
            check.known_miss(
                "2.4 % too short with 10 cells on the radius, 0.7 % with 4: finer grids do not come nearer",
            )
        } else {
            check
        },
        Check::gate(
            format!("{space}: radius of the face"),
            radius,
            "mm",
            r,
            RADIUS_TOLERANCE,
            source(outcome.space),
        ),
    ]
}
