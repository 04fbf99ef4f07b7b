//! Plate under tension at its end (case 2.1 of the paper of the fragile points method): waves along it against exact solutions.

mod checks;
mod convergence;
mod figures;
mod load;
mod scene;

use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use examples::fragile::Fragile;
use examples::{CaseError, Common, Report, Resolution, Restart, Totals, case, within};

use load::{Load, Shape};
use scene::{Files, HEIGHTS, LENGTH, Setup, speed};

/// Elastic plate (4 m x 2 m, nu = 0) held at one end and drawn at the other, by the fragile points method.
///
/// Peaks of displacement and stress, the speed of waves and the energy are judged against the exact waves, for both fluxes, and the order
/// of convergence with half a sine; the exit code says whether all are within the tolerances but for what is declared.
#[derive(Debug, Parser)]
#[command(name = "wave_plate", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    fragile: Fragile,
    /// How the tension goes with time
    #[arg(long, value_enum, default_value = "all")]
    load: Loads,
    /// The most tension, Pa, 1e-4 to 10; Young's modulus is 8e4 Pa
    #[arg(long, value_name = "PA", default_value_t = 0.1, value_parser = within(1e-4, 10.0))]
    tension: f64,
    /// How long the load acts or rises, ms, 1 to 100 [default: pulse 14.1, half sine 21.2, ramp 14.1]
    #[arg(long, value_name = "MS", value_parser = within(1.0, 100.0))]
    duration: Option<f64>,
    /// Cells along the plate, 8 to 1000, even; half as many across [default: 40 as printed]
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u32).range(8..=1000))]
    cells: u32,
    /// End of the runs, ms, 60 to 10000
    #[arg(long, value_name = "MS", default_value_t = 300.0, value_parser = within(60.0, 1e4))]
    end: f64,
    /// Instead: errors, orders and costs of cells of once, half and a quarter of the size, with half a sine and a sine squared, on one thread
    #[arg(long)]
    convergence: bool,
    /// ParaView frames a run, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// Which loads are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Loads {
    /// At once, and held
    Step,
    /// At once, and taken off at once
    Pulse,
    /// Half a sine
    HalfSine,
    /// Rises in a straight line, and is held
    Ramp,
    /// One after the other
    All,
}

impl Loads {
    fn shapes(self) -> &'static [Shape] {
        match self {
            Loads::Step => &[Shape::Step],
            Loads::Pulse => &[Shape::Pulse],
            Loads::HalfSine => &[Shape::HalfSine],
            Loads::Ramp => &[Shape::Ramp],
            Loads::All => &[Shape::Step, Shape::Pulse, Shape::HalfSine, Shape::Ramp],
        }
    }
}

impl Options {
    fn setups(&self, shapes: &[Shape]) -> Vec<Setup> {
        let transit = LENGTH / speed();
        let along = self.cells as usize;
        let of = |&shape: &Shape| {
            let duration = self.duration.map_or(shape.usual() * transit, |ms| 1e-3 * ms);
            let load = Load { shape, tension: self.tension, duration };
            self.fragile.joints().iter().map(move |&joint| Setup {
                load,
                joint,
                fragile: self.fragile,
                counts: [along, along / HEIGHTS],
                end: 1e-3 * self.end,
                threads: self.common.threads(),
            })
        };
        shapes.iter().flat_map(of).collect()
    }
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("wave_plate")?;
    let smoke = common.resolution == Resolution::Smoke;
    // A convergence study starts with half as many cells at smoke resolution.
    let coarsest = options.cells as usize / if smoke { 2 } else { 1 };
    let standard = options.fragile.has_usual_penalty() && options.duration.is_none();
    let settings = |methods: Vec<&str>| {
        serde_json::json!({
            "methods": methods,
            "cells_along": options.cells,
            "points": format!("{:?}", options.fragile.points).to_lowercase(),
            "seed": options.fragile.seed,
            "tension": options.tension,
            "wave_speed": speed(),
            "end": 1e-3 * options.end,
            "convergence": options.convergence,
            "threads": common.threads(),
        })
    };
    let report = |methods, totals, rows| {
        Report::new("wave_plate", common.resolution, settings(methods), totals, rows).finish(common, &folder)
    };
    if options.convergence {
        let setups = options.setups(&[Shape::HalfSine, Shape::SineSquared]);
        let (totals, rows) = convergence::study(&setups, coarsest)?;
        println!("{}", convergence::table(&rows));
        convergence::keep(&rows, &folder)?;
        let checks = convergence::checks(&rows, standard, !smoke);
        return report(Vec::new(), &totals, checks);
    }
    let files = Files { folder: &folder, frames: options.frames, restart };
    let (mut totals, mut rows, mut outcomes) = (Totals::default(), Vec::new(), Vec::new());
    for setup in options.setups(options.load.shapes()) {
        let outcome = scene::draw_out(&setup, files)?;
        totals = totals.plus(&outcome.totals);
        rows.extend(checks::of(&outcome));
        outcomes.push(outcome);
    }
    figures::draw(&outcomes, &folder)?;
    if options.load.shapes().contains(&Shape::HalfSine) {
        let (sums, study) = convergence::study(&options.setups(&[Shape::HalfSine]), coarsest)?;
        totals = totals.plus(&sums);
        rows.extend(convergence::checks(&study, standard, !smoke));
    }
    let mut methods: Vec<&str> = outcomes.iter().map(|o| o.method.as_str()).collect();
    methods.sort_unstable();
    methods.dedup();
    report(methods, &totals, rows)
}
