//! Failure of a soil slope under gravity (MPM3D-F90 `Slopefail.mpm`): strength at failure and slip surface, against limit equilibrium on
//! circles.

mod bishop;
mod checks;
mod figures;
mod scene;
mod setup;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use bishop::Strength;
use checks::Failure;
use scene::Outcome;
use setup::{DENSITY, GRAVITY, Setup};

/// A slope 20 m high, 1 : 1, of soil that does not hold it.
///
/// First the slope as it is, its weight acting at once: slip surface and run-out on grids that get finer. Then slopes
/// of more and less strength under slowly growing weight: at which it fails. Both are held against the critical
/// circle of Bishop; the exit code says whether they are within the tolerances. Writes pictures, CSV histories and
/// ParaView files.
#[derive(Debug, Parser)]
#[command(name = "slope_failure", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Cell sizes, m, 0.2 to 5, that divide 5 m [default: 2.5; 2.5,1.25,0.625; 1.25,0.625,0.3125 by resolution]
    #[arg(long, value_name = "M,M", value_delimiter = ',', value_parser = within(0.2, 5.0))]
    spacing: Vec<f64>,
    /// End of the slides, s, 1 to 60
    #[arg(long, value_name = "S", default_value_t = 15.0, value_parser = within(1.0, 60.0))]
    end: f64,
    /// Cell size of the slopes of other strengths, m; none with 0 [default: 2.5; 1.25; 0.625 by resolution]
    #[arg(long, value_name = "M", value_parser = within(0.0, 5.0))]
    reduction_spacing: Option<f64>,
    /// Write ParaView frames of the finest slide
    #[arg(long)]
    frames: bool,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("slope_failure")?;
    let resolution = options.common.resolution;
    let mut spacings = options.spacing.clone();
    if spacings.is_empty() {
        spacings = resolution.choose(vec![2.5], vec![2.5, 1.25, 0.625], vec![1.25, 0.625, 0.3125]);
    }
    spacings.sort_by(|a, b| b.total_cmp(a));
    let threads = options.common.threads();
    let as_it_is = |spacing| Setup { spacing, reduction: 1.0, ramp: 0.0, end: options.end, threads };

    let weight = DENSITY * GRAVITY;
    let strength = as_it_is(1.0).strength();
    let circle = bishop::critical(&strength, weight);
    let (mut slides, mut slips) = (Vec::new(), Vec::new());
    for (n, &spacing) in spacings.iter().enumerate() {
        let files = (n + 1 == spacings.len() && options.frames).then_some(folder.as_path());
        let outcome = scene::slide(&as_it_is(spacing), &[2.0, 8.0], false, files, restart)?;
        let slip = scene::slip(&outcome)?;
        figures::write(&outcome, &slip, &folder)?;
        slides.push(outcome);
        slips.push(slip);
    }
    if let Some(finest) = slides.last() {
        figures::slope(finest)?.save(folder.join("slope.png"))?;
    }
    figures::slips(&slides, &slips, &circle)?.save(folder.join("slip.png"))?;
    figures::histories(&slides)?.save(folder.join("run_out.png"))?;
    let mut found = checks::of_slides(&slides, &slips, &circle);

    let spacing = options.reduction_spacing.unwrap_or(resolution.choose(2.5, 1.25, 0.625));
    let mut tried = Vec::new();
    let mut failure = None;
    if spacing > 0.0 {
        let slow = Setup { ramp: 3.0, end: 10.0, ..as_it_is(spacing) };
        let (bracket, runs) = reduce(&slow, restart)?;
        // Flow without dilatancy slips at the strength of Davis: tan = sin(phi), c cos(phi).
        let sine = strength.tangent / (1.0 + strength.tangent.powi(2)).sqrt();
        let cosine = sine / strength.tangent;
        let davis = Strength { cohesion: strength.cohesion * cosine, tangent: sine };
        let reduced = bishop::critical(&davis, weight);
        // The last failing run is the strongest failing slope.
        let last = runs.iter().rfind(|o| o.failed());
        let slip = last.map_or(Ok(Vec::new()), scene::slip)?;
        found.extend(checks::of_failure(&bracket, &slip, [&circle, &reduced], spacing));
        failure = Some([bracket.stands, bracket.fails]);
        tried = runs;
    }
    let books: Vec<&Outcome> = slides.iter().chain(&tried).collect();
    let totals = books.iter().fold(Totals::default(), |sum, o| sum.plus(&o.totals));
    let settings = serde_json::json!({
        "runs": books.iter().map(|o| o.setup).collect::<Vec<_>>(),
        "run_outs": slides.iter().map(Outcome::run_out).collect::<Vec<_>>(),
        "stands_and_fails": failure,
        "circle": { "ends": circle.ends, "centre": circle.centre, "radius": circle.radius, "factor": circle.factor },
    });
    Report::new("slope_failure", resolution, settings, &totals, found).finish(&options.common, &folder)
}

/// Find the strength reduction at failure by bisection to two hundredths.
fn reduce(slow: &Setup, restart: &Restart) -> Result<(Failure, Vec<Outcome>), CaseError> {
    let (mut stands, mut fails) = (0.4, 1.6);
    let mut runs = Vec::new();
    while fails - stands > 0.02 {
        let reduction = 0.5 * (stands + fails);
        let outcome = scene::slide(&Setup { reduction, ..*slow }, &[], true, None, restart)?;
        if outcome.failed() {
            fails = reduction;
        } else {
            stands = reduction;
        }
        runs.push(outcome);
    }
    Ok((Failure { stands, fails }, runs))
}
