//! Pictures and charts of one set of constants.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::picture::{
    Axis, Chart, ColourMap, Cut, FieldPicture, Marker, Mirror, Panels, ParticlePicture, Picture, Quantity,
    Series, Stroke,
};
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot};

use crate::scene::{Model, Outcome};
use crate::shape::{Sizes, WAIST};
use crate::{EXPERIMENT, finite_elements, scene};

/// Draw and write all results of one set of constants.
pub fn draw(outcomes: &[Outcome], folder: &Path) -> Result<(), CaseError> {
    let Some(first) = outcomes.first() else { return Ok(()) };
    let set = first.setup.constants.name();
    bars(outcomes)?.save(folder.join(format!("bar_{set}.png")))?;
    energy(outcomes)?.save(folder.join(format!("energy_{set}.png")))?;
    profile(outcomes)?.save(folder.join(format!("profile_{set}.png")))?;
    for outcome in outcomes {
        write_outline(outcome, &folder.join(format!("profile_{}.csv", outcome.setup.name())))?;
    }
    Ok(())
}

/// Draw the deformed bars side by side: cut open in three dimensions, as a section in axisymmetric runs.
fn bars(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let strain = Quantity::scalar("plastic_strain")
        .label("equivalent plastic strain")
        .range(0.0, most_strain(outcomes))
        .map(ColourMap::Viridis);
    let mut panels = Panels::new(2).title("Copper bar, 190 m/s, 80 µs after impact");
    for outcome in outcomes {
        let count = outcome.totals.particles;
        panels = match outcome.setup.model {
            Model::Quarter => {
                let title = format!("three dimensions, {count} particles (a quarter)");
                panels.panel(title, in_space(outcome, &strain)?)
            }
            Model::Axisymmetric => {
                panels.panel(format!("axisymmetric, {count} particles"), section(outcome, &strain)?)
            }
        };
    }
    Ok(panels.compose()?)
}

/// Return the upper end of the colour range: all but one particle in a hundred are below, rounded up to a quarter. The corner and the
/// middle of the foot exceed it.
fn most_strain(outcomes: &[Outcome]) -> f64 {
    let mut strains: Vec<f64> = outcomes
        .iter()
        .flat_map(|o| o.snapshot.scalar("plastic_strain").unwrap_or_default())
        .copied()
        .collect();
    strains.sort_by(f64::total_cmp);
    let most = strains.get(strains.len() * 99 / 100).copied().unwrap_or(1.0);
    (4.0 * most).ceil().max(1.0) / 4.0
}

/// Return a snapshot with particles as large as the widest gaps between them: the matter at the foot is stretched to more than twice its
/// width, and cubes of its volume would leave gaps.
fn closed(outcome: &Outcome, stretch: f64) -> Result<Snapshot, OutputError> {
    let s = &outcome.snapshot;
    let size = ParticleSize::Uniform(0.5 * stretch * outcome.setup.spacing());
    Snapshot::new(s.dimension(), s.time(), s.step(), s.positions().to_vec(), size)?
        .with_scalar("plastic_strain", s.scalar("plastic_strain")?.to_vec())
}

fn in_space(outcome: &Outcome, strain: &Quantity) -> Result<Picture, OutputError> {
    ParticlePicture::new(560, 580)
        .colour_by(strain.clone())
        .mirrored([Mirror::x(0.0), Mirror::y(0.0)])
        .cut(Cut { normal: [1.0, 0.0, 0.0], through: [0.0; 3] })
        .cut(Cut { normal: [0.0, -1.0, 0.0], through: [0.0; 3] })
        .draw(&outcome.snapshot)
}

fn section(outcome: &Outcome, strain: &Quantity) -> Result<Picture, OutputError> {
    FieldPicture::new(560, 580)
        .colour_by(strain.clone())
        .mirrored([Mirror::x(0.0)])
        .axes("r", "z")
        .draw(&closed(outcome, 1.8)?)
}

/// Draw the energy balance over time.
fn energy(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let mut chart = Chart::new(900, 640)
        .title("Energy of the bar")
        .x(Axis::new("time").unit("µs", 1e6))
        .y(Axis::new("energy").unit("J", 1.0));
    for (i, outcome) in outcomes.iter().enumerate() {
        let model = outcome.setup.model.name();
        let stroke = if i == 0 { Stroke::Solid } else { Stroke::Dashed };
        let t: Vec<f64> = outcome.ledger.iter().map(|e| e.time).collect();
        let whole = |x: f64| x * outcome.setup.copies();
        let kinetic: Vec<f64> = outcome.ledger.iter().map(|e| whole(e.kinetic)).collect();
        let internal: Vec<f64> = outcome.ledger.iter().map(|e| whole(e.internal)).collect();
        let total: Vec<f64> = outcome.ledger.iter().map(|e| whole(e.total)).collect();
        for (c, (name, y)) in
            [("kinetic", kinetic), ("internal", internal), ("sum", total)].iter().enumerate()
        {
            let series = Series::new(format!("{name}, {model}"), &t, y)?;
            chart = chart.series(series.stroke(stroke).colour(mpm_core::output::picture::palette(c)));
        }
    }
    Ok(chart.draw()?)
}

/// Return the three sizes as points of the outline.
fn points(sizes: &Sizes) -> ([f64; 3], [f64; 3]) {
    let top = scene::RADIUS;
    ([0.5 * sizes.foot, 0.5 * sizes.waist, top], [0.0, WAIST * scene::LENGTH, sizes.length])
}

/// Draw the radius over height, with the reference points.
fn profile(outcomes: &[Outcome]) -> Result<Picture, CaseError> {
    let constants = outcomes[0].setup.constants;
    let mut chart = Chart::new(900, 640)
        .title(format!("Profile of the bar, {} constants", constants.name()))
        .x(Axis::new("height").unit("mm", 1e3))
        .y(Axis::new("radius").unit("mm", 1e3));
    for (i, outcome) in outcomes.iter().enumerate() {
        let rings = &outcome.outline.0;
        let foot = rings.first().map_or(0.0, |r| r.height);
        let z: Vec<f64> = rings.iter().map(|r| r.height - foot).collect();
        let r: Vec<f64> = rings.iter().map(|r| r.radius).collect();
        let stroke = if i == 0 { Stroke::Solid } else { Stroke::Dashed };
        chart = chart.series(Series::new(outcome.setup.model.name(), &z, &r)?.stroke(stroke));
    }
    let references = [
        ("finite elements [C]", finite_elements(constants), Marker::Diamond, [20; 3]),
        ("experiment [M]", EXPERIMENT, Marker::Circle, [190, 40, 40]),
    ];
    for (name, sizes, marker, colour) in references {
        let (r, z) = points(&sizes);
        chart = chart.series(Series::new(name, &z, &r)?.stroke(Stroke::None).marker(marker).colour(colour));
    }
    Ok(chart.draw()?)
}

fn write_outline(outcome: &Outcome, path: &Path) -> Result<(), CaseError> {
    let columns = [("initial height", "m"), ("radius", "m"), ("height", "m")];
    let mut file = History::create(path, columns)?;
    for ring in &outcome.outline.0 {
        file.push(&[ring.start, ring.radius, ring.height])?;
    }
    Ok(())
}
