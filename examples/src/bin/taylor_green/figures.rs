//! Pictures and charts.

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::checks::errors;
use crate::scene::{ERROR, Outcome, Study};
use crate::theory::{couette, poiseuille};

/// Draw the vortices of the snapshots by speed.
pub fn vortices(outcome: &Outcome) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2);
    for snapshot in &outcome.run.snapshots {
        let speed = Quantity::magnitude("velocity").label("speed / U").unit("-", 1.0).range(0.0, 1.0);
        // Particles leave the stagnation points, and the fluid has no surface there: cells fill all gaps.
        let picture = FieldPicture::new(560, 500).colour_by(speed).particle_scale(4.0).axes("x", "y");
        let picture = picture.bounds([0.0; 2], [1.0; 2]).draw(snapshot)?;
        panels = panels.panel(format!("t = {:.2} L / U", snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Plot the speed of the particles over the height of the channel at the times of comparison, with the series.
pub fn profiles(outcome: &Outcome) -> Result<Picture, CaseError> {
    let setup = &outcome.setup;
    let mut chart = Chart::new(640, 560).x(Axis::new("speed over the final one")).y(Axis::new("y / H"));
    for (n, snapshot) in outcome.run.snapshots.iter().enumerate() {
        let (speeds, heights): (Vec<f64>, Vec<f64>) =
            snapshot.vector("velocity")?.iter().zip(snapshot.positions()).map(|(v, x)| (v[0], x[1])).unzip();
        let time = setup.viscosity() * snapshot.time();
        let name = format!("{} cells, nu t / H^2 = {time:.2}", setup.cells);
        let found = Series::new(name, &speeds, &heights)?
            .stroke(Stroke::None)
            .marker(Marker::Circle)
            .colour(palette(n));
        let y: Vec<f64> = (0..=100).map(|n| f64::from(n) / 100.0).collect();
        let exact =
            |y: &f64| if setup.study == Study::Couette { couette(*y, time) } else { poiseuille(*y, time) };
        let exact: Vec<f64> = y.iter().map(exact).collect();
        let theory = Series::new(if n == 0 { "series" } else { "" }, &exact, &y)?.colour([60; 3]);
        chart = chart.series(theory).series(found);
    }
    Ok(chart.draw()?)
}

/// Plot the errors at the end over the cells, one line a flow, with a slope of second order.
pub fn orders(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(640, 520)
        .x(Axis::new("cell over L or H").logarithmic())
        .y(Axis::new("root-mean-square error of the velocity").logarithmic());
    for (n, grids) in outcomes.chunk_by(|a, b| a.setup.study == b.setup.study).enumerate() {
        let (h, e): (Vec<f64>, Vec<f64>) =
            errors(grids, |o| o.run.last()[ERROR]).into_iter().map(|[h, e]| (h, e)).unzip();
        let (Some(&from), Some(&to), Some(&error)) = (h.last(), h.first(), e.last()) else { continue };
        chart = chart.series(
            Series::new(grids[0].setup.study.name(), &h, &e)?.marker(Marker::Circle).colour(palette(n)),
        );
        if n == 0 {
            chart = chart.series(
                Series::slope("second order", 2.0, (from, 0.5 * error), (from, to))
                    .colour([60; 3])
                    .stroke(Stroke::Dashed),
            );
        }
    }
    Ok(chart.draw()?)
}
