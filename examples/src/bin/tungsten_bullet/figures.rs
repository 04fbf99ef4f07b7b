//! Pictures of the shot, and the way of the tip.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Quantity, Series, Stroke, palette,
};

use crate::INTERFACE;
use crate::scene::{BULLET, END, MOMENTS, Outcome, SPEED, TARGET};

/// Draw everything.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    let mut panels = Panels::new(MOMENTS.len()).title("Tungsten bullet on aluminium, 1140 m/s, plane strain");
    for outcome in outcomes {
        for frame in &outcome.frames {
            let speed = Quantity::component("velocity", 0)
                .label("velocity along x")
                .unit("m/s", 1.0)
                .range(0.0, SPEED)
                .map(ColourMap::Viridis);
            let picture = FieldPicture::new(520, 400)
                .colour_by(speed)
                .bounds([-BULLET[0] - 4e-3, -0.2 * TARGET[1]], [TARGET[0] + 14e-3, 0.2 * TARGET[1]])
                .draw(frame)?;
            panels = panels.panel(format!("{}, {:.0} µs", outcome.name, 1e6 * frame.time()), picture);
        }
    }
    panels.compose()?.save(folder.join("bullet.png"))?;

    let mut chart = Chart::new(860, 520)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("depth of the tip").unit("mm", 1e3));
    let dashed = |name: &str, speed: f64| {
        let line = Series::new(name, &[0.0, END], &[0.0, speed * END]);
        line.map(|s| s.stroke(Stroke::Dashed).colour(palette(7)))
    };
    for (name, speed) in [("Tate, 760 m/s", INTERFACE[0]), ("Tate, 880 m/s", INTERFACE[1])] {
        chart = chart.series(dashed(name, speed)?);
    }
    for (n, outcome) in outcomes.iter().enumerate() {
        let t: Vec<f64> = outcome.history.iter().map(|e| e.time).collect();
        let x: Vec<f64> = outcome.history.iter().map(|e| e.tip).collect();
        chart = chart.series(Series::new(outcome.name, &t, &x)?.colour(palette(n)));
    }
    chart.draw()?.save(folder.join("tip.png"))?;
    Ok(())
}
