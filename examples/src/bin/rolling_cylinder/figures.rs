//! Pictures and charts.

use examples::{CaseError, Detection};
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Marker, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{OutputError, ParticleSize, Snapshot};

use crate::scene::{LENGTH, Outcome, RADIUS, THICKNESS};
use crate::{course, errors};

/// Number of coloured sectors of the cylinder.
const SECTORS: f64 = 8.0;

/// Draw the rolling cylinder, one column per coefficient of friction.
pub fn cylinder(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(outcomes.len().max(1));
    let frames = outcomes.iter().map(|o| o.snapshots.len()).min().unwrap_or(0);
    for frame in 0..frames {
        for outcome in outcomes {
            let snapshot = &outcome.snapshots[frame];
            let part = (frame + 1) as f64 / frames as f64;
            let (mu, time) = (outcome.setup.incline.friction, part * outcome.setup.end);
            panels = panels.panel(format!("friction {mu}, {time:.1} s"), tilted(outcome, snapshot)?);
        }
    }
    Ok(panels.compose()?)
}

/// Draw the inclined plane, and the cylinder with rotating sectors; in three dimensions the cells beside the middle.
fn tilted(outcome: &Outcome, snapshot: &Snapshot) -> Result<Picture, CaseError> {
    let (sine, cosine) = outcome.setup.incline.angle.sin_cos();
    let turn = |[x, y, _]: [f64; 3]| [cosine * x + sine * y, cosine * y - sine * x, 0.0];
    let numbers = snapshot.scalar("particle")?;
    let angles = outcome.angles()?;
    let (mut places, mut sectors) = (Vec::new(), Vec::new());
    for ((&place, &body), &number) in snapshot.positions().iter().zip(snapshot.bodies()).zip(numbers) {
        if place[2] > 0.5 * outcome.setup.spacing() {
            continue;
        }
        let angle = angles.get(number as usize).copied().unwrap_or(0.0);
        let sector = (angle * SECTORS / std::f64::consts::TAU).floor().rem_euclid(2.0);
        places.push(turn(place));
        sectors.push(if body == 0 { 0.5 } else { sector });
    }
    let size = ParticleSize::Uniform(0.5 * outcome.setup.spacing());
    let turned =
        Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("sector", sectors)?;
    let low = turn([LENGTH, -THICKNESS, 0.0]);
    let top = turn([0.0, 2.0 * RADIUS, 0.0])[1].max(turn([LENGTH, 0.0, 0.0])[1]);
    let right = turn([LENGTH, 2.0 * RADIUS, 0.0])[0];
    let left = turn([0.0, -THICKNESS, 0.0])[0];
    Ok(FieldPicture::new(460, 520)
        .colour_by(Quantity::scalar("sector").label("sector").range(0.0, 1.0).map(ColourMap::Viridis))
        .bounds([left, low[1]], [right, top])
        .draw(&turned)?)
}

/// Draw distance and spin over time.
pub fn histories(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let chart = |title: &str, unit: &str| {
        Chart::new(720, 560).x(Axis::new("time").unit("s", 1.0)).y(Axis::new(title).unit(unit, 1.0))
    };
    let (mut way, mut spin) = (chart("way", "m"), chart("spin", "rad/s"));
    for (n, outcome) in outcomes.iter().enumerate() {
        let rows = outcome.free();
        let t: Vec<f64> = rows.iter().map(|r| r.time).collect();
        let exact = course(outcome, outcome.setup.cylinder());
        let mu = outcome.setup.incline.friction;
        let draw = |chart: Chart, now: Vec<f64>, exact: Vec<f64>| -> Result<Chart, OutputError> {
            let exact = Series::new(format!("exact, friction {mu}"), &t, &exact)?;
            let chart = chart.series(Series::new(format!("friction {mu}"), &t, &now)?.colour(palette(n)));
            Ok(chart.series(exact.stroke(Stroke::Dashed).colour([60; 3])))
        };
        way = draw(way, rows.iter().map(|r| r.way).collect(), exact.iter().map(|e| e.way).collect())?;
        spin = draw(spin, rows.iter().map(|r| r.spin).collect(), exact.iter().map(|e| e.spin).collect())?;
    }
    Ok(Panels::new(2).panel("", way.draw()?).panel("", spin.draw()?).compose()?)
}

/// Draw the errors of distance and spin over the cell size.
pub fn spacings(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut frictions: Vec<f64> = outcomes.iter().map(|o| o.setup.incline.friction).collect();
    frictions.dedup();
    let mut panels = Panels::new(2);
    for mu in frictions {
        for (what, name) in ["error of the way", "error of the spin"].iter().enumerate() {
            let mut chart = Chart::new(640, 480)
                .x(Axis::new("cell size").unit("m", 1.0))
                .y(Axis::new(*name).unit("%", 100.0));
            let detections = [
                (Detection::Local, Marker::Circle),
                (Detection::Distance, Marker::Square),
                (Detection::Approach, Marker::Triangle),
            ];
            for (detection, marker) in detections {
                let of = |o: &&Outcome| o.setup.detection == detection && o.setup.incline.friction == mu;
                let of: Vec<&Outcome> = outcomes.iter().filter(of).collect();
                if of.is_empty() {
                    continue;
                }
                let h: Vec<f64> = of.iter().map(|o| o.setup.spacing()).collect();
                let e: Vec<f64> = of.iter().map(|o| errors(o)[what]).collect();
                chart = chart.series(Series::new(detection.name(), &h, &e)?.marker(marker));
            }
            panels = panels.panel(format!("friction {mu}"), chart.draw()?);
        }
    }
    Ok(panels.compose()?)
}
