//! Pictures and charts.

use examples::{CaseError, liquid};
use mpm_core::output::picture::{Axis, Chart, Panels, Picture, Quantity, Series, Stroke, palette};

use crate::scene::{CENTRE, MODE, Outcome};
use crate::setup::{DENSITY, GRAVITY, SWAY, Study};
use crate::theory::{Mode, shift};

/// Draw the liquid of the snapshots by pressure.
pub fn surface(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (setup, mut panels) = (&outcome.setup, Panels::new(2));
    let (right, top) = (setup.length, 1.6 * setup.depth);
    let walls = [[0.0, top], [0.0, 0.0], [right, 0.0], [right, top]];
    let walls: Vec<_> = walls.windows(2).map(|w| [w[0], w[1]]).collect();
    for snapshot in &outcome.run.snapshots {
        let pressure =
            Quantity::scalar("pressure").unit("kPa", 1e-3).range(0.0, 1.2 * DENSITY * GRAVITY * setup.depth);
        let picture = liquid(snapshot, pressure, [[0.0; 2], [right, top]], &walls)?;
        panels = panels.panel(format!("{:.2} s", snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Plot the amplitude of a wave, or the shift of the centre of mass, over time with theory.
pub fn history(outcome: &Outcome) -> Result<Picture, CaseError> {
    let setup = &outcome.setup;
    let (mode, times) = (Mode::new(setup.mode, setup), outcome.run.times());
    let (label, found): (&str, Vec<f64>) = match setup.study {
        Study::Wave | Study::Decay => ("amplitude of the mode", outcome.run.values(MODE).collect()),
        _ => (
            "shift of the centre of mass",
            outcome.run.values(CENTRE).map(|x| x - 0.5 * setup.length).collect(),
        ),
    };
    let exact = |t: f64| match setup.study {
        Study::Wave => setup.amplitude * (mode.frequency() * t).cos(),
        Study::Decay => {
            setup.amplitude
                * (-mode.decay(setup.viscosity, setup.depth) * t).exp()
                * (mode.frequency() * t).cos()
        }
        _ => SWAY[0] * shift(setup, SWAY[1] * mode.frequency(), t),
    };
    let mut chart =
        Chart::new(860, 420).x(Axis::new("time").unit("s", 1.0)).y(Axis::new(label).unit("mm", 1e3)).series(
            Series::new(format!("{} cells over the length", setup.cells), &times, &found)?.colour(palette(0)),
        );
    if setup.study != Study::Long {
        let exact: Vec<f64> = times.iter().map(|t| exact(*t)).collect();
        chart = chart
            .series(Series::new("linear theory", &times, &exact)?.stroke(Stroke::Dashed).colour(palette(1)));
    }
    Ok(chart.draw()?)
}
