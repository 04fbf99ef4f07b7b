//! Pictures and histories.

use std::path::Path;

use examples::{CaseError, cracks as tips};
use mpm_core::output::picture::{Axis, Chart, ColourMap, FieldPicture, Panels, Quantity, Series, palette};

use crate::Run;
use crate::setup::Steel;

/// Draw cracks, shear bands, and speeds of crack tips.
pub fn draw(runs: &[Run], folder: &Path) -> Result<(), CaseError> {
    let (bands, cracks): (Vec<&Run>, Vec<&Run>) =
        runs.iter().partition(|run| run.setup.steel == Steel::Yielding);
    if !cracks.is_empty() {
        plates(&cracks, "Cracks in Kalthoff's plate", folder.join("cracks.png"))?;
        speeds(&cracks, folder)?;
    }
    if !bands.is_empty() {
        plates(&bands, "A crack, and a band of shear in steel that yields", folder.join("modes.png"))?;
    }
    Ok(())
}

/// Draw one panel per run: stress, or plastic strain of a yielding steel, and cracks.
fn plates(runs: &[&Run], title: &str, path: impl AsRef<Path>) -> Result<(), CaseError> {
    let mut panels = Panels::new(runs.len().clamp(2, 4)).title(title);
    for Run { setup, outcome, .. } in runs {
        let stress =
            || Quantity::scalar("von_mises").label("von Mises stress").unit("GPa", 1e-9).range(0.0, 1.5e9);
        let strain = || {
            let most = (2.0 * setup.collapse).min(1.0);
            Quantity::scalar("plastic_strain").label("plastic strain").range(0.0, most).map(ColourMap::Magma)
        };
        let ink = if setup.steel == Steel::Yielding { [255; 3] } else { [0; 3] };
        let quantity = if setup.steel == Steel::Yielding { strain() } else { stress() };
        let picture = FieldPicture::new(560, 520)
            .colour_by(quantity)
            .lines(outcome.lines.iter().copied(), 1.2, ink)
            .draw(&outcome.snapshot)?;
        panels = panels.panel(setup.words(), picture);
    }
    panels.compose()?.save(path)?;
    Ok(())
}

fn speeds(runs: &[&Run], folder: &Path) -> Result<(), CaseError> {
    let mut chart =
        Chart::new(980, 620)
            .x(Axis::new("time").unit("µs", 1e6))
            .y(Axis::new("speed of the tip").unit("m/s", 1.0).range(0.0, 3500.0));
    for (n, Run { setup, outcome, .. }) in runs.iter().enumerate() {
        let (t, v): (Vec<f64>, Vec<f64>) =
            tips::speeds(&outcome.path).into_iter().map(|[t, v]| (t, v)).unzip();
        if !t.is_empty() {
            chart = chart.series(Series::new(setup.words(), &t, &v)?.colour(palette(n)));
        }
    }
    chart.draw()?.save(folder.join("speed.png"))?;
    Ok(())
}
