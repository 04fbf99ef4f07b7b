//! Residual speed over impact speed, straight and oblique, beside the estimate.

use std::path::Path;

use examples::{CaseError, Restart};
use mpm_core::output::History;

use crate::estimate::Estimate;
use crate::scene::{self, Outcome};
use crate::setup::Setup;

/// Impact speeds, m/s: about those of the experiments.
const SPEEDS: [f64; 5] = [350.0, 450.0, 575.0, 700.0, 850.0];

/// One shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Radians.
    pub angle: f64,
    /// Of impact, m/s.
    pub speed: f64,
    /// Behind the plate, m/s; 0 where the rod stayed or came back.
    pub residual: f64,
    /// The same by cavity expansion.
    pub estimate: f64,
}

/// Shoot at all speeds, at 0 degrees and at that of `setup`.
pub fn shoot(
    setup: &Setup,
    folder: &Path,
    restart: &Restart,
) -> Result<(Vec<Point>, Vec<Outcome>), CaseError> {
    let mut angles = vec![0.0, setup.angle];
    angles.dedup();
    let (mut points, mut outcomes) = (Vec::new(), Vec::new());
    for angle in angles {
        for speed in SPEEDS {
            let setup = Setup { angle, speed, ..*setup };
            let outcome = scene::shoot(&setup, &[], None, restart)?;
            let residual = outcome.residual();
            points.push(Point { angle, speed, residual, estimate: Estimate::of(&setup)?.residual(speed) });
            outcomes.push(outcome);
        }
    }
    let columns = [("angle", "rad"), ("impact speed", "m/s"), ("residual speed", "m/s"), ("estimate", "m/s")];
    let mut file = History::create(folder.join("curve.csv"), columns)?;
    for p in &points {
        file.push(&[p.angle, p.speed, p.residual, p.estimate])?;
    }
    Ok((points, outcomes))
}
