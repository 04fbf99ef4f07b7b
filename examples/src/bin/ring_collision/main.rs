//! Collision of two elastic rings at 60 m/s (Ma 2010): the location of contact detection decides whether their surfaces touch. Closest
//! approach of the surfaces over time, energy error over the time step, rebound, contact force; USF and MUSL, the approach test against the
//! distance of the surfaces.

mod checks;
mod figures;
mod scene;
mod setup;
mod surface;
mod watch;

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Check, Common, Detection, Law, Report, Resolution, Restart, Totals, case, within};

use scene::Outcome;
use setup::{Kernel, Scheme, Seeding, Setup};
use watch::Look;

/// Two elastic rings (radii 30 and 40 mm) collide at 60 m/s.
///
/// Writes the closest approach of their surfaces over time, contact force, energy error over the time factor,
/// and pictures; the exit code says whether surfaces meet with the distance test and whether energy and momentum
/// are conserved.
#[derive(Debug, Parser)]
#[command(name = "ring_collision", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Stress updates to run
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["usf", "musl"])]
    scheme: Vec<Scheme>,
    /// Shape functions to run [default: cpgimp at smoke, else both]
    #[arg(long, value_enum, value_delimiter = ',')]
    shape: Vec<Kernel>,
    /// Where particles start
    #[arg(long, value_enum, default_value = "circles")]
    seeding: Seeding,
    /// Tests of contact to run
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["approach", "distance"])]
    detection: Vec<Detection>,
    /// What the rings do where they touch
    #[arg(long, value_enum, default_value = "coulomb")]
    law: Law,
    /// Cell sizes, mm; particles are half as far apart [default: 2, or 2 and 1, or 2, 1 and 0.5 by resolution]
    #[arg(long, value_name = "MM", value_delimiter = ',', value_parser = within(0.25, 5.0))]
    cell: Vec<f64>,
    /// Coefficient of friction, 0 to 10
    #[arg(long, value_name = "MU", default_value_t = 0.1, value_parser = within(0.0, 10.0))]
    friction: f64,
    /// Distance of the lines of flight, mm, 0 to 70
    #[arg(long, value_name = "MM", default_value_t = 0.0, value_parser = within(0.0, 70.0))]
    offset: f64,
    /// Time factor, step over h / (c + |v|), of the runs that are looked at closely; 0.01 to 2
    #[arg(long, value_name = "F", default_value_t = 0.3, value_parser = within(0.01, 2.0))]
    factor: f64,
    /// Time factors of the energy errors, beside --factor [default: 1, 6 or 9 of 0.05 to 0.9 by resolution]
    #[arg(long, value_name = "F", value_delimiter = ',', value_parser = within(0.01, 2.0))]
    factors: Vec<f64>,
}

const MOMENTUM_TOLERANCE: f64 = 1e-12;

impl Options {
    fn cells(&self) -> Vec<f64> {
        let all: &[f64] = self.common.resolution.choose(&[2.0], &[2.0, 1.0], &[2.0, 1.0, 0.5]);
        if self.cell.is_empty() { all.to_vec() } else { self.cell.clone() }
    }
    fn factors(&self) -> Vec<f64> {
        let all: &[f64] = self.common.resolution.choose(
            &[0.6],
            &[0.05, 0.1, 0.2, 0.5, 0.7, 0.9],
            &[0.05, 0.1, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9],
        );
        let all = if self.factors.is_empty() { all } else { &self.factors };
        all.iter().copied().filter(|&f| f != self.factor).collect()
    }
    fn setup(&self, method: (Kernel, Scheme, Detection), cell: f64, factor: f64) -> Setup {
        Setup {
            seeding: self.seeding,
            kernel: method.0,
            scheme: method.1,
            detection: method.2,
            law: self.law,
            cell: 1e-3 * cell,
            friction: self.friction,
            offset: 1e-3 * self.offset,
            factor,
        }
    }
    fn schemes(&self) -> Vec<(Kernel, Scheme)> {
        let all: &[Kernel] = match self.common.resolution {
            Resolution::Smoke => &[Kernel::Cpgimp],
            _ => &[Kernel::Linear, Kernel::Cpgimp],
        };
        let kernels = if self.shape.is_empty() { all } else { &self.shape };
        kernels.iter().flat_map(|&k| self.scheme.iter().map(move |&s| (k, s))).collect()
    }
    fn methods(&self) -> Vec<(Kernel, Scheme, Detection)> {
        let of = |(k, s)| self.detection.iter().map(move |&d| (k, s, d));
        self.schemes().into_iter().flat_map(of).collect()
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("ring_collision")?;
    let (close, sweep) = collide(options, &folder, restart)?;
    let runs = close.iter().chain(sweep.iter().filter(|o| o.setup.factor != options.factor));
    let totals = runs.fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    figures::draw(&close, &sweep, &folder)?;
    println!("{}", checks::table(&sweep));
    let mut checks: Vec<Check> = close.iter().flat_map(checks::closely).collect();
    checks.extend(options.schemes().iter().flat_map(|&method| checks::curves(&sweep, method)));
    checks.push(Check::gate(
        "largest momentum error of all runs",
        totals.momentum_error,
        "-",
        0.0,
        MOMENTUM_TOLERANCE,
        "conservation",
    ));
    let settings = serde_json::json!({
        "close": close.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "sweep": sweep.iter().map(|o| o.setup).collect::<Vec<_>>(),
    });
    Report::new("ring_collision", options.common.resolution, settings, &totals, checks)
        .finish(&options.common, &folder)
}

/// Run the detailed runs, and those over the time factor at the coarsest cell, in order of factors.
fn collide(
    options: &Options,
    folder: &Path,
    restart: &Restart,
) -> Result<(Vec<Outcome>, Vec<Outcome>), CaseError> {
    let (cells, methods) = (options.cells(), options.methods());
    let mut setups = Vec::new();
    for &cell in &cells {
        for &method in &methods {
            setups.push((options.setup(method, cell, options.factor), Look::Closely));
        }
    }
    // Finest first for load balance.
    setups.reverse();
    for factor in options.factors() {
        for &method in &methods {
            setups.push((options.setup(method, cells[0], factor), Look::Ledger));
        }
    }
    let mut close = scene::collide_all(&setups, folder, options.common.threads(), restart)?;
    let mut sweep = close.split_off(cells.len() * methods.len());
    close.reverse();
    sweep.extend(close.iter().take(methods.len()).cloned());
    sweep.sort_by(|a, b| a.setup.factor.total_cmp(&b.setup.factor));
    Ok((close, sweep))
}
