//! Pictures and charts.

use std::collections::BTreeMap;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, FieldPicture, Mirror, Panels, Picture, Quantity, Series, Stroke, palette,
};
use mpm_core::output::{OutputError, ParticleSize, Snapshot};

use crate::checks::words;
use crate::scene::Outcome;
use crate::setup::{Bars, Load, ROD, Setup};

/// Projection of a particle position to the drawing plane; `None` to omit it.
type Flat<'a> = &'a dyn Fn([f64; 3]) -> Option<[f64; 3]>;

/// Draw the damage of each slab: in the section between two bars next to the axis, on the front and on the back.
pub fn damage(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut panels = Panels::new(3);
    for outcome in outcomes {
        let setup = &outcome.setup;
        let [half, thickness] = setup.slab;
        let h = setup.cell();
        // Ejected matter is omitted.
        let near = move |z: f64| z.abs() < 1.5 * thickness;
        let views: [(&str, f64, Flat); 3] = [
            ("section", 0.0, &|[x, y, z]| (y < 0.5 * h).then_some([x, z, 0.0])),
            ("front", 1.0, &|[x, y, z]| near(z).then_some([x, y, 0.0])),
            ("back", -1.0, &|[x, y, z]| near(z).then_some([x, y, 0.0])),
        ];
        for (n, (name, upward, flat)) in views.into_iter().enumerate() {
            let drawn = field(n > 0);
            let drawn = if n == 0 {
                let below =
                    if setup.load == Load::Rod { thickness + 1.2 * ROD.length } else { 1.6 * thickness };
                drawn.axes("x", "z").bounds([-1.05 * half, -below], [1.05 * half, 0.6 * half])
            } else {
                drawn.axes("x", "y").bounds([-1.05 * half; 2], [1.05 * half; 2])
            };
            let picture =
                drawn.lines(bars(setup, n), 1.5, [40, 110, 220]).draw(&section(outcome, upward, flat)?)?;
            panels = panels.panel(format!("{}, {name}", words(setup)), picture);
        }
    }
    Ok(panels.compose()?)
}

/// Return the initial bars as seen along z.
fn bars(setup: &Setup, view: usize) -> Vec<[[f64; 2]; 2]> {
    if view == 0 {
        return Vec::new();
    }
    let half = setup.slab[0];
    let both = setup.bars().into_iter().flat_map(|(axis, [across, _])| [(axis, across), (axis, -across)]);
    both.map(|(axis, at)| if axis == 0 { [[-half, at], [half, at]] } else { [[at, -half], [at, half]] })
        .collect()
}

fn field(whole: bool) -> FieldPicture {
    let damage = Quantity::scalar("damage").label("damage").range(0.0, 1.0).map(ColourMap::Inferno);
    let mirrors = if whole { vec![Mirror::x(0.0), Mirror::y(0.0)] } else { vec![Mirror::x(0.0)] };
    FieldPicture::new(420, 400).colour_by(damage).mirrored(mirrors)
}

/// Project the particles kept by `flat`: all, or the highest ones along `upward`; steel has no damage.
fn section(outcome: &Outcome, upward: f64, flat: Flat) -> Result<Snapshot, OutputError> {
    let snapshot = &outcome.snapshot;
    let (places, bodies, damage) = (snapshot.positions(), snapshot.bodies(), snapshot.scalar("damage")?);
    let value = |n: usize| if bodies[n] == 0 { damage[n] } else { f64::NAN };
    // In views along z, the highest or lowest particle in each column of particle width.
    let width = 0.5 * outcome.setup.cell();
    let mut seen: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    for n in 0..snapshot.len() {
        let Some(x) = flat(places[n]) else { continue };
        let column = x.map(|c| (c / width).floor() as i64);
        let key = if upward == 0.0 { [n as i64, 0, -1] } else { column };
        let best = seen.entry(key).or_insert(n);
        if upward * places[n][2] > upward * places[*best][2] {
            *best = n;
        }
    }
    let (places, values): (Vec<_>, Vec<_>) =
        seen.into_values().filter_map(|n| flat(places[n]).map(|x| (x, value(n)))).unzip();
    let size = ParticleSize::Uniform(width);
    Snapshot::new(2, snapshot.time(), snapshot.step(), places, size)?.with_scalar("damage", values)
}

/// Draw the speed of the rod over its depth, or the deflection over time.
pub fn histories(outcomes: &[&Outcome]) -> Result<Picture, CaseError> {
    let rod = outcomes.first().is_some_and(|o| o.setup.load == Load::Rod);
    let mut chart = if rod {
        Chart::new(820, 540)
            .x(Axis::new("depth of the tip").unit("mm", 1e3))
            .y(Axis::new("speed of the rod").unit("m/s", 1.0))
    } else {
        Chart::new(820, 540)
            .x(Axis::new("time").unit("ms", 1e3))
            .y(Axis::new("deflection of the back").unit("mm", 1e3))
    };
    for (n, outcome) in outcomes.iter().enumerate() {
        let row = |r: &crate::scene::Row| if rod { (r.depth, r.speed) } else { (r.time, r.deflection) };
        let (x, y): (Vec<f64>, Vec<f64>) = outcome.rows.iter().map(row).unzip();
        let particles = outcome.setup.bars == Bars::Particles;
        let name = format!("{}{}", words(&outcome.setup), if particles { ", particles" } else { "" });
        let stroke = if particles { Stroke::Dashed } else { Stroke::Solid };
        chart = chart.series(Series::new(name, &x, &y)?.colour(palette(n)).stroke(stroke));
    }
    Ok(chart.draw()?)
}
