//! Error over cost: finite elements, material points and elements that become particles, with cells of several sizes, axisymmetric.

use std::path::Path;

use examples::{CaseError, Check, Resolution, Totals, case, machine};
use mpm_core::output::History;
use mpm_core::output::picture::{Axis, Chart, Marker, Panels, Picture, Series, palette};

use crate::beside::{Bar, Outcome};
use crate::coupled::{self, Coupling};
use crate::scene::Space;
use crate::{Methods, Options, elements, mpm};

/// Minimum processor time of a row, s: shorter runs are repeated.
const LEAST: f64 = 0.5;
/// Required cost of material points over that of finite elements at equal errors.
const CHEAPER: f64 = 3.0;

/// Largest allowed cost of elements that convert to particles, over that of material points, at equal errors.
const CONVERTED: f64 = 0.5;

const METHODS: [(Methods, &str, Marker); 4] = [
    (Methods::Fem, "finite elements", Marker::Circle),
    (Methods::Mpm, "material points", Marker::Square),
    (Methods::Mpfem, "elements and particles (MPFEM)", Marker::Triangle),
    (Methods::Afemp, "elements that become particles (AFEMP)", Marker::Diamond),
];
const FEM: usize = 0;
const MPM: usize = 1;
const AFEMP: usize = 3;

/// Sizes, and the errors at which costs are compared, below and above the speed at which finite elements tangle.
const SIZES: [(&str, [f64; 2]); 2] = [("length", [0.002, 0.01]), ("radius of the face", [0.02, 0.02])];

/// Reason for the cost of the length of a fast bar by elements that convert to particles.
const SHORT: &str = "the bar is small: much of it is converted, and elements ask for steps half as long as particles of their size";
/// Speed from which finite elements tangle, m/s, and the largest number of cells per radius that is run above it.
const TANGLES: (f64, u32) = (300.0, 4);

/// Reason for the cost of the face by finite elements.
const FACE: &str = "the edge of the face has an error of first order in the size of elements, and those there are flat, which shortens \
                    steps; particles are not squeezed";

/// Run and its cost.
struct Row {
    method: usize,
    outcome: Outcome,
    /// Processor time, s, including set-up.
    seconds: f64,
}

/// Extrapolated length and radius of the face, m.
struct Limit {
    /// Limit of each method.
    each: [[f64; 2]; METHODS.len()],
    /// Reference of errors: mean limit of finite elements and material points, or that of the latter if the former tangle.
    sizes: [f64; 2],
}

/// Run all methods; print, write and draw errors and costs. One thread, so that costs are comparable.
pub fn study(options: &Options, folder: &Path) -> Result<(Totals, Vec<Check>), CaseError> {
    let all: &[u32] =
        options.common.resolution.choose(&[3, 4, 6], &[3, 4, 6, 8, 12, 16], &[3, 4, 6, 8, 12, 16, 24, 32]);
    let (mut rows, mut totals) = (Vec::new(), Totals::default());
    for (method, &(which, ..)) in METHODS.iter().enumerate() {
        for &cells in all.iter().filter(|&&n| !tangles(which, options.speed) || n <= TANGLES.1) {
            let bar = Bar { threads: 1, ..options.bar(Space::Axisymmetric, cells) };
            match run(method, which, bar, options) {
                Ok(row) => {
                    totals = totals.plus(&row.outcome.totals);
                    rows.push(row);
                }
                Err(why) if tangles(which, options.speed) => println!("{cells} finite elements: {why}"),
                Err(why) => return Err(why),
            }
        }
    }
    let limit = Limit::of(&rows);
    println!("{}", table(&rows, &limit));
    write(&rows, &limit, &folder.join("convergence.csv"))?;
    draw(&rows, &limit)?.save(folder.join("convergence.png"))?;
    let resolved = options.common.resolution != Resolution::Smoke;
    Ok((totals, checks(&rows, &limit, resolved, options.speed)))
}

/// True for finite elements without conversion at speeds at which they tangle.
fn tangles(which: Methods, speed: f64) -> bool {
    which == Methods::Fem && speed >= TANGLES.0
}

fn run(method: usize, which: Methods, bar: Bar, options: &Options) -> Result<Row, CaseError> {
    let (start, mut times) = (machine::core_seconds(), 0.0);
    loop {
        let outcome = match which {
            Methods::Fem => elements::impact(bar, options.integration, None)?,
            Methods::Mpfem => coupled::beside(Coupling::Mpfem, bar)?,
            Methods::Afemp => coupled::beside(Coupling::Afemp, bar)?,
            _ if bar.speed >= TANGLES.0 => coupled::particles(bar)?,
            _ => mpm::impact(bar, None)?,
        };
        times += 1.0;
        let taken = machine::core_seconds() - start;
        if taken >= LEAST {
            return Ok(Row { method, outcome, seconds: taken / times });
        }
    }
}

impl Limit {
    /// Extrapolate the two finest runs of each method to the limit with an error of first order, that of the radius at the edge of the
    /// face, and average over the methods.
    fn of(rows: &[Row]) -> Self {
        let limit = |method: usize| -> [f64; 2] {
            let mut own = rows.iter().rev().filter(|row| row.method == method).map(|row| &row.outcome);
            let (Some(fine), Some(coarse)) = (own.next(), own.next()) else { return [f64::NAN; 2] };
            let [near, far] = [fine, coarse].map(|o| 1.0 / f64::from(o.bar.cells));
            [0, 1].map(|n| (far * fine.sizes[n] - near * coarse.sizes[n]) / (far - near))
        };
        let each: [[f64; 2]; METHODS.len()] = std::array::from_fn(limit);
        let mean = |n: usize| 0.5 * (each[FEM][n] + each[MPM][n]);
        Limit { each, sizes: [0, 1].map(|n| if each[FEM][n].is_nan() { each[MPM][n] } else { mean(n) }) }
    }

    /// Return the relative error of a size.
    fn error(&self, row: &Row, size: usize) -> f64 {
        (row.outcome.sizes[size] / self.sizes[size] - 1.0).abs()
    }
}

/// Return the cost of an error of a size with a method, s: logarithmic interpolation between the first run from which all finer ones are
/// within the error and the run before. `None` without such a run.
fn cost(rows: &[Row], limit: &Limit, (method, size): (usize, usize), error: f64) -> Option<f64> {
    let own = rows.iter().filter(|row| row.method == method);
    let own: Vec<(f64, f64)> = own.map(|row| (limit.error(row, size), row.seconds)).collect();
    let first = own.iter().rposition(|run| run.0 > error).map_or(0, |last| last + 1);
    let (fine, dear) = *own.get(first)?;
    let Some((coarse, cheap)) = first.checked_sub(1).map(|before| own[before]) else { return Some(dear) };
    Some(cheap * (dear / cheap).powf((coarse / error).ln() / (coarse / fine).ln()))
}

/// Check that elements are cheaper at equal errors.
fn checks(rows: &[Row], limit: &Limit, resolved: bool, speed: f64) -> Vec<Check> {
    let mut checks = Vec::new();
    let few = "three sizes of cells do not say where methods converge to";
    // The cost of a method that never reaches the error exceeds that of its finest run.
    let dearest = |method: usize| {
        rows.iter().rev().find(|row| row.method == method).map_or(f64::NAN, |row| row.seconds)
    };
    for (size, (name, errors)) in SIZES.into_iter().enumerate() {
        let error = errors[usize::from(speed >= TANGLES.0)];
        let of = |method: usize| cost(rows, limit, (method, size), error);
        let within = format!("{name} within {} %", 100.0 * error);
        let particles = of(MPM).unwrap_or(dearest(MPM));
        if !tangles(Methods::Fem, speed) {
            let name = format!("cost of material points over that of elements, {within}");
            let ratio = particles / of(FEM).unwrap_or(f64::INFINITY);
            let check = Check::at_least(name, ratio, "-", CHEAPER, "elements are to be cheaper");
            let check = if size == 1 { check.known_miss(FACE) } else { check };
            checks.push(check.judged_if(resolved, few));
        }
        let name = format!("cost of elements that become particles over that of material points, {within}");
        if let Some(converted) = of(AFEMP) {
            let check = Check::at_most(name, converted / particles, "-", CONVERTED, "they are to be cheaper");
            let check = match (size, tangles(Methods::Fem, speed)) {
                (0, true) => check.known_miss(SHORT),
                (1, false) => check.known_miss(FACE),
                _ => check,
            };
            checks.push(check.judged_if(resolved, few));
        } else {
            checks.push(Check::unreferenced(
                name,
                dearest(AFEMP) / particles,
                "-",
                "no run has that error: of the finest",
            ));
        }
    }
    checks
}

fn table(rows: &[Row], limit: &Limit) -> String {
    let head = [
        "method",
        "cells",
        "length mm",
        "error",
        "face mm",
        "error",
        "energy error",
        "points",
        "steps",
        "core-s",
    ];
    let mut lines = vec![head.map(String::from)];
    let mm = |x: f64| format!("{:.3}", 1e3 * x);
    let percent = |x: f64| format!("{:.2} %", 100.0 * x);
    for row in rows {
        let Outcome { bar, sizes, totals, .. } = &row.outcome;
        lines.push([
            row.outcome.method.into(),
            bar.cells.to_string(),
            mm(sizes[0]),
            percent(limit.error(row, 0)),
            mm(sizes[1]),
            percent(limit.error(row, 1)),
            percent(totals.energy_error),
            totals.particles.to_string(),
            totals.steps.to_string(),
            format!("{:.2}", row.seconds),
        ]);
    }
    let ends = METHODS.map(|(_, label, _)| format!("limit of {label}"));
    for (name, sizes) in
        ends.into_iter().chain(["mean".into()]).zip(limit.each.into_iter().chain([limit.sizes]))
    {
        let mut line = [const { String::new() }; 10];
        (line[0], line[2], line[4]) = (name, mm(sizes[0]), mm(sizes[1]));
        lines.push(line);
    }
    case::columns(&lines)
}

fn write(rows: &[Row], limit: &Limit, path: &Path) -> Result<(), CaseError> {
    let columns = [
        ("method (1 finite elements, 2 material points, 3 MPFEM, 4 AFEMP)", "-"),
        ("cells on the radius", "-"),
        ("length", "m"),
        ("error of the length", "-"),
        ("radius of the face", "m"),
        ("error of the face", "-"),
        ("energy error", "-"),
        ("steps", "-"),
        ("processor time", "s"),
    ];
    let mut file = History::create(path, columns)?;
    for row in rows {
        let Outcome { bar, sizes, totals, .. } = &row.outcome;
        file.push(&[
            1.0 + row.method as f64,
            f64::from(bar.cells),
            sizes[0],
            limit.error(row, 0),
            sizes[1],
            limit.error(row, 1),
            totals.energy_error,
            totals.steps as f64,
            row.seconds,
        ])?;
    }
    Ok(())
}

/// Draw errors over cost, one panel per size.
fn draw(rows: &[Row], limit: &Limit) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2).title("Error over cost, one thread");
    for (size, (name, _)) in SIZES.into_iter().enumerate() {
        let mut chart = Chart::new(620, 520)
            .x(Axis::new("core-seconds").logarithmic())
            .y(Axis::new("relative error").logarithmic());
        for (method, (_, label, marker)) in METHODS.into_iter().enumerate() {
            let of = rows.iter().filter(|row| row.method == method);
            let (x, y): (Vec<f64>, Vec<f64>) = of.map(|r| (r.seconds, limit.error(r, size))).unzip();
            chart = chart.series(Series::new(label, &x, &y)?.marker(marker).colour(palette(method)));
        }
        panels = panels.panel(name, chart.draw()?);
    }
    Ok(panels.compose()?)
}
