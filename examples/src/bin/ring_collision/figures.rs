//! Histories, charts and pictures.

use std::path::Path;

use clap::ValueEnum;
use examples::{CaseError, Detection};
use mpm_core::output::History;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::scene::{Outcome, PICTURES};
use crate::setup::{Kernel, Scheme};
use crate::watch::Row;

/// Method of each panel.
const METHODS: [(Kernel, Scheme); 4] = [
    (Kernel::Linear, Scheme::Usf),
    (Kernel::Linear, Scheme::Musl),
    (Kernel::Cpgimp, Scheme::Usf),
    (Kernel::Cpgimp, Scheme::Musl),
];

/// Write and draw the detailed runs, and the energy errors of the sweep.
pub fn draw(close: &[Outcome], sweep: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    for outcome in close {
        write_rows(outcome, &folder.join(format!("history_{}.csv", outcome.setup.name())))?;
    }
    over_time(close, "closest approach of the surfaces", ("mm", 1e3), |r| r.gap, Some([-1.0e-3, 6.0e-3]))?
        .save(folder.join("closest_approach.png"))?;
    over_time(close, "contact force", ("kN", 1e-3), |r| r.force, None)?.save(folder.join("force.png"))?;
    if !sweep.is_empty() {
        write_sweep(sweep, &folder.join("energy_error.csv"))?;
        errors(sweep)?.save(folder.join("energy_error.png"))?;
    }
    rings(close)?.save(folder.join("rings.png"))?;
    closeup(close)?.save(folder.join("contact.png"))?;
    Ok(())
}

fn write_rows(outcome: &Outcome, path: &Path) -> Result<(), CaseError> {
    let columns = [
        ("time", "s"),
        ("closest approach", "m"),
        ("contact force", "N"),
        ("velocity left", "m/s"),
        ("velocity right", "m/s"),
        ("kinetic energy", "J"),
        ("internal energy", "J"),
    ];
    let mut file = History::create(path, columns)?;
    for r in &outcome.rows {
        file.push(&[r.time, r.gap, r.force, r.velocity[0], r.velocity[1], r.kinetic, r.internal])?;
    }
    Ok(())
}

fn label(outcome: &Outcome) -> String {
    format!("{}, cell {} mm", outcome.setup.detection.name(), 1e3 * outcome.setup.cell)
}

/// Draw a panel per scheme, a curve per detection and cell.
fn over_time(
    close: &[Outcome],
    what: &str,
    (unit, factor): (&str, f64),
    read: fn(&Row) -> f64,
    range: Option<[f64; 2]>,
) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2).title(format!("Two rings: {what}"));
    for (kernel, scheme) in METHODS {
        let of: Vec<&Outcome> =
            close.iter().filter(|o| (o.setup.kernel, o.setup.scheme) == (kernel, scheme)).collect();
        if of.is_empty() {
            continue;
        }
        let mut axis = Axis::new(what).unit(unit, factor);
        if let Some([low, high]) = range {
            axis = axis.range(low, high);
        }
        let mut chart = Chart::new(720, 560).x(Axis::new("time").unit("ms", 1e3).range(0.0, 3.0e-3)).y(axis);
        for outcome in of {
            let t: Vec<f64> = outcome.rows.iter().map(|r| r.time).collect();
            let y: Vec<f64> = outcome.rows.iter().map(read).collect();
            let coarse = outcome.setup.cell == close[0].setup.cell;
            let stroke = if coarse { Stroke::Solid } else { Stroke::Dashed };
            let colour = palette(outcome.setup.detection as usize);
            chart = chart.series(Series::new(label(outcome), &t, &y)?.stroke(stroke).colour(colour));
        }
        panels = panels.panel(format!("{}, {}", kernel.name(), scheme.name()), chart.draw()?);
    }
    Ok(panels.compose()?)
}

/// Draw the change of the energy over the time factor. Stopped runs and values beyond the frame are omitted.
fn errors(sweep: &[Outcome]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2).title("Two rings: energy lost (below 0) or gained by the end");
    for (kernel, scheme) in METHODS {
        let of: Vec<&Outcome> =
            sweep.iter().filter(|o| (o.setup.kernel, o.setup.scheme) == (kernel, scheme)).collect();
        if of.is_empty() {
            continue;
        }
        let mut chart = Chart::new(720, 480)
            .x(Axis::new("time factor: step over h / (c + |v|)").range(0.0, 1.0))
            .y(Axis::new("change of energy").unit("%", 100.0).range(-0.2, 0.6));
        for detection in Detection::value_variants() {
            let of = of.iter().filter(|o| o.setup.detection == *detection && o.error.is_finite());
            let (x, y): (Vec<f64>, Vec<f64>) = of.map(|o| (o.setup.factor, o.error)).unzip();
            if !x.is_empty() {
                let series = Series::new(detection.name(), &x, &y)?.marker(Marker::Circle);
                chart = chart.series(series.colour(palette(*detection as usize)));
            }
        }
        panels = panels.panel(format!("{}, {}", kernel.name(), scheme.name()), chart.draw()?);
    }
    Ok(panels.compose()?)
}

fn write_sweep(sweep: &[Outcome], path: &Path) -> Result<(), CaseError> {
    let columns = [
        ("shape (0 linear, 1 cpgimp)", "-"),
        ("scheme (0 usf, 1 musl)", "-"),
        ("detection (by place among the options)", "-"),
        ("time factor", "-"),
        ("energy error at the end", "-"),
        ("largest rise of the energy", "-"),
        ("rebound speed over impact speed", "-"),
        ("momentum error", "-"),
        ("steps", "-"),
    ];
    let mut file = History::create(path, columns)?;
    for o in sweep {
        file.push(&[
            f64::from(o.setup.kernel as u8),
            f64::from(o.setup.scheme as u8),
            f64::from(o.setup.detection as u8),
            o.setup.factor,
            o.error,
            o.rise,
            o.rebound,
            o.totals.momentum_error,
            o.totals.steps as f64,
        ])?;
    }
    Ok(())
}

/// Return the outcomes of the last scheme at the coarsest cell, one per detection.
fn shown(close: &[Outcome]) -> Vec<&Outcome> {
    let Some(last) = close.last().map(|o| o.setup) else { return Vec::new() };
    let same = |o: &&Outcome| {
        (o.setup.kernel, o.setup.scheme, o.setup.cell) == (last.kernel, last.scheme, close[0].setup.cell)
    };
    close.iter().filter(same).collect()
}

fn pressure() -> Quantity {
    Quantity::scalar("pressure").unit("MPa", 1e-6).range(-2.0e6, 2.0e6).map(ColourMap::CoolWarm)
}

/// Draw a row of pictures per detection.
fn rings(close: &[Outcome]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(PICTURES.len()).title("Two rings, 30 m/s each: pressure");
    for outcome in shown(close) {
        for snapshot in &outcome.snapshots {
            let picture = FieldPicture::new(440, 300)
                .colour_by(pressure())
                .bounds([0.0, -0.01], [0.2, 0.11])
                .draw(snapshot)?;
            panels = panels.panel(format!("{}, {:.2} ms", label(outcome), 1e3 * snapshot.time()), picture);
        }
    }
    Ok(panels.compose()?)
}

/// Draw a close-up of the contact zone at the third time.
fn closeup(close: &[Outcome]) -> Result<Picture, CaseError> {
    let all = shown(close);
    let mut panels = Panels::new(all.len().max(1)).title("Two rings pressed together, from near");
    for outcome in all {
        if let Some(snapshot) = outcome.snapshots.get(2) {
            let picture = FieldPicture::new(520, 520)
                .colour_by(pressure())
                .bounds([0.085, 0.035], [0.115, 0.065])
                .draw(snapshot)?;
            panels = panels.panel(format!("{}, {:.2} ms", label(outcome), 1e3 * snapshot.time()), picture);
        }
    }
    Ok(panels.compose()?)
}
