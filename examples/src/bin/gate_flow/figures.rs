//! Pictures and charts.

use std::path::Path;

use examples::martin_moyce::{FRONT, WIDTH};
use examples::{CaseError, WATER_PRESSURE, immersed};
use mpm_core::output::History;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::checks::front;
use crate::scene::Outcome;
use crate::setup::{Gate, WALL, WATER};

/// Draw the water at the times of the snapshots, by pressure.
pub fn water(outcome: &Outcome) -> Result<Picture, CaseError> {
    let [width, height] = outcome.setup.size();
    let bounds = match outcome.setup.gate {
        Gate::None => [[0.0, 0.0], [4.5 * width, 1.05 * height]],
        _ => [[0.0, -0.002], [3.0 * WATER[0], 1.02 * WALL]],
    };
    let mut panels = Panels::new(2);
    for snapshot in &outcome.snapshots {
        let pressure = Quantity::scalar(WATER_PRESSURE)
            .label("pressure")
            .unit("kPa", 1e-3)
            .range(0.0, outcome.setup.pressure(0.0))
            .map(ColourMap::Viridis);
        let picture = FieldPicture::new(640, 420)
            .colour_by(pressure)
            .axes("x", "y")
            .bounds(bounds[0], bounds[1])
            .draw(&immersed(snapshot)?)?;
        panels = panels.panel(format!("{:.2} s", snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Plot the displacement of the tip over time, one line per direction.
pub fn tip(outcome: &Outcome) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 460)
        .x(Axis::new("time").unit("s", 1.0))
        .y(Axis::new("way of the tip").unit("mm", 1e3));
    let times: Vec<f64> = outcome.rows.iter().map(|r| r.time).collect();
    for (d, name) in ["across", "up"].into_iter().enumerate() {
        let ways: Vec<f64> = outcome.rows.iter().map(|r| r.tip[d]).collect();
        chart = chart.series(Series::new(name, &times, &ways)?.colour(palette(d)));
    }
    Ok(chart.draw()?)
}

/// Plot the position of the front over time with the experiment, dimensionless as there.
pub fn fronts(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (t, z): (Vec<f64>, Vec<f64>) =
        outcome.fronts.iter().map(|[t, x]| (t / outcome.setup.second(), x / WIDTH)).unzip();
    let (times, places): (Vec<f64>, Vec<f64>) = FRONT.iter().map(|[t, z]| (*t, *z)).unzip();
    let measured = Series::new("experiment, Martin and Moyce 1952", &times, &places)?;
    let run = Series::new(format!("{} cells over the width", outcome.setup.cells), &t, &z)?;
    let chart = Chart::new(860, 460)
        .x(Axis::new("t sqrt(2 g / a)"))
        .y(Axis::new("front x / a"))
        .series(run.colour(palette(0)))
        .series(measured.stroke(Stroke::None).marker(Marker::Circle).colour(palette(1)));
    Ok(chart.draw()?)
}

/// Write the histories of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let name = outcome.setup.name();
    if outcome.setup.gate == Gate::None {
        let columns = [("t sqrt(2 g / a)", "-"), ("front x / a", "-"), ("experiment", "-")];
        let mut file = History::create(folder.join(format!("front_{name}.csv")), columns)?;
        for [time, place] in FRONT {
            file.push(&[time, front(outcome, time), place])?;
        }
        return Ok(());
    }
    let columns = [
        ("time", "s"),
        ("tip across", "m"),
        ("tip up", "m"),
        ("force across", "N/m"),
        ("force up", "N/m"),
        ("water through", "-"),
        ("particles inside", "-"),
        ("deepest centre", "m"),
        ("pressure less that at rest", "Pa"),
        ("change of density", "-"),
    ];
    let mut file = History::create(folder.join(format!("tip_{name}.csv")), columns)?;
    for (r, force) in outcome.rows.iter().zip(&outcome.forces) {
        let ([across, up], [fx, fy], inside) = (r.tip, *force, r.inside as f64);
        file.push(&[r.time, across, up, fx, fy, r.out, inside, r.depth, r.pressure, r.density])?;
    }
    Ok(())
}
