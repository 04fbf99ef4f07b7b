//! Pictures of the shot, and position of the tip over time.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::estimate;
use crate::scene::{BULLET, END, MOMENTS, Outcome, SPEED, Space, TARGET};

/// Draw all results.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    for space in [Space::PlaneStrain, Space::Axisymmetric] {
        let of: Vec<_> = outcomes.iter().filter(|o| o.space == space).collect();
        if !of.is_empty() {
            section(&of, space)?.save(folder.join(format!("bullet_{}.png", space.name())))?;
        }
    }
    let mut chart = Chart::new(860, 520)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("depth of the tip").unit("mm", 1e3));
    for (space, grey) in [(Space::PlaneStrain, 60), (Space::Axisymmetric, 160)] {
        if outcomes.iter().any(|o| o.space == space) {
            for speed in estimate::interface(space) {
                let name = format!("Tate, {}, {speed:.0} m/s", space.name());
                let line = Series::new(name, &[0.0, END], &[0.0, speed * END])?;
                chart = chart.series(line.stroke(Stroke::Dashed).colour([grey; 3]));
            }
        }
    }
    for (n, outcome) in outcomes.iter().enumerate() {
        let t: Vec<f64> = outcome.history.iter().map(|e| e.time).collect();
        let x: Vec<f64> = outcome.history.iter().map(|e| e.tip).collect();
        chart = chart.series(Series::new(outcome.name(), &t, &x)?.colour(palette(n)));
    }
    chart.draw()?.save(folder.join("tip.png"))?;
    Ok(())
}

/// Draw sections through bullet and target at three times.
fn section(outcomes: &[&Outcome], space: Space) -> Result<Picture, CaseError> {
    let (from, to) = (-BULLET[0] - 4e-3, TARGET[0] + 14e-3);
    let across = 0.2 * TARGET[1];
    let (size, low, high, title) = match space {
        Space::PlaneStrain => ((520, 400), [from, -across], [to, across], "plane strain"),
        Space::Axisymmetric => ((300, 520), [0.0, from], [across, to], "round, half of the section"),
    };
    let mut panels =
        Panels::new(MOMENTS.len()).title(format!("Tungsten bullet on aluminium, 1140 m/s, {title}"));
    for outcome in outcomes {
        for frame in &outcome.frames {
            let speed = Quantity::component("velocity", space.axis())
                .label("velocity along the flight")
                .unit("m/s", 1.0)
                .range(0.0, SPEED)
                .map(ColourMap::Viridis);
            let picture = FieldPicture::new(size.0, size.1).colour_by(speed).bounds(low, high).draw(frame)?;
            panels = panels.panel(format!("{}, {:.0} µs", outcome.method, 1e6 * frame.time()), picture);
        }
    }
    Ok(panels.compose()?)
}
