//! Error against core-seconds: elastic bar and copper bar of Feng 2014 by particle contacts, and by the material point
//! method with linear shape functions and GIMP, with one law for all methods.

mod copper;
mod elastic;

use std::path::PathBuf;

use clap::Parser;
use examples::machine::core_seconds;
use mpm_core::output::picture::{Axis, Chart, Marker, Panels, Series, palette};

/// Run both bars at several resolutions by all methods on one thread; a table, and a chart of error over core-seconds.
#[derive(Debug, Parser)]
#[command(name = "pcmm_or_mpm", version)]
struct Options {
    /// Finest of the four resolutions over the coarsest, 2 to 8
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(2..=8))]
    finest: u32,
    /// Folder for the chart
    #[arg(long, value_name = "DIR", default_value = "out/pcmm_or_mpm")]
    out: PathBuf,
}

/// Any error of the program.
pub type Failure = Box<dyn std::error::Error>;

/// Method of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Particle contacts of this library.
    Contacts,
    /// Material points with linear shape functions, FLIP, MUSL.
    Linear,
    /// Material points with GIMP, FLIP, MUSL.
    Gimp,
}

const WAYS: [(Way, &str); 3] =
    [(Way::Contacts, "PCMM"), (Way::Linear, "MPM, linear shape functions"), (Way::Gimp, "MPM, GIMP")];

/// Number of cells across, error, and time, s.
type Point = (u32, f64, f64);

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    std::fs::create_dir_all(&options.out)?;
    let finer = |coarsest: u32| -> Vec<u32> {
        let step = f64::from(options.finest).powf(1.0 / 3.0);
        (0..4).map(|k| (f64::from(coarsest) * step.powi(k)).round() as u32).collect()
    };
    let mut panels = Panels::new(2).title("Error over cost, one thread");
    type Run = fn(Way, u32) -> Result<f64, Failure>;
    let cases: [(&str, u32, Run); 2] =
        [("elastic bar, confined", 5, elastic::error), ("copper bar, axisymmetric", 4, copper::error)];
    println!("{:<26} {:<10} {:>6} {:>9} {:>13}", "case", "method", "cells", "error", "core-seconds");
    for (case, coarsest, error) in cases {
        let mut chart = Chart::new(620, 520)
            .x(Axis::new("core-seconds").logarithmic())
            .y(Axis::new("relative error").logarithmic());
        for (n, (way, name)) in WAYS.into_iter().enumerate() {
            let mut points: Vec<Point> = Vec::new();
            for cells in finer(coarsest) {
                let before = core_seconds();
                let error = error(way, cells)?;
                let cost = (core_seconds() - before).max(0.01);
                println!("{case:<26} {name:<10} {cells:>6} {:>7.2} % {cost:>13.2}", 100.0 * error);
                points.push((cells, error, cost));
            }
            let x: Vec<f64> = points.iter().map(|p| p.2).collect();
            let y: Vec<f64> = points.iter().map(|p| p.1).collect();
            chart = chart.series(Series::new(name, &x, &y)?.marker(Marker::Circle).colour(palette(n)));
        }
        panels = panels.panel(case, chart.draw()?);
    }
    panels.compose()?.save(options.out.join("pcmm_or_mpm.png"))?;
    Ok(())
}
