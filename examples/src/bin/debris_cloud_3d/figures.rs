//! Pictures and histories.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::scene::{Outcome, RADIUS};

/// Draw all clouds at their ends.
pub fn clouds(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let title = "Aluminium sphere of 9.53 mm on an aluminium plate of 2.2 mm: particles and elements";
    let mut panels = Panels::new(2).title(title);
    for outcome in outcomes {
        let title = format!("{}, {} points", outcome.setup.name(), outcome.snapshot.len());
        panels = panels.panel(title, cut(outcome)?);
    }
    Ok(panels.compose()?)
}

/// Draw the points within a cell or 10 degrees of the plane z = 0, rotated about the axis into it.
fn cut(outcome: &Outcome) -> Result<Picture, OutputError> {
    let snapshot = &outcome.snapshot;
    let velocity = snapshot.vector("velocity")?;
    let (mut places, mut speeds, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    for (n, (&[x, y, z], v)) in snapshot.positions().iter().zip(velocity).enumerate() {
        if z < outcome.setup.spacing().max(10f64.to_radians().tan() * y) {
            places.push([x, y.hypot(z), 0.0]);
            speeds.push(v[0]);
            sizes.push(snapshot.size_of(n));
        }
    }
    let flat = Snapshot::new(2, snapshot.time(), snapshot.step(), places, ParticleSize::Each(sizes))?
        .with_scalar("speed", speeds)?;
    let speed = Quantity::scalar("speed")
        .label("velocity along x")
        .unit("km/s", 1e-3)
        .range(0.0, outcome.setup.speed)
        .map(ColourMap::Viridis);
    FieldPicture::new(640, 480)
        .colour_by(speed)
        .mirrored([Mirror::y(0.0)])
        .bounds([-3.0 * RADIUS, -6.0 * RADIUS], [11.0 * RADIUS, 6.0 * RADIUS])
        .draw(&flat)
}

/// Write the histories of the clouds.
pub fn write(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    for outcome in outcomes {
        let columns = [("time", "s"), ("front", "m"), ("mass", "kg"), ("momentum", "kg m/s")];
        let path = folder.join(format!("history_{}.csv", outcome.setup.file()));
        let mut history = History::create(path, columns)?;
        for row in &outcome.rows {
            history.push(&[row.time, row.front, row.mass, row.momentum])?;
        }
    }
    Ok(())
}
