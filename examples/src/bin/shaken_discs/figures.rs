//! Pictures and charts.

use examples::CaseError;
use mpm_core::output::picture::{Axis, Chart, FieldPicture, Panels, Picture, Quantity, Series, palette};
use mpm_core::output::{ParticleSize, Snapshot};

use crate::layout::RADIUS;
use crate::scene::{Outcome, is_large};

/// Draw the pile at several times: large discs in one colour, small ones in shades by initial height.
pub fn pile(outcome: &Outcome) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(outcome.snapshots.len().max(1));
    let layout = &outcome.layout;
    let top = layout.discs.iter().map(|d| d.centre[1]).fold(0.0, f64::max);
    // Colour classes: container, large discs, and small discs in four layers.
    let kind = |body: u32| match body.checked_sub(1).and_then(|n| layout.discs.get(n as usize)) {
        None => 0.0,
        Some(disc) if is_large(disc.radius) => 5.0,
        Some(disc) => 1.0 + (4.0 * disc.centre[1] / top).floor().min(3.0),
    };
    let [width, height] = layout.inside;
    for snapshot in &outcome.snapshots {
        let kinds: Vec<f64> = snapshot.bodies().iter().map(|&b| kind(b)).collect();
        let size = ParticleSize::Uniform(0.5 * outcome.setup.spacing());
        let places = snapshot.positions().to_vec();
        let coloured =
            Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("kind", kinds)?;
        let picture = FieldPicture::new(360, 520)
            .colour_by(Quantity::scalar("kind").label("layer of the start; 5: large").range(0.0, 5.0))
            .bounds([-RADIUS, -RADIUS], [width + RADIUS, height + RADIUS])
            .draw(&coloured)?;
        panels = panels.panel(format!("{:.1} s", snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Draw heights, overlap and energy over time.
pub fn histories(outcome: &Outcome) -> Result<Picture, CaseError> {
    let rows = &outcome.rows;
    let t: Vec<f64> = rows.iter().map(|r| r.time).collect();
    let chart = |name: &str, unit: &str, factor: f64| {
        Chart::new(560, 460).x(Axis::new("time").unit("s", 1.0)).y(Axis::new(name).unit(unit, factor))
    };
    let column = |of: &dyn Fn(&crate::watch::Row) -> f64| rows.iter().map(of).collect::<Vec<f64>>();
    let height = chart("mean height", "mm", 1e3)
        .series(Series::new("large discs", &t, &column(&|r| r.heights[0]))?.colour(palette(1)))
        .series(Series::new("small discs", &t, &column(&|r| r.heights[1]))?.colour(palette(0)));
    let h = outcome.setup.spacing();
    let overlap = chart("deepest overlap", "cells", 1.0 / h).series(Series::new(
        "of surfaces",
        &t,
        &column(&|r| r.overlap),
    )?);
    let energy =
        chart("kinetic energy", "J/m", 1.0).series(Series::new("all discs", &t, &column(&|r| r.kinetic))?);
    Ok(Panels::new(3)
        .panel("", height.draw()?)
        .panel("", overlap.draw()?)
        .panel("", energy.draw()?)
        .compose()?)
}
