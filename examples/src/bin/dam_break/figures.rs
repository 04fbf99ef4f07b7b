//! Pictures and charts.

use examples::martin_moyce::FRONT as EXPERIMENT;
use examples::{CaseError, liquid};
use mpm_core::output::picture::{Axis, Chart, Marker, Panels, Picture, Quantity, Series, Stroke, palette};

use crate::checks::{clock_shift, fronts, smoothed};
use crate::scene::Outcome;
use crate::setup::Study;
use crate::theory::{WALL, depth};

/// Draw the water of the snapshots by pressure.
pub fn water(outcomes: &[&Outcome], columns: usize) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(columns);
    for Outcome { setup, run } in outcomes {
        let ([left, right], [_, [_, top]]) = (setup.tank(), setup.window());
        let walls = [[left, top], [left, 0.0], [right, 0.0], [right, top]];
        let walls: Vec<_> = walls.windows(2).map(|w| [w[0], w[1]]).collect();
        for snapshot in &run.snapshots {
            let pressure = Quantity::scalar("pressure").unit("kPa", 1e-3).range(0.0, setup.pressure());
            let title = match setup.study {
                Study::Release => format!("pressure at the release, a = {} H", setup.aspect),
                _ => format!(
                    "{:.2} s, t = {:.2} sqrt(H / g)",
                    snapshot.time(),
                    snapshot.time() / setup.second()
                ),
            };
            panels = panels.panel(title, liquid(snapshot, pressure, setup.window(), &walls)?);
        }
    }
    Ok(panels.compose()?)
}

/// Plot the depth at the end over x / (c t), with shallow flow.
pub fn profile(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (setup, heap) = (&outcome.setup, outcome.heap());
    let place = |n: usize| (heap.middle(n) / setup.height - setup.aspect) / setup.end;
    let (x, h): (Vec<f64>, Vec<f64>) = (0..heap.heights.len())
        .map(|n| (place(n), heap.heights[n] / setup.height))
        .filter(|(x, _)| *x < 2.2)
        .unzip();
    let exact: Vec<f64> = x.iter().map(|x| depth(*x)).collect();
    let run = Series::new(format!("{} cells over H", setup.cells), &x, &h)?.colour(palette(0));
    let theory = Series::new("shallow flow, Ritter", &x, &exact)?.stroke(Stroke::Dashed).colour([60; 3]);
    Ok(Chart::new(860, 460)
        .x(Axis::new("x / (t sqrt(g H))"))
        .y(Axis::new("depth h / H"))
        .series(run)
        .series(theory)
        .draw()?)
}

/// Plot the front of a column over time with the experiment, as published and with its clock shifted.
pub fn front(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (t, x): (Vec<f64>, Vec<f64>) = fronts(outcome).into_iter().map(|[t, x]| (t, x)).unzip();
    let shift = clock_shift(outcome);
    let measured = |name: String, by: f64, marker, colour| -> Result<Series, CaseError> {
        let (t, x): (Vec<f64>, Vec<f64>) = EXPERIMENT.iter().map(|[t, x]| (t - by, *x)).unzip();
        Ok(Series::new(name, &t, &x)?.stroke(Stroke::None).marker(marker).colour(colour))
    };
    let run = Series::new(format!("{} cells over the height", outcome.setup.cells), &t, &x)?;
    let chart = Chart::new(860, 460)
        .x(Axis::new("t sqrt(2 g / a)"))
        .y(Axis::new("front x / a"))
        .series(run.colour(palette(0)))
        .series(measured("experiment, Martin and Moyce 1952".into(), 0.0, Marker::Circle, palette(6))?)
        .series(measured(format!("the same, {shift:.2} earlier"), shift, Marker::Square, palette(1))?);
    Ok(chart.draw()?)
}

/// Plot the pressure at the far wall over time with the experiment.
pub fn wall(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (t, p): (Vec<f64>, Vec<f64>) = smoothed(outcome).into_iter().map(|[t, p]| (t, p)).unzip();
    let (times, pressures): (Vec<f64>, Vec<f64>) = WALL.iter().map(|[t, p]| (*t, *p)).unzip();
    let measured = Series::new("experiment, Buchner 2002", &times, &pressures)?;
    let run = Series::new(format!("{} cells over H, means over 0.1", outcome.setup.cells), &t, &p)?;
    let chart = Chart::new(860, 460)
        .x(Axis::new("t sqrt(g / H)").range(1.5, outcome.setup.end))
        .y(Axis::new("pressure at the far wall / (rho g H)").range(-0.5, 2.0))
        .series(run.colour(palette(0)))
        .series(measured.stroke(Stroke::None).marker(Marker::Circle).colour(palette(1)));
    Ok(chart.draw()?)
}
