//! Pictures and charts.

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{OutputError, ParticleSize, Snapshot};

use crate::scene::{ALUMINIUM, Outcome, SPACING, Setup};

/// Draw the descending stress wave in the middle section of a layer of balls.
pub fn waves(setup: &Setup, outcome: &Outcome) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(3).title("Vertical stress over the load on the plate");
    for snapshot in &outcome.snapshots {
        panels = panels.panel(format!("{:.1} µs", 1e6 * snapshot.time()), section(setup, snapshot)?);
    }
    Ok(panels.compose()?)
}

fn section(setup: &Setup, snapshot: &Snapshot) -> Result<Picture, OutputError> {
    let middle = (f64::from(setup.balls / 2) + 0.5) * ALUMINIUM.diameter;
    let (mut places, mut stresses) = (Vec::new(), Vec::new());
    for (&[x, y, z], stress) in snapshot.positions().iter().zip(snapshot.tensor("stress")?) {
        // Single layer of particles behind the middle.
        if y >= middle && y < middle + 0.5 * SPACING {
            places.push([x, z, 0.0]);
            stresses.push(-stress[2] / setup.pressure);
        }
    }
    let size = ParticleSize::Uniform(0.5 * SPACING);
    let cut =
        Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("stress", stresses)?;
    FieldPicture::new(440, 440)
        .colour_by(Quantity::scalar("stress").label("-σ_zz / p").range(0.0, 8.0).map(ColourMap::Viridis))
        .axes("x", "z")
        .draw(&cut)
}

/// Draw the reaction of the ground beside that of a chain of Hertz contacts.
pub fn reaction(outcome: &Outcome, chain: &[[f64; 2]]) -> Result<Picture, CaseError> {
    let split = |rows: &[[f64; 2]]| -> (Vec<f64>, Vec<f64>) { rows.iter().map(|r| (r[0], r[1])).unzip() };
    let (time, ratio) = split(&outcome.reaction);
    let (chain_time, chain_ratio) = split(chain);
    let now = Series::new("reaction of the ground", &time, &ratio)?.colour(palette(0));
    let then = Series::new("chain of Hertz contacts", &chain_time, &chain_ratio)?;
    let chart = Chart::new(860, 520)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("force over load"))
        .series(now)
        .series(then.stroke(Stroke::Dashed).colour([90; 3]));
    Ok(chart.draw()?)
}
