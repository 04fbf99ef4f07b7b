//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::History;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Picture, Quantity, Series, palette,
};

use crate::scene::Outcome;

/// Draw the column at the times of the snapshots, by plastic strain.
pub fn column(outcome: &Outcome) -> Result<Picture, CaseError> {
    let setup = outcome.setup;
    let far = setup.width() * (1.0 + 2.4 * setup.aspect);
    let mut panels = Panels::new(2);
    for snapshot in &outcome.snapshots {
        let strain = Quantity::scalar("plastic_strain")
            .label("plastic strain")
            .range(0.0, 1.0)
            .map(ColourMap::Viridis);
        let picture = FieldPicture::new(640, 300)
            .colour_by(strain)
            .axes("x", "z")
            .bounds([0.0, 0.0], [far, 1.1 * setup.height])
            .draw(snapshot)?;
        panels = panels.panel(format!("{:.2} s", snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Plot the deposits, one line per run.
pub fn deposits(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 460)
        .x(Axis::new("distance from the wall").unit("mm", 1e3))
        .y(Axis::new("height of the deposit").unit("mm", 1e3));
    for (n, o) in outcomes.iter().enumerate() {
        let far = o.fronts.last().map_or(0.0, |f| f[1]) + o.setup.spacing();
        let columns = (0..o.heap.heights.len()).take_while(|&c| o.heap.middle(c) < far);
        let (x, z): (Vec<f64>, Vec<f64>) = columns.map(|c| (o.heap.middle(c), o.heap.heights[c])).unzip();
        let name = format!("{} cells over the height", o.setup.cells);
        chart = chart.series(Series::new(name, &x, &z)?.colour(palette(n)));
    }
    if let Some(o) = outcomes.first() {
        let (w, h) = (o.setup.width(), o.setup.height);
        let start = Series::new("start", &[0.0, w, w], &[h, h, 0.0])?;
        chart = chart.series(start.stroke(mpm_core::output::picture::Stroke::Dotted).colour([120; 3]));
    }
    Ok(chart.draw()?)
}

/// Plot the run-out over time, one line per run.
pub fn fronts(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 460)
        .x(Axis::new("time").unit("s", 1.0))
        .y(Axis::new("way of the front").unit("mm", 1e3));
    for (n, o) in outcomes.iter().enumerate() {
        let (t, x): (Vec<f64>, Vec<f64>) = o.fronts.iter().map(|f| (f[0], f[1] - o.setup.width())).unzip();
        let name = format!("{} cells over the height", o.setup.cells);
        chart = chart.series(Series::new(name, &t, &x)?.colour(palette(n)));
    }
    Ok(chart.draw()?)
}

/// Write the front over time and the deposit of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let name = outcome.setup.name();
    let mut file =
        History::create(folder.join(format!("front_{name}.csv")), [("time", "s"), ("front", "m")])?;
    for row in &outcome.fronts {
        file.push(row)?;
    }
    let mut file =
        History::create(folder.join(format!("deposit_{name}.csv")), [("distance", "m"), ("height", "m")])?;
    for (n, height) in outcome.heap.heights.iter().enumerate() {
        file.push(&[outcome.heap.middle(n), *height])?;
    }
    Ok(())
}
