//! Pictures and charts.

use std::f64::consts::PI;

use examples::{CaseError, liquid};
use mpm_core::output::Snapshot;
use mpm_core::output::picture::{
    Axis, Chart, Panels, ParticlePicture, Picture, Quantity, Series, Stroke, palette,
};

use crate::scene::{Outcome, RATE, STRETCH};
use crate::setup::{Setup, Study};
use crate::theory::ellipse;

/// Draw the drop of the snapshots by speed or pressure, with the outline of the reference.
pub fn shapes(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (setup, snapshots) = (&outcome.setup, &outcome.run.snapshots);
    let mut panels = Panels::new(if setup.study == Study::Elliptic { 2 } else { 3 });
    for snapshot in snapshots {
        panels = panels.panel(title(setup, snapshot.time()), one(setup, snapshot)?);
    }
    Ok(panels.compose()?)
}

fn title(setup: &Setup, time: f64) -> String {
    match setup.study {
        Study::Cube => format!("{:.0} ms", 1e3 * time),
        Study::Elliptic => format!("A0 t = {:.2}, line: exact ellipse", RATE * time),
        _ => format!("{:.0} ms, line: circle of the same volume", 1e3 * time),
    }
}

fn one(setup: &Setup, snapshot: &Snapshot) -> Result<Picture, CaseError> {
    let colour = match setup.study {
        Study::Elliptic => {
            Quantity::magnitude("velocity").unit("m/s", 1.0).range(0.0, 1.5 * RATE * setup.size)
        }
        _ => Quantity::scalar("pressure").unit("Pa", 1.0).range(0.0, 1.5 * setup.drop().pressure()),
    };
    if setup.study.dimensions() == 3 {
        let picture = ParticlePicture::new(420, 420).colour_by(colour);
        return Ok(picture.draw(snapshot)?);
    }
    let radius = setup.radius();
    let (axes, bounds) = match setup.study {
        Study::Elliptic => (ellipse(RATE * snapshot.time()).axes.map(|a| a * radius), [3.9, 1.1]),
        _ => ([radius; 2], [1.25, 1.25]),
    };
    let at = |n: usize| {
        let angle = n as f64 * PI / 180.0;
        [axes[0] * angle.cos(), axes[1] * angle.sin()]
    };
    let outline: Vec<[[f64; 2]; 2]> = (0..360).map(|n| [at(n), at(n + 1)]).collect();
    let [x, y] = bounds.map(|b| b * radius);
    liquid(snapshot, colour, [[-x, -y], [x, y]], &outline)
}

/// Plot the stretch over time, one line a grid, with the undamped oscillation of the theory.
pub fn oscillation(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 420)
        .x(Axis::new("time").unit("ms", 1e3))
        .y(Axis::new("stretch less 1").unit("%", 100.0));
    for (n, outcome) in outcomes.iter().enumerate() {
        let stretch: Vec<f64> = outcome.run.values(STRETCH).collect();
        let name = format!("{} cells over R", outcome.setup.cells);
        chart = chart.series(Series::new(name, &outcome.run.times(), &stretch)?.colour(palette(n)));
    }
    if let Some(Outcome { setup, .. }) = outcomes.first() {
        let times: Vec<f64> = (0..=200).map(|n| setup.end * f64::from(n) / 200.0).collect();
        let exact: Vec<f64> =
            times.iter().map(|t| setup.stretch * (2.0 * PI * t / setup.drop().period()).cos()).collect();
        chart = chart
            .series(Series::new("theory, undamped", &times, &exact)?.stroke(Stroke::Dashed).colour([60; 3]));
    }
    Ok(chart.draw()?)
}
