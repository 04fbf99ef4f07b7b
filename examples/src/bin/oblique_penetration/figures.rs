//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::curve::Point;
use crate::scene::Outcome;
use crate::setup::{ROD, RodFrame, THICKNESS};
use crate::{EXPERIMENT, PAPER};

/// Upper end of the colour range, plastic strain.
const MOST_STRAIN: f64 = 2.0;

/// Draw sections in the plane of symmetry at the times of the snapshots.
pub fn cuts(outcome: &Outcome) -> Result<Picture, CaseError> {
    let (speed, angle) = (outcome.setup.speed, outcome.setup.angle.to_degrees());
    let title = format!("{speed:.0} m/s, {angle:.0} degrees, {} particles", outcome.totals.particles);
    let mut panels = Panels::new(3).title(title);
    for snapshot in &outcome.snapshots {
        panels = panels.panel(format!("{:.0} µs", 1e6 * snapshot.time()), cut(outcome, snapshot)?);
    }
    Ok(panels.compose()?)
}

/// Draw the particles within half a cell of the plane of symmetry.
fn cut(outcome: &Outcome, snapshot: &Snapshot) -> Result<Picture, OutputError> {
    let h = outcome.setup.spacing();
    let strain = snapshot.scalar("plastic_strain")?;
    let (mut places, mut strains, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    let elements = outcome.setup.rod == RodFrame::Fem;
    let all = snapshot.positions().iter().zip(snapshot.bodies()).zip(strain).enumerate();
    for (n, ((&[x, y, z], &body), &strain)) in all {
        // The rod is elastic. Its elements are drawn at their own size.
        let rod = body == 0;
        let size = if rod && elements { snapshot.size_of(n) } else { h / f64::from(outcome.setup.parts) };
        if y < size.max(0.5 * h) {
            places.push([x, z, 0.0]);
            strains.push(if rod { 0.0 } else { strain });
            sizes.push(size);
        }
    }
    let size = ParticleSize::Each(sizes);
    let section =
        Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("strain", strains)?;
    FieldPicture::new(470, 560)
        .colour_by(
            Quantity::scalar("strain")
                .label("plastic strain")
                .range(0.0, MOST_STRAIN)
                .map(ColourMap::Viridis),
        )
        .axes("x", "z")
        .bounds([-0.6 * ROD.length, -THICKNESS - 0.5 * ROD.length], [0.6 * ROD.length, 0.85 * ROD.length])
        .draw(&section)
}

/// Draw the speed of the rod over time, one line per run.
pub fn histories(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 520)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("speed of the rod's centre of mass").unit("m/s", 1.0));
    for (n, outcome) in outcomes.iter().enumerate() {
        let (t, v): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (r.time, r.speed())).unzip();
        let name =
            format!("{} cells through the plate, friction {}", outcome.setup.cells, outcome.setup.friction);
        chart = chart.series(Series::new(name, &t, &v)?.colour(palette(n)));
    }
    let end = outcomes.iter().map(|o| o.last().time).fold(0.0, f64::max);
    let level = |name: &str, v: f64, stroke| -> Result<Series, OutputError> {
        Ok(Series::new(name, &[0.0, end], &[v; 2])?.stroke(stroke).colour([60; 3]))
    };
    if outcomes.iter().any(|o| o.setup.is_the_paper_s()) {
        chart = chart.series(level("experiment", EXPERIMENT, Stroke::Dashed)?).series(level(
            "MPM3Dpp",
            PAPER,
            Stroke::Dotted,
        )?);
    }
    Ok(chart.draw()?)
}

/// Draw the residual speed over the square of the cell size: a straight line for an error of second order.
pub fn convergence(outcomes: &[&Outcome], limit: f64) -> Result<Picture, CaseError> {
    let mut points: Vec<(f64, f64)> =
        outcomes.iter().map(|o| (o.setup.spacing().powi(2), o.last().speed())).collect();
    points.push((0.0, limit));
    let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    let chart = Chart::new(760, 520)
        .x(Axis::new("cell size squared").unit("mm²", 1e6))
        .y(Axis::new("residual speed").unit("m/s", 1.0))
        .series(Series::new("this method, and its limit", &x, &y)?.marker(Marker::Circle))
        .series(Series::new("experiment", &[0.0], &[EXPERIMENT])?.marker(Marker::Square));
    Ok(chart.draw()?)
}

/// Draw the residual speed over impact speed.
pub fn curve(points: &[Point]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(760, 560)
        .x(Axis::new("impact speed").unit("m/s", 1.0))
        .y(Axis::new("residual speed").unit("m/s", 1.0));
    let mut angles: Vec<f64> = points.iter().map(|p| p.angle).collect();
    angles.dedup();
    for (n, angle) in angles.into_iter().enumerate() {
        let of: Vec<&Point> = points.iter().filter(|p| p.angle == angle).collect();
        let column = |f: fn(&Point) -> f64| of.iter().map(|p| f(p)).collect::<Vec<f64>>();
        let (v, found, estimate) = (column(|p| p.speed), column(|p| p.residual), column(|p| p.estimate));
        let degrees = angle.to_degrees();
        let name = format!("{degrees:.0} degrees");
        chart = chart.series(Series::new(name, &v, &found)?.marker(Marker::Circle).colour(palette(n)));
        let name = format!("{degrees:.0} degrees, rigid rod, cavity expansion");
        let line = Series::new(name, &v, &estimate)?.stroke(Stroke::Dashed).colour(palette(n));
        chart = chart.series(line);
    }
    let shot = Series::new("experiment, 30 degrees", &[575.0], &[EXPERIMENT])?;
    Ok(chart.series(shot.marker(Marker::Square)).draw()?)
}

/// Write the history of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("velocity x", "m/s"),
        ("velocity z", "m/s"),
        ("speed", "m/s"),
        ("pitch", "rad"),
        ("tip", "m"),
        ("tail", "m"),
        ("force x", "N"),
        ("force z", "N"),
        ("overlap", "m"),
        ("failed particles", "-"),
    ];
    let mut file = History::create(folder.join(format!("rod_{}.csv", outcome.setup.name())), columns)?;
    for r in &outcome.rows {
        let ([u, w], [fx, fz], failed) = (r.velocity, r.force, r.failed as f64);
        file.push(&[r.time, u, w, r.speed(), r.pitch, r.tip, r.tail, fx, fz, r.overlap, failed])?;
    }
    Ok(())
}
