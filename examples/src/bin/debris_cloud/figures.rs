//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::plane::{self, Row as Plane};
use crate::scene::Outcome;
use crate::setup::{RADIUS, SPEED, THICKNESS};

/// Draw a wedge along the axis at the times of the snapshots.
pub fn cuts(outcome: &Outcome) -> Result<Picture, CaseError> {
    let title = format!(
        "Lead sphere at 6.58 km/s on a lead plate, a quarter: {} particles",
        outcome.totals.particles
    );
    let mut panels = Panels::new(2).title(title);
    for snapshot in &outcome.snapshots {
        panels = panels.panel(format!("{:.0} µs", 1e6 * snapshot.time()), cut(outcome, snapshot)?);
    }
    Ok(panels.compose()?)
}

/// Draw the particles within 15 degrees of the plane z = 0, rotated about the axis into it: the cloud is one of revolution.
fn cut(outcome: &Outcome, snapshot: &Snapshot) -> Result<Picture, OutputError> {
    let half = 0.5 * outcome.setup.spacing();
    let velocity = snapshot.vector("velocity")?;
    let (mut places, mut speeds) = (Vec::new(), Vec::new());
    for (&[x, y, z], v) in snapshot.positions().iter().zip(velocity) {
        if z < half.max(15f64.to_radians().tan() * y) {
            places.push([x, y.hypot(z), 0.0]);
            speeds.push(v[0]);
        }
    }
    let size = ParticleSize::Uniform(outcome.setup.edge());
    let flat =
        Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("speed", speeds)?;
    let speed = Quantity::scalar("speed")
        .label("velocity along x")
        .unit("km/s", 1e-3)
        .range(0.0, SPEED)
        .map(ColourMap::Viridis);
    FieldPicture::new(640, 440)
        .colour_by(speed)
        .mirrored([Mirror::y(0.0)])
        .bounds([-6.0 * RADIUS, -11.0 * RADIUS], [32.0 * THICKNESS, 11.0 * RADIUS])
        .draw(&flat)
}

/// Plot the front of the cloud over time, with its bound.
pub fn front(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(820, 540)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("distance behind the front face").unit("mm", 1e3));
    let mut end = 0.0f64;
    for (n, outcome) in outcomes.iter().enumerate() {
        let (t, x): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (r.time, r.front)).unzip();
        let (_, y): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (r.time, 2.0 * r.radius)).unzip();
        let what = if outcome.setup.cutting.is_some() { "split" } else { "not split" };
        let colour = palette(n);
        chart = chart
            .series(Series::new(format!("front, {what}"), &t, &x)?.colour(colour))
            .series(Series::new(format!("width, {what}"), &t, &y)?.colour(colour).stroke(Stroke::Dotted));
        end = end.max(outcome.last().time);
    }
    let out = THICKNESS / plane::shocked().front;
    let bound = [THICKNESS, THICKNESS + plane::free_surface() * (end - out)];
    let line = Series::new("front, free surface of a plane shock", &[out, end], &bound)?;
    Ok(chart.series(line.stroke(Stroke::Dashed).colour([60; 3])).draw()?)
}

/// Plot the pressure along the row of the plane impact.
pub fn profile(row: &Plane) -> Result<Picture, CaseError> {
    let (x, p): (Vec<f64>, Vec<f64>) = row.profile.iter().map(|p| (p[0], p[1])).unzip();
    let plane = plane::shocked();
    let exact = [plane.particle / plane.front, 1.0, 1.0, 1.05];
    Ok(Chart::new(760, 480)
        .x(Axis::new("place over the way of the front"))
        .y(Axis::new("pressure over that of the Hugoniot"))
        .series(Series::new("row of cells as in the cloud", &x, &p)?.colour(palette(0)))
        .series(Series::new("exact", &exact, &[1.0, 1.0, 0.0, 0.0])?.stroke(Stroke::Dashed).colour([60; 3]))
        .draw()?)
}

/// Write the history of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("front", "m"),
        ("radius", "m"),
        ("back", "m"),
        ("mass behind the plate", "kg"),
        ("momentum behind the plate", "kg m/s"),
        ("radius of the hole", "m"),
        ("pressure at the gauge", "Pa"),
        ("particles", "-"),
    ];
    let mut file = History::create(folder.join(format!("cloud_{}.csv", outcome.setup.name())), columns)?;
    for r in &outcome.rows {
        let particles = r.particles as f64;
        file.push(&[r.time, r.front, r.radius, r.back, r.mass, r.momentum, r.hole, r.pressure, particles])?;
    }
    Ok(())
}
