//! Charts of the swing, and a picture of the bent beam.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::checks::LISTED;
use crate::elements;
use crate::scene::{Entry, Outcome, Plane};

/// Draw all charts and pictures.
pub fn draw(outcomes: &[Outcome], elements: &[Entry], folder: &Path) -> Result<(), CaseError> {
    let mut panels = Panels::new(2).title("Cantilever under a shear pulse at its end");
    panels = panels.panel("displacement of the tip", tip(outcomes)?);
    panels = panels
        .panel("stress beside the root, a quarter of the height below the middle", root(outcomes, elements)?);
    panels.compose()?.save(folder.join("swing.png"))?;
    let mut panels = Panels::new(1).title("Stress along the beam when the tip is lowest");
    for outcome in outcomes {
        panels = panels.panel(outcome.setup.joint.name(), bent(outcome)?);
    }
    panels.compose()?.save(folder.join("beam.png"))?;
    Ok(())
}

fn tip(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart =
        Chart::new(760, 480).x(Axis::new("time").unit("s", 1.0)).y(Axis::new("displacement").unit("mm", 1e3));
    for (k, outcome) in outcomes.iter().enumerate() {
        let (t, u): (Vec<f64>, Vec<f64>) = outcome.history.iter().map(|e| (e.time, e.tip)).unzip();
        chart = chart.series(Series::new(outcome.setup.joint.name(), &t, &u)?.colour(palette(k)));
    }
    let paper = |o: &Outcome| o.setup.beam.poisson == 0.3 && o.setup.beam.plane == Plane::Stress;
    if let Some(first) = outcomes.first().filter(|o| paper(o)) {
        let there = LISTED.iter().filter(|(t, _)| *t <= first.setup.end);
        let (t, u): (Vec<f64>, Vec<f64>) = there.map(|&(t, mm)| (t, 1e-3 * mm)).unzip();
        let points = Series::new("elements of second order", &t, &u)?;
        chart = chart.series(points.stroke(Stroke::None).marker(Marker::Circle).colour([20; 3]));
    }
    Ok(chart.draw()?)
}

fn root(outcomes: &[Outcome], elements: &[Entry]) -> Result<Picture, CaseError> {
    let mut chart =
        Chart::new(760, 480).x(Axis::new("time").unit("s", 1.0)).y(Axis::new("stress").unit("Pa", 1.0));
    for (k, outcome) in outcomes.iter().enumerate() {
        let there = outcome.history.iter().filter(|e| e.time <= elements::END);
        let (t, s): (Vec<f64>, Vec<f64>) = there.map(|e| (e.time, e.stress[1])).unzip();
        chart = chart.series(Series::new(outcome.setup.joint.name(), &t, &s)?.colour(palette(k)));
    }
    let (t, s): (Vec<f64>, Vec<f64>) = elements.iter().map(|e| (e.time, e.stress[1])).unzip();
    let finer = Series::new("our finite elements, finer", &t, &s)?;
    Ok(chart.series(finer.stroke(Stroke::Dashed).colour([20; 3])).draw()?)
}

fn bent(outcome: &Outcome) -> Result<Picture, CaseError> {
    let frame = &outcome.frame;
    let along: Vec<f64> = frame.tensor("stress")?.iter().map(|s| s[0]).collect();
    let quantity =
        Quantity::scalar("along").label("stress along the beam").unit("kPa", 1e-3).range(-4e3, 4e3);
    let picture = FieldPicture::new(900, 330).colour_by(quantity.map(ColourMap::CoolWarm));
    Ok(picture.draw(&frame.clone().with_scalar("along", along)?)?)
}
