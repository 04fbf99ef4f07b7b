//! Pictures and charts.

use examples::series::interpolate;
use examples::{CaseError, WATER_PRESSURE, liquid};
use mpm_core::output::Snapshot;
use mpm_core::output::picture::{Axis, Chart, Panels, Picture, Quantity, Series, Stroke, palette};

use crate::scene::{ACROSS, HEIGHT, Outcome, TURN};
use crate::setup::{EDGE, GRAVITY, Setup, TANK, WATER};
use crate::theory::heave_period;

/// Height of the pictures, m.
const TOP: f64 = 0.8;

/// Centre of the box, m, and sine and cosine of its turn, at a time.
fn pose(outcome: &Outcome, time: f64) -> ([f64; 2], (f64, f64)) {
    let at = |measure: usize| interpolate(outcome.run.series(measure), time * (1.0 - 1e-9));
    ([at(ACROSS), at(HEIGHT)], at(TURN).sin_cos())
}

/// Outline of the box at a time.
fn outline(outcome: &Outcome, time: f64) -> [[[f64; 2]; 2]; 4] {
    let ([x, y], (sin, cos)) = pose(outcome, time);
    let corner = |n: usize| {
        let [a, b] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][n % 4].map(|s: f64| 0.5 * EDGE * s);
        [x + cos * a - sin * b, y + sin * a + cos * b]
    };
    [0, 1, 2, 3].map(|n| [corner(n), corner(n + 1)])
}

/// Pressure of the water, NaN on the box, which is drawn grey.
fn around_the_box(outcome: &Outcome, snapshot: &Snapshot) -> Result<Snapshot, CaseError> {
    let ([x, y], (sin, cos)) = pose(outcome, snapshot.time());
    let inside = |p: &[f64; 3]| {
        let [a, b] = [p[0] - x, p[1] - y];
        (cos * a + sin * b).abs().max((cos * b - sin * a).abs()) < 0.5 * EDGE
    };
    let values = snapshot.positions().iter().zip(snapshot.scalar("pressure")?);
    let values = values.map(|(p, &value)| if inside(p) { f64::NAN } else { value }).collect();
    Ok(snapshot.clone().with_scalar(WATER_PRESSURE, values)?)
}

/// Draw the water of the snapshots by pressure, and the box.
pub fn water(outcome: &Outcome) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2);
    let right = TANK[0];
    let walls = [[0.0, TOP], [0.0, 0.0], [right, 0.0], [right, TOP]];
    for snapshot in &outcome.run.snapshots {
        let mut lines: Vec<_> = walls.windows(2).map(|w| [w[0], w[1]]).collect();
        lines.extend(outline(outcome, snapshot.time()));
        let pressure = Quantity::scalar(WATER_PRESSURE)
            .label("pressure")
            .unit("kPa", 1e-3)
            .range(0.0, WATER * GRAVITY * TANK[1]);
        let picture =
            liquid(&around_the_box(outcome, snapshot)?, pressure, [[0.0; 2], [right, TOP]], &lines)?;
        let title = format!("{} kg/m^3, {:.2} s", outcome.setup.density, snapshot.time());
        panels = panels.panel(title, picture);
    }
    Ok(panels.compose()?)
}

/// Plot the height of boxes over time, over their depth at rest, with the linear theory of the first one.
pub fn heave(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 460)
        .x(Axis::new("time").unit("s", 1.0))
        .y(Axis::new("height of the box above its depth at rest").unit("mm", 1e3));
    for (n, Outcome { setup, run }) in outcomes.iter().enumerate() {
        let rest = setup.level() - setup.draught() + 0.5 * EDGE;
        let heights: Vec<f64> = run.values(HEIGHT).map(|y| y - rest).collect();
        let name = format!("{} kg/m^3, {} cells", setup.density, setup.cells);
        chart = chart.series(Series::new(name, &run.times(), &heights)?.colour(palette(n)));
    }
    if let Some(Outcome { setup, run }) = outcomes.first() {
        chart = chart.series(undamped(setup, &run.times())?);
    }
    Ok(chart.draw()?)
}

/// Heave of the linear theory without the waves that the release makes.
fn undamped(setup: &Setup, times: &[f64]) -> Result<Series, CaseError> {
    let (period, first) = (heave_period(setup, 40), setup.bottom() - (setup.level() - setup.draught()));
    let heights: Vec<f64> =
        times.iter().map(|t| first * (2.0 * std::f64::consts::PI * t / period).cos()).collect();
    Ok(Series::new("period of linear potential flow", times, &heights)?
        .stroke(Stroke::Dashed)
        .colour([60; 3]))
}

/// Plot the turn of boxes over time.
pub fn turn(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 420)
        .x(Axis::new("time").unit("s", 1.0))
        .y(Axis::new("turn").unit("degrees", 180.0 / std::f64::consts::PI));
    for (n, Outcome { setup, run }) in outcomes.iter().enumerate() {
        let turns: Vec<f64> = run.values(TURN).collect();
        chart = chart.series(
            Series::new(format!("{} kg/m^3", setup.density), &run.times(), &turns)?.colour(palette(n)),
        );
    }
    Ok(chart.draw()?)
}
