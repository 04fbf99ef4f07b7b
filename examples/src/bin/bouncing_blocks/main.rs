//! Contact of blocks, bars, discs and balls against exact values: impact of two bars, a wave through a pre-compressed
//! joint, colliding discs (Sulsky 1994), a block on an incline, Hertz contact.

mod bars;
mod discs;
mod figures;
mod hertz;
mod incline;

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, ValueEnum};
use examples::blocks::scene::Asked;
use examples::{CaseError, Check, Common, Detection, Law, Report, Restart, Totals, case};

use serde::Serialize;

/// Blocks, bars, discs and balls in contact against exact values.
#[derive(Debug, Parser)]
#[command(name = "bouncing_blocks", version)]
struct Options {
    #[command(flatten)]
    common: Common,
    /// Scenes to run
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["impact", "wave", "discs", "incline", "hertz"])]
    scene: Vec<Scene>,
    /// How contact is detected [default: as suits each scene]
    #[arg(long, value_enum)]
    detection: Option<Detection>,
    /// What bodies do where they touch [default: as suits each scene]
    #[arg(long, value_enum)]
    law: Option<Law>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Scene {
    /// Two bars hit each other end to end
    Impact,
    /// A wave passes a joint under pressure, and opens one
    Wave,
    /// Two discs of Sulsky 1994
    Discs,
    /// A block on an incline sticks or slides
    Incline,
    /// Balls and cylinders after Hertz
    Hertz,
}

/// Result of a scene.
struct Outcome {
    checks: Vec<Check>,
    totals: Totals,
}

fn main() -> ExitCode {
    case::start_case(run)
}

fn run(options: &Options, restart: &Restart) -> Result<ExitCode, CaseError> {
    let folder = options.common.folder("bouncing_blocks")?;
    let (mut checks, mut totals) = (Vec::new(), Totals::default());
    for &scene in &options.scene {
        let outcome = of(scene, options, &folder, restart)?;
        totals = totals.plus(&outcome.totals);
        checks.extend(outcome.checks);
    }
    let settings =
        serde_json::json!({ "scenes": options.scene, "detection": options.detection, "law": options.law });
    Report::new("bouncing_blocks", options.common.resolution, settings, &totals, checks)
        .finish(&options.common, &folder)
}

fn of(scene: Scene, options: &Options, folder: &Path, restart: &Restart) -> Result<Outcome, CaseError> {
    let resolution = options.common.resolution;
    let asked = Asked { detection: options.detection, law: options.law };
    match scene {
        Scene::Impact => bars::impact(resolution.choose(100, 200, 400), asked, folder, restart),
        Scene::Wave => bars::wave(resolution.choose(100, 200, 400), asked, folder, restart),
        Scene::Discs => {
            let finer: &[u32] = resolution.choose(&[1], &[1, 2, 4], &[1, 2, 4, 8]);
            discs::all(finer, asked, folder, restart)
        }
        Scene::Incline => incline::all(resolution.choose(1, 1, 2), asked, folder, restart),
        Scene::Hertz => {
            let size = |cells, ball, cylinder| hertz::Size { cells, ball, cylinder };
            let size = resolution.choose(size(40, 1e-2, 3e-2), size(64, 3e-3, 1.2e-2), size(128, 1e-3, 4e-3));
            hertz::all(size, asked, options.common.threads(), folder, restart)
        }
    }
}
