//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::History;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::bishop::{Circle, surface};
use crate::scene::Outcome;
use crate::setup::{BASE, CREST, FAR, HEIGHT, TOE};

/// Draw the slope at the times of the snapshots, by plastic strain.
pub fn slope(outcome: &Outcome) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(1);
    for snapshot in &outcome.snapshots {
        let strain = Quantity::scalar("plastic_strain")
            .label("plastic strain")
            .range(0.0, 1.0)
            .map(ColourMap::Inferno);
        let picture = FieldPicture::new(900, 340)
            .colour_by(strain)
            .axes("x", "z")
            .bounds([CREST, BASE], [FAR, 1.1 * HEIGHT])
            .draw(snapshot)?;
        panels = panels.panel(format!("{:.1} s", snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Draw the slip surfaces in the undeformed ground, and the critical circle.
pub fn slips(outcomes: &[Outcome], slips: &[Vec<[f64; 2]>], circle: &Circle) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 520)
        .x(Axis::new("x").unit("m", 1.0).range(0.0, 70.0))
        .y(Axis::new("z").unit("m", 1.0).range(-10.0, 25.0));
    let places: Vec<f64> = (0..=140).map(|n| 0.5 * f64::from(n)).collect();
    let ground: Vec<f64> = places.iter().map(|x| surface(*x)).collect();
    chart = chart.series(Series::new("ground", &places, &ground)?.colour([120; 3]));
    let (x, z): (Vec<f64>, Vec<f64>) =
        places.iter().filter_map(|x| circle.height(*x).map(|z| (*x, z))).unzip();
    let name = "critical circle, Bishop";
    chart = chart.series(Series::new(name, &x, &z)?.stroke(Stroke::Dashed).colour([60; 3]));
    for (n, (outcome, slip)) in outcomes.iter().zip(slips).enumerate() {
        let (x, z): (Vec<f64>, Vec<f64>) = slip.iter().map(|s| (s[0], s[1])).unzip();
        let name = format!("cells of {} m", outcome.setup.spacing);
        if !x.is_empty() {
            chart = chart.series(Series::new(name, &x, &z)?.colour(palette(n)));
        }
    }
    Ok(chart.draw()?)
}

/// Draw the run-out over time, one line per run.
pub fn histories(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 460)
        .x(Axis::new("time").unit("s", 1.0))
        .y(Axis::new("way beyond the toe").unit("m", 1.0));
    for (n, o) in outcomes.iter().enumerate() {
        let (t, x): (Vec<f64>, Vec<f64>) = o.history.iter().map(|h| (h[0], h[2] - TOE)).unzip();
        let name = format!("cells of {} m", o.setup.spacing);
        chart = chart.series(Series::new(name, &t, &x)?.colour(palette(n)));
    }
    Ok(chart.draw()?)
}

/// Write history and slip surface of a run as CSV.
pub fn write(outcome: &Outcome, slip: &[[f64; 2]], folder: &Path) -> Result<(), CaseError> {
    let name = outcome.setup.name();
    let columns = [("time", "s"), ("largest displacement", "m"), ("front", "m")];
    let mut file = History::create(folder.join(format!("history_{name}.csv")), columns)?;
    for row in &outcome.history {
        file.push(row)?;
    }
    let mut file = History::create(folder.join(format!("slip_{name}.csv")), [("x", "m"), ("z", "m")])?;
    for row in slip {
        file.push(row)?;
    }
    Ok(())
}
