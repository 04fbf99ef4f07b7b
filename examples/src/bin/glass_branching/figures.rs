//! Pictures and histories.

use std::path::Path;

use examples::{CaseError, cracks as tips};
use mpm_core::output::picture::{Axis, Chart, FieldPicture, Panels, Quantity, Series, Stroke, palette};

use crate::Run;
use crate::setup::RAYLEIGH;

/// Draw cracks; plot speeds of tips and energies.
pub fn draw(runs: &[Run], folder: &Path) -> Result<(), CaseError> {
    let mut panels = Panels::new(2).title("A notched plate of glass under tension");
    let mut speeds = Chart::new(900, 560)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("speed of the tip").unit("m/s", 1.0));
    let mut energies = Chart::new(900, 560)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("energy of cracks").unit("J/m", 1.0));
    let mut last = 0.0;
    for (n, Run { setup, outcome, .. }) in runs.iter().enumerate() {
        let stress = Quantity::scalar("von_mises")
            .label("von Mises stress")
            .unit("MPa", 1e-6)
            .range(0.0, 3.0 * setup.load);
        let picture = FieldPicture::new(720, 400)
            .colour_by(stress)
            .lines(outcome.lines.iter().copied(), 1.2, [255, 255, 255])
            .draw(&outcome.snapshot)?;
        panels = panels.panel(setup.words(), picture);
        let (t, v): (Vec<f64>, Vec<f64>) =
            tips::speeds(&outcome.parted).into_iter().map(|[t, v]| (t, v)).unzip();
        if !t.is_empty() {
            speeds = speeds.series(Series::new(setup.words(), &t, &v)?.colour(palette(n)));
        }
        let (t, d): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|row| (row.time, row.dissipated)).unzip();
        last = t.last().copied().unwrap_or(last);
        energies = energies.series(Series::new(setup.words(), &t, &d)?.colour(palette(n)));
    }
    let cap = Series::new("0.6 c_R", &[0.0, last], &[0.6 * RAYLEIGH; 2])?;
    panels.compose()?.save(folder.join("cracks.png"))?;
    speeds.series(cap.stroke(Stroke::Dashed).colour([60; 3])).draw()?.save(folder.join("speed.png"))?;
    energies.draw()?.save(folder.join("energy.png"))?;
    Ok(())
}
