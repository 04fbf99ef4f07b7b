//! Charts of histories, and pictures of the plate.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Panels, Picture, Quantity, Series, Stroke, palette,
};

use crate::load::Shape;
use crate::scene::{LENGTH, Outcome, speed};

/// Draw all results.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    histories(outcomes)?.save(folder.join("waves.png"))?;
    plates(outcomes)?.save(folder.join("plate.png"))?;
    Ok(())
}

/// Draw a row of charts per load: displacements, stress in the middle, stress at the clamped end.
fn histories(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let what: [(&str, &[usize]); 3] = [
        ("displacement of end and middle", &[0, 1]),
        ("stress in the middle", &[2]),
        ("stress where it is held", &[3]),
    ];
    let title = "Plate under tension at its end: the fragile points method and exact waves";
    let mut panels = Panels::new(what.len()).title(title);
    let mut shapes: Vec<_> = Vec::new();
    outcomes.iter().map(|o| o.setup.load.shape).for_each(|s| {
        if !shapes.contains(&s) {
            shapes.push(s);
        }
    });
    for shape in shapes {
        let runs: Vec<&Outcome> = outcomes.iter().filter(|o| o.setup.load.shape == shape).collect();
        for (name, followed) in what {
            panels = panels.panel(format!("{}: {name}", shape.name()), chart(&runs, followed)?);
        }
    }
    Ok(panels.compose()?)
}

fn chart(runs: &[&Outcome], followed: &[usize]) -> Result<Picture, CaseError> {
    let Some(first) = runs.first() else { return Err(CaseError::Other("no run to draw".into())) };
    let (load, stress) = (first.setup.load, followed[0] >= 2);
    let scale = if stress { load.tension } else { load.tension * LENGTH / (speed() * speed()) };
    let label = if stress { "stress over the tension" } else { "displacement over that at rest" };
    let mut chart =
        Chart::new(620, 420).x(Axis::new("time").unit("ms", 1e3)).y(Axis::new(label).unit("", 1.0 / scale));
    let times = |o: &Outcome| o.history.iter().map(|e| e.time).collect::<Vec<f64>>();
    for (k, run) in runs.iter().enumerate() {
        for &n in followed {
            let y: Vec<f64> = run.history.iter().map(|e| e.found[n]).collect();
            let which = if stress { "" } else { [", end", ", middle"][n] };
            let series = Series::new(format!("{}{which}", run.setup.joint.name()), &times(run), &y)?;
            chart = chart.series(series.colour(palette(k + runs.len() * n * usize::from(!stress))));
        }
    }
    for &n in followed {
        let y: Vec<f64> = first.history.iter().map(|e| e.exact[n]).collect();
        let series = Series::new("exact", &times(first), &y)?;
        chart = chart.series(series.stroke(Stroke::Dashed).colour([20; 3]));
    }
    Ok(chart.draw()?)
}

/// Draw the stress in the plate when the front reaches the clamped end.
fn plates(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(2)
        .title("Stress along the plate when the front has come to the held end, over the tension");
    for outcome in outcomes
        .iter()
        .filter(|o| matches!(o.setup.load.shape, Shape::Step | Shape::HalfSine) || outcomes.len() < 4)
    {
        let Some(frame) = outcome.frames.first() else { continue };
        let most = outcome.setup.load.tension;
        let along: Vec<f64> = frame.tensor("stress")?.iter().map(|s| s[0] / most).collect();
        let quantity = Quantity::scalar("along").label("stress over the tension").range(-1.2, 1.2);
        let picture = FieldPicture::new(560, 330)
            .colour_by(quantity.map(ColourMap::CoolWarm))
            .draw(&frame.clone().with_scalar("along", along)?)?;
        panels = panels.panel(outcome.setup.name(), picture);
    }
    Ok(panels.compose()?)
}
