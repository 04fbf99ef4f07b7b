//! Residual speed over impact speed, normal and oblique, with the estimate by cavity expansion.

use std::path::Path;

use examples::{CaseError, Restart};
use mpm_core::output::History;

use crate::estimate::Estimate;
use crate::scene::{self, Outcome};
use crate::setup::Setup;

/// Impact speeds, m/s: approximately those of the experiments.
const SPEEDS: [f64; 5] = [350.0, 450.0, 575.0, 700.0, 850.0];

/// Result of a shot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Obliquity, rad.
    pub angle: f64,
    /// Impact speed, m/s.
    pub speed: f64,
    /// Residual speed, m/s; 0 if the rod stuck or rebounded.
    pub residual: f64,
    /// Residual speed by cavity expansion, m/s.
    pub estimate: f64,
}

/// Run all impact speeds, at 0 degrees and at the obliquity of `setup`.
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
