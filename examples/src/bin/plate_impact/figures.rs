//! Charts and tables.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{Axis, Chart, Marker, Panels, Series, Stroke, palette};
use mpm_core::output::{History, OutputError};

use crate::metals;
use crate::shock::Impact;
use crate::spall::{self, Spall};

const THEORY: [u8; 3] = [20; 3];

/// Draw and write all results.
pub fn draw(
    impacts: &[Impact],
    refined: &[Impact],
    spalls: &[Spall],
    folder: &Path,
) -> Result<(), CaseError> {
    lines(impacts)?.draw()?.save(folder.join("lines.png"))?;
    table(impacts, folder)?;
    Panels::new(2)
        .title("a shock in copper at a particle speed of 1 km/s")
        .panel("pressure along the target", profiles(refined)?.draw()?)
        .panel("error over the spacing", errors(refined)?.draw()?)
        .compose()?
        .save(folder.join("shock.png"))?;
    Panels::new(2)
        .title("spall of a steel without yield strength: flyer of 5 mm on 10 mm")
        .panel("velocity of the free surface", surface(spalls)?.draw()?)
        .panel("density of the target at the end", scabs(spalls)?.draw()?)
        .compose()?
        .save(folder.join("spall.png"))?;
    for spall in spalls.iter().step_by(4) {
        let columns = [("time", "s"), ("velocity", "m/s"), ("pressure", "Pa")];
        let mut file = History::create(folder.join(format!("surface_{}.csv", spall.cells)), columns)?;
        for look in &spall.surface {
            file.push(&[look.time, look.speed, look.pressure])?;
        }
    }
    for impact in refined {
        let columns = [
            ("position", "m"),
            ("velocity", "m/s"),
            ("pressure", "Pa"),
            ("rho/rho0 - 1", "-"),
            ("e", "J/m^3"),
        ];
        let mut file = History::create(folder.join(format!("profile_{}.csv", impact.cells)), columns)?;
        for p in &impact.profile {
            file.push(&[p.x, p.speed, p.pressure, p.compression, p.energy])?;
        }
    }
    Ok(())
}

/// Draw shock speed over particle speed: points on the lines of the sources.
fn lines(impacts: &[Impact]) -> Result<Chart, OutputError> {
    let mut chart = Chart::new(900, 640)
        .title("Shock lines: this run (marks) on those of the sources")
        .x(Axis::new("particle speed").unit("km/s", 1e-3).range(0.0, 2400.0))
        .y(Axis::new("shock speed").unit("km/s", 1e-3));
    for (i, metal) in metals::all().iter().enumerate() {
        let own = impacts.iter().filter(|s| s.metal.name == metal.name);
        let (u, front): (Vec<f64>, Vec<f64>) = own.map(|s| (s.particle_speed, s.measured.front)).unzip();
        let ends = [0.0, 1700.0];
        let line = ends.map(|u| metal.shocked(u).front);
        let points = Series::new(metal.name, &u, &front)?.stroke(Stroke::None).marker(Marker::Circle);
        chart =
            chart.series(points.colour(palette(i))).series(Series::new("", &ends, &line)?.colour(palette(i)));
    }
    Ok(chart)
}

/// Write every shock as CSV: one row per shock, metals by their number in the order of the lines.
fn table(impacts: &[Impact], folder: &Path) -> Result<(), CaseError> {
    let columns = [
        ("u_p", "m/s"),
        ("u_p measured", "m/s"),
        ("U_s", "m/s"),
        ("U_s theory", "m/s"),
        ("p", "Pa"),
        ("p theory", "Pa"),
        ("rho/rho0 - 1", "-"),
        ("rho/rho0 - 1 theory", "-"),
        ("e", "J/m^3"),
        ("e theory", "J/m^3"),
        ("overshoot of p", "-"),
    ];
    for metal in metals::all() {
        let name = metal.file_name();
        let mut file = History::create(folder.join(format!("line_{name}.csv")), columns)?;
        for i in impacts.iter().filter(|i| i.metal.name == metal.name) {
            let (m, t) = (i.measured, i.theory());
            file.push(&[
                i.particle_speed,
                i.measured_speed,
                m.front,
                t.front,
                m.pressure,
                t.pressure,
                m.compression,
                t.compression,
                m.energy,
                t.energy,
                i.overshoot,
            ])?;
        }
    }
    Ok(())
}

fn profiles(refined: &[Impact]) -> Result<Chart, OutputError> {
    let mut chart = Chart::new(760, 520)
        .x(Axis::new("distance from the first contact").unit("mm", 1e3))
        .y(Axis::new("pressure").unit("GPa", 1e-9));
    for (i, impact) in refined.iter().enumerate() {
        let x: Vec<f64> = impact.profile.iter().map(|p| p.x).collect();
        let y: Vec<f64> = impact.profile.iter().map(|p| p.pressure).collect();
        chart = chart.series(Series::new(format!("{} cells", impact.cells), &x, &y)?.colour(palette(i)));
    }
    let Some(last) = refined.last() else { return Ok(chart) };
    let (from, to) = (last.plane, last.profile.last().map_or(last.front, |p| p.x));
    let p = last.theory().pressure;
    let step = Series::new("Rankine-Hugoniot", &[from, last.front, last.front, to], &[p, p, 0.0, 0.0])?;
    Ok(chart.series(step.stroke(Stroke::Dashed).colour(THEORY)))
}

fn errors(refined: &[Impact]) -> Result<Chart, OutputError> {
    let h: Vec<f64> = refined.iter().map(|i| crate::shock::THICKNESS / f64::from(i.cells)).collect();
    let mut chart = Chart::new(760, 520)
        .x(Axis::new("spacing").unit("mm", 1e3).logarithmic())
        .y(Axis::new("relative error").logarithmic());
    let along: Vec<f64> = refined.iter().map(Impact::profile_error).collect();
    chart = chart.series(Series::new("density, mean along the target", &h, &along)?.marker(Marker::Circle));
    for (which, what) in ["U_s", "p", "rho/rho0 - 1", "e"].into_iter().enumerate() {
        let error: Vec<f64> = refined.iter().map(|i| i.errors()[which].abs()).collect();
        chart = chart.series(Series::new(what, &h, &error)?.marker(Marker::Square));
    }
    let (Some(&coarse), Some(&fine), Some(&most)) = (h.first(), h.last(), along.first()) else {
        return Ok(chart);
    };
    Ok(chart.series(Series::slope("first order", 1.0, (coarse, most), (fine, coarse))))
}

/// Draw the velocity of the free surface on all grids, with plateau and pull-back of the theory.
fn surface(spalls: &[Spall]) -> Result<Chart, OutputError> {
    let mut chart =
        Chart::new(760, 520).x(Axis::new("time").unit("µs", 1e6)).y(Axis::new("velocity").unit("m/s", 1.0));
    for (i, spall) in spalls.iter().step_by(4).enumerate() {
        let (t, u): (Vec<f64>, Vec<f64>) = spall.surface.iter().map(|l| (l.time, l.speed)).unzip();
        chart =
            chart.series(Series::new(format!("{} cells a flyer", spall.cells), &t, &u)?.colour(palette(i)));
    }
    let end = spalls.first().and_then(|s| s.surface.last()).map_or(0.0, |l| l.time);
    let level = |name: &str, u: f64| Series::new(name, &[0.0, end], &[u; 2]);
    chart = chart.series(level("2 u_p", spall::SPEED)?.stroke(Stroke::Dotted).colour(THEORY));
    if let Some(steel) = metals::all().iter().find(|m| m.name == spall::METAL) {
        let low = level("2 u_p - 2 σ/(ρ c)", spall::SPEED - spall::acoustic_pull_back(steel))?;
        chart = chart.series(low.stroke(Stroke::Dashed).colour(THEORY));
    }
    Ok(chart)
}

/// Draw the density along the target: it drops to zero at the crack.
fn scabs(spalls: &[Spall]) -> Result<Chart, OutputError> {
    let mut chart = Chart::new(760, 520)
        .x(Axis::new("virgin metal from the free surface").unit("mm", 1e3))
        .y(Axis::new("ρ/ρ0").unit("-", 1.0));
    for (i, spall) in spalls.iter().step_by(4).enumerate() {
        let mut depth = 0.0;
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for p in spall.profile.iter().rev() {
            depth += p.thickness;
            x.push(depth);
            y.push(1.0 + p.compression);
        }
        chart =
            chart.series(Series::new(format!("{} cells a flyer", spall.cells), &x, &y)?.colour(palette(i)));
    }
    Ok(chart)
}
