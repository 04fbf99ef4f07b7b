//! A Taylor bar of steel by smoothed particles in space: steps a second of processor time, to be held against other programs.

use std::time::Instant;

use clap::Parser;
use mpm_core::geometry::{Cylinder, Filling, Lattice, fill};
use mpm_core::{Boundary, FullSpace, PlaneStrain, Side, Solver, Team, Watch};
use mpm_materials::library;
use serde_json::json;
use sph::{Composition, Layout, Method, Sph};

/// A bar of 4340 steel (7.595 x 37.97 mm, Johnson-Cook with heat, Mie-Grueneisen) on a rigid wall at 181 m/s: the total Lagrangian form in
/// space, or with --plane in plane strain. Particles updated in a second, over some steps from the start.
#[derive(Debug, Parser)]
#[command(name = "sph_bar", version)]
struct Options {
    /// Spacing, mm, 0.1 to 1
    #[arg(long, value_name = "MM", default_value_t = 0.32)]
    spacing: f64,
    /// Steps, 1 to 100000
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// Threads, 1 to 1024
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// In plane strain, by the updated form
    #[arg(long)]
    plane: bool,
}

type Failure = Box<dyn std::error::Error>;

fn timed<const D: usize, M: Composition<D>>(mut bar: Sph<D, M>, options: &Options) -> Result<(), Failure> {
    bar.bound(Boundary::Wall { axis: D - 1, at: 0.0, side: Side::Above, velocity: 0.0 })?;
    bar.set_team(Team::new(options.threads as usize)?);
    bar.set_watch(Watch::off());
    bar.step_at_most(f64::INFINITY)?;
    bar.measure_steps();
    let begun = Instant::now();
    for _ in 0..options.steps {
        bar.step_at_most(f64::INFINITY)?;
    }
    let (seconds, particles, times) =
        (begun.elapsed().as_secs_f64(), bar.positions().len(), bar.step_times());
    println!(
        "{}",
        json!({
            "method": bar.describe(),
            "particles": particles,
            "neighbours": bar.pairs() as f64 / particles as f64,
            "steps": options.steps,
            "seconds": seconds,
            "updates_per_second": particles as f64 * f64::from(options.steps) / seconds,
            "bytes_per_particle": bar.bytes() / particles,
            "shares": {
                "search": times.search / times.total(), "kernels": times.kernels / times.total(),
                "sums": times.sums / times.total(), "law": times.law / times.total(), "motion": times.motion / times.total(),
            },
        })
    );
    Ok(())
}

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    let (h, radius, length) = (options.spacing * 1e-3, 3.7975e-3, 37.97e-3);
    if options.plane {
        let shape = mpm_core::geometry::Cuboid::new([-radius, 0.0], [radius, length])?;
        let seeds = fill(&shape, &Lattice::new([-radius, 0.0], h)?, 1, &Filling::new())?;
        let law = library::steel_4340().with_bulk_viscosity(0.5, 4.0)?;
        return timed(
            Sph::new(Method::updated(PlaneStrain), law, &Layout::of_seeds(&seeds), |_| [0.0, -181.0])?,
            &options,
        );
    }
    let shape = Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], length, radius)?;
    let seeds = fill(&shape, &Lattice::new([0.0; 3], h)?, 1, &Filling::new())?;
    let method = Method::total_lagrangian(FullSpace);
    timed(
        Sph::new(method, library::steel_4340(), &Layout::of_seeds(&seeds), |_| [0.0, 0.0, -181.0])?,
        &options,
    )
}
