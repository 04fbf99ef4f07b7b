//! Pictures, charts and histories.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::checks::RECHT_IPSON;
use crate::scene::Outcome;
use crate::setup::{PLATE, PROJECTILE};

/// Upper end of the temperature range, K.
const HOT: f64 = 900.0;
/// Temperature of steel without a thermal state, K.
const ROOM: f64 = 293.0;

/// Draw and write all results.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    for outcome in outcomes {
        sections(outcome)?.save(folder.join(format!("plug_{}.png", outcome.setup.name())))?;
        write(outcome, folder)?;
    }
    velocities(outcomes)?.save(folder.join("velocities.png"))?;
    Ok(())
}

/// Draw damage above and temperature below, at the times of the snapshots.
fn sections(outcome: &Outcome) -> Result<Picture, CaseError> {
    let setup = &outcome.setup;
    let title = format!(
        "Arne on 8 mm of Weldox 460 E, {:.1} m/s, constants {}, {} form, {} particles",
        setup.speed,
        setup.name(),
        setup.form.name(),
        outcome.totals.particles
    );
    let (name, critical) = setup.constants.damage();
    let damage = || Quantity::scalar("of").label("damage over critical damage").range(0.0, 1.0);
    let heat = || Quantity::scalar("of").label("temperature").unit("K", 1.0).range(ROOM, HOT);
    let mut panels = Panels::new(outcome.frames.len()).title(title);
    for frame in &outcome.frames {
        let picture = section(frame, name, 0.0, 1.0 / critical, damage().map(ColourMap::Viridis))?;
        panels = panels.panel(format!("{:.0} µs", 1e6 * frame.time()), picture);
    }
    for frame in &outcome.frames {
        let picture = section(frame, "temperature", ROOM, 1.0, heat().map(ColourMap::Viridis))?;
        panels = panels.panel(format!("{:.0} µs", 1e6 * frame.time()), picture);
    }
    Ok(panels.compose()?)
}

/// Draw a scaled quantity of the plate; the projectile, which lacks it, has the value `rest`.
fn section(
    frame: &Snapshot,
    name: &str,
    rest: f64,
    factor: f64,
    quantity: Quantity,
) -> Result<Picture, OutputError> {
    let values = frame.scalar(name)?.iter().zip(frame.bodies());
    let values: Vec<f64> = values.map(|(v, body)| if *body == 1 { v * factor } else { rest }).collect();
    let sizes = ParticleSize::Each((0..frame.len()).map(|n| 1.15 * frame.size_of(n)).collect());
    let section = Snapshot::new(2, frame.time(), frame.step(), frame.positions().to_vec(), sizes)?
        .with_scalar("of", values)?;
    FieldPicture::new(400, 420)
        .colour_by(quantity)
        .axes("r", "z")
        .bounds([-2.2 * PROJECTILE[0], -2.0 * PLATE[1]], [2.2 * PROJECTILE[0], 3.6 * PLATE[1]])
        .mirrored([Mirror::x(0.0)])
        .draw(&section)
}

/// Draw the velocities of projectile and plug.
fn velocities(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart =
        Chart::new(860, 520).x(Axis::new("time").unit("µs", 1e6)).y(Axis::new("velocity").unit("m/s", 1.0));
    for (n, outcome) in outcomes.iter().enumerate() {
        let t: Vec<f64> = outcome.rows.iter().map(|r| r.time).collect();
        let [v, ahead]: [Vec<f64>; 2] =
            [|r: &crate::track::Row| r.projectile, |r: &crate::track::Row| r.ahead]
                .map(|of| outcome.rows.iter().map(of).collect());
        let name = |what: &str| format!("{what}, constants {}", outcome.setup.name());
        chart = chart
            .series(Series::new(name("projectile"), &t, &v)?.colour(palette(n)))
            .series(Series::new(name("plug"), &t, &ahead)?.colour(palette(n)).stroke(Stroke::Dashed));
    }
    if outcomes.iter().any(|o| o.setup.speed == crate::SPEED) {
        let end = outcomes.iter().map(|o| o.last().time).fold(0.0, f64::max);
        let level = Series::new("Recht and Ipson, limit from memory", &[0.0, end], &[RECHT_IPSON; 2])?;
        chart = chart.series(level.stroke(Stroke::Dotted).width(3.0).colour([60; 3]));
    }
    Ok(chart.draw()?)
}

/// Write the history of a shot as CSV.
fn write(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("projectile", "m/s"),
        ("plate ahead", "m/s"),
        ("flying mass", "kg"),
        ("piece on the axis", "m/s"),
        ("its mass", "kg"),
        ("its widest radius", "m"),
        ("free", "-"),
        ("projectile radius", "m"),
        ("projectile length", "m"),
        ("failed particles", "-"),
        ("kinetic projectile", "J"),
        ("kinetic plate", "J"),
        ("internal", "J"),
        ("friction", "J"),
        ("taken", "J"),
    ];
    let mut file = History::create(folder.join(format!("history_{}.csv", outcome.setup.name())), columns)?;
    for r in &outcome.rows {
        let ([v, m, w], [radius, length], [a, b, c, d, e]) = (r.plug, r.projectile_size, r.energies);
        let (free, failed) = (f64::from(u8::from(r.free)), r.failed as f64);
        let row =
            [r.time, r.projectile, r.ahead, r.flying, v, m, w, free, radius, length, failed, a, b, c, d, e];
        file.push(&row)?;
    }
    Ok(())
}
