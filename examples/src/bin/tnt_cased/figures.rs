//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::scene::Outcome;
use crate::setup::{CASE, CHARGE, Form, gurney};

/// Draw the section z = 0 at the times of the snapshots.
pub fn sections(outcome: &Outcome) -> Result<Picture, CaseError> {
    let title =
        format!("TNT in a copper case, {}: {} particles", outcome.setup.name(), outcome.totals.particles);
    let mut panels = Panels::new(2).title(title);
    for snapshot in &outcome.snapshots {
        panels = panels.panel(format!("{:.1} µs", 1e6 * snapshot.time()), section(outcome, snapshot)?);
    }
    Ok(panels.compose()?)
}

/// Draw the particles within half a cell of z = 0, coloured by speed.
fn section(outcome: &Outcome, snapshot: &Snapshot) -> Result<Picture, OutputError> {
    let h = outcome.setup.spacing();
    let (mut places, mut speeds, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    for (n, (&[x, y, z], v)) in snapshot.positions().iter().zip(snapshot.vector("velocity")?).enumerate() {
        if z < 0.5 * h {
            places.push([x, y, 0.0]);
            speeds.push(v[0].hypot(v[1]));
            // The slice of the cylinder keeps its thickness, and its particles grow in the plane only.
            let size = snapshot.size_of(n);
            sizes.push(match outcome.setup.form {
                Form::Cylinder => (size.powi(3) / (0.5 * h)).sqrt(),
                Form::Cube => size,
            });
        }
    }
    let flat = Snapshot::new(2, snapshot.time(), snapshot.step(), places, ParticleSize::Each(sizes))?
        .with_scalar("speed", speeds)?;
    let speed = Quantity::scalar("speed")
        .label("speed")
        .unit("km/s", 1e-3)
        .range(0.0, 2500.0)
        .map(ColourMap::Viridis);
    let reach = match outcome.setup.form {
        Form::Cylinder => 3.2 * CHARGE,
        Form::Cube => 2.4 * CHARGE,
    };
    FieldPicture::new(560, 500)
        .colour_by(speed)
        .mirrored([Mirror::x(0.0), Mirror::y(0.0)])
        .bounds([-reach; 2], [reach; 2])
        .draw(&flat)
}

/// Draw the speed of the case over its expansion, with the one-dimensional run and Gurney's speed.
pub fn speeds(outcome: &Outcome, alone: &[[f64; 3]]) -> Result<Picture, CaseError> {
    let middle = CHARGE + 0.5 * CASE;
    let (t, v): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (r.time, r.speed)).unzip();
    let (s, w): (Vec<f64>, Vec<f64>) = alone.iter().map(|r| (r[0], r[1])).unzip();
    let end = outcome.last();
    let title = format!("Mean radius at the end: {:.2} of that at the start", end.radius / middle);
    Ok(Chart::new(820, 520)
        .title(title)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("mean speed of the case").unit("m/s", 1.0))
        .series(
            Series::new(format!("{} cells along the radius", outcome.setup.cells), &t, &v)?
                .colour(palette(0)),
        )
        .series(Series::new("finite differences in one dimension", &s, &w)?.colour(palette(1)))
        .series(
            Series::new("Gurney", &[0.0, end.time], &[gurney(); 2])?.stroke(Stroke::Dashed).colour([60; 3]),
        )
        .draw()?)
}

/// Draw the distribution of the chemical energy over time.
pub fn energies(outcome: &Outcome) -> Result<Picture, CaseError> {
    let t: Vec<f64> = outcome.rows.iter().map(|r| r.time).collect();
    let part = |body: usize| -> Vec<f64> {
        outcome.rows.iter().map(|r| r.kinetic[body] / outcome.chemical).collect()
    };
    Ok(Chart::new(820, 480)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("kinetic energy over the chemical energy"))
        .series(Series::new("case", &t, &part(1))?.colour(palette(0)))
        .series(Series::new("gas", &t, &part(0))?.colour(palette(1)))
        .draw()?)
}

/// Write the history of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("mean speed", "m/s"),
        ("fastest", "m/s"),
        ("slowest", "m/s"),
        ("mean radius", "m"),
        ("kinetic energy of the gas", "J"),
        ("kinetic energy of the case", "J"),
    ];
    let mut file = History::create(folder.join(format!("case_{}.csv", outcome.setup.name())), columns)?;
    for r in &outcome.rows {
        let ([most, least], [gas, case]) = (r.range, r.kinetic);
        file.push(&[r.time, r.speed, most, least, r.radius, gas, case])?;
    }
    Ok(())
}
