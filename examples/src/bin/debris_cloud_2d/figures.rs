//! Pictures of the cloud.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{ColourMap, FieldPicture, Panels, Quantity};

use crate::scene::{Outcome, PLATE, SPEED};

/// Draw the frames side by side.
pub fn draw(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let title = format!(
        "Aluminium disc of 2 mm at 5 km/s on a plate of 1 mm, plane strain, {} particles",
        outcome.totals.particles
    );
    let mut panels = Panels::new(3).title(title);
    for frame in outcome.frames.iter().skip(1) {
        let speed = Quantity::component("velocity", 0)
            .label("velocity along x")
            .unit("km/s", 1e-3)
            .range(0.0, SPEED)
            .map(ColourMap::Viridis);
        let picture = FieldPicture::new(520, 560)
            .colour_by(speed)
            .bounds([-3.0 * PLATE[0], -0.55 * PLATE[1]], [13.0 * PLATE[0], 0.55 * PLATE[1]])
            .draw(frame)?;
        panels = panels.panel(format!("{:.2} µs", 1e6 * frame.time()), picture);
    }
    panels.compose()?.save(folder.join("cloud.png"))?;
    Ok(())
}
