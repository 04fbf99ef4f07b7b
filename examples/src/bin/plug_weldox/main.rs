//! Plugging of a steel plate by a blunt projectile (second case of Xiao 2015): axisymmetric smoothed particles, with Borvik's viscoplastic
//! law and damage for the plate, and with a later set of constants.

mod checks;
mod figures;
mod pieces;
mod scene;
mod setup;
mod track;

use std::process::ExitCode;

use clap::Parser;
use examples::{CaseError, Common, Report, Restart, Totals, case, within};

use setup::{Constants, Form, Setup};

/// Blunt Arne tool steel projectile (20 mm x 80 mm) on 8 mm of Weldox 460 E at 173.7 m/s, by smoothed particles around the axis.
///
/// The plate, 500 mm across and held at its rim, fails in a band around the projectile, and a plug leaves. Balances, the size of the plug
/// and the shape of the projectile are judged; the residual velocity is shown beside 72.5 m/s, which rests on a limit from memory of the
/// literature. There is no total Lagrangian form of the plate: neighbours that never change cannot part.
#[derive(Debug, Parser)]
#[command(name = "plug_weldox", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Impact speed, m/s, 20 to 1000
    #[arg(long, value_name = "V", default_value_t = SPEED, value_parser = within(20.0, 1000.0))]
    speed: f64,
    /// Constants of the plate
    #[arg(long, value_enum, value_delimiter = ',', default_value = "2001,later")]
    constants: Vec<Constants>,
    /// Form of the particles: as printed, or with corrected gradients
    #[arg(long, value_enum, default_value = "updated")]
    form: Form,
    /// Spacing in the projectile and before it, mm, 0.05 to 2 [default: 1, 0.4 or, as printed, 0.1 by resolution]
    #[arg(long, value_name = "MM", value_parser = within(0.05, 2.0))]
    fine: Option<f64>,
    /// Friction coefficient between projectile and plate, 0 to 1; none is printed
    #[arg(long, value_name = "MU", default_value_t = 0.0, value_parser = within(0.0, 1.0))]
    friction: f64,
    /// End of a run, µs, 10 to 1000
    #[arg(long, value_name = "US", default_value_t = 160.0, value_parser = within(10.0, 1000.0))]
    end: f64,
    /// ParaView frames a run, 0 to 1000
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    frames: u32,
}

/// Impact speed of the paper, m/s.
pub const SPEED: f64 = 173.7;

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let common = &options.common;
    let folder = common.folder("plug_weldox")?;
    let fine = options.fine.unwrap_or(common.resolution.choose(1.0, 0.4, 0.1));
    let (mut totals, mut rows, mut outcomes) = (Totals::default(), Vec::new(), Vec::new());
    for &constants in &options.constants {
        let setup = Setup {
            constants,
            form: options.form,
            speed: options.speed,
            spacing: 1e-3 * fine,
            friction: options.friction,
            end: 1e-6 * options.end,
            threads: common.threads(),
        };
        let outcome = scene::shoot(&setup, options.frames, &folder, restart)?;
        totals = totals.plus(&outcome.totals);
        rows.extend(checks::of(&outcome));
        outcomes.push(outcome);
    }
    figures::draw(&outcomes, &folder)?;
    let settings = serde_json::json!({
        "impact_speed": options.speed,
        "constants": options.constants.iter().map(|c| c.name()).collect::<Vec<_>>(),
        "form": options.form.name(),
        "method": outcomes.first().map(|o| o.method.clone()),
        "spacing": outcomes.first().map(|o| o.setup.fine()),
        "particles_of_projectile_and_plate": outcomes.first().map(|o| o.particles),
        "friction": options.friction,
        "end": 1e-6 * options.end,
        "core_seconds": outcomes.iter().map(|o| o.totals.wall_seconds).collect::<Vec<_>>(),
        "threads": common.threads(),
    });
    Report::new("plug_weldox", common.resolution, settings, &totals, rows).finish(common, &folder)
}
