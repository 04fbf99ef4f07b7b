//! Charts of the bar.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::OutputError;
use mpm_core::output::picture::{Axis, Chart, Panels, Series, Stroke, palette};

use crate::due;
use crate::scene::{END, Entry, Outcome, SPEED};

/// Draw all charts.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    Panels::new(2)
        .title("Elastic bar on a rigid wall, 50 m/s")
        .panel("velocity at half the length", velocity(outcomes)?.draw()?)
        .panel(
            format!("energy, {}", outcomes.last().map_or("", |o| o.setup.which.name())),
            energy(outcomes)?.draw()?,
        )
        .compose()?
        .save(folder.join("bar.png"))?;
    Ok(())
}

fn velocity(outcomes: &[Outcome]) -> Result<Chart, OutputError> {
    let [stop, back] = due();
    let (t, v) = ([0.0, stop, stop, back, back, END], [SPEED, SPEED, 0.0, 0.0, -SPEED, -SPEED]);
    let exact = Series::new("exact, plane strain", &t, &v)?;
    let mut chart = Chart::new(760, 520)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("velocity towards the wall").unit("m/s", 1.0))
        .series(exact.stroke(Stroke::Dashed).colour([20; 3]));
    for (i, outcome) in outcomes.iter().enumerate() {
        let t: Vec<f64> = outcome.history.iter().map(|e| e.time).collect();
        let v: Vec<f64> = outcome.history.iter().map(|e| e.middle).collect();
        chart = chart.series(Series::new(outcome.setup.which.name(), &t, &v)?.colour(palette(i)));
    }
    Ok(chart)
}

fn energy(outcomes: &[Outcome]) -> Result<Chart, OutputError> {
    let mut chart =
        Chart::new(760, 520).x(Axis::new("time").unit("µs", 1e6)).y(Axis::new("energy over that at impact"));
    let Some(outcome) = outcomes.last() else { return Ok(chart) };
    let t: Vec<f64> = outcome.history.iter().map(|e| e.time).collect();
    let of = |f: fn(&Entry) -> f64| outcome.history.iter().map(f).collect::<Vec<f64>>();
    let curves = [
        ("kinetic", of(|e| e.kinetic)),
        ("internal", of(|e| e.internal)),
        ("sum", of(|e| e.kinetic + e.internal)),
    ];
    for (c, (name, y)) in curves.iter().enumerate() {
        chart = chart.series(Series::new(*name, &t, y)?.colour(palette(c)));
    }
    Ok(chart)
}
