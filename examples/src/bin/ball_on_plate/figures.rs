//! Pictures and histories.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::History;
use mpm_core::output::picture::{
    Axis, Chart, FieldPicture, Mirror, Panels, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{ParticleSize, Snapshot};

use crate::hertz::Impact;
use crate::scene::Outcome;

/// Plot the force over time of all runs, with Hertz's.
pub fn forces(outcomes: &[Outcome], impact: &Impact, folder: &Path) -> Result<(), CaseError> {
    let mut chart = Chart::new(860, 520)
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("force on the ball").unit("N", 1.0));
    let (t, f): (Vec<f64>, Vec<f64>) =
        impact.history(400).into_iter().map(|[t, d]| (t, impact.force_at(d))).unzip();
    chart = chart.series(Series::new("Hertz", &t, &f)?.stroke(Stroke::Dashed).colour([60; 3]));
    for (n, outcome) in outcomes.iter().enumerate() {
        let every = outcome.rows.first().map_or(0.0, |r| r.time);
        let (t, f): (Vec<f64>, Vec<f64>) =
            outcome.rows.iter().map(|r| (r.time - 0.5 * every, r.force)).unzip();
        chart = chart.series(Series::new(outcome.setup.words(), &t, &f)?.colour(palette(n)));
    }
    chart.draw()?.save(folder.join("force.png"))?;
    Ok(())
}

/// Draw the pressure around the contact at the largest approach, one panel per run.
pub fn stresses(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    let mut panels = Panels::new(2).title("Pressure around the contact at its largest");
    for outcome in outcomes {
        let (snapshot, contact) = (&outcome.snapshot, outcome.setup.impact.contact());
        // Largest pressure by Hertz.
        let most = 1.5 * outcome.setup.impact.force() / (std::f64::consts::PI * contact * contact);
        // Points are drawn enlarged: elements that are longer than wide are drawn square.
        let size = ParticleSize::Each((0..snapshot.len()).map(|n| 1.3 * snapshot.size_of(n)).collect());
        let positions = snapshot.positions().to_vec();
        let around = Snapshot::new(2, snapshot.time(), snapshot.step(), positions, size)?
            .with_scalar("pressure", snapshot.scalar("pressure")?.to_vec())?;
        let picture = FieldPicture::new(560, 520)
            .colour_by(Quantity::scalar("pressure").label("pressure").unit("GPa", 1e-9).range(0.0, most))
            .axes("r", "z")
            .bounds([-4.0 * contact, -4.0 * contact], [4.0 * contact, 4.0 * contact])
            .mirrored([Mirror::x(0.0)])
            .draw(&around)?;
        panels = panels.panel(outcome.setup.words(), picture);
    }
    panels.compose()?.save(folder.join("pressure.png"))?;
    Ok(())
}

/// Write the history of a run.
pub fn history(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("approach of the centre of mass", "m"),
        ("mean force on the ball since the row before", "N"),
        ("speed of the ball", "m/s"),
    ];
    let mut file = History::create(folder.join(format!("history_{}.csv", outcome.setup.name())), columns)?;
    for row in &outcome.rows {
        file.push(&[row.time, row.approach, row.force, row.speed])?;
    }
    Ok(())
}
