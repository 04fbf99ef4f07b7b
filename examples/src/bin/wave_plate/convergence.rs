//! Orders of convergence: a strip of the plate with cells of h, h/2 and h/4 against the exact waves.

use std::path::Path;

use examples::fragile::Joint;
use examples::{CaseError, Check, Totals, case, machine};
use fpm::{Composition, Method};
use mpm_core::output::History;
use mpm_core::output::picture::{Axis, Chart, Marker, Panels, Picture, Series, Stroke, palette};
use mpm_core::{PlaneStrain, Solver};

use crate::load::Shape;
use crate::scene::{LENGTH, Setup, speed};

/// Required order of convergence of the displacement.
const ORDER: f64 = 1.9;
/// Length of the strip over its height: the motion is one-dimensional.
const SLENDER: usize = 10;
/// End of the run over the transit time of a wave along the plate.
const END: f64 = 8.5;
/// Reason for the low order with half a sine.
const JUMPS: &str = "the rate of half a sine jumps where it begins and ends: errors of waves fall with the power 5/3 at best, 1.98 by a \
                     sine squared";
const CANCEL: &str =
    "errors of phase of both signs nearly cancel, so that what is left is small and falls unevenly";

/// Run, and its cost.
#[derive(Clone, Debug)]
pub struct Row {
    shape: Shape,
    joint: Joint,
    /// Cells along the plate.
    along: usize,
    /// Root mean square errors of displacement and stress over all cells and steps, over those of the exact waves.
    errors: [f64; 2],
    cells: usize,
    steps: u64,
    /// Processor time, s.
    seconds: f64,
}

/// Run strips with one, two and four times the cells along, for each load and flux. Return totals and rows.
pub fn study(setups: &[Setup], along: usize) -> Result<(Totals, Vec<Row>), CaseError> {
    let (mut rows, mut totals) = (Vec::new(), Totals::default());
    for setup in setups {
        for finer in [1, 2, 4] {
            let along = along * finer;
            let setup = Setup { counts: [along, (along / SLENDER).max(2)], threads: 1, ..*setup };
            let penalty = setup.fragile.penalty()?;
            let (row, run) = match setup.joint {
                Joint::Incomplete => follow(&setup, Method::printed(PlaneStrain).with_penalty(penalty))?,
                Joint::Symmetric => follow(&setup, Method::symmetric(PlaneStrain).with_penalty(penalty))?,
            };
            totals = totals.plus(&run);
            rows.push(row);
        }
    }
    Ok((totals, rows))
}

fn follow<M: Composition<2>>(setup: &Setup, method: M) -> Result<(Row, Totals), CaseError> {
    let mut strip = setup.plate(method)?;
    let (exact, end) = (setup.exact(), END * LENGTH / speed());
    let (mut wrong, mut all, mut seconds) = ([0.0; 2], [0.0; 2], 0.0);
    while strip.time() < end {
        let start = machine::core_seconds();
        strip.step_towards(end)?;
        seconds += machine::core_seconds() - start;
        let t = strip.time();
        for (i, x) in strip.reference().iter().enumerate() {
            let wanted = [exact.displacement(x[0], t), exact.stress(x[0], t)];
            let found = [strip.displacements()[i][0], strip.nominal_stresses()[i][0][0]];
            for k in 0..2 {
                wrong[k] += (found[k] - wanted[k]).powi(2);
                all[k] += wanted[k] * wanted[k];
            }
        }
    }
    let (cells, steps) = (strip.reference().len(), strip.steps());
    let totals = Totals {
        particles: cells,
        steps,
        simulated_seconds: strip.time(),
        wall_seconds: seconds,
        updates: cells as f64 * steps as f64,
        bytes: strip.bytes(),
        energy_error: strip.account().energy_error(),
        momentum_error: 0.0,
    };
    let errors = [0, 1].map(|k| (wrong[k] / all[k]).sqrt());
    let row = Row {
        shape: setup.load.shape,
        joint: setup.joint,
        along: setup.counts[0],
        errors,
        cells,
        steps,
        seconds,
    };
    Ok((row, totals))
}

/// Return the order of convergence between two runs, of displacement or stress.
fn order([coarse, fine]: [&Row; 2], k: usize) -> f64 {
    (coarse.errors[k] / fine.errors[k]).log2()
}

/// Check the last order of the displacement for each load and flux: at least 1.9.
pub fn checks(rows: &[Row], standard: bool, resolved: bool) -> Vec<Check> {
    let judged = |three: &[Row]| -> Option<Check> {
        let [first, middle, last] = three else { return None };
        let orders = [order([first, middle], 0), order([middle, last], 0)];
        let name = format!("{}, {}: order of displacement", last.shape.name(), last.joint.name());
        let check = Check::at_least(name, orders[1], "-", ORDER, "second order [C]");
        let check = check.judged_if(resolved, "twenty cells along are too few for an order");
        Some(match (last.shape, last.joint) {
            _ if !standard => check,
            (Shape::HalfSine, Joint::Symmetric) => check.known_miss(JUMPS),
            (_, Joint::Incomplete) => check.known_miss(CANCEL),
            _ => check,
        })
    };
    rows.chunks(3).filter_map(judged).collect()
}

/// Format a table of errors, orders and costs.
pub fn table(rows: &[Row]) -> String {
    let head = [
        "load",
        "flux",
        "cells along",
        "error of u",
        "order",
        "of stress",
        "order",
        "cells",
        "steps",
        "core-s",
    ];
    let mut lines = vec![head.map(String::from)];
    for three in rows.chunks(3) {
        for (n, row) in three.iter().enumerate() {
            let order = |k: usize| {
                let before = n.checked_sub(1).map(|before| order([&three[before], row], k));
                before.map_or(String::new(), |order| format!("{order:.2}"))
            };
            lines.push([
                row.shape.name().into(),
                row.joint.name().into(),
                row.along.to_string(),
                format!("{:.3e}", row.errors[0]),
                order(0),
                format!("{:.3e}", row.errors[1]),
                order(1),
                row.cells.to_string(),
                row.steps.to_string(),
                format!("{:.2}", row.seconds),
            ]);
        }
    }
    case::columns(&lines)
}

/// Write the rows, and draw them.
pub fn keep(rows: &[Row], folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("load (1 half sine, 2 sine squared)", "-"),
        ("flux (1 incomplete, 2 symmetric)", "-"),
        ("cells along", "-"),
        ("error of displacement", "-"),
        ("error of stress", "-"),
        ("steps", "-"),
        ("processor time", "s"),
    ];
    let mut file = History::create(folder.join("convergence.csv"), columns)?;
    for r in rows {
        let load = if r.shape == Shape::HalfSine { 1.0 } else { 2.0 };
        let flux = if r.joint == Joint::Incomplete { 1.0 } else { 2.0 };
        file.push(&[load, flux, r.along as f64, r.errors[0], r.errors[1], r.steps as f64, r.seconds])?;
    }
    draw(rows)?.save(folder.join("convergence.png"))?;
    Ok(())
}

/// Draw errors over cell size and over cost.
fn draw(rows: &[Row]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2).title("Waves in a strip of the plate: error of displacement, one thread");
    for (n, label) in ["h / L", "core-seconds"].into_iter().enumerate() {
        let of = |r: &Row| if n == 0 { 1.0 / r.along as f64 } else { r.seconds };
        let mut chart = Chart::new(640, 540)
            .x(Axis::new(label).logarithmic())
            .y(Axis::new("relative error, root mean square").logarithmic());
        for (k, three) in rows.chunks(3).enumerate() {
            let Some(row) = three.first() else { continue };
            let (x, y): (Vec<f64>, Vec<f64>) = three.iter().map(|r| (of(r), r.errors[0])).unzip();
            let marker = if row.joint == Joint::Symmetric { Marker::Circle } else { Marker::Square };
            let stroke = if row.shape == Shape::HalfSine { Stroke::Solid } else { Stroke::Dashed };
            let series = Series::new(format!("{}, {}", row.shape.name(), row.joint.name()), &x, &y)?;
            chart = chart.series(series.marker(marker).stroke(stroke).colour(palette(k)));
        }
        if let (0, Some(first)) = (n, rows.first()) {
            let h = 1.0 / first.along as f64;
            let at = (h, 2.0 * first.errors[0]);
            let slope = Series::slope("order 2", 2.0, at, (0.25 * h, h));
            chart = chart.series(slope.stroke(Stroke::Dotted).colour([90; 3]));
        }
        panels = panels.panel(format!("over {label}"), chart.draw()?);
    }
    Ok(panels.compose()?)
}
