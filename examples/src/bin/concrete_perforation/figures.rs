//! Pictures and charts.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Mirror, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::scene::Outcome;
use crate::setup::{HALF_WIDTH, Model, ROD, SHOTS, THICKNESS};

/// Draw the slab cut through the axis at the times of the snapshots, by damage.
pub fn cuts(outcome: &Outcome) -> Result<Picture, CaseError> {
    let title = format!("{:.0} m/s, {} particles", outcome.setup.speed, outcome.totals.particles);
    let mut panels = Panels::new(2).title(title);
    for snapshot in &outcome.snapshots {
        let half = 0.5 * outcome.setup.spacing();
        let flat = |[x, y, z]: [f64; 3]| match outcome.setup.model {
            Model::Quarter => (y < half).then_some([x, z, 0.0]),
            Model::Axisymmetric => Some([x, y, 0.0]),
        };
        let picture = field(560, 520, [Mirror::x(0.0)])
            .axes("x", "z")
            .bounds([-0.8 * HALF_WIDTH, -THICKNESS - ROD.length], [0.8 * HALF_WIDTH, 1.1 * ROD.length])
            .draw(&section(outcome, snapshot, flat)?)?;
        panels = panels.panel(format!("{:.0} µs", 1e6 * snapshot.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Draw front and back of the slab at the last snapshot, by damage: radial cracks and craters.
pub fn cracks(outcome: &Outcome) -> Result<Option<Picture>, CaseError> {
    let Some(last) = outcome.snapshots.last().filter(|_| outcome.setup.model == Model::Quarter) else {
        return Ok(None);
    };
    let h = outcome.setup.spacing();
    let mut panels = Panels::new(2);
    for (name, at) in [("front", -0.5 * h), ("back", 0.5 * h - THICKNESS)] {
        // Two layers of particles; ejecta are not shown.
        let flat = |[x, y, z]: [f64; 3]| ((z - at).abs() < 0.5 * h).then_some([x, y, 0.0]);
        let picture = field(560, 560, [Mirror::x(0.0), Mirror::y(0.0)])
            .axes("x", "y")
            .bounds([-1.05 * HALF_WIDTH; 2], [1.05 * HALF_WIDTH; 2])
            .draw(&section(outcome, last, flat)?)?;
        panels = panels.panel(format!("{name}, {:.0} µs", 1e6 * last.time()), picture);
    }
    Ok(Some(panels.compose()?))
}

fn field<const N: usize>(width: usize, height: usize, mirrors: [Mirror; N]) -> FieldPicture {
    let damage = Quantity::scalar("damage").label("damage").range(0.0, 1.0).map(ColourMap::Inferno);
    FieldPicture::new(width, height).colour_by(damage).mirrored(mirrors)
}

/// Gather the particles for which `flat` returns a position in the picture.
fn section(
    outcome: &Outcome,
    snapshot: &Snapshot,
    flat: impl Fn([f64; 3]) -> Option<[f64; 3]>,
) -> Result<Snapshot, OutputError> {
    let damage = snapshot.scalar("damage")?;
    let (mut places, mut values) = (Vec::new(), Vec::new());
    for ((&x, &body), &damage) in snapshot.positions().iter().zip(snapshot.bodies()).zip(damage) {
        if let Some(place) = flat(x) {
            places.push(place);
            // The rod has no damage.
            values.push(if body == 0 { f64::NAN } else { damage });
        }
    }
    let size = ParticleSize::Uniform(outcome.setup.edge());
    Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("damage", values)
}

/// Plot the speed of the rod over the depth of its tip, one line per run.
pub fn histories(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(860, 560)
        .x(Axis::new("depth of the tip").unit("mm", 1e3))
        .y(Axis::new("speed of the rod").unit("m/s", 1.0));
    for (n, outcome) in outcomes.iter().enumerate() {
        let (x, v): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(|r| (-r.tip, r.speed)).unzip();
        let name = format!("{:.0} m/s, {} cells", outcome.setup.speed, outcome.setup.cells);
        chart = chart.series(Series::new(name, &x, &v)?.colour(palette(n)));
    }
    Ok(chart.draw()?)
}

/// Plot the residual speed over the impact speed, with the experiment.
pub fn curve(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let (v, found): (Vec<f64>, Vec<f64>) = outcomes.iter().map(|o| (o.setup.speed, o.residual())).unzip();
    let (shot, left): (Vec<f64>, Vec<f64>) = SHOTS.iter().map(|s| (s[0], s[1])).unzip();
    let setup = outcomes[0].setup;
    let name = format!("this run: {}, {} cells", setup.model.name(), setup.cells);
    let whole = [200.0, 1100.0];
    let chart = Chart::new(760, 600)
        .x(Axis::new("impact speed").unit("m/s", 1.0))
        .y(Axis::new("residual speed").unit("m/s", 1.0))
        .series(Series::new(name, &v, &found)?.marker(Marker::Circle).colour(palette(0)))
        .series(Series::new("experiment, 48 MPa", &shot, &left)?.marker(Marker::Square).colour(palette(1)))
        .series(Series::new("no slab", &whole, &whole)?.stroke(Stroke::Dotted).colour([120; 3]));
    Ok(chart.draw()?)
}

/// Write impact and residual speeds of all runs as CSV.
pub fn write_curve(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("impact speed", "m/s"),
        ("residual speed", "m/s"),
        ("cells", "-"),
        ("particles", "-"),
        ("steps", "-"),
        ("stepping", "s"),
        ("damaged part of the slab", "-"),
    ];
    let mut file = History::create(folder.join("curve.csv"), columns)?;
    for o in outcomes {
        let (particles, steps) = (o.totals.particles as f64, o.totals.steps as f64);
        let (seconds, cells) = (o.totals.wall_seconds, f64::from(o.setup.cells));
        file.push(&[o.setup.speed, o.residual(), cells, particles, steps, seconds, o.last().damaged])?;
    }
    Ok(())
}

/// Write the history of a run as CSV.
pub fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("speed", "m/s"),
        ("tip", "m"),
        ("force", "N"),
        ("damaged part of the slab", "-"),
        ("slab inside the rod", "m^3"),
    ];
    let mut file = History::create(folder.join(format!("rod_{}.csv", outcome.setup.name())), columns)?;
    for r in &outcome.rows {
        file.push(&[r.time, r.speed, r.tip, r.force, r.damaged, r.inside])?;
    }
    Ok(())
}
