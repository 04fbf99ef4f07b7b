//! Taylor bar of steel by smoothed particles: steps per second of processor time, for profilers. `RESULTS.md` compares it with other
//! programs.

use benchmarks::{bar, stepped};
use clap::Parser;
use examples::CaseError;
use mpm_core::PlaneStrain;
use serde_json::json;
use sph::{Composition, Method, Sph};

/// A bar of 4340 steel (7.595 x 37.97 mm, Johnson-Cook with heat, Mie-Grueneisen) on a rigid wall at 181 m/s: the total Lagrangian form in
/// space, or with --plane the updated one of its half in plane strain. Particles updated in a second, over some steps from the start.
#[derive(Debug, Parser)]
#[command(name = "sph_bar", version)]
struct Options {
    /// Spacing, mm, 0.1 to 1
    #[arg(long, value_name = "MM", default_value_t = 0.32, value_parser = examples::within(0.1, 1.0))]
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

fn run<const D: usize, M: Composition<D>>(mut bar: Sph<D, M>, options: &Options) -> Result<(), CaseError> {
    bar.measure_steps();
    let found = stepped(&mut bar, options.threads as usize, options.steps.into())?;
    let times = bar.step_times();
    println!(
        "{}",
        json!({
            "method": bar.describe(),
            "particles": found.points,
            "neighbours": bar.pairs() as f64 / found.points as f64,
            "steps": found.steps,
            "seconds": found.seconds,
            "updates_per_second": found.updates_per_second(),
            "bytes_per_particle": found.bytes_per_point(),
            "shares": {
                "search": times.search / times.total(), "kernels": times.kernels / times.total(),
                "sums": times.sums / times.total(), "law": times.law / times.total(), "motion": times.motion / times.total(),
            },
        })
    );
    Ok(())
}

fn main() -> Result<(), CaseError> {
    let options = Options::parse();
    let spacing = 1e-3 * options.spacing;
    if options.plane {
        let cells = (bar::SIZE[0] / spacing).round() as usize;
        return run(bar::half(Method::updated(PlaneStrain), cells)?, &options);
    }
    run(bar::in_space(spacing)?, &options)
}
