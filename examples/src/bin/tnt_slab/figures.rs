//! Charts of the slab.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{Axis, Chart, Panels, Series, Stroke, palette};
use mpm_core::output::{History, OutputError};

use crate::scene::{LENGTH, Outcome};
use crate::taylor_wave::{CHAPMAN_JOUGUET, State};

const EXACT: [u8; 3] = [20; 3];
/// Number of points of an exact curve.
const POINTS: usize = 600;

/// Draw and write all results.
pub fn draw(outcome: &Outcome, folder: &Path) -> Result<(), CaseError> {
    let title = format!("TNT slab lit at a wall, {:.1} µs after", 1e6 * outcome.time);
    Panels::new(2)
        .title(title)
        .panel("pressure along the slab", profile(outcome, Value::Pressure)?.draw()?)
        .panel("velocity along the slab", profile(outcome, Value::Speed)?.draw()?)
        .compose()?
        .save(folder.join("taylor_wave.png"))?;
    gauges(outcome)?.draw()?.save(folder.join("gauges.png"))?;
    let columns = [("position", "m"), ("velocity", "m/s"), ("pressure", "Pa"), ("exact velocity", "m/s")];
    let mut file = History::create(folder.join("profile.csv"), columns)?;
    for p in &outcome.profile {
        file.push(&[p.x, p.speed, p.pressure, outcome.wave.at(p.x / outcome.time).speed])?;
    }
    Ok(())
}

#[derive(Clone, Copy)]
enum Value {
    Pressure,
    Speed,
}

fn profile(outcome: &Outcome, value: Value) -> Result<Chart, OutputError> {
    let of = |pressure: f64, speed: f64| match value {
        Value::Pressure => pressure,
        Value::Speed => speed,
    };
    let axis = match value {
        Value::Pressure => Axis::new("pressure").unit("GPa", 1e-9),
        Value::Speed => Axis::new("velocity").unit("km/s", 1e-3),
    };
    let x: Vec<f64> = outcome.profile.iter().map(|p| p.x).collect();
    let y: Vec<f64> = outcome.profile.iter().map(|p| of(p.pressure, p.speed)).collect();
    let mut places: Vec<f64> = (0..=POINTS).map(|i| LENGTH * i as f64 / POINTS as f64).collect();
    // Two points at the front, which is a jump.
    let front = CHAPMAN_JOUGUET[0] * outcome.time;
    places.extend([front * (1.0 - 1e-9), front * (1.0 + 1e-3)]);
    places.sort_by(f64::total_cmp);
    let states: Vec<State> = places.iter().map(|x| outcome.wave.at(x / outcome.time)).collect();
    let exact: Vec<f64> = states.iter().map(|s| of(s.pressure, s.speed)).collect();
    Ok(Chart::new(760, 520)
        .x(Axis::new("position").unit("mm", 1e3))
        .y(axis)
        .series(Series::new("this run", &x, &y)?.colour(palette(0)))
        .series(Series::new("exact", &places, &exact)?.stroke(Stroke::Dashed).colour(EXACT)))
}

fn gauges(outcome: &Outcome) -> Result<Chart, OutputError> {
    let mut chart = Chart::new(900, 560)
        .title("Pressure at four gauges")
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("pressure").unit("GPa", 1e-9));
    for (i, gauge) in outcome.gauges.iter().enumerate() {
        let (t, p): (Vec<f64>, Vec<f64>) = gauge.history.iter().map(|[t, p]| (*t, *p)).unzip();
        chart = chart.series(Series::new(format!("{:.1} mm", 1e3 * gauge.place), &t, &p)?.colour(palette(i)));
    }
    let limit = Series::new("Chapman-Jouguet", &[0.0, outcome.time], &[CHAPMAN_JOUGUET[1]; 2])?;
    Ok(chart.series(limit.stroke(Stroke::Dashed).colour(EXACT)))
}
