//! Plate impact: a flyer hits a target of the same metal. The shock lines of all metals of the library are measured and compared with those
//! of their sources, the states behind the shocks with Rankine and Hugoniot, and spall with acoustic theory for its plane and for the
//! pull-back of the free surface.

mod checks;
mod figures;
mod jobs;
mod lagrange;
mod metals;
mod plates;
mod shock;
mod spall;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use plates::Files;
use shock::{Impact, Setup};
use spall::Spall;

/// Plate impact: shock lines of the library's metals, and spall of a steel.
///
/// A flyer hits a target of the same metal. Shock speed over particle speed, pressure, density and energy behind the
/// shock are compared with each metal's line and Rankine-Hugoniot; the thickness of the spall and the pull-back of the
/// free surface with acoustic theory, on three grids. The exit code says whether all are within the tolerances. Writes
/// charts, CSV histories and ParaView series.
#[derive(Debug, Parser)]
#[command(name = "plate_impact", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Cells along each plate of the shock lines, 60 to 20000 [default: 150, 300 or 1000 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(60..=20_000))]
    cells: Option<u32>,
    /// Cells along the spall's flyer on the coarsest of three grids, 20 to 5000 [default: 25, 100 or 200 by resolution]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(20..=5000))]
    flyer_cells: Option<u32>,
    /// Linear coefficient of the bulk viscosity, 0 to 2
    #[arg(long, value_name = "B1", default_value_t = 1.0, value_parser = within(0.0, 2.0))]
    linear_viscosity: f64,
    /// Quadratic coefficient of the bulk viscosity, 0 to 2
    #[arg(long, value_name = "B0", default_value_t = 2.0, value_parser = within(0.0, 2.0))]
    quadratic_viscosity: f64,
    /// ParaView frames of a shock and of the spall, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// Particle speeds behind the shocks of the lines, m/s.
const PARTICLE_SPEEDS: [f64; 3] = [500.0, 1000.0, 1500.0];
/// Metal and particle speed, m/s, of the shock that is run on three grids.
const REFINED: (&str, f64) = ("copper", 1000.0);
/// Grids of a refinement, by the factor on the cells.
const GRIDS: [u32; 3] = [1, 2, 4];

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("plate_impact")?;
    let cells = options.cells.unwrap_or(common.resolution.choose(150, 300, 1000));
    let flyer_cells = options.flyer_cells.unwrap_or(common.resolution.choose(25, 100, 200));
    let viscosity = [options.linear_viscosity, options.quadratic_viscosity];
    let files = |name: String, frames: u32| Files { folder: &folder, name, frames, restart };

    let metals = metals::all();
    let mut shocks: Vec<Box<dyn FnOnce() -> Result<Impact, CaseError> + Send + '_>> = Vec::new();
    let setup = Setup { cells, viscosity };
    for metal in metals {
        for speed in PARTICLE_SPEEDS {
            let files = files(format!("{}_{speed:.0}", metal.file_name()), 0);
            shocks.push(Box::new(move || shock::impact(metal, speed, &setup, files)));
        }
    }
    for metal in metals.into_iter().filter(|m| m.name == REFINED.0) {
        for factor in GRIDS {
            let setup = Setup { cells: factor * cells, ..setup };
            let files = files(format!("shock_{}", setup.cells), if factor == 1 { options.frames } else { 0 });
            shocks.push(Box::new(move || shock::impact(metal, REFINED.1, &setup, files)));
        }
    }
    let mut spalls: Vec<Box<dyn FnOnce() -> Result<Spall, CaseError> + Send + '_>> = Vec::new();
    for metal in metals.into_iter().filter(|m| m.name == spall::METAL) {
        let threshold = spall::acoustic_pull_back(&metal);
        for factor in GRIDS {
            let cells = factor * flyer_cells;
            let frames = if factor == 1 { options.frames } else { 0 };
            let (opening, transits) = (spall::OPENING, spall::RINGING);
            let main = spall::Setup { speed: spall::SPEED, opening, transits, cells, viscosity };
            let onset = |factor| spall::Setup { speed: factor * threshold, transits: spall::ONSET, ..main };
            let runs = [
                ("spall", main, frames),
                ("at_once", spall::Setup { opening: spall::AT_ONCE, ..main }, 0),
                ("slower", onset(checks::SLOWER), 0),
                ("faster", onset(checks::FASTER), 0),
            ];
            for (name, setup, frames) in runs {
                let files = files(format!("{name}_{cells}"), frames);
                spalls.push(Box::new(move || spall::spall(&metal, &setup, files)));
            }
        }
    }
    println!("{} shocks in {} metals", shocks.len(), metals.len());
    let mut impacts = jobs::on_threads(common.threads(), shocks)?;
    let refined = impacts.split_off(metals.len() * PARTICLE_SPEEDS.len());
    println!("{} impacts of steel plates that may spall", spalls.len());
    let spalls = jobs::on_threads(common.threads(), spalls)?;
    figures::draw(&impacts, &refined, &spalls, &folder)?;
    let totals = (impacts.iter().chain(&refined).map(|i| &i.totals))
        .chain(spalls.iter().map(|s| &s.totals))
        .fold(Totals::default(), |sum, t| sum.plus(t));
    let settings = serde_json::json!({
        "cells": cells,
        "flyer_cells": flyer_cells,
        "viscosity": viscosity,
        "particle_speeds": PARTICLE_SPEEDS,
        "spall_strength": spall::STRENGTH,
        "opening": spall::OPENING,
        "spall_speed": spall::SPEED,
    });
    let checks = checks::of(&impacts, &refined, &spalls, viscosity, &totals);
    Report::new("plate_impact", common.resolution, settings, &totals, checks).finish(common, &folder)
}
