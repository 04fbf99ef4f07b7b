//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, ParticleSize, Snapshot};

use crate::breaking;
use crate::scene::Outcome;
use crate::setup::Means;
use crate::theory;

/// Plot the radius over time, and the theoretical one at rest.
pub fn radius(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 540)
        .title("Rings that are thrown outwards")
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("radius").unit("mm", 1e3));
    for (n, outcome) in outcomes.iter().enumerate() {
        let (metal, means) = (&outcome.setup.metal, outcome.setup.means);
        let (t, r): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (r.time, r.radius)).unzip();
        let stroke = if means == Means::Mpm { Stroke::Solid } else { Stroke::Dashed };
        let name = format!("{}, {}", metal.name, means.name());
        // Both curves coincide.
        let colour = if means == Means::Mpm { palette(n) } else { [20; 3] };
        chart = chart.series(Series::new(name, &t, &r)?.colour(colour).stroke(stroke));
        if means == Means::Mpm || outcomes.len() == 1 {
            let limit = theory::rigid(metal, outcome.setup.radius);
            let line = Series::new(format!("{}, at rest [C]", metal.name), &[limit.time], &[limit.radius])?;
            chart = chart.series(line.marker(Marker::Circle).colour([60; 3]));
        }
    }
    Ok(chart.draw()?)
}

/// Plot the error of the radius at rest over the thickness.
pub fn convergence(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(760, 520)
        .title("Radius at rest off that of the elastic thin ring")
        .x(Axis::new("thickness over radius").logarithmic())
        .y(Axis::new("error").logarithmic());
    let mut names: Vec<(&str, Means)> =
        outcomes.iter().map(|o| (o.setup.metal.name, o.setup.means)).collect();
    names.dedup();
    for (n, (name, means)) in names.into_iter().enumerate() {
        let of = outcomes.iter().filter(|o| (o.setup.metal.name, o.setup.means) == (name, means));
        let (x, y): (Vec<f64>, Vec<f64>) = of
            .map(|o| {
                let exact = theory::elastic(&o.setup.metal, o.setup.radius).radius;
                (o.setup.thickness / o.setup.radius, (o.rest.radius / exact - 1.0).abs())
            })
            .unzip();
        let marker = if means == Means::Mpm { Marker::Circle } else { Marker::Square };
        chart = chart.series(
            Series::new(format!("{name}, {}", means.name()), &x, &y)?.marker(marker).colour(palette(n)),
        );
    }
    Ok(chart.series(Series::slope("second order", 2.0, (0.1, 1e-4), (0.025, 0.1))).draw()?)
}

/// Draw the ring at four times, coloured by pieces.
pub fn pieces(outcome: &breaking::Outcome) -> Result<Picture, CaseError> {
    let setup = &outcome.setup;
    let count = outcome.rows.last().map_or(0, |r| r.pieces);
    let title = format!(
        "A ring at {:.0} m/s: {} particles of a half, {count} pieces",
        setup.metal.speed, outcome.totals.particles
    );
    let mut panels = Panels::new(2).title(title);
    let last = outcome.rows.len();
    let reach = 1.05 * outcome.rows.last().map_or(setup.radius, |r| r.radius);
    for look in [last / 4, last / 3 + 1, last / 2 + 1, last].map(|n| n.saturating_sub(1)) {
        let (snapshot, row) = (&outcome.snapshots[look], &outcome.rows[look]);
        let found = breaking::pieces(setup, snapshot, row.radius)?;
        // Pieces of similar mass are rarely neighbours on the ring; failed points are dark.
        let colour = |piece: &Option<usize>| piece.map_or(0.0, |p| 2.0 + (p * 5 % 11) as f64);
        let colours = found.of.iter().map(colour).collect();
        let flat = snapshot.positions().iter().map(|&[x, y, _]| [x, y, 0.0]).collect();
        let size = ParticleSize::Uniform(0.6 * setup.spacing());
        let flat = Snapshot::new(2, snapshot.time(), 0, flat, size)?.with_scalar("piece", colours)?;
        let piece =
            Quantity::scalar("piece").label("pieces; 0: failed").range(0.0, 12.0).map(ColourMap::Viridis);
        let picture =
            FieldPicture::new(520, 460).colour_by(piece).bounds([-reach; 2], [reach; 2]).draw(&flat)?;
        panels = panels.panel(format!("{:.1} µs, {} pieces", 1e6 * row.time, row.pieces), picture);
    }
    Ok(panels.compose()?)
}

/// Write the history and the masses of pieces as CSV.
pub fn write(outcome: &breaking::Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [("time", "s"), ("radius", "m"), ("pieces", "-"), ("mass that failed", "-")];
    let name = outcome.setup.name();
    let mut file = History::create(folder.join(format!("{name}.csv")), columns)?;
    for r in &outcome.rows {
        file.push(&[r.time, r.radius, r.pieces as f64, r.failed])?;
    }
    let mut file =
        History::create(folder.join(format!("{name}_masses.csv")), [("piece", "-"), ("mass", "kg")])?;
    for (n, &mass) in outcome.masses.iter().enumerate() {
        file.push(&[n as f64, mass])?;
    }
    Ok(())
}
