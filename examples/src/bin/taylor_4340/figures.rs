//! Pictures of the bars.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity, Series, palette,
};
use mpm_core::output::{OutputError, ParticleSize, Snapshot};

use crate::scene::{LENGTH, Outcome, RADIUS, ROOM, Space};

/// Draw a picture per quantity with a row of bars per speed, and the energy over time.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    // The quarter in three dimensions is for ParaView only.
    let flat: Vec<&Outcome> = outcomes.iter().filter(|o| o.setup.space == Space::Axisymmetric).collect();
    if flat.is_empty() {
        return Ok(());
    }
    let fields = [
        ("temperature", "temperature", "K", ROOM, ColourMap::Inferno),
        ("plastic_strain", "plastic strain", "", 0.0, ColourMap::Viridis),
        ("failure_damage", "Johnson-Cook damage", "", 0.0, ColourMap::Magma),
    ];
    for (field, label, unit, low, map) in fields {
        let quantity = Quantity::scalar(field).label(label).unit(unit, 1.0).map(map);
        bars(&flat, quantity, (field, low))?.save(folder.join(format!("{field}.png")))?;
    }
    energy(&flat)?.save(folder.join("energy.png"))?;
    Ok(())
}

fn bars(outcomes: &[&Outcome], quantity: Quantity, (field, low): (&str, f64)) -> Result<Picture, CaseError> {
    let columns = outcomes.iter().filter(|o| o.setup.speed == outcomes[0].setup.speed).count();
    let mut panels = Panels::new(columns).title("Bars of 4340 steel, 60 µs after impact");
    for outcome in outcomes {
        let beside = outcomes.iter().filter(|o| o.setup.speed == outcome.setup.speed);
        let mut high = low;
        for outcome in beside {
            high = f64::max(high, most(outcome.snapshot.scalar(field)?));
        }
        let quantity = quantity.clone().range(low, high);
        let title = format!("{}, {} particles", outcome.setup.words(), outcome.totals.particles);
        panels = panels.panel(title, bar(outcome, field, quantity)?);
    }
    Ok(panels.compose()?)
}

/// Return the upper end of the colour range: all but one particle in two hundred are below.
fn most(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() * 199 / 200).copied().unwrap_or(1.0)
}

fn bar(outcome: &Outcome, field: &str, quantity: Quantity) -> Result<Picture, OutputError> {
    let s = &outcome.snapshot;
    // Particles as large as the gaps at the face, so that the matter looks closed.
    let size = ParticleSize::Uniform(2.0 * outcome.setup.spacing());
    let s = Snapshot::new(2, s.time(), s.step(), s.positions().to_vec(), size)?
        .with_scalar(field, s.scalar(field)?.to_vec())?;
    FieldPicture::new(420, 560)
        .colour_by(quantity)
        .mirrored([Mirror::x(0.0)])
        .axes("r", "z")
        .bounds([-2.2 * RADIUS, -0.02 * LENGTH], [2.2 * RADIUS, 0.94 * LENGTH])
        .draw(&s)
}

/// Draw the energy error over time, one panel per speed.
fn energy(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let beside = |a: &&Outcome, b: &&Outcome| a.setup.speed == b.setup.speed;
    let mut panels = Panels::new(outcomes.chunk_by(beside).count().min(3))
        .title("Error of the energy, over that at impact");
    let all = || outcomes.iter().flat_map(|o| &o.ledger).map(|e| e.energy_error);
    let (low, high) = (all().fold(0.0, f64::min), all().fold(1e-4, f64::max));
    // Margin for the legend above.
    let (low, high) = (low - 0.1 * (high - low), high + 0.6 * (high - low));
    for runs in outcomes.chunk_by(beside) {
        let mut chart =
            Chart::new(520, 420)
                .x(Axis::new("time").unit("µs", 1e6))
                .y(Axis::new("energy error").unit("%", 1e2).range(low, high));
        for Outcome { setup, ledger, .. } in runs {
            let (t, error): (Vec<f64>, Vec<f64>) = ledger.iter().map(|e| (e.time, e.energy_error)).unzip();
            chart = chart
                .series(Series::new(setup.form.words(), &t, &error)?.colour(palette(setup.form as usize)));
        }
        panels = panels.panel(format!("{} m/s", runs[0].setup.speed), chart.draw()?);
    }
    Ok(panels.compose()?)
}
