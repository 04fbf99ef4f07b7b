//! Pictures and charts.

use std::path::Path;

use examples::{CaseError, Outline, WATER_PRESSURE, immersed};
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, Snapshot};

use crate::scene::Outcome;
use crate::setup::{HALF, Method};
use crate::theory::{SIMILARITY, von_karman, wagner};

/// Snapshot with the pressure of the water, which is NaN on the wedge.
fn drawn(outcome: &Outcome) -> Result<Snapshot, CaseError> {
    let (setup, snapshot) = (&outcome.setup, &outcome.snapshot);
    if setup.method == Method::Mpm {
        return Ok(immersed(snapshot)?);
    }
    let wedge = Outline::polygon(&setup.corners(setup.speed * snapshot.time()));
    let values = snapshot.positions().iter().zip(snapshot.scalar("pressure")?);
    let inside = |x: &[f64; 3]| wedge.depth([x[0], x[1]], HALF) > 0.0;
    let values = values.map(|(x, &value)| if inside(x) { f64::NAN } else { value }).collect();
    Ok(snapshot.clone().with_scalar(WATER_PRESSURE, values)?)
}

/// Draw the water beside the wedges at the end, by pressure.
pub fn pressure(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2);
    for outcome in outcomes {
        let setup = &outcome.setup;
        let most = SIMILARITY[1] * setup.stagnation();
        let pressure = Quantity::scalar(WATER_PRESSURE)
            .label("pressure")
            .unit("kPa", 1e-3)
            .range(0.0, most)
            .map(ColourMap::Viridis);
        let sunk = setup.speed * setup.end();
        let picture = FieldPicture::new(640, 420)
            .colour_by(pressure)
            .axes("x", "y")
            .bounds([0.0, -sunk - 0.35 * HALF], [1.2 * HALF, setup.height() - sunk + 0.05 * HALF])
            .draw(&drawn(outcome)?)?;
        let name = format!("{}: {} particles inside", setup.name().replace('_', ", "), outcome.inside());
        panels = panels.panel(name, picture);
    }
    Ok(panels.compose()?)
}

/// Draw the force over rho V^3 t over time, one line per run, with theory.
pub fn forces(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 520)
        .x(Axis::new("time").unit("ms", 1e3))
        .y(Axis::new("F / (rho V^3 t)").range(0.0, 40.0));
    for (n, outcome) in outcomes.iter().enumerate() {
        let (t, f): (Vec<f64>, Vec<f64>) = outcome.factors().into_iter().map(|[t, f]| (t, f)).unzip();
        let name = outcome.setup.label();
        chart = chart.series(Series::new(name, &t, &f)?.colour(palette(n)));
    }
    if let Some(Outcome { setup, .. }) = outcomes.first() {
        let level = |name: &str, f: f64, stroke| -> Result<Series, CaseError> {
            Ok(Series::new(name, &[0.0, setup.end()], &[f; 2])?.stroke(stroke).colour([60; 3]))
        };
        chart = chart.series(level("Wagner", wagner(setup), Stroke::Dashed)?).series(level(
            "von Karman",
            von_karman(setup),
            Stroke::Dotted,
        )?);
    }
    Ok(chart.draw()?)
}

/// Draw the mean pressure along the wedge over the similarity variable, one line per run.
pub fn profiles(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 520).x(Axis::new("x / (V t)")).y(Axis::new("pressure / (rho V^2 / 2)"));
    for (n, outcome) in outcomes.iter().enumerate() {
        let (x, p): (Vec<f64>, Vec<f64>) = outcome.pressures.iter().map(|[x, p]| (*x, *p)).unzip();
        let name = outcome.setup.label();
        chart = chart.series(Series::new(name, &x, &p)?.colour(palette(n)));
    }
    Ok(chart.draw()?)
}

/// Write the history of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("impulse up", "N s/m"),
        ("force up", "N/m"),
        ("particles inside", "-"),
        ("deepest centre", "m"),
        ("keel bent up", "m"),
    ];
    let mut file = History::create(folder.join(format!("force_{}.csv", outcome.setup.name())), columns)?;
    let mut before = outcome.rows.first().copied().unwrap_or_default();
    for r in &outcome.rows {
        let span = r.time - before.time;
        let force = if span > 0.0 { (r.impulse - before.impulse) / span } else { 0.0 };
        file.push(&[r.time, r.impulse, force, r.inside as f64, r.depth, r.bend])?;
        before = *r;
    }
    Ok(())
}
